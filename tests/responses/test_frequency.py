"""Frequency responses and spectra against the oracles, python-control and each other."""

import control as ct
import numpy as np
import pytest
import xarray as xr
from hypothesis import given
from hypothesis import strategies as st

import models
import oracles
import susp_ss as ss
from models import ROADS, VEHICLES

FREQUENCY = np.geomspace(0.02, 100.0, 60)


@pytest.mark.parametrize("vehicle", VEHICLES.values(), ids=VEHICLES.keys())
def test_frequency_response_is_the_oracles(vehicle):
    H = ss.frequency_response(vehicle, FREQUENCY)
    reference = oracles.frequency_response(models.oracle(vehicle), FREQUENCY)
    assert H.dims == ("output", "input", "frequency")
    for name in H.output.values:
        expected = reference[str(name)]
        np.testing.assert_allclose(H.sel(output=name), expected, rtol=1e-7, atol=1e-9 * np.abs(expected).max())


def test_low_frequency_keeps_its_digits():
    # Far below the body mode the deflection is the inertia force over the spring: -w^2 ms / ks.
    car, f = ss.QuarterCar(), 1e-6
    H = complex(ss.frequency_response(car, [f]).sel(output="sws").item())
    np.testing.assert_allclose(H.real, -((2 * np.pi * f) ** 2) * car.ms / car.ks, rtol=1e-6)


@pytest.mark.parametrize("ground", ROADS)
@pytest.mark.parametrize("name", ["quarter", "pitch half", "full, unequal corners, bars, tyre damping"])
def test_psd_is_the_oracles(name, ground):
    vehicle, road = VEHICLES[name], ROADS[ground]
    S = ss.psd(vehicle, road, FREQUENCY)
    reference = oracles.psd(models.oracle(vehicle), models.oracle_road(road), FREQUENCY)
    for output in S.output.values:
        expected = reference[str(output)]
        np.testing.assert_allclose(S.sel(output=output), expected, rtol=1e-6, atol=1e-9 * expected.max())


def test_psd_integrates_to_the_metric():
    f = np.geomspace(1e-3, 1e3, 40001)
    S = ss.psd(ss.FullCar(), ss.Road(tracks="isotropic"), f)
    metrics = ss.ride_metrics(ss.FullCar(), ss.Road(tracks="isotropic"))
    for output, value in (("bacc_fr", metrics.bacc.sel(point="fr")), ("sws_rl", metrics.sws.sel(corner="rl"))):
        np.testing.assert_allclose(np.sqrt(np.trapezoid(S.sel(output=output), f)), float(value), rtol=1e-3)


def test_sweeps_come_first():
    cars = ss.FullCar(ks=np.array([15e3, 20e3]), cs=np.array([[1000.0], [1500.0], [2000.0]]))
    H, S = ss.frequency_response(cars, FREQUENCY), ss.psd(cars, ss.Road(), FREQUENCY)
    assert H.dims == ("design_0", "design_1", "output", "input", "frequency")
    assert S.dims == ("design_0", "design_1", "output", "frequency")
    one = ss.FullCar(ks=20e3, cs=1500.0)
    np.testing.assert_allclose(H[1, 1], ss.frequency_response(one, FREQUENCY), rtol=1e-12)
    np.testing.assert_allclose(S[1, 1], ss.psd(one, ss.Road(), FREQUENCY), rtol=1e-12)


@pytest.mark.parametrize(
    ("frequency", "error", "words"),
    [
        ([], ValueError, "non-empty row"),
        ([[1.0]], ValueError, "non-empty row"),
        (1.0, ValueError, "non-empty row"),
        ([1.0, -2.0], ValueError, "> 0 Hz, got -2.0"),
        ([1.0, np.nan], ValueError, "got nan"),
        ("low", TypeError, "numbers in Hz"),
        (None, TypeError, "numbers in Hz"),
    ],
)
def test_bad_frequencies(frequency, error, words):
    with pytest.raises(error, match=words):
        ss.frequency_response(ss.QuarterCar(), frequency)
    with pytest.raises(error, match=words):
        ss.psd(ss.QuarterCar(), ss.Road(), frequency)


def test_a_resonance_without_damping_is_refused():
    car = ss.RigidTyreQuarterCar(ms=1.0, ks=(2.0 * np.pi) ** 2, cs=0.0)
    with pytest.raises(ValueError, match="a mode without damping answers without bound"):
        ss.frequency_response(car, [0.5, 1.0])
    assert np.isfinite(ss.frequency_response(car, [0.5, 1.1])).all()


def test_spectra_over_speeds_are_those_of_each_speed():
    speeds, f = xr.DataArray(np.array([10.0, 30.0]), dims="speed"), np.array([0.5, 3.0, 12.0])
    every = ss.psd(ss.FullCar(), ss.Road(speed=speeds, tracks="isotropic", waviness=2.4), f)
    assert every.dims == ("speed", "output", "frequency")
    for i, speed in enumerate(speeds.values):
        one = ss.psd(ss.FullCar(), ss.Road(speed=float(speed), tracks="isotropic", waviness=2.4), f)
        np.testing.assert_allclose(every.isel(speed=i), one, rtol=1e-12)


def test_many_designs_are_python_controls_to_ten_digits():
    cars = ss.FullCar(ks=np.array([15e3, 22e3]), cs=ss.Corners(fr=900.0, fl=1100.0, rr=1300.0, rl=np.array([1e3, 2e3])))
    H = ss.frequency_response(cars, FREQUENCY)
    for i, (ks, rl) in enumerate([(15e3, 1e3), (22e3, 2e3)]):
        system = ss.FullCar(ks=ks, cs=ss.Corners(fr=900.0, fl=1100.0, rr=1300.0, rl=rl)).state_space()
        expected = system(2j * np.pi * FREQUENCY)
        size = np.abs(expected).max(axis=-1, keepdims=True)
        np.testing.assert_allclose(H[i], expected, rtol=0.0, atol=1e-10 * size.max())
        np.testing.assert_allclose(H[i] / size, expected / size, rtol=0.0, atol=1e-10)


@pytest.mark.parametrize("ground", ["identical", "independent", "isotropic"])
def test_cross_spectra_are_hermitian_and_those_of_sums(ground):
    """The sum of two outputs is an output: S_x+y = S_x + S_y + 2 Re S_xy, and of the roll by its two sides."""
    car, road = ss.FullCar(**models.UNEQUAL), ROADS[ground]
    S = ss.psd(car, road, FREQUENCY, cross=True)
    assert S.dims == ("output", "output_", "frequency")
    np.testing.assert_allclose(S, S.conj().transpose("output_", "output", "frequency"), atol=0.0)
    own = ss.psd(car, road, FREQUENCY)
    np.testing.assert_allclose(np.einsum("iif->if", S.values), own, rtol=1e-12)
    left, right = (S.sel(output=f"bacc_{side}") for side in ("fl", "fr"))
    apart = left.sel(output_="bacc_fl") + right.sel(output_="bacc_fr") - 2.0 * left.sel(output_="bacc_fr").real
    roll = own.sel(output="roll_acc") * (2.0 * car.c) ** 2
    np.testing.assert_allclose(apart.real, roll, atol=1e-9 * float(own.sel(output="bacc_fr").max()))


def test_the_phase_of_a_cross_spectrum_is_how_far_the_first_is_ahead():
    names = {"inputs": ["dz_r_f", "dz_r_r"], "outputs": ["lag_f", "lag_r"]}
    lags = ss.LinearVehicle(ct.ss(-5.0 * np.eye(2), np.eye(2), np.eye(2), np.zeros((2, 2)), **names), wheelbase=2.5)
    S = ss.psd(lags, ss.Road(speed=10.0), FREQUENCY, cross=True).sel(output="lag_f", output_="lag_r")
    np.testing.assert_allclose(S / np.abs(S), np.exp(2j * np.pi * FREQUENCY * 0.25), rtol=1e-10)


def test_coherence_is_one_of_one_process_and_that_of_the_tracks_at_the_tyres():
    assert ss.coherence(ss.PitchHalfCar(), ss.Road(), FREQUENCY).values == pytest.approx(1.0, abs=1e-12)
    gamma = ss.coherence(ss.FullCar(), ss.Road(tracks="isotropic"), FREQUENCY)
    assert (gamma >= 0.0).all()
    assert (gamma <= 1.0 + 1e-12).all()
    np.testing.assert_allclose(gamma.sel(output="bacc_cg", output_="roll_acc"), 0.0, atol=1e-12)
    still = ss.coherence(ss.FullCar(), ss.Road(), [1.0, 5.0])
    assert np.isnan(still.sel(output="roll_acc")).all()
    assert np.isfinite(still.drop_sel(output="roll_acc", output_="roll_acc")).all()


def test_transmissibility_over_the_road_is_that_of_displacements():
    car, f = ss.QuarterCar(ks=np.array([15e3, 25e3])), np.array([0.01, 1.2, 10.0])
    T = ss.transmissibility(car, ss.Road(speed=7.0, roughness=1e-3), f, "bacc")
    H = ss.frequency_response(car, f).sel(output="bacc", input="z_r")
    np.testing.assert_allclose(T, -H / (2.0 * np.pi * f) ** 2, rtol=1e-10)
    assert T.dims == ("design", "frequency")
    np.testing.assert_allclose(T.sel(frequency=0.01), 1.0, atol=1e-3)


def test_transmissibility_of_a_seat_is_its_own_on_any_road():
    seat = ss.Seat(x=0.4, y=0.3, mass=60.0, ks=30e3, cs=700.0)
    car, w = ss.FullCar(**models.UNEQUAL).with_seats({"driver": seat}), 2.0 * np.pi * FREQUENCY
    alone = (30e3 + 700.0j * w) / (30e3 + 700.0j * w - 60.0 * w**2)
    for road in (ss.Road(), ss.Road(tracks="isotropic", speed=9.0, waviness=2.4)):
        T = ss.transmissibility(car, road, FREQUENCY, "bacc_driver", over="bacc_driver_floor")
        np.testing.assert_allclose(T, alone, rtol=1e-9)


@pytest.mark.parametrize(
    ("names", "words"),
    [
        (("bac",), "output: no output named 'bac', available: bacc_cg"),
        ((3,), "output: no output named 3"),
        (("bacc_cg", "street"), "over: no output named 'street', available: .*, road"),
        (("sws_fr",), "over the road it must be an acceleration in m/s.2, got 'sws_fr'"),
        (("bacc_cg", "roll_acc"), "over: no wheel moves 'roll_acc' on such a road"),
    ],
)
def test_unknown_transmissibilities(names, words):
    with pytest.raises(ValueError, match=words):
        ss.transmissibility(ss.FullCar(), ss.Road(), FREQUENCY, *names)


@given(st.floats(50.0, 5e3), st.floats(0.02, 0.5), st.floats(3e3, 1e5), st.floats(1.5, 50.0), st.floats(50.0, 5e3))
def test_responses_are_alike_for_all_dampers_where_points_are_invariant(ms, share, ks, stiffer, cs):
    car = {"ms": ms, "mu": share * ms, "ks": ks, "kt": stiffer * ks}
    points = ss.invariant_points(ss.QuarterCar(**car))
    assert {name: len(f) for name, f in points.items()} == {"bacc": 3, "sws": 1, "dtl": 2}
    for name, f in points.items():
        H = np.abs(ss.frequency_response(ss.QuarterCar(**car, cs=np.array([1e-3, cs, 50.0 * cs])), f))
        of = H.sel(output=name, input="z_r")
        np.testing.assert_allclose(of, of.isel(design=[1, 1, 1]).values, rtol=1e-6)
    softer = ss.QuarterCar(**{**car, "ks": 0.3 * ks}, cs=cs)
    for name, at in (
        ("bacc", np.sqrt(stiffer * ks / (share * ms))),
        ("sws", np.sqrt(stiffer * ks / (ms * (1 + share)))),
    ):
        f = [at / (2.0 * np.pi)]
        both = [ss.frequency_response(one, f).sel(output=name).item() for one in (softer, ss.QuarterCar(**car, cs=cs))]
        assert both[0] == pytest.approx(both[1], rel=1e-6)


def test_invariant_points_of_sweeps_and_what_has_none():
    rigid = ss.RigidTyreQuarterCar(ks=np.array([10e3, 20e3]))
    f = ss.invariant_points(rigid)["bacc"]
    np.testing.assert_allclose(f[:, 0], np.sqrt(2.0 * rigid.ks / rigid.ms) / (2.0 * np.pi))
    # Body and wheel, of displacements, then have the road's own amplitude.
    H = ss.frequency_response(ss.RigidTyreQuarterCar(ks=10e3), f[0]).sel(output="bacc").item()
    assert abs(H) == pytest.approx((2.0 * np.pi * f[0, 0]) ** 2, rel=1e-9)
    for bad, error in ((ss.FullCar(), TypeError), (None, TypeError), (ss.QuarterCar(ct=10.0), ValueError)):
        with pytest.raises(error, match="must be"):
            ss.invariant_points(bad)
    with pytest.raises(TypeError, match="got a curve"):
        ss.invariant_points(ss.QuarterCar(ks=ss.SpringCurve([-0.1, 0.1], [-2e3, 2e3])))
