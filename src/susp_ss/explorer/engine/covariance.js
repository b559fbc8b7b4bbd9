// A car's motion by its modes, and its exact covariance on a road: for one design, the algebra of
// susp_ss.responses.covariance.modal and first_order.

// Of the size of its terms, what a sum that cancels leaves.
const ROUNDING = 1e-13;

// Modes of a condition above this are too nearly one to keep digits; dampers then count as other by a ten-millionth.
const PARALLEL = 1e4, ASIDE = 1e-7;

// p' = v + ..., v' = -K p - C v + ..., K and C symmetric; vectors hold the positions before the velocities. Modes are
// those that creep and one of each pair that swings, with their eigenvalues `rates` and `shapes` of the positions; `W`
// takes vectors to their amplitudes. Real vectors are made of them and, for the `swinging`, of their conjugates.
class Dynamics {
  static of(K, C) {
    const own = new Dynamics(K, C);
    return own.condition < PARALLEL ? own : new Dynamics(K, divided(C, 1 - ASIDE));
  }

  constructor(K, C) {
    const n = K.length, unit = Math.sqrt(sum(K.map((row, i) => row[i])) / n);
    Object.assign(this, { n, K: divided(K, unit ** 2), C: divided(C, unit) });
    const A = zeros(2 * n, 2 * n);
    for (let i = 0; i < n; i++) {
      A[i][n + i] = 1;
      A[n + i].set(this.K[i].map((k) => -k));
      A[n + i].set(this.C[i].map((c) => -c), n);
    }
    const creeping = (rate) => Math.abs(rate.im) <= SPLIT * modulus(rate);
    const found = eigenvalues(A).filter((rate) => creeping(rate) || rate.im > 0);
    const modes = found.map((rate, at) => this.polished(rate, at));
    this.rates = modes.map(({ rate }) => scaled(rate, unit));
    this.shapes = modes.map(({ shape }) => shape);
    this.swinging = modes.flatMap(({ rate }, k) => (creeping(rate) ? [] : [k]));
    this.counted = modes.map(({ rate }) => (creeping(rate) ? 1 : 2));
    const all = this.whole(this.rates), V = A.map((_, i) => this.whole(this.shapes.map((shape) => shape[i % n]))
      .map((one, k) => (i < n ? one : product(all[k], one))));
    const sizes = this.rates.map((_, k) => sum(V.map((row, i) => (i < n ? unit : 1) * modulus(row[k]))));
    this.W = solve(V, V.map((row, i) => row.map((_, j) => complex(i === j ? 1 : 0)))).slice(0, modes.length);
    const seen = this.W.map((row) => sum(row.map((one, i) => modulus(one) / (i < n ? unit : 1))));
    this.condition = Math.max(...seen.map((one, k) => one * sizes[k])) / (2 * n);
  }

  // What is known of each mode, and of the conjugates.
  whole(x) {
    return [...x, ...this.swinging.map((k) => conjugate(x[k]))];
  }

  // The real number that amplitudes of the modes, seen so, come to.
  real(seen, amplitudes) {
    let total = 0;
    for (let k = 0; k < seen.length; k++) {
      total += this.counted[k] * (seen[k].re * amplitudes[k].re - seen[k].im * amplitudes[k].im);
    }
    return total;
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

  // Amplitudes of the modes in a real vector; where they cancel by symmetry, none.
  amplitudes(x) {
    return this.W.map((row) => {
      const terms = row.map((one, i) => scaled(one, x[i])), total = terms.reduce(plus);
      return modulus(total) > ROUNDING * sum(terms.map(modulus)) ? total : complex(0);
    });
  }
}

const divided = (A, by) => A.map((row) => row.map((one) => one / by));

// What one process u of a spectrum stirs up, which moves modes by entries[j] at the j-th of at most two axles: felt[j],
// E[x u(t - tau_j)] by modes, half of it where an axle meets itself. Of h' = sum integrating[j] u(t - tau_j), which adds
// up to nothing over the axles, E[x h] by modes and E[h^2].
//
// With R = (alpha I - A)^-1, d = e^(-alpha tau) and f what a fading colour forces over the delay, alpha R = I + R A and
// alpha f = e^(A tau) b - d b - A f. High-passes, though white at high frequency, then need no white noise of their own,
// with which they would cancel.
function stirred({ rates }, entries, tau, { level, terms }, integrating) {
  const behind = entries.length > 1;
  const lefts = terms.map(({ alpha }) => (behind ? exponentialLess1(scaled(alpha, -tau)) : complex(-1)));
  const found = rates.map((rate, mode) => {
    const front = entries[0][mode], rear = behind ? entries[1][mode] : complex(0), over = scaled(rate, tau);
    const free = behind ? product(exponential(over), front) : complex(0), both = plus(rear, free);
    let first = scaled(front, 0.5 * level), second = scaled(minus(both, scaled(rear, 0.5)), level);
    let drifting = scaled(minus(free, front), level);
    for (let i = 0; i < terms.length; i++) {
      const { alpha, low, high } = terms[i], gone = lefts[i], d = plus(gone, complex(1));
      const slow = scaled(product(low, alpha), 0.5), fast = scaled(product(high, rate), 0.5);
      const late = product(scaled(high, 0.5), d), gain = quotient(minus(slow, fast), minus(alpha, rate));
      const one = product(gain, plus(front, product(d, rear)));
      first = plus(first, minus(one, product(late, rear)));
      if (!behind) continue;
      const other = product(gain, both), f = scaled(product(meanExponential(over, scaled(alpha, -tau)), front), tau);
      const pushed = product(plus(slow, fast), f);
      second = plus(second, plus(other, plus(pushed, product(late, front))));
      const step = product(scaled(product(low, gone), 0.5), plus(front, rear));
      drifting = plus(drifting, plus(minus(other, one), plus(pushed, step)));
    }
    return { first, second, drifting };
  });
  const felt = [found.map(({ first }) => first), found.map(({ second }) => second)].slice(0, entries.length);
  if (!integrating.some((rate) => rate !== 0)) return { felt, cross: null, own: 0 };
  const [ahead, back] = integrating;
  const cross = found.map(({ drifting }, mode) => scaled(quotient(drifting, rates[mode]), -back));
  const wandered = terms.reduce((total, { alpha, low, high }) => {
    const kept = unforgotten(scaled(alpha, tau));
    return total + product(low, kept).re + product(high, minus(complex(1), kept)).re;
  }, level);
  return { felt, cross, own: -ahead * back * tau * wandered };
}
