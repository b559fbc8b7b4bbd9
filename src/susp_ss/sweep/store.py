"""Sweeps of any size: ride metrics over a grid of designs, a chunk at a time, into a Zarr store that can be resumed.

The store is laid out first, full of NaN, and appears under its name complete. Then chunks of designs are computed, on
the threads of this machine or the workers of a Dask cluster, and each is written to Zarr chunks of its own, by this
process alone. Last, the chunk is marked as finished: whatever dies before that leaves a chunk that the next run
computes again, so that nothing is lost or doubled. The marks, and what was asked, are in the store's group ``sweep``.
"""

from __future__ import annotations

import dataclasses
import hashlib
import importlib
import itertools
import math
import os
import tempfile
import warnings
from collections.abc import Callable, Iterator, Mapping
from concurrent.futures import CancelledError, ThreadPoolExecutor, as_completed, wait
from contextlib import AbstractContextManager, contextmanager, nullcontext
from os import PathLike
from pathlib import Path
from typing import Any, Literal, NamedTuple

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike

from .. import __version__
from ..extras import needing
from ..metrics.blocks import block_metrics, taken_apart
from ..progress import progress as progress_of
from ..quantities import briefly
from ..responses.excitation import check_kinds
from ..roads.road import Road
from ..vehicles.files import entry, model_name
from ..vehicles.vehicle import Vehicle

STORE_VERSION, GROUP = 1, "sweep"

# Most designs of a chunk: many seconds of work, and some 100 MB while it lasts.
MOST_DESIGNS = {"covariance": 2**17, "spectral": 2**8}

# Seconds that a scheduler has to answer, and to have a first worker.
ANSWER, WORKER = 30.0, 30.0

# Seconds that chunks under way have to be finished after an interrupt.
PATIENCE = 1.0

Index = tuple[int, ...]
Task = tuple[Any, ...]
"""Arguments of `block_metrics`."""

Finish = Callable[[Index, xr.Dataset], None]
Compute = Callable[[Mapping[Index, Task], Finish], None]


class Swept(NamedTuple):
    """What a sweep did: all designs and chunks of the store, chunks found finished, and designs computed now."""

    designs: int
    chunks: int
    found: int
    computed: int


def sweep(
    vehicle: Vehicle,
    road: Road,
    axes: Mapping[str, ArrayLike],
    store: str | PathLike[str],
    method: Literal["covariance", "spectral"] = "covariance",
    *,
    scheduler: str | None = None,
    progress: bool = False,
) -> Swept:
    """Compute ride metrics over a grid of designs into a Zarr store, or finish a store that an earlier run began.

    ``xarray.open_zarr(store)`` opens the Dataset that `ride_metrics` would return; designs that are not finished are
    NaN. It stays in memory a chunk at a time, about 100 000 designs for each thread.

    Parameters
    ----------
    vehicle : Vehicle
        One number, or one for each corner, for every parameter that is not an axis.
    road : Road
        What the vehicle runs over.
    axes : mapping of str to array_like
        Values of the parameters that vary, in SI units, each a row of different numbers; the result has a dim for each,
        in this order. ``ks`` is for all corners, ``ks_front``, ``ks_left`` or ``ks_rl`` for some; an axis for corners
        that differ in the vehicle is refused, as it would make them alike.
    store : path
        Folder of the store. If it exists, it must be of the same sweep.
    method : {"covariance", "spectral"}
        Of `ride_metrics`.
    scheduler : str, optional
        Address of a Dask scheduler, whose workers compute; they need susp_ss, but do not touch the store. The threads
        of this machine when None.
    progress : bool
        Show the progress on stderr.

    Returns
    -------
    Swept
        Numbers of ``designs`` and ``chunks``, of chunks ``found`` finished, and of designs ``computed``.

    Raises
    ------
    TypeError, ValueError
        An argument that is refused, a store of another sweep (with what differs), or a design that is refused (with its
        values).
    OSError
        The store cannot be written, or the scheduler does not answer or is lost; says how many chunks are unfinished.
    ModuleNotFoundError
        Dask or Zarr is not installed.

    Examples
    --------
    >>> import pathlib, tempfile
    >>> import numpy as np
    >>> import xarray as xr
    >>> from susp_ss import QuarterCar, Road
    >>> from susp_ss.sweep import sweep
    >>> store = pathlib.Path(tempfile.mkdtemp(), "out.zarr")
    >>> axes = {"ks": np.linspace(12e3, 25e3, 30), "cs": np.linspace(800.0, 2200.0, 20)}
    >>> sweep(QuarterCar(), Road(), axes, store)
    Swept(designs=600, chunks=1, found=0, computed=600)
    >>> xr.open_zarr(store).bacc.sizes
    Frozen({'ks': 30, 'cs': 20})
    >>> sweep(QuarterCar(), Road(), axes, store)
    Swept(designs=600, chunks=1, found=1, computed=0)
    """
    _need_libraries(scheduler)
    check_kinds(vehicle, road)
    if method not in MOST_DESIGNS:
        raise ValueError(f"method of a sweep must be one of {', '.join(MOST_DESIGNS)}, got {briefly(method)}")
    frame, ground, arrays = taken_apart(_along(vehicle, axes), road)
    sizes = {name: arrays.sizes[name] for name in axes}
    chunk = _chunk(sizes, MOST_DESIGNS[method])
    regions = _regions(sizes, chunk)

    how: dict[str, Any] = {"method": method, "weighting": {}, "designs": math.prod(sizes.values())}

    def task(region: Mapping[str, slice]) -> Task:
        return arrays.isel(region), frame, ground, how, tuple(axes)

    path = Path(store)
    with _computing(scheduler) as compute:
        asked = _asked(vehicle, road, axes, method, chunk)
        if not path.exists():
            first = block_metrics(*task({name: slice(1) for name in axes})).isel(dict.fromkeys(axes, 0))
            _lay_out(path, first.drop_vars(axes), arrays.coords, chunk, asked)
        done = _marks(path, asked)
        found = done[...]
        tasks = {index: task(region) for index, region in regions.items() if not found[index]}
        shown = progress_of("sweeping", len(regions), len(regions) - len(tasks), progress)
        with _saying_what_is_unfinished(path, done), shown as steps:

            def finish(index: Index, metrics: xr.Dataset) -> None:
                _write(path, regions[index], metrics)
                done[index] = True
                steps.advance()

            compute(tasks, finish)
    computed = sum(math.prod(block.sizes.values()) for block, *_ in tasks.values())
    return Swept(math.prod(sizes.values()), len(regions), len(regions) - len(tasks), computed)


def _need_libraries(scheduler: str | None) -> None:
    with needing("distributed", "a sweep"):
        for name in ("dask.array", "zarr") if scheduler is None else ("dask.array", "zarr", "distributed"):
            importlib.import_module(name)


def _along(vehicle: Vehicle, axes: Mapping[str, ArrayLike]) -> Vehicle:
    """The vehicle with its axes as labelled arrays, each on a dim of its own name."""
    quantities, known = vehicle.quantities(), vehicle.settings()
    if not axes:
        raise ValueError(f"axes must name at least one parameter, available: {', '.join(quantities)}")
    for name in quantities:
        if not all(isinstance(leaf, float) for leaf in vehicle.at_wheels(name)):
            raise ValueError(
                f"{type(vehicle).__name__}({name}=...) of a sweep must be a number, or an axis; got an array"
            )
    arrays: dict[str, xr.DataArray] = {}
    for name, given in axes.items():
        if name not in known:
            raise ValueError(
                f"axes: {type(vehicle).__name__} has no parameter named {name!r}, available: {', '.join(quantities)}"
            )
        field, wheels = known[name]
        for other in arrays:
            both = [wheel for wheel in known[other][1] if wheel in wheels]
            if known[other][0] == field and both:
                raise ValueError(f"axes {other} and {name} both set {field} at {', '.join(both)}; pass one of them")
        values = np.asarray(given)
        if values.ndim != 1 or values.dtype.kind not in "iuf" or len(np.unique(values)) < values.size:
            raise ValueError(f"axes[{name!r}] must be a row of different numbers, got {briefly(given)}")
        at = "" if name == field else f" at {', '.join(wheels)}"
        labels = {"units": quantities[field].unit, "long_name": f"{quantities[field].meaning}{at}"}
        arrays[name] = xr.DataArray(values, {name: (name, values.astype(float), labels)})
    return vehicle.replaced(**arrays)


def _chunk(sizes: Mapping[str, int], most: int) -> dict[str, int]:
    """Whole last axes, even pieces of the next one, and single nodes of the others: at most ``most`` designs."""
    chunk = {}
    for name, size in reversed(list(sizes.items())):
        chunk[name] = math.ceil(size / math.ceil(size / most))
        most = max(most // chunk[name], 1)
    return {name: chunk[name] for name in sizes}


def _regions(sizes: Mapping[str, int], chunk: Mapping[str, int]) -> dict[Index, dict[str, slice]]:
    """Slices of every chunk by its index."""
    pieces = [
        [slice(start, min(start + chunk[name], size)) for start in range(0, size, chunk[name])]
        for name, size in sizes.items()
    ]
    indices = itertools.product(*(range(len(slices)) for slices in pieces))
    return {
        index: dict(zip(sizes, region, strict=True))
        for index, region in zip(indices, itertools.product(*pieces), strict=True)
    }


def _asked(
    vehicle: Vehicle, road: Road, axes: Mapping[str, ArrayLike], method: str, chunk: Mapping[str, int]
) -> dict[str, str]:
    """Everything that decides the numbers of a store, as text by name."""
    fixed = [name for name in vehicle.quantities() if name not in axes]
    grid = {name: np.asarray(values, dtype=float) for name, values in axes.items()}
    return {
        "susp_ss": __version__,
        "model": model_name(vehicle),
        **{f"parameter {name}": _text(entry(vehicle, name)) for name in fixed},
        **{f"road {name}": str(value) for name, value in dataclasses.asdict(road).items()},
        **({} if type(road) is Road else {"road kind": type(road).__name__}),
        "method": method,
        "axes": ", ".join(axes),
        **{f"axis {name}": _digest(values) for name, values in grid.items()},
        "chunk": _text(chunk),
    }


def _text(parts: Mapping[str, Any]) -> str:
    return ", ".join(f"{name} {part}" for name, part in parts.items())


def _digest(values: np.ndarray) -> str:
    checksum = hashlib.sha256(values.tobytes()).hexdigest()[:8]
    return f"{len(values)} nodes from {values[0]} to {values[-1]} (sha256 {checksum})"


def _lay_out(
    path: Path, first: xr.Dataset, coords: Mapping[Any, Any], chunk: Mapping[str, int], asked: Mapping[str, str]
) -> None:
    """Make the store, full of NaN, and give it its name when it is complete."""
    import dask.array
    import zarr

    sizes = {name: coords[name].size for name in chunk}
    # Zarr specifies variable-length text; numpy's own of fixed length it does not.
    empty = xr.Dataset(coords={**coords, **{name: place.astype(object) for name, place in first.coords.items()}})
    for name, data in first.items():
        blocks = dask.array.empty((*sizes.values(), *data.shape), chunks=(*chunk.values(), *data.shape))
        empty[name] = ((*sizes, *data.dims), blocks, data.attrs)
    counts = [math.ceil(sizes[name] / chunk[name]) for name in chunk]
    path.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(prefix=f".{path.name}-", dir=path.parent) as scratch:
        laid = Path(scratch, path.name)
        empty.to_zarr(laid, compute=False, zarr_format=3, consolidated=False)
        group = zarr.open_group(laid, mode="r+").create_group(GROUP)
        group.attrs.update({"store version": STORE_VERSION, **asked})
        group.create_array("done", shape=counts, chunks=(1,) * len(counts), dtype=bool, dimension_names=list(chunk))
        with warnings.catch_warnings():
            # Zarr 3 has yet to specify consolidated metadata, which open_zarr wants.
            warnings.simplefilter("ignore", zarr.errors.ZarrUserWarning)
            zarr.consolidate_metadata(laid)
        os.rename(laid, path)


def _marks(path: Path, asked: Mapping[str, str]) -> Any:
    """Open the marks of a store, if it is of the sweep that is asked for."""
    import zarr

    try:
        group = zarr.open_group(path, path=GROUP, mode="r+", use_consolidated=False)
        held = dict(group.attrs)
        version = held.pop("store version")
    except (FileNotFoundError, FileExistsError, KeyError):
        raise ValueError(f"store {path} exists and is not a store of a sweep; pass another name") from None
    if version != STORE_VERSION:
        raise ValueError(
            f"store {path} has version {version}, and this susp_ss {__version__} reads version {STORE_VERSION}; "
            f"use the susp_ss {held.get('susp_ss')} that made it, or pass another name"
        )
    differing = [
        f"{name} is {held.get(name, 'absent')} there and {asked.get(name, 'absent')} here"
        for name in dict.fromkeys([*held, *asked])
        if held.get(name) != asked.get(name)
    ]
    if differing:
        raise ValueError(f"store {path} is of another sweep: {'; '.join(differing)}; pass another name")
    return group["done"]


def _write(path: Path, region: Mapping[str, slice], metrics: xr.Dataset) -> None:
    """Write the metrics of a chunk, whose Zarr chunks nothing else writes."""
    metrics.drop_vars(metrics.coords).to_zarr(path, region=region, zarr_format=3, consolidated=False)


@contextmanager
def _saying_what_is_unfinished(path: Path, done: Any) -> Iterator[None]:
    def unfinished() -> str:
        marks = done[...]
        return f"{int((~marks).sum())} of {marks.size} chunks are unfinished; run the same sweep again to resume"

    try:
        yield
    except OSError as error:
        raise OSError(f"store {path}: {error.strerror or error}; {unfinished()}") from error
    except KeyboardInterrupt:
        raise KeyboardInterrupt(f"store {path}: {unfinished()}") from None


def _computing(scheduler: str | None) -> AbstractContextManager[Compute]:
    return nullcontext(_on_threads) if scheduler is None else _on_cluster(scheduler)


def _on_threads(tasks: Mapping[Index, Task], finish: Finish) -> None:
    """Compute and finish chunks on threads; a failure waits for those under way, an interrupt not for long."""

    def run(index: Index) -> None:
        finish(index, block_metrics(*tasks[index]))

    pool = ThreadPoolExecutor(os.cpu_count())
    futures = [pool.submit(run, index) for index in tasks]
    try:
        for future in as_completed(futures):
            future.result()
    except KeyboardInterrupt:
        pool.shutdown(wait=False, cancel_futures=True)
        wait(futures, timeout=PATIENCE)
        raise
    except BaseException:
        pool.shutdown(cancel_futures=True)
        raise
    pool.shutdown()


@contextmanager
def _on_cluster(scheduler: str) -> Iterator[Compute]:
    """Compute chunks on the workers of a cluster, and finish them here."""
    from distributed import Client, KilledWorker
    from distributed import as_completed as as_answered

    try:
        client = Client(scheduler, timeout=ANSWER)
    except (OSError, ValueError) as error:
        raise ConnectionError(
            f"no Dask scheduler answers at {scheduler!r} within {ANSWER:g} s; start one with: dask scheduler"
        ) from error

    def compute(tasks: Mapping[Index, Task], finish: Finish) -> None:
        futures = {client.submit(block_metrics, *task, pure=False): index for index, task in tasks.items()}
        try:
            for future in as_answered(futures):
                finish(futures[future], future.result())
                future.release()
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
