"""Responses over time, through python-control's ``forced_response``."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike, NDArray

from ..progress import tracked
from ..quantities import briefly, whole_number
from ..roads.profiles import synthesise
from ..roads.road import Road
from ..vehicles.contract import Model, RoadVehicle
from ..vehicles.parameters import DesignSpace
from .excitation import check_kinds, check_stationary, delay, infinite_outputs, processes
from .labels import labelled_outputs

Array = NDArray[np.float64]

# Steps times the fastest swing: heights taken as linear over a step weaken that swing by its square over 12.
RESOLVED = 0.15

# A mode whose imaginary part is a smaller share of its modulus creeps.
SWINGING = 1e-6

MOST_STEPS = 1e7


def simulate(vehicle: RoadVehicle, profile: Any, time: ArrayLike) -> xr.Dataset:
    """Drive a vehicle over given road heights.

    The heights are taken as linear between samples and the states advance exactly (`control.forced_response`). The
    vehicle starts at rest in static equilibrium on the first heights. Outputs that need the road's velocity (tyre
    damping, rigid tyre) take it from the heights by central differences.

    Parameters
    ----------
    vehicle : Vehicle
        One number for every parameter.
    profile : array_like, (wheels, T), or mapping of wheel to (T,)
        Road heights in m under each wheel, in the order of ``vehicle.wheels``; (T,) for a quarter car, or
        one row for all wheels at once.
    time : array_like, (T,)
        Evenly spaced instants in s.

    Returns
    -------
    xarray.Dataset
        On time, with the variables and dims of `ride_metrics`: ``bacc`` on point, ``sws``, ``dtl`` and the momentary
        ``damper_power`` on corner, ``pitch_acc`` and ``roll_acc``.

    Raises
    ------
    TypeError, ValueError
        Parameters that are arrays, times that are not evenly spaced, heights of the wrong shape or not finite.

    Examples
    --------
    >>> import numpy as np
    >>> from susp_ss import QuarterCar, simulate
    >>> time = np.arange(0.0, 3.0, 0.005)
    >>> kerb = np.where(time > 0.5, 0.05, 0.0)
    >>> response = simulate(QuarterCar(), kerb, time)
    >>> bool(abs(response.sws[-1]) < 1e-3)
    True
    """
    check_kinds(vehicle)
    model = vehicle.single("simulate()")
    t = _checked_time(time)
    z = _checked_profile(profile, tuple(vehicle.wheels), len(t))
    y = _outputs(model, z, t)
    power = model.damping[:, None] * y[model.layout.rates] ** 2
    history = labelled_outputs(model.layout, y[None], power[None], vehicle.design_space(), ("time",), {"time": t})
    history.time.attrs["units"] = "s"
    return history


def _outputs(model: Model, z: Array, t: Array) -> Array:
    """All outputs (outputs, T) on road heights (inputs, T), from static equilibrium on the first."""
    import control

    A, B, Y, D, D1 = (x.reshape(x.shape[-2:]) for x in model.displacement_form())
    states = control.ss(A, B, np.eye(len(A)), np.zeros(B.shape))
    x0 = np.linalg.solve(A, -B @ z[:, 0])
    x = np.asarray(control.forced_response(states, t, z, x0).states)
    y = Y @ x + D @ z
    return y + D1 @ np.gradient(z, t[1] - t[0], axis=1) if np.any(D1) else y


def time_variances(
    flat: RoadVehicle, space: DesignSpace, road: Road, duration: float, step: float, seed: int
) -> tuple[Array, Array]:
    """Mean squares (designs, outputs) over a synthesised record, and their standard errors.

    The record is periodic and starts after the vehicle has forgotten its initial state, so that the mean square is the
    sum of the powers of its harmonics, independent with variance equal to their square: the error follows from the
    record itself, ``var = sum P_k^2 / 2``.
    """
    for name, value in (("duration", duration), ("step", step)):
        if isinstance(value, bool) or not isinstance(value, (int, float, np.integer, np.floating)):
            raise TypeError(f"{name} must be a number > 0 s, got {briefly(value)}")
        if not (np.isfinite(value) and value > 0.0):
            raise ValueError(f"{name} must be > 0 s and finite, got {briefly(value)}")
    if duration < 100 * step:
        raise ValueError(f"duration must be at least 100 steps of {step} s, got {duration} s")
    seed = whole_number("seed", seed, 0)
    designs = tracked(range(space.size), "simulating", space.size > 1)
    pairs = [_mean_squares(flat.select(slice(i, i + 1)), road.one(i), duration, step, seed) for i in designs]
    squares, errors = zip(*pairs, strict=True)
    return np.stack(squares), np.stack(errors)


def _mean_squares(vehicle: RoadVehicle, road: Road, duration: float, step: float, seed: int) -> tuple[Array, Array]:
    model = vehicle.assemble()
    check_stationary(vehicle, road, model)
    excited = processes(vehicle, road)
    tau = float(delay(vehicle, road)) if any(process.later.any() for process in excited) else 0.0
    eigenvalues = np.linalg.eigvals(model.A)
    swinging = np.abs(eigenvalues[np.abs(eigenvalues.imag) > SWINGING * np.abs(eigenvalues)])
    step = min(step, RESOLVED / swinging.max(initial=RESOLVED / step))
    if tau:
        step = tau / np.ceil(tau / step)
    fading = eigenvalues if road.weighting is None else np.concatenate([eigenvalues, road.weighting.poles])
    forget = 8.0 / np.abs(fading.real).min()
    if (duration + forget) / step > MOST_STEPS:
        raise ValueError(
            f"{type(vehicle).__name__} needs {(duration + forget) / step:.2g} time steps, {forget:.3g} s of them to "
            f"forget its start; the most is {MOST_STEPS:.0e}: pass a shorter duration, more damping or another method"
        )
    z = heights_under(vehicle, road, duration, step, seed)
    period = z.shape[1]
    lead = int(np.ceil(forget / step))
    z = np.take(z, np.arange(-lead, period), axis=1, mode="wrap")
    y = _outputs(model, z, step * np.arange(lead + period))
    if road.weighting is not None:
        y = road.weighting.filtered(y, step)
    y = y[:, lead:]

    power = 2.0 * np.abs(np.fft.rfft(y, axis=1) / period) ** 2
    power[:, 0] *= 0.5
    power[:, -1] *= 0.5
    squares, errors = power.sum(axis=1), np.sqrt(0.5 * (power**2).sum(axis=1))
    squares[infinite_outputs(model, excited, road).reshape(-1)] = np.inf
    return squares, errors


def heights_under(vehicle: RoadVehicle, road: Road, duration: float, step: float, seed: int) -> Array:
    """One realisation of the heights in m under each wheel, (wheels, T): periodic, with tracks and delay."""
    excited = processes(vehicle, road)
    tau = float(delay(vehicle, road)) if any(process.later.any() for process in excited) else 0.0
    z = synthesise(
        road,
        duration,
        step,
        sides=[wheel.side for wheel in vehicle.wheels.values()],
        delays=[tau * wheel.axle for wheel in vehicle.wheels.values()],
        track_width=float(vehicle.track_width),
        seed=seed,
    )
    return z * np.any([process.now + process.later != 0.0 for process in excited], axis=0)[:, None]


def _checked_time(time: ArrayLike) -> Array:
    t = np.asarray(time)
    if t.dtype.kind not in "iuf":
        raise TypeError(f"time must be numbers in s, got {briefly(time)}")
    t = t.astype(float)
    if t.ndim != 1 or len(t) < 2 or not np.isfinite(t).all():
        raise ValueError(f"time must be one row of at least two finite instants in s, got shape {t.shape}")
    steps = np.diff(t)
    if steps[0] <= 0.0 or np.ptp(steps) > 1e-6 * steps[0]:
        raise ValueError(f"time must rise in even steps, got steps from {steps.min():g} to {steps.max():g} s")
    return t


def _checked_profile(profile: Any, wheels: tuple[str, ...], samples: int) -> Array:
    if isinstance(profile, Mapping):
        if set(profile) != set(wheels):
            raise ValueError(f"profile must have the wheels {', '.join(wheels)}, got {', '.join(map(str, profile))}")
        profile = [profile[name] for name in wheels]
    try:
        z = np.asarray(profile)
    except ValueError:
        raise ValueError(f"profile must have shape {(len(wheels), samples)}, got rows of different lengths") from None
    if z.dtype.kind not in "iuf":
        raise TypeError(f"profile must be road heights in m, got {briefly(profile)}")
    if z.ndim == 1:
        z = np.broadcast_to(z, (len(wheels), len(z)))
    if z.shape != (len(wheels), samples):
        raise ValueError(f"profile must have shape {(len(wheels), samples)} (wheels, time), got {np.shape(profile)}")
    if not np.isfinite(z).all():
        raise ValueError("profile must be finite, got NaN or inf")
    return z.astype(float)
