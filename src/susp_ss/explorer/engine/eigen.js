// Eigenvalues and eigenvectors of any real matrix: balanced, by reflections to Hessenberg's form, by Francis' steps to
// Schur's, and by substitution to vectors.

// What is coupled to what, as lists of rows: a matrix of several such parts falls apart into them.
function coupled(A) {
  const left = new Set(A.keys()), parts = [];
  for (const first of A.keys()) {
    if (!left.delete(first)) continue;
    const part = [first];
    for (const i of part) {
      for (const j of left) if ((A[i][j] !== 0 || A[j][i] !== 0) && left.delete(j)) part.push(j);
    }
    parts.push(part.sort((i, j) => i - j));
  }
  return parts;
}

// Complex numbers at some rows among n, none elsewhere.
function among(n, rows, x) {
  const whole = [];
  for (let i = 0; i < n; i++) whole.push(complex(0));
  rows.forEach((i, at) => (whole[i] = x[at]));
  return whole;
}

// Powers of two that, as scales of the states, make rows and columns alike in size.
function balance(A) {
  const n = A.length, scales = new Float64Array(n).fill(1);
  for (let changed = true; changed; ) {
    changed = false;
    for (let i = 0; i < n; i++) {
      let row = 0, column = 0;
      for (let j = 0; j < n; j++) {
        if (j === i) continue;
        row += Math.abs(A[i][j]);
        column += Math.abs(A[j][i]);
      }
      if (row === 0 || column === 0) continue;
      const by = 2 ** Math.round(0.5 * Math.log2(row / column));
      if (row / by + column * by > 0.95 * (row + column)) continue;
      changed = true;
      scales[i] *= by;
      for (let j = 0; j < n; j++) {
        A[j][i] *= by;
        A[i][j] /= by;
      }
    }
  }
  return scales;
}

// H becomes Z^T H Z, of nothing below the first subdiagonal; Z, of as many rows as are asked for, turns along.
function reflected(H, Z) {
  const n = H.length;
  for (let k = 0; k < n - 2; k++) {
    const v = new Float64Array(n);
    let size = 0;
    for (let i = k + 1; i < n; i++) size += (v[i] = H[i][k]) ** 2;
    size = Math.sqrt(size);
    if (size === Math.abs(v[k + 1])) continue;
    v[k + 1] += v[k + 1] < 0 ? -size : size;
    reflect(H, Z, v, k + 1, n, k, n);
    for (let i = k + 2; i < n; i++) H[i][k] = 0;
  }
}

// Reflect H from both sides, its columns from `from` on and its rows up to `to`, and Z from the right, by a vector that
// is not zero from `first` to before `last`.
function reflect(H, Z, v, first, last, from, to) {
  const n = H.length;
  let square = 0;
  for (let i = first; i < last; i++) square += v[i] * v[i];
  if (square === 0) return;
  const by = 2 / square;
  for (let j = from; j < n; j++) {
    let total = 0;
    for (let i = first; i < last; i++) total += v[i] * H[i][j];
    total *= by;
    for (let i = first; i < last; i++) H[i][j] -= total * v[i];
  }
  turned(H, to, v, first, last, by);
  turned(Z, Z.length, v, first, last, by);
}

function turned(M, rows, v, first, last, by) {
  for (let i = 0; i < rows; i++) {
    const row = M[i];
    let total = 0;
    for (let j = first; j < last; j++) total += v[j] * row[j];
    if (total === 0) continue;
    total *= by;
    for (let j = first; j < last; j++) row[j] -= total * v[j];
  }
}

// H becomes Schur's form, with blocks of one or two rows on its diagonal, by steps of two shifts at once.
function schur(H, Z) {
  const v = new Float64Array(H.length), norm = Math.max(...H.map((row) => Math.max(...row.map(Math.abs))));
  for (let end = H.length - 1, step = 1; end > 0; step++) {
    let first = end;
    for (; first > 0; first--) {
      const beside = Math.abs(H[first][first]) + Math.abs(H[first - 1][first - 1]);
      if (Math.abs(H[first][first - 1]) <= EPSILON * (beside || norm)) break;
    }
    if (first > 0) H[first][first - 1] = 0;
    if (first >= end - 1) {
      end = first - 1;
      step = 0;
      continue;
    }
    const [a, b, c, d] = [H[end - 1][end - 1], H[end - 1][end], H[end][end - 1], H[end][end]];
    // Shifts of no meaning now and then get on where the good ones go in circles.
    const odd = step % 10 ? 0 : Math.abs(c) + Math.abs(H[end - 1][end - 2]);
    const trace = odd ? 1.5 * odd : a + d, determinant = odd ? odd * odd : a * d - b * c;
    const [p, q] = [H[first], H[first + 1]];
    v[first] = p[first] * p[first] + p[first + 1] * q[first] - trace * p[first] + determinant;
    v[first + 1] = q[first] * (p[first] + q[first + 1] - trace);
    v[first + 2] = q[first] * H[first + 2][first + 1];
    for (let k = first; k < end; k++) {
      const last = Math.min(k + 3, end + 1);
      if (k > first) for (let i = k; i < last; i++) v[i] = H[i][k - 1];
      let size = 0;
      for (let i = k; i < last; i++) size += v[i] * v[i];
      size = Math.sqrt(size);
      v[k] += v[k] < 0 ? -size : size;
      reflect(H, Z, v, k, last, Math.max(k - 1, first), Math.min(k + 4, end + 1));
      if (k > first) for (let i = k + 1; i < last; i++) H[i][k - 1] = 0;
    }
  }
}

// Modes of x' = A x: their rates, and of each the column of V and the row of W = V^-1, both complex; of a pair of
// conjugates the one that turns forwards. `condition` is what errors of A grow by in it.
function modesOf(A) {
  return coupled(A).flatMap((rows) => {
    const found = eigen(rows.map((i) => Float64Array.from(rows, (j) => A[i][j])));
    const whole = (x) => among(A.length, rows, x);
    return found.map(({ rate, V, W, condition }) => ({ rate, V: whole(V), W: whole(W), condition }));
  });
}

// Eigenvalues alone, those of the blocks of Schur's form, which A becomes.
function ratesOf(A) {
  balance(A);
  reflected(A, []);
  schur(A, []);
  const rates = [];
  for (let i = 0; i < A.length; i++) {
    if (i + 1 === A.length || A[i + 1][i] === 0) rates.push(complex(A[i][i]));
    else {
      const half = 0.5 * (A[i][i] - A[i + 1][i + 1]), middle = complex(A[i][i] - half);
      const away = root(complex(half * half + A[i][i + 1] * A[i + 1][i]));
      rates.push(plus(middle, away), minus(middle, away));
      i++;
    }
  }
  return rates;
}

// A = S Q T Q^H S^-1 of a complex T with nothing below its diagonal, where the eigenvalues `rates` are, and S of powers
// of two; A is overwritten.
function triangularised(A) {
  const scales = balance(A), Z = identity(A.length);
  reflected(A, Z);
  schur(A, Z);
  const [T, Q] = [A, Z].map((M) => M.map((row) => Array.from(row, (one) => complex(one))));
  triangular(T, Q);
  return { scales, T, Q, rates: T.map((row, i) => row[i]) };
}

// Modes of a matrix that does not fall apart, which is overwritten.
function eigen(A) {
  const n = A.length, { scales, T, Q, rates } = triangularised(A), least = EPSILON * Math.max(...rates.map(modulus));
  const gap = (one, other) => {
    const apart = minus(one, other);
    return modulus(apart) > least ? apart : complex(least);
  };
  const length = (x) => Math.sqrt(sum(x.map(power)));
  return rates.flatMap((rate, k) => {
    if (rate.im < 0 && !creeping(rate)) return [];
    // T y = rate y from below, and w T = rate w from the left.
    const [y, w, V, W] = [0, 1, 2, 3].map(() => T.map(() => complex(0)));
    y[k] = w[k] = complex(1);
    for (let i = k - 1; i >= 0; i--) {
      for (let j = i + 1; j <= k; j++) increase(y[i], T[i][j], y[j]);
      y[i] = quotient(y[i], gap(rate, rates[i]));
    }
    for (let j = k + 1; j < n; j++) {
      for (let i = k; i < j; i++) increase(w[j], w[i], T[i][j]);
      w[j] = quotient(w[j], gap(rate, rates[j]));
    }
    Q.forEach((row, i) => {
      for (let j = 0; j <= k; j++) increase(V[i], row[j], y[j]);
      for (let j = k; j < n; j++) {
        W[i].re += w[j].re * row[j].re + w[j].im * row[j].im;
        W[i].im += w[j].im * row[j].re - w[j].re * row[j].im;
      }
      V[i] = scaled(V[i], scales[i]);
      W[i] = scaled(W[i], 1 / scales[i]);
    });
    return [{ rate, V, W, condition: length(y) * length(w) }];
  });
}

// Turn every block of two rows, so that T, complex from then on, has nothing below its diagonal; Z turns along.
function triangular(T, Z) {
  for (let m = T.length - 1; m > 0; m--) {
    const below = T[m][m - 1];
    if (below.re === 0 && below.im === 0) continue;
    const shift = beyond(T, m), length = Math.hypot(modulus(shift), modulus(below));
    const c = scaled(shift, 1 / length), s = scaled(below, 1 / length);
    for (let j = m - 1; j < T.length; j++) {
      const up = T[m - 1][j], down = T[m][j];
      T[m - 1][j] = plus(product(conjugate(c), up), product(conjugate(s), down));
      T[m][j] = minus(product(c, down), product(s, up));
    }
    for (const [M, rows] of [[T, m + 1], [Z, Z.length]]) {
      for (let i = 0; i < rows; i++) {
        const left = M[i][m - 1], right = M[i][m];
        M[i][m - 1] = plus(product(c, left), product(s, right));
        M[i][m] = minus(product(conjugate(c), right), product(conjugate(s), left));
      }
    }
    T[m][m - 1] = complex(0);
  }
}
