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


class Stepper:
    """One vehicle of numbers and curves, ready to be driven in steps of ``h`` seconds."""

    def __init__(self, vehicle: Vehicle, h: float, positions: bool = False):
        self.dampers, self.springs = vehicle.at_wheels("cs"), vehicle.at_wheels("ks")
        straight = vehicle.middling()
        self.first_cs, self.first_ks = straight.at_wheels("cs"), straight.at_wheels("ks")
        model = straight.assemble()
        self.h, table = h, model.layout.outputs
        form = form_with_positions(model, straight) if positions else model.displacement_form()
        P, D_u = model.actuated()
        D_u = joined([D_u, np.zeros((form[2].shape[-2] - len(table), D_u.shape[-1]))], -2)
        forms = (*form, P, D_u)
        self.A, self.B, self.Y, self.D, self.D1, self.P, self.D_u = (x.reshape(x.shape[-2:]) for x in forms)
        self.travel, self.rate = (np.arange(len(table))[table.of(name)] for name in ("sws", "sws_rate"))
        self.seen = np.concatenate([self.travel, self.rate])
        corners = np.arange(len(self.dampers))
        # Rows of `seen` that curves of corners meet, those corners, and what they push.
        self.curves = [
            (corners[at] + field * len(corners), corners[at], _beyond(curve, number))
            for field, (values, numbers) in enumerate(((self.springs, self.first_ks), (self.dampers, self.first_cs)))
            for at, curve, number in _grouped(values, numbers)
        ]

    def beyond(self, motion: Array) -> Array:
        """What curves push more than the numbers in their place, (corners, ...), at travels and rates ``seen``."""
        corners = len(self.dampers)
        if len(self.curves) == 1 and len(self.curves[0][1]) == corners:
            ((rows, _, push),) = self.curves
            return push(motion[rows[0] : rows[0] + corners])
        u = np.zeros((corners, *motion.shape[1:]))
        for rows, at, push in self.curves:
            u[at] += push(motion[rows])
        return u

    def rest(self, z: Array) -> Array:
        """The state (2n,) standing still on heights (inputs,)."""
        inverse = np.linalg.inv(self.A)
        linear, pushed = -inverse @ (self.B @ z), -inverse @ self.P
        on_springs = self.Y[self.travel]
        at = on_springs @ linear + self.D[self.travel] @ z
        B = -on_springs @ pushed
        first, nothing = list(self.first_ks), np.zeros((1, len(at)))
        travel = balanced(B[None], self.springs, first, STILL + nothing, nothing, at[None])[0]
        return linear + pushed @ self.beyond(np.concatenate([travel, np.zeros_like(travel)]))

    def drive(self, z: Array, x: Array) -> History:
        """Drive over heights z (inputs, T, ...) from states x (2n, ...)."""
        n, E = len(self.A), self.Y[self.seen]
        whole, half = (held(self.A, np.concatenate([self.B, self.P], axis=1), h, 3) for h in (self.h, 0.5 * self.h))
        wheels, many = len(self.B.T), len(E)
        free, (hold, ramp, bend) = whole[0], (gain[:, wheels:] for gain in whole[1:])
        half_free, half_hold = half[0], half[1][:, wheels:]

        def along(gain: Array, heights: Array) -> Array:
            return np.moveaxis(np.tensordot(gain, heights, axes=1), 1, 0)

        rise = np.diff(z, axis=1)
        middle = z[:, :-1] + 0.5 * rise
        first = along(half[1][:, :wheels], z[:, :-1]) + along(half[2][:, :wheels], 0.5 * rise)
        second = along(half[1][:, :wheels], middle) + along(half[2][:, :wheels], 0.5 * rise)
        D, moved = self.D[self.seen], along(self.D1[self.seen], rise / self.h)
        # Of the state at the start of a step and of the heights: what curves meet at the start, in the middle and at
        # the end as long as they do not push, and the state at the end.
        linear = np.concatenate([E, E @ half_free, E @ half_free @ half_free, free])
        first_seen = along(E, np.moveaxis(first, 0, 1))
        second_seen = along(E, np.moveaxis(second, 0, 1)) + along(E @ half_free, np.moveaxis(first, 0, 1))
        by_heights = np.concatenate(
            [
                along(D, z[:, :-1]) + moved,
                along(D, middle) + moved + first_seen,
                along(D, z[:, 1:]) + moved + second_seen,
                along(whole[1][:, :wheels], z[:, :-1]) + along(whole[2][:, :wheels], rise),
            ],
            axis=1,
        )
        # Of pushes: on the middle, and on the end by the first guess; on the state at the end.
        on_middle, by_first = E @ half_hold, E @ (half_free @ half_hold - half_hold)
        on_end = np.concatenate([hold - 3.0 * ramp + 2.0 * bend, 2.0 * ramp - 2.0 * bend, 2.0 * bend - ramp], axis=1)

        states = np.empty((z.shape[1], n, *z.shape[2:]))
        states[0] = x
        for k in range(len(rise[0])):
            # `dot`, which costs a third of what `@` does for so small arrays.
            ahead = linear.dot(x) + by_heights[k]
            in_middle, at_end = ahead[many : 2 * many], ahead[2 * many : 3 * many]
            u = self.beyond(ahead[:many])
            u_a = self.beyond(in_middle + on_middle.dot(u))
            u_b = self.beyond(in_middle + on_middle.dot(u_a))
            u_c = self.beyond(at_end + by_first.dot(u) + on_middle.dot(2.0 * u_b))
            x = ahead[3 * many :] + on_end.dot(np.concatenate([u, u_a + u_b, u_c]))
            states[k + 1] = x

        y = np.tensordot(self.Y, states, axes=(1, 1)) + np.tensordot(self.D, z, axes=1)
        if np.any(self.D1):
            y += np.tensordot(self.D1, np.gradient(z, self.h, axis=1), axes=1)
        y += np.tensordot(self.D_u, self.beyond(y[self.seen]), axes=1)
        damping = [
            c.force(v) if isinstance(c, Curve) else c * v for c, v in zip(self.dampers, y[self.rate], strict=True)
        ]
        return History(y, np.stack(damping))


def _beyond(curve: Curve, number: Any) -> Callable[[Array], Array]:
    """What a curve pushes more than a number in its place, of motions (corners, ...)."""
    law, leaves = curve.law, curve.leaves()
    if not isinstance(law, Broken) or not all(np.size(leaf) == 1 for leaf in [*leaves, number]):
        return lambda motion: np.asarray(curve.force(motion) - number * motion)
    kinks, slopes, (factor, linear) = (
        np.array([*map(np.ravel, some)]).ravel() for some in (law.kinks, law.slopes, (curve.factor, number))
    )
    rises = factor * np.diff(slopes)
    slope, at_rest = factor * slopes[0] - linear, rises @ np.maximum(-kinks, 0.0)

    def push(motion: Array) -> Array:
        return np.asarray(slope * motion + (np.maximum(motion[..., None] - kinks, 0.0).dot(rises) - at_rest))

    return push


def _grouped(values: tuple[Any, ...], numbers: tuple[Any, ...]) -> list[tuple[Any, Curve, Any]]:
    """Corners that have a curve, those with one and the same together, the curve, and the number in its place."""
    found: list[tuple[list[int], Curve, Any]] = []
    for i, (value, number) in enumerate(zip(values, numbers, strict=True)):
        if isinstance(value, Curve):
            group = next((corners for corners, curve, _ in found if curve.alike(value)), None)
            if group is None:
                found.append(([i], value, number))
            else:
                group.append(i)
    every = slice(None)
    return [(every if len(corners) == len(values) else corners, *rest) for corners, *rest in found]
