"""From vehicles to surrogates: a ride metric as a function of designs, a row of numbers each."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping, Sequence
from itertools import combinations
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..quantities import ROAD, briefly
from ..responses.excitation import check_kinds
from ..responses.labels import dim_of
from ..responses.settings import settable
from ..roads.road import Road
from ..vehicles.contract import RoadVehicle
from ..vehicles.curves import Curve, rate_of, rated
from ..vehicles.vehicle import joined
from .in_memory import one_metric
from .weightings import filters

Array = NDArray[np.float64]


class Response:
    """One metric of one vehicle as a function of design variables: the bridge from vehicles to surrogates.

    Parameters
    ----------
    vehicle : Vehicle
        One number for every parameter; the inputs replace some of them.
    road : Road
        What the vehicle runs over.
    criterion : str
        Name of a variable of `ride_metrics`.
    at : str, optional
        The point or corner, where the criterion has several.
    inputs : sequence of str
        What the columns of X set, in SI units: fields of the vehicle; of a field that a corner may have for itself,
        ``"ks"`` at all corners, ``"ks_front"`` at some or ``"ks_fr"`` at one (of a curve the rate for small motion);
        and ``"speed"``, ``"roughness"`` or ``"cutoff"`` of the road.
    parameter : str, optional
        One more of these, that a second argument sets: ``response(X, value)``, for `ParameterBased`.
    weighting : str, control.TransferFunction, control.StateSpace or mapping of either by output, optional
        As in `ride_metrics`: one for all is for accelerations, and does nothing to another criterion.

    Attributes
    ----------
    parameter_value : float
        The vehicle's or road's own value of ``parameter``.
    weighted : dict of str to Filter
        The filter of the criterion by its name; empty without.
    value_per_design : bool
        True: the second argument may be one value for each design.

    Raises
    ------
    TypeError, ValueError
        An unknown criterion, place, field or weighting; each names what is available.

    Notes
    -----
    A million designs of a quarter car take a tenth of a second.

    Examples
    --------
    >>> from susp_ss import QuarterCar, Response, Road
    >>> response = Response(QuarterCar(), Road(), "sws", parameter="ms")
    >>> X = [[18e3, 1500.0], [20e3, 1500.0]]
    >>> response(X, 317.5).shape
    (2,)
    >>> bool((response(X, 400.0) > response(X)).all())
    True
    >>> felt = Response(QuarterCar(), Road(), "bacc", weighting="Wk")
    >>> bool((felt(X) < Response(QuarterCar(), Road(), "bacc")(X)).all())
    True
    """

    value_per_design = True

    def __init__(
        self,
        vehicle: RoadVehicle,
        road: Road,
        criterion: str = "bacc",
        at: str | None = None,
        inputs: Sequence[str] = ("ks", "cs"),
        parameter: str | None = None,
        weighting: Any = None,
    ):
        check_kinds(vehicle, road)
        if vehicle.design_space().dims:
            raise ValueError("Response needs a vehicle with one number for every parameter, got arrays")
        if not isinstance(criterion, str):
            raise TypeError(f"criterion must be the name of a metric, such as 'bacc', got {briefly(criterion)}")
        if isinstance(inputs, str) or not isinstance(inputs, Sequence):
            raise TypeError(f'inputs must be a sequence of field names such as ("ks", "cs"), got {briefly(inputs)}')
        known = settable(vehicle)
        named = (*inputs, *(() if parameter is None else (parameter,)))
        for name in named:
            if name not in known:
                raise ValueError(
                    f"{type(vehicle).__name__} has no parameter named {name!r}, available: {', '.join(known)}"
                )
        if len(inputs) == 0 or len({*named}) != len(named):
            raise ValueError(f"inputs and parameter must be different fields, got {tuple(inputs)} and {parameter!r}")
        for one, other in combinations(sorted(named, key=lambda name: known[name].wheels is None), 2):
            if known[one].meets(known[other]):
                raise ValueError(f"{one!r} and {other!r} set one parameter, got both; pass one of them")
        self.vehicle: Any = vehicle
        self.road, self.criterion, self.at = road, criterion, at
        self.inputs, self.parameter = tuple(inputs), parameter
        self._check_place()
        through = filters(weighting, vehicle.layout())
        self.weighted = {name: one for name, one in through.items() if name == criterion}
        if parameter is not None:
            value = self.own(parameter)
            if isinstance(value, float):
                self.parameter_value = value

    def own(self, name: str) -> Any:
        """Return the vehicle's or the road's own value of an input or parameter."""
        field, wheels, _ = settable(self.vehicle)[name]
        if field in ROAD:
            return getattr(self.road, field)
        return rate_of(getattr(self.vehicle, field) if wheels is None else self._at_wheels(field)[wheels[0]])

    def _at_wheels(self, field: str) -> dict[str, Any]:
        return dict(zip(self.vehicle.wheels, self.vehicle.at_wheels(field), strict=True))

    def _check_place(self) -> None:
        measured = self.vehicle.layout().variables
        if self.criterion not in measured:
            raise ValueError(f"no criterion named {self.criterion!r}, available: {', '.join(measured)}")
        quantity, places = measured[self.criterion]
        if dim_of(quantity, places) and self.at not in places:
            raise ValueError(f"no {quantity.dim} named {self.at!r}, available: {', '.join(places)}")
        if not dim_of(quantity, places) and self.at is not None:
            raise ValueError(
                f"{self.criterion} of {type(self.vehicle).__name__} has one place only, got at={self.at!r}"
            )

    def __call__(self, X: ArrayLike, value: ArrayLike | None = None) -> Array:
        """Evaluate the metric at designs X (n, inputs), with ``value`` for the parameter if one is named."""
        names = getattr(X, "columns", self.inputs)
        if set(names) != set(self.inputs):
            raise ValueError(f"X must have the columns {', '.join(self.inputs)}, got {', '.join(map(str, names))}")
        columns = np.asarray(X if names is self.inputs else X[list(self.inputs)])  # type: ignore[index, call-overload]
        if columns.dtype.kind not in "iuf":
            raise TypeError(f"X must be numbers, one row a design and a column for {', '.join(self.inputs)}, got {X!r}")
        if columns.ndim != 2 or columns.shape[1] != len(self.inputs):
            raise ValueError(
                f"X must have shape (n, {len(self.inputs)}) with columns {', '.join(self.inputs)}, got {columns.shape}"
            )
        settings: dict[str, Any] = dict(zip(self.inputs, columns.T, strict=True))
        if value is not None:
            if self.parameter is None:
                raise ValueError("a value was given, but Response(parameter=...) names no parameter to set")
            if np.ndim(value) and np.shape(value) != (len(columns),):
                raise ValueError(f"value must be one number or one a design, {(len(columns),)}, got {np.shape(value)}")
            settings[self.parameter] = np.broadcast_to(np.asarray(value), len(columns))
        ofroad = {name: settings.pop(name) for name in ROAD if name in settings}
        road = dataclasses.replace(self.road, **ofroad) if ofroad else self.road
        return self._metric(road, settings, len(columns))

    def _metric(self, road: Road, settings: Mapping[str, Array], n: int) -> Array:
        """The metric (n,) of the vehicles on roads that columns of numbers make."""
        known, fields = settable(self.vehicle), dict[str, Any]()
        for name, column in settings.items():
            field, wheels, _ = known[name]
            own = self._at_wheels(field)
            if wheels is not None:
                fields.setdefault(field, own).update({wheel: rated(own[wheel], column) for wheel in wheels})
            elif any(isinstance(value, Curve) for value in own.values()):
                fields[field] = {at: rated(value, column) for at, value in own.items()}
            else:
                fields[field] = column
        for field, values in fields.items():
            if isinstance(values, dict):
                fields[field] = joined(values)
        vehicle = dataclasses.replace(self.vehicle, **fields) if fields else self.vehicle
        return np.broadcast_to(one_metric(vehicle, road, self.criterion, self.at, self.weighted), n)
