"""How far any suspension could go: the least of one root mean square under limits of others, over all causal laws."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np
import xarray as xr

from ..metrics.ride import ride_metrics
from ..progress import tracked
from ..quantities import briefly
from .dual import LIGHT, MET, RESOLVED, SLOWEST, Solution, Task, best_gain, solve
from .plant import Plant, plant
from .preview import Law
from .result import Feedback
from .semidefinite import check_solver, programme


@dataclass(frozen=True, eq=False, repr=False)
class ActiveBound(Feedback):
    """The least root mean square of one output over all laws, and the law that reaches it.

    Attributes
    ----------
    minimise : str
        Which output.
    bound : float
        The root mean square that the law reaches, in the output's SI unit.
    unresolved : float
        How much lower, relatively, forces of any bandwidth might still come; 0 where that changes nothing.
    limits : dict of str to float
        Of every output that was limited, by its name with its place.
    multipliers : dict of str to float
        How much the bound falls per unit by which a limit is raised, in their SI units: the limits' shadow prices. None
        of a gain that is only the best found.
    preview : bool
        Whether the law also acts on what it knows of the road ahead of the axles behind.
    least : float
        No law comes below this, by the semidefinite programme; NaN where that was not asked for, or had no answer.
    """

    minimise: str = ""
    bound: float = float("nan")
    unresolved: float = 0.0
    limits: Mapping[str, float] = field(default_factory=dict)
    multipliers: Mapping[str, float] = field(default_factory=dict)
    preview: bool = True
    least: float = float("nan")

    def __repr__(self) -> str:
        metric, _, place = self.minimise.partition("@")
        data = self.passive.get(metric)
        before = "" if data is None else f", passive {float(data.sel({data.dims[0]: place}) if place else data):.4g}"
        unit = self.metrics[metric].attrs["units"]
        return f"active bound on {type(self.vehicle).__name__}: {self.minimise} >= {self.bound:.4g} {unit}{before}"


@dataclass(frozen=True, eq=False, repr=False)
class ActiveFront:
    """Active bounds over limits that were arrays.

    Attributes
    ----------
    minimise : str
        Which output.
    bound : xarray.DataArray
        Over the limits' dims; NaN where no law meets the limits.
    metrics, multipliers : xarray.Dataset
        As of an `ActiveBound`, over the same dims.
    passive : xarray.Dataset
        Of the vehicle by itself.
    limits : dict of str to DataArray
        Of every output that was limited, by its name with its place.
    least : xarray.DataArray
        As of an `ActiveBound`, over the same dims.
    points : list of ActiveBound or None
        In the order of the flattened dims.
    """

    minimise: str
    bound: xr.DataArray
    metrics: xr.Dataset
    multipliers: xr.Dataset
    passive: xr.Dataset
    limits: Mapping[str, xr.DataArray]
    least: xr.DataArray
    points: list[ActiveBound | None]

    def __repr__(self) -> str:
        met = int(self.bound.notnull().sum())
        return (
            f"active front of {self.minimise} over {', '.join(map(str, self.bound.dims))}: {met} of {self.bound.size} "
            f"points within reach, {float(self.bound.min()):.4g} to {float(self.bound.max()):.4g} "
            f"{self.bound.attrs['units']}"
        )

    def _repr_html_(self) -> str:
        return str(self.bound.to_dataframe(name=self.minimise).to_html())


def active_bound(
    vehicle: Any,
    road: Any,
    minimise: str = "bacc",
    limits: Mapping[str, Any] | None = None,
    weighting: Any = None,
    preview: bool = True,
    certify: str | None = None,
) -> ActiveBound | ActiveFront:
    """Least root mean square of one output over all feedback laws under limits of others, and the law that reaches it.

    ``min E[y0^2]`` such that ``E[y_i^2] <= l_i^2`` over every causal law of forces between wheels and body that knows
    the whole state, and what each axle has met, which those behind will meet a wheelbase later. Linear, nonlinear,
    active or semi-active: none comes below. The dual ``max_lambda min_u E[y0^2 + sum lambda_i (y_i^2 - l_i^2)]`` has
    its inner minimum by a Riccati equation with preview in closed form (``feedback.preview``).

    Parameters
    ----------
    vehicle : Vehicle
        With one number for every parameter.
    road : Road
    minimise : str
        An output: ``"bacc@cg"``, ``"dtl@fr"``, or ``"bacc"`` where it has one place.
    limits : mapping of str to float, array or DataArray
        Root mean squares not to be exceeded, in SI units, by output: ``{"sws@fr": 0.02, "dtl": 900.0}``; without a
        place they hold at every place. ``force`` (N) is that of the actuators. Arrays make a front, on dim ``limit`` or
        on those of DataArrays; one point after another starts from the last.
    weighting : optional
        As in `ride_metrics`: outputs are minimised and limited behind their filters.
    preview : bool
        False: the law is a gain on the vehicle's states alone.
    certify : {"clarabel", "scs"}, optional
        Solve the problem by this solver as one semidefinite programme as well (``feedback.semidefinite``), for
        ``least``. The road's velocity must be white and come to all axles at once: ``Road(delay=False)``.

    Returns
    -------
    ActiveBound, or ActiveFront where limits are arrays

    Raises
    ------
    TypeError, ValueError
        An output without a place or of no finite variance; limits that no law meets, with the least value that each
        can have while the others are met; ``certify`` on a road with a delay or a colour.

    Notes
    -----
    With ``preview=True`` the bound is global and met by its law, to the digits of ``unresolved``: where fewer outputs
    with a force in them are minimised or limited than there are actuators, laws may grow without end as they come
    closer, and a small weight on forces ends that. Limit ``force`` to see what real actuators may do. With
    ``preview=False`` and a road that comes to a second axle later, or is not white, the problem is not convex: the gain
    is the best found by descent from that of the problem with preview, and the bound what this gain reaches.

    Examples
    --------
    How far the passive quarter car is from the best suspension of the same working space and tyre load:

    >>> import susp_ss as ss
    >>> car, road = ss.QuarterCar(), ss.Road.iso8608("B", speed=20.0)
    >>> passive = ss.ride_metrics(car, road)
    >>> best = ss.active_bound(car, road, "bacc", {"sws": float(passive.sws), "dtl": float(passive.dtl)})
    >>> best
    active bound on QuarterCar: bacc >= 0.6014 m/s^2, passive 0.6842
    >>> bool(abs(ss.ride_metrics(best.closed, road).bacc / best.bound - 1.0) < 1e-6)
    True

    The same by a semidefinite programme, with which the law shares nothing:

    >>> best = ss.active_bound(car, road, "bacc", dict(best.limits), certify="clarabel")
    >>> bool(abs(best.least / best.bound - 1.0) < 1e-5)
    True
    """
    if not isinstance(preview, (bool, np.bool_)):
        raise TypeError(f"preview must be True or False, got {briefly(preview)}")
    known = plant(vehicle, road, weighting, "active_bound")
    goal = known.named(minimise, "minimise")
    if len(goal) > 1:
        raise ValueError(f"minimise must be an output at one place, got {minimise!r}; available: {', '.join(goal)}")
    ((name, row),) = goal.items()
    grid = _limits(known, {} if limits is None else limits, name)
    problem = _Problem(known, vehicle, ride_metrics(vehicle, road, weighting=weighting), name, row, preview)
    tasks = [
        problem.task({str(one): float(value.values[at]) for one, value in grid.items()})
        for at in np.ndindex(*grid.sizes.values())
    ]
    if certify is not None:
        check_solver(certify, known)
        problem = problem._replace(least=programme(known, tasks[0], certify))
    if not grid.sizes:
        (task,) = tasks
        found, solved = problem.bound(task)
        if found is None and solved is not None:
            raise ValueError("limits: no gain on the states alone was found that meets them; pass preview=True")
        if found is None:
            raise ValueError(_beyond(known, task))
        return found
    points: list[ActiveBound | None] = []
    last: Solution | None = None
    for task in tracked(tasks, "bounding"):
        found, last = problem.bound(task, last)
        points.append(found)
    return _front(grid, points, problem)


class _Problem(NamedTuple):
    """What all points of a front share."""

    plant: Plant
    vehicle: Any
    passive: xr.Dataset
    name: str
    row: int
    preview: bool
    least: Callable[[Task], float] = lambda task: float("nan")

    def task(self, limits: Mapping[str, float]) -> Task:
        """The outputs of the system behind names, in proportion to the passive vehicle."""
        known = self.plant
        alone, forces = known.variances(Law(known.no_force)), known.forces
        felt = np.abs(known.system.D[: len(known.layout.outputs)]).max(axis=1)
        felt[forces] = 0.0
        moved = felt > 0.0
        force = float((alone[: len(felt)][moved] / felt[moved] ** 2).max()) if moved.any() else 1.0
        row = int(known.rows[self.row])
        size = force if row in np.arange(len(felt))[forces] else float(alone[row])
        if known.still[self.row]:
            raise ValueError(f"minimise: {self.name} is at rest on this road without any force")
        rows = [int(known.rows[known.named(name, "limits")[name]]) for name in limits]
        return Task(row, size, np.array(rows, dtype=int), np.array([*limits.values()]) ** 2, force, tuple(limits))

    def bound(self, task: Task, start: Solution | None = None) -> tuple[ActiveBound | None, Solution | None]:
        """The bound, and the solution from which one nearby may start; nothing where no law meets the limits."""
        known, change = self.plant, np.inf
        # Nearby the same weights are needed as there, and the one before to compare with.
        first, *lighter = LIGHT if start is None else LIGHT[LIGHT.index(start.light) - 1 :]
        fine = solve(known, task, first, start)
        if fine.excess(task).max(initial=0.0) > MET:
            return None, None
        for light in lighter:
            coarse, fine = fine, solve(known, task, light, fine)
            if fine.excess(task).max(initial=0.0) > MET:
                return None, None
            levels = [np.sqrt(one.variances[task.row] / task.size) for one in (coarse, fine)]
            change = levels[0] - levels[1]
            if change < RESOLVED:
                break
        blind = known.looks_ahead and not self.preview
        law = best_gain(known, task, fine) if blind else fine.law
        if law is None:
            return None, fine
        variances = known.variances(law)
        bound = float(np.sqrt(variances[task.row]))
        finite = blind or not known.looks_ahead
        limits = np.sqrt(task.limits)
        prices = fine.multipliers * task.size / (limits * bound)
        return ActiveBound(
            kind="active bound",
            vehicle=self.vehicle,
            road=known.road,
            metrics=known.metrics(variances),
            passive=self.passive,
            closed=known.closed(law.K, named=False) if finite else None,
            gain=known.gain(law.K),
            minimise=self.name,
            bound=bound,
            unresolved=0.0 if blind or change < RESOLVED else min(1.0, float(change / levels[1] / SLOWEST)),
            limits=dict(zip(task.names, limits.tolist(), strict=True)),
            multipliers={} if blind else dict(zip(task.names, prices.tolist(), strict=True)),
            preview=self.preview,
            least=float(np.sqrt(self.least(task))),
        ), fine


def _limits(known: Plant, limits: Any, minimised: str) -> xr.Dataset:
    """The limits of every output that they name, over common dims.

    Raises
    ------
    TypeError, ValueError
        No positive numbers, or the output that is minimised.
    """
    if not isinstance(limits, Mapping):
        raise TypeError(f'limits must be a mapping such as {{"sws@fr": 0.02}}, got {briefly(limits)}')
    found: dict[str, xr.DataArray] = {}
    # A place's own limit goes before that of all places.
    for name in sorted(limits, key=lambda name: "@" in str(name)):
        places, given = known.named(name, "limits"), limits[name]
        plain = given if isinstance(given, xr.DataArray) else np.asarray(given)
        if plain.dtype.kind not in "iuf":
            raise TypeError(f"limits: {name} must be a root mean square > 0 or an array of them, got {briefly(given)}")
        if not (plain.size and np.isfinite(plain).all() and (plain > 0.0).all()):
            raise ValueError(f"limits: {name} must be finite and > 0, got {briefly(given)}")
        if plain.ndim > 1 and not isinstance(plain, xr.DataArray):
            raise ValueError(f"limits: {name} must be a number, a row of them or a DataArray, got {briefly(given)}")
        taken = [dim for dim in getattr(plain, "dims", ()) if dim in known.layout.variables]
        if taken:
            raise ValueError(f"limits: {name} has a dim named {taken[0]!r} as a metric is; rename it, {taken[0]}_limit")
        array = plain if isinstance(plain, xr.DataArray) else xr.DataArray(plain, dims=["limit"][: plain.ndim])
        unit = known.layout.outputs.quantities[name.partition("@")[0]].unit
        found |= dict.fromkeys(places, array.astype(float).assign_attrs(units=unit))
    if minimised in found:
        raise ValueError(f"limits: {minimised} is what is minimised; limit other outputs")
    lengths = {array.sizes["limit"] for array in found.values() if "limit" in array.sizes}
    if len(lengths) > 1:
        raise ValueError(f"limits must be arrays of one length, got {', '.join(map(str, sorted(lengths)))}")
    return xr.Dataset(dict(zip(found, xr.broadcast(*found.values()), strict=True)))


def _beyond(known: Plant, task: Task) -> str:
    """Say which limits no law meets: the least of each while the others are met, or by itself."""
    said = []
    for i, (name, row, limit) in enumerate(zip(task.names, task.rows, task.limits, strict=True)):
        others = np.arange(len(task.rows)) != i
        for kept in (others, np.zeros(len(others), dtype=bool)):
            own = task._replace(row=int(row), size=float(limit), rows=task.rows[kept], limits=task.limits[kept])
            solved = solve(known, own, LIGHT[-1])
            if solved.excess(own).max(initial=0.0) <= MET:
                break
        least = float(np.sqrt(solved.variances[row]))
        if least > np.sqrt(limit):
            together = " while the others are met" if kept.any() else ""
            unit = known.layout.outputs.quantities[name.partition("@")[0]].unit
            said.append(f"{name} <= {np.sqrt(limit):.4g} {unit}, which is {least:.4g} at least{together}")
    if not said:
        nearest = np.sqrt(solve(known, task, LIGHT[-1]).variances[task.rows])
        said = [f"{name} {value:.4g}" for name, value in zip(task.names, nearest.tolist(), strict=True)]
        return f"no law meets the limits, though each by itself can be; nearest to all: {', '.join(said)}"
    return f"no law meets the limits: {'; '.join(said)}"


def _front(grid: xr.Dataset, points: list[ActiveBound | None], problem: _Problem) -> ActiveFront:
    """All points over the dims of the limits."""
    dims, shape = tuple(grid.sizes), tuple(grid.sizes.values())

    def over(values: list[float], **attrs: Any) -> xr.DataArray:
        return xr.DataArray(np.reshape(values, shape), dims=dims, coords=grid.coords, attrs=attrs)

    met = next((point for point in points if point is not None), None)
    if met is None:
        raise ValueError("limits: no law meets any of them; pass one point of them to see which contradict")
    missing = met.metrics * np.nan
    rows = [missing if point is None else point.metrics for point in points]
    metrics = xr.concat(rows, dim="point_", combine_attrs="override")
    names = [str(name) for name in grid.data_vars]
    unit = met.metrics[problem.name.partition("@")[0]].attrs["units"]
    stacked = {
        name: ((*dims, *data.dims[1:]), data.values.reshape(*shape, *data.shape[1:]), met.metrics[name].attrs)
        for name, data in metrics.data_vars.items()
    }
    labels = {name: coord for name, coord in metrics.coords.items() if "point_" not in coord.dims}
    return ActiveFront(
        minimise=problem.name,
        bound=over([np.nan if p is None else p.bound for p in points], units=unit),
        metrics=xr.Dataset(stacked, {**labels, **grid.coords}),
        multipliers=xr.Dataset(
            {name: over([np.nan if p is None else p.multipliers.get(name, np.nan) for p in points]) for name in names}
        ),
        passive=problem.passive,
        limits={str(name): limit for name, limit in grid.items()},
        least=over([np.nan if p is None else p.least for p in points], units=unit),
        points=points,
    )
