"""What the engine in JavaScript takes from the searches for fronts and bounds: their constants, and their words."""

from __future__ import annotations

from typing import Any

import numpy as np

from ..design import halving, search
from ..design.bounds import KEPT
from ..design.pareto import pareto_front
from ..feedback import dual, preview, shaping
from ..feedback.plant import Plant, plant
from ..roads.road import Road
from ..vehicles.quarter import QuarterCar
from ..vehicles.vehicle import Vehicle
from .background import POINTS
from .described import refusal

ROAD = Road()


def constants() -> dict[str, Any]:
    """Constants of JavaScript."""
    return {
        "SEARCH": {
            "apart": search.APART,
            "met": search.MET,
            "same": halving.SAME,
            "points": POINTS,
            "kept": KEPT,
        },
        "DUAL": {
            "light": dual.LIGHT,
            "resolved": dual.RESOLVED,
            "start": dual.START,
            "most": dual.MOST,
            "awake": dual.AWAKE,
            "lifts": dual.LIFTS,
            "met": dual.MET,
        },
        "KLEINMAN": preview.STEPS,
        "SHAPING": {"white": shaping.WHITE, "lost": shaping.LOST, "felt": np.ravel(shaping.FELT).tolist()},
    }


def words() -> dict[str, str]:
    """What is said where there is no front or no bound; ``NAME`` and ``VALUE`` are put in."""
    car, box = QuarterCar(ct=100.0), {"ks": (1e4, 2e4)}
    known = _plant(car)
    return {
        "same": refusal(lambda: pareto_front(car, ROAD, box, ("bacc", "bacc"))).replace("bacc", "NAME"),
        "flat": refusal(lambda: pareto_front(car, ROAD, box, ("bacc", "dtl")))
        .replace("dtl", "NAME")
        .replace("inf", "VALUE"),
        "infinite": refusal(lambda: known.named("dtl", "")).removeprefix(": ").replace("dtl", "NAME"),
        "unshaped": shaping.UNSHAPED,
    }


def steered(vehicle: Vehicle) -> dict[str, Any]:
    """What the engine knows of the forces that stand for a vehicle's suspensions."""
    if vehicle.layout().controls:
        return {"steers": True}
    model = vehicle.assemble()
    return {
        "suspensions": model.suspensions.tolist(),
        "unbounded": refusal(lambda: _plant(vehicle).named("damper_power", "")).removeprefix(": "),
    }


def _plant(vehicle: Vehicle) -> Plant:
    return plant(vehicle, ROAD, None, "active_bound")
