"""Sweeps beside memory on the same processors, and very many designs of which none is stored.

The same full cars on isotropic tracks go into memory, into a store by this process, and into a store by a Dask cluster
of as many one-thread workers as there are processors, in turn. What a chunk costs the client of a cluster is measured
with small ones, and says how many machines one client can serve. Then 10^9 quarter cars are reduced, as in
``examples/very_many.py``. Writes a table under ``benchmarks/results``. Run with ``make bench``.
"""

import argparse
import importlib.util
import os
import platform
import resource
import tempfile
import time
from importlib.metadata import version
from pathlib import Path
from statistics import median

import numpy as np
import psutil
import xarray as xr
from distributed import LocalCluster
from report import digits, processor, rows
from rich.console import Console

import susp_ss as ss
import susp_ss.sweep.plan
from susp_ss.sweep import sweep
from susp_ss.sweep.plan import MOST_DESIGNS

RESULTS = Path(__file__).parent / "results"
EXAMPLE = Path(__file__).parents[1] / "examples" / "very_many.py"

ROAD = ss.DEFAULT_ROAD
AXES = {"ks": np.linspace(12536.0, 24570.0, 2000), "cs": np.linspace(798.0, 2235.0, 1000)}
DESIGNS = 2_000_000
ROUNDS = 5

# Designs of a chunk, and chunks, when the client is measured.
SMALL, SMALL_CHUNKS = 1000, 500

# Asserted on every run, of the medians.
LEAST_RATIO = {"cluster of local": 0.9, "local of memory": 0.8}

MACHINES = 100

# Seconds of Dask's scheduler for a task, the upper end of what its manual says.
SCHEDULING = 1e-3

# Of a block: its metrics, its histogram, its least value and its front, and what joins these.
TASKS = 10


def loaded(path):
    spec = importlib.util.spec_from_file_location(path.stem, path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def in_memory():
    along = {name: xr.DataArray(values, {name: values}) for name, values in AXES.items()}
    ss.ride_metrics(ss.FullCar(**along), ROAD).load()


def into_a_store(scheduler=None, axes=AXES):
    with tempfile.TemporaryDirectory() as folder:
        sweep(ss.FullCar(), ROAD, axes, Path(folder, "out.zarr"), scheduler=scheduler)


def rates(say):
    """Designs a second of the three ways, in turn, after a warm-up of each, and processor seconds of all processes."""
    found, spent = {"memory": [], "local": [], "cluster": []}, {"memory": [], "local": [], "cluster": []}
    with LocalCluster(n_workers=os.cpu_count(), threads_per_worker=1, dashboard_address=":0") as cluster:
        ways = {
            "memory": in_memory,
            "local": into_a_store,
            "cluster": lambda: into_a_store(cluster.scheduler_address),
        }
        workers = [psutil.Process(worker.pid) for worker in cluster.workers.values()]

        def processors():
            return time.process_time() + sum(sum(worker.cpu_times()[:2]) for worker in workers)

        for turn in range(ROUNDS + 1):
            for name, run in ways.items():
                begun, before = time.perf_counter(), processors()
                run()
                per_second, used = DESIGNS / (time.perf_counter() - begun), processors() - before
                say(f"{name}: {per_second:,.0f} designs a second, {used:.1f} s of processors")
                if turn:
                    found[name].append(per_second)
                    spent[name].append(used)
        client = client_seconds(cluster.scheduler_address)
    return found, spent, client


def client_seconds(scheduler):
    """Processor time of this process for a chunk that the workers write: many small chunks less a single one."""
    axes = {"ks": np.linspace(12536.0, 24570.0, SMALL_CHUNKS), "cs": np.linspace(798.0, 2235.0, SMALL)}
    few = {**axes, "ks": axes["ks"][:1]}
    ordinary, spent = MOST_DESIGNS["covariance"], []
    try:
        susp_ss.sweep.plan.MOST_DESIGNS["covariance"] = SMALL
        for some in (few, axes):
            begun = time.process_time()
            into_a_store(scheduler, some)
            spent.append(time.process_time() - begun)
    finally:
        susp_ss.sweep.plan.MOST_DESIGNS["covariance"] = ordinary
    return (spent[1] - spent[0]) / (SMALL_CHUNKS - 1)


def reduced(nodes):
    """Designs a second of the example, its blocks, and the peak of this process's memory in MB."""
    example = loaded(EXAMPLE)
    example.main(["--nodes", "1000", "1000", "2"])
    per_second = example.main(["--nodes", *map(str, nodes)])
    blocks = int(np.prod(nodes)) / example.BLOCK
    return per_second, blocks, resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024


def markdown(found, spent, client, nodes, reduction, load):
    libraries = ", ".join(f"{name} {version(name)}" for name in ("numpy", "numba", "dask", "zarr"))
    return "\n".join(
        [
            "# Sweeps: designs a second",
            "",
            f"{processor()}, {os.cpu_count()} cores, Python {platform.python_version()}, {libraries}; load average at "
            f"its start {load:.1f} (0 on a quiet machine).",
            "",
            *stored(found, spent, client),
            "## Nothing stored",
            "",
            *not_stored(int(np.prod(nodes)), *reduction),
            "",
        ]
    )


def stored(found, spent, client):
    middle = {name: median(values) for name, values in found.items()}
    ratio = {name: digits(value, 2) for name, value in ratios(found).items()}
    chunk = MOST_DESIGNS["covariance"]
    every = sum(data.nbytes for data in ss.ride_metrics(ss.FullCar(), ROAD).values())
    kinds = {
        "memory": ("memory", ""),
        "local": ("local sweep, into a store", f"{ratio['local of memory']} of memory"),
        "cluster": (
            f"Dask cluster, {os.cpu_count()} one-thread workers that write for themselves",
            f"{ratio['cluster of local']} of local",
        ),
    }
    body = [
        [kind, digits(middle[name]), beside, digits(1e6 * median(spent[name]) / DESIGNS)]
        for name, (kind, beside) in kinds.items()
    ]
    return [
        f"{DESIGNS:,} full cars on isotropic tracks, every metric at every place; medians of {ROUNDS} rounds in which "
        "each way has its turn, and of the rounds' ratios.",
        "",
        *rows(["", "designs a second", "ratio", "µs of a processor a design"], body),
        "",
        f"A chunk of up to {chunk:,} designs costs the client and Dask's scheduler {digits(1e3 * client, 2)} ms of a "
        "processor where chunks come one by one (they are received together where they come faster), so that one "
        f"client keeps up with {digits(chunk / client / 1e6, 2)} million designs a second or more. On paper, "
        f"{MACHINES} such machines compute {digits(MACHINES * middle['cluster'] / 1e6, 2)} million a second, and write "
        f"{digits(MACHINES * middle['cluster'] * every / 1e9, 2)} GB/s of double precision before compression, which "
        "the store has to take.",
        "",
    ]


def not_stored(designs, per_second, blocks, memory):
    alone = designs / per_second
    together, scheduling = 1e9 / per_second / MACHINES, TASKS * blocks * 1e9 / designs * SCHEDULING
    seconds = max(together, scheduling)
    return [
        f"{designs:,} quarter cars: least acceleration, quantiles of travel and the Pareto front of both in one pass "
        f"(`examples/very_many.py`), {digits(per_second / 1e6, 2)} million a second, {digits(alone, 2)} s, with "
        f"{digits(memory, 2)} MB at most in memory.",
        "",
        f"On paper, 10^9 of them on {MACHINES} such machines: {digits(together, 2)} s of computing; beside it Dask's "
        f"scheduler takes {digits(scheduling, 2)} s for {TASKS} tasks a block of 1 ms each at most. So "
        f"{digits(seconds, 2)} s, or {digits(MACHINES * os.cpu_count() * seconds / 3600, 2)} hours of a core.",
    ]


def ratios(found):
    pairs = {"cluster of local": ("cluster", "local"), "local of memory": ("local", "memory")}
    return {
        name: median(a / b for a, b in zip(found[one], found[other], strict=True))
        for name, (one, other) in pairs.items()
    }


def main():
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument(
        "--nodes", type=int, nargs=3, default=(1000, 1000, 1000), metavar="N", help="of what is reduced"
    )
    nodes = parser.parse_args().nodes
    load, say = os.getloadavg()[0], Console(stderr=True, highlight=False).print
    reduction = reduced(nodes)
    found, spent, client = rates(say)
    text = markdown(found, spent, client, nodes, reduction, load)
    RESULTS.mkdir(exist_ok=True)
    (RESULTS / "sweeps.md").write_text(text, encoding="utf-8")
    print(text)
    for name, least in LEAST_RATIO.items():
        if ratios(found)[name] < least:
            raise SystemExit(f"{name}: {ratios(found)[name]:.2f}, not {least:g}")


if __name__ == "__main__":
    main()
