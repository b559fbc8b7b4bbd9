"""What to type to get a result again."""

from __future__ import annotations

import dataclasses
from typing import Any

import numpy as np

from ..fit.fitting import Fit
from ..metrics.weightings import filter_of
from ..roads.road import Road
from ..roads.road_fit import unfitted
from ..study.feasibility import Study
from ..vehicles.curve_files import curve_entry
from ..vehicles.curves import Curve
from ..vehicles.parameters import Corners
from ..vehicles.seats import Seat, field_of
from ..vehicles.vehicle import Vehicle


def study_code(study: Study) -> str:
    """Python that runs a study again.

    Examples
    --------
    >>> import susp_ss as ss
    >>> from susp_ss.presentation.reproduction import study_code
    >>> print(study_code(ss.feasibility_study(nodes=(3, 3))))
    import susp_ss as ss
    <BLANKLINE>
    study = ss.feasibility_study(
        road=ss.Road(
            roughness=6.4e-05,
            speed=20.0,
            waviness=2.0,
            tracks='isotropic',
            delay=True,
        ),
        corner='fr',
        nodes=(3, 3),
        nonnegative=False,
    )
    ss.save(study, 'results')
    """
    asked = {"road": study.road, "corner": study.corner, "nodes": study.nodes, "nonnegative": study.nonnegative}
    if not study.as_published:
        ranges = {name: tuple(study.responses[name].values[[0, -1]].tolist()) for name in ("ks", "cs")}
        asked |= {"vehicle": study.vehicle, "low_fidelity": study.low_fidelity, **ranges}
    return "\n".join(
        ["import susp_ss as ss", "", f"study = {_call('feasibility_study', asked)}", "ss.save(study, 'results')"]
    )


def study_command(study: Study) -> str | None:
    r"""The command that runs a study again, if the command line can: it knows square grids, and cars from files.

    Examples
    --------
    >>> import susp_ss as ss
    >>> from susp_ss.presentation.reproduction import study_command
    >>> print(study_command(ss.feasibility_study(nodes=(3, 3))))
    susp-ss study --roughness 6.4e-05 --speed 20.0 \
        --waviness 2.0 --cutoff 0.0 \
        --tracks isotropic --delay \
        --corner fr --nodes 3 --free \
        --out results
    """
    road, (springs, dampers) = unfitted(study.road), study.nodes
    if springs != dampers or not study.as_published or type(road) is not Road or len(road.table) > 1:
        return None
    wheels = "" if road.wheels is None else f" --wheels {','.join(road.wheels)}"
    return " \\\n    ".join(
        [
            f"susp-ss study --roughness {road.roughness!r} --speed {road.speed!r}",
            f"{_surface(road)} --cutoff {road.cutoff!r}",
            f"--tracks {road.tracks} --{'' if road.delay else 'no-'}delay{wheels}",
            f"--corner {study.corner} --nodes {springs} --{'nonnegative' if study.nonnegative else 'free'}",
            "--out results",
        ]
    )


def _surface(road: Road) -> str:
    contact = f" --contact-length {road.contact_length!r}" if road.contact_length else ""
    if not road.table:
        return f"--waviness {road.waviness!r}{contact}"
    below, above = road.slopes
    return f"--waviness {below!r}:{above!r} --knee {road.table[0][0]!r}{contact}"


def fit_code(fit: Fit) -> str:
    """Python that makes a fit again from the same file."""
    made = [f"runs = {_call(*fit.runs.read)}", f"cheap = {code(fit.low_fidelity)}"]
    own_filter = any("control.tf(" in line for line in made)
    return "\n".join(
        [
            *(["import control"] if own_filter else []),
            "import susp_ss as ss\n",
            *made,
            f"fit = ss.fit_runs(runs, cheap, {', '.join(f'{name}={value!r}' for name, value in fit.asked.items())})",
            "ss.save(fit, 'fit')",
        ]
    )


def code(value: Any) -> str:
    """Python that makes a vehicle, a road or what they are made of.

    Examples
    --------
    >>> import susp_ss as ss
    >>> from susp_ss.presentation.reproduction import code
    >>> print(code(ss.RigidTyreQuarterCar(cs=ss.DamperCurve.two_slopes(bump=800.0, rebound=2400.0))))
    ss.RigidTyreQuarterCar(
        ms=317.5,
        ks=18553.0,
        cs=ss.DamperCurve.two_slopes(
            bump=800.0,
            rebound=2400.0,
        ),
    )
    """
    if isinstance(value, Curve):
        return _curve_code(value)
    if isinstance(value, Vehicle) and hasattr(value, "plain"):
        return _seated_code(value)
    if isinstance(value, Corners):
        return _corners_code(value)
    if isinstance(value, tuple) and any(isinstance(part, Curve) for part in value):
        return f"({', '.join(map(code, value))})"
    if dataclasses.is_dataclass(value):
        return _call(type(value).__name__, _told(value, type(value)))
    if hasattr(value, "ninputs"):
        own = filter_of(value, "weighting")
        return f"control.tf({own.numerator.tolist()!r}, {own.denominator.tolist()!r})"
    return repr(value.tolist() if isinstance(value, (np.ndarray, np.generic)) else value)


def _call(name: str, arguments: dict[str, Any]) -> str:
    lines = [f"    {key}={code(value)},".replace("\n", "\n    ") for key, value in arguments.items()]
    return "\n".join([f"ss.{name}(", *lines, ")"])


def _told(value: Any, kind: type) -> dict[str, Any]:
    """The fields of a kind; what is nothing, and is so by default, goes without saying."""
    defaults = {field.name: field.default for field in dataclasses.fields(kind)}
    own = {name: getattr(value, name) for name in defaults}
    return {name: x for name, x in own.items() if x or defaults[name]}


def _corners_code(corners: Corners) -> str:
    """Corners, of which what is alike is said once."""
    told = {name: code(value) for name, value in zip(Corners.__dataclass_fields__, corners, strict=True)}
    if len(set(told.values())) == 1:
        return told["fr"]
    if told["fr"] == told["fl"] and told["rr"] == told["rl"]:
        return _call("Corners.axles", {"front": corners.fr, "rear": corners.rr})
    return _call("Corners", _told(corners, Corners))


def _curve_code(curve: Curve) -> str:
    """A curve of numbers by the form in which a vehicle file holds it."""
    entry = curve_entry(curve)
    numbers = {key: part["value"] if isinstance(part, dict) else part for key, part in entry.items() if key != "unit"}
    form = "" if "force" in numbers else ".digressive" if "knee" in numbers else ".two_slopes"
    return _call(f"{type(curve).__name__}{form}", numbers)


def _seated_code(vehicle: Any) -> str:
    fields = {seat: {of: field_of(of, seat) for of in Seat.quantities()} for seat in vehicle.seats}
    seats = (
        f"{seat!r}: "
        + _call("Seat", {of: getattr(vehicle, name) for of, name in own.items() if hasattr(vehicle, name)})
        for seat, own in fields.items()
    )
    car = _call(vehicle.plain.__name__, _told(vehicle, vehicle.plain))
    return f"{car}.with_seats({{{', '.join(seats)}}})"
