"""Derivatives of the variances of all outputs along P parameters: the algebra of `matrices`, in dual numbers.

With ``A X + X A^T + Q = 0``, the tangent of X solves the same equation with another right-hand side, ``A dX + dX A^T +
(dA X + X dA^T + dQ) = 0``, so that one inverse serves all parameters. The matrices are real-analytic in the
parameters: an imaginary step gives their tangents to rounding. States are mass-normalised by the design's own masses.
"""

from __future__ import annotations

import copy
from collections.abc import Callable, Container, Sequence
from itertools import combinations, pairwise
from typing import Any, NamedTuple

import numpy as np

from ...quantities import ROAD
from ...roads.colours import colours
from ...roads.road import Road
from ...vehicles.second_order import SecondOrder, beyond_rounding
from ...vehicles.vehicle import Vehicle
from ..excitation import Process, integrated, processes
from ..settings import Setting
from .dual import Array, Dual
from .first_order import Correlations, Spectrum
from .lyapunov import Dynamics, Reach

# So small that its square is nothing beside any parameter.
STEP = 1e-30

# A derivative of a transfer function that is smaller than this, relative to its terms, is zero.
VANISHING = 1e-7


class Tangents(NamedTuple):
    """What is known of P parameters' effects on N designs.

    Derivatives (P, N, outputs) of the variances, NaN where they are infinite or become so; where an output that is zero
    by symmetry ceases to be, (P, N, outputs); and the dampers (N, corners).
    """

    variances: Array
    kinked: Array
    damping: Dual


class _System(NamedTuple):
    """``x' = A x + B w``, ``h' = warps w``, ``y = Y x + on_warps h + D w``, w the road's velocity, and more."""

    A: Dual
    B: Dual
    Y: Dual
    D: Dual
    on_warps: Dual
    warps: Dual
    damping: Dual
    axles: list[Dual]
    track_width: Dual


def variance_tangents(vehicle: Vehicle, road: Road, settings: Sequence[Setting], variances: Array) -> Tangents:
    """Differentiate the variances (N, outputs) of a flattened vehicle's N designs."""
    N, model = len(variances), vehicle.assemble()
    system = _system(vehicle, model, settings, N)
    excited = processes(vehicle, road)

    ground = {}
    for name in ROAD:
        value = np.broadcast_to(np.asarray(getattr(road, name), dtype=float), N)
        ground[name] = Dual(value, np.broadcast_to(_along(settings, name), (len(settings), N)))
    taus = [distance / ground["speed"] for distance in system.axles]

    A = system.A
    n = A.shape[-1] // 2
    free_dynamics = Dynamics(-A[:, n:, :n], -A[:, n:, n:])
    dynamics = Dynamics(free_dynamics.K.value, free_dynamics.C.value)
    spectra = [_spectrum(road, process, system.track_width, ground) for process in excited]
    entered = [[(system.B @ weights)[:, :, None] for weights in process.weights] for process in excited]
    alphas = [spectrum.alphas for spectrum in spectra]
    carried = {
        (i, j): _carried(free_dynamics, dynamics.reach, taus[j] - taus[i], [own[i] for own in entered], alphas)
        for i, j in {pair for process in excited for pair in combinations(process.axles.tolist(), 2)}
    }

    Q, variance = 0.0 * A, 0.0 * system.D[:, :, 0]
    for number, (process, spectrum) in enumerate(zip(excited, spectra, strict=True)):
        axles = process.axles.tolist()
        entries = [entered[number][axle] for axle in axles]

        def carry(
            i: int, j: int, axles: Any = axles, entries: Any = entries, number: int = number
        ) -> tuple[Dual, Dual]:
            E, forced = carried[axles[i], axles[j]]
            return E @ entries[i], forced[number].mT[:, :, :, None]

        stirred = Correlations(free_dynamics, entries, [taus[axle] for axle in axles], carry, spectrum)
        Q += stirred.right_hand_side()
        each, drift = integrated(model, process)
        rates, bounded = [(system.warps @ process.weights[axle]) for axle in axles], bool(drift.any())
        if each.any():
            cross, own = stirred.integrated(rates, bounded)
            w = system.on_warps
            variance += (w * (2.0 * (system.Y @ cross) + w @ own)).sum(-1)
        if road.velocity_is_bounded:
            feeds = [system.D @ process.weights[axle] for axle in axles]
            variance += stirred.passed_on(feeds, system.Y, system.on_warps, rates, bounded)

    X, _ = dynamics.lyapunov(Q.value)
    sway = A.tangent @ X
    dX, _ = dynamics.lyapunov(sway + np.swapaxes(sway, -1, -2) + Q.tangent)
    Y = system.Y
    variance += ((Y @ Dual(X, dX)) * Y).sum(-1)

    zero = variances == 0.0
    wheels = np.concatenate([process.weights for process in excited]).T
    passed_on, terms = system.D.tangent @ wheels, np.abs(system.D.tangent) @ np.abs(wheels)
    unbounded = np.isinf(variances) | (
        np.any(beyond_rounding(passed_on, terms), axis=-1) & (not road.velocity_is_bounded)
    )
    kinked = zero & _moving(system, excited, taus) if zero.any() else np.zeros_like(unbounded)
    return Tangents(np.where(unbounded, np.nan, np.where(zero, 0.0, variance.tangent)), kinked, system.damping)


def _along(settings: Sequence[Setting], field: str, wheel: str | None = None) -> Array:
    """Which settings are of a field (at a wheel), as a column (P, 1)."""
    return np.array([[s.field == field and s.at(wheel)] for s in settings], dtype=float)


def stepped_along(vehicle: Vehicle, settings: Sequence[Setting], held: Container[tuple[str, str]] = ()) -> Vehicle:
    """The vehicle an imaginary step along each setting, (P, N); fields at the wheels ``held`` stay."""
    stepped = copy.copy(vehicle)
    for name in {setting.field for setting in settings}.difference(ROAD):
        moved = [
            value + 1j * STEP * _along(settings, name, wheel) * ((name, wheel) not in held)
            for wheel, value in zip(vehicle.wheels, vehicle.at_wheels(name), strict=True)
        ]
        # The vehicle itself was checked when it was made.
        object.__setattr__(stepped, name, tuple(moved) if name in vehicle.per_corner else moved[0])
    return stepped


def _system(vehicle: Vehicle, model: SecondOrder, settings: Sequence[Setting], N: int) -> _System:
    stepped = stepped_along(vehicle, settings)

    def dual(value: Any, moved: Any, ndim: int) -> Dual:
        rest = np.shape(value)[np.ndim(value) - ndim :]
        tangent = np.broadcast_to(np.imag(moved) / STEP, (len(settings), N, *rest))
        return Dual(np.broadcast_to(value, (N, *rest)), tangent)

    other = stepped.assemble()
    n = len(model.layout.coordinates)
    A, B, Y, D = (dual(x, y, 2) for x, y in zip(model.velocity_form(), other.velocity_form(), strict=True))
    root = np.broadcast_to(np.sqrt(model.m), (N, n))
    stretch = np.concatenate([root, root], axis=-1)
    return _System(
        A=A[:, : 2 * n, : 2 * n] * (stretch[:, :, None] / stretch[:, None, :]),
        B=B[:, : 2 * n] * stretch[:, :, None],
        Y=Y[:, :, : 2 * n] * (1.0 / stretch[:, None, :]),
        D=D,
        on_warps=dual(model.on_integrators, other.on_integrators, 2),
        warps=dual(model.integrators, other.integrators, 2),
        damping=dual(model.damping, other.damping, 1),
        axles=[dual(x, y, 0) for x, y in zip(vehicle.axles, stepped.axles, strict=True)],
        track_width=dual(vehicle.track_width, stepped.track_width, 0),
    )


def _spectrum(road: Road, process: Process, width: Dual, ground: dict[str, Dual]) -> Spectrum:
    """The spectrum with its derivatives along the track width and what a design sets of a road."""
    there = copy.copy(road)
    for name, value in ground.items():
        object.__setattr__(there, name, value[:, None])
    terms = colours(there, process.share, process.sign, width)
    return Spectrum(terms.white[:, :, None], terms.alphas, terms.weights)


def _carried(
    dynamics: Dynamics, reach: Callable[..., Reach], tau: Dual, sources: Sequence[Dual], alphas: Sequence[Any]
) -> tuple[Dual, list[Dual]]:
    """Carry the states over the delay, freely and under decaying forcing from each source, at rates of its own."""
    ends = np.cumsum([0, *(each.shape[-1] for each in alphas)])
    # Those of a weighting alone are constants.
    rates: Any = 0.0 * tau[:, None] + np.concatenate(alphas, axis=-1)
    forcing: Any = np.concatenate(
        [source + np.zeros(each.shape[-1]) for source, each in zip(sources, alphas, strict=True)], axis=-1
    )
    E, f = dynamics.carried(forcing, rates[:, None, :], tau[:, None, None], reach(rates.value, tau.value))
    return E, [f[:, :, first:last] for first, last in pairwise(ends)]


def _moving(system: _System, excited: Sequence[Process], taus: Sequence[Dual]) -> Array:
    """Where the transfer function of an output has a derivative (P, N, outputs), told at one middling frequency."""
    A = system.A
    n = A.value.shape[-1] // 2
    s = 1j * np.sqrt(-np.trace(A.value[:, n:, :n], axis1=-2, axis2=-1) / n)[:, None, None]
    still = -A + s * np.eye(2 * n)
    late = [np.exp(-(tau[:, None, None] * s)) for tau in taus]
    moving = np.zeros(system.D.tangent.shape[:-1], dtype=bool)
    for process in excited:
        entered = sum((system.B @ process.weights[axle])[:, :, None] * late[axle] for axle in process.axles)
        warped = sum((system.warps @ process.weights[axle])[:, :, None] * late[axle] for axle in process.axles)
        x: Any = np.linalg.solve(still, entered)
        H = (system.Y @ x + system.on_warps @ warped / s)[:, :, 0]
        terms = np.abs(system.Y.tangent) @ np.abs(x.value) + np.abs(system.Y.value) @ np.abs(x.tangent)
        moving |= np.abs(H.tangent) > VANISHING * terms[..., 0]
    return moving
