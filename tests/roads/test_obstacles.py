"""Obstacles are what their names say, and what they do to a car at a speed follows from `simulate`."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import susp_ss as ss
from susp_ss.roads.obstacles import KINDS

DIPS = {"pothole": -1.0}


@pytest.mark.parametrize("kind", KINDS)
@given(
    height=st.floats(1e-3, 0.3),
    length=st.floats(0.5, 40.0),
    before=st.floats(0.1, 9.0),
    step=st.sampled_from([0.05, 0.013, 0.01]),
    track=st.sampled_from(["both", "left", "right"]),
)
def test_obstacle_is_as_high_as_long_and_where_it_is_told(kind, height, length, before, step, track):
    given = {"wavelengths": (0.5 * length, 0.5)} if kind == "swept sine" and length > 1.1 else {}
    if kind == "swept sine" and not given:
        return
    profile = ss.obstacle(kind, height, length, track=track, before=before, after=3.0, step=step, **given)
    x = profile.x.values
    assert (np.diff(x) > 0.0).all()
    assert np.diff(x).max() <= step * (1.0 + 1e-6)
    np.testing.assert_allclose(x[[0, -1]], [0.0, before + length + 3.0], atol=1e-9)
    for side in ("left", "right"):
        z = DIPS.get(kind, 1.0) * profile[side].values
        if track not in ("both", side):
            assert not z.any()
            continue
        assert z[x <= before].max() == 0.0
        # The top lies on a point, but of a wave between two.
        top = height * (1.0 - (0.5 * 2.0 * np.pi * step / 0.5) ** 2)
        assert top <= z.max() <= height * (1.0 + 1e-12)
        last = height if kind in ("kerb", "ramp") else 0.0
        np.testing.assert_allclose(z[x >= before + length - 1e-12], last, atol=1e-9)


def test_a_swept_sine_goes_through_its_wavelengths():
    profile = ss.obstacle("swept sine", 0.02, 200.0, wavelengths=(8.0, 1.0), before=1.0)
    x, z = profile.x.values - 1.0, profile.left.values
    up = x[1:][(z[:-1] <= 0.0) & (z[1:] > 0.0)]
    waves = np.diff(up)
    middle = 0.5 * (up[1:] + up[:-1])
    np.testing.assert_allclose(waves, 8.0 * (1.0 / 8.0) ** (middle / 200.0), rtol=0.02)
    assert z[-1] == pytest.approx(0.0, abs=1e-12)


def test_area_of_the_others():
    for kind, length, area in (
        ("bump", 1.2, 0.5 * 1.2),
        ("plank", 0.4, 0.4 - 0.02),
        ("speed table", 6.7, 6.7 - 1.8),
        ("pothole", 0.8, -(0.8 - 0.05)),
    ):
        profile = ss.obstacle(kind, 0.05, length)
        np.testing.assert_allclose(np.trapezoid(profile.left, profile.x), 0.05 * area, rtol=1e-3)


@pytest.mark.parametrize(
    ("given", "error", "words"),
    [
        ({"kind": "log"}, ValueError, "kind must be one of kerb, ramp, bump, .* got 'log'"),
        ({"kind": None}, ValueError, "kind must be one of"),
        ({"height": -0.1}, ValueError, "height must be > 0 m"),
        ({"height": np.nan}, ValueError, "height must be > 0 m and finite, got nan"),
        ({"length": "1"}, TypeError, "length must be a number > 0 m, got '1'"),
        ({"edge": 0.1}, ValueError, "edge is for speed table, pothole, plank, and a bump has none"),
        ({"kind": "plank", "edge": 0.15}, ValueError, "edge must be at most half of the length of 0.2 m"),
        ({"wavelengths": (5.0, 1.0)}, ValueError, "wavelengths is for swept sine"),
        ({"kind": "swept sine", "wavelengths": (1.0, 5.0)}, ValueError, "wavelengths must fall"),
        ({"kind": "swept sine", "wavelengths": 5.0}, TypeError, "wavelengths must be two numbers"),
        ({"kind": "swept sine", "wavelengths": (5.0, 0.05)}, ValueError, "10 steps or more"),
        ({"track": "middle"}, ValueError, "track must be one of both, left, right"),
        ({"before": 0.0}, ValueError, "before must be > 0 m"),
        ({"step": 1e-12}, ValueError, "step must make at most"),
    ],
)
def test_bad_obstacles_are_refused(given, error, words):
    with pytest.raises(error, match=words):
        ss.obstacle(**{"kind": "bump", **given})


def test_peaks_are_those_of_each_simulation():
    car, bump = ss.PitchHalfCar(), ss.obstacle("bump", length=0.8, after=10.0)
    worst = ss.peaks(car, bump, [3.0, 12.0])
    assert worst.speed.attrs["units"] == "m/s"
    assert "time" not in worst.dims
    assert "x" not in worst.coords
    for speed in (3.0, 12.0):
        ride = ss.simulate(car, bump, speed=speed)
        for name in ("bacc", "sws", "dtl", "pitch_acc", "damper_power"):
            np.testing.assert_array_equal(worst[name].sel(speed=speed), np.abs(ride[name]).max("time"))
    assert worst.sws.attrs["units"] == "m"


def test_a_slow_ramp_is_followed_quasi_statically():
    # At a walking pace both axles end on the ramp's height; the pitch in between is height over wheelbase.
    car = ss.QuarterCar(cs=3000.0)
    worst = ss.peaks(car, ss.obstacle("ramp", 0.05, 8.0, after=2.0), [0.5], step=0.002)
    assert float(worst.sws[0]) < 1e-3


@pytest.mark.parametrize("speeds", [3.0, [], ["fast"], [[3.0]], None])
def test_speeds_are_a_row_of_numbers(speeds):
    with pytest.raises(TypeError, match="speeds must be one row of numbers in m/s"):
        ss.peaks(ss.QuarterCar(), ss.obstacle("bump"), speeds)
    with pytest.raises(ValueError, match="speeds must be > 0 m/s"):
        ss.peaks(ss.QuarterCar(), ss.obstacle("bump"), [3.0, -1.0])
