"""Any stable first-order system ``x' = A x``, for N designs at once, in the coordinates of its modes.

All that the covariance of a road's response needs is a function of A: its inverse, resolvents, ``e^(A tau)``, the same
under decaying forcing, and the solution of a Lyapunov equation, whose entries fall apart between modes. A design whose
eigenvectors are too nearly parallel (critical damping, poles placed on one another) keeps no digits in them and goes by
Schur's form and Pade's exponential, one by one.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import scipy.linalg
from numpy.typing import NDArray

Array = NDArray[np.float64]

# Eigenvectors with a condition above this cost more than five digits of a function of A.
PARALLEL = 1e5

# The solution of a Lyapunov equation by eigenvectors loses the square of their condition; beyond this it is refined.
REFINED = 1e-12
EPSILON = np.finfo(float).eps


class Modal:
    """Free dynamics ``x' = A x``, A (N, n, n), balanced, every eigenvalue in the open left half plane.

    The eigenvalues are ``rates`` (N, n), the eigenvectors the columns of ``V`` (N, n, n); one A may stand for all
    designs.
    """

    def __init__(self, A: Array, rates: NDArray, V: NDArray):
        eye = np.eye(A.shape[-1])
        # An exact zero would stop the inversion; how near to zero a determinant is, the condition tells.
        singular = ~np.isfinite(np.linalg.slogdet(V)[1])
        W = np.linalg.inv(np.where(singular[:, None, None], eye, V) if singular.any() else V)
        self.condition = np.linalg.norm(V, axis=(-2, -1)) * np.linalg.norm(W, axis=(-2, -1)) / len(eye)
        self.A, self.rates, self.V, self.W = A, rates, V, W
        self.parallel = singular | ~(self.condition < PARALLEL)

    def _one_by_one(self, N: int) -> list[tuple[int, int]]:
        """Those of N designs that are not computed by modes, each with the number of its system."""
        which = np.broadcast_to(np.arange(len(self.A)), N)
        return [(int(i), int(which[i])) for i in np.flatnonzero(self.parallel[which])]

    def _of_modes(self, values: Any, x: Any, real: bool = True) -> Any:
        """``V diag(values) W x``, the function of A that has these values at its eigenvalues."""
        V, W = (self.V, self.W) if x.ndim == 3 else (self.V[:, None], self.W[:, None])
        y = V @ (values * (W @ x))
        return np.ascontiguousarray(y.real) if real else y

    def solve(self, x: Array) -> Array:
        """``A^-1 x`` of columns (N, n, k)."""
        return np.asarray(np.linalg.solve(self.A, x))

    def resolvent(self, alpha: NDArray, x: Array) -> Any:
        """``(alpha I - A)^-1 x`` of columns (N, J, n, k), for alpha (N, J, 1, 1) that are no eigenvalues of A."""
        y = self._of_modes(1.0 / (alpha - self.rates[:, None, :, None]), x, np.isrealobj(alpha))
        for i, j in self._one_by_one(len(y)):
            y[i] = np.linalg.solve(alpha[i] * np.eye(self.A.shape[-1]) - self.A[j], x[i])
        return y

    def propagate(self, b: Array, tau: Array, alphas: NDArray) -> tuple[Array, Any]:
        """Carry ``b`` (N, n) over the delays ``tau`` (N,), freely and under forcing that decays at ``alphas`` (N, J).

        Returns ``e^(A tau) b``, (N, n, 1), and ``int_0^tau e^(A (tau - s)) b e^(-alpha s) ds``, (N, J, n, 1).
        """
        over = tau[:, None, None] * self.rates[:, :, None]
        free = self._of_modes(np.exp(over), b[:, :, None])
        columns = np.broadcast_to(b[:, None, :, None], (*alphas.shape, b.shape[1], 1))
        decay = -(tau[:, None] * alphas)[:, :, None, None]
        driven = tau[:, None, None, None] * _mean_exponential(over[:, None], decay)
        forced = self._of_modes(driven, columns, np.isrealobj(alphas))
        for i, j in self._one_by_one(len(free)):
            free[i], forced[i] = _carried(self.A[j], b[i], float(tau[i]), alphas[i])
        return free, forced

    def lyapunov(self, Q: Array) -> tuple[Array, Array]:
        """Solve ``A X + X A^T + Q = 0`` for symmetric Q (N, n, n).

        Returns X (N, n, n), with a step of refinement where eigenvectors are not far from parallel, and its relative
        error (N,), as an order of magnitude: what remains, over twice the slowest rate.
        """
        X = self._lyapunov(Q)
        if (EPSILON * self.condition**2 > REFINED).any():
            X = X + self._lyapunov(self._residual(X, Q))
        rest = np.abs(self._residual(X, Q)).max(axis=(-2, -1)) / (2.0 * np.abs(self.rates.real).min(axis=-1))
        largest = np.abs(X).max(axis=(-2, -1))
        return X, np.divide(rest, largest, out=np.zeros_like(rest), where=largest > 0.0)

    def _residual(self, X: Array, Q: Array) -> Array:
        half = self.A @ X
        return np.asarray(half + half.mT + Q)

    def _lyapunov(self, Q: Array) -> Array:
        V, W = self.V, self.W
        sums = self.rates[:, :, None] + self.rates[:, None, :].conj()
        X = np.ascontiguousarray((V @ ((W @ Q @ W.conj().mT) / -sums) @ V.conj().mT).real)
        for i, j in self._one_by_one(len(X)):
            X[i] = scipy.linalg.solve_continuous_lyapunov(self.A[j], -Q[i])
        return 0.5 * (X + X.mT)


def _mean_exponential(x: NDArray, y: NDArray) -> NDArray:
    """``int_0^1 e^(x (1 - s) + y s) ds = (e^x - e^y) / (x - y)``, without loss where x is near y."""
    apart = x - y
    ahead = apart.real > 0.0
    # From the larger of both ends, so that nothing overflows.
    step = np.where(ahead, -apart, apart)
    safe = np.where(step == 0.0, 1.0, step)
    return np.asarray(np.exp(np.where(ahead, x, y)) * np.where(step == 0.0, 1.0, np.expm1(safe) / safe))


def _carried(A: Array, b: Array, tau: float, alphas: NDArray) -> tuple[Array, NDArray]:
    """What `Modal.propagate` returns of one design: the forcing is one more state."""
    n = len(A)
    free = scipy.linalg.expm(A * tau) @ b[:, None]
    forced = np.zeros((len(alphas), n, 1), dtype=alphas.dtype)
    for j, alpha in enumerate(alphas):
        driven = np.block([[A, b[:, None]], [np.zeros((1, n)), np.array([[-alpha]])]])
        forced[j] = scipy.linalg.expm(driven * tau)[:n, n:]
    return free, forced
