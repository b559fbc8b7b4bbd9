"""The full car of seven degrees of freedom, the study's high-fidelity model."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

from .half import anti_roll_bar, corners_between
from .linkage import Linkage, coordinates
from .parameters import parameter
from .sections import Mode, Section
from .vehicle import Vehicle, Wheel


@dataclass(frozen=True, kw_only=True, eq=False)
class FullCar(Vehicle):
    """A rigid body on four wheels: heave, pitch, roll and four wheel hops (Eqs 31 to 41 of the study).

    The body point over a corner is ``z_b`` minus ``a theta`` in front or plus ``b theta`` behind, minus ``c phi`` on
    the right or plus ``c phi`` on the left. ``theta`` is the PITCH angle with ``iyy`` and ``phi`` the ROLL angle with
    ``ixx``; the study's nomenclature swaps the two names, its equations are as written here. The parameters
    ``mu, ks, cs, kt, ct`` take one value for all corners or `Corners`.

    Parameters
    ----------
    mb : float, array or DataArray
        Body mass in kg, > 0: four times Table 1's sprung mass.
    ixx, iyy : float, array or DataArray
        Roll and pitch inertia in kg m^2, > 0 (Table 1).
    a, b, c : float, array or DataArray
        Front axle and rear axle to the centre of gravity, and half the track width, in m, > 0 (Table 1).
    mu, ks, cs, kt, ct : float, array, DataArray or Corners
        Per corner, as in `QuarterCar`.
    arb_front, arb_rear : float, array or DataArray
        Anti-roll bars in N/m, >= 0: equal and opposite forces at the two corners of an axle per metre of
        difference in suspension deflection.

    Examples
    --------
    >>> from susp_ss import Corners, FullCar
    >>> car = FullCar(cs=Corners.axles(front=1400.0, rear=1700.0), arb_front=12e3)
    >>> system = car.state_space()
    >>> system["sws_fr", "z_r_fr"].nstates
    14
    """

    mb: Any = parameter(1270.0, "kg", "body mass")
    ixx: Any = parameter(220.45, "kg m^2", "roll inertia")
    iyy: Any = parameter(1067.22, "kg m^2", "pitch inertia")
    a: Any = parameter(0.961, "m", "front axle to centre of gravity")
    b: Any = parameter(1.504, "m", "rear axle to centre of gravity")
    c: Any = parameter(0.723, "m", "half track width")
    mu: Any = parameter(45.4, "kg", "unsprung mass")
    ks: Any = parameter(18553.0, "N/m", "spring stiffness")
    cs: Any = parameter(1516.5, "N s/m", "damping rate", zero=True)
    kt: Any = parameter(192e3, "N/m", "tyre stiffness")
    ct: Any = parameter(0.0, "N s/m", "tyre damping", zero=True)
    arb_front: Any = parameter(0.0, "N/m", "front anti-roll bar", zero=True)
    arb_rear: Any = parameter(0.0, "N/m", "rear anti-roll bar", zero=True)

    wheels: ClassVar[dict[str, Wheel]] = {
        "fr": Wheel(axle=0, side=-1),
        "fl": Wheel(axle=0, side=1),
        "rr": Wheel(axle=1, side=-1),
        "rl": Wheel(axle=1, side=1),
    }
    per_corner: ClassVar[tuple[str, ...]] = ("mu", "ks", "cs", "kt", "ct")

    def _linkage(self) -> Linkage:
        *wheel, heave, pitch, roll = coordinates(*(f"z_u_{name}" for name in self.wheels), "z_b", "theta", "phi")
        points = {
            "fr": heave - self.a * pitch - self.c * roll,
            "fl": heave - self.a * pitch + self.c * roll,
            "rr": heave + self.b * pitch - self.c * roll,
            "rl": heave + self.b * pitch + self.c * roll,
        }
        corners = corners_between(self, dict(zip(self.wheels, wheel, strict=True)), points)
        road = {name: corner.tyre.elongation + wheel[i] for i, (name, corner) in enumerate(corners.items())}
        return Linkage(
            masses={
                **dict(zip(wheel, self._at_corners("mu"), strict=True)),
                heave: self.mb,
                pitch: self.iyy,
                roll: self.ixx,
            },
            corners=corners,
            points={"cg": heave, **points},
            rotations={"pitch_acc": pitch, "roll_acc": roll},
            bars=[
                anti_roll_bar(corners["fr"], corners["fl"], self.arb_front),
                anti_roll_bar(corners["rr"], corners["rl"], self.arb_rear),
            ],
            warp=road["fr"] - road["fl"] - road["rr"] + road["rl"],
        )

    def sections(self) -> tuple[Section, ...]:
        right, left, rear_right, rear_left = self._struts()
        if not (right.equals(left) and rear_right.equals(rear_left)):
            return ()
        front, rear = ("fr", "fl"), ("rr", "rl")
        return (
            Section(
                {front: left, rear: rear_left},
                {
                    "bacc_cg": Mode(2.0 / self.mb, (1.0, 1.0)),
                    "pitch_acc": Mode(2.0 / self.iyy, (-self.a, self.b)),
                },
            ),
            Section(
                {front: left.with_bar(self.arb_front), rear: rear_left.with_bar(self.arb_rear)},
                {"roll_acc": Mode(2.0 / self.ixx, (self.c, self.c))},
            ),
        )
