"""A cheap vehicle takes what belongs to the corners it stands for; a road's inputs are those of the road."""

import dataclasses

import numpy as np
import pytest

import susp_ss as ss
from susp_ss.fit.low_fidelity import LowFidelityResponse
from susp_ss.quantities import metric_and_place

ROAD = ss.Road.iso8608("B", speed=20.0, tracks="isotropic")
CORNERS = ("fr", "fl", "rr", "rl")


@pytest.mark.parametrize(
    ("place", "taken"),
    [
        ("fr", (18e3, 1400.0)),
        ("fl", (20e3, 1400.0)),
        ("rr", (22e3, 1400.0)),
        ("cg", (20.5e3, 1400.0)),
        (None, (20.5e3, 1400.0)),
    ],
)
def test_a_quarter_car_takes_its_corner_or_the_mean(place, taken):
    cheap = LowFidelityResponse(ss.QuarterCar(), ROAD, "bacc", place, (*(f"ks_{corner}" for corner in CORNERS), "cs"))
    expected = ss.Response(ss.QuarterCar(), ROAD, "bacc")([taken])
    np.testing.assert_allclose(cheap([[18e3, 20e3, 22e3, 22e3, 1400.0]]), expected, rtol=1e-14)


def test_a_corner_that_no_column_sets_keeps_its_own():
    cheap = LowFidelityResponse(ss.QuarterCar(ks=10e3), ROAD, "sws", "cg", ("ks_front", "cs"))
    np.testing.assert_allclose(cheap([[20e3, 1400.0]]), ss.Response(ss.QuarterCar(), ROAD, "sws")([[15e3, 1400.0]]))


@pytest.mark.parametrize("metric", ["bacc", "sws", "dtl", "pitch_acc"])
def test_half_and_full_cars_take_the_same_columns_to_their_wheels(metric):
    columns, X = ("ks_front", "ks_rear", "cs", "iyy"), [[18e3, 22e3, 1400.0, 900.0]]
    half = ss.PitchHalfCar(ks=(18e3, 22e3), cs=1400.0, iyy=900.0)
    full = ss.FullCar(ks=ss.Corners.axles(front=18e3, rear=22e3), cs=1400.0, iyy=900.0)
    for car, at in ((half, "r"), (full, "rl")):
        expected = ss.ride_metrics(car, ROAD)[metric]
        if metric != "pitch_acc":
            expected = expected.sel({expected.dims[0]: at})
        got = LowFidelityResponse(type(car)(), ROAD, metric, "rl", columns)(X)
        np.testing.assert_allclose(got, [expected.item()], rtol=1e-12)


def test_a_roll_half_car_is_the_axle_of_the_place():
    cheap = LowFidelityResponse(ss.RollHalfCar(), ROAD, "bacc", "rl", ("ks_rr", "ks_rl", "ks_front"))
    assert cheap.unknown == ("ks_front",)
    expected = ss.ride_metrics(ss.RollHalfCar(ks=(18e3, 22e3)), ROAD).bacc.sel(point="l").item()
    np.testing.assert_allclose(cheap([[18e3, 22e3, 1.0]]), [expected], rtol=1e-12)


@pytest.mark.parametrize("car", [ss.QuarterCar(), ss.FullCar()])
@pytest.mark.parametrize("criterion", ["bacc", "damper_power"])
@pytest.mark.parametrize("cutoff", [0.0, 0.01])
def test_roads_of_their_own(car, criterion, cutoff):
    at = "fr" if isinstance(car, ss.FullCar) else None
    road = dataclasses.replace(ROAD, cutoff=cutoff)
    X = np.array([[18e3, 15.0, 30e-6], [20e3, 30.0, 60e-6], [22e3, 15.0, 90e-6]])
    got = ss.Response(car, road, criterion, at, ("ks", "speed", "roughness"))(X)
    for row, (ks, speed, roughness) in zip(got, X, strict=True):
        metrics = ss.ride_metrics(
            dataclasses.replace(car, ks=ks), dataclasses.replace(road, speed=speed, roughness=roughness)
        )
        expected = metrics[criterion] if at is None else metrics[criterion].sel({metrics[criterion].dims[0]: at})
        np.testing.assert_allclose(row, expected.item(), rtol=1e-12)


def test_a_parameter_of_the_road_and_one_at_a_corner():
    response = ss.Response(ss.FullCar(), ROAD, "bacc", "fr", ("ks",), parameter="speed")
    assert response.parameter_value == 20.0
    np.testing.assert_allclose(
        response([[18e3], [18e3]], [10.0, 30.0]),
        ss.Response(ss.FullCar(), ROAD, "bacc", "fr", ("ks", "speed"))([[18e3, 10.0], [18e3, 30.0]]),
    )
    corner = ss.Response(ss.FullCar(), ROAD, "bacc", "fr", ("ks",), parameter="cs_rl")
    assert corner.parameter_value == ss.FullCar().cs
    np.testing.assert_allclose(corner([[18e3]], corner.parameter_value), corner([[18e3]]), rtol=1e-12)


@pytest.mark.parametrize(
    ("columns", "said"),
    [
        (("gap",), "QuarterCar has none of the inputs gap, available: ms, mu, ks"),
        (("ks", "ks_front"), "'ks' and 'ks_front' both set ks at corner f"),
        (("ks_front", "ks_fr"), "'ks_front' and 'ks_fr' both set ks at corner fr"),
    ],
)
def test_columns_that_cannot_be_matched(columns, said):
    with pytest.raises(ValueError, match=said):
        LowFidelityResponse(ss.QuarterCar(), ROAD, "bacc", "fr", columns)


def test_bad_settings_of_a_response():
    with pytest.raises(ValueError, match=r"'ks_fr' and 'ks' set one parameter, got both"):
        ss.Response(ss.FullCar(), ROAD, "bacc", "fr", ("ks", "ks_fr"))
    with pytest.raises(ValueError, match=r"Road\(speed=...\) must be > 0 m/s, got -1.0"):
        ss.Response(ss.QuarterCar(), ROAD, inputs=("speed",))([[20.0], [-1.0]])
    with pytest.raises(ValueError, match="shape"):
        LowFidelityResponse(ss.QuarterCar(), ROAD, "bacc", None, ("ks",))([[1.0, 2.0]])


def test_outputs_name_metric_and_place():
    assert metric_and_place("bacc") == ("bacc", None)
    assert metric_and_place("roll_acc") == ("roll_acc", None)
    assert metric_and_place("damper_power_rl") == ("damper_power", "rl")
    assert metric_and_place("peak_load") == ("peak_load", None)
