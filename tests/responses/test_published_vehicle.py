"""A published multi-body car, linearised by differences, runs through as a linear vehicle.

CommonRoad vehicle models 3.0.2 (TU Munich; Althoff, Koschi and Manzinger 2017): 29 states, a rigid body on two axles
with compliant joints and magic-formula tyres, its parameters those of vehicle 2, a BMW 320i. z points down there.
"""

import control as ct
import numpy as np
import pytest
from scipy.optimize import root

import susp_ss as ss

WHEELS = ("fr", "fl", "rr", "rl")
SPEED = 20.0


@pytest.fixture(scope="module")
def car():
    """The parameters, and the linearised car with the heights under its wheels as inputs."""
    pytest.importorskip("vehiclemodels", reason="commonroad-vehicle-models is not installed: pip install '.[test]'")
    from vehiclemodels.init_mb import init_mb
    from vehiclemodels.parameters_vehicle2 import parameters_vehicle2
    from vehiclemodels.vehicle_dynamics_mb import vehicle_dynamics_mb

    p = parameters_vehicle2()

    def rates(x):
        return np.array(vehicle_dynamics_mb(list(x), [0.0, 0.0], p))

    # Straight on at constant speed: x, y, steering angle, speed and yaw angle are given.
    x, free = np.array(init_mb([0.0, 0.0, 0.0, SPEED, 0.0, 0.0, 0.0], p)), [5, *range(6, 29)]

    def trimmed(y):
        full = x.copy()
        full[free] = y
        return full

    x = trimmed(root(lambda y: rates(trimmed(y))[free], x[free], tol=1e-12).x)
    assert np.abs(rates(x)[free]).max() < 1e-9
    A = np.array([(rates(x + e) - rates(x - e)) / 2e-6 for e in 1e-6 * np.eye(29)]).T
    A[3] = 0.0  # cruise control
    # Under wheel i the tyre's force grows by K_zt times the height of the road, as the equations for F_z have it.
    B, tyres, suspensions = np.zeros((29, 4)), np.zeros((4, 29)), np.zeros((4, 29))
    for i, wheel in enumerate(WHEELS):
        front, side = wheel[0] == "f", -1.0 if wheel[1] == "l" else 1.0
        heave, roll = (16, 13) if front else (21, 18)
        mass, inertia, track = (p.m_uf, p.I_uf, p.T_f) if front else (p.m_ur, p.I_ur, p.T_r)
        B[heave + 1, i], B[roll + 1, i] = -p.K_zt / mass, -0.5 * side * track * p.K_zt / inertia
        tyres[i, [heave, roll]] = p.K_zt, 0.5 * side * track * p.K_zt
        lever = p.a if front else -p.b
        suspensions[i, [heave, 11, 8, 6, roll]] = 1.0, -1.0, lever, -0.5 * side * track, 0.5 * side * track
    outputs = {"bacc_cg": -A[12], "pitch_acc": A[9], "roll_acc": A[7], "ay": A[10] + SPEED * np.eye(29)[5]}
    outputs |= {f"sws_{wheel}": -row for wheel, row in zip(WHEELS, suspensions, strict=True)}
    outputs |= {f"dtl_{wheel}": row for wheel, row in zip(WHEELS, tyres, strict=True)}
    D = np.vstack([np.zeros((8, 4)), p.K_zt * np.eye(4)])
    system = ct.ss(
        A, B, np.array(list(outputs.values())), D, inputs=[f"z_r_{wheel}" for wheel in WHEELS], outputs=list(outputs)
    )
    return p, ss.LinearVehicle(system, wheelbase=p.a + p.b, track_width=p.T_f)


@pytest.mark.parametrize(
    "road",
    [
        ss.Road(speed=SPEED, cutoff=0.01),
        ss.Road(speed=SPEED, tracks="independent", cutoff=0.01),
        ss.Road(speed=SPEED, tracks="isotropic", cutoff=0.01),
    ],
    ids=["identical", "independent", "isotropic"],
)
def test_a_published_car_by_three_routes(car, road):
    _, vehicle = car
    exact, spectral = (ss.ride_metrics(vehicle, road, method=method) for method in ("covariance", "spectral"))
    record = ss.ride_metrics(vehicle, road, method="time", duration=200.0)
    assert list(exact) == ["bacc", "sws", "dtl", "pitch_acc", "roll_acc", "ay"]
    for name in exact:
        rtol = 1e-3 if road.tracks == "isotropic" else 1e-6
        np.testing.assert_allclose(exact[name], spectral[name], rtol=rtol, atol=1e-7)
        error = np.maximum(record[f"{name}_stderr"], 1e-3 * exact[name])
        assert float((abs(record[name] - exact[name]) / error).max()) < 5.0, name


def test_a_published_car_rides_like_a_full_car_of_its_figures(car):
    p, vehicle = car
    alike = ss.FullCar(
        mb=p.m_s,
        ixx=p.I_Phi_s,
        iyy=p.I_y_s,
        a=p.a,
        b=p.b,
        c=0.5 * p.T_f,
        mu=ss.Corners.axles(front=0.5 * p.m_uf, rear=0.5 * p.m_ur),
        ks=ss.Corners.axles(front=p.K_sf, rear=p.K_sr),
        cs=ss.Corners.axles(front=p.K_sdf, rear=p.K_sdr),
        kt=p.K_zt,
    )
    road = ss.Road(speed=SPEED, cutoff=0.001)
    ours, theirs = ss.ride_metrics(alike, road), ss.ride_metrics(vehicle, road)
    np.testing.assert_allclose(theirs.bacc.sel(point="cg"), ours.bacc.sel(point="cg"), rtol=0.02)
    for name in ("sws", "dtl"):
        np.testing.assert_allclose(theirs[name], ours[name], rtol=0.03)


def test_what_the_published_car_leaves_out_and_what_it_feels(car):
    _, vehicle = car
    # Its tyres' radii are measured from flat ground: a little of a long hill stays.
    with pytest.raises(ValueError, match="feel the height of the road"):
        ss.ride_metrics(vehicle, ss.Road(speed=SPEED))
    kept = ss.covariance(vehicle, ss.Road(speed=SPEED, cutoff=0.01)).state.values.tolist()
    # Where it is and where it looks, which no output sees; the steering angle and the speed stand still.
    assert {f"p_x[{i}]" for i in range(29)} - set(kept) == {"p_x[0]", "p_x[1]", "p_x[4]"}
