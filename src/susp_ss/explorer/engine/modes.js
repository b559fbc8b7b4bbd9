// The modes of a real system x' = A x: those that creep and one of each pair that swings, with their eigenvalues
// `rates`; `W` takes vectors to their amplitudes. Real vectors are made of them and, for the `swinging`, of their
// conjugates.

const creeping = (rate) => Math.abs(rate.im) <= SPLIT * modulus(rate);

// Of the size of its terms, what a sum that cancels leaves.
const ROUNDING = 1e-13;

// Modes of a condition above this are too nearly one to keep digits; dampers then count as other by a ten-millionth.
const PARALLEL = 1e4, ASIDE = 1e-7;

class Modes {
  constructor(rates = [], W = []) {
    this.W = W;
    this.turn(rates);
  }

  turn(rates) {
    this.rates = rates;
    this.swinging = rates.flatMap((rate, k) => (creeping(rate) ? [] : [k]));
    this.counted = rates.map((rate) => (creeping(rate) ? 1 : 2));
  }

  // What is known of each mode, and of the conjugates.
  whole(x) {
    return [...x, ...this.swinging.map((k) => conjugate(x[k]))];
  }

  // The real number that amplitudes of the modes, seen so, come to.
  real(seen, amplitudes) {
    let total = 0;
    for (let k = 0; k < seen.length; k++) {
      total += this.counted[k] * (seen[k].re * amplitudes[k].re - seen[k].im * amplitudes[k].im);
    }
    return total;
  }

  // The real row for amplitudes' real parts, then for their imaginary ones, of what is seen of the modes.
  reading(seen) {
    const { counted } = this;
    return [...seen.map(({ re }, k) => counted[k] * re), ...seen.map(({ im }, k) => -counted[k] * im)];
  }

  // Amplitudes of the modes in a real vector; where they cancel by symmetry, none.
  amplitudes(x) {
    return this.W.map((row) => {
      let re = 0, im = 0, terms = 0;
      for (let i = 0; i < row.length; i++) {
        if (x[i] === 0) continue;
        re += row[i].re * x[i];
        im += row[i].im * x[i];
        terms += modulus(row[i]) * Math.abs(x[i]);
      }
      return Math.sqrt(re * re + im * im) > ROUNDING * terms ? complex(re, im) : complex(0);
    });
  }
}
