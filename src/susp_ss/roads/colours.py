"""The spectrum of road velocity as a white part and first-order colours: what makes a variance a matter of algebra."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from .road import Road

Array = NDArray[np.float64]

# x K_1(x) ~ sum c_i / (1 + (x / x_i)^2) with sum c_i = 1: a minimax fit of the error relative to 1 - x K_1(x), which
# rules roll, over x from 0.05 to 60; it stays below 3.5e-4 there. The signs are free, since the coherence decays
# exponentially and nonnegative terms cannot come closer than 0.7 %.
COHERENCE_RATES = np.array([0.042969, 0.144895, 0.402436, 1.023908, 2.287207, 4.500472, 7.055675])
COHERENCE_WEIGHTS = np.array([0.0014158, 0.0111706, 0.0779362, 0.4023666, 0.891928, -0.4842454, 0.0994281])
COHERENCE_WEIGHTS = COHERENCE_WEIGHTS / COHERENCE_WEIGHTS.sum()

# Rates as near as this to one another are moved apart: what that changes is far below what their terms say.
COINCIDENT = 1e-6


class Colours(NamedTuple):
    """Two-sided velocity spectrum ``white + sum_j weights_j alphas_j^2 / (alphas_j^2 + omega^2)``, rates (N, J).

    ``static`` is its value at zero frequency, which a cut-off makes exactly zero.
    """

    static: Any
    white: float
    alphas: Array
    weights: Array


def colours(road: Road, share: float, sign: int, track_width: NDArray[Any], cutoff: Any = None) -> Colours:
    """Velocity spectrum of the part ``share + 0.5 sign gamma`` of two tracks a width (N,) apart.

    The mean of both tracks is ``(1 + gamma) / 2`` of one, their half difference ``(1 - gamma) / 2``. A ``cutoff`` takes
    the place of the road's own.

    Raises
    ------
    ValueError
        The road has no spectrum of first-order terms, or none that is white at high frequency: what passes the road's
        velocity on is taken for infinite.
    """
    white, rates, weights = road.first_order()
    if not white > 0.0:
        raise ValueError(
            f"the covariance route needs a road whose velocity has a white part, got {white:g} m^2/s; take "
            'ride_metrics(..., method="spectral")'
        )
    N = len(track_width)
    total = Colours(
        white + weights.sum(),
        white,
        np.broadcast_to(road.speed * rates, (N, len(rates))),
        np.broadcast_to(weights, (N, len(weights))),
    )
    coherence = Colours(share, share, np.empty((N, 0)), np.empty((N, 0)))
    if sign:
        alphas = COHERENCE_RATES * road.speed / track_width[:, None]
        part = np.broadcast_to(0.5 * sign * COHERENCE_WEIGHTS, alphas.shape)
        coherence = Colours(share + 0.5 * sign, share, alphas, part)
    total = _product(total, coherence)
    cutoff = road.cutoff if cutoff is None else cutoff
    return _high_passed(total, 2.0 * np.pi * cutoff * road.speed) if cutoff else total


def _product(one: Colours, other: Colours) -> Colours:
    """Partial fractions of a product: ``L_a L_b = (b^2 L_a - a^2 L_b)/(b^2 - a^2)`` with ``L_a = a^2/(a^2 + w^2)``."""
    static, white = one.static * other.static, one.white * other.white
    if not one.alphas.shape[1] or not other.alphas.shape[1]:
        alphas = np.concatenate([one.alphas, other.alphas], axis=1)
        return Colours(static, white, alphas, np.concatenate([one.weights * other.white, one.white * other.weights], 1))
    b = other.alphas[:, None, :]
    a = _apart(one.alphas[:, :, None], b)
    shares = one.weights[:, :, None] * other.weights[:, None, :] / (b**2 - a**2)
    own = one.weights * other.white + (shares * b**2).sum(axis=2)
    others = one.white * other.weights - (shares * a**2).sum(axis=1)
    alphas = np.concatenate([one.alphas, other.alphas], axis=1)
    return Colours(static, white, alphas, np.concatenate([own, others], axis=1))


def _high_passed(colours: Colours, cut: Any) -> Colours:
    """Multiply by ``w^2 / (w^2 + cut^2)``: partial fractions that cancel nothing at low frequency."""
    alphas = _apart(colours.alphas, cut)
    weights = colours.weights * alphas**2 / (alphas**2 - cut**2)
    own = -colours.white - weights.sum(axis=1, keepdims=True)
    alphas = np.concatenate([alphas, np.full_like(own, cut)], axis=1)
    return Colours(0.0, colours.white, alphas, np.concatenate([weights, own], axis=1))


def _apart(rates: Any, others: Any) -> Any:
    """Rates, moved by a little where they coincide with others."""
    return np.where(np.abs(rates - others) < COINCIDENT * np.abs(others), (1.0 + 2.0 * COINCIDENT) * rates, rates)
