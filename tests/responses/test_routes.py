"""One table: every vehicle on every road by every route, and against the oracles' own routes."""

import dataclasses

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import models
import oracles
import susp_ss as ss
from models import ROADS, VEHICLES, WHEEL_ROADS

CASES = [
    pytest.param(vehicle, road, id=f"{name} | {ground}")
    for name, vehicle in VEHICLES.items()
    for ground, road in ROADS.items()
] + [
    pytest.param(VEHICLES[name], road, id=f"{name} | {ground}")
    for name in ("full", "full, unequal corners, bars, tyre damping")
    for ground, road in WHEEL_ROADS.items()
]


def assert_agree(metrics, reference, rtol, vehicle):
    """Equal within rtol; what cancels by symmetry, or nearly does, to the same share of what cancels.

    Roll is what left and right wheels do not share: with sides nearly alike, its digits are those of the body's
    acceleration over them.
    """
    for name, data in reference.items():
        values, expected = metrics[name].values, data.values
        np.testing.assert_array_equal(np.isinf(values), np.isinf(expected), err_msg=str(name))
        finite, atol = np.isfinite(expected), 1e-7
        if name == "roll_acc":
            atol += rtol * float(reference.bacc.max()) / float(vehicle.c)
        np.testing.assert_allclose(values[finite], expected[finite], rtol=rtol, atol=atol, err_msg=f"{name} {vehicle}")


def by_name(metrics):
    """A Dataset of one design as the oracles' flat dict."""
    flat = {}
    for name, data in metrics.items():
        for place in data.coords[data.dims[0]].values if data.dims else [""]:
            flat[f"{name}_{place}" if place else name] = float(data.sel({data.dims[0]: place}) if place else data)
    return flat


@pytest.mark.parametrize(("vehicle", "road"), CASES)
def test_covariance_and_spectral_routes_agree(vehicle, road):
    rtol = 1e-3 if road.tracks == "isotropic" else 1e-6
    assert_agree(ss.ride_metrics(vehicle, road), ss.ride_metrics(vehicle, road, method="spectral"), rtol, vehicle)


@pytest.mark.parametrize(("vehicle", "road"), [case for case in CASES if case.values[1].tracks != "isotropic"])
def test_covariance_route_is_the_oracles_lyapunov_solution(vehicle, road):
    oracle = models.oracle(vehicle)
    expected = oracles.metrics(oracle, oracles.variance_lyapunov_delay(oracle, models.oracle_road(road)))
    ours = by_name(ss.ride_metrics(vehicle, road))
    assert ours.keys() == expected.keys()
    for name, value in expected.items():
        np.testing.assert_allclose(ours[name], value, rtol=1e-9, atol=1e-7, err_msg=name)


@pytest.mark.parametrize("waviness", [1.6, 2.0, 2.9])
@pytest.mark.parametrize("name", ["quarter", "roll half", "full, unequal corners"])
def test_spectral_route_is_the_oracles_integral(name, waviness):
    road = ss.Road(waviness=waviness, tracks="isotropic", speed=17.0)
    oracle = models.oracle(VEHICLES[name])
    expected = oracles.metrics(oracle, oracles.variance_spectral(oracle, models.oracle_road(road)))
    ours = by_name(ss.ride_metrics(VEHICLES[name], road, method="spectral"))
    for key, value in expected.items():
        np.testing.assert_allclose(ours[key], value, rtol=1e-6, atol=1e-7, err_msg=key)


@given(models.vehicles, models.roads)
@settings(max_examples=40)
def test_routes_agree_for_random_vehicles_and_roads(vehicle, road):
    metrics = ss.ride_metrics(vehicle, road)
    for name, data in metrics.items():
        assert (data.values >= 0).all(), name
        # Rotations may vanish by symmetry, and tyre damping makes the load infinite.
        if name not in ("roll_acc", "pitch_acc", "dtl"):
            assert (np.isfinite(data.values) & (data.values > 0)).all(), name
    rtol = 1e-3 if road.tracks == "isotropic" else 1e-6
    assert_agree(metrics, ss.ride_metrics(vehicle, road, method="spectral"), rtol, vehicle)


@given(models.vehicles, models.roads, st.floats(0.01, 100.0))
@settings(max_examples=40)
def test_metrics_scale_with_the_root_of_roughness(vehicle, road, factor):
    rougher = ss.Road(
        road.roughness * factor, road.speed, road.waviness, road.cutoff, road.tracks, road.delay, road.wheels
    )
    one, other = ss.ride_metrics(vehicle, road), ss.ride_metrics(vehicle, rougher)
    for name in one:
        power = 1.0 if name == "damper_power" else 0.5
        np.testing.assert_allclose(other[name], one[name] * factor**power, rtol=1e-9, atol=1e-7)


@given(models.vehicles, st.sampled_from(["identical", "independent"]), st.floats(0.2, 5.0))
@settings(max_examples=40)
def test_metrics_scale_with_the_root_of_speed_without_delay_and_cutoff(vehicle, tracks, factor):
    one = ss.ride_metrics(vehicle, ss.Road(tracks=tracks, delay=False, speed=10.0))
    other = ss.ride_metrics(vehicle, ss.Road(tracks=tracks, delay=False, speed=10.0 * factor))
    for name in one:
        power = 1.0 if name == "damper_power" else 0.5
        np.testing.assert_allclose(other[name], one[name] * factor**power, rtol=1e-9, atol=1e-7)


def test_left_and_right_of_a_symmetric_car_are_alike():
    metrics = ss.ride_metrics(ss.FullCar(arb_front=1e4), ss.Road(tracks="isotropic"))
    for name in ("sws", "dtl", "damper_power"):
        right, left = metrics[name].sel(corner=["fr", "rr"]), metrics[name].sel(corner=["fl", "rl"])
        np.testing.assert_allclose(right.values, left.values, rtol=1e-10)


def test_drifting_warp_and_undamped_models_are_refused_by_every_route():
    drifting = ss.Road(wheels=("fr",))
    for method in ("covariance", "spectral", "time"):
        with pytest.raises(ValueError, match="no finite variance"):
            ss.ride_metrics(ss.FullCar(), drifting, method=method)
        with pytest.raises(ValueError, match="no damper reaches"):
            ss.ride_metrics(ss.QuarterCar(cs=0.0), ss.Road(), method=method)
    with pytest.raises(ValueError, match="no damper reaches"):
        ss.covariance(ss.QuarterCar(cs=np.array([1000.0, 0.0])), ss.Road())
    cut_off = ss.Road(wheels=("fr",), cutoff=0.01, waviness=2.9)
    assert np.isfinite(ss.ride_metrics(ss.FullCar(), cut_off).sws).all()
    with pytest.raises(ValueError, match="no finite variance"):
        ss.ride_metrics(ss.FullCar(), dataclasses.replace(cut_off, waviness=3.0))
    one_track = ss.Road(tracks="isotropic", waviness=3.1, wheels=("fr", "rr"))
    with pytest.raises(ValueError, match="no finite variance"):
        ss.ride_metrics(ss.FullCar(), one_track)
    steep = ss.Road(tracks="independent", waviness=3.0)
    with pytest.raises(ValueError, match="no finite variance"):
        ss.ride_metrics(ss.FullCar(), steep, method="spectral")


def test_one_missing_damper_is_no_undamped_mode():
    car = ss.FullCar(cs=ss.Corners(fr=1500.0, fl=1500.0, rr=0.0, rl=1500.0))
    metrics = ss.ride_metrics(car, ss.Road())
    assert_agree(metrics, ss.ride_metrics(car, ss.Road(), method="spectral"), 1e-6, car)
    assert float(metrics.damper_power.sel(corner="rr")) == 0.0


def test_coincident_rates_of_cutoff_and_coherence():
    # A cut-off at one of the fit's own rates makes its partial fractions coincide.
    from susp_ss.roads.colours import COHERENCE_RATES

    car = ss.RollHalfCar()
    for rate in COHERENCE_RATES[1:3]:
        cutoff = rate / (2 * car.c) / (2 * np.pi)
        at, near = (ss.ride_metrics(car, ss.Road(tracks="isotropic", cutoff=c)) for c in (cutoff, cutoff * (1 + 1e-4)))
        for name in at:
            np.testing.assert_allclose(at[name], near[name], rtol=1e-4)


@pytest.mark.parametrize("tracks", ["independent", "isotropic"])
@pytest.mark.parametrize("waviness", [1.5, 2.5])
def test_spectral_route_of_a_warped_road_of_any_waviness(tracks, waviness):
    # Front and rear warps grow without bound towards low frequency and all but cancel.
    vehicle, road = VEHICLES["full, bars"], ss.Road(tracks=tracks, waviness=waviness)
    oracle = models.oracle(vehicle)
    expected = oracles.metrics(oracle, oracles.variance_spectral(oracle, models.oracle_road(road)))
    ours = by_name(ss.ride_metrics(vehicle, road, method="spectral"))
    for key, value in expected.items():
        np.testing.assert_allclose(ours[key], value, rtol=1e-6, err_msg=key)


@pytest.mark.parametrize("ct", [300.0, 5000.0])
@pytest.mark.parametrize("speed", [2.0, 20.0, 200.0])
def test_interference_of_delayed_wheels_fades_within_the_tolerance(ct, speed):
    # With tyre damping accelerations fall off so slowly that the delay's oscillation reaches far up the spectrum.
    car, road = ss.FullCar(ct=ct), ss.Road(speed=speed)
    assert_agree(ss.ride_metrics(car, road), ss.ride_metrics(car, road, method="spectral"), 1e-6, car)
