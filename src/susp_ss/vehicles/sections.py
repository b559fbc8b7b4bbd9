"""A left-right symmetric vehicle as separate problems: the mean of its two sides, and half their difference.

Each section is one or two struts joined by a rigid body. The mean of left and right heaves and pitches, the half
difference rolls; neither feels the other.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np


class Strut(NamedTuple):
    """A wheel of mass ``mu`` on its tyre ``kt, ct``, and the suspension ``ks, cs`` that carries the body on it."""

    mu: Any
    ks: Any
    cs: Any
    kt: Any
    ct: Any

    def equals(self, other: Strut) -> bool:
        """Whether every design has the same values on both."""
        return all(x is y or np.array_equal(x, y) for x, y in zip(self, other, strict=True))

    def with_bar(self, arb: Any) -> Strut:
        """The half difference of left and right bends an anti-roll bar by twice its own deflection."""
        return self._replace(ks=self.ks + 2.0 * arb)


class Mode(NamedTuple):
    """A body coordinate of one over ``mobility`` inertia that lifts the point over each strut by its ``arm``."""

    mobility: Any
    arms: tuple[Any, ...]


class Section(NamedTuple):
    """Struts by the corners that they stand for, and body modes by the acceleration that each is."""

    struts: dict[tuple[str, ...], Strut]
    body: dict[str, Mode]

    def compliance(self, i: int, j: int) -> Any:
        """Acceleration over strut ``i`` per unit force of strut ``j``, in 1/kg."""
        return sum(mode.mobility * mode.arms[i] * mode.arms[j] for mode in self.body.values())

    def rigidity(self) -> Any:
        """Determinant of the 2 x 2 compliance, in 1/kg^2, free of cancellation; 0 for a body with one mode."""
        if len(self.body) == 1:
            return 0.0
        one, other = self.body.values()
        return one.mobility * other.mobility * (one.arms[0] * other.arms[1] - one.arms[1] * other.arms[0]) ** 2
