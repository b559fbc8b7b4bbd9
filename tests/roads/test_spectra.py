"""Spectra that are no white velocity: first-order terms against the spectra themselves, and every route's variances."""

import mpmath
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import susp_ss as ss
from susp_ss.roads.colours import colours

CORNERS = ss.Corners(fr=16e3, fl=18e3, rr=21e3, rl=23e3)
CARS = {
    "quarter": ss.QuarterCar(),
    "pitch half": ss.PitchHalfCar(),
    "full": ss.FullCar(arb_rear=6e3),
    "full, unequal corners": ss.FullCar(ks=CORNERS, arb_front=9e3),
}


def density(terms, omega):
    """The two-sided spectrum that first-order terms stand for, at (F,) angular frequencies, of the first design."""
    level, alphas, low, high = terms.level[0, 0], terms.alphas[0], terms.low[0], terms.high[0]
    square = omega[:, None] ** 2
    return level + ((low * alphas**2 + high * square) / (alphas**2 + square)).sum(axis=1).real


def agree(car, road, rtol):
    """To rtol; what is zero by symmetry, to the rounding that an integral of large terms leaves of it."""
    exact, spectral = ss.ride_metrics(car, road), ss.ride_metrics(car, road, method="spectral")
    for name, data in spectral.items():
        np.testing.assert_allclose(exact[name], data, rtol=rtol, atol=1e-9, err_msg=name)


@given(waviness=st.floats(1.2, 3.8), part=st.sampled_from([0, 1, -1]), width=st.floats(0.5, 3.0))
@settings(max_examples=40)
def test_terms_are_the_spectrum(waviness, part, width):
    road = ss.Road(waviness=waviness, tracks="isotropic", speed=15.0)
    n = np.geomspace(2e-3, 50.0, 60)
    share = 1.0 if part == 0 else 0.5
    terms = colours(road, share, part, np.array([width]))
    apart = road.incoherence(n, width)
    wanted = {0: 1.0, 1: 1.0 - 0.5 * apart, -1: 0.5 * apart}[part]
    omega = 2.0 * np.pi * n * road.speed
    if waviness == 2.0 and part:
        return
    expected = 0.5 * wanted * omega**2 * road.psd(n) / road.speed / (2.0 * np.pi)
    np.testing.assert_allclose(density(terms, omega) / (2.0 * np.pi), expected, rtol=3e-5)


@pytest.mark.parametrize("waviness", [1.2, 1.5, 1.9, 2.1, 2.5, 2.9, 3.1, 3.5, 3.8])
@pytest.mark.parametrize("tracks", ["identical", "isotropic"])
@pytest.mark.parametrize("speed", [3.0, 60.0])
def test_any_waviness_within_1e_5_of_the_integral(waviness, tracks, speed):
    road = ss.Road(waviness=waviness, tracks=tracks, speed=speed)
    for name in ("quarter", "full"):
        agree(CARS[name], road, 5e-6)


@pytest.mark.parametrize("name", CARS)
def test_independent_tracks_below_waviness_3(name):
    agree(CARS[name], ss.Road(waviness=2.7, tracks="independent"), 1e-5)


def test_the_softest_and_hardest_of_the_study_on_the_roughest_spectra():
    for ks, cs in ((12536.0, 798.0), (24570.0, 2235.0)):
        for waviness in (1.2, 3.8):
            agree(ss.QuarterCar(ks=ks, cs=cs), ss.Road(waviness=waviness), 1e-5)


@pytest.mark.parametrize("tracks", ["identical", "independent", "isotropic"])
@pytest.mark.parametrize("cutoff", [0.0, 0.01])
@pytest.mark.parametrize("name", CARS)
def test_a_contact_patch(name, tracks, cutoff):
    agree(
        CARS[name], ss.Road(tracks=tracks, contact_length=0.15, cutoff=cutoff), 1e-4 if tracks == "isotropic" else 2e-6
    )


@pytest.mark.parametrize("car", [ss.QuarterCar(ct=80.0), ss.FullCar(ct=80.0), ss.FullCar(ks=CORNERS, ct=80.0)], ids=str)
@pytest.mark.parametrize(
    "road",
    [
        ss.Road(contact_length=0.1, tracks="independent"),
        ss.Road(waviness=3.4, tracks="isotropic"),
        ss.Road(contact_length=0.2, tracks="independent", cutoff=0.01, delay=False),
    ],
    ids=ss.Road.describe,
)
def test_a_velocity_of_finite_variance_is_passed_straight_on(car, road):
    assert np.isfinite(ss.ride_metrics(car, road).dtl).all()
    agree(car, road, 2e-6)


def test_a_rigid_tyre_on_a_contact_patch():
    """All that the closed form needs: one degree of freedom behind two first-order filters."""
    car, road = ss.RigidTyreQuarterCar(), ss.Road(contact_length=0.2)
    alpha = road.speed / road.contact_length
    with mpmath.workdps(30):

        def density(w):
            s = mpmath.mpc(0, w)
            H = s * (car.cs * s + car.ks) / (car.ms * s**2 + car.cs * s + car.ks)
            return abs(H) ** 2 * alpha**2 / (alpha**2 + w**2)

        variance = mpmath.quad(density, [0, 1, 5, 10, 50, 100, 1000, 1e5, mpmath.inf]) * road.intensity / mpmath.pi
    np.testing.assert_allclose(float(ss.ride_metrics(car, road).bacc) ** 2, float(variance), rtol=1e-9)


@pytest.mark.parametrize("knee", [0.05, 0.16, 0.5])
@pytest.mark.parametrize("waviness", [(2.0, 1.5), (3.0, 1.8), (1.5, 2.6)])
def test_two_slopes(knee, waviness):
    road = ss.Road.two_slope(waviness=waviness, knee=knee)
    assert float(road.psd(0.1)) == pytest.approx(64e-6)
    n = np.array([0.5 * knee, knee, 2.0 * knee])
    np.testing.assert_allclose(np.diff(np.log(road.psd(n))) / np.log(2.0), [-waviness[0], -waviness[1]])
    assert 0.0 < road.fit_error < 0.05
    agree(ss.QuarterCar(), road, 1e-3)


def test_two_equal_slopes_are_one():
    """The coherence of a surface taken apart into terms is Bessel's, and so are all metrics."""
    bent = ss.Road.two_slope(waviness=(2.4, 2.4), tracks="isotropic")
    plain = ss.Road(waviness=2.4, tracks="isotropic")
    n = np.geomspace(0.002, 20.0, 30)
    np.testing.assert_allclose(bent.incoherence(n, 1.4), plain.incoherence(n, 1.4), rtol=1e-5)
    metrics, expected = (ss.ride_metrics(ss.FullCar(), road) for road in (bent, plain))
    for name, data in expected.items():
        np.testing.assert_allclose(metrics[name], data, rtol=3e-6, err_msg=name)


def test_a_measured_spectrum_is_what_was_measured():
    n = np.geomspace(0.011, 2.83, 25)
    G = 64e-6 * (n / 0.1) ** -2.2 * (1.0 + 0.4 * np.sin(2.0 * np.log(n)))
    road = ss.Road.from_psd(n, G, waviness=(2.0, 2.5), tracks="isotropic")
    np.testing.assert_allclose(road.psd(n), G)
    np.testing.assert_allclose(road.psd(np.array([0.0055, 5.66])), [G[0] * 4.0, G[-1] * 2.0**-2.5])
    assert road.fit_error < 0.05
    agree(ss.QuarterCar(), road, 1e-3)
    agree(ss.FullCar(), road, 3e-3)


@pytest.mark.parametrize(
    ("call", "error", "words"),
    [
        (lambda: ss.Road.from_psd([0.1], [1e-6]), ValueError, "two or more finite numbers > 0 cycle/m"),
        (lambda: ss.Road.from_psd([0.1, 1.0], [1e-6, 0.0]), ValueError, "psd=.*> 0 m\\^3"),
        (lambda: ss.Road.from_psd([1.0, 0.1], [1e-6, 1e-5]), ValueError, "do not rise"),
        (lambda: ss.Road.from_psd([0.1, 1.0], [1e-6, 1e-5, 1e-4]), ValueError, "2 wavenumbers and 3 values"),
        (lambda: ss.Road.from_psd(["a", "b"], [1e-6, 1e-5]), TypeError, "wavenumber=...\\) must be one row of numbers"),
        (lambda: ss.Road.from_psd([0.1, 1.0], [1e-6, 1e-7], roughness=1e-6), ValueError, "reads the roughness off"),
        (lambda: ss.Road.from_psd([0.1, 1.0], [1e-6, 1e-7], waviness=5.0), ValueError, "> 1 and < 4"),
        (lambda: ss.Road.two_slope(knee=0.0), ValueError, "knee=...\\) must be > 0 cycle/m"),
        (lambda: ss.Road.two_slope(waviness=2.0), ValueError, "two exponents"),
        (lambda: ss.Road.two_slope(waviness=(2.0, 0.5)), ValueError, "> 1 and < 4"),
        (lambda: ss.Road(contact_length=-0.1), ValueError, "contact_length=...\\) must be >= 0 m"),
        (lambda: ss.Road(waviness=(2.0, 3.0)), ValueError, "> 1 and < 4"),
    ],
)
def test_what_is_no_spectrum(call, error, words):
    with pytest.raises(error, match=words):
        call()


@pytest.mark.parametrize("waviness", [(3.0, 1.8), (2.0, 1.5)])
def test_two_slopes_on_an_isotropic_surface(waviness):
    """The coherence by terms keeps its digits, so that the integral converges."""
    agree(ss.FullCar(), ss.Road.two_slope(waviness=waviness, knee=0.2, tracks="isotropic"), 1e-3)
