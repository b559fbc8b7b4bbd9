"""An engineer's own table of expensive runs (Adams, CarSim, a test rig, a script) as designs and responses in SI units.

A table has one row a run and one column a quantity, whatever the columns are called. The caller says which column is
which; the name (``ks``, ``bacc_cg``, ``speed``, ...) says the SI unit and the bound, and the unit that the file or the
caller states says what to multiply by. The flow is: a reader for each kind of file -> `_Table` of cells -> numbers in
SI units -> checks of the runs together. A table is taken whole or refused in one line that names the place in the file.
"""

from __future__ import annotations

import csv
import difflib
import io
import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from decimal import Decimal
from os import PathLike
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pandas as pd
import xarray as xr
from numpy.typing import NDArray

from ..extras import needing
from ..quantities import KNOWN, UNITS, Quantity, briefly, quantity_of, units_of
from ..units import DECIMAL_COMMA, NUMBER, factor_of, plain_unit
from ..vehicles.files import models, utf8_text

NAMES = {name: quantity for model in models().values() for name, quantity in model.quantities().items()} | KNOWN
"""Parameters of vehicles and roads, and metrics, which are root mean squares or mean powers."""

# How a NetCDF file begins that is no HDF5 file; scipy reads it.
CLASSIC = (b"CDF\x01", b"CDF\x02")

UNKNOWN = Quantity("", "", "")


@dataclass(frozen=True, eq=False)
class Runs:
    """Expensive runs: n designs of k inputs, and their m responses.

    Attributes
    ----------
    designs : pandas.DataFrame, (n, k)
        In SI units, one column an input, named as in this package.
    responses : pandas.DataFrame, (n, m)
        In SI units, one column an output.
    rows : ndarray, (n,)
        Where each run stands in the file: its line, the first being 1, or in Parquet and NetCDF files its row.
    path : Path
        The file.
    units : dict
        Unit of each name: SI, or as the file or the caller stated it where the name is not known to the package.
    columns : dict
        Column of each name in the file.
    stated : dict
        Unit of each column, in which the file's numbers are.
    """

    designs: pd.DataFrame
    responses: pd.DataFrame
    rows: NDArray[np.int_]
    path: Path
    units: dict[str, str]
    columns: dict[str, str]
    stated: dict[str, str]

    @property
    def row_word(self) -> str:
        """What ``rows`` counts: lines, or in Parquet and NetCDF files rows."""
        return _row_word(self.path)

    def place(self, run: int, name: str) -> str:
        """Say where the number of a run, 0 to n - 1, stands: ``runs.csv, line 7, column 'K_S'``."""
        return _place(self.path, self.columns[name], self.rows[run])


def read_runs(
    path: str | PathLike[str],
    inputs: Mapping[str, str],
    outputs: Mapping[str, str],
    units: Mapping[str, str] | None = None,
) -> Runs:
    """Read a table of expensive runs.

    Parameters
    ----------
    path : path
        By its suffix: ``.csv``, ``.txt`` or ``.tsv``: UTF-8 text, a header and one line a run, separated by tabs,
        semicolons or commas, whichever of these comes first in this list and stands in the header; blank lines and
        lines that begin with # are skipped. ``.parquet`` (needs pyarrow). ``.nc``: NetCDF, of version 4 if
        netCDF4 is installed: variables of one dim, or outputs on a grid whose dims the inputs, which may be
        coordinates, span together.
    inputs, outputs : mapping of str to str
        For each name in this package's terms, its column in the file: ``{"ks": "K_S"}``. Parameters of vehicles
        (``ks``, ``cs``, ``ms``, ...), of roads (``speed``, ``roughness``, ``cutoff``) and metrics (``bacc``, ``sws``,
        ``dtl``, ``pitch_acc``, ``roll_acc``, ``damper_power``) are known, also with a place behind the name, such as
        ``ks_rear``, ``sws_rr``, ``bacc_cg``. Any other name is taken as it is.
    units : mapping of str to str, optional
        Unit of a column, by its name here or its own, one of `UNITS`; without it, the unit that the file states, in the
        line after the header or in a NetCDF variable's attribute ``units``; without either, the SI unit. A line of
        units holds a unit or nothing in each column asked for. The unit of a name that is not known is kept as text.

    Returns
    -------
    Runs

    Raises
    ------
    OSError
        The file cannot be read.
    ModuleNotFoundError
        A Parquet file without pyarrow, or a NetCDF 4 file without netCDF4.
    ValueError
        The file is not what its suffix says, or its suffix is unknown; a column is missing, there twice or asked for
        twice; a line is too short or too long; a cell is empty or no number, not finite, or beyond the bound of its
        name; a unit is none of its kind; an input is the same in all runs; one design has two different responses;
        there are no runs. The message is one line with the place in the file.

    Examples
    --------
    >>> import pathlib, tempfile
    >>> from susp_ss.fit.runs import read_runs
    >>> path = pathlib.Path(tempfile.mkdtemp(), "runs.csv")
    >>> _ = path.write_text("run;K_S;body\\n;N/mm;m/s²\\n1;18.5;0.69\\n2;20;0.71\\n")
    >>> runs = read_runs(path, inputs={"ks": "K_S"}, outputs={"bacc": "body"})
    >>> runs.designs.ks.tolist(), runs.responses.bacc.tolist(), runs.rows.tolist()
    ([18500.0, 20000.0], [0.69, 0.71], [3, 4])
    >>> runs.place(0, "ks").removeprefix(str(path.parent) + "/")
    "runs.csv, line 3, column 'K_S'"
    """
    path, columns = Path(path), {**inputs, **outputs}
    given = _check_asked(inputs, outputs, units or {})
    if path.suffix.lower() not in READERS:
        raise ValueError(f"{path}: runs are read from {', '.join(READERS)} files, got {path.suffix or 'no suffix'!r}")
    table = READERS[path.suffix.lower()](path, inputs, outputs)
    if not table.rows:
        raise ValueError(f"{path}: no runs, only column names")
    kept, factors, stated = _conversion(path, columns, table, given)
    values = [
        [_value(name, table.cells[name][run], factors[name], _place(path, columns[name], row)) for name in columns]
        for run, row in enumerate(table.rows)
    ]
    frame = pd.DataFrame(values, columns=list(columns), dtype=float)
    runs = Runs(frame[list(inputs)], frame[list(outputs)], np.array(table.rows), path, kept, columns, stated)
    _check_together(runs)
    return runs


def _check_asked(inputs: Mapping[str, str], outputs: Mapping[str, str], units: Mapping[str, str]) -> dict[str, str]:
    """Units by name, as they may be stated by column; what is asked for must be there, and once only."""
    for what, names in (("inputs", inputs), ("outputs", outputs)):
        if not names:
            raise ValueError(f"{what} must name at least one column, got none")
    users: dict[str, str] = {}
    for name, column in [*inputs.items(), *outputs.items()]:
        if name in users.values():
            raise ValueError(f"{name} is asked for as an input and as an output")
        if column in users:
            raise ValueError(f"column {column!r} is asked for twice, as {users[column]} and as {name}")
        users[column] = name
    named: dict[str, str] = {}
    for asked, unit in units.items():
        found = asked if asked in users.values() else users.get(asked)
        if found is None:
            known = dict.fromkeys([*users.values(), *users])
            raise ValueError(f"units: no input or output named {asked!r}, available: {', '.join(known)}")
        if found in named:
            raise ValueError(f"units: {found} is given twice, by its name and by its column")
        named[found] = unit
    return named


# Files -> cells


class _Table(NamedTuple):
    """Rows that hold runs; for each name its cells, and the unit that the file states if it does."""

    rows: Sequence[int]
    cells: dict[str, list[Any]]
    units: dict[str, str]
    units_row: int | None = None


def _read_text(path: Path, inputs: Mapping[str, str], outputs: Mapping[str, str]) -> _Table:
    columns = {**inputs, **outputs}
    records = records_of(path)
    if not records:
        raise ValueError(f"{path}: no header, the file has no text")
    (header_line, header), *records = records
    _check_header(f"{path}, line {header_line}", header, columns.values())
    for line, cells in records:
        if len(cells) != len(header):
            raise ValueError(f"{path}, line {line}: needs {len(header)} cells as the header has, got {len(cells)}")
    lines = [line for line, _ in records]
    found = {name: [cells[header.index(column)] for _, cells in records] for name, column in columns.items()}
    units = _stated(path, lines[0], columns, {name: cells[0] for name, cells in found.items()}) if records else {}
    if not units:
        return _Table(lines, found, {})
    return _Table(lines[1:], {name: cells[1:] for name, cells in found.items()}, units, lines[0])


def records_of(path: Path) -> list[tuple[int, list[str]]]:
    """The lines of a text file that hold something, each with its number and its cells."""
    lines = ["\n" if line.startswith("#") else line for line in io.StringIO(utf8_text(path), newline=None)]
    header = next((line.strip() for line in lines if line.strip()), "")
    delimiter = next((mark for mark in "\t;," if mark in re.sub('"[^"]*"', "", header)), ",")
    reader = csv.reader(lines, delimiter=delimiter, skipinitialspace=True, strict=True)
    records, line = [], 1
    try:
        for cells in reader:
            if any(cell.strip() for cell in cells):
                records.append((line, [cell.strip() for cell in cells]))
            # A cell in quotes may hold line breaks; a record's line is its first.
            line = reader.line_num + 1
    except csv.Error as error:
        raise ValueError(f"{path}, line {line}: not a line of cells: {error}") from None
    return records


def _stated(path: Path, line: int, columns: Mapping[str, str], cells: Mapping[str, str]) -> dict[str, str]:
    """The units of the line after the header, or none if it is a run."""
    filled = {name: cell for name, cell in cells.items() if cell}
    units = {
        name: cell
        for name, cell in filled.items()
        if (plain_unit(cell) in SPELT if _quantity(name).unit else not like_number(cell))
    }
    other = next((name for name in filled if name not in units), None)
    certain = next((name for name, cell in units.items() if plain_unit(cell) in SPELT), None)
    if other is None:
        return units
    if certain is None:
        return {}
    raise ValueError(
        f"{_place(path, columns[other], line)}: needs a unit, {_units_of(other)}, or nothing, as column "
        f"{columns[certain]!r} of this line has the unit {units[certain]!r}, got {filled[other]!r}"
    )


def _read_parquet(path: Path, inputs: Mapping[str, str], outputs: Mapping[str, str]) -> _Table:
    columns = {**inputs, **outputs}
    raw = path.read_bytes()
    with needing("parquet", f"{path}: a Parquet file"):
        import pyarrow
        import pyarrow.parquet
    # From memory, an OSError says that the bytes are wrong.
    broken = (pyarrow.ArrowException, OSError, ValueError)
    try:
        file = pyarrow.parquet.ParquetFile(io.BytesIO(raw))
    except broken as error:
        raise _unreadable(path, "Parquet", error) from error
    _check_header(str(path), file.schema_arrow.names, columns.values())
    try:
        table = file.read(columns=list(columns.values()))
        cells = {name: table.column(column).to_pylist() for name, column in columns.items()}
    except broken as error:
        raise _unreadable(path, "Parquet", error) from error
    return _Table(range(1, table.num_rows + 1), cells, {})


def _read_netcdf(path: Path, inputs: Mapping[str, str], outputs: Mapping[str, str]) -> _Table:
    columns = {**inputs, **outputs}
    # netCDF4 reports a missing file and a broken one alike, and scipy takes bytes.
    raw = path.read_bytes()
    classic = raw.startswith(CLASSIC)
    if not classic:
        with needing("netcdf", f"{path}: a NetCDF 4 file"):
            import netCDF4  # noqa: F401
    source, engine = (io.BytesIO(raw), "scipy") if classic else (path, "netcdf4")
    try:
        with xr.open_dataset(source, engine=engine, decode_times=False) as dataset:
            available = [str(name) for name in dataset.variables]
            arrays = dataset[[column for column in columns.values() if column in available]].load()
    except (OSError, RuntimeError, ValueError, TypeError, LookupError) as error:
        raise _unreadable(path, "NetCDF", error) from error
    _check_header(str(path), available, columns.values())
    spanned = list(dict.fromkeys(dim for column in inputs.values() for dim in arrays[column].dims))
    for name, column in outputs.items():
        dims = arrays[column].dims
        if set(dims) != set(spanned):
            needs, got = (", ".join(map(str, some)) for some in (spanned, dims))
            raise ValueError(
                f"{path}, column {column!r}: {name} must be on the dims of the inputs, ({needs}), got ({got})"
            )
    grid = xr.broadcast(*(arrays[column] for column in columns.values()))
    cells = {name: array.values.reshape(-1).tolist() for name, array in zip(columns, grid, strict=True)}
    units = {name: str(arrays[column].attrs.get("units", "")).strip() for name, column in columns.items()}
    return _Table(range(1, grid[0].size + 1), cells, {name: unit for name, unit in units.items() if unit})


READERS: dict[str, Callable[[Path, Mapping[str, str], Mapping[str, str]], _Table]] = {
    ".csv": _read_text,
    ".txt": _read_text,
    ".tsv": _read_text,
    ".parquet": _read_parquet,
    ".nc": _read_netcdf,
}


def _unreadable(path: Path, kind: str, error: Exception) -> ValueError:
    return ValueError(f"{path}: not a readable {kind} file: {' '.join(str(error).split())}")


def _check_header(where: str, header: Sequence[str], columns: Iterable[str]) -> None:
    lower = {name.lower(): name for name in header}
    for column in columns:
        if column not in header:
            close = difflib.get_close_matches(column.lower(), lower, n=1)
            meant = f"did you mean {lower[close[0]]!r}? " if close else ""
            raise ValueError(f"{where}: no column {column!r}, {meant}available: {', '.join(map(repr, header))}")
        if header.count(column) > 1:
            raise ValueError(f"{where}: {header.count(column)} columns are named {column!r}")


def _place(path: Path, column: str, row: int | None = None) -> str:
    return f"{path}, {'' if row is None else f'{_row_word(path)} {row}, '}column {column!r}"


def _row_word(path: Path) -> str:
    return "line" if READERS[path.suffix.lower()] is _read_text else "row"


# Cells -> numbers in SI units


def _quantity(name: str) -> Quantity:
    return quantity_of(name, NAMES) or UNKNOWN


SPELT = {plain_unit(unit) for units in UNITS.values() for unit in units}


def _units_of(name: str) -> str:
    unit = _quantity(name).unit
    return f"one of {', '.join(units_of(unit))}" if unit else "as text"


def _conversion(
    path: Path, columns: Mapping[str, str], table: _Table, given: Mapping[str, str]
) -> tuple[dict[str, str], dict[str, float], dict[str, str]]:
    """Unit of each name in `Runs`, the factor that takes the file's numbers there, and the unit that these are in."""
    kept, factors, in_file = {}, {}, {}
    for name, column in columns.items():
        quantity = _quantity(name)
        unit = quantity.unit
        stated = given[name] if name in given else table.units.get(name, unit)
        factor = factor_of(stated, quantity) if unit else 1.0
        if factor is None:
            where = f"units of {name}" if name in given else _place(path, column, table.units_row)
            raise ValueError(f"{where}: {name} is in {_units_of(name)}, got {briefly(stated)}")
        kept[name] = unit or stated
        factors[name] = factor
        in_file[name] = stated
    return kept, factors, in_file


def like_number(text: str) -> bool:
    """Whether a cell is meant as a number, be it with a decimal comma."""
    return bool(NUMBER.fullmatch(text) or DECIMAL_COMMA.fullmatch(text))


def _value(name: str, cell: Any, factor: float, where: str) -> float:
    if cell is None or cell == "":
        raise ValueError(f"{where}: {name} needs a number, got an empty cell")
    if isinstance(cell, str) and DECIMAL_COMMA.fullmatch(cell):
        raise ValueError(f"{where}: {cell} is written with a decimal comma; write {cell.replace(',', '.')}")
    number = NUMBER.fullmatch(cell) if isinstance(cell, str) else isinstance(cell, (int, float, Decimal))
    if not number or isinstance(cell, bool):
        raise ValueError(f"{where}: {name} needs a number, got {briefly(cell)}")
    value = float(cell) * factor
    bound = _quantity(name).bound
    within = {"> 0": value > 0.0, ">= 0": value >= 0.0, "": True}[bound]
    if not np.isfinite(value) or not within:
        raise ValueError(f"{where}: {name} must be finite{f' and {bound}' if bound else ''}, got {cell}")
    return value


# The runs together


def _check_together(runs: Runs) -> None:
    """Refuse one design of two results, and an input that never changes."""

    def shown(name: str, value: float) -> str:
        return f"{name} = {value} {runs.units[name]}".rstrip()

    first: dict[tuple[float, ...], int] = {}
    outputs, responses = list(map(str, runs.responses)), runs.responses.to_numpy()
    for run, design in enumerate(map(tuple, runs.designs.to_numpy())):
        earlier = first.setdefault(design, run)
        for name, here, there in zip(outputs, responses[run], responses[earlier], strict=True):
            if here != there:
                raise ValueError(
                    f"{runs.place(run, name)}: {shown(name, here)}, but {runs.row_word} {runs.rows[earlier]} of "
                    f"the same design has {shown(name, there)}"
                )
    for name, values in zip(map(str, runs.designs), runs.designs.to_numpy().T, strict=True):
        if (values == values[0]).all():
            where = _place(runs.path, runs.columns[name])
            raise ValueError(f"{where}: an input must vary, got {shown(name, values[0])} in all runs")
