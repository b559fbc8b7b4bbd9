"""The model of a car that moves, at one speed or at a row of them.

Tyres slide at ``s = x' - y psi' - R spin'``; the state has these four in place of the forward speed and the spins,
since no force depends on the speed that all have in common: a car that coasts a little faster answers alike.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from .linear_model import LinearLayout, LinearModel
from .modes import Modes, modes_among
from .second_order import ROUNDING, Array

CONTROLS = ("delta_f", "delta_r", "drive_fr", "drive_fl", "drive_rr", "drive_rl")
"""Steering angles in rad, positive to the left, and drive torques in N m, negative to brake."""

NAMED = {
    **dict.fromkeys(("z_u_fr", "z_u_fl"), "front hop"),
    **dict.fromkeys(("z_u_rr", "z_u_rl"), "rear hop"),
    **dict.fromkeys(("steer_fr", "steer_fl"), "steer"),
    "z_b": "heave",
    "theta": "pitch",
    "phi": "roll",
    "y": "sway",
    "psi": "yaw",
    "x": "spin",
    **{f"spin_{wheel}": "spin" for wheel in ("fr", "fl", "rr", "rl")},
}
"""Modes by the coordinate that moves most."""

UNMOVED = 1e-9
"""Of a mode's energy: a motion that holds no more does not name it."""

INTEGRATORS = ("warp", "bank")
"""The warp of the road in m, and the angle in rad to which a road that stands still would bring the body."""

OVER_CRITICAL = (
    "is unstable at {speed} m/s, above its critical speed of {critical} m/s; pass a lower speed or stiffer rear tyres "
    "(cornering)"
)

LASTING = (
    "has a mode that does not die out at {speed} m/s (rate {worst} 1/s); pass springs that hold the body up (ks, "
    "arb_front, arb_rear), dampers (cs) and tyres that hold it on course (cornering)"
)


class Motions(NamedTuple):
    """``x' = rates s + road z_r' + control u`` of all motions x, of which forces depend on ``s = kept x`` alone."""

    rates: Array
    road: Array
    control: Array
    kept: Array
    names: tuple[str, ...]


@dataclass(frozen=True)
class HandlingLayout(LinearLayout):
    """Names of the states relative to the road, then what integrates."""

    @property
    def states(self) -> tuple[str, ...]:
        return tuple(name.removeprefix("p_") for name in self.names[: -len(INTEGRATORS)])


@dataclass(frozen=True, eq=False)
class HandlingModel(LinearModel):
    """`Model` of a car that moves, in the states that forces depend on; ``all_motions`` are those of the whole car.

    ``control`` and ``on_control`` are by `CONTROLS`, then by the forces of an actuator at every corner.
    """

    all_motions: Motions
    control: Array
    on_control: Array
    mass: Array
    stiffness: Array
    carcass: Array
    speed: Array
    critical: Array

    def controls(self) -> tuple[Array, Array]:
        """How steering angles and drive torques drive the states, and outputs."""
        return self.control[..., : len(CONTROLS)], self.on_control[..., : len(CONTROLS)]

    def actuated(self) -> tuple[Array, Array]:
        """What forces between wheel and body, one a corner, do to the states and to the outputs."""
        return self.control[..., len(CONTROLS) :], self.on_control[..., len(CONTROLS) :]

    def whole(self) -> HandlingModel:
        """The same over all motions, the forward speed and the spins among them, which no output feels as such."""
        every = self.all_motions
        return replace(
            self,
            layout=replace(self.layout, names=(*every.names, *INTEGRATORS)),
            A=every.rates @ every.kept,
            B=every.road,
            C=self.C @ every.kept,
            control=every.control,
        )

    def modes(self) -> Modes:
        """Modes of one design, each named after the motion that holds most of its energy, none of these twice.

        What has a position has a mode of its own; sway and yaw share one where they swing. More modes than motions, of
        which a pair that creeps makes two, are named after what holds most of their energy all the same.
        """
        from scipy.optimize import linear_sum_assignment

        every, n = self.all_motions, self.stiffness.shape[-1]
        poles, vectors = self.rates[0], self.vectors[0]
        keep = modes_among(poles)
        poles, vectors = poles[keep], vectors[:, keep]
        # All motions of a mode of the states that forces depend on.
        w = (every.rates[0] @ vectors)[n : n + self.mass.shape[-1]] / poles
        energy = (w.conj() * (self.mass[0] @ w)).real
        energy[:n] += (vectors[:n].conj() * (self.stiffness[0] @ vectors[:n])).real
        carcasses = self.carcass[0][:, None] * np.abs(vectors[len(vectors) - self.carcass.shape[-1] :]) ** 2
        coordinates = tuple(name.removeprefix("d") for name in every.names[n : n + len(w)])
        slots = [NAMED[name] for name in coordinates] + ["relaxation"] * len(carcasses)
        shares = np.concatenate([energy, carcasses])
        shares /= np.abs(shares).sum(axis=0)
        worth = shares + (np.arange(len(slots)) < n)[:, None]
        of, mode = linear_sum_assignment(worth, maximize=True)
        named = {m: slots[i] for i, m in zip(of, mode, strict=True) if shares[i, m] > UNMOVED}
        if len({"sway", "yaw"} & set(named.values())) == 1:
            named = {m: "sway and yaw" if name in ("sway", "yaw") else name for m, name in named.items()}
        motions = tuple(named.get(m, slots[shares[:, m].argmax()]) for m in range(len(keep)))
        return Modes.of(poles, w, coordinates, motions)

    def refusal(self) -> str:
        """Why nothing stays straight: a speed above the critical one, or a mode that no damper or tyre holds."""
        growing = self.rates.real.max(axis=-1) > -ROUNDING * np.abs(self.rates).max(axis=-1)
        if not growing.any():
            return ""
        first = int(np.argmax(growing))
        speed, critical = (float(x[first]) for x in (self.speed, self.critical))
        if speed >= critical:
            return OVER_CRITICAL.format(speed=f"{speed:.4g}", critical=f"{critical:.4g}")
        worst = self.rates[first][np.argmax(self.rates[first].real)]
        return LASTING.format(speed=f"{speed:.4g}", worst=f"{worst:.3g}")

    def drifting(self, which: NDArray[np.bool_]) -> str:
        """What has no finite variance where the warp of the road, or the angle of its tracks, drifts."""
        if not which[INTEGRATORS.index("bank")]:
            return super().drifting(which)
        return (
            "tracks that part without bound tilt the car ever further, so that its roll, and under gravity SWS and "
            "DTL, have no finite variance; isotropic tracks stay together"
        )

    def cornered(self, output: str) -> Array:
        """An output (N,) per lateral acceleration, as the car turns steadily at whatever speed."""
        turn = self.settled({"delta_f": 1.0})
        of = self.layout.outputs.of
        return np.asarray(turn[:, of(output)][:, 0] / turn[:, of("ay")][:, 0])

    def settled(self, given: Mapping[str, float]) -> Array:
        """Outputs (N, outputs) under controls that stay."""
        B, D = self.controls()
        u = np.array([given.get(name, 0.0) for name in CONTROLS])[:, None]
        return np.asarray((D @ u - self.C @ np.linalg.solve(self.A, B @ u))[..., 0])
