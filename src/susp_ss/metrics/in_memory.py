"""Ride metrics of vehicles in memory: variances of any route, as labelled root mean squares."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from ..responses.covariance.routes import covariance_variances
from ..responses.excitation import spanned
from ..responses.filters import Filter
from ..responses.labels import labelled_outputs
from ..responses.simulation import time_variances
from ..responses.spectral import spectral_variances
from ..roads.road import Road
from ..vehicles.contract import RoadVehicle
from ..vehicles.parameters import DesignSpace
from ..vehicles.second_order import Layout
from .weightings import rows_behind, say_weightings

METHODS = ("covariance", "spectral", "time")

Array = NDArray[np.float64]

INFINITE = (
    "infinite where a damper passes the road's vertical velocity straight on (tyre damping, or a rigid tyre): up to "
    "waviness 3 that velocity has no finite variance; set ct = 0, or take a road of a waviness above 3"
)
"""When a tyre load has no finite variance: the comment of its variable."""


def metrics_in_memory(
    vehicle: RoadVehicle, road: Road, method: str, designs: int, weighting: Mapping[str, Filter], **record: Any
) -> xr.Dataset:
    """Metrics of a vehicle in memory, part of a sweep of so many designs; ``record`` is for time histories."""
    space, flat, road = spanned(vehicle, road)

    def moments(road: Road) -> tuple[Array, Array | None]:
        if method == "time":
            return time_variances(flat, space, road, **record)
        if method == "spectral":
            return spectral_variances(flat, space, road), None
        return covariance_variances(flat, space, road, designs), None

    layout, (variances, errors) = vehicle.layout(), moments(road)
    rates, damping = layout.rates, flat.damping()
    powers = damping * variances[:, rates], None if errors is None else damping * errors[:, rates]
    for one, rows in rows_behind(weighting, layout.outputs).items():
        through, their_errors = moments(road.weighted(one))
        variances[:, rows] = through[:, rows]
        if errors is not None and their_errors is not None:
            errors[:, rows] = their_errors[:, rows]
    return _labelled(layout, space, variances, errors, powers, weighting)


def template(layout: Layout, method: str, weighting: Mapping[str, Filter]) -> xr.Dataset:
    """Metrics of one design as `metrics_in_memory` returns them, without their values."""
    nothing, power = np.zeros((1, len(layout.outputs))), np.zeros((1, len(layout.corners) if layout.dampers else 0))
    timed = method == "time"
    errors, powers = nothing if timed else None, (power, power if timed else None)
    return _labelled(layout, DesignSpace.over((), ""), nothing, errors, powers, weighting)


def _labelled(
    layout: Layout,
    space: DesignSpace,
    variances: Array,
    errors: Array | None,
    powers: tuple[Array, Array | None],
    weighting: Mapping[str, Filter],
) -> xr.Dataset:
    """Root mean squares of variances (designs, outputs), which they replace, and damper powers, with their errors."""
    power, of_power = powers
    roots = np.sqrt(variances, out=variances)
    metrics = labelled_outputs(layout, roots, power, space, long_name="{statistic} {meaning}")
    if "dtl" in metrics:
        metrics.dtl.attrs["comment"] = INFINITE
    say_weightings(metrics, weighting)
    if errors is None or of_power is None:
        return metrics
    with np.errstate(divide="ignore", invalid="ignore"):
        of_roots = np.where(errors > 0.0, errors / (2.0 * roots), 0.0)
    stderr = labelled_outputs(layout, of_roots, of_power, space, long_name="standard error of {meaning}")
    return metrics.assign({f"{name}_stderr": data for name, data in stderr.items()})
