"""Ride metrics of vehicles in memory: variances of any route, as labelled root mean squares."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from ..responses.covariance.routes import covariance_variances
from ..responses.excitation import spanned
from ..responses.labels import labelled_outputs
from ..responses.simulation import time_variances
from ..responses.spectral import spectral_variances
from ..roads.road import Road
from ..vehicles.parameters import DesignSpace
from ..vehicles.second_order import Layout
from ..vehicles.vehicle import Vehicle

METHODS = ("covariance", "spectral", "time")

Array = NDArray[np.float64]

INFINITE = (
    "infinite where a damper passes the road's vertical velocity straight on (tyre damping, or a rigid tyre): up to "
    "waviness 3 that velocity has no finite variance; set ct = 0, or take a road of a waviness above 3"
)
"""When a tyre load has no finite variance: the comment of its variable."""


def metrics_in_memory(vehicle: Vehicle, road: Road, method: str, designs: int, **record: Any) -> xr.Dataset:
    """Metrics of a vehicle in memory, part of a sweep of so many designs; ``record`` is for time histories."""
    (space, flat, road), errors = spanned(vehicle, road), None
    if method == "time":
        variances, errors = time_variances(flat, space, road, **record)
    elif method == "spectral":
        variances = spectral_variances(flat, space, road)
    else:
        variances = covariance_variances(flat, space, road, designs)
    corners = flat.linkage().corners.values()
    damping = np.stack(np.broadcast_arrays(*(corner.cs for corner in corners))).T
    return _labelled(vehicle.layout(), space, damping, variances, errors)


def template(layout: Layout, method: str) -> xr.Dataset:
    """Metrics of one design as `metrics_in_memory` returns them, without their values."""
    nothing, one = np.zeros((1, len(layout.outputs))), DesignSpace.over((), "")
    return _labelled(layout, one, np.zeros(len(layout.corners)), nothing, nothing if method == "time" else None)


def _labelled(layout: Layout, space: DesignSpace, damping: Array, variances: Array, errors: Array | None) -> xr.Dataset:
    """Root mean squares and damper powers of variances (designs, outputs), which they replace."""
    rates = layout.outputs.of("sws_rate")
    power = damping * variances[:, rates]
    roots = np.sqrt(variances, out=variances)
    metrics = labelled_outputs(layout, roots, power, space, long_name="{statistic} {meaning}")
    metrics.dtl.attrs["comment"] = INFINITE
    if errors is None:
        return metrics
    with np.errstate(divide="ignore", invalid="ignore"):
        of_roots = np.where(errors > 0.0, errors / (2.0 * roots), 0.0)
    of_power = damping * errors[:, rates]
    stderr = labelled_outputs(layout, of_roots, of_power, space, long_name="standard error of {meaning}")
    return metrics.assign({f"{name}_stderr": data for name, data in stderr.items()})
