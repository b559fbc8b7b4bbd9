"""An expensive model to tune a cheap one to: a nonlinear full car, integrated in time, that leaves a table of runs.

    python examples/nonlinear_full_car.py --runs 60 --out runs.csv

It stands for whatever gives you runs: a multibody program, a test rig. Only its table is meant to be read by others,
one row a design: spring and damper rate, the same at all corners, then at the front right corner the root mean squares
of the body's acceleration above it, of the suspension's travel and of the dynamic tyre load, both from standing still.

The car is `FullCar` with three things that a linear model has not:

- dampers softer in bump than in rebound, and digressive: beyond a knee the force rises less. ``cs`` is the mean of the
  two slopes below the knee;
- bump stops that stiffen as they are pressed;
- tyres that push and never pull: a wheel whose load has gone to zero is off the road.

It is integrated as a linear car with inputs: the road's heights, and the forces ``f`` by which its struts and tyres
differ from linear ones. Over a step both are taken as linear in time, and the car's answer to them is exact; ``f`` at
the end of the step is first guessed from the answer to an ``f`` that stays as it was (exponential Heun, second order).
On the default road, class C at 20 m/s, stops and lift-off are at work without being the rule; a summary says how much.
All runs ride over the same record of road, and each is settled before it counts.
"""

import argparse
import math
import os
import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from time import perf_counter
from typing import NamedTuple, NoReturn

import numpy as np
from numpy.typing import NDArray
from rich.console import Console
from rich.progress import track
from scipy.linalg import expm
from scipy.stats import qmc

from susp_ss import FullCar, Road
from susp_ss.roads import wheel_heights
from susp_ss.study.feasibility import DAMPING, STIFFNESS

Array = NDArray[np.float64]

STEP = 1e-3  # s; a quarter of it changes the root mean squares by 0.01 % on class C at 20 m/s
SETTLING = 5.0  # s, in which the least damped design forgets 99.8 % of its start

SAMPLINGS = {"latin-hypercube": qmc.LatinHypercube, "halton": qmc.Halton}
HEADER = "ks,cs,bacc,sws,dtl\nN/m,N s/m,m/s^2,m,N\n"


@dataclass(frozen=True, kw_only=True)
class Laws:
    """Forces of struts and tyres, as the linear car has its signs: positive in compression, where a force pushes."""

    bump: float = 0.6  # slope of the damper below the knee, of cs
    rebound: float = 1.4
    knee: float = 0.3  # m/s
    beyond: float = 0.5  # slope beyond the knee, of the slope below it
    jounce: float = 0.035  # m of travel before a stop touches
    droop: float = 0.045
    stop_rate: float = 30e3  # N/m at first touch
    stop_depth: float = 0.02  # m at which the stop pushes twice as hard as its first rate says
    gravity: float = 9.81  # m/s^2

    def damper(self, rate: Array, cs: float) -> Array:
        slope = cs * np.where(rate > 0.0, self.bump, self.rebound)
        below = np.minimum(np.maximum(rate, -self.knee), self.knee)
        return slope * (self.beyond * rate + (1.0 - self.beyond) * below)

    def stop(self, travel: Array) -> Array:
        pressed = travel - np.minimum(np.maximum(travel, -self.droop), self.jounce)
        return self.stop_rate * pressed * (1.0 + (pressed / self.stop_depth) ** 2)

    def tyre(self, squeeze: Array, kt: float, load: Array) -> Array:
        """The change from the static ``load``, which is all that an unloading tyre can lose."""
        return np.maximum(kt * squeeze, -load)

    def static_load(self, car: FullCar) -> Array:
        """Load on each tyre (4,) of the car standing still."""
        lever = np.array([car.b, car.b, car.a, car.a]) / (car.a + car.b)
        return self.gravity * (0.5 * car.mb * lever + car.mu)


class History(NamedTuple):
    """A ride over time, each (wheels, T) in the order of ``FullCar.wheels``."""

    bacc: Array
    sws: Array
    dtl: Array
    on_stop: NDArray[np.bool_]
    lifted: NDArray[np.bool_]


def ride(car: FullCar, z: Array, step: float, laws: Laws) -> History:
    """Drive over road heights z (wheels, T), linear between samples, from the linear car's equilibrium on the first."""
    model = car.assemble()
    A, B, Y, D, _ = model.displacement_form()
    wheels, samples = z.shape
    states, load = len(A), laws.static_load(car)
    links = np.concatenate([model.suspensions, model.tyres])

    # What the laws act on, as shares of the states and of the road: travel, its rate, and how far the tyre is squeezed.
    of_states, of_road = np.zeros((3, wheels, states)), np.zeros((3, *z.shape))
    of_states[0, :, : states // 2] = of_states[1, :, states // 2 :] = model.R[model.suspensions]
    of_states[2, :, : states // 2] = model.R[model.tyres]
    of_road[2] = model.N[model.tyres] @ z

    def differing(x: Array, n: int) -> Array:
        """Forces (struts, then tyres) by which the laws differ from the linear car's."""
        travel, rate, squeeze = of_states @ x + of_road[..., n]
        strut = laws.damper(rate, car.cs) - car.cs * rate + laws.stop(travel)
        return np.concatenate([strut, laws.tyre(squeeze, car.kt, load) - car.kt * squeeze])

    accelerations = -model.R[links].T / model.m[:, None]
    B_f = np.concatenate([np.zeros_like(accelerations), accelerations])
    free, hold, ramp = linear_step(A, np.concatenate([B, B_f], axis=1), step)
    (hold_z, hold_f), (ramp_z, ramp_f) = (np.split(gain, [wheels], axis=1) for gain in (hold, ramp))
    pushed = (hold_z @ z[:, :-1] + ramp_z @ np.diff(z, axis=1)).T

    x, f = np.empty((samples, states)), np.empty((samples, 2 * wheels))
    x[0] = np.linalg.solve(A, -B @ z[:, 0])
    f[0] = differing(x[0], 0)
    for n, push in enumerate(pushed):
        guess = free @ x[n] + push + hold_f @ f[n]
        x[n + 1] = guess + ramp_f @ (differing(guess, n + 1) - f[n])
        f[n + 1] = differing(x[n + 1], n + 1)

    travel, _, squeeze = of_states @ x.T + of_road
    outputs = model.layout.outputs.names
    above = [outputs.index(f"bacc_{wheel}") for wheel in model.layout.corners]
    bacc = Y[above] @ x.T + D[above] @ z + model.acceleration[above] @ accelerations @ f.T
    dtl = laws.tyre(squeeze, car.kt, load[:, None])
    return History(bacc, travel, dtl, laws.stop(travel) != 0.0, dtl == -load[:, None])


def linear_step(A: Array, B: Array, step: float) -> tuple[Array, Array, Array]:
    """``x(t+h) = free x + hold u(t) + ramp (u(t+h) - u(t))``, exact for inputs linear over the step."""
    n, m = B.shape
    block = np.zeros((n + 2 * m, n + 2 * m))
    block[:n, :n], block[:n, n : n + m], block[n : n + m, n + m :] = step * A, step * B, np.eye(m)
    free, hold, ramp = np.split(expm(block)[:n], [n, n + m], axis=1)
    return free, hold, ramp


def record(road: Road, duration: float, seed: int) -> Array:
    """Road heights (wheels, T) under the four wheels; the end comes once more in front, to settle on."""
    car = FullCar()
    z = wheel_heights(
        road,
        duration,
        STEP,
        sides=[wheel.side for wheel in car.wheels.values()],
        delays=[wheel.axle * (car.a + car.b) / road.speed for wheel in car.wheels.values()],
        track_width=2.0 * car.c,
        seed=seed,
    )
    return np.take(z, np.arange(-round(SETTLING / STEP), z.shape[1]), axis=1, mode="wrap")


def run(ks: float, cs: float, z: Array) -> tuple[Array, Array]:
    """Root mean squares bacc, sws and dtl at the front right; shares of time of any stop touched, any wheel lifted."""
    history = ride(FullCar(ks=ks, cs=cs), z, STEP, Laws())
    *measured, on_stop, lifted = (values[:, round(SETTLING / STEP) :] for values in history)
    rms = np.sqrt([np.mean(values[0] ** 2) for values in measured])
    return rms, np.array([on_stop.any(axis=0).mean(), lifted.any(axis=0).mean()])


def designs(count: int, sampling: str, seed: int) -> Array:
    """Springs and dampers (count, 2) over the study's range, rounded as they will be written."""
    unit_square = SAMPLINGS[sampling](2, rng=seed).random(count)
    return qmc.scale(unit_square, *zip(STIFFNESS, DAMPING, strict=True)).round(3)


class Table:
    """Runs on their way into a file: a first line says what asked for them, each run follows as soon as it is done."""

    def __init__(self, out: Path, settings: str):
        self.out, self.partial = out, out.with_name(f"{out.name}.partial")
        if out.exists():
            raise FileExistsError(f"{out} exists already; give another --out or remove it")
        begin = f"# {settings}\n{HEADER}"
        if not self.partial.exists():
            self.partial.write_text(begin)
        text = self.partial.read_text()
        if not text.startswith(begin):
            begun = text.partition("\n")[0].removeprefix("# ")
            raise FileExistsError(f"{self.partial} was begun with {begun}; give the same or remove it")
        whole = text[: text.rindex("\n") + 1]
        os.truncate(self.partial, len(whole))
        self.done = whole.count("\n") - begin.count("\n")

    def append(self, *numbers: float) -> None:
        with self.partial.open("a") as file:
            file.write(",".join(f"{number:.9g}" for number in numbers) + "\n")

    def finish(self) -> None:
        finished = self.out.with_name(f"{self.out.name}.finished")
        finished.write_text(self.partial.read_text().partition("\n")[2])
        finished.replace(self.out)
        self.partial.unlink()


class Parser(argparse.ArgumentParser):
    """Says what is wrong in one line."""

    def error(self, message: str) -> NoReturn:
        self.exit(2, f"{self.prog}: {message}\n")


def between(least: float, most: float, kind: type = float) -> Callable[[str], float]:
    def number(text: str) -> float:
        try:
            value = kind(text)
        except ValueError:
            value = math.nan
        if not least <= value <= most:
            what = "a whole number" if kind is int else "a number"
            raise argparse.ArgumentTypeError(f"needs {what} from {least:g} to {most:g}, got {text!r}")
        return value

    return number


def main(arguments: Sequence[str] | None = None) -> None:
    parser = Parser(description="Runs of a nonlinear full car on a random road, as CSV.", allow_abbrev=False)
    add = parser.add_argument
    add("--runs", type=between(1, 1e5, int), default=60, help="number of designs (%(default)s)")
    add("--out", type=Path, required=True, help="CSV file to write; the same command goes on where one stopped")
    add("--seed", type=between(0, 1e9, int), default=0, help="of the designs and of the road (%(default)s)")
    add("--duration", type=between(1.0, 3600.0), default=30.0, help="of the record in s (%(default)s)")
    # Faster or rougher, the car mostly flies, and chaos takes the digits.
    add("--speed", type=between(1.0, 40.0), default=20.0, help="in m/s, up to 40 (%(default)s)")
    add("--road-class", choices=tuple("ABCD"), default="C", help="of ISO 8608 (%(default)s)")
    add("--sampling", choices=SAMPLINGS, default="latin-hypercube", help="of the designs (%(default)s)")
    asked = parser.parse_args(arguments)
    settings = " ".join(f"--{name.replace('_', '-')} {value}" for name, value in vars(asked).items() if name != "out")

    road = Road.iso8608(asked.road_class, speed=asked.speed, tracks="isotropic")
    began, shares = perf_counter(), []
    try:
        table = Table(asked.out, settings)
        z = record(road, asked.duration, asked.seed)
        missing = designs(asked.runs, asked.sampling, asked.seed)[table.done :]
        for ks, cs in track(missing, "runs", console=Console(stderr=True)):
            rms, share = run(ks, cs, z)
            table.append(ks, cs, *rms)
            shares.append(share)
        table.finish()
    except OSError as refused:
        parser.error(str(refused))
    except KeyboardInterrupt:
        parser.exit(130, f"{parser.prog}: stopped; the same command goes on from here\n")
    said = f"{asked.out}: {asked.runs} runs, {table.done} of them found; {road.describe()}"
    if shares:
        (stop, lift), seconds = np.mean(shares, axis=0), (perf_counter() - began) / len(shares)
        said += f"\n{seconds:.1f} s a run; a stop touched {stop:.2%}, a wheel off the road {lift:.2%} of the time"
    print(said, file=sys.stderr)


if __name__ == "__main__":
    main()
