"""Ride metrics of vehicles in memory: variances of any route, as labelled root mean squares."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from ..quantities import SHIFT
from ..responses.covariance.linearisation import linearise
from ..responses.covariance.routes import EVERY, covariance_variances
from ..responses.excitation import design_space, spanned
from ..responses.filters import Filter
from ..responses.labels import labelled_outputs, shifted, values_of
from ..responses.records import Moments, time_moments
from ..responses.spectral import spectral_variances
from ..roads.road import Road
from ..vehicles.contract import RoadVehicle
from ..vehicles.parameters import DesignSpace
from ..vehicles.second_order import Layout
from .weightings import rows_behind, say_weightings

METHODS = ("covariance", "spectral", "time")

Array = NDArray[np.float64]

LINEARISED = (
    "springs and dampers with curves are statistically linearised: the linear ones that come closest in the mean "
    "square stand in their place, about the mean deflection ride_height_shift"
)
"""What metrics of curved springs and dampers are: the comment of the Dataset."""

INFINITE = (
    "infinite where a damper passes the road's vertical velocity straight on (tyre damping, or a rigid tyre): up to "
    "waviness 3 that velocity has no finite variance; set ct = 0, or take a road of a waviness above 3"
)
"""When a tyre load has no finite variance: the comment of its variable."""


def metrics_in_memory(
    vehicle: RoadVehicle, road: Road, method: str, designs: int, weighting: Mapping[str, Filter], **record: Any
) -> xr.Dataset:
    """Metrics of a vehicle in memory, part of a sweep of so many designs; ``record`` is for time histories."""
    space, found = _moments(vehicle, road, method, designs, weighting, **record)
    return _labelled(vehicle.layout(), space, found, weighting)


def one_metric(
    vehicle: RoadVehicle, road: Road, name: str, place: str | None, weighting: Mapping[str, Filter]
) -> Array:
    """A single metric (designs,), exact and without labels, which take as long as some hundred designs."""
    found = exact_moments(vehicle, road, weighting)
    layout = vehicle.layout()
    _, places = layout.variables[name]
    values = values_of(layout, name, found.variances, found.power)
    one = values[:, 0 if place is None else places.index(place)]
    return one if name == "damper_power" else np.sqrt(one)


def exact_moments(vehicle: RoadVehicle, road: Road, weighting: Mapping[str, Filter]) -> Moments:
    """What all metrics are made of, without labels."""
    _, found = _moments(vehicle, road, "covariance", design_space(vehicle, road).size, weighting)
    return found


def _moments(
    vehicle: RoadVehicle, road: Road, method: str, designs: int, weighting: Mapping[str, Filter], **record: Any
) -> tuple[DesignSpace, Moments]:
    """The designs that a vehicle and a road span, and their variances, damper powers and mean deflections."""
    space, flat, road = spanned(vehicle, road)
    layout = vehicle.layout()
    straight = linearise(flat, space, road, designs) if flat.curved and method != "time" else None
    car = flat if straight is None else straight.vehicle

    def moments(road: Road, needed: Any = EVERY) -> Moments:
        if method == "time":
            return time_moments(flat, space, road, **record)
        if method == "spectral":
            return Moments(spectral_variances(car, space, road))
        return Moments(covariance_variances(car, space, road, designs, needed))

    if straight is None:
        found = moments(road)
    else:
        found = (moments(road) if method == "spectral" else Moments(straight.variances))._replace(shift=straight.shift)
    if found.power is None:
        errors = None if found.errors is None else dissipated(car, found.errors)
        found = found._replace(power=dissipated(car, found.variances), power_errors=errors)
    for one, rows in rows_behind(weighting, layout.outputs).items():
        through = moments(road.weighted(one), rows)
        found.variances[:, rows] = through.variances[:, rows]
        if found.errors is not None and through.errors is not None:
            found.errors[:, rows] = through.errors[:, rows]
    return space, found


def dissipated(car: RoadVehicle, variances: Array) -> Array:
    """Mean powers in W (designs, corners) of linear dampers, of variances (designs, outputs) of all outputs."""
    return np.asarray(car.damping() * variances[:, car.layout().rates])


def template(layout: Layout, method: str, weighting: Mapping[str, Filter], curved: bool) -> xr.Dataset:
    """Metrics of one design as `metrics_in_memory` returns them, without their values."""
    nothing, power = np.zeros((1, len(layout.outputs))), np.zeros((1, len(layout.corners) if layout.dampers else 0))
    shift, errors = (power if curved else None), (nothing, power, power if curved else None)
    like = Moments(nothing, None, power, None, shift)
    if method == "time":
        like = Moments(nothing, errors[0], power, errors[1], shift, errors[2])
    return _labelled(layout, DesignSpace.over((), ""), like, weighting)


def _labelled(layout: Layout, space: DesignSpace, found: Moments, weighting: Mapping[str, Filter]) -> xr.Dataset:
    """Root mean squares of variances (designs, outputs), which they replace, and damper powers, with their errors."""
    variances, errors = found.variances, found.errors
    roots = np.sqrt(variances, out=variances)
    metrics = labelled_outputs(layout, roots, found.power, space, long_name="{statistic} {meaning}")
    if "dtl" in metrics:
        metrics.dtl.attrs["comment"] = INFINITE
    say_weightings(metrics, weighting)
    if found.shift is not None:
        metrics[SHIFT.name] = shifted(layout, space, found.shift, "{statistic} {meaning}")
        if errors is None:
            metrics.attrs["comment"] = LINEARISED
    if errors is None:
        return metrics
    with np.errstate(divide="ignore", invalid="ignore"):
        of_roots = np.where(errors > 0.0, errors / (2.0 * roots), 0.0)
    error_of = "standard error of {meaning}"
    stderr = labelled_outputs(layout, of_roots, found.power_errors, space, long_name=error_of)
    if found.shift_errors is not None:
        stderr[SHIFT.name] = shifted(layout, space, found.shift_errors, error_of)
    return metrics.assign({f"{name}_stderr": data for name, data in stderr.items()})
