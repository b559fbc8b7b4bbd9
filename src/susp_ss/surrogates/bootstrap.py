"""Confidence bounds of errors by resampling the runs."""

from __future__ import annotations

import warnings
from collections.abc import Callable
from typing import Any

import numpy as np
from scipy import stats

from .regressor import Array

# Of the runs, and how many of them at once.
RESAMPLES, TOGETHER = 9999, 100


def bounds(statistic: Callable[..., Any], *columns: Array, confidence: float, method: str = "BCa") -> tuple[Any, Any]:
    """Bounds of a statistic of paired columns (..., n), over resampled runs; BCa's are NaN if these are all alike.

    They have the shape of the statistic: what shares the resamples costs little more than one.
    """
    with warnings.catch_warnings(), np.errstate(divide="ignore", invalid="ignore"):
        warnings.simplefilter("ignore", stats.DegenerateDataWarning)
        found = stats.bootstrap(
            columns,
            statistic,
            paired=True,
            axis=-1,
            vectorized=True,
            confidence_level=confidence,
            method=method,
            n_resamples=RESAMPLES,
            batch=TOGETHER,
            rng=0,
        ).confidence_interval
    return found.low, found.high


def rmse(errors: Array, axis: int) -> Any:
    return np.sqrt(np.mean(errors**2, axis=axis))


def r2_and_rmse(y: Array, errors: Array, axis: int) -> Array:
    """Both (2, ...)."""
    squares = np.mean(errors**2, axis=axis)
    return np.stack([1.0 - squares / np.var(y, axis=axis), np.sqrt(squares)])


def ratio(errors: Array, others: Array, axis: int) -> Any:
    with np.errstate(divide="ignore", invalid="ignore"):
        return rmse(errors, axis) / rmse(others, axis)
