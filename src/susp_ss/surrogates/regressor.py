"""What every surrogate takes for designs and responses, and what it calls the columns."""

from __future__ import annotations

import itertools
import warnings
from collections.abc import Iterable
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray
from sklearn.base import BaseEstimator, RegressorMixin
from sklearn.preprocessing import MinMaxScaler
from sklearn.utils import gen_batches
from sklearn.utils.validation import check_is_fitted, validate_data

from .folds import one_blas_thread, split, unfitted
from .intervals import NoInterval, checked_share, jackknife_plus

Array = NDArray[np.float64]

# Columns that are this close to a combination of the others cannot be told apart from them.
DEPENDENT = 1e-10


# Of the box of the runs, what a design may lie beyond it by rounding.
EDGE = 1e-9

# Designs predicted at once: a prediction holds every distance from every run, or every fit without one.
BATCH = 1000

# Runs of an approximation that holds every distance between them: 200 MB, and a minute.
MOST_RUNS = 5000

# Runs up to which a file keeps what fits without some of them found, whose search takes seconds.
KEPT = 300


def independent(columns: Array) -> bool:
    """Whether no column is a combination of the others, beyond rounding, by their singular values."""
    if not columns.shape[1]:
        return True
    values = np.linalg.svd(columns, compute_uv=False)
    return bool(len(values) == columns.shape[1] and values[-1] > DEPENDENT * values[0])


def factors(k: int, degree: int) -> list[tuple[int, ...]]:
    """Which of k columns are multiplied in every monomial up to a degree, the constant first; none for -1."""
    return [f for d in range(degree + 1) for f in itertools.combinations_with_replacement(range(k), d)]


def monomials(Z: Array, degree: int) -> Array:
    """Every monomial (n, m) of designs (n, k) up to a degree, in the order of `factors`."""
    multiplied = factors(Z.shape[1], degree)
    columns, at = np.ones((len(multiplied), len(Z))), {f: i for i, f in enumerate(multiplied)}
    for f in multiplied[1:]:
        np.multiply(columns[at[f[:-1]]], Z[:, f[-1]], out=columns[at[f]])
    return columns.T


def beyond(designs: Array, lowest: Array, highest: Array) -> NDArray[np.bool_]:
    """Which values (n, k) lie outside a box, by more than rounding."""
    edge = EDGE * np.maximum(np.abs(lowest), np.abs(highest))
    return (designs < lowest - edge) | (designs > highest + edge)


class ExtrapolationWarning(UserWarning):
    """Designs were predicted outside the box of the runs, where nothing holds a surrogate to the expensive model."""


class Surrogate(RegressorMixin, BaseEstimator):
    """A regressor from designs X (n, k), an array or a DataFrame, to responses y (n,).

    Attributes
    ----------
    lowest_, highest_ : ndarray, (k,)
        The box of the runs.
    """

    def outside(self, X: ArrayLike) -> NDArray[np.bool_]:
        """Which of the designs X (n, k) lie outside the box of the runs, beyond rounding."""
        return np.any(beyond(self._columns(X), self.lowest_, self.highest_), axis=1)

    def predict(self, X: ArrayLike, *, interval: float | None = None) -> Any:
        """Predict the responses at designs.

        Parameters
        ----------
        X : array_like, (n, k), or DataFrame
        interval : float, optional
            Share of new responses that the bounds are to hold, such as 0.95, by the jackknife+ (R. Barber et al.,
            *Annals of Statistics* 49, 2021; its guarantee, for designs drawn as the runs were, is ``2 interval - 1``,
            and what it holds is near ``interval``). Needs 19 runs for 95 %; with fewer, errors are taken for normal.

        Returns
        -------
        ndarray (n,), or ndarray (n,) and ndarray (n, 2)
            Predictions; with an interval also its lower and upper bounds, in the unit of the responses.

        Raises
        ------
        ValueError
            Bad designs, an interval that is not between 0 and 1, or a surrogate that has none, with the reason.

        Warns
        -----
        ExtrapolationWarning
            Designs outside the box of the runs, where no interval holds.
        """
        designs = self._designs(X)
        return self._at(designs) if interval is None else self._with_interval(designs, interval)

    def _at(self, designs: Array) -> Array:
        """Predictions (N,) at checked designs (N, k)."""
        raise NotImplementedError

    def _others(self, designs: Array) -> tuple[Array, Array]:
        """What fits without each run predict (N, n) at checked designs, and by how much, (n,) or (N, n), they miss it.

        Raises
        ------
        ValueError
            The others do not determine a fit, or the runs are not known.
        """
        raise NotImplementedError

    def _with_interval(self, designs: Array, interval: float) -> tuple[Array, Array]:
        level, predicted = checked_share("interval", interval), self._at(designs)
        try:
            bounds = [
                jackknife_plus(predicted[some], *self._others(designs[some]), level)
                for some in gen_batches(len(designs), BATCH)
            ]
        except (ValueError, RuntimeError) as error:
            raise NoInterval(f"{type(self).__name__} has no interval: {error}") from error
        return predicted, np.concatenate(bounds)

    def _numbers(self) -> dict[str, Any]:
        """What a fit found beside its box, from which `_restore` makes the same predictions."""
        raise NotImplementedError

    def _restore(self, found: dict[str, Any]) -> None:
        """Take up what a fit found, after its columns and box."""
        raise NotImplementedError

    def _numbers_without(self) -> dict[str, Any]:
        """What fits without some runs found, from which `_restore_without` makes the same intervals.

        Raises
        ------
        ValueError, RuntimeError
            There are no such fits.
        """
        raise NotImplementedError

    def _restore_without(self, found: dict[str, Any]) -> None:
        """Take up what fits without some runs found, after all else."""
        raise NotImplementedError

    def _runs(self, X: ArrayLike, y: ArrayLike) -> tuple[Array, Array]:
        """Designs (n, k) and responses (n,) to be fitted, finite numbers and at least two."""
        designs, responses = validate_data(self, X, y, y_numeric=True, dtype=float, ensure_min_samples=2)
        self.lowest_, self.highest_ = designs.min(axis=0), designs.max(axis=0)
        return designs, responses

    def _designs(self, X: ArrayLike) -> Array:
        """Designs (n, k) to be predicted; those outside the box of the runs are warned of."""
        designs = self._columns(X)
        far_out = beyond(designs, self.lowest_, self.highest_)
        if far_out.any():
            column = int(np.argmax(far_out.any(axis=0)))
            far = designs[np.argmax(far_out[:, column]), column]
            warnings.warn(
                f"{np.count_nonzero(far_out.any(axis=1))} of {len(designs)} designs lie outside the box of the runs, "
                f"such as {self._place(column)} = {far:g} where the runs go from {self.lowest_[column]:g} to "
                f"{self.highest_[column]:g}: an extrapolation",
                ExtrapolationWarning,
                stacklevel=3,
            )
        return designs

    def _columns(self, X: ArrayLike) -> Array:
        """Designs (n, k) with the columns of the fit."""
        check_is_fitted(self)
        return validate_data(self, X, reset=False, dtype=float)

    def _place(self, column: int) -> str:
        """A column in the words of a message."""
        names = getattr(self, "feature_names_in_", None)
        return f"column {column} of X" if names is None else str(names[column])


# Fits without some runs, which these are, and by how much the fit misses them in the measure of its errors there.
Deputies: TypeAlias = "list[tuple[Approximation, NDArray[np.intp], Array]]"

RUNS = ("designs", "responses")
"""Names of `Approximation.runs_` among numbers."""


class Approximation(Surrogate):
    """A surrogate of the responses alone, on columns that run from -1 to 1 over the box of its runs.

    Attributes
    ----------
    runs_ : (ndarray (n, k), ndarray (n,))
        Designs and responses that an interpolant goes through.
    """

    _deputies: Deputies | None = None

    def _without(self) -> Deputies:
        """Fits without each design, or a tenth of more than 30 runs, shapes and thetas their own.

        With what each lacks, and how far it misses that in terms of the size of its errors there.

        Thetas that have seen a run flatter the error there, so that the closed forms make no intervals.
        """
        if self._deputies is None:
            designs, responses = self.runs_
            with one_blas_thread():
                parts = [
                    (unfitted(self).fit(designs[fitted], responses[fitted]), left_out)
                    for fitted, left_out in split(designs, None, 0)
                ]
            self._deputies = self._missing(parts)
        return self._deputies

    def _missing(self, parts: Iterable[tuple[Approximation, NDArray[np.intp]]]) -> Deputies:
        """Deputies, and how far they miss the runs that they lack."""
        designs, responses = self.runs_
        deputies: Deputies = []
        for deputy, lacking in parts:
            there, size = deputy._at_with_size(designs[lacking])
            deputies.append((deputy, lacking, np.abs(responses[lacking] - there) / size))
        return deputies

    def _numbers_without(self) -> dict[str, Any]:
        if len(self.runs_[0]) > KEPT:
            raise ValueError(f"fits without some of more than {KEPT} runs are made when asked for")
        folds, fits = np.empty(len(self.runs_[0]), dtype=np.intp), []
        for i, (deputy, lacking, _) in enumerate(self._without()):
            folds[lacking] = i
            fits.append({name: value for name, value in deputy._numbers().items() if name not in RUNS})
        return {"folds": folds, "fits": fits}

    def _restore_without(self, found: dict[str, Any]) -> None:
        folds, fits, parts = np.asarray(found["folds"]), found["fits"], []
        if folds.shape != (len(self.runs_[0]),) or set(folds.tolist()) != set(range(len(fits))):
            raise ValueError("left_out must have one fold a run, and one fit for each fold")
        for i, fit in enumerate(fits):
            deputy = unfitted(self)
            deputy.n_features_in_ = self.n_features_in_
            deputy._restore({**fit, **{name: rows[folds != i] for name, rows in zip(RUNS, self.runs_, strict=True)}})
            parts.append((deputy, np.flatnonzero(folds == i)))
        self._deputies = self._missing(parts)

    def _common(self, designs: Array) -> tuple[Array, ...]:
        """What fits to any of the runs make of designs alike."""
        return ()

    def _at_with_size(self, designs: Array, *common: Array) -> tuple[Array, Array]:
        """Predictions (N,), and what the size (N,) of their errors is proportional to, as far as this is known."""
        return self._at(designs), np.ones(len(designs))

    def _others(self, designs: Array) -> tuple[Array, Array]:
        common = self._common(designs)
        by_others, misses = (np.empty((len(designs), len(self.runs_[0]))) for _ in range(2))
        for deputy, lacking, missed in self._without():
            predicted, size = deputy._at_with_size(designs, *common)
            by_others[:, lacking] = predicted[:, None]
            misses[:, lacking] = np.outer(size, missed)
        return by_others, misses

    def _box(self, designs: Array) -> MinMaxScaler:
        """The box of the runs; every variable varies in it."""
        constant = np.ptp(designs, axis=0) <= DEPENDENT * np.abs(designs).max(axis=0)
        if constant.any():
            column = int(np.argmax(constant))
            raise ValueError(
                f"{self._place(column)} is constant, got {designs[0, column]:g} in every run; vary it, or leave it out"
            )
        return MinMaxScaler(feature_range=(-1.0, 1.0)).fit(designs)

    def _distinct(self, X: ArrayLike, y: ArrayLike) -> tuple[Array, Array]:
        """The runs to interpolate: no design has two responses."""
        designs, responses = self._runs(X, y)
        _, first, group = np.unique(designs, axis=0, return_index=True, return_inverse=True)
        again = responses != responses[first[group]]
        if again.any():
            row = int(np.argmax(again))
            raise ValueError(
                f"rows {first[group[row]]} and {row} of X are one design with two responses, "
                f"{float(responses[first[group[row]]])!r} and {float(responses[row])!r}; keep one, or their mean"
            )
        return self._merged(designs, responses)

    def _merged(self, designs: Array, responses: Array) -> tuple[Array, Array]:
        """Take up the runs; a design that returns with the same response counts once."""
        runs = np.column_stack([designs, responses])
        _, first, group = np.unique(runs, axis=0, return_index=True, return_inverse=True)
        kept = np.sort(first)
        # Of each run, which of those that are kept it is.
        self._of_run = np.searchsorted(kept, first[group.ravel()])
        return self._keep(designs[kept], responses[kept])

    def _keep(self, designs: Array, responses: Array) -> tuple[Array, Array]:
        if len(designs) > MOST_RUNS:
            raise ValueError(
                f"{type(self).__name__} takes at most {MOST_RUNS} runs, got {len(designs)}; some hundred are plenty in "
                "a few variables"
            )
        self.runs_, self._deputies = (designs, responses), None
        return self.runs_

    def _found_runs(self, found: dict[str, Any]) -> tuple[Array, Array]:
        """Take up the runs that an approximation keeps, and their box."""
        designs, responses = (np.asarray(found[name], dtype=float) for name in RUNS)
        if designs.ndim != 2 or designs.shape != (len(responses), self.n_features_in_) or responses.ndim != 1:
            raise ValueError(
                f"designs and responses must be (n, {self.n_features_in_}) and (n,), got {designs.shape} and "
                f"{responses.shape}"
            )
        if not (np.isfinite(designs).all() and np.isfinite(responses).all()):
            raise ValueError("designs and responses must be finite")
        self.box_ = self._box(designs)
        return self._keep(designs, responses)
