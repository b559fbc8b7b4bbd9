"""The matrices of a car that moves: rows of velocities, masses and forces on them, as a first-order system.

With one row a motion, kinetic energy is ``sum m (J w)^2 / 2`` and a force F on the row j adds ``j^T F``: M, and what
tyres and shafts do, come from the same table. In axes that turn with the car every lateral speed v changes as ``v' + U
r``, and nothing else of the motion's inertia depends on the speed U.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import fields
from typing import Any, NamedTuple

import numpy as np

from ..quantities import signal
from .handling_model import CONTROLS, INTEGRATORS, HandlingLayout, HandlingModel, Motions
from .linkage import Motion
from .second_order import ROUNDING, Array, coefficients

DRIVEN = len(CONTROLS) + 4
"""Columns of what drives the car: `CONTROLS`, and an actuator at every corner."""


class Velocities(NamedTuple):
    """The rows of a car, over coordinates whose ``positions`` matter and others that only move (``handling``).

    Of the latter the lateral and the yaw motion come first, then what only tyres' sliding depends on.
    """

    positions: tuple[Motion, ...]
    handling: tuple[Motion, ...]
    inertias: Sequence[tuple[Motion, Any]]
    contacts: Sequence[Motion]
    slips: Sequence[Motion]
    shafts: Sequence[Motion]
    body: Motion
    steer: tuple[Motion, ...]

    @property
    def names(self) -> list[str]:
        return [name for motion in (*self.positions, *self.handling) for name in motion.terms]


def assembled(car: Any) -> HandlingModel:
    """The model of a flattened `RideHandlingCar`'s designs."""
    return _Assembly(car).model()


class _Assembly:
    """All matrices of a car on the way to its model, (N, rows, columns); states ``s = (p, w, v, r, slips, lags)``."""

    def __init__(self, car: Any):
        self.car, self.rows, self.wheels = car, car.velocities(), tuple(car.wheels)
        self.N = max((len(leaf) for leaf in car.leaves() if isinstance(leaf, np.ndarray)), default=1)
        self.ride, self.U = car.linkage().assemble(), self.each(car.speed)
        self.lagging = np.any([np.broadcast_to(x, self.N) > 0.0 for x in car.at_wheels("relaxation")], axis=-1)
        self.riding, self.roll = self.ride.R.shape[-1], self.rows.names.index("phi")
        self.leaning = self.each(car.mb * car.lean)[:, 0]
        self.positions, self.moving = len(self.rows.positions), len(self.rows.names)
        self.forms = self.of(self.rows.contacts), self.of(self.rows.slips), self.of(self.rows.shafts)
        n, k = self.positions, int(self.lagging.sum())
        self.p, self.w = slice(n), slice(n, 2 * n)
        self.v, self.r = 2 * n, 2 * n + 1
        self.slips, self.lags = slice(2 * n + 2, 2 * n + 6), slice(2 * n + 6, 2 * n + 6 + k)
        self.size = 2 * n + 6 + k

    def each(self, *values: Any) -> Array:
        """Values as (N, values)."""
        return np.stack([np.broadcast_to(value, self.N) for value in values], axis=-1).astype(float)

    def of(self, motions: Sequence[Motion]) -> Array:
        """Motions as rows over all coordinates."""
        rows = coefficients([motion.terms for motion in motions], self.rows.names)
        return np.broadcast_to(rows, (self.N, *rows.shape[-2:]))

    def padded(self, x: Array, *shape: int) -> Array:
        """A matrix of the ride, with zeros for what steers and moves."""
        x = np.broadcast_to(x, (self.N, *x.shape[-2:]))
        return np.pad(x, [(0, 0), *((0, most - have) for most, have in zip(shape, x.shape[-2:], strict=True))])

    def model(self) -> HandlingModel:
        rates, road, controls = self.motion()
        kept = self.kept()
        A, B, Bu = (kept @ x for x in (rates, road, controls))
        self.on_course(A, B, Bu)
        C, on_road, on_control = self.outputs(rates, road, controls)
        eigenvalues, vectors = np.linalg.eig(A)
        layout, warp = self.car.layout(), self.ride.integrators
        warp = np.broadcast_to(warp, (self.N, *warp.shape[-2:]))
        names = self.rows.names
        lags = tuple(signal("lag", name) for name, lag in zip(self.wheels, self.lagging, strict=True) if lag)
        moving = (*(f"p_{name}" for name in names[: self.positions]), *(f"d{name}" for name in names))
        own = (*moving[: 2 * self.positions + 2], *(signal("slip", name) for name in self.wheels), *lags)
        signals = {field.name: getattr(layout, field.name) for field in fields(layout)}
        return HandlingModel(
            layout=HandlingLayout(**signals, names=(*own, *INTEGRATORS)),
            A=A,
            rates=eigenvalues,
            vectors=vectors,
            B=B,
            C=C,
            integrators=np.concatenate([warp, self.G[:, [self.roll]]], axis=-2),
            on_integrators=self.on_heights(),
            on_road_velocity=on_road,
            states=np.broadcast_to(np.eye(self.size + 2), (self.N, self.size + 2, self.size + 2)),
            damping=self.car.damping(),
            all_motions=Motions(rates, road, controls, kept, (*moving, *lags)),
            control=Bu,
            on_control=on_control,
            mass=self.M,
            stiffness=self.K,
            carcass=self.carcass(),
            speed=self.U[:, 0],
            critical=self.each(self.car.critical())[:, 0],
        )

    def motion(self) -> tuple[Array, Array, Array]:
        """How everything moves: rates of (positions, velocities, lags) by the states s, the road and the controls."""
        car, n = self.car, self.positions
        J, m = self.of([row for row, _ in self.rows.inertias]), self.each(*(m for _, m in self.rows.inertias))
        self.M = J.mT @ (m[..., None] * J)
        inverse = np.linalg.inv(self.M)
        K, C = (self.padded(x, n, n) for x in (self.ride.K, self.ride.C))
        K[:, self.roll, self.roll] -= self.leaning
        steered = range(self.riding, n)
        for i in steered:
            K[:, i, i] += np.broadcast_to(car.steering, self.N)
            C[:, i, i] += np.broadcast_to(car.steering_damping, self.N)
        self.K, self.G = K, np.linalg.solve(K, self.padded(self.ride.K_in, n, 4))

        contacts, slips, shafts = self.forms
        across, pushed = self.lateral_forces()
        along = np.zeros((self.N, 4, self.size))
        along[..., self.slips] = -(self.each(*car.at_wheels("slip")) / self.U)[..., None] * np.eye(4)
        forces = contacts.mT @ across + slips.mT @ along
        forces[:, :n, self.p] -= K
        forces[:, :n, self.w] -= C
        by_control = contacts.mT @ pushed
        by_control[..., 2 : len(CONTROLS)] += shafts.mT
        by_control[:, : self.riding, len(CONTROLS) :] -= self.ride.R[..., self.ride.suspensions, :].mT
        for i in steered:
            by_control[:, i, 0] += np.broadcast_to(car.steering, self.N)
        rates = np.zeros((self.N, n + self.moving + self.lags.stop - self.lags.start, self.size))
        rates[:, :n, self.w] = np.eye(n)
        rates[:, n : n + self.moving] = inverse @ forces
        rates[:, n + n, self.r] -= self.U[:, 0]
        road, controls = np.zeros((*rates.shape[:2], 4)), np.zeros((*rates.shape[:2], DRIVEN))
        road[:, :n] = -self.G
        road[:, n : n + self.moving] = inverse[..., :n] @ self.padded(self.ride.C_in, n, 4)
        controls[:, n : n + self.moving] = inverse @ by_control
        self.lag(rates, controls)
        return rates, road, controls

    def slip_angles(self) -> tuple[Array, Array]:
        """By the states and the controls, (N, 4, states) and (N, 4, controls)."""
        angle, steered = np.zeros((self.N, 4, self.size)), np.zeros((self.N, 4, DRIVEN))
        n = self.positions
        angle[..., n : 2 * n + 2] = -self.forms[0][..., : n + 2] / self.U[..., None]
        for i, _ in enumerate(self.rows.steer):
            angle[:, i, self.riding + i] += 1.0
        steered[:, :2, 0] = 0.0 if self.rows.steer else 1.0
        steered[:, 2:, 1] = 1.0
        return angle, steered

    def lateral_forces(self) -> tuple[Array, Array]:
        """``C alpha``, where there is a relaxation length of the alpha that follows."""
        angle, steered = self.slip_angles()
        late = self.each(*self.car.at_wheels("relaxation")) > 0.0
        angle[late], steered[late] = 0.0, 0.0
        for column, wheel in enumerate(np.flatnonzero(self.lagging), self.lags.start):
            angle[:, wheel, column] = late[:, wheel]
        stiffness = self.each(*self.car.at_wheels("cornering"))[..., None]
        return stiffness * angle, stiffness * steered

    def lag(self, rates: Array, controls: Array) -> None:
        """``alpha_late' = (alpha - alpha_late) U / sigma``; of a design without, a state that fades unseen."""
        angle, steered = self.slip_angles()
        length = self.each(*self.car.at_wheels("relaxation"))
        first = self.positions + self.moving
        for i, wheel in enumerate(np.flatnonzero(self.lagging)):
            late = length[:, wheel] > 0.0
            rate = np.where(late, self.U[:, 0] / np.where(late, length[:, wheel], 1.0), 0.0)[:, None]
            rates[:, first + i] = rate * angle[:, wheel]
            rates[:, first + i, self.lags.start + i] -= np.where(late, rate[:, 0], 1.0)
            controls[:, first + i] = rate * steered[:, wheel]

    def carcass(self) -> Array:
        """Energy in a tyre that lags behind, a spring of ``C / sigma`` under ``C alpha``, per half ``alpha^2``."""
        stiffness, length = (self.each(*self.car.at_wheels(name)) for name in ("cornering", "relaxation"))
        return (stiffness * length)[:, self.lagging]

    def kept(self) -> Array:
        """The states s as rows over (positions, velocities, lags)."""
        n, m = self.positions, self.moving
        kept = np.zeros((self.N, self.size, n + m + self.lags.stop - self.lags.start))
        kept[:, : 2 * n + 2, : 2 * n + 2] = np.eye(2 * n + 2)
        kept[:, self.slips, n : n + m] = self.forms[1]
        kept[:, self.lags, n + m :] = np.eye(self.lags.stop - self.lags.start)
        return kept

    def on_course(self, A: Array, B: Array, control: Array) -> None:
        """Without any cornering stiffness, a car that no road pushes aside stays on course.

        The states of its course then fade, and how it answers to what else drives it is not a number.
        """
        adrift = ~self.each(*self.car.at_wheels("cornering")).any(axis=-1)
        course, ride = [self.v, self.r], slice(self.v)
        by_ride = np.concatenate([A[:, self.v :, ride], B[:, self.v :]], axis=-1)
        adrift &= np.abs(by_ride).max(axis=(-2, -1)) <= ROUNDING * np.abs(A).max(axis=(-2, -1))
        A[np.ix_(adrift, course)] = 0.0
        A[np.ix_(adrift, course, course)] = -np.eye(2)
        control[adrift] = np.nan

    def outputs(self, rates: Array, road: Array, controls: Array) -> tuple[Array, Array, Array]:
        """Outputs by the states s, the road's velocity and the controls."""
        ride, n, table = self.ride, self.positions, self.car.layout().outputs
        velocities = slice(n, n + self.moving)
        acceleration = self.padded(ride.acceleration, len(table), self.moving)
        C, D, Du = (acceleration @ x[:, velocities] for x in (rates, road, controls))
        C[..., self.p] += self.padded(ride.elongation @ ride.R, len(table), n)
        C[..., self.w] += self.padded(ride.rate @ ride.R, len(table), n)
        D = D + ride.rate @ ride.N
        body = self.of([self.rows.body])
        for x, by in ((C, rates), (D, road), (Du, controls)):
            x[:, table.of("ay")] = body @ by[:, velocities]
        C[:, table.of("ay"), self.r] += self.U
        C[:, table.of("yaw_rate"), self.r] = 1.0
        C[:, table.of("sideslip"), self.v] = 1.0 / self.U
        C[:, table.of("roll"), self.roll] = 1.0
        C[:, table.of("slip_angle")], Du[:, table.of("slip_angle")] = self.slip_angles()
        for x in (C, D, Du):
            self.transfer(x)
        return C, D, Du

    def transfer(self, x: Array) -> None:
        """Loads that move from the left wheels to the right, by those of the tyres."""
        table = self.car.layout().outputs
        fr, fl, rr, rl = np.moveaxis(x[:, table.of("dtl")], 1, 0)
        front, rear = 0.5 * (fr - fl), 0.5 * (rr - rl)
        x[:, table.of("load_transfer")] = np.stack([front, rear], axis=1)
        weight = self.each(self.car.weight)
        x[:, table.of("load_transfer_ratio")] = (2.0 * (front + rear) / weight)[:, None]

    def on_heights(self) -> Array:
        """Outputs per metre of road warp, and per angle to which a road that stands still would bring the body."""
        ride, n, table = self.ride, self.riding, self.car.layout().outputs
        leaning = np.zeros((self.N, n, 1))
        leaning[:, self.roll, 0] = self.leaning
        leant = np.linalg.solve(np.broadcast_to(ride.K, (self.N, n, n)), leaning)
        warped = np.broadcast_to(ride.warped, (self.N, *ride.warped.shape[-2:]))
        felt = ride.elongation @ np.concatenate([warped, ride.R @ leant], axis=-1)
        felt[:, table.of("roll"), 1] = 1.0
        self.transfer(felt)
        return felt
