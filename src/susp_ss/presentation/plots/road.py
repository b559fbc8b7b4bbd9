"""Spectra of roads and profiles on the chart of ISO 8608."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import matplotlib as mpl
import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ...quantities import briefly
from ...roads.profile_spectra import HIGHEST, LOWEST
from ...roads.road import CLASSES, REFERENCE_WAVENUMBER, Road
from ...roads.road_fit import spectrum_of
from .style import COLUMN, STYLE, add_grid, add_legend, panels, styled

# What the chart shows beyond the range that ISO 8608 fits, as a factor.
MARGIN = 1.6

# Letters stand on what lies behind them.
IN_THE_MIDDLE: Any = {"ha": "center", "va": "center", "bbox": {"facecolor": "white", "linewidth": 0.0, "pad": 0.5}}

Drawn = Road | xr.Dataset


def road_chart(roads: Drawn | Mapping[str, Drawn], ax: Any = None) -> Figure:
    """Spectra over wavenumber among the classes of ISO 8608.

    A class lies between half and twice its geometric mean; its letter stands in the middle.

    Parameters
    ----------
    roads : Road, profile, or mapping of str to them
        For each legend entry a `Road`, as a line; a profile (``left`` and ``right`` on ``x``), its spectrum smoothed in
        the bands of ISO 8608 with their confidence; or the road of `fit_road`, as the line over its profile's spectrum.
        At most four.
    ax : Axes, optional

    Returns
    -------
    matplotlib.figure.Figure
        It fits a column of text.

    Raises
    ------
    TypeError, ValueError
        None of these, or a profile that has no spectrum: see `fit_road`.

    Examples
    --------
    >>> import susp_ss as ss
    >>> from susp_ss import plots
    >>> profile = ss.synthesise(ss.Road.iso8608("B"), 1000.0, 0.1)
    >>> figure = plots.road_chart({"measured": profile, "class B": ss.Road.iso8608("B")})
    >>> figure.axes[0].get_xlabel()
    'wavenumber (cycle/m)'
    """
    entries = roads if isinstance(roads, Mapping) and not isinstance(roads, xr.Dataset) else {"": roads}
    if not entries:
        raise ValueError("roads must have at least one entry, got none")
    for drawn in entries.values():
        if isinstance(drawn, Road):
            drawn.single("road_chart()")
        elif not isinstance(drawn, xr.Dataset):
            raise TypeError(f"roads must be Roads or profiles, got {briefly(drawn)}")
    with mpl.rc_context(STYLE):
        figure, axes = panels(ax, 1, 1, (COLUMN, 3.2))
        here = axes[0, 0]
        n = np.geomspace(LOWEST / MARGIN, HIGHEST * MARGIN, 200)
        _add_classes(here, n)
        for drawn, style in styled(entries):
            bands = spectrum_of(drawn) if isinstance(drawn, xr.Dataset) else getattr(drawn, "spectrum", None)
            if bands is not None:
                _add_bands(here, bands, style, alone=isinstance(drawn, xr.Dataset))
            if isinstance(drawn, Road):
                here.loglog(n, drawn.psd(n), **style)
        here.set(xlabel="wavenumber (cycle/m)", ylabel="$G_d$ (m³)", xlim=(n[0], n[-1]))
        add_grid(here)
        if list(entries) != [""]:
            add_legend(figure, here, inside=ax is not None, columns=2)
    return figure


def _add_classes(axes: Axes, n: np.ndarray) -> None:
    """Limits of the classes, and their letters at the right."""
    falling = (n / REFERENCE_WAVENUMBER) ** -2.0
    for mean in list(CLASSES.values())[:-1]:
        axes.loglog(n, 2.0 * mean * falling, color="0.6", linewidth=0.6)
    at = HIGHEST * MARGIN**0.5
    for name, mean in CLASSES.items():
        height = mean * (at / REFERENCE_WAVENUMBER) ** -2.0
        axes.text(at, height, name, color="0.4", fontsize="small", clip_on=True, zorder=5, **IN_THE_MIDDLE)


def _add_bands(axes: Axes, bands: xr.Dataset, style: dict[str, Any], alone: bool) -> None:
    """A smoothed spectrum with its confidence; its points are named in the legend where no line is."""
    label = style["label"] if alone else None
    n, colour = bands.wavenumber, style["color"]
    axes.fill_between(n, bands.psd_low, bands.psd_high, color=colour, alpha=0.2, linewidth=0.0)
    axes.loglog(n, bands.psd, color=colour, marker=".", markersize=2.5, linewidth=0.4, label=label)
