"""Any smooth spectrum of road velocity as first-order terms: a convex least-squares fit of the relative error.

``x^(2 - w)`` is a continuous sum of first-order spectra, ``x^(-2 b) = sin(pi b)/pi int e^((1-b)t) / (e^t + x^2) dt``,
and three of them a decade already stand for it to 1e-5. The argument is ``x = 2 pi n B``, so that the coherence of two
tracks a width B apart, which only depends on x, is fitted once for all widths. The ends of the fitted range are carried
on by the integrals that variances take from beyond them: deflections and accelerations go with ``omega`` at low
frequency (the warp of four wheels stays), and with ``1 / omega`` at high frequency (a velocity that is passed straight
on stays).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import fixed_quad

Array = NDArray[np.float64]

# Decades of x in which the fit is asked to be close, points of each, and decades of rates beyond; where an end is so
# steep that much comes from beyond it, more of them.
RANGE, POINTS, BEYOND, STEEP = (-4.0, 4.0), 40, 1.0, 2.0

# Rates a decade where the spectrum is a power of x, and where it bends.
SPARSE, DENSE = 3, 9

# A spectrum that falls faster than this power is made of low-passes, any other of high-passes: neither then cancels.
FALLING = -0.3

# What an end's integral weighs in the fit, beside one point.
END_WEIGHT = 30.0

# Singular values below this share of the largest are rounding: weights that they made would cancel to the last digits.
RANK = 2e-13


class Terms(NamedTuple):
    """``level + sum (low rate^2 + high x^2) / (rate^2 + x^2)``, and the largest relative error in `RANGE`."""

    level: float
    rates: Array
    low: Array
    high: Array
    error: float


def fit(density: Callable[[Array], Array], bends: Sequence[tuple[float, float]]) -> Terms:
    """First-order terms of a positive density over x, whose slope in logarithms changes within ``bends``."""
    x = np.logspace(*RANGE, int(np.ptp(RANGE) * POINTS) + 1)
    S = density(x)
    slope = np.gradient(np.log(S), np.log(x))
    (lowest, p_low), (highest, p_high) = (x[0], slope[0]), (x[-1], slope[-1])
    bounded = p_high < -1.0  # the velocity has a finite variance of its own

    rates = _rates(p_low, p_high, bends)
    high = (np.interp(np.log(rates), np.log(x), slope) > FALLING) & (not bounded)
    square = (x[:, None] / rates) ** 2
    level = 0.0 if bounded else 1.0
    rows = [np.c_[np.where(high, square, 1.0) / (1.0 + square), np.full(len(x), level)] / S[:, None]]
    for k in (0, 2) if p_low > -1.0 else (2,):
        total = _integral(density, lowest, k, -1.0)
        row = np.r_[_below(lowest, rates, high, k), level * lowest ** (k + 1) / (k + 1)]
        rows.append(END_WEIGHT * row[None] / total)
    for k in (-2, 0) if bounded else (-2,):
        total = _integral(density, highest, k, 1.0)
        rows.append(END_WEIGHT * np.r_[_above(highest, rates, high, k), level / highest][None] / total)

    A = np.concatenate(rows)
    target = np.r_[np.ones(len(x)), np.full(len(A) - len(x), END_WEIGHT)]
    size = np.linalg.norm(A, axis=0)
    size[size == 0.0] = 1.0
    weights = np.linalg.lstsq(A / size, target, rcond=RANK)[0] / size
    error = float(np.abs(A[: len(x)] @ weights - 1.0).max())
    own = weights[:-1]
    return Terms(level * float(weights[-1]), rates, np.where(high, 0.0, own), np.where(high, own, 0.0), error)


def _rates(p_low: float, p_high: float, bends: Sequence[tuple[float, float]]) -> Array:
    start = RANGE[0] - (STEEP if p_low < -0.4 else BEYOND)
    end = RANGE[1] + (STEEP if -1.6 < p_high < -1.0 else BEYOND)
    steps = np.arange(round(start * DENSE), round(end * DENSE) + 1)
    exponents = steps / DENSE
    keep = steps % (DENSE // SPARSE) == 0
    for low, high in bends:
        keep |= (exponents >= np.log10(low)) & (exponents <= np.log10(high))
    return np.asarray(10.0 ** exponents[keep])


def _integral(density: Callable[[Array], Array], end: float, k: int, direction: float) -> float:
    """``int x^k S dx`` from an end of the range outwards: three decades by quadrature, then as a power of x."""

    def integrand(u: Array) -> Array:
        x = np.exp(u)
        return density(x) * x ** (k + 1)

    u, far = np.log(end), np.log(end) + direction * 3.0 * np.log(10.0)
    last, before = integrand(np.array([far, far - 0.1 * direction]))
    exponent = np.log(last / before) / 0.1
    near = fixed_quad(integrand, min(u, far), max(u, far), n=40)[0]
    return float(near - last / exponent)


def _below(end: float, rates: Array, high: NDArray[np.bool_], k: int) -> Array:
    """``int_0^end x^k`` of high-passes or low-passes of unit weight."""
    t = end / rates
    # arctan t = t - t^3/3 + ...: what is left after the first one or two terms, by its series where t is small.
    once = np.where(t < 0.03, t**3 / 3 - t**5 / 5 + t**7 / 7 - t**9 / 9, t - np.arctan(t))
    if k == 0:
        return np.where(high, rates * once, end - rates * once)
    twice = np.where(t < 0.03, t**5 / 5 - t**7 / 7 + t**9 / 9, t**3 / 3 - once)
    return rates**3 * np.where(high, twice, once)


def _above(end: float, rates: Array, high: NDArray[np.bool_], k: int) -> Array:
    """``int_end^inf x^k`` of high-passes or low-passes of unit weight; k = 0 of low-passes only."""
    t = rates / end
    if k == 0:
        return rates * np.arctan(t)
    rest = np.where(t < 0.03, t**2 / 3 - t**4 / 5 + t**6 / 7, 1.0 - np.arctan(t) / t)
    return np.where(high, 1.0 - rest, rest) / end
