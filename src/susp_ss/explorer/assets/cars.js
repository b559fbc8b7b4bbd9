// Cars that move: a body on wheels, seen from its right and a little from above, or from behind where it has no length.
"use strict";
window.explorer = window.explorer || {};

explorer.Car = class {
  static SIZES = { car: { radius: 0.31, mount: 0.62, height: 1.4 }, truck: { radius: 0.5, mount: 1.0, height: 3.1 } };
  static DEPTH = [0.3, 0.24]; // How far the far side lies to the right of and above the near one, per metre.

  // A drawing of the wheels at places {name: [ahead, left]} in metres.
  constructor(places) {
    const { svg } = explorer;
    this.places = places;
    const [x, y] = [0, 1].map((i) => Object.values(places).map((place) => place[i]));
    [this.rear, this.front] = [Math.min(...x), Math.max(...x)];
    [this.right, this.left] = [Math.min(...y), Math.max(...y)];
    this.behind = this.front === this.rear && this.left > this.right;
    this.single = this.front === this.rear && this.left === this.right;
    this.truck = new Set(x).size > 2;
    Object.assign(this, explorer.Car.SIZES[this.truck ? "truck" : "car"]);
    this.shape = this.outline();
    this.seen = this.faces();
    this.group = svg("g", { class: "car" });
    this.far = svg("path", { class: "body far" });
    this.near = svg("path", { class: "body near" });
    this.wheels = new Map();
    const order = Object.keys(places).sort((one, other) => places[other][1] - places[one][1]);
    const drawn = order.map((name) => {
      const spring = svg("path", { class: "spring" });
      const size = this.behind
        ? { rx: 0.11, ry: this.radius }
        : { rx: this.radius, ry: this.radius };
      const hub = this.behind ? "" : svg("circle", { r: 0.13 });
      const wheel = svg("g", { class: "wheel" }, svg("ellipse", size), hub);
      this.wheels.set(name, { spring, wheel });
      return [spring, wheel];
    });
    const half =
      this.behind || this.single ? drawn.length : drawn.filter((_, i) => places[order[i]][1] > this.right).length;
    this.group.append(...drawn.slice(0, half).flat(), this.far, this.near, ...drawn.slice(half).flat());
  }

  // The picture's frame in metres: left, top, width, height (z up is minus).
  box(margin = 0.2) {
    const [side, up] = this.sides();
    const reach = this.behind ? [this.right - 0.35, this.left + 0.35] : this.ends(side);
    const low = this.single ? [-0.7, 0.7] : reach;
    return [low[0], -(this.height + up + margin), low[1] - low[0], this.height + up + 2 * margin];
  }

  ends(side) {
    const x = this.shape.map(([ahead]) => ahead);
    return [Math.min(...x) - 0.09, Math.max(...x) + 0.15 + side];
  }

  sides() {
    return this.behind ? [0, 0] : explorer.Car.DEPTH.map((by) => by * (this.left - this.right));
  }

  // Motion in metres and rad of the drawing: {heave, pitch, roll, wheels: {name: z}}.
  move({ heave = 0, pitch = 0, roll = 0, wheels }) {
    const at = (x, y, z) => {
      const height = z + heave - pitch * x + roll * y;
      if (this.behind) return `${-y},${-height}`;
      const [side, up] = explorer.Car.DEPTH;
      return `${x + side * (y - this.right)},${-(height + up * (y - this.right))}`;
    };
    const outline = (y) => this.shape.map(([x, z]) => (this.behind ? at(0, x, z) : at(x, y, z)));
    const near = outline(this.right);
    this.near.setAttribute("d", `M${near.join("L")}Z`);
    if (this.left > this.right && !this.behind) {
      const far = outline(this.left);
      this.far.setAttribute("d", this.seen.map(([i, j]) => `M${near[i]}L${far[i]}L${far[j]}L${near[j]}Z`).join(""));
    }
    for (const [name, { spring, wheel }] of this.wheels) {
      const [x, y] = this.places[name];
      const hub = this.radius + (wheels?.[name] ?? 0);
      const [side, up] = this.behind ? [0, 0] : explorer.Car.DEPTH.map((by) => by * (y - this.right));
      const across = this.behind ? -y : x + side;
      wheel.setAttribute("transform", `translate(${across.toFixed(4)} ${(-(hub + up)).toFixed(4)})`);
      const top = this.mount + heave - pitch * x + roll * y + up;
      spring.setAttribute("d", explorer.Car.coil(across, hub + up, top));
    }
  }

  // The near side of the body, (ahead, up), or the back of it, (left, up).
  outline() {
    if (this.single)
      return [
        [-0.5, 0.62],
        [-0.5, 1.2],
        [0.5, 1.2],
        [0.5, 0.62],
      ];
    if (this.behind) {
      const [r, l] = [this.right, this.left];
      return [
        [r - 0.08, 0.5],
        [r - 0.1, 0.85],
        [r + 0.18, 1.35],
        [l - 0.18, 1.35],
        [l + 0.1, 0.85],
        [l + 0.08, 0.5],
      ];
    }
    const [a, b] = [this.front, this.rear];
    if (this.truck)
      return [
        [b - 1.1, 0.85],
        [b - 1.1, 3.0],
        [a - 0.75, 3.0],
        [a - 0.75, 2.6],
        [a + 0.6, 2.6],
        [a + 0.9, 1.75],
        [a + 0.9, 0.6],
        [a + 0.6, 0.6],
        [a + 0.6, 0.85],
      ];
    const length = a - b;
    return [
      [b - 0.62, 0.42],
      [b - 0.66, 0.82],
      [b - 0.25, 0.92],
      [b + 0.16 * length, 1.3],
      [b + 0.58 * length, 1.32],
      [b + 0.8 * length, 0.92],
      [a + 0.5, 0.78],
      [a + 0.7, 0.6],
      [a + 0.7, 0.42],
    ];
  }

  // Sides of the outline whose faces, from near to far, can be seen.
  faces() {
    const [side, up] = explorer.Car.DEPTH;
    const pairs = this.shape.map((_, i) => [i, (i + 1) % this.shape.length]);
    return pairs.filter(([i, j]) => {
      const [along, above] = [0, 1].map((k) => this.shape[j][k] - this.shape[i][k]);
      return along * up - above * side > 0;
    });
  }

  static coil(x, low, high) {
    const turns = 7;
    let path = `M${x.toFixed(3)},${(-low).toFixed(3)}`;
    for (let i = 0; i < turns; i++) {
      const z = low + ((high - low) * (i + 0.5)) / turns;
      path += `L${(x + (i % 2 ? 0.07 : -0.07)).toFixed(3)},${(-z).toFixed(3)}`;
    }
    return `${path}L${x.toFixed(3)},${(-high).toFixed(3)}`;
  }

  // Where the wheels of a state stand: by their names, ends or sides where there are but two.
  static places(names, { a = 1, b = 1.5, c = 0.72, middle = 0.5 }) {
    const sided = names.includes("l");
    const place = (name) => {
      if (name === "") return [0, 0];
      if (name.length === 1) return sided ? [0, name === "l" ? c : -c] : [name === "f" ? a : -b, 0];
      return [{ f: a, m: -middle, r: -b }[name[0]], name[1] === "l" ? c : -c];
    };
    return Object.fromEntries(names.map((name) => [name, place(name)]));
  }
};

// What moves by itself: while it is wanted and in view, and not where less motion is preferred until asked for.
explorer.motion = (() => {
  const parts = new Map(); // From an element in view to what draws it at a time in seconds.
  const seen = new Set();
  const watch = new IntersectionObserver((entries) => {
    for (const { target, isIntersecting } of entries) seen[isIntersecting ? "add" : "delete"](target);
    run();
  });
  let playing = !matchMedia("(prefers-reduced-motion: reduce)").matches;
  const BETWEEN = 38; // ms between two pictures, some 24 a second: sliders need the rest.
  let [time, before, frame] = [0, null, null];

  function add(element, draw) {
    if (!parts.has(element)) watch.observe(element);
    parts.set(element, draw);
    draw(time);
  }

  function run() {
    if (playing && seen.size && frame === null) {
      before = null;
      frame = requestAnimationFrame(step);
    }
  }

  function step(now) {
    frame = null;
    before ??= now;
    if (now - before >= BETWEEN) {
      time += Math.min(0.1, (now - before) / 1000);
      before = now;
      for (const element of seen) parts.get(element)(time);
    }
    if (playing && seen.size) frame = requestAnimationFrame(step);
  }

  function play(wanted) {
    playing = wanted;
    run();
  }

  return { add, play, playing: () => playing };
})();
