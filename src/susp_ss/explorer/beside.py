"""A process beside the server's for what takes seconds, so that it holds up nothing that is live."""

from __future__ import annotations

import multiprocessing
import signal
from typing import Any, Self

from ..surrogates.folds import one_blas_thread
from .background import background
from .state import Given


class Beside:
    """The `background` of states, one after another, while the context is open.

    Examples
    --------
    >>> from susp_ss.explorer.beside import Beside
    >>> from susp_ss.explorer.app import application
    >>> beside = Beside()
    >>> app = application(slowly=beside.background)
    """

    def __enter__(self) -> Self:
        self._pool = multiprocessing.get_context("spawn").Pool(1, _begin)
        return self

    def __exit__(self, *_: object) -> None:
        self._pool.terminate()

    def background(self, state: Any, given: Given) -> Any:
        """What `background` returns."""
        return self._pool.apply(background, (state, Given(given.vehicle, given.road, given.profile)))


def _begin() -> None:
    """Ctrl-C is for the server, which ends this process."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    one_blas_thread()
