"""Further points of a vehicle's body, whose vertical acceleration is measured as well."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from functools import cache
from typing import Any

import numpy as np

from ..quantities import briefly
from .linkage import Linkage, Motion

Places = tuple[tuple[str, tuple[float, float]], ...]


def checked_points(given: Any, kind: str, linkage: Linkage) -> Places:
    """Names and places (ahead, left) of further points.

    Raises
    ------
    TypeError, ValueError
        No mapping of names to two numbers each, a name that is taken, or a place that the model's body does not have.
    """
    need = '{"driver": (x, y)} in m ahead of and to the left of the centre of gravity'
    if not isinstance(given, Mapping):
        raise TypeError(f"points must be a mapping such as {need}, got {briefly(given)}")
    if "" in linkage.points:
        raise ValueError(f"points: the body of a {kind} moves as one point; take a car with pitch or roll")
    found = []
    for name, place in given.items():
        if not isinstance(name, str) or not name:
            raise TypeError(f"points must have names, got {briefly(name)}; pass {need}")
        if name in linkage.points:
            raise ValueError(f"points: {name!r} is a point of {kind} already; pass another name")
        numbers = isinstance(place, (tuple, list)) and len(place) == 2
        if not numbers or not all(isinstance(x, (int, float, np.number)) and np.isfinite(x) for x in place):
            raise ValueError(f"points: {name!r} must be two finite numbers (x, y) in m, got {briefly(place)}")
        for along, rotation, word in ((0, "pitch_acc", "ahead"), (1, "roll_acc", "left")):
            if place[along] and rotation not in linkage.rotations:
                raise ValueError(
                    f"points: {name!r} lies {place[along]:g} m {word}, where a {kind} has no body; pass 0 there"
                )
        found.append((name, (float(place[0]), float(place[1]))))
    return tuple(found)


@cache
def with_points(kind: Any, places: Places) -> Any:
    """The same kind of vehicle, measured at further points of its body."""

    def linkage(self: Any) -> Linkage:
        own: Linkage = kind.linkage(self)
        cg, *_ = own.points.values()
        none = Motion({})
        pitch, roll = (own.rotations.get(name, none) for name in ("pitch_acc", "roll_acc"))
        more = {name: cg - x * pitch + y * roll for name, (x, y) in places}
        return dataclasses.replace(own, points={**own.points, **more})

    def reduce(self: Any) -> tuple[Any, ...]:
        return _again, (kind, places, vars(self))

    return type(kind.__name__, (kind,), {"__doc__": kind.__doc__, "linkage": linkage, "__reduce__": reduce})


def _again(kind: type, places: Places, values: dict[str, Any]) -> Any:
    vehicle = object.__new__(with_points(kind, places))
    for name, value in values.items():
        object.__setattr__(vehicle, name, value)
    return vehicle
