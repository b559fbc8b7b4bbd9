"""Peaks of every output of a vehicle on a profile, over speed."""

from __future__ import annotations

import xarray as xr
from numpy.typing import ArrayLike

from ..progress import tracked
from ..quantities import ROAD, briefly, positive
from ..vehicles.contract import RoadVehicle
from ..vehicles.parameters import number_array
from .simulation import simulate


def peaks(vehicle: RoadVehicle, profile: xr.Dataset, speeds: ArrayLike, *, step: float | None = None) -> xr.Dataset:
    """Largest magnitude of every output on a profile, at each of some speeds.

    Parameters
    ----------
    vehicle : Vehicle
        As `simulate` takes it.
    profile : xarray.Dataset
        Heights ``left`` and ``right`` in m on ``x``, such as `obstacle` makes. The vehicle starts in equilibrium on the
        first heights, and only what happens before the first axle's last point counts.
    speeds : array_like, (V,)
        In m/s, > 0.
    step : float, optional
        Of the simulations, in s; 0.001 by default.

    Returns
    -------
    xarray.Dataset
        The variables of `simulate` with ``reduce="peak"``, ``max |y|`` over time, on ``speed`` first.

    Raises
    ------
    TypeError, ValueError
        Speeds that are not one row of numbers > 0, and whatever `simulate` refuses.

    Examples
    --------
    >>> import susp_ss as ss
    >>> worst = ss.peaks(ss.FullCar(), ss.obstacle("bump", length=0.5), [2.0, 8.0, 30.0])
    >>> worst.bacc.sel(point="cg").idxmax("speed").item()
    8.0
    """
    need = "speeds must be one row of numbers in m/s"
    given = number_array(speeds, need)
    if given.ndim != 1 or given.size == 0:
        raise TypeError(f"{need}, got {briefly(speeds)}")
    at = [positive("speeds", speed, "m/s") for speed in given.tolist()]
    runs = tracked(at, "driving", len(at) > 1)
    found = [simulate(vehicle, profile, speed=speed, step=step, reduce="peak") for speed in runs]
    speed = xr.Variable("speed", at, {"units": ROAD["speed"].unit, "long_name": ROAD["speed"].meaning})
    return xr.concat(found, speed)
