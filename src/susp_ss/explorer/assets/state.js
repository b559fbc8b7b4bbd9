// The state of the page, as the URL has it, and the way back.
"use strict";
window.explorer = window.explorer || {};

explorer.state = (() => {
  // What belongs to the road and to the pictures is not a design's own: pins leave it out.
  const COMMON = ["road", "bump", "carpet", ""];

  let table; // As Given.document of the package writes it.

  const rows = (model) => table.models[model].rows;
  const models = () => Object.keys(table.models);
  const usual = (model) => structuredClone(table.models[model].default);
  const own = (row) => !COMMON.includes(row.table);
  const optional = (row) => table.optional.includes(row.table);
  const get = (state, row) => (row.table ? state[row.table]?.[row.key] : state[row.key]);

  function put(state, row, value) {
    if (!row.table) state[row.key] = value;
    else (state[row.table] ??= {})[row.key] = value;
  }

  // A curve or a seat begins with what its rows are by default.
  function begin(state, optionalTable) {
    for (const row of rows(state.model)) if (row.table === optionalTable) put(state, row, row.default);
  }

  function write({ state, pins }) {
    return new URLSearchParams([...parts(state, () => true), ...pins.map((pin) => ["pin", pin])])
      .toString()
      .replace(/%40/g, "@")
      .replace(/%2C/g, ",");
  }

  function parts(state, wanted) {
    const found = state.model === models()[0] ? [] : [["model", state.model]];
    for (const row of rows(state.model).filter(wanted)) {
      const value = get(state, row);
      if (value === undefined || value === null) continue;
      if (optional(row) || String(value) !== String(get(table.models[state.model].default, row))) {
        found.push([row.name, String(value)]);
      }
    }
    return found;
  }

  // A design alone, as a pin keeps it.
  const design = (state) => new URLSearchParams(parts(state, own)).toString();

  // A pinned design under the conditions of the page.
  function pinned(pin, state) {
    const { state: alone } = read(pin);
    for (const row of rows(alone.model)) {
      const common = own(row) ? undefined : get(state, row);
      if (common !== undefined && !wrong(row, common)) put(alone, row, common);
    }
    return unseated(alone).state;
  }

  // What is right of a query; what is wrong with the rest is said.
  function read(text) {
    const query = new URLSearchParams(text);
    const errors = [];
    let model = query.getAll("model").at(-1) ?? models()[0];
    if (!models().includes(model)) {
      errors.push(error("model", `model must be one of ${models().join(", ")}, got '${model}'`));
      model = models()[0];
    }
    const state = usual(model);
    const known = new Map(rows(model).map((row) => [row.name, row]));
    const { PINS } = explorer.state;
    const given = query.getAll("pin");
    if (given.length > PINS) errors.push(error("pin", `pin must be at most ${PINS} designs, got ${given.length}`));
    for (const [name, word] of query) {
      if (name === "model" || name === "pin") continue;
      const row = known.get(name);
      if (!row) errors.push(error(name, `no parameter of ${model} named '${name}'`));
      else {
        const value = row.kind === "choice" ? (row.several ? word.split(",") : word) : number(word);
        const what = wrong(row, value);
        if (what) errors.push(error(name, what));
        else {
          if (optional(row) && !state[row.table]) begin(state, row.table);
          put(state, row, value);
        }
      }
    }
    errors.push(...unseated(state).errors);
    // A pin of a model that is not there is none; what else is wrong in one is said, and the rest stands.
    const pins = given.slice(0, PINS).filter((pin) => {
      const found = read(pin).errors;
      errors.push(...found.map(({ message }) => error("pin", `pin: ${message}`)));
      return !found.some(({ parameter }) => parameter === "model");
    });
    return { state, pins, errors };
  }

  // Without a seat, what else was asked for than its outputs, or else what is by default.
  function unseated(state) {
    const errors = [];
    for (const row of state.seat ? [] : rows(state.model).filter(({ seated }) => seated?.length)) {
      const own = [get(state, row)].flat();
      const [missing] = own.filter((one) => row.seated.includes(one));
      if (missing === undefined) continue;
      errors.push(error(row.name, `${row.name} ${missing} needs a seat, got none`));
      const left = row.several ? own.filter((one) => !row.seated.includes(one)) : [];
      put(state, row, left.length ? left : structuredClone(row.default));
    }
    return { state, errors };
  }

  const number = (word) => (word.trim() && Number.isFinite(Number(word)) ? Number(word) : word);
  const error = (parameter, message) => ({ parameter, message });

  // What is wrong with a value, in one line; nothing if it is right. The server judges once more.
  function wrong(row, value) {
    if (row.kind === "choice") {
      const right = [value].flat().every((one) => row.options.includes(one));
      const need = `${row.several ? "some" : "one"} of ${row.options.join(", ")}`;
      return right ? "" : `${row.name} must be ${need}, got '${value}'`;
    }
    if (typeof value === "number" && value >= row.least && value <= row.most) return "";
    const got = typeof value === "number" ? value : `'${value}'`;
    return `${row.name} must be a number from ${row.least} to ${row.most}${row.unit && " "}${row.unit}, got ${got}`;
  }

  const within = (row, value) => Math.min(row.most, Math.max(row.least, value));

  // Another model on the same road; of what was shown, what it has as well.
  function changed(state, model) {
    const next = usual(model);
    for (const row of rows(model)) {
      const value = own(row) ? undefined : get(state, row);
      if (value !== undefined && !wrong(row, value)) put(next, row, value);
    }
    return unseated(next).state;
  }

  // Without its springs and dampers: what the background of the carpet hangs on.
  function unsprung(state) {
    const own = rows(state.model).filter((row) => row.table === "vehicle" && table.design.includes(row.group));
    const vehicle = Object.entries(state.vehicle).filter(([name]) => !own.some(({ key }) => key === name));
    return { ...state, vehicle: Object.fromEntries(vehicle) };
  }

  const load = (document) => (table = document);
  return {
    PINS: 4,
    load,
    models,
    rows,
    usual,
    own,
    optional,
    get,
    put,
    begin,
    unseated,
    within,
    write,
    read,
    number,
    wrong,
    design,
    pinned,
    unsprung,
    changed,
  };
})();

// Each step back is one of the browser's own: Back and Forward, Undo and Redo are the same.
explorer.steps = (() => {
  const QUIET = 150; // ms without a move until the URL is written: browsers refuse more than some 200 in 10 s.
  const TOGETHER = 800; // ms within which further moves of one slider are the same step.

  let at = history.state?.step ?? 0;
  // A page that is loaded again, or come back to, still has the steps after it.
  const [{ type }] = performance.getEntriesByType("navigation");
  let last = type === "navigate" ? at : Math.max(at, Number(sessionStorage.getItem("steps")));
  let moving = { name: null, until: 0 };
  let waiting = null;
  let newest = "";

  const address = (query) => location.pathname + (query && `?${query}`) + location.hash;

  // The URL of a step must be whole before another begins.
  function settle() {
    if (waiting === null) return;
    clearTimeout(waiting);
    waiting = null;
    history.replaceState({ step: at }, "", address(newest));
  }

  // The first move of a slider is a step; those after it, while it moves on, change that step.
  function move(name, query) {
    const now = performance.now();
    const onwards = name !== null && name === moving.name && now < moving.until;
    moving = { name, until: now + TOGETHER };
    if (onwards) {
      newest = query;
      clearTimeout(waiting);
      waiting = setTimeout(settle, QUIET);
      return;
    }
    settle();
    last = ++at;
    sessionStorage.setItem("steps", last);
    history.pushState({ step: at }, "", address(query));
  }

  function arrived() {
    clearTimeout(waiting);
    waiting = null;
    moving = { name: null, until: 0 };
    at = history.state?.step ?? 0;
  }

  function go(by) {
    settle();
    history.go(by);
  }

  // Nobody who lets go of a slider waits for the URL.
  for (const end of ["pointerup", "keyup"]) document.addEventListener(end, settle);

  return { move, arrived, go, back: () => at > 0, forward: () => at < last };
})();
