"""Extremes and fatigue of stationary Gaussian processes, from the moments of their spectra."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.special import gamma

Array = NDArray[np.float64]

ESTIMATES = ("vanmarcke", "davenport", "cartwright")
"""Of the highest value, in the order of `Gaussian.highest`."""

COUNTINGS = ("narrow_band", "dirlik")
"""Of cycles, in the order of `Gaussian.ranges`."""

# Levels up to which an integral over them runs, in standard deviations, beyond which one wave in 1e31 comes; its nodes.
HIGHEST, NODES = 12.0, 200

# Vanmarcke's power of the bandwidth, for what an envelope crosses without a peak under it.
EFFECTIVE = 1.2

# Levels in standard deviations as far as which logarithms and powers are numbers.
NEAREST, FARTHEST = 1e-7, 37.0


class Gaussian(NamedTuple):
    """A process of zero mean by its moments ``m_k = int |omega|^k S d omega``, arrays of one shape.

    They may be infinite from some k on. A process that does not move has no rates and no extremes.
    """

    m0: Array
    m1: Array
    m2: Array
    m4: Array

    @property
    def rate(self) -> Array:
        """Upward crossings of zero a second, ``sqrt(m2 / m0) / (2 pi)`` (Rice 1945)."""
        return np.sqrt(_ratio(self.m2, self.m0, 0.0)) / (2.0 * np.pi)

    @property
    def irregularity(self) -> Array:
        """Zero crossings over peaks, ``m2 / sqrt(m0 m4)``: 1 of a sine, 0 where there are peaks without end."""
        known = np.where(np.isinf(self.m4), 0.0, _ratio(self.m2, np.sqrt(self.m0 * self.m4), 0.0))
        return np.where(np.isnan(self.m2), np.nan, known)

    @property
    def bandwidth(self) -> Array:
        """Vanmarcke's ``sqrt(1 - m1^2 / (m0 m2))``: 0 of a sine, up to 1."""
        known = np.isfinite(self.m2)
        m1, m2 = (np.where(known, m, 1.0) for m in (self.m1, self.m2))
        share = _ratio(m1, self.m0, 0.0) * _ratio(m1, m2, 0.0)
        return np.where(known, np.sqrt(np.clip(1.0 - share, 0.0, 1.0)), 1.0)

    def passing(self, level: Array) -> Array:
        """Upward crossings of a level a second."""
        return np.asarray(self.rate * np.exp(-0.5 * self._scaled(level) ** 2))

    def reaching(self, level: Array, seconds: Array) -> Array:
        """Probability of being at a level, or coming to it, within a time: see `log_of_staying`."""
        return np.asarray(-np.expm1(log_of_staying(self._scaled(level), self.rate * seconds, self.bandwidth)))

    def highest(self, seconds: Array) -> Array:
        """Expected highest value within a time, (..., estimates)."""
        waves = np.asarray(self.rate * seconds)
        finite = np.where(np.isfinite(waves), waves, 10.0)
        factors = np.stack(
            [vanmarcke(finite, self.bandwidth), davenport(finite), cartwright(finite, self.irregularity)], axis=-1
        )
        of_infinite = np.where(np.isfinite(waves), 1.0, waves)[..., None]
        return np.where(self.m0[..., None] > 0.0, np.sqrt(self.m0)[..., None] * factors * of_infinite, 0.0)

    def ranges(self, slope: float) -> Array:
        """Sum of the ranges of a second's cycles, each to the power ``slope``, (..., countings)."""
        moving, moments = self.m0 > 0.0, (np.where(self.m0 > 0.0, m, 1.0) for m in self)
        m0, m1, m2, m4 = moments
        with np.errstate(invalid="ignore"):
            both = np.stack([narrow_band(m0, m2, slope), dirlik(m0, m1, m2, m4, slope)], axis=-1)
        return np.where(moving[..., None], both, 0.0)

    def _scaled(self, level: Array) -> Array:
        return _ratio(level, np.sqrt(self.m0), np.inf)


def _ratio(one: Any, other: Any, nothing: float) -> Array:
    """A ratio, where the other is zero a given value."""
    shape = np.broadcast_shapes(np.shape(one), np.shape(other))
    with np.errstate(invalid="ignore"):
        return np.divide(one, other, out=np.full(shape, nothing), where=np.asarray(other) != 0.0)


def log_of_staying(level: Any, waves: Any, bandwidth: Any) -> Any:
    """Logarithm of the probability to start and stay below ``r`` standard deviations for so many waves.

    ``(1 - e^(-r^2/2)) exp(-N (1 - e^(-sqrt(2 pi) delta^1.2 r)) / (e^(r^2/2) - 1))``: crossings come in clumps, of which
    the envelope tells (E. H. Vanmarcke 1975, one barrier).
    """
    r = np.clip(level, NEAREST, FARTHEST)
    clumps = -np.expm1(-np.sqrt(2.0 * np.pi) * bandwidth**EFFECTIVE * r)
    return np.log1p(-np.exp(-0.5 * r**2)) - waves * clumps / np.expm1(0.5 * r**2)


def vanmarcke(waves: Array, bandwidth: Array) -> Array:
    """Mean of the highest value in standard deviations, by the probability to stay below a level."""
    return _mean_of_highest(lambda r: np.exp(log_of_staying(r, waves, bandwidth)))


def davenport(waves: Array) -> Array:
    """``sqrt(2 ln N) + 0.5772 / sqrt(2 ln N)``, crossings one by one (A. G. Davenport 1964); NaN below one wave."""
    with np.errstate(divide="ignore", invalid="ignore"):
        root = np.sqrt(2.0 * np.log(waves))
        return np.where(waves > 1.0, root + np.euler_gamma / root, np.nan)


def cartwright(waves: Array, irregularity: Array) -> Array:
    """Mean of the highest of ``N / g`` peaks, of which ``g e^(-r^2/2)`` are above r, g being the irregularity.

    D. E. Cartwright and M. S. Longuet-Higgins 1956; with peaks without end ``exp(-N e^(-r^2/2))`` is left.
    """

    def below(r: float) -> Array:
        waves_above = np.exp(-0.5 * r**2)
        above = irregularity * waves_above
        return np.exp(waves * waves_above * _ratio(np.log1p(-above), above, -1.0))

    return _mean_of_highest(below)


def _mean_of_highest(below: Callable[[float], Array]) -> Array:
    """``int_0^inf 1 - P(highest < r) dr``, which is the mean where the highest value is positive."""
    return np.asarray(sum(weight * (1.0 - below(r)) for r, weight in _levels()))


@cache
def _levels() -> list[tuple[float, float]]:
    at, weights = np.polynomial.legendre.leggauss(NODES)
    return list(zip(0.5 * HIGHEST * (1.0 + at), 0.5 * HIGHEST * weights, strict=True))


def narrow_band(m0: Any, m2: Any, slope: float) -> Any:
    """``sqrt(m2 / m0) / (2 pi) (2 sqrt(2 m0))^k Gamma(1 + k/2)``: every wave is a cycle (J. W. Miles 1954)."""
    return np.sqrt(m2 / m0) / (2.0 * np.pi) * (8.0 * m0) ** (0.5 * slope) * gamma(1.0 + 0.5 * slope)


def dirlik(m0: Any, m1: Any, m2: Any, m4: Any, slope: float) -> Any:
    """The same of rainflow cycles: an exponential and two Rayleigh distributions of their ranges (T. Dirlik 1985)."""
    g, mean = m2 / np.sqrt(m0 * m4), m1 / m0 * np.sqrt(m2 / m4)
    D1 = 2.0 * (mean - g**2) / (1.0 + g**2)
    R = (g - mean - D1**2) / (1.0 - g - D1 + D1**2)
    D2 = (1.0 - g - D1 + D1**2) / (1.0 - R)
    D3 = 1.0 - D1 - D2
    Q = 1.25 * (g - D3 - D2 * R) / D1
    rayleigh = np.sqrt(2.0) ** slope * gamma(1.0 + 0.5 * slope) * (D2 * np.abs(R) ** slope + D3)
    peaks = np.sqrt(m4 / m2) / (2.0 * np.pi)
    return peaks * (4.0 * m0) ** (0.5 * slope) * (D1 * Q**slope * gamma(1.0 + slope) + rayleigh)
