"""The cheap model behind a surrogate, as a checked callable."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..quantities import briefly


def evaluated(
    low_fidelity: Callable[..., Any],
    X: NDArray[np.float64],
    *value: float | NDArray[np.float64],
    name: str = "low_fidelity",
) -> NDArray[np.float64]:
    """Return ``low_fidelity(X)`` or ``low_fidelity(X, value)`` as one finite number a design.

    The value is one for all designs or one for each. Messages call the callable by the ``name`` of the argument.

    Raises
    ------
    TypeError
        ``low_fidelity`` cannot be called.
    ValueError
        It returned another shape, or something else than finite real numbers.
    """
    check_callable(low_fidelity, name)
    response = np.asarray(low_fidelity(X, *value))
    where = "".join(f" at the parameter's value {v:g}" for v in value if np.ndim(v) == 0)
    if response.shape != (len(X),):
        raise ValueError(
            f"{name} must return one number for each design, shape {(len(X),)}, got {response.shape}{where}"
        )
    if response.dtype.kind not in "iuf":
        raise ValueError(f"{name} must return real numbers, got {response.dtype}{where}")
    if not np.isfinite(response).all():
        raise ValueError(f"{name} must return finite numbers, got {response[~np.isfinite(response)][0]}{where}")
    return response.astype(float)


def check_callable(low_fidelity: Any, name: str = "low_fidelity") -> None:
    """Say when the cheap model cannot be called."""
    if not callable(low_fidelity):
        raise TypeError(f"{name} must be a callable of X (n, k) that returns (n,), got {briefly(low_fidelity)}")
