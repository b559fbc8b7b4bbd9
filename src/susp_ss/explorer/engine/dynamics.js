// A car's motion by its modes.

// p' = v + ..., v' = -K p - C v + ..., K and C symmetric; vectors hold the positions before the velocities, `shapes` are
// those of the positions.
class Dynamics extends Modes {
  // Motions that may fall apart into some that know nothing of one another; `near` are those of a C that is little else.
  static of(K, C, near = null) {
    const met = (M, i, j) => Math.abs(M[i][j]) > ROUNDING * Math.sqrt(Math.abs(M[i][i] * M[j][j]));
    const parts = coupled(K.map((row, i) => row.map((_, j) => Number(met(K, i, j) || met(C, i, j)))));
    if (parts.length === 1) return Dynamics.sound(K, C, near);
    return new Apart(K.length, parts.map((rows, at) => {
      const [own, damping] = [K, C].map((M) => rows.map((i) => rows.map((j) => M[i][j])));
      return { own: Dynamics.sound(own, damping, near?.parts?.[at]?.own), rows };
    }));
  }

  static sound(K, C, near) {
    const own = new Dynamics(K, C, near);
    return own.condition < PARALLEL ? own : new Dynamics(K, divided(C, 1 - ASIDE), near);
  }

  constructor(K, C, near) {
    super();
    const n = K.length, unit = Math.sqrt(sum(K.map((row, i) => row[i])) / n);
    Object.assign(this, { n, K: divided(K, unit ** 2), C: divided(C, unit) });
    // Rates in units, with vectors.
    this.eigenpairs = this.followed(near) ?? this.fresh();
    this.turn(this.eigenpairs.map(({ rate }) => scaled(rate, unit)));
    this.shapes = this.eigenpairs.map(({ x }) => {
      const shape = K.map((_, i) => complex(x[2 * i], x[2 * i + 1])), most = ROUNDING * Math.max(...shape.map(modulus));
      return shape.map((one) => (modulus(one) > most ? one : complex(0)));
    });
    this.invert(unit);
  }

  // W is the inverse of V, by which real vectors are made of the amplitudes' parts.
  invert(unit) {
    const { n, rates, shapes, counted } = this, V = zeros(2 * n, 2 * n), sizes = [];
    let column = 0;
    rates.forEach((rate, k) => {
      let size = 0;
      shapes[k].forEach((one, i) => {
        const moving = product(rate, one);
        [V[i][column], V[n + i][column]] = [one.re, moving.re];
        if (counted[k] === 2) [V[i][column + 1], V[n + i][column + 1]] = [one.im, moving.im];
        size += unit * modulus(one) + modulus(moving);
      });
      column += counted[k];
      sizes.push(size);
    });
    const rows = inverse(V).of;
    this.W = counted.map((count) => {
      const [re, im] = rows.splice(0, count);
      return re.map((one, i) => (im ? complex(0.5 * one, -0.5 * im[i]) : complex(one)));
    });
    const seen = this.W.map((row) => sum(row.map((one, i) => modulus(one) / (i < n ? unit : 1))));
    this.condition = column === 2 * n ? Math.max(...seen.map((one, k) => one * sizes[k])) / (2 * n) : Infinity;
  }

  // From eigenvalues that nothing else tells.
  fresh() {
    const { n, K, C } = this, A = zeros(2 * n, 2 * n);
    for (let i = 0; i < n; i++) {
      A[i][n + i] = 1;
      for (let j = 0; j < n; j++) [A[n + i][j], A[n + i][n + j]] = [-K[i][j], -C[i][j]];
    }
    const start = (at) => K.flatMap((_, i) => [Math.cos(1 + i * i + i * at), 0]);
    return ratesOf(A).filter((rate) => creeping(rate) || rate.im > 0).map((rate, at) => this.polished(rate, start(at)));
  }

  // What those of others become, if these are all there are: rates add up to the traces of A and of its square.
  followed(near) {
    const { K, C, n } = this;
    if (near?.n !== n) return null;
    const found = near.eigenpairs.map(({ rate, x }) => this.polished(this.corrected(rate, x), x));
    let trace = 0, square = 0;
    for (const { rate } of found) {
      const count = creeping(rate) ? 1 : 2;
      trace += count * rate.re;
      square += count * (rate.re ** 2 - rate.im ** 2);
    }
    for (let i = 0; i < n; i++) {
      trace += C[i][i];
      square += 2 * K[i][i] - dot(C[i], C[i]);
    }
    const size = sum(found.map(({ rate }) => power(rate)));
    return Math.abs(trace) <= ROUNDING * Math.sqrt(size) && Math.abs(square) <= ROUNDING * size ? found : null;
  }

  // An eigenvalue and its vector, of numbers re, im, re, im, .., by steps of Newton's: the rate is moved aside by a little,
  // lest it be exact.
  polished(rate, x) {
    const { n, K, C } = this;
    for (let round = 0; round < 3; round++) {
      const aside = scaled(rate, 1 + 1e-9), square = product(aside, aside), rows = [];
      for (let i = 0; i < n; i++) {
        // Of (K + rate C + rate^2) x = (C + 2 rate) x.
        const row = [], slope = scaled(product(aside, complex(x[2 * i], x[2 * i + 1])), 2);
        for (let j = 0; j < n; j++) {
          row.push(K[i][j] + aside.re * C[i][j], aside.im * C[i][j]);
          slope.re += C[i][j] * x[2 * j];
          slope.im += C[i][j] * x[2 * j + 1];
        }
        row[2 * i] += square.re;
        row[2 * i + 1] += square.im;
        row.push(slope.re, slope.im);
        rows.push(row);
      }
      x = eliminated(rows);
      const size = 1 / Math.sqrt(dot(x, x));
      for (let i = 0; i < 2 * n; i++) x[i] *= size;
      rate = this.corrected(rate, x);
    }
    return { rate, x };
  }

  // The rate put right by Rayleigh's quotient, whose error is the square of the vector's.
  corrected(rate, x) {
    const { n, K, C } = this, m = complex(0), c = complex(0), k = complex(0);
    for (let i = 0; i < n; i++) {
      for (let j = 0; j < n; j++) {
        const re = x[2 * i] * x[2 * j] - x[2 * i + 1] * x[2 * j + 1];
        const im = x[2 * i] * x[2 * j + 1] + x[2 * i + 1] * x[2 * j];
        c.re += C[i][j] * re;
        c.im += C[i][j] * im;
        k.re += K[i][j] * re;
        k.im += K[i][j] * im;
        if (i === j) {
          m.re += re;
          m.im += im;
        }
      }
    }
    const slope = plus(scaled(product(m, rate), 2), c), off = plus(product(plus(product(m, rate), c), rate), k);
    return minus(rate, quotient(off, slope));
  }
}

// Motions that know nothing of one another, as those of a car's two halves, each of its own rows of all n positions.
class Apart extends Modes {
  constructor(n, parts) {
    const each = (of) => parts.flatMap(({ own, rows }) => of(own, rows, [...rows, ...rows.map((i) => n + i)]));
    super(each(({ rates }) => rates), each(({ W }, _, both) => W.map((one) => among(2 * n, both, one))));
    this.shapes = each(({ shapes }, rows) => shapes.map((one) => among(n, rows, one)));
    this.parts = parts;
  }
}

const divided = (A, by) => A.map((row) => row.map((one) => one / by));
