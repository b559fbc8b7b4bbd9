"""How near scenarios come to the published tables."""

from __future__ import annotations

from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure

from ...study.scan import Scan
from .style import COLUMN, LINES, STYLE, panels

NAMES = {
    "excited": "excited wheels",
    "tracks": "tracks",
    "delay": "axle delay",
    "speed": "speed (m/s)",
    "waviness": "waviness",
    "cutoff": "cut-off (cycle/m)",
    "place": "place of metrics",
    "road_class": "road class",
    "fit": "fit",
}


def scenario_scan(scan: Scan, ax: Any = None) -> Figure:
    """Distance to the published tables by assumption: which one can come near, and which one matters.

    Parameters
    ----------
    scan : Scan
        From `susp_ss.study.scan_scenarios`.
    ax : Axes, optional

    Returns
    -------
    matplotlib.figure.Figure
        A group of rows an assumption, a row a level, a dot a scenario. The black mark is the nearest that a level
        comes, whatever the other assumptions; groups in which these marks differ most stand first. Scenarios
        without finite variance have no distance: their number stands at the right.

    Raises
    ------
    ValueError
        No scenario has a distance.

    Examples
    --------
    >>> import pandas as pd
    >>> from susp_ss.presentation.plots import scenario_scan
    >>> from susp_ss.study.scan import DEFAULT, FACTORS, Scan
    >>> usual = dict(zip(FACTORS, DEFAULT)) | {"refused": ""}
    >>> table = pd.DataFrame([usual | {"speed": v, "distance": v / 10.0} for v in (10.0, 20.0, 30.0)])
    >>> [label.get_text() for label in scenario_scan(Scan(table)).axes[0].get_yticklabels()][:4]
    ['speed (m/s)', '10', '20', '30']
    """
    table = scan.scenarios
    if not np.isfinite(table["distance"]).any():
        raise ValueError("no scenario of the table has a distance")
    nearest = scan.nearest_by_factor()
    reach = nearest.groupby("factor", sort=False)["distance"].agg(lambda d: d.max() - d.min())
    rows = [
        row
        for factor in reach.sort_values(ascending=False, kind="stable").index
        for row in [(factor, None), *((factor, level) for level in nearest.query("factor == @factor")["level"])]
    ]
    shift = np.random.default_rng(0).uniform(-0.3, 0.3, len(table))
    with mpl.rc_context(STYLE):
        figure, given = panels(ax, 1, 1, (COLUMN, 0.5 + 0.135 * len(rows)))
        axes = given[0, 0]
        margin = axes.get_yaxis_transform()
        axes.text(1.02, -0.7, "infinite", transform=margin, fontsize=6, color="0.35")
        for at, (factor, level) in enumerate(rows):
            if level is None:
                continue
            distance = table["distance"].where(table[factor] == level).to_numpy()
            axes.scatter(distance, at + shift, s=2, color=LINES[1][0], alpha=0.25, linewidth=0, rasterized=True)
            refused = int((table[factor] == level).sum() - np.isfinite(distance).sum())
            if np.isfinite(distance).any():
                axes.plot(np.nanmin(distance), at, "|", color="black", markersize=8, markeredgewidth=2)
            if refused:
                axes.text(1.02, at, str(refused), transform=margin, va="center", fontsize=6, color="0.35")
        labels = [NAMES[factor] if level is None else _level(level) for factor, level in rows]
        axes.set_yticks(range(len(rows)), labels)
        for label, (_, level) in zip(axes.get_yticklabels(), rows, strict=True):
            label.set_fontweight("bold" if level is None else "normal")
        axes.tick_params(axis="y", length=0)
        axes.set_ylim(len(rows) - 0.5, -0.5)
        axes.set_xscale("log")
        axes.set_xlabel("distance to the published tables")
        axes.grid(axis="x", which="major", linewidth=0.4, color="0.8")
    return figure


def _level(level: Any) -> str:
    return f"{level:g}" if isinstance(level, float) else str(level)
