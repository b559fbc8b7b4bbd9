"""The signals of a system by their names: which inputs are the road under which wheel, and what each output is."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from ..quantities import ACTUATION, DIMS, METRICS, Quantity, briefly, signal
from .contract import RoadVehicle
from .full import FullCar
from .half import PitchHalfCar, RollHalfCar
from .linkage import Wheel
from .quarter import QuarterCar
from .second_order import Array, Row
from .vehicle import Vehicle

if TYPE_CHECKING:
    import control

HEIGHT, RATE = "z_r", "dz_r"

KNOWN_WHEELS = {frozenset(kind.wheels): kind.wheels for kind in (QuarterCar, PitchHalfCar, RollHalfCar, FullCar)}
"""Where wheels of these names run, as on the package's own vehicles."""


def check_system(system: Any) -> None:
    """Say what is no continuous state space with states, outputs and finite matrices."""
    import control

    where = "LinearVehicle(system=...)"
    if not isinstance(system, control.StateSpace):
        hint = ""
        if isinstance(system, control.TransferFunction):
            hint = "; pass control.ss(...) of it, with named inputs and outputs"
        elif isinstance(system, control.NonlinearIOSystem):
            hint = "; pass its .linearize(...)"
        raise TypeError(f"{where} must be a control.StateSpace, got {briefly(system)}{hint}")
    if system.isdtime(strict=True):
        raise ValueError(
            f"{where} must be in continuous time, got one of step {system.dt}; pass the system it came from"
        )
    if not system.nstates or not system.noutputs:
        raise ValueError(f"{where} needs states and outputs, got {system.nstates} states and {system.noutputs} outputs")
    for name in "ABCD":
        if not np.isfinite(getattr(system, name)).all():
            raise ValueError(f"{where} must be finite, got NaN or inf in {name}")


def road_inputs(inputs: Sequence[str]) -> tuple[bool, dict[str, int]]:
    """Whether the road comes as heights, and the number of the input of each wheel."""
    found = {
        stem: {
            name.removeprefix(stem).removeprefix("_"): i
            for i, name in enumerate(inputs)
            if name == stem or name.startswith(f"{stem}_")
        }
        for stem in (HEIGHT, RATE)
    }
    if bool(found[HEIGHT]) == bool(found[RATE]):
        need = "inputs z_r... (m) or dz_r... (m/s)" + (", one of both" if found[HEIGHT] else "")
        raise ValueError(f"LinearVehicle(system=...) needs {need}, got {', '.join(inputs) or 'none'}")
    return bool(found[HEIGHT]), found[HEIGHT] or found[RATE]


def checked_wheels(
    wheels: Mapping[str, tuple[int, int]] | None, driven: tuple[str, ...], axles: int = 2
) -> dict[str, Wheel]:
    """The wheels by name, each with an input of its own, on so many axles at most."""
    where = "LinearVehicle(wheels=...)"
    if wheels is None:
        if frozenset(driven) not in KNOWN_WHEELS:
            raise ValueError(
                f"{where} must say where the wheels {', '.join(driven)} run, such as wheels="
                f"{{{driven[0]!r}: (0, -1), ...}}: (axle, side), axle 0 in front, side -1 right and 1 left"
            )
        return dict(KNOWN_WHEELS[frozenset(driven)])
    if not isinstance(wheels, Mapping):
        raise TypeError(f'{where} must be a mapping such as {{"fr": (0, -1)}}, got {briefly(wheels)}')
    if set(wheels) != set(driven):
        raise ValueError(
            f"{where} and the inputs of the system must be of the same wheels, got {', '.join(wheels) or 'none'} and "
            f"inputs for {', '.join(driven)}"
        )
    checked = {}
    for name, place in wheels.items():
        if not (
            isinstance(place, Sequence) and len(place) == 2 and place[0] in range(axles) and place[1] in (-1, 0, 1)
        ):
            raise ValueError(
                f"{where}: {name!r} must be (axle, side) with axle 0 to {axles - 1} and side -1, 0 or 1, got "
                f"{briefly(place)}; three axles need wheelbase=(second, third)"
            )
        checked[name] = Wheel(int(place[0]), int(place[1]))
    return checked


def distances(wheelbase: Any) -> tuple[float, ...]:
    """How far each axle is behind the first, from the wheelbase or several, in m, or what is wrong with them."""
    if not isinstance(wheelbase, (tuple, list)):
        wheelbase = (wheelbase,)
    behind = [length("wheelbase", distance) for distance in wheelbase]
    if behind != sorted(behind):
        raise ValueError(f"LinearVehicle(wheelbase=...) must ascend from axle to axle, got {briefly(wheelbase)}")
    return (0.0, *behind)


def length(name: str, value: Any) -> float:
    """A wheelbase or track width in m, or what is wrong with it."""
    if isinstance(value, bool) or not isinstance(value, (int, float, np.integer, np.floating)):
        raise TypeError(f"LinearVehicle({name}=...) must be one number >= 0 m, got {briefly(value)}")
    if not (np.isfinite(value) and value >= 0.0):
        raise ValueError(f"LinearVehicle({name}=...) must be finite and >= 0 m, got {briefly(value)}")
    return float(value)


def output_table(
    outputs: Sequence[str], wheels: Mapping[str, Wheel], like: RoadVehicle | None
) -> tuple[tuple[Row, ...], Array]:
    """What each output is, and the damping rates that damper powers are made of."""
    known = {row.name: row for row in like.layout().outputs.rows} if like is not None else {}
    rates = [signal("sws_rate", wheel) for wheel in wheels]
    damping = np.zeros(0)
    if like is not None and set(rates) <= set(outputs):
        damping = like.damping()
    rows = []
    for name in outputs:
        row = known.get(name) or _row(name)
        if row.quantity.name in DIMS:
            raise ValueError(f"LinearVehicle(system=...) has an output named {name!r}, which results use; rename it")
        rows.append(row._replace(public=True))
    variables: dict[str, set[str]] = {}
    for row in rows:
        variables.setdefault(row.quantity.name, set()).add(row.place)
    for name, places in variables.items():
        if "" in places and len(places) > 1:
            other = signal(name, max(places))
            raise ValueError(
                f"LinearVehicle(system=...) has outputs {name!r} and {other!r}; give both a place, or neither"
            )
    return tuple(rows), damping


def _row(name: str) -> Row:
    """An output by its name alone: one of the package's at a place, or one of its own."""
    known = METRICS | ACTUATION
    for stem in sorted(known, key=len, reverse=True):
        quantity = known[stem]
        if quantity.statistic == "RMS" and (name == stem or (quantity.dim and name.startswith(f"{stem}_"))):
            return Row(quantity, name.removeprefix(stem).removeprefix("_"), True)
    return Row(Quantity(name, "", name), "", True)


def named_like(system: control.StateSpace, like: RoadVehicle) -> control.StateSpace:
    """A system that lost its names, with those of the vehicle whose loop was closed."""
    import control

    generic = [f"u[{i}]" for i in range(system.ninputs)]
    if system.input_labels != generic or not isinstance(like, Vehicle):
        return system
    shape, fitting = (system.noutputs, system.ninputs), []
    for form in ("displacement", "velocity"):
        for actuators in (False, True):
            try:
                own = like.state_space(form, actuators)
            except ValueError:
                continue
            if (own.noutputs, own.ninputs) == shape:
                fitting.append(own)
    if not fitting:
        raise ValueError(
            f"LinearVehicle(system=...) has no names, and {shape[0]} outputs from {shape[1]} inputs are not those of a "
            f"loop closed around {type(like).__name__}'s state_space(); name them, control.ss(..., inputs=, outputs=)"
        )
    # Where both forms exist, tyres pass heights straight on to their loads and rates not at all, whatever actuators do.
    loads = [name.startswith("dtl") for name in fitting[0].output_labels]
    own = min(fitting, key=lambda own: np.abs(system.D - own.D)[loads, : len(like.wheels)].max())
    same = system.nstates == own.nstates
    return control.ss(
        system.A,
        system.B,
        system.C,
        system.D,
        inputs=own.input_labels,
        outputs=own.output_labels,
        states=own.state_labels if same else system.state_labels,
    )
