"""What the page shows is what the package says of the same vehicle on the same road."""

import dataclasses
import json

import numpy as np
import pandas as pd
import pytest
from hypothesis import given, settings

import susp_ss as ss
from explored import states
from susp_ss.explorer.compute import SPEEDS, compute, compute_all
from susp_ss.explorer.state import MODELS, NOTHING, Given, from_query

ROAD = ss.Road.iso8608("B", speed=20.0, tracks="isotropic")
DAMPER = ss.DamperCurve([-0.6, -0.2, 0.0, 0.2, 0.6], [-800.0, -400.0, 0.0, 200.0, 400.0])

CASES = {
    "ks_front=20000&cs_rear=1800&arb_front=5000&ct_rear=0": (
        ss.FullCar(
            ks=ss.Corners.axles(front=20e3, rear=18553.0), cs=ss.Corners.axles(front=1516.5, rear=1800.0), arb_front=5e3
        ),
        ROAD,
    ),
    "model=quarter&ms=400&waviness=2.3&speed=30": (
        ss.QuarterCar(ms=400.0),
        dataclasses.replace(ROAD, waviness=2.3, speed=30.0),
    ),
    "model=quarter&seat_ks=30000": (ss.QuarterCarWithSeat(seat_ks=30e3), ROAD),
    "model=pitch-half&kt_rear=250000&cutoff=0.01": (
        ss.PitchHalfCar(kt=(192e3, 250e3)),
        dataclasses.replace(ROAD, cutoff=0.01),
    ),
    "model=roll-half&arb=9000&roughness=0.0002": (ss.RollHalfCar(arb=9e3), dataclasses.replace(ROAD, roughness=2e-4)),
    "model=ride-handling&height=0.6&speed=30": (
        ss.RideHandlingCar(height=0.6, speed=30.0),
        dataclasses.replace(ROAD, speed=30.0),
    ),
    "model=three-axle&cs_rear=20000&middle=0.7": (ss.ThreeAxleTruck(cs=(10e3, 15e3, 20e3), middle=0.7), ROAD),
    "seat_x=0.5&seat_y=-0.3&seat_mass=60": (
        ss.FullCar().with_seats({"driver": ss.Seat(x=0.5, y=-0.3, mass=60.0)}),
        ROAD,
    ),
    "model=quarter&cs=2000&curve_rebound=1&curve_compression=0.5&curve_knee=0.2&curve_beyond=0.5": (
        ss.QuarterCar(cs=DAMPER),
        ROAD,
    ),
}


def case(text):
    state, errors = from_query(text)
    assert errors == []
    found = compute(state)
    assert found["errors"] == []
    json.dumps(found, allow_nan=False)
    return (*CASES[text], state, found)


def by_name(metrics):
    """Values of a Dataset by ``sws@fr``."""
    return {
        f"{name}@{place}" if data.dims else str(name): value
        for name, data in metrics.data_vars.items()
        for place, value in zip(
            data[data.dims[0]].values if data.dims else [""], np.atleast_1d(data.values), strict=True
        )
    }


@pytest.mark.parametrize("text", CASES)
def test_metrics_are_those_of_ride_metrics(text):
    car, road, _, found = case(text)
    own = by_name(ss.ride_metrics(car, road))
    assert {row["name"]: row["value"] for row in found["metrics"]} == pytest.approx(own, rel=1e-9)


@pytest.mark.parametrize("text", CASES)
def test_comfort_is_that_of_the_standard(text):
    car, road, _, found = case(text)
    own = ss.comfort(car, road).metrics
    for row in found["comfort"]:
        at = own.sel(point=row["point"]) if row["point"] else own
        assert row["total"] == pytest.approx(float(at.total), rel=1e-9)
        assert row["wz"] == pytest.approx(float(at.bacc), rel=1e-9)
        assert row["words"] == str(at.reaction.item())
        assert ("wroll" in row, "wpitch" in row) == ("roll_acc" in own, "pitch_acc" in own)


@pytest.mark.parametrize("text", CASES)
def test_spectra_hold_the_weighted_variance(text):
    car, road, _, found = case(text)
    f = np.array(found["frequency"])
    straight = ss.linearised(car, road)
    H, S = ss.frequency_response(straight, f), ss.psd(straight, road, f)
    felt = {f"bacc@{row['point']}" if row["point"] else "bacc": row["wz"] for row in found["comfort"]}
    for shown, spectrum in zip(found["bode"], found["psd"], strict=True):
        name = (
            shown["output"].replace("@", "_") if shown["output"].replace("@", "_") in H.output.values else "bacc_body"
        )
        response = H.sel(output=name, input=shown["input"]).values
        assert shown["magnitude"] * np.exp(1j * np.radians(shown["phase"])) == pytest.approx(response, rel=1e-9)
        assert spectrum["psd"] == pytest.approx(S.sel(output=name).values, rel=1e-9)
        if spectrum["weighting"]:
            variance = np.trapezoid(spectrum["weighted"], f)
            at = shown["output"] if shown["output"] in felt else "bacc@body"
            assert np.sqrt(variance) == pytest.approx(felt[at], rel=0.02)


@pytest.mark.parametrize("text", CASES)
def test_modes_are_the_vehicle_s_own(text):
    car, road, _, found = case(text)
    straight = ss.linearised(car, road)
    own = straight.modes()
    known = own[~own.get("name", pd.Series([""] * len(own))).isin(["spin", "sway and yaw"])]
    assert [mode["frequency"] for mode in found["modes"]] == pytest.approx(known["frequency"].tolist())
    assert [mode["damping"] for mode in found["modes"]] == pytest.approx(known["damping_ratio"].tolist())
    for mode, shape in zip(found["modes"], known["shape"], strict=True):
        parts = [*(mode["shape"].get(name) for name in ("heave", "pitch", "roll")), *mode["shape"]["wheels"].values()]
        parts += mode["shape"]["seats"].values()
        vertical = shape[[not name.startswith(("y", "psi", "x", "spin")) for name in shape.index]]
        amplitudes = sorted(abs(complex(*part)) for part in parts if part is not None)
        assert amplitudes == pytest.approx(sorted(vertical.abs()))


def test_modes_have_the_names_of_what_moves():
    names = [mode["name"] for mode in compute(NOTHING.default())["modes"]]
    assert names[:3] == ["heave", "pitch", "roll"]
    assert sorted(names[3:]) == ["front hop", "front hop", "rear hop", "rear hop"]
    seated = compute(from_query("model=quarter&seat_ks=35000")[0])["modes"]
    assert [mode["name"] for mode in seated] == ["heave", "seat", "hop"]


@pytest.mark.parametrize("text", CASES)
def test_the_bump_is_that_of_simulate(text):
    car, _, state, found = case(text)
    shown, asked = found["bump"], state["bump"]
    profile = ss.obstacle("bump", asked["height"], asked["length"], before=asked["speed"] * 0.2, after=30.0)
    ride = ss.simulate(car, profile, speed=asked["speed"], step=0.001, positions=True)
    t = np.array(shown["t"]) + 0.2
    first = next(iter(car.wheels))
    for name, data in (("ground", ride.z_r), ("wheels", ride.z_u)):
        own = data.sel(corner=first) if data.ndim > 1 else data
        scale = np.abs(own).max().item()
        assert np.interp(t, ride.time, own) == pytest.approx(np.array(shown[name][first]), abs=0.03 * scale)
    heave = ride.z_s[0] if ride.z_s.ndim > 1 else ride.z_s
    assert np.interp(t, ride.time, heave) == pytest.approx(
        np.array(shown["body"]["heave"]), abs=0.03 * np.abs(heave.values).max()
    )
    assert np.array(shown["x"]) == pytest.approx(np.array(shown["t"]) * asked["speed"], abs=1e-9)


@pytest.mark.parametrize("model", MODELS)
def test_metrics_over_speed_are_those_at_each_speed(model):
    state = NOTHING.default(model)
    over = compute(state)["speeds"]
    assert over["speed"] == SPEEDS.tolist()
    for i in (0, len(SPEEDS) - 1):
        state["road"]["speed"] = over["speed"][i]
        own = {row["name"]: row["value"] for row in compute(state)["metrics"]}
        assert {row["name"]: row["values"][i] for row in over["metrics"]} == pytest.approx(own, rel=1e-9)


ALIKE = {
    "full": ["", "ks_front=15053&arb_rear=4000", "cs_rear=2016.5&mb=1500", "kt_front=250000&ct_front=80"],
    "ride-handling": ["", "cornering_rear=60000", "izz=1400&cs_rear=2016.5"],
    "quarter": ["", "seat_mass=70", "curve_rebound=1.4", "ks=22000"],
}


def numbers_of(found):
    """Metrics, comfort and metrics over speed in a row; an infinite one is nan."""
    some = [row["value"] for row in found["metrics"]] + [row["total"] for row in found["comfort"]]
    return np.array([*some, *(value for row in found["speeds"]["metrics"] for value in row["values"])], dtype=float)


@pytest.mark.parametrize("model", ALIKE)
def test_states_together_are_each_alone(model):
    asked = [from_query(f"model={model}&speed=25&{text}")[0] for text in ALIKE[model]]
    for together, state in zip(compute_all(asked), asked, strict=True):
        alone = compute(state)
        assert together.keys() == alone.keys()
        np.testing.assert_allclose(*map(numbers_of, (together, alone)), rtol=1e-9)


def test_a_state_that_is_refused_takes_no_other_with_it():
    loose, firm = (from_query(f"model=ride-handling&cornering_front={front}&speed=60")[0] for front in (90000, 45000))
    refused, found = compute_all([loose, firm])
    assert "unstable" in refused["errors"][0]["message"]
    assert found["errors"] == []
    assert found["metrics"] == compute(firm)["metrics"]


@settings(max_examples=8)
@given(states())
def test_every_state_that_the_page_can_come_to_is_answered_in_json(state):
    found = compute(state)
    json.dumps(found, allow_nan=False)
    assert found["errors"] or {"metrics", "comfort", "bode", "psd", "modes", "bump", "speeds"} <= {*found}


def test_what_is_next_to_nothing_is_nothing():
    state, errors = from_query("model=ride-handling&relaxation_rear=2.885797081925577e-95")
    assert (state["vehicle"]["relaxation_rear"], errors) == (0.0, [])


def test_what_is_infinite_is_none():
    found = compute(from_query("model=quarter&ct=100")[0])
    assert {row["name"]: row["value"] for row in found["metrics"]}["dtl"] is None


@pytest.mark.parametrize(
    "car",
    [ss.QuarterCar(ct=100.0), ss.LinearVehicle(ss.RigidTyreQuarterCar().state_space(input="velocity"))],
    ids=["damped tyre", "rigid tyre"],
)
def test_what_is_infinite_is_felt_all_the_same(car):
    felt = compute(Given(car).default(), Given(car))["comfort"][0]
    assert felt["total"] == pytest.approx(ss.comfort(car, ROAD).metrics.total.item(), rel=1e-9)


def test_a_car_that_spins_at_some_speed_has_metrics_at_its_own():
    loose = Given(ss.RideHandlingCar(cornering=ss.Corners.axles(front=60e3, rear=30e3)))
    state = loose.default()
    state["road"]["speed"] = 10.0
    found = compute(state, loose)
    assert "metrics" in found
    assert "speeds" not in found
    (error,) = found["errors"]
    assert "unstable" in error["message"]


@pytest.fixture(scope="module")
def fitted():
    """A surrogate of full cars in two variables, one of whose outputs is weighted."""
    rng = np.random.default_rng(0)
    runs = pd.DataFrame({"ks": rng.uniform(13e3, 24e3, 25), "cs": rng.uniform(900.0, 2200.0, 25)})
    cars = ss.FullCar(ks=runs.ks.to_numpy(), cs=runs.cs.to_numpy())
    from susp_ss.fit.surrogate_file import SuspensionSurrogate

    cheap = ss.LowFidelity(ss.QuarterCar(), ROAD, place="fr", weighting="Wk")
    felt = ss.ride_metrics(cars, ROAD, weighting={"bacc": "Wk"})
    outputs = {"bacc": felt.bacc.sel(point="fr"), "sws": felt.sws.sel(corner="fr")}
    models = {name: ss.ResponseBased(cheap.response(name, list(runs))).fit(runs, y) for name, y in outputs.items()}
    return SuspensionSurrogate({"ks": "N/m", "cs": "N s/m"}, {"bacc": "m/s^2", "sws": "m"}, models, cheap)


def test_a_surrogate_stands_beside_the_exact_value(fitted):
    given = Given(surrogates={"fit": fitted})
    found = compute(from_query("ks_front=20000&ks_rear=20000&speed=30", given)[0], given)
    assert found["errors"] == []
    rows = {row["output"]: row for row in found["surrogates"]}
    predicted = fitted.predict({"ks": [20e3], "cs": [1516.5]}, interval=0.95).iloc[0]
    exact = by_name(ss.ride_metrics(ss.FullCar(ks=20e3), ROAD, weighting={"bacc": "Wk"}))
    for name, own in (("bacc@fr", "bacc"), ("sws@fr", "sws")):
        row = rows[name]
        assert (row["surrogate"], row["outside"]) == ("fit: ResponseBased", False)
        assert row["value"] == pytest.approx(predicted[own])
        assert (row["low"], row["high"]) == pytest.approx((predicted[f"{own}_low"], predicted[f"{own}_high"]))
        assert row["exact"] == pytest.approx(exact[name], rel=1e-9)


def test_a_design_that_a_surrogate_does_not_know_is_said(fitted):
    given = Given(surrogates={"fit": fitted})
    found = compute(from_query("ks_front=20000", given)[0], given)
    assert found["surrogates"] == []
    assert "fit has one ks for all of fr, fl, rr, rl" in found["errors"][0]["message"]
    assert compute(from_query("cs_front=4000&cs_rear=4000", given)[0], given)["surrogates"][0]["outside"]
