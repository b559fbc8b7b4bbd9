"""Runs predicted by the others, from one factorisation of all: the closed forms of cross-validation."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from .regressor import DEPENDENT, Array

Rows = NDArray[np.intp]


def left_out(H: Array, y: Array, P: Array, folds: Sequence[Rows]) -> Iterator[tuple[Rows, Array, Array]]:
    """What fits to the other runs miss.

    With H the first n rows and columns of the inverse of ``[[C, P], [P', 0]]``, the errors of a fold S, response minus
    prediction, are ``H_SS^-1 (H y)_S``, and ``H_SS^-1`` is their covariance in the measure of C (O. Dubrule,
    *Mathematical Geology* 15, 1983; S. Rippa for radial bases, *Advances in Computational Mathematics* 11, 1999; for
    folds D. Ginsbourger and C. Schaerer, *Fast calculation of Gaussian process multiple-fold cross-validation residuals
    and their covariances*, 2021).

    Parameters
    ----------
    H : ndarray, (n, n)
    y : ndarray, (n,)
    P : ndarray, (n, m)
        Columns of the trend, or of the polynomial tail.
    folds : sequence of ndarray of int
        Rows of each fold.

    Yields
    ------
    ndarray of int, ndarray, ndarray
        The rows, their errors, and the diagonal of ``H_SS^-1``.

    Raises
    ------
    ValueError
        The other runs do not determine the trend.
    """
    weights, basis = H @ y, np.linalg.qr(P)[0]
    for i, S in enumerate(folds, 1):
        others = len(y) - len(S)
        # The others' share in each column of the trend; with none in some combination, they do not determine it.
        shares = np.linalg.svd(np.delete(basis, S, axis=0), compute_uv=False)
        if others <= P.shape[1] or (P.shape[1] and shares[-1] <= DEPENDENT):
            raise ValueError(
                f"fold {i} of {len(folds)}, fitted to {others} of {len(y)} runs: these do not determine the "
                f"{P.shape[1]} columns of the trend"
            )
        inverse = np.linalg.inv(H[np.ix_(S, S)])
        yield S, inverse @ weights[S], np.diag(inverse)
