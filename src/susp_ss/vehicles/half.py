"""Half cars: one side of a car, which heaves and pitches, or one axle of it, which heaves and rolls."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

from .linkage import Corner, Linkage, Motion, Wheel, coordinates, track
from .parameters import parameter
from .vehicle import Vehicle


@dataclass(frozen=True, kw_only=True, eq=False)
class PitchHalfCar(Vehicle):
    """One side of a car: heave, pitch and two wheels, four degrees of freedom.

    The body point over the front end is ``z_b - a theta``, over the rear end ``z_b + b theta`` (Eqs 38 to 41 of the
    study without roll). The parameters ``mu, ks, cs, kt, ct`` take one value or a tuple (front, rear).

    Parameters
    ----------
    mb, iyy : float, array or DataArray
        Body mass (kg) and pitch inertia (kg m^2) of the side, > 0: half of Table 1's.
    a, b : float, array or DataArray
        Distance of the front and the rear axle from the centre of gravity in m, > 0 (Table 1).
    mu, ks, cs, kt, ct : float, array, DataArray or tuple
        Per end, as in `QuarterCar`.

    Examples
    --------
    >>> from susp_ss import PitchHalfCar, Road, ride_metrics
    >>> car = PitchHalfCar(ks=(17e3, 20e3))
    >>> ride_metrics(car, Road()).sws.corner.values.tolist()
    ['f', 'r']
    """

    mb: Any = parameter(635.0, "kg", "body mass of one side")
    iyy: Any = parameter(533.61, "kg m^2", "pitch inertia of one side")
    a: Any = 0.961
    b: Any = 1.504
    mu: Any = 45.4
    ks: Any = 18553.0
    cs: Any = 1516.5
    kt: Any = 192e3
    ct: Any = 0.0

    wheels: ClassVar[dict[str, Wheel]] = {"f": Wheel(axle=0, side=0), "r": Wheel(axle=1, side=0)}
    per_corner: ClassVar[tuple[str, ...]] = ("mu", "ks", "cs", "kt", "ct")

    def linkage(self) -> Linkage:
        *wheels, heave, pitch = coordinates("z_u_f", "z_u_r", "z_b", "theta")
        mounts = {"f": heave - self.a * pitch, "r": heave + self.b * pitch}
        return Linkage(
            masses={**dict(zip(wheels, self.at_wheels("mu"), strict=True)), heave: self.mb, pitch: self.iyy},
            corners=corners(self, wheels, mounts),
            points={"cg": heave, **mounts},
            rotations={"pitch_acc": pitch},
        )


@dataclass(frozen=True, kw_only=True, eq=False)
class RollHalfCar(Vehicle):
    """One axle of a car: heave, roll and two wheels, four degrees of freedom.

    The body point over the right wheel is ``z_b - c phi``, over the left ``z_b + c phi`` (Eqs 38 to 41 of the study
    without pitch). The parameters ``mu, ks, cs, kt, ct`` take one value or a tuple (right, left).

    Parameters
    ----------
    mb, ixx : float, array or DataArray
        Body mass (kg) and roll inertia (kg m^2) of the axle's half, > 0: half of Table 1's.
    c : float, array or DataArray
        Half the track width in m, > 0 (Table 1).
    mu, ks, cs, kt, ct : float, array, DataArray or tuple
        Per side, as in `QuarterCar`.
    arb : float, array or DataArray
        Anti-roll bar in N/m, >= 0: equal and opposite forces at both wheels per metre of difference in suspension
        deflection.

    Examples
    --------
    >>> from susp_ss import RollHalfCar
    >>> soft, stiff = RollHalfCar(), RollHalfCar(arb=15e3)
    >>> bool((stiff.natural_frequencies() >= soft.natural_frequencies() - 1e-9).all())
    True
    """

    mb: Any = parameter(635.0, "kg", "body mass over one axle")
    ixx: Any = parameter(110.225, "kg m^2", "roll inertia over one axle")
    c: Any = 0.723
    mu: Any = 45.4
    ks: Any = 18553.0
    cs: Any = 1516.5
    kt: Any = 192e3
    ct: Any = 0.0
    arb: Any = 0.0

    wheels: ClassVar[dict[str, Wheel]] = {"r": Wheel(axle=0, side=-1), "l": Wheel(axle=0, side=1)}
    per_corner: ClassVar[tuple[str, ...]] = ("mu", "ks", "cs", "kt", "ct")

    def linkage(self) -> Linkage:
        *wheels, heave, roll = coordinates("z_u_r", "z_u_l", "z_b", "phi")
        mounts = {"r": heave - self.c * roll, "l": heave + self.c * roll}
        return Linkage(
            masses={**dict(zip(wheels, self.at_wheels("mu"), strict=True)), heave: self.mb, roll: self.ixx},
            corners=corners(self, wheels, mounts),
            points={"cg": heave, **mounts},
            rotations={"roll_acc": roll},
            bars={("r", "l"): self.arb},
        )


def corners(car: Vehicle, wheels: Sequence[Motion], mounts: Mapping[str, Motion]) -> dict[str, Corner]:
    """A wheel of the car on its own road, with its own suspension and tyre, under each mount."""
    roads = track(*(f"z_r_{name}" for name in mounts))
    values = zip(*(car.at_wheels(name) for name in ("ks", "cs", "kt", "ct")), strict=True)
    parts = zip(mounts.items(), roads, wheels, values, strict=True)
    return {name: Corner(road, wheel, mount, *own) for (name, mount), road, wheel, own in parts}
