"""Parameters of a vehicle: checked numbers, arrays or DataArrays, one value or one a corner, and what these span."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from ..quantities import DIMS, EVENTS, METRICS, Quantity, briefly

# A dim or coordinate of a sweep may not have the name of one of a result's.
RESERVED = {*DIMS, *METRICS, *EVENTS}


def parameter(default: Any, unit: str, meaning: str, zero: bool = False, signed: bool = False) -> Any:
    """Declare a field that the table of quantities does not know, or knows by another meaning.

    It is > 0; with ``zero`` it may be 0, and with ``signed`` any finite number.
    """
    quantity = Quantity("", unit, meaning, bound="" if signed else ">= 0" if zero else "> 0")
    return dataclasses.field(default=default, metadata={"quantity": quantity})


@dataclass(frozen=True, kw_only=True, eq=False)
class Corners:
    """One parameter at each corner of a car.

    Parameters
    ----------
    fr, fl, rr, rl : float, array or xarray.DataArray
        Front right, front left, rear right, rear left, in the parameter's own unit.

    Examples
    --------
    >>> from susp_ss import Corners, FullCar
    >>> car = FullCar(ks=Corners.axles(front=18e3, rear=21e3))
    >>> car.ks.rl
    21000.0
    """

    fr: Any
    fl: Any
    rr: Any
    rl: Any

    @classmethod
    def axles(cls, *, front: Any, rear: Any) -> Corners:
        """Give both wheels of an axle the same value."""
        return cls(fr=front, fl=front, rr=rear, rl=rear)

    def __iter__(self):
        return iter((self.fr, self.fl, self.rr, self.rl))


def checked(value: Any, where: str, quantity: Quantity) -> Any:
    """Return ``value`` as float, float array or float DataArray, or say what is wrong with it.

    The numbers of a lazy DataArray are not known yet: they are checked when its blocks are computed.

    Raises
    ------
    TypeError
        Not a real number, array or DataArray.
    ValueError
        Empty, not finite, or below the bound.
    """
    bound = quantity.bound or ("finite, in" if quantity.unit else "finite")
    need = f"must be {bound} {quantity.unit}".rstrip()
    if lazy(value):
        return _checked_lazy(value, where, need)
    if hasattr(value, "__dask_graph__") and not isinstance(value, xr.DataArray):
        raise TypeError(f"{where} {need}, got a bare Dask array; wrap it in an xarray.DataArray, which names its dims")
    try:
        values = value.values if isinstance(value, xr.DataArray) else np.asarray(value)
    except ValueError:
        raise TypeError(f"{where} {need}, got rows of different lengths") from None
    if values.dtype.kind not in "iuf" or np.ma.is_masked(value):
        raise TypeError(f"{where} {need}, got {briefly(value)}; pass a number, an array or an xarray.DataArray")
    if values.size == 0:
        raise ValueError(f"{where} {need}, got an empty array")
    values = values.astype(float)
    values.flags.writeable = False
    within = {"> 0": values > 0.0, ">= 0": values >= 0.0, "": True}[quantity.bound]
    bad = ~(np.isfinite(values) & within)
    if bad.any():
        index = np.unravel_index(np.argmax(bad), bad.shape)
        dims = value.dims if isinstance(value, xr.DataArray) else design_dims(values.ndim)
        place = ", ".join(f"{dim}={i}" for dim, i in zip(dims, index, strict=True))
        raise ValueError(f"{where} {need}, got {values[index]}" + (f" at ({place})" if place else ""))
    if values.ndim == 0:
        return float(values)
    if not isinstance(value, xr.DataArray):
        return values
    _refuse_reserved(value, where)
    return value.copy(data=values)


def number_array(given: Any, need: str) -> NDArray[Any]:
    """Return whatever is passed for numbers as an array of them.

    Raises
    ------
    TypeError
        Saying the ``need``: no numbers, or rows of different lengths.

    Examples
    --------
    >>> from susp_ss.vehicles.parameters import number_array
    >>> number_array([1, 2.5], "time must be numbers in s")
    array([1. , 2.5])
    >>> number_array([[1], [1, 2]], "time must be numbers in s")
    Traceback (most recent call last):
    TypeError: time must be numbers in s, got [[1], [1, 2]]
    """
    try:
        values = np.asarray(given)
    except (TypeError, ValueError):
        values = np.empty(0, dtype=object)
    if values.dtype.kind not in "iuf":
        raise TypeError(f"{need}, got {briefly(given)}")
    return values


def lazy(value: Any) -> bool:
    """Whether a value is a DataArray of blocks that are computed later, as Dask's are."""
    return isinstance(value, xr.DataArray) and value.chunks is not None


def computed(value: Any) -> Any:
    """A parameter with its values known."""
    return value.compute() if lazy(value) else value


def _checked_lazy(value: xr.DataArray, where: str, need: str) -> xr.DataArray:
    if value.dtype.kind not in "iuf":
        raise TypeError(f"{where} {need}, got a lazy DataArray of {value.dtype}; pass numbers")
    if value.ndim == 0:
        raise TypeError(f"{where} {need}, got one lazy number; pass its value, as .compute() returns it")
    if value.size == 0:
        raise ValueError(f"{where} {need}, got an empty array")
    _refuse_reserved(value, where)
    return value.astype(float)


def _refuse_reserved(value: xr.DataArray, where: str) -> None:
    for dim in value.dims:
        if dim in RESERVED or not isinstance(dim, str):
            raise ValueError(f"{where} has a dim named {dim!r}, which results use themselves or cannot use; rename it")


def design_dims(ndim: int) -> tuple[str, ...]:
    """Dimension names of plain arrays: ``design``, or ``design_0, design_1, ...`` of a grid."""
    return ("design",) if ndim == 1 else tuple(f"design_{i}" for i in range(ndim))


@dataclass(frozen=True, eq=False)
class DesignSpace:
    """The designs that a vehicle's array parameters span, in row-major order."""

    dims: tuple[str, ...]
    shape: tuple[int, ...]
    coords: dict[str, Any]
    _plain: tuple[int, ...]
    _template: xr.DataArray | None

    @classmethod
    def over(cls, values: Iterable[Any], where: str) -> DesignSpace:
        """Broadcast DataArrays by dimension name and plain arrays as numpy does."""
        values = list(values)
        labelled = [x for x in values if isinstance(x, xr.DataArray)]
        plain = [x for x in values if isinstance(x, np.ndarray)]
        try:
            shape = np.broadcast_shapes(*(x.shape for x in plain))
            if not labelled:
                return cls(design_dims(len(shape)) if shape else (), shape, {}, shape, None)
            if shape:
                labelled.append(xr.DataArray(np.empty(shape), dims=design_dims(len(shape))))
            aligned = xr.broadcast(*xr.align(*labelled, join="exact", copy=False))
        except ValueError as error:
            sizes = [dict(x.sizes) if isinstance(x, xr.DataArray) else x.shape for x in labelled + plain]
            raise ValueError(f"{where} has parameters that do not broadcast: sizes {sizes}; {error}") from None
        template = aligned[0]
        coords: dict[str, Any] = {}
        clashing = set()
        for array in aligned:
            for name, coord in array.coords.items():
                clashing |= {name} if name in coords and not coords[str(name)].identical(coord) else set()
                coords[str(name)] = coord
        coords = {name: coord for name, coord in coords.items() if name in template.dims or name not in clashing}
        return cls(tuple(map(str, template.dims)), template.shape, coords, shape, template)

    @property
    def size(self) -> int:
        return int(np.prod(self.shape, dtype=int))

    def place(self, design: int) -> str:
        """Where a design lies, as the end of a message; nothing where there is one only."""
        place = zip(self.dims, np.unravel_index(design, self.shape), strict=True)
        return f" at ({', '.join(f'{dim}={i}' for dim, i in place)})" if self.dims else ""

    def some(self, designs: NDArray[np.int_]) -> SomeDesigns:
        """Some of the designs, as far as one has to know how many and where they lie."""
        return SomeDesigns(self, designs)

    def flat(self, value: Any) -> float | NDArray[np.float64]:
        """One number, or one for each design."""
        if isinstance(value, float):
            return value
        if self._template is None:
            return np.broadcast_to(value, self.shape).reshape(-1)
        values = self.labelled(value).broadcast_like(self._template).transpose(*self.dims).values
        return values.reshape(-1)

    def labelled(self, value: Any) -> xr.DataArray:
        """An array parameter with its dims, whether plain or labelled already."""
        if isinstance(value, xr.DataArray):
            return value
        return xr.DataArray(np.broadcast_to(value, self._plain), dims=design_dims(len(self._plain)))

    def unflatten(self, values: NDArray, dims: tuple[str, ...] = (), coords: dict | None = None) -> xr.DataArray:
        """Give results of shape (designs, ...) their labels."""
        shaped = values.reshape((*self.shape, *values.shape[1:]))
        return xr.DataArray(shaped, dims=(*self.dims, *dims), coords={**self.coords, **(coords or {})})


class SomeDesigns(NamedTuple):
    """Some designs of a space."""

    space: DesignSpace
    designs: NDArray[np.int_]

    @property
    def size(self) -> int:
        return len(self.designs)

    def place(self, design: int) -> str:
        """Where one of them lies in the whole space."""
        return self.space.place(int(self.designs[design]))


def blocks(size: int, length: int) -> list[slice]:
    """Parts of so many designs that are no longer than ``length``."""
    return [slice(first, min(first + length, size)) for first in range(0, size, length)]
