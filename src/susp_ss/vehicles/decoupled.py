"""A left-right symmetric linkage as separate problems: the mean of its two sides, and half their difference.

Each half is one or two struts joined by a rigid body. The mean of left and right heaves and pitches, the half
difference rolls; neither feels the other. The halves are read off the linkage itself, so that whatever has none
(unequal sides, a seat, a rigid tyre) is known by what it is.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np

from ..quantities import signal
from .linkage import Corner, Linkage, Wheel


class Strut(NamedTuple):
    """A wheel of mass ``mu`` on its tyre ``kt, ct``, and the suspension ``ks, cs`` that carries the body on it."""

    mu: Any
    ks: Any
    cs: Any
    kt: Any
    ct: Any


class BodyMode(NamedTuple):
    """A body coordinate of one over ``mobility`` inertia that lifts the mount over each strut by its ``arm``."""

    mobility: Any
    arms: tuple[Any, ...]


class Half(NamedTuple):
    """Struts by the corners that they stand for, and the body coordinates that they move.

    ``points`` are the body's accelerations by name, each with its share of every coordinate; those of the mounts are
    the rows of `compliance`.
    """

    struts: dict[tuple[str, ...], Strut]
    body: dict[str, BodyMode]
    points: dict[str, dict[str, Any]]

    def select(self, designs: slice) -> Half:
        """The same half of some of the designs."""

        def some(x: Any) -> Any:
            return x[designs] if isinstance(x, np.ndarray) else x

        return Half(
            {name: Strut._make(map(some, strut)) for name, strut in self.struts.items()},
            {name: BodyMode(some(mode.mobility), tuple(map(some, mode.arms))) for name, mode in self.body.items()},
            {name: {mode: some(share) for mode, share in shares.items()} for name, shares in self.points.items()},
        )

    def compliance(self, i: int, j: int) -> Any:
        """Acceleration over strut ``i`` per unit force of strut ``j``, in 1/kg."""
        return sum(mode.mobility * mode.arms[i] * mode.arms[j] for mode in self.body.values())

    def rigidity(self) -> Any:
        """Determinant of the 2 x 2 compliance, in 1/kg^2, free of cancellation; 0 for a body with one mode."""
        modes, total = list(self.body.values()), 0.0
        for i, one in enumerate(modes):
            for other in modes[:i]:
                area = one.arms[0] * other.arms[1] - one.arms[1] * other.arms[0]
                total = total + one.mobility * other.mobility * area**2
        return total


def halves(linkage: Linkage, wheels: Mapping[str, Wheel]) -> tuple[Half, ...]:
    """The mean of left and right, then half their difference; the mean alone on one track; none without such a split.

    A single track splits into nothing, and is its own mean. Two sides split where every axle has both, and the same
    values on both.
    """
    if linkage.links or linkage.more or any(corner.wheel is None for corner in linkage.corners.values()):
        return ()
    axles: list[tuple[str, ...]]
    if not any(wheel.side for wheel in wheels.values()):
        axles = [(name,) for name in sorted(wheels, key=lambda name: wheels[name].axle)]
    else:
        ends = sorted({wheel.axle for wheel in wheels.values()})
        axles = [tuple(name for name, wheel in wheels.items() if wheel.axle == axle) for axle in ends]
        if any(sorted(wheels[name].side for name in axle) != [-1, 1] for axle in axles):
            return ()
    if len(axles) > 2 or not set(linkage.bars) <= set(axles):
        return ()

    masses = {name: mass for motion, mass in linkage.masses.items() for name in motion.terms}
    struts = {name: _strut(corner, masses) for name, corner in linkage.corners.items()}
    ridden = {name for corner in linkage.corners.values() if corner.wheel for name in corner.wheel.terms}
    parity = {name: _parity(name, linkage, axles) for name in masses if name not in ridden}
    if None in parity.values() or any(not _same(*(struts[name] for name in axle)) for axle in axles):
        return ()

    def half(odd: bool) -> Half:
        coordinates = [name for name, is_odd in parity.items() if is_odd is odd]
        body = {
            name: BodyMode(len(axles[0]) / masses[name], tuple(_arm(linkage.corners[axle[-1]], name) for axle in axles))
            for name in coordinates
        }
        stiffened = {
            axle: struts[axle[-1]]._replace(ks=struts[axle[-1]].ks + 2.0 * linkage.bars[axle])
            if odd and axle in linkage.bars
            else struts[axle[-1]]
            for axle in axles
        }
        return Half(stiffened, body, _points(linkage, coordinates))

    return (half(False), half(True)) if len(axles[0]) == 2 else (half(False),)


def _strut(corner: Corner, masses: Mapping[str, Any]) -> Strut:
    assert corner.wheel is not None
    (wheel,) = corner.wheel.terms
    return Strut(masses[wheel], corner.ks, corner.cs, corner.kt, corner.ct)


def _same(one: Strut, *others: Strut) -> bool:
    """Whether every design has the same values on all."""
    return all(_equal(x, y) for other in others for x, y in zip(one, other, strict=True))


def _equal(x: Any, y: Any) -> bool:
    if isinstance(x, float) and isinstance(y, float):
        return x == y
    return x is y or np.array_equal(x, y)


def _arm(corner: Corner, coordinate: str) -> Any:
    return corner.mount.terms.get(coordinate, 0.0)


def _parity(coordinate: str, linkage: Linkage, axles: list[tuple[str, ...]]) -> bool | None:
    """Whether a body coordinate moves both mounts of an axle alike (False) or oppositely (True); None if neither."""
    arms = [[_arm(linkage.corners[name], coordinate) for name in axle] for axle in axles]
    if all(_equal(one, other) for one, *others in arms for other in others):
        return False
    return True if all(_equal(one, -other) for one, *others in arms for other in others) else None


def _points(linkage: Linkage, coordinates: list[str]) -> dict[str, dict[str, Any]]:
    """Shares of these coordinates in every acceleration but those of the mounts, where there are any."""
    mounts = {id(corner.mount) for corner in linkage.corners.values()}
    motions = {signal("bacc", place): motion for place, motion in linkage.points.items() if id(motion) not in mounts}
    shares = {
        name: {coordinate: motion.terms[coordinate] for coordinate in coordinates if coordinate in motion.terms}
        for name, motion in {**motions, **linkage.rotations}.items()
    }
    return {name: share for name, share in shares.items() if share}
