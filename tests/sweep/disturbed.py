"""What the tests of sweeps share: a small sweep, the files of a store, and ways of stopping."""

import subprocess
import sys

import numpy as np

import susp_ss as ss
import susp_ss.sweep.computing
from susp_ss.sweep import sweep

ROAD = ss.DEFAULT_ROAD
AXES = {"ks": np.linspace(12e3, 25e3, 8), "cs": np.linspace(800.0, 2200.0, 5)}

# Of the eight springs two fit into a chunk.
CHUNKS = 4

LINE = ["--model", "quarter", "--ks", "12e3:25e3:8", "--cs", "800:2200:5", "--store"]


def files(store):
    """Every file of a store and what it holds, but what a kill left beside it."""
    return {
        str(path.relative_to(store)): path.read_bytes()
        for path in store.rglob("*")
        if path.is_file() and path.suffix != ".partial"
    }


def undisturbed_files(folder, vehicle, axes, **how):
    sweep(vehicle, ROAD, axes, folder / "undisturbed.zarr", **how)
    return files(folder / "undisturbed.zarr")


def stopping(patch, stop, n, after=()):
    """Stop at the n-th chunk, when only the metrics named in ``after`` are written of it."""
    write, chunks = susp_ss.sweep.computing.write, []

    def failing(place, region, metrics):
        chunks.append(region)
        if len(chunks) < n:
            write(place, region, metrics)
        else:
            if after:
                write(place, region, metrics[list(after)])
            stop()

    patch.setattr(susp_ss.sweep.computing, "write", failing)


def raising(error):
    def stop():
        raise error

    return stop


def process(program, *arguments):
    """Run the command in a process of its own, after a program and with chunks as small as here."""
    preamble = (
        "import os, resource, signal, sys, susp_ss.sweep.computing, susp_ss.sweep.plan\n"
        # A shell that runs the tests in the background has its children ignore interrupts.
        "signal.signal(signal.SIGINT, signal.default_int_handler)\n"
        "from susp_ss.cli import main\n"
        "susp_ss.sweep.plan.MOST_DESIGNS['covariance'] = 12\n"
    )
    command = [sys.executable, "-c", preamble + program + "main(sys.argv[1:])", "sweep", *map(str, arguments)]
    return subprocess.run(command, capture_output=True, text=True)


def stopped_by(stop, n, after=()):
    """The program that sends a signal to its own process as `stopping` stops."""
    return (
        "write, chunks = susp_ss.sweep.computing.write, []\n"
        "def failing(place, region, metrics):\n"
        "    chunks.append(region)\n"
        f"    if len(chunks) != {n}:\n"
        "        return write(place, region, metrics)\n"
        f"    if {after}:\n"
        f"        write(place, region, metrics[list({after})])\n"
        f"    os.kill(os.getpid(), {int(stop)})\n"
        "    write(place, region, metrics)\n"
        "susp_ss.sweep.computing.write = failing\n"
    )
