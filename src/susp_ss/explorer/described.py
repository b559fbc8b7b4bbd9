"""What the engine in JavaScript says of a kind of vehicle: names, places, words, and how a road reaches it."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from typing import Any

import numpy as np

from ..metrics.comfort import AXES
from ..metrics.ride import ride_metrics
from ..quantities import SHIFT, metric_and_place, signal
from ..responses.excitation import processes
from ..responses.positions import with_positions
from ..roads.road import TRACKS, Road
from ..vehicles.vehicle import Vehicle
from .design import damper
from .motion import motion_of
from .rows import metrics_at_places, named
from .spectra import own_name, response_unit, spectrum_unit, under
from .table import takes_curve

ROTATIONS = {"wroll": "roll_acc", "wpitch": "pitch_acc"}


def described(vehicle: Vehicle, asked: tuple[str, ...]) -> dict[str, Any]:
    """Everything that the engine says of a vehicle but its numbers; ``asked`` are outputs that a state may name."""
    layout = vehicle.layout()
    table, names = np.arange(len(layout.outputs)), layout.outputs.names
    public = names[layout.outputs.public]
    measured = []
    for row in metrics_at_places(vehicle, Road()):
        name, _, place = row.name.partition("@")
        rows = table[layout.rates if name == "damper_power" else layout.outputs.of(name)]
        at = layout.variables[name][1].index(place)
        damper = at if name == "damper_power" else None
        measured.append(row.described() | {"row": int(rows[at]), "damper": damper})
    return {
        "processes": excitations(vehicle),
        "measured": measured,
        "rotations": {
            axis: {"word": word, "row": names.index(axis)} for word, axis in ROTATIONS.items() if axis in names
        },
        "points": [
            {"point": place, "label": named(place), "row": int(row)}
            for place, row in zip(layout.outputs.places("bacc"), table[layout.outputs.of("bacc")], strict=True)
        ],
        "outputs": {name: _output(name, layout, public) for name in asked},
        "inputs": layout.inputs,
        "corners": list(vehicle.wheels),
        "axles": [wheel.axle for wheel in vehicle.wheels.values()],
        "coordinates": [{"motion": word, "at": at} for word, at in (motion_of(vehicle, q) for q in layout.coordinates)],
        **(curved(vehicle) if takes_curve(vehicle) else {}),
        "placed": [{"at": at} for _, at in placed(vehicle)],
    }


def curved(vehicle: Any) -> dict[str, Any]:
    """What dampers of curves need and add: the rows of their velocities, and how far they pump the body."""
    layout, bent = vehicle.layout(), dataclasses.replace(vehicle, cs=damper(1e3, 1.0, 0.5, 0.1, 1.0))
    shifts = [row for row in metrics_at_places(bent, Road()) if row.name.startswith(SHIFT.name)]
    return {
        "velocities": np.arange(len(layout.outputs))[layout.rates].tolist(),
        "shifts": [row.described() for row in shifts],
    }


def _output(name: str, layout: Any, public: Any) -> dict[str, Any]:
    own, given = own_name(name, public), under(name, layout.inputs)
    axis = AXES.get(metric_and_place(own)[0])
    return {
        "row": layout.outputs.names.index(own),
        "input": layout.inputs.index(given),
        "unit": {"bode": response_unit(own, given), "psd": spectrum_unit(own)},
        "weighting": axis and axis.weighting,
    }


def excitations(vehicle: Vehicle) -> dict[str, Any]:
    """How a road reaches a vehicle: for each kind of tracks the processes, as the wheels of each axle meet them."""
    return {
        tracks: [
            {"share": process.share, "sign": process.sign, "weights": process.weights[process.axles].tolist()}
            for process in processes(vehicle, Road(tracks=tracks))
        ]
        for tracks in TRACKS
    }


def placed(vehicle: Vehicle) -> list[tuple[int, list[str]]]:
    """Rows of `form_with_positions` that a drive over a bump shows, and where."""
    names = with_positions(vehicle.layout(), vehicle).outputs.names
    body = next(name for name in names if name.startswith("z_s"))
    shown = {body: ["body", "heave"], "pitch": ["body", "pitch"], "roll": ["body", "roll"]}
    shown |= {signal("z_u", wheel): ["wheels", wheel] for wheel in vehicle.wheels}
    shown |= {signal("z_s", seat): ["seats", seat] for seat in vehicle.linkage().seats}
    return [(names.index(name), at) for name, at in shown.items() if name in names]


def drifting(vehicle: Vehicle, road: Road) -> str:
    """What is said of a vehicle that has no finite variance on a road, whatever that road is."""
    return refusal(lambda: ride_metrics(vehicle, road)).replace(f" ({road.describe()})", "")


def refusal(attempt: Callable[[], Any]) -> str:
    """What the package says where it refuses."""
    try:
        attempt()
    except ValueError as error:
        return str(error)
    raise AssertionError("this must be refused")
