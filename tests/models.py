"""The one table of vehicles and roads that drives the tests, each vehicle beside its independent oracle."""

from dataclasses import fields

import mpmath
from hypothesis import strategies as st

import oracles
import susp_ss as ss

CORNERS = ("fr", "fl", "rr", "rl")


def oracle(vehicle, digits=None):
    """The same vehicle, written out term by term by the oracle; with `digits` in multiple precision from the start."""
    number = float if digits is None else mpmath.mpf

    def of(value):
        return tuple(map(number, value)) if isinstance(value, (ss.Corners, tuple)) else number(value)

    values = {field.name: of(getattr(vehicle, field.name)) for field in fields(vehicle)}
    writers = {
        ss.RigidTyreQuarterCar: oracles.rigid_tyre_matrices,
        ss.QuarterCar: oracles.quarter_matrices,
        ss.PitchHalfCar: oracles.pitch_half_matrices,
        ss.RollHalfCar: oracles.roll_half_matrices,
        ss.FullCar: oracles.full_car_matrices,
    }
    with mpmath.workdps(digits or 15):
        return writers[type(vehicle)](**values)


def handling_parameters(car):
    """Every parameter of a `RideHandlingCar` for the oracle, those of wheels by wheel."""
    return {
        field.name: dict(zip(car.wheels, car.at_wheels(field.name), strict=True))
        if field.name in car.per_corner
        else getattr(car, field.name)
        for field in fields(car)
    }


UNEQUAL = {
    "mu": ss.Corners(fr=41.0, fl=44.0, rr=47.0, rl=52.0),
    "ks": ss.Corners(fr=16e3, fl=18e3, rr=21e3, rl=24e3),
    "cs": ss.Corners(fr=1200.0, fl=1600.0, rr=1400.0, rl=1800.0),
    "kt": ss.Corners(fr=180e3, fl=195e3, rr=205e3, rl=215e3),
}

VEHICLES = {
    "rigid tyre": ss.RigidTyreQuarterCar(),
    "quarter": ss.QuarterCar(),
    "quarter, tyre damping": ss.QuarterCar(ct=150.0),
    "pitch half": ss.PitchHalfCar(),
    "pitch half, unequal ends": ss.PitchHalfCar(ks=(16e3, 22e3), cs=(1200.0, 1700.0), mu=(40.0, 50.0), ct=(50.0, 90.0)),
    "roll half": ss.RollHalfCar(),
    "roll half, unequal sides, bar": ss.RollHalfCar(ks=(16e3, 22e3), cs=(1200.0, 1700.0), arb=15e3),
    "full": ss.FullCar(),
    "full, bars": ss.FullCar(arb_front=20e3, arb_rear=8e3),
    "full, unequal corners": ss.FullCar(**UNEQUAL),
    "full, unequal corners, bars, tyre damping": ss.FullCar(**UNEQUAL, arb_front=15e3, arb_rear=5e3, ct=80.0),
}

ROADS = {
    "identical": ss.Road(),
    "identical, no delay": ss.Road(delay=False),
    "independent": ss.Road(tracks="independent", speed=13.0),
    "independent, no delay": ss.Road(tracks="independent", delay=False),
    "isotropic": ss.Road(tracks="isotropic"),
    "isotropic, slow": ss.Road(tracks="isotropic", speed=4.0),
    "isotropic, no delay": ss.Road(tracks="isotropic", delay=False),
    "identical, cut-off": ss.Road(cutoff=0.01),
    "independent, cut-off": ss.Road(tracks="independent", cutoff=0.02, speed=30.0),
    "isotropic, cut-off": ss.Road(tracks="isotropic", cutoff=0.01),
}

# Names that only a four-wheeled car knows: roads that would drift without their cut-off.
WHEEL_ROADS = {
    "front axle, identical": ss.Road(wheels=("fr", "fl")),
    "right track, independent": ss.Road(tracks="independent", wheels=("fr", "rr")),
    "one wheel, cut-off": ss.Road(wheels=("rl",), cutoff=0.02),
    "diagonal, isotropic, cut-off": ss.Road(wheels=("fr", "rl"), tracks="isotropic", cutoff=0.02),
    "front axle, independent, cut-off": ss.Road(wheels=("fr", "fl"), tracks="independent", cutoff=0.05),
}


def oracle_road(road):
    """The same road for the oracle."""
    names = ("roughness", "speed", "waviness", "cutoff", "tracks", "delay", "wheels")
    return oracles.RoadCase(**{name: getattr(road, name) for name in names})


def _about(value, factor=3.0):
    return st.floats(value / factor, value * factor)


def _per_corner(value, factor=3.0):
    one = _about(value, factor)
    return st.one_of(one, st.builds(ss.Corners, fr=one, fl=one, rr=one, rl=one))


def _per_end(value, factor=3.0):
    one = _about(value, factor)
    return st.one_of(one, st.tuples(one, one))


quarter_cars = st.builds(
    ss.QuarterCar,
    ms=_about(317.5),
    mu=_about(45.4),
    ks=_about(18e3),
    cs=_about(1500.0),
    kt=_about(192e3),
    ct=st.floats(0.0, 300.0),
)
pitch_half_cars = st.builds(
    ss.PitchHalfCar,
    mb=_about(635.0),
    iyy=_about(534.0),
    a=_about(0.96, 2.0),
    b=_about(1.5, 2.0),
    mu=_per_end(45.4),
    ks=_per_end(18e3),
    cs=_per_end(1500.0),
    kt=_per_end(192e3),
    ct=st.floats(0.0, 300.0),
)
roll_half_cars = st.builds(
    ss.RollHalfCar,
    mb=_about(635.0),
    ixx=_about(110.0),
    c=_about(0.72, 2.0),
    mu=_per_end(45.4),
    ks=_per_end(18e3),
    cs=_per_end(1500.0),
    kt=_per_end(192e3),
    ct=st.floats(0.0, 300.0),
    arb=st.floats(0.0, 3e4),
)
full_cars = st.builds(
    ss.FullCar,
    mb=_about(1270.0),
    ixx=_about(220.0),
    iyy=_about(1067.0),
    a=_about(0.96, 2.0),
    b=_about(1.5, 2.0),
    c=_about(0.72, 2.0),
    mu=_per_corner(45.4),
    ks=_per_corner(18e3),
    cs=_per_corner(1500.0),
    kt=_per_corner(192e3),
    ct=st.one_of(st.just(0.0), _per_corner(100.0)),
    arb_front=st.floats(0.0, 3e4),
    arb_rear=st.floats(0.0, 3e4),
)
ride_handling_cars = st.builds(
    ss.RideHandlingCar,
    mb=_about(1270.0, 1.5),
    a=_about(1.1, 1.3),
    b=_about(1.4, 1.3),
    c=_about(0.72, 1.2),
    mu=_per_corner(45.4, 1.5),
    ks=_per_corner(25e3, 1.5),
    cs=_per_corner(1500.0, 2.0),
    kt=_per_corner(192e3, 1.5),
    ct=st.one_of(st.just(0.0), _per_corner(100.0)),
    arb_front=st.floats(0.0, 3e4),
    arb_rear=st.floats(0.0, 3e4),
    izz=st.floats(1500.0, 3000.0),
    ixz=st.floats(-50.0, 50.0),
    height=st.floats(0.3, 0.7),
    roll_centre_front=st.floats(-0.05, 0.3),
    roll_centre_rear=st.floats(-0.05, 0.4),
    radius=_about(0.31, 1.2),
    cornering=_per_corner(45e3, 1.3),
    relaxation=st.one_of(st.just(0.0), st.floats(0.1, 0.6), st.just(ss.Corners(fr=0.3, fl=0.0, rr=0.0, rl=0.4))),
    slip=_per_corner(50e3, 2.0),
    wheel_inertia=_per_corner(1.0, 2.0),
    steering=st.one_of(st.none(), st.floats(5e3, 5e4)),
    speed=st.floats(5.0, 35.0),
)
vehicles = st.one_of(quarter_cars, pitch_half_cars, roll_half_cars, full_cars)
roads = st.builds(
    ss.Road,
    roughness=st.floats(1e-6, 1e-2),
    speed=st.floats(3.0, 50.0),
    cutoff=st.one_of(st.just(0.0), st.floats(1e-3, 0.1)),
    tracks=st.sampled_from(["identical", "independent", "isotropic"]),
    delay=st.booleans(),
)
