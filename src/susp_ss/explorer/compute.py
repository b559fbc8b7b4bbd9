"""What the explorer shows of a state, while the slider moves: plain numbers in SI units."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Mapping
from typing import Any

import xarray as xr

from ..metrics import ride_metrics
from ..quantities import CORNERS, MIDDLE
from ..roads.road import Road
from ..vehicles.curves import DamperCurve
from ..vehicles.parameters import Corners
from ..vehicles.quarter import QuarterCar, QuarterCarWithSeat
from ..vehicles.seats import Seat, field_of
from .state import NOTHING, Given, checked

PLACES = CORNERS | MIDDLE | {"cg": "centre of gravity", "f": "front", "r": "rear", "l": "left", "front": "front"}


def compute(state: Any, given: Given = NOTHING) -> dict[str, Any]:
    """Everything that the page shows at once.

    Parameters
    ----------
    state : dict
        As the page has it; what is wrong in it stays as it is by default, and is said in ``errors``.
    given : Given
        What the explorer was started with.

    Returns
    -------
    dict
        Plain JSON. An infinite value is None.

    Examples
    --------
    >>> from susp_ss.explorer.compute import compute
    >>> found = compute({"model": "quarter", "vehicle": {"ks": 18e3, "cs": 1500.0}})
    >>> [round(one["value"], 3) for one in found["metrics"] if one["name"] == "bacc"]
    [0.678]
    """
    right, errors = checked(state, given)
    try:
        car, road = vehicle_of(right, given), road_of(right, given)
        return {"metrics": metrics_of(ride_metrics(car, road)), "errors": errors}
    except (ValueError, TypeError) as error:
        return {"errors": [*errors, {"parameter": "", "message": str(error)}]}


def vehicle_of(state: Mapping[str, Any], given: Given = NOTHING) -> Any:
    """The vehicle of a checked state."""
    car: Any = given.models[state["model"]]
    if state["vehicle"]:
        car = car.replaced(**state["vehicle"])
    if state["curve"]:
        car = dataclasses.replace(car, cs=_dampers(car, **state["curve"]))
    return seated(car, state["seat"]) if state["seat"] else car


def _dampers(car: Any, **curve: float) -> Any:
    """The damper's curve at every wheel, about the rate there."""
    curves = {wheel: damper(rate, **curve) for wheel, rate in zip(car.wheels, car.at_wheels("cs"), strict=True)}
    if len(curves) == 1:
        return next(iter(curves.values()))
    return Corners(**curves) if len(curves) == 4 else tuple(curves.values())


def damper(cs: float, rebound: float, compression: float, knee: float, beyond: float) -> DamperCurve:
    """A curve of four straight parts: ``cs`` times a factor in rebound and compression, less or more beyond a knee."""
    v = [-2.0 * knee, -knee, 0.0, knee, 2.0 * knee]
    out, into = rebound * cs * knee, compression * cs * knee
    return DamperCurve(v, [-(1.0 + beyond) * out, -out, 0.0, into, (1.0 + beyond) * into])


def seated(car: Any, seat: Mapping[str, float]) -> Any:
    """The vehicle with a driver on a seat."""
    if isinstance(car, QuarterCar):
        return QuarterCarWithSeat(**vars(car), **{field_of(of, ""): value for of, value in seat.items()})
    return car.with_seats({"driver": Seat(**seat)})


def road_of(state: Mapping[str, Any], given: Given = NOTHING) -> Road:
    """The road of a checked state."""
    return dataclasses.replace(given.road, **state["road"])


def metrics_of(found: xr.Dataset) -> list[dict[str, Any]]:
    """Every metric at every place."""
    rows = []
    for name, data in found.data_vars.items():
        meaning = data.attrs["long_name"].removeprefix("RMS ")
        for place, value in zip(
            data[data.dims[0]].values.tolist() if data.dims else [""], data.values.flat, strict=True
        ):
            rows.append(
                {
                    "name": f"{name}@{place}" if place else str(name),
                    "label": f"{meaning}, {PLACES.get(place, place)}" if place else meaning,
                    "unit": data.attrs["units"],
                    "value": number(value),
                }
            )
    return rows


def number(value: Any) -> float | None:
    """A number that JSON can hold."""
    return float(value) if math.isfinite(value) else None
