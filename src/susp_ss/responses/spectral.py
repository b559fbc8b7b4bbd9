"""Variances by integrating spectra over all frequencies: any waviness and any coherence.

Gauss and Legendre's quadrature on `panels`, which are halved where the last coefficients of what they integrate are not
small. Axles that meet the road one after the other interfere ever faster as frequency rises. Their cross terms are
smooth functions times ``exp(-j w tau)``: of those the Legendre series is integrated term by term, with spherical Bessel
functions (N. S. Bakhvalov and L. G. Vasil'eva, *USSR Comput. Math. Math. Phys.* 8, 1968), and far above every
resonance three terms of an asymptotic series are the rest.
"""

from __future__ import annotations

from itertools import combinations

import numpy as np
from numpy.polynomial import legendre
from numpy.typing import NDArray
from scipy.special import spherical_jn

from ..progress import tracked
from ..roads.road import Road
from ..vehicles.contract import Model, RoadVehicle
from ..vehicles.parameters import DesignSpace, blocks
from .excitation import check_stationary, infinite_outputs, processes
from .frequency import effects, squared
from .panels import ABOVE, BELOW, BETWEEN, Marks, Panels, marks

Array = NDArray[np.float64]

# Error of a panel, relative to each variance but no finer than to what the wheels would give one by one, where their
# effects cancel; what it must be at the worst, and how often panels are halved.
RELATIVE, CANCELLED, REFUSED, ROUNDS = 1e-11, 1e-12, 1e-7, 14

# Designs and panels at work at once.
DESIGNS, TOGETHER = 64, 256

NODES = 16
X, WEIGHTS = legendre.leggauss(NODES)
ORDER = np.arange(NODES)
# Legendre coefficients of what has such values at the nodes; and of it, its slope and its curvature at 1.
SERIES = (ORDER[:, None] + 0.5) * legendre.legvander(X, NODES - 1).T * WEIGHTS
AT_END = np.stack([ORDER**0, ORDER * (ORDER + 1) / 2, (ORDER - 1) * ORDER * (ORDER + 1) * (ORDER + 2) / 8]) @ SERIES


def spectral_variances(flat: RoadVehicle, space: DesignSpace, road: Road) -> Array:
    """Integrate ``S_y(f) df`` over all frequencies: variances (designs, outputs) of all outputs of all designs.

    An output that passes the road's velocity straight on has no finite variance unless the waviness exceeds 3.
    """
    groups = blocks(space.size, DESIGNS)
    shown = tracked(groups, "integrating", len(groups) > 1)
    return np.concatenate([_variances(flat.select(some), road.select(some), some.stop - some.start) for some in shown])


def _variances(flat: RoadVehicle, road: Road, designs: int) -> Array:
    model = flat.assemble()
    check_stationary(flat, road, model)
    infinite = infinite_outputs(model, processes(flat, road), road)
    infinite = np.broadcast_to(infinite, (designs, infinite.shape[-1]))
    marked = marks(flat, model, road, designs)
    panels, total, size = marked.panels(), np.zeros(infinite.shape), np.zeros(infinite.shape)
    for halvings in range(ROUNDS + 1):
        integral, error, alone = _integrals(flat, model, road, marked, panels)
        if not halvings:
            np.add.at(size, panels.design, alone)
        so_far = total.copy()
        np.add.at(so_far, panels.design, integral)
        allowed = RELATIVE * np.abs(so_far) + CANCELLED * size + np.finfo(float).tiny
        over = np.where(infinite, 0.0, 1.0 / allowed)[panels.design] * error
        bad = np.any(over > 1.0, axis=1)
        if not bad.any() or halvings == ROUNDS:
            break
        np.add.at(total, panels.design[~bad], integral[~bad])
        panels = panels.some(bad).halved()
    if over.max() * RELATIVE > REFUSED:
        raise ValueError(f"{type(flat).__name__}: the integral over the spectrum did not converge to {REFUSED:g}")
    return np.where(infinite, np.inf, so_far)


def _integrals(flat: RoadVehicle, model: Model, road: Road, marked: Marks, panels: Panels) -> list[Array]:
    """What `_integral` says of all panels."""
    found = []
    for part in blocks(len(panels.design), TOGETHER):
        some = panels.some(part)
        if len(marked.high) == 1:
            found.append(_integral(flat, model, road, marked, some))
        else:
            vehicle = flat.select(some.design)
            found.append(_integral(vehicle, vehicle.assemble(), road.select(some.design), marked, some))
    return list(map(np.concatenate, zip(*found, strict=True)))


def _integral(
    vehicle: RoadVehicle, model: Model, road: Road, marked: Marks, panels: Panels
) -> tuple[Array, Array, Array]:
    """Integrals over panels, their errors, and what wheels would give one by one, (P, outputs)."""
    where, start, end = marked.where(panels), np.exp(panels.start), np.exp(panels.end)
    linear = where[:, None] == BETWEEN
    half = np.where(where == BETWEEN, 0.5 * (end - start), panels.half)
    in_log = np.exp(panels.centre[:, None] + panels.half[:, None] * X)
    omega = np.where(linear, 0.5 * (start + end)[:, None] + half[:, None] * X, in_log)
    scale = (np.where(linear, 1.0, omega) / (2.0 * np.pi))[:, None]
    weights = half[:, None] * WEIGHTS
    H = model.relative_transfer(omega)
    found = effects(vehicle, model, road, omega / (2.0 * np.pi), H)
    below, further = np.flatnonzero(where == BELOW), np.flatnonzero(where != BELOW)
    density = np.zeros((*H.shape[:2], NODES))
    for effect in found:
        density[below] += effect.velocity[below] * squared(effect.at(below).whole)
        density[further] += effect.velocity[further] * sum(map(squared, effect.at(further).each))
    integral, error = _summed(weights, scale * density), _left_out(scale * density, half, np.zeros(len(half)))
    alone = _summed(weights, scale * found[0].velocity * squared(H).sum(axis=-2))
    last = (where == BETWEEN) & (panels.end == marked.high[panels.design])
    for effect in (effect.at(further) for effect in found if len(further) and len(effect.taus) > 1):
        for (first, one), (second, other) in combinations(zip(effect.taus, effect.each, strict=True), 2):
            tau = np.broadcast_to(second - first, (len(further), 1, 1))[:, 0]
            turning = _turning(half[further, None], start[further, None], end[further, None], last[further], tau)
            above = where[further] == ABOVE
            turning[above] = np.where(tau[above] == 0.0, weights[further][above], 0.0)
            cross = 2.0 * scale[further] * effect.velocity * one.conj() * other
            integral[further] += _summed(turning, cross).real
            error[further] += np.where(above[:, None], 0.0, _left_out(cross, half[further], half[further] * tau[:, 0]))
    return integral, error, alone


def _turning(half: Array, start: Array, end: Array, last: NDArray[np.bool_], tau: Array) -> NDArray[np.complex128]:
    """Weights (P, NODES) of ``int C(w) exp(-j w tau) dw`` over panels, and from the last of them on."""
    turn = (-1j) ** ORDER * spherical_jn(ORDER, half * tau)
    weights = 2.0 * half * np.exp(-0.5j * (start + end) * tau) * (turn @ SERIES)
    last = last & (tau[:, 0] > 0.0)
    h, by, at_end = half[last], 1.0 / (1j * tau[last]), np.exp(-1j * end[last] * tau[last])
    weights[last] += at_end * (by * AT_END[0] + by**2 / h * AT_END[1] + by**3 / h**2 * AT_END[2])
    return np.asarray(weights)


def _summed(weights: NDArray, values: NDArray) -> NDArray:
    """Weighted sums (P, outputs) of values (P, outputs, NODES)."""
    return np.asarray((values @ weights[..., None])[..., 0])


def _left_out(values: NDArray, half: Array, turns: Array) -> Array:
    """Estimates (P, outputs) of what quadrature leaves out, whose Legendre coefficients go on as the last ones fall.

    By Gauss's rule those from twice the number of nodes on, or, the more ``turns`` (P,) of phase there are, from that
    number on.
    """
    last = np.abs(values @ SERIES[-2:].T).max(axis=-1)
    peak = np.abs(values).max(axis=-1)
    fallen = np.divide(last, peak, out=np.zeros_like(peak), where=peak > 0.0)
    return np.asarray(2.0 * half[:, None] * peak * fallen ** (2.0 - np.minimum(turns / NODES, 1.0))[:, None])
