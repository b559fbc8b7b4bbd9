"""Accelerations in one-third octaves, and the limits that ISO 2631 once set to them."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike, NDArray

from ..quantities import metric_and_place
from ..responses.covariance import linearised
from ..responses.excitation import check_kinds
from ..responses.frequency import psd
from ..roads.road import Road
from ..vehicles.contract import RoadVehicle
from .weightings import filters

BANDS = 10.0 ** (np.arange(-10, 21) / 10.0)
"""Exact centres in Hz of the bands from 0.1 to 100 Hz (IEC 61260-1, base 10)."""

# From a band's centre to its edges, in the logarithm.
HALF = np.log(10.0) / 20.0

# Points of Gauss's rule in each band: the rear axle's delay makes spectra oscillate, at 5 m/s nine times in the last.
NODES = 64

FATIGUE = {
    "25 min": 1.80,
    "1 h": 1.18,
    "4 h": 0.53,
    "8 h": 0.315,
    "24 h": 0.14,
}
"""Vertical RMS acceleration in m/s^2 in a one-third octave from 4 to 8 Hz that decreases proficiency by fatigue within
an exposure (ISO 2631:1974 and ISO 2631-1:1985, table 1)."""

REDUCED_COMFORT = 1.0 / 3.15
"""Share of it that reduces comfort, 10 dB less (the same, 4.1.3)."""


def third_octaves(
    vehicle: RoadVehicle,
    road: Road,
    *,
    weighting: Any = None,
    points: Mapping[str, tuple[float, float]] | None = None,
) -> xr.DataArray:
    """Root mean squares of every output in one-third octaves, from 0.1 to 100 Hz.

    ``sqrt(int |W(f)|^2 S(f) df)`` over each band, between ``10^(-1/20)`` and ``10^(1/20)`` times its centre
    ``10^(n/10)`` Hz (IEC 61260-1).

    Parameters
    ----------
    vehicle, road, weighting, points
        As in `ride_metrics`; arrays make a sweep, and curves are linearised.

    Returns
    -------
    xarray.DataArray
        On (sweep..., output, frequency), in the output's unit, frequency being the bands' centres.

    Raises
    ------
    TypeError, ValueError
        As `ride_metrics`.

    Examples
    --------
    >>> import susp_ss as ss
    >>> felt = ss.third_octaves(ss.QuarterCar(), ss.Road(), weighting="Wk").sel(output="bacc")
    >>> felt.idxmax("frequency").round(1).item()
    10.0
    """
    check_kinds(vehicle, road)
    car: Any = vehicle if points is None else vehicle.with_points(points)
    filtering = filters(weighting, car.layout())
    if car.curved:
        car = linearised(car, road)
    at, share = np.polynomial.legendre.leggauss(NODES)
    f = BANDS[:, None] * np.exp(HALF * at)
    S = psd(car, road, f.ravel())
    through = np.ones((S.sizes["output"], *f.shape))
    for row, name in enumerate(S.output.values.tolist()):
        one = filtering.get(metric_and_place(name)[0])
        if one is not None:
            through[row] = one.power(2.0 * np.pi * f)
    density = S.values.reshape(*S.shape[:-1], *f.shape) * through
    bands = S.isel(frequency=slice(len(BANDS))).assign_coords(frequency=BANDS).rename("third_octaves")
    bands.frequency.attrs = {"units": "Hz", "long_name": "centre of the one-third octave"}
    return bands.copy(data=np.sqrt((density * (HALF * share * f)).sum(axis=-1)))


def reduced_comfort(frequency: ArrayLike, exposure: str) -> NDArray[np.float64]:
    """Vertical acceleration in m/s^2 in one-third octaves from 1 to 80 Hz that reduces comfort within an exposure.

    Least from 4 to 8 Hz; below it falls with the root of frequency, above it rises with frequency (ISO 2631:1974 and
    ISO 2631-1:1985; the standard of 1997 has weightings in place of limits). To be compared with accelerations that are
    not weighted.

    Examples
    --------
    >>> from susp_ss.metrics.third_octaves import reduced_comfort
    >>> reduced_comfort([1.0, 5.0, 80.0], "8 h").round(3).tolist()
    [0.2, 0.1, 1.0]
    """
    f = np.asarray(frequency, dtype=float)
    return REDUCED_COMFORT * FATIGUE[exposure] * np.maximum(np.maximum(2.0 / np.sqrt(f), 1.0), f / 8.0)
