"""How body, wheels and seats move: in each mode, and over a bump."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..responses.simulation import simulate
from ..roads.obstacles import obstacle
from ..vehicles.contract import RoadVehicle
from ..vehicles.ride_handling import RideHandlingCar
from ..vehicles.vehicle import Vehicle
from .rows import finite
from .seat import DRIVER

BODY = {"z_b": "heave", "z_s": "heave", "theta": "pitch", "phi": "roll"}

AXLES = ("front hop", "middle hop", "rear hop")

# Of the drive over a bump: seconds before and after its begin, about how many instants are shown, the longest step in
# s, and how many steps there are at least on the bump.
BEFORE, AFTER, SHOWN, STEP, OVER = 0.2, 1.8, 200, 0.005, 12


def modes(vehicle: RoadVehicle) -> list[dict[str, Any]]:
    """Every mode that swings body, wheels or seats up and down, slowest first.

    Its name is the motion that has the most of its kinetic energy, no motion of the body being named twice. Shapes are
    complex amplitudes ``[re, im]``, m and rad, in proportion.
    """
    if not isinstance(vehicle, Vehicle):
        return []
    motions = {name: motion_of(vehicle, name) for name in vehicle.layout().coordinates}
    known = vehicle.modes()
    if isinstance(vehicle, RideHandlingCar):
        known = known[[name in {word for word, _ in motions.values()} for name in known["name"]]]
        names = list(known["name"])
    else:
        shapes = np.array([shape.to_numpy() for shape in known["shape"]])
        names = _names(
            np.abs(shapes) ** 2 * np.array([*vehicle.linkage().masses.values()]), [word for word, _ in motions.values()]
        )
    finite(known[["frequency", "damping_ratio"]].to_numpy(float))
    return [
        {"name": name, "frequency": float(mode["frequency"]), "damping": float(mode["damping_ratio"])}
        | {"shape": _shape(dict(mode["shape"]), motions)}
        for name, mode in zip(names, known.to_dict("records"), strict=True)
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


def _names(energies: NDArray[np.float64], motions: list[str]) -> list[str]:
    """For each mode, of kinetic energies (modes, coordinates), the motion of the coordinate that is most its own."""
    from scipy.optimize import linear_sum_assignment

    shares = energies / energies.sum(axis=1, keepdims=True)
    own = dict(zip(*linear_sum_assignment(shares, maximize=True), strict=True))
    return [motions[own.get(mode, int(share.argmax()))] for mode, share in enumerate(shares)]


def _shape(amplitudes: dict[str, complex], motions: dict[str, tuple[str, tuple[str, ...]]]) -> dict[str, Any]:
    shape: dict[str, Any] = {"wheels": {}, "seats": {}}
    for coordinate, (_, (first, *rest)) in motions.items():
        value = [float(amplitudes[coordinate].real), float(amplitudes[coordinate].imag)]
        if rest:
            shape[first][rest[0]] = value
        else:
            shape[first] = value
    return shape


def bump(vehicle: RoadVehicle, height: float, length: float, speed: float) -> dict[str, Any]:
    """Where body, wheels and road are while a vehicle drives over a bump on both tracks, and what its body feels.

    ``t`` in s and the place ``x`` of the first axle in m, both from the begin of the bump; heights in m and angles in
    rad from level ground; ``acceleration`` in m/s^2 where the body's is measured first.
    """
    profile = obstacle("bump", height, length, before=BEFORE * speed, after=AFTER * speed + vehicle.axles[-1])
    known = isinstance(vehicle, Vehicle)
    seats = vehicle.linkage().seats if isinstance(vehicle, Vehicle) else {}
    ride = simulate(vehicle, profile, speed=speed, step=min(STEP, length / speed / OVER), positions=known)
    shown = slice(None, None, max(1, len(ride.time) // SHOWN))

    def at(name: str, dim: str) -> dict[str, list[float]]:
        if name not in ride:
            return {}
        data = ride[name]
        places = data[dim].values.tolist() if dim in data.dims else [""]
        rows = data.values[..., shown].reshape(len(places), -1)
        return dict(zip(places, finite(rows), strict=True))

    heave = next(iter(at("z_s", "point").values()), None)
    body = {"heave": heave} | {name: finite(ride[name].values[shown]) for name in ("pitch", "roll") if name in ride}
    return {
        "t": (ride.time.values[shown] - BEFORE).tolist(),
        "x": (ride.x.values[shown] - BEFORE * speed).tolist(),
        "body": body if known else {},
        "wheels": at("z_u", "corner"),
        "seats": {name: z for name, z in at("z_s", "point").items() if name in seats},
        "ground": at("z_r", "corner"),
        "acceleration": next(iter(at("bacc", "point").values()), []),
    }
