"""The explorer's engine in JavaScript, written out of the Python package: a car, a road, and what the ride is worth.

What a vehicle is, its own `linkage` says, traced with `symbols`; spectra, weightings, processes, names, units, bounds
and words are read off the package's objects. Of its own the engine has dense linear algebra and the algebra of
covariance alone (``engine/*.js``), which the tests hold against `ride_metrics` on random cars.
"""

from __future__ import annotations

import json
from importlib import resources
from typing import Any

import numpy as np

from ..quantities import signal
from ..responses.excitation import integrated, processes
from ..roads.colours import COINCIDENT, colours
from ..roads.road import TRACKS, Road
from ..vehicles.vehicle import Vehicle, joined
from .symbols import Lines, written

SOURCES = ("algebra.js", "covariance.js", "ride.js")

# What JavaScript asks of an assembled car.
MATRICES = (
    *("m", "K", "C", "K_in", "C_in", "R", "N", "elongation", "on_position", "on_velocity", "on_road_velocity"),
    *("integrators", "damping"),
)


def assembled(vehicle: Vehicle) -> str:
    """A function of JavaScript that makes a vehicle's matrices of parameters at every wheel, ``p.ks_fr``."""
    lines, kind = Lines(), type(vehicle)
    car = object.__new__(kind)
    for field in kind.quantities():
        each = {wheel: lines.given(f"p.{signal(field, wheel)}") for wheel in kind.wheels}
        value = joined(each) if field in kind.per_corner else lines.given(f"p.{field}")
        object.__setattr__(car, field, value)
    model = car.linkage().assemble()
    parts = {name: getattr(model, name) for name in MATRICES}
    parts |= {"track_width": car.track_width, "wheelbase": car.wheelbase}
    made = ", ".join(f"{name}: {written(value)}" for name, value in parts.items())
    return f"(p) => {{\n{lines}\nreturn {{ {made} }};\n}}"


def excitations(vehicle: Vehicle, surfaces: dict[str, Any]) -> dict[str, Any]:
    """How the tracks of a road reach a vehicle: for each kind of tracks the processes, met by one axle after another."""
    model, found = vehicle.assemble(), {}
    for tracks in TRACKS:
        found[tracks] = []
        for process in processes(vehicle, Road(tracks=tracks)):
            surface = f"{process.share} {process.sign}"
            surfaces[surface] = process
            rates, _ = integrated(model, process)
            axles = process.axles
            found[tracks].append(
                {
                    "surface": surface,
                    "sign": process.sign,
                    "weights": process.weights[axles].tolist(),
                    "rates": [rate[0] if len(rate) else 0.0 for rate in rates[axles].tolist()],
                }
            )
    return found


def surface(process: Any, waviness: float) -> dict[str, Any]:
    """A process's road velocity as first-order terms, at unit roughness, speed and track width."""
    road = Road(roughness=1.0, speed=1.0, waviness=waviness, tracks="isotropic")
    level, *terms = colours(road, process.share, process.sign, np.ones(1))
    columns = np.broadcast_arrays(*terms)
    return {"level": level.item(), "terms": np.stack(columns, axis=-1)[0].tolist()}


def measured(vehicle: Vehicle) -> list[dict[str, Any]]:
    """The metrics: their names, and the rows of the output table that they are the roots of."""
    layout, found = vehicle.layout(), []
    table = np.arange(len(layout.outputs))
    for name, (_, places) in layout.variables.items():
        power = name == "damper_power"
        rows = table[layout.rates if power else layout.outputs.of(name)].tolist()
        for i, (place, row) in enumerate(zip(places, rows, strict=True)):
            found.append({"name": f"{name}@{place}", "row": row, "damper": i if power else None})
    return found


def model(vehicle: Vehicle, surfaces: dict[str, Any]) -> str:
    """A kind of vehicle as an object of JavaScript."""
    parts = {
        "assemble": assembled(vehicle),
        "processes": json.dumps(excitations(vehicle, surfaces)),
        "measured": json.dumps(measured(vehicle)),
    }
    return "{ " + ",\n".join(f"{name}: {value}" for name, value in parts.items()) + " }"


def engine(models: dict[str, Vehicle], wavinesses: tuple[float, ...]) -> str:
    """The engine as a script that sets ``window.engine``."""
    surfaces: dict[str, Any] = {}
    cars = ",\n".join(f"{json.dumps(name)}: {model(vehicle, surfaces)}" for name, vehicle in models.items())
    spectra = {
        name: {f"{waviness:g}": surface(process, waviness) for waviness in wavinesses} for name, process in surfaces.items()
    }
    sources = "\n".join(resources.files(__package__).joinpath("engine", name).read_text("utf-8") for name in SOURCES)
    return (
        f'(() => {{\n"use strict";\nconst COINCIDENT = {COINCIDENT};\n'
        f"const SURFACES = {json.dumps(spectra)};\nconst MODELS = {{\n{cars}\n}};\n{sources}\n"
        "globalThis.engine = { Car };\n})();\n"
    )
