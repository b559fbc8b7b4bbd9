"""How a road excites a vehicle's wheels: independent processes, each met by one axle after the other.

Two tracks split into their mean ``m`` and half difference ``d`` (left is ``m + d``), which are uncorrelated whatever
the coherence of the tracks; identical tracks and single-track vehicles have a mean alone.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..quantities import briefly
from ..roads.road import Road
from ..vehicles.contract import Model, RoadVehicle
from ..vehicles.parameters import DesignSpace, computed
from ..vehicles.second_order import beyond_rounding

# Rates of what integrates that are no larger than this, relative to their terms, are what splitting them off leaves.
DRIFT = 1e-9


class Process(NamedTuple):
    """One scalar random process: how much of it the wheels of each axle see, (axles, wheels), each after its `delays`.

    Its spectrum is ``share + 0.5 * sign * gamma`` times that of one track.
    """

    weights: NDArray[np.float64]
    share: float
    sign: int

    @property
    def axles(self) -> NDArray[np.int_]:
        """Those that it excites; the first if it is none."""
        excited = np.flatnonzero(self.weights.any(axis=1))
        return excited if len(excited) else np.zeros(1, dtype=int)

    @property
    def delayed(self) -> bool:
        """Whether some wheels see it later than others may."""
        return bool(self.weights[1:].any())


def check_kinds(vehicle: Any, *roads: Any) -> None:
    """Say when an argument is no vehicle or no road at all.

    Raises
    ------
    TypeError
        Naming the argument and an example of what it may be.
    """
    if not isinstance(vehicle, RoadVehicle):
        raise TypeError(f"vehicle must be one of the package's vehicles, such as QuarterCar(), got {briefly(vehicle)}")
    for road in roads:
        if not isinstance(road, Road):
            raise TypeError(f"road must be a Road, such as Road.iso8608('B', speed=20.0), got {briefly(road)}")


def design_space(vehicle: RoadVehicle, road: Road) -> DesignSpace:
    """The designs that a vehicle and a road span together."""
    return DesignSpace.over([*vehicle.moving(road.speed).leaves(), *road.leaves()], type(vehicle).__name__)


def spanned(vehicle: RoadVehicle, road: Road) -> tuple[DesignSpace, Any, Road]:
    """The designs that a vehicle and a road span together, and both with all of them in one row."""
    space = design_space(vehicle, road)
    return space, vehicle.moving(road.speed).flattened(space), road.mapped(lambda x: space.flat(computed(x)))


def processes(vehicle: RoadVehicle, road: Road) -> list[Process]:
    """Split what the wheels see into independent processes.

    Raises
    ------
    ValueError
        ``road.wheels`` names a wheel that the vehicle does not have.
    """
    names = tuple(vehicle.wheels)
    for name in road.wheels or ():
        if name not in names or name == "":
            available = ", ".join(names) or f"none, a {type(vehicle).__name__} has one wheel without a name"
            raise ValueError(f"Road(wheels=...): no wheel named {name!r}, available: {available}")
    excited = np.array([road.wheels is None or name in road.wheels for name in names], dtype=float)
    axle = np.array([wheel.axle if road.delay else 0 for wheel in vehicle.wheels.values()])
    side = np.array([wheel.side for wheel in vehicle.wheels.values()], dtype=float)

    def process(weights: NDArray, share: float, sign: int) -> Process:
        return Process(np.where(axle == np.arange(len(vehicle.axles))[:, None], weights, 0.0), share, sign)

    if road.tracks == "identical" or not side.any():
        return [process(excited, 1.0, 0)]
    sign = 1 if road.tracks == "isotropic" else 0
    if sign and not np.all(np.asarray(vehicle.track_width) > 0.0):
        raise ValueError(
            f"isotropic tracks need the track width of the vehicle, and this {type(vehicle).__name__} has none; pass "
            "LinearVehicle(track_width=...) > 0 m"
        )
    return [process(excited, 0.5, sign), process(side * excited, 0.5, -sign)]


def delays(vehicle: RoadVehicle, road: Road) -> list[Any]:
    """Time in s from the first axle to each, one number or one a design."""
    return [distance / road.speed for distance in vehicle.axles]


def steep(process: Process, road: Road) -> bool:
    """Whether even the change of a process over a delay has no finite variance: from waviness 3 on, without a cut-off.

    Where tracks cohere at long waves, their difference has one.
    """
    return road.slopes[0] >= 3.0 and process.sign == 0 and not _cut_off(road)


def bounded(process: Process, road: Road) -> bool:
    """Whether the height of a process has a finite variance.

    At long waves its spectrum goes with ``n^-w``, times ``n^2`` by a cut-off, and where tracks that cohere part.
    """
    return bool(road.slopes[0] < 1.0 + 2.0 * _cut_off(road) + 2.0 * (process.sign < 0))


def _cut_off(road: Road) -> bool:
    return bool(np.all(np.asarray(road.cutoff) > 0.0))


def check_stationary(vehicle: RoadVehicle, road: Road, model: Model) -> None:
    """Say when a vehicle on a road has no stationary response.

    Raises
    ------
    ValueError
        A mode of some design is never damped, the vehicle feels the height of the road, or the wheels' heights drift
        apart in the one direction that a rigid body cannot follow.
    """
    refusal = model.refusal()
    if refusal:
        raise ValueError(f"{type(vehicle).__name__} {refusal}")
    if _cut_off(road) and road.slopes[0] < 3.0:
        return
    for process in processes(vehicle, road):
        rates, drift = integrated(model, process)
        diverges = np.any(rates != 0.0, axis=0) & steep(process, road)
        if process.sign > 0 and road.slopes[0] >= 3.0 and not _cut_off(road):
            # The mean of tracks that cohere is as steep as either: what it does over a delay must cancel as well.
            turning = [np.asarray(x)[..., None] * rate for x, rate in zip(vehicle.axles, rates, strict=True)]
            diverges = diverges | (np.abs(sum(turning)) > DRIFT * sum(map(np.abs, turning)))
        drifts = (drift != 0.0) & (not bounded(process, road))
        which = np.any(drifts | diverges, axis=tuple(range(drift.ndim - 1)))
        if which.any():
            instead = "" if _cut_off(road) else "pass cutoff > 0, or "
            raise ValueError(
                f"{model.drifting(which)} ({road.describe()}); {instead}let all wheels see a road of waviness below 3"
            )


def integrated(model: Model, process: Process) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Rates of what integrates, under the process by each axle (axles, designs..., k), and under all axles together.

    The latter is what drifts, (designs..., k): exactly zero where the wheels behind undo what those in front did.
    """
    rates = np.moveaxis(model.integrators @ process.weights.T, -1, 0)
    sizes = np.abs(model.integrators) @ np.abs(process.weights).sum(axis=0)

    def cleaned(rate: NDArray) -> NDArray:
        return np.where(np.abs(rate) > DRIFT * sizes, rate, 0.0)

    return cleaned(rates), cleaned(rates.sum(axis=0))


def infinite_outputs(model: Model, excited: list[Process], road: Road) -> NDArray[np.bool_]:
    """Outputs (designs..., outputs) that pass the road's velocity straight on, which has no finite variance.

    It has one only where its spectrum falls off at high frequency, from waviness 3 on or with a contact of some length.
    """
    if road.velocity_is_bounded:
        return np.zeros(model.on_road_velocity.shape[:-1], dtype=bool)
    weights = np.concatenate([process.weights for process in excited]).T
    passed_on, terms = model.on_road_velocity @ weights, np.abs(model.on_road_velocity) @ np.abs(weights)
    return np.any(beyond_rounding(passed_on, terms), axis=-1)


def vanishing_outputs(model: Model, excited: list[Process]) -> NDArray[np.bool_]:
    """Outputs (designs..., outputs) that no process moves, as what each wheel does to them cancels: by symmetry.

    It does so at every frequency, of which a few between the slowest and the fastest mode tell.
    """
    rates = np.abs(np.linalg.eigvals(model.A))
    H = model.relative_transfer(np.geomspace(rates.min(), rates.max(), 5))
    still = np.ones(H.shape[:-2], dtype=bool)
    for process in excited:
        moved, sizes = process.weights @ H, np.abs(process.weights) @ np.abs(H)
        still &= np.all(np.abs(moved) <= DRIFT * sizes, axis=(-2, -1))
        for rate in integrated(model, process)[0]:
            still &= (model.on_integrators @ rate[..., None])[..., 0] == 0.0
    return still
