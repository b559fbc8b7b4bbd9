"""Closed forms, reductions of one model to another, and python-control's own H2 norm."""

import control as ct
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import models
import oracles
import susp_ss as ss
from models import VEHICLES

undamped_tyre_quarter_cars = st.builds(
    ss.QuarterCar,
    ms=st.floats(50.0, 2000.0),
    mu=st.floats(5.0, 200.0),
    ks=st.floats(2e3, 2e5),
    cs=st.floats(50.0, 2e4),
    kt=st.floats(5e4, 1e6),
)


@given(undamped_tyre_quarter_cars, st.floats(1.0, 60.0))
@settings(max_examples=200)
def test_quarter_car_closed_forms(car, speed):
    road = ss.Road(speed=speed)
    q = oracles.road_intensity(road.roughness, speed)
    metrics = ss.ride_metrics(car, road)
    ms, mu, ks, cs, kt = car.ms, car.mu, car.ks, car.cs, car.kt
    for name, variance in {
        "sws": oracles.quarter_deflection_variance(ms, mu, cs, q),
        "bacc": oracles.quarter_body_acceleration_variance(ms, mu, ks, cs, kt, q),
        "dtl": oracles.quarter_tyre_force_variance(ms, mu, ks, cs, kt, q),
    }.items():
        np.testing.assert_allclose(float(metrics[name]), np.sqrt(variance), rtol=1e-9)
    np.testing.assert_allclose(float(metrics.damper_power), oracles.quarter_damper_power(kt, q), rtol=1e-9)


@given(st.floats(10.0, 3000.0), st.floats(1e3, 1e6), st.floats(10.0, 1e5))
@settings(max_examples=50)
def test_rigid_tyre_closed_form(ms, ks, cs):
    metrics = ss.ride_metrics(ss.RigidTyreQuarterCar(ms=ms, ks=ks, cs=cs), ss.Road())
    variance = oracles.rigid_tyre_deflection_variance(ms, cs, ss.Road().intensity)
    np.testing.assert_allclose(float(metrics.sws), np.sqrt(variance), rtol=1e-9)
    assert np.isinf([metrics.bacc, metrics.dtl, metrics.damper_power]).all()


def test_comfort_optimal_damping():
    car = ss.QuarterCar()
    best = oracles.comfort_optimal_damping(car.ms, car.mu, car.ks, car.kt)
    around = best * (1 + np.linspace(-0.01, 0.01, 201))
    metrics = ss.ride_metrics(ss.QuarterCar(cs=around), ss.Road())
    np.testing.assert_allclose(around[int(metrics.bacc.argmin("design"))], best, rtol=1e-4)


def equal_ends(**changes):
    return ss.FullCar(a=1.2, b=1.2, **changes)


@pytest.mark.parametrize("arb", [0.0, 12e3])
def test_heave_and_roll_of_a_symmetric_car_are_quarter_cars(arb):
    car = equal_ends(arb_front=arb, arb_rear=arb)
    masses = oracles.equivalent_sprung_masses(car.mb, car.iyy, car.ixx, car.a, car.c)
    together = ss.ride_metrics(car, ss.Road(delay=False))
    heave = ss.ride_metrics(ss.QuarterCar(ms=masses["heave"]), ss.Road())
    for name in ("sws", "dtl", "damper_power"):
        np.testing.assert_allclose(together[name].values, float(heave[name]), rtol=1e-9)
    np.testing.assert_allclose(together.bacc.values, float(heave.bacc), rtol=1e-9)

    # Independent tracks add a half difference of half the intensity, which only rolls the car.
    apart = ss.ride_metrics(car, ss.Road(delay=False, tracks="independent"))
    roll = ss.ride_metrics(ss.QuarterCar(ms=masses["roll"], ks=car.ks + 2 * arb), ss.Road())
    for name in ("sws", "dtl"):
        expected = np.sqrt(0.5 * float(heave[name]) ** 2 + 0.5 * float(roll[name]) ** 2)
        np.testing.assert_allclose(apart[name].values, expected, rtol=1e-9)
    np.testing.assert_allclose(float(apart.roll_acc), np.sqrt(0.5) * float(roll.bacc) / car.c, rtol=1e-9)


def test_pitch_of_a_symmetric_car_is_a_quarter_car():
    # Front and rear far enough apart in time are uncorrelated: mean and half difference of the axles carry half each.
    car = equal_ends()
    masses = oracles.equivalent_sprung_masses(car.mb, car.iyy, car.ixx, car.a, car.c)
    metrics = ss.ride_metrics(car, ss.Road(speed=0.1))
    road = ss.Road(speed=0.1)
    heave, pitch = (ss.ride_metrics(ss.QuarterCar(ms=masses[name]), road) for name in ("heave", "pitch"))
    np.testing.assert_allclose(float(metrics.pitch_acc), np.sqrt(0.5) * float(pitch.bacc) / car.a, rtol=1e-9)
    for name in ("sws", "dtl"):
        expected = np.sqrt(0.5 * float(heave[name]) ** 2 + 0.5 * float(pitch[name]) ** 2)
        np.testing.assert_allclose(metrics[name].values, expected, rtol=1e-9)


@pytest.mark.parametrize("delay", [True, False])
def test_half_cars_are_full_cars_on_special_roads(delay):
    full = ss.ride_metrics(ss.FullCar(), ss.Road(delay=delay))
    pitch = ss.ride_metrics(ss.PitchHalfCar(), ss.Road(delay=delay))
    for name in ("sws", "dtl", "damper_power"):
        for end in "fr":
            for side in "rl":
                ours = full[name].sel(corner=end + side)
                np.testing.assert_allclose(float(ours), float(pitch[name].sel(corner=end)), rtol=1e-9)
    np.testing.assert_allclose(float(full.pitch_acc), float(pitch.pitch_acc), rtol=1e-9)
    roll = ss.ride_metrics(ss.RollHalfCar(), ss.Road(tracks="isotropic"))
    both = ss.ride_metrics(ss.FullCar(a=1.2, b=1.2), ss.Road(tracks="isotropic", delay=False))
    np.testing.assert_allclose(float(both.roll_acc), float(roll.roll_acc), rtol=1e-9)
    np.testing.assert_allclose(both.sws.sel(corner=["fr", "fl"]).values, roll.sws.values, rtol=1e-9)


WHEEL_BY_WHEEL = ["quarter", "pitch half", "pitch half, unequal ends", "roll half", "roll half, unequal sides, bar"]


@pytest.mark.parametrize("name", WHEEL_BY_WHEEL)
def test_h2_norm_wheel_by_wheel(name):
    vehicle = VEHICLES[name]
    system = vehicle.state_space(input="velocity")
    for wheel in vehicle.wheels:
        road = ss.Road(wheels=(wheel,) if wheel else None, delay=False)
        metrics = ss.ride_metrics(vehicle, road)
        checked = 0
        for output in system.output_labels:
            kind, _, place = output.partition("_")
            value = metrics[output] if output in metrics else metrics[kind]
            value = float(value.sel({value.dims[0]: place}) if value.dims else value)
            norm = ct.norm(system[output, f"dz_r_{wheel}" if wheel else "dz_r"], 2, method="scipy")
            if np.isfinite(norm) or np.isfinite(value):
                np.testing.assert_allclose(value, norm * np.sqrt(road.intensity), rtol=1e-7, err_msg=output)
                checked += 1
        assert checked >= 3


@pytest.mark.parametrize("name", ["full, unequal corners", "full, unequal corners, bars, tyre damping"])
def test_h2_norm_of_a_full_car_with_unequal_corners(name):
    vehicle, road = VEHICLES[name], ss.Road(delay=False)
    system = vehicle.state_space(input="velocity")
    metrics = ss.ride_metrics(vehicle, road)
    # Four wheels on one profile do not warp, and without its integrator the rest is stable.
    assert system.state_labels[-1] == "warp"
    n = system.nstates - 1
    together = np.ones((4, 1))
    for i, output in enumerate(system.output_labels):
        one = ct.ss(system.A[:n, :n], system.B[:n] @ together, system.C[i : i + 1, :n], system.D[i : i + 1] @ together)
        kind, _, place = output.partition("_")
        value = metrics[output] if output in metrics else metrics[kind]
        value = float(value.sel({value.dims[0]: place}) if value.dims else value)
        norm = ct.norm(one, 2, method="scipy")
        if np.isinf(value):
            assert np.isinf(norm)
        else:
            np.testing.assert_allclose(value, norm * np.sqrt(road.intensity), rtol=1e-6, err_msg=output)


@pytest.mark.parametrize("wheel", ["fr", "rl"])
def test_h2_norm_of_body_acceleration_from_one_wheel(wheel):
    # One wheel alone warps the road without bound, but a cut-off far below the body's modes hardly changes BAcc.
    vehicle = VEHICLES["full, unequal corners"]
    system = vehicle.state_space(input="velocity")
    n = system.nstates - 1
    road = ss.Road(wheels=(wheel,), cutoff=1e-5)
    metrics = ss.ride_metrics(vehicle, road)
    one = system[["bacc_cg", "bacc_fr", "bacc_fl", "bacc_rr", "bacc_rl"], f"dz_r_{wheel}"]
    assert np.abs(one.C[:, n]).max() < 1e-9 * np.abs(one.C).max(), "a constant warp does not accelerate the body"
    for i, value in enumerate(metrics.bacc.values):
        norm = ct.norm(ct.ss(one.A[:n, :n], one.B[:n], one.C[i : i + 1, :n], 0), 2, method="scipy")
        np.testing.assert_allclose(value, norm * np.sqrt(road.intensity), rtol=1e-5)


@given(models.vehicles, st.floats(1e-2, 1.0))
@settings(max_examples=8)
@pytest.mark.slow
def test_light_damping_keeps_its_accuracy(vehicle, lightness):
    import dataclasses

    def lighter(value):
        if isinstance(value, ss.Corners):
            return ss.Corners(**{name: getattr(value, name) * lightness for name in ("fr", "fl", "rr", "rl")})
        return tuple(part * lightness for part in value) if isinstance(value, tuple) else value * lightness

    vehicle = dataclasses.replace(vehicle, cs=lighter(vehicle.cs), ct=0.0)
    oracle = models.oracle(vehicle, digits=40)
    road = oracles.RoadCase(speed=20.0)
    expected = oracles.metrics(oracle, oracles.variance_lyapunov_delay(oracle, road, digits=40))
    metrics = ss.ride_metrics(vehicle, ss.Road())
    for name in ("sws", "dtl"):
        for place in vehicle.wheels:
            value = metrics[name].sel(corner=place) if place else metrics[name]
            key = f"{name}_{place}" if place else name
            np.testing.assert_allclose(float(value), expected[key], rtol=1e-8)


EXTREMES = [
    *({"cs": cs} for cs in (1e-9, 1e-6, 1e-3, 1.0, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9)),
    *({name: value * factor} for name, value in (("ms", 317.5), ("mu", 45.4), ("kt", 192e3), ("ks", 18e3))
      for factor in (1e-6, 1e-4, 1e-2, 1e2, 1e4, 1e6, 1e8)),
]  # fmt: skip


@pytest.mark.parametrize("extreme", EXTREMES, ids=str)
@pytest.mark.parametrize("model", [ss.QuarterCar, ss.RollHalfCar])
def test_extreme_parameters_keep_six_digits_or_are_refused(model, extreme):
    if "ms" in extreme:
        extreme = extreme if model is ss.QuarterCar else {"mb": 2 * extreme["ms"]}
    car = model(**extreme)
    try:
        metrics = ss.ride_metrics(car, ss.Road(tracks="independent"))
    except ValueError:
        with pytest.raises(ValueError, match="keeps fewer than six digits"):
            ss.ride_metrics(car, ss.Road(tracks="independent"))
        return
    oracle = models.oracle(car, digits=60)
    road = oracles.RoadCase(speed=20.0, tracks="independent")
    expected = oracles.metrics(oracle, oracles.variance_lyapunov_delay(oracle, road, digits=60))
    for name in ("bacc", "sws", "dtl", "damper_power"):
        value = metrics[name] if model is ss.QuarterCar else metrics[name].sel({metrics[name].dims[0]: "r"})
        key = name if model is ss.QuarterCar else f"{name}_r"
        np.testing.assert_allclose(float(value), expected[key], rtol=1e-6)


@pytest.mark.parametrize("cs", [1.0, 100.0, 1e4])
def test_ordinary_damping_is_never_refused(cs):
    for road in (ss.Road(), ss.Road(tracks="isotropic"), ss.Road(delay=False)):
        assert np.isfinite(ss.ride_metrics(ss.FullCar(cs=cs), road).sws).all()
