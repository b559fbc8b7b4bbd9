"""Responses and spectra over frequency."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import matplotlib as mpl
import numpy as np
import xarray as xr
from matplotlib.figure import Figure
from numpy.typing import ArrayLike

from ...quantities import METRICS, briefly, metric_and_place, signal, titled, typeset, unit_of
from ...responses.frequency import frequency_response
from ...responses.frequency import psd as spectrum
from ...roads.road import Road
from ...study.published import LABELS
from ...vehicles.full import FullCar
from ...vehicles.quarter import QuarterCar
from ...vehicles.vehicle import Vehicle
from .style import COLUMN, STYLE, WIDTH, Shown, add_grid, add_legend, panels, shown, styled

# Spectra: tyre load in N, whose squares stay readable.
SPECTRA = {name: shown(name, {"dtl": "N"}.get(name, "")) for name in LABELS}

FREQUENCY = np.geomspace(0.1, 50.0, 400)

# Panels of spectra in a row.
ABREAST = 3


def bode(curves: Mapping[str, xr.DataArray], ax: Any = None, per: str = "m") -> Figure:
    """Magnitude and phase over frequency, for one or several models.

    Parameters
    ----------
    curves : mapping of str to DataArray
        For each legend entry a complex response on ``frequency`` (Hz) and one more dim, ``output`` or ``criterion``,
        whose names start with those of the metrics; in output unit per metre of road. At most four, all with the
        same outputs.
    ax : array_like of Axes, optional
        A row of magnitudes and one of phases, a column an output.
    per : str
        Unit of the input: metres of road height, or another.

    Returns
    -------
    matplotlib.figure.Figure
        One output fits a column of text, three a page. Phases are continuous over frequency.

    Examples
    --------
    >>> from susp_ss.presentation.plots import bode, study_curves
    >>> figure = bode(study_curves("fr"))
    >>> [axes.get_ylabel() for axes in figure.axes[::3]]
    ['|H| ((m/s²)/m)', 'phase (deg)']
    """
    dim, outputs = _outputs_of(curves)
    width = COLUMN if len(outputs) == 1 else max(WIDTH, 2.3 * len(outputs))
    with mpl.rc_context(STYLE):
        figure, axes = panels(ax, 2, len(outputs), (width, 4.2), sharex=True)
        for output, (above, below) in zip(outputs, axes.T, strict=True):
            for curve, style in styled(curves):
                H = curve.sel({dim: output})
                above.loglog(H.frequency, np.abs(H), **style)
                below.semilogx(H.frequency, np.degrees(np.unwrap(np.angle(H))), **style)
            above.set(title=LABELS.get(output, output), ylabel=titled("|H|", _per(per, output)))
            below.set(xlabel="frequency (Hz)", ylabel="phase (deg)")
            below.yaxis.set_major_locator(mpl.ticker.MaxNLocator(7, steps=[1, 1.8, 4.5, 9, 10]))
            add_grid(above)
            add_grid(below)
        add_legend(figure, axes[0, 0], inside=ax is not None, columns=1 if len(outputs) == 1 else 4)
    return figure


def psd(
    vehicles: Mapping[str, Vehicle], road: Road, corner: str = "fr", frequency: ArrayLike = FREQUENCY, ax: Any = None
) -> Figure:
    """Spectra of the three criteria on a random road, for one or several vehicles.

    Parameters
    ----------
    vehicles : mapping of str to Vehicle
        For each legend entry a quarter car, or a vehicle that has ``corner``; at most four.
    road : Road
        Any waviness, any tracks.
    corner : str
        Where body acceleration, suspension deflection and tyre load are taken; the quarter car has one place only.
    frequency : array_like, (F,)
        Hz, > 0.
    ax : sequence of 3 Axes, optional

    Returns
    -------
    matplotlib.figure.Figure
        One-sided spectra; the area below a curve is the variance.

    Raises
    ------
    ValueError
        A vehicle that has no such corner.

    Examples
    --------
    >>> import susp_ss as ss
    >>> from susp_ss import plots
    >>> cars = {"quarter car": ss.QuarterCar(), "full car at rl": ss.FullCar()}
    >>> figure = plots.psd(cars, ss.Road.iso8608("B", speed=20.0), "rl")
    >>> figure.axes[2].get_ylabel()
    'SWS (mm²/Hz)'
    """
    return spectra({name: _criteria(spectrum(car, road, frequency), corner) for name, car in vehicles.items()}, ax)


def spectra(curves: Mapping[str, xr.DataArray], ax: Any = None) -> Figure:
    """Spectra over frequency, for one or several vehicles or roads.

    Parameters
    ----------
    curves : mapping of str to DataArray
        For each legend entry what `susp_ss.psd` returns of one design, or some outputs of it: on ``output`` (or
        ``criterion``) and ``frequency`` (Hz). At most four, all with the same outputs. Where the attribute
        ``weighting`` of all has the same name for an output, its axis says so.
    ax : sequence of Axes, optional
        One an output.

    Returns
    -------
    matplotlib.figure.Figure
        A panel an output; the area below a curve is the variance.

    Raises
    ------
    TypeError, ValueError
        No such mapping, curves of a sweep or of different outputs.

    Examples
    --------
    >>> import numpy as np
    >>> import susp_ss as ss
    >>> from susp_ss import plots
    >>> S = ss.psd(ss.FullCar(), ss.DEFAULT_ROAD, np.geomspace(0.1, 50.0, 200))
    >>> figure = plots.spectra({"full car": S.sel(output=["bacc_cg", "pitch_acc", "sws_fr"])})
    >>> [axes.get_ylabel() for axes in figure.axes]
    ['bacc_cg ((m/s²)²/Hz)', 'pitch_acc ((rad/s²)²/Hz)', 'sws_fr (mm²/Hz)']
    """
    dim, outputs = _outputs_of(curves)
    rows = -(-len(outputs) // ABREAST)
    columns = min(len(outputs), ABREAST)
    size = (COLUMN if columns == 1 else WIDTH, 2.4 * rows + 0.3)
    with mpl.rc_context(STYLE):
        figure, axes = panels(ax, *((rows, columns) if ax is None else (1, len(outputs))), size)
        for here, output in zip(axes.flat, outputs, strict=False):
            symbol, unit, one = _density(output)
            for density, style in styled(curves):
                here.loglog(density.frequency, density.sel({dim: output}) / one**2, **style)
            passed = {curve.attrs.get("weighting", {}).get(output, "") for curve in curves.values()}
            through = f" through {passed.pop()}" if len(passed) == 1 and "" not in passed else ""
            here.set(xlabel="frequency (Hz)", ylabel=titled(f"{symbol}{through}", unit))
            add_grid(here)
        for spare in axes.flat[len(outputs) :]:
            spare.set_axis_off()
        add_legend(figure, axes.flat[0], inside=ax is not None, columns=4)
    return figure


def _outputs_of(curves: Any) -> tuple[str, list[str]]:
    """The dim beside frequency that all curves have, and the outputs on it."""
    need = "curves must be a mapping of names to DataArrays on output and frequency"
    if not isinstance(curves, Mapping) or not curves:
        raise TypeError(f"{need}, got {briefly(curves)}")
    for name, curve in curves.items():
        if not isinstance(curve, xr.DataArray):
            raise TypeError(f"{need}, got {briefly(curve)} as {name!r}")
        if "frequency" not in curve.dims or curve.ndim != 2:
            raise ValueError(f"{need}, got {name!r} on ({', '.join(map(str, curve.dims))})")
    first = next(iter(curves.values()))
    (dim,) = (str(dim) for dim in first.dims if dim != "frequency")
    outputs: list[str] = first[dim].values.tolist()
    for name, curve in curves.items():
        if dim not in curve.dims or not set(outputs) <= set(curve[dim].values.tolist()):
            raise ValueError(f"curves must all have the outputs {', '.join(outputs)}, got {name!r} without")
    return dim, outputs


def _density(output: str) -> tuple[str, str, float]:
    """How a density is shown: its symbol, its unit, and SI units in one of what is squared."""
    if output in SPECTRA:
        symbol, unit, one = SPECTRA[output]
    else:
        metric, _ = metric_and_place(output)
        of = SPECTRA.get(metric) or (shown(metric) if metric in METRICS else Shown("", typeset(unit_of(output)), 1.0))
        symbol, unit, one = output, of.unit, of.one
    return symbol, f"{_grouped(unit)}²/Hz" if unit else "1/Hz", one


def bode_magnitude(curves: Mapping[str, xr.DataArray], ax: Any = None) -> Figure:
    """Magnitude over frequency of the three criteria per metre of road height.

    Parameters
    ----------
    curves : mapping of str to DataArray
        For each legend entry a response on dims ``criterion`` (bacc, dtl, sws) and ``frequency`` (Hz), complex or not.
    ax : sequence of 3 Axes, optional

    Returns
    -------
    matplotlib.figure.Figure

    Examples
    --------
    >>> from susp_ss.presentation.plots import bode_magnitude, study_curves
    >>> figure = bode_magnitude(study_curves("fr"))
    >>> figure.axes[2].get_ylabel()
    '|SWS / road| (m/m)'
    """
    with mpl.rc_context(STYLE):
        figure, axes = panels(ax, 1, len(LABELS), (WIDTH, 2.7))
        for here, (criterion, symbol) in zip(axes.flat, LABELS.items(), strict=True):
            for curve, style in styled(curves):
                here.loglog(curve.frequency, np.abs(curve.sel(criterion=criterion)), **style)
            here.set(xlabel="frequency (Hz)", ylabel=titled(f"|{symbol} / road|", _per("m", criterion)))
            add_grid(here)
        add_legend(figure, axes[0, 0], inside=ax is not None)
    return figure


def study_curves(
    corner: str, full_car: Vehicle | None = None, quarter_car: Vehicle | None = None
) -> dict[str, xr.DataArray]:
    """Responses of both models of the study for `bode` and `bode_magnitude`, each with its own spring and damper.

    Without others they are the study's own, with the middle of their range.

    The full car is measured at ``corner``, once with the road under all four wheels in phase, once with the road
    under that corner's wheel alone.
    """
    quarter = frequency_response(quarter_car or QuarterCar(), FREQUENCY).sel(input="z_r", drop=True)
    car = full_car or FullCar()
    heights = [signal("z_r", wheel) for wheel in car.wheels]
    full = _criteria(frequency_response(car, FREQUENCY).sel(input=heights), corner)
    return {
        "quarter car": _criteria(quarter, corner),
        f"full car at {corner}, all wheels in phase": full.sum("input"),
        f"full car at {corner}, road under {corner} only": full.sel(input=f"z_r_{corner}", drop=True),
    }


def _criteria(response: xr.DataArray, corner: str) -> xr.DataArray:
    """The three criteria of a response at a corner, or at the only place there is, on dim ``criterion``."""
    available = response.output.values.tolist()
    names = list(LABELS) if set(LABELS) <= set(available) else [signal(criterion, corner) for criterion in LABELS]
    if not set(names) <= set(available):
        raise ValueError(f"no corner named {corner!r}, the vehicle's outputs are {', '.join(available)}")
    return response.sel(output=names).assign_coords(output=list(LABELS)).rename(output="criterion")


def _per(input: str, output: str) -> str:
    return f"{_grouped(unit_of(output)) or 1}/{_grouped(input)}"


def _grouped(unit: str) -> str:
    return f"({unit})" if "/" in unit else unit
