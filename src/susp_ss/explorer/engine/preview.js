// The least weighted sum of variances over all causal laws, and every output's variance under the law that reaches it,
// as susp_ss.feedback.preview: x' = A x + B u, y = C x + D u, driven by noises that one axle after the other meets.

// The share of the costs by which the last step of Kleinman's iteration may still descend: what is left is about its
// square.
const LEVEL = 1e-8;

const minusOf = (A, B) => A.map((row, i) => row.map((one, j) => one - B[i][j]));
const weighed = (weights, A) => A.map((row, i) => row.map((one) => weights[i] * one));

// x + by y.
function ahead(x, by, y) {
  const out = [];
  for (let i = 0; i < x.length; i++) out.push(x[i] + by * y[i]);
  return out;
}

// A += by x y^T.
function increment(A, by, x, y) {
  for (let i = 0; i < x.length; i++) add(A[i], y, by * x[i]);
}

// The law u = -K x of least sum weights y^2, by Kleinman's iteration from a stable one on.
function optimal(system, weights, start) {
  const { A, B, C, D } = system, DW = transpose(weighed(weights, D)), undo = inverse(multiply(DW, D)).of;
  const [Bt, crossed] = [transpose(B), multiply(DW, C)];
  let K = start, reached = null;
  for (let round = 0; round < KLEINMAN; round++) {
    const decay = new Decay(minusOf(A, multiply(B, K))), seen = minusOf(C, multiply(D, K));
    if (!decay.stable) break;
    const P = decay.told(multiply(transpose(weighed(weights, seen)), seen)), size = sum(P.map((row, i) => row[i]));
    const settled = reached && size > reached.size * (1 - LEVEL);
    if (!reached || size < reached.size) reached = { K, P, decay, seen, weights, undo, size };
    if (settled) break;
    K = multiply(undo, multiply(Bt, P).map((row, i) => ahead(row, 1, crossed[i])));
  }
  return reached ?? optimal(system, weights, zeros(B[0].length, A.length));
}

// Variances of all outputs under a law of `optimal`. Of a noise each axle has its `delay`, `entry` (n) and `standing`
// (m), what a unit of white noise makes of states and of outputs; the noise's colours are a `bank` of `rates`, and each
// entry of it moves states by `pushed` (n) and outputs by `seen` (m), one for every axle and rate.
function variancesUnder(system, noises, law) {
  const { B, C, D } = system, { decay, seen, weights, undo } = law, n = decay.A.length, Bt = transpose(B);
  const RB = multiply(undo, Bt), Z = negated(decay.stirred(multiply(B, RB)));
  const loop = {
    ...law, B, D, Bt, Z,
    back: minusOf(multiply(seen, Z), multiply(D, RB)),
    undone: [decay.inverse, transpose(decay.inverse)],
    WD: transpose(weighed(weights, D)),
    WC: transpose(weighed(weights, seen)),
  };
  const sums = { total: C.map(() => 0), forwards: zeros(n, n), backwards: zeros(n, n) };
  for (const noise of noises) {
    const bank = bankUnder(loop, noise);
    settle(loop, bank, travelled(loop, noise.axles, bank, sums), sums);
  }
  const [X, Y] = [decay.stirred(sums.forwards), decay.told(sums.backwards)];
  return sums.total.map((one, i) => Math.max(one + quadratic(seen[i], X) + quadratic(loop.back[i], Y), 0));
}

// The colours of a noise as the law acts on them.
function bankUnder({ decay, undo, B, D, Bt, WD, WC, P }, { bank, rates }) {
  return bank.map(({ axle, of, pushed, seen }) => {
    const [, adjoint] = decay.resolvent(rates[of]);
    const costate = times(adjoint, ahead(times(P, pushed), 1, times(WC, seen)));
    const gain = times(undo, ahead(times(Bt, costate), 1, times(WD, seen)));
    return {
      axle, rate: rates[of], costate,
      pushed: ahead(pushed, -1, times(B, gain)),
      seen: ahead(seen, -1, times(D, gain)),
    };
  });
}

// Drives over a unit of noise, from axle to axle: adds what is met on the way, and returns what starts and ends in
// states x and colours v, with the sign by which it counts.
function travelled(loop, axles, bank, sums) {
  const { seen, back, Z, undone } = loop, terms = [];
  let x = axles[0].entry, v = bank.map(({ axle }) => +(axle === 0));
  legs(loop, axles, bank).forEach(({ s, end, resting, rest, passage }, j) => {
    const { T } = passage, psi = ahead(ahead(x, -1, times(Z, s)), -1, resting);
    const gone = passage.crossed(psi, v, bank, end);
    terms.push([psi, v, 1], [gone.x, gone.v, -1]);
    increment(sums.backwards, 1, end, end);
    increment(sums.backwards, -1, s, s);
    // The integrals of v, of x and of s.
    const overV = v.map((one, q) => (one - gone.v[q]) / bank[q].rate), change = ahead(gone.x, -1, psi);
    bank.forEach(({ pushed }, q) => overV[q] && add(change, pushed, -overV[q]));
    const overX = times(undone[0], change), overS = times(undone[1], ahead(s, -1, end));
    for (let i = 0; i < seen.length; i++) {
      let met = dot(seen[i], times(gone.Y, back[i])), moving = dot(seen[i], overX) + dot(back[i], overS);
      for (let q = 0; q < bank.length; q++) {
        if (!v[q]) continue;
        met += bank[q].seen[i] * dot(gone.V[q], back[i]);
        moving += bank[q].seen[i] * overV[q];
      }
      sums.total[i] += 2 * met + rest[i] * (T * rest[i] + 2 * moving);
    }
    x = [times(Z, end), resting, axles[j + 1].entry].reduce((total, one) => ahead(total, 1, one), gone.x);
    v = gone.v.map((one, q) => one + (bank[q].axle === j + 1));
  });
  return [...terms, [x, v, 1]];
}

// For each interval between axles: the costate at its start and end but for what rests in it, and states and outputs at
// rest there.
function legs({ decay, seen, undo, undone, Bt, WD, WC, P, B, D }, axles, bank) {
  const standing = axles.map((_, j) => axles.slice(0, j + 1).map((one) => one.standing)
    .reduce((total, one) => ahead(total, 1, one))), found = [];
  let [later] = zeros(1, B.length);
  for (let j = axles.length - 2; j >= 0; j--) {
    const passage = decay.passage(axles[j + 1].delay - axles[j].delay), held = standing[j];
    const still = times(undone[1], times(WC, held)).map((one) => -one);
    const force = times(undo, ahead(times(Bt, still), 1, times(WD, held))).map((one) => -one);
    const end = ahead(ahead(later, 1, times(P, axles[j + 1].entry)), -1, still);
    for (const one of bank) if (one.axle === j + 1) add(end, one.costate, 1);
    const s = times(passage.adjoint, end), resting = times(undone[0], times(B, force)).map((one) => -one);
    later = ahead(s, 1, still);
    const rest = ahead(ahead(times(seen, resting), 1, times(D, force)), 1, held);
    found.unshift({ s, end, resting, rest, passage });
  }
  return found;
}

// Adds what remains of starts less ends: Lyapunov's equation, whose right-hand side in states the colours add to.
function settle({ decay, seen }, bank, terms, sums) {
  for (const [x, , by] of terms) increment(sums.forwards, by, x, x);
  const r = bank.length, colours = zeros(r, r);
  for (const [, v, by] of terms) increment(colours, by, v, v);
  colours.forEach((row, p) => bank.forEach(({ rate }, q) => (row[q] /= bank[p].rate + rate)));
  const pushed = bank.map((one) => one.pushed), right = r ? multiply(colours, pushed) : [];
  const mixed = bank.map(({ rate }, q) => {
    for (const [x, v, by] of terms) add(right[q], x, by * v[q]);
    return times(decay.resolvent(rate)[0], right[q]);
  });
  for (let q = 0; q < r; q++) {
    increment(sums.forwards, 1, pushed[q], mixed[q]);
    increment(sums.forwards, 1, mixed[q], pushed[q]);
  }
  for (let i = 0; r && i < seen.length; i++) {
    const own = bank.map((one) => one.seen[i]);
    sums.total[i] += 2 * dot(own, mixed.map((one) => dot(seen[i], one))) + quadratic(own, colours);
  }
}
