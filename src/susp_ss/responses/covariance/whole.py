"""Variances of a vehicle on struts whose sides differ: one problem on every process of the road."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...quantities import signal
from ...roads.colours import colours
from ...roads.road import Road
from ...vehicles.contract import RoadVehicle
from ...vehicles.decoupled import OnStruts
from ..excitation import Process, delay, processes, steep
from . import digits, struts
from .polynomials import Array, Track
from .struts import Chassis
from .symmetric import as_track, columns

# A delay is walked in steps in which no root turns by more than this many radians: a bound some half above the fastest,
# of which a step of 20 keeps twelve digits.
REACH = 22.0

# Wheels that hop almost alike cost digits as their damping gets lighter: twelve are left at half of its critical value,
# nine at a fifth. Below that two systems of units must agree so well.
LIGHT, AGREED = 0.2, 1e-9

# An acceleration is zero by symmetry if its variance is at most the first share of what its forces would make of it all
# together; up to the second, it may have lost digits.
ZERO, CANCELLED = 1e-24, 1e-17


class Stirred(NamedTuple):
    """One process: how much of it wheels see at once and later (2, S), whether it is `steep`, and its spectrum."""

    weights: Array
    steep: bool
    road: Track


class Problem(NamedTuple):
    """Struts at the corners ``places`` on the road's processes, as arrays over N designs.

    ``points`` are the accelerations by name, each with its share of every coordinate of the body (B, N).
    """

    places: tuple[str, ...]
    chassis: Chassis
    points: dict[str, Array]
    excited: tuple[Stirred, ...]
    tau: Array

    def variances(self, kernels: Any, walk: tuple[int, int]) -> dict[str, Array]:
        """Variance (N,) of every output, by the kernels of `struts` or `struts_numba`."""
        chassis, (steps, halvings) = self.chassis, walk
        S, B = len(chassis.struts), len(chassis.mobility)
        linked = kernels.linked(chassis)
        step = np.empty((0, 0, 0))
        if steps > 0:
            step = struts.moved(linked.D, self.tau / steps, halvings, kernels)
        each = [struts.excited(linked, B, *process, self.tau, step, steps, kernels) for process in self.excited]
        total = np.sum(each, axis=0)
        body, (deflections, tyres, rates) = total[: B * B].reshape(B, B, -1), total[B * B :].reshape(3, S, -1)
        driven = np.any([process.weights for process in self.excited], axis=(0, 1))
        # A damped tyre passes on white velocity; where its wheel sees none, its load is left to matrices.
        damped = np.where(driven, np.inf, np.nan)[:, None]
        loads = np.where(chassis.struts[:, 4] > 0.0, damped, chassis.struts[:, 3] ** 2 * tyres)
        accelerations = self._accelerations(body, self._largest(deflections, rates))
        out = dict(zip(self.points, accelerations, strict=True))
        at_corners = {"sws": deflections, "dtl": loads, "sws_rate": rates, "tyre_deflection": tyres}
        for name, values in at_corners.items():
            out |= {signal(name, corner): variance for corner, variance in zip(self.places, values, strict=True)}
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
        return self._replace(chassis=chassis, excited=excited, tau=self.tau * time)

    def compliance(self) -> Array:
        """Acceleration over each strut per unit force of each, (S, S, N)."""
        return np.einsum("bn,bin,bjn->ijn", self.chassis.mobility, self.chassis.arms, self.chassis.arms)

    def stiffened(self) -> Array:
        """The struts (S, 5, N), each with what the bars on it add at most."""
        stiffened = self.chassis.struts.copy()
        for pair, bar in zip(self.chassis.pairs, self.chassis.bars, strict=True):
            stiffened[pair, 1] += 2.0 * bar
        return stiffened


def problem(whole: OnStruts, vehicle: RoadVehicle, road: Road, N: int) -> Problem:
    """N designs of a vehicle on a road."""

    width = np.broadcast_to(np.asarray(vehicle.track_width, dtype=float), N)
    corners = list(whole.struts)

    def stirred(process: Process) -> Stirred:
        spectrum = colours(road, process.share, process.sign, width)
        return Stirred(np.stack([process.now, process.later]), steep(process, road), as_track(spectrum))

    return Problem(
        places=tuple(name for (name,) in corners),
        chassis=Chassis(
            struts=np.stack([columns(N, strut) for strut in whole.struts.values()]),
            pairs=np.array([[corners.index(corner) for corner in pair] for pair in whole.bars], int).reshape(-1, 2),
            bars=columns(N, list(whole.bars.values())),
            mobility=columns(N, [mode.mobility for mode in whole.body.values()]),
            arms=np.stack([columns(N, mode.arms) for mode in whole.body.values()]),
        ),
        points={
            name: columns(N, [shares.get(coordinate, 0.0) for coordinate in whole.body])
            for name, shares in whole.points.items()
        },
        excited=tuple(stirred(process) for process in processes(vehicle, road)),
        tau=columns(N, [delay(vehicle, road)])[0],
    )


def whole_variances(
    whole: OnStruts, vehicle: RoadVehicle, road: Road, N: int, kernels: Any = struts
) -> tuple[Array, NDArray[np.bool_]]:
    """Variances (outputs, N) of N designs by their struts, and which of them (N,) are left to matrices.

    Those are whose delay is very long, whose wheels warp the road without bound or have no damper, whose damped tyres
    pass on a velocity of finite variance, and which may keep fewer than six digits here.
    """
    outputs, one = vehicle.layout().outputs, problem(whole, vehicle, road, N)
    compliance, delayed = one.compliance(), any(process.weights[1].any() for process in one.excited)
    left, walk = digits.undamped(one.chassis.struts), (0, 0)
    with np.errstate(all="ignore"):
        if delayed:
            turns = digits.turns(one.stiffened(), compliance, one.tau)
            left |= turns > digits.LONGEST_WALK * REACH
            walk = digits.walk(float(turns.max(where=~left, initial=1.0)), REACH)

        def solved(problem: Problem) -> Array:
            found = problem.variances(kernels, walk)
            return np.array([found[name] for name in outputs.names])

        variances = solved(one)
        left |= np.isnan(variances).any(axis=0)
        if road.velocity_is_bounded:
            left |= one.chassis.struts[:, 4].any(axis=0)
        if digits.extreme(one.stiffened(), compliance, LIGHT):
            left |= digits.disagreement(variances, solved(one.in_other_units()), outputs, AGREED)
    return variances, left
