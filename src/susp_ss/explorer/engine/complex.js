// Complex numbers { re, im }, and matrices of them, arrays of rows.

const complex = (re, im = 0) => ({ re, im });
const plus = (a, b) => complex(a.re + b.re, a.im + b.im);
const minus = (a, b) => complex(a.re - b.re, a.im - b.im);
const product = (a, b) => complex(a.re * b.re - a.im * b.im, a.re * b.im + a.im * b.re);
const scaled = (a, factor) => complex(a.re * factor, a.im * factor);
const conjugate = (a) => complex(a.re, -a.im);
const modulus = (a) => Math.sqrt(a.re * a.re + a.im * a.im);
const power = (a) => a.re * a.re + a.im * a.im;

// total += a b.
function increase(total, a, b) {
  total.re += a.re * b.re - a.im * b.im;
  total.im += a.re * b.im + a.im * b.re;
}

function quotient(a, b) {
  const size = power(b);
  return complex((a.re * b.re + a.im * b.im) / size, (a.im * b.re - a.re * b.im) / size);
}

function root(a) {
  const re = Math.sqrt(0.5 * (modulus(a) + Math.abs(a.re)));
  if (re === 0) return complex(0);
  const im = (0.5 * a.im) / re;
  return a.re >= 0 ? complex(re, im) : complex(Math.abs(im), a.im < 0 ? -re : re);
}

// e^a - 1, without loss where a is small.
function exponentialLess1(a) {
  const half = Math.sin(0.5 * a.im), grown = Math.expm1(a.re);
  return complex(grown * Math.cos(a.im) - 2 * half * half, (grown + 1) * Math.sin(a.im));
}

const exponential = (a) => complex(Math.exp(a.re) * Math.cos(a.im), Math.exp(a.re) * Math.sin(a.im));

// int_0^1 e^(x (1 - s) + y s) ds, without loss where x is near y, from the larger end, so that nothing overflows.
function meanExponential(x, y) {
  const ahead = x.re > y.re, step = ahead ? minus(y, x) : minus(x, y), start = exponential(ahead ? x : y);
  return step.re === 0 && step.im === 0 ? start : product(start, quotient(exponentialLess1(step), step));
}

// 1 - (1 - e^-z) / z, without loss where z is small.
function unforgotten(z) {
  if (modulus(z) > 0.5) return plus(complex(1), quotient(exponentialLess1(scaled(z, -1)), z));
  let total = complex(0);
  for (let k = 17; k > 1; k--) total = product(scaled(z, 1 / k), minus(complex(1), total));
  return total;
}

// Solve A X = B by elimination with row pivots, in place: B becomes X.
function solve(A, B) {
  const n = A.length;
  const less = (row, other, factor, first) => {
    for (let j = first; j < row.length; j++) row[j] = minus(row[j], product(factor, other[j]));
  };
  for (let k = 0; k < n; k++) {
    let pivot = k;
    for (let i = k + 1; i < n; i++) if (power(A[i][k]) > power(A[pivot][k])) pivot = i;
    for (const M of [A, B]) [M[k], M[pivot]] = [M[pivot], M[k]];
    for (let i = k + 1; i < n; i++) {
      const factor = quotient(A[i][k], A[k][k]);
      less(A[i], A[k], factor, k + 1);
      less(B[i], B[k], factor, 0);
    }
  }
  for (let k = n - 1; k >= 0; k--) {
    for (let j = 0; j < B[k].length; j++) B[k][j] = quotient(B[k][j], A[k][k]);
    for (let i = 0; i < k; i++) less(B[i], B[k], A[i][k], 0);
  }
  return B;
}

// Eigenvalues of a real matrix, by elimination to Hessenberg's form, then QR steps with Wilkinson's shift.
function eigenvalues(A) {
  const n = A.length, H = hessenberg(A).map((row) => Array.from(row, (one) => complex(one)));
  const size = (i, j) => modulus(H[i][j]);
  for (let end = n - 1, step = 1; end > 0; step++) {
    let first = end;
    while (first > 0 && size(first, first - 1) > EPSILON * (size(first, first) + size(first - 1, first - 1))) first--;
    if (first === end) {
      end--;
      step = 0;
      continue;
    }
    // A shift of no meaning now and then gets on where the good one goes in circles.
    const shift = step % 10 ? wilkinson(H, end) : plus(H[end][end], complex(size(end, end - 1)));
    for (let i = first; i <= end; i++) H[i][i] = minus(H[i][i], shift);
    const turns = [];
    for (let j = first; j < end; j++) {
      const length = Math.hypot(size(j, j), size(j + 1, j)) || 1;
      const c = scaled(H[j][j], 1 / length), s = scaled(H[j + 1][j], 1 / length);
      turns.push([c, s]);
      for (let k = j; k <= end; k++) {
        const up = H[j][k], down = H[j + 1][k];
        H[j][k] = plus(product(conjugate(c), up), product(conjugate(s), down));
        H[j + 1][k] = minus(product(c, down), product(s, up));
      }
    }
    turns.forEach(([c, s], at) => {
      const j = first + at;
      for (let k = first; k <= Math.min(j + 1, end); k++) {
        const left = H[k][j], right = H[k][j + 1];
        H[k][j] = plus(product(left, c), product(right, s));
        H[k][j + 1] = minus(product(right, conjugate(c)), product(left, conjugate(s)));
      }
    });
    for (let i = first; i <= end; i++) H[i][i] = plus(H[i][i], shift);
  }
  return H.map((row, i) => row[i]);
}

const EPSILON = 2 ** -52;

function hessenberg(A) {
  const n = A.length, H = A.map((row) => Float64Array.from(row));
  for (let m = 1; m < n - 1; m++) {
    let pivot = m;
    for (let i = m + 1; i < n; i++) if (Math.abs(H[i][m - 1]) > Math.abs(H[pivot][m - 1])) pivot = i;
    if (H[pivot][m - 1] === 0) continue;
    [H[m], H[pivot]] = [H[pivot], H[m]];
    for (const row of H) [row[m], row[pivot]] = [row[pivot], row[m]];
    for (let i = m + 1; i < n; i++) {
      const factor = H[i][m - 1] / H[m][m - 1];
      add(H[i], H[m], -factor);
      for (const row of H) row[m] += factor * row[i];
    }
  }
  return H;
}

// The eigenvalue of the last two rows and columns that is nearer to the last entry.
function wilkinson(H, end) {
  const larger = beyond(H, end), across = product(H[end - 1][end], H[end][end - 1]);
  return power(larger) ? minus(H[end][end], quotient(across, larger)) : H[end][end];
}

// By how much the other one is beyond the last entry.
function beyond(H, end) {
  const across = product(H[end - 1][end], H[end][end - 1]), half = scaled(minus(H[end - 1][end - 1], H[end][end]), 0.5);
  const square = root(plus(product(half, half), across));
  const sums = [plus(half, square), minus(half, square)];
  return power(sums[0]) > power(sums[1]) ? sums[0] : sums[1];
}
