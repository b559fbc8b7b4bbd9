"""How a ride feels: accelerations in one-third octaves beside the limits, and total values between the words."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import matplotlib as mpl
import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from ...metrics.comfort import REACTIONS
from ...metrics.third_octaves import FATIGUE, reduced_comfort
from ...quantities import KNOWN, briefly, titled
from .style import COLUMN, STYLE, WIDTH, add_grid, add_legend, panels, styled

LIMITED = 10.0 ** (np.arange(0, 20) / 10.0)
"""Centres of the bands from 1 to 80 Hz, to which ISO 2631 set limits."""

BELOW = 1e-3
"""Of the greatest value, what is not shown of spectra in one-third octaves."""


def third_octaves(curves: Mapping[str, xr.DataArray], ax: Any = None, limits: bool = True) -> Figure:
    """Root mean squares in one-third octaves, beside the limits of reduced comfort.

    The limits are those of vertical vibration of ISO 2631:1974 and ISO 2631-1:1985, which the standard of 1997 replaced
    by weightings: they are for accelerations that are not weighted. Beside them a weighted curve shows what a
    weighting leaves.

    Parameters
    ----------
    curves : mapping of str to DataArray
        For each legend entry root mean squares in m/s^2 on ``frequency`` (Hz), of one output of
        `susp_ss.third_octaves`; at most four.
    ax : Axes, optional
    limits : bool
        Whether the limits are drawn, for exposures from 25 min to 24 h.

    Returns
    -------
    matplotlib.figure.Figure

    Raises
    ------
    TypeError, ValueError
        No mapping of such curves.

    Examples
    --------
    >>> import susp_ss as ss
    >>> from susp_ss import plots
    >>> car, road = ss.QuarterCar(), ss.Road()
    >>> curves = {"as it is": ss.third_octaves(car, road), "Wk": ss.third_octaves(car, road, weighting="Wk")}
    >>> figure = plots.third_octaves({name: bands.sel(output="bacc") for name, bands in curves.items()})
    >>> figure.axes[0].get_ylabel()
    'RMS in one-third octave (m/s²)'
    """
    _check(curves, "frequency", 'third_octaves(...).sel(output="bacc_cg")')
    edge = 10.0**0.05
    with mpl.rc_context(STYLE):
        figure, given = panels(ax, 1, 1, (WIDTH, 3.6))
        axes = given[0, 0]
        for curve, style in styled(curves):
            f = curve.frequency.values
            axes.stairs(curve, np.append(f / edge, f[-1] * edge), baseline=None, **style)
        top = max(float(curve.max()) for curve in curves.values())
        axes.set(xscale="log", yscale="log", xlabel="frequency (Hz)", ylim=(BELOW * top, 3.0 * top))
        axes.set_ylabel(titled("RMS in one-third octave", "m/s^2"))
        axes.xaxis.set_major_formatter(mpl.ticker.FormatStrFormatter("%g"))
        if limits:
            for exposure in FATIGUE:
                limit = reduced_comfort(LIMITED, exposure)
                axes.plot(LIMITED, limit, color="0.55", linewidth=0.8)
                axes.annotate(
                    exposure, (LIMITED[-1], limit[-1]), (3, 0), textcoords="offset points", va="center", color="0.35"
                )
            axes.plot([], [], color="0.55", linewidth=0.8, label="reduced comfort, not weighted (ISO 2631-1:1985)")
            axes.set_ylim(top=max(3.0 * top, 1.3 * limit.max(), 1.3 * reduced_comfort(LIMITED, "25 min").max()))
        add_grid(axes)
        add_legend(figure, axes, inside=ax is not None, columns=2)
    return figure


def comfort(curves: Mapping[str, xr.DataArray], ax: Any = None) -> Figure:
    """Vibration total values over what is varied, between the words of ISO 2631-1.

    Parameters
    ----------
    curves : mapping of str to DataArray
        For each legend entry total values in m/s^2 on one dim, such as ``speed``; at most four, on the same dim.
    ax : Axes, optional

    Returns
    -------
    matplotlib.figure.Figure
        The words stand beside the range of values that each is for; they overlap as the standard's do (C.2.3).

    Raises
    ------
    TypeError, ValueError
        No mapping of such curves.

    Examples
    --------
    >>> import numpy as np, xarray as xr
    >>> import susp_ss as ss
    >>> from susp_ss import plots
    >>> speed = xr.DataArray(np.linspace(5.0, 40.0, 15), dims="speed")
    >>> ride = ss.comfort(ss.FullCar(), ss.Road.iso8608("C", speed=speed.assign_coords(speed=speed)))
    >>> figure = plots.comfort({"centre of gravity": ride.metrics.total.sel(point="cg")})
    >>> figure.axes[0].get_xlabel()
    'speed (m/s)'
    """
    dim = _check(curves, None, 'comfort(...).metrics.total.sel(point="cg")')
    with mpl.rc_context(STYLE):
        figure, given = panels(ax, 1, 1, (1.5 * COLUMN, 3.2))
        axes = given[0, 0]
        for curve, style in styled(curves):
            x = curve[dim] if dim in curve.coords else np.arange(curve.size)
            axes.plot(x, curve, **style)
        known = KNOWN.get(dim)
        unit = known.unit if known else curve[dim].attrs.get("units", "") if dim in curve.coords else ""
        axes.set_xlabel(titled(known.meaning if known else dim, unit))
        axes.set_ylabel(titled("total value", "m/s^2"))
        top = 1.1 * max(float(curve.max()) for curve in curves.values())
        axes.set_ylim(0.0, top)
        _words(axes, top)
        add_grid(axes)
        add_legend(figure, axes, inside=ax is not None, columns=4)
    return figure


def _words(axes: Any, top: float) -> None:
    """The standard's words right of Axes, each at its range up to ``top``; ranges that overlap side by side."""
    for i, (word, low, high) in enumerate(REACTIONS):
        if low >= top:
            continue
        place, ends = 1.02 + 0.025 * (i % 2), (low, min(high, top))
        axes.axhspan(*ends, color="0.5", alpha=0.05 + 0.03 * i, linewidth=0.0)
        across = axes.get_yaxis_transform()
        axes.plot([place, place], ends, color="0.3", linewidth=1.6, transform=across, clip_on=False)
        axes.text(1.075, sum(ends) / 2.0, word, transform=across, va="center", fontsize=7.0)


def _check(curves: Any, dim: str | None, such: str) -> str:
    """The one dim of curves, the one asked for if any."""
    need = f'curves must be a mapping such as {{"driver": {such}}}'
    if not isinstance(curves, Mapping) or not curves:
        raise TypeError(f"{need}, got {briefly(curves)}")
    for name, curve in curves.items():
        if not isinstance(curve, xr.DataArray):
            raise TypeError(f"{need}, got {briefly(curve)} as {name!r}")
        if curve.ndim != 1 or curve.dims[0] != (dim or curve.dims[0]):
            raise ValueError(f"{need} on {dim or 'one dim'}, got {name!r} on ({', '.join(map(str, curve.dims))})")
        dim = str(curve.dims[0])
    return str(dim)
