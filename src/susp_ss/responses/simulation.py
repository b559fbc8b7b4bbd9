"""Responses over time, through python-control's ``forced_response``."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike, NDArray

from ..progress import tracked
from ..quantities import briefly, positive, whole_number
from ..roads.profiles import wheel_heights
from ..roads.road import Road
from ..vehicles.contract import Model, RoadVehicle
from ..vehicles.parameters import DesignSpace
from .excitation import check_kinds, check_stationary, delays, infinite_outputs, processes
from .labels import labelled_outputs
from .meeting import met
from .stepping import History, Stepper

Array = NDArray[np.float64]

# Steps times the fastest swing: heights taken as linear over a step weaken that swing by its square over 12.
RESOLVED = 0.15

# Times the slowest mode's decay time until the start is forgotten.
FORGET = 8.0

# Parts of a record with curves, each as many times the time to forget, are driven side by side.
PARTS = 1.0

# A mode whose imaginary part is a smaller share of its modulus creeps.
SWINGING = 1e-6

MOST_STEPS = 1e7

# On a profile, in s.
STEP = 0.001


def simulate(
    vehicle: RoadVehicle,
    profile: Any,
    time: ArrayLike | None = None,
    inputs: Mapping[str, ArrayLike] | None = None,
    *,
    speed: float | None = None,
    step: float | None = None,
) -> xr.Dataset:
    """Drive a vehicle over a profile at a speed, or over given heights under its wheels.

    The heights are taken as linear between samples and the states advance exactly (`control.forced_response`). The
    vehicle starts at rest in static equilibrium on the first heights, its further inputs at zero. Outputs that need the
    road's velocity (tyre damping, rigid tyre) take it from the heights by central differences.

    On a profile the first axle goes from its first point to its last. Wheels on the left run on ``left``, on the right
    on ``right``, on the centre line on the mean, each as far behind the first axle as its own axle is; what lies before
    the first point is as high as it.

    Parameters
    ----------
    vehicle : Vehicle
        One number for every parameter, or a curve: that is taken as it is, by steps of fourth order (third at a kink)
        that resolve the stiffest spring's fastest swing; deflections keep four digits where stops are hit.
    profile : xarray.Dataset, or array_like, (wheels, T), or mapping of wheel to (T,)
        A profile: heights ``left`` and ``right`` in m on ``x``, m, rising, evenly spaced or not, linear between points.
        Or road heights in m under each wheel, in the order of ``vehicle.wheels``; (T,) for a quarter car, or one row
        for all wheels at once.
    time : array_like, (T,)
        Evenly spaced instants in s of such heights; on a profile they follow from ``speed`` and ``step``.
    inputs : mapping of str to array_like, (T,), optional
        What else drives the vehicle, linear between samples as well: ``delta_f`` (rad), ``drive_rr`` (N m) and so on
        of a `RideHandlingCar`; what is left out stays zero.
    speed : float
        In m/s, on a profile; a `RideHandlingCar` moves at it as well.
    step : float
        In s, on a profile, 0.001 by default.

    Returns
    -------
    xarray.Dataset
        On time, with the variables and dims of `ride_metrics`: ``bacc`` on point, ``sws``, ``dtl`` and the momentary
        ``damper_power`` on corner, ``pitch_acc`` and ``roll_acc``. On a profile, coordinate ``x`` on time is where the
        first axle is, in m.

    Raises
    ------
    TypeError, ValueError
        Parameters that are arrays, times that are not evenly spaced, heights or inputs of the wrong shape or not
        finite, an input that the vehicle has not, a profile without a speed or not longer than the wheelbase.

    Examples
    --------
    A ramp of 5 cm on the left, at 10 m/s:

    >>> import numpy as np
    >>> import xarray as xr
    >>> from susp_ss import FullCar, simulate
    >>> x = np.array([0.0, 5.0, 5.5, 40.0])
    >>> ramp = xr.Dataset({"left": ("x", [0.0, 0.0, 0.05, 0.05]), "right": ("x", np.zeros(4))}, coords={"x": x})
    >>> ride = simulate(FullCar(), ramp, speed=10.0)
    >>> first = np.abs(ride.sws).idxmax("time")
    >>> bool(first.sel(corner="rl") > first.sel(corner="fl") > 0.5)
    True

    Heights under the wheel of a quarter car:

    >>> from susp_ss import QuarterCar
    >>> time = np.arange(0.0, 3.0, 0.005)
    >>> kerb = np.where(time > 0.5, 0.05, 0.0)
    >>> response = simulate(QuarterCar(), kerb, time)
    >>> bool(abs(response.sws[-1]) < 1e-3)
    True

    A step of the steering angle, on a level road:

    >>> from susp_ss import RideHandlingCar
    >>> step = np.where(time > 0.5, 0.01, 0.0)
    >>> turn = simulate(RideHandlingCar(), np.zeros_like(time), time, inputs={"delta_f": step})
    >>> bool(turn["roll"].max() > turn["roll"][-1] > 0.0)
    True
    """
    check_kinds(vehicle)
    at = {}
    if isinstance(profile, xr.Dataset):
        if time is not None:
            raise ValueError("time must be left out on a profile, where instants follow from speed and step; got both")
        if speed is None:
            raise ValueError("speed must be given on a profile, in m/s: simulate(vehicle, profile, speed=20.0)")
        vehicle = vehicle.moving(positive("speed", speed, "m/s"))
        t, x, z = met(vehicle, profile, speed, STEP if step is None else step)
        at["x"] = xr.Variable("time", x, {"units": "m", "long_name": "place of the first axle"})
    else:
        if speed is not None or step is not None:
            raise ValueError(
                "speed and step are for a profile, an xarray.Dataset with left and right on x; heights under the "
                f"wheels need time instead, got {briefly(profile)}"
            )
        t = _checked_time(time)
        z = _checked_profile(profile, tuple(vehicle.wheels), len(t))
    layout = vehicle.layout()
    given = _checked_inputs(inputs, layout.controls, type(vehicle).__name__, len(t))
    if vehicle.curved:
        y, damping = _stepped(vehicle, z, t)
    else:
        model = vehicle.single("simulate()")
        y = _outputs(model, z, t, given)
        damping = model.damping[:, None] * y[layout.rates]
    power = damping * y[layout.rates]
    history = labelled_outputs(layout, y[None], power[None], vehicle.design_space(), ("time",), {"time": t, **at})
    history.time.attrs["units"] = "s"
    return history


def _outputs(model: Model, z: Array, t: Array, controls: Array | None = None) -> Array:
    """All outputs (outputs, T) on road heights (inputs, T), from static equilibrium on the first."""
    import control

    A, B, Y, D, D1 = (x.reshape(x.shape[-2:]) for x in model.displacement_form())
    x0, driving = np.linalg.solve(A, -B @ z[:, 0]), z
    if controls is not None:
        further = [x.reshape(x.shape[-2:]) for x in model.controls()]
        if not np.isfinite(further[0]).all():
            raise ValueError("inputs: without cornering stiffness, what a car does under them is not determined")
        B, D = np.hstack([B, further[0]]), np.hstack([D, further[1]])
        driving = np.concatenate([z, controls])
    states = control.ss(A, B, np.eye(len(A)), np.zeros(B.shape))
    x = np.asarray(control.forced_response(states, t, driving, x0).states)
    y = Y @ x + D @ driving
    return y + D1 @ np.gradient(z, t[1] - t[0], axis=1) if np.any(D1) else y


def _stepped(vehicle: Any, z: Array, t: Array) -> History:
    """The same of a vehicle with curves, in as many steps a sample as its fastest swing needs."""
    vehicle.middling().single("simulate()")
    step = t[1] - t[0]
    parts = int(np.ceil(step * _fastest(vehicle.steepest()) / RESOLVED))
    finer = np.linspace(t[0], t[-1], parts * (len(t) - 1) + 1)
    heights = np.stack([np.interp(finer, t, row) for row in z])
    stepper = Stepper(vehicle, step / parts)
    y, damping = stepper.drive(heights, stepper.rest(z[:, 0]))
    return History(y[:, ::parts], damping[:, ::parts])


def _fastest(vehicle: RoadVehicle) -> float:
    """The modulus in rad/s of the fastest eigenvalue that swings."""
    eigenvalues = np.linalg.eigvals(vehicle.assemble().A)
    return float(np.abs(eigenvalues[np.abs(eigenvalues.imag) > SWINGING * np.abs(eigenvalues)]).max(initial=0.0))


class Moments(NamedTuple):
    """Variances (designs, outputs), damper powers and mean deflections (designs, corners), each with its error."""

    variances: Array
    errors: Array | None = None
    power: Any = None
    power_errors: Any = None
    shift: Array | None = None
    shift_errors: Array | None = None


def time_moments(flat: RoadVehicle, space: DesignSpace, road: Road, duration: float, step: float, seed: int) -> Moments:
    """Mean squares (designs, outputs) over a synthesised record, and what else results need, with standard errors.

    The record is periodic and starts after the vehicle has forgotten its initial state, so that the mean square is the
    sum of the powers of its harmonics, independent with variance equal to their square: the error follows from the
    record itself, ``var = sum P_k^2 / 2``.
    """
    duration, step = positive("duration", duration, "s"), positive("step", step, "s")
    if duration < 100 * step:
        raise ValueError(f"duration must be at least 100 steps of {step} s, got {duration} s")
    seed = whole_number("seed", seed, 0)
    designs = tracked(range(space.size), "simulating", space.size > 1)
    found = [_moments(flat.select(slice(i, i + 1)), road.one(i), duration, step, seed) for i in designs]
    return Moments._make(None if part[0] is None else np.stack(part) for part in zip(*found, strict=True))


def _moments(vehicle: Any, road: Road, duration: float, step: float, seed: int) -> Moments:
    curved = vehicle.curved
    model = (vehicle.middling() if curved else vehicle).assemble()
    check_stationary(vehicle, road, model)
    excited = processes(vehicle, road)
    eigenvalues = np.linalg.eigvals(model.A)
    step = min(step, RESOLVED / max(_fastest(vehicle.steepest() if curved else vehicle), RESOLVED / step))
    later = [tau for tau in delays_met(vehicle, road) if tau > 0.0]
    if later:
        step = later[0] / np.ceil(later[0] / step)
    fading = eigenvalues if road.weighting is None else np.concatenate([eigenvalues, road.weighting.poles])
    forget = FORGET / np.abs(fading.real).min()
    if (duration + forget) / step > MOST_STEPS:
        raise ValueError(
            f"{type(vehicle).__name__} needs {(duration + forget) / step:.2g} time steps, {forget:.3g} s of them to "
            f"forget its start; the most is {MOST_STEPS:.0e}: pass a shorter duration, more damping or another method"
        )
    z = heights_under(vehicle, road, duration, step, seed)
    period, lead = z.shape[1], int(np.ceil(forget / step))
    if curved:
        y, damping = _side_by_side(Stepper(vehicle, step), z, lead)
    else:
        z = np.take(z, np.arange(-lead, period), axis=1, mode="wrap")
        y = _outputs(model, z, step * np.arange(lead + period))
        damping = model.damping.reshape(-1, 1) * y[model.layout.rates]
    force, rate = damping[:, -period:], y[model.layout.rates, -period:]
    if road.weighting is not None:
        y = road.weighting.filtered(y, step)

    squares, errors = _mean_product(y[:, -period:], y[:, -period:], curved)
    squares[infinite_outputs(model, excited, road).reshape(-1)] = np.inf
    power = _mean_product(force, rate)
    power[0][np.isinf(squares[model.layout.rates])] = np.inf
    if not curved:
        return Moments(squares, errors, *power)
    travel = y[model.layout.outputs.of("sws"), -period:]
    return Moments(squares, errors, *power, travel.mean(axis=1), _error_of_mean(travel, lead))


def _side_by_side(stepper: Stepper, z: Array, lead: int) -> History:
    """A lead and a period of heights (inputs, T), in parts that each forget their own start on what lies before."""
    period = z.shape[1]
    length = int(min(period, PARTS * lead))
    parts = -(-period // length)
    at = np.arange(-lead, length)[:, None] + length * np.arange(parts)
    heights = np.take(z, at, axis=1, mode="wrap")
    start = -np.linalg.solve(stepper.A, stepper.B @ heights[:, 0])

    def joined(history: Array) -> Array:
        whole = np.moveaxis(history[:, lead:], 2, 1).reshape(len(history), -1)[:, :period]
        return np.concatenate([whole[:, -lead:], whole], axis=1)

    return History(*map(joined, stepper.drive(heights, start)))


def _error_of_mean(x: Array, length: int) -> Array:
    """Standard error of the means of histories (rows, T) whose parts of such a length know nothing of one another."""
    parts = max(x.shape[1] // length, 2)
    means = np.stack([part.mean(axis=1) for part in np.array_split(x, parts, axis=1)])
    return np.asarray(means.std(axis=0, ddof=1) / np.sqrt(parts))


def _mean_product(x: Array, y: Array, about_mean: bool = False) -> tuple[Array, Array]:
    """Means of products of histories (rows, T) of a period, and their standard errors, by the powers of harmonics."""
    period = x.shape[1]
    of_x, of_y = (np.fft.rfft(part, axis=1) / period for part in (x, y))
    power = 2.0 * np.real(of_x * np.conj(of_y))
    power[:, 0] *= 0.0 if about_mean else 0.5
    power[:, -1] *= 0.5
    return power.sum(axis=1), np.sqrt(0.5 * (power**2).sum(axis=1))


def heights_under(vehicle: RoadVehicle, road: Road, duration: float, step: float, seed: int) -> Array:
    """One realisation of the heights in m under each wheel, (wheels, T): periodic, with tracks and delay."""
    excited, taus = processes(vehicle, road), delays_met(vehicle, road)
    z = wheel_heights(
        road,
        duration,
        step,
        sides=[wheel.side for wheel in vehicle.wheels.values()],
        delays=[taus[wheel.axle] for wheel in vehicle.wheels.values()],
        track_width=float(vehicle.track_width),
        seed=seed,
    )
    return z * np.any([process.weights != 0.0 for process in excited], axis=(0, 1))[:, None]


def delays_met(vehicle: RoadVehicle, road: Road) -> list[float]:
    """Delay in s of every axle of one design, none where no process is met by one axle after another."""
    delayed = any(process.delayed for process in processes(vehicle, road))
    return [float(tau) if delayed else 0.0 for tau in delays(vehicle, road)]


def _checked_time(time: Any) -> Array:
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


def _checked_inputs(inputs: Any, names: tuple[str, ...], kind: str, samples: int) -> Array | None:
    """Further inputs (names, T), zero where none is given; None where none is at all."""
    if inputs is None:
        return None
    if not isinstance(inputs, Mapping):
        raise TypeError(f'inputs must be a mapping such as {{"delta_f": angles}}, got {briefly(inputs)}')
    rows = np.zeros((len(names), samples))
    for name, values in inputs.items():
        if name not in names:
            raise ValueError(f"inputs: {kind} has no input named {name!r}, available: {', '.join(names) or 'none'}")
        row = np.asarray(values)
        if row.dtype.kind not in "iuf":
            raise TypeError(f"inputs[{name!r}] must be numbers, got {briefly(values)}")
        if row.shape != (samples,) or not np.isfinite(row).all():
            raise ValueError(
                f"inputs[{name!r}] must be {samples} finite numbers, one an instant, got {briefly(values)}"
            )
        rows[names.index(name)] = row
    return rows
