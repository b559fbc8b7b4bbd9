"""Responses over time: any number of vehicles over one road, each sample exactly as linear heights between them say."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike, NDArray

from ..progress import tracked
from ..quantities import briefly, positive
from ..vehicles.contract import Model, RoadVehicle
from ..vehicles.parameters import blocks, number_array
from .excitation import check_kinds
from .first_order_hold import FirstOrderHold, joined
from .labels import labelled_outputs
from .meeting import Heights, Way, way_over
from .positions import form_with_positions, with_positions
from .statistics import checked_statistics, kept
from .stepping import Stepper

Array = NDArray[np.float64]

# Steps times the fastest swing: heights taken as linear over a step weaken that swing by its square over 12.
RESOLVED = 0.15

# A mode whose imaginary part is a smaller share of its modulus creeps.
SWINGING = 1e-6

# On a profile, in s.
STEP = 0.001

# Rows and states of designs that are driven together: what of them is at work at once stays near the processor.
TOGETHER = 120


def simulate(
    vehicle: RoadVehicle,
    profile: Any,
    time: ArrayLike | None = None,
    inputs: Mapping[str, ArrayLike] | None = None,
    *,
    speed: float | None = None,
    step: float | None = None,
    positions: bool = False,
    reduce: str | Sequence[str] | None = None,
) -> xr.Dataset:
    """Drive a vehicle over a profile at a speed, or over given heights under its wheels.

    The heights are taken as linear between samples and the states advance exactly, as `control.forced_response` has
    them, tens of times as fast. The vehicle starts at rest in static equilibrium on the first heights, its further
    inputs at zero. Outputs that need the road's velocity (tyre damping, rigid tyre) take it from the heights by central
    differences.

    On a profile the first axle goes from its first point to its last. Wheels on the left run on ``left``, on the right
    on ``right``, on the centre line on the mean, each as far behind the first axle as its own axle is; what lies before
    the first point is as high as it.

    Parameters
    ----------
    vehicle : Vehicle
        Parameters that are arrays make a sweep, whose dims come first in the result. A curve is taken as it is, by
        steps of fourth order (third at a kink) that resolve the stiffest spring's fastest swing; deflections keep four
        digits where stops are hit.
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
    positions : bool
        Add where everything is, from where it stands on level ground: the heights ``z_s`` of the body on point, ``z_u``
        of the wheels and ``z_r`` of the road under them on corner, in m, and the angles ``pitch`` (positive nose down)
        and ``roll`` (positive left up) in rad.
    reduce : str or sequence of str, optional
        Keep numbers in place of histories: ``"rms"`` (about zero), ``"mean"``, ``"peak"`` (of the modulus), ``"max"``,
        ``"min"``; several lie on dim "statistic". A thousand designs then need no more memory than a dozen.

    Returns
    -------
    xarray.Dataset
        On (sweep..., time), with the variables and dims of `ride_metrics`: ``bacc`` on point, ``sws``, ``dtl`` and the
        momentary ``damper_power`` on corner, ``pitch_acc`` and ``roll_acc``. On a profile, coordinate ``x`` on time is
        where the first axle is, in m.

    Raises
    ------
    TypeError, ValueError
        Times that are not evenly spaced, heights or inputs of the wrong shape or not finite, an input that the vehicle
        has not, a profile without a speed or not longer than the wheelbase, an unknown statistic.

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

    How far the suspension of twenty dampers moves at most on it:

    >>> dampers = xr.DataArray(np.linspace(500.0, 3000.0, 20), dims="cs")
    >>> travel = simulate(FullCar(cs=dampers), ramp, speed=10.0, reduce="peak").sws.sel(corner="fl")
    >>> travel.dims, int(travel.argmin('cs'))
    (('cs',), 19)

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
    statistics = checked_statistics(reduce)
    vehicle, way = _underway(vehicle, profile, time, speed, step)
    t = way.time
    layout, space = vehicle.layout(), vehicle.design_space()
    controls = _checked_inputs(inputs, layout.controls, type(vehicle).__name__, len(t))
    if positions:
        layout = with_positions(layout, vehicle)
    if way.x is not None and "x" in space.dims:
        raise ValueError("designs on a dim named 'x', which is where the first axle is on a profile; rename it")
    flat = vehicle.flattened(space)
    corners = len(layout.corners) if layout.dampers else 0
    whole = np.empty((space.size, len(layout.outputs) + corners, len(statistics or t)))
    for group in tracked(_groups(flat, space.size), "simulating", space.size > 1):
        part = flat.select(group)
        kept(histories(part, way.under(part), t, controls, positions), whole[group], statistics)
    values, power = np.split(whole, [len(layout.outputs)], axis=1)
    if isinstance(reduce, str):
        return labelled_outputs(layout, values[..., 0], power[..., 0], space, long_name=f"{reduce} of {{meaning}}")
    if statistics:
        return labelled_outputs(layout, values, power, space, ("statistic",), {"statistic": list(statistics)})
    found = labelled_outputs(layout, values, power, space, ("time",), {"time": t})
    found.time.attrs["units"] = "s"
    if way.x is None:
        return found
    return found.assign_coords(x=("time", way.x, {"units": "m", "long_name": "place of the first axle"}))


def _underway(vehicle: RoadVehicle, profile: Any, time: Any, speed: Any, step: Any) -> tuple[Any, Heights | Way]:
    """The vehicle as it moves, and what its wheels meet."""
    if not isinstance(profile, xr.Dataset):
        if speed is not None or step is not None:
            raise ValueError(
                "speed and step are for a profile, an xarray.Dataset with left and right on x; heights under the "
                f"wheels need time instead, got {briefly(profile)}"
            )
        t = _checked_time(time)
        return vehicle, Heights(t, _checked_profile(profile, tuple(vehicle.wheels), len(t)))
    if time is not None:
        raise ValueError("time must be left out on a profile, where instants follow from speed and step; got both")
    if speed is None:
        raise ValueError("speed must be given on a profile, in m/s: simulate(vehicle, profile, speed=20.0)")
    speed = positive("speed", speed, "m/s")
    vehicle = vehicle.moving(speed)
    return vehicle, way_over(vehicle, profile, speed, STEP if step is None else step)


def _groups(flat: RoadVehicle, designs: int) -> list[slice]:
    """Designs that are driven together: one with curves, else so many as keep a stretch near the processor."""
    layout = flat.layout()
    many = 1 if flat.curved else int(TOGETHER // (len(layout.outputs) + len(layout.states)) + 1)
    return blocks(designs, many)


def histories(
    part: Any,
    z: Array,
    t: Array,
    controls: Array | None = None,
    positions: bool = False,
    model: Model | None = None,
    resolved: float = RESOLVED,
) -> Iterator[Array]:
    """Outputs and damper powers (N, rows, L) of flattened vehicles on heights z, (inputs, T) or (N, inputs, T).

    Stretch after stretch, of vehicles of numbers; of one with curves all at once, in steps that times its fastest swing
    are at most ``resolved``. ``model`` is theirs where it is known.
    """
    if part.curved:
        yield _curved(part, z, t, positions, resolved)
        return
    model = part.assemble() if model is None else model
    damping, rates = model.damping[..., None], model.layout.rates
    for y in driven(model, z, t[1] - t[0], controls, part if positions else None):
        yield np.concatenate([y, damping * y[:, rates] ** 2], axis=1)


def driven(
    model: Model, z: Array, step: float, controls: Array | None = None, placed: RoadVehicle | None = None
) -> Iterator[Array]:
    """Outputs (N, outputs, L) on road heights z (inputs, T) or (N, inputs, T), from static equilibrium on the first.

    Further inputs, ``controls`` (inputs, T), are zero before.
    """
    form = model.displacement_form() if placed is None else form_with_positions(model, placed)
    A, B, Y, D, D1 = form
    on_states, on_outputs, given = [B], [D], [z]
    if controls is not None:
        further = model.controls()
        if not np.isfinite(further[0]).all():
            raise ValueError("inputs: without cornering stiffness, what a car does under them is not determined")
        on_states.append(further[0])
        on_outputs.append(joined([further[1], np.zeros((D.shape[-2] - further[1].shape[-2], len(controls)))], -2))
        given.append(controls)
    if np.any(D1):
        on_states.append(np.zeros_like(B))
        on_outputs.append(D1)
        given.append(np.gradient(z, step, axis=-1))
    u = joined(given, -2)
    hold = FirstOrderHold(A, joined(on_states, -1), Y, joined(on_outputs, -1), step)
    return hold.drive(u, -np.linalg.solve(A, B @ z[..., :1]))


def _curved(part: Any, z: Array, t: Array, positions: bool, resolved: float) -> Array:
    """`histories` of one vehicle with curves, in as many steps a sample as its fastest swing needs."""
    step, z = t[1] - t[0], z.reshape(z.shape[-2:])
    parts = int(np.ceil(step * fastest(part.steepest()) / resolved))
    finer = np.linspace(t[0], t[-1], parts * (len(t) - 1) + 1)
    heights = np.stack([np.interp(finer, t, row) for row in z])
    stepper = Stepper(part, step / parts, positions)
    y, damping = stepper.drive(heights, stepper.rest(z[:, 0]))
    return np.concatenate([y, damping * y[stepper.rate]])[None, :, ::parts]


def fastest(vehicle: RoadVehicle) -> float:
    """The modulus in rad/s of the fastest eigenvalue that swings."""
    eigenvalues = np.linalg.eigvals(vehicle.assemble().A)
    return float(np.abs(eigenvalues[np.abs(eigenvalues.imag) > SWINGING * np.abs(eigenvalues)]).max(initial=0.0))


def _checked_time(time: Any) -> Array:
    t = number_array(time, "time must be numbers in s").astype(float)
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
    if not inputs:
        return None
    rows = np.zeros((len(names), samples))
    for name, values in inputs.items():
        if name not in names:
            raise ValueError(f"inputs: {kind} has no input named {name!r}, available: {', '.join(names) or 'none'}")
        row = number_array(values, f"inputs[{name!r}] must be numbers")
        if row.shape != (samples,) or not np.isfinite(row).all():
            raise ValueError(
                f"inputs[{name!r}] must be {samples} finite numbers, one an instant, got {briefly(values)}"
            )
        rows[names.index(name)] = row
    return rows
