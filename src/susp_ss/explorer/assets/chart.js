// Line charts, drawn by hand as SVG: a slider's move redraws all of them within a frame.
"use strict";
window.explorer = window.explorer || {};

explorer.svg = (name, attributes = {}, ...children) => {
  const element = document.createElementNS("http://www.w3.org/2000/svg", name);
  for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
  element.append(...children);
  return element;
};

explorer.Chart = class {
  static MARGIN = { top: 22, right: 10, bottom: 30, left: 44 };

  // A host has a width and a height by its style; the drawing follows them.
  constructor(host) {
    const { svg } = explorer;
    this.host = host;
    this.grid = svg("g", { class: "grid" });
    this.marks = svg("g", { "clip-path": `url(#clip-${host.id})` });
    this.title = svg("text", { class: "title", x: 2, y: 12 });
    this.under = svg("text", { class: "under", "text-anchor": "end" });
    this.cursor = svg("path", { class: "cursor" });
    this.reading = svg("text", { class: "reading", "text-anchor": "end", y: 12 });
    this.inside = svg("rect");
    this.picture = svg("svg", { role: "img" });
    const clip = svg("clipPath", { id: `clip-${host.id}` }, this.inside);
    this.picture.append(clip, this.grid, this.marks, this.cursor, this.title, this.under, this.reading);
    this.drawn = new Map();
    host.replaceChildren(this.picture);
    new ResizeObserver(() => this.measure()).observe(host);
    this.picture.addEventListener("pointermove", (event) => this.read(event.offsetX));
    this.picture.addEventListener("pointerleave", () => this.read(null));
  }

  measure() {
    const { clientWidth: width, clientHeight: height } = this.host;
    if (!width || (width === this.width && height === this.height)) return;
    const { top, right, bottom, left } = explorer.Chart.MARGIN;
    Object.assign(this, { width, height, ranges: "" });
    this.picture.setAttribute("viewBox", `0 0 ${width} ${height}`);
    const box = { x: left, y: top, width: width - left - right, height: height - top - bottom };
    for (const [key, value] of Object.entries(box)) this.inside.setAttribute(key, Math.max(0, value));
    this.under.setAttribute("x", width - right);
    this.under.setAttribute("y", height - 3);
    this.reading.setAttribute("x", width - right);
    if (this.shown) this.draw(this.shown);
  }

  // What a chart shows: axes {label, log, span, one, ticks}, lines and points [{key, style, name, x, y, area}], words.
  draw(shown) {
    this.shown = shown;
    if (!this.width) return this.measure();
    const { top, right, bottom, left } = explorer.Chart.MARGIN;
    const marks = [...shown.lines, ...(shown.points || [])];
    const [x, y] = ["x", "y"].map(
      (axis) =>
        new explorer.Scale(
          shown[axis],
          marks.map((mark) => mark[axis]),
          axis === "x" ? [left, this.width - right] : [this.height - bottom, top],
        ),
    );
    this.scales = { x, y };
    this.frame(x, y);
    this.picture.setAttribute("aria-label", shown.words || shown.y.label);
    for (const line of shown.lines) this.mark(line, explorer.Chart.path);
    for (const point of shown.points || []) this.mark(point, explorer.Chart.dot);
    const keys = new Set(marks.map(({ key }) => key));
    for (const [key, { element }] of this.drawn) {
      if (!keys.has(key)) (element.remove(), this.drawn.delete(key));
    }
    if (shown.at !== undefined) this.point(shown.at);
  }

  // A pinned design, whose values stay, is drawn again only where the ranges change.
  mark(mark, path) {
    const { key, style } = mark;
    if (!this.drawn.has(key)) this.drawn.set(key, { element: this.marks.appendChild(explorer.svg("path")) });
    const { element, x, y, ranges } = this.drawn.get(key);
    if (element.getAttribute("class") !== style) element.setAttribute("class", style);
    if (x === mark.x && y === mark.y && ranges === this.ranges) return;
    this.drawn.set(key, { element, x: mark.x, y: mark.y, ranges: this.ranges });
    element.setAttribute("d", path(mark, this.scales.x, this.scales.y));
  }

  static dot(point, x, y) {
    const [px, py, r] = [x.at(point.x[0]), y.at(point.y[0]), 4.5];
    return `M${px - r},${py}a${r},${r} 0 1 0 ${2 * r},0a${r},${r} 0 1 0 ${-2 * r},0Z`;
  }

  static path(line, x, y) {
    let [path, pen] = ["", "M"];
    for (let i = 0; i < line.x.length; i++) {
      const [px, py] = [x.at(line.x[i]), y.at(line.y[i])];
      if (!Number.isFinite(px + py)) pen = "M";
      else {
        path += `${pen}${px.toFixed(1)},${py.toFixed(1)}`;
        pen = "L";
      }
    }
    if (line.area) path += `L${x.at(line.x.at(-1))},${y.pixels[0]}L${x.at(line.x[0])},${y.pixels[0]}Z`;
    return path;
  }

  // Grid and labels change only where the ranges do.
  frame(x, y) {
    const ranges = [x, y].flatMap(({ label, ends, pixels }) => [label, ...ends, ...pixels]).join();
    if (ranges === this.ranges) return;
    this.ranges = ranges;
    this.title.textContent = y.label;
    this.under.textContent = x.label;
    const { svg } = explorer;
    const parts = [];
    for (const [value, text] of y.ticks) {
      const at = Math.round(y.at(value)) + 0.5;
      parts.push(svg("path", { class: "tick", d: `M${x.pixels[0]},${at}H${x.pixels[1]}` }));
      parts.push(svg("text", { x: x.pixels[0] - 5, y: at + 3.5, "text-anchor": "end" }, text));
    }
    for (const [value, text] of x.ticks) {
      const at = Math.round(x.at(value)) + 0.5;
      parts.push(svg("path", { class: "tick", d: `M${at},${y.pixels[0]}V${y.pixels[1]}` }));
      parts.push(svg("text", { x: at, y: y.pixels[0] + 13, "text-anchor": "middle" }, text));
    }
    this.grid.replaceChildren(...parts);
  }

  // A vertical line at a value of x.
  point(value) {
    const at = this.scales?.x.at(value);
    const { pixels } = this.scales?.y || {};
    this.cursor.setAttribute("d", Number.isFinite(at) ? `M${at.toFixed(1)},${pixels[0]}V${pixels[1]}` : "");
  }

  // What all lines are beneath the pointer.
  read(pixel) {
    const { scales, shown } = this;
    if (!scales || shown.still) return;
    const lines = shown.lines.filter((line) => line.name);
    if (pixel === null || !lines.length) {
      this.reading.textContent = "";
      this.title.style.visibility = "";
      return shown.at === undefined ? this.cursor.setAttribute("d", "") : this.point(shown.at);
    }
    const value = scales.x.under(pixel);
    const near = (line) =>
      line.x.reduce((best, x, i) => (Math.abs(x - value) < Math.abs(line.x[best] - value) ? i : best), 0);
    const [first] = lines;
    const said = lines.map((line) => `${line.name} ${scales.y.text(line.y[near(line)])}`);
    this.reading.textContent = `${scales.x.text(first.x[near(first)])} ${shown.x.unit || ""}: ${said.join("  ")}`;
    this.title.style.visibility = "hidden";
    this.point(first.x[near(first)]);
  }
};

// From values to pixels, with round ends that stay where they are while the values move a little.
explorer.Scale = class {
  constructor({ label, log = false, one = 1, span, decades = 4, every, least = 0.01 }, values, pixels) {
    Object.assign(this, { label, log, one, pixels, every, least });
    // A label needs more room beside than above another.
    this.most = Math.max(2, Math.floor(Math.abs(pixels[1] - pixels[0]) / (pixels[1] > pixels[0] ? 55 : 21)));
    this.ends = span ? span.map((value) => value / one) : this.around(values, decades);
    this.ticks = log ? this.powers() : this.steps();
    const [low, high] = this.ends.map((end) => this.along(end));
    this.factor = (pixels[1] - pixels[0]) / (high - low || 1);
    this.low = low;
  }

  along(value) {
    return this.log ? Math.log10(value) : value;
  }

  at(value) {
    return this.pixels[0] + (this.along(value / this.one) - this.low) * this.factor;
  }

  under(pixel) {
    const along = this.low + (pixel - this.pixels[0]) / this.factor;
    return this.one * (this.log ? 10 ** along : along);
  }

  text(value) {
    return explorer.numbers.brief(value / this.one);
  }

  around(values, decades) {
    let [low, high] = [Infinity, -Infinity];
    for (const some of values) {
      for (const value of some) {
        if (value === null || (this.log && value <= 0)) continue;
        if (value < low) low = value;
        if (value > high) high = value;
      }
    }
    if (low > high) [low, high] = this.log ? [1, 10] : [0, 1];
    [low, high] = [low / this.one, high / this.one];
    if (this.log) {
      const top = 10 ** Math.ceil(Math.log10(high) - 1e-9);
      return [Math.max(10 ** Math.floor(Math.log10(low)), top / 10 ** decades), top === low ? 10 * top : top];
    }
    if (low > 0 && low < 0.6 * high) low = 0;
    // What hardly differs fills no range.
    const more = this.least * Math.max(Math.abs(low), Math.abs(high)) - (high - low);
    if (more > 0) [low, high] = [low - more / 2, high + more / 2];
    const step = this.step(high - low || 1);
    const ends = [step * Math.floor(low / step + 1e-9), step * Math.ceil(high / step - 1e-9)];
    return ends[0] === ends[1] ? [ends[0] - step, ends[1] + step] : ends;
  }

  // The least round step that leaves room for labels.
  step(range) {
    const rough = range / this.most;
    if (this.every) return this.every * Math.ceil(rough / this.every - 1e-9);
    const power = 10 ** Math.floor(Math.log10(rough));
    return power * [1, 2, 5, 10].find((digit) => power * digit >= rough * (1 - 1e-9));
  }

  steps() {
    const [low, high] = this.ends;
    const step = this.step(high - low);
    const ticks = [];
    for (let i = Math.ceil(low / step - 1e-9); i <= high / step + 1e-9; i++) ticks.push(step * i);
    return ticks.map((value) => [value * this.one, explorer.numbers.stepped(value, step)]);
  }

  powers() {
    const [low, high] = this.ends.map((end) => Math.log10(end));
    const digits = high - low < 1.5 ? [1, 2, 5] : [1];
    const ticks = [];
    for (let power = Math.floor(low); power <= high; power++) {
      for (const digit of digits) {
        const value = digit * 10 ** power;
        if (Math.log10(value) >= low - 1e-9 && Math.log10(value) <= high + 1e-9) ticks.push(value);
      }
    }
    return ticks.map((value) => [value * this.one, explorer.Scale.power(value)]);
  }

  static power(value) {
    return value >= 0.001 && value < 1e5
      ? String(Number(value.toPrecision(1)))
      : explorer.numbers.brief(value, 1).replace("1·", "");
  }
};
