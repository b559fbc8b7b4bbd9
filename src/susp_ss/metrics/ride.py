"""Ride metrics of a vehicle on a road, by any of three routes."""

from __future__ import annotations

from typing import Literal

import xarray as xr

from ..quantities import briefly
from ..responses.excitation import check_kinds, design_space
from ..roads.road import Road
from ..vehicles.vehicle import Vehicle
from .blocks import lazy_metrics
from .in_memory import METHODS, metrics_in_memory


def ride_metrics(
    vehicle: Vehicle,
    road: Road,
    method: Literal["covariance", "spectral", "time"] = "covariance",
    *,
    duration: float = 600.0,
    step: float = 0.002,
    seed: int = 0,
) -> xr.Dataset:
    """Root mean squares of a vehicle's ride on a random road.

    Parameters
    ----------
    vehicle : Vehicle
        Any of the five models. Parameters that are arrays make a sweep, whose dims come first in the result. If one
        is a DataArray of Dask blocks, so is the result: each block's values are checked when it is computed.
    road : Road
        What the wheels run over.
    method : {"covariance", "spectral", "time"}
        ``"covariance"``: exact, by Routh's and Lyapunov's equations with the wheelbase delay in closed form, for
        waviness 2; the coherence of isotropic tracks is a rational fit, good to 1e-4 for cars and 1e-3 from 0.4 m of
        track on. Parameters like a car's keep twelve digits, masses and stiffnesses three decades apart eight or nine;
        a design that keeps fewer than six is refused. A microsecond or two a design, some hundred where corners are
        unequal; very large sweeps are compiled, at first use on a machine for half a minute. ``"spectral"``:
        ``int |H|^2 G df``, any waviness and the exact coherence.
        ``"time"``: mean squares over a synthesised record, with a standard error beside each.
    duration, step : float
        Of the record in s, for ``"time"``; the step is shortened to resolve the fastest mode and to divide the delay
        of the rear wheels.
    seed : int
        Of the record, for ``"time"``.

    Returns
    -------
    xarray.Dataset
        ``bacc`` (m/s^2) on point (cg and above each corner), ``sws`` (m), ``dtl`` (N) and the mean ``damper_power``
        (W) on corner, ``pitch_acc`` and ``roll_acc`` (rad/s^2) where the vehicle has them; a quarter car has no point
        or corner. ``"time"`` adds ``<name>_stderr``. A variance that white road velocity makes infinite (tyre load
        with tyre damping; acceleration, tyre load and damper power on a rigid tyre) is `inf`.

    Raises
    ------
    TypeError, ValueError
        An argument of the wrong kind, a vehicle without damping, a waviness the method cannot take, or a road whose
        warp drifts without bound.

    Examples
    --------
    >>> from susp_ss import FullCar, Road, ride_metrics
    >>> metrics = ride_metrics(FullCar(), Road.iso8608("B", speed=20.0, tracks="isotropic"))
    >>> print(f"{1e3 * metrics.sws.sel(corner='fr').item():.1f} mm")
    5.5 mm
    """
    check_kinds(vehicle, road)
    if method not in METHODS:
        raise ValueError(f"method must be one of {', '.join(METHODS)}, got {briefly(method)}")
    if vehicle.lazy or road.lazy:
        return lazy_metrics(vehicle, road, {"method": method, "duration": duration, "step": step, "seed": seed})
    designs = design_space(vehicle, road).size
    return metrics_in_memory(vehicle, road, method, designs, duration=duration, step=step, seed=seed)
