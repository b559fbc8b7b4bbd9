"""How results are told to the page: by name, label and unit."""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import Any, NamedTuple

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from ..quantities import CORNERS, MIDDLE
from ..vehicles.contract import RoadVehicle

PLACES = {
    **CORNERS,
    **MIDDLE,
    "cg": "centre of gravity",
    "f": "front",
    "r": "rear",
    "l": "left",
    "body": "body",
    "driver": "driver",
    "driver_floor": "floor under the driver",
}


class Row(NamedTuple):
    """A metric at a place, ``values`` over the designs."""

    name: str
    label: str
    unit: str
    values: NDArray[Any]

    def described(self) -> dict[str, str]:
        """Name, label and unit."""
        return {"name": self.name, "label": self.label, "unit": self.unit}


def at_places(metrics: xr.Dataset) -> list[Row]:
    """Every metric of one design, or of designs on dim ``design``, at every place."""
    rows, places = [], {dim: coord.values.tolist() for dim, coord in metrics.coords.items()}
    for name, data in metrics.data_vars.items():
        meaning, unit = data.attrs["long_name"].removeprefix("RMS "), data.attrs["units"]
        dim = next((dim for dim in data.dims if dim != "design"), None)
        if dim is None:
            rows.append(Row(str(name), meaning, unit, np.atleast_1d(data.values)))
            continue
        for place, values in zip(places[dim], data.values.T, strict=True):
            rows.append(Row(f"{name}@{place}", f"{meaning}, {named(place)}", unit, np.atleast_1d(values)))
    return rows


def output_names(car: RoadVehicle) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Names of all metrics of a vehicle, ``sws@fr``, and of those that have a frequency response."""
    layout = car.layout()
    names = [f"{name}@{at}" if at else name for name, (_, places) in layout.variables.items() for at in places]
    public = layout.outputs.names[layout.outputs.public]
    return tuple(names), tuple(name for name in names if name.replace("@", "_") in public)


def existing(name: str, names: Iterable[str], joint: str = "@") -> str:
    """An output's own name; where a seat has made its one place several, the name at the first of them."""
    return next(own for own in names if own == name or own.startswith(f"{name}{joint}"))


def named(place: str) -> str:
    """A place in words."""
    return PLACES.get(place, place)


def finite(values: NDArray[Any]) -> Any:
    """Numbers of a picture as lists.

    Raises
    ------
    ValueError
        Not all are finite: parameters lie too many decades apart.
    """
    if not np.isfinite(values).all():
        raise ValueError(
            "parameters lie too many decades apart for finite responses; pass zero where one nearly vanishes"
        )
    return values.tolist()


def number(value: Any) -> float | None:
    """A number that JSON can hold; None is infinite."""
    return float(value) if math.isfinite(value) else None
