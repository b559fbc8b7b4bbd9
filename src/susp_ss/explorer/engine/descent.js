// Least values of smooth functions within a box, under one limit if need be: sequential quadratic programmes.

// Relative descent that is rounding, steps at most, and by which share of what a step promises it must descend.
const SETTLED = 1e-11, STEPS = 100, ARMIJO = 1e-4;

// min g d + d B d / 2 within low <= d <= high: Newton's steps along the faces of the box, B positive definite.
function boxed(g, B, low, high) {
  const n = g.length, d = g.map(() => 0), held = new Set();
  const slopes = () => times(B, d).map((one, i) => one + g[i]);
  for (let round = 0; round < 20 * n; round++) {
    const free = Array.from(g, (_, i) => i).filter((i) => !held.has(i)), slope = slopes();
    if (free.length) {
      const step = inverted(free.map((i) => free.map((j) => B[i][j])))(free.map((i) => -slope[i]));
      const room = (i, by) => (by > 0 ? high[i] - d[i] : low[i] - d[i]) / by;
      const rooms = free.map((i, at) => (step[at] ? Math.max(room(i, step[at]), 0) : Infinity));
      const share = Math.min(1, ...rooms);
      free.forEach((i, at) => (d[i] += share * step[at]));
      if (share < 1) {
        const i = free[rooms.indexOf(share)];
        d[i] = Math.abs(d[i] - low[i]) < Math.abs(high[i] - d[i]) ? low[i] : high[i];
        held.add(i);
        continue;
      }
    }
    const pull = slopes();
    const inward = (i) => (d[i] <= low[i] ? -pull[i] : pull[i]);
    const worst = [...held].reduce((one, other) => (one < 0 || inward(other) > inward(one) ? other : one), -1);
    if (worst < 0 || !(inward(worst) > 0)) break;
    held.delete(worst);
  }
  return d;
}

// The same under over + a d <= 0, or as near to it as the box comes: the step and the price of the limit.
function limited(g, B, low, high, over, a) {
  const at = (price) => boxed(g.map((one, i) => one + price * a[i]), B, low, high);
  const beyond = (d) => over + dot(a, d);
  const free = at(0);
  if (beyond(free) <= 0) return { step: free, price: 0 };
  const reach = sum(Array.from(a, (one, i) => Math.min(one * low[i], one * high[i])));
  const least = Math.max(0, over + 0.9 * reach);
  let [few, many] = [0, 1];
  while (beyond(at(many)) > least && many < 1e12) many *= 8;
  for (let round = 0; round < 60; round++) {
    const middle = 0.5 * (few + many);
    if (beyond(at(middle)) > least) few = middle;
    else many = middle;
  }
  return { step: at(many), price: many };
}

// Where a `value` is least, from a start on, and a limit is not `over`, which without one is less than nothing.
// `at(x)` gives both, with x, and `slopesAt` of that their derivatives; `curvatures` are about those of the value.
function descended(at, slopesAt, start, low, high, curvatures = start.map(() => 1), settled = SETTLED) {
  const n = start.length, B = zeros(n, n).map((row, i) => ((row[i] = curvatures[i]), row));
  let here = at(start), slopes = slopesAt(here), weight = 0;
  for (let round = 0; round < STEPS; round++) {
    const { x } = here, [down, up] = [low, high].map((ends) => Array.from(x, (one, i) => ends[i] - one));
    const { step, price } = limited(slopes.value, B, down, up, here.over, slopes.over);
    weight = Math.max(2 * price, 0.5 * weight);
    const merit = ({ value, over }) => value + weight * Math.max(over, 0);
    const promised = dot(slopes.value, step) - weight * Math.max(here.over, 0);
    const curved = 0.5 * dot(step, times(B, step));
    if (!(Math.max(-promised, curved) > settled * (Math.abs(here.value) + 1))) break;
    let share = 1, next = null;
    do {
      next = at(x.map((one, i) => Math.min(Math.max(one + share * step[i], low[i]), high[i])));
      if (merit(next) <= merit(here) + ARMIJO * share * promised) break;
      share *= 0.5;
    } while (share > 1e-4);
    if (!(merit(next) < merit(here))) break;
    const after = slopesAt(next), bent = (found) => Array.from(found.value, (one, i) => one + price * found.over[i]);
    bend(B, Array.from(next.x, (one, i) => one - x[i]), bent(after).map((one, i) => one - bent(slopes)[i]));
    [here, slopes] = [next, after];
  }
  return here;
}

// The curvature after a step of so much and a change of the slope by so much, by Powell's damped form of BFGS.
function bend(B, step, change) {
  const pushed = times(B, step), own = dot(step, pushed), found = dot(step, change);
  if (!(own > 0)) return;
  const kept = found < 0.2 * own ? (0.8 * own) / (own - found) : 1;
  const damped = pushed.map((one, i) => kept * change[i] + (1 - kept) * one), size = dot(step, damped);
  B.forEach((row, i) => {
    add(row, damped, damped[i] / size);
    add(row, pushed, -pushed[i] / own);
  });
}
