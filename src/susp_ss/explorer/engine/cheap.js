// The cheap model of a surrogate's file, which stands in for a car with more parameters: susp_ss.fit.low_fidelity.

// What only susp-ss explore does of a file that is right.
class Elsewhere extends Refusal {
  constructor(what) {
    super(filled(WORDS.elsewhere, { what }));
  }
}

const damaged = (what) => new Refusal(filled(WORDS.damaged, { what }));

const CHEAP = new Map(Object.entries(MODELS).filter(([, { cheap }]) => cheap).map(([kind, { cheap }]) => [cheap.model, kind]));

// A metric and its place in an output's name, as susp_ss.quantities has it.
function metricAndPlace(name) {
  const { metrics } = FITTED, found = metrics.includes(name) ? [] : metrics.filter((one) => name.startsWith(`${one}_`));
  const metric = found.reduce((one, other) => (other.length > one.length ? other : one), "");
  return metric ? { metric, place: name.slice(metric.length + 1) } : { metric: name, place: null };
}

// A table in a file, whose keys may be any words.
function tableOf(value, where) {
  if (typeof value !== "object" || value === null || Array.isArray(value)) throw damaged(`${where} must be a table`);
  return new Map(Object.entries(value));
}

function numbersOf(value, where, count = value?.length) {
  if (Array.isArray(value) && value.length === count && value.every(Number.isFinite)) return value;
  throw damaged(`${where} must be ${count ?? "some"} numbers`);
}

// The road of a fit, of those that are known here.
function fittedRoad(table) {
  const road = tableOf(table, "road"), found = {};
  for (const [name, zero] of Object.entries(FITTED.road)) {
    const value = road.get(name);
    if (!(Number.isFinite(value) && (value > 0 || (zero && value === 0)))) throw damaged(`road.${name} is ${value}`);
    found[name] = value;
  }
  if (!FITTED.tracks.includes(road.get("tracks"))) throw damaged(`road.tracks is ${road.get("tracks")}`);
  const strange = [...road.keys()].find((name) => !FITTED.of_road.includes(name));
  if (strange !== undefined) throw damaged(`road has a ${strange}`);
  const waviness = road.get("waviness"), plain = Number.isFinite(waviness) && waviness in GAMMA;
  if (!plain || road.get("delay") !== true || road.get("wheels") || road.get("contact_length") || road.get("table")?.length) {
    throw new Elsewhere("the road of this fit");
  }
  return { ...found, waviness, tracks: road.get("tracks") };
}

// Beyond, matrices of a car have no digits left.
const [SMALL, LARGE] = [1e-9, 1e12];

// The parameters of a vehicle's table, in SI units, at every wheel.
function parametersOf(kind, entries) {
  const found = {};
  for (const [name, { unit, wheels, own }] of Object.entries(MODELS[kind].files.call.fields)) {
    const entry = entries.has(name) ? tableOf(entries.get(name), name) : null;
    const names = wheels ? wheels.map((wheel) => `${name}_${wheel}`) : [name];
    names.forEach((one, i) => {
      const value = entry ? (entry.get("value") ?? entry.get(wheels?.[i])) : own[i];
      if (entry && (entry.get("unit") !== unit || typeof value !== "number")) throw new Elsewhere("the cheap model of this fit");
      found[one] = value;
    });
  }
  return found;
}

class CheapModel {
  constructor({ vehicle, road, place, parameter, weighting }) {
    const own = tableOf(vehicle, "vehicle"), model = own.get("model");
    if (!FITTED.models.includes(model)) throw damaged(filled(WORDS.no_model, { name: model }));
    this.kind = CHEAP.get(model);
    this.known = this.kind !== undefined && !own.has("seats");
    this.parameters = this.known ? parametersOf(this.kind, tableOf(own.get("parameters") ?? {}, "parameters")) : null;
    this.road = fittedRoad(road);
    if (place !== null && !FITTED.places.includes(place)) throw damaged(`place is ${place}`);
    if (typeof (weighting ?? "") !== "string") tableOf(weighting, "weighting");
    Object.assign(this, { place, parameter, weighting: weighting ?? null });
  }

  // The filter that a metric passes before its root mean square is taken, or null.
  through(metric) {
    if (this.weighting === null || !FITTED.accelerations.includes(metric)) return null;
    const known = typeof this.weighting === "string";
    if (!known) throw new Elsewhere("a weighting of its own");
    if (!Object.hasOwn(FILTERS, this.weighting)) throw damaged(`weighting is ${this.weighting}`);
    return FILTERS[this.weighting];
  }

  // How much of each column every input of the cheap model takes, by the names of its parameters at every wheel.
  shares(columns, corners) {
    const { fields } = MODELS[this.kind].files.call, { meant, road } = FITTED, found = new Map();
    const known = (name) => Object.hasOwn(fields, name) || Object.hasOwn(road, name);
    for (const [wheel, stoodFor] of Object.entries(corners)) {
      columns.forEach((name, i) => {
        const [field, at] = known(name) ? [name, stoodFor] : Object.hasOwn(meant, name) ? meant[name] : [name, []];
        const many = at.filter((corner) => stoodFor.includes(corner)).length;
        if (!known(field) || !many) return;
        const own = fields[field]?.wheels ? `${field}_${wheel}` : field;
        if (!found.has(own)) found.set(own, columns.map(() => 0));
        found.get(own)[i] = many / stoodFor.length;
      });
    }
    return found;
  }

  // The parameters of the vehicle, or the one of the road, that a name sets.
  named(name) {
    const { named, files } = MODELS[this.kind];
    if (Object.hasOwn(FITTED.road, name)) return [name];
    if (!Object.hasOwn(named, name)) throw damaged(`parameter is ${name}`);
    const [field, wheels] = named[name];
    return files.call.fields[field].wheels ? wheels.map((wheel) => `${field}_${wheel}`) : [field];
  }

  // The cheap response of an output as a function of a design in columns, and where it is `tuned` of its parameter.
  response(output, columns, tuned) {
    if (!this.known) throw new Elsewhere("the cheap model of this fit");
    const { metric, place } = metricAndPlace(output), { measured, cheap } = MODELS[this.kind], where = place ?? this.place ?? "cg";
    const known = cheap.places[where] ?? { ...cheap.places.cg, at: cheap.single ? null : where }, filter = this.through(metric);
    const at = [`${metric}@${known.at}`, metric].map((name) => measured.findIndex((one) => one.name === name)).find((i) => i >= 0);
    const shares = [...this.shares(columns, known.wheels)], own = { ...this.parameters, ...this.road };
    if (at === undefined || !shares.length) throw damaged(`the cheap model has no ${output} by ${columns.join(", ")}`);
    const rest = shares.map(([name, share]) => (1 - sum(share)) * own[name]), names = tuned ? this.named(this.parameter) : [];
    const possible = (name, one) => (one > SMALL && one < LARGE) || (one === 0 && cheap.vanishing.some((own) => name.startsWith(own)));
    return (design, value) => {
      const set = { ...own };
      shares.forEach(([name, share], i) => (set[name] = dot(share, design) + rest[i]));
      names.forEach((name) => (set[name] = value));
      if (!Object.keys(this.parameters).every((name) => possible(name, set[name]))) throw new Refusal(WORDS.apart);
      const found = measuredThrough(new Car(this.kind, set), set, filter)[at];
      if (!Number.isFinite(found)) throw new Refusal(filled(WORDS.infinite_cheap, { value: found === Infinity ? "inf" : "nan" }));
      return found;
    };
  }
}

// All metrics of a car on a road, accelerations behind a filter if there is one.
function measuredThrough(car, road, filter) {
  const why = car.impossible() || refused(car, road);
  if (why) throw new Refusal(why);
  const here = car.at(road);
  if (!filter) return here.metrics(road);
  const variances = here.variances(road, filter);
  return car.measured.map(({ row }) => deviation(variances[row]));
}
