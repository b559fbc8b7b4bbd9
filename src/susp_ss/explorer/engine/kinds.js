// Kinds of surrogates as their files hold them, susp_ss.surrogates: what they predict at a design, and between which
// bounds, by what their fits without some of the runs say.

// Student's distribution is known of few runs alone, which have no rank for a bound.
function jackknifePlus(predicted, byOthers, misses) {
  const { interval, rounding, student } = FITTED, n = byOthers.length, rank = Math.ceil(interval * (n + 1) - rounding);
  if (rank > n) {
    const square = (one, i) => (misses[i] + Math.abs(one - predicted)) ** 2;
    const margin = student[n - 1] * Math.sqrt(sum(byOthers.map(square)) / n);
    return { low: predicted - margin, high: predicted + margin };
  }
  const sorted = (sign) => byOthers.map((one, i) => one + sign * misses[i]).sort((one, other) => one - other);
  const low = sorted(-1)[n - rank], high = sorted(1)[rank - 1];
  // The ends may cross where the fits without a run disagree by more than they miss.
  return { low: Math.min(low, predicted), high: Math.max(high, predicted) };
}

// Which fit lacks each run.
function foldsOf(value, count, fits) {
  const folds = numbersOf(value, "folds", count), known = folds.every((one) => Number.isInteger(one) && one >= 0 && one < fits);
  if (!known) throw damaged("left_out must have a fit for each fold");
  return folds;
}

// What fits without some runs found, if the file knows.
function leftOutOf(numbers, count) {
  if (!numbers.left_out) return null;
  const found = tableOf(numbers.left_out, "left_out"), fits = found.get("fits"), n = found.get("errors")?.length;
  if (!Array.isArray(fits) || !n) throw damaged("left_out must have runs and fits");
  const errors = numbersOf(found.get("errors"), "errors"), folds = foldsOf(found.get("folds"), n, fits.length);
  fits.forEach((one) => numbersOf(one, "each of fits", count));
  return { misses: errors.map(Math.abs), folds, fits };
}

// A surrogate of coefficients: `law` of a design is what any coefficients predict there.
class ByCoefficients {
  constructor(numbers, coefficients, law) {
    Object.assign(this, { coefficients, law, leftOut: leftOutOf(numbers, coefficients.length) });
  }

  predict(design) {
    const law = this.law(design), value = law(this.coefficients), nothing = { value, low: null, high: null };
    if (!this.leftOut) return nothing;
    const { misses, folds, fits } = this.leftOut;
    try {
      const each = fits.map(law);
      return { value, ...jackknifePlus(value, folds.map((fold) => each[fold]), misses) };
    } catch (error) {
      if (error instanceof Refusal) return nothing;
      throw error;
    }
  }
}

// Of RB and VB, the study's corrections of the cheap response.
function correction({ found }, terms) {
  if (!Number.isFinite(found.intercept)) throw damaged("intercept must be a number");
  return [found.intercept, ...numbersOf(found.coef, "coef", terms)];
}

// How many monomials there are in k columns up to a degree, unless these are more than so many.
function countOf(k, degree, most) {
  let count = 1;
  for (let d = 1; d <= degree && count <= most; d++) count = (count * (k + d)) / d;
  return count;
}

// Which of k columns are multiplied in every monomial up to a degree, in the order of susp_ss.surrogates.regressor.
function factors(k, degree) {
  let last = [[]];
  const all = [[]];
  for (let d = 0; d < degree; d++) {
    last = last.flatMap((one) => [...Array(k).keys()].slice(one.at(-1) ?? 0).map((column) => [...one, column]));
    all.push(...last);
  }
  return all;
}

// These monomials as a function of a design.
function monomials(k, degree) {
  const terms = factors(k, degree);
  return (z) => terms.map((term) => term.reduce((total, i) => total * z[i], 1));
}

// Columns that run from -1 to 1 over a box, of a design.
function scaling(lowest, highest) {
  const scale = lowest.map((one, i) => 2 / (highest[i] - one));
  if (!scale.every((one) => one > 0 && Number.isFinite(one))) throw damaged("box must have some width in every column");
  return (design) => design.map((one, i) => one * scale[i] - 1 - lowest[i] * scale[i]);
}

const MADE = {
  ResponseBased(numbers, cheap) {
    const f = cheap(false), power = numbers.settings.form === "power";
    return new ByCoefficients(numbers, correction(numbers, 1), (design) => {
      const response = f(design);
      return power ? ([a, b]) => a * response ** b : ([a, b]) => a + b * response;
    });
  },

  VariableBased(numbers, cheap) {
    const f = cheap(false);
    return new ByCoefficients(numbers, correction(numbers, numbers.columns.length), (design) => {
      const response = f(design);
      return ([a, ...slopes]) => response + a + dot(slopes, design);
    });
  },

  ParameterBased(numbers, cheap) {
    const f = cheap(true), coefficients = numbersOf([numbers.found.parameter], "parameter", 1);
    return new ByCoefficients(numbers, coefficients, (design) => ([value]) => f(design, value));
  },

  Polynomial(numbers) {
    const k = numbers.columns.length, { degree } = numbers.settings, { box, coef } = numbers.found;
    if (!(Number.isInteger(degree) && degree > 0)) throw damaged(`degree is ${degree}`);
    numbersOf(coef, "coef", countOf(k, degree, coef?.length));
    const scaled = scaling(...[0, 1].map((end) => numbersOf(box?.[end], "box", k))), terms = monomials(k, degree);
    return new ByCoefficients(numbers, coef, (design) => {
      const columns = terms(scaled(design));
      return (a) => dot(a, columns);
    });
  },
};
