"""Pictures of the study: response surfaces and error maps."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import matplotlib as mpl
import numpy as np
import xarray as xr
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure
from matplotlib.patches import Patch
from mpl_toolkits.mplot3d.art3d import Poly3DCollection
from numpy.typing import NDArray

from ...study.feasibility import Study
from ...study.published import CRITERIA, SURROGATES
from .style import STYLE, WIDTH, new_figure, panels, shown

# The study's colours of low fidelity, high fidelity and surrogate; edges tell the surfaces apart without colour.
SURFACES = {"lf": ("#f2d30b", "#8a7500"), "hf": ("#35d0e0", "#0a6d78"), "surrogate": ("#ffffff", "#303030")}

FORMULAE = {"RB": "$S = a_0 + a_1 f$", "VB": "$S = f + a_0 + a_1 K_s + a_2 C_s$", "PB": "$S = f(M_s)$"}

AXES = {name: shown(name) for name in CRITERIA}
ERROR_AXES = AXES | {"dtl": shown("dtl", "N")}
KS, CS = shown("ks"), shown("cs")
VIEW = (34.0, 155.0)
"""Elevation and azimuth in degrees, the same for all criteria. Along K_s every surface shows its upper side: over C_s
BAcc rises and the others fall."""


def response_surfaces(
    study: Study, surrogate: str, criteria: Sequence[str] = tuple(CRITERIA), ax: Any = None
) -> Figure:
    """Low-fidelity, high-fidelity and surrogate response over spring and damper: Figure 4, 5 or 6 of the study.

    Parameters
    ----------
    study : Study
    surrogate : {"RB", "VB", "PB"}
    criteria : sequence of str
        Which of bacc, dtl and sws to show.
    ax : sequence of 3-D Axes, optional
        One a criterion.

    Returns
    -------
    matplotlib.figure.Figure
        One panel a criterion; yellow, cyan and white as in the study.

    Examples
    --------
    >>> import susp_ss as ss
    >>> from susp_ss.presentation.plots import response_surfaces
    >>> figure = response_surfaces(ss.feasibility_study(nodes=(4, 4)), "RB")
    >>> [axes.get_zlabel() for axes in figure.axes]
    ['BAcc (m/s²)', 'DTL (kN)', 'SWS (mm)']
    """
    _check(surrogate, criteria)
    count = len(criteria)
    with mpl.rc_context(STYLE):
        if ax is None:
            figure = new_figure(WIDTH if count > 1 else 0.5 * WIDTH, 2.75)
            ax = [figure.add_axes((i / count, 0.14, 0.83 / count, 0.83), projection="3d") for i in range(count)]
        figure, ((*given,),) = panels(ax, 1, count, (0.0, 0.0))
        for i, (axes, criterion) in enumerate(zip(given, criteria, strict=True)):
            symbol, _, one = AXES[criterion]
            here = study.responses.sel(criterion=criterion) / one
            _surfaces(axes, here, {"lf": "lf", "hf": "hf", "surrogate": surrogate}, *VIEW)
            axes.set_xlabel(KS.label, labelpad=-6)
            axes.set_ylabel(CS.label, labelpad=-6)
            axes.set_zlabel(AXES[criterion].label, labelpad=-1)
            if count > 1:
                axes.set_title(f"({'abc'[i]}) {symbol}", y=1.0)
        labels = ["quarter car", "full car", f"{surrogate}: {FORMULAE[surrogate]}"]
        if count > 1:
            labels = ["low fidelity (quarter car)", "high fidelity (full car)", f"surrogate {labels[-1]}"]
        handles = [
            Patch(facecolor=face, edgecolor=edge, label=label)
            for (face, edge), label in zip(SURFACES.values(), labels, strict=True)
        ]
        figure.legend(handles=handles, loc="lower center", ncols=3, frameon=False, columnspacing=1.2)
    return figure


def error_map(study: Study, surrogate: str, criteria: Sequence[str] = tuple(CRITERIA), ax: Any = None) -> Figure:
    """Error ``S - F`` of a surrogate over spring and damper.

    Parameters
    ----------
    study : Study
    surrogate : {"RB", "VB", "PB"}
    criteria : sequence of str
        Which of bacc, dtl and sws to show.
    ax : sequence of Axes, optional
        One a criterion.

    Returns
    -------
    matplotlib.figure.Figure
        One panel a criterion, blue where the surrogate is too low, red where it is too high; a black line where it is
        right and a cross at the node where it is furthest off.

    Examples
    --------
    >>> import susp_ss as ss
    >>> from susp_ss.presentation.plots import error_map
    >>> figure = error_map(ss.feasibility_study(nodes=(4, 4)), "VB")
    >>> figure.axes[0].get_xlabel()
    '$K_s$ (kN/m)'
    """
    _check(surrogate, criteria)
    count = len(criteria)
    with mpl.rc_context(STYLE):
        figure, given = panels(ax, 1, count, (WIDTH if count > 1 else 0.5 * WIDTH, 2.6), sharey=True)
        for axes, criterion in zip(given.flat, criteria, strict=True):
            symbol, unit, one = ERROR_AXES[criterion]
            here = study.responses.sel(criterion=criterion)
            error = (here[surrogate] - here["hf"]).transpose("cs", "ks") / one
            # An odd number of bands, so that small errors of either sign share the neutral one.
            limit = max(float(np.abs(error).max()), np.finfo(float).tiny)
            bands = np.linspace(-limit, limit, 16)
            image = axes.contourf(
                here.ks / KS.one, here.cs / CS.one, error, levels=bands, cmap="RdBu_r", extend="neither"
            )
            if float(error.min()) < 0.0 < float(error.max()):
                axes.contour(here.ks / KS.one, here.cs / CS.one, error, levels=[0.0], colors="black", linewidths=0.7)
            worst = error.isel(abs(error).argmax(...))
            axes.plot(worst.ks / KS.one, worst.cs / CS.one, "x", color="black", clip_on=False, zorder=3)
            bar = figure.colorbar(image, ax=axes, location="bottom", ticks=mpl.ticker.MaxNLocator(5))
            bar.set_label(f"{surrogate} error of {symbol} ({unit})")
            axes.set_title(symbol)
            axes.set_xlabel(KS.label)
        given[0, 0].set_ylabel(CS.label)
    return figure


def _surfaces(axes: Any, here: xr.Dataset, names: dict[str, str], elevation: float, azimuth: float) -> None:
    x, y = np.meshgrid(here.ks / KS.one, here.cs / CS.one, indexing="ij")
    heights = {kind: here[name].transpose("ks", "cs").values for kind, name in names.items()}
    # Strips of one damping interval, the nearest drawn last; matplotlib sorts by depth within a collection only, where
    # steep strips would show through each other.
    axes.computed_zorder = False
    for j in range(y.shape[1] - 1):
        strips = [_strip(x, y, z, j) for z in heights.values()]
        faces, edges = (
            [to_rgb(SURFACES[kind][part]) for kind, strip in zip(heights, strips, strict=True) for _ in strip]
            for part in (0, 1)
        )
        nearness = j if np.sin(np.radians(azimuth)) > 0.0 else y.shape[1] - j
        axes.add_collection3d(
            Poly3DCollection(
                np.concatenate(strips), facecolors=faces, edgecolors=edges, linewidths=0.25, zorder=10 + nearness
            )
        )
    low, high = (end(list(heights.values())) for end in (np.min, np.max))
    axes.set(xlim=(x.min(), x.max()), ylim=(y.min(), y.max()), zlim=(low, high))
    for axis in (axes.xaxis, axes.yaxis, axes.zaxis):
        axis.set_major_locator(mpl.ticker.MaxNLocator(4))
    axes.tick_params(pad=-3)
    axes.tick_params(axis="z", pad=-0.5)
    axes.view_init(elev=elevation, azim=azimuth)
    axes.set_box_aspect((1.0, 1.0, 0.9), zoom=0.95)


def _strip(x: NDArray, y: NDArray, z: NDArray, j: int) -> NDArray[np.float64]:
    """Facets (n, 4, 3) between the nodes j and j + 1 of the second axis."""
    points = np.stack([x, y, z], axis=-1)
    return np.stack([points[:-1, j], points[1:, j], points[1:, j + 1], points[:-1, j + 1]], axis=1)


def _check(surrogate: str, criteria: Sequence[str] = ()) -> None:
    for what, name, known in [
        ("surrogate", surrogate, SURROGATES),
        *(("criterion", name, CRITERIA) for name in criteria),
    ]:
        if name not in known:
            raise ValueError(f"no {what} named {name!r}, available: {', '.join(known)}")
