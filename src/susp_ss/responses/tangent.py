"""Derivatives of the variances of all outputs along P parameters: the algebra of `covariance`, in dual numbers.

With ``A X + X A^T + Q = 0``, the tangent of X solves the same equation with another right-hand side, ``A dX + dX A^T +
(dA X + X dA^T + dQ) = 0``, so that one inverse serves all parameters. The matrices are real-analytic in the
parameters: an imaginary step gives their tangents to rounding. States are mass-normalised by the design's own masses.
"""

from __future__ import annotations

import copy
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from ..roads import Road
from ..vehicles import Vehicle
from ..vehicles.linkage import SecondOrder
from .dual import Array, Dual, concatenate, exp, expm1, solve
from .excitation import Process, processes
from .lyapunov import Dynamics
from .spectrum import spectrum

# The parameters of a road, beside the fields of a vehicle.
ROAD = ("roughness", "speed", "cutoff")

# So small that its square is nothing beside any parameter.
STEP = 1e-30

# A Taylor step of h with rate * h <= 1: 1 / 18! is below rounding.
TAYLOR_TERMS = 18

# A derivative of a transfer function that is smaller than this, relative to its terms, is zero.
VANISHING = 1e-7


class Direction(NamedTuple):
    """What to change: a field of the vehicle, at one wheel or (None) everywhere, or a field of the road."""

    field: str
    wheel: str | None = None


class Tangents(NamedTuple):
    """What is known of P parameters' effects on N designs.

    Derivatives (P, N, outputs) of the variances, NaN where they are infinite or become so; where an output that is zero
    by symmetry ceases to be, (P, N, outputs); and the dampers (N, corners).
    """

    variances: Array
    kinked: Array
    damping: Dual


class _System(NamedTuple):
    """``x' = A x + B z_r'``, ``y = Y x + on_warp * warp + D z_r'``, the dampers, and where the wheels are."""

    A: Dual
    B: Dual
    Y: Dual
    D: Dual
    on_warp: Dual
    damping: Dual
    wheelbase: Dual
    track_width: Dual


class _Colours(NamedTuple):
    """A process's velocity spectrum: white (N, 1), rates and weights of its colours (N, J)."""

    white: Dual
    alphas: Dual
    weights: Dual


def variance_tangents(vehicle: Vehicle, road: Road, directions: Sequence[Direction], variances: Array) -> Tangents:
    """Differentiate the variances (N, outputs) of a flattened vehicle's N designs."""
    N, model = len(variances), vehicle.assemble()
    system = _system(vehicle, model, directions, N)
    excited = processes(vehicle, road)

    logarithmic = {name: _along(directions, name) / (getattr(road, name) or 1.0) for name in ROAD}
    tau = system.wheelbase / road.speed
    tau = Dual(tau.value, tau.tangent - tau.value * logarithmic["speed"])
    if not any(process.later.any() for process in excited):
        tau = 0.0 * tau

    A = system.A
    n = A.value.shape[-1] // 2
    dynamics = Dynamics(-A.value[:, n:, :n], -A.value[:, n:, n:])
    colours = [_colours(road, process, system.track_width, logarithmic) for process in excited]
    fronts = [(system.B @ process.now)[:, :, None] for process in excited]
    E, forced = _carried(dynamics, A, tau, fronts, colours[0].alphas)

    Q, cross, own = 0.0 * A, 0.0 * fronts[0], 0.0 * colours[0].white
    for process, front, parts, drift in zip(excited, fronts, colours, forced, strict=True):
        response = _Response(A, front, (system.B @ process.later)[:, :, None], E @ front, drift, parts, tau)
        Q += response.right_hand_side()
        if model.warp is not None:
            with_warp, of_warp = response.warp(float(model.warp @ process.now), float(model.warp @ process.later))
            cross, own = cross + with_warp, own + of_warp

    X, _ = dynamics.lyapunov(Q.value)
    sway = A.tangent @ X
    dX, _ = dynamics.lyapunov(sway + np.swapaxes(sway, -1, -2) + Q.tangent)
    Y, w = system.Y, system.on_warp
    variance = ((Y @ Dual(X, dX)) * Y).sum(-1) + 2.0 * w * (Y @ cross)[:, :, 0] + w * w * own

    zero = variances == 0.0
    passed_on = system.D @ np.stack([side for process in excited for side in process[:2]], axis=-1)
    unbounded = np.isinf(variances) | np.any(passed_on.tangent != 0.0, axis=-1)
    kinked = zero & _moving(system, model, excited, tau) if zero.any() else np.zeros_like(unbounded)
    return Tangents(np.where(unbounded, np.nan, np.where(zero, 0.0, variance.tangent)), kinked, system.damping)


def _along(directions: Sequence[Direction], field: str, wheel: str | None = None) -> Array:
    """Which directions change a field (at a wheel), as a column (P, 1)."""
    return np.array([[d.field == field and d.wheel in (None, wheel)] for d in directions], dtype=float)


def _system(vehicle: Vehicle, model: SecondOrder, directions: Sequence[Direction], N: int) -> _System:
    stepped = copy.copy(vehicle)
    for name in {direction.field for direction in directions}.difference(ROAD):
        if name in vehicle.per_corner:
            parts = zip(vehicle.wheels, vehicle._at_corners(name), strict=True)
            moved: Any = tuple(value + 1j * STEP * _along(directions, name, wheel) for wheel, value in parts)
        else:
            moved = getattr(vehicle, name) + 1j * STEP * _along(directions, name)
        # The vehicle itself was checked when it was made.
        object.__setattr__(stepped, name, moved)

    def dual(value: Any, moved: Any, ndim: int) -> Dual:
        rest = np.shape(value)[np.ndim(value) - ndim :]
        tangent = np.broadcast_to(np.imag(moved) / STEP, (len(directions), N, *rest))
        return Dual(np.broadcast_to(value, (N, *rest)), tangent)

    other = stepped.assemble()
    n = len(model.coordinates)
    A, B, Y, D = (dual(x, y, 2) for x, y in zip(model.velocity_form(), other.velocity_form(), strict=True))
    root = np.broadcast_to(np.sqrt(model.m), (N, n))
    stretch = np.concatenate([root, root], axis=-1)
    return _System(
        A=A[:, : 2 * n, : 2 * n] * (stretch[:, :, None] / stretch[:, None, :]),
        B=B[:, : 2 * n] * stretch[:, :, None],
        Y=Y[:, :, : 2 * n] * (1.0 / stretch[:, None, :]),
        D=D,
        on_warp=dual(model.on_warp, other.on_warp, 1),
        damping=dual(model.damping, other.damping, 1),
        wheelbase=dual(vehicle.wheelbase, stepped.wheelbase, 0),
        track_width=dual(vehicle.track_width, stepped.track_width, 0),
    )


def _colours(road: Road, process: Process, width: Dual, logarithmic: dict[str, Array]) -> _Colours:
    """Rates and weights depend on the cut-off times the track width; rates go with the speed, weights with both."""
    stepped: Any = width.value * (1.0 + 1j * STEP)
    white, alphas, weights = spectrum(road, process, stepped)
    wider = np.divide(width.tangent, width.value, out=np.zeros_like(width.tangent), where=width.value > 0.0)[..., None]
    roughness, speed, cutoff = (logarithmic[name][..., None] for name in ROAD)
    rate, weight = alphas.imag / STEP, weights.imag / STEP
    alphas, weights = alphas.real, weights.real
    return _Colours(
        Dual(np.full((len(alphas), 1), white), np.broadcast_to(white * (speed + roughness), wider.shape)),
        Dual(alphas, rate * wider + alphas * speed + (alphas + rate) * cutoff),
        Dual(weights, weight * (wider + cutoff) + weights * (speed + roughness)),
    )


def _carried(dynamics: Dynamics, A: Dual, tau: Dual, sources: Sequence[Dual], alphas: Dual) -> tuple[Dual, list[Dual]]:
    """Carry the states over the delay, freely and under decaying forcing from each source.

    Returns ``E = e^(A tau)`` and, for each source b, ``f = int_0^tau e^(A (tau - s)) b e^(-alpha s) ds`` (N, 2n, J): by
    Taylor over a short time h, then over twice the time and so on, ``E <- E^2`` and ``f <- E f + f e^(-alpha h)``.
    """
    size, J = A.value.shape[-1], alphas.value.shape[-1]
    reach = np.max(np.maximum(dynamics.fastest(), alphas.value.max(axis=-1, initial=0.0)) * tau.value)
    doublings = max(0, int(np.ceil(np.log2(max(reach, 1.0)))))
    rates = concatenate([alphas] * len(sources), axis=-1)[:, None, :]
    h = tau[:, None, None] / 2.0**doublings

    forcing = concatenate([source + np.zeros(J) for source in sources], axis=-1)
    E = term = 0.0 * A + np.eye(size)
    f = drift = 0.0 * forcing
    for k in range(1, TAYLOR_TERMS + 1 if reach else 0):
        term, drift = A @ term * (h / k), (A @ drift + forcing) * (h / k)
        forcing = forcing * (rates * h / -k)
        E, f = E + term, f + drift
    for _ in range(doublings):
        f = E @ f + f * exp(-(rates * h))
        E, h = E @ E, 2.0 * h
    return E, [f[:, :, i * J : (i + 1) * J] for i in range(len(sources))]


class _Response:
    """What one process stirs up, as in `covariance`: columns (N, 2n, 1), and one a colour (N, J, 2n, 1)."""

    def __init__(self, A: Dual, front: Dual, rear: Dual, free: Dual, forced: Dual, parts: _Colours, tau: Dual) -> None:
        self.A, self.front, self.rear, self.free, self.tau = A, front, rear, free, tau
        self.white = parts.white[:, :, None]
        self.alphas, self.weights = parts.alphas[:, :, None, None], parts.weights[:, :, None, None]
        self.decay = exp(-(self.alphas * tau[:, None, None, None]))
        self.forced = forced.T[:, :, :, None]
        # For a colour u of unit sigma^2: E[x u(t)], and the first half of E[x u(t - tau)].
        self.now = self._resolvent(front[:, None] + self.decay * rear[:, None])
        self.before = self._resolvent((rear + free)[:, None])

    def _resolvent(self, x: Dual) -> Dual:
        """``(alpha I - A)^-1 x`` for every colour."""
        n = self.A.value.shape[-1] // 2
        K, C = -self.A[:, None, n:, :n], -self.A[:, None, n:, n:]
        a, b = x[:, :, :n], x[:, :, n:]
        inner = C + self.alphas * np.eye(n)
        p = solve(K + self.alphas * inner, b + inner @ a)
        return concatenate([p, self.alphas * p - a], axis=-2)

    def right_hand_side(self) -> Dual:
        """The process's share of Q."""
        front, rear = self.front, self.rear
        sigma2 = 0.5 * self.weights * self.alphas
        g, h = ((sigma2 * x).sum(-3) for x in (self.now, self.before + self.forced))
        half = front * (0.5 * self.white * front + g).T + rear * (self.white * (0.5 * rear + self.free) + h).T
        return half + half.T

    def warp(self, now: float, later: float) -> tuple[Dual, Dual]:
        """``E[x warp]`` (N, 2n, 1) and ``E[warp^2]`` (N, 1) of a rate ``now * u(t) + later * u(t - tau)``."""
        if now + later != 0.0:
            height = -0.5 * self.weights / self.alphas
            cross = self.alphas * height * (now * self.now + later * (self.before - self.forced))
            own = height * (now**2 + later**2 + 2.0 * now * later * self.decay)
            return cross.sum(-3), own.sum(-3)[:, :, 0]
        tau = self.tau[:, None, None, None]
        memory = -expm1(-(self.alphas * tau)) / self.alphas
        sigma2 = 0.5 * self.weights * self.alphas
        coloured = (sigma2 * (self.now - self.before - self.forced)).sum(-3)
        coloured += (self.front + self.rear) * (sigma2 * memory).sum(-3)
        cross = solve(self.A, self.white * (self.free - self.front) - coloured)
        own = self.white * tau[:, 0] + (self.weights * (tau - memory)).sum(-3)
        return now * cross, now**2 * own[:, :, 0]


def _moving(system: _System, model: SecondOrder, excited: Sequence[Process], tau: Dual) -> Array:
    """Where the transfer function of an output has a derivative (P, N, outputs), told at one middling frequency."""
    A = system.A
    n = A.value.shape[-1] // 2
    s = 1j * np.sqrt(-np.trace(A.value[:, n:, :n], axis1=-2, axis2=-1) / n)[:, None, None]
    late = exp(-(tau[:, None, None] * s))
    still = -A + s * np.eye(2 * n)
    moving = np.zeros(system.on_warp.tangent.shape, dtype=bool)
    for process in excited:
        x = solve(still, (system.B @ process.now)[:, :, None] + (system.B @ process.later)[:, :, None] * late)
        H = (system.Y @ x)[:, :, 0]
        terms = np.abs(system.Y.tangent) @ np.abs(x.value) + np.abs(system.Y.value) @ np.abs(x.tangent)
        if model.warp is not None:
            H += system.on_warp * (late * (model.warp @ process.later) + model.warp @ process.now)[:, :, 0] / s[:, :, 0]
        moving |= np.abs(H.tangent) > VANISHING * terms[..., 0]
    return moving
