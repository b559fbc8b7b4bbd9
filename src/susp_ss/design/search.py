"""Least values under limits: sequential quadratic programmes from the best designs of a sample."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from typing import Any, NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from ..surrogates.sampling import sample
from .lockstep import Ask, in_lockstep

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

    def slopes(self, U: Array, /) -> Array:
        """Derivatives (N, metrics, k) at points (N, k)."""

    def few(self) -> Searchable:
        """The same, judged fast, to say where to start."""


class Point(NamedTuple):
    """A design in the unit cube (k,) and its named metrics."""

    u: Array
    values: Array


# Steps in the unit cube that are rounding: there a line search may go on for hundreds of values.
STILL = 1e-9


class Programme(NamedTuple):
    """Minimise metric ``goal`` under limits of others, metrics by their place among the names; start near designs."""

    goal: int
    limits: Mapping[int, float]
    near: Sequence[Array] = ()


class Search:
    """Minimises one of a problem's metrics under limits of others."""

    def __init__(self, problem: Searchable, starts: int = STARTS):
        self.problem, self.starts = problem, starts
        self.evaluated = {"values": 0, "slopes": 0}
        self.U = sample({str(j): (0.0, 1.0) for j in range(problem.k)}, DESIGNS, "sobol").to_numpy()
        self.seen = problem.few().values(self.U)
        # Every metric in proportion to what is usual.
        self.sizes = np.median(self.seen, axis=0)

    def least(self, programmes: Sequence[Programme]) -> list[Point | None]:
        """The design of each programme whose goal is least while limits are met; None: none is found."""
        begun = [(place, u) for place, one in enumerate(programmes) for u in self._starts(one)]
        found = self._descended(
            [partial(self._descend, programmes[place].goal, programmes[place].limits, u) for place, u in begun]
        )
        ended: list[list[Point]] = [[] for _ in programmes]
        for (place, _), point in zip(begun, found, strict=True):
            ended[place].append(point)
        return [self._best(programme, points) for programme, points in zip(programmes, ended, strict=True)]

    def _best(self, programme: Programme, found: Sequence[Point]) -> Point | None:
        met = [point for point in found if self.excess(point.values, programme.limits) <= MET]
        return min(met, key=lambda point: float(point.values[programme.goal])) if met else None

    def nearest(self, limits: Mapping[int, float]) -> Point:
        """The design whose largest excess over limits is least."""
        excess = np.max([self.seen[:, i] / limit for i, limit in limits.items()], axis=0)
        starts = self.U[np.argsort(excess)[: self.starts]]
        found = self._descended([partial(self._descend_excess, limits, start) for start in starts])
        return min(found, key=lambda point: self.excess(point.values, limits))

    def _descended(self, descents: Sequence[Callable[[Ask], Point]]) -> list[Point]:
        """Where descents end that go side by side, the designs of all in one call."""
        # Values first, so that the slopes of all, which cost more, wait for one another.
        return in_lockstep(descents, {"values": self._values, "slopes": self._slopes})

    def _values(self, U: Array) -> Array:
        self.evaluated["values"] += len(U)
        return self.problem.values(U)

    def _slopes(self, U: Array) -> Array:
        self.evaluated["slopes"] += len(U)
        return self.problem.slopes(U)

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

    def _starts(self, programme: Programme) -> list[Array]:
        """Where to start: near others' solutions, and from the best of the sample."""
        near = programme.near
        order = np.lexsort((self.seen[:, programme.goal], self._over(programme.limits)))
        chosen = list(near)
        for u in self.U[order]:
            if len(chosen) >= max(self.starts if not near else 0, len(near) + 1):
                break
            if all(np.abs(u - other).max() > APART for other in chosen[len(near) :]):
                chosen.append(u)
        return chosen

    def _descend(self, goal: int, limits: Mapping[int, float], start: Array, ask: Ask) -> Point:
        at = _Remembered(ask)
        rows, bounds = [*limits], np.array([*limits.values()])
        end = self._slsqp(
            lambda u: at.values(u)[goal] / self.sizes[goal],
            lambda u: at.slopes(u)[goal] / self.sizes[goal],
            start,
            [(0.0, 1.0)] * len(start),
            lambda u: 1.0 - at.values(u)[rows] / bounds,
            lambda u: -at.slopes(u)[rows] / bounds[:, None],
        )
        return at.point(end)

    def _descend_excess(self, limits: Mapping[int, float], start: Array, ask: Ask) -> Point:
        """Minimise t such that no metric exceeds t of its limit."""
        at = _Remembered(ask)
        rows, bounds = [*limits], np.array([*limits.values()])
        first = np.max(at.values(start)[rows] / bounds)
        only_t = np.append(np.zeros(len(start)), 1.0)
        end = self._slsqp(
            lambda x: x[-1],
            lambda x: only_t,
            np.append(start, first),
            [(0.0, 1.0)] * len(start) + [(0.0, None)],
            lambda x: x[-1] - at.values(x[:-1])[rows] / bounds,
            lambda x: np.column_stack([-at.slopes(x[:-1])[rows] / bounds[:, None], np.ones(len(rows))]),
        )
        return at.point(end[:-1])

    def _slsqp(self, least: Any, gradient: Any, start: Array, bounds: Any, positive: Any, jacobian: Any) -> Array:
        """Where the sequential quadratic programme ends, at the latest when its steps are within rounding."""
        from scipy.optimize import minimize

        last = start

        def still(x: Array) -> None:
            nonlocal last
            step, last = np.abs(x - last).max(), x.copy()
            if step <= STILL:
                raise _Still

        try:
            return np.asarray(
                minimize(
                    least,
                    start,
                    jac=gradient,
                    method="SLSQP",
                    bounds=bounds,
                    constraints={"type": "ineq", "fun": positive, "jac": jacobian},
                    options=SMOOTH if self.problem.smooth else KINKED,
                    callback=still,
                ).x
            )
        except _Still:
            return last


class _Still(Exception):
    """A descent no longer moves."""


class _Remembered:
    """Values and slopes, each design asked for once."""

    def __init__(self, ask: Ask):
        self.ask = ask
        self.known: dict[tuple[str, bytes], Array] = {}

    def values(self, u: Array) -> Array:
        return self._known("values", u)

    def slopes(self, u: Array) -> Array:
        return self._known("slopes", u)

    def point(self, u: Array) -> Point:
        inside = np.clip(u, 0.0, 1.0)
        return Point(inside, self.values(inside))

    def _known(self, kind: str, u: Array) -> Array:
        inside = np.clip(u, 0.0, 1.0)
        key = kind, inside.tobytes()
        if key not in self.known:
            self.known[key] = self.ask(kind, inside)
        return self.known[key]
