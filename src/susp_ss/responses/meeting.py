"""Which heights of a profile each wheel of a vehicle meets, and when."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from ..quantities import briefly
from ..vehicles.contract import RoadVehicle

Array = NDArray[np.float64]

TRACKS = ("left", "right")

# Of a step, what rounding may take from the last one.
LAST = 1e-6


class Met(NamedTuple):
    """Instants (T,) in s, where the first axle is on the profile (T,) in m, and the heights in m, (wheels, T)."""

    time: Array
    x: Array
    heights: Array


def met(vehicle: RoadVehicle, profile: xr.Dataset, speed: Any, step: Any) -> Met:
    """Heights under every wheel of a vehicle whose first axle goes from the first to the last point of a profile.

    A wheel on the left (right) runs on the left (right) track, one on the centre line on the mean of both, as far
    behind the first axle as its own is. Heights are linear between points; what lies before the first is as high as it.

    Raises
    ------
    TypeError, ValueError
        No profile, or one that is not longer than the vehicle; no speed or step > 0.
    """
    x, tracks = checked_tracks(profile)
    speed, step = positive("speed", speed, "m/s"), positive("step", step, "s")
    length = float(x[-1] - x[0])
    wheelbase = float(np.max(vehicle.wheelbase))
    if length <= wheelbase:
        raise ValueError(
            f"profile must be longer than the wheelbase of {wheelbase:g} m, or the last axle never meets it, got "
            f"{length:g} m"
        )
    steps = int(length / (speed * step) + LAST)
    if steps < 1:
        raise ValueError(f"step must be less than the {length / speed:.4g} s on the profile, got {step:g} s")
    time = step * np.arange(steps + 1)
    first = x[0] + speed * time
    left, right = tracks
    by_side = {1: left, -1: right, 0: 0.5 * (left + right)}
    wheels = vehicle.wheels.values()
    heights = [np.interp(first - vehicle.axles[wheel.axle], x, by_side[wheel.side]) for wheel in wheels]
    return Met(time, first, np.stack(heights))


def checked_tracks(profile: xr.Dataset) -> tuple[Array, Array]:
    """Points x (P,) and heights (left and right, P) of a profile in m, or say what is wrong with it."""
    need = "profile must have left and right, heights in m on x"
    for name in ("x", *TRACKS):
        if name not in profile.variables:
            raise ValueError(f"{need}, got no {name!r} among {', '.join(map(str, profile.variables))}")
        one = profile[name]
        if one.dims != ("x",) or one.dtype.kind not in "iuf":
            raise ValueError(f"{need}, got {name!r} of {one.dtype} on ({', '.join(map(str, one.dims))})")
        if one.attrs.get("units", "m") != "m":
            raise ValueError(f"{need}, got {name!r} in {one.attrs['units']}")
        bad = np.flatnonzero(~np.isfinite(one.values))
        if bad.size:
            raise ValueError(f"profile must be finite, got {name!r} {one.values[bad[0]]} at point {bad[0]}")
    x = profile["x"].values.astype(float)
    if len(x) < 2:
        raise ValueError(f"profile must have at least two points, got {len(x)}")
    back = np.flatnonzero(np.diff(x) <= 0.0)
    if back.size:
        raise ValueError(f"profile must have rising x, got {x[back[0] + 1]:g} m after {x[back[0]]:g} m")
    return x, np.stack([profile[name].values.astype(float) for name in TRACKS])


def positive(name: str, value: Any, unit: str) -> float:
    """Return a number > 0 as float, or say what is wrong with it."""
    if isinstance(value, (bool, np.bool_)) or not isinstance(value, (int, float, np.integer, np.floating)):
        raise TypeError(f"{name} must be a number > 0 {unit}, got {briefly(value)}")
    if not (np.isfinite(value) and value > 0.0):
        raise ValueError(f"{name} must be > 0 {unit} and finite, got {briefly(value)}")
    return float(value)
