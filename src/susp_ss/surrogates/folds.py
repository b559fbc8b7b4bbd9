"""Expensive runs in folds, and the surrogates to be fitted to them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import AbstractContextManager, contextmanager
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import ArrayLike, NDArray
from sklearn.base import clone
from sklearn.utils.validation import check_X_y
from threadpoolctl import threadpool_limits

from ..quantities import briefly, whole_number

Array = NDArray[np.float64]

# Up to this many runs each is left out alone; beyond, a tenth of them at a time.
ALONE, FOLDS = 30, 10

# A fold: the rows to fit, and those to predict.
Fold = tuple[NDArray[np.intp], NDArray[np.intp]]


def checked_runs(X: Any, y: ArrayLike) -> tuple[Any, Array]:
    """Designs, an array or the DataFrame that they were, and responses; finite numbers, at least two."""
    designs, responses = check_X_y(X, y, dtype=float, y_numeric=True, ensure_min_samples=2)
    return (X if isinstance(X, pd.DataFrame) else designs), responses.astype(float)


def rows(X: Any, which: NDArray[Any]) -> Any:
    """Some designs of an array or a DataFrame."""
    return X.iloc[which] if isinstance(X, pd.DataFrame) else X[which]


def same_design(X: Any) -> NDArray[np.intp]:
    """A number for each design (n,), the same for equal ones, counted from 0."""
    return np.unique(np.asarray(X, dtype=float), axis=0, return_inverse=True)[1].ravel()


def unfitted(surrogate: Any) -> Any:
    """A copy to be fitted, of the same low-fidelity model, which scikit-learn's `clone` would copy with its tables."""
    if not hasattr(surrogate, "low_fidelity"):
        return clone(surrogate)
    settings = surrogate.get_params(deep=False)
    return type(surrogate)(
        **{name: value if name == "low_fidelity" else clone(value, safe=False) for name, value in settings.items()}
    )


def uses_low_fidelity(surrogate: Any) -> bool:
    """Whether a surrogate, or a step of its pipeline, has a cheap model."""
    return any(name.split("__")[-1] == "low_fidelity" for name in surrogate.get_params())


def split(X: Any, folds: Any, random_state: int | None) -> list[Fold]:
    """Folds of the designs, equal ones in one fold; of one design each by default, or ten beyond 30 runs."""
    from sklearn.model_selection import GroupKFold

    design = same_design(X)
    different = int(design.max()) + 1
    if folds is None:
        folds = different if len(design) <= ALONE else min(FOLDS, different)
    parts = whole_number("folds", folds, 2, different, f"from 2 to the {different} different designs")
    return list(GroupKFold(parts, shuffle=True, random_state=random_state).split(design, groups=design))


@contextmanager
def in_fold(i: int, folds: Sequence[Fold]) -> Iterator[None]:
    """Name the fold, counted from 0, to whose others no fit is possible."""
    fitted, left_out = map(len, folds[i])
    try:
        yield
    except ValueError as error:
        where = f"fold {i + 1} of {len(folds)}, fitted to {fitted} of {fitted + left_out} runs"
        raise ValueError(f"{where}: {error}") from error


def one_blas_thread() -> AbstractContextManager[Any]:
    """Keep linear algebra to one thread while many small problems are solved, one after another.

    More threads gain nothing on matrices of this size, and where something else runs they wait for one another: fits
    that take seconds then take minutes. The limit holds for the whole process meanwhile.
    """
    return threadpool_limits(limits=1, user_api="blas")


def check_mapping(surrogates: Any) -> None:
    """Say when surrogates have no names."""
    if not isinstance(surrogates, Mapping) or not surrogates:
        raise TypeError(f"surrogates must map names to regressors, got {briefly(surrogates)}")
