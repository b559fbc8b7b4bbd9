"""How well a surrogate predicts expensive runs that it has not seen, and what its cheap model is worth.

`cross_validate` and `held_out` predict runs; `compare` does so for many surrogates on the same folds, and sets the best
one that uses a cheap model beside the best one that makes do with the same expensive runs alone. Every error is
prediction minus expensive response, in its unit.
"""

from __future__ import annotations

import functools
import inspect
import math
import time
import warnings
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
import pandas as pd
from numpy.typing import ArrayLike, NDArray
from scipy import stats

from ..progress import tracked
from . import bootstrap
from .accuracy import Accuracy, accuracy
from .by_coefficients import ByCoefficients
from .folds import (
    Fold,
    check_mapping,
    checked_runs,
    in_fold,
    one_blas_thread,
    rows,
    split,
    unfitted,
    uses_low_fidelity,
)
from .intervals import EDGE, checked_share
from .kriging import Kriging
from .polynomial import Polynomial
from .radial_basis import RadialBasis
from .regressor import Array, ExtrapolationWarning, Surrogate, beyond


@dataclass(frozen=True, eq=False)
class Validation:
    """Expensive runs beside what a surrogate predicted for them without having seen them.

    Attributes
    ----------
    y, predicted : ndarray, (n,)
        Expensive and predicted response.
    std : ndarray, (n,), or None
        The prediction's own standard deviation, of a surrogate that states one, such as `Kriging`.
    outside : ndarray of bool, (n,), or None
        Which runs lie outside the box of those that the surrogate was fitted to; None if it keeps no box.
    confidence : float
        Of all intervals.
    fixed : ndarray, (n,), or None
        Predicted with the thetas, noise or shape of a fit to all runs, where ``predicted`` found them anew for every
        fold; None where there was no such choice.
    """

    y: Array
    predicted: Array
    std: Array | None
    outside: NDArray[np.bool_] | None
    confidence: float = 0.95
    fixed: Array | None = None

    @property
    def residuals(self) -> Array:
        """Prediction minus expensive response (n,)."""
        return self.predicted - self.y

    @functools.cached_property
    def accuracy(self) -> Accuracy:
        """R2, RMSE and MAE, the maximum absolute error."""
        return accuracy(self.y, self.predicted)

    @property
    def rmse_fixed(self) -> float:
        """RMSE of ``fixed``; NaN without."""
        return np.nan if self.fixed is None else accuracy(self.y, self.fixed).RMSE

    @functools.cached_property
    def interval(self) -> tuple[Accuracy, Accuracy]:
        """Lower and upper confidence bounds of the accuracy.

        By the bootstrap over runs, bias-corrected and accelerated (B. Efron, *Journal of the American Statistical
        Association* 82, 1987), which takes the runs for a random sample of designs. It has nothing to say on a maximum
        (P. Bickel and D. Freedman, *Annals of Statistics* 9, 1981): no resample holds an error beyond the largest
        seen. The bounds of the MAE are NaN, and so are bounds of errors that are all alike. Few runs make bounds too
        narrow: of independent normal errors, those of 95 % held the true RMSE in 86 % of draws of 10 runs, and in 92 %
        of 40.
        """
        both = bootstrap.bounds(bootstrap.r2_and_rmse, self.y, self.residuals, confidence=self.confidence)
        low, high = (Accuracy(float(r2), float(rmse), np.nan) for r2, rmse in both)
        return low, high

    @property
    def margin(self) -> Array | None:
        """Half the width (n,) of the central interval in which each response is predicted to lie, normal by ``std``."""
        return None if self.std is None else stats.norm.ppf(0.5 + 0.5 * self.confidence) * self.std

    @property
    def allowance(self) -> Array:
        """Half the width (n,) of an interval that is to hold each response, by how far the other runs were missed.

        In shares of ``std`` where there is one; the other runs' rank as in the jackknife+, and with too few for it
        Student's t of their root mean square, as of errors that are normal.
        """
        size = np.ones(len(self.y)) if self.std is None else np.maximum(self.std, np.finfo(float).tiny)
        missed, others = np.abs(self.residuals) / size, len(self.y) - 1
        rank = math.ceil(self.confidence * (others + 1) - EDGE)
        if rank > others:
            squares = (np.sum(missed**2) - missed**2) / others
            return size * stats.t.ppf(0.5 + 0.5 * self.confidence, others) * np.sqrt(squares)
        # Without a run of low rank, the next in order takes the place of the one asked for.
        ordered = np.sort(missed)
        return size * np.where(missed <= ordered[rank - 1], ordered[rank], ordered[rank - 1])

    @property
    def coverage(self) -> float | None:
        """Share of runs within ``margin`` of their prediction, near ``confidence`` if ``std`` is right."""
        return None if self.margin is None else float(np.mean(np.abs(self.residuals) <= self.margin))

    @property
    def coverage_interval(self) -> tuple[float, float] | None:
        """Confidence bounds of the coverage, Clopper's and Pearson's for a share of n independent runs."""
        if self.coverage is None:
            return None
        n = len(self.y)
        found = stats.binomtest(round(self.coverage * n), n).proportion_ci(self.confidence)
        return float(found.low), float(found.high)


class Gain(NamedTuple):
    """What the cheap model is worth: RMSE of the ``baseline`` over that of the best ``tuned`` surrogate, and bounds."""

    tuned: str
    baseline: str
    ratio: float
    low: float
    high: float


@dataclass(frozen=True, eq=False)
class Comparison:
    """What `compare` found.

    Attributes
    ----------
    table : pandas.DataFrame
        By surrogate, least RMSE first: ``R2``, ``RMSE`` with its confidence bounds ``RMSE_low`` and ``RMSE_high``,
        ``MAE`` (the maximum absolute error), ``coverage`` of the predicted intervals (NaN without), ``outside``, the
        number of runs predicted outside the box of the fitted ones (NaN if unknown), ``low_fidelity``, whether the
        surrogate uses a cheap model, and ``seconds`` of all its fits and predictions. With ``refit``, ``RMSE_fixed`` is
        what it would have been without (NaN where there is no difference).
    validations : dict
        A `Validation` by surrogate.
    refused : dict
        Why a surrogate could not be fitted, by surrogate.
    models : dict
        Surrogates fitted to all runs, of those whose errors at runs left out came from such a fit.
    """

    table: pd.DataFrame
    validations: dict[str, Validation]
    refused: dict[str, str]
    models: dict[str, Any]

    @property
    def best(self) -> str:
        """The surrogate of least RMSE."""
        return str(self.table.index[0])

    @property
    def baseline(self) -> str | None:
        """The best surrogate that uses no cheap model: the same budget of expensive runs without it."""
        return self._best_that(low_fidelity=False)

    @property
    def tied(self) -> tuple[str, ...]:
        """The best surrogate, and those whose RMSE cannot be told from its own with these runs.

        By the bootstrap of the mean difference of squared errors, both at the same runs. The best was chosen by the
        same runs, so that an edge over the others that is just clear is likely to shrink on new ones.
        """
        errors = np.stack([self.validations[name].residuals for name in self.table.index])
        confidence = self.validations[self.best].confidence
        # Not BCa, which has no bounds where one surrogate is worse by the same at every run.
        low, _ = bootstrap.bounds(np.mean, errors**2 - errors[0] ** 2, confidence=confidence, method="percentile")
        return tuple(self.table.index[low <= 0.0])

    def gain(self) -> Gain:
        """Return RMSE of the baseline over that of the best surrogate with a cheap model, above 1 if that pays.

        The bounds are those of the bootstrap over runs, both errors taken at the same runs; NaN if one surrogate's
        errors are zero. They do not allow for another plan: with ten runs of a full car's body acceleration co-Kriging
        gained 6.2 (5.4 to 8.1) at the runs left out, and 3.9 at 200 other designs.

        Raises
        ------
        ValueError
            No surrogate with, or none without a cheap model could be fitted.
        """
        tuned, baseline = self._best_that(low_fidelity=True), self.baseline
        if tuned is None or baseline is None:
            which = "with a" if tuned is None else "without its"
            reasons = "".join(f"; {name}: {reason}" for name, reason in self.refused.items())
            raise ValueError(f"a gain needs a fitted surrogate {which} low-fidelity model, got none{reasons}")
        errors = self.validations[baseline].residuals, self.validations[tuned].residuals
        confidence = self.validations[tuned].confidence
        low, high = map(float, bootstrap.bounds(bootstrap.ratio, *errors, confidence=confidence))
        return Gain(tuned, baseline, float(bootstrap.ratio(*errors, axis=-1)), low, high)

    def _best_that(self, low_fidelity: bool) -> str | None:
        names = self.table.index[self.table["low_fidelity"] == low_fidelity]
        return str(names[0]) if len(names) else None


def cross_validate(
    surrogate: Any,
    X: ArrayLike,
    y: ArrayLike,
    folds: int | None = None,
    random_state: int | None = 0,
    confidence: float = 0.95,
    refit: bool = False,
) -> Validation:
    """Predict each expensive run by a surrogate fitted to others.

    Parameters
    ----------
    surrogate : scikit-learn regressor
        Copies of it are fitted; they share its low-fidelity model.
    X : array_like, (n, k), or DataFrame
        Designs. Equal ones are left out together.
    y : array_like, (n,)
        Responses of the expensive model.
    folds : int, optional
        Parts, at random and of about one size, each left out in turn. By default every design alone, or ten parts if
        there are more than 30 runs.
    random_state : int or None
        Of the parts.
    confidence : float
    refit : bool
        Find thetas and noise of `Kriging` and `CoKriging`, and the shape of `RadialBasis`, anew for every fold. By
        default they are those of a fit to all runs, from which the runs left out are predicted in closed form, at the
        cost of that one fit.

    Returns
    -------
    Validation

    Raises
    ------
    ValueError
        Bad numbers in X or y, more folds than different designs, or a fold to which the surrogate cannot be fitted,
        with the number of its runs.

    Notes
    -----
    Errors of runs left out share most of the runs that they were fitted to: intervals that take them for independent
    are somewhat narrow. Thetas that have seen the runs left out flatter: found anew for every fold, errors of Kriging,
    co-Kriging and Gaussian radial bases were 1.1 to 1.5 times as large in the median of plans of 10 and 20 runs, and
    up to 7 times in single ones. Runs of a space-filling plan leave a hole when left out, a run at the edge of the box
    an extrapolation: the error of a fit to all of them tends to be smaller.

    Examples
    --------
    >>> import numpy as np
    >>> from susp_ss import Polynomial, cross_validate
    >>> X = np.array([[0.0], [1.0], [2.0]])
    >>> cross_validate(Polynomial(degree=1), X, [0.0, 1.0, 4.0]).residuals.round(9).tolist()
    [-2.0, 1.0, -2.0]
    """
    X, y = checked_runs(X, y)
    splits, confidence = split(X, folds, random_state), checked_share("confidence", confidence)
    with one_blas_thread():
        return _cross_validated(surrogate, X, y, splits, confidence, refit)[0]


def held_out(surrogate: Any, X: ArrayLike, y: ArrayLike, confidence: float = 0.95) -> Validation:
    """Predict expensive runs that a fitted surrogate has not seen, such as nodes between those of its fit.

    Parameters
    ----------
    surrogate : fitted scikit-learn regressor
    X : array_like, (n, k), or DataFrame
        Designs; that none was fitted is up to the caller.
    y : array_like, (n,)
        Responses of the expensive model.
    confidence : float

    Returns
    -------
    Validation

    Raises
    ------
    ValueError
        Bad numbers in X or y.
    sklearn.exceptions.NotFittedError
        The surrogate is not fitted.

    Examples
    --------
    >>> import numpy as np
    >>> from susp_ss import Polynomial, held_out
    >>> X = np.linspace(0.0, 4.0, 9)[:, None]
    >>> surrogate = Polynomial(degree=2).fit(X, X[:, 0] ** 2)
    >>> round(held_out(surrogate, [[0.7], [3.1]], [0.49, 9.61]).accuracy.R2, 9)
    1.0
    """
    X, y = checked_runs(X, y)
    outside = surrogate.outside(X) if hasattr(surrogate, "outside") else None
    return Validation(y, *_predicted(surrogate, X), outside, checked_share("confidence", confidence))


def compare(
    surrogates: Mapping[str, Any],
    X: ArrayLike,
    y: ArrayLike,
    folds: int | None = None,
    random_state: int | None = 0,
    confidence: float = 0.95,
    refit: bool = False,
    progress: bool = False,
) -> Comparison:
    """Cross-validate surrogates on the same folds of the same expensive runs.

    Parameters
    ----------
    surrogates : mapping of str to scikit-learn regressor
        If all use a low-fidelity model, `Polynomial`, `RadialBasis` and `Kriging` join as the baseline.
    X, y, folds, random_state, confidence, refit
        As of `cross_validate`.
    progress : bool
        Show progress on stderr.

    Returns
    -------
    Comparison
        A surrogate that cannot be fitted to every fold is listed in ``refused``.

    Raises
    ------
    TypeError
        ``surrogates`` is no mapping, or empty.
    ValueError
        As `cross_validate`, or no surrogate could be fitted.

    Examples
    --------
    >>> import numpy as np
    >>> from susp_ss import Polynomial, ResponseBased, compare
    >>> X = np.linspace(0.0, 3.0, 8)[:, None]
    >>> F = 1.0 + 2.0 * np.sin(X[:, 0]) + 0.01 * X[:, 0]
    >>> tuned = ResponseBased(lambda X: np.sin(X[:, 0]))
    >>> found = compare({"RB": tuned, "line": Polynomial(1), "septic": Polynomial(7)}, X, F)
    >>> found.best, found.baseline, found.refused["septic"][:40]
    ('RB', 'line', 'fold 1 of 8, fitted to 7 of 8 runs: degr')
    >>> bool(found.gain().low > 10.0)
    True
    """
    X, y = checked_runs(X, y)
    check_mapping(surrogates)
    splits, confidence = split(X, folds, random_state), checked_share("confidence", confidence)
    candidates = dict(surrogates)
    if all(map(uses_low_fidelity, candidates.values())):
        candidates |= _baselines()
    validations, refused, seconds = dict[str, Validation](), dict[str, str](), dict[str, float]()
    models = dict[str, Any]()
    with one_blas_thread():
        for name, surrogate in tracked(candidates.items(), "comparing", progress):
            start = time.perf_counter()
            try:
                validations[name], model = _cross_validated(surrogate, X, y, splits, confidence, refit)
                if model is not None:
                    models[name] = model
            except (ValueError, RuntimeError) as error:
                refused[name] = str(error)
            seconds[name] = time.perf_counter() - start
    if not validations:
        raise ValueError("no surrogate can be fitted: " + "; ".join(f"{name}: {why}" for name, why in refused.items()))
    errors = np.stack([validation.residuals for validation in validations.values()])
    bounds = np.stack(bootstrap.bounds(bootstrap.rmse, errors, confidence=confidence), axis=-1)
    found = [
        _row(validation, low, high, refit)
        | {"low_fidelity": uses_low_fidelity(candidates[name]), "seconds": seconds[name]}
        for (name, validation), (low, high) in zip(validations.items(), bounds.tolist(), strict=True)
    ]
    table = pd.DataFrame(found, index=pd.Index(list(validations), name="surrogate")).sort_values("RMSE", kind="stable")
    return Comparison(table, validations, refused, models)


def _cross_validated(
    surrogate: Any, X: Any, y: Array, folds: Sequence[Fold], confidence: float, refit: bool
) -> tuple[Validation, Any]:
    """Errors at runs left out, and the fit to all runs where these came from it."""
    outside = _outside(X, folds) if hasattr(surrogate, "outside") else None
    if isinstance(surrogate, ByCoefficients):
        try:
            model = unfitted(surrogate).fit(X, y)
        except ValueError:
            # What all runs do not determine the others of a fold do not, and it is named.
            _fitted_anew(surrogate, X, y, folds)
            raise
        return Validation(y, y - model.without(folds).errors, None, outside, confidence), model
    if not hasattr(surrogate, "predict_left_out"):
        return Validation(y, *_fitted_anew(surrogate, X, y, folds), outside, confidence), None
    model = unfitted(surrogate).fit(X, y)
    fixed, std = model.predict_left_out([left_out for _, left_out in folds])
    if not refit:
        return Validation(y, fixed, std, outside, confidence), model
    return Validation(y, *_fitted_anew(surrogate, X, y, folds), outside, confidence, fixed), model


def _fitted_anew(surrogate: Any, X: Any, y: Array, folds: Sequence[Fold]) -> tuple[Array, Array | None]:
    """Predictions and their standard deviations by a fit to the others of each fold."""
    parts = []
    # Our own read numbers alone; a table would be checked anew in every fold, which takes as long as the fits.
    X = np.asarray(X, dtype=float) if isinstance(surrogate, Surrogate) else X
    for i, (fitted, left_out) in enumerate(folds):
        with in_fold(i, folds):
            model = unfitted(surrogate).fit(rows(X, fitted), y[fitted])
        parts.append(_predicted(model, rows(X, left_out)))
    order = np.argsort(np.concatenate([left_out for _, left_out in folds]))
    mean, std = zip(*parts, strict=True)
    return np.concatenate(mean)[order], None if std[0] is None else np.concatenate(std)[order]


def _outside(X: Any, folds: Sequence[Fold]) -> NDArray[np.bool_]:
    """Which runs lie outside the box of the others of their fold."""
    designs, outside = np.asarray(X, dtype=float), np.empty(len(X), dtype=bool)
    for fitted, left_out in folds:
        box = designs[fitted].min(axis=0), designs[fitted].max(axis=0)
        outside[left_out] = beyond(designs[left_out], *box).any(axis=1)
    return outside


def _predicted(model: Any, X: Any) -> tuple[Array, Array | None]:
    """Prediction, and its standard deviation if it has one."""
    with warnings.catch_warnings():
        # A run left out often lies outside the box of the others; how many do is told instead.
        warnings.simplefilter("ignore", ExtrapolationWarning)
        if "return_std" in inspect.signature(model.predict).parameters:
            return model.predict(X, return_std=True)
        return model.predict(X), None


def _baselines() -> dict[str, Any]:
    return {
        "Polynomial (baseline)": Polynomial(),
        "RadialBasis (baseline)": RadialBasis(),
        "Kriging (baseline)": Kriging(),
    }


def _row(validation: Validation, low: float, high: float, refit: bool) -> dict[str, Any]:
    known = {"coverage": validation.coverage, "outside": validation.outside}
    return {
        "R2": validation.accuracy.R2,
        "RMSE": validation.accuracy.RMSE,
        "RMSE_low": low,
        "RMSE_high": high,
        "MAE": validation.accuracy.MAE,
        **({"RMSE_fixed": validation.rmse_fixed} if refit else {}),
    } | {name: np.nan if values is None else float(np.sum(values)) for name, values in known.items()}
