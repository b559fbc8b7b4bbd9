// What takes seconds: the carpet of a state's springs and dampers, the best of them, and what no suspension beats, as
// susp_ss.explorer.background says it.

// What cannot be computed, in words for the page.
class Refusal extends Error {}

// All designs under the conditions of a state, whatever its own springs and dampers are.
class Field {
  constructor(state) {
    Object.assign(this, { state, designs: DESIGNS[state.model], road: roadOf(state) });
    const own = Object.fromEntries(this.designs.map(({ key, value }) => [key, value]));
    this.car = carOf(this.with(own));
    const { measured } = this.car, is = (axis) => ({ name }) => name === axis || name.startsWith(`${axis}@`);
    [this.x, this.y] = [state.carpet.x, state.carpet.y].map((axis) => measured.findIndex(is(axis)));
    this.names = { x: measured[this.x].name, y: measured[this.y].name };
  }

  with(design) {
    return { ...this.state, vehicle: { ...this.state.vehicle, ...design } };
  }

  // The metrics of a design.
  metrics(design) {
    return carOf(this.with(design)).metrics(this.road);
  }

  // Both metrics for every combination of springs and dampers about the model's own.
  carpet() {
    const designs = FACTORS.map((ks) => FACTORS.map((cs) => {
      const by = { springs: ks, dampers: cs };
      const moved = this.designs.map(({ key, group, value }) => [key, value * by[group]]);
      const found = this.metrics(Object.fromEntries(moved));
      return [found[this.x], found[this.y]];
    }));
    const { x, y } = this.names;
    if (!designs.flat(2).every(Number.isFinite)) {
      throw new Refusal(`no carpet of ${x} and ${y}, which are infinite on this road`);
    }
    return { carpet: { x, y, ks: FACTORS, cs: FACTORS, designs } };
  }

  front() {
    const { x, y } = this.names, own = this.car.metrics(this.road);
    if (x === y) throw new Refusal(said("same", { NAME: x }));
    for (const [name, value] of [[y, own[this.y]], [x, own[this.x]]]) {
      if (!(value > 0 && value < Infinity)) throw new Refusal(said("flat", { NAME: name, VALUE: value ? "inf" : "0" }));
    }
    const settings = (u) => this.designs.map(({ key, least, most }, j) => [key, least + u[j] * (most - least)]);
    const design = (u) => Object.fromEntries(settings(u));
    const values = (u) => {
      const found = this.metrics(design(u));
      return [found[this.y], found[this.x]];
    };
    const points = frontOf(new Search(values, this.designs.length), SEARCH.points);
    this.best = points.map(({ u, values: [y, x] }) => ({ x, y, design: design(u) }));
    return { front: { points: this.best.map(({ x, y }) => [x, y]), designs: this.best.map((one) => one.design) } };
  }

  bound() {
    const { road } = this, car = this.car.at(road), { measured } = car;
    const kept = ({ name }) => SEARCH.kept.includes(name.split("@")[0]);
    const goal = measured[this.y], variances = car.variances(road);
    const limited = [...new Set([measured[this.x], ...measured.filter(kept)])].filter((one) => one !== goal);
    for (const [where, one] of [["minimise", goal], ...limited.map((one) => ["limits", one])]) {
      if (one.damper !== null) throw new Refusal(`${where}: ${car.unbounded}`);
      if (variances[one.row] === Infinity) throw new Refusal(`${where}: ${said("infinite", { NAME: one.name })}`);
    }
    const dual = new Dual(new Plant(car, road), goal.row, limited.map(({ row }) => row)), points = [];
    let last = null;
    for (const { x, design } of this.best) {
      const found = this.metrics(design);
      last = dual.bound(limited.map((one) => found[measured.indexOf(one)] ** 2), last);
      if (last) points.push([x, Math.sqrt(last.variances[0])]);
    }
    return { bound: { points } };
  }
}

const said = (words, names) =>
  Object.entries(names).reduce((text, [name, one]) => text.replace(name, one), WORDS[words]);

// `say` is told what is found so far while there is `more` to come.
function background(state, say = () => {}) {
  const found = { errors: [] }, refuse = (message) => {
    if (!found.errors.some((one) => one.message === message)) found.errors.push({ parameter: "", message });
  };
  const field = new Field(state), why = field.car.impossible() || refused(field.car, field.road);
  const parts = why ? [] : field.car.steers ? ["carpet"] : ["carpet", "front", "bound"];
  if (why) refuse(why);
  for (const part of parts) {
    if (part === "bound" && !found.front) continue;
    try {
      Object.assign(found, field[part]());
    } catch (error) {
      if (!(error instanceof Refusal)) throw error;
      refuse(error.message);
    }
    if (part !== parts.at(-1)) say({ ...found, more: true });
  }
  return found;
}
