"""Other roads, weighted outputs and systems of any making: time a design, beside what it stands in for.

Each pair is timed in turns, so that both meet the same machine, and its ratio is asserted. Writes a table under
``benchmarks/results``. Run with ``make bench``.
"""

import os
import platform
import time
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from importlib.metadata import version
from pathlib import Path
from statistics import median
from typing import Any

import control
import numpy as np
from report import LIBRARIES, digits, processor, rows
from rich.console import Console
from ride_metrics import Case, Race

import susp_ss as ss
from susp_ss.responses.covariance.routes import covariance_variances
from susp_ss.responses.excitation import spanned

RESULTS = Path(__file__).parent / "results"
MANY = 1000
FEW = 4  # cars that an integral over frequency is timed on
STATES, OUTPUTS = 30, 12

LYAPUNOV, EIG = "scipy's expm and Lyapunov solver", "batched numpy.linalg.eig"


class RandomSystems(Race):
    """Stable systems with random matrices, four wheels and a delay; the peers are given the matrices."""

    def __init__(self, count):
        rng = np.random.default_rng(count)
        inputs = [f"dz_r_{wheel}" for wheel in ss.FullCar.wheels]
        outputs = [f"y{i}" for i in range(OUTPUTS)]

        def system():
            A = 30.0 * rng.standard_normal((STATES, STATES))
            A -= (np.linalg.eigvals(A).real.max() + 5.0) * np.eye(STATES)
            B, C = rng.standard_normal((STATES, 4)), rng.standard_normal((OUTPUTS, STATES))
            return control.ss(A, B, C, np.zeros((OUTPUTS, 4)), inputs=inputs, outputs=outputs)

        self.systems = [system() for _ in range(count)]
        self.road = ss.Road()
        given = self.systems if count > 1 else self.systems[0]
        self.cars = ss.LinearVehicle(given, wheelbase=2.5, track_width=1.5)
        self.spanned = spanned(self.cars, self.road)

    @cached_property
    def matrices(self):
        A, B, Y = (np.stack([getattr(one, name) for one in self.systems]) for name in "ABC")
        return A, Y, B[:, :, :2].sum(axis=-1), B[:, :, 2:].sum(axis=-1)

    def ours_covariance(self):
        return ss.ride_metrics(self.cars, self.road)

    def ours_without_labels(self):
        space, flat, road = self.spanned
        return np.sqrt(covariance_variances(flat, space, road))


@dataclass(frozen=True)
class Pair:
    """Ours and what it is compared with, each on so many designs; ``agree`` refuses timings of different things.

    The ratio is the other's time over ours, asserted to be at least the bound; of what may be ``slower`` it is ours
    over the other's, asserted to be at most the bound.
    """

    name: str
    ours: Callable[[], Any]
    designs: int
    beside: str
    other: Callable[[], Any]
    other_designs: int
    bound: float | None
    slower: bool = False
    agree: Callable[[], None] = lambda: None

    def timed(self, turns=5) -> tuple[float, float]:
        """Medians of seconds a design, after a warm-up: ours and the other."""
        self.agree()
        taken: dict[Any, list[float]] = {self.ours: [], self.other: []}
        for turn in range(turns + 1):
            for run, seconds in taken.items():
                start = time.perf_counter()
                run()
                if turn:
                    seconds.append(time.perf_counter() - start)
        return median(taken[self.ours]) / self.designs, median(taken[self.other]) / self.other_designs

    def ratio(self, ours, other):
        return ours / other if self.slower else other / ours

    def kept(self, ratio):
        return self.bound is None or (ratio <= self.bound if self.slower else ratio >= self.bound)


def waviness(model, tracks):
    """A road of waviness 2.5: first-order terms beside the integral over frequency."""
    road = ss.Road(waviness=2.5, tracks=tracks)
    case = Case(model.__name__, model)
    many, few = case.designs(MANY), case.designs(FEW)

    def ours(cars=many):
        return ss.ride_metrics(cars, road)

    def other():
        return ss.ride_metrics(few, road, method="spectral")

    def agree():
        by_terms, by_integral = ours(few), other()
        for name in by_terms:
            np.testing.assert_allclose(by_terms[name], by_integral[name], rtol=1e-5, err_msg=name)

    name = f"{case.name}, waviness 2.5, {tracks} tracks"
    return Pair(name, ours, MANY, f"the spectral route, {FEW} cars", other, FEW, 2000.0, agree=agree)


def weighted():
    """Accelerations by Wk beside the same without."""
    road, cars = ss.Road(tracks="isotropic"), Case("FullCar", ss.FullCar).designs(MANY)

    def ours():
        return ss.ride_metrics(cars, road, weighting="Wk")

    def other():
        return ss.ride_metrics(cars, road)

    return Pair("FullCar, isotropic tracks, Wk", ours, MANY, "the same unweighted", other, MANY, 4.0, slower=True)


def systems(count, peer, bound, labels=True):
    race = RandomSystems(count)
    ours = race.ours_covariance if labels else race.ours_without_labels
    other = race.loop_on_scipy_lyapunov if count == 1 else race.batched_numpy_eig
    race.matrices  # noqa: B018

    def agree():
        bare, ride = other(), race.ours_covariance()
        labelled = np.stack([np.atleast_1d(ride[f"y{i}"]) for i in range(OUTPUTS)], axis=-1)
        np.testing.assert_allclose(labelled, bare, rtol=1e-6)
        np.testing.assert_allclose(race.ours_without_labels(), bare, rtol=1e-6)

    name = f"LinearVehicle, {STATES} states{'' if labels else ', bare numbers'}"
    return Pair(name, ours, count, peer, other, count, bound, slower=True, agree=agree)


def pairs():
    yield waviness(ss.QuarterCar, "identical")
    yield waviness(ss.FullCar, "isotropic")
    yield weighted()
    yield systems(1, LYAPUNOV, 2.5)
    yield systems(1, LYAPUNOV, 2.0, labels=False)
    yield systems(MANY, EIG, 1.0)


def main():
    say = Console(stderr=True, highlight=False).print
    load, body, broken = os.getloadavg()[0], [], []
    for pair in pairs():
        say(f"{pair.name}: {pair.designs:,} designs beside {pair.beside}")
        ours, other = pair.timed(turns=31 if pair.designs == 1 else 5)
        ratio = pair.ratio(ours, other)
        kind, most = ("ours over it", "at most") if pair.slower else ("it over ours", "at least")
        figures = (digits(1e6 * ours), pair.beside, digits(1e6 * other), f"{digits(ratio, 2)}, {kind}")
        body.append([pair.name, f"{pair.designs:,}", *figures, f"{most} {digits(pair.bound)}" if pair.bound else "–"])
        if not pair.kept(ratio):
            broken.append(f"{pair.name}, {pair.designs:,}: {ratio:.3g}, not {most} {pair.bound:g}")
    header = ["", "designs", "ours, µs a design", "beside", "µs a design", "ratio", "asserted"]
    libraries = ", ".join(f"{name} {version(name)}" for name in LIBRARIES)
    where = (
        f"{processor()}, {os.cpu_count()} cores, Python {platform.python_version()}, {libraries}; load average at its "
        f"start {load:.1f} (0 on a quiet machine). Medians of runs in turns. Ours starts from vehicles and ends with a "
        "checked, labelled Dataset; scipy and numpy start from matrices and end with bare numbers."
    )
    text = "\n".join(["# Any road, weighting and system", "", where, "", *rows(header, body), ""])
    (RESULTS / "any_road_any_system.md").write_text(text, encoding="utf-8")
    print(text)
    if broken:
        raise SystemExit("\n".join(broken))


if __name__ == "__main__":
    main()
