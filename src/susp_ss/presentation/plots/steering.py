"""What a car does as it is steered, over time."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import matplotlib as mpl
import xarray as xr
from matplotlib.figure import Figure

from ...quantities import HANDLING, briefly, titled, typeset, units_of
from .style import STYLE, WIDTH, add_grid, add_legend, panels, styled

PANELS = {
    "ay": ("lateral acceleration", "m/s^2"),
    "yaw_rate": ("yaw rate", "deg/s"),
    "sideslip": ("sideslip", "deg"),
    "roll": ("roll", "deg"),
}


def steering(histories: Mapping[str, xr.Dataset], ax: Any = None) -> Figure:
    """Lateral acceleration, yaw rate, sideslip and roll over time, of one or several cars or speeds.

    Parameters
    ----------
    histories : mapping of str to Dataset
        For each legend entry what `susp_ss.simulate` returns of a `RideHandlingCar`; at most four.
    ax : sequence of 4 Axes, optional

    Returns
    -------
    matplotlib.figure.Figure

    Raises
    ------
    TypeError
        No mapping of such histories.

    Examples
    --------
    >>> import numpy as np
    >>> import susp_ss as ss
    >>> from susp_ss import plots
    >>> time = np.arange(0.0, 2.0, 0.01)
    >>> step = {"delta_f": np.where(time > 0.2, 0.01, 0.0)}
    >>> turn = ss.simulate(ss.RideHandlingCar(), 0.0 * time, time, inputs=step)
    >>> [axes.get_ylabel() for axes in plots.steering({"20 m/s": turn}).axes]
    ['lateral acceleration (m/s²)', 'yaw rate (deg/s)', 'sideslip (deg)', 'roll (deg)']
    """
    if not isinstance(histories, Mapping) or not all(
        isinstance(history, xr.Dataset) and {*PANELS} <= {*history} for history in histories.values()
    ):
        raise TypeError(
            'histories must be a mapping such as {"20 m/s": history} of what simulate returns of a RideHandlingCar, '
            f"got {briefly(histories)}"
        )
    with mpl.rc_context(STYLE):
        figure, given = panels(ax, 2, 2, (WIDTH, 3.8), sharex=True)
        for axes, (name, (word, unit)) in zip(given.flat, PANELS.items(), strict=True):
            one = units_of(HANDLING[name].unit)[unit]
            for history, style in styled(histories):
                axes.plot(history.time, history[name] / one, **style)
            axes.set_ylabel(titled(word, typeset(unit)))
            add_grid(axes)
        for axes in given[-1]:
            axes.set_xlabel("time (s)")
        add_legend(figure, given[0, 0], inside=ax is not None, columns=4)
    return figure
