"""Names, units and dimensions of the outputs, shared by metrics and time histories."""

from __future__ import annotations

from functools import lru_cache
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from ..quantities import SHIFT, Quantity
from ..vehicles.parameters import DesignSpace
from ..vehicles.second_order import Layout


def dim_of(quantity: Quantity, places: tuple[str, ...]) -> tuple[str, ...]:
    """The dim along which the places of a variable lie, if it has several."""
    return (quantity.dim,) if quantity.dim and places != ("",) else ()


def labelled_outputs(
    layout: Layout,
    values: NDArray[np.float64],
    power: NDArray[np.float64],
    space: DesignSpace,
    dims: tuple[str, ...] = (),
    coords: dict[str, Any] | None = None,
    long_name: str = "{meaning}",
) -> xr.Dataset:
    """Arrange outputs as a Dataset.

    Parameters
    ----------
    layout : Layout
        Names the outputs.
    values : ndarray, (designs, outputs, ...)
        In output units, with trailing axes ``dims``.
    power : ndarray, (designs, corners, ...)
        Damper power in W.
    space : DesignSpace
        Labels the designs.
    long_name : str
        Of every variable, with ``{statistic}`` and ``{meaning}`` of its quantity filled in.
    """
    arrays = {}
    for name, (quantity, places) in layout.variables.items():
        data = values_of(layout, name, values, power)
        shaped = data if dim_of(quantity, places) else data[:, 0]
        arrays[name] = shaped.reshape((*space.shape, *shaped.shape[1:]))
    labelled = _empty(layout, space.dims, space.shape, dims, values.shape[2:], long_name).copy(data=arrays)
    more = {**space.coords, **(coords or {})}
    return labelled.assign_coords(more) if more else labelled


def shifted(
    layout: Layout, space: DesignSpace, values: NDArray[np.float64], long_name: str, dims: tuple[str, ...] = ()
) -> xr.DataArray:
    """Mean deflections (designs, corners, ...) with their labels, and trailing axes ``dims``."""
    dim = dim_of(SHIFT, layout.corners)
    long_name = long_name.format(statistic=SHIFT.statistic, meaning=SHIFT.meaning)
    shaped = space.unflatten(values if dim else values[:, 0], (*dim, *dims), {d: list(layout.corners) for d in dim})
    return shaped.assign_attrs(units=SHIFT.unit, long_name=long_name)


@lru_cache(maxsize=64)
def _empty(
    layout: Layout,
    dims: tuple[str, ...],
    shape: tuple[int, ...],
    more_dims: tuple[str, ...],
    more_shape: tuple[int, ...],
    long_name: str,
) -> xr.Dataset:
    """A Dataset of everything but its values: putting it together takes xarray longer than filling it in."""
    variables: dict[str, Any] = {}
    for name, (quantity, places) in layout.variables.items():
        dim = dim_of(quantity, places)
        along = (*shape, *((len(places),) if dim else ()), *more_shape)
        attrs = {
            "units": quantity.unit,
            "long_name": long_name.format(statistic=quantity.statistic, meaning=quantity.meaning),
        }
        variables[name] = (*dims, *dim, *more_dims), np.broadcast_to(np.nan, along), attrs
    labels = {dim: list(places) for q, places in layout.variables.values() for dim in dim_of(q, places)}
    return xr.Dataset(variables, labels)


def values_of(
    layout: Layout, name: str, values: NDArray[np.float64], power: NDArray[np.float64]
) -> NDArray[np.float64]:
    """A variable's part (designs, places, ...) of the outputs and damper powers of all."""
    if name == "damper_power":
        return power
    rows = layout.outputs.of(name)
    if isinstance(rows, slice):
        return values[:, rows]
    # Taken by rows of the transpose, which keeps one design after another in memory if they are.
    return np.moveaxis(np.moveaxis(values, 1, 0)[rows], 0, 1)
