"""How far a linear car holds in a turn: a nonlinear car of 14 degrees of freedom, steered harder and harder.

    python examples/nonlinear_turning_car.py --speed 20 --friction 0.9

The car is `RideHandlingCar` without small angles: it turns and slides as far as it will, tyres see their own speeds,
slip and load, the body leans by sines and cosines, and a tyre that its load no longer presses down lets go. Two laws of
the tyres: the linear one, ``F = C s`` along the slip s, and one that saturates at friction times load, ``F = mu F_z
tanh(C s / (mu F_z))`` along the combined slip. A step of the steering angle is taken at ever larger angles, all of them
at once, and each history is held against the linear car's.

Accelerations are those of points in axes that turn with the car: of one at (x, y), ``a_x = v_x' - r v_y`` and ``a_y =
v_y' + r v_x``. With one row a mass, ``J^T m (J w' + what velocities alone make) = forces`` gives all rates w'.
"""

import argparse
import math
import sys
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import NoReturn

import numpy as np
from numpy.typing import NDArray

import susp_ss as ss

Array = NDArray[np.float64]

GRAVITY = 9.81  # m/s^2, as in the linear car
STEP, BEGIN, END = 2e-3, 0.2, 3.0  # s
ANGLES = np.radians([0.05, 0.5, 1.0, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0])
OUTPUTS = ("ay", "yaw_rate", "sideslip", "roll", "load_transfer_front", "load_transfer_rear")

# Places of the rates w among themselves.
HUBS, HEAVE, PITCH, ROLL, LATERAL, YAW, FORWARD, SPINS = slice(0, 4), 4, 5, 6, 7, 8, 9, slice(10, 14)
RATES = 14


@dataclass(frozen=True)
class Tyre:
    """``F = C s`` along the slip s; with friction no more than ``friction`` times the load, and none without load."""

    friction: float = math.inf

    def forces(self, slip: Array, angle: Array, load: Array, car: ss.RideHandlingCar) -> tuple[Array, Array]:
        """Forces (4, N) along and across the wheels by longitudinal slip, slip angle and load (4, N)."""
        along = np.array(car.at_wheels("slip"))[:, None] * slip
        across = np.array(car.at_wheels("cornering"))[:, None] * np.tan(angle)
        if math.isinf(self.friction):
            return along, across
        most, asked = self.friction * np.maximum(load, 0.0), np.maximum(np.hypot(along, across), 1e-12)
        share = most * np.tanh(asked / np.maximum(most, 1e-12)) / asked
        return share * along, share * across


class TurningCar:
    """A `RideHandlingCar` with rigid steering and no relaxation, driven N times at once."""

    def __init__(self, car: ss.RideHandlingCar, tyre: Tyre):
        if car.steering is not None or any(car.at_wheels("relaxation")):
            raise ValueError("the nonlinear car has neither compliant steering nor relaxation lengths")
        self.car, self.tyre = car, tyre
        self.x = np.array([car.a, car.a, -car.b, -car.b])
        self.y = car.c * np.array([-1.0, 1.0, -1.0, 1.0])
        self.h = np.repeat([car.roll_centre_front, car.roll_centre_rear], 2)
        self.mu, self.spin = np.array(car.at_wheels("mu")), np.array(car.at_wheels("wheel_inertia"))
        carried = car.mb * GRAVITY * np.array([car.b, car.a])[[0, 0, 1, 1]] / (2.0 * (car.a + car.b))
        self.static = (carried + self.mu * GRAVITY)[:, None]
        # How the roll of an axle follows from its hubs, (4, 4): that of its own axle for each wheel.
        self.axles = np.kron(np.eye(2), np.array([[-1.0, 1.0], [-1.0, 1.0]])) / (2.0 * car.c)
        self.mounts = np.column_stack([np.ones(4), -self.x, self.y])

    def at_speed(self, N: int) -> Array:
        """Rolling straight ahead at rest on its springs: positions (7), rates (14), of N cars."""
        state = np.zeros((7 + RATES, N))
        state[7 + FORWARD] = self.car.speed
        state[7:][SPINS] = self.car.speed / self.car.radius
        return state

    def slope(self, state: Array, delta: Array, z: Array) -> tuple[Array, dict[str, Array]]:
        """Rates of the state (21, N) under steering angles (N,) and road heights (4,), and the outputs."""
        car, w = self.car, state[7:]
        phi, u, v, r = state[ROLL], w[FORWARD], w[LATERAL], w[YAW]
        lean, d_lean = self.axles @ state[HUBS], self.axles @ w[HUBS]
        Fz = self.static + np.array(car.at_wheels("kt"))[:, None] * (z[:, None] - state[HUBS])
        if not math.isinf(self.tyre.friction):
            Fz = np.maximum(Fz, 0.0)
        travel = state[HUBS] - self.mounts @ state[4:7]
        rate = w[HUBS] - self.mounts @ w[4:7]
        strut = np.array(car.at_wheels("ks"))[:, None] * travel + np.array(car.at_wheels("cs"))[:, None] * rate
        for axle, arb in ((slice(0, 2), car.arb_front), (slice(2, 4), car.arb_rear)):
            strut[axle] += arb * (travel[axle] - travel[axle][::-1])

        # Tyres, in the planes of the wheels and then along the car.
        turned = np.stack([delta, delta, 0.0 * delta, 0.0 * delta])
        ahead, aside = u - self.y[:, None] * r, v + self.x[:, None] * r + self.h[:, None] * d_lean
        along = ahead * np.cos(turned) + aside * np.sin(turned)
        angle = turned - np.arctan2(aside, ahead)
        Fl, Ft = self.tyre.forces((car.radius * w[SPINS] - along) / along, angle, Fz, car)
        Fx, Fy = Fl * np.cos(turned) - Ft * np.sin(turned), Fl * np.sin(turned) + Ft * np.cos(turned)

        N = state.shape[1]
        force = np.zeros((RATES, N))
        force[HUBS] = Fz - self.static - strut + self.axles.T @ (self.h[:, None] * Fy)
        force[4:7] = self.mounts.T @ strut
        force[ROLL] += car.mb * GRAVITY * car.arm * np.sin(phi)
        force[LATERAL], force[FORWARD] = Fy.sum(axis=0), Fx.sum(axis=0)
        force[YAW] = (self.x[:, None] * Fy - self.y[:, None] * Fx).sum(axis=0)
        force[SPINS] = -car.radius * Fl

        M = np.zeros((N, RATES, RATES))
        for i, inertia in zip((HEAVE, PITCH, ROLL, YAW), (car.mb, car.iyy, car.ixx, car.body_izz), strict=True):
            M[:, i, i] += inertia
        M[:, ROLL, YAW] -= car.ixz
        M[:, YAW, ROLL] -= car.ixz
        # The body's centre of gravity stands beside the middle of the car by e, a hub beside its place by its own.
        e, de = -car.arm * np.sin(phi), -car.arm * np.cos(phi) * w[ROLL]
        by_roll = np.zeros((N, RATES))
        by_roll[:, ROLL] = -car.arm * np.cos(phi)
        aside_body = self.add(M, force, w, car.mb, 0.0, e, de, by_roll, car.arm * np.sin(phi) * w[ROLL] ** 2)
        swings = (self.h - car.radius)[:, None]
        for i, (offset, d_offset) in enumerate(zip(swings * lean, swings * d_lean, strict=True)):
            by_hubs = np.zeros((N, RATES))
            by_hubs[:, HUBS] = swings[i] * self.axles[i]
            self.add(M, force, w, self.mu[i], self.x[i], self.y[i] + offset, d_offset, by_hubs, 0.0 * phi)
            M[:, i, i] += self.mu[i]
            M[:, 10 + i, 10 + i] += self.spin[i]
        rates = np.linalg.solve(M, force.T[..., None])[..., 0].T
        dynamic = Fz - self.static
        moved = (dynamic[[0, 2]] - dynamic[[1, 3]]) / 2.0
        outputs = [aside_body(rates), r, v / u, phi, *moved]
        return np.concatenate([w[:7], rates]), dict(zip(OUTPUTS, outputs, strict=True))

    @staticmethod
    def add(
        M: Array, force: Array, w: Array, m: float, x: float, y: Array, dy: Array, by: Array, ddy: Array
    ) -> Callable[[Array], Array]:
        """Add a mass at (x, y) that moves aside by itself, ``y'' = by w' + ddy``; return its lateral acceleration."""
        u, v, r = w[FORWARD], w[LATERAL], w[YAW]
        along, across = np.zeros_like(by), by.copy()
        along[:, FORWARD], along[:, YAW] = 1.0, -y
        across[:, LATERAL] += 1.0
        across[:, YAW] += x
        a_x, a_y = -2.0 * r * dy - r * (v + x * r), ddy + r * (u - r * y)
        for row, rest in ((along, a_x), (across, a_y)):
            M += m * row[:, :, None] * row[:, None, :]
            force -= m * row.T * rest
        return lambda rates: (across * rates.T).sum(axis=1) + a_y

    def drive(self, delta: Array, z: Array, step: float) -> dict[str, Array]:
        """Outputs (N, T) under steering angles (N, T) and heights (4, T), linear between samples (Runge and Kutta)."""
        state, history = self.at_speed(len(delta)), []
        for k in range(delta.shape[1] - 1):
            ends = (delta[:, k], z[:, k]), (delta[:, k + 1], z[:, k + 1])
            middle = tuple(0.5 * (one + other) for one, other in zip(*ends, strict=True))
            first, outputs = self.slope(state, *ends[0])
            second, _ = self.slope(state + 0.5 * step * first, *middle)
            third, _ = self.slope(state + 0.5 * step * second, *middle)
            fourth, _ = self.slope(state + step * third, *ends[1])
            history.append(outputs)
            state = state + step / 6.0 * (first + 2.0 * second + 2.0 * third + fourth)
        history.append(self.slope(state, delta[:, -1], z[:, -1])[1])
        return {name: np.array([outputs[name] for outputs in history]).T for name in OUTPUTS}


def linear(car: ss.RideHandlingCar, delta: Array, z: Array, time: Array) -> dict[str, Array]:
    """The same of the linear car, one row an angle."""
    histories = [ss.simulate(car, z, time, inputs={"delta_f": row}) for row in delta]
    found = {}
    for name in OUTPUTS:
        stem, _, place = name.rpartition("_")
        at = {"axle": place} if stem == "load_transfer" else {}
        found[name] = np.array([history[stem if at else name].sel(at).values for history in histories])
    return found


def turns(car: ss.RideHandlingCar, tyre: Tyre, angles: Array = ANGLES) -> tuple[Array, dict[str, Array]]:
    """Largest lateral acceleration (N,), and the linear car's largest error of each output over its largest value."""
    time = np.arange(0.0, END, STEP)
    delta = angles[:, None] * np.clip((time - BEGIN) / 0.1, 0.0, 1.0)
    z = np.zeros((4, len(time)))
    true, ours = TurningCar(car, tyre).drive(delta, z, STEP), linear(car, delta, z, time)
    errors = {name: _error(ours[name], true[name]) for name in OUTPUTS}
    return np.abs(true["ay"]).max(axis=1), errors


def _error(ours: Array, true: Array) -> Array:
    return np.asarray(np.abs(ours - true).max(axis=1) / np.abs(true).max(axis=1))


def holds_to(ay: Array, error: Array, bound: float) -> float:
    """Lateral acceleration up to which an error stays below a bound, between the turns by interpolation."""
    beyond = np.flatnonzero(error > bound)
    if not len(beyond):
        return float(ay[-1])
    k = int(beyond[0])
    return float(np.interp(bound, error[k - 1 : k + 1], ay[k - 1 : k + 1])) if k else 0.0


def said(laws: Mapping[str, tuple[Array, dict[str, Array]]]) -> str:
    """Tables of errors, and up to where they stay small."""
    lines = []
    for law, (ay, errors) in laws.items():
        lines += [
            f"{law}: largest error of the linear car",
            "  ay (m/s^2)  " + "  ".join(f"{name:>19}" for name in OUTPUTS),
        ]
        lines += [
            f"  {a:10.2f}  " + "  ".join(f"{errors[name][i]:19.2%}" for name in OUTPUTS) for i, a in enumerate(ay)
        ]
        worst = np.max([errors[name] for name in ("ay", "yaw_rate", "roll")], axis=0)
        bounds = ", ".join(f"{bound:.0%} up to {holds_to(ay, worst, bound):.1f} m/s^2" for bound in (0.02, 0.05, 0.1))
        lines.append(f"  ay, yaw rate and roll hold to {bounds}")
    return "\n".join(lines)


class Parser(argparse.ArgumentParser):
    """Says what is wrong in one line."""

    def error(self, message: str) -> NoReturn:
        self.exit(2, f"{self.prog}: {message}\n")


def between(least: float, most: float) -> Callable[[str], float]:
    def number(text: str) -> float:
        try:
            value = float(text)
        except ValueError:
            value = math.nan
        if not least <= value <= most:
            raise argparse.ArgumentTypeError(f"needs a number from {least:g} to {most:g}, got {text!r}")
        return value

    return number


def main(arguments: Sequence[str] | None = None) -> None:
    parser = Parser(description="How far a linear car holds in a turn.", allow_abbrev=False)
    parser.add_argument("--speed", type=between(5.0, 60.0), default=20.0, help="in m/s (%(default)s)")
    parser.add_argument("--friction", type=between(0.1, 2.0), default=0.9, help="of the tyres (%(default)s)")
    asked = parser.parse_args(arguments)
    car = ss.RideHandlingCar(speed=asked.speed, cornering=ss.Corners.axles(front=45e3, rear=50e3), arb_front=8e3)
    laws = {"linear tyres": Tyre(), f"tyres that saturate, friction {asked.friction:g}": Tyre(asked.friction)}
    try:
        car.steady_state()
    except ValueError as refused:
        parser.error(str(refused))
    sys.stdout.write(said({law: turns(car, tyre) for law, tyre in laws.items()}) + "\n")


if __name__ == "__main__":
    main()
