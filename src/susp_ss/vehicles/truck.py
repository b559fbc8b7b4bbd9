"""A rigid truck of three axles: nine degrees of freedom."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from .half import corners
from .linkage import Linkage, Wheel, coordinates
from .vehicle import Vehicle

OUTSIDE = "(middle=...) must lie between -a and b, got {middle} m"


@dataclass(frozen=True, kw_only=True, eq=False)
class ThreeAxleTruck(Vehicle):
    """A rigid body on three axles: heave, pitch, roll and six wheel hops.

    The body point over an axle is ``z_b`` less ``theta`` times the distance of the axle ahead of the centre of gravity,
    minus ``c phi`` on the right or plus ``c phi`` on the left, as in `FullCar`. The second axle meets the road ``a +
    middle`` behind the first, the third ``a + b`` behind it. Each wheel has a spring and a damper of its own, which
    stand where it runs; the frame is rigid, nothing equalises the loads of the two axles behind.

    The defaults are a loaded truck of 24 t, with single tyres in front and twin tyres behind; rates, tyres and unsprung
    masses are of the size that heavy vehicles have (P. S. Fancher, R. D. Ervin, C. B. Winkler and T. D. Gillespie, *A
    Factbook of the Mechanical Properties of the Components for Single-Unit and Articulated Heavy Trucks*, UMTRI-86-12,
    1986), for no truck in particular. The body heaves at 1.8 Hz.

    Parameters
    ----------
    mb : float, array or DataArray
        Body mass in kg, > 0.
    ixx, iyy : float, array or DataArray
        Roll and pitch inertia in kg m^2, > 0.
    a, b : float, array or DataArray
        First axle ahead of and third axle behind the centre of gravity in m, > 0.
    middle : float, array or DataArray
        Second axle behind the centre of gravity in m, between the others; negative ahead of it.
    c : float, array or DataArray
        Half the track width in m, > 0, the same on all axles.
    mu, ks, cs, kt, ct : float, array, DataArray or tuple
        Per wheel as in `QuarterCar`: one value, (front, middle, rear), or one for each of ``fr, fl, mr, ml, rr, rl``.
    arb_front, arb_middle, arb_rear : float, array or DataArray
        Anti-roll bars in N/m, >= 0, as in `FullCar`.

    Raises
    ------
    ValueError
        The second axle does not lie between the others.

    Examples
    --------
    >>> import susp_ss as ss
    >>> truck = ss.ThreeAxleTruck(ks=(230e3, 500e3, 500e3))
    >>> ride = ss.ride_metrics(truck, ss.Road.iso8608("C", speed=20.0, tracks="isotropic"))
    >>> ride.dtl.corner.values.tolist()
    ['fr', 'fl', 'mr', 'ml', 'rr', 'rl']
    """

    mb: Any = 21.2e3
    ixx: Any = 25e3
    iyy: Any = 120e3
    a: Any = 3.7
    middle: Any = 0.9
    b: Any = 2.25
    c: Any = 1.0
    mu: Any = (270.0, 540.0, 540.0)
    ks: Any = (250e3, 550e3, 550e3)
    cs: Any = (10e3, 15e3, 15e3)
    kt: Any = (0.9e6, 1.8e6, 1.8e6)
    ct: Any = 0.0
    arb_front: Any = 0.0
    arb_middle: Any = 0.0
    arb_rear: Any = 0.0

    wheels: ClassVar[dict[str, Wheel]] = {
        "fr": Wheel(axle=0, side=-1),
        "fl": Wheel(axle=0, side=1),
        "mr": Wheel(axle=1, side=-1),
        "ml": Wheel(axle=1, side=1),
        "rr": Wheel(axle=2, side=-1),
        "rl": Wheel(axle=2, side=1),
    }
    per_corner: ClassVar[tuple[str, ...]] = ("mu", "ks", "cs", "kt", "ct")

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.lazy:
            return
        space = self.design_space()
        a, middle, b = (space.flat(x) for x in (self.a, self.middle, self.b))
        outside = np.flatnonzero(~((-a < np.asarray(middle)) & (middle < np.asarray(b))))
        if outside.size:
            got = f"{np.broadcast_to(middle, space.size)[outside[0]]:g}"
            at = space.place(int(outside[0]))
            raise ValueError(f"{type(self).__name__}{OUTSIDE.format(middle=got)}{at}")

    @property
    def axles(self) -> tuple[Any, ...]:
        """How far each axle is behind the first, in m."""
        return (0.0, self.a + self.middle, self.a + self.b)

    def linkage(self) -> Linkage:
        *wheels, heave, pitch, roll = coordinates(*(f"z_u_{name}" for name in self.wheels), "z_b", "theta", "phi")
        over = heave - self.a * pitch, heave + self.middle * pitch, heave + self.b * pitch
        mounts = {name: over[axle] + side * self.c * roll for name, (axle, side) in self.wheels.items()}
        at = corners(self, wheels, mounts)
        front, middle, rear = ((at[f"{axle}r"].road, at[f"{axle}l"].road) for axle in "fmr")
        behind, ahead = (self.a + self.middle) / (self.a + self.b), (self.b - self.middle) / (self.a + self.b)
        means = [right + left for right, left in (front, middle, rear)]
        slopes = [left - right for right, left in (front, middle, rear)]
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
            bars={
                ("fr", "fl"): self.arb_front,
                ("mr", "ml"): self.arb_middle,
                ("rr", "rl"): self.arb_rear,
            },
            warps=[
                means[1] - ahead * means[0] - behind * means[2],
                slopes[1] - slopes[0],
                slopes[2] - slopes[1],
            ],
        )
