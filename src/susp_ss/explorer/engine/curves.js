// Dampers of curves: on a random road by statistical linearisation (susp_ss.responses.covariance.linearisation), over a
// bump as they are, by steps (susp_ss.responses.stepping).

// Of the standard normal distribution, up to u and at u; erf by its series of positive terms.
function normal(u) {
  const z = Math.abs(u) / Math.SQRT2;
  let term = z, total = z;
  for (let k = 1; z < 6 && term > 1e-17 * total; k++) total += term *= (2 * z * z) / (2 * k + 1);
  const erf = z < 6 ? (2 / Math.sqrt(Math.PI)) * Math.exp(-z * z) * total : 1;
  return { below: 0.5 * (1 + Math.sign(u) * erf), density: Math.exp(-0.5 * u * u) / Math.sqrt(2 * Math.PI) };
}

// A force that is linear between kinks and zero at rest, susp_ss.vehicles.laws.Broken.
class Broken {
  constructor(kinks, slopes) {
    Object.assign(this, { slopes, bends: kinks.map((kink, i) => ({ kink, rise: slopes[i + 1] - slopes[i] })) });
  }

  force(x) {
    let total = this.slopes[0] * x;
    for (const { kink, rise } of this.bends) total += rise * (Math.max(x - kink, 0) - Math.max(-kink, 0));
    return total;
  }

  // Means of the force and of its first and third derivative under a Gaussian motion about rest.
  means(sigma) {
    let force = 0, slope = this.slopes[0], third = 0;
    for (const { kink, rise } of this.bends) {
      const u = -kink / sigma, { below, density } = normal(u);
      force += rise * (sigma * (u * below + density) - Math.max(-kink, 0));
      slope += rise * below;
      third -= (rise * u * density) / sigma ** 2;
    }
    return { force, slope, third };
  }

  // The deviation of a velocity by which a damper dissipates a power: Newton in logarithms.
  deviation(power) {
    let log = 0.5 * Math.log(power / this.means(CURVE.middling).slope);
    for (let round = 0; round < CURVE.steps; round++) {
      const sigma = Math.exp(log), { slope, third } = this.means(sigma);
      const step = (Math.log(power / slope) - 2 * log) / (2 + (sigma ** 2 * third) / slope);
      log += Math.min(Math.max(step, -2), 2);
      if (Math.abs(step) < CURVE.settled) break;
    }
    return Math.exp(log);
  }
}

// The law of a state's curve, susp_ss.explorer.design.damper.
function damper(cs, { rebound, compression, knee, beyond }) {
  const out = rebound * cs * knee, into = compression * cs * knee;
  const at = [-2 * knee, -knee, 0, knee, 2 * knee], force = [-(1 + beyond) * out, -out, 0, into, (1 + beyond) * into];
  const slopes = at.slice(1).map((end, i) => (force[i + 1] - force[i]) / (end - at[i]));
  return new Broken([-knee, 0, knee], slopes);
}

// So many cars of other speeds tell how powers change, each of which counts less than so many times.
const NEAR = 3, FAR = 10;

// The car of numbers that stands for one of curves on a road, and how far its dampers pump it.
class StraightCar extends Car {
  constructor(curved, rates, like = curved) {
    const dampers = Object.fromEntries(curved.dampers.map((name, i) => [name, rates[i]]));
    super(curved.model, { ...curved.parameters, ...dampers }, like);
    this.settled = true;
  }

  unstable() {
    return this.settled ? "" : WORDS.unsettled;
  }

  metrics(road) {
    return [...super.metrics(road), ...this.shift];
  }

  // Where the mean forces of springs and of the dampers' unequal sides balance.
  pumped(means) {
    const rows = this.suspensions.map((row) => this.R[row]), pushed = new Float64Array(this.m.length);
    rows.forEach((row, i) => add(pushed, row, means[i].force));
    this.shift = times(rows, inverted(this.K)(pushed)).map((one) => -one);
    return this;
  }
}

// A car whose dampers all have the curve of a state.
class CurvedCar extends Ride {
  constructor(model, parameters, curve) {
    super(model, parameters);
    this.measured = [...this.measured, ...this.shifts];
    this.frame = frameOf(this);
    this.dampers = this.corners.map((corner) => (corner ? `cs_${corner}` : "cs"));
    this.laws = this.dampers.map((name) => damper(parameters[name], curve));
    this.first = this.laws.map((law) => law.means(CURVE.middling).slope);
    // Cars of numbers by the speeds at which they stand for this one, and the inverse Jacobian at the last of these.
    this.settled = [];
    this.inverse = negated(identity(this.laws.length));
  }

  metrics(road) {
    return this.at(road).metrics(road);
  }

  over(asked) {
    return bumpOfCurves(this, asked);
  }

  // The car of numbers that logarithms x of the dampers' powers make, which is little else than one before.
  trial(x, before = null) {
    const means = this.laws.map((law, i) => law.means(law.deviation(Math.exp(x[i]))));
    return { x, means, car: new StraightCar(this, means.map(({ slope }) => slope), before?.car) };
  }

  // By how much its powers are other than these, of what passes.
  residual({ x, means, car }, passing) {
    return car.variancesOf(this.velocities, passing).map((variance, i) =>
      Math.log(means[i].slope * Math.max(variance, CURVE.still)) - x[i]);
  }

  // The car of numbers on a road, by Broyden's updates. What cars of other speeds do on this road costs no modes, and
  // tells nearly how the powers change.
  at(road) {
    const far = ({ speed }) => Math.abs(Math.log(speed / road.speed));
    const near = [...this.settled].sort((one, other) => far(other) - far(one)).slice(-NEAR);
    if (near.length && far(near.at(-1)) === 0) return near.at(-1).car;
    const inverse = this.inverse.map((row) => Float64Array.from(row)), passing = this.passing(road);
    const less = (x, y) => Float64Array.from(x, (one, i) => one - y[i]);
    let here = null, rest = null;
    const learn = (next) => {
      const found = this.residual(next, passing);
      if (here) update(inverse, less(next.x, here.x), less(found, rest));
      [here, rest] = [next, found];
    };
    const seen = near.map((one) => (learn(one), { x: one.x, rest, all: sum(rest) }));
    const weights = seen.map((one, i) =>
      seen.reduce((total, { all }, j) => (i === j ? total : (total * all) / (all - one.all)), 1));
    if (!here) learn(this.trial(Float64Array.from(this.first, (cs) => Math.log(cs * CURVE.middling ** 2))));
    else if (weights.every((one) => Math.abs(one) < FAR)) {
      // Through these, to where all powers together are as they should be.
      const mean = (of) => here.x.map((_, i) => dot(weights, seen.map((one) => one[of][i])));
      learn(this.trial(less(mean("x"), times(inverse, mean("rest"))), here));
    }
    for (let round = 0; round < CURVE.rounds; round++) {
      if (Math.max(...rest.map(Math.abs)) <= CURVE.converged) {
        this.inverse = inverse;
        this.settled.push({ speed: road.speed, ...here });
        return here.car.pumped(here.means);
      }
      const step = times(inverse, rest), most = Math.max(...step.map(Math.abs));
      const share = round || near.length ? Math.min(1, CURVE.longest / most) : 1;
      learn(this.trial(here.x.map((one, i) => one - share * step[i]), here));
    }
    return Object.assign(here.car.pumped(here.means), { settled: false });
  }
}

// Broyden's update of an inverse Jacobian, after a step has changed the residual.
function update(inverse, step, change) {
  const moved = times(inverse, change), along = times(transpose(inverse), step), size = dot(step, moved);
  if (Math.abs(size) <= 1e-12 * dot(step, step)) return;
  inverse.forEach((row, i) => add(row, along, (step[i] - moved[i]) / size));
}

// Matrices of one shape, each so many times.
function combined(...terms) {
  const [[, first]] = terms, out = zeros(first.length, first[0].length);
  for (const [by, M] of terms) for (let i = 0; i < out.length; i++) add(out[i], M[i], by);
  return out;
}

// sum_k A^k / (k + power)! for powers 0 to 3, of a small A; each is A times the next and one term more.
function series(A) {
  const unit = identity(A.length);
  let total = unit;
  for (let k = 14; k > 0; k--) total = combined([1, unit], [1 / (k + 3), multiply(A, total)]);
  const found = [combined([1 / 6, total])];
  for (const first of [1 / 2, 1, 1]) found.unshift(combined([first, unit], [1, multiply(A, found[0])]));
  return found;
}

// e^(A h), and what inputs 1, t/h and (t/h)^2 through B have done after a step and after half of it, as
// susp_ss.responses.first_order_hold has them: of a step that is small, then doubled.
function held(A, B, h) {
  const size = h * Math.max(...A.map((row) => sum(row.map(Math.abs))));
  const doublings = Math.max(1, Math.ceil(Math.log2(size)) + 2);
  const step = h / 2 ** doublings, [grown, ...integrals] = series(combined([step, A]));
  let half, whole = [grown, ...integrals.map((one, k) => combined([step * Math.max(1, k), multiply(one, B)]))];
  for (let k = 0; k < doublings; k++) {
    half = whole;
    const [free, hold, ramp, bend] = half, then = (M) => multiply(free, M);
    whole = [
      then(free),
      combined([1, then(hold)], [1, hold]),
      combined([0.5, then(ramp)], [0.5, hold], [0.5, ramp]),
      combined([0.25, then(bend)], [0.25, hold], [0.5, ramp], [0.25, bend]),
    ];
  }
  return { whole, half };
}

// A matrix in one row of numbers, for thousands of products: to += M x, of numbers in one row as well.
class Packed {
  constructor(M) {
    const numbers = Float64Array.from(M.flatMap((row) => [...row]));
    Object.assign(this, { rows: M.length, columns: M[0].length, numbers });
  }

  add(to, x) {
    const { rows, columns, numbers } = this;
    for (let i = 0, at = 0; i < rows; i++) {
      let total = 0;
      for (let j = 0; j < columns; j++) total += numbers[at++] * x[j];
      to[i] += total;
    }
    return to;
  }

  times(x) {
    return this.add(new Float64Array(this.rows), x);
  }
}

// Cox and Matthews' steps of h over heights of the road that rise evenly, of a car of curves from rest on level ground.
class Stepper {
  constructor(curved, h) {
    const car = new StraightCar(curved, curved.first), n = car.m.length, { A, B, Y, D } = displacementForm(car);
    const push = pushes(car), P = [...push.map((row) => row.map(() => 0)), ...push], wheels = B[0].length, felt = curved.measured[0].row;
    const { whole, half } = held(A, beside(B, P), h);
    const part = (M, from, to) => M.map((row) => row.slice(from, to)), again = (M) => multiply(half[0], M);
    const [ofRoad, halfOfRoad] = [whole, half].map((some) => some.slice(1).map((gain) => part(gain, 0, wheels)));
    const [hold, ramp, bend] = whole.slice(1).map((gain) => part(gain, wheels)), halfHold = part(half[1], wheels);
    const [E, under] = [Y, D].map((M) => curved.velocities.map((row) => M[row])), seen = (M) => multiply(E, M);
    const [free, halfFree] = [whole[0], half[0]], [onHold, onRamp] = halfOfRoad;
    Object.assign(this, { curved, n, x: new Float64Array(2 * n + 2 * wheels), wheels });
    // By the state, the heights and their rise: velocities at the start, in the middle and at the end of a step, and the
    // state after it, but for what the curves push.
    const middle = [halfFree, onHold, combined([0.5, onRamp])];
    const end = [
      again(halfFree),
      combined([1, again(onHold)], [1, onHold]),
      combined([0.5, again(onRamp)], [0.5, onHold], [0.5, onRamp]),
    ];
    const by = ([ofState, ofHeights, ofRise], share) =>
      [seen(ofState), combined([1, seen(ofHeights)], [1, under]), combined([1, seen(ofRise)], [share, under])];
    const rows = ([x, z, rise]) => new Packed(beside(beside(x, z), rise));
    this.start = rows([E, under, combined([0, under])]);
    this.middle = rows(by(middle, 0.5));
    this.end = rows(by(end, 1));
    this.after = rows([free, ofRoad[0], ofRoad[1]]);
    this.onNext = new Packed(seen(halfHold));
    this.onEnd = new Packed(seen(again(halfHold)));
    const inside = combined([2, ramp], [-2, bend]);
    const [first, last] = [combined([1, hold], [-3, ramp], [2, bend]), combined([-1, ramp], [2, bend])];
    [this.onStart, this.inside, this.onLast] = [first, inside, last].map((M) => new Packed(M));
    this.felt = [...Y[felt], ...D[felt], ...D[felt].map(() => 0)];
    this.feltPush = multiply([car.acceleration[felt]], push)[0];
    this.places = car.placed.map((_, row) => car.places[row]);
  }

  // What the curves push at these velocities more than the numbers in their place; in their place as well.
  beyond(rates) {
    const { laws, first } = this.curved;
    for (let i = 0; i < rates.length; i++) rates[i] = laws[i].force(rates[i]) - first[i] * rates[i];
    return rates;
  }

  // Before a step.
  on(z, rise) {
    this.x.set(z, 2 * this.n);
    this.x.set(rise, 2 * this.n + this.wheels);
  }

  step() {
    const { x, onNext } = this, u = this.beyond(this.start.times(x)), halfWay = this.middle.times(x);
    const a = this.beyond(onNext.add(halfWay.slice(), u)), b = this.beyond(onNext.add(halfWay, a));
    const twice = b.map((one, i) => 2 * one - u[i]), inside = a.map((one, i) => one + b[i]);
    const c = this.beyond(onNext.add(this.onEnd.add(this.end.times(x), u), twice));
    x.set(this.onLast.add(this.inside.add(this.onStart.add(this.after.times(x), u), inside), c));
  }

  // What the body feels, on heights of which the state knows.
  acceleration() {
    return dot(this.felt, this.x) + dot(this.feltPush, this.beyond(this.start.times(this.x)));
  }
}

// Where everything is while a car of curves drives over a bump.
function bumpOfCurves(curved, asked) {
  const steepest = new StraightCar(curved, curved.laws.map(({ slopes }) => Math.max(...slopes)));
  const way = wayOver(curved, asked);
  const swinging = steepest.dynamics.rates.filter((rate) => Math.abs(rate.im) > CURVE.swinging * modulus(rate));
  const parts = Math.ceil((way.step * Math.max(...swinging.map(modulus))) / CURVE.resolved);
  const stepper = new Stepper(curved, way.step / parts), none = curved.corners.map(() => 0);
  return recorded(curved, way, {
    place: (row) => dot(stepper.places[row], stepper.x),
    acceleration(z) {
      stepper.on(z, none);
      return stepper.acceleration();
    },
    on(z, rise) {
      const part = rise.map((one) => one / parts);
      for (let k = 0; k < parts; k++) {
        stepper.on(z.map((one, i) => one + k * part[i]), part);
        stepper.step();
      }
    },
  });
}
