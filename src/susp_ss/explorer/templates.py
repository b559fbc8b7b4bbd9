"""Files of a vehicle with gaps, ``{{name}}``, which the page without a server fills with the numbers of its state.

Every word in them is the package's own: gaps are cut into what it writes of a vehicle.
"""

from __future__ import annotations

import dataclasses
import itertools
import re
from typing import Any, Self

import numpy as np

from ..exchange.exporting import texts
from ..exchange.realised import Realised, realised
from ..presentation.reproduction import code
from ..roads.road import Road
from ..vehicles.curve_files import across_step, curve_entry
from ..vehicles.files import vehicle_text
from ..vehicles.parameters import Corners
from ..vehicles.seats import Seat, field_of
from ..vehicles.vehicle import Vehicle
from .design import damper
from .downloads import FILES
from .lines import script
from .state import NOTHING

SOURCE = "sources/fmi2.c"
"""The place in an FMU of what is the same in all of them."""

MATRICES = ("A", "B", "C", "D", "REST")


class Gap(float):
    """A number that is written as a gap of a name."""

    name: str

    def __new__(cls, name: str) -> Self:
        made = super().__new__(cls, 1.0)
        made.name = name
        return made

    def __repr__(self) -> str:
        return f"{{{{{self.name}}}}}"


def vehicle_file(vehicle: Vehicle) -> str:
    """A vehicle file with a gap for every parameter's entry, by the parameter's name.

    Examples
    --------
    >>> from susp_ss import QuarterCar
    >>> from susp_ss.explorer.templates import vehicle_file
    >>> print(vehicle_file(QuarterCar()).splitlines()[-1])
    ct = {{ct}}  # tyre damping, >= 0
    """
    lines, seat = [], ""
    for line in vehicle_text(vehicle).splitlines():
        if line.startswith("["):
            seat = line.strip("[]").partition(".")[2]
        name = field_of(line.partition(" = ")[0], seat) if seat else line.partition(" = ")[0]
        lines.append(re.sub(r"^(\w+) = \{.*\}(?=  #)", rf"\1 = {{{{{name}}}}}", line))
    return "\n".join([*lines, ""])


def python_lines() -> dict[str, str]:
    """Lines of Python with gaps for the query of the address, vehicle, road and bump; of ``curved`` vehicles, too."""
    bump = {key: Gap(key) for key in NOTHING.default()["bump"]}
    query, vehicle, road = (repr(Gap(name)) for name in ("query", "vehicle", "road"))
    return {
        kind: script(query, vehicle, road, straight, **bump)
        for kind, straight in (("straight", "vehicle"), ("curved", "ss.linearised(vehicle, road)"))
    }


def vehicle_call(vehicle: Vehicle) -> dict[str, Any]:
    """How code makes a vehicle: its class, its fields, and those of its seats by the names of the vehicle's.

    A field has its own value at each of its wheels, is ``apart`` where it has several, and is ``told`` even where it is
    zero.
    """
    kind = getattr(vehicle, "plain", type(vehicle))
    defaults = {field.name: field.default for field in dataclasses.fields(kind)}
    seats = {
        seat: {of: field_of(of, seat) for of in Seat.quantities() if hasattr(vehicle, field_of(of, seat))}
        for seat in (vehicle.seats if kind is not type(vehicle) else ())
    }
    return {
        "kind": kind.__name__,
        "seats": seats,
        "fields": {
            name: {
                "unit": vehicle.quantities()[name].unit,
                "wheels": list(vehicle.wheels) if name in vehicle.per_corner else None,
                "own": list(vehicle.at_wheels(name)) if name in vehicle.per_corner else [getattr(vehicle, name)],
                "apart": isinstance(getattr(vehicle, name), (Corners, tuple)),
                "told": bool(defaults.get(name)),
            }
            for name in vehicle.quantities()
            if getattr(vehicle, name) is not None
        },
    }


def road_call() -> list[dict[str, Any]]:
    """The fields of a road of a state, and how their own values are written."""
    road, state = NOTHING.road, NOTHING.default()["road"]
    fields = {field.name: field.default for field in dataclasses.fields(Road)}
    return [
        {"name": name, "own": code(getattr(road, name)), "told": bool(default)}
        for name, default in fields.items()
        if name in state or getattr(road, name) or default
    ]


def fmu(vehicle: Vehicle) -> list[dict[str, str]] | None:
    """Description and tables of an FMU, on heights of the road and on their rates; None of a car that moves.

    Gaps are the parameters, in C the matrices, the GUID, and what each output, then each state's rate depends on:
    ``row 0``, ``row 1`` and so on.
    """
    if vehicle.layout().controls:
        return None
    return [_fmu(realised(vehicle.replaced(ct=ct)), type(vehicle).__name__) for ct in (0.0, 1.0)]


def _fmu(model: Realised, name: str) -> dict[str, str]:
    full = {key: np.ones_like(getattr(model, key)) for key in "ABCD"}
    constants = tuple(one._replace(value=Gap(one.name)) for one in model.constants)
    identifier = FILES["fmu"].name.removesuffix(".fmu")
    found = texts(dataclasses.replace(model, **full, constants=constants), name, identifier, repr(Gap("guid")))
    place, tables = (place for place in found if place != SOURCE)
    every = " ".join(str(i + 1) for i in range(len(model.inputs) + len(model.states)))
    rows = itertools.count()
    values = {"PARAMETER": f"{{{', '.join(repr(one.value) for one in constants)}, 0.0}}"}
    values |= {key: repr(Gap(key)) for key in MATRICES}

    def initialised(part: re.Match[str]) -> str:
        return f"{part['before']}{values[part['key']]};"

    arrays = rf"(?P<before>double (?P<key>{'|'.join(values)})\[.*? = )\{{.*?\}};"
    return {
        place: re.sub(f'(?<=dependencies="){every}(?=")', lambda _: repr(Gap(f"row {next(rows)}")), found[place]),
        tables: re.sub(arrays, initialised, found[tables], flags=re.DOTALL),
    }


def files() -> dict[str, Any]:
    """Of each kind of files, its name and type, and what is common to those of all models."""
    known = {kind: {"name": file.name, "type": file.type} for kind, file in FILES.items()}
    source = texts(realised(NOTHING.models["quarter"]), "", "", "")[SOURCE]
    return {**known, "lines": python_lines(), "road": road_call(), "source": {SOURCE: source}}


def curve() -> dict[str, Any]:
    """How a vehicle file holds a damper's curve, and how far beyond its knees."""
    own = damper(1.0, rebound=1.0, compression=1.0, knee=0.5, beyond=1.0)
    return {"entry": curve_entry(own), "further": across_step(own)}


def of_vehicle(vehicle: Vehicle) -> dict[str, Any]:
    """The files of one vehicle."""
    return {"toml": vehicle_file(vehicle), "call": vehicle_call(vehicle), "fmu": fmu(vehicle)}
