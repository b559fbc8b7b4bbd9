"""What takes the explorer seconds: the carpet of a vehicle's springs and dampers, the best of them, and beyond."""

from __future__ import annotations

import dataclasses
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..design.bounds import bounds
from ..design.pareto import ParetoFront, pareto_front
from ..vehicles.curves import rate_of
from ..vehicles.vehicle import joined
from .design import damper
from .rows import existing, metrics_at_places, output_names
from .scene import Found, Scene
from .state import NOTHING, Given
from .table import DESIGN, Number

FACTORS = np.geomspace(0.5, 2.0, 7)
"""Of all springs and all dampers of the carpet, about the model's own."""

POINTS = 9
"""Of the front."""


def conditions(state: dict[str, Any], given: Given = NOTHING) -> dict[str, Any]:
    """A checked state with the model's own springs and dampers: what the background depends on.

    Examples
    --------
    >>> from susp_ss.explorer.background import conditions
    >>> from susp_ss.explorer.state import from_query, query
    >>> query(conditions(from_query("model=quarter&ks=20000&mu=50")[0]))
    'model=quarter&mu=50'
    """
    own = {row.key: row.default for row in _design(state, given)}
    usual = given.default(state["model"])
    return state | {"vehicle": state["vehicle"] | own, "bump": usual["bump"], "bode": usual["bode"]}


def background(state: Any, given: Given = NOTHING) -> Found:
    """The carpet, the Pareto front and the active bound of a state, whatever its springs and dampers are.

    Parameters
    ----------
    state : dict
        As `compute` takes it.
    given : Given
        What the explorer was started with.

    Returns
    -------
    dict
        Plain JSON; what cannot be computed is left out, and ``errors`` says why.

        ``carpet``
            ``x`` and ``y``, metrics by name; ``designs``, their values ``[x, y]`` for each of the factors ``ks`` of all
            springs (rows) and ``cs`` of all dampers (columns) about the model's own.
        ``front``
            ``points`` ``[x, y]`` that no springs and dampers within the sliders' ranges beat in both, and their
            ``designs`` by name.
        ``bound``
            For each of these, the least y of any suspension, active or not, that has no more x, nor any more
            deflection or tyre load at any wheel.

    Examples
    --------
    >>> from susp_ss.explorer.background import background
    >>> found = background({"model": "quarter"})
    >>> all(y < passive for (_, y), (_, passive) in zip(found["bound"]["points"], found["front"]["points"]))
    True
    """
    field = Field(state, given)
    found = (field.attempt(carpet) or {}) | (field.attempt(front) or {})
    if "front" in found:
        found |= field.attempt(bound) or {}
    return found | {"errors": field.errors}


class Field(Scene):
    """All designs under the conditions of a state."""

    def __init__(self, state: Any, given: Given):
        super().__init__(state, given)
        self.state = conditions(self.state, given)

    @cached_property
    def axes(self) -> tuple[str, str]:
        """The metrics across and up."""
        names, _ = output_names(self.vehicle)
        x, y = (existing(self.state["carpet"][axis], names) for axis in "xy")
        return x, y

    @cached_property
    def moved(self) -> list[Number]:
        """Springs and dampers."""
        return _design(self.state, self.given)

    @cached_property
    def rates(self) -> dict[str, float]:
        """Springs and dampers as the package searches them, per unit of the sliders: curves by their rates at rest."""
        curve = self.state["curve"]
        by = float(rate_of(damper(1.0, **curve))) if curve else 1.0
        return {row.key: by if row.group == "dampers" else 1.0 for row in self.moved}

    @cached_property
    def best(self) -> ParetoFront:
        """The designs that no other beats."""
        box = {row.key: (row.least * self.rates[row.key], row.most * self.rates[row.key]) for row in self.moved}
        return pareto_front(self.vehicle, self.road, box, self.axes[::-1], points=POINTS)

    @cached_property
    def points(self) -> NDArray[np.float64]:
        """Their metrics, (points, 2)."""
        return self.best.table()[list(self.axes)].to_numpy()


def carpet(field: Field) -> Found:
    """Both metrics for every combination of springs and dampers."""
    car, (x, y) = field.vehicle, field.axes
    if not field.moved:
        return {}
    springs, dampers = (grid.ravel() for grid in np.meshgrid(FACTORS, FACTORS, indexing="ij"))
    scaled: dict[str, Any] = {
        name: joined({wheel: own * by for wheel, own in zip(car.wheels, car.at_wheels(name), strict=True)})
        for name, by in (("ks", springs), ("cs", dampers))
    }
    values = {row.name: row.values for row in metrics_at_places(dataclasses.replace(car, **scaled), field.road)}
    designs = np.stack([values[x], values[y]], axis=-1).reshape(len(FACTORS), len(FACTORS), 2)
    if not np.isfinite(designs).all():
        raise ValueError(f"no carpet of {x} and {y}, which are infinite on this road")
    return {"carpet": {"x": x, "y": y, "ks": FACTORS.tolist(), "cs": FACTORS.tolist(), "designs": designs.tolist()}}


def front(field: Field) -> Found:
    """The best designs, where springs and dampers are all that there is."""
    if not field.moved or field.vehicle.layout().controls:
        return {}
    found = field.best.designs.to_dict("records")
    designs = [{str(key): rate / field.rates[str(key)] for key, rate in one.items()} for one in found]
    return {"front": {"points": field.points.tolist(), "designs": designs}}


def bound(field: Field) -> Found:
    """What no suspension beats, at the same limits as the best designs."""
    least = bounds(field.straight, field.road, field.axes[::-1], field.best.metrics)
    met = np.isfinite(least)
    return {"bound": {"points": np.stack([field.points[met, 0], least[met]], axis=1).tolist()}}


def _design(state: dict[str, Any], given: Given) -> list[Number]:
    rows = given.tables[state["model"]]
    return [row for row in rows if isinstance(row, Number) and row.table == "vehicle" and row.group in DESIGN]
