"""A linkage as struts on a rigid body: whole, or as the mean of its two sides and half their difference.

Where left and right are alike, the mean of both heaves and pitches, the half difference rolls, neither feels the other,
and each half is a strut an axle, joined by a body. All is read off the linkage itself, so that whatever has no halves
(unequal sides), or is more than struts on a rigid body (a rigid tyre, links of its own), is known by what it is. A seat
is a strut as well: its rider is a wheel without a tyre.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..quantities import signal
from .linkage import Corner, Linkage, Motion, Wheel


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


class OnStruts(NamedTuple):
    """Struts by the corners that they stand for, bars between two of them, and the body coordinates that they move.

    ``points`` are the body's accelerations by name, each with its share of every coordinate; ``seats`` are those of the
    struts, the last ones, that stand for seats.
    """

    struts: dict[tuple[str, ...], Strut]
    bars: dict[tuple[tuple[str, ...], ...], Any]
    body: dict[str, BodyMode]
    points: dict[str, dict[str, Any]]
    seats: tuple[str, ...] = ()

    def select(self, designs: slice | NDArray[np.int_]) -> OnStruts:
        """The same of some of the designs."""

        def some(x: Any) -> Any:
            return x[designs] if isinstance(x, np.ndarray) else x

        return OnStruts(
            {name: Strut._make(map(some, strut)) for name, strut in self.struts.items()},
            {pair: some(stiffness) for pair, stiffness in self.bars.items()},
            {name: BodyMode(some(mode.mobility), tuple(map(some, mode.arms))) for name, mode in self.body.items()},
            {name: {mode: some(share) for mode, share in shares.items()} for name, shares in self.points.items()},
            self.seats,
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


def whole(linkage: Linkage) -> OnStruts | None:
    """All struts on their body, each for its own corner; None where there is more than struts on a rigid body."""
    body = _body(linkage)
    if body is None or len(linkage.corners) < len(body):
        return None
    feet = [*(corner.mount for corner in linkage.corners.values()), *(seat.floor for seat in linkage.seats.values())]
    return OnStruts(
        {(name,): strut for name, strut in (_struts(linkage) | _riders(linkage)).items()},
        {tuple((name,) for name in pair): stiffness for pair, stiffness in linkage.bars.items()},
        {
            name: BodyMode(1.0 / inertia, tuple(foot.terms.get(name, 0.0) for foot in feet))
            for name, inertia in body.items()
        },
        _shares(_accelerations(linkage), list(body)),
        tuple(linkage.seats),
    )


def halves(linkage: Linkage, wheels: Mapping[str, Wheel]) -> tuple[OnStruts, ...]:
    """The mean of left and right, then half their difference; the mean alone on one track; none without such a split.

    A single track splits into nothing, and is its own mean. Two sides split where every axle has both, and the same
    values on both. The accelerations of the mounts, the rows of `OnStruts.compliance`, are not among the points.
    """
    inertias = _body(linkage)
    if inertias is None or linkage.seats:
        return ()
    axles: list[tuple[str, ...]]
    if not any(wheel.side for wheel in wheels.values()):
        axles = [(name,) for name in sorted(wheels, key=lambda name: wheels[name].axle)]
    else:
        ends = sorted({wheel.axle for wheel in wheels.values()})
        axles = [tuple(name for name, wheel in wheels.items() if wheel.axle == axle) for axle in ends]
        if any(sorted(wheels[name].side for name in axle) != [-1, 1] for axle in axles):
            return ()
    if not set(linkage.bars) <= set(axles):
        return ()

    struts = _struts(linkage)
    parity = {name: _parity(name, linkage, axles) for name in inertias}
    if None in parity.values() or any(not _same(*(struts[name] for name in axle)) for axle in axles):
        return ()

    mounts = {id(corner.mount) for corner in linkage.corners.values()}
    points = {name: motion for name, motion in _accelerations(linkage).items() if id(motion) not in mounts}

    def half(odd: bool) -> OnStruts:
        coordinates = [name for name, is_odd in parity.items() if is_odd is odd]
        body = {
            name: BodyMode(
                len(axles[0]) / inertias[name], tuple(_arm(linkage.corners[axle[-1]], name) for axle in axles)
            )
            for name in coordinates
        }
        stiffened = {
            axle: struts[axle[-1]]._replace(ks=struts[axle[-1]].ks + 2.0 * linkage.bars[axle])
            if odd and axle in linkage.bars
            else struts[axle[-1]]
            for axle in axles
        }
        return OnStruts(stiffened, {}, body, _shares(points, coordinates))

    return (half(False), half(True)) if len(axles[0]) == 2 else (half(False),)


def _body(linkage: Linkage) -> dict[str, Any] | None:
    """Inertia of each of the body's coordinates; None where there is more than struts on a rigid body."""
    wheels = [corner.wheel for corner in linkage.corners.values() if corner.wheel and len(corner.wheel.terms) == 1]
    seats = linkage.seats.values()
    riders = [seat.rider for seat in seats if len(seat.rider.terms) == 1]
    if linkage.links or linkage.more or len(wheels) < len(linkage.corners) or len(riders) < len(seats):
        return None
    ridden = {name for wheel in (*wheels, *riders) for name in wheel.terms}
    body = {name: mass for name, mass in _masses(linkage).items() if name not in ridden}
    mounts = (corner.mount for corner in linkage.corners.values())
    fixed = [*_accelerations(linkage).values(), *mounts, *(seat.floor for seat in seats)]
    return body if all(motion.terms.keys() <= body.keys() for motion in fixed) else None


def _masses(linkage: Linkage) -> dict[str, Any]:
    return {name: mass for motion, mass in linkage.masses.items() for name in motion.terms}


def _riders(linkage: Linkage) -> dict[str, Strut]:
    masses, riders = _masses(linkage), {name: next(iter(seat.rider.terms)) for name, seat in linkage.seats.items()}
    return {name: Strut(masses[riders[name]], seat.ks, seat.cs, 0.0, 0.0) for name, seat in linkage.seats.items()}


def _struts(linkage: Linkage) -> dict[str, Strut]:
    masses = _masses(linkage)
    wheels = {name: next(iter(corner.wheel.terms)) for name, corner in linkage.corners.items() if corner.wheel}
    return {
        name: Strut(masses[wheels[name]], corner.ks, corner.cs, corner.kt, corner.ct)
        for name, corner in linkage.corners.items()
    }


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


def _accelerations(linkage: Linkage) -> dict[str, Motion]:
    """The body's accelerations by the names of outputs."""
    return {**{signal("bacc", place): motion for place, motion in linkage.points.items()}, **linkage.rotations}


def _shares(motions: Mapping[str, Motion], coordinates: list[str]) -> dict[str, dict[str, Any]]:
    """Shares of these coordinates in motions, where there are any."""
    shares = {
        name: {coordinate: motion.terms[coordinate] for coordinate in coordinates if coordinate in motion.terms}
        for name, motion in motions.items()
    }
    return {name: share for name, share in shares.items() if share}
