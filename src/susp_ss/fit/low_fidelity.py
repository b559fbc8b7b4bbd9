"""A cheap vehicle that stands in for a car with more parameters than its own.

A quarter car has one spring where a car has four: it takes the one of its corner, or the mean of those it stands for.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..metrics.response import Response
from ..metrics.weightings import ACCELERATIONS, filter_of
from ..quantities import CORNERS, GROUPS, ROAD, briefly, metric_and_place, signal
from ..responses.filters import Filter
from ..responses.settings import settable
from ..roads.road import Road
from ..vehicles.curves import rate_of
from ..vehicles.full import FullCar
from ..vehicles.linkage import Wheel
from ..vehicles.vehicle import Vehicle

Array = NDArray[np.float64]

ALL = frozenset(CORNERS)


class LowFidelityResponse:
    """A cheap vehicle's metric as a function of the inputs of an expensive car, matched by their names.

    An input's name is a parameter's (``ks``, ``ms``, ``speed``), with ``_fr``, ``_fl``, ``_rr``, ``_rl``, ``_front``,
    ``_rear``, ``_right`` or ``_left`` if it belongs to some corners only. Each wheel of the cheap vehicle stands for
    the corners at its end and on its side; where the vehicle has no ends or no sides, for those at ``place``. Its
    parameter is the mean over these corners, with its own value at those that no column sets.

    Parameters
    ----------
    vehicle : Vehicle
        The cheap model, one number for every parameter.
    road : Road
        What it runs over.
    criterion : str
        Name of a variable of `ride_metrics`.
    place : str, optional
        Where the expensive car was measured: a corner, or ``"cg"``.
    columns : sequence of str
        Names of the columns of X, in SI units.
    parameter : str, optional
        A parameter of the cheap model that a second argument sets, as in `Response`.
    weighting : str or system of python-control, optional
        A filter before accelerations become root mean squares, as in `Response`.

    Attributes
    ----------
    unknown : tuple of str
        Columns that the cheap model has no parameter for, and ignores.

    Raises
    ------
    TypeError, ValueError
        As `Response`; two columns that set one corner's parameter; columns of which the cheap model knows none.

    Examples
    --------
    >>> from susp_ss import QuarterCar, Response, Road
    >>> from susp_ss.fit.low_fidelity import LowFidelityResponse
    >>> cheap = LowFidelityResponse(QuarterCar(), Road(), "sws", "rr", ("ks_front", "ks_rear", "cs", "gap"))
    >>> cheap.unknown
    ('ks_front', 'gap')
    >>> bool(cheap([[18e3, 22e3, 1500.0, 0.1]]) == Response(QuarterCar(), Road(), "sws")([[22e3, 1500.0]]))
    True
    """

    value_per_design = True

    def __init__(
        self,
        vehicle: Vehicle,
        road: Road,
        criterion: str,
        place: str | None,
        columns: Sequence[str],
        parameter: str | None = None,
        weighting: Any = None,
    ):
        self.vehicle, self.road, self.criterion, self.place = vehicle, road, criterion, place
        self.columns, self.parameter = tuple(columns), parameter
        if len(vehicle.axles) > 2:
            raise ValueError(
                f"a cheap model stands for the corners of a car, and a {type(vehicle).__name__} has more axles; pass "
                "one with at most two"
            )
        shares = _shares(vehicle, place, self.columns)
        if not shares:
            raise ValueError(
                f"{type(vehicle).__name__} has none of the inputs {', '.join(columns)}, available: "
                f"{', '.join(settable(vehicle))}"
            )
        self._weights = np.array(list(shares.values())).T
        self.unknown = tuple(name for name, row in zip(self.columns, self._weights, strict=True) if not row.any())
        at = own_place(vehicle, place) if vehicle.layout().variables[criterion][0].dim else None
        self.response = Response(vehicle, road, criterion, at, tuple(shares), parameter, weighting)
        self._rest = (1.0 - self._weights.sum(axis=0)) * [self.response.own(name) for name in shares]
        if hasattr(self.response, "parameter_value"):
            self.parameter_value = self.response.parameter_value

    def __call__(self, X: ArrayLike, value: ArrayLike | None = None) -> Array:
        """Evaluate the metric at designs X (n, columns), with ``value`` for the parameter if one is named."""
        designs = np.asarray(X, dtype=float)
        if designs.ndim != 2 or designs.shape[1] != len(self.columns):
            raise ValueError(
                f"X must have shape (n, {len(self.columns)}) with columns {', '.join(self.columns)}, got "
                f"{designs.shape}"
            )
        return self.response(designs @ self._weights + self._rest, value)

    def expressions(self) -> dict[str, str]:
        """Each input of the cheap model as text in the names of the columns.

        Examples
        --------
        >>> from susp_ss import QuarterCar, Road
        >>> from susp_ss.fit.low_fidelity import LowFidelityResponse
        >>> LowFidelityResponse(QuarterCar(), Road(), "sws", "cg", ("ks_front", "ks_rear", "cs")).expressions()
        {'ks': '(0.5*ks_front+0.5*ks_rear)', 'cs': 'cs'}
        """
        expressions = {}
        for own, shares, rest in zip(self.response.inputs, self._weights.T.tolist(), self._rest.tolist(), strict=True):
            terms = [_scaled(share, name) for share, name in zip(shares, self.columns, strict=True) if share]
            terms += [repr(rest)] if rest else []
            expressions[own] = terms[0] if terms == [terms[0]] and 1.0 in shares else f"({'+'.join(terms)})"
        return expressions


def _scaled(share: float, name: str) -> str:
    return name if share == 1.0 else f"{share!r}*{name}"


def corners_of(name: str) -> tuple[str, frozenset[str]]:
    """Split ``"ks_front"`` into the parameter and the corners that have it; without a suffix, all."""
    field, _, place = name.rpartition("_")
    corners = GROUPS.get(place, ALL & {place})
    return (field, corners) if corners and field in FullCar.per_corner else (name, ALL)


def _shares(vehicle: Vehicle, place: str | None, columns: Sequence[str]) -> dict[str, Array]:
    """How much of each column every input of the cheap model's `Response` takes."""
    fields = {*vehicle.quantities(), *ROAD}
    shares: dict[str, Array] = {}
    for wheel, where in vehicle.wheels.items():
        stood_for = stands_for(vehicle, where, place)
        taken: dict[tuple[str, str], str] = {}
        for i, name in enumerate(columns):
            field, corners = (name, stood_for) if name in fields else corners_of(name)
            if field not in fields or not corners & stood_for:
                continue
            for corner in corners & stood_for:
                if taken.setdefault((field, corner), name) != name:
                    raise ValueError(f"{taken[field, corner]!r} and {name!r} both set {field} at corner {corner}")
            own = signal(field, wheel) if field in vehicle.per_corner else field
            shares.setdefault(own, np.zeros(len(columns)))[i] = len(corners & stood_for) / len(stood_for)
    return shares


def stands_for(vehicle: Vehicle, wheel: Wheel, place: str | None) -> frozenset[str]:
    """Corners of a car that a wheel of the cheap vehicle stands for."""
    axles, sides = (set(column) for column in zip(*vehicle.wheels.values(), strict=True))
    measured = FullCar.wheels.get(place or "")

    def stands(corner: Wheel) -> bool:
        end, flank = (wheel if len(own) > 1 else measured or corner for own in (axles, sides))
        return corner == Wheel(end.axle, flank.side)

    return frozenset(name for name, corner in FullCar.wheels.items() if stands(corner))


def own_place(vehicle: Vehicle, place: str | None) -> str | None:
    """The cheap vehicle's name of a place on the car."""
    if len(vehicle.wheels) == 1 or place not in FullCar.wheels:
        return None if len(vehicle.wheels) == 1 else place
    return next(name for name, wheel in vehicle.wheels.items() if place in stands_for(vehicle, wheel, place))


@dataclass(frozen=True, eq=False)
class LowFidelity:
    """A cheap model and its road, to stand in for an expensive one whatever its inputs and outputs are.

    Parameters
    ----------
    vehicle : Vehicle
        One number for every parameter.
    road : Road
    place : str, optional
        Where the expensive model was measured, for outputs whose names do not say so: a corner, or ``"cg"``.
    parameter : str, optional
        Of the vehicle or the road, which a parameter-based surrogate tunes.
    weighting : str or system of python-control, optional
        What the expensive model's accelerations are weighted by before they become root mean squares: a name of
        `susp_ss.weighting` or a filter. The cheap model's are weighted likewise.

    Examples
    --------
    >>> from susp_ss import LowFidelity, QuarterCar, Road
    >>> cheap = LowFidelity(QuarterCar(), Road(), place="fr")
    >>> cheap.response("sws", ("ks_front", "cs")).place, cheap.response("roll_acc", ("ks_front", "cs"))
    ('fr', None)
    """

    vehicle: Vehicle
    road: Road
    place: str | None = None
    parameter: str | None = None
    weighting: Any = None

    def __post_init__(self) -> None:
        if self.place not in (None, "cg", *CORNERS):
            raise ValueError(f"place must be one of {', '.join(CORNERS)}, cg, got {briefly(self.place)}")
        if self.weighting is not None:
            filter_of(self.weighting, "weighting")

    def through(self, output: str) -> Filter | None:
        """Return the filter that an output passes before its root mean square is taken, or None."""
        behind = self.weighting is not None and metric_and_place(output)[0] in ACCELERATIONS
        return filter_of(self.weighting, "weighting") if behind else None

    def own(self, column: str) -> float | None:
        """Return the model's own value of a column's parameter, over all its wheels, or None if it has none."""
        known = self.vehicle.quantities()
        field = column if column in known else corners_of(column)[0]
        if field in ROAD:
            return getattr(self.road, field)
        return float(np.mean([rate_of(own) for own in self.vehicle.at_wheels(field)])) if field in known else None

    def response(self, output: str, columns: Sequence[str], tuned: bool = False) -> LowFidelityResponse | None:
        """Return the cheap response of an output to named columns, or None where the model has none.

        ``tuned`` gives it the parameter as second argument.

        Raises
        ------
        TypeError, ValueError
            As `LowFidelityResponse`; an output without a place, where the model has several.
        """
        metric, place = metric_and_place(output)
        place = self.place if place is None else place
        measured = self.vehicle.layout().variables
        if metric not in measured:
            return None
        if place is None and measured[metric][0].dim and len(self.vehicle.wheels) > 1:
            raise ValueError(
                f"output {output!r} has several places on {type(self.vehicle).__name__}; name it, such as {output}_fr"
            )
        parameter = self.parameter if tuned else None
        return LowFidelityResponse(self.vehicle, self.road, metric, place, columns, parameter, self.weighting)
