"""The page of a fit: the ranking of surrogates, how near they come, and what was taken."""

from __future__ import annotations

import itertools
import shlex
from collections.abc import Collection, Mapping
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pandas as pd

from ...fit.fitting import Fit
from ...fit.next_runs import asked_for
from ...quantities import titled
from ..plots.study import SURFACES
from ..plots.validation import GREY, OTHERS
from ..reproduction import fit_code
from ..text.fit import (
    JUDGED,
    choices,
    failures,
    following,
    following_table,
    judged,
    meaning,
    median_errors,
    more,
    ranking_table,
    stated,
    tie,
    typed,
    unknown,
    worth,
)
from ..versions import versions
from .figures import Figure, marker, plain, plane, scatter, space, style, surface
from .page import number, picture, render

UNTUNED, RUNS = "cheap model, untuned", "runs"

FILLS = (("#56b4e9", "#004a75"), SURFACES["lf"])
"""Faces and lines over the box: of the surrogate taken, and of the cheap model, as in a study."""

INK = "#000000"

SHAPES = {1: "curve", 2: "surface"}
"""What shows a surrogate over the box, by its number of inputs."""

AZIMUTHS = (155.0, 205.0, 25.0, 335.0, 65.0, 115.0, 245.0, 295.0)
"""From where surfaces may be seen, in degrees: a little off either axis, a study's way first."""

SHOWN = 5
"""Values of each input in the table that stands in for that."""

WORST = 10
"""Runs listed as those predicted worst."""


def fit_page(fit: Fit, maps: Mapping[str, Path]) -> str:
    """Return the page of a fit.

    Parameters
    ----------
    fit : Fit
    maps : mapping of str to Path
        For each output a still picture of the surrogate over the box, for print; none where it has not two inputs.
    """
    sections: list[dict[str, Any]] = []
    figures: dict[str, dict[str, Figure]] = {}
    for i, output in enumerate(fit.outputs):
        figures |= {f"{kind}-{i}": views for kind, views in _figures(fit, output).items()}
        still = maps.get(output)
        sections.append({"id": i, "map": still and picture(still), **_section(fit, output)})
    box = fit.surrogate.box
    middle = ",".join(f"{name}={0.5 * (low + high):.5g}" for name, (low, high) in box.items())
    return render(
        "fit.html",
        figures,
        versions=versions(),
        file=fit.runs.path.name,
        count=len(fit.runs.rows),
        quantities=[_quantity(fit, name) for name in (*box, *fit.outputs)],
        cheap=f"{type(fit.low_fidelity.vehicle).__name__}; {fit.low_fidelity.road.describe()}",
        unknown=unknown(fit),
        judged=f"{JUDGED} {choices(fit)}",
        outputs=sections,
        following=_following(fit),
        predict=f"susp-ss predict surrogate.json --at {shlex.quote(middle)}",
        code=fit_code(fit),
    )


def _following(fit: Fit) -> dict[str, Any] | None:
    """The next runs, if they were asked for."""
    plan = asked_for(fit)
    if plan is None:
        return None
    table = following_table(fit, plan)
    return {
        "said": " ".join(following(fit, plan)),
        "columns": list(table.columns),
        "rows": list(zip(table.index, table.to_numpy().tolist(), strict=True)),
    }


def _quantity(fit: Fit, name: str) -> tuple[str, str, float, float, str]:
    """A column of the runs: its name here and in the file, its ends and its unit."""
    (values,) = _columns(fit, (name,))
    return name, fit.runs.columns[name], min(values), max(values), fit.runs.units[name]


def _section(fit: Fit, output: str) -> dict[str, Any]:
    """What is said of an output."""
    found, unit = fit.outputs[output], fit.runs.units[output]
    ranking = ranking_table(found, unit)
    learning = None if found.learning is None else median_errors(found)
    return {
        "name": output,
        "meaning": meaning(fit, output),
        "unit": unit,
        "low": float(fit.runs.responses[output].min()),
        "high": float(fit.runs.responses[output].max()),
        "taken": found.chosen,
        "first": judged(fit, output),
        "predicts": found.verdict.predicts,
        "said": [*tie(found), worth(fit, found), *stated(found)],
        "more": more(fit, output),
        "columns": list(ranking.columns),
        "rows": list(zip(ranking.index, ranking.to_numpy().tolist(), strict=True)),
        "boxes": _boxes(fit, output),
        "shape": SHAPES.get(len(fit.surrogate.inputs)),
        "numbers": _numbers(fit, output),
        "failures": failures(found),
        "typed": typed(found, unit),
        "formula": None if found.formula is None else found.formula[1],
        "worst": _worst(fit, output),
        "learning": None if learning is None else (learning.columns.tolist(), dict(learning.T.items())),
    }


class Box(NamedTuple):
    """What shows and hides a trace: its name and colour, if its marker is open, and if it is shown at first."""

    name: str
    colour: str
    open: bool
    shown: bool


def _boxes(fit: Fit, output: str) -> dict[str, list[Box]]:
    """The boxes of each plot; of surrogates the foremost are shown, of learning curves the others in grey."""
    found = fit.outputs[output]
    surrogates = []
    for i, name in enumerate(found.comparison.table.index):
        colour, marker = style(i)
        surrogates.append(Box(name, colour, marker.endswith("-open"), name in found.foremost))
    curves = [box for box in surrogates if box.shown]
    if len(curves) < len(surrogates):
        curves.append(Box(OTHERS, GREY, False, True))
    names = [found.chosen, *([] if found.untuned is None else [UNTUNED])]
    faces, lines = (
        [
            *(Box(name, fill[part], False, True) for name, fill in zip(names, FILLS, strict=False)),
            Box(RUNS, INK, False, True),
        ]
        for part in (0, 1)
    )
    return {"parity": surrogates, "learning": curves, "curve": lines, "surface": faces}


def _figures(fit: Fit, output: str) -> dict[str, dict[str, Figure]]:
    """Every plot of an output, and the views of each."""
    found, shape = fit.outputs[output], SHAPES.get(len(fit.surrogate.inputs))
    figures = {"parity": _parity(fit, output)}
    if shape is not None:
        figures[shape] = {"": {"surface": _surface, "curve": _curve}[shape](fit, output)}
    if found.learning is not None:
        figures["learning"] = {"": _learning(median_errors(found), found.foremost, fit.runs.units[output])}
    return figures


def _parity(fit: Fit, output: str) -> dict[str, Figure]:
    """Predicted against expensive response, runs left out, and the error alone."""
    found, unit, y = fit.outputs[output], fit.runs.units[output], fit.runs.responses[output]
    ends, texts = (float(y.min()), float(y.max())), _texts(fit)
    numbers = {"expensive": "x:.5g", "predicted": "customdata[0]:.5g", "error": "customdata[1]:.3g"}
    hover = "<br>".join(["%{text}", *(f"{what} %{{{value}}} {plain(unit)}" for what, value in numbers.items())])
    figures = {}
    for view, side, agreed in (("prediction", "predicted response", ends), ("error", "error", (0.0, 0.0))):
        data: list[dict[str, Any]] = [
            scatter("agreement", ends, agreed, "", mode="lines", line={"color": "#7f7f7f"}, hoverinfo="skip")
        ]
        for i, name in enumerate(found.comparison.table.index):
            one = found.comparison.validations[name]
            rest: dict[str, Any] = {
                "text": texts,
                "customdata": np.stack([one.predicted, one.residuals], axis=-1).tolist(),
            }
            rest["error_y"] = {"array": one.allowance.tolist(), "thickness": 1, "width": 3}
            height = {"prediction": one.predicted, "error": one.residuals}[view]
            data.append(scatter(name, one.y, height, hover, mode="markers", marker=marker(*style(i)), **rest))
        titles = (plain(titled(name, unit)) for name in ("expensive response", side))
        figures[view] = {"data": data, "layout": plane(*titles)}
    return figures


def _surface(fit: Fit, output: str, count: int = 25) -> Figure:
    """The surrogate taken over the box of two inputs, the cheap model as it is, and the runs."""
    names, units = (*fit.surrogate.inputs, output), fit.runs.units
    x, y = (np.linspace(*bounds, count) for bounds in fit.surrogate.box.values())
    X = np.stack([axis.ravel() for axis in np.meshgrid(x, y)], axis=-1)
    hover = "<br>".join(
        f"{plain(name)} %{{{axis}:.5g}} {plain(units[name])}" for name, axis in zip(names, "xyz", strict=True)
    )
    data: list[dict[str, Any]] = [
        surface(name, x, y, z.reshape(count, count), fill, hover)
        for fill, (name, z) in zip(FILLS, _predicted(fit, output, X).items(), strict=False)
    ]
    runs = {
        "type": "scatter3d",
        "name": RUNS,
        "mode": "markers",
        **dict(zip("xyz", _columns(fit, names), strict=True)),
        "text": _texts(fit),
        "marker": {"size": 4, "color": INK},
        "hovertemplate": f"%{{text}}<br>{plain(output)} %{{z:.5g}} {plain(units[output])}<extra></extra>",
    }
    titles = [plain(titled(name, units[name])) for name in names]
    return {"data": [*data, runs], "layout": space(titles, _azimuth(fit))}


def _azimuth(fit: Fit) -> float:
    """From where the surfaces of all outputs show their upper faces: where none rises steeply towards the eye."""
    corners = pd.DataFrame(itertools.product(*fit.surrogate.box.values()), columns=list(fit.surrogate.inputs))
    heights = fit.surrogate.predict(corners)[list(fit.outputs)].to_numpy().reshape(2, 2, -1)
    slopes = np.stack([np.diff(heights.mean(axis=1 - axis), axis=0)[0] for axis in (0, 1)])
    slopes /= np.abs(slopes).max(axis=0) + np.finfo(float).tiny
    towards = np.radians(AZIMUTHS)
    rises = np.outer(np.cos(towards), slopes[0]) + np.outer(np.sin(towards), slopes[1])
    return AZIMUTHS[int(rises.max(axis=1).argmin())]


def _curve(fit: Fit, output: str, count: int = 200) -> Figure:
    """The surrogate taken over its one input, the cheap model as it is, and the runs."""
    ((name, bounds),) = fit.surrogate.box.items()
    x, unit = np.linspace(*bounds, count), plain(fit.runs.units[output])
    curves = _predicted(fit, output, x[:, None])
    data = [
        scatter(label, x, y, f"%{{x:.5g}}, %{{y:.5g}} {unit}", mode="lines", line={"color": colour, "dash": dash})
        for (label, y), (_, colour), dash in zip(curves.items(), FILLS, ("solid", "dash"), strict=False)
    ]
    hover = f"%{{text}}<br>%{{y:.5g}} {unit}"
    given, responses = _columns(fit, (name, output))
    runs = scatter(RUNS, given, responses, hover, mode="markers", marker=marker(INK, "circle"), text=_texts(fit))
    return {
        "data": [*data, runs],
        "layout": plane(*(plain(titled(one, fit.runs.units[one])) for one in (name, output))),
    }


def _learning(medians: pd.DataFrame, foremost: Collection[str], unit: str) -> Figure:
    """Median error against the number of runs, of the foremost in colour above the others in grey."""
    others, data = [], []
    for i, (name, row) in enumerate(medians.iterrows()):
        known = row.dropna().astype(float)
        hover = f"{plain(str(name))}, %{{x}} runs: %{{y:.3g}} {plain(unit)}"
        if name in foremost:
            look = {"mode": "lines+markers", "marker": marker(*style(i))}
            data.append(scatter(str(name), known.index, known, hover, **look))
        else:
            thin = {"mode": "lines", "line": {"color": GREY, "width": 1}}
            others.append(scatter(OTHERS, known.index, known, hover, **thin))
    layout = plane("expensive runs", plain(titled("RMSE", unit)))
    layout["xaxis"] |= {"type": "log", "tickvals": medians.columns.tolist(), "ticktext": [*map(str, medians.columns)]}
    layout["yaxis"] |= {"type": "log", "dtick": "D2"}
    return {"data": others + data, "layout": layout}


def _predicted(fit: Fit, output: str, X: np.ndarray) -> dict[str, np.ndarray]:
    """The surrogate taken and the cheap model as it is, at designs within the box of the runs."""
    names, found = list(fit.surrogate.inputs), fit.outputs[output]
    cheap = fit.low_fidelity.response(output, names)
    predicted = {found.chosen: found.model.predict(pd.DataFrame(X, columns=names))}
    return predicted if cheap is None else predicted | {UNTUNED: cheap(X)}


def _numbers(fit: Fit, output: str) -> dict[str, Any] | None:
    """What stands in for a surface or curve: its values at a few designs."""
    box, units = fit.surrogate.box, fit.runs.units
    if len(box) not in SHAPES:
        return None
    X = np.stack(np.meshgrid(*(np.linspace(*bounds, SHOWN) for bounds in box.values()), indexing="ij"), axis=-1)
    designs = X.reshape(-1, len(box))
    predicted = _predicted(fit, output, designs)
    return {
        "columns": [
            *(titled(name, units[name]) for name in box),
            *(titled(name, units[output]) for name in predicted),
        ],
        "rows": np.column_stack([designs, *predicted.values()]).tolist(),
    }


def _columns(fit: Fit, names: tuple[str, ...]) -> list[list[float]]:
    table = pd.concat([fit.runs.designs, fit.runs.responses], axis=1)
    return [table[name].tolist() for name in names]


def _texts(fit: Fit) -> list[str]:
    """What each run says of itself: where it stands in its file, and its design."""
    word, units = fit.runs.row_word, fit.runs.units
    designs = fit.runs.designs.to_dict("records")
    return [
        "<br>".join(
            [f"{word} {row}", *(plain(f"{name} {value:.5g} {units[str(name)]}") for name, value in design.items())]
        )
        for row, design in zip(fit.runs.rows.tolist(), designs, strict=True)
    ]


def _worst(fit: Fit, output: str) -> dict[str, Any]:
    """The runs that the surrogate taken predicted worst when they were left out."""
    one = fit.outputs[output].comparison.validations[fit.outputs[output].chosen]
    order = np.abs(one.residuals).argsort()[::-1][:WORST]
    designs, rows = fit.runs.designs.to_numpy(), fit.runs.rows
    return {
        "columns": [fit.runs.row_word, *fit.surrogate.inputs, "expensive", "predicted", "error"],
        "rows": [
            [
                str(rows[i]),
                *map(number, (*designs[i], one.y[i], one.predicted[i])),
                number(one.residuals[i], 3),
            ]
            for i in order
        ],
    }
