"""Intervals of predictions, by what fits without some of the runs say of these runs, and of new designs.

The jackknife+ (R. Barber, E. Candès, A. Ramdas and R. Tibshirani, *Predictive inference with the jackknife+*, Annals of
Statistics 49, 2021; with folds of several runs its CV+): run i, left out with its fold, was missed by R_i; at a new
design the fits without each fold predict ``S_-i(x)``, and the interval goes from the ``floor((1 - q)(n + 1))``-th
smallest of ``S_-i(x) - R_i`` to the ``ceil(q (n + 1))``-th smallest of ``S_-i(x) + R_i``. It assumes no distribution,
only that a new design is drawn as the runs were. Where there are too few runs for such a rank, fewer than 19 for 95 %,
errors are taken for normal: ``S(x) +- t s``, with s the root mean square of ``R_i + |S_-i(x) - S(x)|``, how far from
the prediction each run puts a bound, and t of Student with n degrees of freedom.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy import stats

from ..quantities import briefly

Array = NDArray[np.float64]

# Of a rank, what is rounding.
EDGE = 1e-9


class NoInterval(ValueError):
    """A surrogate cannot say how far its predictions may be from the responses."""


class NoIntervalWarning(UserWarning):
    """Predictions were asked for with an interval, which a surrogate does not have."""


class LeftOut(NamedTuple):
    """What fits without some runs found, and by how much they miss these runs.

    Attributes
    ----------
    errors : ndarray, (n,)
        Response minus prediction by the others.
    folds : ndarray of int, (n,)
        Which fit each run was left out of.
    fits : ndarray, (f, m)
        Coefficients of each fit.
    """

    errors: Array
    folds: NDArray[np.intp]
    fits: Array


def checked_share(name: str, value: Any) -> float:
    """A confidence, or the share of responses that an interval is to hold."""
    if isinstance(value, bool) or not isinstance(value, float | int) or not 0.0 < value < 1.0:
        raise ValueError(f"{name} must be a number between 0 and 1, got {briefly(value)}")
    return float(value)


def jackknife_plus(predicted: Array, by_others: Array, residuals: Array, level: float) -> Array:
    """Bounds (N, 2) of the responses at N designs.

    Parameters
    ----------
    predicted : ndarray, (N,)
        By the fit to all runs.
    by_others : ndarray, (N, n)
        By the fits without each run.
    residuals : ndarray, (n,) or (N, n)
        How far each run was missed, absolute; in the measure of each design where errors differ from place to place.
    level : float
        Share q of responses that are to lie between the bounds.

    Returns
    -------
    ndarray, (N, 2)
    """
    n = by_others.shape[1]
    rank = math.ceil(level * (n + 1) - EDGE)
    if rank > n:
        farthest = residuals + np.abs(by_others - predicted[:, None])
        margin = stats.t.ppf(0.5 + 0.5 * level, n) * np.sqrt(np.mean(farthest**2, axis=1))
        return np.column_stack([predicted - margin, predicted + margin])
    low = np.partition(by_others - residuals, n - rank, axis=1)[:, n - rank]
    high = np.partition(by_others + residuals, rank - 1, axis=1)[:, rank - 1]
    # The ends may cross where the fits without a run disagree by more than they miss.
    return np.column_stack([np.minimum(low, predicted), np.maximum(high, predicted)])


def left_out_of(found: Mapping[str, Any], coefficients: int) -> LeftOut:
    """What a file holds of the fits without some runs.

    Raises
    ------
    KeyError, TypeError, ValueError
        Numbers that no fit left there.
    """
    errors, fits = (np.asarray(found[name], dtype=float) for name in ("errors", "fits"))
    folds = np.asarray(found["folds"])
    if errors.ndim != 1 or not len(errors) or folds.shape != errors.shape or folds.dtype.kind != "i":
        raise ValueError("left_out must have one error and one fold a run")
    if fits.ndim != 2 or fits.shape[1] != coefficients or folds.min() < 0 or folds.max() >= len(fits):
        raise ValueError(f"left_out must have fits of {coefficients} coefficients, one for each fold")
    if not (np.isfinite(errors).all() and np.isfinite(fits).all()):
        raise ValueError("left_out must be finite")
    return LeftOut(errors, folds, fits)
