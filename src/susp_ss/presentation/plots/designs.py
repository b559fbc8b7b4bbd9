"""Designs in the plane of what they achieve."""

from __future__ import annotations

from typing import Any

import matplotlib as mpl
import numpy as np
import xarray as xr
from matplotlib.figure import Figure
from matplotlib.patheffects import withStroke
from numpy.typing import NDArray

from .study import AXES
from .style import COLUMN, LINES, STYLE, add_grid, add_legend, panels, shown

# Grid lines drawn along either design variable, spread over those there are.
MOST_LINES = 6

# Design variable: colour and dashes of its lines.
FAMILIES = {"ks": LINES[1], "cs": LINES[2]}


def carpet(metrics: xr.Dataset, x: str = "dtl", y: str = "bacc", colour: str = "sws", ax: Any = None) -> Figure:
    """One metric against another, with lines of constant spring and of constant damper: a carpet plot.

    Parameters
    ----------
    metrics : Dataset
        On dims ``ks`` and ``cs``, with these as coordinates in SI units: `ride_metrics` of a vehicle whose ``ks``
        and ``cs`` are DataArrays, at one point and one corner.
    x, y, colour : str
        The metrics along the axes, and the one that colours the designs: three of bacc, dtl and sws.
    ax : Axes, optional

    Returns
    -------
    matplotlib.figure.Figure
        At most six lines of either family, each labelled with its value at an end; along them all nodes of the grid
        are used, so that a fine grid makes smooth lines.

    Raises
    ------
    ValueError
        Metrics that are not on ks and cs alone.

    Examples
    --------
    >>> import numpy as np
    >>> import susp_ss as ss
    >>> import xarray as xr
    >>> from susp_ss.presentation.plots import carpet
    >>> ks, cs = (xr.DataArray(v, {name: v}, name) for name, v in {
    ...     "ks": np.linspace(12e3, 25e3, 5), "cs": np.linspace(800.0, 2200.0, 30)}.items())
    >>> figure = carpet(ss.ride_metrics(ss.QuarterCar(ks=ks, cs=cs), ss.Road.iso8608("B", speed=20.0)))
    >>> figure.axes[0].get_xlabel(), figure.axes[1].get_ylabel()
    ('DTL (kN)', 'SWS (mm)')
    """
    fields = {name: _scaled(metrics, name) for name in (x, y, colour)}
    drawn = {name: _spread(metrics.sizes[name]) for name in FAMILIES}
    with mpl.rc_context(STYLE):
        figure, given = panels(ax, 1, 1, (COLUMN, 3.1))
        axes = given[0, 0]
        extent = [np.ptp(fields[name].values) or 1.0 for name in (x, y)]
        for dim, (ink, dashes) in FAMILIES.items():
            axis = shown(dim)
            lines = np.stack([fields[name].isel({dim: drawn[dim]}).transpose(dim, ...) for name in (x, y)], axis=-1)
            axes.plot(*np.moveaxis(lines, -1, 0).swapaxes(1, 2), color=ink, linestyle=dashes, linewidth=0.8)
            axes.plot([], [], color=ink, linestyle=dashes, linewidth=0.8, label=axis.label)
            for line, value in zip(
                _from_wide_end(lines / extent), metrics[dim].values[drawn[dim]] / axis.one, strict=True
            ):
                away = line[0] - line[min(2, len(line) - 1)]
                axes.annotate(
                    f"{value:.3g}",
                    line[0] * extent,
                    xytext=11.0 * away / (np.linalg.norm(away) or 1.0),
                    textcoords="offset points",
                    ha="center",
                    va="center",
                    fontsize=7,
                    color=ink,
                    path_effects=[withStroke(linewidth=2.0, foreground="white")],
                )
        crossings = {name: field.isel(ks=drawn["ks"], cs=drawn["cs"]).values for name, field in fields.items()}
        dots = axes.scatter(crossings[x], crossings[y], c=crossings[colour], cmap="viridis", s=10, zorder=3)
        bar = figure.colorbar(dots, ax=axes)
        bar.set_label(AXES[colour].label)
        axes.set(xlabel=AXES[x].label, ylabel=AXES[y].label)
        axes.margins(0.16)
        add_grid(axes)
        add_legend(figure, axes, inside=ax is not None, columns=2)
    return figure


def _scaled(metrics: xr.Dataset, name: str) -> xr.DataArray:
    if name not in AXES or name not in metrics:
        raise ValueError(f"no metric named {name!r} to draw, available: {', '.join(AXES)}")
    data = metrics[name]
    if set(data.dims) != set(FAMILIES) or not set(FAMILIES) <= set(data.coords):
        raise ValueError(
            f"metrics must lie on the coordinates ks and cs alone, got {name} on {', '.join(map(str, data.dims))}; "
            "select one point and one corner"
        )
    return data.transpose(*FAMILIES) / AXES[name].one


def _spread(count: int) -> NDArray[np.int_]:
    """At most MOST_LINES indices from the first to the last."""
    return np.unique(np.linspace(0, count - 1, min(count, MOST_LINES)).round().astype(int))


def _from_wide_end(lines: NDArray) -> NDArray[np.float64]:
    """Lines (lines, points, 2), turned to start where the nearest neighbours lie farther apart: room for labels."""
    gaps = np.linalg.norm(np.diff(lines[:, [0, -1]], axis=0), axis=-1).min(axis=0, initial=np.inf)
    return lines if gaps[0] >= gaps[1] else lines[:, ::-1]
