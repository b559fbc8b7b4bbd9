// A car's motion by its modes, and its exact covariance on a road: for one design, the algebra of
// susp_ss.responses.covariance.modal and first_order.

// p' = v + ..., v' = -K p - C v + ..., K and C symmetric; vectors hold the positions before the velocities, `shapes` are
// those of the positions.
class Dynamics extends Modes {
  // Of K and C in which some `pairs` of positions may be alike, those of left and right.
  static of(K, C, pairs) {
    const Q = identity(K.length);
    for (const [i, j] of pairs) [Q[i][i], Q[i][j], Q[j][i], Q[j][j]] = [1, 1, 1, -1].map((one) => one * Math.SQRT1_2);
    const turned = [K, C].map((M) => multiply(Q, multiply(M, Q)));
    const met = (M, i, j) => Math.abs(M[i][j]) > ROUNDING * Math.sqrt(Math.abs(M[i][i] * M[j][j]));
    const parts = coupled(Q.map((row, i) => row.map((_, j) => Number(turned.some((M) => met(M, i, j))))));
    if (parts.length === 1) return Dynamics.sound(K, C);
    return new Apart(parts.map((rows) => {
      const own = Dynamics.sound(...turned.map((M) => rows.map((i) => Float64Array.from(rows, (j) => M[i][j]))));
      return { own, on: Q.map((row) => rows.map((i) => row[i])) };
    }));
  }

  static sound(K, C) {
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
      for (let j = 0; j < n; j++) [A[n + i][j], A[n + i][n + j]] = [-this.K[i][j], -this.C[i][j]];
    }
    const found = triangularised(A).rates.filter((rate) => creeping(rate) || rate.im > 0);
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

// Motions that know nothing of one another, as those of a car's two halves, each `on` the positions by a matrix.
class Apart extends Modes {
  constructor(parts) {
    const onAll = (on, x) => on.map((row) => applied(row, x));
    const bothOnAll = (on, x) => [x.slice(0, x.length / 2), x.slice(x.length / 2)].flatMap((one) => onAll(on, one));
    super(parts.flatMap(({ own }) => own.rates), parts.flatMap(({ own, on }) => own.W.map((row) => bothOnAll(on, row))));
    this.shapes = parts.flatMap(({ own, on }) => own.shapes.map((shape) => onAll(on, shape)));
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
function stirred({ rates }, entries, taus, spectrum, integrating, bounded) {
  const axles = [...entries.keys()], many = integrating[0].length, { level, terms } = spectrum;
  const pairs = axles.flatMap((j) => axles.slice(0, j).map((i) => ({ i, j, tau: taus[j] - taus[i] })));
  for (const pair of pairs) {
    pair.gone = terms.map(({ alpha }) => exponentialLess1(scaled(alpha, -pair.tau)));
    pair.late = complex(0);
    pair.slow = complex(0);
    terms.forEach(({ low, high }, at) => {
      increase(pair.late, scaled(high, 0.5), plus(pair.gone[at], complex(1)));
      increase(pair.slow, scaled(low, 0.5), pair.gone[at]);
    });
  }
  const integrates = integrating.some((row) => row.some((rate) => rate !== 0));
  const felt = axles.map(() => rates.map(() => complex(0)));
  const cross = Array.from({ length: many }, () => rates.map(() => complex(0)));
  rates.forEach((rate, mode) => {
    const b = entries.map((entry) => entry[mode]);
    if (b.every(({ re, im }) => re === 0 && im === 0)) return;
    const { gain, apart } = met(rate, terms, pairs), heights = axles.map(() => complex(0));
    // An axle that meets the process now.
    axles.forEach((j) => {
      increase(felt[j][mode], plus(gain, complex(0.5 * level)), b[j]);
      if (bounded) increase(heights[j], apart, b[j]);
    });
    // By what the one ahead has met before, and by what the one behind will meet.
    for (const { i, j, less, gains, pushed, late, aparts, forced } of pairs) {
      const free = plus(less, complex(1));
      increase(felt[j][mode], plus(product(plus(gain, complex(level)), free), plus(pushed, late)), b[i]);
      increase(felt[i][mode], minus(plus(gain, gains), late), b[j]);
      if (bounded) {
        increase(heights[j], minus(product(apart, free), forced), b[i]);
        increase(heights[i], plus(apart, aparts), b[j]);
      } else if (integrates) {
        increase(heights[j], plus(product(plus(gain, complex(level)), less), pushed), b[i]);
        increase(heights[i], gains, b[j]);
      }
    }
    if (!integrates) return;
    if (!bounded) drifted(heights, b, pairs);
    heights.forEach((height, j) => integrating[j].forEach((weight, k) => {
      increase(cross[k][mode], bounded ? complex(weight) : quotient(complex(-weight), rate), height);
    }));
  });
  return { felt, cross, own: integrates ? ofHeights(taus, spectrum, integrating, bounded) : null };
}

// How a mode answers to all terms at once, `gain`, and to their heights, `apart`; the same as each fades over a pair of
// axles less that, `gains` and `aparts`, what is forced meanwhile, `pushed` and `forced`, and e^(rate tau) - 1, `less`.
function met(rate, terms, pairs) {
  const gain = complex(0), apart = complex(0);
  for (const pair of pairs) {
    const over = scaled(rate, pair.tau), less = exponentialLess1(over);
    Object.assign(pair, { over, less, gains: complex(0), aparts: complex(0), pushed: complex(0), forced: complex(0) });
  }
  terms.forEach(({ alpha, low, high }, at) => {
    const away = minus(alpha, rate), slow = scaled(product(low, alpha), 0.5), fast = scaled(product(high, rate), 0.5);
    const weight = scaled(minus(high, low), 0.5), one = quotient(minus(slow, fast), away), part = quotient(weight, away);
    gain.re += one.re;
    gain.im += one.im;
    apart.re += part.re;
    apart.im += part.im;
    const push = plus(slow, fast);
    for (const pair of pairs) {
      const { tau, over, less, gone } = pair;
      // (e^over - e^(-alpha tau)) / (over + alpha tau), where these are apart.
      const sum = plus(rate, alpha), size = power(sum) * tau * tau;
      const mean = size > 0.25 ? quotient(minus(less, gone[at]), sum)
        : scaled(meanExponential(over, scaled(alpha, -tau)), tau);
      increase(pair.gains, one, gone[at]);
      increase(pair.aparts, part, gone[at]);
      increase(pair.pushed, push, mean);
      increase(pair.forced, weight, mean);
    }
  });
  return { gain, apart };
}

// Heights of later axles less that of the first, of heights that drift: less what the first has met, and what is left of
// slow terms.
function drifted(heights, b, pairs) {
  const first = heights[0], left = (i, j) => pairs.find((pair) => pair.i === Math.min(i, j) && pair.j === Math.max(i, j));
  heights.forEach((height, j) => {
    if (!j) return;
    heights[j] = minus(height, first);
    b.forEach((entry, i) => {
      const before = i ? left(0, i).slow : complex(0), between = i === j ? complex(0) : left(i, j).slow;
      increase(heights[j], plus(before, scaled(between, Math.sign(j - i))), entry);
    });
  });
  heights[0] = complex(0);
}

// E[h h] of `stirred`.
function ofHeights(taus, { level, terms }, integrating, bounded) {
  const own = zeros(integrating[0].length, integrating[0].length);
  taus.forEach((first, i) => taus.forEach((last, j) => {
    const tau = Math.abs(last - first);
    let shared = 0;
    if (bounded) {
      for (const { alpha, low, high } of terms) {
        shared += quotient(product(scaled(minus(high, low), 0.5), exponential(scaled(alpha, -tau))), alpha).re;
      }
    } else if (i !== j) {
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

// What an output that sees `seen` of the modes and `on` of the integrals gains by feeds[j] u(t - tau_j) passed straight
// on, where u has a finite variance.
function passedOn(dynamics, feeds, seen, on, { felt }, taus, { terms }, integrating, bounded) {
  let total = 0;
  feeds.forEach((feed, j) => {
    let beside = dynamics.real(seen, felt[j]);
    feeds.forEach((other, i) => {
      let velocities = 0, height = 0;
      terms.forEach(({ alpha, low, high }) => {
        const half = scaled(minus(low, high), 0.5), gone = exponentialLess1(scaled(alpha, -Math.abs(taus[j] - taus[i])));
        const left = plus(gone, complex(1));
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
