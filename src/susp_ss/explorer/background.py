"""What takes the explorer seconds: the carpet of a vehicle's springs and dampers, the best of them, and beyond."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from typing import Any

import numpy as np

from ..design.bounds import bounds
from ..design.pareto import pareto_front
from ..metrics.ride import ride_metrics
from ..roads.road import Road
from ..vehicles.vehicle import Vehicle, joined
from .design import road_of, vehicle_of
from .rows import at_places, existing
from .state import NOTHING, Given, checked
from .table import Number

FACTORS = np.geomspace(0.5, 2.0, 7)
"""Of all springs and all dampers of the carpet, about the model's own."""

POINTS = 5
"""Of the front."""

DESIGN = ("springs", "dampers")
"""Groups of the vehicle's table that are the design; all else is the frame in which it stands."""

Found = dict[str, Any]


def frame(state: dict[str, Any], given: Given = NOTHING) -> dict[str, Any]:
    """A checked state with the model's own springs and dampers: what the background depends on.

    Examples
    --------
    >>> from susp_ss.explorer.background import frame
    >>> from susp_ss.explorer.state import from_query, query
    >>> query(frame(from_query("model=quarter&ks=20000&mu=50")[0]))
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
    right, errors = checked(state, given)
    right = frame(right, given)
    found: Found = {"errors": errors}

    def attempt(part: Callable[..., Any], *arguments: Any) -> Any:
        try:
            return part(*arguments)
        except (ValueError, TypeError) as error:
            errors.append({"parameter": "", "message": str(error)})
            return None

    car, road = attempt(vehicle_of, right, given), attempt(road_of, right, given)
    if not isinstance(car, Vehicle) or road is None:
        return found
    x, y = right["carpet"]["x"], right["carpet"]["y"]
    drawn = attempt(carpet, car, road, x, y)
    if drawn is None:
        return found
    found["carpet"], x, y = drawn, drawn["x"], drawn["y"]
    box = {row.key: (row.least, row.most) for row in _design(right, given)}
    front = attempt(pareto_front, car, road, box, (y, x), None, POINTS)
    if front is None:
        return found
    points = front.table()[[x, y]].to_numpy()
    found["front"] = {"points": points.tolist(), "designs": front.designs.to_dict("records")}
    least = attempt(bounds, car, road, (y, x), front.metrics)
    if least is not None:
        met = np.isfinite(least)
        found["bound"] = {"points": np.stack([points[met, 0], least[met]], axis=1).tolist()}
    return found


def carpet(car: Vehicle, road: Road, x: str, y: str) -> Found:
    """Two metrics for every combination of springs and dampers."""
    springs, dampers = (grid.ravel() for grid in np.meshgrid(FACTORS, FACTORS, indexing="ij"))
    scaled: dict[str, Any] = {
        field: joined({wheel: own * by for wheel, own in zip(car.wheels, car.at_wheels(field), strict=True)})
        for field, by in (("ks", springs), ("cs", dampers))
    }
    values = {row.name: row.values for row in at_places(ride_metrics(dataclasses.replace(car, **scaled), road))}
    x, y = existing(x, values), existing(y, values)
    designs = np.stack([values[x], values[y]], axis=-1).reshape(len(FACTORS), len(FACTORS), 2)
    if not np.isfinite(designs).all():
        raise ValueError(f"a carpet of {x} and {y} is infinite on this road")
    return {"x": x, "y": y, "ks": FACTORS.tolist(), "cs": FACTORS.tolist(), "designs": designs.tolist()}


def _design(state: dict[str, Any], given: Given) -> list[Number]:
    rows = given.tables[state["model"]]
    return [row for row in rows if isinstance(row, Number) and row.table == "vehicle" and row.group in DESIGN]
