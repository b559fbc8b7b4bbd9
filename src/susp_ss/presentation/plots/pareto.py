"""Designs that no other beats, beside the vehicle itself and what any suspension could do."""

from __future__ import annotations

from itertools import cycle
from typing import Any

import matplotlib as mpl
from matplotlib.figure import Figure

from ...design import ParetoFront
from ...metrics.outputs import output
from ...quantities import KNOWN, briefly, titled
from .style import LINES, STYLE, WIDTH, add_grid, panels, shown

MARKERS = "oxs+^"


def pareto(front: ParetoFront, ax: Any = None) -> Figure:
    """Draw a Pareto front and its designs.

    Parameters
    ----------
    front : ParetoFront
        Of two objectives.
    ax : Axes, optional
        Two.

    Returns
    -------
    matplotlib.figure.Figure
        Left one objective over the other: the front, the vehicle itself, and the bound where the front has one, a dot
        for each design. Right where each design lies in the ranges of its variables.

    Raises
    ------
    TypeError, ValueError
        No front, or one of a single objective.

    Examples
    --------
    >>> import susp_ss as ss
    >>> box = {"ks": (12e3, 25e3), "cs": (800.0, 2200.0)}
    >>> front = ss.pareto_front(ss.QuarterCar(), ss.Road(), box, ("bacc", "dtl"), points=3)
    >>> [axes.get_ylabel() for axes in ss.plots.pareto(front).axes]
    ['dtl (kN)', 'share of the range']
    """
    if not isinstance(front, ParetoFront):
        raise TypeError(f"front must be a ParetoFront, got {briefly(front)}")
    if len(front.objectives) < 2:
        raise ValueError(f"front must have two objectives to draw, got {front.objectives[0]} alone")
    first, second = front.objectives
    table, own = front.table(), front.passive()
    (label, one), (other_label, other) = (_axis(front, name) for name in front.objectives)
    with mpl.rc_context(STYLE):
        figure, given = panels(ax, 1, 2, (WIDTH, 2.9))
        left, right = given[0]
        left.plot(table[first] / one, table[second] / other, "o-", color=LINES[1][0], ms=3, lw=1.2, label="front")
        left.plot(own[first] / one, own[second] / other, "D", color=LINES[0][0], ms=5, label="vehicle itself")
        if front.bound is not None:
            left.plot(front.bound / one, table[second] / other, ".", color=LINES[2][0], ms=4, label="any suspension")
        left.set(xlabel=label, ylabel=other_label)
        left.legend(frameon=False)
        inks = cycle([ink for ink, _ in LINES])
        for (name, (low, high)), ink, marker in zip(front.variables.items(), inks, cycle(MARKERS), strict=False):
            share = (table[name] - low) / (high - low)
            right.plot(table[first] / one, share, marker=marker, color=ink, lw=0.8, ms=3, label=_ranged(front, name))
        right.set(xlabel=label, ylabel="share of the range", ylim=(-0.04, 1.04))
        right.legend(frameon=False, loc="upper left", bbox_to_anchor=(1.0, 1.0))
        for axes in (left, right):
            add_grid(axes)
    return figure


def _axis(front: ParetoFront, name: str) -> tuple[str, float]:
    """Label of an objective, and SI units in one of its axis's."""
    metric = name.partition("@")[0]
    if metric not in KNOWN:
        return titled(name, output(front.metrics, name).attrs["units"]), 1.0
    axis = shown(metric)
    return titled(name, axis.unit), axis.one


def _ranged(front: ParetoFront, name: str) -> str:
    """A variable and its range."""
    quantity = front.vehicle.quantities()[front.vehicle.settings()[name][0]]
    axis = shown(quantity.name) if quantity.name in KNOWN else None
    low, high = (end / (axis.one if axis else 1.0) for end in front.variables[name])
    return f"{titled(name, axis.unit if axis else quantity.unit)}\n{low:.5g} to {high:.5g}"
