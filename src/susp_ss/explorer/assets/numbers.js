// Numbers as people read them: few digits, a true minus sign, the unit that pictures use.
"use strict";
window.explorer = window.explorer || {};

explorer.numbers = (() => {
  const MINUS = "\u2212";
  const NOTHING = "\u2013";

  // Three significant digits and never fewer than the whole ones, in powers of ten where zeros would hide the number.
  function brief(value, digits = 3) {
    if (value === null || value === undefined) return NOTHING;
    if (value === 0) return "0";
    const size = Math.floor(Math.log10(Math.abs(value)) + 1e-12);
    if (size < -3 || size > 6) {
      const [mantissa, power] = value.toExponential(digits - 1).split("e");
      return `${signed(mantissa)}·10${superscript(Number(power))}`;
    }
    return signed(value.toFixed(Math.max(0, digits - 1 - size)));
  }

  // As many digits as tell a step from the next.
  function stepped(value, step) {
    const decimals = Math.max(0, Math.ceil(-Math.log10(step) - 1e-9));
    return signed(String(Number(value.toFixed(Math.min(decimals, 12)))));
  }

  // "+3.2 %" against a reference; nothing where there is none.
  function change(value, reference) {
    if (value === null || reference === null || reference === undefined || !reference) return "";
    const percent = 100 * (value / reference - 1);
    if (Math.abs(percent) < 0.05) return "0.0\u202f%";
    const digits = Math.abs(percent) < 99.95 ? 1 : 0;
    return `${percent > 0 ? "+" : MINUS}${Math.abs(percent).toFixed(digits)}\u202f%`;
  }

  const signed = (text) => text.replace("-", MINUS);
  const superscript = (power) =>
    String(power)
      .replace("-", "\u207b")
      .replace(/\d/g, (digit) => "⁰¹²³⁴⁵⁶⁷⁸⁹"[digit]);

  return { brief, stepped, change };
})();

// What the package calls its quantities, places and units.
explorer.words = (() => {
  const known = () => explorer.table.words;
  const split = (name) => name.split("@");

  // An output by one name with a seat and without: only beside a seat has the one point of a quarter car a name.
  const bare = (name) => name.replace(/@body$/, "");

  function output(name) {
    const [metric, place] = split(name);
    const meaning = known().quantities[metric]?.meaning ?? metric;
    return place ? `${meaning}, ${placed(place)}` : meaning;
  }

  // One letter stands for two places: of a car with a left side, r is the right.
  function placed(place) {
    const sided = explorer.state.rows(explorer.words.model).some((row) => row.options?.includes("sws@l"));
    return place === "r" && sided ? "right" : (known().places[place] ?? place);
  }

  // As a picture's title has it, with the place as the engine writes it.
  const title = (name) =>
    split(name)[1]
      ? `${known().quantities[split(name)[0]]?.meaning ?? split(name)[0]} ${split(name)[1]}`
      : output(name);

  // Text in which ``K_s`` is a symbol with its index.
  function symbols(text) {
    return text.split(/\b([A-Za-z]_[A-Za-z]+)\b/).map((part, i) => {
      if (i % 2 === 0) return part;
      const [letter, index] = part.split("_");
      return explorer.html("span", {}, explorer.html("i", {}, letter), explorer.html("sub", {}, index));
    });
  }

  // The unit of the page and how much of the SI unit one of it is.
  const shown = (row) => known().units[row.name];

  function metric(name, unit = "") {
    return known().quantities[split(name)[0]] ?? { unit: unit.replace("^2", "²").replace("^3", "³"), one: 1 };
  }

  const sentence = (text) => text[0].toUpperCase() + text.slice(1);
  const within = (text, unit) => (unit ? `${text} (${unit})` : text);

  return { model: null, bare, output, placed, title, symbols, shown, metric, sentence, within };
})();
