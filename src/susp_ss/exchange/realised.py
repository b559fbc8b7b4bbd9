"""A vehicle as other programs take it: matrices, and the name, unit and meaning of every signal."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..quantities import per_input, signal
from ..responses.excitation import check_kinds
from ..vehicles.contract import RoadVehicle
from ..vehicles.vehicle import Vehicle

Array = NDArray[np.float64]


class Signal(NamedTuple):
    """An input, a state or an output; a unit of no letters is not known."""

    name: str
    unit: str
    meaning: str


class Constant(NamedTuple):
    """A parameter of the vehicle and its value in SI units."""

    name: str
    unit: str
    meaning: str
    value: float


@dataclass(frozen=True, eq=False)
class Realised:
    """``x' = A x + B u``, ``y = C x + D u``, from ``x = rest u`` at the first ``u``.

    ``u`` are the heights of the road under the wheels, or their rates, where an output passes them straight on; then
    whatever else drives the vehicle.
    """

    A: Array
    B: Array
    C: Array
    D: Array
    rest: Array
    inputs: tuple[Signal, ...]
    states: tuple[Signal, ...]
    outputs: tuple[Signal, ...]
    constants: tuple[Constant, ...]


def realised(vehicle: RoadVehicle) -> Realised:
    """The matrices of a vehicle of one number for every parameter.

    Raises
    ------
    TypeError, ValueError
        No vehicle, several designs, or two signals of one name.
    """
    check_kinds(vehicle)
    model = vehicle.single("export()")
    layout = model.layout
    A, B, C, D, D1 = (x.reshape(x.shape[-2:]) for x in model.displacement_form())
    names = layout.states
    if by_rate := bool(np.any(D1)):
        A, B, C, D = (x.reshape(x.shape[-2:]) for x in model.velocity_form())
        names, rest = layout.relative_states, np.zeros(B.shape)
    else:
        rest = -np.linalg.solve(A, B)
    if layout.controls:
        B_u, D_u = (x.reshape(x.shape[-2:]) for x in model.controls())
        if not np.isfinite(B_u).all():
            raise ValueError(
                f"{type(vehicle).__name__}: without cornering stiffness, what it does when steered is not determined"
            )
        B, D = np.hstack([B, np.pad(B_u, [(0, len(A) - len(B_u)), (0, 0)])]), np.hstack([D, D_u])
        rest = np.pad(rest, [(0, 0), (0, len(layout.controls))])
    if not model.second_order:
        # What no output sees is left out of a state space, so that its own names need not fit.
        names = tuple(f"x_{i}" for i in range(1, len(A) + 1))
    found = Realised(
        A,
        B,
        C,
        D,
        rest,
        (*(_road(name, by_rate) for name in layout.inputs), *map(_control, layout.controls)),
        tuple(_state(name) for name in names),
        tuple(Signal(r.name, r.quantity.unit, _at(r.quantity.meaning, r.place)) for r in layout.outputs.rows),
        _constants(vehicle) if isinstance(vehicle, Vehicle) else (),
    )
    _check_names(found)
    return found


def _road(name: str, by_rate: bool) -> Signal:
    wheel = name.removeprefix("z_r").removeprefix("_")
    if by_rate:
        return Signal(f"d{name}", "m/s", _at("rate of the road's height", wheel))
    return Signal(name, "m", _at("road height", wheel))


def _control(name: str) -> Signal:
    kind, _, place = name.partition("_")
    return Signal(name, per_input(name), _at({"delta": "steering angle", "drive": "drive torque"}[kind], place))


def _at(meaning: str, place: str) -> str:
    return f"{meaning}, {place}" if place else meaning


# Coordinates are known by their symbols; others, of a vehicle of one's own, have no unit here.
LENGTH, ANGLES = "z", ("theta", "phi")


def _state(name: str) -> Signal:
    relative, rate = name.startswith("p_"), name.startswith("d")
    coordinate = name.removeprefix("p_").removeprefix("d")
    if name == "warp":
        return Signal(name, "m", "warp of the road under the wheels")
    unit = "m" if coordinate.startswith(LENGTH) else "rad" if coordinate.startswith(ANGLES) else ""
    meaning = f"rate of {coordinate}" if rate else f"{coordinate} relative to the road" if relative else coordinate
    return Signal(name, f"{unit}/s" if unit and rate else unit, meaning)


def _constants(vehicle: Vehicle) -> tuple[Constant, ...]:
    constants = []
    for name, quantity in vehicle.quantities().items():
        own = zip(vehicle.wheels, vehicle.at_wheels(name), strict=True)
        for wheel, value in own if name in vehicle.per_corner else [("", getattr(vehicle, name))]:
            if value is None:  # what a vehicle does without, such as compliant steering
                continue
            constants.append(Constant(signal(name, wheel), quantity.unit, _at(quantity.meaning, wheel), float(value)))
    return tuple(constants)


def _check_names(found: Realised) -> None:
    seen: set[str] = set()
    for kind in ("inputs", "outputs", "states", "constants"):
        for one in getattr(found, kind):
            if one.name in seen:
                raise ValueError(f"{kind}: another signal is named {one.name!r} as well; rename it")
            seen.add(one.name)
