"""Ride metrics side by side with what a user would pick instead: time a design, and the ratio to the covariance route.

Ours starts from parameters and ends with a labelled, checked Dataset. Every peer is given the assembled matrices for
nothing and returns bare numbers: the Lyapunov and eigenvalue peers those that ours does (all outputs, wheelbase delay,
identical tracks), `control.norm` one output of one input without delay, and the simulation 20 s at 5 ms.
Writes a table and a plot under ``benchmarks/results``. Run with ``make bench``.
"""

import os
import time
import warnings
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cached_property, partial
from pathlib import Path
from statistics import median
from typing import NamedTuple

import control
import numpy as np
import scipy.linalg
from report import markdown, plot, write
from rich.console import Console

import susp_ss as ss
from susp_ss.responses.covariance.routes import PLENTY

RESULTS = Path(__file__).parent / "results"

CONTENDERS = {
    "ours_covariance": "susp_ss covariance",
    "batched_numpy_eig": "batched numpy.linalg.eig",
    "loop_on_scipy_lyapunov": "loop on scipy Lyapunov",
    "control_norm": "control.norm, one output",
    "control_forced_response": "control.forced_response",
    "ours_spectral": "susp_ss spectral",
    "ours_time": "susp_ss time",
}
OURS, EIG, LYAPUNOV, NORM, *_ = CONTENDERS
OWN = tuple(name for name in CONTENDERS if name.startswith("ours"))

# Designs at once, and how often each is timed after a warm-up; 10^7 without one, since as many as are worth compiling
# for have loaded all that they need.
RUNS = {10**k: 5 for k in range(6)} | {10**6: 3, PLENTY: 3, 10**7: 1}

# Seconds that one run of another than our covariance route may take, judged by the run of a tenth as many designs.
LONGEST = 2.0

# Asserted on every run: these take at least so many times as long as ours on 1000 designs.
LEAST_RATIO = {
    "full car": {EIG: 7.0, LYAPUNOV: 25.0, NORM: 50.0},
    "full car, four unequal corners": {EIG: 2.0, LYAPUNOV: 6.0},
}


@dataclass(frozen=True)
class Case:
    """Vehicles of one kind that differ in springs and dampers, and who is timed on how many of them."""

    name: str
    model: type
    contenders: tuple[str, ...] = tuple(CONTENDERS)
    tracks: str = "identical"
    alike: bool = True
    largest: int = max(RUNS)

    @property
    def road(self):
        return ss.Road(roughness=64e-6, speed=20.0, tracks=self.tracks)

    @property
    def degrees_of_freedom(self):
        return len(self.model.layout().coordinates)

    def designs(self, count):
        rng = np.random.default_rng(count)

        def between(low, high):
            if self.alike:
                return rng.uniform(low, high, count)
            return ss.Corners(**{corner: rng.uniform(low, high, count) for corner in self.model.wheels})

        return self.model(ks=between(12536, 24570), cs=between(798, 2235))


PEERS = (OURS, EIG, LYAPUNOV)
CASES = (
    Case("rigid-tyre quarter car", ss.RigidTyreQuarterCar, PEERS, largest=10**5),
    Case("quarter car", ss.QuarterCar),
    Case("roll half car", ss.RollHalfCar, PEERS, largest=10**5),
    Case("pitch half car", ss.PitchHalfCar),
    Case("full car", ss.FullCar),
    Case("full car, isotropic tracks", ss.FullCar, OWN, tracks="isotropic"),
    Case("full car, four unequal corners", ss.FullCar, PEERS, alike=False, largest=10**6),
    Case("full car, four unequal corners, isotropic tracks", ss.FullCar, (OURS,), "isotropic", False, 10**6),
)
FULL_CAR = next(case for case in CASES if case.name == "full car")


def symmetric(matrix):
    return matrix + np.swapaxes(matrix, -1, -2)


class Race:
    """The same designs for all, and a contender a method; peers may be asked for the first few outputs only."""

    def __init__(self, case, count):
        self.road, self.cars = case.road, case.designs(count)

    def ours_covariance(self):
        return ss.ride_metrics(self.cars, self.road).sws

    def ours_spectral(self):
        return ss.ride_metrics(self.cars, self.road, method="spectral").sws

    def ours_time(self):
        return ss.ride_metrics(self.cars, self.road, method="time", duration=20.0, step=0.005).sws

    @cached_property
    def matrices(self):
        """``x' = A x + front w(t) + rear w(t - tau)``, ``y = Y x`` of all designs; without the warp, which is zero."""
        assembled = self.cars.assemble()
        A, B, Y, _ = assembled.velocity_form()
        n = 2 * len(assembled.layout.coordinates)
        behind = np.array([float(wheel.axle) for wheel in self.cars.wheels.values()])
        A, B, Y = (np.broadcast_to(x, (self.cars.design_space().size, *x.shape[-2:])) for x in (A, B, Y))
        return A[:, :n, :n], Y[:, :, :n], B[:, :n] @ (1.0 - behind), B[:, :n] @ behind

    @property
    def tau(self):
        return float(self.cars.wheelbase) / self.road.speed

    def loop_on_scipy_lyapunov(self, outputs=None):
        rms = []
        for A, Y, front, rear in zip(*self.matrices, strict=True):
            Q = np.outer(front, front)
            if self.tau:
                carried = scipy.linalg.expm(A * self.tau) @ front
                Q += np.outer(rear, rear) + symmetric(np.outer(carried, rear))
            X = scipy.linalg.solve_continuous_lyapunov(A, -self.road.intensity * Q)
            rms.append(np.sqrt(np.abs(np.einsum("oi,ij,oj->o", Y[:outputs], X, Y[:outputs]))))
        return np.array(rms)

    def batched_numpy_eig(self, outputs=None):
        A, Y, *inputs = self.matrices
        T = np.swapaxes
        eigenvalues, V = np.linalg.eig(A)
        front, rear = (np.linalg.solve(V, b[..., None].astype(V.dtype)) for b in inputs)
        Q = front @ T(front, 1, 2)
        if self.tau:
            carried = np.exp(eigenvalues * self.tau)[..., None] * front
            Q = Q + rear @ T(rear, 1, 2) + symmetric(carried @ T(rear, 1, 2))
        X = -self.road.intensity * Q / (eigenvalues[:, :, None] + eigenvalues[:, None, :])
        Z = Y[:, :outputs] @ V
        return np.sqrt(np.abs(np.sum((Z @ X) * Z, axis=-1)))

    def control_norm(self, outputs=1):
        intensity = np.sqrt(self.road.intensity)
        return np.array(
            [
                [intensity * control.norm(control.ss(A, front[:, None], y[None], 0.0), 2) for y in Y[:outputs]]
                for A, Y, front, _ in zip(*self.matrices, strict=True)
            ]
        )

    def control_forced_response(self):
        t = np.arange(0.0, 20.0, 0.005)
        w = np.random.default_rng(0).standard_normal((1, len(t)))
        for A, Y, front, _ in zip(*self.matrices, strict=True):
            history = control.forced_response(control.ss(A, front[:, None], Y, np.zeros((len(Y), 1))), t, w)
        return history.outputs


def check_agreement(case):
    """Refuse the timings of peers that compute something else than ours."""
    race = Race(case, 3)
    travel = [name.startswith("sws") for name in race.cars.layout().outputs.names]
    ours = race.ours_covariance().to_numpy().reshape(3, -1)
    for peer in set(case.contenders) & {EIG, LYAPUNOV}:
        np.testing.assert_allclose(getattr(race, peer)()[:, travel], ours, rtol=1e-6, err_msg=f"{peer}, {case.name}")


class Timing(NamedTuple):
    """Seconds of the first call and the median of the next ones; of the only call if it is not repeated.

    Of a contender that failed, until it did; ``failed`` says why.
    """

    first: float
    median: float
    failed: str = ""


def timed(run: Callable, runs: int) -> Timing:
    failed = ""

    def seconds():
        nonlocal failed
        start = time.perf_counter()
        # What a peer cannot do on some machine is a result, too.
        try:
            found = run()
        except (ArithmeticError, ValueError, RuntimeError, np.linalg.LinAlgError) as error:
            failed = f"failed: {type(error).__name__}, {' '.join(str(error).split())}"[:70]
            return time.perf_counter() - start
        taken = time.perf_counter() - start
        if np.isnan(found).any():
            failed = "failed: NaN"
        return taken

    first = seconds()
    again = [first] if failed or runs == 1 else [seconds() for _ in range(runs)]
    return Timing(first, median(again), failed)


def timings(case, say) -> Iterator[tuple[tuple[str, str, int], Timing]]:
    """Time the contenders by (case, contender, designs); one that would take too long is not run on more designs."""
    racing = list(case.contenders)
    for count in (n for n in RUNS if n <= case.largest):
        race = Race(case, count)
        for contender in tuple(racing):
            say(f"{case.name}: {count:,} designs, {CONTENDERS[contender]}")
            if contender not in OWN:
                race.matrices  # noqa: B018
            timing = timed(getattr(race, contender), RUNS[count])
            if timing.failed:
                say(f"{case.name}: {CONTENDERS[contender]} {timing.failed}")
                if contender in OWN:
                    raise SystemExit(f"{CONTENDERS[contender]}, {count:,} designs of {case.name}: {timing.failed}")
            yield (case.name, contender, count), timing
            if contender != OURS and 10 * timing.median > LONGEST:
                racing.remove(contender)


def output_timings(say, count=100):
    """Time the contenders on some full cars by (contender, outputs); ours gives all outputs at once."""
    race = Race(FULL_CAR, count)
    every = race.matrices[1].shape[1]
    for peer in (EIG, LYAPUNOV, NORM):
        for outputs in (1, every):
            say(f"{count} full cars, outputs: {outputs}, {CONTENDERS[peer]}")
            yield (peer, outputs), timed(partial(getattr(race, peer), outputs=outputs), 5)
    yield (OURS, every), timed(race.ours_covariance, 5)


def main():
    # Not so: the slowest mode is a body's, near 1 Hz.
    warnings.filterwarnings("ignore", "There appears to be poles close to the imaginary axis", UserWarning)
    say = Console(stderr=True, highlight=False).print
    load, start = os.getloadavg()[0], time.perf_counter()
    by_designs = {key: timing for case in CASES for key, timing in timings(case, say)}
    by_outputs = dict(output_timings(say))
    took = time.perf_counter() - start
    for case in CASES:
        check_agreement(case)
    text = markdown(CASES, CONTENDERS, RUNS, by_designs, by_outputs, load, took)
    write(RESULTS, "ride_metrics", text, plot(CASES, CONTENDERS, by_designs))
    print(text)

    for case, least_of in LEAST_RATIO.items():
        ours = by_designs[case, OURS, 1000].median
        for peer, least in least_of.items():
            timing = by_designs[case, peer, 1000]
            ratio = timing.median / ours
            if not timing.failed and ratio < least:
                found = f"{CONTENDERS[peer]} takes {ratio:.2g} times as long as ours"
                raise SystemExit(f"{found} on 1000 designs of {case}, not {least:g}")


if __name__ == "__main__":
    main()
