"""The Lyapunov equation of a second-order system, solved in its own structure.

``p' = v + ...``, ``v' = -K p - C v + ...``, stacks of (N, n, n), mass-normalised; K and C need not be symmetric.
First-order vectors are stacks (N, 2n, k) with the positions above the velocities. Nothing here loops over designs.
"""

from __future__ import annotations

from functools import cache, cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

# Taylor steps of h with rate * h <= 4: rounding costs less than two digits, and 4^32 / 32! is below it.
TAYLOR_REACH = 4.0
TAYLOR_TERMS = 32

# A delay of more steps than this (a walking pace) is reached by squaring instead.
LONGEST_WALK = 64


class Dynamics:
    """Mass-normalised free dynamics ``x' = A x``, ``A = [[0, I], [-K, -C]]``, for N designs at once.

    K and C are arrays (N, n, n), or dual numbers where only `solve` and `resolvent` are asked for.
    """

    def __init__(self, K: Any, C: Any):
        self.K, self.C = K, C
        self.n = K.shape[-1]

    def apply(self, x: Array) -> Array:
        """``A x``."""
        p, v = x[:, : self.n], x[:, self.n :]
        return np.concatenate([v, -(self.K @ p) - self.C @ v], axis=1)

    def solve(self, x: Any) -> Any:
        """``A^-1 x`` of columns (N, 2n, k)."""
        a, b = x[:, : self.n], x[:, self.n :]
        return np.concatenate([-np.linalg.solve(self.K, b + self.C @ a), a], axis=-2)

    def resolvent(self, alpha: Any, x: Any) -> Any:
        """``(alpha I - A)^-1 x`` of columns (N, J, 2n, k), for alpha (N, J, 1, 1) that are no eigenvalues of A."""
        a, b = x[:, :, : self.n], x[:, :, self.n :]
        inner = self.C[:, None] + alpha * np.eye(self.n)
        p = np.linalg.solve(self.K[:, None] + alpha * inner, b + inner @ a)
        return np.concatenate([p, alpha * p - a], axis=-2)

    def fastest(self) -> Array:
        """An upper bound on the modulus of the eigenvalues of A, (N,)."""
        damping = 0.5 * np.linalg.norm(self.C, ord=np.inf, axis=(-2, -1))
        return damping + np.sqrt(damping**2 + np.linalg.norm(self.K, ord=np.inf, axis=(-2, -1)))

    def propagate(self, b: Array, tau: Array, alphas: Array) -> tuple[Array, Array]:
        """Carry ``b`` over the delay, freely and under decaying forcing.

        Parameters
        ----------
        b : ndarray, (N, 2n)
        tau : ndarray, (N,)
        alphas : ndarray, (N, J)
            Rates of the forcing, possibly none.

        Returns
        -------
        free : ndarray, (N, 2n, 1)
            ``e^(A tau) b``.
        forced : ndarray, (N, J, 2n, 1)
            ``int_0^tau e^(A (tau - s)) b e^(-alpha s) ds``.
        """
        N, J = alphas.shape
        forcing = np.concatenate([np.zeros((N, 1)), np.ones((N, J))], axis=1)
        rates = np.concatenate([np.zeros((N, 1)), alphas], axis=1)
        x = np.concatenate([b[:, :, None], np.zeros((N, b.shape[1], J), dtype=alphas.dtype)], axis=2)
        reach = np.maximum(self.fastest(), np.abs(rates).max(axis=1)) * tau
        steps = max(1, int(np.ceil(reach.max() / TAYLOR_REACH)))
        if steps > LONGEST_WALK:
            return self._leap(b, tau, alphas, int(np.ceil(np.log2(steps))))
        h = (tau / steps)[:, None, None]
        for _ in range(steps):
            term, drive, total = x, forcing[:, None, :], x
            for k in range(1, TAYLOR_TERMS + 1):
                term = (h / k) * (self.apply(term) + b[:, :, None] * drive)
                drive = -(h / k) * rates[:, None, :] * drive
                total = total + term
            x, forcing = total, forcing * np.exp(-h[:, 0] * rates)
        return x[:, :, :1].real, np.moveaxis(x[:, :, 1:, None], 2, 1)

    def _leap(self, b: Array, tau: Array, alphas: Array, squarings: int) -> tuple[Array, Array]:
        """The same as `propagate` over a long delay: ``e^(A h)`` squared, ``(alpha I + A)^-1`` for the forcing."""
        h = (tau / 2.0**squarings)[:, None, None]
        E = term = np.broadcast_to(np.eye(2 * self.n), (len(tau), 2 * self.n, 2 * self.n))
        for k in range(1, TAYLOR_TERMS + 1):
            term = (h / k) * self.apply(term)
            E = E + term
        for _ in range(squarings):
            E = E @ E
        free, rates = E @ b[:, :, None], alphas[:, :, None, None]
        left = free[:, None] - np.exp(-rates * tau[:, None, None, None]) * b[:, None, :, None]
        return free, -self.resolvent(-rates, left)

    def lyapunov(self, Q: Array) -> tuple[Array, Array]:
        """Solve ``A X + X A^T + Q = 0`` for symmetric Q (..., N, 2n, 2n); every design must be asymptotically stable.

        Returns X (..., N, 2n, 2n) and its relative error (..., N), as an order of magnitude.

        With ``X = [[P, S], [S^T, V]]`` the position block gives ``S = W - Q_pp / 2`` with W skew, the mixed
        block ``V = P K^T + S C^T - Q_pv``, and what remains are n^2 equations in the n^2 numbers of P and W: V must be
        symmetric, and ``sym(K S + C V) = Q_vv / 2``. They are solved with one step of refinement, in a time unit that
        makes the stiffness of order one. The equations are inverted once, whatever the number of Q.
        """
        n = self.n
        unit, K, C, L, inverse = self._equations
        Qpp, Qpv, Qvv = Q[..., :n, :n] / unit, Q[..., :n, n:] / unit**2, Q[..., n:, n:] / unit**3
        V0 = -0.5 * Qpp @ C.mT - Qpv
        known = (V0 - _transpose(V0)) + _symmetrised(-0.5 * K @ Qpp + C @ V0)
        right = (Qvv - known).reshape(*Q.shape[:-2], n * n)

        def correction(y: Array) -> Array:
            return ((right - (y[..., None, :] @ L)[..., 0, :])[..., None, :] @ inverse)[..., 0, :]

        y = (right[..., None, :] @ inverse)[..., 0, :]
        y += correction(y)
        # What a second step of refinement would still change tells the digits that are lost.
        error = np.abs(correction(y)).max(axis=-1) / np.abs(y).max(axis=-1)
        P, W = ((y @ basis.reshape(n * n, n * n)).reshape(*y.shape[:-1], n, n) for basis in _basis(n))

        S = W - 0.5 * Qpp
        V = P @ K.mT + S @ C.mT - Qpv
        V = 0.5 * (V + _transpose(V))
        X = np.empty_like(Q)
        X[..., :n, :n], X[..., n:, n:] = P, V * unit**2
        X[..., :n, n:], X[..., n:, :n] = S * unit, _transpose(S) * unit
        return X, error

    @cached_property
    def _equations(self) -> tuple[Array, ...]:
        """Time unit, K and C in it, and the n^2 equations L of `lyapunov`, each unknown a row, with their inverse."""
        n = self.n
        unit = np.sqrt(np.trace(self.K, axis1=-2, axis2=-1) / n)[:, None, None]
        K, C = self.K / unit**2, self.C / unit
        P, W = _basis(n)
        left = _left(C, W), _left(K, W)
        V = _transpose(_left(K, P) - left[0])
        L = (V - _transpose(V)) + _symmetrised(left[1] + _left(C, V))
        L = L.reshape(len(K), n * n, n * n)
        return unit, K, C, L, np.asarray(np.linalg.inv(L), dtype=float)


@cache
def _basis(n: int) -> tuple[Array, Array]:
    """A matrix of unknowns split into its symmetric and its skew part, one basis matrix an entry, (n^2, n, n)."""
    unit = np.eye(n * n).reshape(n * n, n, n)
    return 0.5 * (unit + _transpose(unit)), 0.5 * (unit - _transpose(unit))


def _left(matrix: Array, stack: Any) -> Array:
    """``matrix @ each`` of a stack (m, n, n), or of a stack for each design, as (N, m, n, n)."""
    return matrix[:, None] @ stack


def _transpose(stack: Array) -> Array:
    return np.swapaxes(stack, -1, -2)


def _symmetrised(stack: Array) -> Array:
    return stack + _transpose(stack)
