"""The feasibility study: a quarter car tuned three ways to a full car, over the study's range of springs and dampers.

Low fidelity is the quarter car, high fidelity the full car at one corner; both are exact root mean squares on a random
road. The study, *Feasibility study of surrogate model for the application of vehicle suspension system*, 2021, states
no road, speed or place; the scenario here is a documented choice of this package.
"""

from __future__ import annotations

import dataclasses
import functools
import operator
import time
import warnings
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
import pandas as pd
import xarray as xr
from numpy.typing import NDArray
from scipy.stats import qmc

from ..metrics.response import Response
from ..metrics.ride import ride_metrics
from ..quantities import PARAMETERS, briefly, signal
from ..roads.road import DEFAULT_ROAD, Road
from ..surrogates import ExtrapolationWarning
from ..vehicles.curves import rate_of
from ..vehicles.full import FullCar
from ..vehicles.quarter import QuarterCar
from ..vehicles.vehicle import Vehicle
from .fits import fit, scores, tuned
from .optima import RUNS, Optima, Responses, verified_optima
from .published import COEFFICIENTS, CRITERIA, SURROGATES, Published, comparison, index, published, ranking

STIFFNESS = (12536.0, 24570.0)
"""Range of K_s in N/m (Table 2 of the study)."""

DAMPING = (798.0, 2235.0)
"""Range of C_s in N s/m (Table 2 of the study)."""

FEW = (5, 10, 25)
"""Numbers of high-fidelity designs on which the surrogates are fitted to see how few are enough."""

ENOUGH = 1.05
"""Few designs are enough when the RMSE over all nodes is within this factor of the fit on all nodes."""

CARRIED = ("mu", "ks", "cs", "kt", "ct")
"""What every corner of a car has."""

UNKNOWNS = {surrogate: len(names) for surrogate, names in COEFFICIENTS.items()}


@dataclass(frozen=True, eq=False)
class Study:
    """What `feasibility_study` found.

    Attributes
    ----------
    road : Road
        What the cars run over.
    corner : str
        Where the full car is measured.
    nonnegative : bool
        Whether the coefficients of RB and VB were kept from being negative.
    vehicle, low_fidelity : Vehicle
        The expensive and the cheap car.
    responses : xarray.Dataset
        ``lf``, ``hf``, ``RB``, ``VB``, ``PB`` on (ks, cs, criterion), in the unit of the coordinate ``unit``.
    accuracy : pandas.DataFrame
        R2, RMSE and MAE (the maximum absolute error) at the nodes, by (surrogate, criterion), SI units.
    coefficients : pandas.DataFrame
        a0, a1, a2 and ms by (surrogate, criterion); NaN where the model has no such term.
    held_out : pandas.DataFrame
        Like ``accuracy``, at designs that no fit has seen: halfway between neighbouring nodes, and cell centres.
    cost : pandas.DataFrame
        By (surrogate, criterion): ``unknowns`` of the fit; ``RMSE_5``, ``RMSE_10``, ``RMSE_25`` over all nodes when
        fitted on that many space-filling designs instead of on the nodes; ``enough``: the smallest of these numbers
        from which on the RMSE stays within 5 % of the fit on all nodes (NaN: none is); ``saved``: high-fidelity
        evaluations spared by it.
    seconds : dict
        Median time measured for ``lf`` and ``hf`` responses at all nodes.
    """

    road: Road
    corner: str
    nonnegative: bool
    vehicle: Vehicle
    low_fidelity: Vehicle
    responses: xr.Dataset
    accuracy: pd.DataFrame
    coefficients: pd.DataFrame
    held_out: pd.DataFrame
    cost: pd.DataFrame
    seconds: dict[str, float]

    @property
    def nodes(self) -> tuple[int, int]:
        """Number of springs and of dampers on the grid."""
        return self.responses.sizes["ks"], self.responses.sizes["cs"]

    @property
    def as_published(self) -> bool:
        """Whether the cars and the ranges of springs and dampers are the study's own."""
        ks, cs = (self.responses[name].values for name in ("ks", "cs"))
        own = [_numbers(FullCar()), _numbers(QuarterCar()), STIFFNESS, DAMPING]
        return [_numbers(self.vehicle), _numbers(self.low_fidelity), (ks[0], ks[-1]), (cs[0], cs[-1])] == own

    @property
    def published(self) -> Published:
        """The study's own ``accuracy`` and ``coefficients``, as printed, in SI units."""
        return published()

    @functools.cached_property
    def optima(self) -> Optima:
        """Where designs land that are optimised on each surrogate of few runs; searched when first asked for."""
        ks, cs = (tuple(self.responses[name].values[[0, -1]].tolist()) for name in ("ks", "cs"))
        quarter_car = _low_fidelity_functions(self.road, self.low_fidelity)
        full_car = _high_fidelity_function(self.road, self.corner, self.vehicle)
        return verified_optima(full_car, quarter_car, ks, cs, RUNS, self.nonnegative)

    def comparison(self) -> pd.DataFrame:
        """Ours beside the published value, one row an entry of Tables 3 to 5; NaN beside those of other cars."""
        table = comparison(self.accuracy, self.coefficients)
        return table if self.as_published else table.assign(published=np.nan)

    def describe(self) -> str:
        """Say in one line what was run."""
        springs, dampers = self.nodes
        ks, cs = (self.responses[name].values for name in ("ks", "cs"))
        kinds = f"own {type(self.vehicle).__name__} against {type(self.low_fidelity).__name__}"
        own = f"{kinds}, ks {ks[0]:g} to {ks[-1]:g} N/m, cs {cs[0]:g} to {cs[-1]:g} N s/m; "
        return (
            f"{'' if self.as_published else own}{springs} x {dampers} nodes, full car at {self.corner}, "
            f"{'nonnegative' if self.nonnegative else 'free'} coefficients; {self.road.describe()}"
        )

    def __repr__(self) -> str:
        """What was run, and which surrogate came nearest by each criterion."""
        return f"Study: {self.describe()}; R2 {'; '.join(f'{c} {said}' for c, said in ranking(self.accuracy).items())}"

    def _repr_html_(self) -> str:
        return self.accuracy.to_html()


def feasibility_study(
    road: Road | None = None,
    corner: str = "fr",
    nodes: tuple[int, int] = (20, 20),
    nonnegative: bool = False,
    *,
    vehicle: Vehicle | None = None,
    low_fidelity: Vehicle | None = None,
    ks: tuple[float, float] = STIFFNESS,
    cs: tuple[float, float] = DAMPING,
) -> Study:
    """Tune a quarter car to a full car by response, by variables and by sprung mass.

    Both models are evaluated on a grid over Table 2 of the study. With ``f`` the quarter car and ``F`` the full car, RB
    ``a0 + a1 f``, VB ``f + a0 + a1 K_s + a2 C_s`` and PB ``f(M_s)`` (Eqs 43 to 45) each minimise ``sum (S - F)^2``
    (Eq 46) for body acceleration, dynamic tyre load and suspension working space, root mean square each.

    Parameters
    ----------
    road : Road, optional
        `susp_ss.DEFAULT_ROAD` if None: class B at 20 m/s on an isotropic surface, the rear axle delayed.
        ``road.wheels`` restricts what the full car meets; the quarter car's one wheel always meets the road.
    corner : {"fr", "fl", "rr", "rl"}
        Where the full car is measured; its body acceleration above that corner.
    nodes : (int, int)
        Springs and dampers on the grid, both ends of Table 2 included; each >= 2.
    nonnegative : bool
        Keep the coefficients of RB and VB from being negative.
    vehicle : Vehicle, optional
        The expensive car, one number for every parameter; the study's full car if None. A spring or damper of the grid
        is that of ``corner``: where the car's corners differ, the others keep their ratio to it.
    low_fidelity : Vehicle, optional
        The cheap car, on one wheel, with a sprung mass ``ms``; the quarter car of ``corner`` if None: its unsprung
        mass and tyre, and the body's mass divided by the number of wheels.
    ks, cs : (float, float)
        Range of springs in N/m and of dampers in N s/m; Table 2 of the study if not given.

    Returns
    -------
    Study

    Raises
    ------
    TypeError, ValueError
        An argument of the wrong kind, an unknown corner, an empty grid, or a road on which the metrics are not finite.

    Examples
    --------
    >>> import susp_ss as ss
    >>> study = ss.feasibility_study(nodes=(6, 6))
    >>> study.responses["hf"].dims
    ('ks', 'cs', 'criterion')
    >>> study.coefficients.loc[("PB", "bacc"), "ms"].round(0).item()
    198.0
    """
    road = DEFAULT_ROAD if road is None else road
    car = FullCar() if vehicle is None else vehicle
    _check(road, corner, nonnegative, car)
    cheap = _quarter_of(car, corner) if low_fidelity is None else low_fidelity
    _check_low_fidelity(cheap)
    springs, dampers = grid(*checked_nodes(nodes), _range("ks", ks), _range("cs", cs))
    lf, lf_seconds = _timed(lambda: quarter_responses(springs, dampers, road, cheap))
    hf, hf_seconds = _timed(lambda: high_fidelity(springs, dampers, road, corner, car))
    X, F = designs(springs, dampers), hf.values.reshape(-1, len(CRITERIA))
    quarter_car = _low_fidelity_functions(road, cheap)
    fitted = fit(X, F, quarter_car, nonnegative)
    at_nodes = scores(fitted, X, F)
    halfway = between(springs, dampers)
    evaluate = _high_fidelity_function(road, corner, car)
    return Study(
        road=road,
        corner=corner,
        nonnegative=bool(nonnegative),
        vehicle=car,
        low_fidelity=cheap,
        responses=_responses(lf, hf, fitted, X, road, corner),
        accuracy=at_nodes,
        coefficients=tuned(fitted),
        held_out=scores(fitted, halfway, evaluate(halfway)),
        cost=_cost(X, F, at_nodes, evaluate, quarter_car, nonnegative),
        seconds={"lf": lf_seconds, "hf": hf_seconds},
    )


def grid(
    springs: int, dampers: int, ks: tuple[float, float] = STIFFNESS, cs: tuple[float, float] = DAMPING
) -> tuple[xr.DataArray, xr.DataArray]:
    """Springs on dim ks and dampers on dim cs, evenly, both ends included."""

    def axis(name: str, bounds: tuple[float, float], count: int) -> xr.DataArray:
        values = np.linspace(*bounds, count)
        array = xr.DataArray(values, dims=name, coords={name: values})
        array[name].attrs = {"units": PARAMETERS[name].unit, "long_name": PARAMETERS[name].meaning}
        return array

    return axis("ks", ks, springs), axis("cs", cs, dampers)


def designs(ks: xr.DataArray, cs: xr.DataArray) -> NDArray[np.float64]:
    """Every node of a grid as a row (K_s, C_s), springs outermost."""
    return np.stack([axis.values.ravel() for axis in xr.broadcast(ks, cs)], axis=-1)


def between(ks: xr.DataArray, cs: xr.DataArray) -> NDArray[np.float64]:
    """Designs halfway between neighbouring nodes of a grid, and in the middle of its cells."""
    rows = [np.linspace(axis[0], axis[-1], 2 * axis.size - 1) for axis in (ks.values, cs.values)]
    i, j = np.indices([len(row) for row in rows])
    new = (i % 2 == 1) | (j % 2 == 1)
    return np.stack([rows[0][i[new]], rows[1][j[new]]], axis=-1)


def quarter_responses(ks: Any, cs: Any, road: Road, cheap: Vehicle) -> xr.DataArray:
    """The cheap car's three criteria, along a last dim ``criterion``."""
    return by_criterion(ride_metrics(cheap.replaced(ks=ks, cs=cs), dataclasses.replace(road, wheels=None)))


def high_fidelity(ks: Any, cs: Any, road: Road, corner: str, car: Vehicle) -> xr.DataArray:
    """The expensive car's three criteria at a corner, along a last dim ``criterion``."""
    settings: dict[str, Any] = {}
    for name, values in (("ks", ks), ("cs", cs)):
        own = dict(zip(car.wheels, map(rate_of, car.at_wheels(name)), strict=True))
        if len(set(car.at_wheels(name))) == 1:
            settings[name] = values
        else:
            settings |= {signal(name, wheel): values * (value / own[corner]) for wheel, value in own.items()}
    metrics = ride_metrics(car.replaced(**settings), road)
    return by_criterion(metrics.sel(point=corner, corner=corner).drop_vars(["point", "corner"]))


def _quarter_of(car: Vehicle, corner: str) -> QuarterCar:
    """The quarter car of a car's corner."""
    at = {name: dict(zip(car.wheels, car.at_wheels(name), strict=True))[corner] for name in ("mu", "kt", "ct")}
    return QuarterCar(ms=car.at_wheels("mb")[0] / len(car.wheels), **at)


def _numbers(car: Vehicle) -> tuple[Any, ...]:
    """Kind and every number of a car but those of the grid."""
    return type(car), *(car.at_wheels(name) for name in car.quantities() if name not in ("ks", "cs"))


def by_criterion(metrics: xr.Dataset) -> xr.DataArray:
    """Stack the study's criteria along a last dim, with their units."""
    stacked = metrics[list(CRITERIA)].to_dataarray("criterion").transpose(..., "criterion")
    stacked.attrs = {}
    return stacked.assign_coords(unit=("criterion", list(CRITERIA.values())))


def _low_fidelity_functions(road: Road, cheap: Vehicle) -> dict[str, Response]:
    own = dataclasses.replace(road, wheels=None)
    return {criterion: Response(cheap, own, criterion, parameter="ms") for criterion in CRITERIA}


def _high_fidelity_function(road: Road, corner: str, car: Vehicle) -> Responses:
    return lambda X: high_fidelity(X[:, 0], X[:, 1], road, corner, car).values


def _responses(
    lf: xr.DataArray, hf: xr.DataArray, fitted: dict[tuple[str, str], Any], X: NDArray, road: Road, corner: str
) -> xr.Dataset:
    responses = xr.Dataset({"lf": lf, "hf": hf})
    meanings = {"lf": "quarter car, low fidelity", "hf": f"full car at {corner}, high fidelity"}
    for surrogate, formula in SURROGATES.items():
        columns = [fitted[surrogate, criterion].predict(X) for criterion in CRITERIA]
        responses[surrogate] = hf.copy(data=np.stack(columns, axis=-1).reshape(hf.shape))
        meanings[surrogate] = f"surrogate {formula}"
    for name, meaning in meanings.items():
        responses[name].attrs = {"long_name": meaning, "units": "in coordinate unit"}
    return responses.assign_attrs(road=road.describe(), corner=corner, statistic="root mean square")


def _cost(
    X: NDArray,
    F: NDArray,
    at_nodes: pd.DataFrame,
    evaluate: Responses,
    low_fidelity: dict[str, Any],
    nonnegative: bool,
) -> pd.DataFrame:
    # Unscrambled Halton points but the first, the corner of the range: every prefix fills the range.
    unit_square = qmc.Halton(2, scramble=False).random(max(FEW) + 1)[1:]
    few = qmc.scale(unit_square, X.min(axis=0), X.max(axis=0))
    F_few = evaluate(few)
    cost = pd.DataFrame({"unknowns": [UNKNOWNS[surrogate] for surrogate, _ in index()]}, index=index())
    for count in FEW:
        fitted = fit(few[:count], F_few[:count], low_fidelity, nonnegative)
        with warnings.catch_warnings():
            # Few designs leave the corners of the range outside their box; how badly, is what is measured.
            warnings.simplefilter("ignore", ExtrapolationWarning)
            cost[f"RMSE_{count}"] = scores(fitted, X, F)["RMSE"]
    near = np.array([cost[f"RMSE_{count}"] <= ENOUGH * at_nodes["RMSE"] for count in FEW])
    # Luck with few designs does not count: every larger number must be near as well.
    enough = np.logical_and.accumulate(near[::-1])[::-1]
    cost["enough"] = np.select(list(enough), FEW, default=np.nan)
    cost["saved"] = len(X) - cost["enough"]
    return cost


def _timed(run: Callable[[], Any]) -> tuple[Any, float]:
    seconds = []
    for _ in range(3):
        start = time.perf_counter()
        result = run()
        seconds.append(time.perf_counter() - start)
    return result, float(np.median(seconds))


def _check(road: Any, corner: Any, nonnegative: Any, car: Any) -> None:
    if not isinstance(road, Road):
        raise TypeError(f"road must be a Road, such as Road.iso8608('B', speed=20.0), got {briefly(road)}")
    road.single("feasibility_study")
    if not isinstance(car, Vehicle):
        raise TypeError(f"vehicle must be a vehicle, such as FullCar(), got {briefly(car)}")
    if not {"mb", *CARRIED} <= set(car.quantities()) or len(car.wheels) < 2:
        raise ValueError(f"vehicle must be a car of several wheels, such as FullCar(), got a {type(car).__name__}")
    if car.design_space().dims:
        raise ValueError("vehicle must have one number for every parameter, got arrays; ks and cs give the grid")
    if not isinstance(corner, str) or corner not in car.wheels:
        raise ValueError(f"no corner named {corner!r}, available: {', '.join(car.wheels)}")
    for name in ("ks", "cs"):
        if not all(rate_of(value) > 0.0 for value in car.at_wheels(name)):
            raise ValueError(f"vehicle needs {name} > 0 at every corner, to keep their ratio over the grid")
    if not isinstance(nonnegative, (bool, np.bool_)):
        raise TypeError(f"nonnegative must be True or False, got {briefly(nonnegative)}")


def _check_low_fidelity(cheap: Any) -> None:
    if not isinstance(cheap, Vehicle):
        raise TypeError(f"low_fidelity must be a vehicle, such as QuarterCar(), got {briefly(cheap)}")
    if len(cheap.wheels) != 1 or not {"ms", "ks", "cs"} <= set(cheap.quantities()):
        raise ValueError(
            f"low_fidelity must be a car on one wheel with ms, ks and cs, such as QuarterCar(), got a "
            f"{type(cheap).__name__}"
        )
    if cheap.design_space().dims:
        raise ValueError("low_fidelity must have one number for every parameter, got arrays")


def _range(name: str, bounds: Any) -> tuple[float, float]:
    quantity = PARAMETERS[name]
    values = np.asarray(bounds)
    need = f"{name} must be two numbers {quantity.bound} {quantity.unit}, lowest and highest"
    if values.shape != (2,) or values.dtype.kind not in "iuf":
        raise TypeError(f"{need}, got {briefly(bounds)}")
    low, high = map(float, values)
    if not 0.0 < low < high < np.inf:
        raise ValueError(f"{need}, got {briefly(bounds)}")
    return low, high


def checked_nodes(nodes: Any) -> tuple[int, int]:
    """Return the numbers of springs and dampers, or say what is wrong with them."""
    need = "nodes must be two whole numbers >= 2, springs and dampers, such as (20, 20)"
    try:
        springs, dampers = (operator.index(count) for count in nodes)
    except (TypeError, ValueError):
        raise TypeError(f"{need}, got {briefly(nodes)}") from None
    if min(springs, dampers) < 2:
        raise ValueError(f"{need}, got {briefly(nodes)}")
    return springs, dampers
