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
const gainsOf = ({ dynamics, seen }, row, moved) => dynamics.whole(seen[row].map((one, k) => product(one, moved[k])));

// Complex response of an output to the height of the road under a wheel.
function response(car, row, wheel, frequencies) {
  const { dynamics } = car, rates = dynamics.whole(dynamics.rates);
  const gains = gainsOf(car, row, dynamics.amplitudes(car.entering[wheel]));
  const warp = car.on_warp[row] * sum(car.integrators.map((one) => one[wheel]));
  return frequencies.map((f) => {
    const s = complex(0, 2 * Math.PI * f), through = complex(car.on_road_velocity[row][wheel]);
    return plus(product(plus(resonances(rates, gains, s), through), s), complex(warp));
  });
}

// One-sided spectrum of an output on a road.
function spectrum(car, row, road, frequencies) {
  const total = frequencies.map(() => 0), rates = car.dynamics.whole(car.dynamics.rates);
  for (const process of car.processes[road.tracks]) {
    const axles = car.entries(process).map((entry, j) => ({
      gains: gainsOf(car, row, entry),
      through: dot(car.on_road_velocity[row], process.weights[j]),
      warp: car.on_warp[row] * process.rates[j],
      tau: (j * car.wheelbase) / road.speed,
    }));
    frequencies.forEach((f, i) => {
      const s = complex(0, 2 * Math.PI * f);
      const whole = axles.reduce((sum, { gains, through, warp, tau }) => {
        const turn = exponentialLess1(scaled(s, -tau)), alone = plus(resonances(rates, gains, s), complex(through));
        return plus(sum, plus(product(plus(turn, complex(1)), alone), quotient(scaled(turn, warp), s)));
      }, complex(0));
      total[i] += shareOf(process, road, f / road.speed, car.track_width) * verticalVelocity(road, f) * power(whole);
    });
  }
  return total;
}

// Angles in degrees without the jumps of a whole turn.
function unwrapped(angles) {
  let turns = 0;
  return angles.map((angle, i) => {
    if (i) turns -= Math.round((angle - angles[i - 1]) / (2 * Math.PI));
    return ((angle + 2 * Math.PI * turns) * 180) / Math.PI;
  });
}

// Natural motions, slowest first, each named after the coordinate whose kinetic energy is most its own.
function modes(car) {
  const { n, rates } = car.dynamics, mass = car.m;
  const found = rates.map((rate, k) => ({ rate, shape: car.shapes[k] }))
    .sort((one, other) => modulus(one.rate) - modulus(other.rate));
  const shares = found.map(({ shape }) => {
    const energies = shape.map((one, i) => power(one) * mass[i]), all = sum(energies);
    return energies.map((one) => one / all);
  });
  const own = assigned(shares, n);
  return found.map(({ rate, shape }, i) => {
    const most = shape.reduce((one, other) => (modulus(other) > modulus(one) ? other : one));
    const drawn = { wheels: {}, seats: {} };
    car.coordinates.forEach(({ at: [first, place] }, j) => {
      const { re, im } = quotient(shape[j], most);
      if (place === undefined) drawn[first] = [re, im];
      else drawn[first][place] = [re, im];
    });
    const at = own[i] ?? shares[i].indexOf(Math.max(...shares[i]));
    const size = modulus(rate), name = car.coordinates[at].motion;
    return { name, frequency: size / (2 * Math.PI), damping: -rate.re / size, shape: drawn };
  });
}

// The columns that rows take so that their entries add up to the most, no column twice; undefined for rows without one.
function assigned(rows, columns) {
  let best = [{ total: 0, taken: [] }]; // By the set of columns that are taken, as bits.
  for (const row of rows) {
    const next = [];
    const offer = (set, total, taken) => {
      if (!(next[set]?.total >= total)) next[set] = { total, taken };
    };
    best.forEach(({ total, taken }, set) => {
      offer(set, total, [...taken, undefined]);
      for (let j = 0; j < columns; j++) if (!(set & (1 << j))) offer(set | (1 << j), total + row[j], [...taken, j]);
    });
    best = next;
  }
  return best.reduce((one, other) => (other.total > one.total ? other : one)).taken;
}

// The way of a car over a haversine bump on both tracks, heights linear between its points: steps, and which are shown.
function wayOver({ axles, wheelbase }, { height, length, speed }) {
  const pieces = Math.ceil(length / BUMP.spacing - 1e-9);
  const point = (k) => 0.5 * height * (1 - Math.cos((2 * Math.PI * k) / pieces));
  const ground = (x) => {
    const at = Math.min(Math.max((x / length) * pieces, 0), pieces), k = Math.min(Math.floor(at), pieces - 1);
    return point(k) + (at - k) * (point(k + 1) - point(k));
  };
  const step = Math.min(BUMP.step, length / speed / BUMP.over);
  const way = (BUMP.before + BUMP.after) * speed + length + wheelbase;
  const steps = Math.floor(way / (speed * step) + 1e-6);
  const heights = (i) => axles.map((axle) => ground((i * step - BUMP.before) * speed - axle * wheelbase));
  return { speed, step, steps, every: Math.max(1, Math.floor((steps + 1) / BUMP.shown)), heights };
}

// Where everything is on a way, as a drive says it, which goes on by the rise of the heights z.
function recorded(car, { speed, step, steps, every, heights }, drive) {
  const found = { t: [], x: [], body: {}, wheels: {}, ground: {}, acceleration: [] };
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
  const way = wayOver(car, asked), { dynamics } = car, { rates } = dynamics, felt = car.measured[0].row;
  const into = car.entering.map((one) => dynamics.amplitudes(one));
  const free = rates.map((rate) => exponential(scaled(rate, way.step)));
  const driven = rates.map((rate, k) => {
    const gain = meanExponential(scaled(rate, way.step), complex(0));
    return into.map((one) => product(one[k], gain));
  });
  let amplitudes = rates.map(() => complex(0));
  return recorded(car, way, {
    place: (row, z) => dynamics.real(car.placed[row].seen, amplitudes) + dot(car.places[row], times(car.G, z)),
    acceleration: (z) =>
      dynamics.real(car.seen[felt], amplitudes) + car.on_warp[felt] * sum(car.integrators.map((one) => dot(one, z))),
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
