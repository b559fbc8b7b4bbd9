"""The spectrum of road velocity as a white part and first-order colours: what makes a variance a matter of algebra."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..roads import Road
from .excitation import Process

Array = NDArray[np.float64]

# x K_1(x) ~ sum c_i / (1 + (x / x_i)^2) with sum c_i = 1: a minimax fit of the error relative to 1 - x K_1(x), which
# rules roll, over x from 0.05 to 60; it stays below 3.5e-4 there. The signs are free, since the coherence decays
# exponentially and nonnegative terms cannot come closer than 0.7 %.
COHERENCE_RATES = np.array([0.042969, 0.144895, 0.402436, 1.023908, 2.287207, 4.500472, 7.055675])
COHERENCE_WEIGHTS = np.array([0.0014158, 0.0111706, 0.0779362, 0.4023666, 0.891928, -0.4842454, 0.0994281])
COHERENCE_WEIGHTS = COHERENCE_WEIGHTS / COHERENCE_WEIGHTS.sum()


class Spectrum(NamedTuple):
    """Two-sided velocity spectrum ``white + sum_j weight_j alpha_j^2 / (alpha_j^2 + omega^2)``."""

    white: float
    alphas: Array
    weights: Array


def spectrum(road: Road, process: Process, track_width: Array) -> Spectrum:
    """Write a process's velocity spectrum as a white part and signed first-order colours, (N, J)."""
    q = road.intensity
    alphas = np.empty((len(track_width), 0))
    weights = alphas
    if process.sign:
        alphas = COHERENCE_RATES * road.speed / track_width[:, None]
        weights = np.broadcast_to(0.5 * process.sign * q * COHERENCE_WEIGHTS, alphas.shape)
    white = q * process.share
    if road.cutoff:
        # The cut-off multiplies by w^2 / (w^2 + cut^2); partial fractions, apart from coincident rates.
        cut = 2.0 * np.pi * road.cutoff * road.speed
        alphas = np.where(np.abs(alphas - cut) < 1e-6 * cut, (1.0 + 2e-6) * alphas, alphas)
        weights = weights * alphas**2 / (alphas**2 - cut**2)
        own = -white - weights.sum(axis=1, keepdims=True)
        alphas = np.concatenate([alphas, np.full_like(own, cut)], axis=1)
        weights = np.concatenate([weights, own], axis=1)
    return Spectrum(white, alphas, weights)
