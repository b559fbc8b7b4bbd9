// What surrogates of opened files predict of a state's car, beside its exact value: susp_ss.explorer.surrogates.

// A file's text as surrogates; what is wrong with it is said by a Refusal.
function surrogateOf(text) {
  let document;
  try {
    document = JSON.parse(text);
  } catch (error) {
    throw new Refusal(`${WORDS.no_json}: ${error.message.replace(/\s+/g, " ")}`);
  }
  if (document?.format !== FITTED.format) throw new Refusal(WORDS.no_surrogate);
  const { version, susp_ss: release, stated = {} } = document;
  if (!Number.isInteger(version) || version < 1) throw damaged(`version is ${version}`);
  if (version > FITTED.version) {
    throw new Refusal(WORDS.newer.replace(`version ${FITTED.version + 1}`, `version ${version}`).replace("{release}", release));
  }
  const inputs = [...tableOf(document.inputs, "inputs").keys()], outputs = [...tableOf(document.outputs, "outputs")];
  tableOf(stated, "stated");
  tableOf(document.low_fidelity, "low_fidelity");
  if (!inputs.length || !outputs.length) throw damaged("it has no inputs or no outputs");
  try {
    return elsewhere(() => {
      const cheap = new CheapModel(document.low_fidelity);
      return { inputs, cheap, outputs: outputs.map(([name, numbers]) => outputOf(name, numbers, version, inputs, cheap)) };
    });
  } catch (error) {
    // Nothing where there should be a table, or lists in lists without end.
    throw error instanceof TypeError || error instanceof RangeError ? damaged(error.message) : error;
  }
}

// What is made, or { refused } of what only susp-ss explore makes.
function elsewhere(make) {
  try {
    return make();
  } catch (error) {
    if (error instanceof Elsewhere) return { refused: error.message };
    throw error;
  }
}

function outputOf(name, numbers, version, columns, cheap) {
  for (const part of ["settings", "found", "accuracy"]) tableOf(numbers?.[part], `${name}: ${part}`);
  const { kind, unit, box } = numbers, called = numbers.accuracy.surrogate ?? kind;
  if (typeof unit !== "string") throw damaged(`${name} has no unit`);
  if (!Object.hasOwn(MADE, kind)) throw damaged(filled(WORDS.no_kind, { name: kind }));
  if (version < FITTED.version && FITTED.foreign.includes(kind)) throw damaged(`${name} is a ${kind} of file version ${version}`);
  if (String(numbers.columns) !== String(columns)) throw damaged(`${name} must have the columns ${columns.join(", ")}`);
  const [lowest, highest] = [0, 1].map((end) => numbersOf(box?.[end]?.map((one) => one ?? 0), `box of ${name}`, columns.length)
    .map((one, i) => box[end][i] ?? (end ? Infinity : -Infinity)));
  const made = elsewhere(() => {
    const model = MADE[kind](numbers, (tuned) => cheap.response(name, columns, tuned)), filter = cheap.through(metricAndPlace(name).metric);
    const somewhere = lowest.map((one) => (Number.isFinite(one) ? one : Math.sign(one)));
    if (!Number.isFinite(model.predict(somewhere).value)) throw damaged(`${name} has no finite value`);
    return { model, filter };
  });
  return { name, unit, called, lowest, highest, ...made };
}

// Whether a design lies outside a box, by more than rounding.
const outsideOf = (design, { lowest, highest }) => design.some((one, i) => {
  const edge = FITTED.edge * Math.max(Math.abs(lowest[i]), Math.abs(highest[i]));
  return one < lowest[i] - edge || one > highest[i] + edge;
});

// The value of an input that a car or its road has.
function inputOf(name, car, road) {
  if (Object.hasOwn(FITTED.road, name)) return road[name];
  const { fields } = car.files.call, [field, wheels] = Object.hasOwn(car.named, name) ? car.named[name] : [name, []];
  const rate = (key) => {
    const at = car.dampers ? car.dampers.indexOf(key) : -1;
    return at < 0 ? car.parameters[key] : 0.5 * (car.laws[at].slopes[1] + car.laws[at].slopes[2]);
  };
  const values = wheels.map((wheel) => rate(fields[field]?.wheels ? `${field}_${wheel}` : field));
  if (values[0] === undefined) throw new Refusal(filled(WORDS.lacking, { name, kind: car.type }));
  if (new Set(values).size === 1) return values[0];
  const said = wheels.map((wheel, i) => `${wheel} ${general(values[i], 6)}`).join(", ");
  throw new Refusal(filled(WORDS.several, { name, wheels: wheels.join(", "), values: said }));
}

// What a car has of each output on the road of the fit, weighted as its runs were: where and how much.
function exactOf({ inputs, outputs, cheap }, design, car) {
  const ofRoad = inputs.map((name, i) => [name, design[i]]).filter(([name]) => Object.hasOwn(FITTED.road, name));
  const road = { ...cheap.road, ...Object.fromEntries(ofRoad) }, known = new Map();
  for (const { name, filter } of outputs) {
    const { metric } = metricAndPlace(name);
    if (filter && !car.measured.some((one) => one.name.split("@")[0] === metric)) throw unweighted(metric, car);
  }
  for (const filter of [null, ...outputs.map((one) => one.filter ?? null)]) {
    if (!known.has(filter)) known.set(filter, measuredThrough(car, road, filter));
  }
  return outputs.map(({ name, filter }) => {
    const { metric, place } = metricAndPlace(name), names = [`${metric}@${place ?? cheap.place}`, metric];
    const at = names.map((own) => car.measured.findIndex((one) => one.name === own)).find((row) => row >= 0);
    if (at === undefined) return { output: name, exact: null };
    return { output: car.measured[at].name, exact: finite(known.get(filter ?? null)[at]) };
  });
}

function predictions({ name, fitted }, state) {
  if (fitted.refused) return [{ surrogate: name, refused: fitted.refused }];
  const car = carOf(state), { inputs, outputs } = fitted, design = inputs.map((own) => inputOf(own, car, state.road));
  const predicted = outputs.map(({ model }) => model?.predict(design)), exact = exactOf(fitted, design, car);
  const outside = outputs.some((one) => outsideOf(design, one));
  return outputs.map(({ name: output, unit, called, refused: why }, i) => {
    const surrogate = `${name}: ${called}`;
    if (why) return { surrogate, refused: `${output}: ${why}` };
    const { value, low, high } = predicted[i], bounds = { low: finite(low), high: finite(high) };
    return { surrogate, output: exact[i].output, unit, value: finite(value), ...bounds, exact: exact[i].exact, outside };
  });
}

function unweighted(metric, car) {
  const names = new Set(car.measured.filter(({ damper }) => damper === null).map((one) => one.name.split("@")[0]));
  return new Refusal(filled(WORDS.unweighted, { name: `'${metric}'`, outputs: [...names].join(", ") }));
}

// What is opened, by its text; of a file that is opened no more, nothing is kept.
let opened = new Map();

// Rows of all opened files { name, text }, or why there are none.
function surrogates(files, state) {
  const before = opened;
  opened = new Map();
  return files.flatMap(({ name, text }) => {
    try {
      const fitted = before.get(text) ?? surrogateOf(text);
      opened.set(text, fitted);
      return predictions({ name, fitted }, state);
    } catch (error) {
      if (error instanceof Refusal) return [{ surrogate: name, refused: error.message }];
      throw error;
    }
  });
}

// Why a file's text is no surrogate; nothing if it is one, which is kept for the next answer.
function wrong(text) {
  try {
    kept(opened, text, () => surrogateOf(text));
    return "";
  } catch (error) {
    if (error instanceof Refusal) return error.message;
    throw error;
  }
}
