"""Ride metrics side by side with what a user would pick instead: time a design, and the ratio to the covariance route.

Every peer is given the assembled matrices for nothing. Lyapunov and eigenvalue peers compute what ours does (all
outputs, wheelbase delay, identical tracks) but for checks and labels; the H2 norm is one output of one input without
delay; the simulation is 20 s at 5 ms.
Writes a table and a plot under ``benchmarks/results``. Run with ``make bench``.
"""

import os
import platform
import time
from pathlib import Path
from statistics import median

import control
import numpy as np
import scipy.linalg
from matplotlib.figure import Figure

import susp_ss as ss

RESULTS = Path(__file__).parent / "results"
ROAD = ss.Road(roughness=64e-6, speed=20.0)
MODELS = {"quarter car": ss.QuarterCar, "pitch half car": ss.PitchHalfCar, "full car": ss.FullCar}
SWEEPS = (1, 10, 100, 1000, 10_000)
SECONDS_A_POINT = 2.0
REPEATS = 5

# Asserted on every run: our route beats these peers by at least so much on 1000 full cars.
LEAST_RATIO = {"control.forced_response": 20.0, "control.norm": 1.5}


def sweep(model, count):
    rng = np.random.default_rng(count)
    return model(ks=rng.uniform(12536, 24570, count), cs=rng.uniform(798, 2235, count))


def delayed(A, B_front, B_rear, tau):
    return np.outer(B_front, B_front) + np.outer(B_rear, B_rear) + symmetric(
        np.outer(scipy.linalg.expm(A * tau) @ B_front, B_rear)
    )  # fmt: skip


def symmetric(matrix):
    return matrix + np.swapaxes(matrix, -1, -2)


class Peers:
    """The same designs as plain matrices, and a peer a method."""

    def __init__(self, model, count):
        self.cars = sweep(model, count)
        assembled = self.cars.assemble()
        A, B, Y, _ = assembled.velocity_form()
        n = 2 * len(assembled.coordinates)
        self.A, self.Y = A[:, :n, :n], Y[:, :, :n]
        rear = np.array([float(wheel.axle) for wheel in self.cars.wheels.values()])
        self.front, self.rear = B[:, :n] @ (1.0 - rear), B[:, :n] @ rear
        self.tau = float(self.cars.wheelbase) / ROAD.speed

    def ours_covariance(self):
        ss.ride_metrics(self.cars, ROAD)

    def ours_spectral(self):
        ss.ride_metrics(self.cars, ROAD, method="spectral")

    def ours_time(self):
        ss.ride_metrics(self.cars, ROAD, method="time", duration=20.0, step=0.005)

    def loop_on_scipy_lyapunov(self):
        for A, Y, front, rear in zip(self.A, self.Y, self.front, self.rear, strict=True):
            X = scipy.linalg.solve_continuous_lyapunov(A, -ROAD.intensity * delayed(A, front, rear, self.tau))
            np.sqrt(np.abs(np.diag(Y @ X @ Y.T)))

    def batched_numpy_eig(self):
        eigenvalues, V = np.linalg.eig(self.A)
        front, rear = (np.linalg.solve(V, b[..., None].astype(complex)) for b in (self.front, self.rear))
        carried = np.exp(eigenvalues * self.tau)[..., None] * front
        T = np.swapaxes
        Q = front @ T(front, 1, 2) + rear @ T(rear, 1, 2) + symmetric(carried @ T(rear, 1, 2))
        X = -ROAD.intensity * Q / (eigenvalues[:, :, None] + eigenvalues[:, None, :])
        Z = self.Y @ V
        np.sqrt(np.abs(np.einsum("noi,nij,noj->no", Z, X, Z)))

    def control_norm(self):
        for A, Y, front in zip(self.A, self.Y, self.front, strict=True):
            control.norm(control.ss(A, front[:, None], Y[:1], 0.0), 2, method="scipy")

    def control_forced_response(self):
        t = np.arange(0.0, 20.0, 0.005)
        w = np.random.default_rng(0).standard_normal((1, len(t)))
        for A, Y, front in zip(self.A, self.Y, self.front, strict=True):
            control.forced_response(control.ss(A, front[:, None], Y, np.zeros((len(Y), 1))), t, w)


NAMES = {
    "ours_covariance": "susp_ss covariance",
    "batched_numpy_eig": "batched numpy.linalg.eig",
    "loop_on_scipy_lyapunov": "loop on scipy Lyapunov",
    "control_norm": "control.norm",
    "control_forced_response": "control.forced_response",
    "ours_spectral": "susp_ss spectral",
    "ours_time": "susp_ss time",
}


def timed(run):
    run()
    seconds = []
    for _ in range(REPEATS):
        start = time.perf_counter()
        run()
        seconds.append(time.perf_counter() - start)
    return median(seconds)


def measure():
    """Median seconds a design by (model, peer, designs); a peer stops growing when a run takes too long."""
    figures = {}
    for model_name, model in MODELS.items():
        done = set()
        for count in SWEEPS:
            peers = Peers(model, count)
            for peer in NAMES:
                if peer in done:
                    continue
                seconds = timed(getattr(peers, peer))
                figures[model_name, peer, count] = seconds / count
                if 10 * seconds > SECONDS_A_POINT:
                    done.add(peer)
    return figures


def at_most(figures, model, peer, count):
    """The figure at the largest sweep measured up to ``count``."""
    return figures[model, peer, max(n for m, p, n in figures if (m, p) == (model, peer) and n <= count)]


def table(figures):
    lines = [
        "# Ride metrics: microseconds a design",
        "",
        f"{platform.machine()}, {os.cpu_count()} cores, Python {platform.python_version()}, "
        f"numpy {np.__version__}; median of {REPEATS} runs at the largest sweep measured up to 1000 designs, one BLAS "
        "thread. In brackets: times ours.",
        "",
        "| | " + " | ".join(MODELS) + " |",
        "|---" * (len(MODELS) + 1) + "|",
    ]
    for peer, name in NAMES.items():
        cells = []
        for model in MODELS:
            own, other = (at_most(figures, model, p, 1000) for p in ("ours_covariance", peer))
            cells.append(f"{1e6 * other:.3g}" + ("" if peer == "ours_covariance" else f" ({other / own:.2g})"))
        lines.append(f"| {name} | " + " | ".join(cells) + " |")
    return "\n".join(lines) + "\n"


def plot(figures):
    figure = Figure(figsize=(9.0, 3.4), layout="constrained")
    for axes, model in zip(figure.subplots(1, len(MODELS), sharey=True), MODELS, strict=True):
        for peer, name in NAMES.items():
            points = sorted((n, 1e6 * s) for (m, p, n), s in figures.items() if (m, p) == (model, peer))
            axes.loglog(
                *zip(*points, strict=True), marker=".", label=name, linewidth=2.5 if peer == "ours_covariance" else 1
            )
        axes.set(title=model, xlabel="designs at once")
        axes.grid(linewidth=0.4)
    figure.axes[0].set_ylabel("time a design (µs)")
    figure.legend(*figure.axes[0].get_legend_handles_labels(), loc="outside lower center", ncols=4, frameon=False)
    return figure


def main():
    figures = measure()
    text = table(figures)
    print(text)
    RESULTS.mkdir(exist_ok=True)
    (RESULTS / "ride_metrics.md").write_text(text, encoding="utf-8")
    plot(figures).savefig(RESULTS / "ride_metrics.png", dpi=120)
    ours = at_most(figures, "full car", "ours_covariance", 1000)
    for name, least in LEAST_RATIO.items():
        ratio = at_most(figures, "full car", name.replace(".", "_"), 1000) / ours
        if ratio < least:
            raise SystemExit(f"{name} takes only {ratio:.2g} times our covariance route, expected at least {least:g}")


if __name__ == "__main__":
    main()
