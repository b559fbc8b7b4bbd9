"""Synthesised profiles have the second moments of the road they are drawn from."""

from itertools import pairwise

import numpy as np
import pytest
from scipy.signal import csd, welch

import susp_ss as ss
from susp_ss.roads import wheel_heights


def test_increments_are_those_of_the_road():
    # With waviness 2 the height is Brownian: E[(z(t + s) - z(t))^2] = q s at every lag, down to one sample.
    road, step = ss.Road(speed=10.0), 0.01
    z = np.concatenate([wheel_heights(road, 100.0, step, seed=seed)[0][:5000] for seed in range(20)]).reshape(20, -1)
    for lag in (1, 2, 10):
        mean_square = np.mean((z[:, lag:] - z[:, :-lag]) ** 2)
        np.testing.assert_allclose(mean_square, road.intensity * lag * step, rtol=0.05)


def test_tracks_have_the_coherence_of_the_surface():
    road, width, step = ss.Road(tracks="isotropic", speed=20.0), 1.446, 0.01
    wheels = {"sides": (1, -1), "delays": (0.0, 0.0), "track_width": width}
    records = np.array([wheel_heights(road, 40.0, step, **wheels, seed=seed) for seed in range(200)])
    left, right = records[:, 0], records[:, 1]
    L, R = np.fft.rfft(left), np.fft.rfft(right)
    f = np.fft.rfftfreq(left.shape[1], step)
    for n in (0.05, 0.2):
        band = np.abs(f / road.speed - n) < 0.1 * n
        cross = np.mean((L * R.conj()).real[:, band]) / np.mean(0.5 * (np.abs(L) ** 2 + np.abs(R) ** 2)[:, band])
        np.testing.assert_allclose(cross, road.coherence(n, width), atol=0.05)


def test_delayed_wheels_see_the_same_profile_later():
    front, rear = wheel_heights(ss.Road(), 10.0, 0.01, sides=(0, 0), delays=(0.0, 0.13))
    np.testing.assert_allclose(np.roll(front, 13), rear, atol=1e-12)


@pytest.mark.parametrize("waviness", [1.5, 2.0, 3.0])
def test_spectrum_of_the_samples_is_folded(waviness):
    road, step = ss.Road(waviness=waviness, cutoff=0.001), 0.05
    samples = [wheel_heights(road, 50.0, step, seed=seed)[0] for seed in range(150)]
    power = np.mean(np.abs(np.fft.rfft(samples)) ** 2, axis=0) * 2 * step / len(samples[0])
    f = np.fft.rfftfreq(len(samples[0]), step)[1:-1]
    folded = sum(road.psd(np.abs(f + k / step) / road.speed) / road.speed for k in range(-3000, 3001))
    np.testing.assert_allclose(np.mean(power[1:-1] / folded), 1.0, atol=0.02)
    top = f > 0.9 * f[-1]
    np.testing.assert_allclose(np.mean(power[1:-1][top] / folded[top]), 1.0, atol=0.05)


OCTAVES = 2.0 ** np.arange(-6.5, 2.0)
"""Edges of ISO 8608's octaves from 0.011 to 2.83 cycle/m."""

ROADS = {
    "class C": ss.Road.iso8608("C"),
    "independent": ss.Road(waviness=2.5, tracks="independent"),
    "isotropic": ss.Road(tracks="isotropic"),
    "isotropic, waviness 1.6": ss.Road(waviness=1.6, tracks="isotropic", cutoff=0.02),
    "two slopes": ss.Road.two_slope(waviness=(3.0, 1.8), knee=0.2, tracks="isotropic"),
    "measured": ss.Road.from_psd([0.02, 0.1, 0.3, 1.0], [1e-3, 7e-5, 2e-5, 4e-7], (2.0, 2.4), tracks="isotropic"),
    "contact": ss.Road(tracks="isotropic", contact_length=0.3),
}


@pytest.mark.parametrize("road", ROADS.values(), ids=ROADS)
def test_profile_has_the_spectrum_and_coherence_of_its_road(road):
    # Harmonics of a periodic profile are independent: means over M of them scatter by 1 / sqrt(M), four of which may
    # be met once in ten thousand times.
    length, step, width = 20e3, 0.1, 1.6
    profile = ss.synthesise(road, length, step, seed=1, track_width=width)
    n = np.fft.rfftfreq(profile.sizes["x"], step)
    left, right = (np.fft.rfft(profile[name]) * np.sqrt(2.0 * step / profile.sizes["x"]) for name in ("left", "right"))
    for low, high in pairwise(OCTAVES):
        band = (n >= low) & (n < high)
        G, gamma, M = road.psd(n[band]), road.coherence(n[band], width), band.sum()
        for track in (left, right):
            assert abs(np.mean(np.abs(track[band]) ** 2 / G) - 1.0) < 4.0 / np.sqrt(M)
        cross = np.mean((left * right.conj()).real[band] / G)
        assert abs(cross - gamma.mean()) < 4.0 * np.sqrt(np.mean(1.0 + gamma**2) / (2.0 * M))


def test_another_estimator_says_the_same():
    road, step, width = ss.Road(tracks="isotropic"), 0.05, 1.446
    profile = ss.synthesise(road, 10e3, step, seed=2)
    n, G = welch(profile.left, 1.0 / step, nperseg=2**14)
    across = csd(profile.left, profile.right, 1.0 / step, nperseg=2**14)[1].real / G
    for low, high in pairwise(OCTAVES[1:]):
        band = (n >= low) & (n < high)
        sure = np.sqrt(high - low) * np.sqrt(10e3)
        np.testing.assert_allclose(np.mean(G[band] / road.psd(n[band])), 1.0, atol=0.02 + 4.0 / sure)
        np.testing.assert_allclose(np.mean(across[band]), road.coherence(n[band], width).mean(), atol=4.0 / sure)


def test_profile_of_another_seed_is_another_and_of_the_same_the_same():
    road = ss.Road(tracks="isotropic")
    first, again, other = (ss.synthesise(road, 100.0, 0.1, seed=seed) for seed in (3, 3, 4))
    assert first.identical(again)
    assert not np.allclose(first.left, other.left)
    assert first.x.attrs["units"] == first.left.attrs["units"] == first.right.attrs["units"] == "m"
    np.testing.assert_array_equal(first.x, 0.1 * np.arange(1000))
    assert ss.synthesise(road, 0.7, 0.1).sizes["x"] == 7
    same = ss.synthesise(ss.Road(), 100.0, 0.1)
    np.testing.assert_array_equal(same.left, same.right)


def test_speed_is_none_of_a_profile_s_business():
    slow, fast = (ss.synthesise(ss.Road(speed=speed, tracks="isotropic"), 500.0, 0.1) for speed in (3.0, 30.0))
    np.testing.assert_array_equal(slow.left, fast.left)


@pytest.mark.parametrize(
    ("given", "error", "words"),
    [
        ({"road": "B"}, TypeError, "road must be a Road"),
        ({"road": ss.Road(roughness=np.array([1e-6, 2e-6]))}, ValueError, "one speed, roughness and cutoff"),
        ({"length": None}, TypeError, "length must be a number > 0 m, got None"),
        ({"length": np.nan}, ValueError, "length must be > 0 m and finite, got nan"),
        ({"step": 0.0}, ValueError, "step must be > 0 m"),
        ({"step": True}, TypeError, "step must be a number"),
        ({"length": 1.0, "step": 2.0}, ValueError, "must make 2 points or more"),
        ({"length": 1e9}, ValueError, "at most 1e[+]08, got 1e[+]09 m by 0.1 m"),
        ({"seed": -1}, ValueError, "seed must be a whole number >= 0"),
        ({"seed": None}, ValueError, "seed must be a whole number"),
        ({"track_width": 0.0}, ValueError, "track_width must be > 0 m"),
    ],
)
def test_bad_profiles_are_refused(given, error, words):
    with pytest.raises(error, match=words):
        ss.synthesise(**{"road": ss.Road(), "length": 100.0, "step": 0.1, **given})
