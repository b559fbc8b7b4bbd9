// What each panel shows of the results of the designs: the one that moves first, then those pinned.
"use strict";
window.explorer = window.explorer || {};

explorer.panels = (() => {
  const { html, svg } = explorer;
  const { brief, change } = explorer.numbers;
  const { output, title, metric, within } = explorer.words;

  const body = (name) => document.getElementById(name);
  const charts = new Map();

  // The chart of a panel by its name, at its place among those of the panel.
  function chart(panel, name, size = "") {
    const id = `chart-${panel}-${name}`.replace(/[^\w-]/g, "-");
    if (!charts.get(id)?.host.isConnected) {
      const host = html("div", { id, class: `chart ${size}` });
      body(panel).append(host);
      charts.set(id, new explorer.Chart(host));
    }
    return charts.get(id);
  }

  // Charts of outputs that are no longer shown go.
  function only(panel, names) {
    const key = names.join();
    if (body(panel).dataset.shown === key) return;
    body(panel).replaceChildren();
    body(panel).dataset.shown = key;
  }

  // One line a design; the moving one is drawn last, above the others.
  const lines = (designs, of, style = "") =>
    designs
      .filter(({ results }) => results)
      .map(({ name, style: design, results }) => ({
        key: design + style,
        style: `line ${design} ${style}`,
        name: style ? "" : name,
        ...of(results),
      }))
      .filter(({ x, y }) => x && y)
      .reverse();

  function frequencies(panel, part, draw) {
    return (designs) => {
      const [{ results }] = designs;
      const names = results[part].map((one) => one.output);
      only(panel, names);
      results[part].forEach((one) =>
        draw(designs, one, (found) => found[part]?.find(({ output: name }) => name === one.output)),
      );
    };
  }

  const bode = frequencies("bode", "bode", (designs, one, same) => {
    const { frequency } = designs[0].results;
    const { one: unit, unit: shown } = metric(one.output);
    const x = { label: "frequency (Hz)", unit: "Hz", log: true, span: [frequency[0], frequency.at(-1)] };
    const of = (part) => lines(designs, (found) => ({ x: found.frequency, y: same(found)?.[part] }));
    const peak = frequency[one.magnitude.indexOf(Math.max(...one.magnitude))];
    chart("bode", one.output).draw({
      x,
      y: { label: `${title(one.output)} (${shown || 1} per m)`, log: true, one: unit, decades: 4 },
      lines: of("magnitude"),
      words: `${output(one.output)} per metre of road over frequency, largest at ${brief(peak)} Hz`,
    });
    chart("bode", `${one.output}-phase`, "low").draw({
      x,
      y: { label: "phase (°)", every: 90 },
      lines: of("phase"),
      words: `Phase of ${output(one.output)}`,
    });
  });

  const psd = frequencies("psd", "psd", (designs, one, same) => {
    const { frequency } = designs[0].results;
    const { one: unit, unit: shown } = metric(one.output);
    const weighted = lines(
      designs.slice(0, 1),
      (found) => ({ x: found.frequency, y: same(found)?.weighted, area: true }),
      "weighted",
    );
    const all = [...weighted, ...lines(designs, (found) => ({ x: found.frequency, y: same(found)?.psd }))];
    const peak = frequency[one.psd.indexOf(Math.max(...one.psd))];
    chart("psd", one.output).draw({
      x: { label: "frequency (Hz)", unit: "Hz", log: true, span: [frequency[0], frequency.at(-1)] },
      y: {
        label: `${title(one.output)} (${square(shown)}/Hz)${one.weighting ? `, filled: ${one.weighting}` : ""}`,
        log: true,
        one: unit ** 2,
        decades: 5,
      },
      lines: all,
      words: `Power spectral density of ${output(one.output)}, largest at ${brief(peak)} Hz`,
    });
  });

  const square = (unit) => (unit ? (/^\w+$/.test(unit) ? `${unit}²` : `(${unit})²`) : 1);

  // Over speed, what is shown over frequency and the first of each metric of the study.
  function speeds(designs, state) {
    const { speeds: found } = designs[0].results;
    const first = ["bacc", "sws", "dtl"].map(
      (metric) => found.metrics.find(({ name }) => name.split("@")[0] === metric)?.name,
    );
    const some = found.metrics.filter(({ name }) => first.includes(name) || state.bode.includes(name));
    only(
      "speeds",
      some.map(({ name }) => name),
    );
    for (const { name, unit } of some) {
      const { one, unit: shown } = metric(name, unit);
      chart("speeds", name, "small").draw({
        x: { label: "speed (m/s)", unit: "m/s", span: [found.speed[0], found.speed.at(-1)] },
        y: { label: within(title(name), shown), one },
        lines: lines(designs, ({ speeds: of }) => ({
          x: of?.speed,
          y: of?.metrics.find((each) => each.name === name)?.values,
        })),
        at: state.road.speed,
        words: `${output(name)} over speed`,
      });
    }
  }

  function carpet(designs, state, background) {
    const [x, y] = [state.carpet.x, state.carpet.y];
    const axis = (name) => ({
      label: within(title(name), metric(name).unit),
      unit: metric(name).unit,
      one: metric(name).one,
      least: 0.2,
    });
    const value = (results, name) => results.metrics?.find((each) => each.name === name)?.value ?? null;
    const points = designs
      .filter(({ results }) => results)
      .map(({ name, style, results }) => ({
        key: style,
        style: `point ${style}`,
        name,
        x: [value(results, x)],
        y: [value(results, y)],
      }));
    const { carpet: grid, front, bound } = background ?? {};
    const path = (key, found, style = key) =>
      found
        ? [{ key, style: `line ${style}`, x: found.map((point) => point[0]), y: found.map((point) => point[1]) }]
        : [];
    const springs = grid?.designs ?? [];
    const dampers = springs.length ? springs[0].map((_, j) => springs.map((row) => row[j])) : [];
    const mesh = [...springs, ...dampers].flatMap((points, i) =>
      path(`mesh-${i}`, points, i < springs.length ? "mesh" : "mesh dampers"),
    );
    const here = points[0];
    const [across, up] = [brief(here.x[0] / metric(x).one), brief(here.y[0] / metric(y).one)];
    chart("carpet", "plane", "tall").draw({
      x: axis(x),
      y: axis(y),
      lines: [...mesh, ...path("bound", bound?.points), ...path("front", front?.points)],
      points: points.reverse(), // Its own place above the others.
      still: true,
      words: `${output(y)} over ${output(x)}: this design at ${across} and ${up}`,
    });
  }

  // Cars

  const placesOf = (wheels, state) => explorer.Car.places(Object.keys(wheels), state.vehicle);

  // Modes by their name and how many of that name are slower: another car may have others between them.
  function byName(modes) {
    const rank = (mode, i) => modes.slice(0, i).filter(({ name }) => name === mode.name).length;
    return new Map(modes.map((mode, i) => [`${mode.name} ${rank(mode, i)}`, mode]));
  }

  function modes([{ results }, reference], state) {
    const host = body("modes");
    const places = placesOf(results.modes[0].shape.wheels, state);
    const key = JSON.stringify([results.modes.length, places]);
    if (host.dataset.shown !== key) {
      host.dataset.shown = key;
      host.cars = results.modes.map(() => {
        const car = new explorer.Car(places);
        const words = html("figcaption");
        host.append(html("figure", {}, svg("svg", { viewBox: car.box().join(" "), role: "img" }, car.group), words));
        return { car, words, picture: car.group.parentNode };
      });
      host.replaceChildren(...host.cars.map(({ picture }) => picture.parentNode));
    }
    const others = byName(reference.results?.modes ?? []);
    [...byName(results.modes)].forEach(([name, mode], i) => {
      const { words, picture } = host.cars[i];
      const before = others.get(name);
      const moved = before ? change(mode.frequency, before.frequency) : "";
      words.replaceChildren(
        html("b", {}, mode.name ?? ""),
        html("span", {}, `${brief(mode.frequency)} Hz`),
        html("span", { class: "quiet" }, moved),
        html("span", {}, `ζ ${mode.damping.toFixed(2)}`),
      );
      picture.setAttribute(
        "aria-label",
        `Mode ${i + 1}, ${mode.name ?? ""} ${brief(mode.frequency)} Hz, damping ratio ${mode.damping.toFixed(2)}`,
      );
    });
    const shapes = results.modes.map((mode) => shaped(mode.shape, places));
    explorer.motion.add(host, (time) => host.cars.forEach(({ car }, i) => car.move(shapes[i](3.5 * time))));
  }

  // A mode at a phase, its largest displacement of body or wheels drawn alike.
  const AMPLITUDE = 0.2;
  function shaped({ wheels = {}, ...shape }, places) {
    const { heave = [0, 0], pitch = [0, 0], roll = [0, 0] } = shape;
    const above = Object.values(places).map(([x, y]) => [0, 1].map((i) => heave[i] - x * pitch[i] + y * roll[i]));
    const largest = Math.max(1e-9, ...[...above, ...Object.values(wheels)].map(([re, im]) => Math.hypot(re, im)));
    const now = ([re, im], cos, sin) => ((re * cos - im * sin) * AMPLITUDE) / largest;
    return (phase) => {
      const [cos, sin] = [Math.cos(phase), Math.sin(phase)];
      const moved = Object.fromEntries(Object.entries(wheels).map(([name, z]) => [name, now(z, cos, sin)]));
      return { heave: now(heave, cos, sin), pitch: now(pitch, cos, sin), roll: now(roll, cos, sin), wheels: moved };
    };
  }

  const EXAGGERATED = 3;
  const SLOWED = 0.25;

  function ride(designs, state) {
    const host = body("ride");
    const { bump } = designs[0].results;
    const places = placesOf(bump.wheels, state);
    const key = JSON.stringify([places, state.bump]);
    if (host.dataset.shown !== key) {
      host.dataset.shown = key;
      set(host, places, state.bump);
    }
    const trace = chart("ride", "trace", "small");
    const { one, unit } = metric("bacc");
    trace.draw({
      x: { label: "time (s)", unit: "s", span: [bump.t[0], bump.t.at(-1)] },
      y: { label: `body acceleration (${unit})`, one },
      lines: lines(designs, ({ bump: of }) => ({ x: of?.t, y: of?.acceleration })),
      words: `Body acceleration over the bump, largest ${brief(Math.max(...bump.acceleration.map(Math.abs)))} ${unit}`,
    });
    explorer.motion.add(host, (time) => {
      const last = bump.t.length - 1;
      const t = bump.t[0] + ((time * SLOWED) % (bump.t[last] - bump.t[0]));
      const i = Math.min(last - 1, Math.floor((last * (t - bump.t[0])) / (bump.t[last] - bump.t[0])));
      const part = (t - bump.t[i]) / (bump.t[i + 1] - bump.t[i]);
      const now = (values, by = EXAGGERATED) => (values ? by * (values[i] + part * (values[i + 1] - values[i])) : 0);
      trace.point(t);
      if (!host.car) return;
      const wheels = Object.fromEntries(Object.entries(bump.wheels).map(([name, z]) => [name, now(z)]));
      host.car.move({ heave: now(bump.body.heave), pitch: now(bump.body.pitch), roll: now(bump.body.roll), wheels });
      host.road.setAttribute("d", host.ground(now(bump.x, 1), now(Object.values(bump.ground)[0])));
    });
  }

  // A car on a road; none for a system of which no wheel is known.
  function set(host, places, bump) {
    const stage = host.querySelector(".stage") ?? host.appendChild(html("div", { class: "stage" }));
    host.car = Object.keys(places).length ? new explorer.Car(places) : null;
    if (!host.car) return stage.replaceChildren();
    const [left, top, width] = host.car.box();
    const above = Math.min(-2.15, top);
    const box = [left - 0.6, above, width + 1.2, 0.35 - above];
    const words = { role: "img", class: "ride", "aria-label": "The car over the bump" };
    host.road = svg("path", { class: "road" });
    host.ground = ground(bump, box, host.car);
    stage.replaceChildren(svg("svg", { viewBox: box.join(" "), ...words }, host.road, host.car.group));
  }

  // The road in the frame of the car whose first axle is at x, the bump beginning at zero; from behind, its height.
  function ground({ height, length }, [left, , width], car) {
    const [begin, end] = [left - 5 * width, left + 5 * width]; // As far as a wide window shows.
    return (x, level) => {
      if (car.behind) return `M${begin},${-level}H${end}V0.3H${begin}Z`;
      const from = car.front - x;
      let path = `M${Math.min(begin, from)},0`;
      for (let i = 0; i <= 24; i++) {
        const z = (EXAGGERATED * height * (1 - Math.cos((2 * Math.PI * i) / 24))) / 2;
        path += `L${(from + (length * i) / 24).toFixed(3)},${(-z).toFixed(4)}`;
      }
      return `${path}H${Math.max(end, from + length)}V0.3H${begin}Z`;
    };
  }

  return { chart, body, only, bode, psd, speeds, carpet, modes, ride };
})();
