"""The vehicle and the road of a state."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from typing import Any

from ..roads.road import DEFAULT_ROAD, Road
from ..vehicles.curves import DamperCurve
from ..vehicles.ride_handling import RideHandlingCar
from ..vehicles.vehicle import joined
from .seat import seated
from .state import NOTHING, Given
from .table import MEASURED


def vehicle_of(state: Mapping[str, Any], given: Given = NOTHING) -> Any:
    """The vehicle of a checked state; one whose own speed counts moves at the road's.

    Examples
    --------
    >>> from susp_ss.explorer.design import vehicle_of
    >>> from susp_ss.explorer.state import from_query
    >>> vehicle_of(from_query("model=quarter&ks=20000")[0]).ks
    20000.0
    """
    car: Any = given.models[state["model"]]
    own = given.default(state["model"])["vehicle"]
    moved = {name: value for name, value in state["vehicle"].items() if value != own[name]}
    if isinstance(car, RideHandlingCar):
        moved["speed"] = state["road"]["speed"]
    if moved:
        car = car.replaced(**moved)
    if state["curve"]:
        rates = car.at_wheels("cs")
        curves = {cs: damper(cs, **state["curve"]) for cs in rates}
        at_wheels = dict(zip(car.wheels, map(curves.get, rates), strict=True))
        car = dataclasses.replace(car, cs=curves[rates[0]] if len(curves) == 1 else joined(at_wheels))
    return seated(car, state["seat"]) if state["seat"] else car


def damper(cs: float, rebound: float, compression: float, knee: float, beyond: float) -> DamperCurve:
    """A curve of four straight parts: ``cs`` times a factor in rebound and compression, less or more beyond a knee.

    Examples
    --------
    >>> from susp_ss.explorer.design import damper
    >>> damper(1000.0, rebound=1.5, compression=0.5, knee=0.1, beyond=0.2).force([-0.1, 0.1, 0.3]).round(9).tolist()
    [-150.0, 50.0, 70.0]
    """
    out, into = rebound * cs * knee, compression * cs * knee
    velocity = [-2.0 * knee, -knee, 0.0, knee, 2.0 * knee]
    return DamperCurve(velocity, [-(1.0 + beyond) * out, -out, 0.0, into, (1.0 + beyond) * into])


def road_of(state: Mapping[str, Any], given: Given = NOTHING) -> Road:
    """The road of a checked state."""
    own = dict(state["road"])
    measured = own.pop("spectrum", MEASURED) == MEASURED
    return dataclasses.replace(given.road if measured else DEFAULT_ROAD, **own)
