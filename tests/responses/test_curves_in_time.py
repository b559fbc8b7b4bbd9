"""Curves as they are: steps against another integrator, their order, and how far linearisation lies from them."""

import itertools

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import susp_ss as ss
from susp_ss.responses.stepping import Stepper

STOPS = ss.SpringCurve.with_stops(ks=18e3, stop=150e3, bump=0.015, rebound=0.02)
TWO = ss.DamperCurve.two_slopes(bump=800.0, rebound=2400.0)
SMOOTH = ss.DamperCurve.digressive(bump=1600.0, rebound=1600.0, knee=0.2, final=0.3)
ROAD = ss.Road.iso8608("C", speed=20.0)


def bumps(t, wheels):
    return np.stack([0.03 * np.sin(2.0 * np.pi * (1.3 + 0.4 * i) * t) * np.exp(-t) for i in range(wheels)])


def integrated(car, time, z):
    """Body and wheels of a car with curves in every corner, from its second-order matrices, to 1e-10."""
    model = car.middling().assemble()
    n, R, N = len(model.m), model.R[model.suspensions], model.N[model.suspensions]
    c, k = (car.middling().at_wheels(name) for name in ("cs", "ks"))

    def rates(t, x):
        q, v = x[:n], x[n:]
        heights = np.array([np.interp(t, time, row) for row in z])
        e, de = R @ q + N @ heights, R @ v
        push = [
            (d.force(w) if hasattr(d, "force") else d * w)
            + (s.force(u) if hasattr(s, "force") else s * u)
            - one * w
            - two * u
            for d, s, u, w, one, two in zip(car.at_wheels("cs"), car.at_wheels("ks"), e, de, c, k, strict=True)
        ]
        return np.concatenate([v, (model.K_in @ heights - model.K @ q - model.C @ v - R.T @ push) / model.m])

    x, found = np.zeros(2 * n), [np.zeros(2 * n)]
    # Road heights have a kink at every sample.
    for start, end in itertools.pairwise(time):
        x = solve_ivp(rates, (start, end), x, method="DOP853", rtol=1e-10, atol=1e-13).y[:, -1]
        found.append(x)
    return (R @ np.array(found)[:, :n].T) + N @ z


@pytest.mark.parametrize(
    "car",
    [ss.QuarterCar(cs=SMOOTH), ss.QuarterCar(cs=TWO, ks=STOPS), ss.FullCar(cs=SMOOTH, ks=STOPS, arb_front=1e4)],
    ids=["smooth", "kinks", "full"],
)
def test_simulate_agrees_with_another_integrator(car):
    time = np.arange(0.0, 0.4, 0.005)
    z = bumps(time, len(car.wheels))
    history = ss.simulate(car, z, time)
    expected = integrated(car, time, z)
    travel = np.atleast_2d(history.sws.transpose("corner", "time") if "corner" in history.dims else history.sws)
    assert np.abs(travel).max() > 0.015
    np.testing.assert_allclose(travel, expected, atol=1e-4 * np.abs(expected).max())
    rate, damper = np.ravel(history.sws_rate), car.at_wheels("cs")[0]
    np.testing.assert_allclose(np.ravel(history.damper_power), np.ravel(damper.force(rate)) * rate, atol=1e-9)


def error_of(car, step):
    time = np.arange(0.0, 1.0 + 1e-9, step)
    heights = np.interp(
        time, np.arange(0.0, 1.1, 0.1), [0.0, 0.02, 0.01, -0.02, 0.01, 0.0, 0.03, -0.01, 0.0, 0.02, 0.0]
    )
    stepper = Stepper(car, step)
    return stepper.drive(heights[None], stepper.rest(heights[:1])).outputs[1, -1]


@pytest.mark.parametrize(("damper", "order"), [(SMOOTH, 4.0), (TWO, 2.5)], ids=["smooth", "kinks"])
def test_order_of_the_steps(damper, order):
    car = ss.QuarterCar(cs=damper)
    finest = error_of(car, 1.0 / 3200.0)
    coarse, fine = (abs(error_of(car, step) - finest) for step in (0.01, 0.0025))
    assert np.log(coarse / fine) / np.log(4.0) > order - 0.4


def test_a_car_that_stands_on_a_warped_road_stands_still():
    car = ss.FullCar(cs=TWO, ks=ss.Corners.axles(front=STOPS, rear=20e3), arb_front=5e3)
    time = np.arange(0.0, 1.0, 0.01)
    history = ss.simulate(car, np.outer([0.08, 0.0, 0.0, 0.05], np.ones(len(time))), time)
    for name in ("sws", "dtl"):
        assert np.ptp(history[name].values, axis=history[name].dims.index("time")).max() < 1e-6
    assert np.abs(history.bacc).max() < 1e-8
    assert np.abs(history.sws).max() > 0.02
    # Standing still the tyres carry what the springs do.
    at = history.isel(time=0)
    spring = [s.force(u) if hasattr(s, "force") else s * u for s, u in zip(car.at_wheels("ks"), at.sws, strict=True)]
    bar = 5e3 * float(at.sws[0] - at.sws[1])
    np.testing.assert_allclose(np.add(spring, [bar, -bar, 0.0, 0.0]), at.dtl, atol=1e-6)


def test_a_curve_of_one_slope_is_its_number():
    straight = ss.DamperCurve([-1.0, 1.0], [-1500.0, 1500.0])
    road = ss.Road.iso8608("B", speed=20.0, tracks="isotropic")
    for method, how in (("covariance", {}), ("time", {"duration": 5.0, "seed": 3})):
        curved = ss.ride_metrics(ss.FullCar(cs=straight), road, method, **how)
        linear = ss.ride_metrics(ss.FullCar(cs=1500.0), road, method, **how)
        for name in linear:
            np.testing.assert_allclose(curved[name], linear[name], rtol=1e-6 if method == "covariance" else 5e-3)


# Duration s, and by how much linearisation lies from it at most: measured at length in lesson 7.
@pytest.mark.parametrize(
    ("damper", "spring", "least", "most"),
    [
        (SMOOTH, 18e3, -0.02, 0.0),
        (ss.DamperCurve.two_slopes(1000.0, 2000.0), 18e3, -0.04, 0.0),
        (ss.DamperCurve.two_slopes(600.0, 2400.0), 18e3, -0.10, -0.015),
    ],
    ids=["digressive", "1:2", "1:4"],
)
def test_how_far_linearisation_lies_from_the_curve(damper, spring, least, most):
    """Beside the linearised car on the same record, so that its roughness cancels; two standard errors are granted."""
    car = ss.QuarterCar(cs=damper, ks=spring)
    how = {"method": "time", "duration": 60.0, "step": 0.003, "seed": 5}
    real, linear = ss.ride_metrics(car, ROAD, **how), ss.ride_metrics(ss.linearised(car, ROAD), ROAD, **how)
    for name in ("bacc", "sws", "dtl"):
        error = (linear[name] / real[name] - 1.0).item()
        granted = 2.0 * (real[f"{name}_stderr"] / real[name]).item()
        assert least - granted <= error <= most + granted, name
    shift, stderr = real.ride_height_shift.item(), real.ride_height_shift_stderr.item()
    exact = ss.ride_metrics(car, ROAD).ride_height_shift.item()
    assert abs(shift - exact) < 0.04 * abs(exact) + 3.0 * stderr
    power = real.damper_power.item()
    assert power == pytest.approx(0.5 * ROAD.intensity * car.kt, abs=4.0 * real.damper_power_stderr.item())
