"""The surrogate that tunes a physical parameter of the cheap model."""

from __future__ import annotations

import math
import warnings
from collections.abc import Callable, Sequence
from numbers import Real
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.optimize import minimize_scalar
from sklearn.utils import gen_batches

from ..quantities import briefly
from .by_coefficients import TunedModel
from .low_fidelity import check_callable, evaluated
from .regressor import Array

# The sum of squares is scanned at this many values; a valley between two neighbours could hide from it.
SCAN = 65

GRID = np.linspace(0.0, 1.0, SCAN).tolist()

# Designs of the cheap model in one call.
TOGETHER = 50_000

# Sums of squares that vary less than this vary by rounding alone.
INERT = 1e-10

# Of the range: a minimum nearer to a bound is at it, and Newton's last step is no longer.
BESIDE, LAST = 1e-9, 1e-8


class ParameterBased(TunedModel):
    """Parameter-based surrogate (PB): the cheap model with one of its own parameters tuned.

    ``S(x) = f(x; a)`` with a by ``min sum (S - F)^2`` (*Feasibility study of surrogate model for the application of
    vehicle suspension system*, 2021, Eqs 45 and 46; its parameter is the sprung mass). The sum of squares may have
    several minima: it is scanned over the bounds on 65 values, every valley of the scan is refined by Newton's steps,
    or Brent's method where these do not arrive, and the lowest is taken. That is the global minimum unless it hides in
    a valley narrower than two of the scan's steps, which are geometric for a positive range (4.8 % for the default
    bounds) and equal otherwise.

    Parameters
    ----------
    low_fidelity : callable
        ``f(X, value)``, designs (n, k) as an array of floats and one parameter value to responses (n,), such as
        ``susp_ss.Response(..., parameter="ms")``. One whose attribute ``value_per_design`` is True is also given a
        value for each design, (n,).
    bounds : (float, float), optional
        Lowest and highest value, in the parameter's unit; by default 0.2 and 4 times
        ``low_fidelity.parameter_value``, the model's own.

    Attributes
    ----------
    parameter_ : float
        The tuned value, in its own unit.
    at_bound_ : {None, "lower", "upper"}
        Whether it sits on a bound, which is also warned of: the minimum may lie beyond.

    Raises
    ------
    TypeError, ValueError
        From `fit`: a low-fidelity model that is not callable, returns no finite (n,) or does not depend on its
        parameter, or bounds that are missing or bad.

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
        designs, responses = self._runs(X, y)
        check_callable(self.low_fidelity)
        self.parameter_, self.at_bound_ = self._tuned(designs, responses, self._at_fractions(designs, GRID))
        if self.at_bound_ is not None:
            low, high = self._bounds()
            warnings.warn(
                f"the tuned parameter {self.parameter_:g} sits on its {self.at_bound_} bound of [{low:g}, {high:g}]: "
                "the minimum may lie beyond; pass wider bounds",
                UserWarning,
                stacklevel=2,
            )
        return self

    def _tuned(self, designs: Array, responses: Array, on_grid: Array) -> tuple[float, str | None]:
        """The parameter, and the bound that it sits on, if any; from the cheap responses (SCAN, n) on the scan."""
        low, high = self._bounds()
        unit = np.abs(responses).max() or 1.0

        def deviations(*u: float) -> Array:
            """Of the cheap model from the expensive one, a row a fraction."""
            return (self._at_fractions(designs, u) - responses) / unit

        scanned = (((on_grid - responses) / unit) ** 2).sum(axis=1)
        if np.ptp(scanned) <= INERT * scanned.max():
            raise ValueError(
                f"low_fidelity must depend on its second argument, got one sum of squares for all values from {low:g} "
                f"to {high:g}"
            )
        best, least = GRID[np.argmin(scanned)], scanned.min()
        for i in _valleys(scanned):
            u = _bottom(deviations, *(GRID[min(max(j, 0), SCAN - 1)] for j in (i - 1, i, i + 1)))
            lowest = (deviations(u) ** 2).sum()
            if lowest <= (1.0 + INERT) * least:
                best, least = u, min(lowest, least)
        at_bound = {0.0: "lower", 1.0: "upper"}.get(best)
        return {"lower": low, "upper": high, None: _value(best, low, high)}[at_bound], at_bound

    def _at_fractions(self, designs: Array, fractions: Sequence[float]) -> Array:
        """The cheap responses (u, n) at fractions of the parameter's range."""
        bounds = self._bounds()
        return _at_values(self.low_fidelity, designs, [_value(u, *bounds) for u in fractions])

    def _fit_to(self) -> Callable[[NDArray[np.intp]], Array]:
        """From one scan of all runs."""
        assert self._fitted_to is not None
        designs, responses = self._fitted_to
        on_grid = self._at_fractions(designs, GRID)
        return lambda rows: np.array([self._tuned(designs[rows], responses[rows], on_grid[:, rows])[0]])

    def _numbers(self) -> dict[str, Any]:
        return {"parameter": self.parameter_, "at_bound": self.at_bound_}

    def _restore(self, found: dict[str, Any]) -> None:
        self.parameter_, self.at_bound_ = float(found["parameter"]), found["at_bound"]

    def _coefficients(self) -> Array:
        return np.array([self.parameter_])

    def _at(self, designs: Array) -> Array:
        return evaluated(self.low_fidelity, designs, self.parameter_)

    def _at_each(self, designs: Array, fits: Array) -> Array:
        return _at_values(self.low_fidelity, designs, fits[:, 0].tolist()).T

    def _bounds(self) -> tuple[float, float]:
        if self.bounds is None:
            own = getattr(self.low_fidelity, "parameter_value", None)
            if own is None:
                raise ValueError(
                    "bounds are needed for a low_fidelity without a parameter_value of its own; pass bounds=(low, high)"
                )
            if not _is_number(own) or own <= 0.0:
                raise ValueError(
                    "bounds are needed for a low_fidelity whose parameter_value is not a number > 0, got "
                    f"{own!r}; pass bounds=(low, high)"
                )
            return 0.2 * float(own), 4.0 * float(own)
        values = np.asarray(self.bounds, dtype=object)
        if values.shape != (2,) or not all(_is_number(value) for value in values):
            raise ValueError(f"bounds must be two finite numbers (low, high), got {briefly(self.bounds)}")
        low, high = map(float, values)
        if not low < high:
            raise ValueError(f"bounds must rise from low to high, got {briefly(self.bounds)}")
        return low, high


def _at_values(low_fidelity: Any, designs: Array, values: list[float]) -> Array:
    """The cheap responses (values, n): in one call, where the model takes a value for each design."""
    if not getattr(low_fidelity, "value_per_design", False):
        return np.array([evaluated(low_fidelity, designs, value) for value in values])
    n = len(designs)
    rows = []
    for some in gen_batches(len(values), max(1, TOGETHER // n)):
        each = np.repeat(values[some], n)
        rows.append(evaluated(low_fidelity, np.tile(designs, (len(each) // n, 1)), each).reshape(-1, n))
    return np.concatenate(rows)


def _is_number(value: Any) -> bool:
    return isinstance(value, Real) and not isinstance(value, bool) and math.isfinite(value)


def _value(u: float, low: float, high: float) -> float:
    """The parameter at the fraction u of its range."""
    return min(low * (high / low) ** u if low > 0.0 else low + u * (high - low), high)


def _valleys(values: Array) -> NDArray[np.int_]:
    """Indices no higher than their neighbours, ends included; of a level stretch, the last."""
    left = np.concatenate([[np.inf], values[:-1]])
    right = np.concatenate([values[1:], [np.inf]])
    return np.flatnonzero((values <= left) & (values < right))


def _bottom(deviations: Callable[..., Array], low: float, at: float, high: float) -> float:
    """Where the squares are least between low and high, as they are at one of the scan's values.

    By Newton's steps, or Brent's method where these do not arrive; Newton's come last, as the flat bottom of the
    squares hides half the digits of u.
    """

    def squares(u: float) -> float:
        return float((deviations(u) ** 2).sum())

    if at in (low, high) and squares(abs(at - BESIDE)) > squares(at):
        return at
    u = _newton(deviations, (low + high) / 2, low, high)
    if u is None:
        found = float(minimize_scalar(squares, bounds=(low, high), method="bounded", options={"xatol": BESIDE}).x)
        u = _newton(deviations, found, low, high)
    return found if u is None else u


def _newton(deviations: Callable[..., Array], u: float, low: float, high: float) -> float | None:
    """Newton's steps on the squares from u to where they settle, if they do and stay between low and high."""
    for _ in range(8):
        h = min(3e-4, u / 2, (1.0 - u) / 2)
        left2, left, here, right, right2 = deviations(*(u + k * h for k in (-2, -1, 0, 1, 2)))
        slope = (left2 - 8 * left + 8 * right - right2) / (12 * h)
        bend = (left - 2 * here + right) / h**2
        gradient, curvature = float(slope @ here), float(slope @ slope + bend @ here)
        if not curvature > 0.0 or not low < u - gradient / curvature < high:
            return None
        u -= gradient / curvature
        if abs(gradient) < LAST * curvature:
            return u
    return None
