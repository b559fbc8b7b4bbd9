"use strict";
(() => {
  const figures = JSON.parse(document.getElementById("figures").textContent);
  // On a touch screen the toolbar would always stand over the title; fingers zoom, and a double tap resets.
  const settings = {
    responsive: true,
    displaylogo: false,
    displayModeBar: matchMedia("(hover: hover)").matches ? "hover" : false,
    modeBarButtonsToRemove: ["select2d", "lasso2d", "zoomIn2d", "zoomOut2d", "autoScale2d"],
  };
  const plots = [...document.querySelectorAll(".plot")];

  const controls = (type, plot) => [...document.querySelectorAll(`input[type=${type}][data-plots~="${plot.id}"]`)];

  function draw(plot) {
    const view = controls("radio", plot).find((input) => input.checked)?.value ?? "";
    const shown = new Map(controls("checkbox", plot).map((input) => [input.value, input.checked]));
    const figure = figures[plot.id][view];
    const data = figure.data.map((trace) => ({ ...trace, visible: shown.get(trace.name) ?? true }));
    return Plotly.react(plot, data, figure.layout, settings);
  }

  function showView(view) {
    for (const part of document.querySelectorAll("[data-view]")) part.hidden = part.dataset.view !== view;
  }

  for (const input of document.querySelectorAll("input[data-plots]")) {
    input.addEventListener("change", () => {
      if (input.type === "radio") showView(input.value);
      for (const id of input.dataset.plots.split(" ")) draw(document.getElementById(id));
    });
    if (input.type === "radio" && input.checked) showView(input.value);
  }
  // What stands in for a surface is folded away on the screen only.
  addEventListener("beforeprint", () => {
    for (const part of document.querySelectorAll("details[data-print]")) part.open = true;
  });

  // Without WebGL, pictures and numbers stand in for surfaces.
  const solid = Boolean(document.createElement("canvas").getContext("webgl"));
  document.documentElement.classList.add("scripted");
  for (const plot of plots) {
    if (plot.classList.contains("space") && !solid) continue;
    plot.closest("figure").classList.add("live");
    draw(plot);
  }
})();
