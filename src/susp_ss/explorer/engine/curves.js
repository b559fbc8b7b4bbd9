// Dampers of curves.

// A force that is linear between kinks and zero at rest, susp_ss.vehicles.laws.Broken.
class Broken {
  constructor(kinks, slopes) {
    Object.assign(this, { slopes, bends: kinks.map((kink, i) => ({ kink, rise: slopes[i + 1] - slopes[i] })) });
  }

  force(x) {
    return this.bends.reduce((total, { kink, rise }) =>
      total + rise * (Math.max(x - kink, 0) - Math.max(-kink, 0)), this.slopes[0] * x);
  }
}

// The law of a state's curve, susp_ss.explorer.design.damper.
function damper(cs, { rebound, compression, knee, beyond }) {
  const out = rebound * cs * knee, into = compression * cs * knee;
  const at = [-2 * knee, -knee, 0, knee, 2 * knee], force = [-(1 + beyond) * out, -out, 0, into, (1 + beyond) * into];
  const slopes = at.slice(1).map((end, i) => (force[i + 1] - force[i]) / (end - at[i]));
  return new Broken([-knee, 0, knee], slopes);
}
