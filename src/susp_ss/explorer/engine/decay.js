// Stable linear systems x' = A x, and what white noise stirs up in them.

// Doublings at most, and the size of a power whose square is rounding.
const DOUBLINGS = 40, FORGOTTEN = 1e-9;

function largest(A) {
  let most = 0;
  for (const row of A) for (let j = 0; j < row.length; j++) most = Math.max(most, Math.abs(row[j]));
  return most;
}

// The sum of A^k Q A^kT by Smith's doubling, A being Cayley's transform about the geometric mean of its eigenvalues.
class Decay {
  constructor(A) {
    Object.assign(this, { A, powers: [], passages: {}, shifts: new Map() });
    const pace = Math.exp(inverse(A).size / A.length), [M] = this.resolvent(pace);
    let power = M.map((row, i) => row.map((one, j) => 2 * pace * one - (i === j ? 1 : 0)));
    Object.assign(this, { M, pace });
    for (let k = 0; k < DOUBLINGS && largest(power) > FORGOTTEN; k++) {
      this.powers.push(power);
      power = multiply(power, power);
    }
    this.stable = largest(power) <= FORGOTTEN;
  }

  // X of A X + X A^T + Q = 0.
  stirred(Q) {
    return summed(this.M, this.powers, this.pace, Q);
  }

  // X of A^T X + X A + Q = 0.
  told(Q) {
    this.turned ??= [this.M, ...this.powers].map(transpose);
    const [M, ...powers] = this.turned;
    return summed(M, powers, this.pace, Q);
  }

  get inverse() {
    return (this.undone ??= inverse(this.A).of);
  }

  // (rate I - A)^-1 and its transpose.
  resolvent(rate) {
    return this.shifted(-rate).map(negated);
  }

  // (A + rate I)^-1 and its transpose.
  shifted(rate) {
    return kept(this.shifts, rate, () => {
      const { of } = inverse(this.A.map((row, i) => row.map((one, j) => one + (i === j ? rate : 0))));
      return [of, transpose(of)];
    });
  }

  passage(T) {
    return (this.passages[T] ??= new Passage(this, T));
  }
}

function summed(M, powers, pace, Q) {
  const X = across(multiply(M, Q), M);
  for (const row of X) for (let j = 0; j < row.length; j++) row[j] *= 2 * pace;
  for (const power of powers) {
    const moved = multiply(power, X);
    for (let i = 0; i < X.length; i++) for (let j = 0; j <= i; j++) X[j][i] = X[i][j] += dot(moved[i], power[j]);
  }
  return X;
}
