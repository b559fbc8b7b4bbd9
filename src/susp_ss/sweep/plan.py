"""What a sweep is asked for: its designs in chunks, and what is kept of their metrics."""

from __future__ import annotations

import dataclasses
import hashlib
import itertools
import math
from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike

from .. import __version__
from ..metrics.blocks import block_metrics, taken_apart
from ..metrics.in_memory import template
from ..metrics.outputs import check_output, kept
from ..quantities import ROAD, briefly
from ..responses.excitation import check_kinds
from ..roads.road import Road
from ..roads.road_fit import unfitted
from ..vehicles.contract import RoadVehicle
from ..vehicles.curves import Curve
from ..vehicles.files import entry, model_name
from ..vehicles.vehicle import Vehicle

# Most designs of a chunk: many seconds of work, and some 100 MB while it lasts.
MOST_DESIGNS = {"covariance": 2**17, "spectral": 2**8}

DTYPES = ("float64", "float32")

Index = tuple[int, ...]
Region = Mapping[str, slice]


class Task(NamedTuple):
    """The designs of one chunk, and what is kept of their metrics."""

    region: Region
    block: xr.Dataset
    frame: RoadVehicle
    road: Road
    how: dict[str, Any]
    outputs: tuple[str, ...]
    dtype: str

    def metrics(self) -> xr.Dataset:
        """Compute what is kept."""
        every = block_metrics(self.block, self.frame, self.road, self.how, tuple(self.region))
        return kept(every, self.outputs).astype(self.dtype, copy=False)


@dataclasses.dataclass(frozen=True, eq=False)
class Plan:
    """A sweep before it is computed.

    ``arrays`` has the axes, ``like`` the kept metrics of one design without their values, ``chunk`` the designs of a
    chunk along each axis, and ``asked`` everything that decides the numbers of a store, as text by name.
    """

    frame: RoadVehicle
    arrays: xr.Dataset
    road: Road
    method: str
    outputs: tuple[str, ...]
    dtype: str
    like: xr.Dataset
    chunk: Mapping[str, int]
    asked: Mapping[str, str]

    @property
    def sizes(self) -> dict[str, int]:
        """Number of values of each axis."""
        return {name: self.arrays.sizes[name] for name in self.chunk}

    @property
    def designs(self) -> int:
        """Number of designs."""
        return math.prod(self.sizes.values())

    def task(self, region: Region) -> Task:
        """The work on the designs of a region."""
        how = {"method": self.method, "weighting": {}, "designs": self.designs}
        return Task(region, self.arrays.isel(region), self.frame, self.road, how, self.outputs, self.dtype)


def plan(
    vehicle: Vehicle,
    road: Road,
    axes: Mapping[str, ArrayLike],
    method: str,
    outputs: Sequence[str] | None,
    dtype: str,
) -> Plan:
    """Plan a sweep of the arguments of `sweep`, or refuse them."""
    check_kinds(vehicle, road)
    for name, given, known in (("method", method, tuple(MOST_DESIGNS)), ("dtype", dtype, DTYPES)):
        if given not in known:
            raise ValueError(f"{name} of a sweep must be one of {', '.join(known)}, got {briefly(given)}")
    like = template(vehicle.layout(), method, {}, vehicle.curved)
    chosen = tuple(map(str, like.data_vars)) if outputs is None else _checked(outputs, like)
    frame, ground, arrays = taken_apart(*_along(vehicle, road, axes))
    chunk = chunks({name: arrays.sizes[name] for name in axes}, MOST_DESIGNS[method])
    asked = _asked(vehicle, road, axes, method, chosen, dtype, chunk)
    return Plan(frame, arrays, ground, method, chosen, dtype, kept(like, chosen), chunk, asked)


def _checked(outputs: Sequence[str], like: xr.Dataset) -> tuple[str, ...]:
    if isinstance(outputs, str) or not outputs:
        raise ValueError(f'outputs must be names such as ("bacc@fr", "sws"), got {briefly(outputs)}')
    for name in outputs:
        check_output(name, like, "outputs")
    if len(set(outputs)) < len(outputs):
        raise ValueError(f"outputs must be different names, got {', '.join(outputs)}")
    return tuple(outputs)


def _along(vehicle: Vehicle, road: Road, axes: Mapping[str, ArrayLike]) -> tuple[Vehicle, Road]:
    """The vehicle and the road with their axes as labelled arrays, each on a dim of its own name."""
    quantities, known = vehicle.quantities() | ROAD, vehicle.settings() | {name: (name, ()) for name in ROAD}
    road.single("a sweep")
    if not axes:
        raise ValueError(f"axes must name at least one parameter, available: {', '.join(quantities)}")
    for name in vehicle.quantities():
        own = [x.leaves() if isinstance(x, Curve) else [x] for x in vehicle.at_wheels(name)]
        if not all(leaf is None or isinstance(leaf, float) for leaves in own for leaf in leaves):
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
    of_road = {name: arrays.pop(name) for name in ROAD if name in arrays}
    ground: Any = of_road
    return vehicle.replaced(**arrays), dataclasses.replace(road, **ground)


def chunks(sizes: Mapping[str, int], most: int) -> dict[str, int]:
    """Whole last axes, even pieces of the next one, and single nodes of the others: at most ``most`` designs."""
    chunk = {}
    for name, size in reversed(list(sizes.items())):
        chunk[name] = math.ceil(size / math.ceil(size / most))
        most = max(most // chunk[name], 1)
    return {name: chunk[name] for name in sizes}


def regions(sizes: Mapping[str, int], chunk: Mapping[str, int]) -> dict[Index, Region]:
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
    vehicle: Vehicle,
    road: Road,
    axes: Mapping[str, ArrayLike],
    method: str,
    outputs: Sequence[str],
    dtype: str,
    chunk: Mapping[str, int],
) -> dict[str, str]:
    """Everything that decides the numbers of a store, as text by name."""
    road = unfitted(road)
    own = {name: getattr(vehicle, name) for name in vehicle.quantities()}
    fixed = [name for name, x in own.items() if isinstance(x, Curve) or (name not in axes and x is not None)]
    grid = {name: np.asarray(values, dtype=float) for name, values in axes.items()}
    return {
        "susp_ss": __version__,
        "model": model_name(vehicle),
        **{f"parameter {name}": _text(entry(vehicle, name)) for name in fixed},
        **{f"road {name}": str(value) for name, value in dataclasses.asdict(road).items() if name not in axes},
        **({} if type(road) is Road else {"road kind": type(road).__name__}),
        "method": method,
        "outputs": ", ".join(outputs),
        "dtype": dtype,
        "axes": ", ".join(axes),
        **{f"axis {name}": _digest(values) for name, values in grid.items()},
        "chunk": _text(chunk),
    }


def _text(parts: Mapping[str, Any]) -> str:
    return ", ".join(f"{name} {part}" for name, part in parts.items())


def _digest(values: np.ndarray) -> str:
    checksum = hashlib.sha256(values.tobytes()).hexdigest()[:8]
    return f"{len(values)} nodes from {values[0]} to {values[-1]} (sha256 {checksum})"
