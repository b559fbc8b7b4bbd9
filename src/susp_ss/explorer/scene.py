"""What the parts of the page share of a state: the vehicle, its linear model, and one solution for all its metrics."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Sequence
from contextlib import suppress
from functools import cached_property
from typing import Any, NamedTuple, Self

import numpy as np
from numpy.typing import NDArray

from ..metrics.comfort import AXES
from ..metrics.in_memory import dissipated
from ..metrics.weightings import filter_of
from ..responses.covariance.linearisation import linearise
from ..responses.covariance.routes import covariance_variances
from ..responses.excitation import spanned
from ..responses.filters import EachDesign
from ..responses.records import Moments
from ..roads.road import Road
from ..vehicles.contract import Model
from ..vehicles.vehicle import Vehicle, joined
from .design import road_of, vehicle_of
from .state import Given, checked

Array = NDArray[np.float64]

SPEEDS = np.linspace(4.0, 60.0, 29)
"""Over which metrics are shown, in m/s."""

FELT = tuple(dict.fromkeys(axis.weighting for axis in AXES.values()))
"""Weightings that comfort needs."""

Found = dict[str, Any]


class Ride(NamedTuple):
    """What a vehicle feels on its road, exactly.

    ``moments`` are those at the road's own speed, then at `SPEEDS` where it can go so fast; ``felt`` (weightings,
    outputs) the variances at its own speed through the weightings `FELT`. ``straight`` is the vehicle at its own speed
    with numbers in place of curves.
    """

    moments: Moments
    felt: Array
    straight: Any


class Scene:
    """A state as everything that is shown of it needs it, and what was wrong with it on the way."""

    def __init__(self, state: Any, given: Given):
        self.state, self.errors = checked(state, given)
        self.given = given

    @cached_property
    def vehicle(self) -> Any:
        return vehicle_of(self.state, self.given)

    @cached_property
    def road(self) -> Road:
        return road_of(self.state, self.given)

    @cached_property
    def ride(self) -> Ride:
        """All metrics: one solution, over all speeds where the vehicle can go so fast."""
        try:
            return _ridden(self, SPEEDS)
        except (ValueError, TypeError) as error:
            alone = _ridden(self, SPEEDS[:0])  # What is wrong at its own speed as well is said of that.
            self.note(error)
            return alone

    @cached_property
    def straight(self) -> Any:
        """The vehicle, with numbers in place of curves."""
        return self.ride.straight if self.vehicle.curved else self.vehicle

    @cached_property
    def models(self) -> tuple[Model, Model]:
        """The linear models of that on the road and over the bump, whose speeds are their own."""
        speeds = np.array([self.road.speed, self.state["bump"]["speed"]])
        moving = self.straight.moving(speeds)
        if moving is self.straight:
            return (self.straight.assemble(),) * 2
        both = moving.flattened(moving.design_space()).assemble()
        return both.select(slice(0, 1)), both.select(slice(1, 2))

    @property
    def model(self) -> Model:
        """The linear model on the road."""
        return self.models[0]

    def attempt(self, part: Callable[[Self], Any]) -> Any:
        """What a part finds; None where the package refuses, which is noted."""
        try:
            return part(self)
        except (ValueError, TypeError) as error:
            self.note(error)
            return None

    def note(self, error: Exception) -> None:
        """Say once what was refused."""
        line = {"parameter": "", "message": str(error)}
        if line not in self.errors:
            self.errors.append(line)


def share(scenes: Sequence[Scene]) -> None:
    """Solve the rides of all scenes of one kind on one road at once, which takes little longer than one."""
    kinds: dict[Any, list[Scene]] = {}
    for scene in scenes:
        with suppress(ValueError, TypeError):
            if isinstance(scene.vehicle, Vehicle) and not scene.vehicle.curved:
                kinds.setdefault((type(scene.vehicle), *scene.state["road"].items()), []).append(scene)
    for alike in kinds.values():
        # What is refused of any is left to each alone.
        with suppress(ValueError, TypeError):
            if len(alike) > 1:
                for scene, ride in zip(alike, _linear(alike, SPEEDS), strict=True):
                    scene.ride = ride


def _ridden(scene: Scene, speeds: Array) -> Ride:
    return _curved(scene, speeds) if scene.vehicle.curved else _linear([scene], speeds)[0]


def _linear(scenes: Sequence[Scene], speeds: Array) -> list[Ride]:
    """Rides of vehicles of one kind on one road."""
    ground = _course(scenes[0].road, speeds, len(scenes))
    vehicle = _in_a_row([scene.vehicle for scene in scenes], len(ground.speed) // len(scenes))
    space, car, ground = spanned(vehicle, ground)
    variances = covariance_variances(car, space, ground)
    parts = (np.split(x, len(scenes)) for x in (variances, dissipated(car, variances)))
    return [_ride(scene, own, powers, scene.vehicle) for scene, own, powers in zip(scenes, *parts, strict=True)]


def _course(road: Road, speeds: Array, times: int = 1) -> Road:
    """A road at its own speed, at further ones, and at its own through each of `FELT`; all that so many times."""
    along = np.concatenate([[road.speed], speeds, [road.speed] * len(FELT)])
    filters = [None] * (1 + len(speeds)) + [filter_of(name, "") for name in FELT]
    return dataclasses.replace(road, speed=np.tile(along, times)).weighted(EachDesign(filters * times))


def _ride(scene: Scene, variances: Array, powers: Array, straight: Any, shift: Array | None = None) -> Ride:
    """What was found along a `_course`."""
    count, outputs = len(variances) - len(FELT), scene.vehicle.layout().outputs
    felt = variances[count:]
    if not all(np.isfinite(felt[:, outputs.of(name)]).all() for name in AXES if name in outputs.quantities):
        # Beside roads that no filter stands on, what passes on their velocity counts as infinite.
        felt = _felt(straight, scene.road)
    moments = Moments(variances[:count], power=powers[:count], shift=None if shift is None else shift[:count])
    return Ride(moments, felt, straight)


def _in_a_row(vehicles: Sequence[Any], times: int) -> Any:
    """One vehicle of as many designs, each so many times; what is one number for all stays one."""
    if len(vehicles) == 1:
        return vehicles[0]
    first = vehicles[0]

    def row(values: Sequence[Any]) -> Any:
        return values[0] if len({*values}) == 1 else np.repeat(values, times)

    def at(name: str) -> Any:
        if name not in first.per_corner:
            return row([getattr(car, name) for car in vehicles])
        values = zip(*(car.at_wheels(name) for car in vehicles), strict=True)
        return joined(dict(zip(first.wheels, map(row, values), strict=True)))

    return dataclasses.replace(first, **{field.name: at(field.name) for field in dataclasses.fields(first)})


def _curved(scene: Scene, speeds: Array) -> Ride:
    """The same with what stands for the curves at each speed."""
    space, car, ground = spanned(scene.vehicle, _course(scene.road, speeds))
    every = np.arange(space.size)
    found = linearise(car, space, ground, leaders=np.where(every < space.size - len(FELT), every, 0))
    straight = found.vehicle.mapped(lambda x: float(x[0]) if isinstance(x, np.ndarray) else x)
    return _ride(scene, found.variances, dissipated(found.vehicle, found.variances), straight, found.shift)


def _felt(vehicle: Any, road: Road) -> Array:
    """Variances of a vehicle of numbers through the weightings `FELT`."""
    filters = EachDesign([filter_of(name, "") for name in FELT])
    here = dataclasses.replace(road, speed=np.full(len(FELT), road.speed))
    space, car, ground = spanned(vehicle, here.weighted(filters))
    return covariance_variances(car, space, ground)
