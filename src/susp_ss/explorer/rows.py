"""How results are told to the page: by name, label and unit."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..metrics.in_memory import exact_moments
from ..metrics.weightings import filters
from ..quantities import CORNERS, MIDDLE, SHIFT, Quantity
from ..responses.labels import dim_of, values_of
from ..responses.records import Moments
from ..roads.road import Road
from ..vehicles.contract import RoadVehicle
from ..vehicles.second_order import Layout

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


def metrics_at_places(vehicle: RoadVehicle, road: Road, weighting: Any = None) -> list[Row]:
    """Every metric at every place, with the values of `ride_metrics`."""
    layout = vehicle.layout()
    return at_places(layout, exact_moments(vehicle, road, filters(weighting, layout)))


def at_places(layout: Layout, found: Moments) -> list[Row]:
    """The same of variances, damper powers and mean deflections."""
    roots = np.sqrt(found.variances)
    variables = [(*one, values_of(layout, name, roots, found.power)) for name, one in layout.variables.items()]
    if found.shift is not None:
        variables.append((SHIFT, layout.corners, found.shift))
    return [row for variable in variables for row in _rows(*variable)]


def _rows(quantity: Quantity, places: tuple[str, ...], values: NDArray[Any]) -> Iterator[Row]:
    meaning = spoken(quantity)
    if not dim_of(quantity, places):
        yield Row(quantity.name, meaning, quantity.unit, values[:, 0])
        return
    for place, column in zip(places, values.T, strict=True):
        yield Row(f"{quantity.name}@{place}", f"{meaning}, {named(place)}", quantity.unit, column)


def spoken(quantity: Quantity) -> str:
    """A quantity in words; that it is a root mean square goes without saying."""
    return f"{quantity.statistic} {quantity.meaning}".removeprefix("RMS ")


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


def numbers(values: NDArray[Any]) -> list[float | None]:
    """Numbers that JSON can hold; None is infinite."""
    known = values.tolist()
    return known if np.isfinite(values).all() else list(map(number, known))


def number(value: Any) -> float | None:
    """A number that JSON can hold; None is infinite."""
    return float(value) if math.isfinite(value) else None
