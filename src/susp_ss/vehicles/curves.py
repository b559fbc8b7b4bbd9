"""Real dampers and springs: force laws in place of one rate, and their Gaussian equivalents.

A law has its force at any velocity or deflection, and, where that is Gaussian of mean m and deviation s, the means of
the force and of its first three derivatives: ``E[f]``, ``E[f'] = E[f (x - m)] / s^2``, ``E[f'']`` and ``E[f''']``. The
second is the rate that comes closest in the mean square (Roberts and Spanos, Random Vibration and Statistical
Linearization, 1990), and they are one another's derivatives: along m each is the next, along s it is s times the one
after the next. Piecewise linear laws have them as a sum over kinks, `Digressive` in closed form.
"""

from __future__ import annotations

import csv
import functools
from collections.abc import Callable
from dataclasses import dataclass
from os import PathLike
from pathlib import Path
from typing import Any, ClassVar, NamedTuple, Protocol, Self

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike, NDArray
from scipy.special import erf, ndtr

from ..quantities import PARAMETERS, UNITS, Quantity, briefly
from .parameters import checked, lazy

Array = NDArray[np.float64]


class Means(NamedTuple):
    """Means of a force (N) and of its first three derivatives under a Gaussian motion."""

    force: Any
    slope: Any
    curvature: Any
    third: Any

    def scaled(self, factor: Any) -> Means:
        """The same of a force that is so many times as large."""
        return Means(*(factor * mean for mean in self))


class Law(Protocol):
    """A force that is zero at rest and never falls; its parameters may be arrays over designs."""

    @property
    def rate(self) -> Any:
        """Slope for small motion: the mean of the slopes on both sides of rest."""
        ...

    @property
    def steepest(self) -> Any:
        """The largest slope."""
        ...

    def leaves(self) -> list[Any]:
        """Its parameters."""
        ...

    def mapped(self, function: Callable[[Any], Any]) -> Self:
        """The same law with a function applied to every parameter."""
        ...

    def force(self, x: Any) -> Any:
        """The force at x."""
        ...

    def means(self, sigma: Any, mean: Any = 0.0) -> Means:
        """Means under a Gaussian x."""
        ...


@dataclass(frozen=True, eq=False)
class Broken:
    """A piecewise linear law: one more slope than kinks, through the origin."""

    kinks: tuple[Any, ...]
    slopes: tuple[Any, ...]

    @property
    def rate(self) -> Any:
        below = above = self.slopes[0]
        for kink, slope in zip(self.kinks, self.slopes[1:], strict=True):
            below, above = _where(kink < 0.0, slope, below), _where(kink <= 0.0, slope, above)
        return 0.5 * (below + above)

    @property
    def steepest(self) -> Any:
        return functools.reduce(np.maximum, self.slopes)

    def leaves(self) -> list[Any]:
        return [*self.kinks, *self.slopes]

    def mapped(self, function: Callable[[Any], Any]) -> Broken:
        return Broken(tuple(map(function, self.kinks)), tuple(map(function, self.slopes)))

    def _bends(self) -> list[tuple[Any, Any]]:
        """Every kink, and by how much the slope rises there."""
        rises = (after - before for before, after in zip(self.slopes, self.slopes[1:], strict=False))
        return list(zip(self.kinks, rises, strict=True))

    def force(self, x: Any) -> Any:
        total = self.slopes[0] * x
        for kink, rise in self._bends():
            total = total + rise * (np.maximum(x - kink, 0.0) - _above(kink))
        return total

    def means(self, sigma: Any, mean: Any = 0.0) -> Means:
        force, slope, curvature, third = self.slopes[0] * mean, self.slopes[0], 0.0, 0.0
        for kink, rise in self._bends():
            u = (mean - kink) / sigma
            below, density = ndtr(u), np.exp(-0.5 * u**2) / np.sqrt(2.0 * np.pi)
            force = force + rise * (sigma * (u * below + density) - _above(kink))
            slope, curvature = slope + rise * below, curvature + rise * density / sigma
            third = third - rise * u * density / sigma**2
        return Means(force, slope, curvature, third)

    def stiffened(self, by: Any) -> Broken:
        """The same with a linear spring beside it."""
        return Broken(self.kinks, tuple(slope + by for slope in self.slopes))


@dataclass(frozen=True, eq=False)
class Digressive:
    """A smooth damper law whose slope falls from its value at rest to ``final`` times that, either way.

    ``f(v) = c (final v + (1 - final) knee erf(sqrt(pi) v / (2 knee)))`` with ``c`` the slope of bump or rebound: the
    error function saturates so that its Gaussian means are elementary. For small motion and in the far, the force is
    along two lines that meet at ``knee``.
    """

    bump: Any
    rebound: Any
    knee: Any
    final: Any

    @property
    def rate(self) -> Any:
        return 0.5 * (self.bump + self.rebound)

    @property
    def steepest(self) -> Any:
        return np.maximum(self.bump, self.rebound)

    def leaves(self) -> list[Any]:
        return [self.bump, self.rebound, self.knee, self.final]

    def mapped(self, function: Callable[[Any], Any]) -> Digressive:
        return Digressive(*map(function, self.leaves()))

    def force(self, x: Any) -> Any:
        saturating = self.knee * erf(0.5 * np.sqrt(np.pi) * x / self.knee)
        return _where(x > 0.0, self.bump, self.rebound) * (self.final * x + (1.0 - self.final) * saturating)

    def means(self, sigma: Any, mean: Any = 0.0) -> Means:
        if np.any(mean):
            raise ValueError("a damper has no mean velocity, about which Digressive.means could be taken")
        t = np.sqrt(0.5 * np.pi) * sigma / self.knee
        skew, above = (self.bump - self.rebound), 1.0 - self.final
        spread = 1.0 + t**2
        return Means(
            skew * (self.final * sigma / np.sqrt(2.0 * np.pi) + above * self.knee * np.arctan(t) / np.pi),
            self.rate * (self.final + above / np.sqrt(spread)),
            skew * (self.final + above / spread) / (np.sqrt(2.0 * np.pi) * sigma),
            -self.rate * above * 0.5 * np.pi / self.knee**2 * spread**-1.5,
        )


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
        self.law, self.said, self.factor = *_tabulated(type(self), velocity, force), 1.0

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
        bump, rebound = (_parameter(x, f"{cls.__name__}.two_slopes({n}=...)", CS) for n, x in _named(bump, rebound))
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
        bump, rebound = (_parameter(x, f"{where}({n}=...)", CS) for n, x in _named(bump, rebound))
        knee = _parameter(knee, f"{where}(knee=...)", Quantity("knee", "m/s", "", bound="> 0"))
        final = _parameter(final, f"{where}(final=...)", Quantity("final", "", "", bound=">= 0"))
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
        return _read(cls, Path(path))

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
        self.law, self.said, self.factor = *_tabulated(type(self), deflection, force), 1.0

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
        ks, stop = (_parameter(x, f"{where}({n}=...)", PARAMETERS["ks"]) for n, x in (("ks", ks), ("stop", stop)))
        clear = Quantity("clearance", "m", "", bound="> 0")
        bump, rebound = (_parameter(x, f"{where}({n}=...)", clear) for n, x in _named(bump, rebound))
        return cls.of(Broken((-rebound, bump), (ks + stop, ks, ks + stop)), said)

    @classmethod
    def from_csv(cls, path: str | PathLike[str]) -> SpringCurve:
        """Read a table: a line of the names (deflection or velocity, and force), a line of their units, and rows.

        Parameters
        ----------
        path : path
            A CSV file in UTF-8, columns in any order. Without the line of units they are SI units.

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
        return _read(cls, Path(path))

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


def _above(kink: Any) -> Any:
    """How far rest lies above a kink."""
    return max(-kink, 0.0) if isinstance(kink, float) else np.maximum(-kink, 0.0)


def _where(condition: Any, one: Any, other: Any) -> Any:
    if any(isinstance(x, xr.DataArray) for x in (condition, one, other)):
        return xr.where(condition, one, other)
    chosen = np.where(condition, one, other)
    return chosen if chosen.ndim else float(chosen)


def _parameter(value: Any, where: str, quantity: Quantity) -> Any:
    return checked(value, where, quantity)


def _factor(value: Any, name: str) -> Any:
    return checked(value, f"the factor of a {name}", Quantity("factor", "", "", bound="> 0"))


def _tabulated(kind: type[Curve], x: ArrayLike, force: ArrayLike) -> tuple[Broken, str]:
    """The law of a table, or say at which of its entries it is none."""
    where = f"{kind.__name__}({kind.across.name}=...)"
    at, forces = _column(x, where, kind.across.unit), _column(force, f"{kind.__name__}(force=...)", "N")
    if len(at) != len(forces):
        raise ValueError(f"{kind.__name__} needs one force for each {kind.across.name}, got {len(forces)}, {len(at)}")
    fault = _fault(at, forces, kind.across)
    if fault is not None:
        entry, said = fault
        raise ValueError(f"{kind.__name__}({said}" + (f" at entry {entry}" if entry is not None else ""))
    slopes = np.diff(forces) / np.diff(at)
    return Broken(tuple(at[1:-1].tolist()), tuple(slopes.tolist())), f"{kind.__name__} of {len(at)} entries"


def _column(values: ArrayLike, where: str, unit: str) -> Array:
    try:
        column = np.asarray(values)
    except ValueError:
        raise TypeError(f"{where} must be one row of numbers in {unit}, got rows of different lengths") from None
    if column.dtype.kind not in "iuf" and column.size:
        raise TypeError(f"{where} must be numbers in {unit}, got {briefly(values)}")
    if column.ndim != 1 or len(column) < 2:
        raise ValueError(f"{where} must be one row of at least two numbers in {unit}, got shape {column.shape}")
    if not np.isfinite(column).all():
        entry = int(np.argmin(np.isfinite(column)))
        raise ValueError(f"{where} must be finite, got {column[entry]} at entry {entry}")
    return column.astype(float)


def _fault(at: Array, forces: Array, across: Quantity) -> tuple[int | None, str] | None:
    """What is wrong with a table, and at which entry; None if nothing."""
    for entry in range(1, len(at)):
        if at[entry] <= at[entry - 1]:
            return (
                entry,
                f"{across.name}=...) must rise strictly, got {at[entry]:g} after {at[entry - 1]:g} {across.unit}",
            )
        if forces[entry] < forces[entry - 1]:
            return entry, f"force=...) must not fall, got {forces[entry]:g} after {forces[entry - 1]:g} N"
    if not at[0] < 0.0 < at[-1]:
        return None, f"{across.name}=...) must reach from below 0 to above 0 {across.unit}, got {at[0]:g} to {at[-1]:g}"
    if forces[0] == forces[-1]:
        return None, f"force=...) must rise somewhere, got {forces[0]:g} N everywhere"
    return None


def _read(kind: Any, path: Path) -> Any:
    """The curve of a CSV table."""
    names = (kind.across.name, "force")
    try:
        rows = [(i, row) for i, row in enumerate(csv.reader(path.read_text("utf-8-sig").splitlines()), 1) if any(row)]
    except UnicodeDecodeError:
        raise ValueError(f"{path}: not UTF-8 text") from None
    header = [cell.strip() for cell in rows[0][1]] if rows else []
    if sorted(header) != sorted(names):
        raise ValueError(f"{path}: line 1 must name the columns {', '.join(names)}, got {', '.join(header) or 'none'}")
    rows, factors = rows[1:], dict.fromkeys(names, 1.0)
    if rows and not any(map(_is_number, rows[0][1])):
        factors = _factors(path, rows[0][0], dict(zip(header, rows[0][1], strict=False)), kind.across.unit)
        rows = rows[1:]
    columns: dict[str, list[float]] = {name: [] for name in names}
    for line, row in rows:
        if len(row) != 2 or not all(map(_is_number, row)):
            raise ValueError(f"{path}: line {line} must have two numbers, got {','.join(row)}")
        for name, cell in zip(header, row, strict=True):
            columns[name].append(float(cell) * factors[name])
    at, forces = (np.array(columns[name]) for name in names)
    fault = _fault(at, forces, kind.across) if len(at) > 1 else (None, "...) needs at least two rows")
    if fault is not None:
        entry, said = fault
        place = "" if entry is None else f"line {rows[entry][0]}: "
        raise ValueError(f"{path}: {place}{said.replace('=...)', '').replace('...) ', '')}")
    return kind(at, forces)


def _factors(path: Path, line: int, stated: dict[str, str], unit: str) -> dict[str, float]:
    units = {"force": UNITS["N"], ("velocity" if unit == "m/s" else "deflection"): UNITS[unit]}
    for name, known in units.items():
        if stated.get(name, "").strip() not in known:
            raise ValueError(
                f"{path}: line {line}: the unit of {name} must be one of {', '.join(known)}, got "
                f"{stated.get(name, '').strip() or 'none'}"
            )
    return {name: known[stated[name].strip()] for name, known in units.items()}


def _is_number(cell: str) -> bool:
    try:
        return bool(np.isfinite(float(cell)))
    except ValueError:
        return False
