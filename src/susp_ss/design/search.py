"""Least values under limits: sequential quadratic programmes from the best designs of a sample."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from ..surrogates.sampling import sample

Array = NDArray[np.float64]

# Designs of the sample, which only say where to start.
DESIGNS = 2**11

# Starts from the sample where there is no neighbour, so far apart in the unit cube.
STARTS, APART = 3, 0.25

# By how much, relatively, a limit may be exceeded.
MET = 1e-6

# When a descent ends, and after how many steps at the latest: on smooth metrics, and on those with kinks, where another
# scenario becomes the worst.
SMOOTH = {"ftol": 1e-10, "maxiter": 100}
KINKED = {"ftol": 1e-6, "maxiter": 25}


class Searchable(Protocol):
    """Metrics as smooth functions over the unit cube, such as a `Problem`."""

    @property
    def k(self) -> int:
        """Number of variables."""

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the metrics."""

    @property
    def smooth(self) -> bool:
        """Whether metrics have no kinks."""

    def values(self, U: Array, /) -> Array:
        """Metrics (N, metrics) at points (N, k)."""

    def slopes(self, u: Array, /) -> Array:
        """Derivatives (metrics, k) at a point."""

    def few(self) -> Searchable:
        """The same, judged fast, to say where to start."""


class Point(NamedTuple):
    """A design in the unit cube (k,) and its named metrics."""

    u: Array
    values: Array


class Search:
    """Minimises one of a problem's metrics under limits of others."""

    def __init__(self, problem: Searchable, starts: int = STARTS):
        self.problem, self.starts = problem, starts
        self.evaluated = {"values": 0, "slopes": 0}
        self.U = sample({str(j): (0.0, 1.0) for j in range(problem.k)}, DESIGNS, "sobol").to_numpy()
        self.seen = problem.few().values(self.U)
        # Every metric in proportion to what is usual.
        self.sizes = np.median(self.seen, axis=0)

    def least(self, goal: int, limits: Mapping[int, float], starts: Sequence[Array] = ()) -> Point | None:
        """The design whose metric ``goal`` is least while others stay within limits; None: none is found.

        Metrics are told by their place among the names.
        """
        found = [self._descend(goal, limits, u) for u in self._starts(goal, limits, starts)]
        met = [point for point in found if self.excess(point.values, limits) <= MET]
        return min(met, key=lambda point: float(point.values[goal])) if met else None

    def nearest(self, limits: Mapping[int, float]) -> Point:
        """The design whose largest excess over limits is least."""
        excess = np.max([self.seen[:, i] / limit for i, limit in limits.items()], axis=0)
        found = [self._descend_excess(limits, self.U[i]) for i in np.argsort(excess)[: self.starts]]
        return min(found, key=lambda point: self.excess(point.values, limits))

    def met(self, limits: Mapping[int, float]) -> NDArray[np.bool_]:
        """Which designs of the sample are within limits."""
        return np.asarray(self._over(limits) == 0.0)

    def _over(self, limits: Mapping[int, float]) -> Array:
        """By how much each design of the sample exceeds the limits at most, relatively."""
        over = np.zeros(len(self.seen))
        for i, limit in limits.items():
            over = np.maximum(over, self.seen[:, i] / limit - 1.0)
        return over

    @staticmethod
    def excess(values: Array, limits: Mapping[int, float]) -> float:
        """By how much the limits are exceeded at most, relatively."""
        return max((float(values[i] / limit - 1.0) for i, limit in limits.items()), default=0.0)

    def _starts(self, goal: int, limits: Mapping[int, float], near: Sequence[Array]) -> list[Array]:
        """Where to start: near others' solutions, and from the best of the sample."""
        order = np.lexsort((self.seen[:, goal], self._over(limits)))
        chosen = list(near)
        for u in self.U[order]:
            if len(chosen) >= max(self.starts if not near else 0, len(near) + 1):
                break
            if all(np.abs(u - other).max() > APART for other in chosen[len(near) :]):
                chosen.append(u)
        return chosen

    def _descend(self, goal: int, limits: Mapping[int, float], start: Array) -> Point:
        from scipy.optimize import minimize

        at = _Remembered(self)
        rows, bounds = [*limits], np.array([*limits.values()])
        within: Any = {
            "type": "ineq",
            "fun": lambda u: 1.0 - at.values(u)[rows] / bounds,
            "jac": lambda u: -at.slopes(u)[rows] / bounds[:, None],
        }
        best = minimize(
            lambda u: at.values(u)[goal] / self.sizes[goal],
            start,
            jac=lambda u: at.slopes(u)[goal] / self.sizes[goal],
            method="SLSQP",
            bounds=[(0.0, 1.0)] * len(start),
            constraints=within if rows else (),
            options=SMOOTH if self.problem.smooth else KINKED,
        )
        return at.point(best.x)

    def _descend_excess(self, limits: Mapping[int, float], start: Array) -> Point:
        """Minimise t such that no metric exceeds t of its limit."""
        from scipy.optimize import minimize

        at = _Remembered(self)
        rows, bounds = [*limits], np.array([*limits.values()])
        first = np.max(at.values(start)[rows] / bounds)
        only_t = np.append(np.zeros(len(start)), 1.0)
        within: Any = {
            "type": "ineq",
            "fun": lambda x: x[-1] - at.values(x[:-1])[rows] / bounds,
            "jac": lambda x: np.column_stack([-at.slopes(x[:-1])[rows] / bounds[:, None], np.ones(len(rows))]),
        }
        best = minimize(
            lambda x: x[-1],
            np.append(start, first),
            jac=lambda x: only_t,
            method="SLSQP",
            bounds=[(0.0, 1.0)] * len(start) + [(0.0, None)],
            constraints=within,
            options=SMOOTH if self.problem.smooth else KINKED,
        )
        return at.point(best.x[:-1])


class _Remembered:
    """Values and slopes at the design asked for last."""

    def __init__(self, search: Search):
        self.search = search
        self.known: dict[tuple[str, bytes], Array] = {}

    def values(self, u: Array) -> Array:
        return self._known("values", u, lambda u: self.search.problem.values(u[None])[0])

    def slopes(self, u: Array) -> Array:
        return self._known("slopes", u, self.search.problem.slopes)

    def point(self, u: Array) -> Point:
        inside = np.clip(u, 0.0, 1.0)
        return Point(inside, self.values(inside))

    def _known(self, what: str, u: Array, compute: Any) -> Array:
        inside = np.clip(u, 0.0, 1.0)
        key = what, inside.tobytes()
        if key not in self.known:
            self.search.evaluated[what] += 1
            self.known[key] = compute(inside)
        return self.known[key]
