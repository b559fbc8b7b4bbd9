"""Active bounds by `ss.active_bound` beside a semidefinite programme in cvxpy, with Clarabel and with SCS.

Fronts of 20 points of the least body acceleration under limits of suspension travel and tyre load, of the quarter car,
the car with pitch, and the full car. The programme minimises over the covariance X and ``Y = K X`` (Boyd et al., Linear
Matrix Inequalities in System and Control Theory (1994), chapter 7); its states are scaled by their own root mean
squares, it is compiled once for all limits, and solved by one solver after the other. With a delay there is none, for
what is between the axles makes the state infinite. Writes a table under ``benchmarks/results``.

    python benchmarks/feedback.py [--points 20]
"""

import argparse
import os
import platform
import time
import warnings
from importlib.metadata import version

import cvxpy as cp
import numpy as np
import scipy.linalg
from report import digits, processor, rows
from ride_metrics import RESULTS

import susp_ss as ss

APART = ss.Road.iso8608("B", speed=20.0, tracks="independent", delay=False)
BEHIND = ss.Road.iso8608("B", speed=20.0, tracks="isotropic")
CASES = {
    "quarter car": (ss.QuarterCar(), APART, True),
    "car with pitch, no delay": (ss.PitchHalfCar(), APART, True),
    "full car, no delay": (ss.FullCar(), APART, True),
    "car with pitch, preview": (ss.PitchHalfCar(), BEHIND, True),
    "car with pitch, states alone": (ss.PitchHalfCar(), BEHIND, False),
    "full car, preview": (ss.FullCar(), BEHIND, True),
    "full car, states alone": (ss.FullCar(), BEHIND, False),
}
SOLVERS = {"Clarabel": {"solver": "CLARABEL"}, "SCS": {"solver": "SCS", "eps": 1e-6, "max_iters": 5000}}

# Force in N for which the programme's Y is one, in the states' own root mean squares.
FORCE = 1e3

# Least and largest limit of the front, as a share of the passive car's own.
SHARES = 0.9, 1.4

# Asserted: our bounds, less what they leave unresolved, are those of Clarabel.
NEAR = 1e-3


def limits_of(car, road, shares):
    """Travel and tyre load at every place, as shares of the car's own."""
    own, found = ss.ride_metrics(car, road), {}
    for name in ("sws", "dtl"):
        places = own[name].coords["corner"].values if own[name].dims else [""]
        for place, value in zip(places, own[name].values.flat, strict=True):
            found[f"{name}@{place}" if place else name] = shares * float(value)
    return found


def programme(car, road, minimise, names):
    """The bound as a function of limits by name and a solver's options."""
    system = car.state_space(input="velocity", actuators=True)
    wheels, n = len(car.wheels), system.nstates - car.layout().warps
    sides = sorted({wheel.side for wheel in car.wheels.values()})
    both = np.array([[wheel.side == side for side in sides] for wheel in car.wheels.values()], dtype=float)
    A, B, W = system.A[:n, :n], system.B[:n, wheels:], system.B[:n, :wheels] @ both
    Q = road.intensity * W @ W.T
    size = np.sqrt(np.diag(scipy.linalg.solve_continuous_lyapunov(A, -Q)))
    A, B, Q = A / size[:, None] * size, FORCE * B / size[:, None], Q / np.outer(size, size)
    X, Y = cp.Variable((n, n), symmetric=True), cp.Variable((B.shape[1], n))
    flow = A @ X + B @ Y
    holds, scales, shares = [flow + flow.T + Q << 0], {}, {}
    for name in (minimise, *names):
        row = system.output_labels.index(name.replace("@", "_"))
        c, d = system.C[[row], :n] * size, FORCE * system.D[[row], wheels:]
        scales[name] = np.linalg.norm(c)
        S, z = cp.Variable((1, 1)), (c @ X + d @ Y) / scales[name]
        holds.append(cp.bmat([[S, z], [z.T, X]]) >> 0)
        if name == minimise:
            goal = S[0, 0]
        else:
            shares[name] = cp.Parameter(nonneg=True)
            holds.append(shares[name] >= S)
    problem = cp.Problem(cp.Minimize(goal), holds)

    def solved(limits, options):
        for name, limit in limits.items():
            shares[name].value = (limit / scales[name]) ** 2
        with warnings.catch_warnings():
            warnings.filterwarnings("ignore", "Solution may be inaccurate")
            problem.solve(**options)
        return float(np.sqrt(problem.value) * scales[minimise]) if problem.value is not None else np.nan

    return solved


def timed(run):
    """Seconds of the processor, which a busy machine does not lengthen, and what was found."""
    start = time.process_time()
    found = run()
    return time.process_time() - start, found


def measured(name, car, road, preview, points):
    """One row of the table."""
    minimise = "bacc" if isinstance(car, ss.QuarterCar) else "bacc@cg"
    limits = limits_of(car, road, np.linspace(*SHARES, points))
    ours, front = timed(lambda: ss.active_bound(car, road, minimise, limits, preview=preview))
    own = ss.ride_metrics(car, road).bacc
    passive = float(own.sel(point="cg") if own.dims else own)
    reached = front.bound.values
    row = [name, f"{digits(passive)}", f"{digits(reached[0])} to {digits(reached[-1])}", digits(ours, 2)]
    if road.delay:
        return [*row, "none", "none"]
    solve = programme(car, road, minimise, limits)
    at = [{key: float(value[i]) for key, value in limits.items()} for i in range(points)]
    least = reached * (1.0 - np.array([point.unresolved for point in front.points]))
    for solver, options in SOLVERS.items():
        seconds, found = timed(lambda options=options: np.array([solve(one, options) for one in at]))
        apart = least / found - 1.0
        if solver == "Clarabel":
            assert np.abs(apart).max() < NEAR, (name, apart)
        row.append(f"{digits(seconds, 2)} ({digits(seconds / ours, 2)}), {100 * apart[np.abs(apart).argmax()]:+.3f}%")
    return row


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--points", type=int, default=20)
    points = parser.parse_args().points
    load, start = os.getloadavg()[0], time.perf_counter()
    # What is imported and compiled once is no part of any row.
    ss.active_bound(ss.QuarterCar(), APART, "bacc", {"sws": 0.006, "dtl": 430.0})
    body = [measured(name, *case, points) for name, case in CASES.items()]
    libraries = ", ".join(f"{name} {version(name)}" for name in ("numpy", "scipy", "cvxpy", "clarabel", "scs"))
    text = [
        f"# Fronts of {points} active bounds: processor seconds",
        "",
        f"{processor()}, {os.cpu_count()} cores, Python {platform.python_version()}, {libraries}. One run of "
        f"{time.perf_counter() - start:.0f} s; load average at its start {load:.1f} (0 on a quiet machine). Body "
        f"acceleration in m/s², passive and least with {100 * SHARES[0]:.0f} % and {100 * SHARES[1]:.0f} % of the "
        "passive car's travel and tyre loads; in brackets the ratio of seconds to ours, and after it how far our "
        "bound, less what it leaves unresolved, is at most from the programme's.",
        "",
        *rows(("system", "passive", "bound", "`active_bound`", "cvxpy, Clarabel", "cvxpy, SCS"), body),
    ]
    (RESULTS / "feedback.md").write_text("\n".join(text) + "\n", encoding="utf-8")
    print("\n".join(text))


if __name__ == "__main__":
    main()
