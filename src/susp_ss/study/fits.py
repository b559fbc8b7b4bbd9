"""The study's three surrogates fitted to its three criteria, and what they are worth."""

from __future__ import annotations

from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from ..surrogates import ParameterBased, ResponseBased, VariableBased, accuracy
from .published import ACCURACY, COEFFICIENTS, CRITERIA, index
from .tabulated import Tabulated


def fit(
    X: NDArray[np.float64], F: NDArray[np.float64], low_fidelity: dict[str, Any], nonnegative: bool
) -> dict[tuple[str, str], Any]:
    """Fit every surrogate to every criterion.

    Parameters
    ----------
    X : ndarray, (n, 2)
        Designs (K_s, C_s).
    F : ndarray, (n, 3)
        Their high-fidelity responses, one column a criterion.
    low_fidelity : dict
        For each criterion a callable ``f(X)`` and ``f(X, ms)``, as `Response` is.

    Returns
    -------
    dict
        Fitted estimators by (surrogate, criterion).
    """
    fitted = {}
    for (criterion, response), y in zip(low_fidelity.items(), F.T, strict=True):
        for surrogate, model in fit_criterion(X, y, Tabulated(response, X), nonnegative).items():
            fitted[surrogate, criterion] = model
    return fitted


def fit_criterion(X: NDArray, y: NDArray, f: Tabulated, nonnegative: bool) -> dict[str, Any]:
    """Fit every surrogate to one criterion's high-fidelity responses y (n,)."""
    return {
        "RB": ResponseBased(f, nonnegative=nonnegative).fit(X, y),
        "VB": VariableBased(f, nonnegative=nonnegative).fit(X, y),
        "PB": ParameterBased(f).fit(X, y),
    }


def scores(fitted: dict[tuple[str, str], Any], X: NDArray, F: NDArray) -> pd.DataFrame:
    """R2, RMSE and MAE of every surrogate at designs X, whose high-fidelity responses are F (n, 3)."""
    column = dict(zip(CRITERIA, F.T, strict=True))
    rows = [accuracy(column[key[1]], fitted[key].predict(X)) for key in index()]
    return pd.DataFrame(rows, index=index(), columns=list(ACCURACY))


def tuned(fitted: dict[tuple[str, str], Any]) -> pd.DataFrame:
    """Coefficients a0, a1, a2 and ms of every surrogate; NaN where it has no such term."""
    table = pd.DataFrame(index=index(), columns=["a0", "a1", "a2", "ms"], dtype=float)
    for key in index():
        table.loc[key, list(COEFFICIENTS[key[0]])] = coefficients_of(fitted[key])
    return table


def coefficients_of(model: Any) -> list[float]:
    """Tuned values of a fitted surrogate, in the order of `COEFFICIENTS`."""
    if isinstance(model, ParameterBased):
        return [model.parameter_]
    return [model.intercept_, *map(float, model.coef_)]
