"""Force laws and their Gaussian means.

A law has its force at any velocity or deflection, and, where that is Gaussian of mean m and deviation s, the means of
the force and of its first three derivatives: ``E[f]``, ``E[f'] = E[f (x - m)] / s^2``, ``E[f'']`` and ``E[f''']``. The
second is the rate that comes closest in the mean square (Roberts and Spanos, Random Vibration and Statistical
Linearization, 1990), and they are one another's derivatives: along m each is the next, along s it is s times the one
after the next. Piecewise linear laws have them as a sum over kinks, `Digressive` in closed form.
"""

from __future__ import annotations

import functools
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, NamedTuple, Protocol, Self

import numpy as np
import xarray as xr
from scipy.special import erf, ndtr


class Means(NamedTuple):
    """Means of a force (N) and of its first three derivatives under a Gaussian motion."""

    force: Any
    slope: Any
    curvature: Any
    third: Any

    def scaled(self, factor: Any) -> Means:
        """The same of a force that is so many times as large."""
        return Means(*(factor * mean for mean in self))


class Law(Protocol):
    """A force that is zero at rest and never falls; its parameters may be arrays over designs."""

    @property
    def rate(self) -> Any:
        """Slope for small motion: the mean of the slopes on both sides of rest."""
        ...

    @property
    def steepest(self) -> Any:
        """The largest slope."""
        ...

    def leaves(self) -> list[Any]:
        """Its parameters."""
        ...

    def mapped(self, function: Callable[[Any], Any]) -> Self:
        """The same law with a function applied to every parameter."""
        ...

    def force(self, x: Any) -> Any:
        """The force at x."""
        ...

    def means(self, sigma: Any, mean: Any = 0.0) -> Means:
        """Means under a Gaussian x."""
        ...


@dataclass(frozen=True, eq=False)
class Broken:
    """A piecewise linear law: one more slope than kinks, through the origin."""

    kinks: tuple[Any, ...]
    slopes: tuple[Any, ...]

    @property
    def rate(self) -> Any:
        below = above = self.slopes[0]
        for kink, slope in zip(self.kinks, self.slopes[1:], strict=True):
            below, above = _where(kink < 0.0, slope, below), _where(kink <= 0.0, slope, above)
        return 0.5 * (below + above)

    @property
    def steepest(self) -> Any:
        return functools.reduce(np.maximum, self.slopes)

    def leaves(self) -> list[Any]:
        return [*self.kinks, *self.slopes]

    def mapped(self, function: Callable[[Any], Any]) -> Broken:
        return Broken(tuple(map(function, self.kinks)), tuple(map(function, self.slopes)))

    def _bends(self) -> list[tuple[Any, Any]]:
        """Every kink, and by how much the slope rises there."""
        rises = (after - before for before, after in zip(self.slopes, self.slopes[1:], strict=False))
        return list(zip(self.kinks, rises, strict=True))

    def force(self, x: Any) -> Any:
        total = self.slopes[0] * x
        for kink, rise in self._bends():
            total = total + rise * (np.maximum(x - kink, 0.0) - _above(kink))
        return total

    def means(self, sigma: Any, mean: Any = 0.0) -> Means:
        force, slope, curvature, third = self.slopes[0] * mean, self.slopes[0], 0.0, 0.0
        for kink, rise in self._bends():
            u = (mean - kink) / sigma
            below, density = ndtr(u), np.exp(-0.5 * u**2) / np.sqrt(2.0 * np.pi)
            force = force + rise * (sigma * (u * below + density) - _above(kink))
            slope, curvature = slope + rise * below, curvature + rise * density / sigma
            third = third - rise * u * density / sigma**2
        return Means(force, slope, curvature, third)

    def stiffened(self, by: Any) -> Broken:
        """The same with a linear spring beside it."""
        return Broken(self.kinks, tuple(slope + by for slope in self.slopes))


@dataclass(frozen=True, eq=False)
class Digressive:
    """A smooth damper law whose slope falls from its value at rest to ``final`` times that, either way.

    ``f(v) = c (final v + (1 - final) knee erf(sqrt(pi) v / (2 knee)))`` with ``c`` the slope of bump or rebound: the
    error function saturates so that its Gaussian means are elementary. For small motion and in the far, the force is
    along two lines that meet at ``knee``.
    """

    bump: Any
    rebound: Any
    knee: Any
    final: Any

    @property
    def rate(self) -> Any:
        return 0.5 * (self.bump + self.rebound)

    @property
    def steepest(self) -> Any:
        return np.maximum(self.bump, self.rebound)

    def leaves(self) -> list[Any]:
        return [self.bump, self.rebound, self.knee, self.final]

    def mapped(self, function: Callable[[Any], Any]) -> Digressive:
        return Digressive(*map(function, self.leaves()))

    def force(self, x: Any) -> Any:
        saturating = self.knee * erf(0.5 * np.sqrt(np.pi) * x / self.knee)
        return _where(x > 0.0, self.bump, self.rebound) * (self.final * x + (1.0 - self.final) * saturating)

    def means(self, sigma: Any, mean: Any = 0.0) -> Means:
        if np.any(mean):
            raise ValueError("a damper has no mean velocity, about which Digressive.means could be taken")
        t = np.sqrt(0.5 * np.pi) * sigma / self.knee
        skew, above = (self.bump - self.rebound), 1.0 - self.final
        spread = 1.0 + t**2
        return Means(
            skew * (self.final * sigma / np.sqrt(2.0 * np.pi) + above * self.knee * np.arctan(t) / np.pi),
            self.rate * (self.final + above / np.sqrt(spread)),
            skew * (self.final + above / spread) / (np.sqrt(2.0 * np.pi) * sigma),
            -self.rate * above * 0.5 * np.pi / self.knee**2 * spread**-1.5,
        )


def _above(kink: Any) -> Any:
    """How far rest lies above a kink."""
    return max(-kink, 0.0) if isinstance(kink, float) else np.maximum(-kink, 0.0)


def _where(condition: Any, one: Any, other: Any) -> Any:
    if any(isinstance(x, xr.DataArray) for x in (condition, one, other)):
        return xr.where(condition, one, other)
    chosen = np.where(condition, one, other)
    return chosen if chosen.ndim else float(chosen)
