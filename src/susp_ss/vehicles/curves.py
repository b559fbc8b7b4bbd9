"""Real dampers and springs: curves of force in place of one rate.

A curve is a law of `laws` that belongs to a field of a vehicle, ``cs`` or ``ks``, and spans designs as a number does.
"""

from __future__ import annotations

from collections.abc import Callable
from os import PathLike
from pathlib import Path
from typing import Any, ClassVar, Self

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike

from ..quantities import PARAMETERS, Quantity, briefly
from .laws import Broken, Digressive, Law, Means
from .parameters import checked, lazy
from .tables import read_table, tabulated


class Curve:
    """A force law that stands where a rate may: ``factor`` times a `Law`, which ``said`` shows as it was written."""

    law: Law
    factor: Any
    said: str

    field: ClassVar[str]
    across: ClassVar[Quantity]
    middling: ClassVar[float]
    """Deviation of the motion on a passable road."""

    # An array on the left would otherwise take the product element by element.
    __array_ufunc__ = None

    @classmethod
    def of(cls, law: Law, said: str, factor: Any = 1.0) -> Self:
        """The curve of a law."""
        curve = object.__new__(cls)
        curve.law, curve.said, curve.factor = law, said, factor
        return curve

    def _tabulate(self, x: ArrayLike, force: ArrayLike) -> None:
        name = type(self).__name__
        self.law, self.factor = tabulated(name, self.across, x, force), 1.0
        self.said = f"{name} of {np.size(x)} entries"

    def __mul__(self, factor: Any) -> Self:
        return self.of(self.law, self.said, self.factor * _factor(factor, type(self).__name__))

    __rmul__ = __mul__

    def __repr__(self) -> str:
        times = "" if isinstance(self.factor, float) and self.factor == 1.0 else f"{briefly(self.factor)} * "
        return times + self.said

    @property
    def rate(self) -> Any:
        """Rate for small motion, the mean of the slopes on both sides of rest."""
        return self.factor * self.law.rate

    @property
    def steepest(self) -> Any:
        """The largest rate."""
        return self.factor * self.law.steepest

    def leaves(self) -> list[Any]:
        """Numbers, arrays or DataArrays: what may span designs."""
        return [*self.law.leaves(), self.factor]

    def mapped(self, function: Callable[[Any], Any]) -> Self:
        """The same with a function applied to every leaf."""
        return self.of(self.law.mapped(function), self.said, function(self.factor))

    def force(self, x: ArrayLike) -> Any:
        """Force in N at a velocity (m/s) or a deflection (m), zero at rest."""
        force = self.law.force(x if isinstance(x, xr.DataArray) else np.asarray(x, dtype=float))
        return force if isinstance(self.factor, float) and self.factor == 1.0 else self.factor * force

    def means(self, sigma: Any, mean: Any = 0.0) -> Means:
        """Means of the force and its derivatives where the motion is Gaussian."""
        return self.law.means(sigma, mean).scaled(self.factor)

    def with_rate(self, rate: Any) -> Self:
        """One of another rate for small motion."""
        raise NotImplementedError

    def alike(self, other: Any) -> bool:
        """Whether another is the same law in every design."""
        if self is other:
            return True
        if type(self) is not type(other) or type(self.law) is not type(other.law):
            return False
        own, others = self.leaves(), other.leaves()
        return len(own) == len(others) and all(map(np.array_equal, own, others))


class DamperCurve(Curve):
    """A damper's force as a function of its velocity, in place of a damping rate ``cs``.

    Bump (compression) is positive, velocity and force alike. The force is linear between the entries of a table and
    goes on beyond its ends with their slopes; its value at rest, such as a gas spring's, belongs to the static load and
    is taken off. `simulate` and ``ride_metrics(..., method="time")`` take the curve as it is, the other routes its
    Gaussian equivalent (`susp_ss.linearised`).

    Parameters
    ----------
    velocity : sequence of float
        In m/s, rising strictly from below 0 to above 0.
    force : sequence of float
        In N, never falling.

    Raises
    ------
    TypeError, ValueError
        No such numbers; the message says at which entry.

    See Also
    --------
    DamperCurve.two_slopes, DamperCurve.digressive, DamperCurve.from_csv

    Notes
    -----
    A number times a curve is a curve; an array makes a sweep: ``DamperCurve(...) * valve`` with a DataArray on the
    right. Where a setting such as ``cs`` of `Response` gives a curve a number, that is its rate for small motion, the
    mean of the slopes on both sides of rest, to which the curve is scaled.

    Examples
    --------
    >>> import numpy as np
    >>> from susp_ss import DamperCurve, QuarterCar, Road, ride_metrics
    >>> damper = DamperCurve(velocity=[-1.0, -0.1, 0.0, 0.1, 1.0], force=[-1600.0, -250.0, 0.0, 100.0, 600.0])
    >>> damper.force([-2.0, 0.05]).round(6).tolist()
    [-3100.0, 50.0]
    >>> metrics = ride_metrics(QuarterCar(cs=damper * np.array([0.5, 1.0, 2.0])), Road.iso8608("C", speed=20.0))
    >>> metrics.bacc.round(2).values.tolist()
    [1.28, 1.3, 1.66]
    """

    field = "cs"
    across = Quantity("velocity", "m/s", "velocity of the damper")
    middling = 0.2

    def __init__(self, velocity: ArrayLike, force: ArrayLike):
        self._tabulate(velocity, force)

    @classmethod
    def two_slopes(cls, bump: Any, rebound: Any) -> DamperCurve:
        """A damper of one rate in bump and another in rebound, in N s/m, >= 0, numbers, arrays or DataArrays.

        Examples
        --------
        >>> from susp_ss import DamperCurve
        >>> damper = DamperCurve.two_slopes(bump=800.0, rebound=2400.0)
        >>> damper.rate, damper.force([-1.0, 1.0]).tolist()
        (1600.0, [-2400.0, 800.0])
        """
        said = _call(f"{cls.__name__}.two_slopes", bump=bump, rebound=rebound)
        bump, rebound = (checked(x, f"{cls.__name__}.two_slopes({n}=...)", CS) for n, x in _named(bump, rebound))
        return cls.of(Broken((0.0,), (rebound, bump)), said)

    @classmethod
    def digressive(cls, bump: Any, rebound: Any, knee: Any, final: Any) -> DamperCurve:
        """A damper whose force rises ever less, smoothly.

        ``f = c (final v + (1 - final) knee erf(sqrt(pi) v / (2 knee)))``: for small motion with the slope ``c`` of bump
        or rebound, far beyond the knee with ``final`` times that; the two lines meet at ``knee``. Saturation by the
        error function has elementary Gaussian means (Gelb and Vander Velde, Multiple-Input Describing Functions, 1968).

        Parameters
        ----------
        bump, rebound : float, array or DataArray
            Slopes at rest in N s/m, >= 0.
        knee : float, array or DataArray
            In m/s, > 0.
        final : float, array or DataArray
            From 0 to 1.

        Examples
        --------
        >>> from susp_ss import DamperCurve
        >>> damper = DamperCurve.digressive(bump=1000.0, rebound=3000.0, knee=0.2, final=0.25)
        >>> damper.force([0.01, 1.0]).round(1).tolist()
        [10.0, 400.0]
        """
        where = f"{cls.__name__}.digressive"
        said = _call(where, bump=bump, rebound=rebound, knee=knee, final=final)
        bump, rebound = (checked(x, f"{where}({n}=...)", CS) for n, x in _named(bump, rebound))
        knee = checked(knee, f"{where}(knee=...)", Quantity("knee", "m/s", "", bound="> 0"))
        final = checked(final, f"{where}(final=...)", Quantity("final", "", "", bound=">= 0"))
        if np.any(final > 1.0):
            raise ValueError(f"{where}(final=...) must be from 0 to 1, got {briefly(final)}")
        return cls.of(Digressive(bump, rebound, knee, final), said)

    @classmethod
    def from_csv(cls, path: str | PathLike[str]) -> DamperCurve:
        """Read a table of the columns velocity and force; `SpringCurve.from_csv` says how.

        Examples
        --------
        >>> import pathlib, tempfile
        >>> from susp_ss import DamperCurve
        >>> path = pathlib.Path(tempfile.mkdtemp(), "damper.csv")
        >>> _ = path.write_text("velocity,force\\nmm/s,kN\\n-100,-0.3\\n0,0\\n100,0.1\\n")
        >>> DamperCurve.from_csv(path).force(0.2).item()
        200.0
        """
        return cls(*read_table(cls.across, Path(path)))

    def with_rate(self, rate: Any) -> Self:
        """The same damper scaled to another rate for small motion.

        Raises
        ------
        ValueError
            It has no rate for small motion that could be scaled.
        """
        if np.any(self.law.rate == 0.0):
            raise ValueError(f"{self!r} has no force for small motion, so that no rate can scale it")
        return self.of(self.law, self.said, rate / self.law.rate)


class SpringCurve(Curve):
    """A spring's force as a function of its deflection, in place of a stiffness ``ks``.

    Deflection is that of the suspension from static equilibrium, wheel minus body, bump (compression) positive, and so
    is the force, beside the static load: a table's value at zero is taken off. The force is linear between the entries
    and goes on beyond the ends with their slopes. The covariance route answers with its Gaussian equivalent, about the
    mean deflection that springs and dampers of unequal sides lead to (`susp_ss.linearised`).

    Parameters
    ----------
    deflection : sequence of float
        In m, rising strictly from below 0 to above 0.
    force : sequence of float
        In N, never falling.

    Raises
    ------
    TypeError, ValueError
        No such numbers; the message says at which entry.

    See Also
    --------
    SpringCurve.with_stops, SpringCurve.from_csv

    Notes
    -----
    A number or array times a curve is a curve. Where a setting such as ``ks`` of `Response` gives a curve a number,
    that is its stiffness for small motion: the main spring is exchanged, what stops add is kept.

    Examples
    --------
    >>> from susp_ss import SpringCurve
    >>> spring = SpringCurve(deflection=[-0.1, 0.0, 0.06, 0.08], force=[2000.0, 4000.0, 5200.0, 9200.0])
    >>> spring.force([0.06, 0.09]).round(6).tolist()
    [1200.0, 7200.0]
    """

    field = "ks"
    across = Quantity("deflection", "m", "deflection of the spring")
    middling = 0.01

    def __init__(self, deflection: ArrayLike, force: ArrayLike):
        self._tabulate(deflection, force)

    @classmethod
    def with_stops(cls, ks: Any, stop: Any, bump: Any, rebound: Any) -> SpringCurve:
        """A linear spring between stops.

        Parameters
        ----------
        ks, stop : float, array or DataArray
            Stiffness of the spring, and what a stop adds once it touches, in N/m, > 0.
        bump, rebound : float, array or DataArray
            Clearance to the stops in m, > 0.

        Examples
        --------
        >>> from susp_ss import SpringCurve
        >>> spring = SpringCurve.with_stops(ks=18e3, stop=150e3, bump=0.05, rebound=0.06)
        >>> spring.force([0.05, 0.07]).round(6).tolist()
        [900.0, 4260.0]
        """
        where = f"{cls.__name__}.with_stops"
        said = _call(where, ks=ks, stop=stop, bump=bump, rebound=rebound)
        ks, stop = (checked(x, f"{where}({n}=...)", PARAMETERS["ks"]) for n, x in (("ks", ks), ("stop", stop)))
        clear = Quantity("clearance", "m", "", bound="> 0")
        bump, rebound = (checked(x, f"{where}({n}=...)", clear) for n, x in _named(bump, rebound))
        return cls.of(Broken((-rebound, bump), (ks + stop, ks, ks + stop)), said)

    @classmethod
    def from_csv(cls, path: str | PathLike[str]) -> SpringCurve:
        """Read a table: a line of the names (deflection or velocity, and force), a line of their units, and rows.

        Parameters
        ----------
        path : path
            A CSV file, as any program writes it, columns in any order. Without the line of units they are SI units.

        Raises
        ------
        OSError
            The file cannot be read.
        ValueError
            Something else than such a table, with the number of the line.

        Examples
        --------
        >>> import pathlib, tempfile
        >>> from susp_ss import SpringCurve
        >>> path = pathlib.Path(tempfile.mkdtemp(), "spring.csv")
        >>> _ = path.write_text("deflection,force\\nmm,N\\n-50,-900\\n0,0\\n50,1000\\n")
        >>> SpringCurve.from_csv(path).force(0.01).round(9).item()
        200.0
        """
        return cls(*read_table(cls.across, Path(path)))

    def with_rate(self, rate: Any) -> Self:
        """The same with another main spring, so that this is the stiffness for small motion.

        Raises
        ------
        ValueError
            Its force would then fall somewhere.
        """
        law: Any = self.law
        stiffened = law.stiffened(rate / self.factor - law.rate)
        if any(not lazy(slope) and np.any(slope < 0.0) for slope in stiffened.slopes):
            raise ValueError(
                f"{self!r} is softer somewhere than for small motion, where its stiffness is {briefly(self.rate)} N/m; "
                f"a stiffness of {briefly(rate)} N/m would let its force fall there"
            )
        return self.of(stiffened, self.said, self.factor)


CS = PARAMETERS["cs"]


def rated(own: Any, number: Any) -> Any:
    """What a number makes of a parameter's own value: of a curve, one of that rate for small motion."""
    return own.with_rate(number) if isinstance(own, Curve) else number


def rate_of(own: Any) -> Any:
    """A parameter's number: of a curve its rate for small motion."""
    return own.rate if isinstance(own, Curve) else own


def check_place(curve: Curve, where: str, field: str) -> Curve:
    """A curve in a field that takes it, or say which it takes."""
    if curve.field != field:
        takes = {"cs": "a number or a DamperCurve", "ks": "a number or a SpringCurve"}.get(field, "a number")
        raise TypeError(f"{where} takes {takes}, got {briefly(curve)}")
    return curve


def _call(name: str, **given: Any) -> str:
    return f"{name}({', '.join(f'{key}={briefly(value)}' for key, value in given.items())})"


def _named(bump: Any, rebound: Any) -> list[tuple[str, Any]]:
    return [("bump", bump), ("rebound", rebound)]


def _factor(value: Any, name: str) -> Any:
    return checked(value, f"the factor of a {name}", Quantity("factor", "", "", bound="> 0"))
