"""What all pictures share: sizes for print, colours, dashes, and a figure without a window."""

from __future__ import annotations

from typing import Any

from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

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
DPI = 200

# Okabe and Ito's palette, distinct to colour-blind readers, and a dash pattern for each.
LINES = (("#000000", "-"), ("#0072b2", "--"), ("#d55e00", "-."), ("#009e73", ":"))


def new_figure(width: float, height: float, layout: Any = None) -> Figure:
    """Return an empty figure, in inches."""
    figure = Figure(figsize=(width, height), dpi=DPI, layout=layout)
    FigureCanvasAgg(figure)
    return figure
