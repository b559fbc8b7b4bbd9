"""Where polynomials keep their digits: bounds on struts, and what to ask in two systems of units beyond them."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...vehicles.second_order import Outputs
from .polynomials import Array, Colours, Track

# A delay of more steps than this (a walking pace) is left to matrices, which square their way through it.
LONGEST_WALK = 256

# An acceleration whose variance is at most the first share of its terms is zero by symmetry; up to the second, it may
# have lost digits.
ZERO, CANCELLED = 1e-14, 1e-9

# Ratios of masses, of stiffnesses, and of damping to its critical value, within which variances keep ten digits, if it
# is not too light. Beyond them they are computed in two systems of units, which must agree.
SPREAD, HEAVY = 300.0, 30.0
MASS, TIME = 0.73, 1.37


def turns(struts: Array, compliance: Array, tau: Array) -> Array:
    """Radians (N,) of which no root turns more over the delay.

    Struts are (S, 5, N) of ``mu, ks, cs, kt, ct``, the body's compliance (S, S, N).
    """
    springs, tyres = struts[:, 1:3], struts[:, 3:5]
    # The largest row sums of the stiffness and the damping matrix over the masses bound what is fastest, whatever the
    # unit of the body's coordinates; a small one does so tightly where the wheels are faster than the body.
    unit = np.array([1.0, 0.25])[:, None, None]
    at_body = np.einsum("ijn,jkn->ikn", np.abs(compliance), springs).max(axis=0)
    at_wheels = (((1.0 + unit[..., None]) * springs + tyres) / struts[:, :1]).max(axis=1)
    stiffness, damping = np.maximum((1.0 + 1.0 / unit) * at_body, at_wheels).swapaxes(0, 1)
    fastest = 0.5 * damping + np.sqrt(0.25 * damping**2 + stiffness)
    return np.asarray(fastest.min(axis=0) * tau)


def walk(turns: float, reach: float) -> tuple[int, int]:
    """Steps of at most ``reach`` radians that lead over so many, and how often each halves until one is left."""
    steps = int(np.ceil(turns / reach))
    return steps, max(0, int(np.ceil(np.log2(turns / steps))))


def undamped(struts: Array) -> NDArray[np.bool_]:
    """Designs (N,) of which some wheel has no damper at all."""
    return np.asarray(((struts[:, 2] == 0.0) & (struts[:, 4] == 0.0)).any(axis=0))


def extreme(struts: Array, compliance: Array, light: float) -> bool:
    """Whether some design is so far from any vehicle, or its damping so light, that its digits have to be counted."""
    mu, ks, cs, kt, ct = np.moveaxis(struts, 1, 0)
    masses = np.concatenate([mu, 1.0 / np.einsum("iin->in", compliance)])
    # What has no tyre is a seat.
    stiffnesses = np.concatenate([ks, kt[kt.any(axis=1)]])
    damping = (cs + ct) / np.sqrt((ks + kt) * mu)
    spread = max(float((x.max(axis=0) / x.min(axis=0)).max()) for x in (masses, stiffnesses))
    return not (spread < SPREAD and damping.min() > light and damping.max() < HEAVY)


def sum_or_nan(total: Array, size: Array) -> Array:
    """A variance, from the sizes of its terms: zero where it is no more than rounding, nan where digits may be lost."""
    return np.where(total > CANCELLED * size, total, np.where(np.abs(total) <= ZERO * size, 0.0, np.nan))


def struts_in_other_units(struts: Array) -> Array:
    """The same struts with mass and time in other units, in which results are the same but for rounding."""
    force = MASS / TIME**2
    return struts * np.array([MASS, force, force * TIME, force, force * TIME])[:, None]


def track_in_other_units(road: Track) -> Track:
    """The same road with time in another unit."""
    colours = (Colours(each.alphas / TIME, each.low / TIME, each.high / TIME) for each in (road.real, road.swinging))
    return Track(road.level / TIME, *colours)


def tracks_together(one: Track, other: Track) -> Track:
    """The roads of some designs and those of others behind them, of as many colours."""

    def joined(own: Colours, others: Colours) -> Colours:
        return Colours(*(np.concatenate(pair, axis=-1) for pair in zip(own, others, strict=True)))

    level = np.concatenate([one.level, other.level])
    return Track(level, joined(one.real, other.real), joined(one.swinging, other.swinging))


def disagreement(variances: Array, other: Array, outputs: Outputs, agreed: float) -> NDArray[np.bool_]:
    """Designs (N,) of which some variance (outputs, N) is not the same in other units, but for such a share."""
    units = {
        "sws": 1.0,
        "seat_travel": 1.0,
        "tyre_deflection": 1.0,
        "dtl": MASS**2 * TIME**-4.0,
        "sws_rate": TIME**-2.0,
    }
    same = other / np.array([units.get(row.quantity.name, TIME**-4.0) for row in outputs.rows])[:, None]
    with np.errstate(invalid="ignore"):
        return np.logical_or.reduce((variances != same) & ~(np.abs(variances - same) < agreed * variances))
