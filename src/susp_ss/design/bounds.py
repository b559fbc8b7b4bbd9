"""How far designs are from what any suspension could do: the least of their objective over all feedback laws."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from ..feedback import active_bound
from ..metrics.outputs import output
from ..roads.road import Road
from ..vehicles.vehicle import Vehicle

REPLACED = ("ks", "cs", "arb", "arb_front", "arb_rear")
"""Parameters whose forces a law of forces between wheels and body has in its hands."""

KEPT = ("sws", "dtl")
"""Metrics that a law must leave, at every corner, where the design has them."""


def bounded(fields: Iterable[str]) -> bool:
    """Whether designs that differ in these fields have one bound."""
    return set(fields) <= set(REPLACED)


def bounds(
    vehicle: Vehicle, road: Road, objectives: tuple[str, ...], metrics: xr.Dataset, weighting: Any = None
) -> NDArray[np.float64]:
    """Least first objective (designs,) over all laws that keep the second, and every deflection and tyre load."""
    first, *second = objectives
    places = (
        f"{name}@{place}" if metrics[name].dims[1:] else name
        for name in KEPT
        for place in np.atleast_1d(metrics.get("corner", ""))
    )
    limits = {name: output(metrics, name).to_numpy() for name in dict.fromkeys([*second, *places]) if name != first}
    found = active_bound(vehicle, road, first, limits, weighting)
    return np.asarray(found.bound)
