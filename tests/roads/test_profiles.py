"""Synthesised profiles have the second moments of the road they are drawn from."""

import numpy as np
import pytest

import susp_ss as ss
from susp_ss.roads import synthesise


def test_increments_are_those_of_the_road():
    # With waviness 2 the height is Brownian: E[(z(t + s) - z(t))^2] = q s at every lag, down to one sample.
    road, step = ss.Road(speed=10.0), 0.01
    z = np.concatenate([synthesise(road, 100.0, step, seed=seed)[0][:5000] for seed in range(20)]).reshape(20, -1)
    for lag in (1, 2, 10):
        mean_square = np.mean((z[:, lag:] - z[:, :-lag]) ** 2)
        np.testing.assert_allclose(mean_square, road.intensity * lag * step, rtol=0.05)


def test_tracks_have_the_coherence_of_the_surface():
    road, width, step = ss.Road(tracks="isotropic", speed=20.0), 1.446, 0.01
    wheels = {"sides": (1, -1), "delays": (0.0, 0.0), "track_width": width}
    records = np.array([synthesise(road, 40.0, step, **wheels, seed=seed) for seed in range(200)])
    left, right = records[:, 0], records[:, 1]
    L, R = np.fft.rfft(left), np.fft.rfft(right)
    f = np.fft.rfftfreq(left.shape[1], step)
    for n in (0.05, 0.2):
        band = np.abs(f / road.speed - n) < 0.1 * n
        cross = np.mean((L * R.conj()).real[:, band]) / np.mean(0.5 * (np.abs(L) ** 2 + np.abs(R) ** 2)[:, band])
        np.testing.assert_allclose(cross, road.coherence(n, width), atol=0.05)


def test_delayed_wheels_see_the_same_profile_later():
    front, rear = synthesise(ss.Road(), 10.0, 0.01, sides=(0, 0), delays=(0.0, 0.13))
    np.testing.assert_allclose(np.roll(front, 13), rear, atol=1e-12)


@pytest.mark.parametrize("waviness", [1.5, 2.0, 3.0])
def test_spectrum_of_the_samples_is_folded(waviness):
    road, step = ss.Road(waviness=waviness, cutoff=0.001), 0.05
    samples = [synthesise(road, 50.0, step, seed=seed)[0] for seed in range(400)]
    power = np.mean(np.abs(np.fft.rfft(samples)) ** 2, axis=0) * 2 * step / len(samples[0])
    f = np.fft.rfftfreq(len(samples[0]), step)[1:-1]
    folded = sum(road.psd(np.abs(f + k / step) / road.speed) / road.speed for k in range(-3000, 3001))
    np.testing.assert_allclose(np.mean(power[1:-1] / folded), 1.0, atol=0.02)
    top = f > 0.9 * f[-1]
    np.testing.assert_allclose(np.mean(power[1:-1][top] / folded[top]), 1.0, atol=0.05)
