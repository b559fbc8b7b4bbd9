"""Ride metrics by name: ``sws`` at all places, ``sws@fr`` at one."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import xarray as xr

from ..quantities import briefly, signal


def check_output(name: Any, like: xr.Dataset, where: str, one: bool = False) -> None:
    """Refuse what is no name of a metric among ``like``, or of several values where ``one`` is wanted.

    Raises
    ------
    TypeError, ValueError
        Each says what is available.
    """
    if not isinstance(name, str):
        raise TypeError(f"{where} must be names of metrics such as 'bacc@cg', got {briefly(name)}")
    metric, at, place = name.partition("@")
    if metric not in like:
        raise ValueError(f"{where}: no metric named {metric!r}, available: {', '.join(map(str, like.data_vars))}")
    dims = like[metric].dims
    if at and not dims:
        raise ValueError(f"{where}: {metric} has one place only, got {name!r}; pass {metric}")
    places = [*like.indexes[dims[0]]] if dims else []
    if at and place not in places:
        raise ValueError(f"{where}: {metric} has no {dims[0]} named {place!r}, available: {', '.join(places)}")
    if one and dims and not at:
        raise ValueError(
            f"{where}: {metric} has a value at each of {', '.join(places)}; pass one, such as {metric}@{places[0]}"
        )


def output(metrics: xr.Dataset, name: str) -> xr.DataArray:
    """A metric at all places, or, by ``bacc@fr``, at one."""
    metric, at, place = name.partition("@")
    data = metrics[metric]
    if not at:
        return data
    labelled = {"long_name": f"{data.attrs['long_name']} at {place}"}
    return data.sel({data.dims[-1]: place}, drop=True).assign_attrs(labelled)


def kept(metrics: xr.Dataset, outputs: Sequence[str]) -> xr.Dataset:
    """The metrics that are named, at all places or, as ``bacc_fr`` for ``bacc@fr``, at one."""
    return xr.Dataset({signal(*name.split("@")) if "@" in name else name: output(metrics, name) for name in outputs})
