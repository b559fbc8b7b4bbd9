"""Runs of an FMU, so many at a time, each in a process of its own."""

from __future__ import annotations

import json
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator, Mapping
from concurrent.futures import ThreadPoolExecutor, as_completed
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..progress import progress

Array = NDArray[np.float64]

SCRIPT = Path(__file__).with_name("one_run.py")

# How many letters of what a model says are passed on.
HEARD = 300


class Drive(NamedTuple):
    """What is the same for all runs: instants (T,), the FMU's inputs there (k, T) and their names, and its outputs."""

    t: Array
    u: Array
    road: tuple[str, ...]
    outputs: tuple[str, ...]


def outcomes(
    path: Path,
    drive: Drive,
    runs: Mapping[int, Mapping[str, float]],
    reduced: Callable[[Array, Array], dict[str, float]],
    processes: int,
    shown: bool,
) -> Iterator[tuple[int, dict[str, float] | str]]:
    """What every run comes to, as they end: its metrics, or why there are none.

    Parameters
    ----------
    path : Path
        The FMU.
    drive : Drive
    runs : mapping of int to mapping of str to float
        The parameters of each run, by its number.
    reduced : callable
        Metrics of instants and outputs; a ValueError says why there are none.
    processes : int
        Runs at a time.
    shown : bool
        Whether to show progress on stderr.
    """
    from fmpy import extract

    with tempfile.TemporaryDirectory(prefix="susp_ss-") as work, progress("running", len(runs), 0, shown) as bar:
        folder = Path(work)
        extract(path, folder / "fmu")
        np.save(folder / "inputs.npy", drive.u)
        with ThreadPoolExecutor(processes) as pool:
            jobs = {pool.submit(_outcome, folder, drive, i, run, reduced): i for i, run in runs.items()}
            try:
                for job in as_completed(jobs):
                    bar.advance()
                    yield jobs[job], job.result()
            finally:
                pool.shutdown(cancel_futures=True)


def _outcome(
    folder: Path, drive: Drive, i: int, run: Mapping[str, float], reduced: Callable[[Array, Array], dict[str, float]]
) -> dict[str, float] | str:
    job, result, refusal = folder / f"job_{i}.json", folder / f"result_{i}.npy", folder / f"refusal_{i}.txt"
    asked = {
        "folder": str(folder / "fmu"),
        "inputs": str(folder / "inputs.npy"),
        "road": drive.road,
        "outputs": drive.outputs,
        "parameters": run,
        "step": float(drive.t[1]),
        "result": str(result),
        "refusal": str(refusal),
    }
    job.write_text(json.dumps(asked), encoding="utf-8")
    # -P: modules are not sought beside the script.
    ran = subprocess.run(
        [sys.executable, "-P", str(SCRIPT), str(job)], stdin=subprocess.DEVNULL, capture_output=True, check=False
    )
    if ran.returncode or not result.exists():
        return _why(ran, refusal)
    t, *y = np.load(result)
    result.unlink()
    if t[-1] < drive.t[-1] * (1.0 - 1e-6):
        return f"it ended at {t[-1]:g} s of {drive.t[-1]:g} s"
    for name, values in zip(drive.outputs, y, strict=True):
        if not np.isfinite(values).all():
            return f"{name!r} is not finite from {t[np.argmin(np.isfinite(values))]:g} s on"
    try:
        return reduced(t, np.array(y))
    except ValueError as error:
        return str(error)


def _why(ran: subprocess.CompletedProcess[bytes], refusal: Path) -> str:
    """Why a run has no result, with the last words of the model."""
    lines = [line for stream in (ran.stderr, ran.stdout) for line in stream.decode(errors="replace").splitlines()]
    last = next((f" ({line.strip()[:HEARD]})" for line in reversed(lines) if line.strip()), "")
    if refusal.exists():
        return f"{' '.join(refusal.read_text(encoding='utf-8').split())[:HEARD]}{last}"
    if ran.returncode < 0:
        return f"the model crashed, signal {-ran.returncode}{last}"
    return f"the model ended its process with code {ran.returncode}{last}"
