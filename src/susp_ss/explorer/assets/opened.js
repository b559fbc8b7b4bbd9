// Surrogates whose files are opened in the page itself, where there is no server that has any.
"use strict";
window.explorer = window.explorer || {};

explorer.opened = (() => {
  const { html } = explorer;
  const element = (name) => document.getElementById(name);

  let files; // Of {name, text}, another list after each change; nothing where a server answers.
  let wrong = []; // One line for each file that is none, of those opened last.
  let changed = () => {};

  // Say whom to tell that other files are open.
  function start(told) {
    if (!element("open")) return;
    [files, changed] = [[], told];
    const input = html("input", { type: "file", accept: ".json", multiple: true, hidden: true });
    input.addEventListener("change", async () => {
      wrong = [];
      for (const file of [...input.files]) await open(file);
      input.value = ""; // The same file may be opened again.
      take(files);
    });
    element("open").addEventListener("click", () => input.click());
    element("open").after(input);
  }

  // Of one name there is the last.
  async function open(file) {
    const text = await file.text().catch(() => null);
    const message = text === null ? "cannot be read" : dash_clientside.engine.wrong(text);
    if (message) wrong.push(`${file.name}: ${message}`);
    else files = [...others(file), { name: file.name, text }];
  }

  const others = ({ name }) => files.filter((one) => one.name !== name);

  function close(file) {
    wrong = [];
    take(others(file));
    element("open").focus();
  }

  function take(next) {
    files = next;
    const shown = files.map((file) => {
      const words = `Close ${file.name}`;
      const button = html("button", { type: "button", "aria-label": words, title: words }, "\u00d7");
      button.addEventListener("click", () => close(file));
      return html("li", {}, file.name, button);
    });
    element("surrogates-set").replaceChildren(
      ...wrong.map((line) => html("p", { class: "wrong", role: "alert" }, line)),
      ...(files.length ? [html("ul", { class: "opened", "aria-label": "Opened surrogates" }, ...shown)] : []),
    );
    changed();
  }

  return { start, files: () => files };
})();
