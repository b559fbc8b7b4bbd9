"""Sweeps of any size: ride metrics over a grid of designs, a chunk at a time, into a Zarr store that can be resumed."""

from __future__ import annotations

import importlib
import math
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from os import PathLike
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..extras import needing
from ..progress import progress as progress_of
from ..roads.road import Road
from ..vehicles.vehicle import Vehicle
from .computing import computing
from .plan import Index, plan, regions
from .store import exists, lay_out, located, mark, marks, running


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
    outputs: Sequence[str] | None = None,
    dtype: Literal["float64", "float32"] = "float64",
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
    store : path or str
        Folder of the store, or a URL that fsspec knows, such as ``s3://bucket/out.zarr``. If it exists, it must be of
        the same sweep. One run at a time writes it.
    method : {"covariance", "spectral"}
        Of `ride_metrics`.
    outputs : sequence of str, optional
        Metrics to keep, such as ``("bacc@fr", "sws")``: ``sws`` at every corner, and ``bacc`` at one point as the
        variable ``bacc_fr``. All when None.
    dtype : {"float64", "float32"}
        Of the stored metrics, which are computed in double precision.
    scheduler : str, optional
        Address of a Dask scheduler, whose workers compute, and write where they reach the store; they need susp_ss. The
        threads of this machine when None.
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
        Dask, Zarr or what reaches the URL is not installed.

    Warns
    -----
    UserWarning
        A worker cannot write the store; what it computes travels through this process.

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
    asked = plan(vehicle, road, axes, method, outputs, dtype)
    address, chunks = located(store), regions(asked.sizes, asked.chunk)
    with computing(scheduler) as compute:
        if not exists(address):
            asked.task({name: slice(1) for name in axes}).metrics()
            lay_out(address, asked)
        done = marks(address, asked.asked)
        tasks = {index: asked.task(region) for index, region in chunks.items() if not done[index]}
        found = len(chunks) - len(tasks)
        if tasks:
            shown = progress_of("sweeping", len(chunks), found, progress)
            with _saying_what_is_unfinished(address, done), running(address) as place, shown as steps:

                def finish(indices: Sequence[Index]) -> None:
                    marked = done.copy()
                    marked[tuple(np.transpose(indices))] = True
                    mark(place, marked)
                    done[...] = marked
                    for _ in indices:
                        steps.advance()

                compute(tasks, place, finish)
    computed = sum(math.prod(task.block.sizes.values()) for task in tasks.values())
    return Swept(asked.designs, len(chunks), found, computed)


def _need_libraries(scheduler: str | None) -> None:
    with needing("distributed", "a sweep"):
        for name in ("dask.array", "zarr") if scheduler is None else ("dask.array", "zarr", "distributed"):
            importlib.import_module(name)


@contextmanager
def _saying_what_is_unfinished(store: str, done: NDArray[np.bool_]) -> Iterator[None]:
    def unfinished() -> str:
        return f"{int((~done).sum())} of {done.size} chunks are unfinished; run the same sweep again to resume"

    try:
        yield
    except OSError as error:
        raise OSError(f"store {store}: {error.strerror or error}; {unfinished()}") from error
    except KeyboardInterrupt:
        raise KeyboardInterrupt(f"store {store}: {unfinished()}") from None
