"""Force laws from tables, in memory or in CSV files; what they may not be is said by its place."""

from __future__ import annotations

import csv
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..quantities import UNITS, Quantity, briefly
from .laws import Broken

Array = NDArray[np.float64]


def tabulated(name: str, across: Quantity, x: ArrayLike, force: ArrayLike) -> Broken:
    """The law of a table of a curve of that name, or say at which of its entries it is none."""
    at, forces = _column(x, f"{name}({across.name}=...)", across.unit), _column(force, f"{name}(force=...)", "N")
    if len(at) != len(forces):
        raise ValueError(f"{name} needs one force for each {across.name}, got {len(forces)}, {len(at)}")
    fault = _fault(at, forces, across)
    if fault is not None:
        entry, said = fault
        raise ValueError(f"{name}({said}" + (f" at entry {entry}" if entry is not None else ""))
    slopes = np.diff(forces) / np.diff(at)
    return Broken(tuple(at[1:-1].tolist()), tuple(slopes.tolist()))


def _column(values: ArrayLike, where: str, unit: str) -> Array:
    try:
        column = np.asarray(values)
    except ValueError:
        raise TypeError(f"{where} must be one row of numbers in {unit}, got rows of different lengths") from None
    if column.dtype.kind not in "iuf" and column.size:
        raise TypeError(f"{where} must be numbers in {unit}, got {briefly(values)}")
    if column.ndim != 1 or len(column) < 2:
        raise ValueError(f"{where} must be one row of at least two numbers in {unit}, got shape {column.shape}")
    if not np.isfinite(column).all():
        entry = int(np.argmin(np.isfinite(column)))
        raise ValueError(f"{where} must be finite, got {column[entry]} at entry {entry}")
    return column.astype(float)


def _fault(at: Array, forces: Array, across: Quantity) -> tuple[int | None, str] | None:
    """What is wrong with a table, and at which entry; None if nothing."""
    for entry in range(1, len(at)):
        if at[entry] <= at[entry - 1]:
            return (
                entry,
                f"{across.name}=...) must rise strictly, got {at[entry]:g} after {at[entry - 1]:g} {across.unit}",
            )
        if forces[entry] < forces[entry - 1]:
            return entry, f"force=...) must not fall, got {forces[entry]:g} after {forces[entry - 1]:g} N"
    if not at[0] < 0.0 < at[-1]:
        return None, f"{across.name}=...) must reach from below 0 to above 0 {across.unit}, got {at[0]:g} to {at[-1]:g}"
    if forces[0] == forces[-1]:
        return None, f"force=...) must rise somewhere, got {forces[0]:g} N everywhere"
    return None


def read_table(across: Quantity, path: Path) -> tuple[Array, Array]:
    """Where a CSV table has forces, and these, in SI units; or say in which line it has none."""
    names = (across.name, "force")
    try:
        rows = [(i, row) for i, row in enumerate(csv.reader(path.read_text("utf-8-sig").splitlines()), 1) if any(row)]
    except UnicodeDecodeError:
        raise ValueError(f"{path}: not UTF-8 text") from None
    header = [cell.strip() for cell in rows[0][1]] if rows else []
    if sorted(header) != sorted(names):
        raise ValueError(f"{path}: line 1 must name the columns {', '.join(names)}, got {', '.join(header) or 'none'}")
    rows, factors = rows[1:], dict.fromkeys(names, 1.0)
    if rows and not any(map(_is_number, rows[0][1])):
        factors = _factors(path, rows[0][0], dict(zip(header, rows[0][1], strict=False)), across.unit)
        rows = rows[1:]
    columns: dict[str, list[float]] = {name: [] for name in names}
    for line, row in rows:
        if len(row) != 2 or not all(map(_is_number, row)):
            raise ValueError(f"{path}: line {line} must have two numbers, got {','.join(row)}")
        for name, cell in zip(header, row, strict=True):
            columns[name].append(float(cell) * factors[name])
    at, forces = (np.array(columns[name]) for name in names)
    fault = _fault(at, forces, across) if len(at) > 1 else (None, "...) needs at least two rows")
    if fault is not None:
        entry, said = fault
        place = "" if entry is None else f"line {rows[entry][0]}: "
        raise ValueError(f"{path}: {place}{said.replace('=...)', '').replace('...) ', '')}")
    return at, forces


def _factors(path: Path, line: int, stated: dict[str, str], unit: str) -> dict[str, float]:
    units = {"force": UNITS["N"], ("velocity" if unit == "m/s" else "deflection"): UNITS[unit]}
    for name, known in units.items():
        if stated.get(name, "").strip() not in known:
            raise ValueError(
                f"{path}: line {line}: the unit of {name} must be one of {', '.join(known)}, got "
                f"{stated.get(name, '').strip() or 'none'}"
            )
    return {name: known[stated[name].strip()] for name, known in units.items()}


def _is_number(cell: str) -> bool:
    try:
        return bool(np.isfinite(float(cell)))
    except ValueError:
        return False
