// The exact covariance of a car on a road, in the structure of a second-order system: the algebra of
// susp_ss.responses.covariance.lyapunov and first_order, for one design.

// Of Taylor series over a short time h: fastest rate times h at most, and terms.
const REACH = 1, TERMS = 28;

// p' = v + ..., v' = -K p - C v + ..., K and C symmetric; vectors hold the positions before the velocities.
class Dynamics {
  constructor(K, C) {
    Object.assign(this, { K, C, n: K.length, inverse: inverted(K), over: new Map() });
    const damping = 0.5 * bound(C);
    this.fastest = damping + Math.sqrt(damping * damping + bound(K));
  }

  apply(x) {
    const { n, K, C } = this, out = new Float64Array(2 * n);
    for (let i = 0; i < n; i++) {
      let force = 0;
      for (let j = 0; j < n; j++) force += K[i][j] * x[j] + C[i][j] * x[n + j];
      out[i] = x[n + i];
      out[n + i] = -force;
    }
    return out;
  }

  // A^-1 x.
  solve(x) {
    const { n } = this, right = times(this.C, x.subarray(0, n)), out = new Float64Array(2 * n);
    add(right, x.subarray(n), 1);
    add(out.subarray(0, n), this.inverse(right), -1);
    out.set(x.subarray(0, n), n);
    return out;
  }

  // (alpha I - A)^-1 of complex columns.
  resolvent(alpha, x) {
    const { n, K, C } = this, { re, im } = alpha, square = product(alpha, alpha), m = x.columns;
    const A = complexMatrix(n, n), b = complexMatrix(n, m), out = complexMatrix(2 * n, m);
    for (let i = 0; i < n; i++) {
      for (let j = 0; j < n; j++) {
        A.re[i * n + j] = K[i][j] + re * C[i][j] + (i === j ? square.re : 0);
        A.im[i * n + j] = im * C[i][j] + (i === j ? square.im : 0);
      }
      for (let c = 0; c < m; c++) {
        const p = i * m + c, v = p + n * m;
        b.re[p] = x.re[v] + re * x.re[p] - im * x.im[p];
        b.im[p] = x.im[v] + re * x.im[p] + im * x.re[p];
        for (let j = 0; j < n; j++) {
          b.re[p] += C[i][j] * x.re[j * m + c];
          b.im[p] += C[i][j] * x.im[j * m + c];
        }
      }
    }
    solve(A, b);
    out.re.set(b.re);
    out.im.set(b.im);
    for (let p = 0; p < n * m; p++) {
      out.re[n * m + p] = re * b.re[p] - im * b.im[p] - x.re[p];
      out.im[n * m + p] = re * b.im[p] + im * b.re[p] - x.im[p];
    }
    return out;
  }

  // h^k A^k x, k = 0 ... TERMS - 1.
  powers(x, h) {
    const found = [x];
    while (found.length < TERMS) found.push(this.apply(found.at(-1)).map((one) => one * h));
    return found;
  }

  // The short time h, and e^(A h), e^(2 A h), ... up to e^(A tau).
  exponentials(tau) {
    if (!this.over.has(tau)) {
      const doublings = Math.max(0, Math.ceil(Math.log2((this.fastest * tau) / REACH))), h = tau / 2 ** doublings;
      const columns = zeros(2 * this.n, 2 * this.n).map((unit, i) => {
        const total = new Float64Array(unit.length);
        unit[i] = 1;
        this.powers(unit, h).reduce((factor, term, k) => (add(total, term, factor), factor / (k + 1)), 1);
        return total;
      });
      const found = [transpose(columns)];
      while (found.length <= doublings) found.push(multiply(found.at(-1), found.at(-1)));
      this.over.set(tau, { h, found });
    }
    return this.over.get(tau);
  }

  // int_0^tau e^(A (tau - s)) b e^(-alpha s) ds of each alpha, as complex columns of one row less.
  forced(b, tau, alphas) {
    const { h, found } = this.exponentials(tau), terms = this.powers(b, h);
    return alphas.map((alpha) => {
      const x = complexMatrix(b.length, 1);
      if (modulus(alpha) > 2 * this.fastest) {
        const gone = exponentialLess1(scaled(alpha, -tau));
        add(x.re, times(found.at(-1), b), -1);
        add(x.re, b, gone.re + 1);
        add(x.im, b, gone.im);
        return this.resolvent(scaled(alpha, -1), x);
      }
      // Of (h A)^k b, g_k = int_0^1 (1 - u)^k / k! e^(-z u) du, z = alpha h, where g_(k-1) = 1 / k! - z g_k.
      const z = scaled(alpha, -h);
      let g = complex(0), factorial = 1;
      for (let k = 2; k <= TERMS; k++) factorial *= k;
      for (let k = TERMS; k > 0; factorial /= k, k--) {
        g = plus(product(z, g), complex(1 / factorial));
        add(x.re, terms[k - 1], h * g.re);
        add(x.im, terms[k - 1], h * g.im);
      }
      for (let i = 0; i < found.length - 1; i++) {
        const gone = exponentialLess1(scaled(alpha, -h * 2 ** i)), left = gone.re + 1;
        const re = times(found[i], x.re), im = times(found[i], x.im);
        add(re, x.re, left), add(re, x.im, -gone.im);
        add(im, x.im, left), add(im, x.re, gone.im);
        Object.assign(x, { re, im });
      }
      return x;
    });
  }

  // The n^2 equations of `lyapunov` in Y = P + W, P symmetric and W skew, in a time unit that makes K of order one.
  equations() {
    if (this.solved) return this.solved;
    const n = this.n, unit = Math.sqrt(sum(this.K.map((row, i) => row[i])) / n);
    const K = this.K.map((row) => row.map((k) => k / unit ** 2)), C = this.C.map((row) => row.map((c) => c / unit));
    const equations = zeros(n * n, n * n), V = zeros(n, n), T = zeros(n, n);
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
    this.solved = { unit, K, C, inverse: inverted(equations) };
    return this.solved;
  }

  // Solve A X + X A^T + Q = 0: X = [[P, S], [S^T, V]] with S = W - Q_pp / 2 and V = P K + S C - Q_pv.
  lyapunov(Q) {
    const n = this.n, { unit, K, C, inverse } = this.equations(), X = zeros(2 * n, 2 * n);
    const of = (i, j, scale) => zeros(n, n).map((row, k) => row.map((_, l) => Q[i + k][j + l] / scale));
    const Qpp = of(0, 0, unit), Qpv = of(0, n, unit ** 2), Qvv = of(n, n, unit ** 3), right = new Float64Array(n * n);
    const V0 = multiply(Qpp, C).map((row, i) => row.map((one, j) => -0.5 * one - Qpv[i][j]));
    const CV = multiply(C, V0), KQ = multiply(K, Qpp), half = CV.map((row, i) => row.map((one, j) => one - 0.5 * KQ[i][j]));
    for (let i = 0; i < n; i++) {
      for (let j = 0; j < n; j++) right[i * n + j] = Qvv[i][j] - (V0[i][j] - V0[j][i] + half[i][j] + half[j][i]);
    }
    const y = inverse(right), P = zeros(n, n), S = zeros(n, n);
    for (let i = 0; i < n; i++) {
      for (let j = 0; j < n; j++) {
        P[i][j] = 0.5 * (y[i * n + j] + y[j * n + i]);
        S[i][j] = 0.5 * (y[i * n + j] - y[j * n + i] - Qpp[i][j]);
      }
    }
    const PK = multiply(P, K), SC = multiply(S, C), V = PK.map((row, i) => row.map((one, j) => one + SC[i][j] - Qpv[i][j]));
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

// What one process u of a spectrum adds to Q, met by entries[j] after the j-th of at most two axles; and of h' = sum
// rates[j] u(t - tau_j), which adds up to nothing over the axles, E[x h] and E[h^2]. With R = (alpha I - A)^-1, d what is
// left of a colour after the delay, and f what it forces over it: alpha R = I + R A and alpha f = e^(A tau) b - d b - A f,
// so that high-passes, though white at high frequency, need no white noise of their own that would cancel with theirs.
function stirred(dynamics, entries, tau, { level, terms }, rates) {
  const size = entries[0].length, nothing = new Float64Array(size), [front, rear = nothing] = entries;
  const axles = entries.length, behind = axles > 1, A = (x) => dynamics.apply(x);
  const free = behind ? times(dynamics.exponentials(tau).found.at(-1), front) : nothing;
  const both = rear.map((one, i) => one + free[i]), aFront = A(front), aRear = A(rear), aBoth = A(both);
  const forced = behind ? dynamics.forced(front, tau, terms.map(({ alpha }) => alpha)) : [];
  const felt = [front.map((one) => 0.5 * level * one), both.map((one, i) => level * (one - 0.5 * rear[i]))];
  const passed = front.map((one, i) => level * (free[i] - one));
  let wandered = level * tau;
  terms.forEach(({ alpha, low, high }, term) => {
    const gone = behind ? exponentialLess1(scaled(alpha, -tau)) : complex(-1), d = complex(gone.re + 1, gone.im);
    const slow = scaled(product(low, alpha), 0.5), fast = scaled(high, 0.5), x = complexMatrix(size, axles);
    const put = (at, own, its) => {
      x.re[at] = slow.re * own.re - slow.im * own.im - fast.re * its.re + fast.im * its.im;
      x.im[at] = slow.re * own.im + slow.im * own.re - fast.re * its.im - fast.im * its.re;
    };
    for (let i = 0; i < size; i++) {
      const late = { re: front[i] + d.re * rear[i], im: d.im * rear[i] };
      put(i * axles, late, { re: aFront[i] + d.re * aRear[i], im: d.im * aRear[i] });
      if (behind) put(i * axles + 1, { re: both[i], im: 0 }, { re: aBoth[i], im: 0 });
    }
    const r = dynamics.resolvent(alpha, x);
    if (!behind) {
      add(felt[0], r.re, 1);
      return;
    }
    const { re, im } = forced[term], aRe = A(re), aIm = A(im), late = product(fast, d).re;
    const step = product(scaled(low, 0.5), gone).re, kept = unforgotten(scaled(alpha, tau));
    for (let i = 0; i < size; i++) {
      const first = r.re[2 * i], second = r.re[2 * i + 1];
      const pushed = slow.re * re[i] - slow.im * im[i] + fast.re * aRe[i] - fast.im * aIm[i];
      felt[0][i] += first - late * rear[i];
      felt[1][i] += second + pushed + late * front[i];
      passed[i] += second - first + pushed + step * (front[i] + rear[i]);
    }
    wandered += tau * (product(low, kept).re + product(high, minus(complex(1), kept)).re);
  });
  const Q = zeros(size, size);
  entries.forEach((entry, j) => {
    for (let i = 0; i < size; i++) {
      for (let k = 0; k < size; k++) Q[i][k] += entry[i] * felt[j][k] + entry[k] * felt[j][i];
    }
  });
  if (!rates.some((rate) => rate !== 0)) return { Q, cross: nothing, own: 0 };
  return { Q, cross: dynamics.solve(passed).map((one) => -rates[1] * one), own: -rates[0] * rates[1] * wandered };
}
