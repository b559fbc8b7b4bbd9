// Dense linear algebra of small matrices, arrays of rows. A complex number is { re, im }.

const zeros = (rows, columns) => Array.from({ length: rows }, () => new Float64Array(columns));
const sum = (x) => x.reduce((total, one) => total + one, 0);
const transpose = (A) => Array.from(A[0], (_, j) => Float64Array.from(A, (row) => row[j]));

function dot(x, y) {
  let total = 0;
  for (let i = 0; i < x.length; i++) total += x[i] * y[i];
  return total;
}

function times(A, x) {
  const out = new Float64Array(A.length);
  for (let i = 0; i < A.length; i++) out[i] = dot(A[i], x);
  return out;
}

// to += factor * x.
function add(to, x, factor) {
  for (let i = 0; i < to.length; i++) to[i] += factor * x[i];
}

function multiply(A, B) {
  const out = zeros(A.length, B[0].length);
  for (let i = 0; i < A.length; i++) {
    for (let k = 0; k < B.length; k++) if (A[i][k] !== 0) add(out[i], B[k], A[i][k]);
  }
  return out;
}

// Largest sum of moduli of a row, which bounds the eigenvalues.
const bound = (A) => Math.max(...A.map((row) => sum(row.map(Math.abs))));

// A^-1 b by elimination with row pivots, as a function of b, with one step of refinement.
function inverted(A) {
  const n = A.length, LU = A.map((row) => Float64Array.from(row)), order = LU.map((_, i) => i);
  for (let k = 0; k < n; k++) {
    let pivot = k;
    for (let i = k + 1; i < n; i++) if (Math.abs(LU[i][k]) > Math.abs(LU[pivot][k])) pivot = i;
    [LU[k], LU[pivot]] = [LU[pivot], LU[k]];
    [order[k], order[pivot]] = [order[pivot], order[k]];
    const top = LU[k];
    for (let i = k + 1; i < n; i++) {
      const row = LU[i], factor = (row[k] /= top[k]);
      if (factor !== 0) for (let j = k + 1; j < n; j++) row[j] -= factor * top[j];
    }
  }
  const once = (b) => {
    const x = new Float64Array(n);
    for (let i = 0; i < n; i++) {
      let rest = b[order[i]];
      for (let j = 0; j < i; j++) rest -= LU[i][j] * x[j];
      x[i] = rest;
    }
    for (let i = n - 1; i >= 0; i--) {
      let rest = x[i];
      for (let j = i + 1; j < n; j++) rest -= LU[i][j] * x[j];
      x[i] = rest / LU[i][i];
    }
    return x;
  };
  return (b) => {
    const x = once(b), rest = times(A, x);
    for (let i = 0; i < n; i++) rest[i] = b[i] - rest[i];
    add(x, once(rest), 1);
    return x;
  };
}

const complex = (re, im = 0) => ({ re, im });
const plus = (a, b) => complex(a.re + b.re, a.im + b.im);
const minus = (a, b) => complex(a.re - b.re, a.im - b.im);
const product = (a, b) => complex(a.re * b.re - a.im * b.im, a.re * b.im + a.im * b.re);
const scaled = (a, factor) => complex(a.re * factor, a.im * factor);
const conjugate = (a) => complex(a.re, -a.im);
const modulus = (a) => Math.hypot(a.re, a.im);

function quotient(a, b) {
  const size = b.re * b.re + b.im * b.im;
  return complex((a.re * b.re + a.im * b.im) / size, (a.im * b.re - a.re * b.im) / size);
}

// e^a - 1, without loss where a is small.
function exponentialLess1(a) {
  const half = Math.sin(0.5 * a.im), grown = Math.expm1(a.re);
  return complex(grown * Math.cos(a.im) - 2 * half * half, (grown + 1) * Math.sin(a.im));
}

// 1 - (1 - e^-z) / z, without loss where z is small.
function unforgotten(z) {
  if (modulus(z) > 0.5) return plus(complex(1), quotient(exponentialLess1(scaled(z, -1)), z));
  let total = complex(0);
  for (let k = 16; k > 0; k--) total = product(quotient(z, complex(k + 1)), minus(complex(1), total));
  return total;
}

// Complex rows, columns by columns, one after another.
const complexMatrix = (rows, columns) => ({
  rows, columns, re: new Float64Array(rows * columns), im: new Float64Array(rows * columns),
});

// Solve A X = B of complex matrices, by elimination with row pivots, in place: B becomes X.
function solve(A, B) {
  const n = A.rows, m = B.columns, { re: a, im: b } = A, { re: x, im: y } = B;
  const swap = (v, i, j, width) => {
    for (let k = 0; k < width; k++) [v[i * width + k], v[j * width + k]] = [v[j * width + k], v[i * width + k]];
  };
  // Row i of v + j w less a complex factor times its row k.
  const less = (v, w, i, k, width, first, re, im) => {
    for (let j = first, to = i * width + first, from = k * width + first; j < width; j++, to++, from++) {
      v[to] -= re * v[from] - im * w[from];
      w[to] -= re * w[from] + im * v[from];
    }
  };
  for (let k = 0; k < n; k++) {
    let pivot = k, most = -1;
    for (let i = k; i < n; i++) {
      const size = Math.abs(a[i * n + k]) + Math.abs(b[i * n + k]);
      if (size > most) [pivot, most] = [i, size];
    }
    if (pivot !== k) {
      for (const v of [a, b]) swap(v, k, pivot, n);
      for (const v of [x, y]) swap(v, k, pivot, m);
    }
    const re = a[k * n + k], im = b[k * n + k], size = re * re + im * im;
    for (let i = k + 1; i < n; i++) {
      const p = a[i * n + k], q = b[i * n + k];
      if (p === 0 && q === 0) continue;
      const u = (p * re + q * im) / size, v = (q * re - p * im) / size;
      less(a, b, i, k, n, k + 1, u, v);
      less(x, y, i, k, m, 0, u, v);
    }
  }
  for (let k = n - 1; k >= 0; k--) {
    const re = a[k * n + k], im = b[k * n + k], size = re * re + im * im;
    for (let j = k * m; j < k * m + m; j++) {
      [x[j], y[j]] = [(x[j] * re + y[j] * im) / size, (y[j] * re - x[j] * im) / size];
    }
    for (let i = 0; i < k; i++) less(x, y, i, k, m, 0, a[i * n + k], b[i * n + k]);
  }
  return B;
}
