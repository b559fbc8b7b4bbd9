"""The golden car, whose parameters and speed define the international roughness index (World Bank Technical Paper 46).

Its suspension velocity over its speed, per slope of the profile, is ``H(s) = -kt s^2 / D(s)`` with ``D(s) = (s^2 + c s
+ ks) (mu s^2 + c s + ks + kt) - (c s + ks)^2``: the same for all that uses it, a profile or a spectrum.
"""

from __future__ import annotations

import dataclasses
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..vehicles.parameters import DesignSpace, computed

Array = NDArray[np.float64]

# Per unit sprung mass, in 1/s^2 and 1/s (M. W. Sayers, T. D. Gillespie and W. D. O. Paterson, Guidelines for Conducting
# and Calibrating Road Roughness Measurements, World Bank Technical Paper 46, 1986; ASTM E1926).
KT, KS, CS, MU = 653.0, 63.3, 6.0, 0.15

SPEED = 80.0 / 3.6
"""In m/s."""

BASE = 0.25
"""Length in m over which a tyre levels the profile out, as a moving average."""

RESPONSE = np.array([MU, (1.0 + MU) * CS, (1.0 + MU) * KS + KT, KT * CS, KT * KS])
"""``D(s)``, highest power first."""

_ROOTS = np.roots(RESPONSE)
RATES = _ROOTS[_ROOTS.imag > 0.0]
"""Modes in 1/s, one of each pair: twice the real part of ``sum WEIGHTS / (s - RATES)`` is H."""
WEIGHTS = -KT * RATES**2 / np.polyval(np.polyder(RESPONSE), RATES)

# What is left of an earlier state below this is forgotten.
FORGOTTEN = 1e-20

# Steps worked on together: they stay near the processor.
BLOCK = 16384

# Wavenumbers in cycle/m beyond which a road's share in the index is below 1e-9, and the nodes of the integral between.
LOWEST, HIGHEST, PANELS, NODES = 1e-6, 1e3, 400, 8


def velocities(steps: Array, slopes: Array) -> Array:
    """Suspension velocity over speed at the end of every step, exact for straight lines between points.

    Parameters
    ----------
    steps : ndarray, (S,)
        Lengths in m.
    slopes : ndarray, (tracks, S)
        Of the profile over each step. The car starts in equilibrium on a level road.
    """
    found = np.empty(slopes.shape)
    before = np.zeros((len(RATES), len(slopes)), dtype=complex)
    for first in range(0, len(steps), BLOCK):
        part = slice(first, first + BLOCK)
        over = RATES[:, None] * (steps[part] / SPEED)
        driven = (WEIGHTS / RATES)[:, None] * np.expm1(over)
        modes = _accumulated(np.exp(over)[:, None], driven[:, None] * slopes[:, part], before)
        found[:, part], before = 2.0 * modes.real.sum(axis=0), modes[..., -1]
    return found


def _accumulated(a: NDArray[Any], b: NDArray[Any], before: NDArray[Any]) -> NDArray[Any]:
    """``x_i = a_i x_(i-1) + b_i`` along the last axis, from x = ``before``: by doubling what each x knows of."""
    b[..., 0] += a[..., 0] * before
    reach = 1
    while reach < b.shape[-1] and np.abs(a[..., reach:]).max() > FORGOTTEN:
        b[..., reach:] += a[..., reach:] * b[..., :-reach]
        a[..., reach:] *= a[..., :-reach]
        reach *= 2
    return b


def mean_index(road: Any) -> Any:
    """Mean index in m/km of a `Road`: a number, or a DataArray where its roughness or cut-off is an array.

    ``E|v| = sqrt(2/pi) sigma`` with ``sigma^2 = int |H(2 pi n V)|^2 (sin(pi n L) / (pi n L))^2 (2 pi n)^2 G_d(n) dn``,
    by Gauss's nodes between the bends of the spectrum.
    """
    road = dataclasses.replace(road, speed=SPEED)
    space = DesignSpace.over(road.leaves(), type(road).__name__)
    columns = road.mapped(lambda value: np.reshape(space.flat(computed(value)), (-1, 1)))
    edges = np.union1d(np.linspace(np.log(LOWEST), np.log(HIGHEST), PANELS + 1), np.log([n for n, _ in road.table]))
    at, weights = np.polynomial.legendre.leggauss(NODES)
    half = 0.5 * np.diff(edges)[:, None]
    n = np.exp(edges[:-1, None] + half * (1.0 + at)).ravel()
    omega = 2.0 * np.pi * n * SPEED
    velocity = KT * omega**2 / np.abs(np.polyval(RESPONSE, 1j * omega)) * np.sinc(n * BASE) * 2.0 * np.pi * n
    sigma = np.sqrt(columns.psd(n) @ (velocity**2 * n * (half * weights).ravel()))
    mean = 1000.0 * np.sqrt(2.0 / np.pi) * sigma
    return space.unflatten(mean) if space.dims else float(mean.item())
