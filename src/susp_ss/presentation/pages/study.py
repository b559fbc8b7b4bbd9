"""The page of a study: its tables beside the published ones, response surfaces and error maps."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.ticker import MaxNLocator

from ...quantities import KNOWN, titled
from ...study.feasibility import Study
from ...study.published import (
    CRITERIA,
    FIGURES,
    LABELS,
    SURROGATES,
    TABLES,
    agreement,
    published,
    ranking,
    relative_differences,
)
from ..plots.study import AXES, ERROR_AXES, SURFACES, VIEW
from ..plots.study import CS as DAMPER
from ..plots.study import KS as SPRING
from ..reproduction import study_code, study_command
from ..text.study import CELLS, landed, landings, sought
from .figures import DIVERGING, Figure, marker, plane, scatter, space, surface
from .page import number, picture, render, subscripted

RESPONSES = {"hf": "full car", "lf": "quarter car", **{name: name for name in SURROGATES}}

FILLS = {"hf": SURFACES["hf"], "lf": SURFACES["lf"]} | {
    # Okabe and Ito's vermilion, green and purple beside the study's cyan and yellow.
    "RB": ("#d55e00", "#6b2f00"),
    "VB": ("#009e73", "#004f39"),
    "PB": ("#cc79a7", "#663c53"),
}

SPRINGS, DAMPERS = (subscripted(KNOWN[name].symbol) for name in ("ks", "cs"))
KS, CS = titled(SPRINGS, SPRING.unit), titled(DAMPERS, DAMPER.unit)
DESIGN = f"{SPRINGS} %{{x:.2f}} {SPRING.unit}<br>{DAMPERS} %{{y:.3f}} {DAMPER.unit}<br>"

BANDS = 15
"""Of an error map, an odd number, so that small errors of either sign share the neutral one."""

SHOWN = 5
"""Springs and dampers of the table that stands in for a surface."""


def study_page(study: Study, document: dict[str, Any], pictures: Mapping[str, Path]) -> str:
    """Return the page of a study.

    Parameters
    ----------
    study : Study
    document : dict
        What ``tables.json`` holds.
    pictures : mapping of str to Path
        Still pictures, for print, as in `save.PICTURES`; or none at all.
    """
    entries = study.comparison()
    figures = {"surfaces": _surfaces(study), **{f"errors-{name}": _errors(study, name) for name in SURROGATES}}
    first = study.accuracy["R2"].xs(next(iter(CRITERIA)), level="criterion").idxmax()
    return render(
        "study.html",
        figures,
        document=document,
        versions=document["versions"],
        scenario=study.describe(),
        criteria={name: titled(LABELS[name], unit) for name, unit in CRITERIA.items()},
        labels=LABELS,
        surrogates=SURROGATES,
        tables=TABLES,
        printed_figures=FIGURES,
        as_published=study.as_published,
        agreement={surrogate: agreement(entries, surrogate) for surrogate in SURROGATES if study.as_published},
        ratios=_ratios(study),
        ranking=(ranking(study.accuracy), ranking(published().accuracy)),
        responses={caption: FILLS[name][0] for name, caption in RESPONSES.items()},
        drawn=("full car", "quarter car", first),
        numbers={criterion: _numbers(study, criterion) for criterion in CRITERIA},
        errors={criterion: _error_sentences(study, criterion) for criterion in CRITERIA},
        landings=landings(study.optima),
        sought=sought(study),
        cells=CELLS,
        landed=landed(study),
        pictures={name: picture(path) for name, path in pictures.items()},
        code=study_code(study),
        command=study_command(study),
    )


def _surfaces(study: Study) -> dict[str, Figure]:
    """For each criterion the responses of both cars and of every surrogate over spring and damper."""
    figures = {}
    for criterion, (symbol, unit, one) in AXES.items():
        here = study.responses.sel(criterion=criterion).transpose("cs", "ks")
        hover = f"{DESIGN}{symbol} %{{z:.5g}} {unit}"
        data = [
            surface(caption, *_axes(here), here[name].values / one, FILLS[name], hover)
            for name, caption in RESPONSES.items()
        ]
        figures[criterion] = {
            "data": data,
            "layout": space((KS, CS, AXES[criterion].label), VIEW[1], revision=criterion),
        }
    return figures


def _errors(study: Study, surrogate: str) -> dict[str, Figure]:
    """For each criterion the error of a surrogate over spring and damper, and where it is largest."""
    figures = {}
    for criterion, (symbol, unit, _) in ERROR_AXES.items():
        error = _error(study, surrogate, criterion)
        x, y = _axes(error)
        limit = max(float(np.abs(error).max()), np.finfo(float).tiny)
        size = 2.0 * limit / BANDS
        contour = {
            "type": "contour",
            "name": "error",
            "x": x.tolist(),
            "y": y.tolist(),
            "z": error.values.tolist(),
            "zmin": -limit,
            "zmax": limit,
            "colorscale": DIVERGING,
            "contours": {"start": -limit + size, "end": limit - size, "size": size},
            "line": {"width": 0.5, "color": "#595959"},
            "colorbar": {
                "title": {"text": unit},
                "tickvals": [tick for tick in MaxNLocator(5).tick_values(-limit, limit) if abs(tick) <= limit],
                "thickness": 14,
                "exponentformat": "power",
                "outlinewidth": 0.5,
            },
            "hovertemplate": f"{DESIGN}error %{{z:.4g}} {unit}<extra>{surrogate}</extra>",
        }
        worst = _worst(error)
        at = [float(worst.ks) / SPRING.one], [float(worst.cs) / DAMPER.one]
        look: dict[str, Any] = {"mode": "markers", "marker": marker("#000000", "x"), "cliponaxis": False}
        mark = scatter("largest error", *at, f"{float(worst):.4g} {unit}", **look)
        layout = plane(KS, CS, f"{surrogate}: error of {symbol}")
        for axis, along in (("xaxis", x), ("yaxis", y)):
            layout[axis]["range"] = [float(along[0]), float(along[-1])]
        figures[criterion] = {"data": [contour, mark], "layout": layout}
    return figures


def _error(study: Study, surrogate: str, criterion: str) -> xr.DataArray:
    """``S - F`` (cs, ks) in the unit of an error map."""
    here = study.responses.sel(criterion=criterion).transpose("cs", "ks")
    return (here[surrogate] - here["hf"]) / ERROR_AXES[criterion].one


def _worst(error: xr.DataArray) -> xr.DataArray:
    return error.isel(abs(error).argmax(...))


def _axes(here: xr.Dataset | xr.DataArray) -> tuple[Any, Any]:
    return here.ks.values / SPRING.one, here.cs.values / DAMPER.one


def _error_sentences(study: Study, criterion: str) -> list[str]:
    """The error maps of a criterion in words."""
    unit, sentences = ERROR_AXES[criterion].unit, []
    for surrogate in SURROGATES:
        error = _error(study, surrogate, criterion)
        worst = _worst(error)
        sentences.append(
            f"{surrogate}: {number(float(error.min()), 3)} to {number(float(error.max()), 3)} {unit}, largest at K_s = "
            f"{float(worst.ks) / SPRING.one:.4g} {SPRING.unit} and C_s = {float(worst.cs) / DAMPER.one:.4g} "
            f"{DAMPER.unit}."
        )
    return sentences


def _numbers(study: Study, criterion: str) -> dict[str, Any]:
    """The surfaces of a criterion at a few nodes."""
    _, unit, one = AXES[criterion]
    here = study.responses.sel(criterion=criterion) / one
    few = here.isel({name: _few(here.sizes[name]) for name in ("ks", "cs")})
    rows = [
        [float(ks) / SPRING.one, float(cs) / DAMPER.one, *(float(few[name].sel(ks=ks, cs=cs)) for name in RESPONSES)]
        for ks in few.ks.values
        for cs in few.cs.values
    ]
    return {"unit": unit, "rows": rows}


def _few(count: int) -> list[int]:
    return sorted({round(i) for i in np.linspace(0, count - 1, SHOWN)})


def _ratios(study: Study) -> dict[tuple[str, str, str], float]:
    """Ours as a multiple of the published value, where that can be compared with."""
    if not study.as_published:
        return {}
    entries = study.comparison()
    known = entries.loc[relative_differences(entries).index]
    keys = zip(known.surrogate, known.criterion, known.quantity, strict=True)
    return dict(zip(keys, (known.ours / known.published).tolist(), strict=True))
