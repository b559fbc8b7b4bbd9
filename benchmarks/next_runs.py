"""Runs needed when each follows from those before, against Latin hypercubes; and whether more are said to help.

Two expensive models: the full car; and the nonlinear car, where a table of its runs is named, as
``examples/nonlinear_full_car.py --runs 520 --out runs.csv`` writes. Kriging of 520 runs, whose error at runs left out
is 0.01 % of the range, stands for either between them. Both start from a Latin hypercube of 5 runs; then each run is
the one that `susp_ss.next_runs` names for the three criteria together, or there are fresh Latin hypercubes of as many
runs. What is said of more runs is set beside what twice as many, drawn at random, do. Writes a table under
``benchmarks/results``.

    python benchmarks/next_runs.py [runs.csv] [--draws 10]
"""

import argparse
import os
import warnings
from time import process_time

import numpy as np
from intervals import CRITERIA, NOISE, linear_runs, runs_of
from report import digits, processor, rows
from ride_metrics import RESULTS
from threadpoolctl import threadpool_limits

import susp_ss as ss
from susp_ss.fit.next_runs import LITTLE
from susp_ss.study.feasibility import DAMPING, STIFFNESS
from susp_ss.surrogates.next_designs import knowledge, next_designs, over

BOX = {"ks": STIFFNESS, "cs": DAMPING}
START, MOST, SHOWN = 5, 24, 20
TARGETS = (0.01, 0.002)
STOPS = (8, 16, 32)
TEST = ss.sample(BOX, 400, "sobol", random_state=99).to_numpy()

# Asserted: nowhere does it take so many more runs to the first target; nor are so many alarms false.
MOST_MORE, MOST_FALSE = 2, 0.2


def models(table):
    """By name: the expensive responses and the cheap ones, each a function of designs by criterion."""
    found = {"linear car": (linear_runs, None)}
    if table:
        found["nonlinear car"] = (runs_of, table)
    for name, (read, path) in found.items():
        X, responses, road = read(path) if path else read()
        yield (
            name,
            {
                criterion: (
                    ss.Kriging("quadratic").fit(X, responses[criterion]).predict,
                    ss.Response(ss.QuarterCar(), road, criterion),
                )
                for criterion in CRITERIA
            },
        )


def surrogates(f):
    return {"CoKriging": ss.CoKriging(f), "Kriging": ss.Kriging()}


def errors(fits, truths):
    """RMSE of each criterion in shares of its range."""
    found = [np.sqrt(np.mean((fit.predict(TEST) - y) ** 2)) / np.ptp(y) for fit, y in zip(fits, truths, strict=True)]
    return np.array(found)


def fitted(kind, model, X):
    return [surrogates(f)[kind].fit(X, F(X)) for F, f in model.values()]


def following(kind, model, truths, draw):
    """Errors (runs, criteria) from START runs on, one more at a time."""
    X, found = ss.sample(BOX, START, random_state=[draw, START]).to_numpy(), []
    while True:
        fits = fitted(kind, model, X)
        found.append(errors(fits, truths))
        if len(X) == MOST:
            return found
        scales = [float(F(X).std()) for F, _ in model.values()]

        def known(designs, fits=fits, scales=scales):
            return [knowledge(fit, designs, scale) for fit, scale in zip(fits, scales, strict=True)]

        X = np.concatenate([X, next_designs(BOX, X, known, 1)[0]])


def hypercubes(kind, model, truths, draw):
    """Errors (runs, criteria) of plans of START to MOST runs."""
    plans = [ss.sample(BOX, runs, random_state=[draw, runs]).to_numpy() for runs in range(START, MOST + 1)]
    return [errors(fitted(kind, model, X), truths) for X in plans]


def reached(medians, target):
    """The least number of runs from which on the median error is no larger."""
    above = np.flatnonzero(medians > target)
    runs = START + (above[-1] + 1 if len(above) else 0)
    return runs if runs <= MOST else None


def needed(table, draws):
    """Rows of runs needed and errors, and the most that it takes more of them than hypercubes do."""
    body, more = [], []
    for name, model in models(table):
        truths = [F(TEST) for F, _ in model.values()]
        for kind in surrogates(None):
            with_each, plans = (
                np.median([way(kind, model, truths, draw) for draw in range(draws)], axis=0)
                for way in (following, hypercubes)
            )
            for i, criterion in enumerate(model):
                pairs = [[reached(way[:, i], target) for way in (with_each, plans)] for target in TARGETS]
                more += [a - (b or MOST + 1) for a, b in pairs if a is not None]
                body.append(
                    [
                        name,
                        kind,
                        criterion,
                        *(f"{a or f'> {MOST}'} / {b or f'> {MOST}'}" for a, b in pairs),
                        " / ".join(digits(100.0 * way[SHOWN - START, i], 2) for way in (with_each, plans)),
                    ]
                )
                print(*body[-1], flush=True)
    return body, max(more)


def said_and_done(table, draws):
    """Rows of what is said of more runs and what they do, the shares of false alarms, by model and noise."""
    body, wrong, alarms = [], 0, 0
    for name, model in models(table):
        for noise in (0.0, NOISE):
            cases = [
                case
                for F, f in model.values()
                for runs in STOPS
                for draw in range(draws)
                for case in [stopped(F, f, runs, draw, noise)]
            ]
            said, share = np.array(cases).T
            said, useless = said.astype(bool), share > 1.0 - LITTLE
            wrong, alarms = wrong + int((said & ~useless).sum()), alarms + int(said.sum())
            body.append(
                [
                    f"{name}{f', {NOISE:.0%} noise' if noise else ''}",
                    len(cases),
                    int(said.sum()),
                    int((said & ~useless).sum()),
                    int(useless.sum()),
                    int((said & useless).sum()),
                ]
            )
            print(*body[-1], flush=True)
    return body, wrong / max(alarms, 1)


def stopped(F, f, runs, draw, noise):
    """Whether more runs are said to be useless, and the error at new runs with twice as many over that with these."""
    rng = np.random.default_rng([draw, runs])
    X = np.concatenate([ss.sample(BOX, runs, random_state=[draw, runs, i]).to_numpy() for i in range(2)])
    y, new = F(X) * (1.0 + noise * rng.standard_normal(2 * runs)), F(TEST) * (1.0 + noise * rng.standard_normal(400))
    left_out = {
        name: ss.cross_validate(surrogate, X[:runs], y[:runs]).accuracy.RMSE
        for name, surrogate in surrogates(f).items()
    }
    taken = min(left_out, key=left_out.get)
    model = surrogates(f)[taken].fit(X[:runs], y[:runs])
    box = dict(zip(BOX, zip(X[:runs].min(axis=0), X[:runs].max(axis=0), strict=True), strict=True))
    now = knowledge(model, over(box), float(y[:runs].std()))
    then = now.after(range(runs))
    share = np.sqrt((then.variance + then.noise) / (now.variance + now.noise))
    inside = ~model.outside(TEST)
    before, after = (
        np.sqrt(np.mean((fit.predict(TEST) - new)[inside] ** 2)) for fit in (model, surrogates(f)[taken].fit(X, y))
    )
    return share > 1.0 - LITTLE, after / before


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("table", nargs="?")
    parser.add_argument("--draws", type=int, default=10)
    asked = parser.parse_args()
    warnings.simplefilter("ignore")
    start = process_time()
    with threadpool_limits(1):
        body, more = needed(asked.table, asked.draws)
        stops, false = said_and_done(asked.table, asked.draws)
    text = [
        "# Runs that follow from those before",
        "",
        f"{processor()}, {os.cpu_count()} cores, {(process_time() - start) / 60.0:.0f} minutes of one of them. Springs "
        f"and dampers of the study. Errors are root mean squares at {len(TEST)} other designs in % of the range of the "
        f"response, medians of {asked.draws} draws; runs are the least number from which on the error stays below, up "
        f"to {MOST}. Before the stroke: {START} runs of a Latin hypercube, then each as next_runs names it for the "
        "three criteria together. Behind it: Latin hypercubes of as many runs.",
        "",
        *rows(
            ["", "", "", *(f"runs to {target:.1%}" for target in TARGETS), f"error after {SHOWN} runs, %"],
            body,
        ),
        "",
        "## When more will not help",
        "",
        f"Fits of Kriging and co-Kriging, the better at runs left out, to {', '.join(map(str, STOPS))} runs of each "
        f"criterion. Said: by the variance, twice as many runs would lower the error at new runs by less than "
        f"{LITTLE:.0%}. Useless: with twice as many it did fall by less.",
        "",
        *rows(["", "fits", "said", "of these false", "useless", "of these said"], stops),
    ]
    (RESULTS / "next_runs.md").write_text("\n".join([*text, ""]), encoding="utf-8")
    if more > MOST_MORE:
        raise SystemExit(f"next_runs takes {more} more runs than Latin hypercubes, not {MOST_MORE} at most")
    if false > MOST_FALSE:
        raise SystemExit(f"{false:.0%} of what is said of more runs is wrong, not {MOST_FALSE:.0%} at most")


if __name__ == "__main__":
    main()
