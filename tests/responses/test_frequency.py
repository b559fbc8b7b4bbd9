"""Frequency responses and spectra against the oracles, python-control and each other."""

import numpy as np
import pytest
import xarray as xr

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


def test_spectra_over_speeds_are_those_of_each_speed():
    speeds, f = xr.DataArray(np.array([10.0, 30.0]), dims="speed"), np.array([0.5, 3.0, 12.0])
    every = ss.psd(ss.FullCar(), ss.Road(speed=speeds, tracks="isotropic", waviness=2.4), f)
    assert every.dims == ("speed", "output", "frequency")
    for i, speed in enumerate(speeds.values):
        one = ss.psd(ss.FullCar(), ss.Road(speed=float(speed), tracks="isotropic", waviness=2.4), f)
        np.testing.assert_allclose(every.isel(speed=i), one, rtol=1e-12)
