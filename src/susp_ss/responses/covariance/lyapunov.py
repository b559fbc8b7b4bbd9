"""The Lyapunov equation of a second-order system, solved in its own structure.

``p' = v + ...``, ``v' = -K p - C v + ...``, stacks of (N, n, n), mass-normalised; K and C need not be symmetric.
First-order vectors are stacks (N, 2n, k) with the positions above the velocities. Nothing here loops over designs.
"""

from __future__ import annotations

from functools import cache, cached_property
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

# A Taylor step of h with rate * h <= 1: 1 / 18! is below rounding.
TAYLOR_TERMS = 18


class Reach(NamedTuple):
    """Which forcing (J,) may decay as slowly as a mode does, and the most that it or a mode turns over a delay."""

    slow: NDArray[np.bool_]
    turns: float


class Dynamics:
    """Mass-normalised free dynamics ``x' = A x``, ``A = [[0, I], [-K, -C]]``, for N designs at once.

    K and C are arrays (N, n, n), or dual numbers where only `solve`, `resolvent` and `carried` are asked for.
    """

    def __init__(self, K: Any, C: Any):
        self.K, self.C = K, C
        self.n = K.shape[-1]

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

    def reach(self, rates: Array, tau: Array) -> Reach:
        """How far forcing at ``rates`` (N, J) and the delays ``tau`` (N,) lead."""
        fastest = self.fastest()
        slow = np.any(np.abs(rates) <= 2.0 * fastest[:, None], axis=0)
        turning = np.maximum(fastest, np.abs(rates[:, slow]).max(axis=1, initial=0.0))
        return Reach(slow, float(np.max(turning * tau)))

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
        source, rates = b[:, :, None], alphas[:, None, :]
        reach = self.reach(alphas, tau)
        E, f = self.carried(source + 0.0 * rates, rates, tau[:, None, None], reach)
        return E @ source, f.mT[..., None]

    def carried(self, forcing: Any, rates: Any, tau: Any, reach: Reach) -> tuple[Any, Any]:
        """Carry all states over a delay, freely and under decaying forcing, of arrays or dual numbers.

        By Taylor over a short time h, then over twice the time and so on, ``E <- E^2`` and ``f <- E f + f e^(-rate
        h)``; by ``(A + rate I)^-1`` what decays faster than A moves, as so many doublings would cost digits.

        Parameters
        ----------
        forcing : (N, 2n, J)
        rates : (N, 1, J)
            At which each forcing decays.
        tau : (N, 1, 1)
        reach : Reach

        Returns
        -------
        E : (N, 2n, 2n)
            ``e^(A tau)``.
        f : (N, 2n, J)
            ``int_0^tau e^(A (tau - s)) forcing e^(-rate s) ds``.
        """
        slow = reach.slow
        E, f = _doubled(self._first_order, forcing[:, :, slow], rates[:, :, slow], tau, reach.turns)
        if slow.all():
            return E, f
        entered, fast = forcing[:, :, ~slow], rates[:, :, ~slow]
        left = E @ entered - entered * np.exp(-(fast * tau))
        beyond = -self.resolvent(-fast.mT[..., None], left.mT[..., None])[..., 0].mT
        order = np.argsort(np.concatenate([np.flatnonzero(slow), np.flatnonzero(~slow)]))
        return E, np.concatenate([f, beyond], axis=-1)[:, :, order]

    @cached_property
    def _first_order(self) -> Any:
        """A, (N, 2n, 2n)."""
        still = 0.0 * self.K
        above = np.concatenate([still, still + np.eye(self.n)], axis=-1)
        return np.concatenate([above, np.concatenate([-self.K, -self.C], axis=-1)], axis=-2)

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


def _doubled(A: Any, forcing: Any, rates: Any, tau: Any, turns: float) -> tuple[Any, Any]:
    """What `Dynamics.carried` returns, by doublings alone."""
    doublings = max(0, int(np.ceil(np.log2(max(turns, 1.0)))))
    h = tau / 2.0**doublings
    E = term = 0.0 * A + np.eye(A.shape[-1])
    f = drift = 0.0 * forcing
    for k in range(1, TAYLOR_TERMS + 1 if turns else 0):
        term, drift = A @ term * (h / k), (A @ drift + forcing) * (h / k)
        forcing = forcing * (rates * h / -k)
        E, f = E + term, f + drift
    for _ in range(doublings):
        f = E @ f + f * np.exp(-(rates * h))
        E, h = E @ E, 2.0 * h
    return E, f


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
