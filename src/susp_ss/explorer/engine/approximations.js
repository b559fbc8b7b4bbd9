// Surrogates of the runs alone as their files hold them: radial bases and Gaussian processes whose shapes, thetas and
// noise are known (susp_ss.surrogates.radial_basis, kriging and gaussian_process).

// Of bumps about runs by their distance, and of variograms 1 - r by the square of the scaled one.
const BUMPS = {
  linear: (r) => -r,
  cubic: (r) => r ** 3,
  thin_plate_spline: (r) => (r ? r * r * Math.log(r) : 0),
  gaussian: (r) => Math.exp(-r * r),
  multiquadric: (r) => -Math.sqrt(1 + r * r),
  inverse_multiquadric: (r) => 1 / Math.sqrt(1 + r * r),
};

const VARIOGRAMS = {
  gaussian: (t) => -Math.expm1(-t),
  // 1 - (1 + a + a^2 / 3) e^-a; where a is small, by the terms that its digits are left in.
  matern52(t) {
    const a = Math.sqrt(5 * t);
    if (a > 4) return 1 - (1 + a + (a * a) / 3) * Math.exp(-a);
    let term = a ** 3 / 6, total = term;
    for (let k = 4; term > 1e-18 * total; k++) total += term *= a / k;
    return (total + (a * a) / 6) * Math.exp(-a);
  },
};

const squares = (one, other, weights) => one.reduce((total, x, i) => total + (weights?.[i] ?? 1) * (x - other[i]) ** 2, 0);

// Q' x and Q x of an orthogonal Q whose first columns span those of P, and the triangle that takes P to these.
class Reflected {
  constructor(P) {
    const columns = transpose(P), m = columns.length;
    this.mirrors = [];
    for (let j = 0; j < m; j++) {
      const v = Float64Array.from(this.turned(columns[j]), (one, i) => (i < j ? 0 : one)), size = Math.sqrt(dot(v, v));
      v[j] += v[j] < 0 ? -size : size;
      const all = Math.sqrt(dot(v, v));
      this.mirrors.push(v.map((one) => one / all));
    }
    const turned = columns.map((one) => this.turned(one));
    this.triangle = turned.map((_, i) => turned.map((column) => column[i]));
    this.rank = m;
  }

  turned(x, mirrors = this.mirrors) {
    const out = Float64Array.from(x);
    for (const v of mirrors) add(out, v, -2 * dot(v, out));
    return out;
  }

  back(x) {
    return this.turned(x, [...this.mirrors].reverse());
  }

  // What is left when P is taken off, and the way back.
  contrast(x) {
    return this.turned(x).slice(this.rank);
  }

  spread(x) {
    return this.back([...new Float64Array(this.rank), ...x]);
  }
}

// Lower triangle L with L L' = A.
function cholesky(A) {
  const L = A.map((row) => new Float64Array(row.length));
  for (let i = 0; i < A.length; i++) {
    for (let j = 0; j <= i; j++) {
      let rest = A[i][j];
      for (let k = 0; k < j; k++) rest -= L[i][k] * L[j][k];
      if (i === j && !(rest > 0)) throw damaged("these runs and thetas leave no digits");
      L[i][j] = i === j ? Math.sqrt(rest) : rest / L[j][j];
    }
  }
  return L;
}

function forwards(L, b) {
  const x = Float64Array.from(b);
  for (let i = 0; i < x.length; i++) {
    for (let j = 0; j < i; j++) x[i] -= L[i][j] * x[j];
    x[i] /= L[i][i];
  }
  return x;
}

function backwards(L, b) {
  const x = Float64Array.from(b);
  for (let i = x.length - 1; i >= 0; i--) {
    x[i] /= L[i][i];
    for (let j = 0; j < i; j++) x[j] -= L[i][j] * x[i];
  }
  return x;
}

// Fits to runs { designs, responses, guides }: each makes { value, size } of a design and its guides, the size that
// which its errors are proportional to.
function interpolant({ kernel, degree }, { shape }, { designs, responses }) {
  if (!Object.hasOwn(BUMPS, kernel) || !(shape > 0)) throw damaged(`kernel is ${kernel}, shape is ${shape}`);
  const least = FITTED.least_degree[kernel], power = degree ?? Math.max(least, 0), bump = BUMPS[kernel];
  const k = designs[0].length, n = designs.length;
  const known = Number.isInteger(power) && power >= least && countOf(k, power, n) <= n;
  if (!known) throw damaged(`degree is ${degree}`);
  const scaled = scalingOf(designs), Z = designs.map(scaled), tail = power < 0 ? () => [] : monomials(k, power);
  const about = (z) => Z.map((run) => bump(shape * Math.sqrt(squares(z, run)))), P = Z.map(tail), m = P[0].length;
  const conditions = [
    ...Z.map((z, i) => [...about(z), ...P[i]]),
    ...[...Array(m).keys()].map((j) => [...P.map((row) => row[j]), ...Array(m).fill(0)]),
  ];
  const weights = inverted(conditions)([...responses, ...Array(m).fill(0)]);
  return (design) => {
    const z = scaled(design);
    return { value: dot([...about(z), ...tail(z)], weights), size: 1 };
  };
}

const within = (one, [least, most]) => typeof one === "number" && least <= one && one <= most;

function process({ kernel }, { degree, scaled_thetas, noise: own }, { designs, responses, guides }) {
  if (!Object.hasOwn(VARIOGRAMS, kernel)) throw damaged(`kernel is ${kernel}`);
  if (!FITTED.degrees.includes(degree) || !within(own, FITTED.noises)) throw damaged(`degree is ${degree}, noise is ${own}`);
  const k = designs[0].length, n = designs.length, thetas = numbersOf(scaled_thetas, "scaled_thetas", k);
  if (!thetas.every((one) => within(one, FITTED.thetas))) throw damaged(`scaled_thetas are ${thetas.join(", ")}`);
  const variogram = VARIOGRAMS[kernel], wide = variogram(4 * sum(thetas)), scaled = scalingOf(designs), Z = designs.map(scaled);
  const columns = transpose(guides), middle = columns.map((column) => sum(column) / n);
  const width = columns.map((column) => Math.max(...column) - Math.min(...column));
  const terms = monomials(k, degree), trend = (z, guide) => [...terms(z), ...guide.map((one, i) => (one - middle[i]) / width[i])];
  const about = (z) => Float64Array.from(Z, (run) => variogram(squares(z, run, thetas)) / wide);
  const noise = Math.max(own, n * FITTED.least_noise), C = Z.map((z) => about(z).map((one) => -one));
  C.forEach((row, i) => (row[i] += noise));
  const P = Z.map((z, i) => trend(z, guides[i])), turn = new Reflected(P), free = n - turn.rank;
  if (free < 1) throw damaged(`${n} runs are too few for the trend`);
  const contrasts = turn.contrast(responses), met = dot(contrasts, contrasts) <= FITTED.dependent ** 2 * dot(responses, responses);
  const half = transpose(C.map((row) => turn.contrast(row))), L = cholesky(half.map((row) => turn.contrast(row)));
  const solved = met ? contrasts.map(() => 0) : backwards(L, forwards(L, contrasts)), weights = turn.spread(solved);
  const variance = dot(contrasts, solved) / free, rest = times(C, weights).map((one, i) => responses[i] - one);
  const coefficients = inverted(turn.triangle)(turn.turned(rest).slice(0, turn.rank));
  const averages = inverted(transpose(turn.triangle)), nothing = new Float64Array(free);
  return (design, guide) => {
    const z = scaled(design), p = trend(z, guide), v = about(z), a = turn.back([...averages(p), ...nothing]);
    const left = times(C, a).map((one, i) => -v[i] - one), corrected = forwards(L, turn.contrast(left));
    const size = noise + sum(left.map((one, i) => a[i] * (v[i] - one))) - dot(corrected, corrected);
    const value = dot(p, coefficients) - dot(v, weights);
    return { value, size: Math.max(Math.sqrt(variance * Math.max(size, 0)), FITTED.tiny) };
  };
}

function scalingOf(designs) {
  const columns = transpose(designs);
  return scaling(columns.map((one) => Math.min(...one)), columns.map((one) => Math.max(...one)));
}

// A surrogate of its runs: `fit` makes one of any of them, and `guide` is what else it takes of a design.
class Approximation {
  constructor({ kind, settings, found, left_out, columns }, fit, guide = () => []) {
    const designs = Array.isArray(found.designs) ? found.designs : [], n = designs.length;
    designs.forEach((row) => numbersOf(row, "each of designs", columns.length));
    const responses = numbersOf(found.responses, "responses", n);
    if (n < 2) throw damaged("designs must be two or more");
    if (n > FITTED.many) throw new Elsewhere(`${kind} of more than ${FITTED.many} runs`);
    if (left_out === undefined) throw new Elsewhere(`${kind} of an older file`);
    Object.assign(this, { settings, fit, guide, runs: { designs, responses, guides: designs.map(guide) } });
    this.leftOut = left_out && { folds: foldsOf(left_out.folds, n, left_out.fits.length), fits: left_out.fits };
    this.whole = fit(settings, found, this.runs);
  }

  // Fits without some runs, with the runs that each lacks, and by how much it misses these in terms of its size there.
  get deputies() {
    const { folds, fits } = this.leftOut, { runs } = this;
    const some = (which) => Object.fromEntries(Object.entries(runs).map(([name, rows]) => [name, rows.filter((_, i) => which(i))]));
    return (this.made ??= fits.map((found, fold) => {
      const own = this.fit(this.settings, found, some((i) => folds[i] !== fold));
      const lacking = folds.flatMap((one, i) => (one === fold ? [i] : []));
      const missed = lacking.map((i) => {
        const { value, size } = own(runs.designs[i], runs.guides[i]);
        return Math.abs(runs.responses[i] - value) / size;
      });
      return { own, lacking, missed };
    }));
  }

  predict(design) {
    const guide = this.guide(design), { value } = this.whole(design, guide);
    if (!this.leftOut) return { value, low: null, high: null };
    const byOthers = [], misses = [];
    for (const { own, lacking, missed } of this.deputies) {
      const there = own(design, guide);
      lacking.forEach((run, i) => ([byOthers[run], misses[run]] = [there.value, there.size * missed[i]]));
    }
    return { value, ...jackknifePlus(value, byOthers, misses) };
  }
}

Object.assign(MADE, {
  RadialBasis: (numbers) => new Approximation(numbers, interpolant),
  Kriging: (numbers) => new Approximation(numbers, process),
  CoKriging(numbers, cheap) {
    const f = cheap(false);
    return new Approximation(numbers, process, (design) => [f(design)]);
  },
});
