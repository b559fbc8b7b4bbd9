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
class Car {
  constructor(model, parameters) {
    Object.assign(this, MODELS[model], MODELS[model].assemble(parameters), { parameters });
    const root = Float64Array.from(this.m, Math.sqrt);
    const normalised = (A) => A.map((row, i) => Float64Array.from(row, (one, j) => one / (root[i] * root[j])));
    this.dynamics = Dynamics.of(normalised(this.K), normalised(this.C));
    const { rates, shapes } = this.dynamics;
    this.shapes = shapes.map((shape) => shape.map((one, i) => scaled(one, 1 / root[i])));
    // By the rates of the heights under the wheels, into positions relative to the road and velocities.
    this.G = transpose(transpose(this.K_in).map(inverted(this.K)));
    const entering = [
      ...this.G.map((row, i) => row.map((one) => -one * root[i])),
      ...this.C_in.map((row, i) => row.map((one) => one / root[i])),
    ];
    this.entering = this.corners.map((_, wheel) => entering.map((row) => row[wheel]));
    // What every output sees of each mode: elongation R p + rate R p' + acceleration p''.
    const of = (row, x) => row.reduce((total, one, i) => (one ? plus(total, scaled(x[i], one)) : total), complex(0));
    this.placed = this.placed.map(({ at }, i) => ({ at, seen: this.shapes.map((shape) => of(this.places[i], shape)) }));
    const stretched = this.shapes.map((shape) => this.R.map((row) => of(row, shape)));
    this.seen = this.elongation.map((elongation, i) => rates.map((rate, k) => {
      const moving = plus(of(this.rate[i], stretched[k]), product(rate, of(this.acceleration[i], this.shapes[k])));
      return plus(of(elongation, stretched[k]), product(rate, moving));
    }));
    this.on_warp = this.elongation.map(() => 0);
    for (const warp of this.integrators) {
      const standing = times(multiply(this.R, this.G), warp);
      add(standing, times(this.N, warp), 1);
      this.on_warp = times(this.elongation, standing).map((one) => one / dot(warp, warp));
    }
  }

  // The car of numbers on a road, which this is on any.
  at() {
    return this;
  }

  // How a process moves the modes by each of its axles.
  entries({ weights }) {
    return weights.map((row) => {
      const total = new Float64Array(2 * this.m.length);
      row.forEach((weight, wheel) => add(total, this.entering[wheel], weight));
      return this.dynamics.amplitudes(total);
    });
  }

  // Variance of every output on a road, behind a filter if there is one.
  variances(road, filter = null) {
    const { dynamics } = this, { rates, counted } = dynamics, all = dynamics.whole(rates), n = all.length;
    const [re, im] = [0, 1].map(() => new Float64Array(rates.length * n)), cross = rates.map(() => complex(0));
    let warped = 0;
    for (const process of this.processes[road.tracks]) {
      const surface = spectrumOf(process, road, this.track_width);
      const spectrum = filter ? paired(multiplied(surface, filter)) : surface, entries = this.entries(process);
      const one = stirred(dynamics, entries, this.wheelbase / road.speed, spectrum, process.rates);
      entries.forEach((entry, j) => {
        const [b, u] = [entry, one.felt[j]].map((x) => dynamics.whole(x));
        for (let k = 0, at = 0; k < rates.length; k++) {
          for (let l = 0; l < n; l++, at++) {
            re[at] += b[k].re * u[l].re - b[k].im * u[l].im + u[k].re * b[l].re - u[k].im * b[l].im;
            im[at] += b[k].re * u[l].im + b[k].im * u[l].re + u[k].re * b[l].im + u[k].im * b[l].re;
          }
        }
      });
      one.cross?.forEach((value, k) => (cross[k] = plus(cross[k], value)));
      warped += one.own;
    }
    // Covariances of the modes: the right-hand side of Lyapunov's equation over the sum of two rates.
    for (let k = 0, at = 0; k < rates.length; k++) {
      for (let l = 0; l < n; l++, at++) {
        const x = quotient(complex(-counted[k] * re[at], -counted[k] * im[at]), plus(rates[k], all[l]));
        [re[at], im[at]] = [x.re, x.im];
      }
    }
    return this.seen.map((seen, i) => {
      // A damper that passes the road's white velocity straight on.
      if (!filter && this.on_road_velocity[i].some((one) => one !== 0)) return Infinity;
      const other = dynamics.whole(seen), warp = this.on_warp[i];
      let total = 2 * warp * dynamics.real(seen, cross) + warp * warp * warped;
      for (let k = 0, at = 0; k < rates.length; k++) {
        let x = 0, y = 0;
        for (let l = 0; l < n; l++, at++) {
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

// Weightings behind an output may as well stand on the road: their squares as spectra.
const FILTERS = Object.fromEntries(Object.entries(WEIGHTINGS).map(([name, { level, terms, power }]) => [name, {
  level,
  terms: terms.map(([re, im, low, its]) => ({ alpha: complex(re, im), low: complex(low, its), high: complex(0) })),
  power,
}]));
