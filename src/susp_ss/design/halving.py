"""Points of a front: its ends, and between them one level after another of halved gaps."""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from ..progress import progress
from .search import MET, Point, Programme, Search

Array = NDArray[np.float64]

# Points of the front nearer to each other than this share of its extent are one.
SAME = 1e-6


def front(search: Search, limits: Mapping[int, float], count: int) -> list[Point]:
    """Points of the front, from the least of the first objective to the least of the second."""
    with progress("points of the front", total=count) as shown:
        found = _settled(search, ends(search, (0, 1), limits), limits)
        extent = np.abs(found[0].values[:2] - found[1].values[:2])
        if (extent <= SAME * search.sizes[:2]).any():
            return [found[0]]
        for _ in found:
            shown.advance()
        closed: set[tuple[bytes, ...]] = set()
        while len(found) < count:
            gaps = [gap for gap in itertools.pairwise(found) if _known_by(gap) not in closed]
            if not gaps:
                break
            longest = _longest(gaps, extent, count - len(found))
            between = search.least([_midway(a, b, limits, extent) for a, b in longest])
            new = [
                point
                for point, gap in zip(between, longest, strict=True)
                if point is not None and min(_apart(point, end, extent).max() for end in gap) > SAME
            ]
            found = _undominated([*found, *new])
            kept = {id(point) for point in found}
            closed |= {_known_by(gap) for point, gap in zip(between, longest, strict=True) if id(point) not in kept}
            for _ in new:
                shown.advance()
    return found


def _known_by(gap: tuple[Point, Point]) -> tuple[bytes, ...]:
    return tuple(end.u.tobytes() for end in gap)


def _apart(a: Point, b: Point, extent: Array) -> Array:
    """How far apart two points are in either objective, as shares of the front's extent."""
    return np.asarray(np.abs(a.values - b.values)[:2] / extent)


def _longest(gaps: Sequence[tuple[Point, Point]], extent: Array, count: int) -> list[tuple[Point, Point]]:
    """At most so many gaps, the longest first, none shorter than the halves of the longest."""
    lengths = np.array([np.linalg.norm(_apart(a, b, extent)) for a, b in gaps])
    order = np.argsort(-lengths, kind="stable")[:count]
    return [gaps[i] for i in order if lengths[i] >= 0.5 * lengths.max()]


def _midway(a: Point, b: Point, limits: Mapping[int, float], extent: Array) -> Programme:
    """Find the design midway between two, by the objective in which they are farther apart."""
    held = int(np.argmax(_apart(a, b, extent)))
    midway = 0.5 * (a.values[held] + b.values[held])
    tighter = {**limits, held: min(midway, limits.get(held, np.inf))}
    return Programme(1 - held, tighter, [0.5 * (a.u + b.u)])


def _settled(search: Search, alone: Sequence[Point], limits: Mapping[int, float]) -> list[Point]:
    """Of all designs that are as good as either end of the front, the best in the other objective."""
    as_good = [
        Programme(1 - goal, {**limits, goal: float(end.values[goal]) * (1.0 + MET)}, [end.u])
        for goal, end in enumerate(alone)
    ]
    return [
        end if found is None or found.values[1 - goal] > end.values[1 - goal] else found
        for goal, (end, found) in enumerate(zip(alone, search.least(as_good), strict=True))
    ]


def _undominated(points: Sequence[Point]) -> list[Point]:
    """Points in rising order of the first objective, without those that another beats."""
    kept: list[Point] = []
    for point in sorted(points, key=lambda point: (point.values[0], point.values[1])):
        if not kept or point.values[1] < kept[-1].values[1]:
            kept.append(point)
    return kept


def ends(search: Search, goals: Sequence[int], limits: Mapping[int, float]) -> list[Point]:
    """The designs that minimise one metric alone, or say which limits are out of reach."""
    starts = []
    if not search.met(limits).any():
        nearest = search.nearest(limits)
        starts.append(nearest.u)
        if search.excess(nearest.values, limits) > MET:
            raise ValueError(_out_of_reach(search, limits, nearest))
    found = []
    for end in search.least([Programme(goal, limits, starts) for goal in goals]):
        if end is None:
            raise ValueError(_out_of_reach(search, limits, search.nearest(limits)))
        found.append(end)
    return found


def _out_of_reach(search: Search, limits: Mapping[int, float], nearest: Point) -> str:
    """Which limits cannot be met, and what can."""
    names, said = search.problem.names, []
    alone = search.least([Programme(i, {}) for i in limits])
    for (i, limit), least in zip(limits.items(), alone, strict=True):
        if least is not None and least.values[i] > limit:
            said.append(f"{names[i]} <= {limit:g} is out of reach, least {least.values[i]:.4g}")
    if not said:
        at = ", ".join(f"{names[i]} {nearest.values[i]:.4g}" for i in limits)
        said.append(f"no design within the ranges meets all at once, nearest {at}")
    return f"limits: {'; '.join(said)} (SI units)"
