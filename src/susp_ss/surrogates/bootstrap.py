"""Confidence bounds of errors by resampling the runs."""

from __future__ import annotations

import warnings
from collections.abc import Callable
from typing import Any

import numpy as np
from scipy import stats

from .regressor import Array

# Of the runs, and how many of them at once.
RESAMPLES, TOGETHER = 9999, 1000


def bounds(
    statistic: Callable[..., Any], *columns: Array, confidence: float, method: str = "BCa"
) -> tuple[float, float]:
    """Bounds of a statistic of paired columns (n,), over resampled runs; BCa's are NaN if these are all alike."""
    with warnings.catch_warnings(), np.errstate(divide="ignore", invalid="ignore"):
        warnings.simplefilter("ignore", stats.DegenerateDataWarning)
        found = stats.bootstrap(
            columns,
            statistic,
            paired=True,
            vectorized=True,
            confidence_level=confidence,
            method=method,
            n_resamples=RESAMPLES,
            batch=TOGETHER,
            rng=0,
        ).confidence_interval
    return float(found.low), float(found.high)


def rmse(errors: Array, axis: int) -> Any:
    return np.sqrt(np.mean(errors**2, axis=axis))


def r2(y: Array, errors: Array, axis: int) -> Any:
    return 1.0 - np.mean(errors**2, axis=axis) / np.var(y, axis=axis)


def ratio(errors: Array, others: Array, axis: int) -> Any:
    with np.errstate(divide="ignore", invalid="ignore"):
        return rmse(errors, axis) / rmse(others, axis)


def excess(errors: Array, others: Array, axis: int) -> Any:
    return np.mean(errors**2 - others**2, axis=axis)
