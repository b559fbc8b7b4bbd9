"""The filter that turns white noise into a road's velocity: the minimum-phase factor of a list of first-order terms.

A controller that knows what the road did so far knows the noise behind it, for a minimum-phase filter can be undone.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..roads.colours import Colours

Array = NDArray[np.float64]

# Newton steps that give each zero the digits that eigenvalues of a matrix over twenty decades have lost.
POLISH = 8

# Relative error of a factor's square beyond which it is refused.
LOST = 1e-6


class Shaping(NamedTuple):
    """``W(s) = direct + sum_k gains_k / (s + rates_k)``, with ``|W(j omega)|^2`` the two-sided velocity spectrum."""

    direct: float
    rates: Array
    gains: Array

    @property
    def static(self) -> float:
        """``W(0)``: nothing, where the height of the road has a finite variance."""
        total, terms = self.direct + (self.gains / self.rates).sum(), np.abs(self.gains / self.rates)
        return float(total) if abs(total) > LOST * (abs(self.direct) + terms.sum()) else 0.0


def shaping(spectrum: Colours) -> Shaping:
    """Factor the spectrum of one design.

    With ``S = c + sum r_k / (alpha_k^2 - s^2)`` the zeros of the factor are the roots of those of S over ``s^2``, the
    eigenvalues of ``diag(alpha^2) + r 1^T / c``; where c is zero, of the pencil that is left.

    Raises
    ------
    ValueError
        A spectrum that is not positive, or of which the factor loses digits.
    """
    level, rates, weights = float(spectrum.white[0, 0]), np.real(spectrum.alphas[0]), np.real(spectrum.weights[0])
    kept = weights != 0.0
    rates, weights = rates[kept], weights[kept]
    if not len(rates):
        return Shaping(float(np.sqrt(level)), rates, weights)
    squares, residues = rates**2, weights * rates**2
    if level <= 1e-14 * np.abs(weights).sum():
        level = 0.0
    zeros = np.sqrt(_polished(_zeros(level, squares, residues), level, squares, residues))
    # |W|^2 ~ level, or sum of residues / omega^2, at high frequency.
    lead = np.sqrt(level if level else residues.sum())
    gains = np.empty(len(rates))
    for k, rate in enumerate(rates):
        others = np.delete(rates, k)
        factors = np.concatenate([[zeros[0] - rate] if level else [], (zeros[level > 0.0 :] - rate) / (others - rate)])
        gains[k] = lead * np.prod(factors).real
    found = Shaping(float(np.sqrt(level)), rates, gains)
    omega = np.concatenate([rates, np.abs(zeros), 3.0 * rates])
    power = level + (residues / (squares + omega[:, None] ** 2)).sum(axis=1)
    factor = found.direct + (gains / (rates + 1j * omega[:, None])).sum(axis=1)
    error = np.abs(np.abs(factor) ** 2 - power).max() / power.max() if (power >= 0.0).all() else np.inf
    if not error < LOST:
        raise ValueError(f"the road's velocity spectrum has no minimum-phase factor with six digits (error {error:.1g})")
    return found


def _zeros(level: float, squares: Array, residues: Array) -> NDArray[np.complex128]:
    """Zeros of ``level + sum residues / (squares - z)`` over z."""
    if level:
        return np.linalg.eigvals(np.diag(squares) + np.outer(residues, np.ones(len(squares))) / level).astype(complex)
    import scipy.linalg

    size = len(squares)
    border = np.block([[np.diag(squares), residues[:, None] / residues.sum()], [np.ones((1, size)), np.zeros((1, 1))]])
    unit = np.diag(np.r_[np.ones(size), 0.0])
    found = scipy.linalg.eigvals(border, unit)
    return np.asarray(found[np.argsort(np.abs(found))][: size - 1], dtype=complex)


def _polished(
    zeros: NDArray[np.complex128], level: float, squares: Array, residues: Array
) -> NDArray[np.complex128]:
    """The zeros by Newton's method, which sees each of them in its own size."""
    for _ in range(POLISH):
        gap = squares - zeros[:, None]
        value, slope = level + (residues / gap).sum(axis=1), (residues / gap**2).sum(axis=1)
        with np.errstate(all="ignore"):
            step = np.where(slope != 0.0, value / slope, 0.0)
        zeros = np.where(np.abs(step) < 0.3 * np.abs(zeros), zeros - step, zeros)
    # A spectrum that vanishes at zero frequency has a zero there, of which rounding may leave a negative one.
    return np.where((zeros.real < 0.0) & (np.abs(zeros.imag) < 1e-9 * np.abs(zeros)), 0.0, zeros)
