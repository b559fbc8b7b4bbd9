"""Ride metrics of a vehicle on a road, by any of three routes."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Literal

import xarray as xr

from ..quantities import briefly
from ..responses.excitation import check_kinds, design_space
from ..roads.road import Road
from ..vehicles.contract import RoadVehicle
from .blocks import lazy_metrics
from .in_memory import METHODS, metrics_in_memory
from .weightings import filters


def ride_metrics(
    vehicle: RoadVehicle,
    road: Road,
    method: Literal["covariance", "spectral", "time"] = "covariance",
    *,
    weighting: Any = None,
    points: Mapping[str, tuple[float, float]] | None = None,
    duration: float = 600.0,
    step: float = 0.002,
    seed: int = 0,
) -> xr.Dataset:
    """Root mean squares of a vehicle's ride on a random road.

    Parameters
    ----------
    vehicle : Vehicle
        Any of the models, or a `LinearVehicle`. Parameters that are arrays make a sweep, whose dims come first in
        the result. If one is a DataArray of Dask blocks, so is the result: each block's values are checked when it is
        computed. A `DamperCurve` or `SpringCurve` is taken as it is by ``"time"``, and by its Gaussian equivalent by
        the other methods (`susp_ss.linearised`, which says how close that is).
    road : Road
        What the wheels run over; its speed, roughness and cut-off may be arrays as well.
    method : {"covariance", "spectral", "time"}
        ``"covariance"``: exact, by Routh's and Lyapunov's equations with the wheelbase delay in closed form. A
        spectrum other than waviness 2 is a list of first-order terms, fitted to 1e-5 and to bends by `Road.fit_error`
        (variances of a car to 5e-6). At waviness 2 the coherence of isotropic tracks is a rational fit, good to 1e-4
        for cars and 1e-3 from 0.4 m of track on. Parameters like a car's keep twelve digits, masses and stiffnesses
        three decades apart eight or nine; a design that keeps fewer than six is refused. A microsecond or two a
        design, some more where corners are unequal or terms many; very large sweeps are compiled, at first use on a
        machine for half a minute. ``"spectral"``: ``int |H|^2 G df``, with the spectrum and the coherence themselves.
        ``"time"``: mean squares over a synthesised record, with a standard error beside each.
    weighting : str, control.TransferFunction, control.StateSpace or mapping of either by output, optional
        A filter before the root mean square is taken: the name of a weighting of vibration (`susp_ss.weighting`), or
        any stable, proper system with one input and one output. One for all is for the accelerations (``bacc``,
        ``pitch_acc``, ``roll_acc``); by output, ``{"bacc": "Wk", "roll_acc": "We"}``, for those named. The variable's
        attribute ``weighting`` names it.
    points : mapping of str to (x, y), optional
        Points of the body by name, in m ahead of and to the left of the centre of gravity, added to dim "point".
    duration, step : float
        Of the record in s, for ``"time"``; the step is shortened to resolve the fastest mode and to divide the delay
        of the rear wheels.
    seed : int
        Of the record, for ``"time"``.

    Returns
    -------
    xarray.Dataset
        ``bacc`` (m/s^2) on point (cg, above each corner, and the ``points``), ``sws`` (m), ``dtl`` (N), the mean
        ``damper_power`` (W), ``tyre_deflection`` (m) and ``sws_rate`` (m/s) on corner, ``pitch_acc`` and ``roll_acc``
        (rad/s^2) where the vehicle has them, ``seat_travel`` (m) on seat; a quarter car has no point or corner. A
        `RideHandlingCar` adds ``ay`` (m/s^2), ``yaw_rate`` (rad/s), ``sideslip`` and ``roll`` (rad), ``load_transfer``
        (N) on axle, ``load_transfer_ratio``, and ``slip_angle`` (rad) on corner.
        ``"time"`` adds ``<name>_stderr``. With curves, ``ride_height_shift`` (m) on corner is the mean deflection, bump
        positive, about which the others are. A variance that white road velocity makes infinite (tyre load with tyre
        damping; acceleration, tyre load and damper power on a rigid tyre) is `inf`.

    Raises
    ------
    TypeError, ValueError
        An argument of the wrong kind, a vehicle without damping, a road whose warp drifts without bound, or a weighting
        that is unstable, improper or none.

    Examples
    --------
    >>> from susp_ss import FullCar, Road, ride_metrics
    >>> metrics = ride_metrics(FullCar(), Road.iso8608("B", speed=20.0, tracks="isotropic"))
    >>> print(f"{1e3 * metrics.sws.sel(corner='fr').item():.1f} mm")
    5.5 mm

    Speeds, what a driver feels 0.3 m ahead of the centre of gravity and 0.4 m left of it, and ISO 2631's weighting:

    >>> import numpy as np, xarray as xr
    >>> speeds = xr.DataArray(np.array([10.0, 20.0, 30.0]), dims="speed")
    >>> road = Road.iso8608("B", speed=speeds, tracks="isotropic")
    >>> felt = ride_metrics(FullCar(), road, weighting="Wk", points={"driver": (0.3, 0.4)}).bacc.sel(point="driver")
    >>> felt.round(2).values.tolist()
    [0.41, 0.58, 0.67]
    """
    check_kinds(vehicle, road)
    if points is not None:
        vehicle = vehicle.with_points(points)
    if method not in METHODS:
        raise ValueError(f"method must be one of {', '.join(METHODS)}, got {briefly(method)}")
    how: dict[str, Any] = {"method": method, "weighting": filters(weighting, vehicle.layout())}
    how |= {"duration": duration, "step": step, "seed": seed} if method == "time" else {}
    if vehicle.lazy or road.lazy:
        return lazy_metrics(vehicle, road, how)
    designs = design_space(vehicle, road).size
    return metrics_in_memory(vehicle, road, designs=designs, **how)
