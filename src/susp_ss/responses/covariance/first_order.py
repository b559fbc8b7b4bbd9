"""A first-order system ``x' = A x + sum_j b_j u(t - tau_j)``: what one process stirs up, met by one axle after another.

A spectrum of white noise and first-order colours adds its parts to the right-hand side of one Lyapunov equation ``A X +
X A^T + Q = 0``. With ``e_ij = e^(A (tau_j - tau_i)) b_i`` for an axle i ahead of j:

- white of intensity q: ``Q = q sum_j [b_j b_j^T / 2 + sum_(i ahead of j) e_ij b_j^T]`` and its transpose;
- colour of autocorrelation ``s^2 e^(-alpha |t|)``: ``Q = sum_j g_j b_j^T`` and its transpose, ``g_j = E[x u(t - tau_j)]
  = s^2 [(alpha I - A)^-1 (sum_i ahead e_ij + sum_(i not ahead) e^(-alpha (tau_i - tau_j)) b_i) + sum_(i ahead) f_ij]``
  with ``f_ij = int_0^(tau_j - tau_i) e^(A (tau_j - tau_i - s)) b_i e^(-alpha s) ds``.

The road's warps are integrals of the velocity over delays and join by their own closed-form moments. All of this is
written once, for arrays as well as for the dual numbers that carry derivatives.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import combinations
from typing import Any, NamedTuple

import numpy as np


class Spectrum(NamedTuple):
    """A process's velocity spectrum, arrays or dual numbers: white (N, 1, 1), rates and weights (N, J)."""

    white: Any
    alphas: Any
    weights: Any


class Correlations:
    """Correlations of the states of N designs with a process, as each axle meets it.

    Parameters
    ----------
    dynamics : Dynamics
        ``solve`` is ``A^-1 x``, and ``resolvent`` is ``(alpha I - A)^-1 x``.
    entries : sequence of (N, 2n, 1)
        How the process enters by each axle, the first in front.
    taus : sequence of (N,)
        How long after the first the axles meet it, ascending from zero.
    carry : callable
        ``carry(i, j)`` is ``e_ij`` (N, 2n, 1) and ``f_ij`` (N, J, 2n, 1) of each colour.
    spectrum : Spectrum
    """

    def __init__(
        self,
        dynamics: Any,
        entries: Sequence[Any],
        taus: Sequence[Any],
        carry: Callable[[int, int], tuple[Any, Any]],
        spectrum: Spectrum,
    ) -> None:
        self.dynamics, self.entries, self.white = dynamics, entries, spectrum.white
        self.alphas, self.weights = spectrum.alphas[:, :, None, None], spectrum.weights[:, :, None, None]
        axles = range(len(entries))
        pairs = list(combinations(axles, 2))
        self.apart = {(i, j): (taus[j] - taus[i])[:, None, None, None] for i, j in pairs}
        self.decay = {pair: np.exp(-(self.alphas * apart)) for pair, apart in self.apart.items()}
        carried = [[carry(i, j) for i in range(j)] for j in axles]
        self.free = [[free for free, _ in ahead] for ahead in carried]
        nothing = 0.0 * self.alphas
        self.forced = [sum((forced for _, forced in ahead), nothing) for ahead in carried]
        # For a colour u of unit sigma^2, E[x u(t - tau_j)] but for the forcing.
        columns = [
            sum((free[:, None] for free in self.free[j]), nothing)
            + sum((self.decay[j, i] * entries[i][:, None] for i in axles if i > j), entries[j][:, None])
            for j in axles
        ]
        resolved = dynamics.resolvent(self.alphas, np.concatenate(columns, axis=-1))
        self.resolved = [resolved[..., j : j + 1] for j in axles]

    @property
    def sigma2(self) -> Any:
        return 0.5 * self.weights * self.alphas

    def left(self, i: int, j: int) -> Any:
        """How much of each colour is left from axle to axle."""
        return 1.0 if i == j else self.decay[min(i, j), max(i, j)]

    def memory(self, i: int, j: int) -> Any:
        """``int_0^(tau_j - tau_i) e^(-alpha |s|) ds``, odd in its axles."""
        if i == j:
            return 0.0
        over = -np.expm1(-(self.alphas * self.apart[min(i, j), max(i, j)])) / self.alphas
        return over if i < j else -over

    def with_velocity(self, j: int) -> Any:
        """``E[x u(t - tau_j)]`` (N, 2n, 1), of colours."""
        return np.real((self.sigma2 * (self.resolved[j] + self.forced[j])).sum(axis=-3))

    def right_hand_side(self) -> Any:
        """The process's share of Q, (N, 2n, 2n)."""
        half: Any = 0.0
        for j, entry in enumerate(self.entries):
            white = self.white * sum(self.free[j], 0.5 * entry)
            half = half + entry * (white + self.with_velocity(j)).mT
        return half + half.mT

    def with_height(self, j: int, bounded: bool) -> Any:
        """``E[x z(t - tau_j)]`` (N, 2n, 1) of the height z; where that is not bounded, of ``z(t - tau_j) - z(t)``."""
        if bounded:
            # By the cut-off alone: the height itself is the sum of colours of variance -weight / (2 alpha).
            return np.real((-0.5 * self.weights * (self.resolved[j] - self.forced[j])).sum(axis=-3))
        if j == 0:
            return 0.0 * self.entries[0]
        passed: Any = sum(free - self.entries[i] for i, free in enumerate(self.free[j]))
        coloured = (self.sigma2 * (self.resolved[0] - self.resolved[j] - self.forced[j])).sum(axis=-3)
        for i, entry in enumerate(self.entries):
            coloured = coloured + entry * (self.sigma2 * (self.memory(0, i) + self.memory(i, j))).sum(axis=-3)
        return -self.dynamics.solve(self.white * passed - np.real(coloured))

    def of_heights(self, i: int, j: int, bounded: bool) -> Any:
        """``E[z(t - tau_i) z(t - tau_j)]`` (N, 1, 1), i <= j; unbounded, less what cancels if nothing drifts."""
        if bounded:
            return np.real((-0.5 * self.weights / self.alphas * self.left(i, j)).sum(axis=-3))
        if i == j:
            return 0.0
        tau = self.apart[i, j]
        coloured = np.real((self.weights * (tau - self.memory(i, j))).sum(axis=-3))
        return -0.5 * (self.white * tau[:, 0] + coloured)

    def of_velocities(self, i: int, j: int) -> Any:
        """``E[u(t - tau_i) u(t - tau_j)]`` (N, 1, 1), of colours."""
        return np.real((self.sigma2 * self.left(i, j)).sum(axis=-3))

    def height_with_velocity(self, i: int, j: int, bounded: bool) -> Any:
        """``E[z(t - tau_i) u(t - tau_j)]`` (N, 1, 1); where z is not bounded, of ``z(t - tau_i) - z(t - tau_j)``."""
        if bounded:
            sign = float(np.sign(i - j))
            return np.real((0.5 * sign * self.weights * self.left(i, j)).sum(axis=-3))
        return np.real((self.sigma2 * self.memory(i, j)).sum(axis=-3))

    def integrated(self, rates: Sequence[Any], bounded: bool) -> tuple[Any, Any]:
        """``E[x h^T]`` (N, 2n, k) and ``E[h h^T]`` (N, k, k) of k integrals ``h' = sum_j rates_j u(t - tau_j)``.

        Rates are rows (N, k). Unless the height is ``bounded``, they add up to zero.
        """
        rows = [rate[:, None] for rate in rates]
        cross: Any = sum(self.with_height(j, bounded) * row for j, row in enumerate(rows))
        half: Any = sum(
            (1.0 if i < j else 0.5) * self.of_heights(i, j, bounded) * (one.mT * rows[j])
            for i, one in enumerate(rows)
            for j in range(i, len(rows))
        )
        return cross, half + half.mT

    def passed_on(
        self, feeds: Sequence[Any], on_states: Any, on_integrals: Any, rates: Sequence[Any], bounded: bool
    ) -> Any:
        """What outputs (N, outputs) gain by ``sum_j feeds_j u(t - tau_j)`` of finite variance (``white`` is zero).

        By itself, with the states, of which they see ``on_states`` (N, outputs, 2n), and with the integrals of
        `integrated`, of which they see ``on_integrals`` (N, outputs, k).
        """
        total: Any = 0.0
        for j, feed in enumerate(feeds):
            beside = (on_states @ self.with_velocity(j))[:, :, 0]
            for i, rate in enumerate(rates):
                felt = (on_integrals @ rate[:, :, None])[:, :, 0]
                beside = beside + felt * self.height_with_velocity(i, j, bounded)[:, :, 0]
                total = total + feed * feeds[i] * self.of_velocities(i, j)[:, :, 0]
            total = total + 2.0 * feed * beside
        return total
