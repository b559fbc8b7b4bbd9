"""Where a design lands that was optimised on a surrogate, once the expensive model has judged it.

The study's aim is a cheap model to optimise a suspension on, and its tables say how well one predicts. Here each
surrogate, fitted to few runs, is searched for the least body acceleration while working space and tyre load stay near
those in the middle of the range.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from ..design.search import Programme, Search
from ..surrogates import CoKriging, ExtrapolationWarning, Kriging, sample
from .fits import fit_criterion
from .published import CRITERIA
from .tabulated import Tabulated

Array = NDArray[np.float64]
Responses = Callable[[Array], Array]
"""Designs (n, 2) to the three criteria (n, 3)."""

RUNS = (5, 10, 25, 60)
"""Numbers of expensive runs that surrogates are fitted to."""

MORE = 1.05
"""Working space and tyre load may be so many times those in the middle of the range."""

NEAR = 1e-3
"""Relative distance from the optimum, and excess over a limit, up to which a design has met it."""

# Central differences along the unit square.
STEP = 1e-4

# Descents of a search: over two variables the best of its sample lies in the right valley.
STARTS = 1

GOAL, LIMITED = "bacc", ("dtl", "sws")


@dataclass(frozen=True, eq=False)
class Optima:
    """What `verified_optima` found.

    Attributes
    ----------
    limits : dict of str to float
        Largest tyre load in N and working space in m.
    best : Series
        The true optimum: ks, cs and its three criteria, SI units.
    middle : float
        By how much, relatively, body acceleration in the middle of the range is beyond that of the optimum.
    landed : DataFrame
        By (surrogate, runs): ks, cs and the expensive model's three criteria of the design that came out; ``beyond``,
        its body acceleration relative to that of the optimum, less one; and ``excess`` over the worse limit, relative
        to it, 0 where both are kept.
    """

    limits: dict[str, float]
    best: pd.Series
    middle: float
    landed: pd.DataFrame

    def __repr__(self) -> str:
        """How far the middle of the range is from the optimum, and how many runs are enough."""
        said = ", ".join(f"{name} {'-' if runs is None else runs}" for name, runs in self.enough().items())
        return f"Optima: the middle of the range {self.middle:+.2%} from the true optimum; runs that reach it: {said}"

    def _repr_html_(self) -> str:
        return self.landed.to_html()

    def enough(self) -> dict[str, int | None]:
        """Say for each surrogate from how many runs on it comes within 0.1 % of optimum and limits; None: it does not.

        Returns
        -------
        dict of str to int or None
        """
        near = (self.landed["beyond"].abs() <= NEAR) & (self.landed["excess"] <= NEAR)
        found: dict[str, int | None] = {}
        for surrogate, met in near.groupby(level="surrogate", sort=False):
            # Luck with few runs does not count: every larger number must be near as well.
            onwards = met.droplevel("surrogate")[::-1].cummin()
            found[str(surrogate)] = min(onwards.index[onwards.to_numpy()], default=None)
        return found


def verified_optima(
    expensive: Responses,
    low_fidelity: Mapping[str, Any],
    ks: tuple[float, float],
    cs: tuple[float, float],
    runs: Sequence[int],
    nonnegative: bool = False,
    sought: Responses | None = None,
) -> Optima:
    """Optimise on RB, VB, PB, Kriging and co-Kriging of few runs, and verify each design on the expensive model.

    Least body acceleration, with tyre load and working space at most 1.05 times those in the middle of the range.

    Parameters
    ----------
    expensive : callable
        Designs (n, 2) of springs in N/m and dampers in N s/m to body acceleration, tyre load and working space (n, 3).
    low_fidelity : mapping
        For each criterion a callable ``f(X)`` and ``f(X, ms)``, as `Response` is.
    ks, cs : (float, float)
        Range of springs and dampers.
    runs : sequence of int
        How many each surrogate is fitted to: Latin hypercubes, one a number.
    nonnegative : bool
        Keep the coefficients of RB and VB from being negative.
    sought : callable, optional
        Like ``expensive``, searched for the true optimum in its place.

    Returns
    -------
    Optima

    Examples
    --------
    The quarter car is its own best surrogate:

    >>> import numpy as np
    >>> from susp_ss import QuarterCar, Response, Road
    >>> from susp_ss.study.optima import verified_optima
    >>> cheap = {name: Response(QuarterCar(), Road(), name, parameter="ms") for name in ("bacc", "dtl", "sws")}
    >>> itself = lambda X: np.stack([one(X) for one in cheap.values()], axis=-1)
    >>> found = verified_optima(itself, cheap, (12e3, 25e3), (800.0, 2200.0), [5])
    >>> bool(abs(found.landed.loc[("RB", 5), "beyond"]) < 1e-6)
    True
    """
    low, width = np.array([ks[0], cs[0]]), np.array([ks[1] - ks[0], cs[1] - cs[0]])

    def judged(u: Array) -> pd.Series:
        design = low + u * width
        return pd.Series([*design, *expensive(design[None])[0]], index=["ks", "cs", *CRITERIA])

    middle = judged(np.full(2, 0.5))
    limits = {name: MORE * float(middle[name]) for name in LIMITED}

    def searched(responses: Responses) -> pd.Series:
        return judged(_least(lambda U: responses(low + U * width), limits))

    best = searched(sought or expensive)
    rows = {}
    for count in runs:
        X = sample({"ks": ks, "cs": cs}, count, random_state=1).to_numpy()
        for surrogate, predict in _fitted(X, expensive(X), low_fidelity, nonnegative).items():
            rows[surrogate, count] = searched(predict)
    index = pd.MultiIndex.from_product([dict.fromkeys(name for name, _ in rows), runs], names=["surrogate", "runs"])
    landed = pd.DataFrame([rows[key] for key in index], index=index)
    over = landed[list(limits)] / pd.Series(limits) - 1.0
    landed = landed.assign(beyond=landed[GOAL] / best[GOAL] - 1.0, excess=over.max(axis=1).clip(lower=0.0))
    return Optima(limits, best, float(middle[GOAL] / best[GOAL] - 1.0), landed)


def _fitted(X: Array, F: Array, low_fidelity: Mapping[str, Any], nonnegative: bool) -> dict[str, Responses]:
    """What each surrogate of runs X (n, 2) with responses F (n, 3) predicts."""
    models: dict[str, list[Any]] = {}
    with warnings.catch_warnings():
        # What comes of a mass on its bound is what is measured.
        warnings.filterwarnings("ignore", message="the tuned parameter")
        for criterion, y in zip(CRITERIA, F.T, strict=True):
            f = low_fidelity[criterion]
            fitted = fit_criterion(X, y, Tabulated(f, X), nonnegative)
            fitted |= {"Kriging": Kriging().fit(X, y), "CoKriging": CoKriging(f).fit(X, y)}
            for surrogate, model in fitted.items():
                models.setdefault(surrogate, []).append(model)
    return {name: partial(_predicted, some) for name, some in models.items()}


def _predicted(models: list[Any], X: Array) -> Array:
    with warnings.catch_warnings():
        # Few runs leave the corners of the range outside their box; how badly, is what is measured.
        warnings.simplefilter("ignore", ExtrapolationWarning)
        return np.stack([model.predict(X) for model in models], axis=-1)


@dataclass(frozen=True)
class _OnUnitSquare:
    """The three criteria over the unit square, as `Search` takes them."""

    values: Responses
    names = tuple(CRITERIA)
    k = 2
    smooth = True

    def few(self) -> _OnUnitSquare:
        """Itself: nothing judges it faster."""
        return self

    def slopes(self, U: Array) -> Array:
        """Derivatives (N, 3, 2)."""
        up, down = (np.clip(U[:, None] + sign * STEP * np.eye(2), 0.0, 1.0) for sign in (1.0, -1.0))
        values = self.values(np.concatenate([up, down]).reshape(-1, 2))
        above, below = values.reshape(2, len(U), 2, len(self.names))
        return np.asarray(np.swapaxes((above - below) / np.sum(up - down, axis=-1)[..., None], 1, 2))


def _least(values: Responses, limits: Mapping[str, float]) -> Array:
    """Where in the unit square the goal is least within the limits; where none is within them, the nearest to them."""
    search = Search(_OnUnitSquare(values), STARTS)
    place = {name: i for i, name in enumerate(search.problem.names)}
    bounds = {place[name]: limit for name, limit in limits.items()}
    (point,) = search.least([Programme(place[GOAL], bounds)])
    return (search.nearest(bounds) if point is None else point).u
