"""Where the next runs tell most: they fill the box first, then lower the mean variance that Kriging states.

A run at x lowers the variance at x' by ``S(x', x)^2 / (S(x, x) + noise)``, whatever comes out of it, where S is the
covariance that the runs so far have left; S itself by ``S(., x) S(x, .) / (S(x, x) + noise)``. So the run that lowers
the mean over the box most, and the next one after it, are found before either is made (D. Cohn, *Neural Networks* 9,
1996, "active learning"; J. Sacks, W. Welch, T. Mitchell and H. Wynn, *Statistical Science* 4, 1989, by the integrated
mean squared error).
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.stats import qmc

from .kriging import CoKriging, Kriging
from .regressor import Array
from .sampling import sides

# Designs that are looked at, of a Sobol sequence; the corners of the box join them, up to so many inputs.
LOOKED_AT, CORNERED = 512, 4

MOST = 100
"""Runs that may be asked for at once."""

# Runs for each input that fill the box before any variance is believed. With more of them nothing was gained on cars.
FILLING = 3

# Of the variance of the responses, what is rounding.
ROUNDING = 1e-12

# Of each side of the box, squared: designs nearer than this to a run are the same for one who makes it.
SAME = 4e-6

# Designs are given to so many steps along each side of the box, rounded to a decimal place.
STEPS = 1000.0


class Knowledge(NamedTuple):
    """What runs leave to know of one response at designs.

    Attributes
    ----------
    covariance : ndarray, (N, N)
    noise : float
        Variance of a run's own noise.
    """

    covariance: Array
    noise: float

    @property
    def variance(self) -> float:
        """Mean over the designs."""
        return float(np.mean(np.diag(self.covariance)))

    def told(self) -> Array:
        """By how much a run at each design lowers the mean variance (N,)."""
        return np.mean(self.covariance**2, axis=0) / (np.diag(self.covariance) + self.noise)

    def after(self, runs: Sequence[int]) -> Knowledge:
        """What further runs at some of the designs leave."""
        across = self.covariance[:, runs]
        inner = across[runs] + self.noise * np.eye(across.shape[1])
        return Knowledge(self.covariance - across @ np.linalg.pinv(inner, hermitian=True) @ across.T, self.noise)


def next_designs(
    box: Mapping[str, Sequence[float]], made: Array, known: Callable[[Array], Sequence[Knowledge]], count: int
) -> tuple[Array, int]:
    """Designs to run next, and how many of them, the first, fill the box.

    Parameters
    ----------
    box : mapping of str to (low, high)
    made : ndarray, (n, k)
        Runs so far.
    known : callable
        What these have left to know of each response at designs (N, k); nothing where nobody can say.
    count : int

    Returns
    -------
    ndarray, (count, k), and int
        In the box, none twice and none of those made, rounded to about a thousandth of each side.
    """
    lows, highs = (np.array(ends) for ends in sides(box))
    designs = over(box)
    unit, runs = ((X - lows) / (highs - lows) for X in (designs, made))
    left = [one for one in known(designs) if one.variance > ROUNDING]
    few = FILLING * len(box) - len(np.unique(made, axis=0))
    first = list(itertools.islice(filling(unit, runs), min(count, max(few, 0)) if left else count))
    fresh = nearest_square(unit, np.concatenate([runs, unit[first]])) > SAME
    others = list(itertools.islice(most_telling([one.after(first) for one in left], fresh), count - len(first)))
    places = -np.floor(np.log10((highs - lows) / STEPS)).astype(int)
    columns = [
        np.round(column, place) for column, place in zip(designs[first + others].T, places.tolist(), strict=True)
    ]
    return np.clip(np.stack(columns, axis=1), lows, highs), len(first)


def knowledge(model: Kriging | CoKriging, designs: ArrayLike, scale: float) -> Knowledge:
    """What the runs of a fit have left at designs (N, k), in responses over their ``scale``."""
    covariance = model.covariance(designs) / scale**2
    # Rounding must not look like something to learn: it is as if runs were noisy by as much.
    return Knowledge(covariance, (model.noise_ / scale) ** 2 + ROUNDING)


def over(box: Mapping[str, Sequence[float]]) -> Array:
    """Designs (N, k) that fill a box, its corners last."""
    lows, highs = sides(box)
    unit = qmc.Sobol(len(box), scramble=False).random(LOOKED_AT)
    if len(box) <= CORNERED:
        unit = np.concatenate([unit, list(itertools.product((0.0, 1.0), repeat=len(box)))])
    return qmc.scale(unit, lows, highs)


def most_telling(known: Sequence[Knowledge], allowed: NDArray[np.bool_]) -> Iterator[int]:
    """Which designs to run, each lowering the mean variances of all responses together the most after those before."""
    allowed = allowed.copy()
    while allowed.any():
        told = np.sum([one.told() for one in known], axis=0)
        yield (best := int(np.argmax(np.where(allowed, told, -1.0))))
        allowed[best] = False
        known = [one.after([best]) for one in known]


def filling(designs: Array, runs: Array) -> Iterator[int]:
    """Which designs (N, k) to run, each the farthest from all runs (n, k) and those before it; in the unit box."""
    nearest = nearest_square(designs, runs)
    while nearest.max() > SAME:
        yield (farthest := int(np.argmax(nearest)))
        nearest = np.minimum(nearest, nearest_square(designs, designs[[farthest]]))


def nearest_square(designs: Array, runs: Array) -> Array:
    """Square of the distance (N,) of each design (N, k) from the nearest run (n, k)."""
    return np.min(np.sum((designs[:, None] - runs) ** 2, axis=-1), axis=1)
