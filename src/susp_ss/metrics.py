"""Ride metrics of a vehicle on a road, by any of three routes."""

from __future__ import annotations

import dataclasses
import warnings
from collections.abc import Callable, Sequence
from typing import Any, Literal

import numpy as np
import xarray as xr

from .responses.excitation import check_kinds
from .responses.labels import QUANTITIES, labelled_outputs
from .responses.simulation import time_variances
from .responses.spectral import spectral_variances
from .responses.variances import covariance_variances
from .roads import Road
from .vehicles import Vehicle

METHODS = ("covariance", "spectral", "time")


def ride_metrics(
    vehicle: Vehicle,
    road: Road,
    method: Literal["covariance", "spectral", "time"] = "covariance",
    *,
    duration: float = 600.0,
    step: float = 0.002,
    seed: int = 0,
) -> xr.Dataset:
    """Root mean squares of a vehicle's ride on a random road.

    Parameters
    ----------
    vehicle : Vehicle
        Any of the five models. Parameters that are arrays make a sweep, whose dims come first in the result. If one
        is a DataArray of Dask blocks, so is the result: each block's values are checked when it is computed.
    road : Road
        What the wheels run over.
    method : {"covariance", "spectral", "time"}
        ``"covariance"``: exact, by Routh's and Lyapunov's equations with the wheelbase delay in closed form, for
        waviness 2; the coherence of isotropic tracks is a rational fit, good to 1e-4 for cars and 1e-3 from 0.4 m of
        track on. Parameters like a car's keep twelve digits, masses and stiffnesses three decades apart eight or nine;
        a design that keeps fewer than six is refused. A microsecond or two a design, some hundred where corners are
        unequal; very large sweeps are compiled, at first use on a machine for half a minute. ``"spectral"``:
        ``int |H|^2 G df``, any waviness and the exact coherence.
        ``"time"``: mean squares over a synthesised record, with a standard error beside each.
    duration, step : float
        Of the record in s, for ``"time"``; the step is shortened to resolve the fastest mode and to divide the delay
        of the rear wheels.
    seed : int
        Of the record, for ``"time"``.

    Returns
    -------
    xarray.Dataset
        ``bacc`` (m/s^2) on point (cg and above each corner), ``sws`` (m), ``dtl`` (N) and the mean ``damper_power``
        (W) on corner, ``pitch_acc`` and ``roll_acc`` (rad/s^2) where the vehicle has them; a quarter car has no point
        or corner. ``"time"`` adds ``<name>_stderr``. A variance that white road velocity makes infinite (tyre load
        with tyre damping; acceleration, tyre load and damper power on a rigid tyre) is `inf`.

    Raises
    ------
    TypeError, ValueError
        An argument of the wrong kind, a vehicle without damping, a waviness the method cannot take, or a road whose
        warp drifts without bound.

    Examples
    --------
    >>> from susp_ss import FullCar, Road, ride_metrics
    >>> metrics = ride_metrics(FullCar(), Road.iso8608("B", speed=20.0, tracks="isotropic"))
    >>> print(f"{1e3 * metrics.sws.sel(corner='fr').item():.1f} mm")
    5.5 mm
    """
    check_kinds(vehicle, road)
    if method not in METHODS:
        raise ValueError(f"method must be one of {', '.join(METHODS)}, got {method!r}")
    if vehicle.lazy:
        return _lazy_metrics(vehicle, road, {"method": method, "duration": duration, "step": step, "seed": seed})
    return _metrics(vehicle, road, method, vehicle.sweep().size, duration=duration, step=step, seed=seed)


def _metrics(vehicle: Vehicle, road: Road, method: str, designs: int, **record: Any) -> xr.Dataset:
    """Metrics of a vehicle in memory, part of a sweep of so many designs; ``record`` is for time histories."""
    if method == "time":
        variances, errors = time_variances(vehicle, road, **record)
    elif method == "spectral":
        variances = spectral_variances(vehicle, road)
    else:
        variances = covariance_variances(vehicle, road, designs)
    sweep = vehicle.sweep()
    flat = vehicle.flattened(sweep)
    model = vehicle.layout()
    corners = len(model.corners)
    damping = np.stack(np.broadcast_arrays(*flat._at_corners("cs"))).T
    power = damping * variances[:, -corners:]
    roots = np.sqrt(variances, out=variances)
    metrics = labelled_outputs(model, roots, power, sweep, statistic="RMS")
    metrics.damper_power.attrs["long_name"] = f"mean {QUANTITIES['damper_power'][1]}"
    if method == "time":
        with np.errstate(divide="ignore", invalid="ignore"):
            of_roots = np.where(errors > 0.0, errors / (2.0 * roots), 0.0)
        power = damping * errors[:, -corners:]
        stderr = labelled_outputs(model, of_roots, power, sweep, statistic="standard error of")
        metrics = metrics.assign({f"{name}_stderr": data for name, data in stderr.items()})
    return metrics


def _lazy_metrics(vehicle: Vehicle, road: Road, how: dict[str, Any]) -> xr.Dataset:
    """Metrics by blocks of designs, each computed when Dask computes it."""
    import dask.array

    sweep = vehicle.sweep()
    frame, arrays = taken_apart(vehicle)
    with warnings.catch_warnings():
        # A grid has more blocks than any of its axes, which Dask would warn of.
        warnings.simplefilter("ignore", dask.array.PerformanceWarning)
        arrays = arrays.unify_chunks()
    # Without labels, positions let a block name the design that it refuses.
    unlabelled = [dim for dim in sweep.dims if dim not in arrays.indexes]
    arrays = arrays.assign_coords({dim: np.arange(arrays.sizes[dim]) for dim in unlabelled})

    # Names, places and units are those of any vehicle of the kind; a record for them need not be long.
    like = ride_metrics(type(vehicle)(), Road(), how["method"], duration=1.0, step=0.01)
    chunks = tuple(arrays.chunksizes.get(dim, (arrays.sizes[dim],)) for dim in sweep.dims)
    blocks = {
        name: dask.array.empty((*sweep.shape, *data.shape), chunks=(*chunks, *data.shape))
        for name, data in like.items()
    }
    variables = {name: ((*sweep.dims, *like[name].dims), data, like[name].attrs) for name, data in blocks.items()}
    template = xr.Dataset(variables, {**sweep.coords, **like.coords})
    # Dask tells blocks apart by these arguments, not by what a closure would hold.
    given = {
        "frame": frame,
        "road": road,
        "how": how | {"designs": sweep.size},
        "dims": sweep.dims,
        "unlabelled": unlabelled,
    }
    return xr.map_blocks(_without_positions, arrays, kwargs=given, template=template)


def _without_positions(block: xr.Dataset, unlabelled: list[str], **given: Any) -> xr.Dataset:
    return block_metrics(block, **given).drop_vars(unlabelled)


def taken_apart(vehicle: Vehicle) -> tuple[Vehicle, xr.Dataset]:
    """Split a vehicle into a frame, with names in place of its array parameters, and the arrays by name."""
    sweep = vehicle.sweep()
    arrays: dict[str, xr.Variable] = {}

    def named(leaf: Any) -> Any:
        if isinstance(leaf, float):
            return leaf
        name = f"parameter {len(arrays)}"
        arrays[name] = sweep.labelled(leaf).variable
        return name

    frame = vehicle.mapped(named)
    return frame, xr.Dataset(arrays, sweep.coords)


def block_metrics(
    block: xr.Dataset, frame: Vehicle, road: Road, how: dict[str, Any], dims: Sequence[str]
) -> xr.Dataset:
    """Metrics of the designs that a block of arrays makes of a frame.

    Parameters
    ----------
    block : xarray.Dataset
        In memory, with a coordinate along every dim: some of the arrays of `taken_apart`.
    frame : Vehicle
        Of `taken_apart`.
    road : Road
        What the vehicles run over.
    how : dict
        ``method`` and what goes with it, as in `ride_metrics`, and ``designs``, the number of all blocks together.
    dims : sequence of str
        Order of the result's dims, before those of the places.

    Raises
    ------
    ValueError
        A design is refused; the message ends with its coordinates.
    """

    def metrics(designs: xr.Dataset) -> xr.Dataset:
        vehicle = frame.mapped(lambda leaf: designs[leaf] if isinstance(leaf, str) else leaf)
        return _metrics(dataclasses.replace(vehicle), road, **how).transpose(*dims, ..., missing_dims="ignore")

    try:
        return metrics(block)
    except ValueError as error:
        raise _first_refusal(metrics, block) or error from None


def _first_refusal(metrics: Callable[[xr.Dataset], Any], designs: xr.Dataset) -> ValueError | None:
    """Halve refused designs down to one, and return what is said of that."""

    def refusal(some: xr.Dataset) -> ValueError | None:
        try:
            metrics(some)
        except ValueError as error:
            return error
        return None

    dims = list(designs.sizes)
    for dim in dims:
        while designs.sizes[dim] > 1:
            half = designs.sizes[dim] // 2
            first, second = designs.isel({dim: slice(half)}), designs.isel({dim: slice(half, None)})
            designs = first if refusal(first) else second
    one = designs.squeeze()
    said = refusal(one)
    if said is None or not dims:
        return said
    return ValueError(f"{said} at ({', '.join(f'{dim}={one[dim].item()}' for dim in dims)})")
