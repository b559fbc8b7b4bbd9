// Panels of numbers: metrics, comfort, surrogates.
"use strict";
window.explorer = window.explorer || {};

explorer.tables = (() => {
  const { html } = explorer;
  const { brief, change } = explorer.numbers;
  const { metric, sentence, within } = explorer.words;
  const body = (name) => document.getElementById(name);
  const cells = new Map(); // For each table, the cells to fill by row and column.

  // A table is built where its rows or columns change, else filled again.
  function table(name, caption, columns, rows) {
    const key = JSON.stringify([columns, rows.map((row) => [row.group, row.name])]);
    if (body(name).dataset.shown !== key) {
      body(name).dataset.shown = key;
      const head = html(
        "tr",
        {},
        ...columns.map(({ text, style = "", title }) => html("th", { scope: "col", class: style, title }, text)),
      );
      const filled = [];
      const groups = [];
      let group = null;
      for (const row of rows) {
        if (row.group !== group) {
          group = row.group;
          if (!group) groups.push(html("tbody"));
          else
            groups.push(
              html(
                "tbody",
                {},
                html("tr", { class: "group" }, html("th", { colspan: columns.length, scope: "rowgroup" }, group)),
              ),
            );
        }
        const own = columns.slice(1).map(({ style = "" }) => html("td", { class: style }));
        groups
          .at(-1)
          .append(html("tr", { class: row.alone && "alone" }, html("th", { scope: "row" }, row.name), ...own));
        if (row.note !== undefined) {
          own.push(html("td", { colspan: columns.length }));
          groups.at(-1).append(html("tr", { class: "note" }, own.at(-1)));
        }
        filled.push(own);
      }
      body(name).replaceChildren(html("table", { "aria-label": caption }, html("thead", {}, head), ...groups));
      cells.set(name, filled);
    }
    rows.forEach(({ values, note }, i) =>
      [...values, ...(note === undefined ? [] : [note])].forEach((value, j) => {
        const cell = cells.get(name)[i][j];
        const text = value?.text ?? value;
        explorer.say(cell, text);
        if (value?.turn !== undefined && cell.dataset.turn !== value.turn) cell.dataset.turn = value.turn;
      }),
    );
  }

  // A change in words and whether it is more or less.
  function changed(value, reference) {
    const text = change(value, reference);
    return { text, turn: text.startsWith("+") ? "more" : text.startsWith("\u2212") ? "less" : "" };
  }

  function metrics(designs) {
    const [now, ...others] = designs;
    const columns = [
      { text: "" },
      { text: "now", style: "now" },
      { text: `vs ${others[0].name}`, style: "change", title: "Change against the reference" },
      ...others.map(({ name, style }, i) => ({
        text: name,
        style: `pin ${style}`,
        title: i ? `Design ${name}` : `Design ${name}, the reference`,
      })),
    ];
    const found = others.map(
      ({ results }) => new Map((results?.metrics ?? []).map(({ name, value }) => [name, value])),
    );
    const rows = now.results.metrics.map(({ name, label, unit, value }) => {
      const [quantity, place] = name.split("@");
      const { one, unit: shown } = metric(name, unit);
      const text = (some) => brief(some === null || some === undefined ? null : some / one);
      const meaning = explorer.table.words.quantities[quantity]?.meaning ?? label;
      const titled = sentence(within(meaning, shown));
      return {
        ...(place ? { group: titled, name: explorer.words.placed(place) } : { alone: true, name: titled }),
        values: [text(value), changed(value, found[0].get(name)), ...found.map((some) => text(some.get(name)))],
      };
    });
    table("metrics", "Metrics", columns, rows);
  }

  function comfort(designs) {
    const [{ results }, reference] = designs;
    const columns = ["m/s²", "vertical", "roll", "pitch", "total", `vs ${reference.name}`].map((text, i) => ({
      text,
      style: { 4: "now", 5: "change" }[i],
    }));
    const before = new Map((reference.results?.comfort ?? []).map(({ point, total }) => [point, total]));
    const rows = results.comfort.map(({ point, wz, wroll, wpitch, total, words }) => ({
      name: point ? explorer.words.placed(point) : "body",
      values: [
        ...[wz, wroll, wpitch, total].map((value) => value?.toFixed(3) ?? brief(value)),
        changed(total, before.get(point)),
      ],
      note: words,
    }));
    table("comfort", "Weighted comfort", columns, rows);
  }

  function surrogates([{ results }]) {
    const styles = { predicted: "now", "vs exact": "change" };
    const columns = ["", "predicted", "exact", "vs exact"].map((text) => ({ text, style: styles[text] }));
    const rows = results.surrogates.map(({ surrogate, output, unit, value, low, high, exact, outside }) => {
      const { one, unit: shown } = metric(output, unit);
      const text = (some, digits) => brief(some === null ? null : some / one, digits);
      const where = exact >= low && exact <= high ? "within" : "outside";
      const interval = low === null ? "" : `95 % between ${text(low, 4)} and ${text(high, 4)}, exact ${where}`;
      return {
        group: sentence(within(explorer.words.output(output), shown)),
        name: surrogate,
        values: [text(value), text(exact), change(value, exact)],
        note: [interval, outside ? "outside its runs" : ""].filter(Boolean).join("; "),
      };
    });
    table("surrogates", "Surrogates", columns, rows);
  }

  return { metrics, comfort, surrogates };
})();
