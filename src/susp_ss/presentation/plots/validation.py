"""Pictures of how well surrogates predict runs that they have not seen, one column wide."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Collection, Iterator, Mapping
from typing import Any

import matplotlib as mpl
import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from ...quantities import titled
from ...surrogates.validation import Validation
from .style import COLUMN, STYLE, new_figure

# Okabe and Ito's palette without its yellow, and grey; a marker for each, filled and open in turn.
COLOURS = ("#000000", "#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#7f7f7f", "#7a3b00")
MARKERS = ("o", "s", "^", "D", "v", "P", "X", "<", "*")
DASHES = ("-", "--", "-.", ":")
OTHERS, GREY = "the others", "#a6a6a6"

GRID: Any = {"linewidth": 0.4, "color": "0.85"}


def parity(
    validations: Validation | Mapping[str, Validation],
    unit: str = "",
    ax: Axes | None = None,
    margins: Mapping[str, NDArray[np.float64]] | None = None,
) -> Figure:
    """Predicted against expensive response, with the diagonal on which they agree.

    Parameters
    ----------
    validations : Validation, or mapping of str to Validation
        One, or several with their legend entries. Bars are the central intervals that a surrogate predicts.
    unit : str
        Of the response.
    ax : matplotlib.axes.Axes, optional
        Where to draw; a new figure if None.
    margins : mapping of str to ndarray (n,), optional
        Half the lengths of other bars, such as each ``Validation.allowance``, by legend entry.

    Returns
    -------
    matplotlib.figure.Figure

    Examples
    --------
    >>> import numpy as np
    >>> import susp_ss as ss
    >>> from susp_ss.presentation.plots import parity
    >>> X = np.linspace(0.0, 2.0, 9)[:, None]
    >>> figure = parity(ss.cross_validate(ss.Polynomial(), X, np.exp(X[:, 0])), unit="m/s²")
    >>> figure.axes[0].get_xlabel()
    'expensive response (m/s²)'
    """
    several = _several(validations)
    bars = {name: one.margin for name, one in several.items()} | dict(margins or {})

    def draw(axes: Axes) -> None:
        level = next(iter(several.values())).y.mean()
        axes.axline((level, level), slope=1.0, color="0.5", linewidth=0.8, zorder=0)
        for (name, one), style in zip(several.items(), _styles(), strict=False):
            axes.errorbar(one.y, one.predicted, yerr=bars[name], label=name, **_points(style))
        sides = [*axes.get_xlim(), *axes.get_ylim()]
        axes.set(xlim=(min(sides), max(sides)), ylim=(min(sides), max(sides)), aspect="equal")
        axes.set_xlabel(titled("expensive response", unit))
        axes.set_ylabel(titled("predicted response", unit))

    return _drawn(draw, ax, 3.2, len(several))


def residuals(
    validations: Validation | Mapping[str, Validation],
    unit: str = "",
    ax: Axes | None = None,
    margins: Mapping[str, NDArray[np.float64]] | None = None,
) -> Figure:
    """Residual, prediction minus expensive response, against the expensive response.

    Parameters
    ----------
    validations : Validation, or mapping of str to Validation
        One, or several with their legend entries. Bars are the central intervals that a surrogate predicts: those that
        miss the zero line missed the response.
    unit : str
        Of the response.
    ax : matplotlib.axes.Axes, optional
        Where to draw; a new figure if None.
    margins : mapping of str to ndarray (n,), optional
        As of `parity`.

    Returns
    -------
    matplotlib.figure.Figure

    Examples
    --------
    >>> import numpy as np
    >>> import susp_ss as ss
    >>> from susp_ss.presentation.plots import residuals
    >>> X = np.linspace(0.0, 2.0, 9)[:, None]
    >>> figure = residuals(ss.cross_validate(ss.Polynomial(), X, np.exp(X[:, 0])), unit="N")
    >>> figure.axes[0].get_ylabel()
    'residual (N)'
    """
    several = _several(validations)
    bars = {name: one.margin for name, one in several.items()} | dict(margins or {})

    def draw(axes: Axes) -> None:
        axes.axhline(0.0, color="0.5", linewidth=0.8, zorder=0)
        for (name, one), style in zip(several.items(), _styles(), strict=False):
            axes.errorbar(one.y, one.residuals, yerr=bars[name], label=name, **_points(style))
        axes.set_xlabel(titled("expensive response", unit))
        axes.set_ylabel(titled("residual", unit))

    return _drawn(draw, ax, 2.3, len(several))


def learning_curves(
    table: pd.DataFrame, unit: str = "", foremost: Collection[str] | None = None, ax: Axes | None = None
) -> Figure:
    """Error against the number of expensive runs, median and range over the repeats.

    Parameters
    ----------
    table : DataFrame
        Of `susp_ss.learning_curve` or `susp_ss.learning_curve_of_runs`; fits that were refused are left out.
    unit : str
        Of the response.
    foremost : collection of str, optional
        Surrogates to look at; the others are grey lines, without their range. All of them if None.
    ax : matplotlib.axes.Axes, optional
        Where to draw; a new figure if None.

    Returns
    -------
    matplotlib.figure.Figure

    Raises
    ------
    ValueError
        A surrogate that is not in the table.

    Examples
    --------
    >>> import numpy as np
    >>> import susp_ss as ss
    >>> from susp_ss.presentation.plots import learning_curves
    >>> table = ss.learning_curve(
    ...     {"linear": ss.Polynomial(1), "quadratic": ss.Polynomial(2)},
    ...     lambda X: np.exp(X[:, 0]), {"x": (0.0, 1.0)}, budgets=(5, 10, 20), repeats=3,
    ... )
    >>> figure = learning_curves(table, unit="N")
    >>> figure.axes[0].get_ylabel()
    'RMSE (N)'
    """
    errors = {str(name): part.groupby("runs")["RMSE"] for name, part in table.groupby("surrogate", sort=False)}
    coloured = list(errors if foremost is None else foremost)
    unknown = [name for name in coloured if name not in errors]
    if unknown:
        raise ValueError(f"no surrogate named {unknown[0]!r} in the table, available: {', '.join(errors)}")
    others = [name for name in errors if name not in coloured]

    def draw(axes: Axes) -> None:
        for i, (name, style) in enumerate(zip(coloured, _styles(), strict=False)):
            error = errors[name]
            middle = error.median()
            whiskers = [middle - error.min(), error.max() - middle]
            # Side by side, so that whiskers do not hide one another.
            runs = middle.index * 1.02 ** (i - (len(coloured) - 1) / 2)
            axes.errorbar(runs, middle, yerr=whiskers, label=name, **_line(style))
        for i, name in enumerate(others):
            middle = errors[name].median()
            axes.plot(middle.index, middle, color=GREY, linewidth=0.7, zorder=1, label="_" if i else OTHERS)
        axes.set_xscale("log")
        axes.set_yscale("log")
        counts = sorted(table["runs"].unique())
        axes.set_xticks(counts, [str(runs) for runs in counts])
        axes.set_xticks([], minor=True)
        axes.set_xlabel("expensive runs")
        axes.set_ylabel(titled("RMSE", unit))

    return _drawn(draw, ax, 2.6, len(coloured) + bool(others))


def _drawn(draw: Callable[[Axes], None], ax: Axes | None, height: float, entries: int) -> Figure:
    """Draw into the axes given, with the legend inside, or into a figure of one column, with the legend below."""
    height += 0.15 * math.ceil(entries / 2) if entries > 1 else 0.0
    with mpl.rc_context(STYLE):
        figure: Any = new_figure(COLUMN, height, layout="constrained") if ax is None else ax.get_figure(root=True)
        axes = figure.subplots() if ax is None else ax
        draw(axes)
        axes.grid(which="major", **GRID)
        axes.set_axisbelow(True)
        if entries > 1 and ax is None:
            figure.legend(loc="outside lower center", ncols=2, frameon=False, handlelength=3.2, columnspacing=1.2)
        elif entries > 1:
            axes.legend(frameon=False)
    return figure


def _several(validations: Validation | Mapping[str, Validation]) -> Mapping[str, Validation]:
    return {"": validations} if isinstance(validations, Validation) else validations


def _styles() -> Iterator[tuple[str, str, str, bool]]:
    """Colour, marker, dashes and whether the marker is filled, without end."""
    filled = itertools.cycle((True, False))
    return zip(itertools.cycle(COLOURS), itertools.cycle(MARKERS), itertools.cycle(DASHES), filled)


def _points(style: tuple[str, str, str, bool]) -> dict[str, Any]:
    colour, marker, _, filled = style
    face = colour if filled else "none"
    return {
        "color": colour,
        "marker": marker,
        "markerfacecolor": face,
        "markersize": 3.5,
        "markeredgewidth": 0.8,
        "linestyle": "none",
        "elinewidth": 0.7,
        "capsize": 1.5,
        "capthick": 0.7,
    }


def _line(style: tuple[str, str, str, bool]) -> dict[str, Any]:
    return _points(style) | {"linestyle": style[2], "linewidth": 1.1}
