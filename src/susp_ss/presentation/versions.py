"""Versions of what the numbers depend on."""

from __future__ import annotations

import importlib.metadata
import platform

_PACKAGES = ("susp_ss", "numpy", "scipy", "xarray", "scikit-learn", "smt", "cvxpy", "matplotlib", "plotly")


def versions() -> dict[str, str]:
    """Return versions of Python, of this package and of those that compute and draw for it.

    Examples
    --------
    >>> from susp_ss.presentation.versions import versions
    >>> list(versions())[:2]
    ['python', 'susp_ss']
    """
    return {"python": platform.python_version(), **{name: importlib.metadata.version(name) for name in _PACKAGES}}
