"""Surrogates that correct the cheap response: scaled (RB), or shifted by a plane in the design variables (VB).

Both are linear in their coefficients, so that the fit is a convex least-squares problem with one solution; the study
calls them nonlinear. Only RB as a power law is not. Columns are centred and scaled and reduced to a triangle before
they reach the solver: spring rates, damping rates and responses span seven orders of magnitude. The solver's path is
that of an interior point, which only nears the coefficients that nonnegativity holds at zero; it shows which those are,
and the others are fitted again without them.
"""

from __future__ import annotations

import functools
import threading
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy import optimize

from ..quantities import briefly
from .by_coefficients import TunedModel, without_rows
from .low_fidelity import evaluated
from .regressor import DEPENDENT, Array

# Of the solver, on a problem scaled to one, the sharpest that it reaches.
TOLERANCES = (1e-12, 1e-11, 1e-10)

# Scaled coefficients below this are held at zero by nonnegativity: the solver brings them to its tolerance over their
# multiplier.
HELD = 1e-9


class _Correction(TunedModel):
    """``S = offset + a0 + columns a``, fitted by least squares."""

    def __init__(
        self,
        low_fidelity: Callable[[Any], Any],
        nonnegative: bool = False,
        terms: Sequence[bool] | None = None,
    ):
        self.low_fidelity = low_fidelity
        self.nonnegative = nonnegative
        self.terms = terms

    def _split(self, X: Array, f: Array) -> tuple[Array, Array, list[str]]:
        """Columns (n, m) of the coefficients a1, ..., the part that needs none (n,), and the columns' names."""
        raise NotImplementedError

    def fit(self, X: ArrayLike, y: ArrayLike) -> Any:
        """Tune the coefficients to the expensive responses y (n,) at the designs X (n, k)."""
        designs, responses = self._runs(X, y)
        if not isinstance(self.nonnegative, bool | np.bool_):
            raise ValueError(f"nonnegative must be True or False, got {briefly(self.nonnegative)}")
        columns, target, keep, names = self._problem(designs, responses)
        coefficients = np.zeros(len(keep))
        coefficients[keep] = least_squares(columns, target, self.nonnegative, names)
        self.intercept_, self.coef_ = float(coefficients[0]), coefficients[1:]
        return self

    def _problem(self, designs: Array, responses: Array) -> tuple[Array, Array, NDArray[np.bool_], list[str]]:
        """Columns (n, m) of the coefficients to fit, their target (n,), which of all they are, and names."""
        columns, offset, names = self._split(designs, evaluated(self.low_fidelity, designs))
        keep = _kept(self.terms, columns.shape[1])
        every = np.column_stack([np.ones(len(designs)), columns])
        return every[:, keep], responses - offset, keep, [name for name, kept in zip(names, keep, strict=True) if kept]

    def _closed(self, folds: Sequence[NDArray[np.intp]]) -> Array | None:
        if self.nonnegative:
            return None
        assert self._fitted_to is not None
        columns, target, keep, _ = self._problem(*self._fitted_to)
        found = without_rows(columns, target, self._coefficients()[keep], folds)
        if found is None:
            return None
        fits = np.zeros((len(folds), len(keep)))
        fits[:, keep] = found
        return fits

    def _numbers(self) -> dict[str, Any]:
        return {"intercept": self.intercept_, "coef": self.coef_}

    def _restore(self, found: dict[str, Any]) -> None:
        self.intercept_, self.coef_ = float(found["intercept"]), np.asarray(found["coef"], dtype=float)

    def _coefficients(self) -> Array:
        return np.append(self.intercept_, self.coef_)

    def _at(self, designs: Array) -> Array:
        columns, offset, _ = self._split(designs, evaluated(self.low_fidelity, designs))
        return offset + self.intercept_ + columns @ self.coef_

    def _at_each(self, designs: Array, fits: Array) -> Array:
        columns, offset, _ = self._split(designs, evaluated(self.low_fidelity, designs))
        return offset[:, None] + fits[:, 0] + columns @ fits[:, 1:].T


class ResponseBased(_Correction):
    """Response-based surrogate (RB): the cheap response, scaled and shifted.

    ``S(x) = a0 + a1 f(x)``, fitted by ``min sum (S - F)^2`` (*Feasibility study of surrogate model for the application
    of vehicle suspension system*, 2021, Eqs 43 and 46). S is linear in a0 and a1, whatever f is, so that the fit is
    convex, though the study calls it nonlinear. The power law ``S(x) = a0 f(x)^a1`` is fitted by the same sum of
    squares, not in logarithms, and from the line that is best in those.

    Parameters
    ----------
    low_fidelity : callable
        ``f(X)``, designs (n, k) as an array of floats to responses (n,), such as `susp_ss.Response`.
    nonnegative : bool
        Keep every coefficient >= 0, a0 included. By default they are free.
    terms : sequence of bool, optional
        Which of (a0, a1) to fit; the others are 0.
    form : {"linear", "power"}
        The power law takes positive responses of both models, and neither ``nonnegative`` nor ``terms``.

    Attributes
    ----------
    intercept_ : float
        a0, in the unit of the response; of the power law, what scales it.
    coef_ : ndarray, (1,)
        a1.

    Raises
    ------
    TypeError, ValueError
        From `fit`: a low-fidelity model that is not callable or returns no finite (n,), bad terms, a response that is
        not positive in a power law, or designs at which the coefficients cannot be told apart; the column is named.
    RuntimeError
        From `fit`: the solver did not reach the optimum.

    Examples
    --------
    >>> import numpy as np
    >>> from susp_ss import ResponseBased
    >>> X = np.array([[1.0], [2.0], [3.0]])
    >>> surrogate = ResponseBased(lambda X: X[:, 0] ** 2).fit(X, 3.0 + 2.0 * X[:, 0] ** 2)
    >>> round(surrogate.intercept_, 9), surrogate.coef_.round(9).tolist()
    (3.0, [2.0])
    """

    def __init__(
        self,
        low_fidelity: Callable[[Any], Any],
        nonnegative: bool = False,
        terms: Sequence[bool] | None = None,
        form: str = "linear",
    ):
        super().__init__(low_fidelity, nonnegative, terms)
        self.form = form

    def fit(self, X: ArrayLike, y: ArrayLike) -> ResponseBased:
        """Tune the coefficients to the expensive responses y (n,) at the designs X (n, k)."""
        if self.form not in ("linear", "power"):
            raise ValueError(f"form must be 'linear' or 'power', got {briefly(self.form)}")
        if self.form == "linear":
            return super().fit(X, y)
        designs, responses = self._runs(X, y)
        if self.nonnegative or self.terms is not None:
            raise ValueError(
                "form='power' takes neither nonnegative nor terms, got "
                f"{briefly(self.nonnegative)} and {briefly(self.terms)}"
            )
        f = _positive("the low-fidelity response", evaluated(self.low_fidelity, designs))
        a0, a1 = power_law(f, _positive("y", responses))
        self.intercept_, self.coef_ = a0, np.array([a1])
        return self

    def _closed(self, folds: Sequence[NDArray[np.intp]]) -> Array | None:
        return super()._closed(folds) if self.form == "linear" else None

    def _fit_to(self) -> Callable[[NDArray[np.intp]], Array]:
        if self.form == "linear":
            return super()._fit_to()
        assert self._fitted_to is not None
        designs, responses = self._fitted_to
        f = evaluated(self.low_fidelity, designs)
        return lambda rows: np.array(power_law(f[rows], responses[rows]))

    def _at(self, designs: Array) -> Array:
        if self.form == "linear":
            return super()._at(designs)
        f = evaluated(self.low_fidelity, designs)
        return self.intercept_ * _positive("the low-fidelity response", f) ** self.coef_[0]

    def _at_each(self, designs: Array, fits: Array) -> Array:
        if self.form == "linear":
            return super()._at_each(designs, fits)
        f = _positive("the low-fidelity response", evaluated(self.low_fidelity, designs))
        return fits[:, 0] * f[:, None] ** fits[:, 1]

    def _split(self, X: Array, f: Array) -> tuple[Array, Array, list[str]]:
        return f[:, None], np.zeros(len(f)), ["a0", "the low-fidelity response"]

    def __sklearn_tags__(self) -> Any:
        tags = super().__sklearn_tags__()
        tags.target_tags.positive_only = self.form == "power"
        return tags


class VariableBased(_Correction):
    """Variable-based surrogate (VB): the cheap response plus a plane in the design variables.

    ``S(x) = f(x) + a0 + sum a_i x_i``, fitted by ``min sum (S - F)^2`` (*Feasibility study of surrogate model for the
    application of vehicle suspension system*, 2021, Eqs 44 and 46). S is linear in the coefficients and the fit
    convex, though the study calls it nonlinear.

    Parameters
    ----------
    low_fidelity : callable
        ``f(X)``, designs (n, k) as an array of floats to responses (n,), such as `susp_ss.Response`.
    nonnegative : bool
        Keep every coefficient >= 0, a0 included. By default they are free.
    terms : sequence of bool, optional
        Which of (a0, a1, ..., ak) to fit; the others are 0.

    Attributes
    ----------
    intercept_ : float
        a0, in the unit of the response.
    coef_ : ndarray, (k,)
        a1, ..., in the unit of the response over that of the variable.

    Raises
    ------
    TypeError, ValueError, RuntimeError
        As in `ResponseBased`.

    Examples
    --------
    >>> import numpy as np
    >>> from susp_ss import VariableBased
    >>> X = np.array([[1.0, 0.0], [2.0, 1.0], [3.0, 5.0], [4.0, 2.0]])
    >>> surrogate = VariableBased(lambda X: X.prod(axis=1), terms=(True, True, False))
    >>> surrogate.fit(X, X.prod(axis=1) + 1.0 - 0.5 * X[:, 0]).coef_.round(9).tolist()
    [-0.5, 0.0]
    """

    def __init__(
        self,
        low_fidelity: Callable[[Any], Any],
        nonnegative: bool = False,
        terms: Sequence[bool] | None = None,
    ):
        super().__init__(low_fidelity, nonnegative, terms)

    def _split(self, X: Array, f: Array) -> tuple[Array, Array, list[str]]:
        return X, f, ["a0", *map(self._place, range(X.shape[1]))]


def least_squares(columns: Array, target: Array, nonnegative: bool, names: Sequence[str]) -> Array:
    """Minimise ``|columns a - target|^2``, with ``a >= 0`` on demand, by cvxpy.

    Parameters
    ----------
    columns : ndarray, (n, m)
    target : ndarray, (n,)
    nonnegative : bool
        Coefficients at zero are then exactly zero.
    names : sequence of str
        Of the columns. A first one named a0 is the intercept, a column of ones: the others are then centred.

    Returns
    -------
    ndarray, (m,)

    Raises
    ------
    ValueError
        Fewer designs than coefficients, or a column that depends on the others.
    RuntimeError
        The solver stopped short of the optimum.
    """
    n, m = columns.shape
    if n < m:
        raise ValueError(f"{m} coefficients need at least {m} designs, got {n} sample(s)")
    T = _conditioner(columns, names)
    Q, R = np.linalg.qr(columns @ T)
    weak = np.abs(np.diag(R)) < DEPENDENT * np.sqrt(n)
    if weak.any():
        raise ValueError(
            f"{names[int(np.argmax(weak))]} is constant or depends on the others, so that its coefficient is "
            "undetermined; vary it, or leave it out with terms"
        )
    unit = np.abs(target).max() or 1.0
    R, q = R / np.sqrt(n), Q.T @ target / (np.sqrt(n) * unit)
    if not nonnegative:
        return unit * (T @ _solved(R, q))
    # The constraint in units of each coefficient's own size.
    size = np.abs(T).max(axis=1)
    positive = (T / size[:, None]) @ _solved(R, q, T / size[:, None]) > HELD
    a = np.zeros(m)
    while positive.any():
        kept = [name for name, is_positive in zip(names, positive, strict=True) if is_positive]
        a[positive] = least_squares(columns[:, positive], target, False, kept)
        if (a >= 0.0).all():
            break
        # So near the corner that the tolerance took it for positive.
        positive[np.argmin(a / size)] = False
        a[:] = 0.0
    return a


def power_law(f: Array, F: Array) -> tuple[float, float]:
    """Minimise ``|a0 f^a1 - F|^2`` over a0 and a1, for positive f and F (n,).

    Raises
    ------
    ValueError
        f is constant.
    RuntimeError
        The solver stopped short of the optimum.
    """
    u, v = np.log(f), np.log(F)
    middle, level = u.mean(), v.mean()
    u -= middle
    if np.ptp(u) < DEPENDENT:
        raise ValueError(
            "the low-fidelity response is constant, so that its exponent is undetermined; vary the designs"
        )
    target = np.exp(v - level)

    def law(b: Array) -> Array:
        return np.exp(b[0] + b[1] * u)

    found = optimize.least_squares(
        lambda b: law(b) - target,
        [0.0, u @ (v - level) / (u @ u)],
        jac=lambda b: law(b)[:, None] * np.column_stack([np.ones_like(u), u]),
        **dict.fromkeys(("xtol", "ftol", "gtol"), 1e-15),
    )
    if not found.success:
        raise RuntimeError(f"the power law was not fitted: {found.message}")
    return float(np.exp(found.x[0] + level - found.x[1] * middle)), float(found.x[1])


def _conditioner(columns: Array, names: Sequence[str]) -> Array:
    """T (m, m) with ``a = T b``, where the columns of b are scaled to one and, beside an intercept, centred."""
    scale = np.abs(columns).max(axis=0)
    T = np.diag(1.0 / np.where(scale > 0.0, scale, 1.0))
    if names[0] == "a0":
        mean = columns[:, 1:].mean(axis=0)
        spread = np.abs(columns[:, 1:] - mean).max(axis=0)
        spread = np.where(spread > DEPENDENT * scale[1:], spread, np.inf)
        T[1:, 1:] = np.diag(1.0 / spread)
        T[0, 1:] = -mean / spread
    return T


def _solved(R: Array, q: Array, nonnegative: Array | None = None) -> Array:
    """The b that minimises ``|R b - q|^2``, where ``nonnegative @ b >= 0``."""
    import cvxpy as cp

    problem, b, given = _compiled(len(q), nonnegative is not None, threading.get_ident())
    for parameter, value in zip(given, (R, q, nonnegative), strict=False):
        parameter.value = value
    said: object = None
    # Rounding may stall the solver just short of the sharpest tolerance; the active set settles what is left.
    for tolerance in TOLERANCES:
        try:
            problem.solve(solver=cp.CLARABEL, **dict.fromkeys(("tol_gap_abs", "tol_gap_rel", "tol_feas"), tolerance))
        except cp.SolverError as error:
            said = error
            continue
        if problem.status == cp.OPTIMAL:
            return np.asarray(b.value)
        said = f"cvxpy reports {problem.status}"
    raise RuntimeError(f"the least-squares problem was not solved: {said}")


@functools.lru_cache
def _compiled(m: int, constrained: bool, thread: int) -> tuple[Any, Any, list[Any]]:
    """The problem in m unknowns, its unknowns and its parameters, compiled once; a thread has its own."""
    import cvxpy as cp

    b, R, q, T = cp.Variable(m), cp.Parameter((m, m)), cp.Parameter(m), cp.Parameter((m, m))
    problem = cp.Problem(cp.Minimize(cp.sum_squares(R @ b - q)), [T @ b >= 0] if constrained else [])
    return problem, b, [R, q, T] if constrained else [R, q]


def _kept(terms: Sequence[bool] | None, columns: int) -> NDArray[np.bool_]:
    if terms is None:
        return np.ones(columns + 1, dtype=bool)
    kept = np.asarray(terms, dtype=object)
    if kept.shape != (columns + 1,) or not all(isinstance(k, bool | np.bool_) for k in kept) or not kept.any():
        raise ValueError(
            f"terms must be {columns + 1} of True or False, one for each of a0 to a{columns} and at least one True, "
            f"got {briefly(terms)}"
        )
    return kept.astype(bool)


def _positive(name: str, response: Array) -> Array:
    if not (response > 0.0).all():
        raise ValueError(f"{name} must be positive for form='power', got {response.min():g}")
    return response
