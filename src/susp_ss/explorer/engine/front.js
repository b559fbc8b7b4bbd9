// Designs that no other beats in one metric without losing in another: susp_ss.design, of two metrics.

// Designs of the sample, and a step of differences as a share of the box.
const SAMPLE = 512, SIDE = 1e-6;

// Designs that fill the unit cube evenly: multiples of the root of x^(k + 1) = x + 1 (Roberts 2018).
function spread(k, count) {
  let ratio = 2;
  for (let round = 0; round < 60; round++) ratio = (1 + ratio) ** (1 / (k + 1));
  const at = (i) => Array.from({ length: k }, (_, j) => (0.5 + i * ratio ** -(j + 1)) % 1);
  return Array.from({ length: count }, (_, i) => at(i + 1));
}

class Search {
  // `values(u)` are two metrics of a design in the unit cube of `k` variables.
  constructor(values, k) {
    Object.assign(this, { values, k });
    this.seen = spread(k, SAMPLE).map((u) => ({ u, values: values(u) }));
    const middle = (x) => x.sort((a, b) => a - b)[SAMPLE / 2];
    this.sizes = [0, 1].map((i) => middle(this.seen.map((one) => one.values[i])));
  }

  // The design whose metric `goal` is least while the other keeps a limit: from some near it, and the best of the sample.
  least(goal, limit = Infinity, near = []) {
    const over = ({ values }) => Math.max(values[1 - goal] / limit - 1, 0);
    const order = [...this.seen].sort((a, b) => over(a) - over(b) || a.values[goal] - b.values[goal]);
    const chosen = [], most = near.length ? 1 : SEARCH.starts;
    for (const { u } of order) {
      if (chosen.length === most) break;
      if (chosen.every((other) => u.some((one, j) => Math.abs(one - other[j]) > SEARCH.apart))) chosen.push(u);
    }
    const met = [...near, ...chosen].map((u) => this.descend(goal, limit, u)).filter((one) => over(one) <= SEARCH.met);
    return met.reduce((one, other) => (one && one.values[goal] <= other.values[goal] ? one : other), null);
  }

  descend(goal, limit, start) {
    const { k, sizes } = this, ends = [0, 1].map((one) => Array(k).fill(one));
    const told = (values) => ({ value: values[goal] / sizes[goal], over: values[1 - goal] / limit - 1 });
    const at = (x) => {
      const values = this.values(x);
      return { x, values, ...told(values) };
    };
    const slopes = ({ x, value, over }) => {
      const moved = x.map((_, j) => told(this.values(x.map((one, i) => (i === j ? one + SIDE : one)))));
      return {
        value: moved.map((one) => (one.value - value) / SIDE),
        over: moved.map((one) => (one.over - over) / SIDE),
      };
    };
    const { x, values } = descended(at, slopes, start, ...ends);
    return { u: x, values };
  }
}

// Points of the front, from the least of the first metric to the least of the second: its ends, then level by level
// what lies midway between neighbours, as susp_ss.design.halving.
function frontOf(search, count) {
  const alone = [0, 1].map((goal) => search.least(goal));
  const found = alone.map((end, goal) => {
    const other = search.least(1 - goal, end.values[goal] * (1 + SEARCH.met), [end.u]);
    return other && other.values[1 - goal] <= end.values[1 - goal] ? other : end;
  });
  const apart = (a, b) => [0, 1].map((i) => Math.abs(a.values[i] - b.values[i]));
  const extent = apart(...found);
  if (extent.some((one, i) => one <= SEARCH.same * search.sizes[i])) return [found[0]];
  const shares = (a, b) => apart(a, b).map((one, i) => one / extent[i]);
  let points = found;
  const closed = new Set(), named = (gap) => gap.map(({ u }) => u.join()).join("|");
  while (points.length < count) {
    const gaps = points.slice(1).map((end, i) => [points[i], end]).filter((gap) => !closed.has(named(gap)));
    if (!gaps.length) break;
    const length = (gap) => Math.hypot(...shares(...gap)), longest = Math.max(...gaps.map(length));
    const chosen = gaps.sort((a, b) => length(b) - length(a)).slice(0, count - points.length)
      .filter((gap) => length(gap) >= 0.5 * longest);
    const between = chosen.map(([a, b]) => {
      const [first, second] = shares(a, b), held = first >= second ? 0 : 1;
      const midway = 0.5 * (a.values[held] + b.values[held]);
      return search.least(1 - held, midway, [a.u.map((one, j) => 0.5 * (one + b.u[j]))]);
    });
    const far = (one, end) => Math.max(...shares(one, end)) > SEARCH.same;
    points = undominated([...points, ...between.filter((one, i) => one && chosen[i].every((end) => far(one, end)))]);
    chosen.forEach((gap, i) => points.includes(between[i]) || closed.add(named(gap)));
  }
  return points;
}

function undominated(points) {
  const kept = [];
  for (const point of [...points].sort((a, b) => a.values[0] - b.values[0] || a.values[1] - b.values[1])) {
    if (!kept.length || point.values[1] < kept.at(-1).values[1]) kept.push(point);
  }
  return kept;
}
