// Files to take away, as susp_ss.explorer.downloads writes them: the package's own words, filled in.

// A number as Python writes it.
function repr(x) {
  if (Object.is(x, -0)) return "-0.0";
  const [digits, exponent] = x.toExponential().split("e"), power = Number(exponent);
  if (power < -4 || power >= 16) return `${digits}e${power < 0 ? "-" : "+"}${String(Math.abs(power)).padStart(2, "0")}`;
  return Number.isInteger(x) ? `${x}.0` : String(x);
}

// A text whose gaps are filled by their names.
const completed = (text, of) => text.replace(/\{\{([^{}]+)\}\}/g, (_, name) => of(name));

// What a state says of each field of its car: one value, or one for each wheel where axles were set apart.
function fieldsOf(car, { curve }) {
  const several = new Set(car.axles).size > 1, { parameters } = car;
  return Object.fromEntries(Object.entries(car.files.call.fields).map(([name, { own, wheels, apart, ...more }]) => {
    const names = wheels ? wheels.map((wheel) => `${name}_${wheel}`) : [name];
    const rates = names.map((one, i) => parameters[one] ?? own[i]);
    const bent = curve && name === "cs", differ = bent ? (one) => one !== rates[0] : (one, i) => one !== own[i];
    const values = bent ? rates.map((rate) => tabled(damper(rate, curve), curve)) : rates;
    return [name, { ...more, wheels: apart || (several && wheels && rates.some(differ)) ? wheels : null, values }];
  }));
}

// A curve at its kinks and somewhat beyond.
function tabled(law, { knee }) {
  const velocity = [-knee - CURVE.further, -knee, 0, knee, knee + CURVE.further];
  return { velocity, force: velocity.map((v) => law.force(v)) };
}

function toml(value) {
  if (Array.isArray(value)) return `[${value.map(toml).join(", ")}]`;
  if (typeof value === "string") return `"${value}"`;
  if (typeof value === "number") return repr(value);
  return `{ ${Object.entries(value).map(([key, part]) => `${key} = ${toml(part)}`).join(", ")} }`;
}

function vehicleFile(car, state) {
  const fields = fieldsOf(car, state), { entry } = CURVE;
  const curve = (of) => Object.fromEntries(Object.keys(entry).map((key) => [key, { ...entry[key], value: of[key] }]));
  return completed(car.files.toml, (name) => {
    const { wheels, values, unit } = fields[name], parts = values.map((one) => (one.force ? curve(one) : one));
    if (wheels) return toml({ ...Object.fromEntries(wheels.map((wheel, i) => [wheel, parts[i]])), unit });
    return toml(values[0].force ? parts[0] : { value: parts[0], unit });
  });
}

// Python that calls a function with arguments, which are Python by name.
const call = (name, given) => [
  `ss.${name}(`,
  ...Object.entries(given).map(([key, text]) => `    ${key}=${text},`.replaceAll("\n", "\n    ")),
  ")",
].join("\n");

const listed = (values) => `[${values.map(repr).join(", ")}]`;

function fieldCode({ wheels, values }) {
  const curve = ({ velocity, force }) => call("DamperCurve", { velocity: listed(velocity), force: listed(force) });
  const texts = values.map((one) => (one.force ? curve(one) : repr(one)));
  if (!wheels || (wheels.length === 4 && new Set(texts).size === 1)) return texts[0];
  return wheels.length === 4 ? call("Corners.axles", { front: texts[0], rear: texts[2] }) : `(${texts.join(", ")})`;
}

function vehicleCode(car, state) {
  const fields = fieldsOf(car, state), { kind, seats } = car.files.call;
  const seated = Object.values(seats).flatMap((own) => Object.values(own));
  const own = Object.entries(fields).filter(([name, { wheels, values, told }]) =>
    !seated.includes(name) && (told || wheels || values[0] !== 0));
  const made = (name, given) => call(name, Object.fromEntries(given.map(([key, field]) => [key, fieldCode(field)])));
  const code = made(kind, own);
  const occupied = Object.entries(seats).map(([seat, of]) =>
    `'${seat}': ${made("Seat", Object.entries(of).map(([key, name]) => [key, fields[name]]))}`);
  return occupied.length ? `${code}.with_seats({${occupied.join(", ")}})` : code;
}

function roadCode(road) {
  const written = ({ name, own }) => {
    if (!(name in road)) return own;
    return typeof road[name] === "string" ? `'${road[name]}'` : repr(road[name]);
  };
  const told = FILES.road.filter(({ name, told: always }) => always || road[name] !== 0);
  return call("Road", Object.fromEntries(told.map((field) => [field.name, written(field)])));
}

function pythonLines(car, state, query) {
  const { height, length, speed } = state.bump;
  const gaps = { query, vehicle: vehicleCode(car, state), road: roadCode(state.road) };
  Object.assign(gaps, { height: repr(height), length: repr(length), speed: repr(speed) });
  const text = completed(FILES.lines[state.curve ? "curved" : "straight"], (name) => gaps[name]);
  return query ? text : text.replace("?\n", "\n");
}

function metricsTable(car, state) {
  const { metrics: values, comfort: felt } = compute(state);
  const cell = (text) => (/[",\n]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text);
  const rows = [
    ["name", "label", "unit", "value"],
    ...values.map(({ name, label, unit, value }) => [name, label, unit, value === null ? "inf" : repr(value)]),
    ...felt.map(({ point, label, total }) =>
      [`total@${point}`, `vibration total value, ${label}`, "m/s^2", repr(total)]),
  ];
  return rows.map((row) => `${row.map(cell).join(",")}\n`).join("");
}

const WRITERS = { csv: metricsTable, toml: vehicleFile, fmu: functionalMockUp, py: pythonLines };

// A file of a state, whose page has a query in its address; or a message why there is none. A car that moves may be
// written though nothing can be computed of it.
function file(kind, state, query) {
  const car = carOf(state), computed = kind === "csv" || kind === "fmu", { name, type } = FILES[kind];
  const message = (computed || !car.moves ? car.impossible() : "")
    || (kind === "fmu" && !car.files.fmu ? WORDS.fmu : "")
    || (kind === "csv" || (kind === "fmu" && state.curve) ? refused(car, roadOf(state)) : "");
  return message ? { message } : { name, content: new Blob([WRITERS[kind](car, state, query)], { type }) };
}
