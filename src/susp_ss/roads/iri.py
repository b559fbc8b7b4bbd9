"""The international roughness index: of a profile, and of a random road."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike, NDArray

from ..quantities import briefly, positive
from ..vehicles.parameters import number_array
from .golden_car import BASE, mean_index, velocities
from .profiles import SIDES, check_rising, checked_tracks
from .road import Road

Array = NDArray[np.float64]

START = 11.0
"""Length in m over which the slope is taken in which the car starts: half a second of driving."""

# In m: what two distances that are meant to be the same may differ by.
SAME = 1e-9

ATTRS = {"units": "m/km", "long_name": "international roughness index"}


def iri(x: ArrayLike | xr.Dataset, elevation: ArrayLike | None = None, segment: float | None = None) -> Any:
    """International roughness index of a profile: what the suspension of the golden car travels per distance.

    A quarter car of given parameters runs at 80 km/h over the profile, taken as straight between its points; the index
    is the mean magnitude of its suspension velocity over its speed (M. W. Sayers, T. D. Gillespie and W. D. O.
    Paterson, *Guidelines for Conducting and Calibrating Road Roughness Measurements*, World Bank Technical Paper 46,
    1986; ASTM E1926). As these say, the slope of every step is that to the point nearest to 250 mm ahead, a moving
    average where points are closer, and the car starts in equilibrium on the mean slope of the first 11 m. The
    state transition of every step is exact.

    Parameters
    ----------
    x : array_like, (P,), or Dataset
        Distances in m, rising, evenly spaced or not; or a profile with variables ``left`` and ``right`` on ``x``.
    elevation : array_like, (P,)
        Heights in m; left out with a profile.
    segment : float, optional
        Length in m of the segments that get an index each, > 0. The car runs on from one to the next.

    Returns
    -------
    float or xarray.DataArray
        In m/km: a number, with ``segment`` on dim "segment", whose coordinate is where each begins, and ``length``
        along with it; of a profile on dim "track" (left, right) as well. What has no average ahead of it, at the end
        of the profile, is left out, so that the last segment may be shorter than the others.

    Raises
    ------
    TypeError, ValueError
        No numbers, rows of different lengths, distances that do not rise, heights that are not finite, less than 11 m
        of profile, or a segment shorter than a step.

    Notes
    -----
    Technical Paper 46 asks for points every 250 mm or closer, and 500 mm for its second class of measurements. 100 km
    every 50 mm take about half a second a track.

    Examples
    --------
    >>> import numpy as np
    >>> from susp_ss import iri
    >>> x = np.arange(0.0, 200.0, 0.1)
    >>> round(iri(x, 0.005 * np.sin(2 * np.pi * x / 15.0)), 2)
    1.99
    >>> iri(x, 0.02 * x, segment=50.0).length.values.round(1).tolist()
    [50.0, 50.0, 50.0, 49.7]
    """
    profile = x if isinstance(x, xr.Dataset) else None
    if profile is not None and elevation is not None:
        raise TypeError("iri: a profile has its own heights; leave elevation out")
    distances, heights = _rows(x, elevation) if profile is None else checked_tracks(profile)
    length = np.ptp(distances) if len(distances) else 0.0
    if length < START - SAME:
        raise ValueError(f"iri needs at least {START:g} m of profile, over which the car starts, got {length:g} m")
    ends, travelled = _travelled(distances, heights)
    edges = ends[[0, -1]] if segment is None else _edges(segment, distances, ends)
    lengths = np.diff(edges)
    found = xr.DataArray(
        np.diff([np.interp(edges, ends, row) for row in travelled]) / lengths,
        {
            "track": list(SIDES[: len(heights)]),
            "segment": ("segment", edges[:-1], {"units": "m"}),
            "length": ("segment", lengths, {"units": "m"}),
        },
        ("track", "segment"),
        "iri",
        ATTRS,
    )
    found = found.isel({} if profile is not None else {"track": 0}, drop=True)
    found = found.isel({} if segment is not None else {"segment": 0}, drop=True)
    return found if found.dims else found.item()


def mean_iri(road: Road) -> Any:
    """Mean international roughness index of a random road, exactly.

    On a Gaussian road the suspension velocity v of the golden car is Gaussian, so that ``E|v| = sqrt(2/pi) sigma``; its
    variance is the integral of the road's spectrum through the car and the moving average over 250 mm. It grows as the
    square root of the roughness, and what `iri` finds on drawn profiles scatters about it.

    Parameters
    ----------
    road : Road
        Any spectrum, with its cut-off and contact. The speed does not matter. A roughness or cut-off that is an array
        makes a sweep.

    Returns
    -------
    float or xarray.DataArray
        In m/km; on the sweep's dims.

    Raises
    ------
    TypeError
        No road.

    Examples
    --------
    >>> from susp_ss import Road, mean_iri
    >>> [round(mean_iri(Road.iso8608(name)), 1) for name in "ABC"]
    [2.2, 4.3, 8.7]
    """
    if not isinstance(road, Road):
        raise TypeError(f"road must be a Road, such as Road.iso8608('B'), got {briefly(road)}")
    mean = mean_index(road)
    return mean.rename("iri").assign_attrs(ATTRS) if isinstance(mean, xr.DataArray) else mean


def _rows(x: Any, elevation: Any) -> tuple[Array, Array]:
    """Distances and heights, one row each."""
    rows = []
    for name, given in {"x": x, "elevation": elevation}.items():
        need = f"iri({name}=...) must be one row of numbers in m"
        row = number_array(given, need)
        if row.ndim != 1:
            raise TypeError(f"{need}, got {briefly(given)}")
        if not np.isfinite(row).all():
            worst = int(np.argmin(np.isfinite(row)))
            raise ValueError(f"iri({name}=...) must be finite, got {row[worst]} at point {worst}")
        rows.append(row.astype(float))
    distances, heights = rows
    if len(heights) != len(distances):
        raise ValueError(f"iri needs one height at each distance, got {len(heights)} at {len(distances)}")
    check_rising(distances, "iri(x=...) must rise")
    return distances, heights[None]


def _travelled(x: Array, heights: Array) -> tuple[Array, Array]:
    """Ends of the steps (S + 1,), and what the suspension has travelled up to each in mm (tracks, S + 1)."""
    # Beyond the last point another one is thought of, so that what is nearest to a place past it is not the last.
    between = np.append(0.5 * (x[1:] + x[:-1]), 1.5 * x[-1] - 0.5 * x[-2])
    ahead = np.maximum(np.searchsorted(between, x + BASE + SAME), np.arange(1, len(x) + 1))
    ahead = ahead[ahead < len(x)]
    S = len(ahead)
    slopes = (heights[:, ahead] - heights[:, :S]) / (x[ahead] - x[:S])
    first = max(1, int(np.searchsorted(between, x[0] + START)))
    started = (heights[:, first] - heights[:, 0]) / (x[first] - x[0])
    steps = np.diff(x[: S + 1])
    # In equilibrium on a slope the suspension rests; what deviates from that slope moves it.
    travel = 1000.0 * np.abs(velocities(steps, slopes - started[:, None])) * steps
    return x[: S + 1], np.pad(np.cumsum(travel, axis=1), [(0, 0), (1, 0)])


def _edges(segment: Any, x: Array, ends: Array) -> Array:
    """Where segments begin, and the last one ends."""
    length, widest = positive("segment", segment), np.diff(x).max()
    if length < widest - SAME:
        raise ValueError(f"segment must be at least a step of the profile, {widest:g} m, got {length:g} m")
    segments = np.ceil((ends[-1] - x[0]) / length - SAME)
    return np.append(x[0] + length * np.arange(segments), ends[-1])
