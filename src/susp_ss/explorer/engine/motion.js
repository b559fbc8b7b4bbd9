// Responses over frequency, modes, and a drive over a bump.

// K_v(x) = int_0^inf e^(-x cosh t) cosh(v t) dt, by the trapezoidal rule, whose error here is e^(-pi^2 / step).
function bessel(v, x) {
  const step = 0.2;
  let total = 0.5 * Math.exp(-x);
  for (let t = step; x * Math.cosh(t) < 750; t += step) total += Math.exp(-x * Math.cosh(t)) * Math.cosh(v * t);
  return step * total;
}

// Share of a process in the spectrum of one track, at a wavenumber.
function shareOf(process, road, n, trackWidth) {
  if (!process.sign) return process.share;
  const v = 0.5 * road.waviness, x = 2 * Math.PI * n * trackWidth;
  const apart = 1 - 2 / GAMMA[road.waviness] * (0.5 * x) ** v * bessel(v, x);
  return 0.5 * (process.sign < 0 ? apart : 2 - apart);
}

const verticalVelocity = (road, f) => {
  const n = f / road.speed, cut = 1 / (1 + (road.cutoff / n) ** 2);
  return ((2 * Math.PI * f) ** 2 * road.roughness * (n / REFERENCE_WAVENUMBER) ** -road.waviness * cut) / road.speed;
};

// Sum over the modes and their conjugates of gains / (s - rate).
function resonances(rates, gains, s) {
  let re = 0, im = 0;
  for (let k = 0; k < gains.length; k++) {
    const one = quotient(gains[k], minus(s, rates[k]));
    re += one.re;
    im += one.im;
  }
  return complex(re, im);
}

// What an output makes of amplitudes that the modes are moved by.
const gainsOf = (car, row, moved) => car.dynamics.whole(car.sees(row).map((one, k) => product(one, moved[k])));

// Complex response of an output to the height of the road under a wheel.
function response(car, row, wheel, frequencies) {
  const { dynamics } = car, rates = dynamics.whole(dynamics.rates);
  const gains = gainsOf(car, row, dynamics.amplitudes(car.entering[wheel]));
  const warp = dot(car.on_integrators[row], car.integrators.map((one) => one[wheel]));
  return frequencies.map((f) => {
    const s = complex(0, 2 * Math.PI * f), through = complex(car.on_road_velocity[row][wheel]);
    return plus(product(plus(resonances(rates, gains, s), through), s), complex(warp));
  });
}

// One-sided spectra of the outputs of some rows on a road.
function spectra(car, rows, road, frequencies) {
  const totals = rows.map(() => frequencies.map(() => 0)), rates = car.dynamics.whole(car.dynamics.rates);
  for (const process of car.processes[road.tracks]) {
    const integrated = car.integrated(process), entries = car.entries(process);
    const strengths = frequencies.map((f) =>
      shareOf(process, road, f / road.speed, car.track_width) * verticalVelocity(road, f));
    rows.forEach((row, at) => {
      const on = car.on_integrators[row], drift = dot(on, integrated.drift);
      const axles = entries.map((entry, j) => ({
        gains: gainsOf(car, row, entry),
        through: dot(car.on_road_velocity[row], process.weights[j]),
        warp: dot(on, integrated.rates[j]),
        tau: car.behind[j] / road.speed,
      }));
      frequencies.forEach((f, i) => {
        const s = complex(0, 2 * Math.PI * f);
        const whole = axles.reduce((sum, { gains, through, warp, tau }) => {
          const turn = exponentialLess1(scaled(s, -tau)), alone = plus(resonances(rates, gains, s), complex(through));
          return plus(sum, plus(product(plus(turn, complex(1)), alone), quotient(scaled(turn, warp), s)));
        }, quotient(complex(drift), s));
        totals[at][i] += strengths[i] * power(whole);
      });
    });
  }
  return totals;
}

// Angles in degrees without the jumps of a whole turn.
function unwrapped(angles) {
  let turns = 0;
  return angles.map((angle, i) => {
    if (i) turns -= Math.round((angle - angles[i - 1]) / (2 * Math.PI));
    return ((angle + 2 * Math.PI * turns) * 180) / Math.PI;
  });
}

// Natural motions, slowest first, each named after the motion that most of its energy is in, none of these twice.
function modes(car) {
  const found = car.motions().sort((one, other) => modulus(one.rate) - modulus(other.rate));
  const own = assigned(found.map(({ shares }) => shares.map((share, j) => share + car.preferred(j))));
  return found.flatMap(({ rate, shape, shares }, i) => {
    const name = car.slots[shares[own[i]] > UNMOVED ? own[i] : shares.indexOf(Math.max(...shares))];
    if (!car.coordinates.some(({ motion }) => motion === name)) return [];
    const most = shape.reduce((one, other) => (modulus(other) > modulus(one) ? other : one));
    const drawn = { wheels: {}, seats: {} };
    car.coordinates.forEach(({ at: [first, place] }, j) => {
      const { re, im } = quotient(shape[j], most);
      if (place === undefined) drawn[first] = [re, im];
      else drawn[first][place] = [re, im];
    });
    const size = modulus(rate);
    return [{ name, frequency: size / (2 * Math.PI), damping: -rate.re / size, shape: drawn }];
  });
}

// The columns that rows take so that their entries, none below zero by much, add up to the most, no column twice;
// undefined for rows without one. By augmenting paths that are shortest in prices (Kuhn and Munkres).
function assigned(rows) {
  const columns = rows[0].length, all = Math.max(columns, rows.length);
  const cost = (i, j) => (j < columns ? -rows[i][j] : 0);
  const prices = new Float64Array(all + 1), gains = new Float64Array(rows.length), taken = Array(all + 1).fill(-1);
  rows.forEach((_, row) => {
    const least = Array(all).fill(Infinity), from = Array(all).fill(all), seen = Array(all + 1).fill(false);
    let at = all;
    taken[all] = row;
    while (taken[at] >= 0) {
      seen[at] = true;
      const i = taken[at];
      let next = all, step = Infinity;
      for (let j = 0; j < all; j++) {
        if (seen[j]) continue;
        const reduced = cost(i, j) - gains[i] - prices[j];
        if (reduced < least[j]) [least[j], from[j]] = [reduced, at];
        if (least[j] < step) [step, next] = [least[j], j];
      }
      for (let j = 0; j <= all; j++) {
        if (seen[j]) {
          gains[taken[j]] += step;
          prices[j] -= step;
        } else if (j < all) least[j] -= step;
      }
      at = next;
    }
    for (; at !== all; at = from[at]) taken[at] = taken[from[at]];
  });
  const found = Array(rows.length);
  for (let j = 0; j < columns; j++) if (taken[j] >= 0) found[taken[j]] = j;
  return found;
}

// The way of a car over a haversine bump on both tracks, heights linear between its points: steps, and which are shown.
function wayOver({ axles, behind }, { height, length, speed }) {
  const pieces = Math.ceil(length / BUMP.spacing - 1e-9);
  const point = (k) => 0.5 * height * (1 - Math.cos((2 * Math.PI * k) / pieces));
  const ground = (x) => {
    const at = Math.min(Math.max((x / length) * pieces, 0), pieces), k = Math.min(Math.floor(at), pieces - 1);
    return point(k) + (at - k) * (point(k + 1) - point(k));
  };
  const step = Math.min(BUMP.step, length / speed / BUMP.over);
  const way = (BUMP.before + BUMP.after) * speed + length + behind.at(-1);
  const steps = Math.floor(way / (speed * step) + 1e-6);
  const heights = (i) => axles.map((axle) => ground((i * step - BUMP.before) * speed - behind[axle]));
  return { speed, step, steps, every: Math.max(1, Math.floor((steps + 1) / BUMP.shown)), heights };
}

// Where everything is on a way, as a drive says it, which goes on by the rise of the heights z.
function recorded(car, { speed, step, steps, every, heights }, drive) {
  const found = { t: [], x: [], body: {}, wheels: {}, seats: {}, ground: {}, acceleration: [] };
  const put = (at, place, value) => (at[place] ??= []).push(value);
  for (let i = 0, z = heights(0); ; i++) {
    if (i % every === 0) {
      found.t.push(i * step - BUMP.before);
      found.x.push((i * step - BUMP.before) * speed);
      car.placed.forEach(({ at: [group, place] }, row) => put(found[group], place, drive.place(row, z)));
      car.corners.forEach((corner, wheel) => put(found.ground, corner, z[wheel]));
      found.acceleration.push(drive.acceleration(z));
    }
    if (i === steps) return found;
    const next = heights(i + 1);
    drive.on(z, next.map((one, wheel) => one - z[wheel]));
    z = next;
  }
}

// Where everything is while the car drives over a bump.
function bump(car, asked) {
  const way = wayOver(car, asked), { dynamics, positions } = car, { rates } = dynamics;
  const felt = car.measured[0].row, seen = car.sees(felt);
  const into = car.entering.map((one) => dynamics.amplitudes(one));
  const free = rates.map((rate) => exponential(scaled(rate, way.step)));
  const driven = rates.map((rate, k) => {
    const gain = meanExponential(scaled(rate, way.step), complex(0));
    return into.map((one) => product(one[k], gain));
  });
  let amplitudes = rates.map(() => complex(0));
  return recorded(car, way, {
    place: (row, z) => dynamics.real(positions[row].seen, amplitudes) + dot(positions[row].carried, z),
    acceleration: (z) =>
      dynamics.real(seen, amplitudes) + dot(car.on_integrators[felt], times(car.integrators, z)),
    on(_, rise) {
      amplitudes = amplitudes.map((one, k) => {
        const moved = product(free[k], one);
        driven[k].forEach((gain, wheel) => {
          moved.re += gain.re * rise[wheel];
          moved.im += gain.im * rise[wheel];
        });
        return moved;
      });
    },
  });
}
