"""A vehicle with curves over time: its linear part exactly, what curves differ from it by steps of fourth order.

With numbers in place of the curves the vehicle is ``x' = A x + B z_r``; what the curves' forces are beyond these
numbers' pushes between wheel and body, ``+ P u(x, t)``. Over a step road heights are linear and the linear part exact;
u is the parabola through its values at the start, in the middle and at the end, which come of two guesses of the
middle and one of the end: the exponential Runge-Kutta method of Cox and Matthews (J. Comput. Phys. 176, 2002, Eqs 26 to
29), of fourth order where forces are smooth, and of third at a kink, of which there are few a second.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..vehicles.curves import Curve
from ..vehicles.laws import Broken
from ..vehicles.vehicle import Vehicle
from .balance import balanced
from .first_order_hold import held, joined
from .positions import form_with_positions

Array = NDArray[np.float64]

# So small a motion that means under it are the force and its slope themselves.
STILL = 1e-9


class History(NamedTuple):
    """Outputs (outputs, T, ...) over time, and the force (corners, T, ...) of every damper."""

    outputs: Array
    damping: Array


class Bends(NamedTuple):
    """What curves push more than numbers in their place: ``slopes m + on_bends s(along m - kinks) - at_rest``.

    Of motions m (q, ...) along one curve each; ``s`` is whatever the `bend` makes of them: the modulus of how far each
    is beyond a kink, of which straight pieces are sums, or the whole of a force that is not.
    """

    bend: Callable[[Array], Array]
    along: Array
    kinks: Array
    slopes: Array
    on_bends: Array
    at_rest: Array

    def push(self, motion: Array) -> Array:
        """Forces (q, ...)."""

        def alongside(values: Array) -> Array:
            return values.reshape(-1, *[1] * (motion.ndim - 1))

        bent = self.bend(np.tensordot(self.along, motion, axes=1) - alongside(self.kinks))
        straight = alongside(self.slopes) * motion - alongside(self.at_rest)
        return np.asarray(straight + np.tensordot(self.on_bends, bent, axes=1))


class Stepper:
    """One vehicle of numbers and curves, ready to be driven in steps of ``h`` seconds."""

    def __init__(self, vehicle: Vehicle, h: float, positions: bool = False):
        self.dampers, self.springs = vehicle.at_wheels("cs"), vehicle.at_wheels("ks")
        straight = vehicle.middling()
        first_cs, self.first_ks = straight.at_wheels("cs"), straight.at_wheels("ks")
        model = straight.assemble()
        self.h, table = h, model.layout.outputs
        form = form_with_positions(model, straight) if positions else model.displacement_form()
        P, D_u = model.actuated()
        D_u = joined([D_u, np.zeros((form[2].shape[-2] - len(table), D_u.shape[-1]))], -2)
        forms = (*form, P, D_u)
        self.A, self.B, self.Y, self.D, self.D1, P, D_u = (x.reshape(x.shape[-2:]) for x in forms)
        self.travel, self.rate = (np.arange(len(table))[table.of(name)] for name in ("sws", "sws_rate"))
        # Motions along a curve, travels and rates, with the corner where each is.
        curves = [
            (row, corner, curve, number)
            for rows, values, numbers in (
                (self.travel, self.springs, self.first_ks),
                (self.rate, self.dampers, first_cs),
            )
            for corner, (row, curve, number) in enumerate(zip(rows, values, numbers, strict=True))
            if isinstance(curve, Curve)
        ]
        self.seen, at = (np.array([one[i] for one in curves]) for i in range(2))
        self.bends, self.P, self.D_u = _bends([one[2:] for one in curves]), P[:, at], D_u[:, at]

    def rest(self, z: Array) -> Array:
        """The state (2n,) standing still on heights (inputs,)."""
        inverse = np.linalg.inv(self.A)
        linear, pushed = -inverse @ (self.B @ z), -inverse @ self.P
        on_springs = self.Y[self.travel]
        at = on_springs @ linear + self.D[self.travel] @ z
        sprung = np.isin(self.seen, self.travel)
        corners = np.searchsorted(self.travel, self.seen[sprung])
        B = np.zeros((len(at), len(at)))
        B[:, corners] = -on_springs @ pushed[:, sprung]
        first, nothing = list(self.first_ks), np.zeros((1, len(at)))
        motion = np.zeros(len(self.seen))
        travel = balanced(B[None], self.springs, first, STILL + nothing, nothing, at[None])[0]
        motion[sprung] = travel[corners]
        return np.asarray(linear + pushed @ self.bends.push(motion))

    def drive(self, z: Array, x: Array) -> History:
        """Drive over heights z (inputs, T, ...) from states x (2n, ...)."""
        linear, on_heights, on_bends = self._ahead()
        many, bend = len(self.bends.kinks), self.bends.bend
        steps = np.concatenate([z[:, :-1], np.diff(z, axis=1), np.ones_like(z[:1, :-1])])
        by_heights = np.moveaxis(np.tensordot(on_heights, steps, axes=1), 1, 0)
        states = np.empty((z.shape[1], *x.shape))
        states[0] = x
        for k, heights in enumerate(by_heights):
            # `dot`, which costs a third of what `@` does for so small arrays.
            ahead = linear.dot(x) + heights
            for on_later in on_bends:
                ahead = ahead[many:] + on_later.dot(bend(ahead[:many]))
            states[k + 1] = x = ahead

        y = np.tensordot(self.Y, states, axes=(1, 1)) + np.tensordot(self.D, z, axes=1)
        if np.any(self.D1):
            y += np.tensordot(self.D1, np.gradient(z, self.h, axis=1), axes=1)
        y += np.tensordot(self.D_u, self.bends.push(y[self.seen]), axes=1)
        damping = [
            c.force(v) if isinstance(c, Curve) else c * v for c, v in zip(self.dampers, y[self.rate], strict=True)
        ]
        return History(y, np.stack(damping))

    def _ahead(self) -> tuple[Array, Array, list[Array]]:
        """What a step comes to: what bends at its start, twice in its middle and at its end, then the state.

        By the state at its start, by heights there, their rise and one, and by each of these bends, on all that comes
        after.
        """
        whole, half = (held(self.A, np.concatenate([self.B, self.P], axis=1), h, 3) for h in (self.h, 0.5 * self.h))
        wheels, E, D = len(self.B.T), self.Y[self.seen], self.D[self.seen]
        free, (hold, ramp, bend) = half[0], (gain[:, wheels:] for gain in whole[1:])
        level, rising, half_hold = half[1][:, :wheels], 0.5 * half[2][:, :wheels], half[1][:, wheels:]
        _, along, kinks, slopes, on_bends, at_rest = self.bends

        # Everything as rows by what it is linear in.
        sizes = np.cumsum([len(free), wheels, wheels, 1, *[on_bends.shape[1]] * 4])
        x, z, rise, one, *bent = np.split(np.eye(sizes[-1]), sizes[:-1])

        def halfway(x: Array, z: Array) -> Array:
            return np.asarray(free @ x + level @ z + rising @ rise)

        def seen(x: Array, z: Array) -> Array:
            return np.asarray(E @ x + D @ z + self.D1[self.seen] @ rise / self.h)

        def push(motion: Array, bent: Array) -> Array:
            return np.asarray(slopes[:, None] * motion + on_bends @ bent - at_rest[:, None] * one)

        middle = halfway(x, z)
        end = halfway(middle, z + 0.5 * rise)
        motions = [seen(x, z)]
        u = push(motions[0], bent[0])
        motions.append(seen(middle + half_hold @ u, z + 0.5 * rise))
        u_a = push(motions[1], bent[1])
        motions.append(seen(middle + half_hold @ u_a, z + 0.5 * rise))
        u_b = push(motions[2], bent[2])
        motions.append(seen(end + free @ half_hold @ u + half_hold @ (2.0 * u_b - u), z + rise))
        u_c = push(motions[3], bent[3])
        after = (hold - 3.0 * ramp + 2.0 * bend) @ u + 2.0 * (ramp - bend) @ (u_a + u_b) + (2.0 * bend - ramp) @ u_c
        at_bends = [along @ motion - kinks[:, None] * one for motion in motions]
        parts = np.split(np.concatenate([*at_bends, end + after]), sizes[[0, *range(3, 7)]], 1)
        linear, on_heights, *on_bent = map(np.ascontiguousarray, parts)
        return linear, on_heights, [part[(i + 1) * len(along) :] for i, part in enumerate(on_bent)]


def _bends(curves: list[tuple[Curve, Any]]) -> Bends:
    """What curves push more than the numbers in their place, each along a motion of its own."""
    many = len(curves)
    laws = [c.law for c, k in curves if isinstance(c.law, Broken) and all(np.size(x) == 1 for x in (*c.leaves(), k))]
    if len(laws) < many:
        alike = _grouped(curves)

        def push(motion: Array) -> Array:
            u = np.empty_like(motion)
            for at, curve, number in alike:
                u[at] = curve.force(motion[at]) - number * motion[at]
            return u

        return Bends(push, np.eye(many), np.zeros(many), np.zeros(many), np.eye(many), np.zeros(many))
    numbers = np.concatenate([np.ravel(number) for _, number in curves])
    factors = (curve.factor for curve, _ in curves)
    slopes = [np.concatenate([np.ravel(f * x) for x in law.slopes]) for f, law in zip(factors, laws, strict=True)]
    along = np.repeat(np.eye(many), [len(law.kinks) for law in laws], axis=0)
    kinks = np.ravel([np.squeeze(kink) for law in laws for kink in law.kinks])
    on_bends = 0.5 * along.T * np.concatenate([*map(np.diff, slopes)])
    between = np.array([0.5 * (each[0] + each[-1]) for each in slopes]) - numbers
    return Bends(np.abs, along, kinks, between, on_bends, on_bends @ np.abs(kinks))


def _grouped(curves: list[tuple[Curve, Any]]) -> list[tuple[Any, Curve, Any]]:
    """Where one and the same curve is, the curve, and the number in its place."""
    found: list[tuple[list[int], Curve, Any]] = []
    for i, (curve, number) in enumerate(curves):
        group = next((at for at, known, _ in found if known.alike(curve)), None)
        if group is None:
            found.append(([i], curve, number))
        else:
            group.append(i)
    return [(slice(None) if len(at) == len(curves) else at, *rest) for at, *rest in found]
