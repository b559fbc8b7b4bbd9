"""Extremes and fatigue against quadrature of what they approximate, limits, and one another."""

import numpy as np
import pytest
import scipy.integrate
import scipy.special
import scipy.stats
from hypothesis import given, settings
from hypothesis import strategies as st

from susp_ss.metrics import extremes
from susp_ss.metrics.extremes import Gaussian


def of_band(low, high):
    """A process of unit variance whose spectrum is level between two frequencies in rad/s."""
    return Gaussian(*(np.array((high ** (k + 1) - low ** (k + 1)) / (k + 1) / (high - low)) for k in (0, 1, 2, 4)))


def test_rates_and_shapes_of_a_level_band():
    process = of_band(0.0, 6.0)
    assert process.rate == pytest.approx(6.0 / np.sqrt(3.0) / (2.0 * np.pi))
    assert process.irregularity == pytest.approx(np.sqrt(5.0) / 3.0)
    assert process.bandwidth == pytest.approx(0.5)
    assert of_band(5.99, 6.01).irregularity == pytest.approx(1.0, abs=1e-5)
    assert of_band(5.99, 6.01).bandwidth == pytest.approx(0.0, abs=1e-3)


@pytest.mark.parametrize("waves", [30.0, 1e3, 1e6])
@pytest.mark.parametrize("irregularity", [0.3, 0.75, 1.0])
def test_peaks_are_those_of_rice_s_distribution(waves, irregularity):
    g, e = irregularity, np.sqrt(1.0 - irregularity**2)

    def above(r):
        rayleigh = g * np.exp(-0.5 * r**2) * scipy.stats.norm.cdf(r * g / e) if e else np.exp(-0.5 * r**2)
        return rayleigh + (scipy.stats.norm.sf(r / e) if e else 0.0)

    def exceeded(r):
        return -np.expm1(waves / g * np.log1p(-min(above(r), 1.0)))

    # Rice's tail is g e^(-r^2/2) to what is left of the normal one, which counts where there are few waves.
    mean = scipy.integrate.quad(exceeded, 1e-9, 12.0, limit=200)[0]
    rel = 0.015 if waves < 100.0 else 5e-3
    assert extremes.cartwright(np.array(waves), np.array(g)) == pytest.approx(mean, rel=rel)


@settings(max_examples=20)
@given(st.floats(1e3, 1e9), st.floats(0.02, 1.0))
def test_clumps_make_the_highest_value_lower(waves, bandwidth):
    one_by_one = extremes.cartwright(np.array(waves), np.array(0.0))
    assert extremes.vanmarcke(np.array(waves), np.array(bandwidth)) < 1.001 * one_by_one
    narrower = extremes.vanmarcke(np.array(waves), np.array(0.5 * bandwidth))
    assert narrower < extremes.vanmarcke(np.array(waves), np.array(bandwidth))


def test_all_estimates_meet_where_the_stretch_is_long():
    N = np.array(1e9)
    one_by_one = scipy.integrate.quad(lambda r: -np.expm1(-N * np.exp(-0.5 * r**2)), 0.0, 12.0)[0]
    assert extremes.cartwright(N, np.array(0.0)) == pytest.approx(one_by_one, rel=1e-8)
    assert extremes.davenport(N) == pytest.approx(one_by_one, rel=3e-3)
    assert extremes.vanmarcke(N, np.array(1.0)) == pytest.approx(one_by_one, rel=1e-4)


def test_probabilities_keep_their_digits_and_their_limits():
    process, seconds = of_band(0.0, 6.0), np.array(50.0)
    # Crossings of a high level come one by one, and seldom.
    rare = process.reaching(np.array(12.0), seconds)
    assert rare == pytest.approx(process.passing(np.array(12.0)) * seconds, rel=0.02)
    assert process.reaching(np.array(-1.0), seconds) == pytest.approx(1.0)
    assert process.reaching(np.array(1e3), seconds) == pytest.approx(0.0, abs=1e-200)
    # In no time at all, what is above the level already is left.
    assert process.reaching(np.array(2.0), np.array(0.0)) == pytest.approx(np.exp(-2.0))


@pytest.mark.parametrize("slope", [1.0, 3.0, 5.0, 12.0])
def test_damage_of_a_narrow_band_is_that_of_rayleigh_peaks(slope):
    process = of_band(5.7, 6.3)
    narrow, rainflow = process.ranges(slope)
    ranges = scipy.integrate.quad(lambda r: (2.0 * r) ** slope * r * np.exp(-0.5 * r**2), 0.0, 30.0)[0]
    assert narrow == pytest.approx(process.rate * ranges, rel=1e-9)
    assert rainflow == pytest.approx(narrow, rel=0.05)
    # The wider a band, the more a cycle a wave says too much.
    narrow, rainflow = of_band(0.0, 6.0).ranges(slope)
    assert rainflow < narrow or slope == 1.0


def test_dirlik_is_the_integral_of_its_density():
    process = of_band(0.5, 6.0)
    m0, m1, m2, m4 = process
    g, mean = m2 / np.sqrt(m0 * m4), m1 / m0 * np.sqrt(m2 / m4)
    D1 = 2.0 * (mean - g**2) / (1.0 + g**2)
    R = (g - mean - D1**2) / (1.0 - g - D1 + D1**2)
    D2 = (1.0 - g - D1 + D1**2) / (1.0 - R)
    Q = 1.25 * (g - (1.0 - D1 - D2) - D2 * R) / D1

    def density(z):
        return (
            D1 / Q * np.exp(-z / Q)
            + D2 * z / R**2 * np.exp(-0.5 * (z / R) ** 2)
            + (1.0 - D1 - D2) * z * np.exp(-0.5 * z**2)
        )

    assert scipy.integrate.quad(density, 0.0, 60.0)[0] == pytest.approx(1.0)
    peaks = np.sqrt(m4 / m2) / (2.0 * np.pi)
    expected = peaks * scipy.integrate.quad(lambda z: (2.0 * z) ** 4 * density(z), 0.0, 60.0)[0]
    assert process.ranges(4.0)[1] == pytest.approx(expected, rel=1e-7)


def test_a_process_at_rest_or_of_infinite_rate():
    still = Gaussian(*np.zeros((4, 1)))
    assert still.rate == still.passing(np.array(1.0)) == 0.0
    assert still.reaching(np.array(1.0), np.array(100.0)) == pytest.approx(0.0, abs=1e-200)
    np.testing.assert_array_equal(still.highest(np.array(100.0)), np.zeros((1, 3)))
    np.testing.assert_array_equal(still.ranges(3.0), np.zeros((1, 2)))
    rough = Gaussian(np.array([1.0]), *np.full((3, 1), np.inf))
    assert rough.rate == np.inf
    assert np.isinf(rough.highest(np.array(1.0))).all()
