"""Curves in vehicle files, where every value states its unit.

In place of one value, ``cs`` and ``ks`` may have::

    cs = { velocity = { value = [-0.5, 0.0, 0.5], unit = "m/s" }, force = { value = [-1.2, 0.0, 0.4], unit = "kN" } }
    cs = { csv = "damper.csv" }
    cs = { bump = 800, rebound = 2400, unit = "N s/m" }
    cs = { bump = 800, rebound = 2400, knee = { value = 0.2, unit = "m/s" }, final = 0.3, unit = "N s/m" }
    ks = { value = 18, stop = 150, bump = { value = 50, unit = "mm" }, rebound = { value = 60, unit = "mm" },
           unit = "kN/m" }
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

from ..quantities import PARAMETERS, briefly, units_of
from .curves import Curve, DamperCurve, SpringCurve
from .laws import Broken, Digressive

KINDS: dict[str, Any] = {"cs": DamperCurve, "ks": SpringCurve}

FORMS = {
    "cs": (("csv",), ("velocity", "force"), ("bump", "rebound"), ("bump", "rebound", "knee", "final")),
    "ks": (("csv",), ("deflection", "force"), ("value", "stop", "bump", "rebound")),
}
"""Keys of each form that a curve of a field may have in a file, beside its unit."""


def is_curve(field: str, entry: dict[str, Any]) -> bool:
    """Whether an entry of a file means a curve: it has some key that a number has not."""
    return bool({*entry} & {key for form in FORMS.get(field, ()) for key in form if key != "value"})


def curve_of(field: str, where: str, entry: dict[str, Any], folder: Path) -> Curve:
    """The curve of an entry, or a ValueError that names what is wrong with it; CSV files are sought in the folder."""
    keys = tuple(key for key in entry if key != "unit")
    form = next((form for form in FORMS[field] if {*form} == {*keys}), None)
    if form is None:
        forms = "; ".join(", ".join(form) for form in FORMS[field])
        raise ValueError(f"{where} must have value, or one of these: {forms}; got {', '.join(keys)}")
    kind, across = KINDS[field], KINDS[field].across
    if "csv" in form:
        if not isinstance(entry["csv"], str):
            raise ValueError(f"{where}.csv must be the name of a file, got {briefly(entry['csv'])}")
        return _said(where, kind.from_csv, folder / entry["csv"])
    if "force" in form:
        return _said(where, kind, *(_stated(f"{where}.{key}", entry[key], unit) for key, unit in _units(across)))
    rates = {key: entry[key] for key in form if key in (("bump", "rebound") if field == "cs" else ("value", "stop"))}
    factor = _factor(where, entry.get("unit"), PARAMETERS[field].unit)
    numbers = {key: file_number(f"{where}.{key}", rate) * factor for key, rate in rates.items()}
    if field == "ks":
        clearances = {key: _stated(f"{where}.{key}", entry[key], "m") for key in ("bump", "rebound")}
        return _said(where, SpringCurve.with_stops, ks=numbers["value"], stop=numbers["stop"], **clearances)
    if "knee" not in form:
        return _said(where, DamperCurve.two_slopes, **numbers)
    final = file_number(f"{where}.final", entry["final"])
    return _said(
        where, DamperCurve.digressive, **numbers, knee=_stated(f"{where}.knee", entry["knee"], "m/s"), final=final
    )


def curve_entry(curve: Curve) -> dict[str, Any]:
    """A curve of numbers as a file holds it.

    Raises
    ------
    ValueError
        It spans designs.
    """
    if not all(isinstance(leaf, float) for leaf in curve.leaves()):
        raise ValueError(f"a vehicle file needs one number for every parameter, got an array for {curve.field}")
    law, unit, across = curve.law, PARAMETERS[curve.field].unit, curve.across
    if isinstance(law, Digressive):
        knee = {"value": law.knee, "unit": across.unit}
        rates = {"bump": curve.factor * law.bump, "rebound": curve.factor * law.rebound}
        return {**rates, "knee": knee, "final": law.final, "unit": unit}
    assert isinstance(law, Broken)
    if curve.field == "cs" and law.kinks == (0.0,):
        rebound, bump = (float(curve.factor * slope) for slope in law.slopes)
        return {"bump": bump, "rebound": rebound, "unit": unit}
    first, *_, last = (0.0, *law.kinks, 0.0) if not law.kinks else law.kinks
    at = [min(first, 0.0) - across_step(curve), *law.kinks, max(last, 0.0) + across_step(curve)]
    forces = [float(curve.force(x)) for x in at]
    return {across.name: {"value": at, "unit": across.unit}, "force": {"value": forces, "unit": "N"}}


def across_step(curve: Curve) -> float:
    """How far beyond its last kink a table shows a curve."""
    return 5.0 * curve.middling


def toml(value: Any) -> str:
    """A value of an entry as TOML."""
    if isinstance(value, dict):
        return "{ " + ", ".join(f"{key} = {toml(part)}" for key, part in value.items()) + " }"
    if isinstance(value, list):
        return "[" + ", ".join(map(toml, value)) + "]"
    return f'"{value}"' if isinstance(value, str) else repr(value)


def file_number(where: str, value: Any) -> float:
    """A number of a file as a float, or a ValueError that names what is wrong with it."""
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        raise ValueError(f"{where} must be a number, got {briefly(value)}")
    try:
        return float(value)
    except OverflowError:
        raise ValueError(f"{where} must be a finite number, got one of {len(str(value))} digits") from None


def _units(across: Any) -> list[tuple[str, str]]:
    return [(across.name, across.unit), ("force", "N")]


def _stated(where: str, entry: Any, unit: str) -> Any:
    """A number, or a row of numbers, with its unit, in SI units."""
    if not isinstance(entry, dict) or {*entry} != {"value", "unit"}:
        raise ValueError(f'{where} must be {{ value = ..., unit = "{unit}" }}, got {briefly(entry)}')
    factor, value = _factor(where, entry["unit"], unit), entry["value"]
    if isinstance(value, list):
        return [file_number(f"{where}.value", part) * factor for part in value]
    return file_number(f"{where}.value", value) * factor


def _factor(where: str, unit: Any, si: str) -> float:
    units = units_of(si)
    if not isinstance(unit, str) or unit not in units:
        got = "none" if unit is None else briefly(unit)
        raise ValueError(f"{where}.unit must be one of {', '.join(units)}, got {got}")
    return units[unit]


def _said(where: str, make: Callable[..., Any], *given: Any, **named: Any) -> Any:
    try:
        return make(*given, **named)
    except (ValueError, TypeError) as error:
        raise ValueError(f"{where}: {error}") from None
