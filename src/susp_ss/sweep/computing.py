"""Who computes the chunks of a sweep: the threads of this machine, or the workers of a Dask cluster.

Whoever computes a chunk writes it; marks are kept by the process that asked. What a worker cannot write travels to
that process.
"""

from __future__ import annotations

import ctypes
import os
import sys
import warnings
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import CancelledError, ThreadPoolExecutor, as_completed, wait
from contextlib import AbstractContextManager, contextmanager, nullcontext
from functools import cache
from typing import Any, NamedTuple

import xarray as xr

from .plan import Index, Task
from .store import Place, write

# Seconds that a scheduler has to answer, and to have a first worker.
ANSWER, WORKER = 30.0, 30.0

# Seconds that chunks under way have to be finished after an interrupt.
PATIENCE = 1.0

# Chunks that are received together: some 300 MB where workers cannot write.
MOST_AT_ONCE = 16

Finish = Callable[[Sequence[Index]], None]
Compute = Callable[[Mapping[Index, Task], Place, Finish], None]


class Unwritten(NamedTuple):
    """Metrics that a worker could not write, and why."""

    worker: str
    reason: str
    metrics: xr.Dataset


def computing(scheduler: str | None) -> AbstractContextManager[Compute]:
    """What computes and writes chunks, and says which are written."""
    return nullcontext(_on_threads) if scheduler is None else _on_cluster(scheduler)


def _on_threads(tasks: Mapping[Index, Task], place: Place, finish: Finish) -> None:
    """A failure waits for the chunks under way, an interrupt not for long."""

    def run(task: Task) -> None:
        write(place, task.region, task.metrics())

    pool = ThreadPoolExecutor(os.cpu_count())
    unmarked = {pool.submit(run, task): index for index, task in tasks.items()}
    try:
        for future in as_completed(list(unmarked)):
            future.result()
            finish([unmarked.pop(future)])
    except KeyboardInterrupt:
        pool.shutdown(wait=False, cancel_futures=True)
        wait(unmarked, timeout=PATIENCE)
        raise
    except BaseException:
        pool.shutdown(cancel_futures=True)
        raise
    finally:
        ended = [(future, index) for future, index in unmarked.items() if future.done() and not future.cancelled()]
        written = [index for future, index in ended if future.exception() is None]
        if written:
            finish(written)
    pool.shutdown()


def on_worker(task: Task, place: Place) -> Unwritten | None:
    """Compute a chunk and write it, or return what could not be written."""
    from distributed import get_worker

    _keep_memory()
    metrics = task.metrics()
    try:
        write(place, task.region, metrics)
    except OSError as error:
        return Unwritten(get_worker().address, str(error.strerror or error), metrics)
    return None


@cache
def _keep_memory() -> None:
    """Have glibc keep what it frees, as it does by itself, up to its own largest threshold and twice that.

    Dask sets ``MALLOC_TRIM_THRESHOLD_`` for its workers, so that every block of more than 128 kB is a new mapping: a
    quarter of a million page faults a chunk, and two thirds of the time.
    """
    mmap_threshold, trim_threshold, largest = -3, -1, 2**25
    if sys.platform == "linux" and hasattr(libc := ctypes.CDLL(None), "mallopt"):
        libc.mallopt(mmap_threshold, largest)
        libc.mallopt(trim_threshold, 2 * largest)


@contextmanager
def _on_cluster(scheduler: str) -> Iterator[Compute]:
    from distributed import Client, KilledWorker

    try:
        client = Client(scheduler, timeout=ANSWER)
    except (OSError, ValueError) as error:
        raise ConnectionError(
            f"no Dask scheduler answers at {scheduler!r} within {ANSWER:g} s; start one with: dask scheduler"
        ) from error

    def compute(tasks: Mapping[Index, Task], place: Place, finish: Finish) -> None:
        futures = {client.submit(on_worker, task, place, pure=False): index for index, task in tasks.items()}
        try:
            _receive(client, futures, tasks, place, finish)
        except CancelledError as error:
            raise ConnectionError(f"the Dask scheduler at {scheduler} is lost") from error
        except KilledWorker as error:
            raise ConnectionError(f"the workers of the Dask scheduler at {scheduler} died: {error}") from error

    with client:
        try:
            client.wait_for_workers(1, timeout=WORKER)
        except TimeoutError as error:
            raise ConnectionError(
                f"the Dask scheduler at {scheduler} has no worker; start one with: dask worker {scheduler}"
            ) from error
        yield compute


def _receive(
    client: Any, futures: Mapping[Any, Index], tasks: Mapping[Index, Task], place: Place, finish: Finish
) -> None:
    """Mark chunks as they come, several at once when they come faster than marks are written."""
    from distributed import as_completed as as_answered

    said = False
    for batch in as_answered(futures).batches():
        for first in range(0, len(batch), MOST_AT_ONCE):
            some = batch[first : first + MOST_AT_ONCE]
            indices = [futures[future] for future in some]
            for index, unwritten in zip(indices, client.gather(some), strict=True):
                if unwritten is not None:
                    if not said:
                        warnings.warn(_travels(place, unwritten), stacklevel=2)
                        said = True
                    write(place, tasks[index].region, unwritten.metrics)
            finish(indices)
            for future in some:
                future.release()


def _travels(place: Place, unwritten: Unwritten) -> str:
    return (
        f"store {place.store}: the worker at {unwritten.worker} cannot write there ({unwritten.reason}); "
        "what workers cannot write travels through this process"
    )
