// Surrogates whose files are opened in the page itself, where there is no server that has any.
"use strict";
window.explorer = window.explorer || {};

explorer.opened = (() => {
  const { html } = explorer;
  const element = (name) => document.getElementById(name);

  let files; // Of {name, text}, another list after each change; nothing where a server answers.
  let changed = () => {};

  // Say whom to tell that other files are open.
  function start(told) {
    if (!element("open")) return;
    [files, changed] = [[], told];
    const input = html("input", { type: "file", accept: ".json", multiple: true, hidden: true, id: "opened" });
    input.addEventListener("change", async () => {
      for (const file of [...input.files]) await open(file);
      input.value = ""; // The same file may be opened again.
    });
    element("open").addEventListener("click", () => input.click());
    element("open").after(input);
  }

  // One line says why a file is none; of one name there is the last.
  async function open(file) {
    const text = await file.text().catch(() => null);
    const message = text === null ? "cannot be read" : dash_clientside.engine.wrong(text);
    explorer.page.refuse(`open ${file.name}`, message && `${file.name}: ${message}`);
    if (!message) take([...others(file), { name: file.name, text }]);
  }

  const others = ({ name }) => files.filter((one) => one.name !== name);

  function take(next) {
    files = next;
    const shown = files.map((file) => {
      const words = `Close ${file.name}`;
      const close = html("button", { type: "button", "aria-label": words, title: words }, "\u00d7");
      close.addEventListener("click", () => {
        take(others(file));
        element("open").focus();
      });
      return html("li", {}, file.name, close);
    });
    const list = html("ul", { class: "opened", "aria-label": "Opened surrogates" }, ...shown);
    element("surrogates-set").replaceChildren(...(files.length ? [list] : []));
    changed();
  }

  return { start, files: () => files };
})();
