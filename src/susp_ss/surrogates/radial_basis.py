"""Radial basis functions: interpolation by one bump, or one cone, around every run."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from numbers import Real
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.interpolate import RBFInterpolator
from scipy.linalg import lapack
from scipy.spatial.distance import cdist
from scipy.special import xlogy

from ..quantities import briefly, whole_number
from .left_out import left_out
from .regressor import Approximation, Array, independent, monomials

# phi(r) with scipy's signs, after the study's Eqs 10 to 21, where r^2 ln r is 0 at r = 0, and Eq 15 has a misprint for
# exp(-r^2 / (2 sigma^2)): shape = 1 / (sqrt(2) sigma).
KERNELS: dict[str, Callable[[Array], Array]] = {
    "linear": lambda r: -r,
    "cubic": lambda r: r**3,
    "thin_plate_spline": lambda r: xlogy(r**2, r),
    "gaussian": lambda r: np.exp(-(r**2)),
    "multiquadric": lambda r: -np.sqrt(1.0 + r**2),
    "inverse_multiquadric": lambda r: 1.0 / np.sqrt(1.0 + r**2),
}

# The least degree of the polynomial tail with which a kernel has one interpolant; -1 is none.
LEAST_DEGREE = {
    "linear": 0,
    "cubic": 1,
    "thin_plate_spline": 1,
    "gaussian": -1,
    "multiquadric": 0,
    "inverse_multiquadric": -1,
}

SHAPED = ("gaussian", "multiquadric", "inverse_multiquadric")

# Shapes to choose from, times the mean distance of neighbours, from sharp to flat.
SHAPES = np.geomspace(5.0, 0.02, 49)

# The flatter the bumps, the worse the system; beyond this condition number its errors are noise.
CONDITION = 1e14


class RadialBasis(Approximation):
    """Radial basis functions around every run, and a polynomial tail: an interpolant.

    ``S(x) = sum w_i phi(shape |z - z_i|) + p(z)`` with z the columns scaled to [-1, 1] over the box of the runs
    (*Feasibility study of surrogate model for the application of vehicle suspension system*, 2021, Eqs 10 to 21), by
    `scipy.interpolate.RBFInterpolator`.

    Parameters
    ----------
    kernel : {"thin_plate_spline", "linear", "cubic", "gaussian", "multiquadric", "inverse_multiquadric"}
        phi(r): ``r^2 ln r``, ``r``, ``r^3``, ``exp(-r^2)``, ``sqrt(1 + r^2)`` or ``1 / sqrt(1 + r^2)``.
    shape : float, optional
        Of the last three kernels, in the scaled columns; by default the one of 49, from sharp to as flat as 16 digits
        bear, with the least sum of squared leave-one-out errors.
    degree : int, optional
        Of the polynomial tail, -1 for none; by default 1 for the thin plate and the cubic, and 0, a constant, for the
        others.

    Attributes
    ----------
    shape_ : float
        The shape in use; 1 for a kernel without.
    interpolator_ : scipy.interpolate.RBFInterpolator
        On the scaled columns.

    Raises
    ------
    ValueError
        From `fit`: an unknown kernel, a bad shape or degree, one design with two responses (its rows are named), a
        constant column, or too few runs for the tail.

    Examples
    --------
    >>> import numpy as np
    >>> from susp_ss import RadialBasis
    >>> X = np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0], [0.3, 0.6]])
    >>> y = np.array([1.0, 2.0, 3.0, 5.0, 2.5])
    >>> RadialBasis().fit(X, y).predict(X).round(9).tolist()
    [1.0, 2.0, 3.0, 5.0, 2.5]
    """

    def __init__(self, kernel: str = "thin_plate_spline", shape: float | None = None, degree: int | None = None):
        self.kernel = kernel
        self.shape = shape
        self.degree = degree

    def fit(self, X: ArrayLike, y: ArrayLike) -> RadialBasis:
        """Interpolate the responses y (n,) at the designs X (n, k)."""
        designs, responses = self._distinct(X, y)
        degree = self._degree()
        shape = self._shape()
        self.box_ = self._box(designs)
        Z = self.box_.transform(designs)
        n, m = monomials(Z, degree).shape
        needed = m + (shape is None)
        if n < needed:
            raise ValueError(
                f"a polynomial tail of degree {degree} needs at least {needed} different designs, got {n} sample(s)"
            )
        self.shape_ = _best_shape(Z, responses, self.kernel, degree) if shape is None else shape
        self._interpolate(Z, responses)
        return self

    def _interpolate(self, Z: Array, responses: Array) -> None:
        degree = self._degree()
        if not _determined(Z, self.kernel, self.shape_, degree):
            raise ValueError(
                f"these designs do not determine the interpolant with kernel {self.kernel!r}, shape {self.shape_:g} "
                f"and degree {degree}; take a larger shape, a lower degree, or designs that are not on a line"
            )
        self.interpolator_ = RBFInterpolator(Z, responses, kernel=self.kernel, epsilon=self.shape_, degree=degree)

    def _numbers(self) -> dict[str, Any]:
        return {
            "shape": self.shape_,
            "designs": self.runs_[0],
            "responses": self.runs_[1],
        }

    def _restore(self, found: dict[str, Any]) -> None:
        self.shape_ = float(found["shape"])
        designs, responses = self._found_runs(found)
        self._interpolate(self.box_.transform(designs), responses)

    def _at(self, designs: Array) -> Array:
        return self.interpolator_(self.box_.transform(designs))

    def predict_left_out(self, folds: Sequence[NDArray[np.intp]]) -> tuple[Array, None]:
        """Predict runs by the others alone, in closed form, with the shape and the scaled columns of all.

        Parameters
        ----------
        folds : sequence of ndarray of int
            Rows of the fitted designs, each in one fold; a fold is left out together, equal designs in one.

        Returns
        -------
        ndarray (n,), None
            Interpolants (n,) through the other runs of a fold; they have no standard deviation.

        Raises
        ------
        ValueError
            A fold without which the tail is not determined, with the number of its runs.
        """
        designs, responses = self.runs_
        Z, degree = self.box_.transform(designs), self._degree()
        P = monomials(Z, degree)
        inverse = np.linalg.inv(_conditions(cdist(Z, Z), P, self.kernel, self.shape_))
        predicted = responses.copy()
        distinct = [np.unique(self._of_run[S]) for S in folds]
        for S, errors, _ in left_out(inverse[: len(Z), : len(Z)], responses, P, distinct):
            predicted[S] -= errors
        return predicted[self._of_run], None

    def _degree(self) -> int:
        if self.kernel not in KERNELS:
            raise ValueError(f"kernel must be one of {', '.join(KERNELS)}, got {briefly(self.kernel)}")
        least = LEAST_DEGREE[self.kernel]
        if self.degree is None:
            return max(least, 0)
        return whole_number("degree", self.degree, least, need=f">= {least} for kernel {self.kernel!r}")

    def _shape(self) -> float | None:
        """The shape asked for; None where leave-one-out is to choose."""
        if self.shape is None:
            return None if self.kernel in SHAPED else 1.0
        if self.kernel not in SHAPED:
            raise ValueError(f"kernel {self.kernel!r} has no shape, got {briefly(self.shape)}; leave it None")
        if isinstance(self.shape, bool) or not isinstance(self.shape, Real) or not 0.0 < self.shape < math.inf:
            raise ValueError(f"shape must be a number > 0, got {briefly(self.shape)}")
        return float(self.shape)


def leave_one_out(Z: Array, y: Array, kernel: str, shape: float, degree: int) -> Array:
    """Errors of the interpolants that each leave one run out, at that run, from one interpolant of all.

    With A the matrix of the interpolation conditions and of the tail's, and ``A (w, v) = (y, 0)``, the error at run i
    is ``w_i / (A^-1)_ii`` (S. Rippa, *Advances in Computational Mathematics* 11, 1999, section 2).

    Parameters
    ----------
    Z : ndarray, (n, k)
        Scaled designs.
    y : ndarray, (n,)
    kernel : str
    shape : float
    degree : int

    Returns
    -------
    ndarray, (n,)
        Response minus interpolant; inf if the system is singular to working precision.
    """
    return _left_out_errors(cdist(Z, Z), monomials(Z, degree), y, kernel, shape)


def _left_out_errors(distances: Array, P: Array, y: Array, kernel: str, shape: float) -> Array:
    n, A = len(distances), _conditions(distances, P, kernel, shape)
    if _reciprocal_condition(A) < np.finfo(float).eps:
        return np.full(n, np.inf)
    inverse = np.linalg.inv(A)
    if np.linalg.norm(A, 1) * np.linalg.norm(inverse, 1) > CONDITION:
        return np.full(n, np.inf)
    return inverse[:n, :n] @ y / np.diag(inverse)[:n]


def _determined(Z: Array, kernel: str, shape: float, degree: int) -> bool:
    """Whether the runs tell the terms of the tail apart, and then every weight.

    The tail is judged by the singular values of its monomials on the scaled columns. The bumps may be as flat as 16
    digits bear: beyond that the weights are noise, whether or not an elimination meets a pivot of exactly zero.
    """
    P = monomials(Z, degree)
    if not independent(P):
        return False
    return bool(_reciprocal_condition(_conditions(cdist(Z, Z), P, kernel, shape)) > np.finfo(float).eps)


def _conditions(distances: Array, P: Array, kernel: str, shape: float) -> Array:
    """The matrix of the interpolation conditions and of the tail's."""
    return np.block([[KERNELS[kernel](shape * distances), P], [P.T, np.zeros((P.shape[1], P.shape[1]))]])


def _reciprocal_condition(A: Array) -> float:
    """LAPACK's estimate in the 1-norm: rounding, rather than an exception, of a matrix that is singular."""
    factors, _, _ = lapack.dgetrf(A)
    estimate, _ = lapack.dgecon(factors, np.linalg.norm(A, 1))
    return float(estimate)


def _best_shape(Z: Array, y: Array, kernel: str, degree: int) -> float:
    distances, P = cdist(Z, Z), monomials(Z, degree)
    others = distances + np.diag(np.full(len(Z), np.inf))
    shapes = SHAPES / others.min(axis=1).mean()
    sizes = [np.linalg.norm(_left_out_errors(distances, P, y, kernel, shape)) for shape in shapes]
    return float(shapes[np.argmin(sizes)])
