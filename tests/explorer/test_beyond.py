"""Fronts and bounds of the engine in JavaScript beside the package's own, and beside what they must be."""

from pathlib import Path

import numpy as np
import pytest

import susp_ss as ss
from susp_ss import explorer
from susp_ss.explorer.background import background
from susp_ss.explorer.design import road_of, vehicle_of
from susp_ss.explorer.javascript import engine
from susp_ss.explorer.state import NOTHING

ASSETS = Path(explorer.__file__).parent / "assets"


def changed(model, road=None, carpet=None, seat=None, curve=None, **vehicle):
    state = NOTHING.default(model)
    whole = {
        name: more and {row.key: row.default for row in NOTHING.tables[model] if row.table == name} | more
        for name, more in (("seat", seat), ("curve", curve))
    }
    own = {name: (state[name] or {}) | (more or {}) for name, more in (("road", road), ("carpet", carpet))}
    return state | own | whole | {"vehicle": state["vehicle"] | vehicle}


STATES = [
    changed("quarter", {"waviness": 2.4, "speed": 31.0}, ms=420.0, ks=30e3, seat={"mass": 90.0}),
    changed("pitch-half", {"speed": 12.0}, {"x": "dtl@r"}, mb=800.0, a=1.2, mu_rear=60.0),
]


# Each bound may exceed its limits by a ten-thousandth.
@pytest.mark.parametrize("state", STATES, ids=lambda state: state["model"])
def test_fronts_and_bounds_are_those_of_the_package(ask, state):
    (found,), expected = ask("background", [state]), background(state)
    assert found["errors"] == expected["errors"] == []
    np.testing.assert_allclose(found["carpet"]["designs"], expected["carpet"]["designs"], rtol=1e-8)
    np.testing.assert_allclose(found["front"]["points"], expected["front"]["points"], rtol=1e-6)
    np.testing.assert_allclose(found["bound"]["points"], expected["bound"]["points"], rtol=1e-4)


def test_a_car_of_curves_keeps_them_in_every_design(ask):
    state = changed("quarter", {"roughness": 256e-6}, curve={"rebound": 1.6, "knee": 0.15}, ms=300.0)
    (found,), expected, road = ask("background", [state]), background(state), road_of(state)
    np.testing.assert_allclose(found["front"]["points"], expected["front"]["points"], rtol=1e-6)
    np.testing.assert_allclose(found["bound"]["points"], expected["bound"]["points"], rtol=1e-4)
    points, carpet = np.array(found["front"]["points"]), np.array(found["carpet"]["designs"]).reshape(-1, 2)
    for front in (found["front"], expected["front"]):
        cars = [vehicle_of(state | {"vehicle": state["vehicle"] | one}) for one in front["designs"]]
        metrics = [ss.ride_metrics(car, road) for car in cars]
        np.testing.assert_allclose(front["points"], [[float(one.sws), float(one.bacc)] for one in metrics], rtol=1e-8)
    assert not (carpet[None] < points[:, None] * (1.0 - 1e-6)).all(axis=-1).any()


def test_the_full_car(ask):
    state = changed("full", {"speed": 25.0}, mb=1400.0, arb_front=12e3)
    (found,) = ask("background", [state])
    points, carpet = np.array(found["front"]["points"]), np.array(found["carpet"]["designs"]).reshape(-1, 2)
    car, road = vehicle_of(state), road_of(state)
    best = {
        name: np.array([design[name] for design in found["front"]["designs"]]) for name in found["front"]["designs"][0]
    }
    metrics = ss.ride_metrics(car.replaced(**best), road)
    own = np.stack([metrics.sws.sel(corner="fr"), metrics.bacc.sel(point="cg")], axis=-1)
    np.testing.assert_allclose(points, own, rtol=1e-9)
    beaten = (carpet[None] < points[:, None] * (1.0 - 1e-6)).all(axis=-1)
    assert not beaten.any()
    assert found["errors"] == []
    middle = len(points) // 2
    limits = {
        f"{name}@{corner}": float(metrics[name].sel(corner=corner)[middle])
        for name in ("sws", "dtl")
        for corner in car.wheels
    }
    bound = ss.active_bound(car, road, "bacc@cg", limits).bound
    np.testing.assert_allclose(found["bound"]["points"][middle], [points[middle, 0], bound], rtol=1e-4)


@pytest.mark.parametrize(
    "state",
    [
        changed("quarter", carpet={"x": "bacc"}),
        changed("quarter", carpet={"x": "dtl"}, ct=100.0),
        changed("quarter", ct=100.0),
        changed("quarter", carpet={"y": "damper_power"}),
        changed("quarter", carpet={"x": "damper_power"}),
        changed("full", {"tracks": "identical"}, {"x": "roll_acc"}),
        changed("ride-handling"),
    ],
)
def test_what_there_is_not_is_said_in_the_words_of_the_package(ask, state):
    (found,), expected = ask("background", [state]), background(state)
    assert found["errors"] == expected["errors"]
    assert found.keys() == expected.keys()


def test_a_thread_of_its_own_answers_part_by_part_and_only_what_was_asked_last(browser, ask):
    page = browser.new_page()
    page.add_script_tag(content=f"window.explorer = {{ beside: () => {{ {engine()} }} }};")
    page.add_script_tag(path=ASSETS / "answers.js")
    told = """([first, last]) => new Promise((done, failed) => {
        const found = [];
        explorer.answers.slow(first, (part) => found.push(part), failed);
        explorer.answers.slow(last, (part) => (found.push(part), part.more || done(found)), failed);
    })"""
    first, last = changed("full"), changed("quarter", ms=400.0)
    parts = page.evaluate(told, [first, last])
    assert [set(part) - {"errors", "more"} for part in parts] == [
        {"carpet"},
        {"carpet", "front"},
        {"carpet", "front", "bound"},
    ]
    assert parts[-1] == ask("background", [last])[0]
    page.close()
