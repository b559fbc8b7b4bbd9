"""Versions of what the numbers depend on."""

from __future__ import annotations

import importlib.metadata
import platform
from contextlib import suppress

_PACKAGES = ("susp_ss", "numpy", "scipy", "xarray", "scikit-learn", "cvxpy", "matplotlib", "plotly")


def versions() -> dict[str, str]:
    """Return versions of Python, of this package and of those that compute and draw for it, where installed.

    Examples
    --------
    >>> from susp_ss.presentation.versions import versions
    >>> list(versions())[:2]
    ['python', 'susp_ss']
    """
    found = {"python": platform.python_version()}
    for name in _PACKAGES:
        with suppress(importlib.metadata.PackageNotFoundError):
            found[name] = importlib.metadata.version(name)
    return found
