"""A road from a measured profile: its spectrum by weighted least squares, how its tracks relate, how sure that is."""

from __future__ import annotations

from dataclasses import dataclass, field, fields
from typing import Any, NamedTuple

import numpy as np
import xarray as xr
from numpy.typing import NDArray
from scipy.stats import norm

from ..quantities import briefly, positive
from .profile_spectra import EQUAL, FIRST, Bands, bands_of
from .profiles import TRACK_WIDTH, checked_tracks
from .road import CLASSES, REFERENCE_WAVENUMBER, TRACKS, Road

Array = NDArray[np.float64]

# Bands that a slope and a level need, to tell how far the spectrum scatters about them.
LEAST_BANDS = 5

# How much smaller the deviance must be with a second slope, in units of the scatter: a knee that is sought where it
# fits best gains this by chance once in some hundred profiles.
SECOND_SLOPE = 14.0

# What interpolation does to uneven steps hangs on the waviness, which is fitted again so many times, within these.
PASSES, WAVINESS = 3, (1.05, 3.95)

# Knees that the search starts from; the step of derivatives, where iterations settle, and the most of them.
KNEES, STEP, SETTLED, ITERATIONS = 10, 1e-5, 1e-5, 30


@dataclass(frozen=True)
class FittedRoad(Road):
    """A `Road` that was fitted to a profile by `fit_road`, and what the profile says of it.

    Parameters
    ----------
    intervals : dict of str to (float, float)
        Confidence intervals of ``roughness`` (m^3) and ``waviness``; with two slopes ``waviness_below`` and
        ``waviness_above`` the ``knee`` (cycle/m).
    confidence : float
        Of all intervals.
    scatter : float
        How far the bands scatter about the fit in terms of what a Gaussian road's would, at least 1; intervals are so
        many times wider.
    spectrum : xarray.Dataset
        On ``wavenumber``, the middles of the bands of ISO 8608, in cycle/m: ``psd`` (m^3), the mean of both tracks',
        and ``coherence``, each with ``_low`` and ``_high``.
    """

    intervals: dict[str, tuple[float, float]] = field(default_factory=dict, compare=False, repr=False)
    confidence: float = field(default=0.95, compare=False, repr=False)
    scatter: float = field(default=1.0, compare=False, repr=False)
    spectrum: xr.Dataset | None = field(default=None, compare=False, repr=False)

    @property
    def iso_class(self) -> str:
        """The ISO 8608 class, A to H, whose geometric mean of ``G_d(n0)`` is nearest, as a ratio.

        Its limits are half and twice that mean; A has no lower and H no upper one.
        """
        return iso_class(float(self.roughness))


def unfitted(road: Road) -> Road:
    """The same road without what a fit says of it; any other as it is.

    Examples
    --------
    >>> import susp_ss as ss
    >>> from susp_ss.roads.road_fit import unfitted
    >>> unfitted(ss.FittedRoad(speed=30.0)) == ss.Road(speed=30.0)
    True
    """
    if not isinstance(road, FittedRoad):
        return road
    return Road(**{parameter.name: getattr(road, parameter.name) for parameter in fields(Road)})


def iso_class(roughness: float) -> str:
    """Class of a ``G_d(n0)`` in m^3, A to H, between half and twice its geometric mean.

    Examples
    --------
    >>> from susp_ss.roads.road_fit import iso_class
    >>> iso_class(31e-6), iso_class(33e-6)
    ('A', 'B')
    """
    nearest = round(np.log(roughness / CLASSES["A"]) / np.log(4.0))
    return list(CLASSES)[min(max(nearest, 0), len(CLASSES) - 1)]


def fit_road(
    profile: xr.Dataset, *, confidence: float = 0.95, track_width: float | None = None, **parameters: Any
) -> FittedRoad:
    """Return the road whose spectrum and tracks come nearest to a profile's.

    Welch's estimate (Hann window, half overlapping segments of 700 m or what there is, trends taken off) of both tracks
    is smoothed in the bands of ISO 8608, octaves, thirds and twelfths of one, from 0.011 to 2.83 cycle/m or as far as
    the profile reaches: from eight waves along a segment to 0.4 waves a step. To these bands a power of the wavenumber
    is fitted by iterated least squares of the relative error, weighted by the inverse of its covariance; two powers
    with a knee where they come nearer than chance would. Of a profile with uneven steps the spectrum is that of linear
    interpolation, corrected for what it takes.

    Parameters
    ----------
    profile : xarray.Dataset
        ``left`` and ``right`` in m on ``x`` in m, evenly spaced or not, 100 m or longer.
    confidence : float
        Of the intervals, between 0 and 1.
    track_width : float, optional
        Distance of the tracks in m; what the profile's attributes say, or 1.446.
    **parameters
        Any parameter of `Road` that is not fitted: ``speed`` and so on; ``tracks`` to say how they relate.

    Returns
    -------
    FittedRoad
        A `Road`, with ``intervals``, ``iso_class`` and ``spectrum``. ``tracks`` is identical, independent or isotropic,
        whichever coherence is nearest to the profile's; one track that stands for both makes them identical.

    Raises
    ------
    TypeError, ValueError
        No profile, a level one, one too short or too coarse, a parameter that is fitted.

    Notes
    -----
    Intervals are those of a Gaussian road's sample, ``1.96 sqrt(diag((X' V^-1 X)^-1))`` times ``FittedRoad.scatter``,
    since measured spectra scatter by more than that: patches and joints are no part of a homogeneous road.

    Examples
    --------
    >>> import susp_ss as ss
    >>> truth = ss.Road(roughness=100e-6, waviness=2.3, tracks="isotropic")
    >>> road = ss.fit_road(ss.synthesise(truth, 5000.0, 0.1, seed=1))
    >>> road.iso_class, road.tracks, round(road.waviness, 1)
    ('B', 'isotropic', 2.3)
    >>> low, high = road.intervals["roughness"]
    >>> bool(low < 100e-6 < high)
    True
    """
    x, tracks = checked_tracks(profile)
    for name in ("roughness", "waviness", "table", "cutoff"):
        if name in parameters:
            raise ValueError(f"fit_road fits the surface and takes no {name}; replace it in the road that it returns")
    if not positive("confidence", confidence, "and < 1") < 1.0:
        raise ValueError(f"confidence must be > 0 and < 1, got {briefly(confidence)}")
    told = profile.attrs.get("track_width", TRACK_WIDTH) if track_width is None else track_width
    width = positive("track_width", told, "m")
    bands = _usable(x, tracks)
    best = _best(bands)
    if np.any(bands.kept != 1.0):
        for _ in range(PASSES):
            bands = _usable(x, tracks, float(np.clip(best.theta[-1 if len(best.theta) == 2 else 2], *WAVINESS)))
            best = _best(bands)
    outside = [w for w in best.theta[1:3] if not 1.0 < w < 4.0]
    if outside:
        raise ValueError(
            f"profile has a spectrum that falls as n^-w with w = {outside[0]:.2g}, and a road's waviness is > 1 and < "
            "4; is it a road's height, in m over m?"
        )
    surface = best.surface()
    if parameters.get("tracks") is None:
        parameters["tracks"] = _nearest_tracks(bands, tracks, surface, width)
    return FittedRoad(
        **surface,
        **parameters,
        intervals=best.intervals(confidence),
        confidence=confidence,
        scatter=best.scatter,
        spectrum=_labelled(bands, confidence).assign_attrs(track_width=width),
    )


def spectrum_of(profile: xr.Dataset, confidence: float = 0.95) -> xr.Dataset:
    """Spectrum and coherence of a profile in the bands of ISO 8608, as `FittedRoad` has it.

    Raises
    ------
    TypeError, ValueError
        No profile, a level one, one too short or too coarse.
    """
    return _labelled(_usable(*checked_tracks(profile)), confidence)


class Fit(NamedTuple):
    """Parameters ``ln G_d(n0)``, exponent or exponents and ``ln`` of the knee over n0, and how far the bands are off.

    ``deviance`` is ``sum nu (P/mu - 1 - ln(P/mu))`` over bands of nu degrees of freedom; about one a band where only
    chance is at work.
    """

    theta: Array
    covariance: Array
    deviance: float
    spare: int

    @property
    def scatter(self) -> float:
        """See `FittedRoad`."""
        return float(np.sqrt(max(1.0, self.deviance / self.spare)))

    def intervals(self, confidence: float) -> dict[str, tuple[float, float]]:
        """Intervals of the parameters as `FittedRoad` names them."""
        off = norm.ppf(0.5 + 0.5 * confidence) * self.scatter * np.sqrt(np.diag(self.covariance))
        low, high = self.theta - off, self.theta + off
        names = ("waviness",) if len(self.theta) == 2 else ("waviness_below", "waviness_above")
        found = {"roughness": (float(np.exp(low[0])), float(np.exp(high[0])))}
        found |= {name: (float(low[i]), float(high[i])) for i, name in enumerate(names, 1)}
        if len(self.theta) > 2:
            below, above = (float(REFERENCE_WAVENUMBER * np.exp(end[3])) for end in (low, high))
            found["knee"] = (below, above)
        return found

    def surface(self) -> dict[str, Any]:
        """The parameters of a Road with this spectrum."""
        roughness = float(np.exp(self.theta[0]))
        if len(self.theta) == 2:
            return {"roughness": roughness, "waviness": float(self.theta[1])}
        exponents = (float(self.theta[1]), float(self.theta[2]))
        bent = Road.two_slope(roughness, exponents, float(REFERENCE_WAVENUMBER * np.exp(self.theta[3])))
        return {name: getattr(bent, name) for name in ("roughness", "waviness", "table")}


def _usable(x: Array, tracks: Array, waviness: float = 2.0) -> Bands:
    """The bands of a profile that tells its roughness at 0.1 cycle/m, or a refusal."""
    length, step = float(x[-1] - x[0]), float(np.mean(np.diff(x)))
    if length * REFERENCE_WAVENUMBER < FIRST:
        raise ValueError(
            f"profile must be {FIRST / REFERENCE_WAVENUMBER:g} m or longer to tell the roughness at 0.1 cycle/m, got "
            f"{length:g} m"
        )
    level = tracks - tracks.mean(axis=1, keepdims=True)
    if not np.abs(level).max() > 1e-12 * np.abs(tracks).max():
        raise ValueError("profile must not be level")
    bands = bands_of(x, tracks, waviness)
    if bands is None or len(bands.psd) < LEAST_BANDS or bands.centre[-1] < 2.0 * REFERENCE_WAVENUMBER:
        raise ValueError(f"profile must have points every metre or closer to tell its spectrum, got {step:g} m apart")
    return bands


def _best(bands: Bands) -> Fit:
    """One power of the wavenumber, or two where they come nearer than chance would."""
    one = _fitted(bands, np.array([np.log(bands.psd.mean()), 2.0]))
    if len(bands.psd) < 3 * LEAST_BANDS:
        return one
    inner = np.log(bands.centre[[1, -2]] / REFERENCE_WAVENUMBER)
    starts = [np.append(one.theta[[0, 1, 1]], knee) for knee in np.linspace(inner[0], inner[1], KNEES)]
    held = min((_fitted(bands, start, held=1) for start in starts), key=lambda fit: fit.deviance)
    two = _fitted(bands, held.theta)
    within = inner[0] < two.theta[3] < inner[1]
    return two if within and one.deviance - two.deviance > SECOND_SLOPE * two.scatter**2 else one


def _log_density(theta: Array, u: Array) -> Array:
    """``ln G_d`` over ``u = ln(n / n0)``."""
    if len(theta) == 2:
        return np.asarray(theta[0] - theta[1] * u)
    level, below, above, knee = theta

    def fallen(u: Any) -> Any:
        return below * np.minimum(u, knee) + above * np.maximum(u - knee, 0.0)

    return np.asarray(level - fallen(u) + fallen(0.0))


def _fitted(bands: Bands, theta: Array, held: int = 0) -> Fit:
    """Least squares of the relative error of the bands from a start, the last parameters ``held``."""
    u = np.log(bands.harmonics / REFERENCE_WAVENUMBER)
    weight = np.linalg.inv(bands.covariance)
    free = len(theta) - held

    def expected(theta: Array) -> Array:
        steepness = np.where(u < theta[3], theta[1], theta[2]) if len(theta) > 2 else theta[1]
        return bands.mean(np.exp(_log_density(theta, u)), steepness)

    for _ in range(ITERATIONS):
        mean = expected(theta)
        columns = [(expected(theta + STEP * unit) / mean - 1.0) / STEP for unit in np.eye(len(theta))[:free]]
        X = np.stack(columns, axis=1)
        normal = X.T @ weight @ X
        change = np.linalg.lstsq(normal, X.T @ weight @ (bands.psd / mean - 1.0), rcond=None)[0]
        change = np.clip(change, -1.0, 1.0)
        theta = theta + np.append(change, np.zeros(held))
        if np.abs(change).max() < SETTLED:
            break
    ratio = bands.psd / expected(theta)
    freedom = 2.0 / np.diag(bands.covariance)
    deviance = float(np.sum(freedom * (ratio - 1.0 - np.log(ratio))))
    return Fit(theta, np.asarray(np.linalg.pinv(normal), dtype=float), deviance, len(ratio) - len(theta))


def _nearest_tracks(bands: Bands, tracks: Array, surface: dict[str, Any], width: float) -> str:
    """How tracks relate: by the sum of squared differences of the coherence, each by its degrees of freedom."""
    if np.array_equal(*tracks):
        return "identical"

    def off(name: Any) -> float:
        gamma = Road(**surface, tracks=name).coherence(bands.centre, width)
        return float(np.sum(bands.freedom * (bands.coherence - gamma) ** 2))

    return min(TRACKS, key=off)


def _labelled(bands: Bands, confidence: float) -> xr.Dataset:
    """Spectrum and coherence at the middles of the bands, with their intervals."""
    even = (bands.harmonics / REFERENCE_WAVENUMBER) ** -EQUAL
    scale = (bands.centre / REFERENCE_WAVENUMBER) ** -EQUAL / bands.mean(even, EQUAL)
    rows = {"psd": scale * bands.psd, "coherence": bands.coherence}
    ends = {"psd": [scale * end for end in bands.psd_interval(confidence)]}
    ends["coherence"] = list(bands.coherence_interval(confidence))
    units = {"psd": ("m^3", "spectrum of one track"), "coherence": ("", "coherence of the tracks")}
    labelled = {
        name + suffix: ("wavenumber", values, {"units": units[name][0], "long_name": units[name][1]})
        for name in rows
        for suffix, values in (("", rows[name]), ("_low", ends[name][0]), ("_high", ends[name][1]))
    }
    wavenumber = ("wavenumber", bands.centre, {"units": "cycle/m", "long_name": "wavenumber"})
    return xr.Dataset(labelled, {"wavenumber": wavenumber}, {"confidence": confidence})
