"""Active bounds by `ss.active_bound` beside its semidefinite programme in cvxpy, with Clarabel and with SCS.

Fronts of 20 points of the least body acceleration under limits of suspension travel and tyre load, of the quarter car,
the car with pitch, and the full car. The programme is that of ``certify`` (`feedback.semidefinite`), compiled once for
all limits. With a delay there is none, for what is between the axles makes the state infinite. Writes
a table under ``benchmarks/results``.

    python benchmarks/feedback.py [--points 20]
"""

import argparse
import os
import platform
import time
from contextlib import contextmanager
from functools import partial
from importlib.metadata import version
from unittest.mock import patch

import numpy as np
from report import digits, processor, rows
from ride_metrics import RESULTS

import susp_ss as ss
from susp_ss.feedback import bound
from susp_ss.feedback.semidefinite import SOLVERS, programme

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


def timed(run):
    """Seconds of the processor, which a busy machine does not lengthen, and what was found."""
    start = time.process_time()
    found = run()
    return time.process_time() - start, found


@contextmanager
def clocked():
    """The seconds of the processor that semidefinite programmes take meanwhile, in a list of one."""
    clock = [0.0]

    def counted(function, *arguments):
        seconds, found = timed(lambda: function(*arguments))
        clock[0] += seconds
        return found

    def made(*arguments):
        return partial(counted, counted(programme, *arguments))

    with patch.object(bound, "programme", made):
        yield clock


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
    least = reached * (1.0 - np.array([point.unresolved for point in front.points]))
    for solver in SOLVERS:
        with clocked() as clock:
            found = ss.active_bound(car, road, minimise, limits, certify=solver)
        seconds, apart = clock[0], least / found.least.values - 1.0
        if solver == "clarabel":
            assert np.abs(apart).max() < NEAR, (name, apart)
        row.append(f"{digits(seconds, 2)} ({digits(seconds / ours, 2)}), {100 * apart[np.abs(apart).argmax()]:+.3f}%")
    return row


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--points", type=int, default=20)
    points = parser.parse_args().points
    load, start = os.getloadavg()[0], time.perf_counter()
    # What is imported and compiled once is no part of any row.
    for solver in SOLVERS:
        ss.active_bound(ss.QuarterCar(), APART, "bacc", {"sws": 0.006, "dtl": 430.0}, certify=solver)
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
        *rows(
            ("system", "passive", "bound", "`active_bound`", *(f"and `certify={solver!r}`" for solver in SOLVERS)), body
        ),
    ]
    (RESULTS / "feedback.md").write_text("\n".join(text) + "\n", encoding="utf-8")
    print("\n".join(text))


if __name__ == "__main__":
    main()
