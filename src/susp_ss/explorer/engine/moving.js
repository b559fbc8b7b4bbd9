// A car that moves: at each speed another first-order system, which falls apart into the motions that left and right
// have in common and those that they have against one another.
class MovingCar extends Ride {
  constructor(model, parameters, like = null) {
    super(model, parameters);
    if (this.impossible()) return;
    // What both sides do together is the same at any speed, but for sliding that no road stirs up.
    this.halves = [like?.halves[0] ?? half(this.halves[0]), half(this.halves[1])];
    this.modes = this.halves.flatMap(({ modes }, at) => modes.map((mode) => ({ ...mode, at })));
    const nothing = ({ A }) => A.map(() => complex(0));
    const W = this.modes.map(({ W, at }) => this.halves.flatMap((own, i) => (i === at ? W : nothing(own))));
    this.dynamics = new Modes(this.modes.map(({ rate }) => rate), W);
    this.entering = this.corners.map((_, wheel) => this.halves.flatMap(({ B }) => B.map((row) => row[wheel])));
    this.on_road_velocity = this.added(({ D }) => D, this.on_road_velocity);
    // The warp of the road, and the angle to which a road that stands still would bring the body.
    const still = this.added(({ stretch, K_ride, K_in }) => multiply(stretch, quotients(K_ride, K_in)), this.resting);
    const leant = this.added(({ stretch, K_ride, lean }) => multiply(stretch, quotients(K_ride, transpose([lean]))));
    leant[this.roll.row][0] = 1;
    const warps = warped(still, this.integrators);
    this.on_integrators = warps.map((row, i) => Float64Array.of(...row, leant[i][0]));
    this.integrators = [...this.integrators, this.halves[1].G[this.roll.at]];
    this.slots = [...this.motion_slots, ...this.carcass.map(() => "relaxation")];
  }

  // What a real row for each half sees of the modes.
  seenBy(row) {
    return this.modes.map(({ V, at }) => applied(row(this.halves[at]), V));
  }

  // What an output sees of each mode.
  sees(row) {
    return this.halves.flatMap(({ seen }) => seen[row]);
  }

  get positions() {
    return this.placed.map(({ at }, i) => ({
      at,
      seen: this.seenBy(({ places }) => places[i]),
      carried: this.added(({ places, G }) => multiply([places[i]], G))[0],
    }));
  }

  // Matrices of the halves, added up.
  added(of, first = null) {
    const parts = this.halves.map(of), total = (first ?? parts.shift()).map((row) => Float64Array.from(row));
    for (const part of parts) part.forEach((row, i) => add(total[i], row, 1));
    return total;
  }

  at({ speed }) {
    return speed === this.parameters.speed ? this : new MovingCar(this.model, { ...this.parameters, speed }, this);
  }

  impossible() {
    const { izz } = this.parameters;
    return izz > this.least_izz ? "" : filled(WORDS.izz, { izz: general(izz, 4), need: general(this.least_izz, 4) });
  }

  unstable() {
    const { rates } = this.dynamics, worst = rates.reduce((one, other) => (other.re > one.re ? other : one));
    if (worst.re <= -DAMPED * Math.max(...rates.map(modulus))) return "";
    const { speed } = this.parameters, critical = this.gradient < 0 ? Math.sqrt(-this.behind[1] / this.gradient) : Infinity;
    if (speed >= critical) return filled(WORDS.critical, { speed: general(speed, 4), critical: general(critical, 4) });
    const rate = `${general(worst.re, 3)}${worst.im < 0 ? "" : "+"}${general(worst.im, 3)}j`;
    return filled(WORDS.lasting, { speed: general(speed, 4), worst: rate });
  }

  drifting(drift) {
    return drift.at(-1) ? WORDS.parting : WORDS.drifting;
  }

  // Every mode with its shape in the coordinates, and the shares of its energy that the `slots` have.
  motions() {
    return this.modes.map(({ rate, V, at }) => {
      const { M, K, speeds, motions, lags, A } = this.halves[at], n = K.length;
      const w = speeds.map((row) => quotient(applied(row, V), rate));
      const energies = [[w, M], [V.slice(0, n), K]].map(([x, of]) =>
        of.map((row, i) => product(conjugate(x[i]), applied(row, x)).re));
      const each = w.map((_, i) => energies[0][i] + (energies[1][i] ?? 0));
      const own = lags[0] ? V.slice(A.length - lags[0].length) : [];
      const spread = (rows, x) => rows.map((row) => sum(row.map((one, i) => one * one * x[i] / square(rows, i))));
      const carcasses = lags.map((row, i) => this.carcass[i] * power(applied(row, own)));
      const found = [...spread(motions, each), ...carcasses], all = sum(found.map(Math.abs));
      return { rate, shape: motions.map((row) => applied(row, w)), shares: found.map((one) => one / all) };
    });
  }

  // Whatever has a position has a mode of its own.
  preferred(slot) {
    return slot < this.coordinates.length ? 1 : 0;
  }
}

const square = (rows, column) => sum(rows.map((row) => row[column] ** 2));

// One half: states s are the positions p relative to the road, their rates, what else of the velocities forces depend on,
// how the tyres slide, and what lags behind; s' = A s + B z', y = C s + D z', and what `speeds` make of s are the rates
// of all velocities.
function half(own) {
  const { M, K, forces, K_in, C_in, slips, lag, acceleration, felt } = own, n = K.length, size = forces[0].length;
  const solved = inverted(M), by = (columns) => transpose(columns.map(solved));
  const speeds = by(transpose(forces)), G = quotients(K, K_in);
  const moved = by(transpose(C_in).map((column) => Float64Array.from(M, (_, i) => column[i] ?? 0)));
  const kept = size - n - slips.length - lag.length;
  const moving = zeros(n, size);
  moving.forEach((row, i) => (row[n + i] = 1));
  const A = [...moving, ...speeds.slice(0, kept), ...multiply(slips, speeds), ...lag];
  const B = [
    ...negated(G),
    ...moved.slice(0, kept),
    ...multiply(slips, moved),
    ...lag.map(() => new Float64Array(G[0].length)),
  ];
  const C = multiply(acceleration, speeds);
  C.forEach((row, i) => add(row, felt[i], 1));
  let modes = modesOf(A);
  if (!modes.every(({ condition }) => condition < PARALLEL)) {
    modes = modesOf(A.map((row, i) => Float64Array.from(row, (one, j) => (i === j ? one * (1 - ASIDE) : one))));
  }
  const seen = C.map((row) => modes.map(({ V }) => applied(row, V)));
  return { ...own, G, A, B, D: multiply(acceleration, moved), speeds, modes, seen };
}
