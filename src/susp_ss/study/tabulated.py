"""A low-fidelity response remembered at fixed designs, so that a scalar fit need not evaluate it a hundred times."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.polynomial import chebyshev
from numpy.typing import ArrayLike, NDArray

# The responses are analytic in the logarithm of a mass, so that this degree leaves only rounding.
DEGREE = 32


class Tabulated:
    """A `Response` with a parameter, as a Chebyshev interpolant over the parameter's logarithm at given designs.

    At other designs it is the response itself.

    Parameters
    ----------
    response : callable
        ``response(X)`` and ``response(X, values)`` with a ``parameter_value``, such as `susp_ss.Response`.
    X : array_like, (n, k)
        The designs to remember.
    degree : int
        Of the interpolant over 0.2 to 4 times the parameter's own value.

    Examples
    --------
    >>> from susp_ss import QuarterCar, Response, Road
    >>> from susp_ss.study.tabulated import Tabulated
    >>> X = [[18e3, 1500.0], [20e3, 1500.0]]
    >>> response = Response(QuarterCar(), Road(), "dtl", parameter="ms")
    >>> bool(abs(Tabulated(response, X)(X, 250.0) / response(X, 250.0) - 1.0).max() < 1e-12)
    True
    """

    def __init__(self, response: Any, X: ArrayLike, degree: int = DEGREE):
        self.response = response
        self.X = np.asarray(X, dtype=float)
        self.parameter_value: float = response.parameter_value
        self._low, self._high = np.log(0.2 * self.parameter_value), np.log(4.0 * self.parameter_value)
        points = chebyshev.chebpts1(degree + 1)
        values = np.exp(self._low + 0.5 * (points + 1.0) * (self._high - self._low))
        n = len(self.X)
        table = response(np.tile(self.X, (len(values), 1)), np.repeat(values, n)).reshape(-1, n)
        self._coefficients = chebyshev.chebfit(points, table, degree)
        self._own = response(self.X)

    def __call__(self, X: ArrayLike, value: float | None = None) -> NDArray[np.float64]:
        """Responses (n,) at the designs X, with ``value`` for the parameter if one is given."""
        if not np.array_equal(X, self.X):
            return self.response(X, value)
        if value is None:
            return self._own
        position = 2.0 * (np.log(value) - self._low) / (self._high - self._low) - 1.0
        return chebyshev.chebval(position, self._coefficients)
