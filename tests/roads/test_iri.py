"""The international roughness index against the procedure of its sources, closed forms and a dense integral."""

import itertools

import numpy as np
import pytest
import scipy.integrate
import scipy.linalg
import xarray as xr
from hypothesis import given, settings
from hypothesis import strategies as st

import susp_ss as ss

# The car over time, its states body velocity, body acceleration, wheel velocity and wheel acceleration, per slope.
KT, KS, CS, MU, SPEED, BASE = 653.0, 63.3, 6.0, 0.15, 80.0 / 3.6, 0.25
A = np.array(
    [[0.0, 1.0, 0.0, 0.0], [-KS, -CS, KS, CS], [0.0, 0.0, 0.0, 1.0], [KS / MU, CS / MU, -(KS + KT) / MU, -CS / MU]]
)
B = np.array([0.0, 0.0, 0.0, KT / MU])
C = np.array([1.0, 0.0, -1.0, 0.0])

# World Bank Technical Paper 46, table of coefficients, and ASTM E1926: state transition and response over 250 mm.
PRINTED = (
    np.array(
        [
            [0.9966071, 0.01091514, -0.002083274, 0.0003190145],
            [-0.5563044, 0.9438768, -0.8324718, 0.05064701],
            [0.02153176, 0.002126763, 0.7508714, 0.008221888],
            [3.335013, 0.3376467, -39.12762, 0.4347564],
        ]
    ),
    np.array([0.005476107, 1.388776, 0.2275968, 35.79262]),
)


def transition(step):
    S = scipy.linalg.expm(A * step / SPEED)
    return S, np.linalg.solve(A, (S - np.eye(4)) @ B)


def driven(steps, slopes, start, matrices):
    """Suspension velocity over speed at the end of every step, as the printed program goes along."""
    state, found = np.array([start, 0.0, start, 0.0]), []
    for step, slope in zip(steps, slopes, strict=True):
        S, P = matrices(step)
        state = S @ state + P * slope
        found.append(state[0] - state[2])
    return np.array(found)


def program(height, step, matrices=transition):
    """The index of an evenly sampled profile by the program of ASTM E1926."""
    k = max(int(BASE / step + 0.5 + 1e-9), 1)
    first = round(11.0 / step)
    slopes = (height[k:] - height[:-k]) / (k * step)
    known = matrices(step)
    velocity = driven(np.full(len(slopes), step), slopes, (height[first] - height[0]) / (first * step), lambda _: known)
    return 1000.0 * np.abs(velocity).mean()


def profile(points, seed=0):
    return np.cumsum(np.random.default_rng(seed).normal(0.0, 1e-3, points))


@pytest.mark.parametrize("step", [0.025, 0.05, 0.1, 0.1524, 0.2, 0.25, 0.3048, 0.5])
def test_even_profiles_give_what_the_printed_program_gives(step):
    z = profile(600)
    assert ss.iri(step * np.arange(600), z) == pytest.approx(program(z, step), rel=1e-10)


def test_the_printed_matrices_give_the_same():
    S, P = transition(0.25)
    np.testing.assert_allclose(S, PRINTED[0], rtol=2e-6)
    np.testing.assert_allclose(P, PRINTED[1], rtol=2e-5)
    z = profile(800, seed=1)
    assert ss.iri(0.25 * np.arange(800), z) == pytest.approx(program(z, 0.25, lambda _: PRINTED), rel=1e-5)


def test_uneven_profiles_advance_exactly():
    steps = np.random.default_rng(2).uniform(0.26, 0.9, 300)
    x, z = np.r_[0.0, np.cumsum(steps)], profile(301)
    first = int(np.abs(x - 11.0).argmin())
    velocity = driven(steps, np.diff(z) / steps, (z[first] - z[0]) / x[first], transition)
    assert ss.iri(x, z) == pytest.approx(1000.0 * np.abs(velocity) @ steps / x[-1], rel=1e-10)


def test_uneven_points_are_averaged_over_what_is_nearest_to_250_mm():
    rng = np.random.default_rng(3)
    x = np.cumsum(rng.uniform(0.01, 0.12, 800))
    z = profile(800)
    ahead = np.array([max(int(np.abs(x - (at + BASE)).argmin()), i + 1) for i, at in enumerate(x[:-1])])
    S = int(np.argmax(x + BASE > 1.5 * x[-1] - 0.5 * x[-2]))
    slopes = (z[ahead[:S]] - z[:S]) / (x[ahead[:S]] - x[:S])
    first = int(np.abs(x - x[0] - 11.0).argmin())
    steps = np.diff(x[: S + 1])
    velocity = driven(steps, slopes, (z[first] - z[0]) / (x[first] - x[0]), transition)
    assert ss.iri(x, z) == pytest.approx(1000.0 * np.abs(velocity) @ steps / (x[S] - x[0]), rel=1e-10)


@pytest.mark.parametrize("wavelength", [1.5, 2.4, 5.0, 16.0, 40.0])
def test_a_sine_gives_the_mean_of_the_car_s_response(wavelength):
    x = np.arange(0.0, 4000.0, 0.01)
    k = 2.0 * np.pi / wavelength
    H = C @ np.linalg.solve(1j * k * SPEED * np.eye(4) - A, B)
    expected = 1000.0 * 2.0 / np.pi * 1e-3 * k * abs(H) * np.sinc(BASE / wavelength)
    assert ss.iri(x, 1e-3 * np.sin(k * x)) == pytest.approx(expected, rel=3e-3)


@settings(max_examples=20)
@given(st.integers(0, 99), st.floats(1e-3, 1e3), st.floats(-0.2, 0.2), st.floats(-1e3, 1e3))
def test_it_scales_with_height_and_knows_no_slope(seed, factor, slope, start):
    x = start + np.cumsum(np.random.default_rng(seed).uniform(0.02, 0.4, 300))
    z = profile(300, seed)
    whole = ss.iri(x, z)
    assert ss.iri(x, -factor * z) == pytest.approx(factor * whole, rel=1e-9)
    assert ss.iri(x, z + slope * x + 5.0) == pytest.approx(whole, rel=1e-6)


def test_segments_run_on_and_share_the_whole():
    x = 0.05 * np.arange(10001)
    z = profile(10001)
    parts = ss.iri(x, z, segment=100.0)
    assert parts.dims == ("segment",)
    assert parts.attrs["units"] == "m/km"
    np.testing.assert_allclose(parts.segment, [0.0, 100.0, 200.0, 300.0, 400.0])
    np.testing.assert_allclose(parts.length, [100.0, 100.0, 100.0, 100.0, 99.8])
    assert float((parts * parts.length).sum() / parts.length.sum()) == pytest.approx(ss.iri(x, z), rel=1e-12)
    first = x <= 100.2 + 1e-9
    assert float(parts[0]) == pytest.approx(ss.iri(x[first], z[first]), rel=1e-12)


def test_a_profile_gives_both_tracks():
    x = 0.1 * np.arange(500)
    left, right = profile(500, 1), profile(500, 2)
    both = xr.Dataset({"left": ("x", left), "right": ("x", right)}, {"x": x})
    found = ss.iri(both)
    assert float(found.sel(track="left")) == ss.iri(x, left)
    assert float(found.sel(track="right")) == ss.iri(x, right)
    assert ss.iri(both, segment=10.0).dims == ("track", "segment")


def exact_mean(road):
    """Of waviness 2, white slope: ``x' = A x + B u``, u the mean of the slope over the base, by its impulse response.

    Up to the base it is ``A^-1 (e^(A t) - I) B / T``, from there on free, where the Gramian tells the rest.
    """
    T = BASE / SPEED
    intensity = 0.5 * (2.0 * np.pi * 0.1) ** 2 * road.roughness / SPEED

    def impulse(t):
        return np.linalg.solve(A, (scipy.linalg.expm(A * t) - np.eye(4)) @ B) / T

    near = scipy.integrate.fixed_quad(lambda t: np.array([C @ impulse(one) for one in t]) ** 2, 0.0, T, n=20)[0]
    gramian = scipy.linalg.solve_continuous_lyapunov(A.T, -np.outer(C, C))
    return 1000.0 * np.sqrt(2.0 / np.pi * intensity * (near + impulse(T) @ gramian @ impulse(T)))


def dense_mean(road):
    def density(u):
        n = np.exp(u)
        H = C @ np.linalg.solve(2j * np.pi * n * SPEED * np.eye(4) - A, B)
        return abs(H * np.sinc(n * BASE) * 2.0 * np.pi * n) ** 2 * float(road.psd(n)) * n

    edges = np.log([1e-6, 1e-3, 0.03, 0.06, 0.16, 0.3, 0.5, 1.0, 4.0, 60.0])
    parts = [scipy.integrate.quad(density, *ends, epsrel=1e-11, limit=400)[0] for ends in itertools.pairwise(edges)]
    return 1000.0 * np.sqrt(2.0 / np.pi * sum(parts))


def test_the_mean_of_white_slope_is_exact():
    assert ss.mean_iri(ss.Road(speed=7.0)) == pytest.approx(exact_mean(ss.Road()), rel=1e-11)


@pytest.mark.parametrize(
    "road",
    [
        ss.Road(waviness=1.3),
        ss.Road(waviness=3.7, cutoff=0.01),
        ss.Road(contact_length=0.2, tracks="isotropic"),
        ss.Road.two_slope(waviness=(3.0, 1.6), knee=0.16),
    ],
)
def test_the_mean_of_any_spectrum_is_its_integral(road):
    assert ss.mean_iri(road) == pytest.approx(dense_mean(road), rel=1e-9)


def test_the_mean_agrees_with_the_published_relation():
    # IRI = 2.21 sqrt(C) at waviness 2, C in 1e-6 rad m at 1 rad/m, which is 16e-6 m^3 at 0.1 cycle/m: O. Kropac and
    # P. Mucka, Be careful when using the International Roughness Index as an indicator of road unevenness, J. Sound
    # Vib. 287, 2005; without the moving average, which takes two per cent.
    assert ss.mean_iri(ss.Road.iso8608("A")) == pytest.approx(2.21, rel=0.025)


def test_long_profiles_scatter_about_the_mean():
    road = ss.Road(waviness=2.2)
    parts = ss.iri(ss.synthesise(road, 8e3, 0.025, seed=4), segment=200.0).sel(track="left")
    error = float(parts.std(ddof=1)) / np.sqrt(parts.size)
    assert error < 0.02 * ss.mean_iri(road)
    assert float(parts.mean()) == pytest.approx(ss.mean_iri(road), abs=4.0 * error)


@settings(max_examples=30)
@given(st.floats(0.05, 50.0), st.floats(1.01, 3.99), st.sampled_from([0.0, 0.02]), st.sampled_from([0.0, 0.1]))
def test_from_iri_is_the_way_back(iri, waviness, cutoff, contact_length):
    road = ss.Road.from_iri(iri, waviness, cutoff=cutoff, contact_length=contact_length, speed=31.0)
    assert ss.mean_iri(road) == pytest.approx(iri, rel=1e-12)
    assert (road.waviness, road.speed) == (waviness, 31.0)


def test_sweeps_of_roads_and_indices():
    cutoff = xr.DataArray([0.0, 0.05], dims="long", coords={"long": [0.0, 0.05]})
    means = ss.mean_iri(ss.Road(roughness=np.array([16e-6, 64e-6]), cutoff=cutoff))
    assert set(means.dims) == {"long", "design"}
    np.testing.assert_allclose(means.isel(design=1), 2.0 * means.isel(design=0), rtol=1e-12)
    assert float(means.sel(long=0.05, design=1)) == pytest.approx(ss.mean_iri(ss.Road(cutoff=0.05)))
    np.testing.assert_allclose(ss.mean_iri(ss.Road.from_iri(np.array([1.0, 4.0]))), [1.0, 4.0], rtol=1e-12)


X = 0.1 * np.arange(200)


@pytest.mark.parametrize(
    ("arguments", "kind", "said"),
    [
        ((X, None), TypeError, r"iri\(elevation=...\) must be one row of numbers in m, got None"),
        ((None, X), TypeError, r"iri\(x=...\) must be one row of numbers"),
        ((X, np.where(X[7] == X, np.nan, 0.0)), ValueError, "must be finite, got nan at point 7"),
        ((X, X[:-1]), ValueError, "one height at each distance, got 199 at 200"),
        ((X[::-1], X), ValueError, r"iri\(x=...\) must rise, got 19.8 m after 19.9 m at point 1"),
        ((X[:50], X[:50]), ValueError, "at least 11 m of profile, .* got 4.9 m"),
        ((X, X, 0.01), ValueError, "segment must be at least a step of the profile, 0.1 m, got 0.01"),
        ((X, X, "10"), TypeError, "segment must be a number > 0 m, got '10'"),
        ((X, X, np.nan), ValueError, "segment must be > 0 m and finite, got nan"),
        ((xr.Dataset({"left": ("x", X)}, {"x": X}),), ValueError, "profile must have left and right"),
        ((xr.Dataset({"left": ("x", X), "right": ("x", X)}, {"x": X}), X), TypeError, "leave elevation out"),
    ],
)
def test_what_is_no_profile_is_refused(arguments, kind, said):
    with pytest.raises(kind, match=said):
        ss.iri(*arguments)


def test_what_is_no_index_is_refused():
    with pytest.raises(TypeError, match="road must be a Road"):
        ss.mean_iri("B")
    with pytest.raises(ValueError, match=r"Road.from_iri\(iri=...\) must be > 0 m/km, got -1"):
        ss.Road.from_iri(-1.0)
    with pytest.raises(TypeError, match=r"Road.from_iri\(iri=...\) must be > 0 m/km, got None"):
        ss.Road.from_iri(None)
    with pytest.raises(ValueError, match="finds the roughness"):
        ss.Road.from_iri(2.0, roughness=1e-6)
