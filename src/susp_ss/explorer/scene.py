"""What the parts of the page share of a state: the vehicle, its linear model, and one solution for all its metrics."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
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
        solved = _curved if self.vehicle.curved else _linear
        return self.attempt(lambda scene: solved(scene, SPEEDS)) or solved(self, SPEEDS[:0])

    @cached_property
    def straight(self) -> Any:
        """The vehicle, with numbers in place of curves."""
        return self.ride.straight if self.vehicle.curved else self.vehicle

    @cached_property
    def model(self) -> Model:
        """The linear model of that."""
        model: Model = self.straight.assemble()
        return model

    def attempt(self, part: Callable[[Self], Any]) -> Any:
        """What a part finds; None where the package refuses, which is noted."""
        try:
            return part(self)
        except (ValueError, TypeError) as error:
            line = {"parameter": "", "message": str(error)}
            if line not in self.errors:
                self.errors.append(line)
            return None


def _linear(scene: Scene, speeds: Array) -> Ride:
    count = 1 + len(speeds)
    along = np.concatenate([[scene.road.speed], speeds, [scene.road.speed] * len(FELT)])
    filters = EachDesign([None] * count + [filter_of(name, "") for name in FELT])
    space, car, ground = spanned(scene.vehicle, dataclasses.replace(scene.road, speed=along).weighted(filters))
    variances = covariance_variances(car, space, ground)
    moments = Moments(variances[:count], power=dissipated(car, variances)[:count])
    felt, outputs = variances[count:], scene.vehicle.layout().outputs
    if not all(np.isfinite(felt[:, outputs.of(name)]).all() for name in AXES if name in outputs.quantities):
        # Beside roads that no filter stands on, what passes on their velocity counts as infinite.
        felt = _felt(scene.vehicle, scene.road)
    return Ride(moments, felt, scene.vehicle)


def _curved(scene: Scene, speeds: Array) -> Ride:
    """The same with what stands for the curves at each speed."""
    along = np.append(scene.road.speed, speeds)
    space, car, ground = spanned(scene.vehicle, dataclasses.replace(scene.road, speed=along))
    found = linearise(car, space, ground)
    moments = Moments(found.variances, power=dissipated(found.vehicle, found.variances), shift=found.shift)
    straight = found.vehicle.mapped(lambda x: float(x[0]) if isinstance(x, np.ndarray) else x)
    return Ride(moments, _felt(straight, scene.road), straight)


def _felt(vehicle: Any, road: Road) -> Array:
    """Variances of a vehicle of numbers through the weightings `FELT`."""
    filters = EachDesign([filter_of(name, "") for name in FELT])
    here = dataclasses.replace(road, speed=np.full(len(FELT), road.speed))
    space, car, ground = spanned(vehicle, here.weighted(filters))
    return covariance_variances(car, space, ground)
