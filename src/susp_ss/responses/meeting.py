"""Which heights of a profile each wheel of a vehicle meets, and when."""

from __future__ import annotations

from collections.abc import Mapping
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


class Heights(NamedTuple):
    """Heights in m under the wheels, (wheels, T), at instants (T,) in s."""

    time: Array
    heights: Array
    x: None = None

    def under(self, vehicle: RoadVehicle) -> Array:
        """The same whatever the vehicle is."""
        return self.heights


class Way(NamedTuple):
    """Where the first axle is on a profile in m, (T,), at instants (T,) in s; points x and heights of its tracks."""

    time: Array
    x: Array
    points: Array
    tracks: Mapping[int, Array]

    def under(self, vehicle: RoadVehicle) -> Array:
        """Heights in m under a flattened vehicle, (wheels, T), or (designs, wheels, T) where axles differ."""
        behind = [np.asarray(vehicle.axles[wheel.axle])[..., None] for wheel in vehicle.wheels.values()]
        tracks = [self.tracks[wheel.side] for wheel in vehicle.wheels.values()]
        rows = [np.interp(self.x - d, self.points, track) for d, track in zip(behind, tracks, strict=True)]
        return np.stack(np.broadcast_arrays(*rows), axis=-2)


def way_over(vehicle: RoadVehicle, profile: xr.Dataset, speed: float, step: Any) -> Way:
    """The way of a vehicle whose first axle goes from the first to the last point of a profile.

    Raises
    ------
    TypeError, ValueError
        No profile, or one that is not longer than the vehicle; no step > 0.
    """
    points, (left, right) = checked_tracks(profile)
    return way_along(vehicle, points, left, right, speed, step)


def way_along(vehicle: RoadVehicle, points: Array, left: Array, right: Array, speed: float, step: Any) -> Way:
    """The same along two tracks of heights at points in m.

    A wheel on the left (right) runs on the left (right) track, one on the centre line on the mean of both, as far
    behind the first axle as its own is. Heights are linear between points; what lies before the first is as high as it.

    Raises
    ------
    TypeError, ValueError
        Tracks that are not longer than the vehicle; no step > 0.
    """
    step = positive("step", step, "s")
    length, wheelbase = float(points[-1] - points[0]), float(np.max(vehicle.wheelbase))
    if length <= wheelbase:
        raise ValueError(
            f"profile must be longer than the wheelbase of {wheelbase:g} m, or the last axle never meets it, got "
            f"{length:g} m"
        )
    steps = int(length / (speed * step) + LAST)
    if steps < 1:
        raise ValueError(f"step must be less than the {length / speed:.4g} s on the profile, got {step:g} s")
    time = step * np.arange(steps + 1)
    return Way(time, points[0] + speed * time, points, {1: left, -1: right, 0: 0.5 * (left + right)})
