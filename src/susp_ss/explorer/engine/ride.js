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
// Its `dynamics` are moved by the rates of the heights under the wheels as `entering` says, vectors by wheel; of the
// modes every output sees `seen`, of those rates themselves `on_road_velocity`, and `on_integrators` of the `integrators`
// of these.
class Ride {
  constructor(model, parameters) {
    Object.assign(this, MODELS[model], MODELS[model].assemble(parameters), { model, parameters });
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

  // How a process moves the modes by each of its axles.
  entries({ weights }) {
    return weights.map((row) => {
      const total = new Float64Array(this.entering[0].length);
      row.forEach((weight, wheel) => add(total, this.entering[wheel], weight));
      return this.dynamics.amplitudes(total);
    });
  }

  // Rates of the integrators under a process by each axle, and what is left of them after all axles; no rounding.
  integrated({ weights }) {
    const rates = weights.map((row) => this.integrators.map((one) => dot(one, row)));
    const sizes = this.integrators.map((one) => sum(one.map((rate, wheel) =>
      Math.abs(rate) * sum(weights.map((row) => Math.abs(row[wheel]))))));
    const cleaned = (row) => row.map((rate, k) => (Math.abs(rate) > DRIFT * sizes[k] ? rate : 0));
    return { rates: rates.map(cleaned), drift: cleaned(sizes.map((_, k) => sum(rates.map((row) => row[k])))) };
  }

  // Variance of every output on a road, behind a filter if there is one.
  variances(road, filter = null) {
    const { dynamics } = this, { rates, counted } = dynamics, all = dynamics.whole(rates), n = all.length;
    const [re, im] = [0, 1].map(() => new Float64Array(rates.length * n)), many = this.integrators.length;
    const cross = this.integrators.map(() => rates.map(() => complex(0))), own = zeros(many, many);
    const taus = this.behind.map((distance) => distance / road.speed), through = new Float64Array(this.seen.length);
    for (const process of this.processes[road.tracks]) {
      const surface = spectrumOf(process, road, this.track_width), entries = this.entries(process);
      const spectrum = filter ? paired(multiplied(surface, filter)) : surface, integrated = this.integrated(process);
      const bounded = integrated.drift.some((rate) => rate !== 0);
      const one = stirred(dynamics, entries, taus, spectrum, integrated.rates, bounded);
      entries.forEach((entry, j) => {
        const [b, u] = [entry, one.felt[j]].map((x) => dynamics.whole(x));
        for (let k = 0, at = 0; k < rates.length; k++) {
          for (let l = 0; l < n; l++, at++) {
            re[at] += b[k].re * u[l].re - b[k].im * u[l].im + u[k].re * b[l].re - u[k].im * b[l].im;
            im[at] += b[k].re * u[l].im + b[k].im * u[l].re + u[k].re * b[l].im + u[k].im * b[l].re;
          }
        }
      });
      if (one.own) {
        cross.forEach((row, k) => row.forEach((value, mode) => (row[mode] = plus(value, one.cross[k][mode]))));
        own.forEach((row, k) => add(row, one.own[k], 1));
      }
      this.on_road_velocity.forEach((passing, i) => {
        const feeds = process.weights.map((row) => dot(passing, row));
        if (feeds.every((feed) => feed === 0)) return;
        // White velocity has no finite variance.
        through[i] += filter
          ? passedOn(dynamics, feeds, this.seen[i], this.on_integrators[i], one, taus, spectrum, integrated.rates, bounded)
          : Infinity;
      });
    }
    // Covariances of the modes: the right-hand side of Lyapunov's equation over the sum of two rates.
    for (let k = 0, at = 0; k < rates.length; k++) {
      for (let l = 0; l < n; l++, at++) {
        const x = quotient(complex(-counted[k] * re[at], -counted[k] * im[at]), plus(rates[k], all[l]));
        [re[at], im[at]] = [x.re, x.im];
      }
    }
    return this.seen.map((seen, i) => {
      const other = dynamics.whole(seen), on = this.on_integrators[i];
      let total = through[i];
      on.forEach((one, k) => {
        total += one * (2 * dynamics.real(seen, cross[k]) + dot(own[k], on));
      });
      for (let k = 0; k < rates.length; k++) {
        if (seen[k].re === 0 && seen[k].im === 0) continue;
        let x = 0, y = 0;
        for (let l = 0, at = k * n; l < n; l++, at++) {
          x += re[at] * other[l].re - im[at] * other[l].im;
          y += re[at] * other[l].im + im[at] * other[l].re;
        }
        total += seen[k].re * x - seen[k].im * y;
      }
      return total;
    });
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

// A car that the speed does not change.
class Car extends Ride {
  constructor(model, parameters) {
    super(model, parameters);
    const root = Float64Array.from(this.m, Math.sqrt);
    const normalised = (A) => A.map((row, i) => Float64Array.from(row, (one, j) => one / (root[i] * root[j])));
    const motions = this.coordinates.map(({ motion }) => motion), each = [...new Set(motions)];
    const pairs = each.map((one) => [...motions.keys()].filter((i) => motions[i] === one)).filter(({ length }) => length === 2);
    this.dynamics = Dynamics.of(normalised(this.K), normalised(this.C), pairs);
    const { rates, shapes } = this.dynamics;
    this.shapes = shapes.map((shape) => shape.map((one, i) => scaled(one, 1 / root[i])));
    // By the rates of the heights under the wheels, into positions relative to the road and velocities.
    const G = quotients(this.K, this.K_in);
    const entering = [
      ...G.map((row, i) => row.map((one) => -one * root[i])),
      ...this.C_in.map((row, i) => row.map((one) => one / root[i])),
    ];
    this.entering = transpose(entering);
    this.G = G;
    // What every output sees of each mode: elongation R p + rate R p' + acceleration p''.
    const stretched = this.shapes.map((shape) => this.R.map((row) => applied(row, shape)));
    this.seen = this.elongation.map((elongation, i) => rates.map((rate, k) => {
      const accelerated = product(rate, applied(this.acceleration[i], this.shapes[k]));
      const moving = plus(applied(this.rate[i], stretched[k]), accelerated);
      return plus(applied(elongation, stretched[k]), product(rate, moving));
    }));
    const still = multiply(this.R, G);
    still.forEach((row, i) => add(row, this.N[i], 1));
    this.on_integrators = multiply(this.elongation, warped(still, this.integrators));
    this.slots = this.coordinates.map(({ motion }) => motion);
  }

  // What is shown of where everything is: what it sees of the modes, and by how much the ground carries it.
  get positions() {
    return this.placed.map(({ at }, i) => ({
      at,
      seen: this.shapes.map((shape) => applied(this.places[i], shape)),
      carried: multiply([this.places[i]], this.G)[0],
    }));
  }

  // Every mode with its shape in the coordinates, and the shares of its kinetic energy that the `slots` have.
  motions() {
    return this.dynamics.rates.map((rate, k) => {
      const shape = this.shapes[k], energies = shape.map((one, i) => power(one) * this.m[i]), all = sum(energies);
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
