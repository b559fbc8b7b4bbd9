"""The spectrum of road velocity as a level and first-order terms: what makes a variance a matter of algebra.

Every factor of a spectrum (the surface, the coherence of two tracks, a cut-off, the contact of a tyre, the square of a
frequency weighting) is such a list, and so is their product, by partial fractions. A term is kept as a low-pass or as a
high-pass, whichever does not cancel; its rate may be complex, one of a conjugate pair of which the real part counts.

Numbers are columns over designs: arrays, or dual numbers that carry derivatives along.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from .road import Road, velocity_terms

# x K_1(x) ~ sum c_i / (1 + (x / x_i)^2) with sum c_i = 1: a minimax fit of the error relative to 1 - x K_1(x), which
# rules roll, over x from 0.05 to 60; it stays below 3.5e-4 there. The signs are free, since the coherence decays
# exponentially and nonnegative terms cannot come closer than 0.7 %.
COHERENCE_RATES = np.array([0.042969, 0.144895, 0.402436, 1.023908, 2.287207, 4.500472, 7.055675])
COHERENCE_WEIGHTS = np.array([0.0014158, 0.0111706, 0.0779362, 0.4023666, 0.891928, -0.4842454, 0.0994281])
COHERENCE_WEIGHTS = COHERENCE_WEIGHTS / COHERENCE_WEIGHTS.sum()

# Rates as near as this to one another are moved apart: what that changes is far below what their terms say.
COINCIDENT = 1e-6

# A logarithmic step of the track width, over which the terms of a spectrum with bends are differentiated.
STEP = 1e-4


class Colours(NamedTuple):
    """``level + Re sum_j (low_j alphas_j^2 + high_j omega^2) / (alphas_j^2 + omega^2)``: level (N, 1), terms (N, J)."""

    level: Any
    alphas: Any
    low: Any
    high: Any

    @property
    def white(self) -> Any:
        """Value at infinite frequency, (N, 1)."""
        return self.level + np.real(self.high).sum(axis=-1)[:, None]

    @property
    def static(self) -> Any:
        """Value at zero frequency, (N, 1)."""
        return self.level + np.real(self.low).sum(axis=-1)[:, None]

    @property
    def weights(self) -> Any:
        """``white + Re sum weights alphas^2 / (alphas^2 + omega^2)`` is the same, (N, J)."""
        return self.low - self.high


def colours(road: Road, share: float, sign: int, track_width: Any) -> Colours:
    """Velocity spectrum of the part ``share + 0.5 sign gamma`` of two tracks a width (N,) apart.

    The mean of both tracks is ``(1 + gamma) / 2`` of one, their half difference ``(1 - gamma) / 2``. What a design may
    set of the road is one number, or one a design (N,).
    """
    N = track_width.shape[0]
    road = road.mapped(lambda x: _column(x, N))
    total = _surface(road, share, sign, track_width[:, None])
    if _plain(road.cutoff).any():
        total = product(total, _first_order(2.0 * np.pi * road.cutoff * road.speed, high=True))
    if road.contact_length:
        total = product(total, _first_order(road.speed * (1.0 / road.contact_length), high=False))
    if road.weighting is not None:
        total = product(total, Colours(*(np.broadcast_to(part, (N, part.shape[1])) for part in road.weighting.colours)))
    return total


def product(one: Colours, other: Colours) -> Colours:
    """The product of two spectra, by partial fractions: each term times the other spectrum at its own pole."""
    for constant, terms in ((one, other), (other, one)):
        if not _plain(constant.alphas).size:
            scale = constant.level
            return Colours(scale * terms.level, terms.alphas, scale * terms.low, scale * terms.high)
    one = one._replace(alphas=_apart(one.alphas, other.alphas))
    at_one, at_other = _at_poles(other, one.alphas), _at_poles(one, other.alphas)
    alphas, low, high = (
        np.concatenate([x, y], axis=-1)
        for x, y in (
            (one.alphas, other.alphas),
            (one.low * at_one, other.low * at_other),
            (one.high * at_one, other.high * at_other),
        )
    )
    # What cancels at one end of the frequency axis is not computed there.
    rising = ~np.concatenate([_plain(one.low), _plain(other.low)], axis=-1).any(axis=-1, keepdims=True)
    if rising.all():
        level = one.static * other.static
    else:
        level = one.white * other.white - np.real(high).sum(axis=-1)[:, None]
        if rising.any():
            level = np.where(rising, one.static * other.static, level)
    return Colours(level, alphas, low, high)


def _surface(road: Road, share: float, sign: int, width: Any) -> Colours:
    standard, scale = road.standard(), road.roughness * road.speed
    exact = standard.exact_terms()
    if exact is not None:
        white, rates, weights = exact
        none = 0.0 * scale + np.zeros(len(rates))
        track = Colours(scale * (white + weights.sum()), rates * road.speed, none, -(scale * weights))
        if not sign:
            return track._replace(level=share * track.level, high=share * track.high)
        alphas = COHERENCE_RATES * road.speed / width
        none = 0.0 * alphas
        part = none - 0.5 * sign * COHERENCE_WEIGHTS
        return product(track, Colours(none[:, :1] + (share + 0.5 * sign), alphas, none, part))
    scale, unit = (scale, width) if sign else (share * scale, 1.0 + 0.0 * width)
    if road.power_law:
        level, rates, low, high, _ = velocity_terms(standard, sign, 1.0)
        scale = scale * unit ** (road.waviness - 2.0)
    else:
        rates, level, low, high = _of_widths(standard, sign, unit)
    return Colours(scale * level, rates * road.speed / unit, scale * low, scale * high)


def _of_widths(standard: Road, sign: int, width: Any) -> tuple[Any, Any, Any, Any]:
    """Rates (J,), level (N, 1) and weights (N, J) of a spectrum whose bends stand at wavenumbers of their own."""

    def terms(widths: NDArray[Any]) -> list[NDArray[Any]]:
        different, which = np.unique(widths, return_inverse=True)
        every = [velocity_terms(standard, sign, float(one)) for one in different]
        return [
            np.stack([np.atleast_1d(getattr(one, name)) for one in every])[which.ravel()]
            for name in ("rates", "level", "low", "high")
        ]

    rates, *found = terms(_plain(width)[:, 0])
    if hasattr(width, "tangent") and sign:
        values = width.value[:, 0]
        ends = [terms(values * np.exp(step))[1:] for step in (STEP, -STEP)]
        # d/d(ln width) by a central difference; zero weight is given to the value itself.
        slopes = [(up - down) / (2.0 * STEP) for up, down in zip(*ends, strict=True)]
        relative = width * (1.0 / width.value) - 1.0
        found = [value + slope * relative for value, slope in zip(found, slopes, strict=True)]
    return rates, *found  # type: ignore[return-value]


def _first_order(rate: Any, high: bool) -> Colours:
    """``omega^2 / (rate^2 + omega^2)``, or one less that."""
    none = 0.0 * rate
    one = none + 1.0
    return Colours(none, rate, none if high else one, one if high else none)


def _at_poles(spectrum: Colours, alphas: Any) -> Any:
    """The spectrum at ``omega^2 = -alphas^2`` (N, J), none of which is a pole of its own."""
    at = (alphas * alphas)[:, :, None]
    terms = [spectrum]
    if np.iscomplexobj(_plain(spectrum.alphas)):
        # The real part on the axis of frequencies is half the sum of a term and its conjugate off it as well.
        half = spectrum._replace(low=0.5 * spectrum.low, high=0.5 * spectrum.high)
        terms = [half, Colours(half.level, *map(np.conjugate, half[1:]))]
    total = spectrum.level + 0.0 * alphas
    for _, rates, low, high in terms:
        square = (rates * rates)[:, None, :]
        total = total + ((low[:, None, :] * square - high[:, None, :] * at) / (square - at)).sum(axis=-1)
    return total


def _apart(rates: Any, others: Any) -> Any:
    """Rates, moved by a little where they coincide with others."""
    own, other = _plain(rates)[:, :, None], _plain(others)[:, None, :]
    near = (np.abs(own - other) < COINCIDENT * np.abs(other)).any(axis=2)
    return rates * np.where(near, 1.0 + 2.0 * COINCIDENT, 1.0)


def _plain(values: Any) -> NDArray[Any]:
    """The values of an array or of dual numbers."""
    return np.asarray(getattr(values, "value", values))


def _column(values: Any, N: int) -> Any:
    """A number, or one a design, as (N, 1)."""
    return np.broadcast_to(np.asarray(values), N)[:, None] if _plain(values).ndim < 2 else values
