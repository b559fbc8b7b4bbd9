"""Road profiles: Gaussian realisations of a `Road` over distance in two tracks, or over time under any wheels."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike, NDArray
from scipy.interpolate import CubicSpline
from scipy.special import zeta

from ..quantities import briefly, positive, whole_number
from .road import Road

Array = NDArray[np.float64]

TRACK_WIDTH = 1.446
"""How far apart tracks are where nothing else says, in m: ``2 c`` of the default car."""

# Images of a folded spectrum that are added up one by one, and the nodes over a spectrum between which their sum, as
# smooth as the spectrum is far up, is linear: to 1e-7 of itself.
IMAGES = 32
FOLD_NODES = 4097

# Nodes a decade between which the coherence of two tracks is a cubic of the logarithms, to 1e-8.
COHERENCE_NODES = 100

MOST_POINTS = 1e8

SIDES = ("left", "right")
"""The tracks of a profile."""


def synthesise(
    road: Road, length: float, step: float, seed: int = 0, *, track_width: float = TRACK_WIDTH
) -> xr.Dataset:
    """Draw one Gaussian realisation of a road as a profile of two tracks.

    The profile is a sum of harmonics of ``1/length`` with independent complex Gaussian amplitudes, so that it is
    periodic. Its spectrum is ``road.psd`` from ``1/length`` up to ``1/(2 step)``, which is its end, and the cross
    spectrum of its tracks that times ``road.coherence``. What `Road` says of speed, delay and wheels does not matter.

    Parameters
    ----------
    road : Road
        Of one speed, roughness and cutoff. With a ``contact_length`` the profile is what such a tyre makes of the
        road.
    length, step : float
        Length of the profile and distance of its points in m; ``length / step`` is rounded to a whole number.
    seed : int
        The same seed draws the same profile.
    track_width : float
        Distance of the tracks in m, > 0: what the coherence of isotropic tracks depends on.

    Returns
    -------
    xarray.Dataset
        ``left`` and ``right`` in m on ``x`` in m, at ``step * arange(length / step)``; the road in the attributes.

    Raises
    ------
    TypeError, ValueError
        No road, or one with arrays; lengths that are not > 0 and finite; fewer than 2 points, or more than 1e8.

    Examples
    --------
    >>> import susp_ss as ss
    >>> profile = ss.synthesise(ss.Road.iso8608("B", tracks="isotropic"), length=1000.0, step=0.05)
    >>> dict(profile.sizes), profile.left.attrs["units"]
    ({'x': 20000}, 'm')
    >>> bool(0.0005 < profile.left.diff("x").std() < 0.001)
    True
    """
    if not isinstance(road, Road):
        raise TypeError(f"road must be a Road, such as Road.iso8608('B'), got {briefly(road)}")
    road.single("synthesise()")
    length, step, track_width = (
        positive(name, value, "m") for name, value in (("length", length), ("step", step), ("track_width", track_width))
    )
    points = round(length / step)
    if not 2 <= points <= MOST_POINTS:
        raise ValueError(
            f"length and step must make 2 points or more, at most {MOST_POINTS:.0e}, got {length:g} m by {step:g} m"
        )
    left, right = _realised(
        road, points, step, (1, -1), (0.0, 0.0), track_width, whole_number("seed", seed, 0), folded=False
    )
    made = {"road": road.describe(), "seed": seed, "track_width": track_width}
    return profile_of(step * np.arange(points, dtype=float), left, right, made)


def profile_of(x: ArrayLike, left: ArrayLike, right: ArrayLike, attributes: dict[str, Any] | None = None) -> xr.Dataset:
    """Two tracks over distance as the Dataset that every function takes as a profile."""
    profile = xr.Dataset(
        {"left": ("x", left, {"units": "m", "long_name": "height of the left track"})}
        | {"right": ("x", right, {"units": "m", "long_name": "height of the right track"})},
        coords={"x": ("x", x, {"units": "m", "long_name": "distance"})},
    )
    return profile.assign_attrs(attributes or {})


def checked_tracks(profile: xr.Dataset) -> tuple[Array, Array]:
    """Points x (P,) and heights (left and right, P) of a profile in m, or say what is wrong with it.

    Raises
    ------
    TypeError, ValueError
        No Dataset, a variable missing, on other dims, no numbers, not in m or not finite; x that does not rise.
    """
    need = "profile must have left and right, heights in m on x"
    if not isinstance(profile, xr.Dataset):
        raise TypeError(
            f"profile must be an xarray.Dataset of left and right, heights in m on x, got {briefly(profile)}"
        )
    for name in ("x", *SIDES):
        if name not in profile.variables:
            raise ValueError(f"{need}, got no {name!r} among {', '.join(map(str, profile.variables))}")
        one = profile[name]
        if one.dims != ("x",) or one.dtype.kind not in "iuf":
            raise ValueError(f"{need}, got {name!r} of {one.dtype} on ({', '.join(map(str, one.dims))})")
        if one.attrs.get("units", "m") != "m":
            raise ValueError(f"{need}, got {name!r} in {one.attrs['units']}")
        bad = np.flatnonzero(~np.isfinite(one.values))
        if bad.size:
            raise ValueError(f"profile must be finite, got {name!r} {one.values[bad[0]]} at point {bad[0]}")
    x = profile["x"].values.astype(float)
    if len(x) < 2:
        raise ValueError(f"profile must have at least two points, got {len(x)}")
    check_rising(x, "profile must have rising x")
    return x, np.stack([profile[name].values.astype(float) for name in SIDES])


def check_rising(x: Array, need: str) -> None:
    """Refuse distances in m that do not rise, by the first point that does not.

    Raises
    ------
    ValueError
        Saying the ``need``.
    """
    back = np.flatnonzero(np.diff(x) <= 0.0)
    if back.size:
        i = int(back[0])
        raise ValueError(f"{need}, got {x[i + 1]:g} m after {x[i]:g} m at point {i + 1}")


def wheel_heights(
    road: Road,
    duration: float,
    step: float,
    *,
    sides: Sequence[int] = (0,),
    delays: Sequence[float] = (0.0,),
    track_width: float = 0.0,
    seed: int | np.random.SeedSequence | np.random.Generator = 0,
) -> Array:
    """Draw one Gaussian realisation of the road height under each wheel over time.

    The same sum of harmonics as `synthesise`, of ``1/duration``; delayed wheels see it shifted around. Its spectrum is
    folded at the sampling frequency, ``sum_k G(f + k f_s)``, so that the samples have the second moments of samples of
    the continuous road.

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
    >>> from susp_ss.roads import wheel_heights
    >>> road = Road(tracks="isotropic")
    >>> left, right = wheel_heights(road, 20.0, 0.005, sides=(1, -1), delays=(0, 0), track_width=1.4)
    >>> left.shape
    (4000,)
    """
    samples = 2 * max(1, round(duration / (2.0 * step)))
    lags = [road.speed * delay for delay in delays]
    return _realised(road, samples, road.speed * step, sides, lags, track_width, seed, folded=True)


def _realised(
    road: Road,
    samples: int,
    step: float,
    sides: Sequence[int],
    lags: Sequence[float],
    track_width: float,
    seed: Any,
    folded: bool,
) -> Array:
    """Heights (sides, samples) in m, ``step`` (m) apart, each lagging by so many metres."""
    rng = np.random.default_rng(seed)
    n = np.arange(1, samples // 2 + 1) / (samples * step)
    power = (_folded(road, n, 1.0 / step) if folded else road.psd(n)) / (samples * step)
    two_tracks = road.tracks != "identical" and any(sides)
    apart = _incoherence(road, n, track_width) if two_tracks else 0.0

    def amplitudes(share: Any) -> NDArray[np.complex128]:
        drawn = rng.standard_normal((2, len(n)))
        return np.sqrt(share * power) * (drawn[0] + 1j * drawn[1])

    mean = amplitudes(1.0 - 0.5 * apart)
    half_difference = amplitudes(0.5 * apart) if two_tracks else 0.0
    heights = np.empty((len(sides), samples))
    spectrum = np.zeros(len(n) + 1, dtype=complex)
    for height, side, lag in zip(heights, sides, lags, strict=True):
        spectrum[1:] = 0.5 * samples * (mean + side * half_difference)
        if lag:
            spectrum[1:] *= np.exp(-2j * np.pi * lag * n)
        height[:] = np.fft.irfft(spectrum, samples)
    return heights


def _incoherence(road: Road, n: Array, track_width: float) -> Any:
    """``1 - gamma`` at many wavenumbers, by cubics of the logarithms where that is less work."""
    nodes = int(COHERENCE_NODES * np.log10(n[-1] / n[0])) + 4
    if len(n) <= nodes:
        return road.incoherence(n, track_width)
    at = np.geomspace(n[0], n[-1], nodes)
    apart = road.incoherence(at, track_width)
    if not np.all(apart > 0.0):
        return road.incoherence(n, track_width)
    return np.exp(CubicSpline(np.log(at), np.log(apart))(np.log(n)))


def _folded(road: Road, n: Array, sampling: float) -> Array:
    """One-sided density in m^3 of the sampled height: the road's own, and all that folds onto it."""
    x = np.linspace(0.0, 0.5, FOLD_NODES)
    near = sum(road.psd(sampling * image) for k in range(1, IMAGES + 1) for image in (k + x, k - x))
    # Further up the spectrum is a power of the wavenumber, the sum over whose images is Hurwitz's zeta function.
    power = road.slopes[1] + (2.0 if road.contact_length else 0.0)
    scale = road.psd(IMAGES * sampling) * IMAGES**power
    far = scale * (zeta(power, IMAGES + 1.0 + x) + zeta(power, IMAGES + 1.0 - x))
    return np.asarray(road.psd(n) + np.interp(n / sampling, x, near + far))
