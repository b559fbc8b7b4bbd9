"""What a design meets in its life: vehicles and roads as a table, and one number for all of them."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np
import pandas as pd
import xarray as xr
from numpy.typing import NDArray

from ..quantities import briefly
from ..responses.settings import settable
from ..vehicles.contract import RoadVehicle

Array = NDArray[np.float64]

WEIGHT = "weight"
"""Column that says how much a scenario counts."""

STATISTICS = "'mean', 'worst' or a quantile between 0 and 1, such as 0.95"


class Scenarios(NamedTuple):
    """Settings of vehicle and road, one row a scenario, with weights that add up to one.

    ``statistic`` is ``"mean"``, ``"worst"`` or the quantile.
    """

    settings: pd.DataFrame
    weights: Array
    statistic: str | float

    def __len__(self) -> int:
        return len(self.weights)

    @property
    def said(self) -> str:
        """The statistic in words."""
        return self.statistic if isinstance(self.statistic, str) else f"{self.statistic:g} quantile"

    def of(self, values: Array) -> Array:
        """The statistic (N, ...) of values (N, scenarios, ...)."""
        if self.statistic == "mean":
            return np.asarray(np.tensordot(self.weights, values, (0, 1)))
        if self.statistic == "worst":
            return np.asarray(values.max(axis=1))
        level = float(self.statistic)
        if np.ptp(self.weights) <= 1e-12 * self.weights.max():
            return np.asarray(np.quantile(values, level, axis=1))
        return np.asarray(np.quantile(values, level, axis=1, weights=self.weights, method="inverted_cdf"))

    def of_metrics(self, metrics: xr.Dataset) -> xr.Dataset:
        """The statistic on dim ``design`` of metrics on that dim, every design in one scenario after another."""

        def one(data: xr.DataArray) -> xr.DataArray:
            values = data.to_numpy()
            attrs = {**data.attrs, "long_name": f"{self.said} over scenarios of {data.attrs['long_name']}"}
            apart = values.reshape(-1, len(self), *values.shape[1:])
            return xr.DataArray(self.of(apart), dims=data.dims, attrs=attrs)

        return xr.Dataset({name: one(data) for name, data in metrics.data_vars.items()}, metrics.coords)

    def some(self, count: int) -> Scenarios:
        """At most so many scenarios, evenly taken."""
        step = math.ceil(len(self) / count)
        weights = self.weights[::step]
        return Scenarios(self.settings.iloc[::step], weights / weights.sum(), self.statistic)


def checked_scenarios(vehicle: RoadVehicle, table: Any, statistic: Any, variables: Mapping[str, Any]) -> Scenarios:
    """Scenarios of a DataFrame or a mapping of columns, or say what is wrong with them."""
    if not isinstance(table, (Mapping, pd.DataFrame)):
        raise TypeError(f"scenarios must be a DataFrame or a mapping of columns, got {briefly(table)}")
    try:
        frame = pd.DataFrame(table)
    except ValueError as error:
        raise ValueError(f"scenarios must be columns of one length: {error}") from None
    known = settable(vehicle)
    settings = frame.drop(columns=WEIGHT, errors="ignore")
    if settings.empty:
        raise ValueError("scenarios must hold at least one row and one column, such as speed, got none")
    for name in settings.columns:
        if name not in known:
            raise ValueError(f"scenarios: no parameter named {name!r}, available: {', '.join(known)}, {WEIGHT}")
        for other in variables:
            if known[name].meets(known[other]):
                raise ValueError(f"scenarios: {name!r} and the variable {other!r} set one parameter; pass one of them")
    if not all(kind.kind in "iuf" for kind in frame.dtypes):
        raise TypeError("scenarios must be numbers in SI units in every column")
    if not np.isfinite(frame.to_numpy(float)).all():
        raise ValueError("scenarios must be finite in every column")
    weights = frame[WEIGHT].to_numpy(float) if WEIGHT in frame else np.ones(len(frame))
    if weights.min() < 0.0 or weights.sum() == 0.0:
        raise ValueError("scenarios: weights must be >= 0, and one of them > 0")
    taken = weights > 0.0
    return Scenarios(
        settings[taken].astype(float).reset_index(drop=True),
        weights[taken] / weights.sum(),
        _checked_statistic(statistic),
    )


def _checked_statistic(statistic: Any) -> str | float:
    if isinstance(statistic, str):
        if statistic in ("mean", "worst"):
            return statistic
    elif isinstance(statistic, (float, np.floating)) and 0.0 < statistic < 1.0:
        return float(statistic)
    raise ValueError(f"statistic must be {STATISTICS}, got {briefly(statistic)}")
