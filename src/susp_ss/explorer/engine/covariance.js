// A car's motion by its modes, and its exact covariance on a road: for one design, the algebra of
// susp_ss.responses.covariance.modal and first_order.

// p' = v + ..., v' = -K p - C v + ..., K and C symmetric; vectors hold the positions before the velocities, `shapes` are
// those of the positions.
class Dynamics extends Modes {
  static of(K, C) {
    const own = new Dynamics(K, C);
    return own.condition < PARALLEL ? own : new Dynamics(K, divided(C, 1 - ASIDE));
  }

  constructor(K, C) {
    super();
    const n = K.length, unit = Math.sqrt(sum(K.map((row, i) => row[i])) / n);
    Object.assign(this, { n, K: divided(K, unit ** 2), C: divided(C, unit) });
    const A = zeros(2 * n, 2 * n);
    for (let i = 0; i < n; i++) {
      A[i][n + i] = 1;
      A[n + i].set(this.K[i].map((k) => -k));
      A[n + i].set(this.C[i].map((c) => -c), n);
    }
    const found = eigenvalues(A).filter((rate) => creeping(rate) || rate.im > 0);
    const modes = found.map((rate, at) => this.polished(rate, at));
    this.turn(modes.map(({ rate }) => scaled(rate, unit)));
    this.shapes = modes.map(({ shape }) => shape);
    const all = this.whole(this.rates), V = A.map((_, i) => this.whole(this.shapes.map((shape) => shape[i % n]))
      .map((one, k) => (i < n ? one : product(all[k], one))));
    const sizes = this.rates.map((_, k) => sum(V.map((row, i) => (i < n ? unit : 1) * modulus(row[k]))));
    this.W = solve(V, V.map((row, i) => row.map((_, j) => complex(i === j ? 1 : 0)))).slice(0, modes.length);
    const seen = this.W.map((row) => sum(row.map((one, i) => modulus(one) / (i < n ? unit : 1))));
    this.condition = Math.max(...seen.map((one, k) => one * sizes[k])) / (2 * n);
  }

  // An eigenvalue and its vector by steps of Newton's: the rate is moved aside by a little, lest it be exact, and put
  // right by Rayleigh's quotient, whose error is the square of the vector's.
  polished(rate, at) {
    const { n, K, C } = this, aside = scaled(rate, 1 + 1e-9), square = product(aside, aside);
    const applied = (M, x) => M.map((row) => x.map((one, j) => scaled(one, row[j])).reduce(plus));
    const form = (x, y) => x.map((one, i) => product(one, y[i])).reduce(plus);
    let shape = Array.from({ length: n }, (_, i) => complex(Math.cos(1 + i * i + i * at)));
    for (let round = 0; round < 3; round++) {
      const D = K.map((row, i) => Array.from(row, (k, j) => {
        const free = complex(k + C[i][j] * aside.re, C[i][j] * aside.im);
        return i === j ? plus(free, square) : free;
      }));
      const slope = applied(C, shape).map((one, i) => [plus(one, scaled(product(aside, shape[i]), 2))]);
      const x = solve(D, slope).map(([one]) => one), size = Math.sqrt(sum(x.map(power)));
      shape = x.map((one) => scaled(one, 1 / size));
    }
    const m = form(shape, shape), c = form(shape, applied(C, shape)), k = form(shape, applied(K, shape));
    const most = ROUNDING * Math.max(...shape.map(modulus));
    shape = shape.map((one) => (modulus(one) > most ? one : complex(0)));
    const off = plus(product(plus(product(m, rate), c), rate), k);
    return { rate: minus(rate, quotient(off, plus(scaled(product(m, rate), 2), c))), shape };
  }
}

const divided = (A, by) => A.map((row) => row.map((one) => one / by));

// What one process u of a spectrum stirs up, which moves modes by entries[j] at the j-th axle, taus[j] after the first.
//
// felt[j] is E[x u(t - tau_j)] by modes, of white noise half of it where an axle meets itself. Of the integrals h' =
// sum integrating[j] u(t - tau_j), `cross` is E[x h] by modes and `own` E[h h]; unless the height z of the process is
// `bounded`, they add up to nothing over the axles. With R = (alpha I - A)^-1, d = e^(-alpha tau) and f what a fading
// colour forces over the delay, alpha R = I + R A and alpha f = e^(A tau) b - d b - A f. High-passes, though white at
// high frequency, then need no white noise of their own, with which they would cancel.
function stirred({ rates }, entries, taus, { level, terms }, integrating, bounded) {
  const axles = [...entries.keys()], many = integrating[0].length, over = (i, j) => Math.abs(taus[j] - taus[i]);
  const faded = terms.map(({ alpha }) => axles.map((i) =>
    axles.map((j) => (i === j ? complex(0) : exponentialLess1(scaled(alpha, -over(i, j)))))));
  const integrates = integrating.some((row) => row.some((rate) => rate !== 0));
  const felt = axles.map(() => rates.map(() => complex(0)));
  const cross = Array.from({ length: many }, () => rates.map(() => complex(0)));
  const increase = (total, a, b) => {
    total.re += a.re * b.re - a.im * b.im;
    total.im += a.re * b.im + a.im * b.re;
  };
  rates.forEach((rate, mode) => {
    const b = entries.map((entry) => entry[mode]);
    if (b.every(({ re, im }) => re === 0 && im === 0)) return;
    // e^(A tau) b from axle to axle; of all axles ahead, and with the own.
    const free = axles.map((j) => axles.slice(0, j).map((i) => product(exponential(scaled(rate, over(i, j))), b[i])));
    const ahead = free.map((some) => some.reduce(plus, complex(0)));
    const heights = axles.map((j) => (bounded ? complex(0) : scaled(minus(ahead[j], b.slice(0, j).reduce(plus, complex(0))), level)));
    axles.forEach((j) => (felt[j][mode] = scaled(plus(ahead[j], scaled(b[j], 0.5)), level)));
    terms.forEach(({ alpha, low, high }, at) => {
      const slow = scaled(product(low, alpha), 0.5), fast = scaled(product(high, rate), 0.5), gone = faded[at];
      const away = minus(alpha, rate), gain = quotient(minus(slow, fast), away), push = plus(slow, fast);
      let first;
      for (const j of axles) {
        const met = plus(ahead[j], b[j]), forced = complex(0), late = complex(0);
        for (const i of axles) {
          if (i === j) continue;
          const d = plus(gone[i][j], complex(1));
          increase(late, scaled(d, i < j ? 1 : -1), b[i]);
          if (i > j) increase(met, d, b[i]);
          else {
            const tau = over(i, j), mean = meanExponential(scaled(rate, tau), scaled(alpha, -tau));
            increase(forced, scaled(mean, tau), b[i]);
          }
        }
        increase(felt[j][mode], gain, met);
        increase(felt[j][mode], push, forced);
        increase(felt[j][mode], scaled(high, 0.5), late);
        first ??= met;
        if (!integrates) continue;
        if (bounded) {
          increase(heights[j], scaled(minus(high, low), 0.5), minus(quotient(met, away), forced));
          continue;
        }
        increase(heights[j], gain, minus(met, first));
        increase(heights[j], push, forced);
        const left = complex(0);
        for (const i of axles) increase(left, plus(gone[0][i], scaled(gone[i][j], Math.sign(j - i))), b[i]);
        increase(heights[j], scaled(low, 0.5), left);
      }
    });
    heights.forEach((height, j) => integrating[j].forEach((weight, k) => {
      const one = bounded ? height : quotient(scaled(height, -1), rate);
      cross[k][mode] = plus(cross[k][mode], scaled(one, weight));
    }));
  });
  const own = integrates ? ofHeights(taus, { level, terms }, integrating, bounded, faded) : null;
  return { felt, cross, own, faded };
}

// What an output that sees `seen` of the modes and `on` of the integrals gains by feeds[j] u(t - tau_j) passed straight
// on, where u has a finite variance.
function passedOn(dynamics, feeds, seen, on, { felt, faded }, { terms }, integrating, bounded) {
  let total = 0;
  feeds.forEach((feed, j) => {
    let beside = dynamics.real(seen, felt[j]);
    feeds.forEach((other, i) => {
      let velocities = 0, height = 0;
      terms.forEach(({ alpha, low, high }, at) => {
        const half = scaled(minus(low, high), 0.5), gone = faded[at][i][j], left = plus(gone, complex(1));
        velocities += product(product(half, alpha), left).re;
        height += product(half, bounded ? left : gone).re * Math.sign(i - j);
      });
      total += feed * other * velocities;
      beside += dot(on, integrating[i]) * height;
    });
    total += 2 * feed * beside;
  });
  return total;
}

// E[h h] of `stirred`.
function ofHeights(taus, { level, terms }, integrating, bounded, faded) {
  const own = zeros(integrating[0].length, integrating[0].length);
  taus.forEach((first, i) => taus.forEach((last, j) => {
    let shared = 0;
    if (bounded) {
      terms.forEach(({ alpha, low, high }, at) => {
        const left = plus(faded[at][i][j], complex(1));
        shared += quotient(product(scaled(minus(high, low), 0.5), left), alpha).re;
      });
    } else if (i !== j) {
      const tau = Math.abs(last - first);
      const wandered = terms.reduce((total, { alpha, low, high }) => {
        const kept = unforgotten(scaled(alpha, tau));
        return total + product(low, kept).re + product(high, minus(complex(1), kept)).re;
      }, level);
      shared = -0.5 * tau * wandered;
    }
    integrating[i].forEach((one, k) => integrating[j].forEach((other, l) => (own[k][l] += shared * one * other)));
  }));
  return own;
}
