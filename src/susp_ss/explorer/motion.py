"""How body, wheels and seats move: in each mode, and over a bump."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..responses.meeting import way_along
from ..responses.positions import with_positions
from ..responses.simulation import histories
from ..roads.obstacles import outline
from ..vehicles.contract import Model, RoadVehicle
from ..vehicles.vehicle import Vehicle
from .rows import finite
from .seat import DRIVER

BODY = {"z_b": "heave", "z_s": "heave", "theta": "pitch", "phi": "roll"}

AXLES = ("front hop", "middle hop", "rear hop")

# Of the drive over a bump: seconds before and after its begin, about how many instants are shown, the longest step in
# s, and how many steps there are at least on the bump.
BEFORE, AFTER, SHOWN, STEP, OVER = 0.2, 1.8, 200, 0.005, 12

# Steps of a vehicle with curves times its fastest swing: the picture is then off by less than a hundredth.
RESOLVED = 0.5


def modes(vehicle: RoadVehicle, model: Model) -> list[dict[str, Any]]:
    """Every mode that swings body, wheels or seats up and down, slowest first.

    Its name is the motion that has the most of its kinetic energy, no motion of the body being named twice. Shapes are
    complex amplitudes ``[re, im]``, m and rad, in proportion.
    """
    if not isinstance(vehicle, Vehicle):
        return []
    motions = {name: motion_of(vehicle, name) for name in vehicle.layout().coordinates}
    words, known = [word for word, _ in motions.values()], model.modes()
    names = known.motions
    if names is None:
        masses = np.array([*vehicle.linkage().masses.values()])
        names = _names(np.abs(known.shapes.T) ** 2 * masses, words)
    amplitudes = known.shapes[[known.names.index(name) for name in motions]]
    parts = finite(np.stack([amplitudes.real, amplitudes.imag], axis=-1).swapaxes(0, 1))
    each = zip(names, finite(known.frequency), finite(known.damping_ratio), parts, strict=True)
    return [
        {"name": name, "frequency": frequency, "damping": damping, "shape": _shape(shape, motions)}
        for name, frequency, damping, shape in each
        if name in words
    ]


def motion_of(vehicle: Vehicle, coordinate: str) -> tuple[str, tuple[str, ...]]:
    """The motion that a coordinate is a part of, and where it stands in a shape."""
    if coordinate in BODY:
        return BODY[coordinate], (BODY[coordinate],)
    stem, _, place = coordinate.removeprefix("z_").partition("_")
    if stem == "seat":
        return "seat", ("seats", place or DRIVER)
    last = len(vehicle.axles) - 1
    axle = vehicle.wheels[place].axle
    return "hop" if last == 0 else AXLES[2 if axle == last else axle], ("wheels", place)


def _names(energies: NDArray[np.float64], motions: list[str]) -> tuple[str, ...]:
    """For each mode, of kinetic energies (modes, coordinates), the motion of the coordinate that is most its own."""
    from scipy.optimize import linear_sum_assignment

    shares = energies / energies.sum(axis=1, keepdims=True)
    own = dict(zip(*linear_sum_assignment(shares, maximize=True), strict=True))
    return tuple(motions[own.get(mode, int(share.argmax()))] for mode, share in enumerate(shares))


def _shape(amplitudes: list[list[float]], motions: dict[str, tuple[str, tuple[str, ...]]]) -> dict[str, Any]:
    shape: dict[str, Any] = {"wheels": {}, "seats": {}}
    for value, (_, (first, *rest)) in zip(amplitudes, motions.values(), strict=True):
        if rest:
            shape[first][rest[0]] = value
        else:
            shape[first] = value
    return shape


def bump(vehicle: RoadVehicle, model: Model | None, height: float, length: float, speed: float) -> dict[str, Any]:
    """Where body, wheels and road are while a vehicle drives over a bump on both tracks, and what its body feels.

    ``t`` in s and the place ``x`` of the first axle in m, both from the begin of the bump; heights in m and angles in
    rad from level ground; ``acceleration`` in m/s^2 where the body's is measured first. ``model`` is the vehicle's at
    that speed, if it is known.
    """
    known = isinstance(vehicle, Vehicle)
    points, heights, _ = outline("bump", height, length, BEFORE * speed, AFTER * speed + vehicle.axles[-1])
    way = way_along(vehicle, points, heights, heights, speed, min(STEP, length / speed / OVER))
    layout = with_positions(vehicle.layout(), vehicle) if known else vehicle.layout()
    driven = histories(vehicle, way.under(vehicle), way.time, positions=known, model=model, resolved=RESOLVED)
    shown = slice(None, None, max(1, len(way.time) // SHOWN))
    y = np.concatenate(list(driven), axis=-1)[0, : len(layout.outputs), shown]

    def at(name: str) -> dict[str, list[float]]:
        if name not in layout.outputs.quantities:
            return {}
        return dict(zip(layout.outputs.places(name), finite(y[layout.outputs.of(name)]), strict=True))

    body = {"heave": at("z_s"), "pitch": at("pitch"), "roll": at("roll")}
    return {
        "t": (way.time[shown] - BEFORE).tolist(),
        "x": (way.x[shown] - BEFORE * speed).tolist(),
        "body": {name: next(iter(rows.values())) for name, rows in body.items() if rows} if known else {},
        "wheels": at("z_u"),
        "ground": at("z_r"),
        "acceleration": next(iter(at("bacc").values()), []),
    }
