// Two matrices, the rows of one after those of the other.
const beside = (one, other) => one.map((row, i) => [...row, ...other[i]]);

// x' = A x + B z_r, y = Y x + D z_r + D1 z_r' over x = (q, q' - M^-1 C_in z_r), of susp_ss.vehicles.second_order.
function displacementForm({ m, K, C, K_in, C_in, R, N, elongation, rate, acceleration, on_road_velocity: D1 }) {
  const n = m.length, over = (M) => M.map((row, i) => row.map((one) => one / m[i]));
  const both = (one, other, factor = 1) => one.map((row, i) => {
    const total = [...row];
    add(total, other[i], factor);
    return total;
  });
  const [k, c, Bz] = [K, C, C_in].map(over);
  const onPosition = both(multiply(elongation, R), multiply(acceleration, k), -1);
  const onVelocity = both(multiply(rate, R), multiply(acceleration, c), -1);
  return {
    A: [...beside(zeros(n, n), identity(n)), ...beside(negated(k), negated(c))],
    B: [...Bz, ...both(over(K_in), multiply(c, Bz), -1)],
    Y: beside(onPosition, onVelocity),
    D: both(both(multiply(elongation, N), multiply(acceleration, over(K_in))), multiply(onVelocity, Bz)),
    D1,
  };
}

// How a force beside every suspension, which pushes the body up, moves the coordinates.
const pushes = ({ m, R, suspensions }) => m.map((mass, i) => suspensions.map((row) => -R[row][i] / mass));
