"""Magnitudes over frequency."""

from __future__ import annotations

from collections.abc import Mapping

import matplotlib as mpl
import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from ..published import LABELS
from ..responses import frequency_response
from ..vehicles import FullCar, QuarterCar
from .style import LINES, STYLE, WIDTH, new_figure

GAINS = {"bacc": ("BAcc / road", "(m/s²)/m"), "dtl": ("DTL / road", "N/m"), "sws": ("SWS / road", "m/m")}


def bode_magnitude(curves: Mapping[str, xr.DataArray]) -> Figure:
    """Magnitude over frequency of the three criteria per metre of road height.

    Parameters
    ----------
    curves : mapping of str to DataArray
        For each legend entry a response on dims ``criterion`` (bacc, dtl, sws) and ``frequency`` (Hz), complex or not.

    Returns
    -------
    matplotlib.figure.Figure

    Examples
    --------
    >>> from susp_ss.plots import bode_magnitude, study_curves
    >>> figure = bode_magnitude(study_curves("fr"))
    >>> figure.axes[2].get_ylabel()
    '|SWS / road| (m/m)'
    """
    with mpl.rc_context(STYLE):
        figure = new_figure(WIDTH, 2.7, layout="constrained")
        panels = figure.subplots(1, 3)
        for axes, (criterion, (label, unit)) in zip(panels, GAINS.items(), strict=True):
            for (name, curve), (colour, dashes) in zip(curves.items(), LINES, strict=False):
                gain = np.abs(curve.sel(criterion=criterion))
                axes.loglog(curve.frequency, gain, color=colour, linestyle=dashes, linewidth=1.2, label=name)
            axes.set_xlabel("frequency (Hz)")
            axes.set_ylabel(f"|{label}| ({unit})")
            axes.grid(which="major", linewidth=0.4, color="0.8")
        handles, labels = panels[0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside lower center", ncols=3, frameon=False, handlelength=3.0)
    return figure


def study_curves(corner: str) -> dict[str, xr.DataArray]:
    """Responses of both models of the study for `bode_magnitude`, with the middle spring and damper of Table 2.

    The full car is measured at ``corner``, once with the road under all four wheels in phase, once with the road
    under that corner's wheel alone.
    """
    frequency = np.geomspace(0.1, 50.0, 400)
    quarter = frequency_response(QuarterCar(), frequency).sel(input="z_r", drop=True)
    full = frequency_response(FullCar(), frequency)
    at_corner = full.sel(output=[f"{criterion}_{corner}" for criterion in LABELS])
    curves = {
        "quarter car": quarter.sel(output=list(LABELS)),
        f"full car at {corner}, all wheels in phase": at_corner.sum("input"),
        f"full car at {corner}, road under {corner} only": at_corner.sel(input=f"z_r_{corner}", drop=True),
    }
    return {name: curve.assign_coords(output=list(LABELS)).rename(output="criterion") for name, curve in curves.items()}
