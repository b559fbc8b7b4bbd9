"""A first-order system ``x' = A x + front u(t) + rear u(t - tau)``: what one process and its delay stir up.

A spectrum of white noise and first-order colours adds its parts to the right-hand side of one Lyapunov equation ``A X +
X A^T + Q = 0``. With ``e = e^(A tau) front``:

- white of intensity q: ``Q = q (front front^T + rear rear^T + e rear^T + rear e^T)``;
- colour of autocorrelation ``s^2 e^(-alpha |t|)``: ``Q = front g^T + rear h^T`` and its transpose, with
  ``g = E[x u(t)]`` and ``h = E[x u(t - tau)]``.

The road's warp is the integral of a velocity over the delay and joins by its own closed-form moments. All of this is
written once, for arrays as well as for the dual numbers that carry derivatives.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np


class Spectrum(NamedTuple):
    """A process's velocity spectrum, arrays or dual numbers: white (N, 1) or a number, rates and weights (N, J)."""

    white: Any
    alphas: Any
    weights: Any


class PassedOn(NamedTuple):
    """A velocity u of finite variance: E[u^2] and E[u(t) u(t - tau)] (N, 1), and E[x u], E[warp u] now and late."""

    variance: Any
    lagged: Any
    states: Any

    def through(self, now: Any, late: Any, with_now: Any, with_late: Any) -> Any:
        """What outputs (N, outputs) gain by passing it on, now and late, and by going with it in the states."""
        crossed = now * with_now + late * with_late + now * late * self.lagged
        return 2.0 * crossed + (now * now + late * late) * self.variance


class Correlations:
    """Correlations of the states of N designs with a process, now and a delay ago.

    Parameters
    ----------
    dynamics : Dynamics
        ``solve`` is ``A^-1 x``, and ``resolvent`` is ``(alpha I - A)^-1 x``.
    front, rear : (N, 2n, 1)
        How the process enters at once, and after the delay.
    free : (N, 2n, 1)
        ``e^(A tau) front``.
    forced : (N, J, 2n, 1)
        ``int_0^tau e^(A (tau - s)) front e^(-alpha s) ds`` for each colour.
    spectrum : Spectrum
    tau : (N,)
    """

    def __init__(
        self, dynamics: Any, front: Any, rear: Any, free: Any, forced: Any, spectrum: Spectrum, tau: Any
    ) -> None:
        self.dynamics, self.front, self.rear, self.free, self.forced = dynamics, front, rear, free, forced
        self.white = spectrum.white
        self.alphas, self.weights = spectrum.alphas[:, :, None, None], spectrum.weights[:, :, None, None]
        self.tau = tau[:, None, None, None]
        self.decay = np.exp(-(self.alphas * self.tau))
        # For a colour u of unit sigma^2: E[x u(t)], and the first half of E[x u(t - tau)].
        now, before = front[:, None] + self.decay * rear[:, None], (rear + free)[:, None] + 0.0 * self.decay
        both = dynamics.resolvent(self.alphas, np.concatenate([now, before], axis=-1))
        self.now, self.before = both[..., :1], both[..., 1:]

    def right_hand_side(self) -> Any:
        """The process's share of Q, (N, 2n, 2n)."""
        front, rear, white = self.front, self.rear, self.white
        sigma2 = 0.5 * self.weights * self.alphas
        g, h = (np.real((sigma2 * x).sum(axis=-3)) for x in (self.now, self.before + self.forced))
        half = front * (0.5 * white * front + g).mT + rear * (white * (0.5 * rear + self.free) + h).mT
        return half + half.mT

    def warp(self, now: float, later: float) -> tuple[Any, Any]:
        """``E[x warp]`` (N, 2n, 1) and ``E[warp^2]`` (N, 1) of a warp of rate ``now * u(t) + later * u(t - tau)``."""
        if now + later != 0.0:
            # Bounded by the cut-off alone: the height itself is the sum of colours of variance -weight / (2 alpha).
            height = -0.5 * self.weights / self.alphas
            cross = self.alphas * height * (now * self.now + later * (self.before - self.forced))
            own = height * (now**2 + later**2 + 2.0 * now * later * self.decay)
            return np.real(cross.sum(axis=-3)), np.real(own.sum(axis=-3)[:, :, 0])
        # The warp is the process's velocity integrated over the delay.
        tau = self.tau
        memory = -np.expm1(-(self.alphas * tau)) / self.alphas
        sigma2 = 0.5 * self.weights * self.alphas
        coloured = (sigma2 * (self.now - self.before - self.forced)).sum(axis=-3)
        coloured = coloured + (self.front + self.rear) * (sigma2 * memory).sum(axis=-3)
        cross = self.dynamics.solve(self.white * (self.free - self.front) - np.real(coloured))
        own = self.white * tau[:, 0] + np.real((self.weights * (tau - memory)).sum(axis=-3))
        return now * cross, now**2 * own[:, :, 0]

    def integrated(self, at_once: Any, drift: Any) -> tuple[Any, Any]:
        """``E[x h]`` (N, n, k) and ``E[h h^T]`` (N, k, k) of k integrals ``h``, whose rates are rows (N, k).

        ``h' = at_once u(t) + (drift - at_once) u(t - tau)``: where nothing drifts, all are one integral over the delay.
        """
        at_once, later = at_once[:, None], (drift - at_once)[:, None]
        if not drift.any():
            cross, own = self.warp(1.0, -1.0)
            return cross * at_once, own[..., None] * (at_once.mT * at_once)
        cross, own = self.warp(1.0, 0.0)
        own = own[..., None]
        if not later.any():
            return cross * at_once, own * (at_once.mT * at_once)
        both = 0.5 * self.warp(1.0, 1.0)[1][..., None] - own
        mixed = at_once.mT * later
        return (
            cross * at_once + self.warp(0.0, 1.0)[0] * later,
            own * (at_once.mT * at_once + later.mT * later) + both * (mixed + mixed.mT),
        )

    def passed_on(self, now: Any, later: Any) -> PassedOn:
        """What a velocity of finite variance (``white`` is zero) has to do with the states and the warp of `warp`."""
        sigma2 = 0.5 * self.weights * self.alphas
        g, h, variance, lagged = (
            np.real((sigma2 * x).sum(axis=-3))
            for x in (self.now, self.before + self.forced, 1.0 + 0.0 * self.decay, self.decay)
        )
        if np.any(now + later):
            # The height is the sum of colours of variance -weight / (2 alpha), and the velocity its derivative.
            slope = np.real((-0.5 * self.weights * self.decay).sum(axis=-3))
            with_warp = -later * slope, now * slope
        else:
            memory = -np.expm1(-(self.alphas * self.tau)) / self.alphas
            with_warp = (now * np.real((sigma2 * memory).sum(axis=-3)),) * 2
        return PassedOn(variance[..., 0], lagged[..., 0], ((g, with_warp[0]), (h, with_warp[1])))
