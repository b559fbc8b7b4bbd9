"""Pareto fronts of a full car: beside grids of a million designs, and beside pymoo's NSGA-II on the same engine.

The certificate takes every node of a grid that meets the limit: none may beat a design of the front, and none may do
better by more than 0.1 % where the front has a design. NSGA-II, its population 40 and else as pymoo sets it, is given
as many evaluations as the front's descents took, and ten and thirty times as many; the hypervolume is that
below the worst of all fronts, as a share of a front of 40 points. Then the best design over 10,000 scenarios; and where
designs land that were optimised on a surrogate of few runs instead of the car, on the linear car and on the nonlinear
one of ``examples/``. Writes a table under ``benchmarks/results``. Run with ``make bench``.
"""

import dataclasses
import os
import sys
import time
import warnings
from pathlib import Path

import numpy as np
import pandas as pd
import xarray as xr
from pymoo.algorithms.moo.nsga2 import NSGA2
from pymoo.core.problem import Problem
from pymoo.indicators.hv import HV
from pymoo.optimize import minimize as evolve
from report import digits, processor, rows
from scipy.stats import qmc

import susp_ss as ss
from susp_ss.metrics.outputs import output
from susp_ss.study.feasibility import DAMPING, STIFFNESS
from susp_ss.study.optima import MORE, RUNS, verified_optima
from susp_ss.study.published import CRITERIA

sys.path.insert(0, str(Path(__file__).parent.parent / "examples"))
import nonlinear_full_car

RESULTS = Path(__file__).parent / "results"

CAR, ROAD = ss.FullCar(), ss.DEFAULT_ROAD
OBJECTIVES, LIMIT = ("bacc@cg", "dtl@fr"), {"sws@fr": 0.0055}
FOUR = {"ks_front": STIFFNESS, "ks_rear": STIFFNESS, "cs_front": DAMPING, "cs_rear": DAMPING}
GRIDS = ({"ks": STIFFNESS, "cs": DAMPING}, {"ks_front": STIFFNESS, "cs_front": DAMPING, "arb_front": (0.0, 2e4)})

# Asserted: what a node of a grid may be better by, and seconds of a front of 20 points over four variables.
BETTER, LONGEST = 1e-3, 20.0


def timed(run):
    begun = time.perf_counter()
    result = run()
    return result, time.perf_counter() - begun


def certified(box, nodes):
    """By how much, relatively, the best node is better than the front where that has a design."""
    front, seconds = timed(lambda: ss.pareto_front(CAR, ROAD, box, OBJECTIVES, LIMIT))
    axes = {name: xr.DataArray(np.linspace(*side, nodes), dims=name) for name, side in box.items()}
    metrics, grid_seconds = timed(lambda: ss.ride_metrics(CAR.replaced(**axes), ROAD))
    x, y, z = (output(metrics, name).to_numpy().ravel() for name in (*OBJECTIVES, *LIMIT))
    met = z <= LIMIT["sws@fr"]
    x, y = x[met], y[met]
    better = 0.0
    for a, b in front.table()[list(OBJECTIVES)].to_numpy():
        better = max(better, a / x[y <= b].min(initial=np.inf) - 1.0, b / y[x <= a].min(initial=np.inf) - 1.0)
    ends = front.table()[list(OBJECTIVES)].min().to_numpy()
    better = max(better, *(ends / [x.min(), y.min()] - 1.0))
    return [", ".join(box), f"{met.size:,}", f"{100 * better:.5f}", digits(seconds, 2), digits(grid_seconds, 2)], better


class OnEngine(Problem):
    """The same problem for NSGA-II, a population in one call."""

    def __init__(self):
        low, high = np.transpose([*FOUR.values()])
        super().__init__(n_var=4, n_obj=2, n_ieq_constr=1, xl=low, xu=high)

    def _evaluate(self, X, out, *_, **__):
        metrics = ss.ride_metrics(CAR.replaced(**dict(zip(FOUR, X.T, strict=True))), ROAD)
        x, y, z = (output(metrics, name).to_numpy() for name in (*OBJECTIVES, *LIMIT))
        out["F"], out["G"] = np.stack([x, y], axis=-1), (z / LIMIT["sws@fr"] - 1.0)[:, None]


def beside_nsga2():
    front, seconds = timed(lambda: ss.pareto_front(CAR, ROAD, FOUR, OBJECTIVES, LIMIT))
    fine = ss.pareto_front(CAR, ROAD, FOUR, OBJECTIVES, LIMIT, 40).table()[list(OBJECTIVES)].to_numpy()
    spent = sum(front.evaluations.values())
    found = [("ours", spent, seconds, front.table()[list(OBJECTIVES)].to_numpy())]
    for times in (1, 10, 30):
        algorithm = NSGA2(pop_size=40)
        result, took = timed(lambda a=algorithm, n=times: evolve(OnEngine(), a, ("n_eval", n * spent), seed=1))
        found.append(("NSGA-II", times * spent, took, np.atleast_2d(result.F)))
    low, worst = fine.min(axis=0), np.max([one.max(axis=0) for *_, one in found] + [fine.max(axis=0)], axis=0)
    volume = HV(ref_point=np.full(2, 1.01))
    whole = volume((fine - low) / (worst - low))
    return seconds, [
        [name, f"{count:,}", digits(took, 2), len(F), f"{volume((F - low) / (worst - low)) / whole:.4f}"]
        for name, count, took, F in found
    ]


def over_scenarios():
    """One evaluation, and the one best design, over 10,000 vehicles and roads."""
    unit = qmc.LatinHypercube(4, rng=np.random.default_rng(0)).random(10_000)
    low, high = [1100.0, 1.6e5, 8.0, 1.6e-5], [1600.0, 2.3e5, 35.0, 2.56e-4]
    columns = qmc.scale(unit, low, high).T
    table = dict(zip(("mb", "kt", "speed", "roughness"), columns, strict=True))
    crossed = CAR.replaced(mb=table["mb"], kt=table["kt"])
    roads = dataclasses.replace(ROAD, speed=table["speed"], roughness=table["roughness"])
    _, once = timed(lambda: ss.ride_metrics(crossed, roads))
    box, body = {"ks": STIFFNESS, "cs": DAMPING}, []
    for statistic in ("mean", 0.95, "worst"):
        best, seconds = timed(
            lambda s=statistic: ss.pareto_front(CAR, ROAD, box, OBJECTIVES[:1], scenarios=table, statistic=s)
        )
        designs = best.evaluations["values"] + 2 * len(box) * best.evaluations["slopes"]
        body.append([statistic, digits(once, 2), designs, digits(seconds, 2), digits(1e3 * seconds / designs, 2)])
    return body


def box_designs(count):
    return ss.sample({"ks": STIFFNESS, "cs": DAMPING}, count, random_state=1).to_numpy()


def where_designs_land(expensive, sought=None):
    """Of every surrogate and number of runs: bacc beyond the true optimum, and excess over the worse limit, in %."""
    cheap = {name: ss.Response(ss.QuarterCar(), ROAD, name, parameter="ms") for name in CRITERIA}
    found = verified_optima(expensive, cheap, STIFFNESS, DAMPING, RUNS, sought=sought)
    cells = [f"{100 * row.beyond:+.2f} / {100 * row.excess:.2f}" for row in found.landed.itertuples()]
    body = pd.Series(cells, found.landed.index).unstack("runs", sort=False)
    return f"{100 * found.middle:+.2f}", body.reset_index().to_numpy().tolist()


def linear_car(X):
    ks, cs = np.transpose(X)
    metrics = ss.ride_metrics(CAR.replaced(ks=ks, cs=cs), ROAD)
    return np.stack([output(metrics, f"{name}@fr").to_numpy() for name in CRITERIA], axis=-1)


def nonlinear_car():
    """The example's car on its record of road, and Kriging of 53 runs in its place while it is searched."""
    record = nonlinear_full_car.record(ss.Road.iso8608("C", speed=20.0, tracks="isotropic"), 5.0, 0)

    def expensive(X):
        bacc, sws, dtl = np.transpose([nonlinear_full_car.run(ks, cs, record)[0] for ks, cs in X])
        return np.stack([bacc, dtl, sws], axis=-1)

    X = np.concatenate([box_designs(49), [[k, c] for k in STIFFNESS for c in DAMPING]])
    fitted = [ss.Kriging().fit(X, y) for y in expensive(X).T]
    return expensive, lambda X: np.stack([one.predict(X) for one in fitted], axis=-1)


def main():
    warnings.simplefilter("ignore", ss.ExtrapolationWarning)
    begun, load = time.perf_counter(), os.getloadavg()[0]
    certificates = [certified(box, nodes) for box, nodes in zip(GRIDS, (1000, 100), strict=True)]
    seconds, race = beside_nsga2()
    robust = over_scenarios()
    linear_gap, linear = where_designs_land(linear_car)
    curved_gap, curved = where_designs_land(*nonlinear_car())
    took = time.perf_counter() - begun
    RESULTS.joinpath("design.md").write_text(
        markdown(certificates, race, robust, (linear_gap, linear), (curved_gap, curved), load, took), encoding="utf-8"
    )
    assert max(better for _, better in certificates) < BETTER
    assert seconds < LONGEST


def markdown(certificates, race, robust, linear, curved, load, took):
    """All tables."""
    columns = ["surrogate", *(f"{runs} runs" for runs in RUNS)]
    text = [
        "# Designs",
        "",
        f"{processor()}, {os.cpu_count()} cores. One run of {took:.0f} s; load average at its start {load:.1f}.",
        "",
        "## Fronts of 20 points beside grids of all designs",
        "",
        *rows(
            ["variables", "nodes", "best node better by, %", "front, s", "grid, s"], [row for row, _ in certificates]
        ),
        "",
        "## Four variables, beside NSGA-II on the same engine",
        "",
        "An evaluation is a design's metrics, or their derivatives. Hypervolume as a share of a front of 40 points.",
        "",
        *rows(["", "evaluations", "s", "designs", "hypervolume"], race),
        "",
        "## Over 10,000 scenarios of mass, tyres, speed and roughness, two variables",
        "",
        *rows(["statistic", "one evaluation, s", "designs judged", "best design, s", "ms a design"], robust),
        "",
        "## Where designs land that were optimised on a surrogate",
        "",
        f"Least bacc at the front right corner, sws and dtl at most {MORE} times those in the middle of the range. In "
        "each cell: bacc of the design on the expensive car beyond that of its true optimum / excess over the worse "
        "limit, in %.",
        "",
        f"The linear full car; the middle of the range is at {linear[0]} %.",
        "",
        *rows(columns, linear[1]),
        "",
        f"The nonlinear car of the examples, 5 s of class C; the middle of the range is at {curved[0]} %. Its true "
        "optimum is sought on Kriging of 53 runs, and judged like the others by a run.",
        "",
        *rows(columns, curved[1]),
    ]
    return "\n".join(text) + "\n"


if __name__ == "__main__":
    main()
