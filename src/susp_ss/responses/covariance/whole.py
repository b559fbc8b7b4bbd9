"""Variances of more struts than two: one problem on all processes of the road, or one a half on its own."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import chain, combinations
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...quantities import signal
from ...roads.colours import colours
from ...roads.road import Road
from ...vehicles.contract import RoadVehicle
from ...vehicles.decoupled import OnStruts
from ..excitation import Process, delays, processes, steep
from . import digits, struts
from .polynomials import Array, Track
from .struts import Chassis, Move
from .symmetric import as_track, columns, total

# A delay is walked in steps in which no root turns by more than this many radians: a bound some half above the fastest,
# of which a step of 20 keeps twelve digits.
REACH = 22.0

# Wheels that hop almost alike cost digits as their damping gets lighter: twelve are left at half of its critical value,
# nine at a fifth. Below that, and for more struts than four, two systems of units must agree so well.
LIGHT, FEW, AGREED = 0.2, 4, 1e-9

# An acceleration is zero by symmetry if its variance is at most the first share of what its forces would make of it all
# together; up to the second, it may have lost digits.
ZERO, CANCELLED = 1e-24, 1e-17


Walks = dict[tuple[int, int], tuple[int, int]]
"""Steps over the time from axle to axle, and halvings of each."""


class Stirred(NamedTuple):
    """One process: the axles that it excites, what wheels see of it by each (axles, S), if `steep`, its spectrum."""

    axles: list[int]
    weights: Array
    steep: bool
    road: Track


class Problem(NamedTuple):
    """Struts at the corners that ``places`` name, then ``seats``, on processes of the road, as arrays over N designs.

    ``points`` are the accelerations by name, each with its share of every coordinate of the body (B, N).
    """

    places: tuple[tuple[str, ...], ...]
    chassis: Chassis
    points: dict[str, Array]
    excited: tuple[Stirred, ...]
    taus: Array
    seats: tuple[str, ...]

    @property
    def delays(self) -> dict[tuple[int, int], Array]:
        """Time (N,) from axle to axle, of those that a process excites together."""
        pairs = {pair for process in self.excited for pair in combinations(process.axles, 2)}
        return {(i, j): self.taus[j] - self.taus[i] for i, j in sorted(pairs)}

    def variances(self, kernels: Any, walks: Walks) -> dict[str, Array]:
        """Variance (N,) of every output, by the kernels of `struts` or `struts_numba`."""
        chassis = self.chassis
        S, B = len(chassis.struts), len(chassis.mobility)
        linked = kernels.linked(chassis)
        moves = {
            pair: Move(tau, struts.moved(linked.D, tau / walks[pair][0], walks[pair][1], kernels), walks[pair][0])
            for pair, tau in self.delays.items()
        }
        each = [struts.excited(linked, B, *process, moves, kernels) for process in self.excited]
        total = np.sum(each, axis=0)
        body, (deflections, tyres, rates) = total[: B * B].reshape(B, B, -1), total[B * B :].reshape(3, S, -1)
        driven = np.any([process.weights.any(axis=0) for process in self.excited], axis=0)
        # A damped tyre passes on white velocity; where its wheel sees none, its load is left to matrices.
        damped = np.where(driven, np.inf, np.nan)[:, None]
        loads = np.where(chassis.struts[:, 4] > 0.0, damped, chassis.struts[:, 3] ** 2 * tyres)
        accelerations = self._accelerations(body, self._largest(deflections, rates))
        out = dict(zip(self.points, accelerations, strict=True))
        at_corners = {"sws": deflections, "dtl": loads, "sws_rate": rates, "tyre_deflection": tyres}
        for name, values in at_corners.items():
            for corners, variance in zip(self.places, values, strict=False):
                out |= {signal(name, corner): variance for corner in corners}
        for i, seat in enumerate(self.seats, len(self.places)):
            # The cushion's force is all that moves the rider, and deflection and rate do not correlate.
            mass, ks, cs, _, _ = chassis.struts[i]
            felt = (ks**2 * deflections[i] + cs**2 * rates[i]) / mass**2
            out |= {signal("bacc", seat): felt, signal("seat_travel", seat): deflections[i]}
        return out

    def _largest(self, deflections: Array, rates: Array) -> Array:
        """What the struts' forces would make of the body's accelerations if none worked against another, (B, N)."""
        chassis = self.chassis
        deflection, (_, ks, cs, _, _) = np.sqrt(deflections), np.moveaxis(chassis.struts, 1, 0)
        force = ks * deflection + cs * np.sqrt(rates)
        for pair, bar in zip(chassis.pairs, chassis.bars, strict=True):
            force[pair] += bar * deflection[pair].sum(axis=0)
        return chassis.mobility * np.einsum("bin,in->bn", np.abs(chassis.arms), force)

    def _accelerations(self, body: Array, largest: Array) -> Array:
        """Variances (points, N) from the second moments (B, B, N) of the body's coordinates."""
        shares = np.stack(list(self.points.values()))
        terms = shares[:, :, None] * shares[:, None] * body
        total = digits.sum_or_nan(terms.sum(axis=(1, 2)), np.abs(terms).sum(axis=(1, 2)))
        size = (np.abs(shares) * largest).sum(axis=1) ** 2
        return np.where(total > CANCELLED * size, total, np.where(total <= ZERO * size, 0.0, np.nan))

    def in_other_units(self) -> Problem:
        """The same problem with mass and time in other units."""
        mass, time = digits.MASS, digits.TIME
        chassis = self.chassis._replace(
            struts=digits.struts_in_other_units(self.chassis.struts),
            bars=self.chassis.bars * (mass / time**2),
            mobility=self.chassis.mobility / mass,
        )
        excited = tuple(one._replace(road=digits.track_in_other_units(one.road)) for one in self.excited)
        return self._replace(chassis=chassis, excited=excited, taus=self.taus * time)

    def beside(self, other: Problem) -> Problem:
        """The designs of both problems, those of the other behind one's own."""

        def joined(own: Any, others: Any) -> Any:
            return np.concatenate([own, others], axis=-1)

        chassis = self.chassis._replace(
            **{
                name: joined(getattr(self.chassis, name), getattr(other.chassis, name))
                for name in ("struts", "bars", "mobility", "arms")
            }
        )
        excited = tuple(
            one._replace(road=digits.tracks_together(one.road, another.road))
            for one, another in zip(self.excited, other.excited, strict=True)
        )
        points = {name: joined(shares, other.points[name]) for name, shares in self.points.items()}
        return self._replace(chassis=chassis, points=points, excited=excited, taus=joined(self.taus, other.taus))

    def compliance(self) -> Array:
        """Acceleration over each strut per unit force of each, (S, S, N)."""
        return np.einsum("bn,bin,bjn->ijn", self.chassis.mobility, self.chassis.arms, self.chassis.arms)

    def stiffened(self) -> Array:
        """The struts (S, 5, N), each with what the bars on it add at most."""
        stiffened = self.chassis.struts.copy()
        for pair, bar in zip(self.chassis.pairs, self.chassis.bars, strict=True):
            stiffened[pair, 1] += 2.0 * bar
        return stiffened

    def turns(self) -> dict[tuple[int, int], Array]:
        """Radians (N,) of which no root turns more from axle to axle."""
        stiffened, compliance = self.stiffened(), self.compliance()
        return {pair: digits.turns(stiffened, compliance, tau) for pair, tau in self.delays.items()}

    def doubtful(self) -> bool:
        """Whether digits have to be counted."""
        return len(self.chassis.struts) > FEW or digits.extreme(self.stiffened(), self.compliance(), LIGHT)


def problem(part: OnStruts, vehicle: RoadVehicle, road: Road, N: int, excited: Sequence[Process]) -> Problem:
    """N designs of a vehicle, or of a half of it, on processes of a road."""
    width = np.broadcast_to(np.asarray(vehicle.track_width, dtype=float), N)
    struts, wheels = list(part.struts), list(vehicle.wheels)
    places = struts[: len(struts) - len(part.seats)]
    under = [wheels.index(corners[-1]) for corners in places]

    def stirred(process: Process) -> Stirred:
        spectrum = colours(road, process.share, process.sign, width)
        axles = process.axles.tolist()
        weights = np.pad(process.weights[np.ix_(axles, under)], [(0, 0), (0, len(part.seats))])
        return Stirred(axles, weights, steep(process, road), as_track(spectrum))

    mounts = {
        signal("bacc", corner): {name: mode.arms[i] for name, mode in part.body.items()}
        for i, corners in enumerate(places)
        for corner in corners
    }
    return Problem(
        places=tuple(places),
        chassis=Chassis(
            struts=np.stack([columns(N, strut) for strut in part.struts.values()]),
            pairs=np.array([[struts.index(corner) for corner in pair] for pair in part.bars], int).reshape(-1, 2),
            bars=columns(N, list(part.bars.values())),
            mobility=columns(N, [mode.mobility for mode in part.body.values()]),
            arms=np.stack([columns(N, mode.arms) for mode in part.body.values()]),
        ),
        points={
            name: columns(N, [shares.get(coordinate, 0.0) for coordinate in part.body])
            for name, shares in (mounts | part.points).items()
        },
        excited=tuple(map(stirred, excited)),
        taus=columns(N, delays(vehicle, road)),
        seats=part.seats,
    )


def whole_variances(
    parts: Sequence[OnStruts], vehicle: RoadVehicle, road: Road, N: int, kernels: Any = struts
) -> tuple[Array, NDArray[np.bool_]]:
    """Variances (outputs, N) of N designs by their struts, and which of them (N,) are left to matrices.

    ``parts`` are the vehicle whole, or its halves, each of which feels a process of its own. Left are those whose delay
    is very long, whose wheels warp the road without bound or have no damper, whose damped tyres pass on a velocity of
    finite variance, and which may keep fewer than six digits here.
    """
    outputs, excited = vehicle.layout().outputs, processes(vehicle, road)
    felt = [excited] if len(parts) == 1 else [[process] for process in excited]
    # On identical tracks the half difference of left and right is nothing.
    problems = [problem(part, vehicle, road, N, own) for part, own in zip(parts, felt, strict=False)]
    left = np.logical_or.reduce([digits.undamped(one.chassis.struts) for one in problems])
    with np.errstate(all="ignore"):
        turns = [one.turns() for one in problems]
        for radians in chain.from_iterable(each.values() for each in turns):
            left |= radians > digits.LONGEST_WALK * REACH
        walks = [
            {pair: digits.walk(float(each[pair].max(where=~left, initial=1.0)), REACH) for pair in each}
            for each in turns
        ]
        doubtful = any(one.doubtful() for one in problems)
        asked = [one.beside(one.in_other_units()) if doubtful else one for one in problems]
        variances = total(asked, walks, outputs, kernels)
        if doubtful:
            variances, other = np.hsplit(variances, 2)
            left |= digits.disagreement(variances, other, outputs, AGREED)
        left |= np.isnan(variances).any(axis=0)
        if road.velocity_is_bounded:
            left |= np.logical_or.reduce([one.chassis.struts[:, 4].any(axis=0) for one in problems])
    return variances, left
