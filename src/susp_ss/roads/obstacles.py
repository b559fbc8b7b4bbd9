"""Obstacles as profiles: kerb, ramp, bump, speed table, pothole, plank and swept sine."""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from ..quantities import briefly, positive
from .profiles import MOST_POINTS, profile_of

Array = NDArray[np.float64]

TRACKS = ("both", "left", "right")

# Points that a wave needs at least, for heights that are linear between them.
WAVE = 10


class Kind(NamedTuple):
    """Heights over the distance from an obstacle's begin, and what they are made of unless the caller says otherwise.

    ``heights`` of the distance (P,), height, length and what else shapes it: ``edge``, the length of each slope, or
    ``wavelengths``, from where to where they are swept.
    """

    heights: Callable[..., Array]
    height: float
    length: float
    edge: float | None = None
    wavelengths: tuple[float, float] | None = None


def _rise(x: Array, height: float, length: float) -> Array:
    return np.interp(x, [0.0, length], [0.0, height])


def _haversine(x: Array, height: float, length: float) -> Array:
    return 0.5 * height * (1.0 - np.cos(2.0 * np.pi * np.clip(x / length, 0.0, 1.0)))


def _raised(x: Array, height: float, length: float, edge: float) -> Array:
    return np.interp(x, [0.0, edge, length - edge, length], [0.0, height, height, 0.0])


def _lowered(x: Array, height: float, length: float, edge: float) -> Array:
    return -_raised(x, height, length, edge)


def _swept(x: Array, height: float, length: float, wavelengths: tuple[float, float]) -> Array:
    """Waves whose number grows by the same factor a metre, up to the last whole one."""
    first, last = (1.0 / wavelength for wavelength in wavelengths)
    growth = np.log(last / first) / length
    waves = first / growth * np.expm1(growth * np.clip(x, 0.0, length))
    whole = np.floor(first / growth * np.expm1(growth * length))
    return height * np.sin(2.0 * np.pi * np.minimum(waves, whole))


STEP = 0.01
"""In m, than which points are no further apart."""

KINDS = {
    "kerb": Kind(_rise, 0.1, 0.05),
    "ramp": Kind(_rise, 0.1, 1.0),
    "bump": Kind(_haversine, 0.1, 1.0),
    "speed table": Kind(_raised, 0.075, 6.7, edge=1.8),
    "pothole": Kind(_lowered, 0.05, 0.6, edge=0.05),
    "plank": Kind(_raised, 0.025, 0.2, edge=0.02),
    "swept sine": Kind(_swept, 0.01, 100.0, wavelengths=(10.0, 0.5)),
}


def obstacle(
    kind: str,
    height: float | None = None,
    length: float | None = None,
    *,
    edge: float | None = None,
    wavelengths: tuple[float, float] | None = None,
    track: str = "both",
    before: float = 5.0,
    after: float = 30.0,
    step: float = STEP,
) -> xr.Dataset:
    """Return the profile of a level road with one obstacle.

    ============  ==========================================================  =======  =======  =================
    kind          shape                                                       height   length   further
    ============  ==========================================================  =======  =======  =================
    kerb          rises by the height over the length, and stays up           0.1 m    0.05 m
    ramp          as a kerb                                                   0.1 m    1 m
    bump          haversine, ``height/2 (1 - cos(2 pi x / length))``          0.1 m    1 m
    speed table   up and down over an edge at either end, level in between    0.075 m  6.7 m    edge 1.8 m
    pothole       down and up over an edge at either end, level in between    0.05 m   0.6 m    edge 0.05 m
    plank         as a speed table                                            0.025 m  0.2 m    edge 0.02 m
    swept sine    waves of amplitude height, their number a metre growing     0.01 m   100 m    from 10 to 0.5 m
                  by the same factor a metre, up to the last whole one
    ============  ==========================================================  =======  =======  =================

    Parameters
    ----------
    kind : str
        One of these.
    height, length : float, optional
        In m, > 0; of a pothole its depth. The length is the whole length, edges included.
    edge : float, optional
        Length of each slope in m, at most half of the length: a tyre climbs no vertical wall.
    wavelengths : (float, float), optional
        First and last wavelength of a swept sine in m, falling.
    track : {"both", "left", "right"}
        Which track has it; the other is level.
    before, after : float
        Metres of level road before and after it.
    step : float
        Points in m are no further apart than this; every corner is one.

    Returns
    -------
    xarray.Dataset
        ``left`` and ``right`` in m on ``x`` in m, from 0 on; the obstacle in the attributes.

    Raises
    ------
    TypeError, ValueError
        An unknown kind or track, a number that is not > 0 and finite, edges longer than the obstacle, an edge or
        wavelengths of a kind that has none, wavelengths that do not fall or are shorter than ten steps.

    Examples
    --------
    >>> import susp_ss as ss
    >>> pothole = ss.obstacle("pothole", height=0.06, length=0.8, track="right")
    >>> float(pothole.right.min()), float(pothole.left.min()), float(pothole.x.max())
    (-0.06, 0.0, 35.8)
    >>> ride = ss.simulate(ss.FullCar(), pothole, speed=10.0)
    >>> bool(abs(ride.sws.sel(corner="fr")).max() > abs(ride.sws.sel(corner="fl")).max())
    True
    """
    if not isinstance(track, str) or track not in TRACKS:
        raise ValueError(f"track must be one of {', '.join(TRACKS)}, got {briefly(track)}")
    further = {"edge": edge, "wavelengths": wavelengths, "step": step}
    x, heights, shape = outline(kind, height, length, before, after, **further)
    left, right = (heights if track in ("both", side) else np.zeros_like(x) for side in ("left", "right"))
    return profile_of(x, left, right, {"obstacle": kind, **shape, "track": track})


def outline(
    kind: str,
    height: Any,
    length: Any,
    before: Any,
    after: Any,
    *,
    edge: Any = None,
    wavelengths: Any = None,
    step: Any = STEP,
) -> tuple[Array, Array, dict[str, Any]]:
    """Points x and heights (P,) in m of the track that has an `obstacle`, and what shapes it."""
    if not isinstance(kind, str) or kind not in KINDS:
        raise ValueError(f"kind must be one of {', '.join(KINDS)}, got {briefly(kind)}")
    usual = KINDS[kind]
    shape = {
        name: positive(name, getattr(usual, name) if value is None else value, "m")
        for name, value in {"height": height, "length": length}.items()
    }
    before, after, step = (
        positive(name, value, "m") for name, value in {"before": before, "after": after, "step": step}.items()
    )
    further = _further(kind, shape["length"], step, edge, wavelengths)
    whole = before + shape["length"] + after
    if whole / step > MOST_POINTS:
        raise ValueError(f"step must make at most {MOST_POINTS:.0e} points of {whole:g} m, got {step:g} m")
    corners = {
        0.0,
        shape["length"],
        *({further["edge"], shape["length"] - further["edge"]} if "edge" in further else ()),
    }
    x = _through([-before, *sorted(corners), shape["length"] + after], step)
    shape |= further
    return x + before, usual.heights(x, **shape), shape


def _further(kind: str, length: float, step: float, edge: Any, wavelengths: Any) -> dict[str, Any]:
    """What shapes a kind beside its height and length, checked."""
    usual = KINDS[kind]
    for name, value in {"edge": edge, "wavelengths": wavelengths}.items():
        if value is not None and getattr(usual, name) is None:
            having = ", ".join(other for other, one in KINDS.items() if getattr(one, name) is not None)
            raise ValueError(f"{name} is for {having}, and a {kind} has none, got {briefly(value)}")
    if usual.edge is not None:
        edge = min(usual.edge, 0.5 * length) if edge is None else positive("edge", edge, "m")
        if 2.0 * edge > length:
            raise ValueError(f"edge must be at most half of the length of {length:g} m, got {edge:g} m")
        return {"edge": edge}
    if usual.wavelengths is None:
        return {}
    given = usual.wavelengths if wavelengths is None else wavelengths
    if not isinstance(given, (tuple, list)) or len(given) != 2:
        raise TypeError(f"wavelengths must be two numbers in m such as (10.0, 0.5), got {briefly(given)}")
    first, last = (positive("wavelengths", one, "m") for one in given)
    if not last < first <= length:
        raise ValueError(f"wavelengths must fall and start within the {length:g} m, got {first:g} to {last:g} m")
    if last < WAVE * step:
        raise ValueError(f"wavelengths must be {WAVE} steps or more, got {last:g} m by steps of {step:g} m")
    return {"wavelengths": (first, last)}


def _through(corners: list[float], step: float) -> Array:
    """Points at the corners and between them, evenly and no further apart than a step."""
    parts = [
        np.linspace(start, end, int(np.ceil((end - start) / step - 1e-9)), endpoint=False)
        for start, end in pairwise(corners)
    ]
    return np.concatenate([*parts, corners[-1:]])
