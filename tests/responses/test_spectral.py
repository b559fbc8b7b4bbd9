"""The spectral route to ten digits: closed forms, the exact route, each design of many, what panels must find out."""

from dataclasses import dataclass
from typing import Any

import control as ct
import numpy as np
import pytest
import xarray as xr

import susp_ss as ss
from models import UNEQUAL, VEHICLES


def assert_equal(one, other, rtol):
    for name in other:
        counts = np.isfinite(other[name].values) & (other[name].values > 1e-6)
        np.testing.assert_allclose(one[name].values[counts], other[name].values[counts], rtol=rtol, err_msg=str(name))


def test_closed_forms_of_a_quarter_car():
    car, road = ss.QuarterCar(), ss.Road()
    q, M = road.intensity, car.ms + car.mu
    ride = ss.ride_metrics(car, road, method="spectral")
    bacc = 0.5 * q * (car.kt * car.cs / car.ms**2 + M * car.ks**2 / (car.ms**2 * car.cs))
    for found, variance in (
        (ride.sws, q * M / (2.0 * car.cs)),
        (ride.bacc, bacc),
        (ride.sws_rate, 0.5 * q * car.kt / car.cs),
    ):
        assert float(found) == pytest.approx(np.sqrt(variance), rel=1e-12)


@pytest.mark.parametrize("tracks", ["identical", "independent"])
@pytest.mark.parametrize(
    "vehicle",
    [
        VEHICLES["pitch half, unequal ends"],
        VEHICLES["full, bars"],
        ss.FullCar(**UNEQUAL),
        ss.FullCar(cs=30.0, b=1.1),
        ss.FullCar(ct=3e3),
        ss.ThreeAxleTruck(),
    ],
    ids=["half", "full", "unequal", "hardly damped", "tyre damping", "three axles"],
)
@pytest.mark.parametrize("speed", [1.0, 20.0, 90.0])
def test_exact_route_to_ten_digits(vehicle, tracks, speed):
    road = ss.Road(tracks=tracks, speed=speed, cutoff=0.003)
    assert_equal(ss.ride_metrics(vehicle, road, method="spectral"), ss.ride_metrics(vehicle, road), 1e-9)


def test_many_designs_are_each_of_them():
    rng = np.random.default_rng(4)
    ks = xr.DataArray(rng.uniform(12e3, 30e3, 70), dims="design")
    cars = ss.PitchHalfCar(ks=ks, b=xr.DataArray(rng.uniform(1.0, 2.0, 70), dims="design"), cs=(900.0, 1600.0))
    road = ss.Road(speed=xr.DataArray(rng.uniform(5.0, 40.0, 70), dims="design"), waviness=2.3, contact_length=0.05)
    every = ss.ride_metrics(cars, road, method="spectral", weighting="Wk")
    for design in (0, 33, 69):
        at = {"design": design}
        one = ss.PitchHalfCar(ks=float(ks[at]), b=float(cars.b[at]), cs=(900.0, 1600.0))
        alone = ss.Road(speed=float(road.speed[at]), waviness=2.3, contact_length=0.05)
        assert_equal(every.isel(at), ss.ride_metrics(one, alone, method="spectral", weighting="Wk"), 1e-11)


def test_axles_in_one_place_are_one():
    half = ss.PitchHalfCar()
    twins = ss.LinearVehicle(half.state_space(input="velocity"), wheelbase=0.0)
    expected = ss.ride_metrics(half, ss.Road(waviness=2.2, delay=False), method="spectral")
    assert_equal(expected, ss.ride_metrics(twins, ss.Road(waviness=2.2), method="spectral"), 1e-9)
    truck = ss.ThreeAxleTruck()
    how = {"wheels": {name: tuple(wheel) for name, wheel in truck.wheels.items()}, "track_width": 2.0}
    tandem = ss.LinearVehicle(truck.state_space(input="velocity"), wheelbase=(4.6, 4.6), **how)
    road = ss.Road(tracks="independent", cutoff=0.01)
    assert_equal(ss.ride_metrics(tandem, road, method="spectral"), ss.ride_metrics(tandem, road), 1e-8)


@dataclass(frozen=True)
class Spiky(ss.Road):
    """A road of waviness 2 and a hump at a wavenumber of which no panel knows."""

    knee: float = 0.4
    width: float = 2e-3

    def psd(self, n: Any) -> Any:
        n = np.asarray(n)
        return super().psd(n) * (1.0 + 1e-4 / ((n**2 - self.knee**2) ** 2 + self.width**2))


def test_what_no_panel_knows_of_is_found():
    road, car = Spiky(), ss.QuarterCar()
    f = np.unique(np.concatenate([np.geomspace(1e-4, 1e4, 200001), np.linspace(7.8, 8.2, 200001)]))
    S = ss.psd(car, road, f)
    ride = ss.ride_metrics(car, road, method="spectral")
    for name in ("bacc", "sws"):
        assert float(ride[name]) == pytest.approx(np.sqrt(np.trapezoid(S.sel(output=name), f)), rel=2e-6)


def test_a_filter_of_nearly_no_damping_is_resolved():
    sharp = ct.tf([1.0, 0.0], [1.0, 2e-4, 900.0])
    car, road = ss.QuarterCar(), ss.Road()
    by_two = [ss.ride_metrics(car, road, method=method, weighting=sharp) for method in ("spectral", "covariance")]
    assert_equal(*by_two, 1e-7)
