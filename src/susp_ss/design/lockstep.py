"""Functions that run side by side and ask for values, all questions answered together."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from queue import SimpleQueue
from typing import Any, NamedTuple, TypeVar

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Ask = Callable[[str, Array], Array]
Result = TypeVar("Result")


class _Question(NamedTuple):
    asker: int
    kind: str
    u: Array
    reply: Future[Array]


def in_lockstep(
    tasks: Sequence[Callable[[Ask], Result]], answers: Mapping[str, Callable[[Array], Array]]
) -> list[Result]:
    """What tasks return that are each given ``ask(kind, u)``, ``u`` (k,) being a row of what ``answers[kind]`` takes.

    Each task is a thread of its own, so that it may be any library's. Nothing is answered before every task that has
    not ended asks; then the first kind of ``answers`` that anyone asks for is answered for all who ask for it, in one
    call of the caller's thread, in the order of tasks. So results depend on no thread's pace.

    Raises
    ------
    Exception
        What a task or an answer raises, when all tasks have ended.

    Examples
    --------
    Two roots by Newton's method, with both values, and then both slopes, in one call:

    >>> from scipy.optimize import newton
    >>> from susp_ss.design.lockstep import in_lockstep
    >>> def root_from(x):
    ...     return lambda ask: newton(lambda x: ask("values", x), x, lambda x: ask("slopes", x))
    >>> tasks = [root_from(x) for x in (1.0, -3.0)]
    >>> in_lockstep(tasks, {"values": lambda x: x**2 - 4.0, "slopes": lambda x: 2.0 * x})
    [np.float64(2.0), np.float64(-2.0)]
    """
    said: SimpleQueue[_Question | None] = SimpleQueue()

    def run(asker: int, task: Callable[[Ask], Result]) -> Result:
        def ask(kind: str, u: Array) -> Array:
            reply: Future[Array] = Future()
            said.put(_Question(asker, kind, u, reply))
            return reply.result()

        try:
            return task(ask)
        finally:
            said.put(None)

    with ThreadPoolExecutor(max(1, len(tasks))) as pool:
        results = [pool.submit(run, asker, task) for asker, task in enumerate(tasks)]
        waiting: list[_Question] = []
        living = len(tasks)
        try:
            while living:
                while len(waiting) < living:
                    question = said.get()
                    if question is None:
                        living -= 1
                    else:
                        waiting.append(question)
                _answer_first_kind(waiting, answers)
                waiting = [question for question in waiting if not question.reply.done()]
        except BaseException as error:
            # No thread is left waiting.
            _refuse(waiting, error)
            while living:
                question = said.get()
                if question is None:
                    living -= 1
                else:
                    _refuse([question], error)
            raise
    return [result.result() for result in results]


def _answer_first_kind(waiting: Sequence[_Question], answers: Mapping[str, Callable[[Array], Array]]) -> None:
    for kind, compute in answers.items():
        asked = sorted((question for question in waiting if question.kind == kind), key=lambda question: question.asker)
        if asked:
            found = compute(np.stack([question.u for question in asked]))
            for question, answer in zip(asked, found, strict=True):
                question.reply.set_result(answer)
            return


def _refuse(questions: Sequence[Any], error: BaseException) -> None:
    for question in questions:
        if not question.reply.done():
            question.reply.set_exception(error)
