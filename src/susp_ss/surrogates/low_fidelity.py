"""The cheap model behind a surrogate, as a checked callable."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray


def evaluated(low_fidelity: Callable[..., Any], *arguments: Any) -> NDArray[np.float64]:
    """Return ``low_fidelity(X, ...)`` as one finite number a design, or say what it returned instead.

    Raises
    ------
    TypeError
        ``low_fidelity`` cannot be called.
    ValueError
        It returned another shape, or NaN or inf.
    """
    if not callable(low_fidelity):
        raise TypeError(f"low_fidelity must be a callable of X (n, k) that returns (n,), got {low_fidelity!r}")
    n = len(arguments[0])
    response = np.asarray(low_fidelity(*arguments), dtype=float)
    if response.shape != (n,):
        raise ValueError(f"low_fidelity must return one number for each design, shape {(n,)}, got {response.shape}")
    if not np.isfinite(response).all():
        raise ValueError(f"low_fidelity must return finite numbers, got {response[~np.isfinite(response)][0]}")
    return response
