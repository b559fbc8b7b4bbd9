"""Surrogates of some coefficients, and what fits without some runs find: in closed form where these are linear."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import solve_triangular

from .folds import Fold, in_fold, one_blas_thread, split, unfitted
from .intervals import LeftOut, left_out_of
from .regressor import Array, Surrogate

# The others' least share in a combination of columns, a singular value, from which the closed form keeps ten digits.
SHARED = 1e-3


class ByCoefficients(Surrogate):
    """A surrogate of some coefficients: fits without some runs, made when first asked for, are kept as theirs."""

    _fitted_to: tuple[Array, Array] | None = None
    _left_out: LeftOut | None = None

    def left_out(self) -> LeftOut:
        """Return what fits without each run found, or without a tenth of them at a time if there are more than 30.

        Raises
        ------
        ValueError
            The others do not determine a fit, or the runs are not known.
        """
        if self._left_out is None:
            if self._fitted_to is None:
                raise ValueError("its errors at runs left out are not known; fit the runs again")
            with one_blas_thread():
                self._left_out = self.without(split(self._fitted_to[0], None, 0))
        return self._left_out

    def _numbers_without(self) -> dict[str, Any]:
        return self.left_out()._asdict()

    def _restore_without(self, found: dict[str, Any]) -> None:
        self._left_out = left_out_of(found, len(self._coefficients()))

    def without(self, folds: Sequence[Fold]) -> LeftOut:
        """Return what fits to the others of each fold found; each run is in one.

        Raises
        ------
        ValueError
            The others of a fold, which is named, do not determine a fit.
        """
        assert self._fitted_to is not None
        designs, responses = self._fitted_to
        fits = self._closed([left_out for _, left_out in folds])
        fits = self._anew(folds) if fits is None else fits
        of_run = np.empty(len(responses), dtype=np.intp)
        for i, (_, left_out) in enumerate(folds):
            of_run[left_out] = i
        predicted = np.take_along_axis(self._at_each(designs, fits), of_run[:, None], axis=1)[:, 0]
        return LeftOut(responses - predicted, of_run, fits)

    def _closed(self, folds: Sequence[NDArray[np.intp]]) -> Array | None:
        """Coefficients (f, m) without the runs of each fold, if there is a closed form."""
        return None

    def _anew(self, folds: Sequence[Fold]) -> Array:
        """Coefficients (f, m) of fits to the others of each fold, one after another."""
        fit_to, fits = self._fit_to(), []
        with warnings.catch_warnings():
            # Of a parameter at its bounds, which is said of the fit to all runs.
            warnings.simplefilter("ignore", UserWarning)
            for i, fold in enumerate(folds):
                with in_fold(i, folds):
                    fits.append(fit_to(fold[0]))
        return np.array(fits)

    def _coefficients(self) -> Array:
        """What the fit found (m,)."""
        raise NotImplementedError

    def _at_each(self, designs: Array, fits: Array) -> Array:
        """Predictions (N, f) at designs (N, k) by fits of coefficients (f, m)."""
        raise NotImplementedError

    def _fit_to(self) -> Callable[[NDArray[np.intp]], Array]:
        """Coefficients (m,) of a fit to some of the runs, as a function of their rows."""
        assert self._fitted_to is not None
        designs, responses = self._fitted_to
        return lambda rows: unfitted(self).fit(designs[rows], responses[rows])._coefficients()

    def _runs(self, X: Any, y: Any) -> tuple[Array, Array]:
        self._fitted_to, self._left_out = super()._runs(X, y), None
        return self._fitted_to

    def _others(self, designs: Array) -> tuple[Array, Array]:
        errors, folds, fits = self.left_out()
        return self._at_each(designs, fits)[:, folds], np.abs(errors)


class TunedModel(ByCoefficients):
    """A surrogate that evaluates the cheap model for every prediction: how well it scores is up to that."""

    def __sklearn_tags__(self) -> Any:
        tags = super().__sklearn_tags__()
        tags.regressor_tags.poor_score = True
        return tags


def without_rows(columns: Array, target: Array, coefficients: Array, folds: Sequence[NDArray[np.intp]]) -> Array | None:
    """Least squares without some of the rows, from the solution for all.

    With ``A = Q R`` and residuals e, the solution without the rows S is ``a - R^-1 Q_S' (I - Q_S Q_S')^-1 e_S``
    (R. Cook and S. Weisberg, *Residuals and Influence in Regression*, 1982, section 3.6).

    Parameters
    ----------
    columns : ndarray, (n, m)
    target : ndarray, (n,)
    coefficients : ndarray, (m,)
        That minimise ``|columns a - target|``.
    folds : sequence of ndarray of int
        Rows to leave out, each time.

    Returns
    -------
    ndarray, (folds, m), or None
        None where the rows left barely determine a solution, and digits would be lost.
    """
    Q, R = np.linalg.qr(columns)
    errors, steps = target - columns @ coefficients, []
    for S in folds:
        shares = np.linalg.svd(np.delete(Q, S, axis=0), compute_uv=False)
        if len(Q) - len(S) < Q.shape[1] or shares[-1] < SHARED:
            return None
        steps.append(Q[S].T @ np.linalg.solve(np.eye(len(S)) - Q[S] @ Q[S].T, errors[S]))
    return coefficients - solve_triangular(R, np.array(steps).T).T
