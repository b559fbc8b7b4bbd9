// The exact covariance of a car's modes on a road: for one design, the algebra of susp_ss.responses.covariance.modal and
// first_order.

// One process u of a road, as it passes under a car's axles, taus[j] after the first: its spectrum, and how each axle
// moves the integrals h' = sum integrating[j] u(t - tau_j); unless the height of the process is `bounded`, these add up
// to nothing over the axles.
//
// With R = (alpha I - A)^-1, d = e^(-alpha tau) and f what a fading colour forces over the delay, alpha R = I + R A and
// alpha f = e^(A tau) b - d b - A f. High-passes, though white at high frequency, then need no white noise of their own,
// with which they would cancel.
class Passing {
  constructor(process, { level, terms }, taus, { rates: integrating, drift }) {
    const axles = [...integrating.keys()], bounded = drift.some((rate) => rate !== 0);
    Object.assign(this, { process, level, terms, taus, integrating, axles, bounded });
    this.integrates = integrating.some((row) => row.some((rate) => rate !== 0));
    this.colours = terms.map(({ alpha, low, high }) => ({
      alpha,
      slow: scaled(product(low, alpha), 0.5),
      fast: scaled(high, 0.5),
      weight: scaled(minus(high, low), 0.5),
    }));
    this.pairs = axles.flatMap((j) => axles.slice(0, j).map((i) => {
      const tau = taus[j] - taus[i], gone = terms.map(({ alpha }) => exponentialLess1(scaled(alpha, -tau)));
      const late = complex(0), slow = complex(0);
      terms.forEach(({ low, high }, at) => {
        increase(late, scaled(high, 0.5), plus(gone[at], complex(1)));
        increase(slow, scaled(low, 0.5), gone[at]);
      });
      return { i, j, tau, gone, late, slow };
    }));
    // E[h h].
    this.own = this.integrates ? ofHeights(this) : null;
  }

  // What it stirs up in modes that it moves by entries[j] at the j-th axle: felt[j] is E[x u(t - tau_j)] by modes, of
  // white noise half of it where an axle meets itself, and `cross` E[x h].
  stirred(rates, entries) {
    const { axles, pairs, level, integrating, integrates, bounded } = this;
    const felt = axles.map(() => rates.map(() => complex(0)));
    const cross = integrating[0].map(() => rates.map(() => complex(0)));
    rates.forEach((rate, mode) => {
      const b = entries.map((entry) => entry[mode]);
      if (b.every(({ re, im }) => re === 0 && im === 0)) return;
      const { gain, apart } = this.met(rate), heights = axles.map(() => complex(0)), whole = plus(gain, complex(level));
      // An axle that meets the process now.
      for (const j of axles) {
        increase(felt[j][mode], plus(gain, complex(0.5 * level)), b[j]);
        if (bounded) increase(heights[j], apart, b[j]);
      }
      // By what the one ahead has met before, and by what the one behind will meet.
      for (const pair of pairs) {
        const { i, j, late } = pair, { less, gains, aparts, pushed, forced } = this.faded(rate, pair);
        const free = plus(less, complex(1));
        increase(felt[j][mode], plus(product(whole, free), plus(pushed, late)), b[i]);
        increase(felt[i][mode], minus(plus(gain, gains), late), b[j]);
        if (bounded) {
          increase(heights[j], minus(product(apart, free), forced), b[i]);
          increase(heights[i], plus(apart, aparts), b[j]);
        } else if (integrates) {
          increase(heights[j], plus(product(whole, less), pushed), b[i]);
          increase(heights[i], gains, b[j]);
        }
      }
      if (!integrates) return;
      if (!bounded) drifted(heights, b, pairs);
      heights.forEach((height, j) => integrating[j].forEach((weight, k) => {
        increase(cross[k][mode], bounded ? complex(weight) : quotient(complex(-weight), rate), height);
      }));
    });
    return { felt, cross };
  }

  // How a mode answers to all colours at once, `gain`, and to their heights, `apart`.
  met(rate) {
    const gain = complex(0), apart = complex(0);
    for (const { alpha, slow, fast, weight } of this.colours) {
      const away = quotient(complex(1), minus(alpha, rate));
      increase(gain, minus(slow, product(fast, rate)), away);
      increase(apart, weight, away);
    }
    return { gain, apart };
  }

  // The same as each fades over a pair of axles less that, `gains` and `aparts`, what is forced meanwhile, `pushed` and
  // `forced`, and e^(rate tau) - 1, `less`.
  faded(rate, { tau, gone }) {
    const over = scaled(rate, tau), less = exponentialLess1(over);
    const gains = complex(0), aparts = complex(0), pushed = complex(0), forced = complex(0);
    this.colours.forEach(({ alpha, slow, fast, weight }, at) => {
      const away = quotient(complex(1), minus(alpha, rate)), pull = product(fast, rate);
      // (e^over - e^(-alpha tau)) / (over + alpha tau), where these are apart.
      const sum = plus(rate, alpha), mean = power(sum) * tau * tau > 0.25 ? quotient(minus(less, gone[at]), sum)
        : scaled(meanExponential(over, scaled(alpha, -tau)), tau);
      const fading = product(gone[at], away);
      increase(gains, minus(slow, pull), fading);
      increase(aparts, weight, fading);
      increase(pushed, plus(slow, pull), mean);
      increase(forced, weight, mean);
    });
    return { less, gains, aparts, pushed, forced };
  }

  // What an output that sees `seen` of the modes and `on` of the integrals gains by feeds[j] u(t - tau_j) passed straight
  // on, where u has a finite variance.
  passedOn(dynamics, feeds, seen, on, felt) {
    const { taus, terms, integrating, bounded } = this;
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
}

// Covariances of the real parts of modes' amplitudes, of their imaginary parts and of the integrals, in this order.
class Moments {
  constructor(rates, integrals) {
    const n = rates.length, size = 2 * n + integrals;
    Object.assign(this, { rates, n, moved: zeros(2 * n, 2 * n), R: zeros(size, size) });
  }

  // What a passing has stirred up adds to them.
  add({ integrates, own }, entries, { felt, cross }) {
    const { n, moved, R } = this;
    entries.forEach((entry, j) => {
      const b = partsOf(entry), u = partsOf(felt[j]);
      for (let k = 0; k < 2 * n; k++) {
        if (b[k] === 0 && u[k] === 0) continue;
        const row = moved[k];
        for (let l = 0; l < 2 * n; l++) row[l] += b[k] * u[l] + u[k] * b[l];
      }
    });
    if (!integrates) return;
    cross.map(partsOf).forEach((row, k) => row.forEach((one, at) => (R[at][2 * n + k] = R[2 * n + k][at] += one)));
    own.forEach((row, k) => row.forEach((one, l) => (R[2 * n + k][2 * n + l] += one)));
  }

  // All of them, by Lyapunov's equation for each two modes, of the second as it is and of its conjugate.
  settled() {
    const { n, rates, moved, R } = this;
    const put = (k, l, value) => (R[k][l] = R[l][k] = 0.5 * value);
    for (let k = 0; k < n; k++) {
      for (let l = 0; l <= k; l++) {
        const a = moved[k][l], b = moved[n + k][n + l], c = moved[k][n + l], d = moved[n + k][l];
        if (a === 0 && b === 0 && c === 0 && d === 0) continue;
        const same = quotient(complex(b - a, -c - d), plus(rates[k], rates[l]));
        const other = quotient(complex(-a - b, c - d), plus(rates[k], conjugate(rates[l])));
        put(k, l, same.re + other.re);
        put(n + k, n + l, other.re - same.re);
        put(k, n + l, same.im - other.im);
        put(n + k, l, same.im + other.im);
      }
    }
    return R;
  }
}

function partsOf(x) {
  const found = [];
  for (const { re } of x) found.push(re);
  for (const { im } of x) found.push(im);
  return found;
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

// E[h h] of a passing.
function ofHeights({ taus, level, terms, integrating, bounded }) {
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
