"""An engineer's own table of expensive runs (Adams, CarSim, a test rig, a script) as designs and responses in SI units.

A table has one row a run and one column a quantity, whatever the columns are called. The caller says which column is
which; the name (``ks``, ``bacc_cg``, ``speed``, ...) says the SI unit and the bound, and the unit that the file or the
caller states says what to multiply by. The flow is: a reader for each kind of file -> `Table` of cells -> numbers in
SI units -> checks of the runs together. A table is taken whole or refused in one line that names the place in the file.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from ..quantities import briefly
from ..surrogates.sampling import sides
from ..units import factor_of
from ..written import Sign, cell_number, checked_sign, decimal_sign
from .tables import Table, place, possible_units, quantity, read_table, row_word


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
        Where each run stands: its line in the file, the first being 1, or where the file is no text its row; of
        histories the name of its file.
    path : Path
        The file, or the folder of the histories.
    units : dict
        Unit of each name: SI, or as the file or the caller stated it where the name is not known to the package.
    columns : dict
        Column of each name in the file.
    stated : dict
        Unit of each column, in which the file's numbers are.
    read : (str, dict)
        The function that read them, and its arguments with all that was guessed.
    row_word : str
        What ``rows`` counts: lines, rows, or files.
    noted : str
        What was guessed of the file, in one line; nothing where nothing was.
    others : tuple of str
        Columns of the file that were not asked for.
    """

    designs: pd.DataFrame
    responses: pd.DataFrame
    rows: NDArray[Any]
    path: Path
    units: dict[str, str]
    columns: dict[str, str]
    stated: dict[str, str]
    read: tuple[str, dict[str, Any]]
    row_word: str = "line"
    noted: str = ""
    others: tuple[str, ...] = ()

    @property
    def weighting(self) -> Any:
        """What accelerations passed as these runs were read, or None: of a table only its maker knows."""
        return self.read[1].get("weighting")

    def place(self, run: int, name: str) -> str:
        """Say where the number of a run, 0 to n - 1, stands: ``runs.csv, line 7, column 'K_S'``."""
        return f"{self.path}, {self.row_word} {self.rows[run]}, column {self.columns[name]!r}"

    def box(self, stated: Mapping[str, Sequence[float]] | None = None) -> dict[str, tuple[float, float]]:
        """Lowest and highest value of each input, or the bounds that are stated in place of them, in SI units.

        Raises
        ------
        TypeError, ValueError
            Bounds of what is no input, or bad ones.
        """
        ends = self.designs.agg(["min", "max"]).to_dict("list")
        box = {str(name): (float(low), float(high)) for name, (low, high) in ends.items()}
        if stated is not None:
            for name, low, high in zip(stated, *sides(stated), strict=True):
                if name not in box:
                    raise ValueError(f"box has no input named {name!r}, available: {', '.join(box)}")
                where = f"box[{name!r}]"
                box[name] = bounded(name, low, where, low), bounded(name, high, where, high)
        return box


def read_runs(
    path: str | PathLike[str],
    inputs: Mapping[str, str],
    outputs: Mapping[str, str],
    units: Mapping[str, str] | None = None,
    *,
    decimal: str | None = None,
    sheet: str | None = None,
) -> Runs:
    """Read a table of expensive runs.

    Parameters
    ----------
    path : path
        By its suffix:

        - ``.csv``, ``.txt`` or ``.tsv``: text in UTF-8, UTF-16 or Latin-1, a header and one line a run, separated by
          tabs, semicolons or commas, whichever of these comes first in this list and stands in the header; blank lines
          and lines that begin with # are skipped.
        - ``.xlsx`` (needs openpyxl): the sheet that has the columns, under titles if there are any.
        - ``.parquet`` (needs pyarrow).
        - ``.nc``: NetCDF, of version 4 if netCDF4 is installed: variables of one dim, or outputs on a grid whose dims
          the inputs, which may be coordinates, span together.
        - ``.mat``: MATLAB 5 to 7, vectors of one length, by themselves or in a struct.
    inputs, outputs : mapping of str to str
        For each name in this package's terms, its column in the file: ``{"ks": "K_S"}``. Parameters of vehicles
        (``ks``, ``cs``, ``ms``, ...), of roads (``speed``, ``roughness``, ``cutoff``) and metrics (``bacc``, ``sws``,
        ``dtl``, ``pitch_acc``, ``roll_acc``, ``damper_power``) are known, also with a place behind the name, such as
        ``ks_rear``, ``sws_rr``, ``bacc_cg``. Any other name is taken as it is. A column may carry its unit, ``K_S
        [N/mm]``, and a known name stand there in another case.
    units : mapping of str to str, optional
        Unit of a column, by its name here or its own, one of `UNITS`; without it, the unit that the file states, in the
        line after the header, in the column's name or in a NetCDF variable's attribute ``units``; without any, the SI
        unit. A line of units holds a unit or nothing in each column asked for. The unit of a name that is not known is
        kept as text.
    decimal : {".", ","}, optional
        The decimal sign of text; found by itself where one cell shows it. Digits may be grouped by the other sign, an
        apostrophe or a space.
    sheet : str, optional
        Of an Excel file in which several have the columns.

    Returns
    -------
    Runs
        Whatever was guessed of the file stands in its ``noted``, one line.

    Raises
    ------
    OSError
        The file cannot be read.
    ModuleNotFoundError
        An Excel file without openpyxl, a Parquet file without pyarrow, or a NetCDF 4 file without netCDF4.
    ValueError
        The file is not what its suffix says, or its suffix is unknown; a column is missing, there twice or asked for
        twice; a line is too short or too long; a cell is empty or no number, not finite, or beyond the bound of its
        name; numbers have decimal points and decimal commas, or could have either; a unit is none of its kind; an input
        is the same in all runs; there are no runs. The message is one line with the place in the file.

    Notes
    -----
    One design may have several runs with different results, as of a rig that scatters; ``noted`` says which.

    Examples
    --------
    >>> import pathlib, tempfile
    >>> from susp_ss.fit.runs import read_runs
    >>> path = pathlib.Path(tempfile.mkdtemp(), "runs.csv")
    >>> _ = path.write_text("run;K_S [N/mm];body\\n;;m/s²\\n1;18,5;0,69\\n2;20;0,71\\n")
    >>> runs = read_runs(path, inputs={"ks": "K_S"}, outputs={"bacc": "body"})
    >>> runs.designs.ks.tolist(), runs.responses.bacc.tolist(), runs.rows.tolist()
    ([18500.0, 20000.0], [0.69, 0.71], [3, 4])
    >>> runs.place(0, "ks").removeprefix(str(path.parent) + "/")
    "runs.csv, line 3, column 'K_S [N/mm]'"
    >>> runs.noted.removeprefix(str(path.parent) + "/")
    'runs.csv: cells between semicolons, decimal commas, ks in N/mm, bacc in m/s²'
    """
    path, columns = Path(path), {**inputs, **outputs}
    given = check_asked(inputs, outputs, units or {})
    asked = checked_sign(decimal)
    table = read_table(path, inputs, outputs, sheet)
    if not table.rows:
        raise ValueError(f"{path}: no runs, only column names")
    columns = {name: table.headings[name] for name in columns}
    frame, kept, stated, sign = in_si_units(path, columns, table, given, asked)
    noted = _noted(path, table, sign if asked is None else ".", given)
    read = {"path": str(path), "inputs": dict(inputs), "outputs": dict(outputs), "units": stated, "decimal": sign}
    read |= {} if sheet is None else {"sheet": sheet}
    made = ("read_runs", read)
    rows, word = np.array(table.rows), row_word(path)
    frames = frame[list(inputs)], frame[list(outputs)]
    return checked_together(Runs(*frames, rows, path, kept, columns, stated, made, word, noted, table.others))


def check_asked(inputs: Mapping[str, str], outputs: Mapping[str, str], units: Mapping[str, str]) -> dict[str, str]:
    """Units by name, as they may be stated by column; what is asked for must be there, and once only.

    Raises
    ------
    ValueError
        Nothing asked for, or something twice, or a unit of what is not asked for.
    """
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


# Cells -> numbers in SI units


def in_si_units(
    path: Path, columns: Mapping[str, str], table: Table, given: Mapping[str, str], decimal: Sign | None
) -> tuple[pd.DataFrame, dict[str, str], dict[str, str], Sign]:
    """The columns as numbers in SI units, the unit of each in `Runs` and in the file, and the decimal sign.

    Raises
    ------
    ValueError
        A cell that is no number or beyond its bound, or a unit of another kind, with its place.
    """
    kept, factors, stated = conversion(path, columns, table, given)
    sign = decimal or decimal_sign(texts(path, columns, table), table.separator)
    values = [
        [_value(name, table.cells[name][run], factors[name], sign, place(path, columns[name], row)) for name in columns]
        for run, row in enumerate(table.rows)
    ]
    return pd.DataFrame(values, columns=list(columns), dtype=float), kept, stated, sign


def conversion(
    path: Path, columns: Mapping[str, str], table: Table, given: Mapping[str, str]
) -> tuple[dict[str, str], dict[str, float], dict[str, str]]:
    """Unit of each name in `Runs`, the factor that takes the file's numbers there, and the unit that these are in."""
    kept, factors, in_file = {}, {}, {}
    for name, column in columns.items():
        unit = quantity(name).unit
        stated = given[name] if name in given else table.units.get(name, unit)
        factor = factor_of(stated, quantity(name)) if unit else 1.0
        if factor is None:
            where = f"units of {name}" if name in given else place(path, column, table.units_row)
            raise ValueError(f"{where}: {name} is in {possible_units(name)}, got {briefly(stated)}")
        kept[name] = unit or stated
        factors[name] = factor
        in_file[name] = stated
    return kept, factors, in_file


def texts(path: Path, columns: Mapping[str, str], table: Table) -> Iterator[tuple[str, str]]:
    """Every cell that is text, with its place."""
    return (
        (place(path, column, row), cell)
        for name, column in columns.items()
        for row, cell in zip(table.rows, table.cells[name], strict=True)
        if isinstance(cell, str)
    )


def _value(name: str, cell: Any, factor: float, decimal: Sign, where: str) -> float:
    if cell is None or cell == "":
        raise ValueError(f"{where}: {name} needs a number, got an empty cell")
    read = cell_number(cell, decimal)
    if read is None:
        raise ValueError(f"{where}: {name} needs a number, got {briefly(cell)}")
    return bounded(name, read * factor, where, cell)


def bounded(name: str, value: float, where: str, got: Any) -> float:
    """Return a finite number within the bound of its name.

    Raises
    ------
    ValueError
        It is not.
    """
    bound = quantity(name).bound
    within = {"> 0": value > 0.0, ">= 0": value >= 0.0, "": True}[bound]
    if not np.isfinite(value) or not within:
        raise ValueError(f"{where}: {name} must be finite{f' and {bound}' if bound else ''}, got {got}")
    return value


def _noted(path: Path, table: Table, decimal: str, given: Mapping[str, str]) -> str:
    """What was guessed of a file, in one line."""
    units = [f"{name} in {unit}" for name, unit in table.units.items() if name not in given]
    said = [*table.noted, *(["decimal commas"] if decimal == "," else []), *units]
    return f"{path}: {', '.join(said)}" if said else ""


# The runs together


def checked_together(runs: Runs) -> Runs:
    """Runs whose inputs all vary, with a note where one design has different results.

    Raises
    ------
    ValueError
        An input is the same in all runs.
    """
    for name, values in zip(map(str, runs.designs), runs.designs.to_numpy().T, strict=True):
        if (values == values[0]).all():
            got = f"{name} = {values[0]} {runs.units[name]}".rstrip()
            raise ValueError(f"{place(runs.path, runs.columns[name])}: an input must vary, got {got} in all runs")
    scatter = _scatter(runs)
    begun = f"{runs.noted}; " if runs.noted else f"{runs.path}: "
    return replace(runs, noted=f"{begun}{scatter}") if scatter else runs


def _scatter(runs: Runs) -> str:
    """Which runs of one design have different results, in words; nothing where none have."""
    of_one = runs.designs.groupby(list(runs.designs), sort=False).indices.values()
    apart = [at for at in of_one if len(at) > 1 and (runs.responses.iloc[at].nunique() > 1).any()]
    if not apart:
        return ""
    first = ", ".join(map(str, runs.rows[apart[0]]))
    others = f", as of {len(apart) - 1} more designs" if apart[1:] else ""
    return f"different results of one design, in {runs.row_word}s {first}{others}, are taken for scatter"
