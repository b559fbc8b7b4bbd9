"""The full car of seven degrees of freedom, the study's high-fidelity model."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

from .half import corners
from .linkage import Linkage, Wheel, coordinates
from .vehicle import Vehicle


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

    mb: Any = 1270.0
    ixx: Any = 220.45
    iyy: Any = 1067.22
    a: Any = 0.961
    b: Any = 1.504
    c: Any = 0.723
    mu: Any = 45.4
    ks: Any = 18553.0
    cs: Any = 1516.5
    kt: Any = 192e3
    ct: Any = 0.0
    arb_front: Any = 0.0
    arb_rear: Any = 0.0

    wheels: ClassVar[dict[str, Wheel]] = {
        "fr": Wheel(axle=0, side=-1),
        "fl": Wheel(axle=0, side=1),
        "rr": Wheel(axle=1, side=-1),
        "rl": Wheel(axle=1, side=1),
    }
    per_corner: ClassVar[tuple[str, ...]] = ("mu", "ks", "cs", "kt", "ct")

    def linkage(self) -> Linkage:
        *wheels, heave, pitch, roll = coordinates(*(f"z_u_{name}" for name in self.wheels), "z_b", "theta", "phi")
        front, rear, side = heave - self.a * pitch, heave + self.b * pitch, self.c * roll
        mounts = {"fr": front - side, "fl": front + side, "rr": rear - side, "rl": rear + side}
        at = corners(self, wheels, mounts)
        return Linkage(
            masses={
                **dict(zip(wheels, self.at_wheels("mu"), strict=True)),
                heave: self.mb,
                pitch: self.iyy,
                roll: self.ixx,
            },
            corners=at,
            points={"cg": heave, **mounts},
            rotations={"pitch_acc": pitch, "roll_acc": roll},
            bars={("fr", "fl"): self.arb_front, ("rr", "rl"): self.arb_rear},
            warps=[at["fr"].road - at["fl"].road - at["rr"].road + at["rl"].road],
        )
