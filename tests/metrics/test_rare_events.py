"""Rare events against statics, simulations, what they must scale with, and one another."""

import control
import numpy as np
import pytest
import xarray as xr
from hypothesis import given, settings
from hypothesis import strategies as st

import models
import susp_ss as ss

ROAD = ss.Road.iso8608("D", speed=20.0, tracks="isotropic", contact_length=0.2)


def loads(vehicle, road=ROAD):
    return ss.rare_events(vehicle, road).static_load


@settings(max_examples=25)
@given(models.full_cars, st.floats(-0.9, 0.9), st.floats(-0.6, 0.6))
def test_static_loads_carry_the_weight_and_its_moments(car, x, y):
    car = car.with_seats({"driver": ss.Seat(x=x, y=y, mass=80.0)})
    at = dict(zip(car.wheels, car.flattened(car.design_space()).static_loads(), strict=True))
    mu = dict(zip(car.wheels, car.at_wheels("mu"), strict=True))
    body = {name: load - 9.81 * mu[name] for name, load in at.items()}
    assert sum(body.values()) == pytest.approx(9.81 * (car.mb + 80.0))
    ahead = sum(load * (car.a if name[0] == "f" else -car.b) for name, load in body.items())
    left = sum(load * (car.c if name[1] == "l" else -car.c) for name, load in body.items())
    size = 9.81 * (car.mb + 80.0) * car.a
    assert ahead == pytest.approx(9.81 * 80.0 * x, abs=1e-9 * size)
    assert left == pytest.approx(9.81 * 80.0 * y, abs=1e-9 * size)


def test_static_loads_of_every_kind():
    car, truck = ss.FullCar(), ss.ThreeAxleTruck()
    front = 9.81 * (car.mu + 0.5 * car.mb * car.b / (car.a + car.b))
    np.testing.assert_allclose(loads(car).sel(corner=["fr", "fl"]), front)
    np.testing.assert_allclose(loads(ss.RideHandlingCar()).sel(corner="fr"), front)
    half = ss.PitchHalfCar()
    assert float(loads(half).sel(corner="f")) == pytest.approx(9.81 * (half.mu + half.mb * half.b / (half.a + half.b)))
    np.testing.assert_allclose(loads(ss.RollHalfCar()), 9.81 * (45.4 + 0.5 * 635.0))
    assert float(loads(ss.QuarterCar())) == pytest.approx(9.81 * (317.5 + 45.4))
    assert float(loads(ss.QuarterCarWithSeat())) == pytest.approx(9.81 * (317.5 + 45.4 + ss.Seat.mass))
    of_truck = loads(truck, ss.Road(contact_length=0.2))
    assert float(of_truck.sum()) == pytest.approx(9.81 * (truck.mb + 2.0 * sum(truck.mu[::2])))


@pytest.fixture(scope="module")
def ride():
    """Twenty records of 40 s of a quarter car, after 5 s over which the start is forgotten."""
    car, road = ss.QuarterCar(), ss.Road.iso8608("D", speed=20.0, contact_length=0.2)
    profile = ss.synthesise(road, 20 * 900.0, 0.01, seed=7)
    history = ss.simulate(car, profile, speed=20.0, step=0.5e-3)
    at = {name: history[name].values[: 20 * 90000].reshape(20, -1)[:, 10000:] for name in ("sws", "dtl", "bacc")}
    return car, road, at


def crossings(y, level):
    """Upward crossings a second of every record."""
    return ((y[:, 1:] > level) & (y[:, :-1] <= level)).sum(axis=1) / 40.0


def close(values, expected, left_out=0.0):
    error = values.std(ddof=1) / np.sqrt(len(values))
    return abs(values.mean() - expected) < 4.5 * error + left_out * expected


def test_rates_are_those_of_a_simulation(ride):
    car, road, at = ride
    gap = 0.035
    events = ss.rare_events(car, road, clearance=gap, rebound=1.2 * gap)
    assert close(crossings(at["sws"], gap), float(events.bump_rate))
    assert close(crossings(-at["sws"], 1.2 * gap), float(events.rebound_rate))
    for name in ("sws", "bacc"):
        assert close(crossings(at[name], 0.0), float(events[f"{name}_crossings"])), name
    # A profile ends at two of its steps, which takes half a per cent from the rate of the load.
    assert close(crossings(-at["dtl"], float(events.static_load)), float(events.lift_off_rate), 0.01)
    assert close(crossings(at["dtl"], 0.0), float(events.dtl_crossings), 0.01)


def test_highest_values_and_probabilities_are_those_of_a_simulation(ride):
    car, road, at = ride
    gap = 0.05
    events = ss.rare_events(car, road, clearance=gap, duration=10.0)
    for name, factor in (("sws", 1.0), ("bacc", 1.0), ("dtl", 1.0)):
        highest = (factor * at[name]).reshape(80, -1).max(axis=1)
        expected = float(events[f"{name}_highest"].sel(estimate="vanmarcke"))
        assert close(highest, expected, 0.01), name
    reached = at["sws"].reshape(80, -1).max(axis=1) > gap
    assert close(reached.astype(float), float(events.bump_probability), 0.02)


def test_irregularity_is_that_of_a_simulation(ride):
    car, road, at = ride
    slopes = np.diff(at["sws"], axis=1)
    peaks = ((slopes[:, :-1] > 0.0) & (slopes[:, 1:] <= 0.0)).sum(axis=1) / 40.0
    assert close(crossings(at["sws"], 0.0) / peaks, float(ss.rare_events(car, road).irregularity), 0.01)


@settings(max_examples=5)
@given(st.floats(0.1, 10.0))
def test_only_the_ratio_of_clearance_to_road_counts(factor):
    car = ss.PitchHalfCar()

    def bump(scale):
        road = ss.Road(roughness=256e-6 * scale**2, contact_length=0.1, tracks="isotropic")
        return ss.rare_events(car, road, clearance=0.03 * scale)

    one, other = bump(1.0), bump(factor)
    xr.testing.assert_allclose(one.bump_rate, other.bump_rate, rtol=1e-7)
    xr.testing.assert_allclose(one.sws_highest * factor, other.sws_highest, rtol=1e-7)
    xr.testing.assert_allclose(one.damage * factor**5, other.damage, rtol=1e-7)


def test_a_sweep_is_its_designs_one_by_one():
    gaps = xr.DataArray([0.05, 0.06, 0.07], dims="gap", coords={"gap": [50, 60, 70]})
    speeds = xr.DataArray([15.0, 25.0], dims="speed", coords={"speed": [15.0, 25.0]})
    road = ss.Road.iso8608("D", speed=speeds, tracks="isotropic", contact_length=0.1)
    swept = ss.rare_events(ss.FullCar(ks=np.array([15e3, 20e3])), road, clearance=gaps)
    assert swept.bump_probability.dims == ("speed", "design", "gap", "corner")
    assert swept.sws_highest.dims == ("speed", "design", "corner", "estimate")
    one = ss.rare_events(
        ss.FullCar(ks=20e3), ss.Road.iso8608("D", speed=25.0, tracks="isotropic", contact_length=0.1), clearance=0.06
    )
    xr.testing.assert_allclose(swept.isel(design=1).sel(speed=25.0, gap=60).drop_vars(["speed", "gap"]), one, rtol=1e-7)
    assert all("units" in data.attrs and data.attrs["long_name"] for data in swept.values())


def test_stops_of_each_wheel_and_each_axle():
    same = ss.rare_events(ss.FullCar(), ROAD, clearance=ss.Corners.axles(front=0.07, rear=0.05))
    by_axle = ss.rare_events(ss.FullCar(), ROAD, clearance=(0.07, 0.05))
    xr.testing.assert_allclose(same, by_axle)
    front = ss.rare_events(ss.FullCar(), ROAD, clearance=0.07).bump_rate.sel(corner="fr")
    assert float(same.bump_rate.sel(corner="fr")) == pytest.approx(float(front))
    wider = ss.rare_events(ss.FullCar(), ROAD, clearance=0.07, rebound=0.09)
    assert (wider.rebound_rate < wider.bump_rate).all()


def test_curves_are_linearised_about_their_mean():
    car = ss.QuarterCar(cs=ss.DamperCurve.two_slopes(bump=800.0, rebound=2400.0))
    events = ss.rare_events(car, ROAD, clearance=0.06, rebound=0.08)
    shift = float(events.ride_height_shift)
    assert shift > 0.0
    linear = ss.rare_events(ss.linearised(car, ROAD), ROAD, clearance=0.06 - shift, rebound=0.08 + shift)
    assert float(events.bump_rate) == pytest.approx(float(linear.bump_rate), rel=1e-7)
    assert float(events.rebound_probability) == pytest.approx(float(linear.rebound_probability), rel=1e-7)
    assert "linearised" in events.attrs["comment"]


def test_a_system_has_what_needs_no_masses():
    car = ss.QuarterCar()
    system = ss.LinearVehicle(car.state_space(input="velocity"), like=car)
    own, found = ss.rare_events(car, ROAD, clearance=0.05), ss.rare_events(system, ROAD, clearance=0.05)
    xr.testing.assert_allclose(own[list(found)], found, rtol=1e-6)
    assert {"static_load", "lift_off_rate", "lift_off_probability", "damage"} == set(own) - set(found)
    assert "LinearVehicle has neither static loads nor springs" in found.attrs["comment"]
    assert "comment" not in own.attrs
    white = ss.rare_events(system, ss.Road(), clearance=0.05)
    assert float(white.dtl_crossings) == np.inf
    assert np.isfinite(white.bump_rate)


def test_damage_counts_cycles_of_the_reference():
    once = ss.rare_events(ss.QuarterCar(), ROAD, sn_range=2000.0, sn_slope=4.0)
    many = ss.rare_events(ss.QuarterCar(), ROAD, sn_range=4000.0, sn_slope=4.0, sn_cycles=10.0, distance=2000.0)
    np.testing.assert_allclose(many.damage, once.damage * 2.0 / 10.0 / 2.0**4)
    stiffer = ss.rare_events(ss.QuarterCar(), ROAD, duration=50.0)
    xr.testing.assert_allclose(stiffer, ss.rare_events(ss.QuarterCar(), ROAD, distance=1000.0))


@pytest.mark.parametrize(
    ("vehicle", "road", "more", "kind", "said"),
    [
        (
            ss.QuarterCar(),
            ss.Road(),
            {},
            ValueError,
            r"infinite rate of lift-off, .* Road\(contact_length=...\) must be > 0",
        ),
        (
            ss.QuarterCar(ct=np.array([0.0, 50.0])),
            ROAD,
            {},
            ValueError,
            r"at \(design=1\) has an .* pass ct=0",
        ),
        (ss.RigidTyreQuarterCar(), ROAD, {}, ValueError, "a tyre that is not rigid"),
        (ss.QuarterCar(cs=0.0), ROAD, {}, ValueError, "no damper reaches"),
        ("car", ROAD, {}, TypeError, "vehicle must be one of the package's vehicles"),
        (ss.QuarterCar(), None, {}, TypeError, "road must be a Road"),
        (
            ss.FullCar(),
            ROAD,
            {"clearance": -0.01},
            ValueError,
            r"\(clearance=...\) must be > 0 m, got -0.01",
        ),
        (ss.FullCar(), ROAD, {"clearance": np.nan}, ValueError, r"\(clearance=...\) must be > 0 m, got nan"),
        (ss.FullCar(), ROAD, {"clearance": "high"}, TypeError, r"rare_events\(clearance=...\) must be > 0 m"),
        (ss.FullCar(), ROAD, {"clearance": (1, 2, 3)}, ValueError, "one value, or one a wheel .fr, fl, rr, rl."),
        (ss.QuarterCar(), ROAD, {"clearance": (0.1,)}, ValueError, r"must be one value, got \(0.1,\)"),
        (ss.QuarterCar(), ROAD, {"rebound": 0.1}, ValueError, "rebound needs a clearance"),
        (ss.QuarterCar(), ROAD, {"distance": None}, TypeError, "distance must be a number > 0 m, got None"),
        (ss.QuarterCar(), ROAD, {"duration": 0.0}, ValueError, "duration must be > 0 s and finite, got 0.0"),
        (ss.QuarterCar(), ROAD, {"sn_slope": np.inf}, ValueError, "sn_slope must be > 0 and finite, got inf"),
        (ss.QuarterCar(), ROAD, {"sn_range": "1 kN"}, TypeError, "sn_range must be a number > 0 N, got '1 kN'"),
    ],
)
def test_what_has_no_answer_is_refused(vehicle, road, more, kind, said):
    with pytest.raises(kind, match=said):
        ss.rare_events(vehicle, road, **more)


def test_stops_need_deflections():
    lag = control.ss([[-1.0]], [[1.0]], [[1.0]], [[0.0]], inputs=["dz_r"], outputs=["gap"])
    with pytest.raises(ValueError, match="needs a vehicle with suspension deflections, outputs sws"):
        ss.rare_events(ss.LinearVehicle(lag), ss.Road(), clearance=0.1)
    with pytest.raises(ValueError, match="needs a vehicle with outputs bacc, sws, dtl"):
        ss.rare_events(ss.LinearVehicle(lag), ss.Road())
    with pytest.raises(ValueError, match=r"bump stop must fit the designs, got {'design': 3} for {'design': 2}"):
        ss.rare_events(ss.QuarterCar(ks=np.array([1e4, 2e4])), ROAD, np.array([0.05, 0.06, 0.07]))


def test_a_slope_whose_powers_are_no_numbers_is_refused():
    with pytest.raises(ValueError, match="sn_slope must be > 0 and at most 50, got 400"):
        ss.rare_events(ss.QuarterCar(), ss.Road.iso8608("C", contact_length=0.1), sn_slope=400.0)
