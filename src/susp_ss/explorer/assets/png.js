// Panels as pictures to take away.
"use strict";
window.explorer = window.explorer || {};

explorer.save = (href, download) => Object.assign(document.createElement("a"), { href, download }).click();

// A panel as it stands, at twice the dots, without its buttons and with the key to the pinned designs.
explorer.png = async (panel, name) => {
  const { html, svg } = explorer;
  const { width, height } = panel.getBoundingClientRect();
  const copy = panel.cloneNode(true);
  copy.append(document.getElementById("pins").cloneNode(true));
  for (const part of copy.querySelectorAll("button, .tools, .set, li .quiet")) part.remove();
  const { fontFamily, color, backgroundColor } = getComputedStyle(document.body);
  const rules = [...document.styleSheets].filter(({ href }) => href).flatMap(({ cssRules }) => [...cssRules]);
  const style = html("style", {}, rules.map(({ cssText }) => cssText).join("\n"));
  const page = html(
    "div",
    { style: `font: 13px/1.35 ${fontFamily}; color: ${color}; background: ${backgroundColor}; height: ${height}px;` },
    style,
    copy,
  );
  const size = { width: 2 * width, height: 2 * height };
  const inside = svg("foreignObject", { width: "100%", height: "100%" }, page);
  const picture = svg("svg", { ...size, viewBox: `0 0 ${width} ${height}` }, inside);
  const image = new Image();
  image.src = `data:image/svg+xml;charset=utf-8,${encodeURIComponent(new XMLSerializer().serializeToString(picture))}`;
  await image.decode();
  const canvas = Object.assign(document.createElement("canvas"), size);
  canvas.getContext("2d").drawImage(image, 0, 0);
  explorer.save(canvas.toDataURL("image/png"), `${name}.png`);
};
