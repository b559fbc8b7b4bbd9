"""Roads from profiles: intervals hold the truth as often as they say, classes and tracks are told apart."""

import dataclasses

import numpy as np
import pytest
from scipy.signal import welch
from scipy.stats import binom

import susp_ss as ss
from susp_ss.roads.profile_spectra import band_edges, bands_of
from susp_ss.roads.profiles import profile_of

SEEDS, RECORDS = 40, 80

TRUTHS = {
    "class B": (ss.Road(tracks="isotropic"), 2000.0, 0.2),
    "steep, independent": (ss.Road(waviness=3.2, tracks="independent"), 1000.0, 0.25),
    "flat, one track, short": (ss.Road(roughness=3e-4, waviness=1.5), 300.0, 0.2),
}


def fits(truth, length, step):
    profiles = (ss.synthesise(truth, length, step, seed=seed) for seed in range(SEEDS))
    return [ss.fit_road(profile, confidence=0.9) for profile in profiles]


@pytest.mark.parametrize("name", TRUTHS)
def test_intervals_hold_the_truth_as_often_as_they_say(name):
    # Fewer or more than a thousandth of binomial draws of 90 %; intervals are widened for scatter, never narrowed.
    truth, length, step = TRUTHS[name]
    found = fits(truth, length, step)
    for parameter in ("roughness", "waviness"):
        value = getattr(truth, parameter)
        held = sum(low < value < high for low, high in (road.intervals[parameter] for road in found))
        assert binom.ppf(1e-3, SEEDS, 0.9) <= held <= binom.ppf(1.0 - 1e-3, SEEDS, 0.93), (parameter, held)
    held, of = np.zeros(2), 0
    for road in found:
        bands = road.spectrum
        n = bands.wavenumber.values
        for i, (kind, true) in enumerate({"psd": truth.psd(n), "coherence": truth.coherence(n, 1.446)}.items()):
            held[i] += np.sum((bands[f"{kind}_low"] <= true) & (true <= bands[f"{kind}_high"]))
        of += len(n)
    assert (np.abs(held / of - 0.9) < 0.03).all() or truth.tracks == "identical"
    assert np.mean([road.tracks == truth.tracks for road in found]) > 0.9


def test_two_slopes_are_found_where_the_road_has_them_and_nowhere_else():
    truth = ss.Road.two_slope(waviness=(2.8, 1.6), knee=0.25, tracks="isotropic")
    for seed in range(3):
        road = ss.fit_road(ss.synthesise(truth, 4000.0, 0.1, seed=seed), confidence=0.9999)
        assert road.tracks == "isotropic"
        for name, value in {
            "roughness": 64e-6,
            "waviness_below": 2.8,
            "waviness_above": 1.6,
            "knee": 0.25,
        }.items():
            low, high = road.intervals[name]
            assert low < value < high
        np.testing.assert_allclose(road.waviness, (2.8, 1.6), rtol=0.2)
        assert not ss.fit_road(ss.synthesise(ss.Road(), 1000.0, 0.1, seed=seed)).table


def test_uneven_steps_do_not_bend_the_spectrum():
    # A hundredth of a metre between candidates makes their choice, one in ten, as good as a continuous road's points.
    for seed in range(4):
        profile = ss.synthesise(ss.Road(tracks="isotropic"), 500.0, 0.01, seed=seed)
        random = np.random.default_rng(seed)
        kept = np.sort(random.choice(profile.sizes["x"], profile.sizes["x"] // 10, replace=False))
        low, high = ss.fit_road(profile.isel(x=kept), confidence=0.999).intervals["waviness"]
        assert low < 2.0 < high
        assert high - low < 0.3


@pytest.mark.parametrize(("roughness", "name"), [(10e-6, "A"), (64e-6, "B"), (500e-6, "C"), (0.2, "H"), (5.0, "H")])
def test_class_is_that_of_the_nearest_geometric_mean(roughness, name):
    road = ss.FittedRoad(roughness=roughness)
    assert road.iso_class == name


def test_a_fitted_road_is_a_road():
    road = ss.fit_road(ss.synthesise(ss.Road.iso8608("C"), 500.0, 0.1), speed=30.0, delay=False)
    assert isinstance(road, ss.Road)
    plain = ss.Road(**{f.name: getattr(road, f.name) for f in dataclasses.fields(ss.Road)})
    assert ss.ride_metrics(ss.QuarterCar(), road).bacc == ss.ride_metrics(ss.QuarterCar(), plain).bacc
    faster = dataclasses.replace(road, speed=40.0)
    assert (faster.speed, faster.intervals) == (40.0, road.intervals)
    assert {road: 1}[dataclasses.replace(road)] == 1
    assert road.iso_class == "C"


def test_bands_are_those_of_the_standard():
    # ISO 8608: octaves around 1/64 and 1/32, thirds of one around 0.05 to 0.25, twelfths above, up to 2.83 cycle/m.
    edges = band_edges()
    centres = np.sqrt(edges[1:] * edges[:-1])
    np.testing.assert_allclose(centres[:3], [1 / 64, 1 / 32, 0.0496], rtol=1e-3)
    np.testing.assert_allclose(centres[2:10], 0.25 * 2.0 ** (np.arange(-7, 1) / 3.0), rtol=1e-9)
    np.testing.assert_allclose(np.log2(edges[11:] / edges[10:-1]), 1.0 / 12.0)
    np.testing.assert_allclose(edges[[0, -1]], [0.01105, 2.8284], rtol=1e-3)


def test_covariance_of_bands_is_that_of_white_noise():
    # Of white noise n^2 is no weight at all; bands of as many harmonics as their octave has.
    rng = np.random.default_rng(5)
    x, found = 0.25 * np.arange(8000), []
    for _ in range(RECORDS):
        bands = bands_of(x, np.cumsum(rng.standard_normal((1, len(x))), axis=1).repeat(2, axis=0))
        found.append(bands.psd)
    relative = np.array(found) / np.mean(found, axis=0)
    np.testing.assert_allclose(relative.var(axis=0).mean() / np.diag(bands.covariance).mean(), 1.0, atol=0.15)
    sizes = np.sqrt(np.diag(bands.covariance))
    expected = np.diag(bands.covariance / np.outer(sizes, sizes), 1).mean()
    got = np.diag(np.corrcoef(relative, rowvar=False), 1).mean()
    np.testing.assert_allclose(got, expected, atol=4.0 / np.sqrt(RECORDS * len(sizes)))


def test_psd_of_the_bands_is_scipy_s():
    profile = ss.synthesise(ss.Road(waviness=2.4), 5000.0, 0.1, seed=3)
    bands = ss.fit_road(profile).spectrum
    n, G = welch(profile.left, 10.0, nperseg=4096)
    for i in (3, 8, 20, 40):
        near = np.abs(np.log2(n[1:] / bands.wavenumber.values[i])) < 0.25
        level = np.mean(G[1:][near] * (n[1:][near] / bands.wavenumber.values[i]) ** 2.4)
        np.testing.assert_allclose(bands.psd[i], level, rtol=0.25)


def level(length=200.0, height=0.0):
    x = np.arange(0.0, length, 0.1)
    return profile_of(x, height + 0.0 * x, height + 0.0 * x)


@pytest.mark.parametrize(
    ("profile", "given", "error", "words"),
    [
        (ss.synthesise(ss.Road(), 50.0, 0.1), {}, ValueError, "profile must be 80 m or longer .* got 49.9 m"),
        (ss.synthesise(ss.Road(), 5000.0, 4.0), {}, ValueError, "points every metre or closer .* got 4 m apart"),
        (level(), {}, ValueError, "profile must not be level"),
        (level(height=3.7), {}, ValueError, "profile must not be level"),
        (ss.synthesise(ss.Road(), 200.0, 0.1), {"roughness": 1e-6}, ValueError, "takes no roughness"),
        (
            ss.synthesise(ss.Road(), 200.0, 0.1),
            {"confidence": 1.0},
            ValueError,
            "confidence must be > 0 and < 1, got 1.0",
        ),
        (ss.synthesise(ss.Road(), 200.0, 0.1), {"confidence": None}, TypeError, "confidence must be a number"),
        (ss.synthesise(ss.Road(), 200.0, 0.1), {"track_width": -1.0}, ValueError, "track_width must be > 0 m"),
        (ss.synthesise(ss.Road(), 200.0, 0.1), {"speed": -1.0}, ValueError, "speed"),
        (ss.synthesise(ss.Road(), 200.0, 0.1)[["left"]], {}, ValueError, "profile must have left and right"),
    ],
)
def test_bad_profiles_are_refused(profile, given, error, words):
    with pytest.raises(error, match=words):
        ss.fit_road(profile, **given)


@pytest.mark.parametrize("profile", [None, [0.0, 1.0], np.zeros(100)])
def test_what_is_no_profile_is_refused(profile):
    with pytest.raises(TypeError, match=r"profile must be an xarray.Dataset"):
        ss.fit_road(profile)


def test_white_noise_is_no_road():
    x = 0.1 * np.arange(20000)
    z = np.random.default_rng(0).standard_normal(len(x)) * 1e-3
    with pytest.raises(ValueError, match=r"falls as n\^-w with w = -?0.*waviness is > 1 and < 4"):
        ss.fit_road(profile_of(x, z, z))
