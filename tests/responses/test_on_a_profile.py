"""Vehicles on profiles: every wheel on its own track at its own time, and what is refused."""

import numpy as np
import pytest
import xarray as xr

import susp_ss as ss

X = np.concatenate([np.linspace(0.0, 4.0, 17), [4.05, 4.3, 4.5], np.linspace(5.0, 30.0, 40)])


def profile(left=None, right=None, x=X, **attrs):
    left = 0.03 * np.exp(-((x - 8.0) ** 2)) if left is None else left
    right = 0.02 * np.sin(0.9 * x) * np.exp(-((0.1 * x) ** 2)) if right is None else right
    attrs = {"units": "m"} | attrs
    return xr.Dataset({"left": ("x", left, attrs), "right": ("x", right, attrs)}, {"x": ("x", x, {"units": "m"})})


CARS = {
    "quarter": (ss.QuarterCar(), [(0, 0.0)]),
    "pitch half": (ss.PitchHalfCar(), [(0, 0.0), (0, 2.465)]),
    "roll half": (ss.RollHalfCar(), [(-1, 0.0), (1, 0.0)]),
    "full": (ss.FullCar(), [(-1, 0.0), (1, 0.0), (-1, 2.465), (1, 2.465)]),
    "truck": (
        ss.ThreeAxleTruck(),
        [(-1, 0.0), (1, 0.0), (-1, 4.6), (1, 4.6), (-1, 5.95), (1, 5.95)],
    ),
    "curves": (
        ss.FullCar(cs=ss.DamperCurve.two_slopes(800.0, 2000.0)),
        [(-1, 0.0), (1, 0.0), (-1, 2.465), (1, 2.465)],
    ),
    "moving": (ss.RideHandlingCar(speed=31.0), [(-1, 0.0), (1, 0.0), (-1, 2.465), (1, 2.465)]),
}


@pytest.mark.parametrize("name", CARS)
def test_each_wheel_meets_its_track_as_far_behind_as_its_axle_is(name):
    car, wheels = CARS[name]
    given = profile()
    ride = ss.simulate(car, given, speed=10.0, step=0.002)
    time = 0.002 * np.arange(1501)
    np.testing.assert_allclose(ride.time, time, atol=1e-12)
    np.testing.assert_allclose(ride.x, 10.0 * time, atol=1e-12)
    tracks = {-1: given.right, 1: given.left, 0: 0.5 * (given.left + given.right)}
    heights = [np.interp(10.0 * time - behind, X, tracks[side]) for side, behind in wheels]
    expected = ss.simulate(car.moving(10.0), np.stack(heights), time)
    for variable in expected:
        np.testing.assert_allclose(ride[variable], expected[variable], rtol=1e-9, atol=1e-12)


def test_a_car_stands_on_the_first_heights():
    ride = ss.simulate(ss.FullCar(), profile(left=0.3 + 0.0 * X, right=0.1 + 0.0 * X), speed=10.0)
    for variable in ("bacc", "sws", "damper_power"):
        assert np.ptp(ride[variable].values, axis=-1).max() < 1e-9


def test_x_may_begin_anywhere_and_speed_scales_time():
    there = ss.simulate(ss.FullCar(), profile(x=X), speed=10.0)
    moved = profile().assign_coords(x=X - 120.0)
    np.testing.assert_allclose(ss.simulate(ss.FullCar(), moved, speed=10.0).bacc, there.bacc, atol=1e-9)


@pytest.mark.parametrize(
    ("given", "how", "error", "words"),
    [
        (profile(), {}, ValueError, "speed must be given"),
        (profile(), {"speed": 0.0}, ValueError, "speed must be > 0 m/s"),
        (profile(), {"speed": None}, ValueError, "speed must be given"),
        (profile(), {"speed": "fast"}, TypeError, "speed must be a number > 0 m/s"),
        (profile(), {"speed": 10.0, "step": np.nan}, ValueError, "step must be > 0 s"),
        (profile(), {"speed": 10.0, "step": 9.0}, ValueError, "step must be less than the 3 s"),
        (profile(), {"speed": 10.0, "time": [0.0, 1.0]}, ValueError, "time must be left out"),
        (profile(x=X / 15.0), {"speed": 10.0}, ValueError, "longer than the wheelbase of 2.465 m"),
        (profile(x=X[::-1]), {"speed": 10.0}, ValueError, "rising x, got 29.359 m after 30 m"),
        (profile(left=np.where(X == 30.0, np.nan, 0.0)), {"speed": 10.0}, ValueError, "'left' nan at point 59"),
        (profile(units="mm"), {"speed": 10.0}, ValueError, "'left' in mm"),
        (profile().drop_vars("right"), {"speed": 10.0}, ValueError, "no 'right' among"),
        (profile().rename(x="s"), {"speed": 10.0}, ValueError, "no 'x' among"),
        (profile().isel(x=[0]), {"speed": 10.0}, ValueError, "at least two points"),
        (profile(left=np.full(len(X), "low")), {"speed": 10.0}, ValueError, "'left' of <U3"),
        (np.zeros(9), {"speed": 10.0}, ValueError, "speed and step are for a profile"),
        (np.zeros(9), {}, TypeError, "time must be numbers in s"),
    ],
)
def test_what_is_no_profile_or_no_ride_on_one_is_refused(given, how, error, words):
    with pytest.raises(error, match=words):
        ss.simulate(ss.FullCar(), given, **how)
