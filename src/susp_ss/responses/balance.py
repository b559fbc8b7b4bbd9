"""Where the mean forces of curved springs and dampers, of bars and tyres balance."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..vehicles.curves import Curve

Array = NDArray[np.float64]

# Steps, and the error of a deflection, relative and in m, below which they end.
STEPS, SETTLED, NOTHING = 60, 1e-12, 1e-19


def balanced(
    compliance: Array, springs: Sequence[Any], first: Sequence[Any], sigma: Array, pump: Array, at: Array
) -> Array:
    """Mean deflections d (N, corners) of N designs: ``d = at - B (E[f(d)] - k1 d + f0)``.

    What the springs push on average beyond numbers ``first`` in their place, and the dampers' mean force ``pump``,
    act on the linear vehicle of these numbers, which stands at ``at`` and yields by its ``compliance`` B (..., corners,
    corners). Mean forces never fall with deflection, so that there is one answer; Newton's steps are halved where
    they lead away.
    """

    def beyond(d: Array) -> tuple[Array, Array]:
        force, slope = pump.copy(), np.zeros_like(pump)
        for i, (spring, number) in enumerate(zip(springs, first, strict=True)):
            if isinstance(spring, Curve):
                means = spring.means(sigma[:, i], d[:, i])
                force[:, i] += means.force - number * d[:, i]
                slope[:, i] = means.slope - number
        return force, slope

    trial, best = at.copy(), np.full(len(at), np.inf)
    d, step, share = trial, np.zeros_like(at), np.ones(len(at))
    for _ in range(STEPS):
        force, slope = beyond(trial)
        residual = trial - at + (compliance @ force[..., None])[..., 0]
        size = np.abs(residual).max(axis=-1)
        if np.all(size <= SETTLED * np.abs(trial).max(axis=-1) + NOTHING):
            return trial
        newton = np.linalg.solve(np.eye(at.shape[1]) + compliance * slope[:, None, :], -residual[..., None])[..., 0]
        closer = (size < best)[:, None]
        d, step, best = np.where(closer, trial, d), np.where(closer, newton, step), np.minimum(size, best)
        share = np.where(closer[:, 0], 1.0, 0.5 * share)
        trial = d + share[:, None] * step
    return d
