"""How well a surrogate reproduces an expensive model: the three figures of the study."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from ..quantities import briefly


class Accuracy(NamedTuple):
    """R2, RMSE and MAE of a surrogate; the MAE is the MAXIMUM absolute error, as in the study."""

    R2: float
    RMSE: float
    MAE: float


def accuracy(y_true: ArrayLike, y_pred: ArrayLike) -> Accuracy:
    """Compare a surrogate with the expensive model at the same designs.

    ``R2 = 1 - sum (S - F)^2 / sum (F - mean F)^2``, ``RMSE = sqrt(mean (S - F)^2)`` and ``MAE = max |S - F|``
    (*Feasibility study of surrogate model for the application of vehicle suspension system*, 2021, Eqs 47 to 49).

    Parameters
    ----------
    y_true, y_pred : array_like, (n,)
        Responses F of the expensive model and S of the surrogate, in one unit; at least two designs.

    Returns
    -------
    Accuracy
        ``R2``, and ``RMSE`` and ``MAE`` in the unit of the responses.

    Raises
    ------
    ValueError
        Different or wrong shapes, fewer than two designs, NaN or inf.

    Examples
    --------
    >>> from susp_ss import accuracy
    >>> accuracy([1.0, 2.0, 3.0], [1.0, 2.0, 4.0])
    Accuracy(R2=0.5, RMSE=0.5773502691896257, MAE=1.0)
    """
    from sklearn.metrics import max_error, r2_score, root_mean_squared_error

    true, predicted = (_responses(name, y) for name, y in (("y_true", y_true), ("y_pred", y_pred)))
    if true.shape != predicted.shape:
        raise ValueError(f"y_true and y_pred must have one length, got {len(true)} and {len(predicted)}")
    return Accuracy(
        float(r2_score(true, predicted)),
        float(root_mean_squared_error(true, predicted)),
        float(max_error(true, predicted)),
    )


def _responses(name: str, y: ArrayLike) -> np.ndarray:
    values = np.asarray(y)
    if values.dtype.kind not in "iuf":
        raise ValueError(f"{name} must be numbers, got {briefly(y)}")
    if values.ndim != 1 or len(values) < 2:
        raise ValueError(f"{name} must be one row of at least two responses, got shape {values.shape}")
    if not np.isfinite(values).all():
        raise ValueError(f"{name} must be finite, got NaN or inf")
    return values.astype(float)
