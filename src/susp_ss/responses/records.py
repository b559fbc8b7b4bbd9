"""Mean squares over records: a road is synthesised, driven over, and forgotten before it counts."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
import scipy.fft
from numpy.typing import NDArray

from ..progress import tracked
from ..quantities import positive, whole_number
from ..roads.profiles import wheel_heights
from ..roads.road import Road
from ..vehicles.contract import RoadVehicle
from ..vehicles.parameters import DesignSpace
from .excitation import check_stationary, delays, infinite_outputs, processes
from .simulation import RESOLVED, driven, fastest
from .stepping import History, Stepper

Array = NDArray[np.float64]

# Times the slowest mode's decay time until the start is forgotten.
FORGET = 8.0

# Parts of a record with curves, each as many times the time to forget, are driven side by side.
PARTS = 1.0

MOST_STEPS = 1e7


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
    step = min(step, RESOLVED / max(fastest(vehicle.steepest() if curved else vehicle), RESOLVED / step))
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
        power = _mean_product(damping[:, -period:], y[model.layout.rates, -period:])
    else:
        z = np.take(z, np.arange(-lead, period), axis=1, mode="wrap")
        y = np.concatenate(list(driven(model, z, step)), axis=-1)[0]
    if road.weighting is not None:
        y = road.weighting.filtered(y, step)
    y = y[:, -period:]
    squares, errors = _mean_product(y, y, curved)
    squares[infinite_outputs(model, excited, road).reshape(-1)] = np.inf
    if not curved:
        return Moments(squares, errors)
    power[0][np.isinf(squares[model.layout.rates])] = np.inf
    travel = y[model.layout.outputs.of("sws")]
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
    of_x = scipy.fft.rfft(x, axis=1) / period
    of_y = of_x if y is x else scipy.fft.rfft(y, axis=1) / period
    power = 2.0 * (of_x.real * of_y.real + of_x.imag * of_y.imag)
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
