"""Raw time histories in place of metrics: one file a run, reduced to what `susp_ss.ride_metrics` computes.

An output's history becomes its root mean square about its mean, which takes off gravity, static load and ride height;
a damper's power its mean. The start, before the ride is stationary, is cut as the caller states.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from os import PathLike
from os.path import commonpath
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from ..metrics.vibration import even_step
from ..metrics.weightings import ACCELERATIONS, filter_of
from ..progress import tracked
from ..quantities import Quantity, briefly, metric_and_place
from ..responses.filters import Filter
from ..units import factor_of
from ..written import Sign, checked_sign, decimal_sign, numbers
from .runs import Runs, bounded, check_asked, checked_together, conversion, in_si_units, texts
from .tables import Table, place, read_table, row_word

Array = NDArray[np.float64]

TIME = Quantity("time", "s", "time")

# Cells of a column in which its decimal sign must show.
SHOWN = 200


def read_histories(
    files: Sequence[str | PathLike[str]],
    inputs: Mapping[str, str],
    outputs: Mapping[str, str],
    cut: float,
    *,
    designs: str | PathLike[str] | None = None,
    time: str = "time",
    weighting: Any = None,
    units: Mapping[str, str] | None = None,
    decimal: str | None = None,
    progress: bool = False,
) -> Runs:
    """Read runs from their time histories, one file each.

    Parameters
    ----------
    files : sequence of path
        One a run, of the kinds that `read_runs` knows: a column of time and one an output.
    inputs, outputs : mapping of str to str
        For each name in this package's terms, its column, as in `read_runs`.
    cut : float
        Seconds of each run's start that are left out.
    designs : path, optional
        A table with the inputs of each run and a column ``file`` that names its history, with or without folder and
        suffix. Without it each history holds its inputs, as columns that do not change.
    time : str, optional
        The column of time, rising, in s or in the unit that its name or the line of units states.
    weighting : str or system of python-control, optional
        A filter before accelerations become root mean squares, as in `ride_metrics`; samples must be even.
    units, decimal
        As in `read_runs`.
    progress : bool, optional
        Show progress on stderr.

    Returns
    -------
    Runs
        Responses are root mean squares about the mean over the rest of each run, by the trapezoidal rule; of
        ``damper_power`` the mean.

    Raises
    ------
    OSError, ModuleNotFoundError, ValueError
        As `read_runs`; time that does not rise; a run that ends before the cut; an input that changes within a run; a
        history that no design names, or two; samples too uneven to be filtered.

    Examples
    --------
    >>> import pathlib, tempfile
    >>> import numpy as np, pandas as pd
    >>> from susp_ss import read_histories
    >>> folder, t = pathlib.Path(tempfile.mkdtemp()), np.arange(0.0, 30.0, 0.01)
    >>> for ks, amplitude in ((18.0, 0.9), (20.0, 1.1)):
    ...     history = {"time": t, "ks [N/mm]": ks, "z_acc": 9.81 + amplitude * np.sin(2 * np.pi * 1.5 * t)}
    ...     pd.DataFrame(history).to_csv(folder / f"run_{ks:.0f}.csv", index=False)
    >>> runs = read_histories(sorted(folder.glob("*.csv")), {"ks": "ks"}, {"bacc": "z_acc"}, cut=10.0)
    >>> runs.designs.ks.tolist(), runs.responses.bacc.round(3).tolist()
    ([18000.0, 20000.0], [0.637, 0.778])
    """
    paths = [Path(file) for file in files]
    given = check_asked(inputs, outputs, units or {})
    sign = checked_sign(decimal)
    if not paths:
        raise ValueError("files must name at least one history, got none")
    if isinstance(cut, bool) or not isinstance(cut, (int, float)) or not 0.0 <= cut < np.inf:
        raise ValueError(f"cut must be >= 0 s, got {briefly(cut)}")
    behind = None if weighting is None else filter_of(weighting, "weighting")
    within = dict(inputs) if designs is None else {}
    found = []
    for path in tracked(paths, "histories", progress):
        history = _History(path, within, outputs, time, given, sign)
        row = {name: history.constant(name) for name in within}
        row |= {name: history.reduced(name, cut, behind) for name in outputs}
        found.append(row)
    frame = pd.DataFrame(found, dtype=float)
    names, kept, stated = history.columns, history.kept, history.stated
    if designs is not None:
        own, *of_designs = _designs(Path(designs), inputs, given, sign, paths)
        frame = pd.concat([own, frame], axis=1)
        names, kept, stated = (one | other for one, other in zip(of_designs, (names, kept, stated), strict=True))
    folder = Path(commonpath([path.absolute().parent for path in paths]))
    read = {"files": list(map(str, paths)), "inputs": dict(inputs), "outputs": dict(outputs), "cut": cut}
    read |= {} if designs is None else {"designs": str(designs)}
    read |= {"time": time, "units": {name: stated[name] for name in [*inputs, *outputs]}}
    read |= {} if weighting is None else {"weighting": weighting}
    noted = f"{len(paths)} histories: root mean squares about the mean, from {cut:g} s on"
    noted += f", accelerations through {behind.name}" if behind else ""
    rows = np.array([str(path.absolute().relative_to(folder)) for path in paths])
    made = ("read_histories", read)
    frames = frame[list(inputs)], frame[list(outputs)]
    return checked_together(Runs(*frames, rows, folder, kept, names, stated, made, "file", noted))


def _designs(
    path: Path, inputs: Mapping[str, str], given: Mapping[str, str], decimal: Sign | None, histories: Sequence[Path]
) -> tuple[pd.DataFrame, dict[str, str], dict[str, str], dict[str, str]]:
    """Inputs of each history from a table, and their columns, units in `Runs` and units in the table."""
    table = read_table(path, inputs, {"file": "file"})
    columns = {name: table.headings[name] for name in inputs}
    own = {name: unit for name, unit in given.items() if name in inputs}
    frame, kept, stated, _ = in_si_units(path, columns, table, own, decimal)
    named = [Path(str(cell)) for cell in table.cells["file"]]
    chosen = []
    for history in histories:
        at = [i for i, name in enumerate(named) if name.name in (history.name, history.stem)]
        if len(at) != 1:
            rows = ", ".join(str(table.rows[i]) for i in at)
            found = f"{len(at)}, in {row_word(path)} {rows}" if at else "none"
            raise ValueError(f"{place(path, table.headings['file'])}: {history.name} needs one design, got {found}")
        chosen += at
    return frame.iloc[chosen].reset_index(drop=True), columns, kept, stated


class _History:
    """One run's columns as arrays in SI units, its time in s."""

    def __init__(
        self,
        path: Path,
        inputs: Mapping[str, str],
        outputs: Mapping[str, str],
        time: str,
        given: Mapping[str, str],
        decimal: Sign | None,
    ):
        table = read_table(path, {"time": time}, {**inputs, **outputs})
        if len(table.rows) < 2:
            raise ValueError(f"{path}: needs two samples or more, got {len(table.rows)}")
        self.path, self.rows = path, table.rows
        names = {name: table.headings[name] for name in {**inputs, **outputs}}
        self.kept, factors, self.stated = conversion(path, names, table, given)
        self.columns = names
        shown = table._replace(rows=table.rows[:SHOWN], cells={n: cells[:SHOWN] for n, cells in table.cells.items()})
        sign = decimal or decimal_sign(texts(path, table.headings, shown), table.separator)
        self.values = {name: factors[name] * self._numbers(table, name, sign) for name in names}
        self.t = _seconds(path, table) * self._numbers(table, "time", sign)
        if (np.diff(self.t) <= 0.0).any():
            at = table.rows[int(np.argmax(np.diff(self.t) <= 0.0)) + 1]
            raise ValueError(f"{place(path, table.headings['time'], at)}: time must rise")

    def _numbers(self, table: Table, name: str, sign: Sign) -> Array:
        cells = table.cells[name]
        values = numbers(cells, sign)
        missing = ~np.isfinite(values)
        if missing.any():
            at = int(np.argmax(missing))
            where = place(self.path, table.headings[name], table.rows[at])
            got = "an empty cell" if cells[at] in (None, "") else briefly(cells[at])
            raise ValueError(f"{where}: {name} needs a number, got {got}")
        return values

    def constant(self, name: str) -> float:
        """The value of an input, the same in all samples."""
        values = self.values[name]
        changes = ~np.isclose(values, values[0], rtol=1e-9, atol=0.0)
        if changes.any():
            row = self.rows[int(np.argmax(changes))]
            where = place(self.path, self.columns[name], row)
            got = f"{values[changes][0]:g} after {values[0]:g}"
            raise ValueError(f"{where}: the input {name} must not change within a run, got {got}")
        return bounded(name, float(values[0]), place(self.path, self.columns[name]), f"{values[0]:g}")

    def reduced(self, name: str, cut: float, behind: Filter | None) -> float:
        """The metric of an output: its root mean square about its mean, or its mean where that is the metric."""
        try:
            return over_time(name, self.t, self.values[name], cut, behind)
        except ValueError as error:
            raise ValueError(f"{self.path}: {error}") from None


def over_time(name: str, t: Array, y: Array, cut: float, behind: Filter | None = None) -> float:
    """The metric of an output over the rest of its history: its root mean square about its mean, or its mean.

    Accelerations first pass the filter that they are ``behind``.

    Raises
    ------
    ValueError
        The history ends before the cut, or its samples are too uneven for the filter.

    Examples
    --------
    >>> import numpy as np
    >>> from susp_ss.fit.histories import over_time
    >>> t = np.linspace(0.0, 5.0, 5001)
    >>> round(over_time("bacc", t, 9.81 + np.where(t < 1.0, 40.0, 2.0 * np.sin(2.0 * np.pi * t)), cut=1.0), 3)
    1.414
    """
    if behind is not None and metric_and_place(name)[0] in ACCELERATIONS:
        y = behind.filtered((y - y.mean())[None], even_step(t))[0]
    kept = t >= t[0] + cut
    if kept.sum() < 2:
        raise ValueError(f"ends at {t[-1] - t[0]:g} s, before the cut of {cut:g} s")
    t, y = t[kept], y[kept]
    mean = np.trapezoid(y, t) / (t[-1] - t[0])
    if metric_and_place(name)[0] == "damper_power":
        return float(mean)
    return float(np.sqrt(np.trapezoid((y - mean) ** 2, t) / (t[-1] - t[0])))


def _seconds(path: Path, table: Table) -> float:
    unit = table.units.get("time", "s")
    factor = factor_of(unit, TIME)
    if factor is None:
        raise ValueError(f"{place(path, table.headings['time'], table.units_row)}: time is in s or ms, got {unit!r}")
    return factor
