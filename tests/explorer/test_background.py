"""The carpet is a batch of cars, the front beats it, and no suspension beats the bound."""

import json

import numpy as np
import pytest

import susp_ss as ss
from susp_ss.explorer.background import FACTORS, background, conditions
from susp_ss.explorer.beside import Beside
from susp_ss.explorer.state import NOTHING, Given, from_query

ROAD = ss.Road.iso8608("B", speed=20.0, tracks="isotropic")


def found_for(text, given=NOTHING, background=background):
    state, errors = from_query(text, given)
    assert errors == []
    found = background(state, given)
    json.dumps(found, allow_nan=False)
    return found


@pytest.fixture(scope="module")
def quarter():
    """As the server gets it, of a process beside its own."""
    with Beside() as beside:
        return found_for("model=quarter&ks=30000&mu=50", background=beside.background)


def test_the_carpet_is_that_of_each_car(quarter):
    carpet = quarter["carpet"]
    assert (carpet["x"], carpet["y"]) == ("sws", "bacc")
    cars = ss.QuarterCar(mu=50.0, ks=18553.0 * FACTORS[:, None], cs=1516.5 * FACTORS)
    own = ss.ride_metrics(cars, ROAD)
    assert np.array(carpet["designs"]) == pytest.approx(np.stack([own.sws, own.bacc], axis=-1), rel=1e-9)


def test_no_design_of_the_carpet_beats_the_front(quarter):
    carpet, front = (
        np.array(part).reshape(-1, 2) for part in (quarter["carpet"]["designs"], quarter["front"]["points"])
    )
    for point in front:
        assert not np.any(np.all(carpet < point * (1.0 - 1e-6), axis=1))
    assert carpet[:, 1].min() >= front[:, 1].min() * (1.0 - 1e-6)


def test_the_front_is_a_line_that_no_design_lies_clearly_below(quarter):
    x, y = np.array(quarter["carpet"]["designs"]).reshape(-1, 2).T
    ends = np.array(sorted(quarter["front"]["points"]))
    assert np.all(y > 0.97 * np.interp(x, *ends.T))


def test_designs_of_the_front_have_its_metrics(quarter):
    for (x, y), design in zip(quarter["front"]["points"], quarter["front"]["designs"], strict=True):
        own = ss.ride_metrics(ss.QuarterCar(mu=50.0, **design), ROAD)
        assert (x, y) == pytest.approx((float(own.sws), float(own.bacc)), rel=1e-6)


def test_the_bound_lies_below_the_front_at_the_same_place(quarter):
    passive = dict(quarter["front"]["points"])
    assert len(quarter["bound"]["points"]) == len(passive)
    assert all(y <= passive[x] * (1.0 + 1e-6) for x, y in quarter["bound"]["points"])


def test_springs_and_dampers_do_not_change_the_background():
    text = "model=quarter&mu=50&carpet_y=dtl"
    assert conditions(from_query(f"{text}&ks=30000&cs=900&bump_height=0.1")[0]) == from_query(text)[0]


def test_what_nobody_waits_for_is_not_begun_or_ended():
    gone = iter([True, False, True, False])
    with Beside(left=lambda: next(gone)) as beside, pytest.MonkeyPatch.context() as patch:
        patch.setattr("susp_ss.explorer.beside.QUICK", 0.0)
        assert beside.background({"model": "three-axle"}, NOTHING) is None
        assert beside.background({"model": "three-axle"}, NOTHING) is None
        patch.setattr("susp_ss.explorer.beside.QUICK", np.inf)
        assert {*beside.background({"model": "quarter", "carpet": {"x": "sws", "y": "sws"}}, NOTHING)} == {
            "carpet",
            "errors",
        }


def test_a_car_that_steers_has_a_carpet_alone():
    assert {*found_for("model=ride-handling")} == {"carpet", "errors"}


def test_the_system_of_a_file_has_no_background():
    system = ss.LinearVehicle(ss.QuarterCar().state_space())
    assert found_for("", Given(system)) == {"errors": []}


def test_what_cannot_be_bounded_is_said():
    found = found_for("model=quarter&ct=100")
    assert {*found} == {"carpet", "front", "errors"}
    assert "dtl has no finite variance" in found["errors"][0]["message"]


def test_axes_that_are_one_are_said():
    found = found_for("model=quarter&carpet_x=bacc")
    assert {*found} == {"carpet", "errors"}
    assert len(found["errors"]) == 1
