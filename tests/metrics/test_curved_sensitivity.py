"""Sensitivities through the fixed point of linearisation, against differences of metrics."""

import dataclasses

import numpy as np
import pytest

import susp_ss as ss
from susp_ss.vehicles.curves import rate_of

TWO = ss.DamperCurve.two_slopes(bump=800.0, rebound=2400.0)
DIGRESSIVE = ss.DamperCurve.digressive(bump=1000.0, rebound=3000.0, knee=0.2, final=0.3)
STOPS = ss.SpringCurve.with_stops(ks=18e3, stop=150e3, bump=0.03, rebound=0.04)
ROAD = ss.Road.iso8608("C", speed=20.0, tracks="isotropic", cutoff=0.01)
CASES = {
    "quarter": (ss.QuarterCar(cs=DIGRESSIVE, ks=STOPS), ("ks", "cs", "kt", "speed", "cutoff"), {}),
    "weighted": (ss.QuarterCar(cs=DIGRESSIVE), ("ks", "cs", "ms", "roughness"), {"weighting": "Wk"}),
    "symmetric": (ss.FullCar(cs=DIGRESSIVE, ks=STOPS, arb_front=12e3), ("cs", "c", "arb_front"), {}),
    "unequal": (
        ss.FullCar(
            cs=ss.Corners(fr=DIGRESSIVE, fl=TWO, rr=1500.0, rl=TWO),
            ks=ss.Corners(fr=STOPS, fl=18e3, rr=STOPS, rl=STOPS),
            arb_front=12e3,
        ),
        ("cs", "cs_rl", "cs_rr", "ks_fr", "ks_fl", "kt_fr", "a", "arb_front"),
        {},
    ),
}


def metrics_at(car, name, value, how):
    if name in ("speed", "roughness", "cutoff"):
        return ss.ride_metrics(car, dataclasses.replace(ROAD, **{name: value}), **how)
    field, wheels = car.settings()[name]
    own = dict(zip(car.wheels, car.at_wheels(field), strict=True))
    if len({rate_of(own[wheel]) for wheel in wheels}) == 1:
        return ss.ride_metrics(car.replaced(**{name: value}), ROAD, **how)
    # One common change where corners differ, by as much at each.
    change = value - rate_of(own[wheels[0]])
    at = {f"{field}_{wheel}": rate_of(own[wheel]) + change for wheel in wheels}
    return ss.ride_metrics(car.replaced(**at), ROAD, **how)


@pytest.mark.parametrize("case", CASES)
def test_sensitivities_are_what_differences_tell(case):
    car, names, how = CASES[case]
    slope, own = ss.sensitivity(car, ROAD, names, **how), ss.ride_metrics(car, ROAD, **how)
    assert set(slope) == set(own)
    for name in names:
        field = car.settings().get(name, (name, None))
        at = getattr(ROAD, name, None)
        if at is None:
            at = rate_of(dict(zip(car.wheels, car.at_wheels(field[0]), strict=True))[field[1][0]])
        h = 1e-4 * at
        above, below = (metrics_at(car, name, at + step, how) for step in (h, -h))
        for metric, data in own.items():
            expected = (above[metric] - below[metric]) / (2.0 * h)
            got = slope[metric].sel(parameter=name)
            error = np.abs(got - expected).max() * at / np.abs(data).max()
            assert error < 1e-6, (name, metric)


def test_a_sweep_of_sensitivities():
    damper = DIGRESSIVE * np.array([0.7, 1.0, 1.4])
    many = ss.sensitivity(ss.FullCar(cs=damper), ROAD, ["cs", "mb"])
    one = ss.sensitivity(ss.FullCar(cs=1.4 * DIGRESSIVE), ROAD, ["cs", "mb"])
    for name, data in one.items():
        np.testing.assert_allclose(many[name].isel(design=2), data, rtol=1e-6, atol=1e-12)
