// Root mean squares of a car's ride: spectra as first-order terms (susp_ss.roads.colours), and a car on a road.

// Spectra { level, terms: [{ alpha, low, high }] } are level + Re sum (low alpha^2 + high omega^2) / (alpha^2 + omega^2).
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
  const own = terms.map(([alpha, low, high]) => term(alpha * rate, scale * low, scale * high));
  const surface = { level: scale * level, terms: own };
  if (!road.cutoff) return surface;
  return multiplied(surface, { level: 0, terms: [term(2 * Math.PI * road.cutoff * road.speed, 0, 1)] });
}

// A complex term as it is and as its conjugate, half of each: real together, whatever they stir.
const paired = ({ level, terms }) => ({
  level,
  terms: terms.flatMap(({ alpha, low, high }) => {
    const half = { alpha, low: scaled(low, 0.5), high: scaled(high, 0.5) };
    const other = () => Object.fromEntries(Object.entries(half).map(([name, one]) => [name, conjugate(one)]));
    return alpha.im ? [half, other()] : [{ alpha, low, high }];
  }),
});

// What is zero may be less by rounding.
const deviation = (variance) => Math.sqrt(Math.max(variance, 0));

// A car of numbers, ready for any road: a kind of `MODELS`, with parameters at every wheel.
//
// Its `dynamics` are moved by the rates of the heights under the wheels as `entering` says, vectors by wheel; an output
// `sees` the modes, of those rates themselves `on_road_velocity`, and `on_integrators` of the `integrators` of these.
class Ride {
  constructor(model, parameters) {
    Object.assign(this, MODELS[model], MODELS[model].assemble(parameters), { model, parameters });
    Object.assign(this, { driven: new Map(), entered: new Map(), tellings: [] });
  }

  // Why there is nothing to be said of it at all, or nothing on any road.
  impossible() {
    const { middle, a, b } = this.parameters;
    return middle === undefined || (-a < middle && middle < b) ? "" : filled(WORDS.middle, { middle: general(middle, 6) });
  }

  unstable() {
    return "";
  }

  // What has no finite variance where some of the integrators drift.
  drifting() {
    return WORDS.drifting;
  }

  // The car of numbers that it is on a road.
  at() {
    return this;
  }

  over(asked) {
    return bump(this.at(asked), asked);
  }

  // How a process moves what moves, by each of its axles; what cancels by symmetry, not at all.
  moved(process) {
    return kept(this.driven, process, () => process.weights.map((row) => cancelled(row, this.entering)));
  }

  // How it moves the modes.
  entries(process) {
    return kept(this.entered, process, () => this.moved(process).map((one) => this.dynamics.amplitudes(one)));
  }

  // What a real row for the parts of the modes' amplitudes and for the integrals makes an output of.
  told(row) {
    return (this.tellings[row] ??= [...this.dynamics.reading(this.sees(row)), ...this.on_integrators[row]]);
  }

  // Rates of the integrators under a process by each axle, and what is left of them after all axles; no rounding.
  integrated({ weights }) {
    const rates = weights.map((row) => this.integrators.map((one) => dot(one, row)));
    const sizes = this.integrators.map((one) => sum(one.map((rate, wheel) =>
      Math.abs(rate) * sum(weights.map((row) => Math.abs(row[wheel]))))));
    const cleaned = (row) => row.map((rate, k) => (Math.abs(rate) > DRIFT * sizes[k] ? rate : 0));
    return { rates: rates.map(cleaned), drift: cleaned(sizes.map((_, k) => sum(rates.map((row) => row[k])))) };
  }

  // The processes of a road as they pass, behind a filter if there is one.
  passing(road, filter = null) {
    const taus = this.behind.map((distance) => distance / road.speed);
    return this.processes[road.tracks].map((process) => {
      const surface = spectrumOf(process, road, this.track_width);
      const spectrum = filter ? paired(multiplied(surface, filter)) : surface;
      return new Passing(process, spectrum, taus, this.integrated(process));
    });
  }

  // Variance of every output on a road, behind a filter if there is one.
  variances(road, filter = null) {
    return this.variancesOf([...this.on_road_velocity.keys()], this.passing(road, filter), filter !== null);
  }

  // Variances of the outputs of some rows, of what passes; where it is `filtered`, its velocity has one, too.
  variancesOf(rows, passing, filtered = false) {
    const { dynamics } = this, moments = new Moments(dynamics.rates, this.integrators.length);
    const through = rows.map(() => 0);
    for (const one of passing) {
      const entries = this.entries(one.process), stirred = one.stirred(dynamics.rates, entries);
      moments.add(one, entries, stirred);
      rows.forEach((row, i) => {
        const feeds = one.process.weights.map((weights) => dot(this.on_road_velocity[row], weights));
        if (feeds.every((feed) => feed === 0)) return;
        const passedOn = () => one.passedOn(dynamics, feeds, this.sees(row), this.on_integrators[row], stirred.felt);
        through[i] += filtered ? passedOn() : Infinity;
      });
    }
    const R = moments.settled();
    return rows.map((row, i) => through[i] + quadratic(this.told(row), R));
  }

  // Root mean squares, and mean powers of dampers, in the order of the model's metrics.
  metrics(road) {
    const variances = this.variances(road);
    return this.measured.map(({ row, damper }) =>
      damper === null ? deviation(variances[row]) : this.damping[damper] * variances[row],
    );
  }
}

// Words with numbers in place of their names, and a number in so many digits, as Python's format g has it.
const filled = (words, numbers) => words.replace(/\{(\w+)\}/g, (_, name) => numbers[name]);
const general = (x, digits) => {
  const [mantissa, exponent] = x.toExponential(digits - 1).split("e").map(Number);
  if (exponent >= -4 && exponent < digits) return String(Number(x.toPrecision(digits)));
  return `${mantissa}e${exponent < 0 ? "-" : "+"}${String(Math.abs(exponent)).padStart(2, "0")}`;
};

// A real row times a complex vector.
function applied(row, x) {
  let re = 0, im = 0;
  for (let i = 0; i < row.length; i++) {
    if (row[i] === 0) continue;
    re += row[i] * x[i].re;
    im += row[i] * x[i].im;
  }
  return complex(re, im);
}

// Rows, each so many times, added up; of what cancels, no rounding.
const cancelled = (weights, rows) => rows[0].map((_, i) => {
  const terms = weights.map((weight, k) => weight * rows[k][i]), total = sum(terms);
  return Math.abs(total) > ROUNDING * sum(terms.map(Math.abs)) ? total : 0;
});

// Of a car that the speed does not change, what its dampers do not: coordinates q = T p in which all masses are one and
// left and right are their sum and their difference, what stiffness there is in these, how the rates of the heights
// under the wheels move p relative to the road and p', and what outputs see of p, p' and p''.
function frameOf({ m, K, K_in, C_in, R, N, coordinates, elongation, rate, acceleration, integrators }) {
  const T = identity(m.length), slots = coordinates.map(({ motion }) => motion);
  for (const [i, j] of alike(slots)) [T[i][i], T[i][j], T[j][i], T[j][j]] = [1, 1, 1, -1].map((one) => one * Math.SQRT1_2);
  T.forEach((row, i) => row.forEach((one, j) => (row[j] = one / Math.sqrt(m[i]))));
  const G = quotients(K, K_in), still = multiply(R, G), back = transpose(T);
  still.forEach((row, i) => add(row, N[i], 1));
  const heavy = G.map((row, i) => row.map((one) => -m[i] * one));
  return {
    T,
    back,
    stiffness: multiply(back, multiply(K, T)),
    views: [multiply(elongation, R), multiply(rate, R), acceleration].map((M) => multiply(M, T)),
    entering: transpose([...multiply(back, heavy), ...multiply(back, C_in)]),
    driven: new Map(),
    G,
    on_integrators: multiply(elongation, warped(still, integrators)),
    slots,
  };
}

// Where the same name stands twice.
const alike = (names) => [...names.keys()].map((i) => [i, names.indexOf(names[i], i + 1)]).filter(([, j]) => j > 0);

// A car that the speed does not change, which may be like another but for its dampers.
class Car extends Ride {
  constructor(model, parameters, like = null) {
    super(model, parameters);
    this.frame = like?.frame ?? frameOf(this);
    const { T, back, stiffness } = Object.assign(this, this.frame);
    this.dynamics = Dynamics.of(stiffness, multiply(back, multiply(this.C, T)), like?.dynamics);
  }

  // Shapes of the modes in the coordinates.
  get shapes() {
    return this.dynamics.shapes.map((shape) => this.T.map((row) => applied(row, shape)));
  }

  // What an output sees of each mode: elongation R p + rate R p' + acceleration p''.
  sees(row) {
    const [still, moving, accelerated] = this.views.map((M) => M[row]);
    return this.dynamics.rates.map((rate, k) => {
      const [x, v, a] = [still, moving, accelerated].map((one) => applied(one, this.dynamics.shapes[k]));
      return plus(x, product(rate, plus(v, product(rate, a))));
    });
  }

  // What is shown of where everything is: what it sees of the modes, and by how much the ground carries it.
  get positions() {
    const { shapes } = this;
    return this.placed.map(({ at }, i) => ({
      at,
      seen: shapes.map((shape) => applied(this.places[i], shape)),
      carried: multiply([this.places[i]], this.G)[0],
    }));
  }

  // Every mode with its shape in the coordinates, and the shares of its kinetic energy that the `slots` have.
  motions() {
    const { shapes } = this;
    return this.dynamics.rates.map((rate, k) => {
      const shape = shapes[k], energies = shape.map((one, i) => power(one) * this.m[i]), all = sum(energies);
      return { rate, shape, shares: energies.map((one) => one / all) };
    });
  }

  // How much a slot counts that has a mode at all.
  preferred() {
    return 0;
  }
}

// What `still` makes of the heights under the wheels, per metre of each of their `warps`.
function warped(still, warps) {
  if (!warps.length) return still.map(() => new Float64Array(0));
  const solved = inverted(multiply(warps, transpose(warps)));
  return multiply(still, transpose(warps)).map(solved);
}

// Weightings behind an output may as well stand on the road: their squares as spectra.
const FILTERS = Object.fromEntries(Object.entries(WEIGHTINGS).map(([name, { level, terms, power }]) => [name, {
  level,
  terms: terms.map(([re, im, low, its]) => ({ alpha: complex(re, im), low: complex(low, its), high: complex(0) })),
  power,
}]));
