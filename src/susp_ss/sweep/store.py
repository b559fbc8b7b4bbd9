"""The Zarr store of a sweep: laid out full of NaN, written a chunk at a time by whoever computed it, and marked.

The root's attributes say what the store holds, and so decide whether it is of the sweep that is asked for. The group
``sweep`` has the array ``done``, a mark for each chunk of designs, which is set after the chunk is written: whatever
dies before that leaves a chunk that the next run computes again, so that nothing is lost or doubled. While a run lasts,
an attribute of the group names it: a worker writes only where it finds that name, for a folder of the same name on
another machine is another store.

A chunk of designs is one Zarr shard of each metric, hence one file, within which every place is a Zarr chunk: one
corner is read without the others.
"""

from __future__ import annotations

import math
import os
import tempfile
import uuid
import warnings
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from functools import lru_cache
from os import PathLike
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from .. import __version__
from ..extras import needing
from .plan import Plan, Region

STORE_VERSION, GROUP, RUN, METADATA = 2, "sweep", "run", "zarr.json"

# Measured on a full car's metrics: a tenth of the time of computing them, and half the size; Zarr's own choice takes
# half as long again, higher levels twice as long for little more.
COMPRESSION: dict[str, Any] = {"cname": "zstd", "clevel": 1, "shuffle": "bitshuffle"}


class Place(NamedTuple):
    """Where the store of a run is, and the run's name in it."""

    store: str
    run: str


def located(store: str | PathLike[str]) -> str:
    """The address of a store for any process: an absolute path, or a URL that fsspec knows."""
    text = os.fspath(store)
    if text.startswith("file://") or "://" not in text:
        return str(Path(text.removeprefix("file://")).absolute())
    import fsspec

    if text.startswith("s3://"):
        with needing("s3", f"store {text}"):
            import s3fs  # noqa: F401
    try:
        fsspec.get_filesystem_class(text.partition("://")[0])
    except (ImportError, ValueError) as error:
        raise ValueError(f"store {text}: {error}") from None
    return text


def exists(store: str) -> bool:
    """Whether anything stands at the address of a store but what was left of laying it out."""
    if "://" not in store:
        return Path(store).exists()
    with _reaching(f"store {store}: ", ()):
        files, root = _files(store)
        files.invalidate_cache()
        if files.exists(f"{root}/{METADATA}") or not files.exists(f"{root}/{GROUP}/{METADATA}"):
            return bool(files.exists(root))
    return False


def lay_out(store: str, plan: Plan) -> None:
    """Make the store, full of NaN, which opens when it is complete."""
    remote = "://" in store
    if not remote:
        Path(store).parent.mkdir(parents=True, exist_ok=True)
    folder = None if remote else Path(store).parent
    with tempfile.TemporaryDirectory(prefix=f".{Path(store).name}-", dir=folder) as scratch:
        laid = Path(scratch, "store")
        _fill(laid, plan)
        if remote:
            _upload(laid, store)
        else:
            os.rename(laid, store)


def _fill(laid: Path, plan: Plan) -> None:
    import zarr
    from zarr.codecs import BloscCodec

    # Zarr specifies variable-length text; numpy's own of fixed length it does not.
    coords = {**plan.arrays.coords, **{name: place.astype(object) for name, place in plan.like.coords.items()}}
    xr.Dataset(coords=coords).to_zarr(laid, zarr_format=3, consolidated=False)
    root = zarr.open_group(laid, mode="r+", use_consolidated=False)
    root.attrs.update(plan.asked)
    designs = tuple(plan.chunk.values())
    for name, data in plan.like.items():
        root.create_array(
            str(name),
            shape=(*plan.sizes.values(), *data.shape),
            chunks=(*designs, *(1 for _ in data.shape)),
            shards=(*designs, *data.shape) if data.shape else None,
            dtype=plan.dtype,
            fill_value=np.nan,
            compressors=BloscCodec(**COMPRESSION),
            dimension_names=[*plan.chunk, *map(str, data.dims)],
            attributes=data.attrs,
        )
    group = root.create_group(GROUP, attributes={"store version": STORE_VERSION, "susp_ss": __version__})
    counts = tuple(math.ceil(plan.sizes[name] / plan.chunk[name]) for name in plan.chunk)
    # One file, which is replaced as a whole.
    group.create_array("done", shape=counts, chunks=counts, dtype=bool, dimension_names=list(plan.chunk))
    with warnings.catch_warnings():
        # Zarr 3 has yet to specify consolidated metadata, which open_zarr wants.
        warnings.simplefilter("ignore", zarr.errors.ZarrUserWarning)
        zarr.consolidate_metadata(laid)


def _upload(laid: Path, store: str) -> None:
    """Copy a store to its URL, beginning with what tells it from other people's files, its root's metadata last."""
    order = {f"{GROUP}/{METADATA}": 0, METADATA: 2}
    names = [path.relative_to(laid).as_posix() for path in laid.rglob("*") if path.is_file()]
    with _reaching(f"store {store}: ", ()):
        files, root = _files(store)
        for name in sorted(names, key=lambda name: order.get(name, 1)):
            files.pipe_file(f"{root}/{name}", (laid / name).read_bytes())


def _files(store: str) -> tuple[Any, str]:
    import fsspec

    return fsspec.core.url_to_fs(store)


def _group(store: str, path: str = "", mode: Any = "r") -> Any:
    import zarr

    return zarr.open_group(store, path=path, mode=mode, zarr_format=3, use_consolidated=False)


def marks(store: str, asked: Mapping[str, str]) -> NDArray[np.bool_]:
    """Read the marks of a store, if it is of the sweep that is asked for."""
    strangers = (FileNotFoundError, FileExistsError, NotADirectoryError, KeyError)
    try:
        with _reaching(f"store {store}: ", strangers):
            group, held = _group(store, GROUP), dict(_group(store).attrs)
            version, done = group.attrs["store version"], np.asarray(group["done"][...])
    except strangers:
        raise ValueError(f"store {store} exists and is not a store of a sweep; pass another name") from None
    if version != STORE_VERSION:
        raise ValueError(
            f"store {store} has version {version}, and this susp_ss {__version__} reads version {STORE_VERSION}; "
            f"use the susp_ss {group.attrs.get('susp_ss')} that made it, or pass another name"
        )
    differing = [
        f"{name} is {held.get(name, 'absent')} there and {asked.get(name, 'absent')} here"
        for name in dict.fromkeys([*held, *asked])
        if held.get(name) != asked.get(name)
    ]
    if differing:
        raise ValueError(f"store {store} is of another sweep: {'; '.join(differing)}; pass another name")
    return done


@contextmanager
def running(store: str) -> Iterator[Place]:
    """Name a run in its store while it lasts."""
    place = Place(store, uuid.uuid4().hex)
    with _reaching():
        group = _group(store, GROUP, "r+")
        group.attrs[RUN] = place.run
    try:
        yield place
    finally:
        with suppress(OSError), _reaching():
            _check(place)
            del group.attrs[RUN]


def write(place: Place, region: Region, metrics: xr.Dataset) -> None:
    """Write the metrics of a chunk, whose shards nothing else writes, into the store that is there before and after."""
    with _reaching():
        _check(place)
        for name, data in metrics.items():
            _array(place, str(name))[tuple(region.values())] = data.values
        _check(place)


def mark(place: Place, done: NDArray[np.bool_]) -> None:
    """Write the marks."""
    with _reaching():
        _check(place)
        _array(place, f"{GROUP}/done")[...] = done


def _check(place: Place) -> None:
    if _group(place.store, GROUP).attrs.get(RUN) != place.run:
        raise FileNotFoundError(f"what is reached at {place.store} is another store, or another run began to write it")


@lru_cache(maxsize=64)
def _array(place: Place, name: str) -> Any:
    import zarr

    return zarr.open_array(place.store, path=name, mode="r+", zarr_format=3)


@contextmanager
def _reaching(named: str = "", known: tuple[type[Exception], ...] = (OSError,)) -> Iterator[None]:
    """Say as an OSError, after a name, whatever else than what is known the libraries of a store say of it."""
    try:
        yield
    except known:
        raise
    except Exception as error:
        said = error.strerror or error if isinstance(error, OSError) else f"{type(error).__name__}: {error}"
        raise OSError(f"{named}{said}") from error
