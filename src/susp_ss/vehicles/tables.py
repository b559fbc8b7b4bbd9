"""Force laws from tables, in memory or in CSV files; what they may not be is said by its place."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..quantities import Quantity, briefly, units_of
from ..units import factor_of
from ..written import decimal_sign, like_number, number, text_table
from .laws import Broken

Array = NDArray[np.float64]

FORCE = Quantity("force", "N", "force")


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
    quantities = {across.name: across, "force": FORCE}
    records, separator, _ = text_table(path)
    line, header = records[0] if records else (1, [])
    if sorted(header) != sorted(quantities):
        need, got = ", ".join(quantities), ", ".join(header) or "none"
        raise ValueError(f"{path}: line {line} must name the columns {need}, got {got}")
    rows, factors = records[1:], dict.fromkeys(quantities, 1.0)
    if rows and not any(map(like_number, rows[0][1])):
        factors = _factors(path, rows[0][0], dict(zip(header, rows[0][1], strict=False)), quantities)
        rows = rows[1:]
    sign = decimal_sign(((f"{path}: line {line}", cell) for line, row in rows for cell in row), separator)
    values = np.empty((len(rows), 2))
    for i, (line, row) in enumerate(rows):
        numbers = [number(cell, sign) for cell in row]
        if len(row) != 2 or any(value is None or not np.isfinite(value) for value in numbers):
            raise ValueError(f"{path}: line {line} must have two numbers, got {separator.join(row)}")
        values[i] = numbers
    at, forces = (factors[name] * values[:, header.index(name)] for name in quantities)
    fault = _fault(at, forces, across) if len(at) > 1 else (None, "...) needs at least two rows")
    if fault is not None:
        entry, said = fault
        place = "" if entry is None else f"line {rows[entry][0]}: "
        raise ValueError(f"{path}: {place}{said.replace('=...)', '').replace('...) ', '')}")
    return at, forces


def _factors(path: Path, line: int, stated: dict[str, str], quantities: dict[str, Quantity]) -> dict[str, float]:
    factors = {}
    for name, quantity in quantities.items():
        unit = stated.get(name, "")
        factor = factor_of(unit, quantity)
        if factor is None:
            known = ", ".join(units_of(quantity.unit))
            raise ValueError(f"{path}: line {line}: the unit of {name} must be one of {known}, got {unit or 'none'}")
        factors[name] = factor
    return factors
