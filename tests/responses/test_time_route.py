"""The time route: within its own stated error of the exact metrics, and that error honest."""

import numpy as np
import pytest

import susp_ss as ss
from models import ROADS, VEHICLES

CASES = [
    ("rigid tyre", "identical"),
    ("quarter", "identical"),
    ("quarter, tyre damping", "identical"),
    ("pitch half, unequal ends", "identical"),
    ("pitch half", "identical, no delay"),
    ("roll half, unequal sides, bar", "isotropic"),
    ("roll half", "independent"),
    ("full", "isotropic"),
    ("full, bars", "independent"),
    ("full", "identical"),
    ("full, unequal corners", "independent, no delay"),
    ("full, unequal corners, bars, tyre damping", "isotropic, cut-off"),
]


def deviations(metrics, exact):
    """Of all finite, nonzero metrics: standard error relative to the value, and deviation in standard errors."""
    errors, scores = [], []
    for name, data in exact.items():
        value, stderr, expected = metrics[name].values, metrics[f"{name}_stderr"].values, data.values
        np.testing.assert_array_equal(np.isinf(value), np.isinf(expected))
        counts = np.isfinite(expected) & (expected > 1e-6)
        errors.append((stderr[counts] / expected[counts]).ravel())
        scores.append(((value[counts] - expected[counts]) / stderr[counts]).ravel())
    return np.concatenate(errors), np.concatenate(scores)


@pytest.mark.parametrize(("name", "ground"), CASES)
def test_time_route_is_within_its_standard_error(name, ground):
    vehicle, road = VEHICLES[name], ROADS[ground]
    exact = ss.ride_metrics(vehicle, road)
    errors, scores = deviations(ss.ride_metrics(vehicle, road, method="time", seed=7), exact)
    assert len(errors) > 0
    assert errors.max() < 0.02
    assert np.abs(scores).max() < 4.0


@pytest.mark.slow
@pytest.mark.parametrize("name", ["rigid tyre", "quarter", "full, unequal corners"])
def test_standard_errors_are_calibrated_over_fifty_seeds(name):
    vehicle, road = VEHICLES[name], ss.Road(tracks="isotropic")
    exact = ss.ride_metrics(vehicle, road)
    scores = [
        deviations(ss.ride_metrics(vehicle, road, method="time", duration=60.0, step=0.004, seed=seed), exact)[1]
        for seed in range(50)
    ]
    spread = np.std(scores, axis=0, ddof=1)
    assert (spread > 0.7).all(), spread
    assert (spread < 1.3).all(), spread


def test_any_waviness():
    road = ss.Road(waviness=2.5, tracks="isotropic")
    exact = ss.ride_metrics(ss.FullCar(), road, method="spectral")
    _, scores = deviations(ss.ride_metrics(ss.FullCar(), road, method="time", duration=200.0, seed=3), exact)
    assert np.abs(scores).max() < 4.0


def test_seeds_repeat_and_differ():
    car, road = ss.QuarterCar(), ss.Road()
    first, again, other = (
        float(ss.ride_metrics(car, road, method="time", duration=20.0, seed=seed).sws) for seed in (1, 1, 2)
    )
    assert first == again != other


def test_sweeps_keep_their_shape():
    cars = ss.QuarterCar(cs=np.array([1000.0, 2000.0]))
    metrics = ss.ride_metrics(cars, ss.Road(), method="time", duration=20.0)
    assert metrics.sws.dims == metrics.sws_stderr.dims == ("design",)
    assert float(metrics.sws[0]) > float(metrics.sws[1])


@pytest.mark.parametrize(
    ("settings", "error", "words"),
    [
        ({"duration": -1.0}, ValueError, "duration must be > 0 s"),
        ({"duration": np.nan}, ValueError, "duration must be > 0 s"),
        ({"step": 0.0}, ValueError, "step must be > 0 s"),
        ({"step": "fast"}, TypeError, "step must be a number"),
        ({"duration": 0.1, "step": 0.01}, ValueError, "at least 100 steps"),
        ({"seed": -1}, ValueError, "seed must be a whole number"),
        ({"seed": 1.5}, ValueError, "seed must be a whole number"),
    ],
)
def test_bad_settings(settings, error, words):
    with pytest.raises(error, match=words):
        ss.ride_metrics(ss.QuarterCar(), ss.Road(), method="time", **settings)


def test_a_coarse_step_is_shortened_to_resolve_wheel_hop():
    exact = ss.ride_metrics(ss.QuarterCar(), ss.Road())
    coarse = ss.ride_metrics(ss.QuarterCar(), ss.Road(), method="time", duration=300.0, step=1.0, seed=2)
    _, scores = deviations(coarse, exact)
    assert np.abs(scores).max() < 4.0


def test_records_beyond_memory_are_refused():
    for settings in ({"duration": 1e12}, {"duration": 10.0}):
        with pytest.raises(ValueError, match="time steps"):
            ss.ride_metrics(ss.QuarterCar(cs=1e-3), ss.Road(), method="time", **settings)
