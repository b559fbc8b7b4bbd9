"""Where to spend the next expensive runs, and whether they would help.

Both ask what the runs have left to know: the variance that Kriging or co-Kriging states, of the surrogate taken where
it is one of them, else of the better of the two, fitted to the same runs.
"""

from __future__ import annotations

import csv
import io
from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from ..quantities import briefly, quantity_of, whole_number
from ..surrogates.folds import one_blas_thread
from ..surrogates.kriging import CoKriging, Kriging
from ..surrogates.next_designs import LOOKED_AT, MOST, Knowledge, knowledge, next_designs, over
from ..units import factor_of
from .fitting import Fit, OutputFit

Array = NDArray[np.float64]

# Less than this share of the error would go if there were twice as many runs: they hardly help.
LITTLE = 0.1


class NextRuns(NamedTuple):
    """The next runs, and what chose them.

    Attributes
    ----------
    designs : DataFrame, (n, k)
        In SI units, a column an input.
    filling : int
        How many of them, the first, fill the box.
    by : dict of str to str
        For each output the surrogate whose variance the others lower.
    """

    designs: pd.DataFrame
    filling: int
    by: dict[str, str]


class Outlook(NamedTuple):
    """What twice as many runs would make of the error of a prediction of a run, its own noise included.

    Attributes
    ----------
    by : str
        The surrogate whose variance says so.
    noise : float
        Standard deviation of a run's own noise, in the unit of the output.
    share : float
        The error with twice as many runs over that now.
    """

    by: str
    noise: float
    share: float

    @property
    def helps(self) -> bool:
        """Whether they are worth it."""
        return self.share <= 1.0 - LITTLE


def next_runs(fit: Fit, runs: int = 5, box: Mapping[str, Sequence[float]] | None = None) -> pd.DataFrame:
    """Say which designs to give to the expensive model next.

    While there are few runs, up to three for each input, those that fill the box: each is the farthest from all others.
    Then those after which the surrogates know most: each lowers the mean over the box of the predicted variance the
    most, in shares of each output's own variance over the runs, summed over the outputs. A run's result does not enter
    its variance, so that several follow from one another without being made (integrated variance: J. Sacks et al.,
    *Statistical Science* 4, 1989; D. Cohn, *Neural Networks* 9, 1996). The variance is that of the surrogate taken, if
    it is Kriging or co-Kriging; the others have none, and the better of those two stands in.

    Parameters
    ----------
    fit : Fit
        From `fit_runs`.
    runs : int
        How many, up to 100.
    box : mapping of str to (low, high), optional
        Bounds of some inputs, in SI units; the others stay within the runs of the fit.

    Returns
    -------
    DataFrame, (runs, k)
        A column an input, in SI units; the most telling first. No design stands there twice, and none of the fit's.

    Raises
    ------
    TypeError, ValueError
        ``fit`` is none, ``runs`` no whole number from 1 to 100, or ``box`` names what is no input or has bad bounds.

    Examples
    --------
    >>> import pathlib, tempfile
    >>> import susp_ss as ss
    >>> path, box = pathlib.Path(tempfile.mkdtemp(), "runs.csv"), {"ks": (15e3, 25e3), "cs": (1e3, 2e3)}
    >>> X = ss.sample(box, 8)
    >>> X.assign(gap=1e-3 * X.ks + 1e-6 * (X.cs - 1e3) ** 2).to_csv(path, index=False)
    >>> runs = ss.read_runs(path, {"ks": "ks", "cs": "cs"}, {"gap": "gap"})
    >>> ss.next_runs(ss.fit_runs(runs, ss.LowFidelity(ss.QuarterCar(), ss.Road())), 3, box).round()
            ks      cs
    0  15000.0  1000.0
    1  24980.0  1506.0
    2  15000.0  2000.0
    """
    return planned(fit, runs, box).designs


def planned(fit: Fit, runs: int, box: Mapping[str, Sequence[float]] | None = None) -> NextRuns:
    """The designs of `next_runs`, and what chose them."""
    if not isinstance(fit, Fit):
        raise TypeError(f"fit must be a Fit, as fit_runs returns it, got {briefly(fit)}")
    count, bounds = whole_number("runs", runs, 1, MOST, f"from 1 to {MOST}"), fit.runs.box(box)
    by = {output: who for output, found in fit.outputs.items() if (who := _knowing(found)) is not None}

    def known(designs: Array) -> list[Knowledge]:
        return [_known(fit, output, who, designs) for output, who in by.items()]

    with one_blas_thread():
        designs, filling = next_designs(bounds, fit.runs.designs.to_numpy(), known, count)
    return NextRuns(pd.DataFrame(designs, columns=list(bounds)), filling, by)


def asked_for(fit: Fit) -> NextRuns | None:
    """The next runs that `fit_runs` was asked for, if any."""
    count = fit.asked["next_runs"]
    return planned(fit, count, fit.asked["next_box"]) if count else None


def in_file_units(fit: Fit, designs: pd.DataFrame) -> pd.DataFrame:
    """Designs in the units, and under the columns, of the file of the runs."""
    columns = {}
    for name, values in designs.items():
        quantity, unit = quantity_of(str(name)), fit.runs.stated[str(name)]
        columns[fit.runs.columns[str(name)]] = values / ((factor_of(unit, quantity) if quantity else None) or 1.0)
    return pd.DataFrame(columns)


def to_fill_in(fit: Fit, designs: pd.DataFrame) -> str:
    """Designs as a table that `read_runs` takes once its outputs are filled in, with the decimal sign of the runs."""
    runs, shown = fit.runs, in_file_units(fit, designs)
    comma = runs.read[1].get("decimal") == ","
    names = [*map(str, runs.designs), *map(str, runs.responses)]
    file = io.StringIO()
    write = csv.writer(file, delimiter=";" if comma else ",", lineterminator="\n").writerow
    write(runs.columns[name] for name in names)
    units = [runs.stated[name] for name in names]
    if any(units):
        write(units)
    for row in shown.itertuples(index=False):
        numbers = (f"{value:.10g}" for value in row)
        write([*(one.replace(".", ",") if comma else one for one in numbers), *[""] * len(runs.responses.columns)])
    return file.getvalue()


def outlook(fit: Fit, output: str) -> Outlook | None:
    """What twice as many runs, spread over the box, would do; None where neither Kriging nor co-Kriging was fitted."""
    by = _knowing(fit.outputs[output])
    if by is None:
        return None
    with one_blas_thread():
        now = _known(fit, output, by, over(fit.runs.box()))
        then = now.after(range(min(len(fit.runs.rows), LOOKED_AT)))
    share = np.sqrt((then.variance + then.noise) / (now.variance + now.noise))
    return Outlook(by, float(fit.outputs[output].models[by].noise_), float(share))


def _knowing(found: OutputFit) -> str | None:
    """The surrogate whose variance says what the runs have left to know."""
    names = (found.chosen, *found.comparison.table.index)
    return next((name for name in names if isinstance(found.models[name], Kriging | CoKriging)), None)


def _known(fit: Fit, output: str, by: str, designs: Array) -> Knowledge:
    """What the runs have left at designs (N, k), in shares of the standard deviation of the responses."""
    model: Any = fit.outputs[output].models[by]
    scale = max(float(fit.runs.responses[output].std()), np.finfo(float).tiny)
    return knowledge(model, pd.DataFrame(designs, columns=list(fit.surrogate.inputs)), scale)
