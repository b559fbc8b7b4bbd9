"""The explorer's engine in JavaScript, written out of the Python package: cars, a road, and what the ride is worth.

What a vehicle is, its own `linkage` says, traced with `symbols`; spectra, weightings, processes, names, units, bounds
and words are read off the package's objects. Of its own the engine has linear algebra and the algebra of covariance
alone (``engine/*.js``), which the tests hold against `compute` on random states.
"""

from __future__ import annotations

import json
from importlib import resources
from typing import Any

import numpy as np
from scipy.special import gamma

from ..metrics.comfort import AXES, REACTIONS
from ..metrics.weightings import WEIGHTINGS, filter_of
from ..quantities import signal
from ..responses.covariance import linearisation
from ..responses.excitation import DRIFT
from ..responses.positions import form_with_positions
from ..responses.simulation import SWINGING
from ..roads.colours import COINCIDENT, colours
from ..roads.obstacles import STEP
from ..roads.road import REFERENCE_WAVENUMBER, Road
from ..vehicles.curves import DamperCurve
from ..vehicles.full import FullCar
from ..vehicles.handling_model import UNMOVED
from ..vehicles.modes import SPLIT
from ..vehicles.ride_handling import RideHandlingCar
from ..vehicles.second_order import ROUNDING
from ..vehicles.truck import OUTSIDE, ThreeAxleTruck
from ..vehicles.vehicle import Vehicle, joined
from . import motion, opened, search, templates
from .background import FACTORS
from .described import described, drifting, placed
from .moving import moving, said, words
from .scene import SPEEDS
from .seat import seated
from .spectra import GRID, powers
from .state import MODELS, NOTHING
from .symbols import Lines
from .table import DESIGN, Choice, Number

SOURCES = (
    *("algebra.js", "complex.js", "modes.js", "eigen.js", "dynamics.js", "covariance.js"),
    *("ride.js", "moving.js", "motion.js", "forms.js", "curves.js", "answers.js"),
    *("descent.js", "front.js", "decay.js", "passage.js", "shaping.js", "preview.js", "bound.js"),
    *("background.js", "zip.js", "fmu.js", "files.js"),
    *("cheap.js", "kinds.js", "approximations.js", "surrogates.js"),
)

# What JavaScript asks of an assembled car.
MATRICES = (
    *("m", "K", "C", "K_in", "C_in", "R", "N", "elongation", "rate", "acceleration", "on_road_velocity"),
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
    model: Any = car.linkage().assemble()
    _, _, Y, _, _ = form_with_positions(model, car)
    n, rows = len(model.layout.coordinates), [row for row, _ in placed(vehicle)]
    parts = {name: getattr(model, name) for name in MATRICES}
    parts |= {"track_width": car.track_width, "behind": list(car.axles), "places": Y[rows, :n]}
    return lines.function(parts)


def surface(sign: int, waviness: float) -> dict[str, Any]:
    """The road velocity of one track (``sign`` 0), of the mean of both (1) or of half their difference (-1).

    As first-order terms, at unit roughness, speed and track width.
    """
    road = Road(roughness=1.0, speed=1.0, waviness=waviness, tracks="isotropic")
    level, *terms = colours(road, 0.5 if sign else 1.0, sign, np.ones(1))
    return {"level": level.item(), "terms": np.stack(np.broadcast_arrays(*terms), axis=-1)[0].tolist()}


def weighting(name: str) -> dict[str, Any]:
    """A frequency weighting: its square as first-order terms, and at the frequencies of spectra."""
    one = filter_of(name, name)
    level, alphas, low, _ = one.colours
    parts = np.stack([alphas[0].real, alphas[0].imag, low[0].real, low[0].imag], axis=-1)
    return {"level": level.item(), "terms": parts.tolist(), "power": powers(name).tolist()}


def settings(name: str, vehicle: Vehicle) -> dict[str, list[str]]:
    """The parameters, at every wheel, that each number of a state of a model sets."""
    known = {row.key: vehicle.settings()[row.key] for row in numbers(name, "vehicle")}
    return {
        key: [signal(field, wheel) for wheel in wheels] if field in vehicle.per_corner else [field]
        for key, (field, wheels) in known.items()
    }


def model(name: str) -> str:
    """A model, and where it takes a seat also with that, as entries of an object of JavaScript."""
    bare: Any = NOTHING.models[name]
    seat = {row.key: row.default for row in numbers(name, "seat")}
    asked = next(row for row in NOTHING.tables[name] if isinstance(row, Choice) and row.name == "bode")
    alone = tuple(output for output in asked.options if output not in asked.seated)
    known: dict[str, Any] = {"vehicle": settings(name, bare)}

    def entry(key: str, car: Any, outputs: tuple[str, ...]) -> str:
        moves = isinstance(car, RideHandlingCar)
        data = described(car, outputs) | search.steered(car) | (said(car) if moves else {})
        data |= {"settings": known, "files": templates.of_vehicle(car)} | opened.told(car)
        return f"{json.dumps(key)}: {{ ...{json.dumps(data)},\nassemble: {(moving if moves else assembled)(car)} }}"

    if not seat:
        return entry(name, bare, alone)
    occupied = seated(bare, seat)
    more = [field for field in type(occupied).quantities() if field not in type(bare).quantities()]
    known["seat"] = {key: next(field for field in more if field.startswith(f"seat_{key}")) for key in seat}
    return ",\n".join([entry(name, bare, alone), entry(f"{name}, seated", occupied, asked.options)])


def numbers(name: str, table: str) -> list[Number]:
    """What the page may set of a table of a model's states."""
    return [row for row in NOTHING.tables[name] if isinstance(row, Number) and row.table == table]


def designs(name: str) -> list[dict[str, Any]]:
    """Springs and dampers of a model as the page begins with them, and their ranges."""
    rows = [row for row in numbers(name, "vehicle") if row.group in DESIGN]
    return [{"key": r.key, "group": r.group, "value": r.default, "least": r.least, "most": r.most} for r in rows]


def wavinesses() -> list[float]:
    """Those that the slider of the road's waviness stops at."""
    row = next(row for row in numbers(MODELS[0], "road") if row.key == "waviness")
    steps = round((row.most - row.least) / row.step)
    return [round(row.least + i * row.step, 9) for i in range(steps + 1)]


def engine() -> str:
    """The engine as a script.

    It sets ``dash_clientside.engine``: ``answer``, ``compute`` and ``background`` are those of `susp_ss.explorer`, of
    which the last tells a second argument what is found so far; ``metrics`` are the numbers alone, and ``file`` is
    what `susp_ss.explorer.downloads` writes. ``answer`` takes the texts of surrogate files as well, of which ``wrong``
    says what is wrong.
    """
    grid = wavinesses()
    constants: dict[str, Any] = {
        "COINCIDENT": COINCIDENT,
        "DAMPED": ROUNDING,
        "DRIFT": DRIFT,
        "SPLIT": SPLIT,
        "UNMOVED": UNMOVED,
        "REFERENCE_WAVENUMBER": REFERENCE_WAVENUMBER,
        "SPEEDS": SPEEDS.tolist(),
        "FREQUENCIES": GRID.tolist(),
        "SURFACES": {str(sign): {f"{w:g}": surface(sign, w) for w in grid} for sign in (0, 1, -1)},
        "GAMMA": {f"{w:g}": float(gamma(0.5 * w)) for w in grid},
        "AXES": {name: axis._asdict() for name, axis in AXES.items()},
        "WEIGHTINGS": {name: weighting(name) for name in WEIGHTINGS},
        "REACTIONS": REACTIONS,
        "FACTORS": FACTORS.tolist(),
        "DESIGNS": {name: designs(name) for name in MODELS},
        **search.constants(),
        **opened.constants(),
        "BUMP": {name.lower(): getattr(motion, name) for name in ("BEFORE", "AFTER", "SHOWN", "STEP", "OVER")}
        | {"spacing": STEP},
        "CURVE": templates.curve()
        | {
            name.lower(): getattr(linearisation, name)
            for name in ("CONVERGED", "ROUNDS", "LONGEST", "STILL", "STEPS", "SETTLED")
        }
        | {"middling": DamperCurve.middling, "resolved": motion.RESOLVED, "swinging": SWINGING},
        "FILES": templates.files(),
        "WORDS": {
            **search.words(),
            "drifting": drifting(FullCar(), Road(waviness=3.0, tracks="independent")),
            "fmu": "no FMU of a car that moves here; susp-ss explore writes it",
            "unsettled": "dampers' linearisation did not settle; take gentler curves or a smoother road",
            "middle": f"{ThreeAxleTruck.__name__}{OUTSIDE}",
            **words(),
            **opened.words(),
            "damaged": "damaged: {what}",
            "elsewhere": "{what} needs susp-ss explore",
            "waviness": f"waviness goes in steps of {grid[1] - grid[0]:.2g} here; susp-ss explore takes any",
        },
    }
    given = "\n".join(f"const {name} = {json.dumps(value)};" for name, value in constants.items())
    cars = ",\n".join(map(model, MODELS))
    sources = "\n".join(resources.files(__package__).joinpath("engine", name).read_text("utf-8") for name in SOURCES)
    return (
        f'(() => {{\n"use strict";\n{given}\nconst MODELS = {{\n{cars}\n}};\n{sources}\n'
        "(globalThis.dash_clientside ??= {}).engine = { answer, compute, background, file, metrics, wrong };\n})();\n"
    )
