// Root mean squares of a car's ride: spectra as first-order terms (susp_ss.roads.colours), and a car on a road.

// Spectra level + Re sum (low alpha^2 + high omega^2) / (alpha^2 + omega^2) are { level, terms: [{ alpha, low, high }] }.
function multiplied(one, other) {
  const apart = one.terms.map((term) => {
    const near = ({ alpha }) => modulus(minus(term.alpha, alpha)) < COINCIDENT * modulus(alpha);
    return other.terms.some(near) ? { ...term, alpha: scaled(term.alpha, 1 + 2 * COINCIDENT) } : term;
  });
  const seen = (terms, by) => terms.map(({ alpha, low, high }) => {
    const at = atPole(by, alpha);
    return { alpha, low: product(low, at), high: product(high, at) };
  });
  const terms = [...seen(apart, other), ...seen(other.terms, { level: one.level, terms: apart })];
  const end = ({ level, terms }, of) => level + sum(terms.map((term) => term[of].re));
  // What cancels at one end of the frequency axis is not computed there.
  const lows = [...one.terms, ...other.terms].some(({ low }) => low.re !== 0 || low.im !== 0);
  const level = lows
    ? end(one, "high") * end(other, "high") - sum(terms.map(({ high }) => high.re))
    : end(one, "low") * end(other, "low");
  return { level, terms };
}

// A spectrum at omega^2 = -at^2: half the sum of each term and its conjugate.
function atPole({ level, terms }, at) {
  const square = product(at, at);
  const value = (alpha, low, high) => {
    const own = product(alpha, alpha);
    return quotient(minus(product(low, own), product(high, square)), minus(own, square));
  };
  return terms.reduce((total, { alpha, low, high }) => {
    const both = plus(value(alpha, low, high), value(conjugate(alpha), conjugate(low), conjugate(high)));
    return plus(total, scaled(both, 0.5));
  }, complex(level));
}

// The velocity of a road under one process, of terms that stand for unit roughness, speed and track width.
function spectrumOf(process, road, trackWidth) {
  const { level, terms } = SURFACES[process.sign][road.waviness], unit = process.sign ? trackWidth : 1;
  const scale = (process.sign ? 1 : process.share) * road.roughness * road.speed * unit ** (road.waviness - 2);
  const rate = road.speed / unit;
  const term = (alpha, low, high) => ({ alpha: complex(alpha), low: complex(low), high: complex(high) });
  const surface = { level: scale * level, terms: terms.map(([alpha, low, high]) => term(alpha * rate, scale * low, scale * high)) };
  if (!road.cutoff) return surface;
  return multiplied(surface, { level: 0, terms: [term(2 * Math.PI * road.cutoff * road.speed, 0, 1)] });
}

// Of the square of its terms, a variance of rounding.
const NOTHING = 1e-12;

// A car of numbers, ready for any road: a kind of `MODELS`, with parameters at every wheel.
class Car {
  constructor(model, parameters) {
    Object.assign(this, MODELS[model], MODELS[model].assemble(parameters));
    const root = Float64Array.from(this.m, Math.sqrt), pairs = [...root, ...root];
    const normalised = (A) => A.map((row, i) => Float64Array.from(row, (one, j) => one / (root[i] * root[j])));
    this.dynamics = new Dynamics(normalised(this.K), normalised(this.C));
    this.G = transpose(transpose(this.K_in).map(inverted(this.K)));
    this.entering = [
      ...this.G.map((row, i) => row.map((one) => -one * root[i])),
      ...this.C_in.map((row, i) => row.map((one) => one / root[i])),
    ];
    this.seen = this.on_position.map((row, i) => [...row, ...this.on_velocity[i]].map((one, j) => one / pairs[j]));
    this.on_warp = this.elongation.map(() => 0);
    for (const warp of this.integrators) {
      const stretched = times(multiply(this.R, this.G), warp);
      add(stretched, times(this.N, warp), 1);
      this.on_warp = times(this.elongation, stretched).map((one) => one / dot(warp, warp));
    }
  }

  // Variance of every output on a road, behind a filter if there is one.
  variances(road, filter = null) {
    const size = this.entering.length, Q = zeros(size, size), cross = new Float64Array(size);
    let warped = 0;
    for (const process of this.processes[road.tracks]) {
      const surface = spectrumOf(process, road, this.track_width), spectrum = filter ? multiplied(surface, filter) : surface;
      const entries = process.weights.map((weights) => times(this.entering, weights));
      const one = stirred(this.dynamics, entries, this.wheelbase / road.speed, spectrum, process.rates);
      Q.forEach((row, i) => add(row, one.Q[i], 1));
      if (one.cross) add(cross, one.cross, 1);
      warped += one.own;
    }
    const X = this.dynamics.lyapunov(Q);
    return this.seen.map((row, i) => {
      // A damper that passes the road's white velocity straight on.
      if (!filter && this.on_road_velocity[i].some((one) => one !== 0)) return Infinity;
      const warp = this.on_warp[i], total = dot(row, times(X, row)) + 2 * warp * dot(row, cross) + warp * warp * warped;
      // What cancels by symmetry leaves rounding.
      const terms = row.reduce((size, one, k) => size + Math.abs(one) * Math.sqrt(Math.max(X[k][k], 0)), 0);
      return total > NOTHING * terms * terms ? total : 0;
    });
  }

  // Root mean squares, and mean powers of dampers, in the order of the model's metrics.
  metrics(road) {
    const variances = this.variances(road);
    return this.measured.map(({ row, damper }) =>
      damper === null ? Math.sqrt(variances[row]) : this.damping[damper] * variances[row],
    );
  }
}

// Weightings behind an output may as well stand on the road: their squares as spectra.
const FILTERS = Object.fromEntries(Object.entries(WEIGHTINGS).map(([name, { level, terms, power }]) => [name, {
  level,
  terms: terms.map(([re, im, low, its]) => ({ alpha: complex(re, im), low: complex(low, its), high: complex(0) })),
  power,
}]));
