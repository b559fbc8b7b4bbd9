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
from scipy.integrate import cubature

import susp_ss as ss
from susp_ss.responses.covariance.routes import covariance_variances
from susp_ss.responses.excitation import spanned

RESULTS = Path(__file__).parent / "results"
MANY = 1000
FEW = 4  # cars that an integral over frequency is timed on
RUNS, STEP = 100, 1e-3  # designs that are driven over one road, in steps of so many seconds
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


def exact(name, vehicle, road):
    """Many vehicles on a road beside a few by the integral over frequency; ``vehicle`` makes so many of them."""
    many, few = vehicle(MANY), vehicle(FEW)

    def ours(vehicles=many):
        return ss.ride_metrics(vehicles, road)

    def other():
        return ss.ride_metrics(few, road, method="spectral")

    def agree():
        by_terms, by_integral = ours(few), other()
        for metric in by_terms:
            # So much is kept by terms that stand for the coherence of isotropic tracks.
            np.testing.assert_allclose(by_terms[metric], by_integral[metric], rtol=1e-4, err_msg=metric)

    return Pair(name, ours, MANY, f"the spectral route, {FEW} of them", other, FEW, 100.0, agree=agree)


def waviness(model, tracks):
    """A road of waviness 2.5: first-order terms beside the integral over frequency."""
    case = Case(model.__name__, model)
    return exact(f"{case.name}, waviness 2.5, {tracks} tracks", case.designs, ss.Road(waviness=2.5, tracks=tracks))


def trucks():
    """Three axles, laden and unladen."""

    def laden(count):
        return ss.ThreeAxleTruck(mb=np.linspace(9e3, 22e3, count))

    return exact("ThreeAxleTruck, isotropic tracks", laden, ss.Road(tracks="isotropic"))


def integrated(model, tracks):
    """The spectral route of one car beside scipy's cubature of the same spectrum, its breaks at the resonances."""
    car, road = model(), ss.Road(tracks=tracks)
    breaks = [np.array([u]) for u in np.log(car.modes()["frequency"])]
    outputs = [name for name in ss.psd(car, road, [1.0]).output.values.tolist() if name.startswith(("sws", "dtl"))]
    exact = ss.ride_metrics(car, road)
    scale = [exact[name].item() if not exact[name].dims else exact[name][0].item() for name in ("sws", "dtl")]
    sizes = np.repeat(scale, len(outputs) // 2)[:, None] ** 2

    def density(u):
        f = np.exp(u[:, 0])
        return (ss.psd(car, road, f).sel(output=outputs).values * f / sizes).T

    def ours():
        return ss.ride_metrics(car, road, method="spectral")

    def other():
        ends = [np.log(1e-12)], [np.log(1e9)]
        return np.sqrt(cubature(density, *ends, rule="gk21", rtol=1e-7, atol=1e-12, points=breaks).estimate)

    def agree():
        first = other().reshape(2, -1)[:, 0] * scale
        for name, value in zip(("sws", "dtl"), first, strict=True):
            np.testing.assert_allclose(np.ravel(ours()[name])[0], value, rtol=1e-6)

    return Pair(f"{model.__name__}, {tracks} tracks, spectral", ours, 1, "scipy's cubature", other, 1, 5.0, agree=agree)


def driven(model):
    """A minute over one road in steps of a millisecond, many designs, beside python-control's of one."""
    ks = np.linspace(12e3, 30e3, RUNS)
    time = STEP * np.arange(60001)
    z = 1e-3 * np.cumsum(np.random.default_rng(1).standard_normal((len(model.wheels), len(time))), axis=1)
    z -= z[:, :1]

    def ours(cars=None):
        return ss.simulate(model(ks=ks) if cars is None else cars, z, time, reduce="peak")

    def other():
        return control.forced_response(model(ks=ks[0]).state_space(), time, z).outputs

    def agree():
        found = ours(model(ks=ks[0]))["sws"].values
        peaks = np.abs(other()).max(axis=-1)
        rows = [i for i, name in enumerate(model(ks=ks[0]).state_space().output_labels) if name.startswith("sws")]
        np.testing.assert_allclose(np.ravel(found), peaks[rows], rtol=1e-9)

    return Pair(f"{model.__name__}, 60 s at 1 ms", ours, RUNS, "control.forced_response", other, 1, 10.0, agree=agree)


def answered(model):
    """Frequency responses of many designs beside python-control's of a few."""
    ks, f = np.linspace(12e3, 30e3, RUNS), np.geomspace(0.1, 50.0, 500)

    def ours():
        return ss.frequency_response(model(ks=ks), f)

    def other():
        return np.stack([model(ks=k).state_space()(2j * np.pi * f, squeeze=False) for k in ks[:FEW]])

    def agree():
        expected = other()
        np.testing.assert_allclose(ours()[:FEW], expected, atol=1e-10 * abs(expected).max())

    name = f"{model.__name__}, response at 500 frequencies"
    return Pair(name, ours, RUNS, "python-control", other, FEW, 5.0, agree=agree)


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
    yield trucks()
    yield weighted()
    yield integrated(ss.QuarterCar, "identical")
    yield integrated(ss.RollHalfCar, "isotropic")
    yield driven(ss.QuarterCar)
    yield driven(ss.FullCar)
    yield answered(ss.QuarterCar)
    yield answered(ss.FullCar)
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
