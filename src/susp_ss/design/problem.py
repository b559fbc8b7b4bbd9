"""A vehicle's metrics as smooth functions of a few variables: values and derivatives of many designs at once."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from typing import Any

import numpy as np
import pandas as pd
import xarray as xr
from numpy.typing import NDArray

from ..metrics.outputs import output
from ..metrics.ride import ride_metrics
from ..metrics.sensitivity import sensitivity
from ..quantities import ROAD
from ..roads.road import Road
from ..vehicles.vehicle import Vehicle
from .scenarios import Scenarios

Array = NDArray[np.float64]

# Vehicles on roads computed together: some 100 MB.
TOGETHER = 2**17

# Scenarios on which designs are judged that only say where to start.
FEW = 2**6

# Steps of differences, as shares of the range: of a mean, whose error is then 1e-8 of it, and of what follows another
# scenario from one design to the next, which a wider step smooths.
STEP, WIDE_STEP = 1e-4, 1e-2


@dataclasses.dataclass(frozen=True, eq=False)
class Problem:
    """Metrics by ``names`` of a vehicle on a road, over the unit cube of its variables.

    With scenarios each metric is their statistic.
    """

    vehicle: Vehicle
    road: Road
    variables: Mapping[str, tuple[float, float]]
    names: tuple[str, ...]
    weighting: Any = None
    scenarios: Scenarios | None = None

    @property
    def k(self) -> int:
        """Number of variables."""
        return len(self.variables)

    @property
    def low(self) -> Array:
        """Lower ends of the ranges."""
        return np.array([low for low, _ in self.variables.values()])

    @property
    def width(self) -> Array:
        """Widths of the ranges."""
        return np.array([high - low for low, high in self.variables.values()])

    @property
    def smooth(self) -> bool:
        """Whether metrics have no kinks where another scenario becomes the one that counts."""
        return self.scenarios is None or self.scenarios.statistic == "mean"

    def few(self) -> Problem:
        """The same problem, judged on few scenarios."""
        return self if self.scenarios is None else dataclasses.replace(self, scenarios=self.scenarios.some(FEW))

    def designs(self, U: Array) -> pd.DataFrame:
        """Points of the unit cube (N, k) in the variables' units."""
        # No rounding leaves a range.
        inside = np.clip(self.low + U * self.width, self.low, self.low + self.width)
        return pd.DataFrame(inside, columns=list(self.variables))

    def metrics(self, designs: pd.DataFrame) -> xr.Dataset:
        """All metrics on dim ``design``."""
        scenarios = self.scenarios
        if scenarios is None:
            return ride_metrics(
                *self._with({name: column.to_numpy() for name, column in designs.items()}), weighting=self.weighting
            )
        size, parts = max(1, TOGETHER // len(scenarios)), []
        for start in range(0, len(designs), size):
            some = designs.iloc[start : start + size]
            n, m = len(some), len(scenarios)
            crossed = {name: np.repeat(column.to_numpy(), m) for name, column in some.items()}
            crossed |= {name: np.tile(column.to_numpy(), n) for name, column in scenarios.settings.items()}
            found = ride_metrics(*self._with(crossed), weighting=self.weighting)
            parts.append(scenarios.of_metrics(found))
        return xr.concat(parts, "design", data_vars="minimal", coords="minimal", compat="override")

    def own(self) -> xr.Dataset:
        """All metrics of the vehicle as it is, on dim ``design`` of length one."""
        if self.scenarios is None:
            return ride_metrics(self.vehicle, self.road, weighting=self.weighting).expand_dims(design=1)
        return self.metrics(pd.DataFrame(index=[0]))

    def _with(self, settings: Any) -> tuple[Vehicle, Road]:
        """The vehicle and the road with columns of values by name."""
        columns: Any = {str(name): column for name, column in settings.items()}
        ofroad: Any = {name: columns.pop(name) for name in ROAD if name in columns}
        return self.vehicle.replaced(**columns), dataclasses.replace(self.road, **ofroad)

    def values(self, U: Array) -> Array:
        """The named metrics (N, names) at points of the unit cube (N, k)."""
        found = self.metrics(self.designs(U))
        return np.stack([output(found, name).to_numpy() for name in self.names], axis=-1)

    def slopes(self, U: Array) -> Array:
        """Derivatives (N, names, k) along the unit cube: exact, over scenarios central differences of one batch."""
        if self.scenarios is not None:
            return self._differences(U, STEP if self.smooth else WIDE_STEP)
        vehicle, road = self._with({name: column.to_numpy() for name, column in self.designs(U).items()})
        found = sensitivity(vehicle, road, list(self.variables), weighting=self.weighting)
        return np.stack([output(found, name).to_numpy() for name in self.names], axis=1) * self.width

    def _differences(self, U: Array, step: float) -> Array:
        up, down = (np.clip(U[:, None] + sign * step * np.eye(self.k), 0.0, 1.0) for sign in (1.0, -1.0))
        values = self.values(np.concatenate([up, down]).reshape(-1, self.k))
        above, below = values.reshape(2, len(U), self.k, len(self.names))
        return np.asarray(np.swapaxes((above - below) / np.sum(up - down, axis=-1)[..., None], 1, 2))
