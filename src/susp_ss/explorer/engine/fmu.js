// A car as a functional mock-up unit, as susp_ss.exchange writes it, but without a binary.

// The system that other programs take, as susp_ss.exchange.realised has it: on heights of the road, or on their rates
// where an output passes them straight on.
function realised(car) {
  const { A, B, Y, D, D1 } = displacementForm(car), n = car.m.length, { integrators } = car;
  if (!D1.some((row) => row.some((one) => one !== 0))) {
    return { rates: 0, A, B, C: Y, D, REST: negated(quotients(A, B)) };
  }
  const none = integrators.map(() => 0);
  const wide = [...A.map((row) => [...row, ...none]), ...integrators.map(() => new Array(2 * n + none.length).fill(0))];
  const moved = [...negated(car.G), ...B.slice(0, n), ...integrators];
  const seen = Y.map((row, i) => [...row, ...car.on_integrators[i]]);
  return { rates: 1, A: wide, B: moved, C: seen, D: D1, REST: moved.map((row) => row.map(() => 0)) };
}

// A name for a text by which it is told from others: four of Fowler, Noll and Vo's hashes.
function fingerprint(text) {
  const hash = (seed) => {
    let found = seed;
    for (let i = 0; i < text.length; i++) found = Math.imul(found ^ text.charCodeAt(i), 16777619);
    return (found >>> 0).toString(16).padStart(8, "0");
  };
  return `{${[2166136261, 1, 2, 3].map(hash).join("").replace(/^(.{8})(.{4})(.{4})(.{4})/, "$1-$2-$3-$4-")}}`;
}

function functionalMockUp(car, state) {
  const own = car.at(roadOf(state)), { rates, ...system } = realised(own), { A, B, C, D } = system;
  const initialiser = (M) => `{\n${M.map((row) => `    {${Array.from(row, repr).join(", ")}}`).join(",\n")}\n}`;
  const depends = (row) => row.flatMap((one, i) => (one === 0 ? [] : [i + 1])).join(" ");
  const gaps = Object.fromEntries(Object.entries(system).map(([name, M]) => [name, initialiser(M)]));
  for (const [name, value] of Object.entries(own.parameters)) gaps[name] = repr(value);
  [...D.map((row, i) => [...row, ...C[i]]), ...B.map((row, i) => [...row, ...A[i]])]
    .forEach((row, i) => (gaps[`row ${i}`] = depends(row)));
  const texts = (guid) => Object.fromEntries(Object.entries(own.files.fmu[rates])
    .map(([path, text]) => [path, completed(text, (name) => (name === "guid" ? guid : gaps[name]))]));
  return zipped({ ...texts(fingerprint(Object.values(texts("")).join(""))), ...FILES.source });
}
