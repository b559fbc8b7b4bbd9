"""The vehicle and the road of a state."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from typing import Any

from ..roads.road import Road
from ..vehicles.curves import DamperCurve
from ..vehicles.vehicle import joined
from .seat import seated
from .state import NOTHING, Given


def vehicle_of(state: Mapping[str, Any], given: Given = NOTHING) -> Any:
    """The vehicle of a checked state.

    Examples
    --------
    >>> from susp_ss.explorer.design import vehicle_of
    >>> from susp_ss.explorer.state import from_query
    >>> vehicle_of(from_query("model=quarter&ks=20000")[0]).ks
    20000.0
    """
    car: Any = given.models[state["model"]]
    if state["vehicle"]:
        car = car.replaced(**state["vehicle"])
    if state["curve"]:
        rates = dict(zip(car.wheels, car.at_wheels("cs"), strict=True))
        car = dataclasses.replace(car, cs=joined({wheel: damper(cs, **state["curve"]) for wheel, cs in rates.items()}))
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
    return dataclasses.replace(given.road, **state["road"])
