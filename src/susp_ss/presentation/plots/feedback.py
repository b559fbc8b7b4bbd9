"""What a law achieves beside the passive vehicle, and how far any law could go."""

from __future__ import annotations

from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure

from ...feedback import ActiveFront, Feedback
from ...quantities import KNOWN, briefly, titled
from .style import COLUMN, LINES, STYLE, add_grid, panels, shown

NEAR = 0.005
"""A ratio this close to one is neither better nor worse."""


def feedback(result: Feedback | ActiveFront, ax: Any = None) -> Figure:
    """Draw what a law achieves, or a front of bounds.

    Parameters
    ----------
    result : Feedback, ActiveBound or ActiveFront
        A front over one dim.
    ax : Axes, optional

    Returns
    -------
    matplotlib.figure.Figure
        Of a law a bar for every metric at every place, its root mean square over the passive one's; of a front the
        least root mean square over the limit.

    Raises
    ------
    TypeError, ValueError
        No such result, or a front over several dims.

    Examples
    --------
    >>> import susp_ss as ss
    >>> figure = ss.plots.feedback(ss.skyhook(ss.QuarterCar(), ss.Road(), gain=1000.0))
    >>> [label.get_text() for label in figure.axes[0].get_yticklabels()][:3]
    ['bacc', 'sws', 'dtl']
    """
    if not isinstance(result, (Feedback, ActiveFront)):
        raise TypeError(f"result must be a Feedback, an ActiveBound or an ActiveFront, got {briefly(result)}")
    with mpl.rc_context(STYLE):
        return _front(result, ax) if isinstance(result, ActiveFront) else _bars(result, ax)


def _bars(law: Feedback, ax: Any) -> Figure:
    ratio = law.table()["ratio"]
    ratio = ratio[np.isfinite(ratio)]
    figure, given = panels(ax, 1, 1, (COLUMN, 0.6 + 0.16 * len(ratio)))
    axes = given[0, 0]
    colours = [LINES[1][0] if r < 1.0 - NEAR else LINES[2][0] if r > 1.0 + NEAR else "0.6" for r in ratio]
    axes.barh(range(len(ratio)), ratio - 1.0, left=1.0, color=colours)
    axes.set_xscale("log")
    axes.axvline(1.0, color="black", linewidth=0.6)
    axes.set_yticks(range(len(ratio)), ratio.index)
    axes.set_ylim(len(ratio) - 0.4, -0.6)
    axes.set_xlabel(f"{law.kind} over passive")
    add_grid(axes)
    axes.set_axisbelow(True)
    return figure


def _front(front: ActiveFront, ax: Any) -> Figure:
    if front.bound.ndim != 1:
        raise ValueError(
            f"result must be a front over one dim, got {', '.join(map(str, front.bound.dims))}; select one"
        )
    figure, given = panels(ax, 1, 1, (COLUMN, 2.4))
    axes = given[0, 0]
    name, limit = next((name, limit) for name, limit in front.limits.items() if float(limit.min()) < float(limit.max()))
    metric = name.partition("@")[0]
    unit, one = (shown(metric).unit, shown(metric).one) if metric in KNOWN else (limit.attrs["units"], 1.0)
    axes.plot(limit / one, front.bound, color=LINES[0][0], marker="o", markersize=3, linewidth=1.2)
    axes.set_xlabel(titled(f"limit of {name}", unit))
    axes.set_ylabel(titled(f"least {front.minimise}", front.bound.attrs["units"]))
    add_grid(axes)
    return figure
