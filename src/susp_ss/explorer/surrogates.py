"""What fitted surrogates predict for the page's design, beside the exact value."""

from __future__ import annotations

import dataclasses
import warnings
from typing import Any

import pandas as pd

from ..fit.surrogate_file import SuspensionSurrogate
from ..quantities import ROAD, metric_and_place
from ..roads.road import Road
from ..surrogates.intervals import NoIntervalWarning
from ..surrogates.regressor import ExtrapolationWarning
from ..vehicles.contract import RoadVehicle
from ..vehicles.curves import rate_of
from ..vehicles.vehicle import Vehicle
from .rows import metrics_at_places, number

INTERVAL = 0.95
"""Share of the expensive model's values that the bounds are to hold."""

LACKING = "needs {name}, which {kind} has not"

SEVERAL = "needs one {name} for all of {wheels}, got {values}"


def predictions(name: str, fitted: SuspensionSurrogate, vehicle: RoadVehicle, road: Road) -> list[dict[str, Any]]:
    """What a surrogate says of every output of its own, and what the vehicle itself has there.

    That is exact on the road for which the surrogate was fitted, and weighted as its runs were. ``outside`` says that
    the design lies outside the runs: then no bounds hold.

    Raises
    ------
    ValueError
        A vehicle that has not one value for each input.
    """
    design = {own: _value(own, vehicle, road) for own in fitted.inputs}
    X = pd.DataFrame([design])
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", NoIntervalWarning)
        warnings.simplefilter("ignore", ExtrapolationWarning)
        found = fitted.predict(X, interval=INTERVAL).iloc[0]
    exact = _exact(fitted, design, vehicle)
    outside = bool(fitted.outside(X)[0])
    rows = []
    for output, unit in fitted.outputs.items():
        metric, place = metric_and_place(output)
        at = next((own for own in (f"{metric}@{place or fitted.low_fidelity.place}", metric) if own in exact), None)
        kind = fitted.accuracy.get(output, {}).get("surrogate", type(fitted.models[output]).__name__)
        bounds = {word: number(found[f"{output}_{word}"]) for word in ("low", "high")}
        rows.append(
            {"surrogate": f"{name}: {kind}", "output": at or output, "unit": unit, "value": number(found[output])}
            | bounds
            | {"exact": None if at is None else number(exact[at]), "outside": outside}
        )
    return rows


def _exact(fitted: SuspensionSurrogate, design: dict[str, float], vehicle: RoadVehicle) -> dict[str, float]:
    """Metrics of the vehicle as the runs of the fit were measured."""
    cheap = fitted.low_fidelity
    given: dict[str, Any] = {name: value for name, value in design.items() if name in ROAD}
    through = {metric: cheap.weighting for metric, _ in map(metric_and_place, fitted.outputs) if cheap.through(metric)}
    rows = metrics_at_places(vehicle, dataclasses.replace(cheap.road, **given), through)
    return {row.name: float(row.values[0]) for row in rows}


def _value(name: str, vehicle: RoadVehicle, road: Road) -> float:
    """The value of an input that the vehicle or the road has."""
    if name in ROAD:
        return float(getattr(road, name))
    if not isinstance(vehicle, Vehicle) or name not in vehicle.settings():
        raise ValueError(LACKING.format(name=name, kind=type(vehicle).__name__))
    field, wheels = vehicle.settings()[name]
    own = dict(zip(vehicle.wheels, map(rate_of, vehicle.at_wheels(field)), strict=True))
    values = {own[wheel] for wheel in wheels}
    if len(values) > 1:
        said = ", ".join(f"{wheel} {own[wheel]:g}" for wheel in wheels)
        raise ValueError(SEVERAL.format(name=name, wheels=", ".join(wheels), values=said))
    return float(values.pop())
