"""A study as text for the terminal and as files in a folder."""

from __future__ import annotations

import json
import textwrap
from collections.abc import Iterator
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd

from .published import (
    ACCURACY,
    COEFFICIENTS,
    CRITERIA,
    FIGURES,
    LABELS,
    SURROGATES,
    TABLES,
    agreement,
    published,
    ranking,
)
from .results_folder import write_results
from .versions import versions

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from .study import Study

TITLE = "Feasibility study of surrogate model for the application of vehicle suspension system, 2021"

PAGE = "report.html"

DATA = ("tables.csv", "tables.json", "responses.nc", PAGE)
PICTURES = {
    **{
        f"surfaces_{name}": f"figures/{FIGURES[name].lower().replace(' ', '_')}_{name}_surfaces.png"
        for name in SURROGATES
    },
    **{f"errors_{name}": f"figures/error_map_{name}.png" for name in SURROGATES},
    "bode_magnitude": "figures/bode_magnitude.png",
}
FIGURE_FILES = tuple(PICTURES.values())


def text(study: Study) -> str:
    """Tables 3 to 5 with ours beside the published values, what agrees, held-out accuracy and cost."""
    entries = study.comparison()
    blocks = [
        f"Feasibility study: {study.describe()}",
        _paragraph(
            "The published study does not state its road, speed or place of measurement. The scenario is a choice of "
            "this package; nothing is tuned to the published tables."
        ),
    ]
    for surrogate in SURROGATES:
        lines = [f"{TABLES[surrogate]}. {surrogate}: {SURROGATES[surrogate]}", _table(entries, surrogate)]
        blocks.append("\n".join([*lines, _paragraph(f"Agreement: {agreement(entries, surrogate)}.")]))
    blocks += [_best(study), _held_out(study), _cost(study)]
    return "\n\n".join(blocks) + "\n"


def _table(entries: pd.DataFrame, surrogate: str) -> str:
    values = {
        (row["criterion"], row["quantity"]): (row["ours"], row["published"])
        for row in entries[entries.surrogate == surrogate].to_dict("records")
    }
    head = [f"{LABELS[criterion]} ({unit})" for criterion, unit in CRITERIA.items()]
    lines = [" " * 6 + "".join(f"{name:>26}" for name in head)]
    lines.append(" " * 6 + f"{'ours':>14}{'published':>12}" * len(CRITERIA))
    for quantity in (*reversed(ACCURACY), *COEFFICIENTS[surrogate]):
        pairs = [values[criterion, quantity] for criterion in CRITERIA]
        shown = "".join(f"{_number(ours):>14}{_number(theirs):>12}" for ours, theirs in pairs)
        lines.append(f"{'Ms, kg' if quantity == 'ms' else quantity:<6}{shown}")
    return "\n".join(lines)


def _best(study: Study) -> str:
    ours, theirs = ranking(study.accuracy), ranking(published().accuracy)
    said = [f"{LABELS[criterion]} {ours[criterion]} (published {theirs[criterion]})" for criterion in CRITERIA]
    return _paragraph(f"Surrogates by R2: {', '.join(said)}.")


def _held_out(study: Study) -> str:
    lines = [
        "Held-out accuracy: the same fits halfway between the nodes, where none was fitted (R2, RMSE as a multiple of",
        "that at the nodes)",
    ]
    ratio = study.held_out["RMSE"] / study.accuracy["RMSE"]
    for surrogate in SURROGATES:
        cells = [
            f"{LABELS[criterion]} {study.held_out['R2'][surrogate, criterion]:.4f}, x{ratio[surrogate, criterion]:.2f}"
            for criterion in CRITERIA
        ]
        lines.append(f"{surrogate:<6}" + "".join(f"{cell:>26}" for cell in cells))
    return "\n".join(lines)


def _cost(study: Study) -> str:
    count = study.nodes[0] * study.nodes[1]
    lf, hf = (study.seconds[name] / count * 1e6 for name in ("lf", "hf"))
    lines = [
        _paragraph(
            f"Cost: measured here, a full car takes {hf:.0f} us and a quarter car {lf:.0f} us, {count} designs at "
            "once. High-fidelity designs that bring the RMSE within 5 % of the fit to all nodes, of 5, 10 and 25 "
            "tried (unknowns of the fit in brackets):"
        )
    ]
    for surrogate, names in COEFFICIENTS.items():
        cells = [f"{LABELS[criterion]} {_enough(study.cost['enough'][surrogate, criterion])}" for criterion in CRITERIA]
        lines.append(f"{surrogate} ({len(names)})" + "".join(f"{cell:>26}" for cell in cells))
    return "\n".join(lines)


def _enough(number: float) -> str:
    return "more than 25" if np.isnan(number) else f"{number:.0f}"


def _number(value: float) -> str:
    return "-" if np.isnan(value) else f"{value:.5g}"


def _paragraph(sentence: str) -> str:
    return textwrap.fill(sentence, 96)


def save(study: Study, folder: str | PathLike[str], force: bool, figures: bool) -> None:
    """Write a study's files; see `Study.save`."""
    write_results(folder, lambda empty: _write(study, empty, figures), (*DATA, *FIGURE_FILES), force)


def _write(study: Study, folder: Path, figures: bool) -> None:
    from .pages.study import study_page

    tables = document(study)
    study.comparison().to_csv(folder / "tables.csv", index=False)
    (folder / "tables.json").write_text(json.dumps(tables, indent=2, allow_nan=False) + "\n", encoding="utf-8")
    study.responses.to_netcdf(folder / "responses.nc", engine="netcdf4")
    pictures = _draw(study, folder) if figures else {}
    (folder / PAGE).write_text(study_page(study, tables, pictures), encoding="utf-8")


def _draw(study: Study, folder: Path) -> dict[str, Path]:
    """Save the figures; return where each is."""
    from .plots import DPI

    (folder / "figures").mkdir()
    for name, figure in zip(PICTURES.values(), _figures(study), strict=True):
        figure.savefig(folder / name, dpi=DPI)
    return {name: folder / file for name, file in PICTURES.items()}


def _figures(study: Study) -> Iterator[Figure]:
    """In the order of PICTURES."""
    from . import plots

    for draw in (plots.response_surfaces, plots.error_map):
        for surrogate in SURROGATES:
            yield draw(study, surrogate)
    yield plots.bode_magnitude(plots.study_curves(study.corner))


def document(study: Study) -> dict[str, Any]:
    """Everything but the responses, as JSON knows it: NaN becomes null."""
    tables: dict[str, Any] = {surrogate: {criterion: {} for criterion in CRITERIA} for surrogate in SURROGATES}
    for row in study.comparison().to_dict("records"):
        entry = {"unit": row["unit"], "ours": _json(row["ours"]), "published": _json(row["published"])}
        tables[row["surrogate"]][row["criterion"]][row["quantity"]] = entry
    return {
        "study": TITLE,
        "scenario": {
            "road": study.road.describe(),
            "corner": study.corner,
            "nodes": list(study.nodes),
            "nonnegative": study.nonnegative,
            "statistic": "root mean square",
        },
        "note": "The published study states no scenario; this one is a choice, and nothing is tuned to its tables.",
        "tables": tables,
        "held_out": _nested(study.held_out),
        "cost": _nested(study.cost),
        "seconds": study.seconds,
        "versions": versions(),
    }


def _nested(frame: pd.DataFrame) -> dict[str, Any]:
    """A frame by (surrogate, criterion) as dictionaries in dictionaries."""
    nested: dict[str, Any] = {surrogate: {} for surrogate in SURROGATES}
    for key, row in zip(frame.index, frame.to_dict("records"), strict=True):
        nested[key[0]][key[1]] = {str(name): _json(value) for name, value in row.items()}
    return nested


def _json(value: float) -> float | None:
    return float(value) if np.isfinite(value) else None
