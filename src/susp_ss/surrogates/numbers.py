"""A fitted surrogate as plain numbers and back, for files that need no pickle."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
from sklearn.utils.validation import check_is_fitted

from ..quantities import briefly
from .correction import ResponseBased, VariableBased
from .kriging import CoKriging, Kriging
from .parameter import ParameterBased
from .polynomial import Polynomial
from .radial_basis import RadialBasis
from .regressor import Surrogate

KINDS: dict[str, type[Surrogate]] = {
    kind.__name__: kind
    for kind in (ResponseBased, VariableBased, ParameterBased, Polynomial, RadialBasis, Kriging, CoKriging)
}


def to_numbers(surrogate: Surrogate) -> dict[str, Any]:
    """Everything about a fitted surrogate but its low-fidelity model, as numbers, text, lists and dictionaries.

    Parameters
    ----------
    surrogate : Surrogate
        Fitted.

    Returns
    -------
    dict
        ``kind``, ``settings`` (the arguments of the class), ``columns`` (names, or null), ``box`` (lowest and highest
        value of each column; null where there is no end), ``found`` (what the fit found) and, for intervals,
        ``left_out`` (what its fits without some runs found; null if there are none, as of approximations of more than
        300 runs).

    Raises
    ------
    TypeError
        A setting that is no plain value, such as a ``random_state`` that is a generator.
    sklearn.exceptions.NotFittedError

    Examples
    --------
    >>> from susp_ss import Polynomial
    >>> from susp_ss.surrogates.numbers import from_numbers, to_numbers
    >>> numbers = to_numbers(Polynomial(degree=1).fit([[0.0], [2.0]], [1.0, 5.0]))
    >>> numbers["kind"], numbers["box"]
    ('Polynomial', [[0.0], [2.0]])
    >>> from_numbers(numbers).predict([[1.0]]).round(9).tolist()
    [3.0]
    """
    check_is_fitted(surrogate)
    names = getattr(surrogate, "feature_names_in_", None)
    return {
        "kind": type(surrogate).__name__,
        "settings": {
            name: _plain(name, value)
            for name, value in surrogate.get_params(deep=False).items()
            if name != "low_fidelity"
        },
        "columns": None if names is None else list(names),
        "box": [
            [end if np.isfinite(end) else None for end in ends.tolist()]
            for ends in (surrogate.lowest_, surrogate.highest_)
        ],
        "found": {name: _plain(name, value) for name, value in surrogate._numbers().items()},
        "left_out": _left_out(surrogate),
    }


def from_numbers(numbers: Mapping[str, Any], low_fidelity: Callable[..., Any] | None = None) -> Any:
    """Make the surrogate again that `to_numbers` took apart; it predicts the same.

    Parameters
    ----------
    numbers : mapping
    low_fidelity : callable, optional
        The cheap model, for a kind that has one.

    Returns
    -------
    Surrogate
        Fitted.

    Raises
    ------
    KeyError, TypeError, ValueError
        Numbers that `to_numbers` did not make.
    """
    if numbers["kind"] not in KINDS:
        raise ValueError(f"no surrogate named {numbers['kind']!r}, available: {', '.join(KINDS)}")
    kind = KINDS[numbers["kind"]]

    model = {"low_fidelity": low_fidelity} if "low_fidelity" in inspect.signature(kind).parameters else {}
    surrogate = kind(**model, **numbers["settings"])
    lowest, highest = numbers["box"]
    surrogate.lowest_ = np.array([-np.inf if end is None else end for end in lowest], dtype=float)
    surrogate.highest_ = np.array([np.inf if end is None else end for end in highest], dtype=float)
    surrogate.n_features_in_ = len(lowest)
    if numbers["columns"] is not None:
        surrogate.feature_names_in_ = np.array(numbers["columns"], dtype=object)
    surrogate._restore(numbers["found"])
    # Older files may have none.
    if numbers.get("left_out") is not None:
        surrogate._restore_without(numbers["left_out"])
    return surrogate


def _left_out(surrogate: Surrogate) -> dict[str, Any] | None:
    try:
        found = surrogate._numbers_without()
    except (ValueError, RuntimeError):
        return None
    return {name: _plain(name, value) for name, value in found.items()}


def _plain(name: str, value: Any) -> Any:
    if isinstance(value, np.generic):
        return value.item()
    if isinstance(value, np.ndarray):
        return value.tolist()
    if isinstance(value, dict):
        return {key: _plain(key, part) for key, part in value.items()}
    if isinstance(value, (list, tuple)):
        return [_plain(name, part) for part in value]
    if value is None or isinstance(value, (bool, int, float, str)):
        return value
    raise TypeError(f"{name} must be a plain value to be saved, got {briefly(value)}")
