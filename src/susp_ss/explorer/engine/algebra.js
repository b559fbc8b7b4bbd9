// Dense linear algebra of small real matrices, arrays of rows.

// Rows are plain arrays, of which engines of JavaScript make many small ones faster than of typed ones.
function zeros(rows, columns) {
  const row = [], out = [];
  for (let j = 0; j < columns; j++) row.push(0.5); // What holds a fraction once is kept as one of doubles.
  row.fill(0);
  for (let i = 0; i < rows; i++) out.push(row.slice());
  return out;
}

// What a map holds under a key, made when it is asked for first.
function kept(map, key, make) {
  if (!map.has(key)) map.set(key, make());
  return map.get(key);
}

const sum = (x) => x.reduce((total, one) => total + one, 0);

function transpose(A) {
  const out = zeros(A[0].length, A.length);
  for (let i = 0; i < A.length; i++) for (let j = 0; j < out.length; j++) out[j][i] = A[i][j];
  return out;
}

function dot(x, y) {
  let total = 0;
  for (let i = 0; i < x.length; i++) total += x[i] * y[i];
  return total;
}

function times(A, x) {
  const out = [];
  for (let i = 0; i < A.length; i++) out.push(dot(A[i], x));
  return out;
}

// x^T A x of a symmetric A, by what is not above its diagonal.
function quadratic(x, A) {
  let total = 0;
  for (let i = 0; i < x.length; i++) {
    if (x[i] === 0) continue;
    const row = A[i];
    let half = 0;
    for (let j = 0; j < i; j++) half += row[j] * x[j];
    total += x[i] * (2 * half + row[i] * x[i]);
  }
  return total;
}

// to += factor * x.
function add(to, x, factor) {
  for (let i = 0; i < to.length; i++) to[i] += factor * x[i];
}

function multiply(A, B) {
  const out = zeros(A.length, B[0].length);
  for (let i = 0; i < A.length; i++) {
    const to = out[i], row = A[i];
    for (let k = 0; k < B.length; k++) {
      const x = B[k], factor = row[k];
      if (factor !== 0) for (let j = 0; j < to.length; j++) to[j] += factor * x[j];
    }
  }
  return out;
}

function identity(n) {
  const out = zeros(n, n);
  for (let i = 0; i < n; i++) out[i][i] = 1;
  return out;
}

const negated = (A) => A.map((row) => row.map((one) => -one));

// A B^T.
function across(A, B) {
  const out = zeros(A.length, B.length);
  for (let i = 0; i < A.length; i++) for (let j = 0; j < B.length; j++) out[i][j] = dot(A[i], B[j]);
  return out;
}

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

// A^-1 by elimination with row pivots, and the logarithm of |det A|.
function inverse(A) {
  const n = A.length, left = zeros(n, 2 * n);
  A.forEach((row, i) => {
    row.forEach((one, j) => (left[i][j] = one));
    left[i][n + i] = 1;
  });
  let size = 0;
  for (let k = 0; k < n; k++) {
    let pivot = k;
    for (let i = k + 1; i < n; i++) if (Math.abs(left[i][k]) > Math.abs(left[pivot][k])) pivot = i;
    [left[k], left[pivot]] = [left[pivot], left[k]];
    const top = left[k], by = top[k];
    size += Math.log(Math.abs(by));
    for (let j = k; j < 2 * n; j++) top[j] /= by;
    for (let i = 0; i < n; i++) {
      const row = left[i], factor = row[k];
      if (i === k || factor === 0) continue;
      for (let j = k; j < 2 * n; j++) row[j] -= factor * top[j];
    }
  }
  return { of: left.map((row) => row.slice(n)), size };
}

// A^-1 B.
const quotients = (A, B) => transpose(transpose(B).map(inverted(A)));
