"""Ride metrics by blocks of designs: lazily, as Dask asks for them, or as a sweep splits them."""

from __future__ import annotations

import dataclasses
import warnings
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import xarray as xr

from ..responses.excitation import design_space
from ..roads.road import Road
from ..vehicles.contract import RoadVehicle
from .in_memory import metrics_in_memory, template


def lazy_metrics(vehicle: RoadVehicle, road: Road, how: dict[str, Any]) -> xr.Dataset:
    """Metrics by blocks of designs, each computed when Dask computes it."""
    import dask.array

    space = design_space(vehicle, road)
    frame, ground, arrays = taken_apart(vehicle, road)
    with warnings.catch_warnings():
        # A grid has more blocks than any of its axes, which Dask would warn of.
        warnings.simplefilter("ignore", dask.array.PerformanceWarning)
        arrays = arrays.unify_chunks()
    # Without labels, positions let a block name the design that it refuses.
    unlabelled = [dim for dim in space.dims if dim not in arrays.indexes]
    arrays = arrays.assign_coords({dim: np.arange(arrays.sizes[dim]) for dim in unlabelled})

    like = template(vehicle.layout(), how["method"], how["weighting"], vehicle.curved)
    chunks = tuple(arrays.chunksizes.get(dim, (arrays.sizes[dim],)) for dim in space.dims)
    blocks = {
        name: dask.array.empty((*space.shape, *data.shape), chunks=(*chunks, *data.shape))
        for name, data in like.items()
    }
    variables = {name: ((*space.dims, *like[name].dims), data, like[name].attrs) for name, data in blocks.items()}
    whole = xr.Dataset(variables, {**space.coords, **like.coords})
    # Dask tells blocks apart by these arguments, not by what a closure would hold.
    given = {
        "frame": frame,
        "road": ground,
        "how": how | {"designs": space.size},
        "dims": space.dims,
        "unlabelled": unlabelled,
    }
    return xr.map_blocks(_without_positions, arrays, kwargs=given, template=whole)


def _without_positions(block: xr.Dataset, unlabelled: list[str], **given: Any) -> xr.Dataset:
    return block_metrics(block, **given).drop_vars(unlabelled)


def taken_apart(vehicle: RoadVehicle, road: Road) -> tuple[RoadVehicle, Road, xr.Dataset]:
    """Split a vehicle and a road into frames, with names in place of array parameters, and the arrays by name."""
    space = design_space(vehicle, road)
    arrays: dict[str, xr.Variable] = {}

    def named(leaf: Any) -> Any:
        if isinstance(leaf, float):
            return leaf
        name = f"parameter {len(arrays)}"
        arrays[name] = space.labelled(leaf).variable
        return name

    frame, ground = vehicle.mapped(named), road.mapped(named)
    return frame, ground, xr.Dataset(arrays, space.coords)


def block_metrics(
    block: xr.Dataset, frame: RoadVehicle, road: Road, how: dict[str, Any], dims: Sequence[str]
) -> xr.Dataset:
    """Metrics of the designs that a block of arrays makes of a frame.

    Parameters
    ----------
    block : xarray.Dataset
        In memory, with a coordinate along every dim: some of the arrays of `taken_apart`.
    frame, road : Vehicle, Road
        Of `taken_apart`.
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
        def filled(leaf: Any) -> Any:
            return designs[leaf] if isinstance(leaf, str) else leaf

        vehicle, ground = frame.mapped(filled).checked(), dataclasses.replace(road.mapped(filled))
        whole = metrics_in_memory(vehicle, ground, **how)
        return whole.transpose(*dims, ..., missing_dims="ignore")

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
