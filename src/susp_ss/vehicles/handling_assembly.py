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
    return Assembly(car).model()


class Assembly:
    """All matrices of a car on the way to its model, (N, rows, columns); states ``s = (p, w, v, r, slips, lags)``.

    What stands before `model` is arithmetic alone, of numbers of any kind.
    """

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
        self.M, self.K, self.C = self.matrices()

    def each(self, *values: Any) -> Array:
        """Values as (N, values)."""
        stack = np.stack([np.broadcast_to(value, self.N) for value in values], axis=-1)
        return stack.astype(np.result_type(float, stack))

    def zeros(self, *shape: int) -> Array:
        """A matrix to be filled."""
        return np.zeros((self.N, *shape), dtype=self.U.dtype)

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
        acceleration, C, on_road, on_control = self.outputs()
        moving = slice(self.positions, self.positions + self.moving)
        C, on_road, on_control = (
            own + acceleration @ by[:, moving] for own, by in ((C, rates), (on_road, road), (on_control, controls))
        )
        eigenvalues, vectors = np.linalg.eig(A)
        layout, warp = self.car.layout(), self.ride.integrators
        warp = np.broadcast_to(warp, (self.N, *warp.shape[-2:]))
        names = self.rows.names
        lags = tuple(signal("lag", name) for name, lag in zip(self.wheels, self.lagging, strict=True) if lag)
        motions = (*(f"p_{name}" for name in names[: self.positions]), *(f"d{name}" for name in names))
        own = (*motions[: 2 * self.positions + 2], *(signal("slip", name) for name in self.wheels), *lags)
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
            all_motions=Motions(rates, road, controls, kept, (*motions, *lags)),
            control=Bu,
            on_control=on_control,
            mass=self.M,
            stiffness=self.K,
            carcass=self.carcass(),
            speed=self.U[:, 0],
            critical=self.each(self.car.critical())[:, 0],
        )

    def matrices(self) -> tuple[Array, Array, Array]:
        """Masses of all motions, and stiffness and damping of those that have a position."""
        car, n = self.car, self.positions
        J, m = self.of([row for row, _ in self.rows.inertias]), self.each(*(m for _, m in self.rows.inertias))
        K, C = (self.padded(x, n, n) for x in (self.ride.K, self.ride.C))
        K[:, self.roll, self.roll] -= self.leaning
        for i in range(self.riding, n):
            K[:, i, i] += np.broadcast_to(car.steering, self.N)
            C[:, i, i] += np.broadcast_to(car.steering_damping, self.N)
        return J.mT @ (m[..., None] * J), K, C

    def forces(self) -> tuple[Array, Array]:
        """What pushes every motion, by the states s and by the controls."""
        car, n = self.car, self.positions
        contacts, slips, shafts = self.forms
        across, pushed = self.lateral_forces()
        along = self.zeros(4, self.size)
        along[..., self.slips] = -(self.each(*car.at_wheels("slip")) / self.U)[..., None] * np.eye(4)
        forces = contacts.mT @ across + slips.mT @ along
        forces[:, :n, self.p] -= self.K
        forces[:, :n, self.w] -= self.C
        by_control = contacts.mT @ pushed
        by_control[..., 2 : len(CONTROLS)] += shafts.mT
        by_control[:, : self.riding, len(CONTROLS) :] -= self.ride.R[..., self.ride.suspensions, :].mT
        for i in range(self.riding, n):
            by_control[:, i, 0] += np.broadcast_to(car.steering, self.N)
        # A car that turns has the lateral acceleration v' + U r.
        forces[..., self.r] -= self.U * self.M[..., n]
        return forces, by_control

    def motion(self) -> tuple[Array, Array, Array]:
        """How everything moves: rates of (positions, velocities, lags) by the states s, the road and the controls."""
        n, moving = self.positions, slice(self.positions, self.positions + self.moving)
        inverse, (forces, by_control) = np.linalg.inv(self.M), self.forces()
        self.G = np.linalg.solve(self.K, self.padded(self.ride.K_in, n, 4))
        rates = self.zeros(n + self.moving + self.lags.stop - self.lags.start, self.size)
        rates[:, :n, self.w] = np.eye(n)
        rates[:, moving] = inverse @ forces
        road, controls = self.zeros(rates.shape[1], 4), self.zeros(rates.shape[1], DRIVEN)
        road[:, :n] = -self.G
        road[:, moving] = inverse[..., :n] @ self.padded(self.ride.C_in, n, 4)
        controls[:, moving] = inverse @ by_control
        rates[:, moving.stop :], controls[:, moving.stop :] = self.lag()
        return rates, road, controls

    def slip_angles(self) -> tuple[Array, Array]:
        """By the states and the controls, (N, 4, states) and (N, 4, controls)."""
        angle, steered = self.zeros(4, self.size), self.zeros(4, DRIVEN)
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

    def lag(self) -> tuple[Array, Array]:
        """``alpha_late' = (alpha - alpha_late) U / sigma``; of a design without, a state that fades unseen."""
        angle, steered = self.slip_angles()
        length = self.each(*self.car.at_wheels("relaxation"))
        lags = self.lags.stop - self.lags.start
        rates, controls = self.zeros(lags, self.size), self.zeros(lags, DRIVEN)
        for i, wheel in enumerate(np.flatnonzero(self.lagging)):
            late = length[:, wheel] > 0.0
            rate = np.where(late, self.U[:, 0] / np.where(late, length[:, wheel], 1.0), 0.0)[:, None]
            rates[:, i] = rate * angle[:, wheel]
            rates[:, i, self.lags.start + i] -= np.where(late, rate[:, 0], 1.0)
            controls[:, i] = rate * steered[:, wheel]
        return rates, controls

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

    def outputs(self) -> tuple[Array, Array, Array, Array]:
        """Outputs by the rates of all velocities, and beside these by the states, the road and the controls."""
        ride, table = self.ride, self.car.layout().outputs
        acceleration = self.padded(ride.acceleration, len(table), self.moving)
        acceleration[:, table.of("ay")] = self.of([self.rows.body])
        elongation, rate = (self.transferred(x) for x in (ride.elongation, ride.rate))
        C, Du = self.zeros(len(table), self.size), self.zeros(len(table), DRIVEN)
        C[..., self.p] = self.padded(elongation @ ride.R, len(table), self.positions)
        C[..., self.w] = self.padded(rate @ ride.R, len(table), self.positions)
        C[:, table.of("ay"), self.r] += self.U
        C[:, table.of("yaw_rate"), self.r] = 1.0
        C[:, table.of("sideslip"), self.v] = 1.0 / self.U
        C[:, table.of("roll"), self.roll] = 1.0
        C[:, table.of("slip_angle")], Du[:, table.of("slip_angle")] = self.slip_angles()
        return acceleration, C, rate @ ride.N, Du

    def transferred(self, x: Array) -> Array:
        """The same with the loads that move from the left wheels to the right, by those of the tyres."""
        x, table = np.broadcast_to(x, (self.N, *x.shape[-2:])).copy(), self.car.layout().outputs
        fr, fl, rr, rl = np.moveaxis(x[:, table.of("dtl")], 1, 0)
        front, rear = 0.5 * (fr - fl), 0.5 * (rr - rl)
        x[:, table.of("load_transfer")] = np.stack([front, rear], axis=1)
        weight = self.each(self.car.weight)
        x[:, table.of("load_transfer_ratio")] = (2.0 * (front + rear) / weight)[:, None]
        return x

    def on_heights(self) -> Array:
        """Outputs per metre of road warp, and per angle to which a road that stands still would bring the body."""
        ride, n, table = self.ride, self.riding, self.car.layout().outputs
        leaning = np.zeros((self.N, n, 1))
        leaning[:, self.roll, 0] = self.leaning
        leant = np.linalg.solve(np.broadcast_to(ride.K, (self.N, n, n)), leaning)
        warped = np.broadcast_to(ride.warped, (self.N, *ride.warped.shape[-2:]))
        felt = self.transferred(ride.elongation) @ np.concatenate([warped, ride.R @ leant], axis=-1)
        felt[:, table.of("roll"), 1] = 1.0
        return felt
