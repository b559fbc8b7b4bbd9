"""A fit of surrogates as text for the terminal and as files in a folder."""

from __future__ import annotations

import math
import re
import textwrap
from collections.abc import Iterable, Iterator, Mapping
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pandas as pd

from .matched import metric_and_place
from .responses.labels import QUANTITIES
from .results_folder import write_results
from .surrogates import ParameterBased

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from .fitting import Fit, OutputFit

SURROGATE, REPORT, PAGE = "surrogate.json", "report.md", "report.html"
ACCURACY, PREDICTIONS = "accuracy.csv", "predictions.csv"

FILES = (SURROGATE, REPORT, PAGE, ACCURACY, PREDICTIONS)
"""What a fit writes, beside ``figures/``."""

JUDGED = (
    "Errors are those at runs left out of a fit; their intervals allow for which runs were drawn, not for where a plan "
    "of few leaves gaps."
)
"""What the errors are, and what their intervals are not."""


def text(fit: Fit) -> str:
    """The ranking, the choice, what the cheap model was worth, and the formula of each output."""
    return "\n\n".join([_head(fit), *(_output(fit, output) for output in fit.outputs)]) + "\n"


def _head(fit: Fit) -> str:
    runs, cheap = fit.runs, fit.low_fidelity
    box = fit.surrogate.box.items()
    inputs = ", ".join(f"{name} {low:g} to {high:g} {runs.units[name]}".rstrip() for name, (low, high) in box)
    return "\n".join(
        [
            _paragraph(f"{len(runs.rows)} runs of {runs.path}: {inputs}"),
            _paragraph(f"Cheap model: {type(cheap.vehicle).__name__}; {cheap.road.describe()}"),
            *(_paragraph(line) for line in [*unknown(fit), JUDGED]),
        ]
    )


def unknown(fit: Fit) -> list[str]:
    """What the cheap model could not be matched to."""
    car, columns = type(fit.low_fidelity.vehicle).__name__, list(fit.surrogate.inputs)
    lines = []
    for output in fit.outputs:
        cheap = fit.low_fidelity.response(output, columns)
        if cheap is None:
            lines.append(f"{car} has no {output}: it is approximated without a cheap model.")
        elif cheap.unknown:
            lines.append(f"For {output}, {car} does not feel {', '.join(cheap.unknown)}.")
    return lines


def _output(fit: Fit, output: str) -> str:
    found, unit, y = fit.outputs[output], fit.runs.units[output], fit.runs.responses[output]
    lines = [
        f"{output}: {meaning(output)}, {y.min():.4g} to {y.max():.4g} {unit}".rstrip(),
        ranking_table(found, unit).to_string(),
        f"Taken: {found.chosen}.",
    ]
    lines += [_paragraph(line) for line in [*tie(found), worth(fit, found), *stated(found)]]
    if found.learning is not None:
        medians = median_errors(found).map("{:.3g}".format, na_action="ignore").rename_axis(columns=None, index=None)
        lines.append(f"RMSE ({unit}) after fewer runs, median of draws\n{medians.to_string(na_rep='-')}")
    lines += map(_paragraph, failures(found))
    if found.formula is None:
        lines.append("None of these has a formula to type.")
    else:
        lines.append(f"To type ({found.formula[0]}, SI units): {output} = {found.formula[1]}")
    return "\n".join(lines)


def meaning(output: str) -> str:
    """What an output is, and where."""
    metric, place = metric_and_place(output)
    return (
        f"{QUANTITIES[metric][1] if metric in QUANTITIES else 'an output of the runs'}{f' at {place}' if place else ''}"
    )


def ranking_table(found: OutputFit, unit: str) -> pd.DataFrame:
    """Every surrogate's errors at runs left out, as text; the cheap model as it is below."""
    table = found.comparison.table
    shown = pd.DataFrame(
        {
            "cheap model": table.low_fidelity.map({True: "yes", False: "no"}),
            f"RMSE ({unit})": table.RMSE.map("{:.4g}".format),
            "95 % of RMSE": [
                f"{low:.3g} to {high:.3g}" for low, high in zip(table.RMSE_low, table.RMSE_high, strict=True)
            ],
            "R2": table.R2.map("{:.5f}".format),
            "max error": table.MAE.map("{:.3g}".format),
        }
    )
    if table.coverage.notna().any():
        shown["in 95 %"] = table.coverage.map(lambda share: "" if math.isnan(share) else f"{100.0 * share:.0f} %")
    if found.kept_back:
        shown["RMSE held out"] = [f"{found.kept_back[name].accuracy.RMSE:.4g}" for name in table.index]
    if found.untuned is not None:
        shown.loc["cheap, untuned"] = ""
        r2, rmse, most = found.untuned
        shown.iloc[-1, [0, 1, 3, 4]] = ["yes", f"{rmse:.4g}", f"{r2:.5f}", f"{most:.3g}"]
    return shown.rename_axis(None)


def tie(found: OutputFit) -> list[str]:
    """What these runs cannot tell, if anything."""
    best, *others = found.comparison.tied
    return [f"These runs cannot tell {best} from {', '.join(others)}."] if others else []


def stated(found: OutputFit) -> list[str]:
    """What the surrogate taken states of its own error, and how far that held."""
    bounds = found.comparison.validations[found.chosen].coverage_interval
    if bounds is None:
        return []
    share = found.comparison.table.coverage[found.chosen]
    verdict = "; its standard deviations are too small" if bounds[1] < 0.95 else ""
    return [f"Of the runs left out {share:.0%} lie within the 95 % interval that {found.chosen} states{verdict}."]


def failures(found: OutputFit) -> list[str]:
    """Surrogates that were not fitted, and tuned parameters without a good value."""
    bounds = [
        f"{name} sits on its {model.at_bound_} bound, {model.parameter_:g}: there is no good value within."
        for name, model in found.models.items()
        if isinstance(model, ParameterBased) and model.at_bound_
    ]
    return [*(f"Not fitted: {name} ({reason})." for name, reason in found.comparison.refused.items()), *bounds]


def worth(fit: Fit, found: OutputFit) -> str:
    """The baseline: the same runs without the cheap model."""
    if found.untuned is None:
        return "There is no cheap model to compare with."
    gain = found.comparison.gain()
    bounds = f" (95 %: {gain.low:.2g} to {gain.high:.2g})" if math.isfinite(gain.low) else ""
    return (
        f"Without the cheap model, the same {len(fit.runs.rows)} runs give {gain.baseline}, with {gain.ratio:.2g} "
        f"times the RMSE of {gain.tuned}{bounds}."
    )


def median_errors(found: OutputFit) -> pd.DataFrame:
    """RMSE by number of runs, median of draws, surrogates in the order of the ranking; of a fit with its learning."""
    assert found.learning is not None
    medians = found.learning.groupby(["surrogate", "runs"]).RMSE.median().unstack()
    return medians.reindex(found.comparison.table.index)


def _paragraph(sentence: str) -> str:
    return textwrap.fill(sentence, 110)


def save(fit: Fit, folder: str | PathLike[str], force: bool) -> None:
    """Write a fit's files; see `Fit.save`."""
    write_results(folder, lambda empty: _write(fit, empty), FILES, force)


def _write(fit: Fit, folder: Path) -> None:
    from .pages.fit import fit_page

    fit.surrogate.save(folder / SURROGATE)
    accuracy_table(fit).to_csv(folder / ACCURACY, index=False)
    predictions(fit).to_csv(folder / PREDICTIONS, index=False)
    (folder / "figures").mkdir()
    names, pictures = _file_names(fit.outputs), {}
    for kind, output, figure in _figures(fit):
        file = f"figures/{kind}_{names[output]}.png"
        figure.savefig(folder / file)
        pictures[kind, output] = file
    maps = {output: folder / file for (kind, output), file in pictures.items() if kind == "map"}
    (folder / PAGE).write_text(fit_page(fit, maps), encoding="utf-8")
    (folder / REPORT).write_text(_markdown(fit, pictures), encoding="utf-8")


def accuracy_table(fit: Fit) -> pd.DataFrame:
    """Every surrogate of every output, one row each: its accuracy at runs left out."""
    tables = []
    for name, found in fit.outputs.items():
        table = found.comparison.table.reset_index()
        table.insert(0, "output", name)
        table.insert(1, "unit", fit.runs.units[name])
        table.insert(3, "taken", table.surrogate == found.chosen)
        tables.append(table)
    return pd.concat(tables, ignore_index=True)


def predictions(fit: Fit) -> pd.DataFrame:
    """The runs, where they stand in their file, and what each surrogate predicted for them when they were left out."""
    table = pd.concat([fit.runs.designs, fit.runs.responses], axis=1).reset_index(drop=True)
    table.insert(0, "row", fit.runs.rows)
    left_out = {
        f"{output}: {name}": validation.predicted
        for output, found in fit.outputs.items()
        for name, validation in found.comparison.validations.items()
    }
    return table.assign(**left_out)


PICTURES = {
    "parity": "predicted against expensive, runs left out",
    "residuals": "errors, runs left out",
    "map": "the surrogate taken, over the box of the runs",
    "learning": "error against number of runs",
}
"""What each picture of an output shows."""


def _figures(fit: Fit) -> Iterator[tuple[str, str, Figure]]:
    """Kind, output and figure: the surrogate taken, beside the best with and the best without a cheap model."""
    from .plots import fitted_map, learning_curves, parity, residuals

    surrogate = fit.surrogate
    for output, found in fit.outputs.items():
        comparison, unit = found.comparison, fit.runs.units[output]
        wanted = (found.chosen, None if found.untuned is None else comparison.gain().tuned, comparison.baseline)
        shown = {name: comparison.validations[name] for name in wanted if name is not None}
        yield "parity", output, parity(shown, unit)
        yield "residuals", output, residuals(shown, unit)
        if len(surrogate.inputs) == 2:
            yield "map", output, fitted_map(surrogate, output, fit.runs.designs)
        if found.learning is not None:
            yield "learning", output, learning_curves(found.learning, unit)


def _file_names(outputs: Iterable[str]) -> dict[str, str]:
    """Outputs may have any name; what each is called in a file name."""
    names: dict[str, str] = {}
    for output in outputs:
        name = re.sub(r"[^A-Za-z0-9_.-]", "_", output)
        names[output] = f"{name}_{len(names)}" if name in names.values() else name
    return names


def _markdown(fit: Fit, pictures: Mapping[tuple[str, str], str]) -> str:
    lines = [f"# Surrogates of {fit.runs.path.name}", "", "```text", text(fit) + "```", ""]
    for (kind, output), file in pictures.items():
        title = f"{output}: {PICTURES[kind]}"
        lines.append(f"## {title}\n\n![{title}]({file})\n")
    return "\n".join(lines)


def document(fit: Fit) -> dict[str, Any]:
    """The ranking, the choice and the formula of each output, as JSON knows it: NaN becomes null."""
    outputs = {}
    for output, found in fit.outputs.items():
        ranking = found.comparison.table.reset_index().astype(object)
        outputs[output] = {
            "unit": fit.runs.units[output],
            "taken": found.chosen,
            "tied": list(found.comparison.tied),
            "baseline": found.comparison.baseline,
            "ranking": ranking.where(ranking.notna(), None).to_dict("records"),
            "untuned": None if found.untuned is None else found.untuned._asdict(),
            "held_out": {name: kept.accuracy._asdict() for name, kept in found.kept_back.items()},
            "not_fitted": found.comparison.refused,
            "formula": None if found.formula is None else dict(zip(("surrogate", "text"), found.formula, strict=True)),
        }
    return {"runs": len(fit.runs.rows), "inputs": fit.surrogate.inputs, "outputs": outputs}
