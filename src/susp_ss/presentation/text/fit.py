"""A fit of surrogates as text for the terminal, and the sentences that its page shares."""

from __future__ import annotations

import math
import textwrap

import numpy as np
import pandas as pd

from ...fit.fitting import Fit, OutputFit
from ...fit.next_runs import NextRuns, asked_for, in_file_units, outlook
from ...quantities import METRICS, metric_and_place, titled, typeset
from ...surrogates import ParameterBased

JUDGED = (
    "Errors are those at runs left out of a fit; their intervals allow for which runs were drawn, not for where a plan "
    "of few leaves gaps."
)
"""What the errors are, and what their intervals are not."""


# Share of the variance that a surrogate must explain not to be called poor.
POOR = 0.5

# Of what the responses span, an error that is seldom worth a run: roads are known to per cents.
ENOUGH = 1e-3

TINY = float(np.finfo(float).tiny)


def fit_text(fit: Fit) -> str:
    """The ranking, the choice, what the cheap model was worth, and the formula of each output."""
    plan = asked_for(fit)
    following = [] if plan is None else [_following(fit, plan)]
    return "\n\n".join([_head(fit), *(_output(fit, output) for output in fit.outputs), *following]) + "\n"


def _head(fit: Fit) -> str:
    runs, cheap = fit.runs, fit.low_fidelity
    box = fit.surrogate.box.items()
    inputs = ", ".join(f"{name} {low:g} to {high:g} {typeset(runs.units[name])}".rstrip() for name, (low, high) in box)
    return "\n".join(
        [
            _paragraph(f"{len(runs.rows)} runs of {runs.path}: {inputs}"),
            _paragraph(f"Cheap model: {type(cheap.vehicle).__name__}; {typeset(cheap.road.describe())}"),
            *(_paragraph(line) for line in [*unknown(fit), JUDGED, choices(fit)]),
        ]
    )


def choices(fit: Fit) -> str:
    """Which runs the choices behind a prediction have seen."""
    if fit.asked["refit"]:
        return (
            "Thetas of Kriging and shapes of radial bases were found anew for every fold; beside, the RMSE with those "
            "of the fit to all runs."
        )
    return "Thetas of Kriging and shapes of radial bases are those of the fit to all runs."


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
        f"{output}: {meaning(fit, output)}, {y.min():.4g} to {y.max():.4g} {typeset(unit)}".rstrip(),
        *map(_paragraph, judged(fit, output)),
        ranking_table(found, unit).to_string(),
        f"Taken: {found.chosen}.",
    ]
    lines += [_paragraph(line) for line in [*tie(found), worth(fit, found), *stated(found), *more(fit, output)]]
    if found.learning is not None:
        medians = median_errors(found).map("{:.3g}".format, na_action="ignore").rename_axis(columns=None, index=None)
        lines.append(f"{titled('RMSE', unit)} after fewer runs, median of draws\n{medians.to_string(na_rep='-')}")
    lines += map(_paragraph, failures(found))
    lines += map(_paragraph, typed(found, unit))
    if found.formula is not None:
        lines.append(f"{output} = {found.formula[1]}")
    return "\n".join(lines)


def meaning(fit: Fit, output: str) -> str:
    """What an output is, where, and what it is weighted by."""
    metric, place = metric_and_place(output)
    what = METRICS[metric].meaning if metric in METRICS else "an output of the runs"
    through = fit.low_fidelity.through(output)
    return f"{what}{f' at {place}' if place else ''}{f', through {through.name}' if through else ''}"


def ranking_table(found: OutputFit, unit: str) -> pd.DataFrame:
    """Every surrogate's errors at runs left out, as text; the cheap model as it is below."""
    table = found.comparison.table
    shown = pd.DataFrame(
        {
            "cheap model": table.low_fidelity.map({True: "yes", False: "no"}),
            titled("RMSE", unit): table.RMSE.map("{:.4g}".format),
            "95 % of RMSE": [
                f"{low:.3g} to {high:.3g}" for low, high in zip(table.RMSE_low, table.RMSE_high, strict=True)
            ],
            "R2": table.R2.map("{:.5f}".format),
            "max error": table.MAE.map("{:.3g}".format),
        }
    )
    if "RMSE_fixed" in table:
        shown["all runs' thetas"] = table.RMSE_fixed.map(lambda rmse: "" if math.isnan(rmse) else f"{rmse:.4g}")
    if table.coverage.notna().any():
        shown["in 95 %"] = table.coverage.map(lambda share: "" if math.isnan(share) else f"{100.0 * share:.0f} %")
    if found.kept_back:
        shown["RMSE held out"] = [f"{found.kept_back[name].accuracy.RMSE:.4g}" for name in table.index]
    if found.untuned is not None:
        shown.loc["cheap, untuned"] = ""
        r2, rmse, most = found.untuned
        shown.iloc[-1, [0, 1, 3, 4]] = ["yes", f"{rmse:.4g}", f"{r2:.5f}", f"{most:.3g}"]
    return shown.rename_axis(None)


def judged(fit: Fit, output: str) -> list[str]:
    """What is to be said first: whether anything predicts, and what may be wrong with the runs or the question."""
    found, unit = fit.outputs[output], fit.runs.units[output]
    verdict, r2 = found.verdict, found.comparison.table.R2[found.chosen]
    bounds = f" (95 %: {_times(verdict.low)} to {_times(verdict.high)})" if math.isfinite(verdict.low) else ""
    times = f"at runs left out the mean of the others errs {_times(verdict.gain)} times{bounds} as much"
    if verdict.predicts:
        lines = [f"{found.chosen} predicts {output}: {times}."]
    else:
        lines = [f"NOTHING HERE PREDICTS {output}: the best is {found.chosen}, and {times}."]
    if r2 < POOR:
        lines[0] += f" Of the variance {100.0 * (1.0 - r2):.0f} % is left."
    shown = typeset(unit)
    for run, predicted, far in verdict.suspects:
        got = (
            f"{fit.runs.responses[output].iloc[run]:.4g} where the other runs predict {predicted:.4g} {shown}".rstrip()
        )
        lines.append(f"Check {fit.runs.place(run, output)}: {got}, {far:.0f} times their usual error.")
    if r2 < POOR and not verdict.suspects:
        others = ", ".join(fit.runs.others)
        among = f"of the columns that were not asked for ({others})" if others else "which the file does not hold"
        lines.append(
            f"Does something vary between these runs that is no input, {among}? Are car, road and place right?"
        )
    car = type(fit.low_fidelity.vehicle).__name__
    if verdict.unit is not None:
        ratio, likely = verdict.unit
        lines.append(
            f"{output} is {ratio:.2g} times what {car} has: is it in {typeset(likely)}? State it (--units "
            f"{output}={likely})."
        )
    if verdict.elsewhere is not None:
        setting, value, share = verdict.elsewhere
        said = {"place": f"at {value} (--at {value})", "tracks": f"on {value} tracks (--tracks {value})"}[setting]
        lines.append(f"{car} comes much nearer {said}: {100.0 * share:.0f} % of its error here. Was that meant?")
    return lines


def _times(ratio: float) -> str:
    """A ratio with two digits, never in powers of ten."""
    return f"{float(f'{ratio:.2g}'):,.10g}"


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
    small = bounds[1] < 0.95
    verdict = "; its standard deviations are too small" if small else ""
    held = f"Of the runs left out {share:.0%} lie within the 95 % interval that {found.chosen} states{verdict}."
    return [held, "The bounds that susp-ss predict prints allow for that."] if small else [held]


def more(fit: Fit, output: str) -> list[str]:
    """Whether more runs would lower the error."""
    found, unit, y = fit.outputs[output], fit.runs.units[output], fit.runs.responses[output]
    share = found.comparison.table.RMSE[found.chosen] / max(np.ptp(y), TINY)
    if share < ENOUGH:
        return [f"There are runs enough for most: the error is {100.0 * share:.2g} % of what the responses span."]
    ahead = outlook(fit, output)
    if ahead is None:
        return []
    if not ahead.helps:
        noise = f"{ahead.noise:.3g} {typeset(unit)}".rstrip()
        return [
            f"MORE RUNS WILL HARDLY HELP: {ahead.by} finds that a run scatters by {noise} of its own; twice as many "
            f"would lower the error at new runs by {100.0 * (1.0 - ahead.share):.0f} %."
        ]
    which = "the next ones are below" if fit.asked["next_runs"] else "susp-ss fit --next says which"
    return [f"More runs would lower the error; {which}."]


def following(fit: Fit, plan: NextRuns) -> list[str]:
    """What chose the next runs."""
    by = {who: [output for output, one in plan.by.items() if one == who] for who in plan.by.values()}
    names = [f"{who} ({', '.join(outputs)})" for who, outputs in by.items()]
    filled, count = plan.filling, len(plan.designs)
    lines = ["The next runs, the most telling first."]
    if filled:
        lines.append(f"{'All' if filled == count else f'The first {filled}'} fill the box, far from all others.")
    if filled < count:
        each = "Each" if not filled else "Each of the others"
        lines.append(f"{each} lowers the variance of {' and '.join(names)}, mean over the box, the most.")
    return lines


def following_table(fit: Fit, plan: NextRuns) -> pd.DataFrame:
    """The next runs as text, in the units of the runs' file."""
    shown = in_file_units(fit, plan.designs)
    titles = [titled(str(name), fit.runs.stated[str(name)]) for name in plan.designs]
    return shown.map("{:.6g}".format).set_axis(titles, axis=1).set_axis(range(1, len(shown) + 1), axis=0)


def _following(fit: Fit, plan: NextRuns) -> str:
    return "\n".join([_paragraph(" ".join(following(fit, plan))), following_table(fit, plan).to_string()])


def failures(found: OutputFit) -> list[str]:
    """Surrogates that were not fitted, and tuned parameters without a good value."""
    bounds = [
        f"{name} sits on its {model.at_bound_} bound, {model.parameter_:g}: there is no good value within."
        for name, model in found.models.items()
        if isinstance(model, ParameterBased) and model.at_bound_
    ]
    reasons: dict[str, list[str]] = {}
    for name, reason in found.comparison.refused.items():
        reasons.setdefault(reason, []).append(name)
    return [*(f"Not fitted: {', '.join(names)} ({reason})." for reason, names in reasons.items()), *bounds]


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


def typed(found: OutputFit, unit: str) -> list[str]:
    """What a formula to type is worth beside the surrogate taken, by the same folds; that there is none, if so."""
    if found.formula is None:
        return ["None of these has a formula to type into a spreadsheet."]
    name, rmse = found.formula[0], found.comparison.table.RMSE
    error = f"at runs left out its RMSE is {rmse[name]:.4g} {typeset(unit)}".rstrip()
    if name == found.chosen:
        return [f"To type into a spreadsheet, in SI units: {name}, the surrogate taken; {error}."]
    return [
        f"To type into a spreadsheet, in SI units: {name}, not the surrogate taken; {error}, by the same folds that of "
        f"{found.chosen} is {rmse[found.chosen]:.4g}."
    ]


def median_errors(found: OutputFit) -> pd.DataFrame:
    """RMSE by number of runs, median of draws, surrogates in the order of the ranking; of a fit with its learning."""
    assert found.learning is not None
    medians = found.learning.groupby(["surrogate", "runs"]).RMSE.median().unstack()
    return medians.reindex(found.comparison.table.index)


def _paragraph(sentence: str) -> str:
    return textwrap.fill(sentence, 110)
