// A car's motion by its modes, and its exact covariance on a road: for one design, the algebra of
// susp_ss.responses.covariance.modal, first_order and lyapunov.

// p' = v + ..., v' = -K p - C v + ..., K and C symmetric; vectors hold the positions before the velocities. Of A, the
// matrix of both, `rates` are the eigenvalues, the columns of V the eigenvectors, and W is the inverse of V.
class Dynamics {
  constructor(K, C) {
    const n = K.length, unit = Math.sqrt(sum(K.map((row, i) => row[i])) / n);
    Object.assign(this, { n, unit, K: divided(K, unit ** 2), C: divided(C, unit) });
    const A = zeros(2 * n, 2 * n);
    for (let i = 0; i < n; i++) {
      A[i][n + i] = 1;
      A[n + i].set(this.K[i].map((k) => -k));
      A[n + i].set(this.C[i].map((c) => -c), n);
    }
    const modes = eigenvalues(A).map((rate, at) => this.polished(rate, at));
    this.rates = modes.map(({ rate }) => scaled(rate, unit));
    this.V = zeros(2 * n, 0).map((_, i) =>
      modes.map(({ rate, shape }) => (i < n ? shape[i] : scaled(product(rate, shape[i - n]), unit))),
    );
    // Of conjugate modes the first counts twice, of real vectors under real forcing.
    const creeping = (rate) => Math.abs(rate.im) <= SPLIT * modulus(rate);
    this.counted = this.rates.map((rate) => (creeping(rate) ? 1 : rate.im > 0 ? 2 : 0));
    const identity = this.V.map((row, i) => row.map((_, j) => complex(i === j ? 1 : 0)));
    this.W = solve(this.V.map((row) => [...row]), identity);
  }

  // An eigenvalue and its vector by steps of Newton's: the rate is moved aside by a little, lest it be exact, and put
  // right by Rayleigh's quotient, whose error is the square of the vector's.
  polished(rate, at) {
    const { n, K, C } = this, aside = scaled(rate, 1 + 1e-9), square = product(aside, aside);
    const applied = (M, x) => x.map((_, i) => x.reduce((total, one, j) => plus(total, scaled(one, M[i][j])), complex(0)));
    const form = (x, y) => x.reduce((total, one, i) => plus(total, product(one, y[i])), complex(0));
    let shape = Array.from({ length: n }, (_, i) => complex(Math.cos(1 + i * (at + 1)), Math.sin(2 + i + at)));
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
    const off = plus(product(plus(product(m, rate), c), rate), k);
    return { rate: minus(rate, quotient(off, plus(scaled(product(m, rate), 2), c))), shape };
  }

  // A real vector as amplitudes of the modes.
  amplitudes(x) {
    return this.W.map((row) => row.reduce((total, one, i) => plus(total, scaled(one, x[i])), complex(0)));
  }

  // And back, the real part; all modes count once, or as said, and those that count nothing may be missing.
  vector(modes, counted = null) {
    const out = new Float64Array(2 * this.n);
    modes.forEach(({ re, im }, k) => {
      const times = counted ? counted[k] : 1;
      for (let i = 0; i < out.length; i++) out[i] += times * (this.V[i][k].re * re - this.V[i][k].im * im);
    });
    return out;
  }

  // The n^2 equations of `lyapunov` in Y = P + W, P symmetric and W skew.
  get equations() {
    if (this.inverse) return this.inverse;
    const { n, K, C } = this, equations = zeros(n * n, n * n), V = zeros(n, n), T = zeros(n, n);
    for (let i = 0; i < n; i++) {
      for (let j = 0; j < n; j++) {
        // Where Y is one in row i, column j alone: V = P K + W C, of which half is to be zero, and T = K W + C V.
        for (const M of [V, T]) M.forEach((row) => row.fill(0));
        for (let k = 0; k < n; k++) {
          V[i][k] += 0.5 * (K[j][k] + C[j][k]);
          V[j][k] += 0.5 * (K[i][k] - C[i][k]);
        }
        for (let k = 0; k < n; k++) {
          T[k][j] += 0.5 * K[k][i];
          T[k][i] -= 0.5 * K[k][j];
          add(T[k], V[i], C[k][i]);
          if (i !== j) add(T[k], V[j], C[k][j]);
        }
        for (let k = 0; k < n; k++) {
          for (let l = 0; l < n; l++) equations[k * n + l][i * n + j] = V[k][l] - V[l][k] + T[k][l] + T[l][k];
        }
      }
    }
    return (this.inverse = inverted(equations));
  }

  // Solve A X + X A^T + Q = 0: X = [[P, S], [S^T, V]] with S = W - Q_pp / 2 and V = P K + S C - Q_pv.
  lyapunov(Q) {
    const { n, unit, K, C } = this, X = zeros(2 * n, 2 * n), right = new Float64Array(n * n);
    const part = (i, j, scale) => divided(Q.slice(i, i + n).map((row) => row.subarray(j, j + n)), scale);
    const Qpp = part(0, 0, unit), Qpv = part(0, n, unit ** 2), Qvv = part(n, n, unit ** 3);
    const V0 = multiply(Qpp, C).map((row, i) => row.map((one, j) => -0.5 * one - Qpv[i][j]));
    const CV = multiply(C, V0), KQ = multiply(K, Qpp);
    for (let i = 0; i < n; i++) {
      for (let j = 0; j < n; j++) {
        const half = CV[i][j] + CV[j][i] - 0.5 * (KQ[i][j] + KQ[j][i]);
        right[i * n + j] = Qvv[i][j] - (V0[i][j] - V0[j][i] + half);
      }
    }
    const y = this.equations(right), P = zeros(n, n), S = zeros(n, n);
    for (let i = 0; i < n; i++) {
      for (let j = 0; j < n; j++) {
        P[i][j] = 0.5 * (y[i * n + j] + y[j * n + i]);
        S[i][j] = 0.5 * (y[i * n + j] - y[j * n + i] - Qpp[i][j]);
      }
    }
    const PK = multiply(P, K), SC = multiply(S, C);
    const V = PK.map((row, i) => row.map((one, j) => one + SC[i][j] - Qpv[i][j]));
    for (let i = 0; i < n; i++) {
      for (let j = 0; j < n; j++) {
        X[i][j] = P[i][j];
        X[i][n + j] = X[n + j][i] = S[i][j] * unit;
        X[n + i][n + j] = 0.5 * (V[i][j] + V[j][i]) * unit ** 2;
      }
    }
    return X;
  }
}

const divided = (A, by) => A.map((row) => row.map((one) => one / by));

// What one process u of a spectrum adds to Q, met by entries[j] after the j-th of at most two axles; and of h' = sum
// rates[j] u(t - tau_j), which adds up to nothing over the axles, E[x h] and E[h^2].
//
// With R = (alpha I - A)^-1, d = e^(-alpha tau) and f what a fading colour forces over the delay, alpha R = I + R A and
// alpha f = e^(A tau) b - d b - A f: high-passes, though white at high frequency, then need no white noise of their own,
// with which they would cancel.
function stirred(dynamics, entries, tau, { level, terms }, integrating) {
  const axles = entries.length, behind = axles > 1, amplitudes = entries.map((entry) => dynamics.amplitudes(entry));
  const counted = terms.every(({ alpha }) => alpha.im === 0) ? dynamics.counted : null;
  const lefts = terms.map(({ alpha }) => (behind ? exponentialLess1(scaled(alpha, -tau)) : complex(-1)));
  const felt = [[], []], passed = [];
  dynamics.rates.forEach((rate, mode) => {
    if (counted && !counted[mode]) return;
    const front = amplitudes[0][mode], rear = behind ? amplitudes[1][mode] : complex(0);
    const over = scaled(rate, tau), free = behind ? product(exponential(over), front) : complex(0), both = plus(rear, free);
    let first = scaled(front, 0.5 * level), second = scaled(minus(both, scaled(rear, 0.5)), level);
    let drifting = scaled(minus(free, front), level);
    for (let i = 0; i < terms.length; i++) {
      const { alpha, low, high } = terms[i], gone = lefts[i], d = plus(gone, complex(1));
      const slow = scaled(product(low, alpha), 0.5), fast = scaled(product(high, rate), 0.5), late = product(scaled(high, 0.5), d);
      const gain = quotient(minus(slow, fast), minus(alpha, rate));
      const one = product(gain, plus(front, product(d, rear)));
      first = plus(first, minus(one, product(late, rear)));
      if (!behind) continue;
      const other = product(gain, both), f = scaled(product(meanExponential(over, scaled(alpha, -tau)), front), tau);
      const pushed = product(plus(slow, fast), f);
      second = plus(second, plus(other, plus(pushed, product(late, front))));
      const step = product(scaled(product(low, gone), 0.5), plus(front, rear));
      drifting = plus(drifting, plus(minus(other, one), plus(pushed, step)));
    }
    [felt[0][mode], felt[1][mode], passed[mode]] = [first, second, quotient(drifting, rate)];
  });
  const Q = zeros(entries[0].length, entries[0].length);
  entries.forEach((entry, j) => {
    const with_u = dynamics.vector(felt[j], counted);
    Q.forEach((row, i) => {
      add(row, with_u, entry[i]);
      add(row, entry, with_u[i]);
    });
  });
  if (!integrating.some((rate) => rate !== 0)) return { Q, cross: null, own: 0 };
  const [ahead, back] = integrating, cross = dynamics.vector(passed, counted).map((one) => -back * one);
  const wandered = terms.reduce((total, { alpha, low, high }) => {
    const kept = unforgotten(scaled(alpha, tau));
    return total + product(low, kept).re + product(high, minus(complex(1), kept)).re;
  }, level);
  return { Q, cross, own: -ahead * back * tau * wandered };
}
