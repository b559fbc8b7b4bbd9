"""Any linear vehicle: state spaces of other making against the package's own models, each other and dense integrals."""

import dataclasses

import control as ct
import numpy as np
import pytest
import scipy.linalg
import xarray as xr
from hypothesis import given, settings
from hypothesis import strategies as st

import susp_ss as ss
from models import ROADS, UNEQUAL, VEHICLES, WHEEL_ROADS
from susp_ss.vehicles.linkage import Link

FORMS = ("displacement", "velocity")


def system_of(vehicle, form, actuators=False):
    """A vehicle's own state space; none where it has none from the height of the road."""
    try:
        return vehicle.state_space(form, actuators)
    except ValueError:
        pytest.skip("no state space from the displacement of the road")


def assert_alike(ours, other, rtol, atol=1e-9):
    for name in ours:
        data = other[name]
        assert (ours[name].dims, ours[name].attrs["units"]) == (data.dims, data.attrs["units"]), name
        for dim in data.dims:
            np.testing.assert_array_equal(ours[name][dim], data[dim])
        np.testing.assert_allclose(ours[name], data, rtol=rtol, atol=atol, err_msg=str(name))


@pytest.mark.parametrize("form", FORMS)
@pytest.mark.parametrize("name", VEHICLES)
def test_a_vehicle_is_its_own_state_space_on_every_road(name, form):
    vehicle = VEHICLES[name]
    linear = ss.LinearVehicle(system_of(vehicle, form, actuators=True), like=vehicle)
    assert vehicle.layout().variables.keys() - linear.layout().variables.keys() <= {"tyre_deflection"}
    roads = ROADS | (WHEEL_ROADS if isinstance(vehicle, ss.FullCar) else {})
    for road in roads.values():
        assert_alike(ss.ride_metrics(linear, road), ss.ride_metrics(vehicle, road), 1e-10, 1e-7)


@pytest.mark.parametrize("form", FORMS)
@pytest.mark.parametrize("name", ["quarter", "pitch half", "roll half, unequal sides, bar", "full, unequal corners"])
def test_a_vehicle_is_its_own_state_space_by_every_route(name, form):
    vehicle = VEHICLES[name]
    linear = ss.LinearVehicle(system_of(vehicle, form, actuators=True), like=vehicle)
    for road in (ss.Road(tracks="independent", waviness=2.4), ss.Road(tracks="isotropic", cutoff=0.01)):
        assert_alike(*(ss.ride_metrics(car, road, method="spectral") for car in (linear, vehicle)), 1e-6)
        record = {"method": "time", "duration": 20.0, "seed": 3}
        assert_alike(*(ss.ride_metrics(car, road, **record) for car in (linear, vehicle)), 1e-6)


@pytest.mark.parametrize("form", FORMS)
@pytest.mark.parametrize("name", VEHICLES)
def test_frequency_and_time_responses(name, form):
    vehicle = VEHICLES[name]
    linear = ss.LinearVehicle(system_of(vehicle, form), like=vehicle)
    frequency, time = np.geomspace(0.02, 60.0, 30), np.arange(0.0, 2.0, 0.004)
    own, other = (ss.frequency_response(car, frequency) for car in (vehicle, linear))
    assert own.output.equals(other.output)
    assert own.input.equals(other.input)
    scale = np.abs(own).max("frequency").values[..., None]
    np.testing.assert_allclose(other.values / scale, own.values / scale, rtol=0.0, atol=1e-9)
    road = ss.Road(tracks="isotropic")
    own, other = (ss.psd(car, road, frequency) for car in (vehicle, linear))
    np.testing.assert_allclose(other, own, rtol=1e-7, atol=1e-12 * float(own.max()))
    kerb = np.where(time > 0.3, 0.04, 0.0) * np.linspace(0.5, 1.0, len(vehicle.wheels))[:, None]
    own, other = (ss.simulate(car, kerb, time) for car in (vehicle, linear))
    for variable in other:
        np.testing.assert_allclose(
            other[variable], own[variable], rtol=1e-7, atol=1e-8 * float(abs(own[variable]).max())
        )


@pytest.mark.parametrize("name", VEHICLES)
def test_covariance_of_the_states_by_their_names(name):
    vehicle = VEHICLES[name]
    linear = ss.LinearVehicle(vehicle.state_space("velocity"), like=vehicle)
    own, other = (ss.covariance(car, ss.Road(tracks="independent", speed=12.0)) for car in (vehicle, linear))
    sizes = np.sqrt(np.diag(own.values))
    np.testing.assert_array_equal(own.state, other.state)
    np.testing.assert_allclose(other.values / np.outer(sizes, sizes), own.values / np.outer(sizes, sizes), atol=1e-10)


# Closed loops


class SkyhookCar(ss.FullCar):
    """A full car whose body hangs on a damper from the sky over each wheel."""

    def linkage(self):
        own = super().linkage()
        sky = [Link(corner.mount, 0.0, 900.0) for corner in own.corners.values()]
        return dataclasses.replace(own, links=sky)


def with_states(plant, *names):
    """A plant that also gives out some of its states."""
    rows = np.eye(plant.nstates)[[plant.state_labels.index(name) for name in names]]
    return ct.ss(
        plant.A,
        plant.B,
        np.vstack([plant.C, rows]),
        np.vstack([plant.D, np.zeros((len(names), plant.ninputs))]),
        inputs=plant.input_labels,
        outputs=[*plant.output_labels, *names],
        states=plant.state_labels,
    )


@pytest.mark.parametrize("road", ROADS.values(), ids=ROADS.keys())
@pytest.mark.parametrize("corners", [{}, UNEQUAL], ids=["alike", "unequal"])
def test_a_skyhook_by_feedback_is_one_by_links(corners, road):
    car = ss.FullCar(**corners, arb_front=12e3)
    plant = with_states(car.state_space("velocity"), "dz_b", "dtheta", "dphi")
    over = np.array([[1.0, x, y] for x in (-car.a, car.b) for y in (-car.c, car.c)])
    # Forces of the sky on the body over each wheel, which wheels do not feel.
    rates = [plant.state_labels.index(name) for name in ("dz_b", "dtheta", "dphi")]
    accelerations = over.T / np.array([[car.mb], [car.iyy], [car.ixx]])
    push, passed = np.zeros((plant.nstates, 4)), np.zeros((plant.noutputs, 4))
    push[rates], passed[:3], passed[3:7] = accelerations, accelerations, over @ accelerations
    forces = ["f_fr", "f_fl", "f_rr", "f_rl"]
    plant = ct.ss(
        plant.A,
        np.hstack([plant.B, push]),
        plant.C,
        np.hstack([plant.D, passed]),
        inputs=[*plant.input_labels, *forces],
        outputs=plant.output_labels,
    )
    law = ct.ss([], [], [], -900.0 * over, inputs=["dz_b", "dtheta", "dphi"], outputs=forces)
    closed = ct.interconnect([plant, law], inputs=plant.input_labels[:4], outputs=plant.output_labels[:-3])
    active, passive = ss.LinearVehicle(closed, like=car), SkyhookCar(**corners, arb_front=12e3)
    expected = ss.ride_metrics(passive, road)
    assert_alike(ss.ride_metrics(active, road), expected, 1e-9, 1e-7)


def test_a_loop_that_lost_its_names_is_known_by_its_feedthrough():
    for vehicle in VEHICLES.values():
        plant = vehicle.state_space("velocity", actuators=True)
        corners = len(vehicle.wheels)
        gain = np.zeros((plant.ninputs, plant.noutputs))
        gain[-corners:, -corners:] = -200.0 * np.eye(corners)
        closed = ct.feedback(plant, ct.ss([], [], [], gain))
        assert closed.input_labels[0] == "u[0]"
        harder = vehicle.replaced(
            **{
                f"cs_{wheel}" if wheel else "cs": cs + 200.0
                for wheel, cs in zip(vehicle.wheels, vehicle.at_wheels("cs"), strict=True)
            }
        )
        road = ss.Road(tracks="isotropic")
        ours, expected = ss.ride_metrics(ss.LinearVehicle(closed, like=vehicle), road), ss.ride_metrics(harder, road)
        # What the actuators dissipate is not the dampers'.
        assert_alike(ours.drop_vars("damper_power"), expected, 1e-9, 1e-7)
    car = ss.QuarterCar()
    gain = np.array([[0.0] * 4, [0.0] * 3 + [-200.0]])
    closed = ct.feedback(car.state_space("displacement", actuators=True), ct.ss([], [], [], gain))
    harder = ss.ride_metrics(ss.QuarterCar(cs=car.cs + 200.0), ss.Road())
    assert_alike(ss.ride_metrics(ss.LinearVehicle(closed, like=car), ss.Road())[["sws"]], harder[["sws"]], 1e-9)
    with pytest.raises(ValueError, match="has no names"):
        ss.LinearVehicle(ct.feedback(ct.ss(closed)[:2, :], ct.ss([], [], [], np.zeros((2, 2)))), like=car)


@pytest.mark.parametrize("form", FORMS)
def test_an_anti_roll_bar_by_position_feedback_is_one_by_links(form):
    car, bar = ss.FullCar(**UNEQUAL), 9e3
    plant = car.state_space(form, actuators=True)
    law = ct.ss(
        [], [], [], bar * np.array([[1.0, -1.0], [-1.0, 1.0]]), inputs=["sws_fr", "sws_fl"], outputs=["u_fr", "u_fl"]
    )
    closed = ct.interconnect([plant, law], inputs=plant.input_labels[:4], outputs=plant.output_labels)
    for road in ROADS.values():
        ours = ss.ride_metrics(ss.LinearVehicle(closed, like=car), road)
        # The tyre loads and accelerations of the bar itself are in it, as the actuators' are.
        assert_alike(ours, ss.ride_metrics(ss.FullCar(**UNEQUAL, arb_front=bar), road), 1e-9, 1e-7)


@pytest.mark.parametrize("form", FORMS)
@pytest.mark.parametrize("tracks", ["identical", "independent"])
def test_position_feedback_agrees_by_three_routes(tracks, form):
    # The rear left corner pushes the front right one: nothing is symmetric, and the static warp moves.
    car = ss.FullCar(**UNEQUAL)
    plant = car.state_space(form, actuators=True)
    law = ct.ss([], [], [], [[4e3]], inputs=["sws_rl"], outputs=["u_fr"])
    lag = ct.ss([[-60.0]], [[60.0]], [[-300.0]], [[0.0]], inputs=["sws_rate_rr"], outputs=["u_rr"])
    closed = ct.interconnect([plant, law, lag], inputs=plant.input_labels[:4], outputs=plant.output_labels)
    active, road = ss.LinearVehicle(closed, like=car), ss.Road(tracks=tracks, speed=15.0)
    exact = ss.ride_metrics(active, road)
    assert_alike(ss.ride_metrics(active, road, method="spectral"), exact, 1e-6)
    record = ss.ride_metrics(active, road, method="time", duration=300.0, seed=1)
    for name in exact:
        error = np.maximum(record[f"{name}_stderr"], 1e-9)
        assert float((abs(record[name] - exact[name]) / error).max()) < 5.0, name


def test_what_feels_the_height_of_the_road_is_refused_by_name_or_bounded_by_a_cut_off():
    # A spring to the sky, by feedback: the body no longer rides along.
    car = ss.QuarterCar()
    plant = with_states(car.state_space("displacement", actuators=True), "z_s")
    law = ct.ss([], [], [], [[-2e3]], inputs=["z_s"], outputs=["u"])
    closed = ct.interconnect([plant, law], inputs=["z_r"], outputs=["bacc", "sws", "dtl"])
    vehicle = ss.LinearVehicle(closed, like=car)
    for method in ("covariance", "spectral", "time"):
        with pytest.raises(ValueError, match=r"^sws feels the height of the road"):
            ss.ride_metrics(vehicle, ss.Road(), method=method)
    road = ss.Road(cutoff=0.02)
    exact = ss.ride_metrics(vehicle, road)
    assert_alike(ss.ride_metrics(vehicle, road, method="spectral"), exact, 1e-6)
    static = ss.frequency_response(vehicle, [1e-4]).sel(output="sws", input="z_r").item()
    np.testing.assert_allclose(static, 2e3 / (2e3 + car.ks) * (1.0 + 0.0j), rtol=0.15, atol=1e-3)


@pytest.mark.parametrize("name", ["full", "full, unequal corners, bars, tyre damping"])
def test_what_no_output_sees_is_left_out(name):
    # A position that drifts, the integrator of a disturbance, and a chain of two, mixed into all other states.
    car = VEHICLES[name]
    plant = car.state_space("velocity")
    n, rng = plant.nstates, np.random.default_rng(5)
    A = np.zeros((n + 4, n + 4))
    A[:n, :n] = plant.A
    A[n, :n], A[n + 1, n] = rng.standard_normal(n), 3.0  # a chain driven by the car
    A[n + 2, n + 3] = 1.0
    B = np.vstack([plant.B, rng.standard_normal((4, 4))])
    C = np.hstack([plant.C, np.zeros((plant.noutputs, 4))])
    Q, _ = np.linalg.qr(rng.standard_normal((n + 4, n + 4)))
    mixed = ct.ss(Q @ A @ Q.T, Q @ B, C @ Q.T, plant.D, inputs=plant.input_labels, outputs=plant.output_labels)
    plain = ct.ss(A, B, C, plant.D, inputs=plant.input_labels, outputs=plant.output_labels)
    for road in (ROADS["isotropic"], ROADS["independent"], ROADS["identical, cut-off"]):
        expected = ss.ride_metrics(car, road)
        assert_alike(ss.ride_metrics(ss.LinearVehicle(plain, like=car), road), expected, 1e-10, 1e-7)
        assert_alike(ss.ride_metrics(ss.LinearVehicle(mixed, like=car), road), expected, 1e-8, 1e-6)
    kept = ss.covariance(ss.LinearVehicle(plain, like=car), ss.Road()).state.values.tolist()
    assert kept == [f"x[{i}]" for i in range(n)]


@pytest.mark.parametrize("gain", [1.0, 10.0, 1e3, 1e6, 1e9])
def test_what_cancels_among_large_states_is_never_taken_for_zero(gain):
    car = ss.PitchHalfCar()
    plant, rng = car.state_space("velocity"), np.random.default_rng(2)
    n, unseen = plant.nstates, 3
    A = scipy.linalg.block_diag(plant.A, np.diag([-0.2, -1.0, -9.0]))
    B = np.vstack([plant.B, gain * rng.standard_normal((unseen, 2))])
    C = np.hstack([plant.C, np.zeros((plant.noutputs, unseen))])
    Q, _ = np.linalg.qr(rng.standard_normal((n + unseen, n + unseen)))
    mixed = ct.ss(Q @ A @ Q.T, Q @ B, C @ Q.T, plant.D, inputs=plant.input_labels, outputs=plant.output_labels)
    linear = ss.LinearVehicle(mixed, like=car)
    if gain > 100.0:
        with pytest.raises(ValueError, match="six digits"):
            ss.ride_metrics(linear, ss.Road())
    else:
        assert_alike(ss.ride_metrics(linear, ss.Road()), ss.ride_metrics(car, ss.Road()), 1e-6)


# Other vehicles


def wheeled(A, B, C, D, outputs, rate=True):
    stem = "dz_r" if rate else "z_r"
    return ct.ss(A, B, C, D, inputs=[f"{stem}_{wheel}" for wheel in ("fr", "fl", "rr", "rl")], outputs=outputs)


def transfer(system, s):
    """C (s I - A)^-1 B + D, (len(s), outputs, inputs), as python-control solves it one s at a time."""
    return system.C @ np.linalg.solve(s[:, None, None] * np.eye(system.nstates) - system.A, system.B) + system.D


def variances_by_integration(vehicle, system, road):
    """Variance of every output of a system driven by the velocity of the road: a dense integral over frequency."""
    u = np.linspace(np.log(1e-7), np.log(1e7), 60001)
    f = np.exp(u)
    s = 2j * np.pi * f
    H = np.concatenate([transfer(system, part) for part in np.array_split(s, 60)]).transpose(1, 2, 0)
    G = (2 * np.pi * f) ** 2 * road.psd(f / road.speed) / road.speed
    late = np.exp(-s * vehicle.wheelbase / road.speed)
    sees = {"fr": (1, 0), "fl": (0, 1), "rr": (late, 0), "rl": (0, late)}
    right, left = (sum(H[:, i] * sees[wheel][side] for i, wheel in enumerate(vehicle.wheels)) for side in (0, 1))
    gamma = {"identical": 1.0, "independent": 0.0}[road.tracks]
    S = np.abs(right) ** 2 + np.abs(left) ** 2 + 2.0 * gamma * (right * left.conj()).real
    return np.trapezoid(S * G * f, u, axis=-1)


def random_system(seed, n):
    rng = np.random.default_rng(seed)
    A = 20.0 * rng.standard_normal((n, n))
    A -= (np.linalg.eigvals(A).real.max() + rng.uniform(1.0, 20.0)) * np.eye(n)
    return wheeled(
        A, rng.standard_normal((n, 4)), rng.standard_normal((3, n)), np.zeros((3, 4)), ["one", "two", "three"]
    )


@given(
    seed=st.integers(0, 10**6),
    n=st.integers(1, 12),
    tracks=st.sampled_from(["identical", "independent"]),
    cutoff=st.sampled_from([0.0, 0.05]),
    speed=st.floats(5.0, 40.0),
)
@settings(max_examples=8)
def test_random_stable_systems_against_a_dense_integral(seed, n, tracks, cutoff, speed):
    system = random_system(seed, n)
    vehicle, road = ss.LinearVehicle(system, wheelbase=2.7), ss.Road(tracks=tracks, cutoff=cutoff, speed=speed)
    expected = np.sqrt(variances_by_integration(vehicle, system, road))
    ours = ss.ride_metrics(vehicle, road)
    np.testing.assert_allclose([float(ours[name]) for name in ("one", "two", "three")], expected, rtol=2e-4)
    spectral = ss.ride_metrics(vehicle, road, method="spectral")
    for name in ours:
        np.testing.assert_allclose(ours[name], spectral[name], rtol=2e-5)


@given(seed=st.integers(0, 10**6), n=st.integers(1, 30), speed=st.floats(5.0, 40.0))
@settings(max_examples=25)
def test_random_stable_systems_against_scipy(seed, n, speed):
    system, road = random_system(seed, n), ss.Road(tracks="independent", speed=speed)
    vehicle, Q = ss.LinearVehicle(system, wheelbase=2.7), np.zeros((n, n))
    carried = scipy.linalg.expm(system.A * vehicle.wheelbase / speed)
    for front, rear in ((0, 2), (1, 3)):
        late = carried @ system.B[:, front]
        for one, other in ((system.B[:, front],) * 2, (system.B[:, rear],) * 2, (late, system.B[:, rear])):
            Q += np.outer(one, other) + (0.0 if one is other else np.outer(other, one))
    X = scipy.linalg.solve_continuous_lyapunov(system.A, -road.intensity * Q)
    sizes = np.sqrt(np.diag(X))
    ours = ss.covariance(vehicle, road).values
    np.testing.assert_allclose(ours / np.outer(sizes, sizes), X / np.outer(sizes, sizes), atol=1e-8)
    expected = np.sqrt(np.diag(system.C @ X @ system.C.T))
    metrics = ss.ride_metrics(vehicle, road)
    np.testing.assert_allclose([metrics[name] for name in system.output_labels], expected, rtol=1e-8)


@pytest.mark.parametrize("tracks", ["identical", "independent", "isotropic"])
def test_modes_on_one_another_have_no_eigenvectors_to_go_by(tracks):
    # Chains of equal lags: defective, so that Schur's form answers.
    n = 6
    A = -12.0 * np.eye(n) + 12.0 * np.eye(n, k=-1)
    B = np.zeros((n, 4))
    B[0], B[2] = [1.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 1.0]
    vehicle = ss.LinearVehicle(
        wheeled(A, B, np.eye(n)[[2, 5]], np.zeros((2, 4)), ["early", "late"]), wheelbase=2.5, track_width=1.5
    )
    for road in (ss.Road(tracks=tracks), ss.Road(tracks=tracks, cutoff=0.03)):
        exact, spectral = (ss.ride_metrics(vehicle, road, method=method) for method in ("covariance", "spectral"))
        for name in exact:
            np.testing.assert_allclose(exact[name], spectral[name], rtol=1e-3 if tracks == "isotropic" else 1e-6)


def test_feedthrough_of_white_velocity_makes_just_that_output_infinite():
    system = random_system(1, 5)
    D = np.zeros((3, 4))
    D[1, 2] = 0.5
    passing = wheeled(system.A, system.B, system.C, D, ["one", "two", "three"])
    metrics = ss.ride_metrics(ss.LinearVehicle(passing), ss.Road(delay=False))
    assert [bool(np.isinf(metrics[name])) for name in ("one", "two", "three")] == [False, True, False]
    steep = ss.ride_metrics(ss.LinearVehicle(passing), ss.Road(delay=False, waviness=3.4), method="spectral")
    assert np.isfinite(steep.two)


@pytest.mark.parametrize("tracks", ["identical", "isotropic"])
def test_many_systems_are_designs(tracks):
    systems = [random_system(seed, 7) for seed in range(5)]
    car = ss.FullCar()
    # One with an integrator among them that the others have not.
    A = np.zeros((7, 7))
    A[:6, :6] = random_system(9, 6).A
    B = np.vstack([random_system(9, 6).B, [1.0, -1.0, -1.0, 1.0]])
    systems.append(wheeled(A, B, systems[0].C, np.zeros((3, 4)), systems[0].output_labels))
    one = {"wheels": car.wheels, "wheelbase": car.wheelbase, "track_width": car.track_width}
    many, road = ss.LinearVehicle(systems, **one), ss.Road(tracks=tracks)
    together = ss.ride_metrics(many, road)
    assert together.one.dims == ("design",)
    for i, system in enumerate(systems):
        alone = ss.ride_metrics(ss.LinearVehicle(system, **one), road)
        for name in alone:
            np.testing.assert_allclose(together[name][i], alone[name], rtol=1e-10)
    response = ss.frequency_response(many, [1.0, 2.0])
    np.testing.assert_allclose(
        response[2], ss.frequency_response(ss.LinearVehicle(systems[2], **one), [1.0, 2.0]), rtol=1e-12
    )


@pytest.mark.parametrize("form", FORMS)
@pytest.mark.parametrize(
    "name", ["quarter, tyre damping", "pitch half, unequal ends", "full, unequal corners, bars, tyre damping"]
)
def test_roads_of_any_spectrum(name, form):
    vehicle = VEHICLES[name]
    linear = ss.LinearVehicle(system_of(vehicle, form, actuators=True), like=vehicle)
    for road in (
        ss.Road(waviness=1.6, tracks="isotropic"),
        ss.Road(waviness=2.6, tracks="independent", speed=13.0),
        ss.Road(waviness=3.3, tracks="isotropic", cutoff=0.01),
        ss.Road(contact_length=0.1, tracks="independent"),
        ss.Road(contact_length=0.1, cutoff=0.02, delay=False),
    ):
        assert_alike(ss.ride_metrics(linear, road), ss.ride_metrics(vehicle, road), 1e-8, 1e-7)


@pytest.mark.parametrize("name", ["quarter, tyre damping", "full, unequal corners, bars, tyre damping"])
def test_weighted_outputs(name):
    # Weightings have poles of their own, complex ones too, and make even a tyre load with tyre damping finite.
    vehicle = VEHICLES[name]
    linear = ss.LinearVehicle(vehicle.state_space("velocity", actuators=True), like=vehicle)
    weighting = {"bacc": "Wk", "dtl": ct.tf([1.0], [0.02, 1.0]), "sws": "Wd"}
    for road in (ss.Road(tracks="isotropic"), ss.Road(tracks="independent", speed=12.0, cutoff=0.01)):
        ours, theirs = (ss.ride_metrics(car, road, weighting=weighting) for car in (linear, vehicle))
        assert_alike(ours, theirs, 1e-8, 1e-7)
        assert np.isfinite(ours.dtl).all()
    road = ss.Road(tracks="independent")
    exact, spectral = (ss.ride_metrics(linear, road, m, weighting=weighting) for m in ("covariance", "spectral"))
    assert_alike(exact, spectral, 1e-6, 1e-7)


def test_roads_that_are_arrays():
    car = ss.FullCar(**UNEQUAL)
    linear = ss.LinearVehicle(car.state_space("velocity", actuators=True), like=car)
    speeds = xr.DataArray([8.0, 20.0, 45.0], dims="speed", coords={"speed": [8.0, 20.0, 45.0]})
    road = ss.Road(speed=speeds, tracks="isotropic", cutoff=0.01)
    assert_alike(ss.ride_metrics(linear, road), ss.ride_metrics(car, road), 1e-9, 1e-7)
    two = ss.LinearVehicle([car.state_space("velocity"), ss.FullCar(cs=900.0).state_space("velocity")], like=car)
    together = ss.ride_metrics(two, road)
    assert together.bacc.dims == ("design", "speed", "point")
    alone = ss.ride_metrics(ss.FullCar(cs=900.0), ss.Road(speed=45.0, tracks="isotropic", cutoff=0.01))
    np.testing.assert_allclose(together.sws[1, 2], alone.sws, rtol=1e-9)
    np.testing.assert_allclose(together.sws[0], ss.ride_metrics(linear, road).sws, rtol=1e-9)
    pytest.importorskip("dask")
    lazy = ss.Road(speed=speeds.chunk(speed=2), tracks="isotropic", cutoff=0.01)
    assert_alike(ss.ride_metrics(two, lazy).compute(), together, 1e-12)
    # Equal lags are no modes to go by: one by one on every road.
    chain = ct.ss([[-9.0, 0.0], [9.0, -9.0]], [[1.0], [0.0]], [[0.0, 1.0]], [[0.0]], inputs="dz_r", outputs="lagged")
    chain, roads = ss.LinearVehicle(chain), ss.Road(speed=speeds, cutoff=0.01)
    each = [ss.ride_metrics(chain, ss.Road(speed=v, cutoff=0.01)).lagged for v in speeds.values]
    np.testing.assert_allclose(ss.ride_metrics(chain, roads).lagged, each, rtol=1e-12)


def test_a_metric_as_a_function_of_the_road():
    car = ss.FullCar()
    linear = ss.LinearVehicle(car.state_space("velocity"), like=car)
    roads = {"road": ss.Road(tracks="isotropic"), "criterion": "sws", "at": "rl", "inputs": ("speed", "roughness")}
    X = np.array([[10.0, 64e-6], [20.0, 32e-6], [30.0, 64e-6]])
    np.testing.assert_allclose(ss.Response(linear, **roads)(X), ss.Response(car, **roads)(X), rtol=1e-10)
    with pytest.raises(ValueError, match="no parameter named 'ks', available: roughness, speed, cutoff"):
        ss.Response(linear, ss.Road(), "sws", at="fr")
    surrogate = ss.ResponseBased(ss.Response(car, **roads)).fit(X, ss.Response(linear, **roads)(X))
    np.testing.assert_allclose(surrogate.predict(X), ss.Response(linear, **roads)(X), rtol=1e-6)
