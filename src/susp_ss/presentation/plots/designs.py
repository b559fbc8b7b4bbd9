"""Designs in the plane of what they achieve."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple

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

# Of labels: their size in points, and where they may stand, so many points from the end of their line and so many
# degrees off its direction; earlier ones first.
SIZE = 7
DISTANCES = (11.0, 15.0, 20.0, 26.0)
TURNS = (0, 30, -30, 60, -60, 90, -90, 120, -120)

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
        families = {
            dim: np.stack([fields[name].isel({dim: drawn[dim]}).transpose(dim, ...) for name in (x, y)], axis=-1)
            for dim in FAMILIES
        }
        for dim, (ink, dashes) in FAMILIES.items():
            lines = np.moveaxis(families[dim], -1, 0).swapaxes(1, 2)
            axes.plot(*lines, color=ink, linestyle=dashes, linewidth=0.8)
            axes.plot([], [], color=ink, linestyle=dashes, linewidth=0.8, label=shown(dim).label)
        crossings = {name: field.isel(ks=drawn["ks"], cs=drawn["cs"]).values for name, field in fields.items()}
        dots = axes.scatter(crossings[x], crossings[y], c=crossings[colour], cmap="viridis", s=10, zorder=3)
        bar = figure.colorbar(dots, ax=axes)
        bar.set_label(AXES[colour].label)
        axes.set(xlabel=AXES[x].label, ylabel=AXES[y].label)
        axes.margins(0.16)
        add_grid(axes)
        add_legend(figure, axes, inside=ax is not None, columns=2)
        figure.draw_without_rendering()  # Labels are placed where the layout puts the points.
        values = {dim: metrics[dim].values[drawn[dim]] / shown(dim).one for dim in FAMILIES}
        _label_lines(axes, families, values, np.stack([crossings[x].ravel(), crossings[y].ravel()], axis=-1))
    return figure


class Box(NamedTuple):
    """The middle of a rectangle and half its sides, each (2,) in points."""

    middle: NDArray[np.float64]
    half: NDArray[np.float64]

    def meets(self, other: Box) -> bool:
        """Whether they overlap."""
        return bool((np.abs(self.middle - other.middle) < self.half + other.half).all())


def _label_lines(
    axes: Any, families: Mapping[str, NDArray], values: Mapping[str, NDArray], dots: NDArray[np.float64]
) -> None:
    """Write its value beside an end of each line, near it and clear of the dots and of other labels."""
    per_point = axes.get_figure(root=True).dpi / 72.0
    placed = [Box(dot, np.full(2, 2.5)) for dot in axes.transData.transform(dots) / per_point]
    for dim, lines in families.items():
        on_paper = axes.transData.transform(lines.reshape(-1, 2)).reshape(lines.shape) / per_point
        for line, value in zip(_from_wide_end(on_paper), values[dim], strict=True):
            text = f"{value:.3g}"
            along = line[0] - line[min(2, len(line) - 1)]
            away = np.arctan2(along[1], along[0])
            offsets = [
                distance * np.array([np.cos(away + turn), np.sin(away + turn)])
                for distance in DISTANCES
                for turn in np.radians(TURNS)
            ]
            half = 0.5 * SIZE * np.array([0.6 * len(text), 1.0])
            boxes = [Box(line[0] + offset, half) for offset in offsets]
            least = int(np.argmin([sum(map(box.meets, placed)) for box in boxes]))
            placed.append(boxes[least])
            axes.annotate(
                text,
                axes.transData.inverted().transform(line[0] * per_point),
                xytext=offsets[least],
                textcoords="offset points",
                ha="center",
                va="center",
                fontsize=SIZE,
                color=FAMILIES[dim][0],
                path_effects=[withStroke(linewidth=2.0, foreground="white")],
            )


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
