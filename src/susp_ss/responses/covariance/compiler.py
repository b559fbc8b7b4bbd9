"""The compiler of the kernels for very many designs: numba, of the extra ``fast``, and where it keeps what it compiled.

Without numba the plain kernels answer, the same to rounding and some times slower.
"""

from __future__ import annotations

import functools
import hashlib
import importlib.util
import os
import warnings
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import Any

import platformdirs

from ...extras import installation


def compiler_found() -> bool:
    """Whether numba is installed; without it, say how to be faster.

    Warns
    -----
    UserWarning
        It is not.
    """
    found = importlib.util.find_spec("numba") is not None
    if not found:
        warnings.warn(
            f"so many designs take a few times as long without numba; run {installation('fast')}", stacklevel=3
        )
    return found


def compiled(**options: Any) -> Callable[[Callable[..., Any]], Any]:
    """``numba.njit`` with its compiled code kept in `cache_folder`; where that cannot be written, nowhere.

    The setting of numba that says where is changed only while it is read: other packages' caches stay where they are.
    """
    import numba

    def decorate(function: Callable[..., Any]) -> Any:
        dispatcher = numba.njit(nogil=True, **options)(function)
        before, folder = numba.config.CACHE_DIR, cache_folder()
        with suppress(OSError):
            folder.mkdir(parents=True, exist_ok=True)
        if os.access(folder, os.W_OK):
            numba.config.CACHE_DIR = str(folder)
            try:
                dispatcher.enable_caching()
            finally:
                numba.config.CACHE_DIR = before
        return dispatcher

    return decorate


def cache_folder() -> Path:
    """Where compiled code is kept: in ``NUMBA_CACHE_DIR`` or else in the user's cache, never beside the package.

    Each state of the sources has a folder of its own, for numba does not see when a kernel that another file's is
    compiled into has changed.

    Examples
    --------
    >>> from susp_ss.responses.covariance.compiler import cache_folder
    >>> cache_folder().parent.name
    'susp_ss'
    """
    home = None
    with suppress(ModuleNotFoundError):
        import numba

        home = numba.config.CACHE_DIR
    root = Path(home, "susp_ss") if home else platformdirs.user_cache_path("susp_ss", appauthor=False)
    return root / _sources()


@functools.cache
def _sources() -> str:
    digest = hashlib.sha256()
    for path in sorted(Path(__file__).parent.glob("*.py")):
        digest.update(path.read_bytes())
    return digest.hexdigest()[:12]
