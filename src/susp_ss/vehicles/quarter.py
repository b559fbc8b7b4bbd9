"""One wheel: the rigid-tyre car of one degree of freedom and the quarter car of two."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

from .linkage import Corner, Linkage, Wheel, coordinates, track
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
