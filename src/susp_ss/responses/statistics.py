"""Numbers in place of histories: what is kept of a response over time, stretch after stretch."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..quantities import briefly

Array = NDArray[np.float64]


class Statistic(NamedTuple):
    """A number of histories (..., T): of one stretch, of two stretches together, at the end of so many samples."""

    of: Callable[[Array], Any]
    joined: Callable[[Any, Any], Any]
    end: Callable[[Any, int], Any] = lambda total, samples: total


STATISTICS = {
    "rms": Statistic(lambda y: np.vecdot(y, y), np.add, lambda total, samples: np.sqrt(total / samples)),
    "mean": Statistic(lambda y: y.sum(axis=-1), np.add, lambda total, samples: total / samples),
    "peak": Statistic(lambda y: np.maximum(y.max(axis=-1), -y.min(axis=-1)), np.maximum),
    "max": Statistic(lambda y: y.max(axis=-1), np.maximum),
    "min": Statistic(lambda y: y.min(axis=-1), np.minimum),
}
"""Root mean square about zero, mean, largest modulus, largest and smallest value."""


def checked_statistics(reduce: Any) -> tuple[str, ...]:
    """Names of statistics; none where histories are kept."""
    if reduce is None:
        return ()
    names = (reduce,) if isinstance(reduce, str) else tuple(reduce) if isinstance(reduce, (tuple, list)) else ()
    if not names or not all(isinstance(name, str) and name in STATISTICS for name in names):
        raise ValueError(f"reduce must be one or several of {', '.join(STATISTICS)}, got {briefly(reduce)}")
    return names


def kept(stretches: Iterator[Array], into: Array, names: tuple[str, ...]) -> None:
    """Put histories (..., L) that follow one another into (..., T), or their statistics into (..., names)."""
    if not names:
        start = 0
        for y in stretches:
            end = start + y.shape[-1]
            into[..., start:end], start = y, end
        return
    wanted = [STATISTICS[name] for name in names]
    found: list[Any] = []
    samples = 0
    for y in stretches:
        samples += y.shape[-1]
        new = [one.of(y) for one in wanted]
        found = [one.joined(*pair) for one, *pair in zip(wanted, found, new, strict=True)] if found else new
    for i, (one, total) in enumerate(zip(wanted, found, strict=True)):
        into[..., i] = one.end(total, samples)
