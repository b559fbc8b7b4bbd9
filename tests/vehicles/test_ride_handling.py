"""Ride and handling in one: its equations by hand, what it reduces to, and what a car that turns steadily must obey."""

import dataclasses

import control as ct
import numpy as np
import pytest
import xarray as xr
from hypothesis import assume, given, settings

import models
import oracles
import susp_ss as ss

CAR = ss.RideHandlingCar()
# Body, axles and hubs at one height: neither gravity nor the hubs' inertia reach roll; on the ground, nor do tyres.
LEVEL = {"height": 0.31, "roll_centre_front": 0.31, "roll_centre_rear": 0.31, "radius": 0.31}
FLAT = dict.fromkeys(LEVEL, 0.0) | {"radius": 1e-9}
UNEQUAL = models.UNEQUAL | {
    "cornering": ss.Corners(fr=40e3, fl=42e3, rr=50e3, rl=55e3),
    "slip": ss.Corners(fr=40e3, fl=45e3, rr=50e3, rl=60e3),
    "ixz": 40.0,
    "roll_centre_rear": 0.2,
}
CARS = {
    "default": CAR,
    "relaxation": ss.RideHandlingCar(relaxation=0.4),
    "unequal corners": ss.RideHandlingCar(**UNEQUAL, arb_front=1e4, ct=50.0),
    "compliant steering, rear relaxation": ss.RideHandlingCar(
        **UNEQUAL, relaxation=ss.Corners.axles(front=0.0, rear=0.3), steering=9e3, speed=31.0
    ),
}
STEADY = ("ay", "yaw_rate", "sideslip", "roll", "dtl_fr", "dtl_rl", "load_transfer_front", "slip_angle_fl")


def assert_response(car, f):
    expected, outputs, inputs = oracles.ride_handling_response(models.handling_parameters(car), f)
    ours = ss.frequency_response(car, f)
    assert (ours.output.values.tolist(), ours.input.values.tolist()) == (outputs, inputs)
    # What is nothing by symmetry is nothing beside the largest answer to the same input, in the output's own unit.
    largest = np.abs(expected).max(axis=(1, 2), keepdims=True)
    per_input = np.abs(expected).max(axis=(0, 2), keepdims=True) / np.abs(expected).max()
    error = np.abs(ours.values - expected) / (np.abs(expected) + 1e-3 * largest * per_input)
    assert error.max() < 1e-8


@pytest.mark.parametrize("car", CARS.values(), ids=CARS)
def test_equations_are_those_written_out_by_hand(car):
    assert_response(car, [0.05, 0.5, 1.3, 5.0, 14.0])


@given(models.ride_handling_cars)
@settings(max_examples=15)
def test_equations_of_random_cars(car):
    assert_response(car, [0.3, 2.0, 11.0])


# Reductions


@pytest.mark.parametrize("road", ["isotropic", "independent, cut-off", "identical, no delay"])
def test_without_heights_and_cornering_stiffness_it_is_the_full_car(road):
    own = models.UNEQUAL | {"arb_front": 15e3, "arb_rear": 5e3}
    metrics = ss.ride_metrics(ss.RideHandlingCar(**own, **LEVEL, cornering=0.0), models.ROADS[road])
    for name, data in ss.ride_metrics(ss.FullCar(**own), models.ROADS[road]).items():
        np.testing.assert_allclose(metrics[name], data, rtol=1e-9, err_msg=name)


def test_with_all_heights_on_the_ground_it_rides_like_the_full_car_whatever_its_tyres():
    f = np.array([0.3, 1.5, 11.0])
    full = ss.frequency_response(ss.FullCar(**models.UNEQUAL), f)
    ours = ss.frequency_response(ss.RideHandlingCar(**models.UNEQUAL, **FLAT), f)
    ours = ours.sel(output=full.output, input=full.input)
    assert (np.abs(ours - full) / np.abs(full).max(["input", "frequency"])).max() < 1e-8


def test_on_alike_tracks_it_is_the_full_car_whatever_its_heights():
    metrics = ss.ride_metrics(CAR, ss.Road())
    for name, data in ss.ride_metrics(ss.FullCar(), ss.Road()).items():
        np.testing.assert_allclose(metrics[name], data, rtol=1e-9, atol=1e-9, err_msg=name)
    for name in ("ay", "yaw_rate", "sideslip", "roll", "load_transfer", "slip_angle"):
        np.testing.assert_allclose(metrics[name], 0.0, atol=1e-9)


def test_without_heights_it_steers_like_the_bicycle_model():
    C, U = ss.Corners.axles(front=40e3, rear=60e3), 25.0
    car = ss.RideHandlingCar(**FLAT, cornering=C, slip=1e-6, mu=ss.Corners.axles(front=40.0, rear=55.0), speed=U)
    a, b, m, mx = car.a, car.b, car.mass, 2 * (40.0 * car.a - 55.0 * car.b)
    M = np.array([[m, mx], [mx, car.izz]])
    damping = [[80e3 + 120e3, a * 80e3 - b * 120e3], [a * 80e3 - b * 120e3, a**2 * 80e3 + b**2 * 120e3]]
    A = np.linalg.solve(M, -np.array(damping) / U - np.array([[0.0, m * U], [0.0, mx * U]]))
    B = np.linalg.solve(M, [[80e3], [a * 80e3]])
    bicycle = ct.ss(A, B, [[1.0 / U, 0.0], [0.0, 1.0]], 0.0)
    f = np.geomspace(0.01, 20.0, 30)
    ours = ss.frequency_response(car, f).sel(output=["sideslip", "yaw_rate"], input="delta_f")
    expected = ct.frequency_response(bicycle, 2 * np.pi * f).frdata[:, 0]
    np.testing.assert_allclose(ours, expected, rtol=1e-7)


def axles(car):
    """What each axle carries, and the cornering stiffness of both its wheels."""
    (fr, fl, rr, rl), C = car.at_wheels("mu"), car.at_wheels("cornering")
    if car.steering is not None:
        C = (*(one / (1.0 + car.trail * one / car.steering) for one in C[:2]), *C[2:])
    L = car.a + car.b
    return car.mb * car.b / L + fr + fl, car.mb * car.a / L + rr + rl, C[0] + C[1], C[2] + C[3]


@given(models.ride_handling_cars)
@settings(max_examples=25)
def test_steady_turns_obey_the_closed_forms(car):
    L, (m_f, m_r, C_f, C_r) = car.a + car.b, axles(car)
    K = oracles.understeer_gradient(m_f, m_r, C_f, C_r)
    assert car.understeer_gradient() == pytest.approx(K, rel=1e-9, abs=1e-12)
    assert car.characteristic_speed() == pytest.approx(np.sqrt(L / K) if K > 0 else np.inf)
    assert car.critical_speed() == pytest.approx(np.sqrt(-L / K) if K < 0 else np.inf)
    assume(car.speed < 0.95 * car.critical_speed() and not car.assemble().refusal())
    turn = car.steady_state(delta_f=0.01)
    expected = oracles.bicycle_gains(L, car.b, m_r, C_r, K, car.speed)
    got = [float(turn[name]) for name in ("yaw_rate", "ay", "sideslip")]
    np.testing.assert_allclose(got, 0.01 * np.array(expected), rtol=1e-8, atol=1e-12)


@given(models.ride_handling_cars)
@settings(max_examples=25)
def test_loads_that_move_are_the_overturning_moment(car):
    assume(not car.assemble().refusal())
    turn = car.steady_state(delta_f=0.02, delta_r=-0.003)
    moved = 2.0 * car.c * (turn.load_transfer_front + turn.load_transfer_rear)
    front, rear = car.roll_centre_front, car.roll_centre_rear
    arm = car.height - (car.b * front + car.a * rear) / (car.a + car.b)
    lean = car.mb * 9.81 * arm * turn["roll"]
    inertia = (car.mb * car.height + sum(car.at_wheels("mu")) * car.radius) * turn.ay
    assert float(moved) == pytest.approx(float(inertia + lean), rel=1e-10)
    ratio = car.rollover_threshold() * float(turn.load_transfer_ratio / turn.ay)
    assert ratio == pytest.approx(1.0, rel=1e-9)
    loads = sum(float(turn[f"dtl_{wheel}"]) for wheel in car.wheels)
    assert abs(loads) < 1e-9 * car.weight


def test_loads_that_move_are_the_overturning_moment_to_twelve_digits():
    turn, m = CAR.steady_state(delta_f=0.02), CAR.mb
    moment = (m * CAR.height + 4 * CAR.mu * CAR.radius) * turn.ay + m * 9.81 * (CAR.height - 0.1) * turn["roll"]
    moved = 2.0 * CAR.c * (turn.load_transfer_front + turn.load_transfer_rear)
    assert float(moved / moment) == pytest.approx(1.0, abs=1e-12)


def test_braking_moves_load_forward_by_the_height_of_the_centre_of_gravity():
    torque = -200.0
    stop = CAR.steady_state(**dict.fromkeys(("drive_fr", "drive_fl", "drive_rr", "drive_rl"), torque))
    moved = float(stop.dtl_fr + stop.dtl_fl)
    assert moved * (CAR.a + CAR.b) == pytest.approx(-CAR.centre * 4 * torque / CAR.radius, rel=1e-9)
    assert abs(float(stop.ay)) < 1e-12


def test_yaw_gain_peaks_at_the_characteristic_speed():
    car = ss.RideHandlingCar(cornering=ss.Corners.axles(front=40e3, rear=55e3))
    peak = car.characteristic_speed()
    speeds = xr.DataArray(peak * np.array([0.98, 1.0, 1.02]), dims="speed")
    gain = car.steady_state(speed=speeds, delta_f=1.0).yaw_rate
    assert int(gain.values.argmax()) == 1
    assert float(gain[1]) == pytest.approx(peak / (2.0 * (car.a + car.b)))


OVERSTEERING = ss.RideHandlingCar(cornering=ss.Corners.axles(front=60e3, rear=35e3))


def test_an_eigenvalue_crosses_zero_at_the_critical_speed():
    critical = OVERSTEERING.critical_speed()
    worst = [OVERSTEERING.moving(critical * (1 + e)).assemble().rates.real.max() for e in (-1e-3, 1e-3)]
    assert worst[0] < 0.0 < worst[1]
    assert np.abs(worst).max() < 0.05


@pytest.mark.parametrize(
    "ask",
    [
        lambda car, speed: ss.ride_metrics(car, ss.Road(speed=speed)),
        lambda car, speed: ss.ride_metrics(car, ss.Road(speed=speed), method="spectral"),
        lambda car, speed: ss.covariance(car, ss.Road(speed=np.array([10.0, speed]))),
        lambda car, speed: car.steady_state(speed=speed, delta_f=0.01),
    ],
)
def test_above_the_critical_speed_it_is_refused_in_words(ask):
    critical = OVERSTEERING.critical_speed()
    ask(OVERSTEERING, 0.99 * critical)
    with pytest.raises(
        ValueError, match=f"unstable at {1.01 * critical:.4g} m/s, above its critical speed of {critical:.4g} m/s"
    ):
        ask(OVERSTEERING, 1.01 * critical)


# Symmetry


@pytest.mark.parametrize("name", ["default", "relaxation"])
def test_symmetric_and_antisymmetric_halves_do_not_couple(name):
    system = CARS[name].state_space(speed=22.0)
    A, labels = system.A, system.state_labels
    mirror, image = np.zeros_like(A), {"fr": "fl", "fl": "fr", "rr": "rl", "rl": "rr"}
    for i, label in enumerate(labels):
        stem, _, wheel = label.rpartition("_")
        other = f"{stem}_{image[wheel]}" if wheel in image else label
        odd = label in ("phi", "dphi", "dy", "dpsi") or label.startswith("lag")
        mirror[labels.index(other), i] = -1.0 if odd else 1.0
    scale = np.abs(A).max(axis=1, keepdims=True)
    assert (np.abs(mirror @ A @ mirror - A) / np.where(scale > 0.0, scale, 1.0)).max() < 1e-10


@given(models.ride_handling_cars)
@settings(max_examples=15)
def test_left_and_right_turns_are_mirror_images(car):
    flipped = {
        name: ss.Corners(fr=v.fl, fl=v.fr, rr=v.rl, rl=v.rr)
        for name in car.per_corner
        if isinstance(v := getattr(car, name), ss.Corners)
    }
    other = dataclasses.replace(car, **flipped)
    f = [0.7, 3.0]
    ours = ss.frequency_response(car, f).sel(output=["ay", "dtl_fr", "slip_angle_rl"], input="delta_f")
    image = ss.frequency_response(other, f).sel(output=["ay", "dtl_fl", "slip_angle_rr"], input="delta_f")
    np.testing.assert_allclose(ours.values, image.values * [[1.0], [-1.0], [1.0]], rtol=1e-7)


# State space and modes


@pytest.mark.parametrize("car", CARS.values(), ids=CARS)
def test_state_space_is_the_frequency_response(car):
    f = np.array([0.2, 1.5, 9.0])
    ours = ss.frequency_response(car, f)
    system = car.state_space("velocity", actuators=True)
    by_rates = ct.frequency_response(system, 2 * np.pi * f).frdata
    by_rates = by_rates[[system.output_labels.index(name) for name in ours.output.values], :10]
    by_rates[:, :4] *= 2j * np.pi * f
    routes = [by_rates]
    if not np.any(car.at_wheels("ct")):
        routes.append(ct.frequency_response(car.state_space(), 2 * np.pi * f).frdata)
    for other in routes:
        error = np.abs(ours.values - other) / np.abs(other).max(axis=(1, 2), keepdims=True)
        assert error.max() < 1e-8


def test_states_are_as_many_as_degrees_of_freedom_say():
    rigid, compliant = CAR.state_space(speed=20.0), ss.RideHandlingCar(steering=1e4).state_space(speed=20.0)
    assert (rigid.nstates, compliant.nstates) == (21, 25)
    assert rigid.input_labels[4:] == list(oracles.CONTROLS)
    assert rigid.output_labels[-4:] == [f"slip_angle_{wheel}" for wheel in CAR.wheels]


def test_actuators_push_as_on_the_full_car():
    full = ss.FullCar().state_space("velocity", actuators=True)
    own = ss.RideHandlingCar(**FLAT).state_space("velocity", actuators=True)
    for output in ("bacc_cg", "roll_acc", "dtl_fr", "sws_rate_rl"):
        ours, theirs = (ct.frequency_response(one[output, "u_fl"], [3.0, 40.0]).frdata for one in (own, full))
        np.testing.assert_allclose(ours, theirs, rtol=1e-9, err_msg=output)


@pytest.mark.parametrize("car", CARS.values(), ids=CARS)
def test_modes_are_the_eigenvalues_with_names(car):
    modes = car.modes(speed=18.0)
    poles = np.linalg.eigvals(car.state_space("velocity", speed=18.0).A)
    # Three states do not die out: the warp, the bank and the speed at which the car coasts. Two equal real eigenvalues
    # may come as a pair.
    poles = poles[np.abs(poles) > 1e-3]
    one_of_each = (poles.imag > 0.0) | (np.abs(poles.imag) < 1e-5 * np.abs(poles))
    expected = np.sort(np.abs(poles[one_of_each])) / (2 * np.pi)
    np.testing.assert_allclose(np.sort(modes.frequency), expected, rtol=1e-6)
    names = modes.name.tolist()
    assert [names.count(name) for name in ("heave", "pitch", "roll", "front hop", "rear hop", "spin")] == [
        1,
        1,
        1,
        2,
        2,
        4,
    ]
    assert any("sway" in name for name in names)
    assert any("yaw" in name for name in names)
    assert names.count("steer") == (2 if car.steering is not None else 0)
    assert modes["shape"][names.index("heave")].abs().idxmax() == "z_b"


def test_undamped_frequencies_without_heights_are_the_full_cars():
    ours, full = ss.RideHandlingCar(**LEVEL), ss.FullCar()
    np.testing.assert_allclose(ours.natural_frequencies(), full.natural_frequencies(), rtol=1e-9)
    swept = ss.RideHandlingCar(**LEVEL, ks=np.array([18e3, 21e3])).natural_frequencies()
    np.testing.assert_allclose(swept[1], ss.FullCar(ks=21e3).natural_frequencies(), rtol=1e-9)


# Refusals


@pytest.mark.parametrize(
    ("make", "kind", "said"),
    [
        (lambda: ss.RideHandlingCar(height=-0.1), ValueError, r"height=...\) must be >= 0 m, got -0.1"),
        (lambda: ss.RideHandlingCar(radius=0.0), ValueError, r"radius=...\) must be > 0 m"),
        (lambda: ss.RideHandlingCar(ixz=np.nan), ValueError, r"ixz=...\) must be finite, in kg m\^2, got nan"),
        (lambda: ss.RideHandlingCar(steering=0.0), ValueError, r"steering=...\) must be > 0 N m/rad"),
        (lambda: ss.RideHandlingCar(mb=None), TypeError, r"mb=...\) must be > 0 kg, got None"),
        (lambda: CAR.state_space(speed=-1.0), ValueError, r"speed=...\) must be > 0 m/s, got -1.0"),
        (lambda: CAR.state_space(speed=np.array([1.0, 2.0])), ValueError, "one number for every parameter"),
        (lambda: ss.ride_metrics(ss.RideHandlingCar(izz=300.0), ss.Road()), ValueError, r"izz=...\) must exceed"),
        (
            lambda: CAR.steady_state(delta=0.1),
            ValueError,
            "no input named 'delta', available: delta_f, delta_r, drive_fr",
        ),
        (lambda: CAR.steady_state(delta_f="left"), TypeError, "delta_f must be a number"),
        (
            lambda: ss.ride_metrics(CAR, ss.Road(tracks="independent")),
            ValueError,
            "tracks that part without bound tilt the car",
        ),
        (
            lambda: ss.ride_metrics(ss.RideHandlingCar(cornering=0.0), ss.Road()),
            ValueError,
            "hold it on course",
        ),
        (
            lambda: ss.ride_metrics(ss.RideHandlingCar(ks=2e3, height=1.5), ss.Road()),
            ValueError,
            "springs that hold the body up",
        ),
        (lambda: ss.RideHandlingCar(height=5.0).rollover_threshold(), ValueError, "do not hold the body up"),
        (lambda: ss.RideHandlingCar(ks=2e3, height=1.5).roll_gradient(), ValueError, "do not hold the body up"),
        (lambda: ss.sensitivity(CAR, ss.Road()), TypeError, "sensitivity needs"),
        (lambda: ss.simulate(CAR, np.zeros(5), np.arange(5.0), [1.0]), TypeError, "inputs must be a mapping"),
        (
            lambda: ss.simulate(
                ss.RideHandlingCar(**LEVEL, cornering=0.0), np.zeros(5), np.arange(5.0), {"delta_f": np.zeros(5)}
            ),
            ValueError,
            "without cornering stiffness",
        ),
        (
            lambda: ss.simulate(CAR, np.zeros(5), np.arange(5.0), {"delta": np.zeros(5)}),
            ValueError,
            "no input named 'delta', available: delta_f",
        ),
        (
            lambda: ss.simulate(ss.FullCar(), np.zeros(5), np.arange(5.0), {"delta_f": np.zeros(5)}),
            ValueError,
            "FullCar has no input named 'delta_f', available: none",
        ),
        (
            lambda: ss.simulate(CAR, np.zeros(5), np.arange(5.0), {"delta_f": np.zeros(4)}),
            ValueError,
            "must be 5 finite numbers",
        ),
    ],
)
def test_wrong_input_is_refused_in_one_line(make, kind, said):
    with pytest.raises(kind, match=said) as refusal:
        make()
    assert "\n" not in str(refusal.value)
