// How far any suspension could go: the least of one variance under limits of others, by their dual, as
// susp_ss.feedback.bound and dual.

// States that the road moves less than this share of the one it moves most are scaled as if it did.
const FAINT = 1e-6;

// Relative ascent of the dual that is rounding.
const SHARP = 1e-13;

// A car with a force beside every suspension, on a road: states scaled by how much the road moves them, and the noises
// behind it.
class Plant {
  constructor(car, road) {
    const { m, C_in, G, acceleration, suspensions } = car, { A, Y } = displacementForm(car), push = pushes(car);
    const W = [...negated(G), ...C_in.map((row, i) => row.map((one) => one / m[i]))];
    const B = [...zeros(m.length, suspensions.length), ...push];
    Object.assign(this, { A, B, C: Y, D: multiply(acceleration, push), W, car, road });
    this.scale();
  }

  scale() {
    const { A, B, C, W } = this, n = A.length / 2, unit = Math.sqrt(sum(A.slice(n).map((row, i) => -row[i])) / n);
    const by = (sizes) => {
      this.A = this.A.map((row, i) => Array.from(row, (one, j) => (one * sizes[j]) / sizes[i]));
      [this.B, this.W] = [this.B, this.W].map((M) => M.map((row, i) => row.map((one) => one / sizes[i])));
      this.C = this.C.map((row) => Array.from(row, (one, j) => one * sizes[j]));
    };
    by(A.map((_, i) => (i < n ? 1 / unit : 1)));
    const X = new Decay(this.A).stirred(across(this.W, this.W));
    const sizes = X.map((row, i) => Math.sqrt(Math.max(row[i], 0)));
    by(sizes.map((one) => Math.max(one, FAINT * Math.max(...sizes))));
  }

  // The noises of all processes, for the outputs of these rows.
  noises(rows) {
    const { car, road, W } = this;
    return car.processes[road.tracks].map((process) => {
      const warping = car.integrated(process).rates;
      const { direct, rates, gains, standing } = shapingOf(spectrumOf(process, road, car.track_width));
      const axles = [], bank = [];
      process.weights.forEach((weights, j) => {
        const entering = times(W, weights);
        const [passing, held] = [rows.map((row) => (row < 0 ? 0 : dot(car.on_road_velocity[row], weights))),
          rows.map((row) => (row < 0 ? 0 : dot(car.on_integrators[row], warping[j])))];
        axles.push({
          delay: car.behind[j] / road.speed,
          entry: entering.map((one) => direct * one),
          standing: held.map((one) => standing * one),
        });
        gains.forEach((gain, k) => bank.push({
          axle: j, of: k, pushed: entering.map((one) => one * gain),
          seen: passing.map((one, i) => one * gain - (held[i] * gain) / rates[k]),
        }));
      });
      return { axles, rates, bank };
    });
  }
}

// The outputs by their rows: the one that is minimised, those limited, and then the forces themselves.
class Dual {
  constructor(plant, goal, rows) {
    const { car, road, A, B } = plant, forces = B[0].length;
    const own = [goal, ...rows], C = [...own.map((row) => plant.C[row]), ...zeros(forces, A.length)];
    const D = [...own.map((row) => plant.D[row]), ...identity(forces)];
    this.system = { A, B, C, D };
    this.noises = plant.noises([...own, ...Array(forces).fill(-1)]);
    const alone = car.variances(road), felt = plant.D.map((row) => Math.max(...row.map(Math.abs)));
    const sizes = felt.flatMap((one, row) => (one > 0 && alone[row] < Infinity ? [alone[row] / one ** 2] : []));
    this.force = sizes.length ? Math.max(...sizes) : 1;
    this.size = alone[goal];
    this.idle = zeros(forces, A.length);
  }

  weights(multipliers, limits, light) {
    const forces = this.idle.length;
    const prices = limits.map((limit, i) => multipliers[i] / limit);
    return [1 / this.size, ...prices, ...Array(forces).fill(light / this.force)];
  }

  // The law of least cost for multipliers and a weight on forces, its variances, and by how much limits are exceeded.
  at(limits, multipliers, light, K) {
    const law = optimal(this.system, this.weights(multipliers, limits, light), K);
    const variances = variancesUnder(this.system, this.noises, law);
    return { law, variances, multipliers, light, excess: limits.map((limit, i) => variances[1 + i] / limit - 1) };
  }

  // Maximise the dual, which is concave, over the multipliers.
  solve(limits, light, start) {
    let first = limits.map((_, i) => start?.multipliers[i] ?? DUAL.start), found = null;
    let K = start ? start.law.K : this.idle;
    const at = (x) => {
      const one = this.at(limits, x, light, K);
      K = one.law.K;
      return { ...one, x, value: sum(x) - dot(one.law.weights, one.variances), over: -1 };
    };
    const slopes = ({ excess }) => ({ value: excess.map((one) => -one), over: excess.map(() => 0) });
    const ends = [0, DUAL.most].map((one) => limits.map(() => one));
    // Where it is stuck, what it has learnt of the curvature is forgotten.
    for (let round = 0; round < DUAL.lifts; round++) {
      const curvatures = first.map((one) => 1 / Math.max(one, DUAL.awake));
      found = descended(at, slopes, first, ...ends, curvatures, SHARP);
      if (!found.excess.some((one) => one > DUAL.met)) break;
      first = found.multipliers;
    }
    return found;
  }

  // The least variance under limits and the solution from which one nearby may start; none where no law meets them.
  bound(limits, start) {
    const { light: weights, resolved, met } = DUAL;
    const [first, ...lighter] = start ? weights.slice(weights.indexOf(start.light) - 1) : weights;
    const beyond = ({ excess }) => Math.max(0, ...excess) > met;
    const level = ({ variances }) => Math.sqrt(variances[0] / this.size);
    let fine = this.solve(limits, first, start);
    if (beyond(fine)) return null;
    for (const light of lighter) {
      const coarse = fine;
      fine = this.solve(limits, light, coarse);
      if (beyond(fine)) return null;
      if (level(coarse) - level(fine) < resolved) break;
    }
    return fine;
  }
}
