"""Further points of a vehicle's body, whose vertical acceleration is measured as well."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Mapping
from functools import cache
from typing import Any

import numpy as np

from ..quantities import briefly
from .linkage import Linkage, Motion

Places = tuple[tuple[str, tuple[float, float]], ...]

ALONG = {"x": ("pitch_acc", "ahead"), "y": ("roll_acc", "to the left")}
"""What a place off the centre of gravity needs: a rotation of the body, by the name of its acceleration."""


def body_point(linkage: Linkage, x: Any, y: Any) -> Motion:
    """The body's height at a place in m ahead of and to the left of the centre of gravity."""
    cg, *_ = linkage.points.values()
    pitch, roll = (linkage.rotations.get(name, Motion({})) for name, _ in ALONG.values())
    return cg - x * pitch + y * roll


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
        if name in linkage.points or name in linkage.seats:
            raise ValueError(f"points: {name!r} is a point of {kind} already; pass another name")
        numbers = isinstance(place, (tuple, list)) and len(place) == 2
        if not numbers or not all(isinstance(x, (int, float, np.number)) and np.isfinite(x) for x in place):
            raise ValueError(f"points: {name!r} must be two finite numbers (x, y) in m, got {briefly(place)}")
        for distance, (rotation, word) in zip(place, ALONG.values(), strict=True):
            if distance and rotation not in linkage.rotations:
                raise ValueError(
                    f"points: {name!r} lies {distance:g} m {word}, where a {kind} has no body; pass 0 there"
                )
        found.append((name, (float(place[0]), float(place[1]))))
    return tuple(found)


@cache
def with_points(kind: Any, places: Places) -> Any:
    """The same kind of vehicle, measured at further points of its body."""

    def linkage(self: Any) -> Linkage:
        own: Linkage = kind.linkage(self)
        more = {name: body_point(own, *place) for name, place in places}
        return dataclasses.replace(own, points={**own.points, **more})

    def reduce(self: Any) -> tuple[Any, ...]:
        return again, (with_points, as_kind(self, kind), places)

    return type(kind.__name__, (kind,), {"__doc__": kind.__doc__, "linkage": linkage, "__reduce__": reduce})


def as_kind(vehicle: Any, kind: Any) -> Any:
    """A vehicle's values as another kind's that has the same fields, or more."""
    other = object.__new__(kind)
    for name, value in vars(vehicle).items():
        object.__setattr__(other, name, value)
    return other


def again(more: Callable[..., Any], plain: Any, *arguments: Any) -> Any:
    """A vehicle of a kind that was made from another, from that other: what a pickle of it holds."""
    return as_kind(plain, more(type(plain), *arguments))
