// How a stable system x' = A x moves over a time: the integrals of what runs forwards times what runs backwards.

// Terms of Taylor's series, the size of a step for which they are enough, and how far inverses of A + rate may amplify
// for the rate to be apart from those of A.
const TAYLOR = 16, SHORT = 0.5, APART = 1e5;

const FACTORIALS = [1];
for (let k = 1; k <= 2 * TAYLOR; k++) FACTORIALS.push(FACTORIALS[k - 1] * k);

// e^(A T) by squares of a short step's.
class Passage {
  constructor(decay, T) {
    const { A } = decay;
    this.size = Math.max(...A.map((row) => sum(row.map(Math.abs))));
    const squares = Math.max(0, Math.ceil(Math.log2((2 * this.size * T) / SHORT)));
    this.step = T * 2 ** -squares;
    const short = A.map((row) => row.map((one) => one * this.step)), E = identity(A.length);
    let term = identity(A.length);
    for (let k = 1; k < TAYLOR; k++) {
      term = multiply(short, term).map((row) => row.map((one) => one / k));
      E.forEach((row, i) => add(row, term[i], 1));
    }
    this.steps = [E];
    for (let k = 0; k < squares; k++) this.steps.push(multiply(this.steps[k], this.steps[k]));
    Object.assign(this, { decay, short, back: transpose(short), T, adjoint: transpose(this.steps[squares]) });
  }

  // From x and v on, with v' = -rate v and x' = A x + pushed v of a `bank`: where they end, and their integrals Y and V
  // over the time, times e^(A (T - t)) from s on the left.
  crossed(x, v, bank, s) {
    const { size, decay, T } = this, n = x.length, gone = v.map((one, q) => one && one * Math.exp(-bank[q].rate * T));
    const last = times(this.adjoint, s), V = zeros(v.length, n), near = [], far = [];
    bank.forEach(({ rate, pushed }, q) => {
      if (!v[q]) return;
      const [undo, adjoint] = decay.shifted(rate);
      if (largest(undo) * size > APART) near.push(q);
      else far.push({ q, adjoint, part: times(undo, pushed) });
    });
    // In x less what each colour that is apart holds of it, that colour has no part.
    const start = far.reduce((total, { q, part }) => ahead(total, v[q], part), x);
    const found = this.slowly(start, near.map((q) => v[q]), near.map((q) => bank[q]), s);
    near.forEach((q, at) => (V[q] = found.V[at]));
    for (const { q, adjoint, part } of far) {
      V[q] = times(adjoint, ahead(last, -Math.exp(-bank[q].rate * T), s)).map((one) => v[q] * one);
      increment(found.Y, -1, part, V[q]);
      add(found.x, part, -gone[q]);
    }
    return { x: found.x, v: gone, Y: found.Y, V };
  }

  slowly(x, v, bank, s) {
    const { short, back, step, steps } = this, n = short.length, r = bank.length;
    const pushed = bank.map((one) => one.pushed.map((value) => value * step));
    const fading = bank.map(({ rate }) => -rate * step);
    // Derivatives of (x, v) and of s in steps, and the series of how v moves x.
    const along = [[x, v]], against = [s], G = zeros(r, n);
    let moved = pushed;
    for (let k = 1; k < TAYLOR; k++) {
      const [now, colours] = along[k - 1], next = times(short, now);
      pushed.forEach((one, q) => add(next, one, colours[q]));
      along.push([next, colours.map((one, q) => one * fading[q])]);
      against.push(times(back, against[k - 1]));
      moved.forEach((one, q) => add(G[q], one, 1 / FACTORIALS[k]));
      moved = moved.map((one, q) => ahead(times(short, one), fading[q] ** k, pushed[q]));
    }
    let Y = zeros(n, n), V = zeros(r, n), gains = G;
    along.forEach(([of, colours], a) => {
      const [weights] = zeros(1, n);
      against.forEach((one, b) => add(weights, one, step / FACTORIALS[a + b + 1]));
      increment(Y, 1, of, weights);
      increment(V, 1, colours, weights);
    });
    // Each interval and the next are one of twice the length.
    for (let k = 0; k < steps.length - 1; k++) {
      const E = steps[k], later = multiply(E, Y);
      Y = multiply(Y, E);
      Y.forEach((row, i) => add(row, later[i], 1));
      if (!r) continue;
      for (let q = 0; q < r; q++) increment(Y, 1, gains[q], V[q]);
      const after = multiply(V, E), fresh = across(gains, E);
      for (let q = 0; q < r; q++) {
        const kept = Math.exp(fading[q] * 2 ** k);
        V[q] = ahead(after[q], kept, V[q]);
        gains[q] = ahead(fresh[q], kept, gains[q]);
      }
    }
    const end = times(steps.at(-1), x);
    bank.forEach((_, q) => add(end, gains[q], v[q]));
    return { x: end, Y, V };
  }
}
