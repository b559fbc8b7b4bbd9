"""A car that moves as the engine in JavaScript knows it: its forces and masses, traced with `symbols`, by halves.

Left and right are alike on the page, so that everything falls apart into what both sides do together and what they do
against one another; `Assembly` says all of it before anything is solved for.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..quantities import signal
from ..roads.road import Road
from ..vehicles.handling_assembly import Assembly
from ..vehicles.handling_model import LASTING, NAMED, OVER_CRITICAL
from ..vehicles.ride_handling import LACKING, RideHandlingCar
from ..vehicles.vehicle import joined
from .described import drifting, placed
from .motion import motion_of
from .symbols import Lines

AGAINST = ("phi", "y", "psi")
"""Motions of the body that left and right have against one another."""


def words() -> dict[str, str]:
    """What is said of cars that are refused, with names in place of numbers."""
    kind = RideHandlingCar.__name__
    return {
        "izz": f"{kind}{LACKING}",
        "critical": f"{kind} {OVER_CRITICAL}",
        "lasting": f"{kind} {LASTING}",
        "parting": drifting(RideHandlingCar(), Road(tracks="independent")),
    }


def moving(vehicle: RideHandlingCar) -> str:
    """A function of JavaScript that makes a car's matrices of parameters at every wheel, ``p.ks_fr``, and its speed.

    Where an axle has a relaxation length, there are states that lag behind: each case is a function of its own.
    """
    cases = [_assembled(vehicle, front, rear) for rear in (False, True) for front in (False, True)]
    chosen = "(p) => cases[(p.relaxation_fr > 0) + 2 * (p.relaxation_rr > 0)](p)"
    return f"((cases) => {chosen})([{', '.join(cases)}])"


def _assembled(vehicle: RideHandlingCar, front: bool, rear: bool) -> str:
    lines = Lines()
    car = _traced(vehicle, lines, front, rear)
    own = Assembly(car)
    return lines.function(
        {
            "halves": _halves(vehicle, own),
            "on_road_velocity": own.outputs()[2][0],
            "resting": own.transferred(own.ride.elongation)[0] @ own.ride.N,
            "integrators": own.ride.integrators,
            "damping": own.ride.damping,
            "carcass": own.carcass()[0],
            "gradient": car.gradient(),
            "least_izz": car.least_izz,
            "track_width": car.track_width,
            "behind": list(car.axles),
        }
    )


def _traced(vehicle: RideHandlingCar, lines: Lines, front: bool, rear: bool) -> Any:
    """The car with parameters that write down what is done with them, those of its right wheels on both sides."""
    kind = type(vehicle)
    car: Any = object.__new__(kind)
    for field in kind.quantities():
        value: Any = None
        if field in kind.per_corner:
            right: list[Any] = [lines.given(f"p.{signal(field, wheel)}") for wheel in ("fr", "rr")]
            if field == "relaxation":
                right = [own if late else 0.0 for own, late in zip(right, (front, rear), strict=True)]
            value = joined(dict(zip(kind.wheels, np.repeat(np.array(right, dtype=object), 2), strict=True)))
        elif getattr(vehicle, field) is not None:
            value = lines.given(f"p.{field}")
        object.__setattr__(car, field, value)
    return car


def _halves(vehicle: RideHandlingCar, own: Assembly) -> list[dict[str, Any]]:
    """What both sides do together, and what they do against one another."""
    ride, names = own.ride, own.rows.names
    positions, at_wheels = names[: own.positions], tuple(own.wheels)
    slips = [f"slip_{wheel}" for wheel in at_wheels]
    lags = [f"late_{wheel}" for wheel, late in zip(at_wheels, own.lagging, strict=True) if late]
    states = [*positions, *(f"d{name}" for name in positions), "y", "psi", *slips, *lags]
    paths = {motion_of(vehicle, name)[1]: i for i, name in enumerate(positions)}
    shown = [paths[tuple(at) if at[0] == "wheels" else (at[-1],)] for _, at in placed(vehicle)]
    leaning = np.where(np.array(positions) == "phi", own.leaning[0], 0.0)
    stretch = own.transferred(ride.elongation)[0] @ ride.R
    (forces, _), (lag, _), (acceleration, felt, _, _) = own.forces(), own.lag(), own.outputs()
    return [
        {
            "M": V.T @ own.M[0] @ V,
            "K": P.T @ own.K[0] @ P,
            "K_ride": P.T @ ride.K @ P,
            "lean": P.T @ leaning,
            "forces": V.T @ forces[0] @ S,
            "K_in": P.T @ ride.K_in,
            "C_in": P.T @ ride.C_in,
            "slips": inverse(slid) @ own.forms[1][0] @ V,
            "lag": inverse(late) @ lag[0] @ S,
            "acceleration": acceleration[0] @ V,
            "felt": felt[0] @ S,
            "stretch": stretch @ P,
            "places": np.eye(len(positions))[shown] @ P,
            "motions": V,
            "lags": late,
        }
        for P, V, S, slid, late in zip(*map(split, (positions, names, states, slips, lags)), strict=True)
    ]


def said(vehicle: RideHandlingCar) -> dict[str, Any]:
    """What the engine says of a car that moves beyond what it says of any."""
    rows, names = vehicle.velocities(), vehicle.layout().outputs.names
    against = [name for name in rows.names[: len(rows.positions)] if name in AGAINST or name.endswith("r")]
    return {
        "moves": True,
        "motion_slots": [NAMED[name] for name in rows.names],
        "roll": {"row": names.index("roll"), "at": against.index("phi")},
    }


def split(names: Sequence[str]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """What left and right do together and against one another, as columns over some motions.

    A tyre that lags behind slips to the same side on the left and on the right where the body moves sideways.

    Examples
    --------
    >>> from susp_ss.explorer.moving import split
    >>> together, against = split(["z_u_fr", "z_u_fl", "phi"])
    >>> together.T.tolist(), against.T.tolist()
    ([[1.0, 1.0, 0.0]], [[-1.0, 1.0, 0.0], [0.0, 0.0, 1.0]])
    """
    even, odd = list[NDArray[np.float64]](), list[NDArray[np.float64]]()
    for i, name in enumerate(names):
        column = np.zeros(len(names))
        column[i] = 1.0
        if not name.endswith(("_fr", "_fl", "_rr", "_rl")):
            (odd if name.removeprefix("d") in AGAINST else even).append(column)
        elif name.endswith("r"):
            column[names.index(f"{name[:-1]}l")] = 1.0
            other = column.copy()
            other[i] = -1.0
            some = (other, column) if name.startswith("late") else (column, other)
            even.append(some[0])
            odd.append(some[1])
    together, against = (np.array(half).reshape(len(half), len(names)).T for half in (even, odd))
    return together, against


def inverse(columns: NDArray[np.float64]) -> NDArray[np.float64]:
    """Rows that find what columns without a common row are taken by."""
    return np.asarray(columns.T / (columns**2).sum(axis=0)[:, None])
