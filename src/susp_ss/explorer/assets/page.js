// The page as a whole: what is asked of the engine and when, and what is drawn of its answers.
"use strict";
window.explorer = window.explorer || {};

explorer.page = (() => {
  const { html } = explorer;
  const AGAIN = 1000; // ms until an unanswered question is asked again.
  const QUIET = 500; // ms without a move until slow things are asked for and numbers are read out.
  const NAMES = ["A", "B", "C", "D"];
  const NEEDS = { ride: "bump", carpet: "metrics" }; // Parts of the results by other names than their panels.
  const FAST = ["metrics", "comfort", "ride", "modes", "bode", "psd", "speeds", "carpet", "surrogates"];

  let here; // {state, pins} of the page.
  let address = []; // What is wrong with the URL, until something moves.
  const wrong = new Map(); // What else is, by its name.
  let flying = false; // Whether a question is not answered yet.
  let now = { key: null, files: null, state: null, results: null };
  let background = { key: null, found: null }; // Of the carpet, which takes seconds.
  let slowFlight = null; // The conditions of the background on its way.
  let quiet = null; // The timer that runs while something moves.
  const answers = new Map(); // {key, results} of pinned designs.
  const waiting = new Set(); // Panels out of view whose picture is old, until nothing moves.
  const seen = new Set();

  const element = (name) => document.getElementById(name);
  const keyOf = (state) => JSON.stringify(state);

  // The designs to compare with; without a pin, the one that the page began with.
  function references() {
    const { state, pins } = here;
    const some = pins.length ? pins : [explorer.state.design(explorer.state.usual(state.model))];
    return some.map((pin, i) => {
      const pinned = explorer.state.pinned(pin, state);
      return {
        name: pins.length ? NAMES[i] : "start",
        style: NAMES[i].toLowerCase(),
        pin,
        state: pinned,
        key: keyOf(pinned),
      };
    });
  }

  // One question at a time, and always the newest: of the design that moves, and of those to compare with that are old.
  function ask() {
    if (flying) return;
    const { state } = here;
    const key = keyOf(state);
    const old = references().filter((one) => one.key !== key && answers.get(one.pin)?.key !== one.key);
    const files = explorer.opened.files();
    const busy = now.key !== key || now.files !== files || old.length > 0;
    element("panels").setAttribute("aria-busy", busy);
    if (!busy) return;
    flying = true;
    explorer.answers.live(
      { state, pins: old.map((one) => one.state), files },
      ({ found, pins }) => answered({ key, files, state, results: found }, old, pins),
      unanswered,
    );
  }

  function unanswered() {
    refuse("answer", "No answer; asked again.");
    setTimeout(() => ((flying = false), ask()), AGAIN);
  }

  function answered(next, old, pins) {
    flying = false;
    wrong.delete("answer");
    old.forEach(({ pin, key }, i) => answers.set(pin, { key, results: pins[i] }));
    now = next;
    complain(next.results.errors);
    ask(); // While this is drawn, the next is on its way.
    draw();
    if (!quiet) say();
  }

  function designs() {
    const others = references().map(({ name, style, pin, key }) => {
      const results = key === now.key ? now.results : answers.get(pin)?.results;
      return { name, style, results };
    });
    return [{ name: "now", style: "now", results: now.results }, ...others];
  }

  function draw(names = FAST) {
    if (!now.results) return;
    const all = designs();
    for (const name of names) {
      const found = now.results[NEEDS[name] ?? name];
      const none = found?.length === 0; // There is no such thing.
      const panel = element(`panel-${name}`);
      element(name).hidden = !found || none; // It could not be computed; the line above the page says why.
      panel.hidden = none && !panel.contains(element("open"));
      waiting.delete(name);
      if (!found || none) continue;
      if (seen.has(name) || !quiet) (explorer.tables[name] ?? explorer.panels[name])(all, now.state, background.found);
      else waiting.add(name);
    }
    document.dispatchEvent(new Event("drawn"));
  }

  // Moves

  // ``name`` is of the slider that moves, so that its moves are one step; null is a step of its own.
  function move(name, next) {
    here = { ...here, ...next };
    address = [];
    wrong.clear();
    explorer.steps.move(name, explorer.state.write(here));
    shown();
  }

  function set(row, value, more = []) {
    const state = structuredClone(here.state);
    if (!row.whole) for (const pair of [[row, value], ...more]) explorer.state.put(state, ...pair);
    else if (value) explorer.state.begin(state, row.name);
    else state[row.name] = null;
    explorer.state.unseated(state);
    move(row.kind === "number" ? row.name : null, { state });
  }

  function shown() {
    explorer.words.model = here.state.model;
    explorer.controls.update(here.state);
    element("models").firstChild.value = here.state.model;
    element("undo").disabled = !explorer.steps.back();
    element("redo").disabled = !explorer.steps.forward();
    element("pin").disabled = here.pins.length >= explorer.state.PINS;
    pins();
    complain();
    clearTimeout(quiet);
    quiet = setTimeout(settle, QUIET);
    ask();
  }

  function pins() {
    const key = here.pins.join();
    if (element("pins").dataset.shown === key) return;
    element("pins").dataset.shown = key;
    const button = (text, words, act) => {
      const made = html("button", { type: "button", "aria-label": words, title: words }, text);
      made.addEventListener("click", act);
      return made;
    };
    element("pins").replaceChildren(
      ...here.pins.map((pin, i) => {
        const name = NAMES[i];
        const others = here.pins.filter((_, j) => j !== i);
        const style = name.toLowerCase();
        const swatch = explorer.svg(
          "svg",
          { class: "swatch", "aria-hidden": true },
          explorer.svg("path", { class: `line ${style}`, d: "M0,5H26" }),
        );
        return html(
          "li",
          {},
          swatch,
          html("b", {}, name),
          i
            ? button("Ref", `Compare with ${name}`, () => move(null, { pins: [pin, ...others] }))
            : html("span", { class: "quiet", title: "Others are compared with it" }, "reference"),
          button("Take", `Go on from design ${name}`, () =>
            move(null, { state: explorer.state.pinned(pin, here.state) }),
          ),
          button("\u00d7", `Unpin design ${name}`, () => move(null, { pins: others })),
        );
      }),
    );
    for (const kept of answers.keys()) if (!references().some(({ pin }) => pin === kept)) answers.delete(kept);
    draw();
  }

  // Springs and dampers by name, within the reach of their sliders.
  function take(design) {
    const state = structuredClone(here.state);
    for (const row of explorer.state.rows(state.model)) {
      if (row.table !== "vehicle" || !(row.key in design)) continue;
      explorer.state.put(state, row, explorer.state.within(row, Number(design[row.key].toPrecision(6))));
    }
    move(null, { state });
  }

  function refuse(name, message) {
    if (message) wrong.set(name, message);
    else wrong.delete(name);
    complain();
  }

  let said = [];
  function complain(errors = said) {
    said = errors;
    const messages = [...address, ...said].map(({ message }) => message);
    const lines = [...new Set([...messages, ...wrong.values()])];
    if (element("errors").dataset.shown === lines.join("\n")) return;
    element("errors").dataset.shown = lines.join("\n");
    element("errors").replaceChildren(...lines.map((line) => html("li", {}, line)));
  }

  // Once nothing moves: what takes seconds, pictures out of view, and the numbers for those who listen.
  function settle() {
    quiet = null;
    askSlowly();
    if (waiting.size) draw([...waiting]);
    say();
  }

  function say() {
    if (!now.results?.metrics) return;
    const [first, before] = designs().map(({ results }) => results?.metrics?.[0]);
    const { one, unit } = explorer.words.metric(first.name, first.unit);
    const [number, change] = [
      explorer.numbers.brief(first.value / one),
      explorer.numbers.change(first.value, before?.value),
    ];
    element("said").textContent = `${explorer.words.output(first.name)} ${number} ${unit}, ${change}`;
  }

  function arrive() {
    const { errors, ...found } = explorer.state.read(location.search);
    here = found;
    address = errors;
    wrong.clear();
    shown();
  }

  // Once, when Dash has the page ready.
  function start(table) {
    if (here) return;
    explorer.table = table;
    explorer.state.load(table);
    const models = explorer.state.models().map((name) => html("option", { value: name }, name));
    const select = html("select", { id: "model", "aria-label": "Model" }, ...models);
    select.addEventListener("change", () => move(null, { state: explorer.state.changed(here.state, select.value) }));
    element("models").append(select);
    explorer.controls.listen(set);
    explorer.opened.start(ask);
    buttons();
    const watch = new IntersectionObserver((entries) => {
      for (const { target, isIntersecting } of entries) {
        const name = target.id.replace("panel-", "");
        seen[isIntersecting ? "add" : "delete"](name);
        if (isIntersecting && waiting.has(name)) draw([name]);
      }
    });
    for (const panel of document.querySelectorAll(".panel")) watch.observe(panel);
    window.addEventListener("popstate", () => (explorer.steps.arrived(), arrive()));
    arrive();
  }

  function buttons() {
    const on = (name, act) => element(name).addEventListener("click", act);
    on("undo", () => explorer.steps.go(-1));
    on("redo", () => explorer.steps.go(1));
    on("pin", () => move(null, { pins: [...here.pins, explorer.state.design(here.state)] }));
    for (const button of document.querySelectorAll("#downloads button")) {
      button.addEventListener("click", () => download(button.id.replace("download-", "")));
    }
    document.addEventListener("keydown", (event) => {
      if (!(event.ctrlKey || event.metaKey) || event.altKey || event.target.type === "text") return;
      const key = event.key.toLowerCase();
      const by = key === "z" ? (event.shiftKey ? 1 : -1) : key === "y" ? 1 : 0;
      if (!by) return;
      event.preventDefault();
      explorer.steps.go(by);
    });
    for (const name of ["ride", "modes"]) element(`${name}-tools`).append(player());
    for (const name of ["ride", "modes", "bode", "psd", "speeds", "carpet"]) {
      const title = element(`${name}-title`).textContent;
      const png = html("button", { type: "button", "aria-label": `Download ${title} as PNG` }, "PNG");
      png.addEventListener("click", () => explorer.png(element(`panel-${name}`), name));
      element(`${name}-tools`).append(png);
    }
  }

  // What the engine or the server makes of this design, without the pins; it says where it cannot.
  async function download(kind) {
    const query = explorer.state.write({ ...here, pins: [] }), { engine } = dash_clientside;
    const { name, content, message } = await (engine ? engine.file(kind, here.state, query) : served(kind, query));
    refuse("download", message);
    if (message) return;
    const href = URL.createObjectURL(content);
    explorer.save(href, name);
    URL.revokeObjectURL(href);
  }

  async function served(kind, query) {
    const answer = await fetch(`download/${kind}?${query}`);
    if (!answer.ok) return { message: await answer.text() };
    const name = answer.headers.get("Content-Disposition").match(/filename="(.*)"/)[1];
    return { name, content: await answer.blob() };
  }

  function player() {
    const button = html("button", { type: "button", class: "player" });
    const say = () => {
      for (const each of document.querySelectorAll(".player"))
        each.textContent = explorer.motion.playing() ? "Pause" : "Play";
      button.textContent = explorer.motion.playing() ? "Pause" : "Play";
    };
    button.addEventListener("click", () => (explorer.motion.play(!explorer.motion.playing()), say()));
    say();
    return button;
  }

  // What the background hangs on.
  function frame() {
    const { bump, bode, ...conditions } = explorer.state.unsprung(here.state);
    return keyOf(conditions);
  }

  // Of the newest conditions alone; what is still on its way for others is given up.
  function askSlowly() {
    const key = frame();
    if (key === slowFlight || key === background.key) return;
    slowFlight = key;
    explorer.answers.slow(here.state, answeredSlowly, () => answeredSlowly({ errors: [{ message: "no answer" }] }));
    settled({ key: null, found: null }, true);
  }

  function answeredSlowly({ more, ...found }) {
    const key = slowFlight;
    if (!more) slowFlight = null;
    settled({ key: more ? null : key, found }, more);
    if (!quiet) askSlowly();
  }

  function settled(next, more = false) {
    background = next;
    element("carpet").setAttribute("aria-busy", more);
    element("carpet-tools").dataset.said = more
      ? "computing …"
      : next.found.errors.map(({ message }) => message).join("\n");
    draw(["carpet"]);
  }

  return { start, refuse, take };
})();

window.dash_clientside = Object.assign(window.dash_clientside || {}, {
  explorer: {
    start: (table) => explorer.page.start(table),
  },
});
