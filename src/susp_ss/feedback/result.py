"""What a feedback law achieves, beside the passive vehicle."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from math import isfinite
from typing import TYPE_CHECKING, Any, Self

import pandas as pd
import xarray as xr

from ..metrics.outputs import check_output, output
from ..roads.road import Road
from ..vehicles.contract import RoadVehicle
from ..vehicles.linear import LinearVehicle

if TYPE_CHECKING:
    import control


SHOWN = ("bacc", "sws", "dtl")
"""Metrics that one line tells of, each at its first place."""


@dataclass(frozen=True, eq=False, repr=False)
class Feedback:
    """A feedback law on a vehicle on a road, and what it achieves there.

    Attributes
    ----------
    kind : str
        What made it, such as ``"lqr"``.
    vehicle, road
        What it was made for.
    metrics, passive : xarray.Dataset
        As `ride_metrics` gives them, of the closed loop, with ``force`` (N) on corner, and of the vehicle by itself.
    closed : LinearVehicle or None
        The closed loop, which stands wherever a vehicle may; None where the law looks ahead, which no finite system
        does.
    gain : xarray.DataArray or None
        Forces per state, (force, state): ``u = gain x`` in the states of ``vehicle.state_space(input="velocity")``,
        those of a weighting's filters behind them.
    controller : control.StateSpace or None
        From measured outputs to forces, where the law is one.
    numbers : dict of str to float
        Gains (N s/m) and lag (s) of a law that is made of these, by their names.
    weighting
        Behind which the metrics of such a law are.
    """

    kind: str
    vehicle: RoadVehicle
    road: Road
    metrics: xr.Dataset
    passive: xr.Dataset
    closed: LinearVehicle | None = None
    gain: xr.DataArray | None = None
    controller: control.StateSpace | None = None
    numbers: Mapping[str, float] = field(default_factory=dict)
    weighting: Any = None

    def table(self) -> pd.DataFrame:
        """Every metric at every place, passive and under the law, with the ratio of both."""
        rows = {}
        for name, data in self.metrics.data_vars.items():
            passive = self.passive.get(name)
            for place in data[data.dims[0]].values if data.dims else [""]:
                at = {data.dims[0]: place} if data.dims else {}
                own = float(data.sel(at))
                before = float(passive.sel(at)) if passive is not None else 0.0
                ratio = own / before if before else float("nan")
                rows[f"{name}@{place}" if place else str(name)] = data.attrs["units"], before, own, ratio
        return pd.DataFrame.from_dict(rows, orient="index", columns=["unit", "passive", self.kind, "ratio"])

    def values(self, name: Any, where: str) -> dict[str, float]:
        """The metrics that ``"sws@fr"``, or ``"sws"`` at every place, stands for.

        Raises
        ------
        TypeError, ValueError
            Nothing stands under that name.
        """
        check_output(name, self.metrics, where)
        data = output(self.metrics, name)
        if not data.dims:
            return {name: float(data)}
        return {f"{name}@{place}": float(x) for place, x in zip(data[data.dims[0]].values, data.values, strict=True)}

    def value(self, name: str) -> float:
        """One metric at one place."""
        return self.values(name, "name")[name]

    def renamed(self, numbers: str) -> Self:
        """The same, with the numbers that it was tuned to beside its kind."""
        return replace(self, kind=f"{self.kind}, {numbers}")

    def __repr__(self) -> str:
        table = self.table()
        first = [next(iter(self.values(name, "name"))) for name in SHOWN if name in self.metrics]
        said = ", ".join(f"{name} {table.ratio[name]:.2f}" for name in first if isfinite(table.ratio[name]))
        return f"{self.kind} on {type(self.vehicle).__name__}: {said} of passive"

    def _repr_html_(self) -> str:
        return self.table().to_html()
