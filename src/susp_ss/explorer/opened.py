"""What the engine in JavaScript takes from fitted surrogates, whose files the page without a server opens itself."""

from __future__ import annotations

import dataclasses
from typing import Any

import numpy as np
from scipy import stats

from ..fit import surrogate_file
from ..fit.low_fidelity import corners_of, own_place, stands_for
from ..metrics.weightings import ACCELERATIONS, filters
from ..quantities import CORNERS, GROUPS, METRICS, ROAD, signal
from ..roads.road import TRACKS, Road
from ..surrogates import gaussian_process, intervals, kriging, numbers, radial_basis, regressor
from ..surrogates.low_fidelity import evaluated
from ..vehicles import MODELS
from ..vehicles.files import model_name, model_named
from ..vehicles.full import FullCar
from ..vehicles.quarter import QuarterCar
from ..vehicles.vehicle import Vehicle
from .described import refusal
from .rows import finite
from .surrogates import INTERVAL, LACKING, SEVERAL

PLACES = ("cg", *CORNERS)
"""Where an expensive model may have been measured."""

FEW = 40
"""Runs up to which a table has Student's distribution; it is needed of fewer than 19."""


def told(vehicle: Vehicle) -> dict[str, Any]:
    """The settings of a vehicle by name, and what stands for what where it is a cheap model."""
    known = {name: [field, list(wheels)] for name, (field, wheels) in vehicle.settings().items()}
    cheap = not (vehicle.seats or vehicle.layout().controls or len(vehicle.axles) > 2)
    return {"type": type(vehicle).__name__, "named": known, "cheap": _cheap(vehicle) if cheap else None}


def _cheap(vehicle: Vehicle) -> dict[str, Any]:
    """The model's name in files, and for each place of a car the corners of each wheel, and the place on the model."""
    places = {
        place: {
            "wheels": {name: sorted(stands_for(vehicle, wheel, place)) for name, wheel in vehicle.wheels.items()},
            "at": own_place(vehicle, place),
        }
        for place in PLACES
    }
    vanishing = [name for name, quantity in vehicle.quantities().items() if quantity.zero]
    known = {"model": model_name(vehicle), "places": places, "single": len(vehicle.wheels) == 1}
    return known | {"vanishing": vanishing}


def constants() -> dict[str, Any]:
    """Constants of JavaScript."""
    some = [signal(field, place) for field in FullCar.per_corner for place in (*CORNERS, *GROUPS)]
    meant = {name: corners_of(name) for name in some}
    return {
        "FITTED": {
            "format": surrogate_file.FORMAT,
            "version": surrogate_file.VERSION,
            "foreign": surrogate_file.FOREIGN,
            "models": list(MODELS),
            "accelerations": ACCELERATIONS,
            "metrics": list(METRICS),
            "road": {name: quantity.zero for name, quantity in ROAD.items()},
            "tracks": TRACKS,
            "of_road": [field.name for field in dataclasses.fields(Road)],
            "places": PLACES,
            "meant": {name: [field, sorted(corners)] for name, (field, corners) in meant.items()},
            "least_degree": radial_basis.LEAST_DEGREE,
            "degrees": list(kriging.TRENDS.values()),
            "thetas": kriging.THETAS,
            "noises": kriging.NOISES,
            "least_noise": gaussian_process.LEAST_NOISE,
            "dependent": regressor.DEPENDENT,
            "tiny": float(np.finfo(float).tiny),
            "many": regressor.KEPT,
            "edge": regressor.EDGE,
            "interval": INTERVAL,
            "rounding": intervals.EDGE,
            "student": stats.t.ppf(0.5 + 0.5 * INTERVAL, np.arange(1, FEW + 1)).tolist(),
        }
    }


def words() -> dict[str, str]:
    """What is said of files that are refused, and of vehicles that surrogates refuse; names stand in braces."""
    newer = {"format": surrogate_file.FORMAT, "version": surrogate_file.VERSION + 1, "susp_ss": "{release}"}
    weighted = refusal(lambda: filters({"{name}": "Wk"}, QuarterCar().layout()))
    infinite = refusal(lambda: evaluated(lambda X: np.full(len(X), np.inf), np.zeros((1, 1))))
    return {
        "lacking": LACKING,
        "several": SEVERAL,
        "no_json": surrogate_file.NO_JSON,
        "no_surrogate": refusal(lambda: surrogate_file.surrogate_of({})),
        "newer": refusal(lambda: surrogate_file.surrogate_of(newer)),
        "apart": refusal(lambda: finite(np.array([np.inf]))),
        "no_kind": refusal(lambda: numbers.from_numbers({"kind": "{name}"})),
        "no_model": refusal(lambda: model_named("{name}")),
        "infinite_cheap": infinite.replace("got inf", "got {value}"),
        "unweighted": weighted[: weighted.index("available: ")].replace("'{name}'", "{name}") + "available: {outputs}",
    }
