"""A study as text for the terminal."""

from __future__ import annotations

import textwrap

import numpy as np
import pandas as pd

from ...quantities import PARAMETERS, titled, typeset
from ...study.feasibility import Study
from ...study.optima import GOAL, MORE, NEAR, Optima
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

CELLS = f"In each cell, of the full car: {LABELS[GOAL]} beyond the true optimum / excess over the worse limit, in %"
"""What `landings` gives."""


def study_text(study: Study) -> str:
    """Tables 3 to 5 beside the published values, what agrees, held-out accuracy, cost, and where designs land."""
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
    blocks += [_best(study), _held_out(study), _cost(study), _optima(study)]
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


def _optima(study: Study) -> str:
    cells = landings(study.optima)
    runs = next(iter(cells.values()))
    lines = [
        _paragraph(f"Designs: {sought(study)} {CELLS}:"),
        " " * 9 + "".join(f"{f'{count} runs':>18}" for count in runs),
        *(f"{surrogate:<9}" + "".join(f"{cell:>18}" for cell in row.values()) for surrogate, row in cells.items()),
        _paragraph(landed(study)),
    ]
    return "\n".join(lines)


def landings(optima: Optima) -> dict[str, dict[int, str]]:
    """For each surrogate and number of runs where its best design lands, as `CELLS` says."""
    cells: dict[str, dict[int, str]] = {}
    for (surrogate, runs), row in zip(optima.landed.index, optima.landed.to_dict("records"), strict=True):
        cells.setdefault(surrogate, {})[runs] = f"{_percent(row['beyond'])} / {_percent(row['excess']).lstrip('+')}"
    return cells


def sought(study: Study) -> str:
    """What each surrogate was searched for, and how."""
    limits = [f"{LABELS[name]} at most {x:.4g} {CRITERIA[name]}" for name, x in study.optima.limits.items()]
    return typeset(
        f"Least {LABELS[GOAL]} with {' and '.join(limits)}, {MORE} times those in the middle of the range. Each "
        "surrogate is fitted to few runs of the full car, one draw a number of runs, and searched; then the full car "
        "is asked at the design that came out."
    )


def landed(study: Study) -> str:
    """What the designs that came out say of the surrogates."""
    optima, enough = study.optima, study.optima.enough()
    reached = [f"{name} from {runs} runs on" for name, runs in enough.items() if runs]
    never = [name for name, runs in enough.items() if not runs]
    most = max(optima.landed.index.get_level_values("runs"))
    over = optima.landed["excess"].xs(most, level="runs")
    exceeding = [f"{name} by {100 * excess:.1f} %" for name, excess in over[over > NEAR].items()]
    broken = (
        f"a limit is exceeded by the design of {', '.join(exceeding)}" if exceeding else "no design exceeds a limit"
    )
    missed = f"; with none of these numbers {', '.join(never)}" if never else ""
    place = ", ".join(f"{optima.best[name]:.5g} {PARAMETERS[name].unit}" for name in ("ks", "cs"))
    return typeset(
        f"The true optimum is at {place}; the middle of the range is {100 * optima.middle:.2g} % beyond it, and what "
        f"comes below it exceeds a limit. Within {100 * NEAR:g} % of the optimum and the limits: "
        f"{', '.join(reached) or 'none'}{missed}. With {most} runs {broken}."
    )


def _percent(share: float) -> str:
    """In per cent to two digits, a zero without minus."""
    return f"{round(100 * share, 2) + 0.0:+.2f}"


def _enough(number: float) -> str:
    return "more than 25" if np.isnan(number) else f"{number:.0f}"


def _number(value: float) -> str:
    return "-" if np.isnan(value) else f"{value:.5g}"


def _paragraph(sentence: str) -> str:
    return textwrap.fill(sentence, WIDTH)
