"""Tasks in lockstep: what they find alone, in one call for all who ask, whatever the pace of their threads."""

import threading

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import newton

from susp_ss.design.lockstep import in_lockstep


def root_of(square, ask):
    return newton(lambda x: ask("values", np.array([x, square]))[0], 3.0, lambda x: ask("slopes", np.array([x]))[0])


def answers(calls):
    def values(U):
        calls.append(("values", len(U)))
        return U[:, :1] ** 2 - U[:, 1:]

    def slopes(U):
        calls.append(("slopes", len(U)))
        return 2.0 * U

    return {"values": values, "slopes": slopes}


@settings(max_examples=8)
@given(st.lists(st.floats(0.5, 30.0), max_size=6))
def test_each_task_returns_what_it_returns_alone_in_as_few_calls_as_the_longest_needs(squares):
    calls, longest = [], []
    found = in_lockstep([lambda ask, s=s: root_of(s, ask) for s in squares], answers(calls))
    alone = []
    for square in squares:
        own = []
        alone += in_lockstep([lambda ask, s=square: root_of(s, ask)], answers(own))
        longest.append(len(own))
    assert found == alone
    np.testing.assert_allclose(found, np.sqrt(squares), rtol=1e-7)
    assert len(calls) <= max(longest, default=0) + 1


def test_order_of_rows_is_that_of_tasks_whoever_asks_first():
    order, rows = threading.Event(), []

    def late(ask):
        order.wait(10.0)
        return ask("values", np.array([1.0]))

    def early(ask):
        order.set()
        return ask("values", np.array([2.0]))

    in_lockstep([late, early], {"values": lambda U: rows.append(U.ravel().tolist()) or U})
    assert rows == [[1.0, 2.0]]


def test_the_first_kind_is_answered_first_and_others_wait_for_one_another():
    calls = []

    def one(kinds):
        return lambda ask: [ask(kind, np.ones(1)) for kind in kinds]

    tasks = [one(["slopes"]), one(["values", "values", "slopes"])]
    in_lockstep(tasks, {kind: lambda U, k=kind: calls.append((k, len(U))) or U for kind in ("values", "slopes")})
    assert calls == [("values", 1), ("values", 1), ("slopes", 2)]


def test_a_task_that_fails_stops_no_other_and_is_raised_at_the_end():
    ended = []

    def broken(ask):
        ask("values", np.ones(1))
        raise ZeroDivisionError

    def whole(ask):
        ended.append([ask("values", np.ones(1)) for _ in range(3)])

    with pytest.raises(ZeroDivisionError):
        in_lockstep([broken, whole], {"values": lambda U: U})
    assert len(ended[0]) == 3


@pytest.mark.parametrize("error", [ValueError, KeyboardInterrupt])
def test_an_answer_that_fails_leaves_no_thread_behind(error):
    def refuse(U):
        raise error("no")

    def stubborn(ask):
        try:
            ask("values", np.ones(1))
        except BaseException:
            ask("values", np.ones(1))

    before = threading.active_count()
    with pytest.raises(error, match="no"):
        in_lockstep([stubborn, lambda ask: ask("values", np.ones(1)), lambda ask: None], {"values": refuse})
    assert threading.active_count() == before
