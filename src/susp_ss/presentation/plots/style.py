"""What all pictures share: sizes for print, colours, dashes, and panels on a figure without a window."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from ...quantities import KNOWN, briefly, titled, typeset, units_of

STYLE: Any = {
    "font.size": 8.0,
    "axes.labelsize": 8.0,
    "axes.titlesize": 9.0,
    "xtick.labelsize": 7.0,
    "ytick.labelsize": 7.0,
    "legend.fontsize": 8.0,
    "axes.linewidth": 0.6,
    "mathtext.default": "regular",
}
"""For a page 180 mm wide."""

WIDTH = 7.1  # inches, the text width of A4
COLUMN = 3.4  # inches, one of two columns
DPI = 200

# Okabe and Ito's palette, distinct to colour-blind readers, and a dash pattern for each.
LINES = (("#000000", "-"), ("#0072b2", "--"), ("#d55e00", "-."), ("#009e73", ":"))


def new_figure(width: float, height: float, layout: Any = None) -> Figure:
    """Return an empty figure, in inches."""
    figure = Figure(figsize=(width, height), dpi=DPI, layout=layout)
    FigureCanvasAgg(figure)
    return figure


def panels(ax: Any, rows: int, columns: int, size: tuple[float, float], **subplots: Any) -> tuple[Figure, Any]:
    """Return a figure and its Axes (rows, columns): those given, or those of a new figure of ``size`` in inches.

    Raises
    ------
    TypeError, ValueError
        ``ax`` is not made of Axes, or not of one a panel.
    """
    if ax is None:
        figure = new_figure(*size, layout="constrained")
        return figure, figure.subplots(rows, columns, squeeze=False, **subplots)
    given = np.atleast_1d(np.asarray(ax, dtype=object))
    if not all(isinstance(axes, Axes) for axes in given.flat):
        raise TypeError(f"ax must be matplotlib Axes, got {briefly(ax)}")
    if given.size != rows * columns:
        raise ValueError(f"ax must be one Axes a panel, {rows} x {columns}, got {given.size}")
    return given.flat[0].figure, given.reshape(rows, columns)


def styled(curves: Mapping[str, Any]) -> Iterator[tuple[Any, dict[str, Any]]]:
    """Each curve with its label, colour and dashes."""
    if len(curves) > len(LINES):
        raise ValueError(f"at most {len(LINES)} curves can be told apart, got {len(curves)}: {', '.join(curves)}")
    for (name, curve), (colour, dashes) in zip(curves.items(), LINES, strict=False):
        yield curve, {"label": name, "color": colour, "linestyle": dashes, "linewidth": 1.2}


def add_legend(figure: Figure, axes: Axes, inside: bool, columns: int = 3) -> None:
    """Put the legend of one panel below the figure, or inside that panel where the figure is somebody else's."""
    handles, labels = axes.get_legend_handles_labels()
    if inside:
        axes.legend(frameon=False, handlelength=3.0)
    else:
        figure.legend(handles, labels, loc="outside lower center", ncols=columns, frameon=False, handlelength=3.0)


def add_grid(axes: Axes) -> None:
    axes.grid(which="major", linewidth=0.4, color="0.8")


class Shown(NamedTuple):
    """How pictures show a quantity: its symbol, the unit on the axis, and SI units in one of it."""

    symbol: str
    unit: str
    one: float

    @property
    def label(self) -> str:
        return titled(self.symbol, self.unit)


def shown(name: str, unit: str = "") -> Shown:
    """How pictures show a quantity, in the unit that they use for it or in another."""
    quantity = KNOWN[name]
    chosen = unit or quantity.shown or quantity.unit
    symbol = f"${quantity.symbol}$" if "_" in quantity.symbol else quantity.symbol
    return Shown(symbol, typeset(chosen), units_of(quantity.unit)[chosen])
