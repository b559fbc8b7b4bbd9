"""The filter that turns white noise into a road's velocity: the minimum-phase factor of a list of first-order terms.

A controller that knows what the road did so far knows the noise behind it, for a minimum-phase filter can be undone.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..roads.colours import Colours

Array = NDArray[np.float64]

# Steps of Aberth's iteration at most, and the relative step at which it ends.
STEPS, SETTLED = 200, 1e-14

# Frequencies in rad/s at which a factor must be close, and how close its square, relatively: beyond them no vehicle
# feels what fitted terms make of the ends of a spectrum.
FELT, LOST = np.geomspace(0.1, 1e4, 200), 1e-5

UNSHAPED = (
    "the road's velocity has no minimum-phase filter with five digits behind it; pass a road of a waviness further "
    "below 3"
)

# A white part below this share of the largest term is none.
WHITE = 1e-14


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

    With ``S(s) = sum_k (low_k alpha_k^2 - high_k s^2) / (alpha_k^2 - s^2) + level`` the zeros of the factor are the
    roots of S over ``s^2``, in the left half plane, and its residues ``gain prod_j (z_j - alpha_k) / prod_(j != k)
    (alpha_j - alpha_k)``.

    Raises
    ------
    ValueError
        A spectrum of which the factor keeps fewer than five digits.
    """
    rates, low, high = (np.real(part[0]) for part in spectrum[1:])
    kept = (low != 0.0) | (high != 0.0)
    order = np.argsort(rates[kept])
    rates, low, high = (part[kept][order] for part in (rates, low, high))
    level, white = float(spectrum.level[0, 0]), float(spectrum.white[0, 0])
    if not len(rates):
        return Shaping(float(np.sqrt(white)), rates, low)
    bounded = white <= WHITE * max(abs(level), np.abs(low).max(), np.abs(high).max())
    # At high frequency S is its white part, or falls as this over omega^2.
    lead = ((low - high) * rates**2).sum() if bounded else white
    zeros = np.sqrt(_zeros(level, rates**2, low, high, len(rates) - bounded))
    gains = np.empty(len(rates))
    for k, rate in enumerate(rates):
        others = np.delete(rates, k)
        first = 1.0 if bounded else zeros[0] - rate
        gains[k] = (first * np.prod((zeros[len(zeros) - len(others) :] - rate) / (others - rate))).real
    found = Shaping(0.0 if bounded else float(np.sqrt(white)), rates, np.sqrt(max(lead, 0.0)) * gains)

    squares = FELT[:, None] ** 2
    power = level + ((low * rates**2 + high * squares) / (rates**2 + squares)).sum(axis=1)
    factor = found.direct + (found.gains / (rates + 1j * FELT[:, None])).sum(axis=1)
    if (
        not np.abs(np.abs(factor) ** 2 - power).max() < np.inf
        or (np.abs(np.abs(factor) ** 2 / power - 1.0) > LOST).any()
    ):
        raise ValueError(UNSHAPED)
    return found


def _zeros(level: float, squares: Array, low: Array, high: Array, count: int) -> NDArray[np.complex128]:
    """Zeros over ``s^2`` of the spectrum by Aberth's iteration (Math. of Computation 27 (1973)).

    Each step is relative to the zero that it moves, so that twenty decades of them do no harm. They start between the
    poles, where those of a spectrum of positive terms are.
    """
    between = np.sqrt(squares[1:] * squares[:-1])
    z = np.append(between, squares[-1] * 1.5)[:count] * np.exp(0.1j)
    for _ in range(STEPS):
        gap = squares - z[:, None]
        value = level + ((low * squares - high * z[:, None]) / gap).sum(axis=1)
        slope = ((low - high) * squares / gap**2).sum(axis=1)
        with np.errstate(all="ignore"):
            newton = 1.0 / (slope / value - (1.0 / gap).sum(axis=1))
            apart = z[:, None] - z
            np.fill_diagonal(apart, np.inf)
            step = newton / (1.0 - newton * (1.0 / apart).sum(axis=1))
        step = np.where(np.isfinite(step), step, 0.0)
        z = z - step
        if (np.abs(step) <= SETTLED * np.abs(z)).all():
            break
    # A spectrum that vanishes at zero frequency has a zero there, of which rounding may leave a negative one.
    return np.where((z.real < 0.0) & (np.abs(z.imag) < 1e-6 * np.abs(z)), 0.0, z)
