"""Road profiles as functions of time: Gaussian realisations of a `Road` under any set of wheels."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.special import zeta

from .road import Road

# Images of a folded spectrum that are added up one by one.
IMAGES = 32


def synthesise(
    road: Road,
    duration: float,
    step: float,
    *,
    sides: Sequence[int] = (0,),
    delays: Sequence[float] = (0.0,),
    track_width: float = 0.0,
    seed: int | np.random.SeedSequence | np.random.Generator = 0,
) -> NDArray[np.float64]:
    """Draw one Gaussian realisation of the road height under each wheel.

    The profile is a sum of harmonics of ``1/duration`` with independent complex Gaussian amplitudes; it is periodic,
    and delayed wheels see it shifted around. The spectrum is folded at the sampling frequency, ``sum_k G(f + k f_s)``,
    so that the samples have the second moments of samples of the continuous road.

    Parameters
    ----------
    road : Road
    duration, step : float
        Length of the record and sampling interval in s.
    sides : sequence of int
        For each wheel -1 (right), +1 (left) or 0 (centre line).
    delays : sequence of float
        For each wheel how long after the first axle it meets the profile, in s.
    track_width : float
        Distance of the tracks in m.
    seed : int, SeedSequence or Generator

    Returns
    -------
    ndarray, shape (wheels, samples)
        Heights in m at ``step * arange(samples)``; the number of samples is even.

    Examples
    --------
    >>> from susp_ss import Road
    >>> from susp_ss.roads import synthesise
    >>> left, right = synthesise(Road(tracks="isotropic"), 20.0, 0.005, sides=(1, -1), delays=(0, 0), track_width=1.4)
    >>> left.shape
    (4000,)
    """
    samples = 2 * max(1, round(duration / (2.0 * step)))
    rng = np.random.default_rng(seed)
    frequency = np.arange(1, samples // 2 + 1) / (samples * step)
    density = _folded(road, frequency, 1.0 / step)
    apart = road.incoherence(frequency / road.speed, track_width)
    two_tracks = road.tracks != "identical" and any(sides)

    def amplitudes(share: NDArray | float) -> NDArray:
        gaussian = rng.standard_normal((2, len(frequency)))
        return np.sqrt(share * density / (samples * step)) * (gaussian[0] + 1j * gaussian[1])

    mean = amplitudes(0.5 * (2.0 - apart) if two_tracks else 1.0)
    half_difference = amplitudes(0.5 * apart) if two_tracks else np.zeros_like(mean)

    profiles = np.empty((len(sides), samples))
    for profile, side, delay in zip(profiles, sides, delays, strict=True):
        spectrum = (mean + side * half_difference) * np.exp(-2j * np.pi * frequency * delay)
        profile[:] = np.fft.irfft(np.concatenate([[0.0], 0.5 * samples * spectrum]), samples)
    return profiles


def _folded(road: Road, frequency: NDArray, sampling: float) -> NDArray:
    """One-sided density in m^2/Hz of the sampled height: the road's own, and all that folds onto it."""

    def density(f: NDArray) -> NDArray:
        return np.asarray(road.psd(f / road.speed) / road.speed)

    x = np.minimum(frequency / sampling, 0.5)
    near = [density(sampling * image) for k in range(1, IMAGES + 1) for image in (k + x, k - x)]
    # Further up the spectrum is a power of frequency, the sum over whose images is Hurwitz's zeta function.
    power = road.slopes[1] + (2.0 if road.contact_length else 0.0)
    scale = density(np.array(IMAGES * sampling)) * IMAGES**power
    return density(frequency) + sum(near) + scale * (zeta(power, IMAGES + 1.0 + x) + zeta(power, IMAGES + 1.0 - x))
