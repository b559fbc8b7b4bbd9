"""A car that steers, on roads: all routes agree, sweeps are single cars side by side, histories are exact."""

import control as ct
import dask.array
import numpy as np
import pytest
import xarray as xr

import models
import oracles
import susp_ss as ss

CAR = ss.RideHandlingCar(cornering=ss.Corners.axles(front=45e3, rear=55e3), arb_front=8e3)
STEERED = ss.RideHandlingCar(
    **models.UNEQUAL,
    cornering=ss.Corners(fr=40e3, fl=42e3, rr=50e3, rl=55e3),
    relaxation=ss.Corners.axles(front=0.4, rear=0.0),
    steering=12e3,
)
CASES = {
    "identical": (CAR, ss.Road()),
    "isotropic": (STEERED, ss.Road(tracks="isotropic", speed=30.0)),
    "isotropic, other waviness, no delay": (CAR, ss.Road(tracks="isotropic", waviness=1.8, delay=False)),
    "isotropic, no delay, cut-off": (STEERED, ss.Road(tracks="isotropic", delay=False, cutoff=0.01)),
    "independent, cut-off, contact": (CAR, ss.Road(tracks="independent", cutoff=0.02, contact_length=0.1)),
    "one wheel, cut-off": (STEERED, ss.Road(wheels=("rl",), cutoff=0.02, speed=13.0)),
}


@pytest.mark.parametrize(("car", "road"), CASES.values(), ids=CASES)
def test_covariance_and_spectral_routes_agree(car, road):
    exact, integral = (ss.ride_metrics(car, road, method=method) for method in ("covariance", "spectral"))
    fitted = road.tracks == "isotropic" and road.waviness == 2.0
    for name, data in integral.items():
        # How far apart two tracks drift at the longest waves, the rational fit of their coherence tells least well.
        rtol = (1e-2 if name == "roll" else 1e-3) if fitted else 1e-5
        np.testing.assert_allclose(exact[name], data, rtol=rtol, atol=1e-8 * float(abs(data).max()) + 1e-9)


def test_spectra_are_the_oracles_on_isotropic_tracks():
    """Variances of what steering feels, by an integral over the equations written out by hand."""
    road, f = ss.Road(tracks="isotropic", cutoff=0.01, speed=25.0), np.geomspace(0.05, 40.0, 12)
    H, outputs, _ = oracles.ride_handling_response(models.handling_parameters(CAR.moving(25.0)), f)
    assert outputs
    n, tau = f / 25.0, (CAR.a + CAR.b) / 25.0
    track = 64e-6 * (n / 0.1) ** -2 * n**2 / (n**2 + 0.01**2) / 25.0
    gamma = oracles.coherence_isotropic(n, 2 * CAR.c)
    late = np.exp(-2j * np.pi * f * tau)
    right, left = (H[:, i] + H[:, i + 2] * late for i in (0, 1))
    expected = (np.abs(right) ** 2 + np.abs(left) ** 2 + 2 * gamma * (right * left.conj()).real) * track
    ours = ss.psd(CAR, road, f)
    assert ours.output.values.tolist() == outputs
    scale = expected.max(axis=1, keepdims=True)
    assert (np.abs(ours.values - expected) / scale).max() < 1e-7


def test_a_record_of_road_agrees_within_its_error():
    road = ss.Road(tracks="isotropic", cutoff=0.02)
    exact = ss.ride_metrics(CAR, road)
    record = ss.ride_metrics(CAR, road, method="time", duration=120.0, step=0.004, seed=3)
    for name in ("bacc", "ay", "yaw_rate", "roll", "load_transfer", "slip_angle"):
        assert (abs(record[name] - exact[name]) < 4.0 * record[f"{name}_stderr"] + 2e-3 * exact[name]).all(), name


def test_a_sweep_is_single_cars_side_by_side():
    speed = xr.DataArray([10.0, 30.0], dims="speed")
    relaxation = xr.DataArray([0.0, 0.3], dims="relaxation")
    steering, rear = xr.DataArray([8e3, 2e4], dims="steering"), xr.DataArray([0.0, 0.25], dims="roll_centre_rear")
    car = ss.RideHandlingCar(relaxation=relaxation, steering=steering, roll_centre_rear=rear)
    road = ss.Road(tracks="isotropic", speed=speed)
    swept = ss.ride_metrics(car, road)
    assert set(swept.ay.dims) == {"speed", "relaxation", "steering", "roll_centre_rear"}
    for at in ((0, 0, 0, 0), (1, 0, 1, 1), (0, 1, 1, 0), (1, 1, 0, 1)):
        where = dict(zip(("speed", "relaxation", "steering", "roll_centre_rear"), at, strict=True))
        single = ss.RideHandlingCar(
            **{name: float(x[where[name]]) for name, x in (("relaxation", relaxation), ("steering", steering))},
            roll_centre_rear=float(rear[at[3]]),
        )
        one = ss.ride_metrics(single, ss.Road(tracks="isotropic", speed=float(speed[at[0]])))
        for name, data in one.items():
            np.testing.assert_allclose(swept[name].isel(where), data, rtol=1e-8, err_msg=name)


def test_a_lazy_sweep_is_the_same():
    values = np.array([35e3, 45e3, 60e3])
    lazy = xr.DataArray(dask.array.from_array(values, chunks=2), dims="cornering")
    road = ss.Road(tracks="isotropic", speed=xr.DataArray([15.0, 25.0], dims="speed"))
    at_once = ss.ride_metrics(ss.RideHandlingCar(cornering=xr.DataArray(values, dims="cornering")), road)
    xr.testing.assert_allclose(ss.ride_metrics(ss.RideHandlingCar(cornering=lazy), road).compute(), at_once)


def test_its_state_space_is_the_same_vehicle():
    """Left to find out for itself what dies out, what integrates, and what no output sees: a car that coasts faster."""
    road = ss.Road(tracks="isotropic", cutoff=0.005)
    for car in (CAR, STEERED):
        again = ss.LinearVehicle(car.state_space(), like=car)
        expected = ss.ride_metrics(car, road)
        for name, data in ss.ride_metrics(again, road).items():
            np.testing.assert_allclose(data, expected[name], rtol=1e-6, err_msg=name)


def test_the_roads_speed_is_the_cars():
    road = ss.Road(tracks="isotropic", speed=33.0)
    for ask in (ss.ride_metrics, ss.covariance, lambda car, road: ss.psd(car, road, [1.0, 5.0])):
        one, other = ask(ss.RideHandlingCar(), road), ask(ss.RideHandlingCar(speed=33.0), road)
        xr.testing.assert_equal(one, other)
    assert ss.RideHandlingCar().speed == 20.0


def test_covariance_is_of_the_named_states():
    X = ss.covariance(CAR, ss.Road(tracks="isotropic"))
    metrics = ss.ride_metrics(CAR, ss.Road(tracks="isotropic"))
    assert np.sqrt(X.sel(state="dpsi", state_="dpsi")) == pytest.approx(float(metrics.yaw_rate))
    angle = X.sel(state=["p_phi", "bank"], state_=["p_phi", "bank"]).values.sum()
    assert np.sqrt(angle) == pytest.approx(float(metrics["roll"]))


def test_a_metric_of_steering_is_a_response():
    response = ss.Response(CAR, ss.Road(tracks="isotropic"), "ay", inputs=("roll_centre_rear", "speed"))
    expected = ss.ride_metrics(
        ss.RideHandlingCar(roll_centre_rear=0.2, cornering=CAR.cornering, arb_front=8e3),
        ss.Road(tracks="isotropic", speed=15.0),
    )
    np.testing.assert_allclose(response([[0.2, 15.0]]), expected.ay)


# Histories


TIME = np.arange(0.0, 4.0, 0.005)
LANE_CHANGE = 0.01 * np.sin(np.pi * np.clip(TIME - 0.5, 0.0, 2.0))


def rough(car, seed=0):
    """Heights of a road under all wheels, from level ground on."""
    road = np.random.default_rng(seed).normal(size=(4, len(TIME))).cumsum(axis=1) * 1e-3
    return road - road[:, :1]


@pytest.mark.parametrize("steering", ["step", "lane change"])
def test_histories_are_the_state_spaces_own(steering):
    z, delta = rough(CAR), np.where(TIME > 0.5, 0.01, 0.0) if steering == "step" else LANE_CHANGE
    braked = np.where(TIME > 2.0, -150.0, 0.0)
    ours = ss.simulate(CAR, z, TIME, inputs={"delta_f": delta, "drive_rr": braked})
    system = CAR.state_space()
    u = np.vstack([z, delta, 0.0 * TIME, 0.0 * TIME, 0.0 * TIME, braked, 0.0 * TIME])
    theirs = dict(zip(system.output_labels, ct.forced_response(system, TIME, u).outputs, strict=True))
    for name in ("ay", "yaw_rate", "sideslip", "roll", "load_transfer_ratio"):
        np.testing.assert_allclose(ours[name], theirs[name], atol=1e-8 * np.abs(theirs[name]).max(), err_msg=name)
    np.testing.assert_allclose(ours.dtl.sel(corner="rl"), theirs["dtl_rl"], atol=1e-6)


def test_a_step_of_the_steering_angle_settles_at_the_steady_state():
    history = ss.simulate(CAR, np.zeros_like(TIME), TIME, inputs={"delta_f": np.full_like(TIME, 0.01)})
    settled = CAR.steady_state(delta_f=0.01)
    for name in ("ay", "yaw_rate", "sideslip", "roll", "load_transfer_ratio"):
        assert float(history[name][-1]) == pytest.approx(float(settled[name]), rel=2e-3), name


def test_road_and_steering_add_up():
    z = rough(CAR, seed=1)
    both = ss.simulate(CAR, z, TIME, inputs={"delta_f": LANE_CHANGE})
    road, steered = ss.simulate(CAR, z, TIME), ss.simulate(CAR, 0.0 * z, TIME, inputs={"delta_f": LANE_CHANGE})
    for name in ("ay", "dtl", "roll"):
        np.testing.assert_allclose(both[name], road[name] + steered[name], atol=1e-7 * float(abs(both[name]).max()))
    assert float(abs(road.ay).max()) > 0.0
