"""The surrogate that tunes a physical parameter of the cheap model."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.optimize import minimize_scalar
from sklearn.base import BaseEstimator, RegressorMixin
from sklearn.utils.validation import check_is_fitted, validate_data

from .low_fidelity import evaluated

# The sum of squares is scanned at this many values; a valley between two neighbours could hide from it.
SCAN = 65


class ParameterBased(RegressorMixin, BaseEstimator):
    """Parameter-based surrogate (PB): the cheap model with one of its own parameters tuned.

    ``S(x) = f(x; a)`` with a by ``min sum (S - F)^2`` (*Feasibility study of surrogate model for the application of
    vehicle suspension system*, 2021, Eqs 45 and 46; its parameter is the sprung mass). The sum of squares may have
    several minima: it is scanned over the bounds on 65 values in geometric steps, every valley of the scan is refined
    by Brent's method, and the lowest is taken. That is the global minimum unless a valley is narrower than the scan's
    steps.

    Parameters
    ----------
    low_fidelity : callable
        ``f(X, value)``, designs (n, k) and one parameter value to responses (n,), such as
        ``susp_ss.Response(..., parameter="ms")``.
    bounds : (float, float), optional
        Lowest and highest value, > 0, in the parameter's unit; by default 0.2 and 4 times
        ``low_fidelity.parameter_value``, the model's own.

    Attributes
    ----------
    parameter_ : float
        The tuned value.
    at_bound_ : {None, "lower", "upper"}
        Whether it sits on a bound, which is also warned of: the minimum may lie beyond.

    Raises
    ------
    TypeError, ValueError
        A low-fidelity model that is not callable or returns no finite (n,), or bounds that are missing or bad.

    Examples
    --------
    >>> import numpy as np
    >>> from susp_ss import ParameterBased
    >>> X = np.array([[1.0], [2.0], [3.0]])
    >>> surrogate = ParameterBased(lambda X, a: np.sin(a * X[:, 0]), bounds=(0.1, 3.0)).fit(X, np.sin(0.7 * X[:, 0]))
    >>> round(surrogate.parameter_, 9)
    0.7
    """

    def __init__(self, low_fidelity: Callable[[Any, float], Any], bounds: Sequence[float] | None = None):
        self.low_fidelity = low_fidelity
        self.bounds = bounds

    def fit(self, X: ArrayLike, y: ArrayLike) -> ParameterBased:
        """Tune the parameter to the expensive responses y (n,) at the designs X (n, k)."""
        designs, responses = validate_data(self, X, y, y_numeric=True, dtype=float, ensure_min_samples=2)
        low, high = self._bounds()
        unit = np.abs(responses).max() or 1.0

        def squares(log_value: float) -> float:
            deviation = (evaluated(self.low_fidelity, designs, float(np.exp(log_value))) - responses) / unit
            return float(deviation @ deviation)

        grid = np.linspace(np.log(low), np.log(high), SCAN)
        scanned = np.array([squares(u) for u in grid])
        best, least = grid[np.argmin(scanned)], scanned.min()
        for i in _valleys(scanned):
            bracket = (grid[max(i - 1, 0)], grid[min(i + 1, SCAN - 1)])
            found = minimize_scalar(squares, bounds=bracket, method="bounded", options={"xatol": 1e-12})
            if found.fun < least:
                best, least = found.x, found.fun
        self.parameter_ = float(np.exp(self._polished(best, designs, responses, low, high)))
        # A bounded search never lands on its bound exactly.
        reach = 1e-6 * np.log(high / low)
        at_low, at_high = np.log(self.parameter_ / low) < reach, np.log(high / self.parameter_) < reach
        self.at_bound_ = "lower" if at_low else "upper" if at_high else None
        if self.at_bound_ is not None:
            self.parameter_ = low if at_low else high
            warnings.warn(
                f"the tuned parameter {self.parameter_:g} sits on its {self.at_bound_} bound of [{low:g}, {high:g}]: "
                "the minimum may lie beyond; pass wider bounds",
                UserWarning,
                stacklevel=2,
            )
        return self

    def _polished(self, u: float, X: NDArray[np.float64], y: NDArray[np.float64], low: float, high: float) -> float:
        """Gauss-Newton from a minimum of squares, whose flat bottom hides half the digits, while it improves."""
        h = 1e-4
        for _ in range(8):
            if not np.log(low) < u - h < u + h < np.log(high):
                return u
            minus, here, plus = (evaluated(self.low_fidelity, X, float(np.exp(v))) for v in (u - h, u, u + h))
            slope, bend = (plus - minus) / (2 * h), (plus - 2 * here + minus) / h**2
            gradient = slope @ (here - y)
            curvature = slope @ slope + bend @ (here - y)
            if curvature <= 0.0 or abs(gradient / curvature) > 1e-3:
                return u
            u = float(u - gradient / curvature)
            if abs(gradient / curvature) < 1e-13:
                break
        return u

    def predict(self, X: ArrayLike) -> NDArray[np.float64]:
        """Return the cheap response (n,) at the designs X (n, k) with the tuned parameter."""
        check_is_fitted(self)
        designs = validate_data(self, X, reset=False, dtype=float)
        return evaluated(self.low_fidelity, designs, self.parameter_)

    def _bounds(self) -> tuple[float, float]:
        if self.bounds is None:
            own = getattr(self.low_fidelity, "parameter_value", None)
            if own is None:
                raise ValueError(
                    "bounds are needed for a low_fidelity without a parameter_value of its own; pass bounds=(low, high)"
                )
            return 0.2 * own, 4.0 * own
        values = np.asarray(self.bounds)
        if values.dtype.kind not in "iuf" or values.shape != (2,) or not np.isfinite(values).all():
            raise ValueError(f"bounds must be two finite numbers (low, high), got {self.bounds!r}")
        low, high = map(float, values)
        if not 0.0 < low < high:
            raise ValueError(f"bounds must rise from above 0, got {self.bounds!r}")
        return low, high

    def __sklearn_tags__(self) -> Any:
        tags = super().__sklearn_tags__()
        # How well it scores is up to the cheap model.
        tags.regressor_tags.poor_score = True
        return tags


def _valleys(values: NDArray[np.float64]) -> NDArray[np.int_]:
    """Indices no higher than their neighbours, ends included."""
    left = np.concatenate([[np.inf], values[:-1]])
    right = np.concatenate([values[1:], [np.inf]])
    return np.flatnonzero((values <= left) & (values <= right))
