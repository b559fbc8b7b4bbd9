"""Error against the number of expensive runs, for every surrogate: which to take at one's budget."""

from __future__ import annotations

import itertools
import time
import warnings
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import ArrayLike

from ..progress import tracked
from ..quantities import whole_number
from .accuracy import accuracy
from .folds import check_mapping, checked_runs, one_blas_thread, rows, same_design, unfitted
from .kriging import MANY, CoKriging, Kriging
from .low_fidelity import evaluated
from .regressor import Array, ExtrapolationWarning
from .sampling import sample

BUDGETS = (5, 10, 20, 50, 100, 200, 400)
"""Numbers of expensive runs."""

# Of a file's runs, what may be fitted if the caller does not say; the others test.
FITTED = 0.8

COLUMNS = ["surrogate", "runs", "repeat", "R2", "RMSE", "MAE", "seconds", "refused"]

Runs = tuple[Any, Array]


def learning_curve(
    surrogates: Mapping[str, Any],
    expensive: Callable[[Any], Any],
    box: Mapping[str, Sequence[float]],
    budgets: Sequence[int] = BUDGETS,
    sampling: str = "latin_hypercube",
    repeats: int = 5,
    test: int = 512,
    random_state: int = 0,
    limits: Mapping[str, int] | None = None,
    progress: bool = False,
) -> pd.DataFrame:
    """Fit surrogates to more and more expensive runs that fill a box, and test each at designs of its own.

    Parameters
    ----------
    surrogates : mapping of str to scikit-learn regressor
        Copies are fitted; they share their low-fidelity models.
    expensive : callable
        ``F(X)``, designs (n, k) as an array of floats in the order of ``box`` to responses (n,), such as
        `susp_ss.Response` of a full car.
    box : mapping of str to (low, high)
        Range of each variable, in its own unit.
    budgets : sequence of int
        Numbers of runs to fit.
    sampling : {"latin_hypercube", "sobol"}
        How the fitted designs are spread, see `sample`; all surrogates get the same.
    repeats : int
        Plans of each size, from seeds of their own.
    test : int
        Designs to test at: a Sobol sequence from another seed, the same for all.
    random_state : int
    limits : mapping of str to int, optional
        Most runs to fit a surrogate to, by its name; by default 500 for `Kriging` and `CoKriging`, and none for the
        others.
    progress : bool
        Show progress on stderr.

    Returns
    -------
    DataFrame
        A row for each ``surrogate``, number of ``runs`` and ``repeat``: ``R2``, ``RMSE`` and ``MAE`` (the maximum) at
        the test designs, ``seconds`` of the fit, and ``refused``: why there is no fit, as above a limit, or missing.

    Raises
    ------
    TypeError, ValueError
        Bad arguments, an ``expensive`` that returns no finite (n,), or one whose ``inputs`` are not those of ``box``.

    Examples
    --------
    >>> import numpy as np
    >>> from susp_ss import Polynomial, learning_curve
    >>> surrogates = {"line": Polynomial(1), "cubic": Polynomial(3)}
    >>> table = learning_curve(surrogates, lambda X: np.exp(X[:, 0]), {"x": (0, 1)}, budgets=(3, 30), repeats=1)
    >>> table["RMSE"].round(3).tolist(), table["refused"][1][:50]
    ([0.077, nan, 0.063, 0.0], 'degree 3 in 1 variable(s) has 4 coefficients and n')
    """
    inputs = getattr(expensive, "inputs", None)
    if inputs is not None and list(inputs) != list(box):
        raise ValueError(f"box must have the inputs of expensive in their order, {', '.join(inputs)}, got {list(box)}")
    seed = whole_number("random_state", random_state, 0)

    def run(count: int, method: str, *stream: int) -> Runs:
        X = sample(box, count, method, [seed, *stream])
        return X, evaluated(expensive, X.to_numpy(), name="expensive")

    at = run(whole_number("test", test, 2), "sobol", 0)
    return _curve(surrogates, budgets, repeats, lambda n, i: (run(n, sampling, 1, i), at), limits, progress)


def learning_curve_of_runs(
    surrogates: Mapping[str, Any],
    X: ArrayLike,
    y: ArrayLike,
    budgets: Sequence[int] | None = None,
    repeats: int = 5,
    random_state: int = 0,
    limits: Mapping[str, int] | None = None,
    progress: bool = False,
) -> pd.DataFrame:
    """Fit surrogates to more and more of the expensive runs at hand, and test each at the runs left out.

    Parameters
    ----------
    surrogates : mapping of str to scikit-learn regressor
    X : array_like, (n, k), or DataFrame
        Designs. Runs at a fitted design do not test.
    y : array_like, (n,)
        Responses of the expensive model.
    budgets : sequence of int, optional
        Numbers of runs to fit, drawn at random, those of one design together; by default those of `learning_curve`
        below four fifths of the runs, and these.
    repeats : int
        Draws of each size; within one, the smaller are parts of the larger.
    random_state : int
    limits, progress
        As of `learning_curve`.

    Returns
    -------
    DataFrame
        As of `learning_curve`.

    Raises
    ------
    TypeError, ValueError
        Bad arguments, or a budget that leaves fewer than two designs to test at.

    Examples
    --------
    >>> import numpy as np
    >>> from susp_ss import Polynomial, learning_curve_of_runs
    >>> X = np.linspace(0.0, 1.0, 20)[:, None]
    >>> table = learning_curve_of_runs({"line": Polynomial(1)}, X, 2.0 * X[:, 0], repeats=2)
    >>> table["runs"].tolist(), bool((table["RMSE"] < 1e-12).all())
    ([5, 5, 10, 10, 16, 16], True)
    """
    X, y = checked_runs(X, y)
    design, n, seed = same_design(X), len(y), whole_number("random_state", random_state, 0)
    if budgets is None:
        # A draw may end among the runs of one design, and the others of it are no test.
        most = max(1, min(int(FITTED * n), n - 1 - int(np.bincount(design).max())))
        budgets = [*(runs for runs in BUDGETS if runs < most), most]

    def draw(runs: int, repeat: int) -> tuple[Runs, Runs]:
        order = np.random.default_rng([seed, repeat]).permutation(n)
        drawn = order[np.argsort(pd.factorize(design[order])[0], kind="stable")][:runs]
        left = np.flatnonzero(~np.isin(design, design[drawn]))
        if runs > n or len(left) < 2:
            raise ValueError(f"budgets must leave two or more of the {n} runs to test at, got {runs}")
        return (rows(X, drawn), y[drawn]), (rows(X, left), y[left])

    return _curve(surrogates, budgets, repeats, draw, limits, progress)


def _curve(
    surrogates: Mapping[str, Any],
    budgets: Sequence[int],
    repeats: int,
    draw: Callable[[int, int], tuple[Runs, Runs]],
    limits: Mapping[str, int] | None,
    progress: bool,
) -> pd.DataFrame:
    """The table, where ``draw(runs, repeat)`` gives the runs to fit and those to test at."""
    check_mapping(surrogates)
    most = _most(surrogates, limits)
    counts = [whole_number("budgets", runs, 1) for runs in budgets]
    cases = itertools.product(counts, range(whole_number("repeats", repeats, 1)))
    table = []
    for runs, repeat in tracked(cases, "learning", progress):
        fitted, test = draw(runs, repeat)
        with one_blas_thread():
            for name, surrogate in surrogates.items():
                tried = runs <= most.get(name, runs)
                result = _tried(surrogate, fitted, test) if tried else {"refused": f"not tried above {most[name]} runs"}
                table.append({"surrogate": name, "runs": runs, "repeat": repeat, "refused": None} | result)
    return pd.DataFrame(table, columns=COLUMNS)


def _tried(surrogate: Any, fitted: Runs, test: Runs) -> dict[str, Any]:
    start = time.perf_counter()
    try:
        model = unfitted(surrogate).fit(*fitted)
    except (ValueError, RuntimeError) as error:
        return {"refused": str(error)}
    seconds = time.perf_counter() - start
    with warnings.catch_warnings():
        # A plan seldom reaches the corners of its box.
        warnings.simplefilter("ignore", ExtrapolationWarning)
        predicted = model.predict(test[0])
    return accuracy(test[1], predicted)._asdict() | {"seconds": seconds}


def _most(surrogates: Mapping[str, Any], limits: Mapping[str, int] | None) -> dict[str, int]:
    """Most runs by surrogate, of those that have such a limit."""
    if limits is None:
        return {name: MANY for name, surrogate in surrogates.items() if isinstance(surrogate, Kriging | CoKriging)}
    for name in limits:
        if name not in surrogates:
            raise ValueError(f"limits has no surrogate named {name!r}, available: {', '.join(surrogates)}")
    return {name: whole_number("limits", most, 1) for name, most in limits.items()}
