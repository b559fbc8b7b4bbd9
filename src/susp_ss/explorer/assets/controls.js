// The sliders, choices and fields of a model's table.
"use strict";
window.explorer = window.explorer || {};

explorer.html = (name, attributes = {}, ...children) => {
  const element = document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) {
    if (value === true) element.setAttribute(key, "");
    else if (value !== false && value !== undefined) element.setAttribute(key, value);
  }
  element.append(...children);
  return element;
};

// Text of an element that holds nothing else; what stays costs no layout.
explorer.say = (element, text) => {
  const node = element.firstChild ?? element.appendChild(document.createTextNode(""));
  if (node.data !== text) node.data = text;
};

explorer.controls = (() => {
  const { html } = explorer;
  const OPEN = ["springs", "dampers", "anti-roll bars", "road"];

  // What a picture shows stands beside it.
  const PLACED = { bump: "ride-set", carpet: "carpet-set", frequency: "bode-set" };

  let model = null;
  let show = []; // For each row, a function that shows a state.
  let changed = () => {};

  // Say whom to tell: changed(row, value), and more [row, value] where one step sets several.
  const listen = (told) => (changed = told);

  function update(state) {
    if (state.model !== model) build(state.model);
    for (const one of show) one(state);
  }

  function build(next) {
    model = next;
    show = [];
    const groups = new Map();
    for (const row of explorer.state.rows(model)) {
      if (!groups.has(row.group)) groups.set(row.group, []);
      groups.get(row.group).push(row);
    }
    const order = [...groups].sort(([a], [b]) => rank(a) - rank(b));
    const made = order.map(([name, rows]) => [name, group(name, rows)]);
    for (const panel of Object.values(PLACED)) document.getElementById(panel).replaceChildren();
    document
      .getElementById("sliders")
      .replaceChildren(...made.filter(([name]) => !PLACED[name]).map(([, part]) => part));
    for (const [name, part] of made) if (PLACED[name]) document.getElementById(PLACED[name]).append(part);
  }

  const rank = (name) => (OPEN.includes(name) ? OPEN.indexOf(name) : OPEN.length);

  function group(name, rows) {
    const parts = [];
    for (const table of new Set(rows.map((row) => row.table))) {
      const some = rows.filter((row) => row.table === table && row.name !== "spectrum").map(control);
      parts.push(...(explorer.state.optional({ table }) ? [optional(table, some)] : some));
    }
    if (PLACED[name] && name !== "frequency") return html("div", { role: "group", "aria-label": name }, ...parts);
    return html(
      "details",
      { open: OPEN.includes(name) },
      html("summary", {}, name === "frequency" ? "Outputs" : explorer.words.sentence(name)),
      ...parts,
    );
  }

  const WORDS = { curve: "Curve in place of the rate", seat: "Driver on a seat" };

  function optional(table, controls) {
    const box = html("input", { type: "checkbox", name: table });
    const inside = html("fieldset", { "aria-label": WORDS[table] }, ...controls);
    box.addEventListener("change", () => changed({ name: table, whole: true }, box.checked));
    show.push((state) => {
      box.checked = Boolean(state[table]);
      inside.hidden = !box.checked;
    });
    return html("div", {}, html("label", { class: "optional" }, box, WORDS[table]), inside);
  }

  const control = (row) => (row.kind === "choice" ? (row.several ? boxes(row) : choice(row)) : slider(row));

  // Whether an option is of the seat, and there is none.
  const absent = (row, option, state) => !state.seat && row.seated.includes(option);

  function choice(row) {
    const options = row.options.map((option) => html("option", { value: option }, explorer.words.output(option)));
    const select = html("select", { name: row.name }, ...options);
    select.addEventListener("change", () => changed(row, select.value));
    show.push((state) => {
      [...select.options].forEach((option) => (option.hidden = option.disabled = absent(row, option.value, state)));
      select.value = explorer.state.get(state, row);
      select.title = select.selectedOptions[0].textContent;
    });
    const caption = explorer.words.symbols(explorer.words.sentence(row.label));
    return html("label", { class: "choice" }, html("span", {}, ...caption), select);
  }

  function boxes(row) {
    const each = row.options.map((value) => html("input", { type: "checkbox", name: row.name, value }));
    const chosen = () => each.filter((box) => box.checked).map((box) => box.value);
    for (const box of each) {
      box.addEventListener("change", () => (chosen().length ? changed(row, chosen()) : (box.checked = true)));
    }
    show.push((state) => {
      const value = explorer.state.get(state, row);
      for (const box of each) {
        box.checked = value.includes(box.value);
        box.parentNode.hidden = absent(row, box.value, state);
      }
    });
    const labels = each.map((box) => html("label", {}, box, explorer.words.output(box.value)));
    return html("fieldset", { class: "boxes" }, html("legend", {}, explorer.words.sentence(row.label)), ...labels);
  }

  // A slider moves in steps, or in ratios; the field beside it takes any number of the range in the unit shown.
  function slider(row) {
    const { one, unit } = explorer.words.shown(row);
    const [least, most] = [row.least, row.most].map((value) => Number((value / one).toPrecision(12)));
    const typable = { ...row, unit, least, most };
    const steps = Math.round((row.most - row.least) / row.step);
    const [along, back] = row.logarithmic
      ? [
          (value) => Math.log(value / row.least) / Math.log(row.most / row.least),
          // Rounded, the ends may lie outside.
          (at) => explorer.state.within(row, Number((row.least * (row.most / row.least) ** at).toPrecision(3))),
        ]
      : [(value) => (value - row.least) / row.step, (at) => Number((row.least + row.step * at).toPrecision(12))];
    const range = html("input", {
      type: "range",
      name: row.name,
      ...(row.logarithmic ? { min: 0, max: 1, step: 0.005 } : { min: 0, max: steps, step: 1 }),
    });
    const field = html("input", { type: "text", inputmode: "decimal", autocomplete: "off", spellcheck: "false" });
    const caption = explorer.words.sentence(row.label);
    range.setAttribute("aria-label", caption);
    field.setAttribute("aria-label", unit ? `${caption} in ${unit}` : caption);
    const digits = row.logarithmic
      ? (value) => explorer.numbers.brief(value / one)
      : (value) =>
          explorer.numbers.stepped(
            value / one,
            Math.min(row.step / one, 10 ** (Math.floor(Math.log10(Math.abs(value / one) || 1)) - 3)),
          );
    range.addEventListener("input", () => changed(row, back(range.valueAsNumber)));
    field.addEventListener("change", () => {
      const typed = explorer.state.number(field.value.replace(",", ".").replace("\u2212", "-"));
      const what = explorer.state.wrong(typable, typed);
      field.setAttribute("aria-invalid", Boolean(what));
      explorer.page.refuse(row.name, what);
      if (!what) changed(row, Number((typed * one).toPrecision(12)));
    });
    show.push((state) => {
      const value = explorer.state.get(state, row);
      const right = field.getAttribute("aria-invalid") !== "true";
      if (value === undefined || value === null || (value === range.shown && right)) return;
      range.shown = value;
      range.value = along(value);
      field.value = digits(value);
      field.setAttribute("aria-invalid", false);
      range.setAttribute("aria-valuetext", `${digits(value)} ${unit}`);
      range.style.setProperty("--at", `${100 * (along(value) / (row.logarithmic ? 1 : steps))}%`);
    });
    const extra = row.name === "roughness" ? [classes(row)] : [];
    return html(
      "div",
      { class: "slider" },
      html("span", { class: "caption" }, ...explorer.words.symbols(caption)),
      ...extra,
      field,
      html("span", { class: "unit" }, unit),
      range,
    );
  }

  // A road's class by ISO 8608 sets the roughness to the class's mean; beside them, a measured road is as it was.
  function classes(row) {
    const known = explorer.table.classes;
    const [spectrum, waviness] = ["spectrum", "waviness"].map((name) =>
      explorer.state.rows(model).find((one) => one.name === name),
    );
    const names = [...(spectrum ? ["measured"] : []), ...Object.keys(known)];
    const options = names.map((name) => html("option", { value: name }, name));
    const title = spectrum ? `Measured: ${spectrum.label}; or class by ISO 8608` : "Class by ISO 8608";
    const select = html("select", { "aria-label": `Road. ${title}`, title }, ...options);
    select.addEventListener("change", () => {
      const value = known[select.value];
      if (!spectrum) return changed(row, value);
      const other = waviness ? [[waviness, value ? 2 : waviness.default]] : [];
      changed(spectrum, spectrum.options[value ? 1 : 0], [[row, value ?? row.default], ...other]);
    });
    // Classes reach a factor of two either way of their mean.
    show.push((state) => {
      if (spectrum && explorer.state.get(state, spectrum) === "measured") return (select.value = "measured");
      const value = explorer.state.get(state, row);
      const distance = (name) => Math.abs(Math.log(known[name] / value));
      select.value = Object.keys(known).reduce((best, name) => (distance(name) < distance(best) ? name : best));
    });
    return select;
  }

  return { listen, update };
})();
