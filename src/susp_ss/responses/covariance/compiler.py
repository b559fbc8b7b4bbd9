"""The compiler of the kernels for very many designs: numba, of the extra ``fast``, and where it keeps what it compiled.

Without numba the plain kernels answer, the same to rounding and some times slower.
"""

from __future__ import annotations

import functools
import hashlib
import importlib.util
import os
import sys
import warnings
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import Any

import platformdirs

from ...extras import installation

PACKAGE = __name__.partition(".")[0]


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


@functools.cache
def _announce_compilations() -> None:
    """Have the first compilation of a kernel of ours said on stderr: it takes as long as nothing else here."""
    from numba.core import event

    class Announcer(event.Listener):
        said = False

        def on_start(self, event: Any) -> None:
            if not self.said and str(event.data["dispatcher"].py_func.__module__).startswith(f"{PACKAGE}."):
                self.said = True
                print(f"{PACKAGE}: compiling for this processor, once for all runs: 10 to 60 s", file=sys.stderr)

        def on_end(self, event: Any) -> None:
            """Nothing to say: what follows is quick."""

    event.register("numba:compile", Announcer())


def compiled(**options: Any) -> Callable[[Callable[..., Any]], Any]:
    """``numba.njit`` with its compiled code kept in `cache_folder`; where that cannot be written, nowhere.

    The setting of numba that says where is changed only while it is read: other packages' caches stay where they are.
    """
    import numba

    _announce_compilations()

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
