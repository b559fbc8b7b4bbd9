"""Parts of figures as plotly has them: traces and layouts, plain dicts."""

from __future__ import annotations

import html
import math
from collections.abc import Iterable
from typing import Any

from numpy.typing import NDArray

from ...quantities import typeset
from ..plots.study import VIEW
from ..plots.validation import COLOURS

Figure = dict[str, Any]

FONT = {"family": "system-ui, sans-serif", "size": 13, "color": "#1b1b1b"}

DISTANCE = 2.75
"""Of the eye from the middle of a cube of side 1."""

# Beside the colours of the printed pictures, a marker for each.
MARKERS = ("circle", "square", "triangle-up", "diamond", "triangle-down", "cross", "x", "triangle-left", "star")

# From too low over right to too high: ColorBrewer's RdBu, which colour-blind readers can tell apart.
DIVERGING = [[0.0, "#2166ac"], [0.25, "#92c5de"], [0.5, "#f7f7f7"], [0.75, "#f4a582"], [1.0, "#b2182b"]]


def plain(text: str) -> str:
    """Text as plotly shows it, whoever wrote it: without tags and templates of plotly's own."""
    return html.escape(typeset(text), quote=False).replace("%{", "%&#123;")


def style(i: int) -> tuple[str, str]:
    """Colour and marker of the i-th of several curves or clouds; the second time round, markers are open."""
    again, first = divmod(i, len(MARKERS))
    return COLOURS[first], MARKERS[first] + ("-open" if again else "")


def surface(
    name: str, x: NDArray, y: NDArray, z: NDArray, colours: tuple[str, str], hover: str, lines: int = 20
) -> dict[str, Any]:
    """Heights z (y, x) in one colour, with lines in another, so that surfaces that cross can be told apart."""
    face, edge = colours
    return {
        "type": "surface",
        "name": name,
        "x": x.tolist(),
        "y": y.tolist(),
        "z": z.tolist(),
        "colorscale": [[0.0, face], [1.0, face]],
        "showscale": False,
        "contours": {
            axis: {
                "show": True,
                "start": float(along[0]),
                "end": float(along[-1]),
                "size": float(along[-1] - along[0]) / lines,
                "color": edge,
                "highlight": False,
            }
            for axis, along in (("x", x), ("y", y))
        },
        "lighting": {"ambient": 0.8, "diffuse": 0.4, "specular": 0.05},
        "hovertemplate": f"{hover}<extra>{plain(name)}</extra>",
    }


def space(titles: Iterable[str], azimuth: float, revision: str = "") -> dict[str, Any]:
    """Layout of a plot in three dimensions; the same revision keeps what the reader has turned."""
    axes = {f"{axis}axis": {"title": {"text": title}} for axis, title in zip("xyz", titles, strict=True)}
    elevation, around = math.radians(VIEW[0]), math.radians(azimuth)
    sides = math.cos(elevation) * math.cos(around), math.cos(elevation) * math.sin(around), math.sin(elevation)
    eye = {axis: DISTANCE * side for axis, side in zip("xyz", sides, strict=True)}
    # A little to the right on the screen, so that the title of the vertical axis fits a phone.
    center = {"x": 0.1 * math.sin(around), "y": -0.1 * math.cos(around), "z": -0.12}
    camera = {"eye": eye, "center": center}
    return {
        "scene": {**axes, "aspectmode": "cube", "camera": camera, "uirevision": revision},
        "font": FONT,
        "margin": {"l": 0, "r": 0, "t": 0, "b": 0},
        "showlegend": False,
        "uirevision": revision,
    }


def plane(x: str, y: str, title: str = "") -> dict[str, Any]:
    """Layout of a plot in two dimensions."""
    look = {"gridcolor": "#d9d9d9", "zeroline": False, "linecolor": "#1b1b1b", "ticks": "outside", "automargin": True}
    return {
        "xaxis": {"title": {"text": x}, **look},
        "yaxis": {"title": {"text": y}, **look},
        "title": {"text": title, "font": {"size": 14}},
        "font": FONT,
        "margin": {"l": 10, "r": 10, "t": 40 if title else 10, "b": 10},
        "plot_bgcolor": "#ffffff",
        "hovermode": "closest",
        "showlegend": False,
    }


def scatter(name: str, x: Iterable[float], y: Iterable[float], hover: str, **look: Any) -> dict[str, Any]:
    """A trace in a plane; ``hover`` is a template of plotly's."""
    return {
        "type": "scatter",
        "name": name,
        "x": list(map(float, x)),
        "y": list(map(float, y)),
        "hovertemplate": f"{hover}<extra>{plain(name)}</extra>",
        **look,
    }


def marker(colour: str, symbol: str) -> dict[str, Any]:
    """A point's look."""
    return {"color": colour, "symbol": symbol, "size": 7}
