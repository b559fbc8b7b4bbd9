"""Tables of an engineer's files, as their programs write them: the cells of the columns asked for, each at its place.

One reader a kind of file. A column is asked for by its name in the file, which may carry its unit, ``ks [N/mm]``; a
name of this package's may stand there in another case. Whatever was guessed is noted in words.
"""

from __future__ import annotations

import difflib
import io
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import xarray as xr

from ..extras import needing
from ..netcdf import read_netcdf
from ..quantities import KNOWN, Quantity, quantity_of, units_of
from ..units import SPELT, plain_unit, split_heading
from ..vehicles.files import models
from ..vehicles.system_files import matlab_variables
from ..written import SEPARATORS, like_number, text_table, unreadable

NAMES = {name: quantity for model in models().values() for name, quantity in model.quantities().items()} | KNOWN
"""Parameters of vehicles and roads, and metrics, which are root mean squares or mean powers."""

UNKNOWN = Quantity("", "", "")

# Lines of a sheet above which its header stands: titles, dates, names of projects.
TITLES = 20


class Table(NamedTuple):
    """Rows that hold something; for each name its cells, and the unit that the file states if it does.

    ``noted`` is what was guessed of the file, ``headings`` what columns are called there, ``others`` the columns that
    were not asked for, and ``separator`` what stands between cells of text.
    """

    rows: Sequence[int]
    cells: dict[str, list[Any]]
    units: dict[str, str]
    units_row: int | None = None
    noted: tuple[str, ...] = ()
    headings: Mapping[str, str] = {}
    others: tuple[str, ...] = ()
    separator: str = ""


class Heading(NamedTuple):
    """A column of a file: where it stands, what it is called there, and the unit that its name states."""

    position: int
    name: str
    unit: str


def quantity(name: str) -> Quantity:
    """What a name of the caller's is: a known quantity, or one of no unit and no bound."""
    return quantity_of(name, NAMES) or UNKNOWN


def possible_units(name: str) -> str:
    """The units that a name may be stated in, for a message."""
    unit = quantity(name).unit
    return f"one of {', '.join(units_of(unit))}" if unit else "as text"


def place(path: Path, column: str, row: int | None = None) -> str:
    """Where a cell stands: ``runs.csv, line 7, column 'K_S'``."""
    return f"{path}, {'' if row is None else f'{row_word(path)} {row}, '}column {column!r}"


def row_word(path: Path) -> str:
    """What rows of a file are: the lines of a text, else rows."""
    return "line" if READERS[path.suffix.lower()] is _read_text else "row"


def read_table(path: Path, inputs: Mapping[str, str], outputs: Mapping[str, str], sheet: str | None = None) -> Table:
    """The columns asked for, by the reader of the file's suffix.

    Raises
    ------
    OSError, ModuleNotFoundError, ValueError
        As `susp_ss.read_runs` says.
    """
    reader = READERS.get(path.suffix.lower())
    if reader is None:
        raise ValueError(f"{path}: runs are read from {', '.join(READERS)} files, got {path.suffix or 'no suffix'!r}")
    if sheet is not None and reader is not _read_excel:
        raise ValueError(f"sheet names one of an Excel file's, got {sheet!r} for {path.name}")
    return _read_excel(path, inputs, outputs, sheet) if reader is _read_excel else reader(path, inputs, outputs)


# Columns


def find_columns(where: str, header: Sequence[str], columns: Mapping[str, str]) -> dict[str, Heading]:
    """The column of each name: as it is called, without its unit, or a known name in another case.

    Raises
    ------
    ValueError
        No such column, or two.
    """
    parts = [split_heading(heading) for heading in header]
    found = {}
    for name, column in columns.items():
        ways = [header, [part for part, _ in parts]]
        if column == name and quantity(name) is not UNKNOWN:
            ways.append([column if part.casefold() == column.casefold() else "" for part, _ in parts])
        hits = ([i for i, heading in enumerate(way) if heading == column] for way in ways)
        at = next(filter(None, hits), [])
        if len(at) > 1:
            alike = sorted({header[i] for i in at})
            said = f"are named {column!r}" if alike == [column] else f"may be {column!r}: {', '.join(map(repr, alike))}"
            raise ValueError(f"{where}: {len(at)} columns {said}")
        if not at:
            raise ValueError(f"{where}: no column {column!r}, {_meant(column, header)}")
        found[name] = Heading(at[0], header[at[0]], parts[at[0]][1])
    return found


def _meant(column: str, header: Sequence[str]) -> str:
    lower = {name.lower(): name for name in header}
    close = difflib.get_close_matches(column.lower(), lower, n=1)
    meant = f"did you mean {lower[close[0]]!r}? " if close else ""
    return f"{meant}available: {', '.join(map(repr, header))}"


def _has_columns(header: Sequence[str], columns: Mapping[str, str]) -> bool:
    try:
        find_columns("", header, columns)
    except ValueError:
        return False
    return True


def _of_headings(found: Mapping[str, Heading], header: Sequence[str]) -> dict[str, Any]:
    used = {heading.position for heading in found.values()}
    return {
        "others": tuple(name for i, name in enumerate(header) if i not in used and name),
        "units": {name: heading.unit for name, heading in found.items() if heading.unit},
        "headings": {name: heading.name for name, heading in found.items()},
    }


# Rows of cells: text and sheets


def _read_text(path: Path, inputs: Mapping[str, str], outputs: Mapping[str, str]) -> Table:
    records, separator, encoding = text_table(path)
    if not records:
        raise ValueError(f"{path}: no header, the file has no text")
    (header_line, header), *records = records
    found = find_columns(f"{path}, line {header_line}", header, {**inputs, **outputs})
    for line, cells in records:
        if len(cells) != len(header):
            raise ValueError(f"{path}, line {line}: needs {len(header)} cells as the header has, got {len(cells)}")
    noted = [] if encoding == "UTF-8" else [f"read as {encoding}"]
    noted += [] if separator == "," else [f"cells between {SEPARATORS[separator]}"]
    return _below(path, records, found, header)._replace(noted=tuple(noted), separator=separator)


def _below(
    path: Path, records: Sequence[tuple[int, Sequence[Any]]], found: Mapping[str, Heading], header: Sequence[str]
) -> Table:
    """The rows below a header, of which the first may hold units."""
    rows = [row for row, _ in records]
    cells = {name: [row[heading.position] for _, row in records] for name, heading in found.items()}
    table = Table(rows, cells, **_of_headings(found, header))
    stated = _stated(path, rows[0], found, {name: column[0] for name, column in cells.items()}) if rows else {}
    if not stated:
        return table
    for name, unit in stated.items():
        named = table.units.get(name, unit)
        if plain_unit(named) != plain_unit(unit):
            raise ValueError(f"{place(path, found[name].name, rows[0])}: the column's name says {named}, got {unit!r}")
    below = {name: column[1:] for name, column in cells.items()}
    return table._replace(rows=rows[1:], cells=below, units={**table.units, **stated}, units_row=rows[0])


def _stated(path: Path, row: int, found: Mapping[str, Heading], cells: Mapping[str, Any]) -> dict[str, str]:
    """The units of the line after the header, or none if it is a run."""
    filled = {name: cell for name, cell in cells.items() if cell not in (None, "")}
    units = {
        name: cell
        for name, cell in filled.items()
        if isinstance(cell, str) and (plain_unit(cell) in SPELT if quantity(name).unit else not like_number(cell))
    }
    other = next((name for name in filled if name not in units), None)
    certain = next((name for name, cell in units.items() if plain_unit(cell) in SPELT), None)
    if other is None:
        return units
    if certain is None:
        return {}
    raise ValueError(
        f"{place(path, found[other].name, row)}: needs a unit, {possible_units(other)}, or nothing, as column "
        f"{found[certain].name!r} of this line has the unit {units[certain]!r}, got {filled[other]!r}"
    )


def _read_excel(path: Path, inputs: Mapping[str, str], outputs: Mapping[str, str], sheet: str | None = None) -> Table:
    columns = {**inputs, **outputs}
    sheets = _sheets(path)
    if sheet is not None and sheet not in sheets:
        raise ValueError(f"{path}: no sheet {sheet!r}, available: {', '.join(map(repr, sheets))}")
    asked = sheets if sheet is None else {sheet: sheets[sheet]}
    filled = {name: records for name, records in asked.items() if records}
    if not filled:
        raise ValueError(f"{path}: no header, the sheets have no cells")
    headers = {name: _header(records, columns) for name, records in filled.items()}
    fitting = [name for name, header in headers.items() if header is not None]
    if len(fitting) > 1:
        raise ValueError(f"{path}: the sheets {', '.join(map(repr, fitting))} have these columns; say which by sheet")
    if not fitting:
        shown = max(filled, key=lambda name: sum(column in filled[name][0][1] for column in columns.values()))
        row, names = filled[shown][0]
        find_columns(f"{path}, sheet {shown!r}, row {row}", _texts(names), columns)
    (chosen,) = fitting
    first = headers[chosen] or 0
    row, names = filled[chosen][first]
    found = find_columns(f"{path}, sheet {chosen!r}, row {row}", _texts(names), columns)
    table = _below(path, filled[chosen][first + 1 :], found, _texts(names))
    return table._replace(noted=(f"sheet {chosen!r}",) if len(sheets) > 1 else ())


def _sheets(path: Path) -> dict[str, list[tuple[int, list[Any]]]]:
    """Rows of every sheet that hold something, each with its number and as many cells as the longest."""
    raw = path.read_bytes()
    with needing("excel", f"{path}: an Excel file"):
        import openpyxl
    try:
        book = openpyxl.load_workbook(io.BytesIO(raw), read_only=True, data_only=True)
        sheets = {sheet.title: list(sheet.iter_rows(values_only=True)) for sheet in book.worksheets}
    except Exception as error:  # whatever a damaged file makes the reader raise
        raise unreadable(path, "Excel", error) from error
    found = {}
    for title, rows in sheets.items():
        width = max(map(len, rows), default=0)
        stripped = [[cell.strip() if isinstance(cell, str) else cell for cell in row] for row in rows]
        found[title] = [
            (number, [*row, *[None] * (width - len(row))])
            for number, row in enumerate(stripped, 1)
            if any(cell not in (None, "") for cell in row) and not str(row[0]).startswith("#")
        ]
    return found


def _texts(cells: Sequence[Any]) -> list[str]:
    return ["" if cell is None else str(cell) for cell in cells]


def _header(records: Sequence[tuple[int, Sequence[Any]]], columns: Mapping[str, str]) -> int | None:
    """Which of a sheet's first rows names all columns asked for."""
    return next((i for i, (_, row) in enumerate(records[:TITLES]) if _has_columns(_texts(row), columns)), None)


# Columns of numbers: Parquet, NetCDF, MATLAB


def _read_parquet(path: Path, inputs: Mapping[str, str], outputs: Mapping[str, str]) -> Table:
    raw = path.read_bytes()
    with needing("parquet", f"{path}: a Parquet file"):
        import pyarrow
        import pyarrow.parquet
    # From memory, an OSError says that the bytes are wrong.
    broken = (pyarrow.ArrowException, OSError, ValueError)
    try:
        file = pyarrow.parquet.ParquetFile(io.BytesIO(raw))
    except broken as error:
        raise unreadable(path, "Parquet", error) from error
    found = find_columns(str(path), file.schema_arrow.names, {**inputs, **outputs})
    try:
        table = file.read(columns=[heading.name for heading in found.values()])
        cells = {name: table.column(heading.name).to_pylist() for name, heading in found.items()}
    except broken as error:
        raise unreadable(path, "Parquet", error) from error
    return Table(range(1, table.num_rows + 1), cells, **_of_headings(found, file.schema_arrow.names))


def _read_netcdf(path: Path, inputs: Mapping[str, str], outputs: Mapping[str, str]) -> Table:
    available, wanted = read_netcdf(path, lambda name: _asked(name, {**inputs, **outputs}))
    found = find_columns(str(path), available, {**inputs, **outputs})
    arrays = {name: wanted[heading.name] for name, heading in found.items()}
    spanned = list(dict.fromkeys(dim for name in inputs for dim in arrays[name].dims))
    for name in outputs:
        dims = arrays[name].dims
        if set(dims) != set(spanned):
            needs, got = (", ".join(map(str, some)) for some in (spanned, dims))
            raise ValueError(
                f"{place(path, found[name].name)}: {name} must be on the dims of the inputs, ({needs}), got ({got})"
            )
    grid = xr.broadcast(*arrays.values())
    cells = {name: array.values.reshape(-1).tolist() for name, array in zip(found, grid, strict=True)}
    table = Table(range(1, grid[0].size + 1), cells, **_of_headings(found, available))
    attributes = {name: str(array.attrs.get("units", "")).strip() for name, array in arrays.items()}
    return table._replace(units=table.units | {name: unit for name, unit in attributes.items() if unit})


def _asked(name: str, columns: Mapping[str, str]) -> bool:
    return any(_has_columns([name], {asked: column}) for asked, column in columns.items())


def _read_matlab(path: Path, inputs: Mapping[str, str], outputs: Mapping[str, str]) -> Table:
    columns = {**inputs, **outputs}
    variables = matlab_variables(path)
    if any(type(value).__name__ == "MatlabOpaque" or name == "None" for name, value in variables.items()):
        raise ValueError(f"{path}: a table of MATLAB's own kind; save S = table2struct(T, 'ToScalar', true)")
    structs = {name: value for name, value in variables.items() if isinstance(value, dict)}
    tables = {"": variables} | structs
    chosen = [name for name, table in tables.items() if _has_columns(list(map(str, table)), columns)]
    if len(chosen) > 1:
        raise ValueError(f"{path}: several structs have these columns: {', '.join(map(repr, chosen))}")
    within = tables[chosen[0] if chosen else next(iter(structs), "")]
    header = list(map(str, within))
    found = find_columns(str(path), header, columns)
    cells: dict[str, list[Any]] = {}
    for name, heading in found.items():
        values = np.asarray(within[heading.name])
        if values.ndim > 1 or (cells and len(np.atleast_1d(values)) != len(next(iter(cells.values())))):
            first, *_ = found.values()
            need = f"as many numbers as {first.name!r}" if cells else "a vector of numbers"
            raise ValueError(f"{place(path, heading.name)}: needs {need}, got shape {values.shape}")
        cells[name] = np.atleast_1d(values).tolist()
    rows = range(1, len(next(iter(cells.values()))) + 1)
    return Table(rows, cells, noted=(f"struct {chosen[0]!r}",) if chosen[0] else (), **_of_headings(found, header))


READERS: dict[str, Callable[..., Table]] = {
    ".csv": _read_text,
    ".txt": _read_text,
    ".tsv": _read_text,
    ".xlsx": _read_excel,
    ".xlsm": _read_excel,
    ".parquet": _read_parquet,
    ".nc": _read_netcdf,
    ".mat": _read_matlab,
}
