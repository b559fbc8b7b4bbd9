"""The engine's several ways to one variance: polynomials against matrices, compiled against plain, and their parts."""

import dataclasses

import numpy as np
import pytest
import scipy.linalg
from hypothesis import assume, given, settings
from hypothesis import strategies as st

import models
import oracles
import susp_ss as ss
from models import ROADS, VEHICLES, WHEEL_ROADS
from susp_ss.responses.covariance import polynomials, routes
from susp_ss.vehicles.vehicle import Vehicle

ENGINE = "susp_ss.responses.covariance.routes"


def variances_of(vehicle, road):
    space = vehicle.design_space()
    return routes.covariance_variances(vehicle.flattened(space), space, road)


def by_matrices(vehicle, road):
    """The same variances where no vehicle is on struts."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(Vehicle, "halves", lambda _: ())
        patch.setattr(Vehicle, "whole", lambda _: None)
        return variances_of(vehicle, road)


def mirrored(vehicle):
    """The vehicle with its right side like its left."""

    def left(value):
        if isinstance(value, ss.Corners):
            return ss.Corners.axles(front=value.fl, rear=value.rl)
        return value[1] if isinstance(value, tuple) and isinstance(vehicle, ss.RollHalfCar) else value

    return dataclasses.replace(vehicle, **{f.name: left(getattr(vehicle, f.name)) for f in dataclasses.fields(vehicle)})


@given(models.vehicles, models.roads)
@settings(max_examples=150)
def test_polynomials_and_matrices_agree(vehicle, road):
    vehicle = mirrored(vehicle)
    assert vehicle.halves()
    try:
        expected = by_matrices(vehicle, road)
    except ValueError:
        assume(False)
    values = variances_of(vehicle, road)
    np.testing.assert_allclose(values, expected, rtol=1e-9, atol=0.0)


@pytest.mark.parametrize("speed", [0.3, 1.0, 4.0])
@pytest.mark.parametrize("tracks", ["independent", "isotropic"])
def test_long_delays(speed, tracks):
    for name in ("pitch half", "full, bars"):
        road = ss.Road(tracks=tracks, speed=speed)
        values = variances_of(VEHICLES[name], road)
        np.testing.assert_allclose(values, by_matrices(VEHICLES[name], road), rtol=1e-9)


@pytest.mark.parametrize(
    "extreme",
    [{"cs": 1e-3}, {"cs": 1e5}, {"kt": 1e9}, {"mu": 0.01}, {"iyy": 1e-2}, {"iyy": 1e7}, {"ks": (1e-3, 1e7)}],
    ids=str,
)
def test_extreme_pairs_of_axles_keep_six_digits_or_are_refused(extreme):
    car, road = ss.PitchHalfCar(**extreme), oracles.RoadCase(speed=20.0)
    try:
        metrics = ss.ride_metrics(car, ss.Road())
    except ValueError:
        with pytest.raises(ValueError, match="keeps fewer than six digits"):
            ss.ride_metrics(car, ss.Road())
        return
    oracle = models.oracle(car, digits=60)
    expected = oracles.metrics(oracle, oracles.variance_lyapunov_delay(oracle, road, digits=60))
    for name in ("sws", "dtl"):
        for end in "fr":
            value = float(metrics[name].sel(corner=end))
            np.testing.assert_allclose(value, expected[f"{name}_{end}"], rtol=1e-6)
    np.testing.assert_allclose(float(metrics.pitch_acc), expected["pitch_acc"], rtol=1e-6)


def test_a_symmetric_car_with_hardly_any_damping_is_not_refused():
    metrics = ss.ride_metrics(ss.FullCar(cs=1e-6), ss.Road())
    assert float(metrics.roll_acc) == 0.0
    assert np.isfinite(metrics.sws).all()


def test_a_sweep_may_mix_symmetric_designs_with_others():
    ks = np.array([18e3, 18e3, 18e3, 21e3])
    cars = ss.FullCar(ks=ss.Corners(fr=ks, fl=18e3, rr=18e3, rl=18e3), cs=np.array([1e3, 1.5e3, 2e3, 1e3]))
    metrics = ss.ride_metrics(cars, ss.Road(tracks="isotropic"))
    for i, k in enumerate(ks):
        one = ss.FullCar(ks=ss.Corners(fr=k, fl=18e3, rr=18e3, rl=18e3), cs=float(cars.cs[i]))
        alone = ss.ride_metrics(one, ss.Road(tracks="isotropic"))
        for name in metrics:
            np.testing.assert_allclose(metrics[name].isel(design=i), alone[name], rtol=1e-9)


def test_compiled_code_gives_the_same(monkeypatch):
    """Every vehicle on every road, and the refusal of one design among many."""
    cs = np.linspace(0.6, 1.6, 5)
    roads = [*ROADS.values(), *WHEEL_ROADS.values()]
    cases = [(vehicle, road) for vehicle in VEHICLES.values() for road in roads]
    cases = [(v, road) for v, road in cases if road.wheels is None or set(road.wheels) <= set(v.wheels)]

    def swept(vehicle):
        def times(value):
            if isinstance(value, ss.Corners):
                return ss.Corners(**{f.name: cs * getattr(value, f.name) for f in dataclasses.fields(value)})
            return tuple(cs * part for part in value) if isinstance(value, tuple) else cs * value

        return dataclasses.replace(vehicle, cs=times(vehicle.cs))

    plain = [variances_of(swept(vehicle), road) for vehicle, road in cases]
    monkeypatch.setattr(f"{ENGINE}.PLENTY", 1)
    monkeypatch.setattr(f"{ENGINE}.MANY", 1)
    for (vehicle, road), expected in zip(cases, plain, strict=True):
        values = variances_of(swept(vehicle), road)
        np.testing.assert_allclose(values, expected, rtol=1e-9)

    uneven = ss.Corners(fr=17e3, fl=18e3, rr=np.r_[np.full(700, 19e3), 1e17], rl=18e3)
    with pytest.raises(ValueError, match=r"FullCar at \(design=700\).*fewer than six digits"):
        ss.ride_metrics(ss.FullCar(ks=uneven), ss.Road())
    with pytest.raises(ValueError, match="no damper reaches"):
        ss.ride_metrics(ss.FullCar(ks=uneven, cs=0.0), ss.Road())


def companion(D):
    """``A`` and ``b`` of ``D(d/dt) xi = w`` for monic D."""
    n = len(D) - 1
    A = np.eye(n, k=1)
    A[-1] = -np.asarray(D[:-1])
    return A, np.eye(n)[-1]


stable = st.lists(st.tuples(st.floats(0.05, 3.0), st.floats(0.3, 30.0)), min_size=1, max_size=4)


def polynomial(modes, real):
    D = np.array([1.0])
    for damping, frequency in modes:
        D = np.convolve(D, [frequency**2, 2.0 * damping * frequency, 1.0])
    return np.convolve(D, [real, 1.0]) if real else D


@given(stable, st.one_of(st.none(), st.floats(0.5, 20.0)), st.floats(0.1, 10.0))
@settings(max_examples=30)
def test_routh_solves_the_lyapunov_equation_of_the_companion(modes, real, density):
    D = polynomial(modes, real)
    A, b = companion(D)
    X = oracles.variance_lyapunov_mpmath(A, density * np.outer(b, b), digits=40)
    even = polynomials.routh(D[:, None], np.array([density]))[:, 0]
    # E[xi^(k) xi^(k)] = (-1)^k r^(2k)(0).
    expected = [float(X[k, k]) for k in range(len(A))]
    np.testing.assert_allclose(even * (-1.0) ** np.arange(len(A)), expected, rtol=1e-9)


@given(stable, st.floats(0.01, 0.3))
def test_the_delay_operator_is_the_exponential_modulo_the_polynomial(modes, tau):
    D = polynomial(modes, None)
    A, _ = companion(D)
    squarings = max(0, int(np.ceil(np.log2(2.0 * max(f * (1 + d) for d, f in modes) * tau))))
    p = polynomials.delay_operator(D[:, None], np.array([tau]), squarings)[:, 0]
    # By Cayley and Hamilton the same polynomial carries the companion's state; its first row reads the function.
    np.testing.assert_allclose(p, scipy.linalg.expm(A * tau)[0], rtol=1e-7, atol=1e-9 * np.abs(p).max())
