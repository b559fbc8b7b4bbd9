"""One wheel: the rigid-tyre car of one degree of freedom, the quarter car of two, and three with a seat on it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

from .linkage import Corner, Cushion, Linkage, Wheel, coordinates, track
from .seats import Seat
from .vehicle import Vehicle


@dataclass(frozen=True, kw_only=True, eq=False)
class RigidTyreQuarterCar(Vehicle):
    """The body of a quarter car on its suspension alone: one degree of freedom.

    ``ms z_s'' = ks (z_r - z_s) + cs (z_r' - z_s')`` (Figure 1a of the study). The tyre is rigid, so that the force on
    the road is the suspension's. On a road of white velocity the body acceleration, the tyre load and the
    damper power have no finite variance.

    Parameters
    ----------
    ms : float, array or DataArray
        Sprung mass in kg, > 0 (Table 1).
    ks : float, array or DataArray
        Spring stiffness in N/m, > 0 (middle of Table 2).
    cs : float, array or DataArray
        Damping rate in N s/m, >= 0 (middle of Table 2).

    Examples
    --------
    >>> from susp_ss import RigidTyreQuarterCar
    >>> RigidTyreQuarterCar().natural_frequencies().round(3)
    array([1.217])
    """

    ms: Any = 317.5
    ks: Any = 18553.0
    cs: Any = 1516.5

    wheels: ClassVar[dict[str, Wheel]] = {"": Wheel(axle=0, side=0)}

    def linkage(self) -> Linkage:
        (body,) = coordinates("z_s")
        (road,) = track("z_r")
        return Linkage(
            masses={body: self.ms},
            corners={"": Corner(road, None, body, self.ks, self.cs)},
            points={"": body},
        )


@dataclass(frozen=True, kw_only=True, eq=False)
class QuarterCar(Vehicle):
    """One wheel and its share of the body: two degrees of freedom, the study's low-fidelity model.

    ``mu z_u'' = kt (z_r - z_u) + ct (z_r' - z_u') - ks (z_u - z_s) - cs (z_u' - z_s')`` and
    ``ms z_s'' = ks (z_u - z_s) + cs (z_u' - z_s')`` (Eqs 29 and 30 of the study, tyre damping added).

    Parameters
    ----------
    ms, mu : float, array or DataArray
        Sprung and unsprung mass in kg, > 0 (Table 1).
    ks : float, array or DataArray
        Spring stiffness in N/m, > 0 (middle of Table 2).
    cs : float, array or DataArray
        Damping rate in N s/m, >= 0 (middle of Table 2).
    kt : float, array or DataArray
        Tyre stiffness in N/m, > 0 (Table 1).
    ct : float, array or DataArray
        Tyre damping in N s/m, >= 0.

    Examples
    --------
    >>> import numpy as np
    >>> from susp_ss import QuarterCar, Road, ride_metrics
    >>> sweep = QuarterCar(cs=np.array([800.0, 1500.0, 2200.0]))
    >>> ride_metrics(sweep, Road()).sws.dims
    ('design',)
    """

    ms: Any = 317.5
    mu: Any = 45.4
    ks: Any = 18553.0
    cs: Any = 1516.5
    kt: Any = 192e3
    ct: Any = 0.0

    wheels: ClassVar[dict[str, Wheel]] = {"": Wheel(axle=0, side=0)}

    def linkage(self) -> Linkage:
        wheel, body = coordinates("z_u", "z_s")
        (road,) = track("z_r")
        return Linkage(
            masses={wheel: self.mu, body: self.ms},
            corners={"": Corner(road, wheel, body, self.ks, self.cs, self.kt, self.ct)},
            points={"": body},
        )


@dataclass(frozen=True, kw_only=True, eq=False)
class QuarterCarWithSeat(Vehicle):
    """A quarter car that carries somebody on a seat: three degrees of freedom.

    ``mu z_u'' = kt (z_r - z_u) + ct (z_r' - z_u') - F``, ``ms z_s'' = F - F_seat`` and ``seat_mass z'' = F_seat`` with
    ``F = ks (z_u - z_s) + cs (z_u' - z_s')`` and ``F_seat = seat_ks (z_s - z) + seat_cs (z_s' - z')``: the quarter car
    of the study (Eqs 29 and 30) and a `Seat` on it. ``bacc`` is at the points ``body``, the floor under the seat, and
    ``driver``.

    Parameters
    ----------
    ms, mu, ks, cs, kt, ct : float, array or DataArray
        As in `QuarterCar`.
    seat_mass, seat_ks, seat_cs : float, array or DataArray
        As in `Seat`.

    Examples
    --------
    The ratio of weighted vibration on the seat to that of the floor, its SEAT value (ISO 10326-1):

    >>> import susp_ss as ss
    >>> felt = ss.ride_metrics(ss.QuarterCarWithSeat(), ss.Road(), weighting="Wk").bacc
    >>> print(f"{felt.sel(point='driver') / felt.sel(point='body'):.2f}")
    0.74
    """

    ms: Any = 317.5
    mu: Any = 45.4
    ks: Any = 18553.0
    cs: Any = 1516.5
    kt: Any = 192e3
    ct: Any = 0.0
    seat_mass: Any = Seat.mass
    seat_ks: Any = Seat.ks
    seat_cs: Any = Seat.cs

    wheels: ClassVar[dict[str, Wheel]] = {"": Wheel(axle=0, side=0)}

    def linkage(self) -> Linkage:
        wheel, body, driver = coordinates("z_u", "z_s", "z_seat")
        (road,) = track("z_r")
        return Linkage(
            masses={wheel: self.mu, body: self.ms, driver: self.seat_mass},
            corners={"": Corner(road, wheel, body, self.ks, self.cs, self.kt, self.ct)},
            points={"body": body},
            seats={"driver": Cushion(driver, body, self.seat_ks, self.seat_cs)},
        )
