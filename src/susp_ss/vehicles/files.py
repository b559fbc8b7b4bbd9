"""Vehicles from TOML files in which every value states its unit.

A file names its model and, in the table ``parameters``, as many of the model's fields as it likes; the others keep
their defaults::

    model = "full"

    [parameters]
    mb = { value = 1.31, unit = "t" }
    ks = { fr = 18.0, fl = 18.0, rr = 21.0, rl = 21.0, unit = "kN/m" }

    [seats.driver]
    x = { value = 0.3, unit = "m" }
    y = { value = 0.4, unit = "m" }

Each table under ``seats``, of which there may be none, is a `Seat` by its name.
"""

from __future__ import annotations

import codecs
import functools
import importlib
import re
import tomllib
from os import PathLike
from pathlib import Path
from typing import Any

from ..quantities import Quantity, briefly, units_of
from ..units import Stated, factor_of, implausible
from . import MODELS
from .curve_files import KINDS, curve_entry, curve_of, file_number, is_curve, toml
from .curves import Curve
from .parameters import Corners
from .seats import Seat, field_of
from .vehicle import Vehicle


@functools.cache
def models() -> dict[str, type[Vehicle]]:
    """Every vehicle by its name in files and on the command line.

    Examples
    --------
    >>> from susp_ss.vehicles.files import models
    >>> list(models())
    ['full', 'quarter', 'quarter-seat', 'rigid-tyre', 'pitch-half', 'roll-half', 'ride-handling', 'three-axle']
    """
    places = {name: place.partition(".") for name, place in MODELS.items()}
    return {
        name: getattr(importlib.import_module(f".{module}", __package__), kind)
        for name, (module, _, kind) in places.items()
    }


def model_named(name: str) -> type[Vehicle]:
    """Return the vehicle class of a model's name.

    Raises
    ------
    ValueError
        No such model.

    Examples
    --------
    >>> from susp_ss.vehicles.files import model_named
    >>> model_named("pitch-half").__name__
    'PitchHalfCar'
    """
    if not isinstance(name, str) or name not in MODELS:
        raise ValueError(f"no model named {name!r}, available: {', '.join(MODELS)}")
    return models()[name]


def model_name(vehicle: Vehicle) -> str:
    """Return the name of a vehicle's model.

    Raises
    ------
    ValueError
        No file can hold a vehicle of that kind.

    Examples
    --------
    >>> from susp_ss import RollHalfCar
    >>> from susp_ss.vehicles.files import model_name
    >>> model_name(RollHalfCar())
    'roll-half'
    """
    if not in_file(vehicle):
        raise ValueError(f"a file holds one of {', '.join(MODELS)}, got a {type(vehicle).__name__}")
    return {car: name for name, car in models().items()}[_plain(vehicle)]


def in_file(vehicle: Vehicle) -> bool:
    """Whether a file can hold a vehicle of that kind.

    Examples
    --------
    >>> from susp_ss import FullCar, Seat
    >>> from susp_ss.vehicles.files import in_file
    >>> in_file(FullCar().with_seats({"driver": Seat()})), in_file(FullCar().with_points({"driver": (0.3, 0.4)}))
    (True, False)
    """
    return _plain(vehicle) in models().values()


def _plain(vehicle: Vehicle) -> type[Vehicle]:
    """The kind of a vehicle without its seats."""
    kind: type[Vehicle] = getattr(type(vehicle), "plain", type(vehicle))
    return kind


def read_vehicle(path: str | PathLike[str], trust_units: bool = False) -> Vehicle:
    """Read a vehicle file.

    Parameters
    ----------
    path : path
        A TOML file: ``model``, and the table ``parameters`` with ``{ value = ..., unit = "..." }`` for each field, or
        one value a corner in place of ``value`` (fr, fl, rr, rl; f, r; or r, l). Fields left out keep their
        defaults. In place of a value, ``cs`` and ``ks`` may have a curve: ``{ csv = "damper.csv" }``,
        ``{ bump = 800, rebound = 2400, unit = "N s/m" }`` and others (`susp_ss.vehicles.curve_files`).
        ``seats.driver`` and the like are tables of a `Seat` each. `susp_ss.quantities.UNITS` lists the units.
    trust_units : bool
        Take values that are far from any road vehicle's, which a mistaken unit would give.

    Returns
    -------
    Vehicle

    Raises
    ------
    OSError
        The file cannot be read.
    ValueError
        The file is not TOML (with line and column), or has an unknown key, model, corner or unit, a missing one, or a
        value that the vehicle refuses or that no road vehicle has. Every message begins with the file's name.

    Examples
    --------
    >>> import pathlib, tempfile
    >>> from susp_ss.vehicles.files import read_vehicle
    >>> path = pathlib.Path(tempfile.mkdtemp(), "car.toml")
    >>> _ = path.write_text('model = "quarter"\\n[parameters]\\nks = { value = 20.0, unit = "N/mm" }\\n')
    >>> read_vehicle(path).ks
    20000.0
    """
    table = _toml(Path(path))
    try:
        return vehicle_of(table, trust_units, Path(path).parent)
    except (ValueError, TypeError) as error:
        # In a file a parameter is known by its name alone.
        said = re.sub(r"\w+\((\w+)=[.]{3}\)", r"\1", str(error))
        raise ValueError(f"{path}: {said}") from error


def vehicle_text(vehicle: Vehicle) -> str:
    """Write a vehicle of one number for every parameter as a vehicle file, for `read_vehicle`.

    Raises
    ------
    ValueError
        A parameter is an array.

    Examples
    --------
    >>> from susp_ss import RigidTyreQuarterCar
    >>> from susp_ss.vehicles.files import vehicle_text
    >>> print(vehicle_text(RigidTyreQuarterCar(ks=20e3)))
    # A vehicle for susp-ss. Every value states its unit; a parameter that is left out keeps its default.
    # Units: kg, t, lb; N/m, N/mm, kN/m, lbf/in; N s/m, N s/mm, kN s/m, lbf s/in.
    model = "rigid-tyre"
    <BLANKLINE>
    [parameters]
    ms = { value = 317.5, unit = "kg" }  # sprung mass, > 0
    ks = { value = 20000.0, unit = "N/m" }  # spring stiffness, > 0
    cs = { value = 1516.5, unit = "N s/m" }  # damping rate, >= 0
    """
    quantities = vehicle.quantities()
    known = dict.fromkeys(quantity.unit for quantity in quantities.values())
    lines = [
        "# A vehicle for susp-ss. Every value states its unit; a parameter that is left out keeps its default.",
        f"# Units: {'; '.join(', '.join(units_of(unit)) for unit in known)}.",
    ]
    if vehicle.per_corner:
        values = ", ".join(f"{wheel} = 18.5" for wheel in vehicle.wheels)
        lines += [
            f"# {', '.join(vehicle.per_corner)} may have a value for each wheel in place of one for all:",
            f'# ks = {{ {values}, unit = "kN/m" }}',
        ]
    table = vehicle_table(vehicle)
    lines += [f'model = "{table["model"]}"', "", "[parameters]"]
    for name in models()[table["model"]].quantities():
        lines.append(_line(name, table["parameters"].get(name), quantities[name]))
    for name, seat in table.get("seats", {}).items():
        lines += ["", f"[seats.{name}]"]
        lines += [_line(of, parts, Seat.quantities()[of]) for of, parts in seat.items()]
    return "\n".join(lines)


def _line(name: str, parts: dict[str, Any] | None, quantity: Quantity) -> str:
    said = ", ".join(word for word in (quantity.meaning, quantity.bound) if word)
    if parts is None:
        return f'# {name} = {{ value = ..., unit = "{quantity.unit}" }}  # {said}; none'
    return f"{name} = {toml(parts)}  # {said}"


def vehicle_table(vehicle: Vehicle) -> dict[str, Any]:
    """Model, parameters and seats of a vehicle, laid out as in a vehicle file.

    Raises
    ------
    ValueError
        A parameter is an array.
    """
    model = model_name(vehicle)
    own = [name for name in models()[model].quantities() if getattr(vehicle, name) is not None]
    table: dict[str, Any] = {
        "model": model,
        "parameters": {name: entry(vehicle, name) for name in own},
    }
    if vehicle.seats:
        fields = {seat: {of: field_of(of, seat) for of in Seat.quantities()} for seat in vehicle.seats}
        table["seats"] = {
            seat: {of: entry(vehicle, name) for of, name in own.items() if hasattr(vehicle, name)}
            for seat, own in fields.items()
        }
    return table


def entry(vehicle: Vehicle, name: str) -> dict[str, Any]:
    """One parameter as a vehicle file holds it: its value, or its value at each wheel, and its unit, or its curve."""
    value = getattr(vehicle, name)
    if isinstance(value, Curve):
        return curve_entry(value)
    at_wheels = isinstance(value, (Corners, tuple))
    parts = dict(zip(vehicle.wheels, value, strict=True)) if at_wheels else {"value": value}
    parts = {key: curve_entry(part) if isinstance(part, Curve) else part for key, part in parts.items()}
    if not all(isinstance(part, (float, dict)) for part in parts.values()):
        raise ValueError(f"a vehicle file needs one number for every parameter, got an array for {name}")
    return {**parts, "unit": vehicle.quantities()[name].unit}


def utf8_text(path: Path) -> str:
    """The text of a file, without the mark that some editors begin with, or a ValueError with line and column."""
    raw = path.read_bytes().removeprefix(codecs.BOM_UTF8)
    if raw.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)):
        raise ValueError(f'{path}: UTF-16 text (as "Unicode" in some programs); save it as UTF-8')
    try:
        return raw.decode()
    except UnicodeDecodeError as error:
        before = raw[: error.start]
        line, column = before.count(b"\n") + 1, error.start - before.rfind(b"\n")
        raise ValueError(f"{path}: not UTF-8 text (at line {line}, column {column})") from None


def _toml(path: Path) -> dict[str, Any]:
    text = utf8_text(path)
    try:
        return tomllib.loads(text)
    # Not every failure of the parser is its own: numbers of too many digits, values nested too deeply.
    except (ValueError, RecursionError) as error:
        place = re.search(r"at line (\d+)", str(error))
        comma = re.search(r"=\s*([+-]?\d+),(\d+)", text.splitlines()[int(place[1]) - 1]) if place else None
        hint = f"; a decimal comma? write {comma[1]}.{comma[2]}" if comma else ""
        raise ValueError(f"{path}: not TOML: {error}{hint}") from None


def vehicle_of(table: dict[str, Any], trust_units: bool = False, folder: Path = Path()) -> Vehicle:
    """Make the vehicle of a table laid out as in a vehicle file, or say in a ValueError what is wrong with it.

    Tables that it names are sought in the folder.
    """
    _refuse_unknown("key", table, ("model", "parameters", "seats"), "")
    if "model" not in table:
        raise ValueError(f'model is missing; write model = "full", or one of {", ".join(MODELS)}')
    car = model_named(table["model"])
    wheels = dict.fromkeys(car.per_corner, tuple(car.wheels))
    parameters = table.get("parameters", {})
    of = f" of the model {table['model']!r}"
    vehicle = car(**_values("parameters", parameters, car.quantities(), wheels, of, trust_units, folder))
    seats = table.get("seats", {})
    if not isinstance(seats, dict):
        raise ValueError(f"seats must be tables, [seats.driver], got {briefly(seats)}")
    own = {
        name: Seat(
            **_values(f"seats.{name}", seat, Seat.quantities(), {}, f" of the seat {name!r}", trust_units, folder)
        )
        for name, seat in seats.items()
    }
    return vehicle.with_seats(own) if own else vehicle


def _values(
    where: str,
    table: Any,
    quantities: dict[str, Quantity],
    wheels: dict[str, tuple[str, ...]],
    of: str,
    trust_units: bool,
    folder: Path,
) -> dict[str, Any]:
    """The values of a table by name, in SI units; those that wheels may have for themselves perhaps for each."""
    if not isinstance(table, dict):
        raise ValueError(f"{where} must be a table, [{where}], got {briefly(table)}")
    _refuse_unknown("parameter", table, tuple(quantities), of)
    return {
        name: _value(name, entry, quantities[name], wheels.get(name, ()), trust_units, folder)
        for name, entry in table.items()
    }


def _value(name: str, entry: Any, quantity: Quantity, wheels: tuple[str, ...], trust_units: bool, folder: Path) -> Any:
    own, units = quantity.unit, units_of(quantity.unit)
    if not isinstance(entry, dict):
        raise ValueError(
            f'{name} must state its unit, {name} = {{ value = ..., unit = "{own}" }}, got {briefly(entry)}'
        )
    if is_curve(name, entry):
        return curve_of(name, name, entry, folder)
    _refuse_unknown("key", entry, ("value", *wheels, "unit"), f" of {name}")
    if name in KINDS and all(isinstance(entry.get(wheel), dict) for wheel in wheels or ("value",)):
        entry = {**entry, "unit": entry.get("unit", own)}
    unit = entry.get("unit")
    factor = factor_of(unit, quantity) if isinstance(unit, str) else None
    if not isinstance(unit, str) or factor is None:
        got = f", got {briefly(unit)}" if "unit" in entry else ", got none"
        raise ValueError(f"{name}.unit must be one of {', '.join(units)}{got}")

    def number(key: str) -> Any:
        where = f"{name}.{key}"
        if name in KINDS and isinstance(entry[key], dict):
            return curve_of(name, where, entry[key], folder)
        value = file_number(where, entry[key])
        far = "" if trust_units else implausible(Stated(value, unit), quantity)
        if far:
            raise ValueError(f"{where}: {far} State the unit, or trust the units as they are (--trust-units)")
        return value * factor

    keys = [key for key in entry if key != "unit"]
    if keys == ["value"]:
        return number("value")
    if not keys or set(keys) != set(wheels):
        need = "value" + (f", or a value for each of {', '.join(wheels)}" if wheels else "")
        raise ValueError(f"{name} must have {need}, got {', '.join(keys) or 'none'}")
    values = {wheel: number(wheel) for wheel in wheels}
    return Corners(**values) if len(wheels) == 4 else tuple(values.values())


def _refuse_unknown(kind: str, table: dict[str, Any], known: tuple[str, ...], of: str) -> None:
    for key in table:
        if key not in known:
            raise ValueError(f"no {kind}{of} named {key!r}, available: {', '.join(known)}")
