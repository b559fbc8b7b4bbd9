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

// x of A x = b by elimination with row pivots, complex numbers as re, im, re, im, ..; rows of A, which are overwritten,
// have theirs of b last.
function eliminated(rows) {
  const n = rows.length;
  for (let k = 0; k < 2 * n; k += 2) {
    let pivot = k / 2, most = -1;
    for (let i = pivot; i < n; i++) {
      const size = rows[i][k] * rows[i][k] + rows[i][k + 1] * rows[i][k + 1];
      if (size > most) [most, pivot] = [size, i];
    }
    const top = rows[pivot], re = top[k] / most, im = -top[k + 1] / most;
    rows[pivot] = rows[k / 2];
    rows[k / 2] = top;
    for (let i = k / 2 + 1; i < n; i++) {
      const row = rows[i], a = row[k] * re - row[k + 1] * im, b = row[k] * im + row[k + 1] * re;
      if (a === 0 && b === 0) continue;
      for (let j = k + 2; j <= 2 * n; j += 2) {
        row[j] -= a * top[j] - b * top[j + 1];
        row[j + 1] -= a * top[j + 1] + b * top[j];
      }
    }
  }
  const [x] = zeros(1, 2 * n);
  for (let k = 2 * n - 2; k >= 0; k -= 2) {
    const row = rows[k / 2], size = row[k] * row[k] + row[k + 1] * row[k + 1];
    let re = row[2 * n], im = row[2 * n + 1];
    for (let j = k + 2; j < 2 * n; j += 2) {
      re -= row[j] * x[j] - row[j + 1] * x[j + 1];
      im -= row[j] * x[j + 1] + row[j + 1] * x[j];
    }
    x[k] = (re * row[k] + im * row[k + 1]) / size;
    x[k + 1] = (im * row[k] - re * row[k + 1]) / size;
  }
  return x;
}

const EPSILON = 2 ** -52;

// By how much the other one is beyond the last entry.
function beyond(H, end) {
  const across = product(H[end - 1][end], H[end][end - 1]), half = scaled(minus(H[end - 1][end - 1], H[end][end]), 0.5);
  const square = root(plus(product(half, half), across));
  const sums = [plus(half, square), minus(half, square)];
  return power(sums[0]) > power(sums[1]) ? sums[0] : sums[1];
}
