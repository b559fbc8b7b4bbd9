"""A process beside the server's for what takes seconds, so that it holds up nothing that is live."""

from __future__ import annotations

import multiprocessing
import signal
import time
from collections.abc import Callable
from threading import Lock
from typing import Any, Self

from ..surrogates.folds import one_blas_thread
from .background import background
from .server import left
from .state import Given

LOOK = 0.2
"""Seconds between two looks whether anybody still waits."""

QUICK = 3.0
"""Seconds after which it is quicker to end what nobody waits for, and begin a process anew, than to let it end."""


class Beside:
    """The `background` of states, one after another, while the context is open.

    What nobody waits for any more, for its page has been left or asks for something else, is not begun, or ended.

    Parameters
    ----------
    left : callable
        Whether who asks, in the thread that asks, has left.

    Examples
    --------
    >>> from susp_ss.explorer.beside import Beside
    >>> from susp_ss.explorer.app import application
    >>> beside = Beside()
    >>> app = application(slowly=beside.background)
    """

    def __init__(self, left: Callable[[], bool] = left):
        self._left = left
        self._turn = Lock()

    def __enter__(self) -> Self:
        self._pool = _pool()
        return self

    def __exit__(self, *_: object) -> None:
        self._pool.terminate()

    def background(self, state: Any, given: Given) -> Any:
        """What `background` returns; None for who has left."""
        with self._turn:
            if self._left():
                return None
            begun = time.monotonic()
            answer = self._pool.apply_async(background, (state, Given(given.vehicle, given.road, given.profile)))
            while not answer.ready():
                answer.wait(LOOK)
                if time.monotonic() - begun > QUICK and self._left():
                    self._pool.terminate()
                    self._pool = _pool()
                    return None
            return answer.get()


def _pool() -> Any:
    return multiprocessing.get_context("spawn").Pool(1, _begin)


def _begin() -> None:
    """Ctrl-C is for the server, which ends this process."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    one_blas_thread()
