"""Pareto fronts: the designs of a vehicle that no other beats in one objective without losing in the other."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import pandas as pd
import xarray as xr
from numpy.typing import NDArray

from ..metrics.in_memory import template
from ..metrics.outputs import check_output, output
from ..metrics.weightings import filters
from ..quantities import briefly, whole_number
from ..responses.excitation import check_kinds
from ..responses.settings import settable
from ..roads.road import Road
from ..vehicles.curves import rate_of
from ..vehicles.vehicle import Vehicle
from .bounds import REPLACED, bounded, bounds
from .halving import ends, front
from .problem import Problem
from .scenarios import Scenarios, checked_scenarios
from .search import Search

Array = NDArray[np.float64]

MOST_VARIABLES = 12


@dataclass(frozen=True, eq=False, repr=False)
class ParetoFront:
    """Designs that no other beats, from least of the first objective to least of the second; or the one best design.

    Attributes
    ----------
    vehicle, road
        What was searched; the vehicle itself is the passive default that the front stands beside.
    variables : dict of str to (low, high)
        Range of each, in SI units.
    objectives : tuple of str
        One or two metrics, such as ``"bacc@cg"``.
    limits : dict of str to float
        Of further metrics, in SI units.
    designs : pandas.DataFrame
        A row a design, a column a variable, in SI units.
    metrics : xarray.Dataset
        Every metric of the designs, on dim ``design``; with scenarios their statistic.
    own : xarray.Dataset
        The same of the vehicle itself, on dim ``design`` of length one.
    scenarios : Scenarios or None
        What they were averaged over.
    evaluations : dict of str to int
        How often metrics (``values``) and their derivatives (``slopes``) of one design were computed by the descents.
    bound : ndarray, (designs,), or None
        Where asked for, what no suspension beats: the least first objective over all feedback laws that keep the
        second, and the deflection and tyre load at every corner, where the design has them (`active_bound`).
    """

    vehicle: Vehicle
    road: Road
    variables: Mapping[str, tuple[float, float]]
    objectives: tuple[str, ...]
    limits: Mapping[str, float]
    designs: pd.DataFrame
    metrics: xr.Dataset
    own: xr.Dataset
    scenarios: Scenarios | None
    evaluations: Mapping[str, int]
    bound: Array | None = None

    @property
    def named(self) -> tuple[str, ...]:
        """Objectives and limited metrics."""
        return tuple(dict.fromkeys([*self.objectives, *self.limits]))

    def table(self) -> pd.DataFrame:
        """Variables, objectives and limited metrics of every design, in SI units."""
        table = self.designs.assign(**{name: output(self.metrics, name).to_numpy() for name in self.named})
        return table if self.bound is None else table.assign(bound=self.bound)

    def passive(self) -> pd.Series:
        """The same of the vehicle itself; NaN where its wheels differ in a variable."""
        known = self.vehicle.settings()
        values = {}
        for name in self.variables:
            field, wheels = known[name]
            at = dict(zip(self.vehicle.wheels, self.vehicle.at_wheels(field), strict=True))
            own = {float(rate_of(at[wheel])) for wheel in wheels}
            values[name] = own.pop() if len(own) == 1 else np.nan
        values |= {name: output(self.own, name).item() for name in self.named}
        return pd.Series(values)

    def vehicle_of(self, design: int) -> Vehicle:
        """The vehicle of a design, by its row."""
        return self.vehicle.replaced(**{name: self.designs[name].iloc[design] for name in self.variables})

    def __repr__(self) -> str:
        table, own = self.table(), self.passive()
        said = [
            f"{name} {table[name].min():.4g} to {table[name].max():.4g} (own {own[name]:.4g})"
            for name in self.objectives
        ]
        designs = f"{len(table)} design{'s' if len(table) > 1 else ''} of {type(self.vehicle).__name__}"
        return f"ParetoFront: {designs} over {', '.join(self.variables)}; {', '.join(said)}"

    def _repr_html_(self) -> str:
        return str(self.table().to_html())


def pareto_front(
    vehicle: Vehicle,
    road: Road,
    variables: Mapping[str, Sequence[float]],
    objectives: Sequence[str] = ("bacc@cg", "dtl@fr"),
    limits: Mapping[str, float] | None = None,
    points: int = 20,
    *,
    weighting: Any = None,
    scenarios: Any = None,
    statistic: str | float = "mean",
    bound: bool = False,
) -> ParetoFront:
    """Find the designs of a vehicle that no other beats in one objective without losing in the other.

    Each end of the front minimises one objective alone, and the other among all designs that do. Then the longest gaps
    between neighbours are halved, level by level: ``min f1(x)`` such that ``f2(x) <= e`` midway, and ``f_i(x) <= l_i``
    for the limits (the epsilon constraint; by the other objective where that is farther apart). Each is a sequential
    quadratic programme (SLSQP) on exact derivatives (`sensitivity`), started between its neighbours and from the best
    of 2048 designs that fill the ranges; those of a level go side by side, and what they ask for is computed at once.

    Parameters
    ----------
    vehicle : Vehicle
        With one number, or curve, for every parameter.
    road : Road
        Of one speed.
    variables : mapping of str to (low, high)
        Ranges in SI units of 1 to 12 parameters: fields of the vehicle, at all corners or at some (``"ks"``,
        ``"cs_front"``, ``"arb_front"``).
    objectives : sequence of str
        Two metrics of `ride_metrics`, at one place each: ``"bacc@cg"``, ``"dtl@fr"``, ``"pitch_acc"``; or one, for the
        one best design.
    limits : mapping of str to float, optional
        Largest values of further metrics in SI units, ``{"sws@fr": 0.02}``.
    points : int
        Designs of the front, >= 2.
    weighting : optional
        As in `ride_metrics`.
    scenarios : DataFrame or mapping of columns, optional
        What the vehicle meets in its life, one row a scenario: parameters of the vehicle that are no variables, and
        ``speed``, ``roughness``, ``cutoff`` of the road, in SI units; the column ``weight`` says how much a row counts.
        Every metric is then its statistic over scenarios.
    statistic : {"mean", "worst"} or float
        Over scenarios: the weighted mean, the largest value, or a quantile between 0 and 1.
    bound : bool
        Whether to compute how far each design is from what any suspension could do, half a second each. It takes
        variables that are springs, dampers or anti-roll bars, and no scenarios.

    Returns
    -------
    ParetoFront
        Dominated designs are left out, so that there may be fewer than asked for.

    Raises
    ------
    TypeError, ValueError
        Unknown or repeated names, ranges that do not rise, and limits that no design meets, with the least value that
        each can have.

    Notes
    -----
    Over scenarios derivatives are central differences, all in one batch.

    Examples
    --------
    >>> import susp_ss as ss
    >>> car, road = ss.QuarterCar(), ss.Road.iso8608("B", speed=20.0)
    >>> box = {"ks": (12e3, 25e3), "cs": (800.0, 2200.0)}
    >>> front = ss.pareto_front(car, road, box, ("bacc", "dtl"), {"sws": 0.006}, points=5)
    >>> table = front.table()
    >>> table.shape, bool((table["sws"] <= 0.006001).all())
    ((5, 5), True)
    """
    problem, ceilings = _problem(vehicle, road, variables, objectives, limits, weighting, scenarios, statistic)
    count = whole_number("points", points, 2)
    _check_bound(bound, problem)
    search = Search(problem)
    by_place = {problem.names.index(name): limit for name, limit in ceilings.items()}
    found = ends(search, (0,), by_place) if len(objectives) == 1 else front(search, by_place, count)
    designs = problem.designs(np.stack([point.u for point in found]))
    metrics = problem.metrics(designs)
    return ParetoFront(
        vehicle=vehicle,
        road=road,
        variables=problem.variables,
        objectives=tuple(objectives),
        limits=ceilings,
        designs=designs,
        metrics=metrics,
        own=problem.own(),
        scenarios=problem.scenarios,
        evaluations=search.evaluated,
        bound=bounds(vehicle, road, tuple(objectives), metrics, weighting) if bound else None,
    )


def _problem(
    vehicle: Any,
    road: Any,
    variables: Any,
    objectives: Any,
    limits: Any,
    weighting: Any,
    scenarios: Any,
    statistic: Any,
) -> tuple[Problem, dict[str, float]]:
    """What is searched and its limits, or say what is wrong."""
    check_kinds(vehicle, road)
    if not isinstance(vehicle, Vehicle) or vehicle.layout().controls:
        raise TypeError(
            f"pareto_front needs a vehicle of springs and dampers, such as FullCar(), got {briefly(vehicle)}"
        )
    if vehicle.design_space().dims:
        raise ValueError("pareto_front needs a vehicle with one number for every parameter, got arrays")
    road.single("pareto_front")
    box = _checked_variables(vehicle, variables)
    like = template(vehicle.layout(), "covariance", filters(weighting, vehicle.layout()), vehicle.curved)
    if isinstance(objectives, str) or not isinstance(objectives, Sequence) or not 1 <= len(objectives) <= 2:
        raise TypeError(
            f'objectives must be two names, or one, such as ("bacc@cg", "dtl@fr"), got {briefly(objectives)}'
        )
    for name in objectives:
        check_output(name, like, "objectives", one=True)
    if len(set(objectives)) < len(objectives):
        raise ValueError(f"objectives must differ, got {objectives[0]!r} twice")
    if limits is not None and not isinstance(limits, Mapping):
        raise TypeError(f'limits must be a mapping such as {{"sws@fr": 0.02}}, got {briefly(limits)}')
    ceilings = {}
    for name, limit in (limits or {}).items():
        check_output(name, like, "limits", one=True)
        if isinstance(limit, bool) or not isinstance(limit, (int, float, np.number)) or not 0.0 < limit < np.inf:
            raise ValueError(
                f"limits[{name!r}] must be a number > 0 {output(like, name).attrs['units']}, got {briefly(limit)}"
            )
        ceilings[name] = float(limit)
    names = tuple(dict.fromkeys([*objectives, *ceilings]))
    over = None
    if scenarios is not None:
        over = checked_scenarios(vehicle, scenarios, statistic, box)
    elif statistic != "mean":
        raise ValueError(f"statistic is taken over scenarios, got {briefly(statistic)} without any; pass scenarios")
    problem = Problem(vehicle, road, box, names, weighting, over)
    for name in names:
        value = output(problem.own(), name).item()
        if not 0.0 < value < np.inf:
            raise ValueError(f"{name} is {value:g} for every design on this road; pass another")
    return problem, ceilings


def _check_bound(bound: Any, problem: Problem) -> None:
    if not isinstance(bound, (bool, np.bool_)):
        raise TypeError(f"bound must be True or False, got {briefly(bound)}")
    fields = [problem.vehicle.settings()[name][0] for name in problem.variables]
    if bound and (problem.scenarios is not None or not bounded(fields)):
        raise ValueError(
            f"bound=True takes no scenarios, and variables among {', '.join(REPLACED)}, got "
            f"{', '.join(problem.variables)}"
        )


def _checked_variables(vehicle: Vehicle, variables: Any) -> dict[str, tuple[float, float]]:
    if not isinstance(variables, Mapping) or not 1 <= len(variables) <= MOST_VARIABLES:
        raise TypeError(
            f'variables must map 1 to {MOST_VARIABLES} names to (low, high), such as {{"ks": (12e3, 25e3)}}, got '
            f"{briefly(variables)}"
        )
    known, box = settable(vehicle), dict[str, tuple[float, float]]()
    for name, side in variables.items():
        if name not in vehicle.settings():
            raise ValueError(
                f"variables: {type(vehicle).__name__} has no parameter named {name!r}, available: "
                f"{', '.join(vehicle.settings())}"
            )
        for other in box:
            if known[name].meets(known[other]):
                raise ValueError(f"variables: {name!r} and {other!r} set one parameter, got both; pass one of them")
        try:
            low, high = map(float, side)
        except (TypeError, ValueError):
            raise TypeError(f"variables[{name!r}] must be two numbers (low, high), got {briefly(side)}") from None
        if not -np.inf < low < high < np.inf:
            raise ValueError(f"variables[{name!r}] must rise between finite numbers, got {briefly(side)}")
        vehicle.replaced(**{name: low})
        box[name] = low, high
    return box
