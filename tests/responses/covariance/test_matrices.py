"""The covariance matrix itself: it solves its equation, is positive, and belongs to the velocity form."""

import numpy as np
import pytest
import scipy.linalg
from hypothesis import given, settings

import models
import susp_ss as ss
from models import VEHICLES
from susp_ss.responses.covariance.lyapunov import Dynamics


@given(models.vehicles, models.roads)
@settings(max_examples=40)
def test_covariance_is_positive_and_gives_the_metrics(vehicle, road):
    X = ss.covariance(vehicle, road)
    assert X.dims == ("state", "state_")
    np.testing.assert_allclose(X, X.T, rtol=1e-12, atol=1e-12 * float(abs(X).max()))
    scale = np.sqrt(np.maximum(np.diag(X), 1e-300))
    live = np.diag(X) > 1e-14 * np.diag(X).max()
    eigenvalues = np.linalg.eigvalsh((X.values / np.outer(scale, scale))[np.ix_(live, live)])
    assert eigenvalues.min() > -1e-6
    system = vehicle.state_space(input="velocity")
    assert list(X.state.values) == system.state_labels
    metrics = ss.ride_metrics(vehicle, road)
    corners = [name for name in system.output_labels if name.startswith("sws")]
    for i, name in enumerate(corners):
        row = system.C[system.output_labels.index(name)]
        expected = float(np.atleast_1d(metrics.sws.values)[i])
        np.testing.assert_allclose(np.sqrt(row @ X.values @ row), expected, rtol=1e-6)


def test_lyapunov_residual_without_delay():
    car, road = VEHICLES["full, unequal corners, bars, tyre damping"], ss.Road(delay=False)
    system = car.state_space(input="velocity")
    X = ss.covariance(car, road).values
    w = system.B @ np.ones(4)
    Q = road.intensity * np.outer(w, w)
    residual = system.A @ X + X @ system.A.T + Q
    np.testing.assert_allclose(residual, 0.0, atol=1e-10 * np.abs(system.A @ X).max())


def test_warp_variance_of_delayed_independent_tracks():
    car, road = ss.FullCar(), ss.Road(tracks="independent", speed=10.0)
    variance = float(ss.covariance(car, road).sel(state="warp", state_="warp"))
    # Each track's front and rear wheels differ by a Brownian increment over the delay.
    np.testing.assert_allclose(variance, 2 * road.intensity * (car.a + car.b) / 10.0, rtol=1e-12)


def test_a_long_sweep_is_each_of_its_designs():
    ks = np.linspace(12e3, 25e3, 700)
    cars = ss.FullCar(ks=ks, b=np.linspace(1.2, 1.8, 700))
    X = ss.covariance(cars, ss.Road(tracks="isotropic"))
    assert X.dims[0] == "design"
    for i in (0, 255, 256, 699):
        one = ss.FullCar(ks=ks[i], b=float(cars.b[i]))
        np.testing.assert_allclose(
            X[i], ss.covariance(one, ss.Road(tracks="isotropic")), rtol=1e-9, atol=1e-12 * float(abs(X[i]).max())
        )


@pytest.mark.parametrize("alphas", [[], [900.0, 0.5, 5.0, 80.0], [3.0 + 4.0j, 200.0 - 9.0j]])
def test_what_a_delay_carries(alphas):
    # Its first mode is as fast as a colour: (s + 5) (s + 80).
    K, C = np.diag([400.0, 90.0]), np.array([[85.0, 2.0], [0.0, 3.0]])
    taus, b, rates = np.array([0.0, 1e-3, 0.1, 3.0]), np.array([1.0, -2.0, 3.0, 0.5]), np.array(alphas)
    each = [np.broadcast_to(x, (len(taus), *x.shape)) for x in (K, C, b, rates)]
    free, forced = Dynamics(*each[:2]).propagate(each[2], taus, each[3])
    A = np.block([[np.zeros((2, 2)), np.eye(2)], [-K, -C]])
    for i, tau in enumerate(taus):
        np.testing.assert_allclose(free[i, :, 0], scipy.linalg.expm(A * tau) @ b, rtol=1e-11, atol=1e-14)
        for j, alpha in enumerate(alphas):
            forcing = np.block([[A, b[:, None]], [np.zeros((1, 4)), np.array([[-alpha]])]])
            expected = scipy.linalg.expm(forcing * tau)[:4, 4]
            np.testing.assert_allclose(forced[i, j, :, 0], expected, rtol=1e-11, atol=1e-14)


def test_a_crawling_car_sees_two_independent_axles():
    crawl = ss.ride_metrics(ss.PitchHalfCar(), ss.Road(speed=1e-6))
    each = [ss.ride_metrics(ss.PitchHalfCar(), ss.Road(speed=1e-6, wheels=(wheel,))) for wheel in "fr"]
    np.testing.assert_allclose(crawl.sws, np.hypot(each[0].sws, each[1].sws), rtol=1e-9)


def test_lost_digits_are_refused_by_design():
    with pytest.raises(ValueError, match="fewer than six digits"):
        ss.covariance(ss.QuarterCar(cs=1e9), ss.Road())
    cars = ss.QuarterCar(ks=np.r_[np.full(300, 18e3), 1e17])
    with pytest.raises(ValueError, match=r"QuarterCar at \(design=300\)"):
        ss.ride_metrics(cars, ss.Road())
