"""Polynomials in the design variables: by least squares over many runs, or Taylor's about one design."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.special import comb
from sklearn.utils.validation import check_is_fitted, validate_data

from ..quantities import briefly, whole_number
from .by_coefficients import ByCoefficients, without_rows
from .low_fidelity import evaluated
from .regressor import DEPENDENT, Approximation, Array, factors, monomials

# Taylor's steps, as a part of the centre: central differences of second order are then right to about this squared.
STEP = 1e-3


class Polynomial(ByCoefficients, Approximation):
    """Full polynomial of the design variables, by least squares.

    ``S(x) = a0 + sum a_i x^p_i`` over all powers p_i of a total degree from 1 to ``degree``, fitted by
    ``min sum (S - F)^2`` on columns scaled to [-1, 1], and given in physical units (*Feasibility study of surrogate
    model for the application of vehicle suspension system*, 2021, Eqs 1 to 9).

    Parameters
    ----------
    degree : int
        Total degree, at least 1.

    Attributes
    ----------
    intercept_ : float
        a0, in the unit of the response.
    coef_ : ndarray, (m,)
        a1, ..., in the unit of the response over that of their term.
    terms_ : list of str
        What each coefficient multiplies, such as ``ks``, ``ks^2`` and ``ks*cs``; columns without names are x0, x1, ...

    Raises
    ------
    ValueError
        From `fit`: a bad degree, fewer runs than coefficients, or designs that cannot tell the coefficients apart.

    Examples
    --------
    >>> import numpy as np
    >>> from susp_ss import Polynomial
    >>> X = np.array([[0.0], [1.0], [2.0], [4.0]])
    >>> surrogate = Polynomial(degree=2).fit(X, 5.0 - 3.0 * X[:, 0] + 0.5 * X[:, 0] ** 2)
    >>> surrogate.terms_, surrogate.coef_.round(9).tolist()
    (['x0', 'x0^2'], [-3.0, 0.5])
    """

    def __init__(self, degree: int = 2):
        self.degree = degree

    def fit(self, X: ArrayLike, y: ArrayLike) -> Polynomial:
        """Fit the coefficients to the responses y (n,) at the designs X (n, k)."""
        designs, responses = self._runs(X, y)
        self.box_ = self._box(designs)
        return self._expanded(self._solved(self._monomials(designs), responses))

    def _solved(self, columns: Array, responses: Array) -> Array:
        """Coefficients (m,) of least squares on the monomials (n, m)."""
        n, m = columns.shape
        if n < m:
            raise ValueError(
                f"degree {self.degree} in {self.n_features_in_} variable(s) has {m} coefficients and needs at least "
                f"{m} runs, got {n} sample(s)"
            )
        coefficients, _, rank, _ = np.linalg.lstsq(columns, responses, rcond=DEPENDENT)
        if rank < m:
            raise ValueError(
                f"degree {self.degree} has {m} coefficients, of which these designs determine {rank} only; vary every "
                f"column over at least {self.degree + 1} levels, not along a line or a curve, or lower the degree"
            )
        return np.asarray(coefficients, dtype=float)

    @classmethod
    def taylor(
        cls,
        response: Callable[[Any], Any],
        center: ArrayLike,
        degree: int = 2,
        step: ArrayLike | None = None,
    ) -> Polynomial:
        """Taylor's polynomial of a response about one design, by central differences.

        ``S(x) = f(c) + sum_i f_i (x_i - c_i) + 1/2 sum_ij f_ij (x_i - c_i)(x_j - c_j)``: exact at the centre c.

        Parameters
        ----------
        response : callable
            ``f(X)``, designs (n, k) as an array of floats to responses (n,), such as `susp_ss.Response`.
        center : array_like, (k,), or DataFrame of one row
            The design c; a DataFrame names the columns.
        degree : int
            1 or 2.
        step : array_like, (k,), optional
            Steps of the differences, in the variables' units; by default 1e-3 of the centre.

        Returns
        -------
        Polynomial
            Fitted.

        Raises
        ------
        TypeError, ValueError
            A response that is not callable or returns no finite (n,), a degree other than 1 or 2, a centre that is not
            one design, or steps that are not positive.

        Examples
        --------
        >>> from susp_ss import Polynomial
        >>> tangent = Polynomial.taylor(lambda X: X[:, 0] ** 3, center=[2.0], degree=1, step=[1e-4])
        >>> round(tangent.intercept_, 6), tangent.coef_.round(6).tolist()
        (-16.0, [12.0])
        """
        polynomial = cls(degree)
        c = validate_data(polynomial, center if hasattr(center, "columns") else np.atleast_2d(center), dtype=float)
        if len(c) != 1:
            raise ValueError(f"center must be one design, got {len(c)}")
        if isinstance(degree, bool) or degree not in (1, 2):
            raise ValueError(f"degree of a Taylor polynomial must be 1 or 2, got {briefly(degree)}")
        h = STEP * np.abs(c[0]) if step is None else np.asarray(step, dtype=float)
        if h.shape != c[0].shape or not (np.isfinite(h) & (h > 0.0)).all():
            raise ValueError(f"step must be {c.size} number(s) > 0, one a variable, got {h.tolist()}")

        def f(ends: Array) -> Array:
            return evaluated(response, c + ends * h, name="response")

        axes = np.eye(c.size)
        value = f(np.zeros_like(c))
        slopes = (f(axes) - f(-axes)) / 2
        i, j = np.triu_indices(c.size)
        a, b = axes[i], axes[j]
        bends = (f(a + b) - f(a - b) - f(b - a) + f(-a - b)) / np.where(i == j, 8, 4)
        coefficients = np.concatenate([value, slopes, bends] if degree == 2 else [value, slopes])
        # It is about one design: there is no box that it would leave.
        polynomial.lowest_, polynomial.highest_ = np.full_like(c[0], -np.inf), np.full_like(c[0], np.inf)
        polynomial.box_ = polynomial._box(np.concatenate([c - h, c + h]))
        return polynomial._expanded(coefficients)

    def _numbers(self) -> dict[str, Any]:
        return {"box": [self.box_.data_min_, self.box_.data_max_], "coef": self.scaled_coef_}

    def _restore(self, found: dict[str, Any]) -> None:
        self.box_ = self._box(np.asarray(found["box"], dtype=float))
        coefficients, k, degree = np.asarray(found["coef"], dtype=float), self.n_features_in_, self._degree()
        if coefficients.shape != (math.comb(k + degree, k),):
            raise ValueError(f"coef must be {math.comb(k + degree, k)} numbers, got shape {coefficients.shape}")
        self._expanded(coefficients)

    def _coefficients(self) -> Array:
        return self.scaled_coef_

    def _at(self, designs: Array) -> Array:
        return self._monomials(designs) @ self.scaled_coef_

    def _at_each(self, designs: Array, fits: Array) -> Array:
        return self._monomials(designs) @ fits.T

    def _closed(self, folds: Sequence[NDArray[np.intp]]) -> Array | None:
        assert self._fitted_to is not None
        designs, responses = self._fitted_to
        return without_rows(self._monomials(designs), responses, self.scaled_coef_, folds)

    def _fit_to(self) -> Callable[[NDArray[np.intp]], Array]:
        """On the scaled columns of all runs."""
        assert self._fitted_to is not None
        designs, responses = self._fitted_to
        columns = self._monomials(designs)
        return lambda rows: self._solved(columns[rows], responses[rows])

    def formula(self) -> str:
        """Return the polynomial in physical units as text that a spreadsheet or a script can take.

        Examples
        --------
        >>> import pandas as pd
        >>> from susp_ss import Polynomial
        >>> X = pd.DataFrame({"ks": [1.0, 2.0, 4.0]})
        >>> text = Polynomial(degree=1).fit(X, [1.5, 3.5, 7.5]).formula()
        >>> text.count("*ks"), round(eval(text, {"ks": 3.0}), 9)
        (1, 5.5)
        """
        check_is_fitted(self)
        terms = zip(self.coef_.tolist(), self.terms_, strict=True)
        return f"{self.intercept_!r} + " + " + ".join(f"{a!r}*{term}" for a, term in terms)

    def _monomials(self, designs: Array) -> Array:
        """Products (n, m) of powers of the columns, scaled to [-1, 1] over the box of the runs."""
        return monomials(self.box_.transform(designs), self._degree())

    def _degree(self) -> int:
        return whole_number("degree", self.degree, 1)

    def _expanded(self, coefficients: Array) -> Polynomial:
        """Multiply ``b prod (s_i x_i + m_i)^p_i`` out into powers of x."""
        k, box = self.n_features_in_, self.box_
        p = np.array([np.bincount(f, minlength=k) for f in factors(k, self._degree())])
        q = p[:, None]
        binomials = comb(p, q) * box.scale_**q * box.min_ ** np.maximum(p - q, 0)
        self.scaled_coef_ = coefficients
        expanded = binomials.prod(axis=-1) @ coefficients
        self.intercept_, self.coef_ = float(expanded[0]), expanded[1:]
        names = getattr(self, "feature_names_in_", [f"x{i}" for i in range(self.n_features_in_)])
        self.terms_ = [_term(names, term) for term in p[1:]]
        return self


def _term(names: Sequence[str], powers: Array) -> str:
    return "*".join(name if p == 1 else f"{name}^{p}" for name, p in zip(names, powers, strict=True) if p > 0)
