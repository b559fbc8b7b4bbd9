"""Half cars: one side of a car, which heaves and pitches, or one axle of it, which heaves and rolls."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

from .linkage import Corner, Link, Linkage, coordinates, track
from .parameters import parameter
from .sections import Mode, Section
from .vehicle import Vehicle, Wheel


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
    a: Any = parameter(0.961, "m", "front axle to centre of gravity")
    b: Any = parameter(1.504, "m", "rear axle to centre of gravity")
    mu: Any = parameter(45.4, "kg", "unsprung mass")
    ks: Any = parameter(18553.0, "N/m", "spring stiffness")
    cs: Any = parameter(1516.5, "N s/m", "damping rate", zero=True)
    kt: Any = parameter(192e3, "N/m", "tyre stiffness")
    ct: Any = parameter(0.0, "N s/m", "tyre damping", zero=True)

    wheels: ClassVar[dict[str, Wheel]] = {"f": Wheel(axle=0, side=0), "r": Wheel(axle=1, side=0)}
    per_corner: ClassVar[tuple[str, ...]] = ("mu", "ks", "cs", "kt", "ct")

    def _linkage(self) -> Linkage:
        wheel_f, wheel_r, heave, pitch = coordinates("z_u_f", "z_u_r", "z_b", "theta")
        points = {"f": heave - self.a * pitch, "r": heave + self.b * pitch}
        wheels = {"f": wheel_f, "r": wheel_r}
        return Linkage(
            masses={**_on_wheels(self, wheels), heave: self.mb, pitch: self.iyy},
            corners=corners_between(self, wheels, points),
            points={"cg": heave, **points},
            rotations={"pitch_acc": pitch},
        )

    def sections(self) -> tuple[Section, ...]:
        front, rear = self._struts()
        body = {"bacc_cg": Mode(1.0 / self.mb, (1.0, 1.0)), "pitch_acc": Mode(1.0 / self.iyy, (-self.a, self.b))}
        return (Section({("f",): front, ("r",): rear}, body),)


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
    c: Any = parameter(0.723, "m", "half track width")
    mu: Any = parameter(45.4, "kg", "unsprung mass")
    ks: Any = parameter(18553.0, "N/m", "spring stiffness")
    cs: Any = parameter(1516.5, "N s/m", "damping rate", zero=True)
    kt: Any = parameter(192e3, "N/m", "tyre stiffness")
    ct: Any = parameter(0.0, "N s/m", "tyre damping", zero=True)
    arb: Any = parameter(0.0, "N/m", "anti-roll bar", zero=True)

    wheels: ClassVar[dict[str, Wheel]] = {"r": Wheel(axle=0, side=-1), "l": Wheel(axle=0, side=1)}
    per_corner: ClassVar[tuple[str, ...]] = ("mu", "ks", "cs", "kt", "ct")

    def _linkage(self) -> Linkage:
        wheel_r, wheel_l, heave, roll = coordinates("z_u_r", "z_u_l", "z_b", "phi")
        points = {"r": heave - self.c * roll, "l": heave + self.c * roll}
        wheels = {"r": wheel_r, "l": wheel_l}
        corners = corners_between(self, wheels, points)
        return Linkage(
            masses={**_on_wheels(self, wheels), heave: self.mb, roll: self.ixx},
            corners=corners,
            points={"cg": heave, **points},
            rotations={"roll_acc": roll},
            bars=[anti_roll_bar(corners["r"], corners["l"], self.arb)],
        )

    def sections(self) -> tuple[Section, ...]:
        right, left = self._struts()
        if not right.equals(left):
            return ()
        sides = ("r", "l")
        return (
            Section({sides: left}, {"bacc_cg": Mode(2.0 / self.mb, (1.0,))}),
            Section({sides: left.with_bar(self.arb)}, {"roll_acc": Mode(2.0 / self.ixx, (self.c,))}),
        )


def _on_wheels(car: Vehicle, wheels: dict) -> dict:
    return dict(zip(wheels.values(), car._at_corners("mu"), strict=True))


def corners_between(car: Vehicle, wheels: dict, points: dict) -> dict[str, Corner]:
    """A suspension between each wheel and its body point, a tyre between each wheel and its road."""
    ks, cs, kt, ct = (car._at_corners(name) for name in ("ks", "cs", "kt", "ct"))
    roads = track(*(f"z_r_{name}" for name in wheels))
    return {
        name: Corner(
            suspension=Link(wheel - points[name], ks[i], cs[i]),
            tyre=Link(roads[i] - wheel, kt[i], ct[i]),
        )
        for i, (name, wheel) in enumerate(wheels.items())
    }


def anti_roll_bar(right: Corner, left: Corner, stiffness: Any) -> Link:
    """A spring along the difference of two suspension deflections."""
    return Link(right.suspension.elongation - left.suspension.elongation, stiffness)
