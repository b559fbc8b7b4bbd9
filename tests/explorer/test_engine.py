"""The engine in JavaScript beside the package that it is written out of, on random states, in one page of a browser."""

import numpy as np
import pytest

import susp_ss as ss
from susp_ss.explorer.background import Field, carpet
from susp_ss.explorer.compute import compute
from susp_ss.explorer.design import vehicle_of
from susp_ss.explorer.javascript import wavinesses
from susp_ss.explorer.state import MODELS, NOTHING
from susp_ss.explorer.table import Number
from susp_ss.roads.road import TRACKS

CARS = 48


def numbers(model, table):
    return [row for row in NOTHING.tables[model] if isinstance(row, Number) and row.table == table]


def drawn(rng, model, seat=False, curve=False, **road):
    """A state anywhere within its sliders; half of all cars have no tyre damping, which makes tyre loads infinite.

    Half of all axles have tyres that do not lag behind.
    """
    state = NOTHING.default(model)
    for table in ("vehicle", "road", "bump", *(["seat"] if seat else []), *(["curve"] if curve else [])):
        own = {row.key: rng.uniform(row.least, row.most) for row in numbers(model, table)}
        state[table] = (state[table] or {}) | own
    if rng.random() < 0.5:
        state["vehicle"] |= {name: 0.0 for name in state["vehicle"] if name.startswith("ct")}
    lags = [name for name in state["vehicle"] if name.startswith("relaxation")]
    state["vehicle"] |= {name: 0.0 for name in lags if rng.random() < 0.5}
    state["road"] |= {"waviness": float(rng.choice(wavinesses()))} | road
    if "middle" in state["vehicle"]:
        a, middle, b = (state["vehicle"][name] for name in ("a", "middle", "b"))
        state["vehicle"]["middle"] = float(np.clip(middle, -0.9 * a, 0.9 * b))
    (bode,) = (row for row in NOTHING.tables[model] if row.name == "bode")
    known = [name for name in bode.options if seat or name not in bode.seated]
    return state | {"bode": rng.choice(known, 2, replace=False).tolist()}


def steady(rng, model, **road):
    """A state of a car that stays on course, without tyre damping."""
    while True:
        state = drawn(rng, model, **road)
        state["vehicle"] |= {name: 0.0 for name in state["vehicle"] if name.startswith("ct")}
        car = vehicle_of(state)
        if not isinstance(car, ss.RideHandlingCar) or (car.izz > car.least_izz and not car.assemble().refusal()):
            return state


def kept(rtol, model, waviness):
    """What the package keeps itself of a truck, whose middle axle is warped off by long waves."""
    return rtol if model != "three-axle" or waviness <= 2.0 else max(rtol, 1e-8 if waviness <= 2.5 else 1e-6)


def agree(found, expected, rtol, atol=0.0):
    """The same at every leaf; lists of numbers within ``rtol`` of their largest."""
    if isinstance(expected, dict):
        assert found.keys() == expected.keys()
        for key, value in expected.items():
            agree(found[key], value, rtol, atol)
    elif isinstance(expected, list) and expected and not isinstance(expected[0], (int, float)):
        assert len(found) == len(expected)
        for one, other in zip(found, expected, strict=True):
            agree(one, other, rtol, atol)
    elif isinstance(expected, (list, float)):
        most = np.abs(expected).max(initial=0.0)
        np.testing.assert_allclose(found, expected, rtol=0.0, atol=rtol * most + atol)
    else:
        assert found == expected


# Terms of another waviness than 2 nearly cancel under a cut-off, and so do those of a warp that is hardly bounded:
# there the package itself keeps no more digits.
@pytest.mark.parametrize(
    ("tracks", "waviness", "cutoff", "rtol"),
    [
        *((tracks, (2.0,), cutoff, 1e-9) for tracks in TRACKS for cutoff in (0.0, 0.03)),
        *((tracks, (1.6, 2.5), 0.0, 1e-9) for tracks in ("identical", "isotropic")),
        ("independent", (1.6,), 0.0, 1e-9),
        ("independent", (2.5,), 0.0, 1e-8),
        ("isotropic", (1.6, 2.5), 0.03, 1e-7),
    ],
)
def test_metrics(ask, tracks, waviness, cutoff, rtol):
    rng = np.random.default_rng(0)
    for model in MODELS:
        if model == "ride-handling" and tracks == "independent" and not cutoff:
            continue
        for one in waviness:
            road = {"tracks": tracks, "waviness": one, "cutoff": cutoff}
            states = [steady(rng, model, **road) for _ in range(CARS // len(waviness))]
            own = {name: np.array([s["vehicle"][name] for s in states]) for name in states[0]["vehicle"]}
            speed, roughness = (np.array([s["road"][name] for s in states]) for name in ("speed", "roughness"))
            metrics = ss.ride_metrics(
                NOTHING.models[model].replaced(**own), ss.Road(roughness=roughness, speed=speed, **road)
            )
            expected = np.hstack([data.values.reshape(len(states), -1) for data in metrics.values()])
            close = kept(rtol, model, one)
            np.testing.assert_allclose(ask("metrics", states), expected, rtol=close, atol=1e-10)


@pytest.mark.parametrize(
    ("model", "seat"),
    [(model, seat) for model in MODELS for seat in (False, True) if numbers(model, "seat") or not seat],
)
def test_whole_states(ask, model, seat):
    rng = np.random.default_rng(1)
    states = [drawn(rng, model, seat, cutoff=0.0, tracks=tracks) for tracks in ("identical", "isotropic")]
    for state, found in zip(states, ask("compute", states), strict=True):
        expected = compute(state)
        shapes(found, expected)
        agree(found, expected, kept(1e-9, model, state["road"]["waviness"]), 1e-11)


@pytest.mark.parametrize(
    ("model", "seat", "tracks"),
    [
        ("full", False, "isotropic"),
        ("full", True, "independent"),
        ("quarter", True, "isotropic"),
        ("pitch-half", False, "identical"),
        ("roll-half", True, "isotropic"),
    ],
)
def test_curves(ask, model, seat, tracks):
    state = drawn(np.random.default_rng(3), model, seat, True, tracks=tracks, waviness=2.0, cutoff=0.0)
    (found,) = ask("compute", [state])
    expected = compute(state)
    assert any(row["name"].startswith("ride_height_shift") for row in expected["metrics"])
    shapes(found, expected)
    agree(found, expected, 1e-9, 1e-11)


def test_curves_that_are_straight_are_none(ask):
    """A damper of one rate all over is linearised to it, and stepped over the bump as the modes go."""
    straight = changed("full", cs_front=1300.0)
    bent = straight | {"curve": {"rebound": 1.0, "compression": 1.0, "knee": 0.1, "beyond": 1.0}}
    (expected, found) = ask("compute", [straight, bent])
    shifts = [row.pop("value") for row in found["metrics"] if row["name"].startswith("ride_height_shift")]
    np.testing.assert_allclose(shifts, 0.0, atol=1e-15)
    assert [row["value"] for row in found["metrics"] if "value" in row] == pytest.approx(
        [row["value"] for row in expected["metrics"]], rel=1e-9
    )
    shapes(found, expected)
    for part in ("comfort", "bode", "psd", "modes", "bump"):
        agree(found[part], expected[part], 1e-9, 1e-12)


def test_dampers_whose_motions_cease_to_swing_as_speed_falls(ask):
    """Modes that follow those of another speed must tell where they no longer can."""
    state = changed("quarter", cs=5200.0)
    state |= {"curve": {"rebound": 1.3, "compression": 0.7, "knee": 0.1, "beyond": 0.5}}
    swinging = [compute(state | {"road": state["road"] | {"speed": speed}})["modes"] for speed in (4.0, 60.0)]
    assert len(swinging[0]) != len(swinging[1])
    (found,) = ask("compute", [state])
    expected = compute(state)
    shapes(found, expected)
    agree(found, expected, 1e-9, 1e-11)


def test_the_carpet_of_curves(ask):
    state = changed("quarter") | {"curve": {"rebound": 1.4, "compression": 0.8, "knee": 0.1, "beyond": 0.4}}
    (found,) = ask("background", [state])
    assert found["errors"] == []
    agree(found["carpet"], carpet(Field(state, NOTHING))["carpet"], 1e-9)


def shapes(found, expected):
    """Modes' shapes apart: they are the same but for a complex factor."""
    for one, other in zip(found["modes"], expected["modes"], strict=True):
        a, b = (np.array(leaves(mode.pop("shape"))) @ [1.0, 1.0j] for mode in (one, other))
        np.testing.assert_allclose(np.outer(a, b), np.outer(b, a), atol=1e-9)


def leaves(shape):
    return [leaf for part in shape.values() for leaf in (part.values() if isinstance(part, dict) else [part])]


def changed(model, **vehicle):
    state = NOTHING.default(model)
    return state | {"vehicle": state["vehicle"] | vehicle}


# Springs whose modes are the same several times; and a damper by a millionth from critical.
@pytest.mark.parametrize(
    ("state", "rtol"),
    [
        (changed("pitch-half", a=1.2, b=1.2, iyy=635.0 * 1.2**2), 1e-9),
        (changed("full", a=1.2, b=1.2, c=0.5, iyy=1270.0 * 1.2**2, ixx=1270.0 * 0.5**2), 1e-9),
        (changed("quarter", cs=4584.5449909371355 * (1.0 + 1e-6)), 1e-9),
        (changed("quarter", cs=4584.5449909371355), 1e-6),
    ],
)
def test_modes_that_are_nearly_one(ask, state, rtol):
    (found,) = ask("metrics", [state])
    np.testing.assert_allclose(found, [row["value"] for row in compute(state)["metrics"]], rtol=rtol)


def test_a_car_that_does_not_stay_on_course_is_refused_in_the_same_words(ask):
    loose = {"cornering_front": 80e3, "cornering_rear": 40e3}
    some = [("over", 60.0, loose), ("later", 20.0, loose), ("soft", 20.0, {"ks_front": 5053.0, "ks_rear": 5053.0})]
    some += [("flat", 20.0, {"izz": 500.0, "mu_front": 113.0})]
    states = {name: changed("ride-handling", **vehicle) for name, _, vehicle in some}
    for name, speed, _ in some:
        states[name]["road"]["speed"] = speed
    states["soft"]["vehicle"] |= {"height": 1.2, "c": 0.45}
    found = dict(zip(states, ask("compute", list(states.values())), strict=True))
    for name, state in states.items():
        expected = compute(state)
        assert found[name]["errors"] == expected["errors"]
        assert found[name].keys() == expected.keys()
    for name, word in (("over", "critical"), ("later", "critical"), ("soft", "does not die out"), ("flat", "izz")):
        assert word in found[name]["errors"][0]["message"]
    assert "metrics" in found["later"]
    assert "modes" not in found["flat"]


def test_axles_of_a_truck_that_change_places_are_refused_in_the_same_words(ask):
    state = changed("three-axle", middle=2.0, b=1.8)
    (found,) = ask("compute", [state])
    assert found["errors"] == compute(state)["errors"]
    assert "middle" in found["errors"][0]["message"]


@pytest.mark.parametrize("road", [{}, {"waviness": 3.0, "cutoff": 0.01}], ids=["without a cut-off", "steep"])
def test_tracks_that_part_tilt_a_car_without_bound(ask, road):
    state = changed("ride-handling")
    state["road"] |= {"tracks": "independent", **road}
    (found,) = ask("compute", [state])
    expected = compute(state)
    said = expected["errors"][0]["message"]
    assert found["errors"][0]["message"].split(";")[0] == said[: said.index(" (")].split(";")[0]
    assert found.keys() == expected.keys()


def test_what_is_refused_is_said(ask):
    rng = np.random.default_rng(2)
    steep = drawn(rng, "full", waviness=3.0, tracks="independent", cutoff=0.0)
    between = drawn(rng, "full", waviness=2.013)
    for state, found in zip((steep, between), ask("compute", [steep, between]), strict=True):
        (error,) = found["errors"]
        assert "metrics" not in found
        assert len(found["modes"]) >= 7
        assert ("warp" if state is steep else "waviness") in error["message"]
    assert "warp" in compute(steep)["errors"][0]["message"]


def test_curves_without_variances_have_the_bump_alone(ask):
    state = drawn(np.random.default_rng(2), "pitch-half", curve=True, waviness=2.013)
    (found,) = ask("compute", [state])
    assert {*found} == {"bump", "errors", "surrogates"}
    assert "waviness" in found["errors"][0]["message"]
