"""How many new responses the 95 % intervals of predictions hold, by surrogate and number of runs.

Runs of the full car's body acceleration, exact and with noise of 2 %; and of the nonlinear car, exact and with the
same noise, where a table of its runs is named, as ``examples/nonlinear_full_car.py --runs 520 --out runs.csv`` writes.
Every draw takes other runs, and is tested at designs that it has not seen. Writes a table under ``benchmarks/results``.

    python benchmarks/intervals.py [runs.csv] [--draws 5]
"""

import argparse
import os
import time
import warnings

import numpy as np
from report import processor, rows
from ride_metrics import RESULTS

import susp_ss as ss
from susp_ss.study.feasibility import DAMPING, STIFFNESS

ROADS = {letter: ss.Road.iso8608(letter, speed=20.0, tracks="isotropic") for letter in "BC"}
INTERVAL, NOISE = 0.95, 0.02
BUDGETS = (5, 10, 20, 60)
NEW = 200

# Asserted, from 10 runs on: the least share of new responses held by any surrogate on any model, mean over the draws.
LEAST_HELD, FROM = 0.85, 10


def surrogates(road):
    def cheap(parameter=None):
        return ss.Response(ss.QuarterCar(), road, "bacc", parameter=parameter)

    return {
        "RB": ss.ResponseBased(cheap()),
        "VB": ss.VariableBased(cheap()),
        "PB": ss.ParameterBased(cheap("ms")),
        "Polynomial": ss.Polynomial(2),
        "RBF thin plate": ss.RadialBasis(),
        "RBF Gaussian": ss.RadialBasis("gaussian"),
        "Kriging": ss.Kriging(),
        "CoKriging": ss.CoKriging(cheap()),
    }


def linear_runs():
    X = ss.sample({"ks": STIFFNESS, "cs": DAMPING}, max(BUDGETS) + NEW, random_state=1).to_numpy()
    return X, ss.Response(ss.FullCar(), ROADS["B"], "bacc", at="fr")(X), ROADS["B"]


def runs_of(path):
    runs = ss.read_runs(path, inputs={"ks": "ks", "cs": "cs"}, outputs={"bacc": "bacc"})
    return runs.designs.to_numpy(), runs.responses["bacc"].to_numpy(), ROADS["C"]


def held(X, y, road, runs, draw, noise):
    """By surrogate: the share of new responses between their bounds, and half their width over the RMSE."""
    rng, found = np.random.default_rng([runs, draw]), {}
    order, y = rng.permutation(len(y)), y * (1.0 + noise * rng.standard_normal(len(y)))
    some, new = order[:runs], order[runs:][:NEW]
    for name, surrogate in surrogates(road).items():
        try:
            predicted, bounds = surrogate.fit(X[some], y[some]).predict(X[new], interval=INTERVAL)
        except ValueError:
            continue
        inside = (bounds[:, 0] <= y[new]) & (y[new] <= bounds[:, 1])
        error = np.sqrt(np.mean((predicted - y[new]) ** 2))
        found[name] = np.mean(inside), np.median(np.diff(bounds)) / 2.0 / error
    return found


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("table", nargs="?")
    parser.add_argument("--draws", type=int, default=5)
    asked = parser.parse_args()
    warnings.simplefilter("ignore")
    start, models = time.perf_counter(), {"linear car": linear_runs()}
    if asked.table:
        models["nonlinear car"] = runs_of(asked.table)
    body, least = [], 1.0
    for model, (X, y, road) in models.items():
        for noise in (0.0, NOISE):
            for runs in BUDGETS:
                draws = [held(X, y, road, runs, draw, noise) for draw in range(asked.draws)]
                cells = []
                for name in surrogates(road):
                    both = [draw[name] for draw in draws if name in draw]
                    share, width = np.mean([b[0] for b in both] or np.nan), np.median([b[1] for b in both] or np.nan)
                    cells.append("" if not both else f"{100.0 * share:.0f} ({width:.1f})")
                    least = min(least, share) if both and runs >= FROM else least
                body.append([f"{model}{', 2 % noise' if noise else ''}", runs, *cells])
                print(*body[-1], sep="  ", flush=True)
    text = [
        "# New responses that intervals of 95 % hold",
        "",
        f"{processor()}, {os.cpu_count()} cores. One run of {time.perf_counter() - start:.0f} s. Body acceleration, "
        f"means over {asked.draws} draws, in %; in brackets half the width over the RMSE at the same designs, 2.0 of "
        "normal errors that are alike everywhere. An empty cell had too few runs.",
        "",
        *rows(["", "runs", *surrogates(ROADS["B"])], body),
    ]
    (RESULTS / "intervals.md").write_text("\n".join([*text, ""]), encoding="utf-8")
    if least < LEAST_HELD:
        raise SystemExit(f"intervals hold {least:.0%} from {FROM} runs on, not {LEAST_HELD:.0%}")


if __name__ == "__main__":
    main()
