"""A study as text for the terminal."""

from __future__ import annotations

import textwrap

import numpy as np
import pandas as pd

from ...quantities import titled, typeset
from ...study.feasibility import Study
from ...study.published import (
    ACCURACY,
    COEFFICIENTS,
    CRITERIA,
    LABELS,
    SURROGATES,
    TABLES,
    agreement,
    published,
    ranking,
)

WIDTH = 96


def study_text(study: Study) -> str:
    """Tables 3 to 5 with ours beside the published values, what agrees, held-out accuracy and cost."""
    entries = study.comparison()
    blocks = [f"Feasibility study: {typeset(study.describe())}"]
    if study.as_published:
        blocks.append(
            _paragraph(
                "The published study does not state its road, speed or place of measurement. The scenario is a choice "
                "of this package; nothing is tuned to the published tables."
            )
        )
    for surrogate in SURROGATES:
        title = f"{TABLES[surrogate]}. " if study.as_published else ""
        lines = [f"{title}{surrogate}: {SURROGATES[surrogate]}", _table(entries, surrogate, study.as_published)]
        if study.as_published:
            lines.append(_paragraph(f"Agreement: {agreement(entries, surrogate)}."))
        blocks.append("\n".join(lines))
    blocks += [_best(study), _held_out(study), _cost(study)]
    return "\n\n".join(blocks) + "\n"


def _table(entries: pd.DataFrame, surrogate: str, beside: bool) -> str:
    """A surrogate's accuracy and coefficients, beside the published ones or alone."""
    values = {
        (row["criterion"], row["quantity"]): (row["ours"], row["published"])
        for row in entries[entries.surrogate == surrogate].to_dict("records")
    }
    head = [titled(LABELS[criterion], unit) for criterion, unit in CRITERIA.items()]
    lines = [" " * 6 + "".join(f"{name:>26}" for name in head)]
    if beside:
        lines.append(" " * 6 + f"{'ours':>14}{'published':>12}" * len(CRITERIA))
    for quantity in (*reversed(ACCURACY), *COEFFICIENTS[surrogate]):
        pairs = [values[criterion, quantity] for criterion in CRITERIA]
        shown = "".join(f"{_number(ours):>14}{_number(theirs) if beside else '':>12}" for ours, theirs in pairs)
        lines.append(f"{'Ms, kg' if quantity == 'ms' else quantity:<6}{shown}")
    return "\n".join(lines)


def _best(study: Study) -> str:
    ours, theirs = ranking(study.accuracy), ranking(published().accuracy)
    published_too = {c: f" (published {theirs[c]})" if study.as_published else "" for c in CRITERIA}
    said = [f"{LABELS[criterion]} {ours[criterion]}{published_too[criterion]}" for criterion in CRITERIA]
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
    return textwrap.fill(sentence, WIDTH)
