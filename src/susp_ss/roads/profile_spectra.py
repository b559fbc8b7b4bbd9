"""Spectrum and coherence of a profile: Welch's estimate, smoothed in the bands of ISO 8608, and how sure it is."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.special import zeta
from scipy.stats import chi2
from scipy.stats import f as fisher

from .road import REFERENCE_WAVENUMBER

Array = NDArray[np.float64]

# ISO 8608 fits between these wavenumbers, in cycle/m: the outer edges of the octaves around 1/64 and 2.
LOWEST, HIGHEST = 2.0**-6.5, 2.0**1.5

# From these on, as powers of two, it smooths in thirds of an octave and in twelfths; below in whole ones.
THIRDS, TWELFTHS = -4.5, -4.5 + 8.0 / 3.0

# Harmonics of a segment below this are left out, since a spectrum that falls and the trend taken off change them by
# some per cent; so segments are as long as the lowest band wants.
FIRST = 8
SEGMENT = FIRST / LOWEST

# Steps that differ by a smaller share count as even; a profile is trusted up to this share of 1/step.
EVEN, TRUSTED = 1e-3, 0.4

# Classes into which uneven steps are sorted, and nodes over their share of a wave.
STEPS, NODES = 200, 1000

# Harmonics further apart than this know nothing of one another behind Hann's window.
RELATED = 6

# The spectrum of a road times n^EQUAL is about the same at all wavenumbers, so that means over a band weigh all alike.
EQUAL = 2.0


class Bands(NamedTuple):
    """A profile's spectrum in bands (B,), and what each harmonic (H,) has to do with it.

    ``psd`` is that of one track in m^3, times ``(n / n0)^2``, a mean over a band's harmonics and both tracks;
    ``in_phase`` and ``opposed`` are twice that of the tracks' mean and of their half difference. ``covariance`` (B, B)
    is that of ``psd`` relative to its expectation, ``freedom`` the degrees of freedom of ``in_phase`` and ``opposed``.
    Of each harmonic there are the wavenumber, the band, the number along a segment, and what interpolation has kept.
    """

    centre: Array
    psd: Array
    in_phase: Array
    opposed: Array
    covariance: Array
    freedom: Array
    harmonics: Array
    of_band: NDArray[np.int_]
    order: Array
    kept: Array

    @property
    def coherence(self) -> Array:
        """``gamma``, of the cross spectrum to that of one track."""
        return (self.in_phase - self.opposed) / (self.in_phase + self.opposed)

    def coherence_interval(self, confidence: float) -> tuple[Array, Array]:
        """Where ``gamma`` lies: ``(1 + gamma) / (1 - gamma)`` is a ratio of variances, and scatters as Fisher's F."""
        spread = fisher.ppf(0.5 + 0.5 * confidence, self.freedom, self.freedom)
        with np.errstate(divide="ignore"):
            ratio = self.in_phase / self.opposed
        return 1.0 - 2.0 / (ratio / spread + 1.0), 1.0 - 2.0 / (ratio * spread + 1.0)

    def psd_interval(self, confidence: float) -> tuple[Array, Array]:
        """Where ``psd`` lies, which scatters as chi-square."""
        freedom = 2.0 / np.diag(self.covariance)
        tail = 0.5 - 0.5 * confidence
        scaled = freedom * self.psd
        return scaled / chi2.ppf(1.0 - tail, freedom), scaled / chi2.ppf(tail, freedom)

    def mean(self, density: Array, waviness: Any) -> Array:
        """What ``psd`` is to be expected of a density (..., H) in m^3 at the harmonics, about as steep as ``n^-w``.

        Hann's window, whose square spreads over a third of a harmonic squared, adds a share of ``w (w + 1) / 6`` over
        the harmonic's square; linear interpolation takes some.
        """
        bent = 1.0 + waviness * (waviness + 1.0) / 6.0 / self.order**2
        each = density * self.kept * bent * (self.harmonics / REFERENCE_WAVENUMBER) ** EQUAL
        starts = np.flatnonzero(np.diff(self.of_band, prepend=-1))
        return np.asarray(np.add.reduceat(each, starts, axis=-1) / np.bincount(self.of_band))


def band_edges() -> Array:
    """Edges of the bands that ISO 8608 smooths in, in cycle/m."""
    lowest, highest = np.log2([LOWEST, HIGHEST])
    octaves = np.arange(lowest, THIRDS)
    thirds = THIRDS + np.arange(8) / 3.0
    twelfths = np.arange(TWELFTHS, highest + 1e-9, 1.0 / 12.0)
    return 2.0 ** np.concatenate([octaves, thirds, twelfths])


def bands_of(x: Array, tracks: Array, waviness: float = 2.0) -> Bands | None:
    """The bands of a profile's tracks (2, P) over x (P,); None where it is too short or too coarse for any.

    A profile with uneven steps is first interpolated, linearly, at half the mean step; what that does to a spectrum of
    such a waviness is told by ``kept``.
    """
    from scipy.signal import csd, welch

    steps = np.diff(x)
    step, even = float(np.mean(steps)), bool(np.ptp(steps) <= EVEN * np.mean(steps))
    if not even:
        at = np.linspace(x[0], x[-1], 2 * len(steps) + 1)
        tracks, step = np.stack([np.interp(at, x, z) for z in tracks]), float(at[1] - at[0])
    length = step * tracks.shape[1]
    segments = max(1, int(2.0 * length / SEGMENT) - 1)
    points = 2 * int(length / (segments + 1) / step)
    if points < 2 * FIRST:
        return None
    how: dict[str, Any] = {"fs": 1.0 / step, "window": "hann", "nperseg": points, "detrend": "linear"}
    n, left = welch(tracks[0], **how)
    right = welch(tracks[1], **how)[1]
    cross = csd(tracks[0], tracks[1], **how)[1].real
    edges = band_edges()
    # An edge that rounding lets a harmonic fall on belongs to the band above.
    band = np.searchsorted(edges * (1.0 - 1e-9), n, side="right") - 1
    order = np.arange(len(n))
    limit = TRUSTED / (step if even else float(np.mean(steps)))
    good = (order >= FIRST) & (band >= 0) & (band < len(edges) - 1) & (n <= limit)
    if not good.any():
        return None
    present, of_band = np.unique(band[good], return_inverse=True)
    weight = (n[good] / REFERENCE_WAVENUMBER) ** EQUAL

    def mean(density: Array) -> Array:
        return np.bincount(of_band, weight * density[good]) / np.bincount(of_band)

    psd, together = 0.5 * mean(left + right), mean(cross)
    gamma = together / np.where(psd > 0.0, psd, 1.0)
    count = (tracks.shape[1] - points) // (points // 2) + 1
    relative = _relative_covariance(order[good], of_band, points, count)
    return Bands(
        np.sqrt(edges[present] * edges[present + 1]),
        psd,
        np.maximum(psd + together, 0.0),
        np.maximum(psd - together, 0.0),
        relative * 0.5 * (1.0 + np.outer(gamma, gamma)),
        2.0 / np.diag(relative),
        n[good],
        of_band,
        order[good].astype(float),
        np.ones(good.sum()) if even else _interpolated(n[good], steps, waviness),
    )


def _interpolated(n: Array, steps: Array, waviness: float) -> Array:
    """Share of the power at wavenumbers that linear interpolation of points so far apart shows.

    It is the convolution of samples with a triangle as wide as two steps h, ``sinc^4(n h)`` of the power, to which all
    that the samples fold onto n is added: ``sum_k G(n + k/h)``. For waviness 2, ``sinc^2(n h)``, and of uneven steps
    exactly the mean over all, each weighted by its length, as the slopes between points are then uncorrelated.
    """
    lengths, edges = np.histogram(steps, STEPS, weights=steps)
    lengths, widths = lengths[lengths > 0.0], (0.5 * (edges[1:] + edges[:-1]))[lengths > 0.0]
    u = np.linspace(1e-3, 0.999, NODES)
    shown = np.sinc(u) ** 4 * u**waviness * (zeta(waviness, u) + zeta(waviness, 1.0 - u))
    return np.asarray(np.interp(np.outer(n, widths), u, shown) @ (lengths / lengths.sum()))


def _relative_covariance(order: NDArray[np.int_], of_band: NDArray[np.int_], points: int, segments: int) -> Array:
    """Covariance of band means of Welch's estimate of a flat spectrum of 1, Gaussian, segments half overlapping.

    Harmonics d apart are related by ``|sum h_k h_l exp(-2 pi j d s / N)|^2`` of the windows of each pair of segments,
    of which only neighbours overlap.
    """
    s = np.arange(512) / 512.0
    window = np.sin(np.pi * s) ** 2
    own = np.abs(np.fft.fft(window**2)) ** 2
    shared = np.abs(np.fft.fft(np.where(s < 0.5, window * np.roll(window, 256), 0.0))) ** 2
    related = (segments * own + 2.0 * (segments - 1) * shared) / (segments**2 * own[0])
    bands = of_band[-1] + 1
    total = np.zeros((bands, bands))
    for apart in range(min(RELATED, len(order) - 1) + 1):
        pairs = order[apart:] - order[: len(order) - apart] == apart
        first, second = of_band[: len(order) - apart][pairs], of_band[apart:][pairs]
        np.add.at(total, (first, second), related[apart])
        if apart:
            np.add.at(total, (second, first), related[apart])
    sizes = np.bincount(of_band)
    return total / np.outer(sizes, sizes)
