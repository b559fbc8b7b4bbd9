"""A vehicle with curves over time: its linear part exactly, what curves differ from it by steps of fourth order.

With numbers in place of the curves the vehicle is ``x' = A x + B z_r``; what the curves' forces are beyond these
numbers' pushes between wheel and body, ``+ P u(x, t)``. Over a step road heights are linear and the linear part exact;
u is the parabola through its values at the start, in the middle and at the end, which come of two guesses of the
middle and one of the end: the exponential Runge-Kutta method of Cox and Matthews (J. Comput. Phys. 176, 2002, Eqs 26 to
29), of fourth order where forces are smooth, and of third at a kink, of which there are few a second.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..vehicles.curves import Curve
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

        self.curves = [*_grouped(self.dampers, self.first_cs), *_grouped(self.springs, self.first_ks)]

    def beyond(self, travel: Array, rate: Array) -> Array:
        """What curves push more than the numbers in their place, (corners, ...)."""
        u = np.zeros_like(travel)
        for corners, curve, number in self.curves:
            motion = (rate if curve.field == "cs" else travel)[corners]
            u[corners] += curve.force(motion) - number * motion
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
        return linear + pushed @ self.beyond(travel, np.zeros_like(travel))

    def drive(self, z: Array, x: Array) -> History:
        """Drive over heights z (inputs, T, ...) from states x (2n, ...)."""
        n, corners, E = len(self.A), len(self.dampers), self.Y[self.seen]
        whole, half = (held(self.A, np.concatenate([self.B, self.P], axis=1), h, 3) for h in (self.h, 0.5 * self.h))
        wheels = len(self.B.T)
        free, (hold, ramp, bend) = whole[0], (gain[:, wheels:] for gain in whole[1:])
        at_start, in_middle, at_end = hold - 3.0 * ramp + 2.0 * bend, 2.0 * ramp - 2.0 * bend, 2.0 * bend - ramp
        half_free, half_hold = half[0], half[1][:, wheels:]

        def along(gain: Array, heights: Array) -> Array:
            return np.moveaxis(np.tensordot(gain, heights, axes=1), 1, 0)

        rise = np.diff(z, axis=1)
        middle = z[:, :-1] + 0.5 * rise
        pushed = along(whole[1][:, :wheels], z[:, :-1]) + along(whole[2][:, :wheels], rise)
        first = along(half[1][:, :wheels], z[:, :-1]) + along(half[2][:, :wheels], 0.5 * rise)
        second = along(half[1][:, :wheels], middle) + along(half[2][:, :wheels], 0.5 * rise)
        D, moved = self.D[self.seen], along(self.D1[self.seen], rise / self.h)
        seen = along(D, z[:, :-1]) + moved, along(D, middle) + moved, along(D, z[:, 1:]) + moved

        def push(x: Array, off: Array) -> Array:
            motion = E @ x + off
            return self.beyond(motion[:corners], motion[corners:])

        states = np.empty((z.shape[1], n, *z.shape[2:]))
        states[0] = x
        for k in range(len(rise[0])):
            u = push(x, seen[0][k])
            half_way = half_free @ x + first[k]
            a = half_way + half_hold @ u
            u_a = push(a, seen[1][k])
            u_b = push(half_way + half_hold @ u_a, seen[1][k])
            u_c = push(half_free @ a + second[k] + half_hold @ (2.0 * u_b - u), seen[2][k])
            x = free @ x + pushed[k] + at_start @ u + in_middle @ (u_a + u_b) + at_end @ u_c
            states[k + 1] = x

        y = np.tensordot(self.Y, states, axes=(1, 1)) + np.tensordot(self.D, z, axes=1)
        if np.any(self.D1):
            y += np.tensordot(self.D1, np.gradient(z, self.h, axis=1), axes=1)
        y += np.tensordot(self.D_u, self.beyond(y[self.travel], y[self.rate]), axes=1)
        damping = [
            c.force(v) if isinstance(c, Curve) else c * v for c, v in zip(self.dampers, y[self.rate], strict=True)
        ]
        return History(y, np.stack(damping))


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
