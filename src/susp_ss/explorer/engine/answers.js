// What the page asks: everything that it shows of a state, as susp_ss.explorer.compute says it.

// The car of a state: what it sets, at the wheels that it means.
function carOf({ model, vehicle, seat, curve, road }) {
  const kind = seat ? `${model}, seated` : model, { settings } = MODELS[kind], parameters = {};
  const set = (parameter, value) => (parameters[parameter] = value);
  for (const [name, value] of Object.entries(vehicle)) settings.vehicle[name].forEach((one) => set(one, value));
  for (const [name, value] of Object.entries(seat ?? {})) set(settings.seat[name], value);
  if (curve) return new CurvedCar(kind, parameters, curve);
  return MODELS[kind].moves ? new MovingCar(kind, { ...parameters, speed: road.speed }) : new Car(kind, parameters);
}

// The road of a state; the waviness of a slider that adds its steps up is off by rounding.
const roadOf = ({ road }) => ({ ...road, waviness: Number(road.waviness.toFixed(9)) });

const metrics = (state) => carOf(state).metrics(roadOf(state));

// JSON has no infinity.
const finite = (value) => (Number.isFinite(value) ? value : null);

// Why a road has no finite variances, or none that is known here.
function refused(car, road) {
  if (!(road.waviness in GAMMA)) return WORDS.waviness;
  const unstable = car.unstable();
  if (unstable) return unstable;
  for (const process of car.processes[road.tracks]) {
    const { rates, drift } = car.integrated(process), cut = road.cutoff > 0;
    const bounded = road.waviness < 1 + 2 * cut + 2 * (process.sign < 0);
    const steep = road.waviness >= 3 && process.sign === 0 && !cut;
    const which = drift.map((one, k) => (one !== 0 && !bounded) || (steep && rates.some((row) => row[k] !== 0)));
    if (which.some(Boolean)) return car.drifting(which);
  }
  return car.at(road).unstable();
}

function overSpeed(car, road) {
  const described = ({ name, label, unit }) => ({ name, label, unit }), own = car.metrics(road);
  const found = { metrics: car.measured.map((one, i) => ({ ...described(one), value: finite(own[i]) })) };
  const cars = SPEEDS.map((speed) => car.at({ ...road, speed })), why = cars.map((one) => one.unstable()).find(Boolean);
  if (why) return { ...found, errors: [{ parameter: "", message: why }] };
  const values = cars.map((one, i) => one.metrics({ ...road, speed: SPEEDS[i] }));
  const over = car.measured.map((one, i) => ({ ...described(one), values: values.map((some) => finite(some[i])) }));
  return { ...found, speeds: { speed: SPEEDS, metrics: over }, errors: [] };
}

function comfort(car, road) {
  const variances = {};
  for (const { weighting } of Object.values(AXES)) variances[weighting] ??= car.variances(road, FILTERS[weighting]);
  const felt = (axis, row) => deviation(variances[AXES[axis].weighting][row]);
  const rotations = Object.entries(car.rotations).map(([axis, { word, row }]) => [axis, word, felt(axis, row)]);
  return car.points.map(({ point, label, row }) => {
    const wz = felt("bacc", row), axes = [["bacc", "wz", wz], ...rotations];
    const total = Math.hypot(...axes.map(([axis, , value]) => AXES[axis].k * value));
    const words = REACTIONS.filter(([, low, high]) => low <= total && total < high).map(([word]) => word).join(" or ");
    return { point, label, ...Object.fromEntries(axes.map(([, word, value]) => [word, value])), total, words };
  });
}

function overFrequency(car, road, outputs) {
  const bode = outputs.map((output) => {
    const { row, input, unit } = car.outputs[output], H = response(car, row, input, FREQUENCIES);
    const phase = unwrapped(H.map(({ re, im }) => Math.atan2(im, re)));
    return { output, unit: unit.bode, input: car.inputs[input], magnitude: H.map(modulus), phase };
  });
  const found = spectra(car, outputs.map((output) => car.outputs[output].row), road, FREQUENCIES);
  const psd = outputs.map((output, at) => {
    const { unit, weighting } = car.outputs[output], S = found[at];
    const weighted = weighting && S.map((one, i) => one * FILTERS[weighting].power[i]);
    return { output, unit: unit.psd, psd: S, weighting, weighted };
  });
  return { frequency: FREQUENCIES, bode, psd };
}

// `files` are surrogates that the page has opened, { name, text }.
function compute(state, files = []) {
  const car = carOf(state), road = roadOf(state), never = car.impossible(), why = never || refused(car, road);
  const found = { errors: why ? [{ parameter: "", message: why }] : [], surrogates: surrogates(files, state) };
  if (never) return found;
  // What curves come to depends on the road.
  const own = why && state.curve ? null : car.at(road);
  if (!why) Object.assign(found, overSpeed(car, road), { comfort: comfort(own, road) });
  if (own && road.waviness in GAMMA) Object.assign(found, overFrequency(own, road, state.bode));
  if (own) found.modes = modes(own);
  return Object.assign(found, { bump: car.over(state.bump) });
}

// What the page shows of a design to compare with.
function compared(state) {
  const { metrics, comfort, frequency, bode, psd, modes, speeds, bump } = compute(state);
  return { metrics, comfort, frequency, bode, psd, modes, speeds, bump: { t: bump.t, acceleration: bump.acceleration } };
}

// The design that moves, and others under the same conditions.
const answer = ({ state, pins, files }) => ({ found: compute(state, files), pins: pins.map(compared) });
