"""How far long work has come, on stderr: a bar on a terminal, and off it a line every ten seconds."""

from __future__ import annotations

import sys
import time
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from typing import Any

# Seconds between lines where nobody watches a bar.
EVERY = 10.0


class Progress:
    """Steps of one piece of work; `advance` counts them."""

    def __init__(self, what: str, total: int, done: int = 0):
        self.what, self.total, self.done = what, total, done
        self._said = time.monotonic()

    def advance(self) -> None:
        """One step is done."""
        self.done += 1
        if time.monotonic() - self._said >= EVERY:
            self._said = time.monotonic()
            print(f"{self.what}: {self.done} of {self.total}", file=sys.stderr, flush=True)


class _Bar(Progress):
    def __init__(self, bar: Any, what: str, total: int, done: int):
        super().__init__(what, total, done)
        self._bar, self._task = bar, bar.add_task(what, total=total, completed=done)

    def advance(self) -> None:
        self._bar.advance(self._task)


class _Silent(Progress):
    def advance(self) -> None:
        pass


@contextmanager
def progress(what: str, total: int, done: int = 0, wanted: bool = True) -> Iterator[Progress]:
    """Show the progress of work of so many steps, some of them done before.

    Examples
    --------
    >>> from susp_ss.progress import progress
    >>> with progress("sweeping", total=3) as shown:
    ...     shown.advance()
    """
    if not wanted:
        yield _Silent(what, total, done)
        return
    from rich.console import Console
    from rich.progress import MofNCompleteColumn
    from rich.progress import Progress as Bars

    console = Console(stderr=True)
    if not console.is_terminal:
        yield Progress(what, total, done)
    else:
        with Bars(*Bars.get_default_columns(), MofNCompleteColumn(), console=console, transient=True) as bars:
            yield _Bar(bars, what, total, done)


def tracked(cases: Iterable[Any], what: str, wanted: bool = True) -> Iterator[Any]:
    """The cases, with their progress.

    Examples
    --------
    >>> from susp_ss.progress import tracked
    >>> list(tracked("abc", "comparing"))
    ['a', 'b', 'c']
    """
    every = list(cases)
    with progress(what, len(every), wanted=wanted) as shown:
        for case in every:
            yield case
            shown.advance()
