"""From a table of expensive runs to the surrogate that predicts them best, with an error that can be believed.

Every surrogate is cross-validated on the same folds; the one with the least error is chosen, for each output by
itself, and stands beside the best that needs no cheap model: what the same runs alone would have given.
"""

from __future__ import annotations

import dataclasses
import warnings
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from html import escape
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from ..quantities import quantity_of, whole_number
from ..responses.settings import settable
from ..surrogates import (
    Accuracy,
    CoKriging,
    Kriging,
    ParameterBased,
    Polynomial,
    RadialBasis,
    ResponseBased,
    VariableBased,
    accuracy,
)
from ..surrogates.folds import one_blas_thread
from ..surrogates.learning import learning_curve_of_runs
from ..surrogates.low_fidelity import evaluated
from ..surrogates.next_designs import MOST
from ..surrogates.regressor import Surrogate
from ..surrogates.validation import Comparison, Validation, compare, held_out
from ..units import Stated, factor_of, implausible
from .formulas import formula
from .low_fidelity import LowFidelity, LowFidelityResponse
from .runs import Runs
from .surrogate_file import SuspensionSurrogate
from .verdict import Verdict, verdict

Array = NDArray[np.float64]

# A cheap model of the same quantity in the same unit is nearer than this; a unit's prefix is a factor of 1000.
APART = 1000.0**0.5


@dataclass(frozen=True, eq=False)
class OutputFit:
    """What was found of one output.

    Attributes
    ----------
    comparison : Comparison
        Every surrogate's cross-validation, best first.
    chosen : str
        The surrogate taken.
    models : dict of str to Surrogate
        Every surrogate, fitted to all runs but those held out.
    untuned : Accuracy or None
        How well the cheap model does as it is, if it has this output.
    kept_back : dict of str to Validation
        Every surrogate at the runs held out; empty without.
    learning : DataFrame or None
        What `learning_curve_of_runs` returns, if asked for.
    formula : (str, str) or None
        The best surrogate that has a formula, and the formula.
    verdict : Verdict
        Whether the surrogate taken predicts anything, and what may be wrong.
    """

    comparison: Comparison
    chosen: str
    models: dict[str, Surrogate]
    untuned: Accuracy | None
    kept_back: dict[str, Validation]
    learning: pd.DataFrame | None
    formula: tuple[str, str] | None
    verdict: Verdict

    @property
    def model(self) -> Surrogate:
        """The surrogate taken, fitted."""
        return self.models[self.chosen]

    @property
    def foremost(self) -> tuple[str, ...]:
        """What to look at first: the surrogate taken, the best that tunes the cheap model, and the best without it."""
        tuned = None if self.untuned is None else self.comparison.gain().tuned
        names = (self.chosen, tuned, self.comparison.baseline)
        return tuple(dict.fromkeys(name for name in names if name is not None))


@dataclass(frozen=True, eq=False)
class Fit:
    """What `fit_runs` found.

    Attributes
    ----------
    runs : Runs
        Those that were fitted.
    low_fidelity : LowFidelity
    outputs : dict of str to OutputFit
    asked : dict
        The other arguments of `fit_runs`, but for ``progress``.
    """

    runs: Runs
    low_fidelity: LowFidelity
    outputs: dict[str, OutputFit]
    asked: dict[str, Any]

    @property
    def surrogate(self) -> SuspensionSurrogate:
        """The surrogates taken, as one that can be saved."""
        units = self.runs.units
        return SuspensionSurrogate(
            {str(name): units[str(name)] for name in self.runs.designs},
            {name: units[name] for name in self.outputs},
            {name: output.model for name, output in self.outputs.items()},
            self.low_fidelity,
            {name: self._error(output) for name, output in self.outputs.items()},
            {name: unit for name, unit in self.runs.stated.items() if quantity_of(name) and unit != units[name]},
        )

    def _error(self, output: OutputFit) -> dict[str, Any]:
        """What a surrogate file says of a surrogate's error."""
        left_out = output.comparison.validations[output.chosen].accuracy
        own = {"surrogate": output.chosen, "runs": len(self.runs.rows), "predicts": output.verdict.predicts}
        return own | {"left_out": left_out._asdict()}

    def __repr__(self) -> str:
        """What was taken, in one line."""
        taken = ", ".join(f"{name} by {output.chosen}" for name, output in self.outputs.items())
        return f"Fit of {len(self.runs.rows)} runs of {self.runs.path}: {taken}"

    def _repr_html_(self) -> str:
        tables = (f"<h4>{escape(name)}</h4>{found.comparison.table.to_html()}" for name, found in self.outputs.items())
        return "".join(tables)


def fit_runs(
    runs: Runs,
    low_fidelity: LowFidelity,
    choose: str | None = None,
    folds: int | None = None,
    held_out_runs: int = 0,
    learning: bool = False,
    refit: bool = False,
    next_runs: int = 0,
    next_box: Mapping[str, Sequence[float]] | None = None,
    trust_units: bool = False,
    random_state: int = 0,
    progress: bool = False,
) -> Fit:
    """Fit every surrogate to every output of a table of runs, and choose by cross-validated error.

    Parameters
    ----------
    runs : Runs
        From `read_runs`.
    low_fidelity : LowFidelity
        The cheap model; its inputs and metrics are matched to those of the runs by name.
    choose : str, optional
        Take this surrogate for every output, such as ``"VB"``, in place of the one with the least error.
    folds : int, optional
        Of the cross-validation: by default each run is left out by itself up to 30 runs, and in 10 folds beyond.
    held_out_runs : int
        Runs that neither fits nor choice may see, drawn at random, for an error that the choice has not flattered.
    learning : bool
        Also fit every surrogate to fewer of the runs, as `learning_curve_of_runs` does.
    refit : bool
        Cross-validate with thetas, noise and shapes found anew for every fold, as `compare` does.
    next_runs : int
        How many runs the report and the files are to name that would tell most next, as `next_runs` does.
    next_box : mapping of str to (low, high), optional
        Bounds of these.
    trust_units : bool
        Take the runs though the cheap model is more than 30 times apart from them.
    random_state : int
        Of the folds and of the runs held out.
    progress : bool
        Show progress on stderr.

    Returns
    -------
    Fit

    Raises
    ------
    TypeError, ValueError
        Too few runs for the inputs; a unit that is probably wrong (with line and column); an unknown surrogate, or one
        that cannot be fitted; an input or output that the cheap model refuses.

    Examples
    --------
    >>> import pathlib, tempfile
    >>> import numpy as np, pandas as pd, susp_ss as ss
    >>> ks, cs = np.random.default_rng(0).uniform([13e3, 900.0], [24e3, 2200.0], (12, 2)).T
    >>> bacc = ss.ride_metrics(ss.FullCar(ks=ks, cs=cs), ss.Road()).bacc.sel(point="fr")
    >>> path = pathlib.Path(tempfile.mkdtemp(), "runs.csv")
    >>> pd.DataFrame({"ks": ks, "cs": cs, "bacc": bacc}).to_csv(path, index=False)
    >>> runs = ss.read_runs(path, inputs={"ks": "ks", "cs": "cs"}, outputs={"bacc": "bacc"})
    >>> fit = ss.fit_runs(runs, ss.LowFidelity(ss.QuarterCar(), ss.Road(), "fr"), choose="VB", folds=2)
    >>> bool(fit.outputs["bacc"].comparison.table.R2["VB"] > 0.9)
    True
    """
    columns = list(map(str, runs.designs))
    _check_enough(runs, held_out_runs)
    _check_weighting(runs, low_fidelity)
    whole_number("next_runs", next_runs, 0, MOST, f"from 0 to {MOST}")
    runs.box(next_box)
    cheap = {str(output): low_fidelity.response(str(output), columns) for output in runs.responses}
    if not trust_units:
        _check_units(runs, low_fidelity, cheap)
    tried = {}
    for output, f in cheap.items():
        tuned = low_fidelity.response(output, columns, tuned=True) if f and _tunable(low_fidelity, f) else None
        tried[output] = candidates(f, tuned)
        if choose is not None and choose not in tried[output]:
            raise ValueError(f"no surrogate of {output} named {choose!r}, available: {', '.join(tried[output])}")
    taken, kept = _split(runs, held_out_runs, random_state)
    found = {}
    for output, surrogates in tried.items():
        X, y = taken.designs, taken.responses[output].to_numpy()
        with warnings.catch_warnings():
            # Of each fold and draw; the report says it once, of the fit to all runs.
            warnings.filterwarnings("ignore", "the tuned parameter")
            comparison = compare(surrogates, X, y, folds, random_state, refit=refit, progress=progress)
            if choose in comparison.refused:
                raise ValueError(f"{choose} cannot be fitted to {output}: {comparison.refused[choose]}")
            learned = learning_curve_of_runs(surrogates, X, y, repeats=3, progress=progress) if learning else None
            with one_blas_thread():
                models = {name: comparison.models[name] for name in comparison.table.index}
        f, at = cheap[output], kept.responses[output].to_numpy()
        own = None if f is None else evaluated(f, X.to_numpy())
        taken_here = comparison.best if choose is None else choose
        typed = ((name, formula(model, getattr(model, "low_fidelity", None))) for name, model in models.items())
        found[output] = OutputFit(
            comparison,
            taken_here,
            models,
            None if own is None else accuracy(y, own),
            {name: held_out(model, kept.designs, at) for name, model in models.items()} if held_out_runs else {},
            learned,
            next(((name, text) for name, text in typed if text is not None), None),
            verdict(comparison, taken_here, surrogates, X, y, own, low_fidelity, output, runs.stated[output]),
        )
    asked = {
        "choose": choose,
        "folds": folds,
        "held_out_runs": held_out_runs,
        "learning": learning,
        "refit": refit,
        "next_runs": next_runs,
        "next_box": next_box,
        "trust_units": trust_units,
        "random_state": random_state,
    }
    return Fit(taken, low_fidelity, found, asked)


def candidates(cheap: LowFidelityResponse | None, tuned: LowFidelityResponse | None) -> dict[str, Surrogate]:
    """Every surrogate by name: the cheap model tuned, where there is one, and the runs approximated.

    Parameters
    ----------
    cheap, tuned : LowFidelityResponse or None
        The cheap response of the designs, and of the designs and its parameter.
    """
    tuning: dict[str, Surrogate] = {}
    if cheap is not None:
        tuning = {
            "RB": ResponseBased(cheap),
            "RB power": ResponseBased(cheap, form="power"),
            "VB": VariableBased(cheap),
        }
        if tuned is not None:
            tuning[f"PB {tuned.parameter}"] = ParameterBased(tuned)
        tuning["CoKriging"] = CoKriging(cheap)
    return tuning | {
        **{f"Polynomial {degree}": Polynomial(degree) for degree in (1, 2, 3)},
        "RBF thin plate": RadialBasis(),
        "RBF Gaussian": RadialBasis("gaussian"),
        "Kriging": Kriging(),
    }


def _tunable(low_fidelity: LowFidelity, cheap: LowFidelityResponse) -> bool:
    """Whether the parameter to be tuned is none that the runs set."""
    known = settable(low_fidelity.vehicle)
    return low_fidelity.parameter is not None and low_fidelity.parameter not in {
        known[name].field for name in cheap.response.inputs
    }


def _check_enough(runs: Runs, held_out_runs: int) -> None:
    n, k = len(runs.designs.drop_duplicates()), runs.designs.shape[1]
    whole_number("held_out_runs", held_out_runs, 0)
    if held_out_runs > n - k - 2 >= 0:
        raise ValueError(
            f"{runs.path}: held_out_runs must leave {k + 2} different designs of {n} to fit, got {held_out_runs}; pass "
            f"{n - k - 2} at most"
        )
    if n < k + 2:
        raise ValueError(
            f"{runs.path}: {n} different designs to fit are fewer than the {k + 2} that {k} input(s) "
            f"need: a plane has {k + 1} coefficients, and one run is left out at a time"
        )


def _check_weighting(runs: Runs, low_fidelity: LowFidelity) -> None:
    """Refuse a cheap model whose accelerations pass another weighting than those of the runs."""
    if runs.weighting is None:
        return
    as_read = dataclasses.replace(low_fidelity, weighting=runs.weighting)
    for output in map(str, runs.responses):
        theirs, own = as_read.through(output), low_fidelity.through(output)
        if theirs is not None and (own is None or not own.same_as(theirs)):
            given = "none" if own is None else own.name
            raise ValueError(
                f"{output} of the runs passed the weighting {theirs.name}, and of the cheap model {given}; pass "
                "LowFidelity(weighting=...) what the runs were read with"
            )


def _check_units(runs: Runs, low_fidelity: LowFidelity, cheap: dict[str, LowFidelityResponse | None]) -> None:
    """Refuse what no road vehicle has, and what the cheap model is orders of magnitude from."""
    for name, middle in pd.concat([runs.designs, runs.responses], axis=1).median().items():
        quantity, unit = quantity_of(str(name)), runs.stated[str(name)]
        factor = None if quantity is None else factor_of(unit, quantity)
        far = "" if quantity is None or factor is None else implausible(Stated(middle / factor, unit), quantity)
        if far:
            where = runs.place(0, str(name)).replace(f", {runs.row_word} {runs.rows[0]}", "")
            raise ValueError(f"{where}: the median of {name}, {far} State its unit, or trust the units")
    for name in map(str, runs.designs):
        own = low_fidelity.own(name)
        if own:
            _check_unit(runs, name, runs.designs[name].to_numpy(), np.full(len(runs.rows), own))
    for output, f in cheap.items():
        if f is not None:
            _check_unit(runs, output, runs.responses[output].to_numpy(), evaluated(f, runs.designs.to_numpy()))


def _check_unit(runs: Runs, name: str, given: Array, own: Array) -> None:
    ratio, unit = float(np.median(given / own)), runs.units[name]
    if not 1.0 / APART < ratio < APART:
        raise ValueError(
            f"{runs.place(0, name)}: {given[0]:g} {unit} where the cheap model has {own[0]:.4g} {unit}, over all runs "
            f"{ratio:.2g} times as much: is the unit wrong? State it, or trust the units"
        )


def _split(runs: Runs, held_out_runs: int, random_state: int) -> tuple[Runs, Runs]:
    """Runs to fit, and runs held out; one design's are on one side."""
    order = np.random.default_rng(random_state).permutation(len(runs.designs.drop_duplicates()))
    group = runs.designs.groupby(list(runs.designs), sort=False).ngroup().to_numpy()
    kept = np.isin(group, order[:held_out_runs])
    return _some(runs, ~kept), _some(runs, kept)


def _some(runs: Runs, chosen: NDArray[np.bool_]) -> Runs:
    return dataclasses.replace(
        runs, designs=runs.designs[chosen], responses=runs.responses[chosen], rows=runs.rows[chosen]
    )
