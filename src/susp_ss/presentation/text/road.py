"""A fitted road as text."""

from __future__ import annotations

import numpy as np
import xarray as xr

from ...quantities import briefly
from ...roads.road import CLASSES
from ...roads.road_fit import FittedRoad, unfitted

NAMES = {
    "roughness": ("G_d(0.1 cycle/m)", "m^3"),
    "waviness": ("waviness", ""),
    "waviness_below": ("waviness below the knee", ""),
    "waviness_above": ("waviness above the knee", ""),
    "knee": ("knee", "cycle/m"),
}


def fitted_spectrum(road: FittedRoad) -> xr.Dataset:
    """The spectrum that a road was fitted to.

    Raises
    ------
    ValueError
        A road that no profile was fitted to.
    """
    if road.spectrum is None:
        raise ValueError(f"a fitted road is one of fit_road, got {briefly(road)}")
    return road.spectrum


def fitted_values(road: FittedRoad) -> dict[str, float]:
    """What was fitted, by the names of the road's intervals."""
    if not road.table:
        return {"roughness": float(road.roughness), "waviness": road.waviness}
    below, above = road.slopes
    return {
        "roughness": float(road.roughness),
        "waviness_below": below,
        "waviness_above": above,
        "knee": road.table[0][0],
    }


def fitted_road_text(road: FittedRoad) -> str:
    """What a profile says of its road: class, spectrum and tracks, each with its interval.

    Raises
    ------
    ValueError
        A road that no profile was fitted to.
    """
    bands = fitted_spectrum(road)
    mean = CLASSES[road.iso_class]
    lines = [
        f"ISO 8608 class {road.iso_class}, by the geometric mean of G_d(0.1 cycle/m): {mean:g} m^3; its limits are "
        "half and twice that",
        "",
        f"{'':26}{'value':>12}{f'{road.confidence:.0%} from':>14}{'to':>12}",
    ]
    for name, value in fitted_values(road).items():
        said, unit = NAMES[name]
        low, high = road.intervals[name]
        lines.append(f"{said:26}{value:12.4g}{low:14.4g}{high:12.4g}  {unit}".rstrip())
    n = bands.wavenumber.values
    lines += ["", f"{len(n)} bands from {n[0]:.3g} to {n[-1]:.3g} cycle/m scatter {_scatter(road)}"]
    lines += [f"tracks: {road.tracks}, {_coherent(road)}"]
    return "\n".join(lines)


def _scatter(road: FittedRoad) -> str:
    if road.scatter < 1.005:
        return "about the fit as those of a Gaussian road do"
    return f"about the fit {road.scatter:.2f} times as far as those of a Gaussian road; intervals are so much wider"


def _coherent(road: FittedRoad) -> str:
    """How many bands the coherence of the tracks agrees with."""
    bands = fitted_spectrum(road)
    if np.all(bands.coherence == 1.0):
        return "left and right are the same"
    width = float(bands.attrs["track_width"])
    gamma = unfitted(road).coherence(bands.wavenumber.values, width)
    within = int(np.sum((bands.coherence_low <= gamma) & (gamma <= bands.coherence_high)))
    apart = f" {width:g} m apart" if road.tracks == "isotropic" else ""
    return f"whose coherence{apart} lies within the interval of {within} of {bands.sizes['wavenumber']} bands"
