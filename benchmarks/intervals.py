"""How many new responses the 95 % intervals of predictions hold, by surrogate, criterion and number of runs.

Runs of the full car, exact; and of the nonlinear car, exact and with noise of 2 %, where a table of its runs is named,
as ``examples/nonlinear_full_car.py --runs 520 --out runs.csv`` writes. Every draw takes other runs, and is tested at
designs that it has not seen. What is finished is kept in a file, from which the same command goes on. Writes a table
under ``benchmarks/results``.

    python benchmarks/intervals.py [runs.csv] [--draws 5] [--kept draws.csv]
"""

import argparse
import os
import warnings
from pathlib import Path
from time import process_time

import numpy as np
import pandas as pd
from report import processor, rows
from ride_metrics import RESULTS
from threadpoolctl import threadpool_limits

import susp_ss as ss
from susp_ss.study.feasibility import DAMPING, STIFFNESS

ROADS = {letter: ss.Road.iso8608(letter, speed=20.0, tracks="isotropic") for letter in "BC"}
INTERVAL, NOISE = 0.95, 0.02
CRITERIA = ("bacc", "dtl", "sws")
BUDGETS = (5, 10, 20, 60)
NEW = 100
KEY = ["model", "criterion", "runs", "surrogate"]

# What is claimed of every surrogate, from so many runs on, in the mean over draws; what falls short is listed.
CLAIMED, FROM = (0.90, 0.99), 10

# Asserted: no cell is below.
LEAST_HELD = 0.85


class Tabulated:
    """The cheap model at all designs at once, looked up by their springs: each fit without a run asks for the same."""

    def __init__(self, cheap, X):
        order = np.argsort(X[:, 0])
        self.springs, self.responses = X[order, 0], cheap(X)[order]

    def __call__(self, X):
        return self.responses[np.searchsorted(self.springs, X[:, 0])]


def surrogates(road, criterion, X):
    cheap = Tabulated(ss.Response(ss.QuarterCar(), road, criterion), X)
    return {
        "RB": ss.ResponseBased(cheap),
        "VB": ss.VariableBased(cheap),
        "PB": ss.ParameterBased(ss.Response(ss.QuarterCar(), road, criterion, parameter="ms")),
        "Polynomial": ss.Polynomial(2),
        "RBF thin plate": ss.RadialBasis(),
        "RBF Gaussian": ss.RadialBasis("gaussian"),
        "Kriging": ss.Kriging(),
        "CoKriging": ss.CoKriging(cheap),
    }


def linear_runs():
    X = ss.sample({"ks": STIFFNESS, "cs": DAMPING}, 520, random_state=1).to_numpy()
    return X, {name: ss.Response(ss.FullCar(), ROADS["B"], name, at="fr")(X) for name in CRITERIA}, ROADS["B"]


def runs_of(path):
    runs = ss.read_runs(path, {"ks": "ks", "cs": "cs"}, {name: name for name in CRITERIA})
    return runs.designs.to_numpy(), {name: runs.responses[name].to_numpy() for name in CRITERIA}, ROADS["C"]


def models(table):
    """Designs, responses, road and noise of each model."""
    yield "linear", *linear_runs(), 0.0
    if table:
        yield "nonlinear", *runs_of(table), 0.0
        yield "nonlinear, 2 % noise", *runs_of(table), NOISE


def held(X, y, road, criterion, runs, seed, noise):
    """By surrogate: the share of new responses between their bounds, and half their width over the RMSE."""
    rng = np.random.default_rng(seed)
    order, y = rng.permutation(len(y)), y * (1.0 + noise * rng.standard_normal(len(y)))
    some, new = order[:runs], order[runs:][:NEW]
    for name, surrogate in surrogates(road, criterion, X).items():
        try:
            predicted, bounds = surrogate.fit(X[some], y[some]).predict(X[new], interval=INTERVAL)
        except ValueError:
            continue
        inside = (bounds[:, 0] <= y[new]) & (y[new] <= bounds[:, 1])
        error = np.sqrt(np.mean((predicted - y[new]) ** 2))
        yield name, float(np.mean(inside)), float(np.median(np.diff(bounds)) / 2.0 / error)


def drawn(draw, table):
    """A row for every cell of one draw, with the seconds of the processor that the draw took."""
    start = process_time()
    found = [
        [draw, model, criterion, runs, *one]
        for model, X, responses, road, noise in models(table)
        for i, (criterion, y) in enumerate(responses.items())
        for runs in BUDGETS
        for one in held(X, y, road, criterion, runs, [draw, runs, i], noise)
    ]
    seconds = process_time() - start
    return pd.DataFrame([[*row, seconds] for row in found], columns=["draw", *KEY, "held", "width", "seconds"])


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("table", nargs="?")
    parser.add_argument("--draws", type=int, default=5)
    parser.add_argument("--kept", type=Path)
    asked = parser.parse_args()
    warnings.simplefilter("ignore")
    done = [pd.read_csv(asked.kept)] if asked.kept and asked.kept.exists() else []
    with threadpool_limits(1):
        for draw in range(asked.draws):
            if not any((one.draw == draw).any() for one in done):
                done.append(drawn(draw, asked.table))
                if asked.kept:
                    pd.concat(done).to_csv(asked.kept, index=False)
                print(f"draw {draw + 1} of {asked.draws}: {done[-1].seconds.iloc[0]:.0f} s", flush=True)
    kept = pd.concat(done)
    write(kept, kept.groupby(KEY, sort=False).agg(held=("held", "mean"), width=("width", "median")))


def write(kept, cells):
    names, body = list(kept.surrogate.unique()), []
    for model, criterion, runs in dict.fromkeys(key[:3] for key in cells.index):
        mine = cells.loc[model, criterion, runs]
        shown = [f"{100.0 * row.held:.0f} ({row.width:.1f})" for row in mine.itertuples()]
        body.append(
            [model, criterion, runs, *map(dict(zip(mine.index, shown, strict=True)).get, names, [""] * len(names))]
        )
    claimed = cells[cells.index.get_level_values("runs") >= FROM]
    share = claimed.held.round(2)
    below, above = claimed[share < CLAIMED[0]], claimed[share > CLAIMED[1]]
    within = len(claimed) - len(below) - len(above)
    spread = kept[kept.runs >= FROM].groupby(KEY).held.sem()
    minutes = kept.groupby("draw").seconds.first().sum() / 60.0
    text = [
        "# New responses that intervals of 95 % hold",
        "",
        f"{processor()}, {os.cpu_count()} cores, {minutes:.0f} minutes of one of them. Means over "
        f"{kept.draw.nunique()} draws of runs, tested at {NEW} others each, in %; in brackets half the width over the "
        "RMSE at the same designs, 2.0 of normal errors that are alike everywhere. An empty cell had too few runs.",
        "",
        f"From {FROM} runs on {within} of {len(claimed)} cells hold {CLAIMED[0]:.0%} to {CLAIMED[1]:.0%}, {len(above)} "
        f"hold more, and {len(below)} less; all of them together {claimed.held.mean():.1%}. The standard error of a "
        f"cell is {100.0 * spread.median():.1f} % in the median.",
        "",
        *rows(["model", "criterion", "runs", *names], body),
    ]
    if len(below):
        listed = [[*key, f"{100.0 * row.held:.0f}"] for key, row in below.iterrows()]
        text += ["", f"## Less than {CLAIMED[0]:.0%}", "", *rows([*KEY, "held, %"], listed)]
    (RESULTS / "intervals.md").write_text("\n".join([*text, ""]), encoding="utf-8")
    if claimed.held.min() < LEAST_HELD:
        raise SystemExit(f"intervals hold {claimed.held.min():.0%} from {FROM} runs on, not {LEAST_HELD:.0%}")


if __name__ == "__main__":
    main()
