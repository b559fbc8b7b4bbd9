"""What the tests of sweeps share: a small sweep, the files of a store, and ways of stopping."""

import multiprocessing
import multiprocessing.forkserver
import os
from typing import NamedTuple

import dask
import numpy as np
from distributed.utils import get_mp_context

import susp_ss as ss
import susp_ss.sweep.computing
from susp_ss.cli import main
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


class Ended(NamedTuple):
    """How a process ended: its exit code, or the signal below zero; and what it said."""

    returncode: int
    stderr: str


FORKS = multiprocessing.get_context("forkserver")


def load_once():
    """Have processes and workers of Dask start from one that has loaded what they need, and knows of no server yet."""
    method = dask.config.set({"distributed.worker.multiprocessing-method": "forkserver"})
    get_mp_context()  # Dask names what to load the first time that it is asked, and not again.
    FORKS.set_forkserver_preload(["distributed", "s3fs", "susp_ss.cli.sweep", "susp_ss.metrics.in_memory", "zarr"])
    multiprocessing.forkserver.ensure_running()
    return method


def process(program, *arguments):
    """Run the command in a process of its own, after a program and with chunks as small as here."""
    listening, speaking = FORKS.Pipe(duplex=False)
    child = FORKS.Process(target=_command, args=(speaking, program, [*map(str, arguments)], dict(os.environ)))
    child.start()
    speaking.close()
    with open(listening.fileno(), closefd=False, encoding="utf-8") as said:
        text = said.read()
    child.join()
    return Ended(child.exitcode, text)


def _command(speaking, program, arguments, environment):
    os.environ.clear()
    os.environ.update(environment)
    os.dup2(speaking.fileno(), 2)
    speaking.close()
    preamble = (
        "import os, resource, signal, sys, susp_ss.sweep.computing, susp_ss.sweep.plan\n"
        # A shell that runs the tests in the background has its children ignore interrupts.
        "signal.signal(signal.SIGINT, signal.default_int_handler)\n"
        "susp_ss.sweep.plan.MOST_DESIGNS['covariance'] = 12\n"
    )
    exec(preamble + program, {})
    main(["sweep", *arguments])


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
