"""What the page may set: ranges, the URL and back, and what is wrong in one line."""

import json
import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import susp_ss as ss
from explored import states
from susp_ss.explorer.state import MODELS, NOTHING, Given, checked, from_query, query
from susp_ss.explorer.table import Choice, Number
from susp_ss.vehicles.files import model_named

UNEQUAL = Given(ss.FullCar(ks=ss.Corners(fr=18e3, fl=19e3, rr=21e3, rl=21e3), cs=0.0, ct=200.0, arb_front=123.4))


@settings(max_examples=50)
@given(states())
def test_a_state_comes_back_from_its_url_and_from_json_to_the_last_digit(state):
    assert from_query(query(state)) == (state, [])
    assert checked(json.loads(json.dumps(state))) == (state, [])


def test_a_default_needs_no_word():
    assert [query(NOTHING.default(model)) for model in MODELS] == ["", *(f"model={model}" for model in MODELS[1:])]


@pytest.mark.parametrize("explorer", [NOTHING, UNEQUAL, Given(ss.ThreeAxleTruck()), Given(road=ss.Road(waviness=1.2))])
def test_every_slider_goes_both_ways_and_can_show_its_default(explorer):
    for rows in explorer.tables.values():
        assert len({row.name for row in rows}) == len({(row.table, row.key) for row in rows}) == len(rows)
        for row in rows:
            if isinstance(row, Choice):
                assert set([row.default] if isinstance(row.default, str) else row.default) <= set(row.options)
                continue
            assert row.least <= row.default <= row.most
            assert row.least < row.most
            steps = (row.default - row.least) / row.step
            assert row.logarithmic or math.isclose(steps, round(steps), abs_tol=1e-6)
    json.dumps(explorer.document(), allow_nan=False)


def test_both_ends_of_every_slider_make_a_vehicle():
    for model, car in NOTHING.models.items():
        for row in NOTHING.tables[model]:
            if isinstance(row, Number) and row.table == "vehicle":
                for value in (row.least, row.most):
                    assert (
                        getattr(car.replaced(**{row.name: value}), row.name.removesuffix("_front"), value) is not None
                    )


def test_wheels_that_differ_have_a_slider_each():
    names = [row.name for row in UNEQUAL.tables["file"]]
    assert {"ks_fr", "ks_fl", "ks_rr", "ks_rl", "mu_front", "mu_rear"} <= set(names)
    assert not {"ks_front", "ks"} & set(names)


def test_what_a_model_does_not_take_is_not_offered():
    names = {model: {row.name for row in rows} for model, rows in NOTHING.tables.items()}
    assert not {"seat_mass", "curve_knee"} & names["ride-handling"]
    assert "seat_x" in names["pitch-half"]
    assert "seat_y" not in names["pitch-half"]
    assert not {"seat_x", "seat_y"} & names["quarter"]
    assert {"ks_middle", "arb_middle", "middle", "seat_x"} <= names["three-axle"]
    assert "waviness" not in {row.name for row in Given(road=ss.Road.two_slope()).tables["full"]}


WRONG = {
    "ks_front=stiff": "ks_front must be a number from 5053 to 74553 N/m, got 'stiff'",
    "ks_front=1e9": "ks_front must be a number from 5053 to 74553 N/m, got 1000000000.0",
    "ks_front=nan": "ks_front must be a number from 5053 to 74553 N/m, got nan",
    "tracks=parallel": "tracks must be one of identical, independent, isotropic, got 'parallel'",
    "model=boat": f"model must be one of {', '.join(MODELS)}, got 'boat'",
    "ks_font=20000": "no parameter of full named 'ks_font'",
    "bode=bacc@driver": "bode bacc@driver needs a seat, got none",
    "__class__=1": "no parameter of full named '__class__'",
}


@pytest.mark.parametrize(("text", "message"), WRONG.items())
def test_what_is_wrong_is_said_in_one_line_and_the_rest_stands(text, message):
    state, errors = from_query(f"{text}&speed=30")
    assert [error["message"] for error in errors] == [message]
    assert errors[0]["parameter"] == text.partition("=")[0]
    assert state["road"]["speed"] == 30.0
    assert checked(state) == (state, [])


ANY = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=5),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=5), inner, max_size=3),
    max_leaves=6,
)
KEYS = st.sampled_from(["model", "vehicle", "curve", "seat", "road", "bump", "carpet", "bode", "more"])


@settings(max_examples=40)
@given(ANY | st.dictionaries(KEYS, ANY | st.dictionaries(st.sampled_from(["ks_front", "speed", "x"]), ANY)))
def test_whatever_comes_from_outside_a_whole_state_comes_of_it(thing):
    state, errors = checked(thing)
    assert checked(state) == (state, [])
    assert all(isinstance(error["message"], str) and "\n" not in error["message"] for error in errors)


def test_models_are_those_of_the_command_line():
    assert [type(car) for car in NOTHING.models.values()] == [model_named(name) for name in MODELS]
