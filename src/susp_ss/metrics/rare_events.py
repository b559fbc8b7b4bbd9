"""How often a ride comes to its limits: stops, wheels that leave the ground, highest values, fatigue."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from ..progress import tracked
from ..quantities import DIMS, EVENTS, SHIFT, Quantity, briefly, positive
from ..responses.covariance.linearisation import linearise
from ..responses.covariance.matrices import BATCH, batches
from ..responses.covariance.spectral_moments import spectral_moments
from ..responses.excitation import check_kinds, spanned
from ..responses.labels import shifted
from ..roads.road import Road
from ..vehicles.contract import RoadVehicle
from ..vehicles.parameters import Corners, DesignSpace, checked, computed, design_dims
from .extremes import COUNTINGS, ESTIMATES, Gaussian
from .in_memory import LINEARISED

Array = NDArray[np.float64]

OUTPUTS = ("bacc", "sws", "dtl")

CLEARANCE = Quantity("clearance", "m", "travel of the suspension to a stop", bound="> 0")

UNKNOWN = "has neither static loads nor springs; pass the vehicle of masses and springs that it stands for"
"""Why a state space has no rate of lift-off and no damage: in the comment of the Dataset."""

# S-N curves of springs fall with slopes of 3 to some 20; powers far beyond are no numbers.
STEEPEST = 50.0


def rare_events(
    vehicle: RoadVehicle,
    road: Road,
    clearance: Any = None,
    rebound: Any = None,
    *,
    distance: float = 1000.0,
    duration: float | None = None,
    sn_slope: float = 5.0,
    sn_range: float = 1000.0,
    sn_cycles: float = 1.0,
) -> xr.Dataset:
    """How often a vehicle on a random road comes to its limits, and how far it goes.

    On a Gaussian road every output is Gaussian, and goes above a level ``sqrt(m2/m0) / (2 pi) exp(-level^2 / (2 m0))``
    times a second (Rice 1945), with the moments ``m_k = int |omega|^k S d omega`` of its spectrum, all exact.

    Parameters
    ----------
    vehicle : Vehicle
        Parameters may be arrays, which make a sweep. Springs and dampers with curves are statistically linearised, and
        stops are as far away as the mean deflection leaves them.
    road : Road
        With a ``contact_length`` > 0 unless its velocity has a finite variance without (waviness above 3): on white
        velocity the tyre load changes infinitely fast.
    clearance, rebound : float, array, DataArray, Corners or tuple, optional
        Travel of the suspension from rest to its bump and to its rebound stop in m, > 0: one value, or one a wheel as
        for ``ks``; arrays are designs. Rebound is as far as bump where it is left out. Without clearance there are
        no stops.
    distance, duration : float
        The stretch over which probabilities, highest values and damage are meant: m of road, or s in their place.
    sn_slope, sn_range, sn_cycles : float
        A spring force that swings ``sn_cycles`` times over ``sn_range`` (N, from valley to peak) has a damage of 1;
        cycles of other ranges count as their ratio to it to the power ``sn_slope``. As it stands, damage is the
        number of cycles of 1 kN that do as much.

    Returns
    -------
    xarray.Dataset
        On (sweep..., corner or point): ``bump_rate``, ``rebound_rate`` and ``lift_off_rate`` (1/s), how often a
        suspension reaches its stop and a wheel leaves the ground; ``bump_probability`` and so on, that it happens on
        the stretch at all; ``static_load`` (N). ``bacc_highest``, ``sws_highest``, ``dtl_highest``, the expected
        highest values on the stretch, on dim "estimate" (``vanmarcke``, ``davenport``, ``cartwright``); the lowest are
        as far below zero.
        ``bacc_crossings`` and so on (1/s), and the ``irregularity`` of the suspension's deflection, zero crossings over
        peaks, 1 of a sine. ``damage`` of the suspension's spring on dim "counting": ``narrow_band``, ``dirlik``. A
        `LinearVehicle` has no static loads and no springs: lift-off and damage are left out, as ``comment`` says. The
        attributes say over which stretch and against which range of the spring's force all this is meant.

    Raises
    ------
    TypeError, ValueError
        What `ride_metrics` refuses; a tyre load whose rate has no finite variance; no length, time or number > 0.

    Notes
    -----
    Probabilities and ``vanmarcke`` know that crossings come in clumps, by the bandwidth ``sqrt(1 - m1^2 / (m0 m2))``
    (E. H. Vanmarcke, *On the distribution of the first-passage time for normal stationary random processes*, J. Appl.
    Mech. 42, 1975). ``davenport`` takes them one by one (A. G. Davenport 1964), ``cartwright`` counts peaks (D. E.
    Cartwright and M. S. Longuet-Higgins 1956). Fatigue: Miles 1954 and T. Dirlik, *Application of computers in fatigue
    analysis*, 1985. A sweep takes a tenth of a millisecond a quarter car, one or two a full car.

    Examples
    --------
    >>> from susp_ss import FullCar, Road, rare_events
    >>> road = Road.iso8608("D", speed=20.0, tracks="isotropic", contact_length=0.1)
    >>> events = rare_events(FullCar(), road, clearance=0.08)
    >>> front = events.sel(corner="fr")
    >>> print(f"{front.bump_probability:.1%} a kilometre, {1e3 * front.sws_highest.sel(estimate='vanmarcke'):.0f} mm")
    19.1% a kilometre, 74 mm
    """
    check_kinds(vehicle, road)
    seconds = None if duration is None else positive("duration", duration, "s")
    metres = positive("distance", distance)
    slope, reference, cycles = (
        positive(name, value, unit)
        for name, value, unit in (("sn_slope", sn_slope, ""), ("sn_range", sn_range, "N"), ("sn_cycles", sn_cycles, ""))
    )
    if slope > STEEPEST:
        raise ValueError(f"sn_slope must be > 0 and at most {STEEPEST:g}, got {slope:g}")
    stops = _stops(clearance, rebound, vehicle)
    space, flat, ground = spanned(vehicle, road)
    straight = linearise(flat, space, ground) if flat.curved else None
    car, layout = flat if straight is None else straight.vehicle, vehicle.layout()
    ride = _Ride(_processes(car, space, ground), metres / _array(computed(road.speed)) if seconds is None else seconds)

    def at_corners(values: Array) -> xr.DataArray:
        return _placed(np.broadcast_to(values, (space.size, len(layout.corners))), "corner", layout.corners, space)

    found = ride.shapes()
    for event, sign, level in stops:
        _check_fits(level, ride, event)
        found |= ride.reaching(event, "sws", level if straight is None else level - sign * at_corners(straight.shift))
    loads = car.static_loads()
    if loads is not None:
        _check_lift_off(vehicle, space, road, ride.processes["dtl"])
        found["static_load"] = at_corners(loads)
        found |= ride.reaching("lift_off", "dtl", found["static_load"])
    if "ks" in vehicle.quantities():
        stiffness = at_corners(np.stack([np.broadcast_to(k, space.size) for k in car.at_wheels("ks")], axis=-1))
        ranges = ride.of("sws", lambda process: process.ranges(slope), dims=("counting",))
        found["damage"] = ride.seconds / cycles * (stiffness / reference) ** slope * ranges

    over = {"distance": metres} if seconds is None else {"duration": seconds}
    events = _dataset(found, space, {**over, "sn_slope": slope, "sn_range": reference, "sn_cycles": cycles})
    if straight is not None:
        events[SHIFT.name] = shifted(layout, space, straight.shift, "{statistic} {meaning}")
        events.attrs["comment"] = LINEARISED
    if loads is None:
        events.attrs["comment"] = f"lift-off and damage are left out: {type(vehicle).__name__} {UNKNOWN}"
    return events


class _Ride(NamedTuple):
    """Moments of the outputs, each on (sweep..., place), and the length of the stretch in s."""

    processes: dict[str, list[xr.DataArray]]
    seconds: Any

    def of(self, output: str, method: Any, *arguments: Any, dims: tuple[str, ...] = ()) -> xr.DataArray:
        """What a method of `Gaussian` makes of an output."""

        def applied(*arrays: Array) -> Array:
            m0, m1, m2, m4, *rest = np.broadcast_arrays(*arrays)
            return np.asarray(method(Gaussian(m0, m1, m2, m4), *rest))

        return xr.apply_ufunc(applied, *self.processes[output], *arguments, output_core_dims=[dims])

    def shapes(self) -> dict[str, xr.DataArray]:
        """What needs no level."""
        found = {}
        for name in self.processes:
            found[f"{name}_crossings"] = self.of(name, lambda process: process.rate)
            found[f"{name}_highest"] = self.of(name, Gaussian.highest, self.seconds, dims=("estimate",))
        if "sws" in self.processes:
            found["irregularity"] = self.of("sws", lambda process: process.irregularity)
        return found

    def reaching(self, event: str, output: str, level: Any) -> dict[str, xr.DataArray]:
        """How often and how likely an output reaches a level."""
        return {
            f"{event}_rate": self.of(output, Gaussian.passing, level),
            f"{event}_probability": self.of(output, Gaussian.reaching, level, self.seconds),
        }


def _dataset(found: dict[str, xr.DataArray], space: DesignSpace, attributes: dict[str, float]) -> xr.Dataset:
    """Events in the order of their table, dims of the sweep first."""
    said = {name: {"units": quantity.unit, "long_name": quantity.meaning} for name, quantity in EVENTS.items()}
    events = xr.Dataset({name: found[name].assign_attrs(said[name]) for name in EVENTS if name in found})
    labels = {"estimate": list(ESTIMATES), "counting": list(COUNTINGS)}
    events = events.assign_coords({dim: label for dim, label in labels.items() if dim in events.dims})
    sweep = dict.fromkeys([*space.dims, *(dim for dim in events.dims if dim not in DIMS)])
    places = ("point", "corner", "estimate", "counting")
    return events.transpose(*sweep, *places, missing_dims="ignore").assign_attrs(attributes)


def _processes(car: RoadVehicle, space: DesignSpace, road: Road) -> dict[str, list[xr.DataArray]]:
    """Moments of the outputs that events are made of, each on (sweep..., place)."""
    layout = car.layout()
    outputs = [name for name in OUTPUTS if name in layout.outputs.quantities]
    if not outputs:
        raise ValueError(f"rare_events needs a vehicle with outputs {', '.join(OUTPUTS)}, got {car!r}")
    rows = {name: np.arange(len(layout.outputs))[layout.outputs.of(name)] for name in outputs}
    every = np.concatenate(list(rows.values()))
    parts = list(batches(np.arange(space.size), BATCH))
    found = [spectral_moments(car, space, road, every, part) for part in tracked(parts, "moments", len(parts) > 1)]
    of_rows = [dict(zip(every, np.concatenate(m).T, strict=True)) for m in zip(*found, strict=True)]

    def labelled(name: str, values: dict[int, Array]) -> xr.DataArray:
        quantity, places = layout.variables[name]
        return _placed(np.stack([values[row] for row in rows[name]], axis=-1), quantity.dim, places, space)

    return {name: [labelled(name, values) for values in of_rows] for name in outputs}


def _placed(values: Array, dim: str, places: tuple[str, ...], space: DesignSpace) -> xr.DataArray:
    """Values (designs, places) with their labels; one place without a name has no dim."""
    if places == ("",):
        return space.unflatten(values[:, 0])
    return space.unflatten(values, (dim,), {dim: list(places)})


def _array(value: Any) -> Any:
    """A number, or an array with its dims."""
    return xr.DataArray(value, dims=design_dims(value.ndim)) if isinstance(value, np.ndarray) else value


def _stops(clearance: Any, rebound: Any, vehicle: RoadVehicle) -> list[tuple[str, float, Any]]:
    """Names of the stops, which way deflection leads there, and how far they are away in m."""
    if clearance is None:
        if rebound is not None:
            raise ValueError("rebound needs a clearance as well, the travel to the bump stop in m")
        return []
    if "sws" not in vehicle.layout().outputs.quantities:
        raise ValueError(f"clearance needs a vehicle with suspension deflections, outputs sws, got {vehicle!r}")
    bump = _travel("clearance", clearance, vehicle)
    return [("bump", 1.0, bump), ("rebound", -1.0, bump if rebound is None else _travel("rebound", rebound, vehicle))]


def _travel(name: str, given: Any, vehicle: RoadVehicle) -> Any:
    """Travel to a stop in m, one number or one a wheel."""
    where, wheels = f"rare_events({name}=...)", vehicle.wheels
    if not isinstance(given, (Corners, tuple)):
        return _array(computed(checked(given, where, CLEARANCE)))
    each = tuple(given)
    if len(each) == len(vehicle.axles) != len(wheels):
        each = tuple(each[wheel.axle] for wheel in wheels.values())
    if len(each) != len(wheels) or len(wheels) == 1:
        need = f", or one a wheel ({', '.join(wheels)})" if len(wheels) > 1 else ""
        raise ValueError(f"{where} must be one value{need}, got {briefly(given)}")
    parts = [_array(checked(part, f"{where} at {wheel}", CLEARANCE)) for wheel, part in zip(wheels, each, strict=True)]
    return xr.concat([xr.DataArray(part) for part in parts], "corner").assign_coords(corner=list(wheels))


def _check_fits(level: Any, ride: _Ride, event: str) -> None:
    """Say when travels to a stop are as many as designs of a dim are not."""
    if isinstance(level, xr.DataArray):
        try:
            xr.align(ride.processes["sws"][0], level, join="exact")
        except ValueError:
            sizes = [dict(x.sizes) for x in (level, ride.processes["sws"][0])]
            raise ValueError(
                f"the travel to the {event} stop must fit the designs, got {sizes[0]} for {sizes[1]}"
            ) from None


def _check_lift_off(vehicle: RoadVehicle, space: DesignSpace, road: Road, loads: list[xr.DataArray]) -> None:
    """Say when tyre loads change infinitely fast."""
    m0, _, m2, _ = (m.values.reshape(space.size, -1) for m in loads)
    beyond = ~np.isfinite(m2).all(axis=1)
    if not beyond.any():
        return
    first = int(np.argmax(beyond))
    of = f"{type(vehicle).__name__}{space.place(first)} has an infinite rate of lift-off"
    if road.velocity_is_bounded or not np.isfinite(m0[first]).all():
        raise ValueError(
            f"{of}, as a damper passes the road's velocity on to the tyre load: pass ct=0, and a tyre that is not rigid"
        )
    raise ValueError(
        f"{of}, as tyre loads change infinitely fast on a road of white velocity: Road(contact_length=...) must be > 0 "
        "m, such as 0.1, over which a tyre levels it out"
    )
