"""Road spectra: ISO 8608, the factor of two in the intensity, and the coherence of an isotropic surface."""

import mpmath
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import quad

import oracles
import susp_ss as ss


def test_classes_are_geometric_means():
    for i, name in enumerate("ABCDEFGH"):
        assert ss.Road.iso8608(name).roughness == 16e-6 * 4**i
    # Neighbouring classes meet at twice the one's mean and half the other's.
    assert 2 * ss.Road.iso8608("A").roughness == ss.Road.iso8608("B").roughness / 2


def test_spectrum_and_intensity():
    road = ss.Road(roughness=64e-6, speed=20.0)
    assert float(road.psd(0.1)) == 64e-6
    np.testing.assert_allclose(road.psd(np.array([0.05, 0.2])), [4 * 64e-6, 64e-6 / 4])
    f = 3.0
    one_sided_velocity = (2 * np.pi * f) ** 2 * road.psd(f / road.speed) / road.speed
    np.testing.assert_allclose(one_sided_velocity, 2 * road.intensity)
    np.testing.assert_allclose(road.intensity, oracles.road_intensity(64e-6, 20.0))


def test_cutoff_bounds_the_variance():
    road = ss.Road(cutoff=0.02, speed=15.0)
    variance = quad(lambda u: float(road.psd(np.exp(u))) * np.exp(u), -40, 40, limit=400)[0]
    np.testing.assert_allclose(variance, road.intensity / (2 * 2 * np.pi * 0.02 * 15.0), rtol=1e-7)


@given(st.floats(1.01, 3.9), st.floats(1e-8, 30.0))
@settings(max_examples=150)
def test_isotropic_coherence_against_multiple_precision(waviness, x):
    road = ss.Road(tracks="isotropic", waviness=waviness)
    width = 1.446
    n = x / (2 * np.pi * width)
    with mpmath.workdps(60):
        v, z = mpmath.mpf(waviness) / 2, mpmath.mpf(2 * np.pi) * n * width
        exact = 1 - 2 / mpmath.gamma(v) * (z / 2) ** v * mpmath.besselk(v, z)
    # Two leading terms of the series cancel near waviness 2, and the direct formula loses digits where it takes over.
    np.testing.assert_allclose(float(road.incoherence(n, width)), float(exact), rtol=2e-5)
    np.testing.assert_allclose(float(road.coherence(n, width)), float(1 - exact), rtol=1e-9, atol=1e-9)


def test_isotropic_coherence_is_that_of_two_lines_on_a_surface():
    n, width = np.array([0.01, 0.1, 0.5]), 1.446
    road = ss.Road(tracks="isotropic")
    np.testing.assert_allclose(road.coherence(n, width), oracles.coherence_isotropic(n, width), rtol=1e-12)
    # Integrate the two-dimensional spectrum (n^2 + m^2)^(-3/2) across the direction of travel.
    across = 2 * np.pi * width
    for wavenumber in n:

        def density(m, wavenumber=wavenumber):
            return (wavenumber**2 + m**2) ** -1.5

        crossed = quad(density, 0, np.inf, weight="cos", wvar=across, limit=500)[0]
        np.testing.assert_allclose(road.coherence(wavenumber, width), crossed / quad(density, 0, np.inf)[0], rtol=1e-5)


def test_cross_spectra():
    n, road = np.array([0.05, 0.3]), ss.Road(tracks="isotropic")
    np.testing.assert_allclose(road.cross_psd(n), road.psd(n))
    np.testing.assert_allclose(road.cross_psd(n, 1.4), road.coherence(n, 1.4) * road.psd(n))
    np.testing.assert_allclose(road.cross_psd(n, 0.0, 2.465), road.psd(n) * np.exp(-2j * np.pi * n * 2.465))
    np.testing.assert_allclose(ss.Road(tracks="independent").cross_psd(n, 1.4), 0.0)
    np.testing.assert_allclose(ss.Road(tracks="identical").cross_psd(n, 1.4), road.psd(n))
    np.testing.assert_allclose(ss.Road(delay=False).cross_psd(n, 0.0, 2.465), road.psd(n))


def test_describe_says_everything():
    road = ss.Road(cutoff=0.01, wheels=("fr", "fl"), delay=False, tracks="isotropic", waviness=2.5)
    line = road.describe()
    assert "\n" not in line
    for word in ("6.4e-05 m^3", "waviness 2.5", "cut-off 0.01", "20 m/s", "isotropic", "no axle delay", "fr, fl"):
        assert word in line


@pytest.mark.parametrize(
    ("settings", "error", "words"),
    [
        ({"roughness": 0.0}, ValueError, "roughness=...\\) must be > 0 m\\^3, got 0.0"),
        ({"roughness": np.nan}, ValueError, "roughness=...\\) must be > 0 m\\^3, got nan"),
        ({"speed": 0}, ValueError, "speed=...\\) must be > 0 m/s, got 0"),
        ({"speed": None}, TypeError, "speed=...\\) must be > 0 m/s, got None"),
        ({"speed": "20"}, TypeError, "speed"),
        ({"speed": True}, TypeError, "speed"),
        ({"speed": np.array([10.0, -20.0])}, ValueError, "speed=...\\) must be > 0 m/s, got -20.0 at \\(design=1\\)"),
        ({"waviness": 1.0}, ValueError, "> 1 and < 4, got 1.0"),
        ({"waviness": np.inf}, ValueError, "waviness"),
        ({"cutoff": -0.1}, ValueError, "cutoff=...\\) must be >= 0 cycle/m"),
        ({"tracks": "parallel"}, ValueError, "one of identical, independent, isotropic, got 'parallel'"),
        ({"delay": 1}, TypeError, "delay=...\\) must be True or False"),
        ({"wheels": "fr"}, TypeError, "sequence of names"),
        ({"wheels": ()}, ValueError, "at least one wheel"),
        ({"wheels": (1,)}, TypeError, "sequence of names"),
        ({"wheels": 3}, TypeError, "sequence of names"),
    ],
)
def test_bad_roads(settings, error, words):
    with pytest.raises(error, match=words):
        ss.Road(**settings)


@pytest.mark.parametrize("n", [0.0, -1.0, np.nan, [0.1, np.inf]])
def test_bad_wavenumbers(n):
    road = ss.Road(tracks="isotropic")
    for spectrum in (road.psd, lambda n: road.coherence(n, 1.4), lambda n: road.cross_psd(n, 1.4)):
        with pytest.raises(ValueError, match="finite and > 0 cycle/m"):
            spectrum(n)
        with pytest.raises(TypeError, match="must be wavenumbers"):
            spectrum(None)


def test_bad_classes_and_wheels():
    with pytest.raises(ValueError, match="one of A, B"):
        ss.Road.iso8608(["B"])
    with pytest.raises(ValueError, match="one of A, B, C, D, E, F, G, H, got 'Z'"):
        ss.Road.iso8608("Z")
    with pytest.raises(ValueError, match="takes its roughness from the class"):
        ss.Road.iso8608("B", roughness=1e-5)
    with pytest.raises(ValueError, match="no wheel named 'rear', available: fr, fl, rr, rl"):
        ss.ride_metrics(ss.FullCar(), ss.Road(wheels=("rear",)))
    with pytest.raises(ValueError, match="no wheel named 'fr', available: none"):
        ss.ride_metrics(ss.QuarterCar(), ss.Road(wheels=("fr",)))
