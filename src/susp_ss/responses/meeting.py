"""Which heights of a profile each wheel of a vehicle meets, and when."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from ..quantities import positive
from ..roads.profiles import checked_tracks
from ..vehicles.contract import RoadVehicle

Array = NDArray[np.float64]

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
