"""What every surrogate takes for designs and responses, and what it calls the columns."""

from __future__ import annotations

import warnings
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from sklearn.base import BaseEstimator, RegressorMixin
from sklearn.preprocessing import MinMaxScaler
from sklearn.utils.validation import check_is_fitted, validate_data

Array = NDArray[np.float64]

# Columns that are this close to a combination of the others cannot be told apart from them.
DEPENDENT = 1e-10


# Of the box of the runs, what a design may lie beyond it by rounding.
EDGE = 1e-9

# Runs of an approximation that holds every distance between them: 200 MB, and a minute.
MOST_RUNS = 5000


def independent(columns: Array) -> bool:
    """Whether no column is a combination of the others, beyond rounding, by their singular values."""
    if not columns.shape[1]:
        return True
    values = np.linalg.svd(columns, compute_uv=False)
    return bool(len(values) == columns.shape[1] and values[-1] > DEPENDENT * values[0])


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

    def _numbers(self) -> dict[str, Any]:
        """What a fit found beside its box, from which `_restore` makes the same predictions."""
        raise NotImplementedError

    def _restore(self, found: dict[str, Any]) -> None:
        """Take up what a fit found, after its columns and box."""
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


class TunedModel(Surrogate):
    """A surrogate that evaluates the cheap model for every prediction: how well it scores is up to that."""

    def __sklearn_tags__(self) -> Any:
        tags = super().__sklearn_tags__()
        tags.regressor_tags.poor_score = True
        return tags


class Approximation(Surrogate):
    """A surrogate of the responses alone, on columns that run from -1 to 1 over the box of its runs.

    Attributes
    ----------
    runs_ : (ndarray (n, k), ndarray (n,))
        Designs and responses that an interpolant goes through.
    """

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
        self.runs_ = designs, responses
        return self.runs_

    def _found_runs(self, found: dict[str, Any]) -> tuple[Array, Array]:
        """Take up the runs that an approximation keeps, and their box."""
        designs, responses = (np.asarray(found[name], dtype=float) for name in ("designs", "responses"))
        if designs.ndim != 2 or designs.shape != (len(responses), self.n_features_in_) or responses.ndim != 1:
            raise ValueError(
                f"designs and responses must be (n, {self.n_features_in_}) and (n,), got {designs.shape} and "
                f"{responses.shape}"
            )
        if not (np.isfinite(designs).all() and np.isfinite(responses).all()):
            raise ValueError("designs and responses must be finite")
        self.box_ = self._box(designs)
        return self._keep(designs, responses)
