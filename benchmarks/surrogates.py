"""Surrogates of a full car at equal numbers of its runs: ours beside SMT's and scikit-learn's, error and time.

The full car's exact metrics stand for the expensive model: class B at 20 m/s on isotropic tracks, front right corner.
All get the same Latin hypercubes over springs and dampers and are tested at 512 other designs. SMT's ``KRG`` and its
co-Kriging ``MFK``, which sees 60 runs of the quarter car besides, keep their defaults; scikit-learn's
``GaussianProcessRegressor`` is given scaled columns, a length for each, and 9 restarts. Then what ours take on the
study's 400 nodes, Kriging on more, and ``susp-ss fit`` of 60 runs from start to end. Writes a table and a plot under
``benchmarks/results``. Run with ``make bench``.
"""

import os
import resource
import subprocess
import sys
import tempfile
import time
import warnings
from pathlib import Path
from statistics import median

import numpy as np
import pandas as pd
from report import digits, processor, rows, write
from rich.console import Console
from ride_metrics import RESULTS
from sklearn.base import BaseEstimator, RegressorMixin
from sklearn.exceptions import ConvergenceWarning
from sklearn.gaussian_process import GaussianProcessRegressor
from sklearn.gaussian_process.kernels import RBF, ConstantKernel
from sklearn.pipeline import make_pipeline
from sklearn.preprocessing import StandardScaler
from smt.applications import MFK
from smt.surrogate_models import KRG

import susp_ss as ss
from susp_ss.presentation.plots import learning_curves
from susp_ss.study.feasibility import DAMPING, STIFFNESS, designs, grid

ROAD = ss.Road.iso8608("B", speed=20.0, tracks="isotropic")
BOX = {"ks": STIFFNESS, "cs": DAMPING}
CRITERIA = {"bacc": "m/s^2", "sws": "m", "dtl": "N"}
BUDGETS = (5, 10, 20, 60, 200)
REPEATS = 3

SMT, SMT_CO, SKLEARN = "SMT KRG", "SMT MFK", "scikit-learn GPR"
PEERS = [SMT, SMT_CO, SKLEARN]

# Asserted: seconds of a fit to all nodes, and of a million predictions.
LONGEST_FIT, LONGEST_PREDICTION = 0.05, 1.0

# Asserted, medians over the criteria: error of the better peer without the quarter car over our best's, by runs.
LEAST_GAIN = {5: 2.0, 10: 2.0, 20: 2.0}

# Asserted, medians over criteria and plans: SMT's time of a fit over ours by number of runs, Kriging and co-Kriging;
# and our error over SMT's, over all numbers of runs.
LEAST_FASTER, MOST_ERROR = {20: 20.0, 60: 20.0, 200: 8.0}, 1.0

# Asserted: seconds of a Kriging fit to so many runs.
MANY, LONGEST_KRIGING = 510, 5.0

# Asserted: the processor's seconds of ``susp-ss fit`` of 60 runs with three outputs, without and with the learning
# curve; on a machine that does nothing else the clock's are no more.
COMMAND, LONGEST_COMMAND = 60, {(): 5.0, ("--learning-curve",): 20.0}


class PlainKriging(RegressorMixin, BaseEstimator):
    """SMT's Kriging as its documentation shows it."""

    def fit(self, X, y):
        self.model_ = KRG(theta0=[1e-2] * X.shape[1], print_global=False)
        self.model_.set_training_values(np.asarray(X), np.asarray(y))
        self.model_.train()
        return self

    def predict(self, X):
        return self.model_.predict_values(np.asarray(X))[:, 0]


class PlainCoKriging(PlainKriging):
    """SMT's recursive co-Kriging of the runs and 60 of the cheap model, on a Latin hypercube over the same box."""

    def __init__(self, low_fidelity):
        self.low_fidelity = low_fidelity

    def fit(self, X, y):
        many = np.concatenate([np.asarray(X), ss.sample(BOX, 60).to_numpy()])
        self.model_ = MFK(theta0=[1e-2] * X.shape[1], print_global=False)
        self.model_.set_training_values(many, self.low_fidelity(many), name=0)
        self.model_.set_training_values(np.asarray(X), np.asarray(y))
        self.model_.train()
        return self


def cheap(criterion, parameter=None):
    return ss.Response(ss.QuarterCar(), ROAD, criterion, parameter=parameter)


def tuned(criterion):
    return {
        "RB": ss.ResponseBased(cheap(criterion)),
        "VB": ss.VariableBased(cheap(criterion)),
        "PB": ss.ParameterBased(cheap(criterion, "ms")),
    }


def contenders(criterion):
    kernel = ConstantKernel() * RBF([1.0] * len(BOX))
    process = GaussianProcessRegressor(kernel, normalize_y=True, n_restarts_optimizer=9, random_state=0)
    return {
        **tuned(criterion),
        "CoKriging": ss.CoKriging(cheap(criterion)),
        "Kriging": ss.Kriging(),
        SMT: PlainKriging(),
        SMT_CO: PlainCoKriging(cheap(criterion)),
        SKLEARN: make_pipeline(StandardScaler(), process),
    }


def seconds(run, repeats):
    taken = []
    for _ in range(repeats + 1):
        start = time.perf_counter()
        run()
        taken.append(time.perf_counter() - start)
    return median(taken[1:])


def on_all_nodes():
    """Seconds of each fit to the study's nodes and of a million predictions, by surrogate: the longest criterion."""
    X = designs(*grid(20, 20))
    many = np.tile(X, (2500, 1))
    longest = {}
    for criterion in CRITERIA:
        y = ss.Response(ss.FullCar(), ROAD, criterion, at="fr")(X)
        for name, surrogate in tuned(criterion).items():
            times = seconds(lambda s=surrogate, y=y: s.fit(X, y), 9), seconds(lambda s=surrogate: s.predict(many), 3)
            longest[name] = np.maximum(longest.get(name, 0.0), times)
    return longest


def curves(say):
    tables = {}
    for criterion in CRITERIA:
        say(f"{criterion}: {REPEATS} plans each of {', '.join(map(str, BUDGETS))} runs")
        expensive = ss.Response(ss.FullCar(), ROAD, criterion, at="fr")
        tables[criterion] = ss.learning_curve(contenders(criterion), expensive, BOX, BUDGETS, repeats=REPEATS)
    return tables


def markdown(tables, fits, smts, many, command, load, took):
    text = [
        "# Surrogates of a full car at equal numbers of its runs",
        "",
        f"{processor()}, {os.cpu_count()} cores. One run of {took:.0f} s; load average at its start {load:.1f}. "
        f"Medians of {REPEATS} Latin hypercubes of each size; errors at 512 other designs. RB, VB, PB, CoKriging "
        "and MFK also use the quarter car, whose runs are free; the others see the full car's alone.",
        "",
    ]
    for criterion, unit in CRITERIA.items():
        medians = tables[criterion].groupby(["surrogate", "runs"], sort=False)[["RMSE", "seconds"]].median()
        for what, title in (("RMSE", f"{criterion}, RMSE in {unit}"), ("seconds", f"{criterion}, seconds of a fit")):
            wide = medians[what].unstack()
            body = [[name, *map("{:.2g}".format, row)] for name, row in wide.T.items()]
            text += [f"## {title}", "", *rows(["runs", *wide.columns], body), ""]
    body = [[name, digits(1e3 * fit), digits(predict)] for name, (fit, predict) in fits.items()]
    text += ["## The tuned models on the study's 400 nodes", "", "The slowest of the three criteria.", ""]
    text += [*rows(["", "a fit, ms", "a million predictions, s"], body), "", "## Kriging beside SMT's", ""]
    text += [f"Medians over criteria and plans. A fit of Kriging to {MANY} runs takes {many:.2g} s.", ""]
    body = [[name, f"{runs}", f"{faster:.2g}", f"{error:.2g}"] for name, runs, faster, error in smts]
    text += [*rows(["", "runs", "SMT's time over ours", "our error over SMT's"], body), "", "## From start to end", ""]
    text += [f"The command with {COMMAND} runs of {len(CRITERIA)} outputs, its start and its report included.", ""]
    body = [
        [" ".join(["`susp-ss fit`", *(f"`{option}`" for option in more)]), *map(digits, taken)]
        for more, taken in command.items()
    ]
    return "\n".join([*text, *rows(["", "s", "of the processor, s"], body), ""])


def gains(tables):
    """Error of the better peer without the quarter car over our best's by number of runs, median over the criteria."""
    found = {}
    for runs in BUDGETS:
        ratios = []
        for table in tables.values():
            errors = table[table.runs == runs].groupby("surrogate").RMSE.median()
            ratios.append(errors[[SMT, SKLEARN]].min() / errors.drop(PEERS).min())
        found[runs] = median(ratios)
    return found


def beside_smt(tables):
    """By kind and number of runs: SMT's time of a fit over ours, and our error over SMT's; medians over all plans."""
    found = []
    for ours, theirs in (("Kriging", SMT), ("CoKriging", SMT_CO)):
        for runs in BUDGETS:
            both = [
                {name: table[(table.surrogate == name) & (table.runs == runs)].reset_index() for name in (ours, theirs)}
                for table in tables.values()
            ]
            faster = np.concatenate([pair[theirs].seconds / pair[ours].seconds for pair in both])
            error = np.concatenate([pair[ours].RMSE / pair[theirs].RMSE for pair in both])
            found.append((ours, runs, median(faster), median(error)))
    return found


def on_many_runs():
    """Seconds of a Kriging fit to many runs, the longest criterion."""
    X, taken = ss.sample(BOX, MANY).to_numpy(), []
    for criterion in CRITERIA:
        y = ss.Response(ss.FullCar(), ROAD, criterion, at="fr")(X)
        taken.append(seconds(lambda y=y: ss.Kriging().fit(X, y), 1))
    return max(taken)


def on_the_command_line():
    """Seconds of ``susp-ss fit`` from start to end, and the processor's, by its further options."""
    X = ss.sample(BOX, COMMAND)
    measured = {name: ss.Response(ss.FullCar(), ROAD, name, at="fr")(X.to_numpy()) for name in CRITERIA}
    with tempfile.TemporaryDirectory() as folder:
        runs = Path(folder, "runs.csv")
        pd.concat([X, pd.DataFrame(measured)], axis=1).to_csv(runs, index=False)
        line = [sys.executable, "-m", "susp_ss", "fit", str(runs), "--inputs", "ks,cs", "--outputs", ",".join(CRITERIA)]
        line += ["--road-class", "B", "--tracks", "isotropic", "--at", "fr"]

        def fit(more):
            start = np.array([time.perf_counter(), processor_of_children()])
            subprocess.run([*line, *more], check=True, capture_output=True)
            return [time.perf_counter(), processor_of_children()] - start

        return {more: np.median([fit(more) for _ in range(4)][1:], axis=0) for more in LONGEST_COMMAND}


def processor_of_children():
    """Seconds that the processes started so far, and ended, took of the processor."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def main():
    # A length at its bound is the peer's matter.
    warnings.filterwarnings("ignore", category=ConvergenceWarning)
    warnings.filterwarnings("ignore", "the tuned parameter", UserWarning)
    warnings.filterwarnings("ignore", "Kriging of", UserWarning)
    load, start = os.getloadavg()[0], time.perf_counter()
    fits, many, tables = on_all_nodes(), on_many_runs(), curves(Console(stderr=True, highlight=False).print)
    smts, command = beside_smt(tables), on_the_command_line()
    text = markdown(tables, fits, smts, many, command, load, time.perf_counter() - start)
    write(RESULTS, "surrogates", text, learning_curves(tables["bacc"], "m/s²"))
    print(text)
    gain = gains(tables)
    print("better peer's error over our best's:", ", ".join(f"{ratio:.2g} at {runs}" for runs, ratio in gain.items()))
    for name, (fit, predict) in fits.items():
        if fit > LONGEST_FIT or predict > LONGEST_PREDICTION:
            raise SystemExit(f"{name} takes {fit:.3g} s to fit and {predict:.3g} s for a million predictions")
    for name, runs, faster, _ in smts:
        if faster < LEAST_FASTER.get(runs, 0.0):
            raise SystemExit(
                f"{name} of {runs} runs is {faster:.2g} times as fast as SMT's, not {LEAST_FASTER[runs]:g}"
            )
    if median(error for *_, error in smts) > MOST_ERROR:
        raise SystemExit(f"the error of Kriging is {median(error for *_, error in smts):.3g} times SMT's")
    if many > LONGEST_KRIGING:
        raise SystemExit(f"Kriging takes {many:.2g} s to fit {MANY} runs")
    for more, longest in LONGEST_COMMAND.items():
        if command[more][1] > longest:
            raise SystemExit(f"susp-ss fit {' '.join(more)} takes {command[more][1]:.2g} s for {COMMAND} runs")
    for runs, least in LEAST_GAIN.items():
        if gain[runs] < least:
            raise SystemExit(f"the better peer has {gain[runs]:.2g} times our error at {runs} runs, not {least:g}")


if __name__ == "__main__":
    main()
