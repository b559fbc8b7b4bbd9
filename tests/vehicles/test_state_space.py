"""Vehicles as python-control systems."""

import control as ct
import numpy as np
import pytest
from hypothesis import given, settings

import models
import oracles
import susp_ss as ss
from models import VEHICLES
from susp_ss.vehicles.modes import modes_among

PROPER = {name: car for name, car in VEHICLES.items() if "tyre" not in name and "unequal ends" not in name}
FREQUENCY = np.geomspace(0.05, 60.0, 40)


@pytest.mark.parametrize("vehicle", PROPER.values(), ids=PROPER.keys())
def test_displacement_form_in_python_control(vehicle):
    system = vehicle.state_space()
    reference = oracles.frequency_response(models.oracle(vehicle), FREQUENCY)
    response = ct.frequency_response(system, 2 * np.pi * FREQUENCY)
    for i, name in enumerate(system.output_labels):
        np.testing.assert_allclose(
            response.complex[i], reference[name], rtol=1e-7, atol=1e-10 * np.abs(reference[name]).max()
        )


@pytest.mark.parametrize("vehicle", VEHICLES.values(), ids=VEHICLES.keys())
def test_velocity_form_in_python_control(vehicle):
    system = vehicle.state_space(input="velocity")
    reference = oracles.frequency_response(models.oracle(vehicle), FREQUENCY)
    response = ct.frequency_response(system, 2 * np.pi * FREQUENCY).complex.reshape(system.noutputs, system.ninputs, -1)
    for i, name in enumerate(system.output_labels):
        expected = reference[name] / (2j * np.pi * FREQUENCY)
        np.testing.assert_allclose(response[i], expected, rtol=1e-8, atol=1e-12 * np.abs(expected).max())


@pytest.mark.parametrize("vehicle", VEHICLES.values(), ids=VEHICLES.keys())
def test_poles(vehicle):
    system = vehicle.state_space(input="velocity")
    poles = ct.poles(system)
    warp = isinstance(vehicle, ss.FullCar)
    assert np.sum(np.abs(poles) < 1e-9) == warp, "the road's warp is the one integrator there is"
    oracle = models.oracle(vehicle)
    reference = np.linalg.eigvals(oracles.first_order(oracle).A)
    np.testing.assert_allclose(
        np.sort_complex(poles[np.abs(poles) > 1e-9]), np.sort_complex(reference), rtol=1e-7, atol=1e-6
    )


@pytest.mark.parametrize("vehicle", VEHICLES.values(), ids=VEHICLES.keys())
def test_an_actuator_that_acts_as_a_damper_is_one(vehicle):
    # Closing u = g sws_rate adds g to every damping rate, whatever the output.
    import dataclasses

    gain = 250.0
    system = vehicle.state_space(input="velocity", actuators=True)
    corners = len(vehicle.wheels)
    roads = system.ninputs - corners
    A, B, C, D = system.A, system.B, system.C, system.D
    rate, push = slice(system.noutputs - corners, None), slice(roads, None)
    closed = np.linalg.inv(np.eye(corners) - gain * D[rate, push]) * gain
    A = A + B[:, push] @ closed @ C[rate]
    C_all, D_all = C + D[:, push] @ closed @ C[rate], D[:, :roads] + D[:, push] @ closed @ D[rate, :roads]
    B_all = B[:, :roads] + B[:, push] @ closed @ D[rate, :roads]

    def stiffer(cs):
        if isinstance(cs, ss.Corners):
            return ss.Corners(**{name: getattr(cs, name) + gain for name in ("fr", "fl", "rr", "rl")})
        return tuple(c + gain for c in cs) if isinstance(cs, tuple) else cs + gain

    damped = dataclasses.replace(vehicle, cs=stiffer(vehicle.cs)).state_space(input="velocity")
    count = damped.noutputs
    for f in (0.5, 3.0, 15.0):
        s = 2j * np.pi * f
        ours = C_all[:count] @ np.linalg.solve(s * np.eye(len(A)) - A, B_all) + D_all[:count]
        theirs = np.atleast_2d(damped(s))
        np.testing.assert_allclose(ours, theirs, rtol=1e-7, atol=1e-9 * np.abs(theirs).max())


def test_names_and_selection():
    system = ss.FullCar().state_space()
    assert system.input_labels == ["z_r_fr", "z_r_fl", "z_r_rr", "z_r_rl"]
    assert system.output_labels[:4] == ["bacc_cg", "pitch_acc", "roll_acc", "bacc_fr"]
    one = system["sws_fr", "z_r_fr"]
    assert (one.ninputs, one.noutputs) == (1, 1)
    assert ss.PitchHalfCar().state_space("velocity").input_labels == ["dz_r_f", "dz_r_r"]
    assert ss.RollHalfCar().state_space().output_labels[-2:] == ["dtl_r", "dtl_l"]


def test_forced_response_of_a_quarter_car_agrees_with_scipy():
    from scipy.signal import lsim

    system = ss.QuarterCar().state_space()
    time = np.linspace(0.0, 2.0, 401)
    bump = np.where(time < 0.2, 0.05 * np.sin(np.pi * time / 0.2) ** 2, 0.0)
    response = ct.forced_response(system, time, bump)
    model = oracles.first_order(models.oracle(ss.QuarterCar()))
    for i, name in enumerate(["bacc", "sws", "dtl"]):
        _, y, _ = lsim((model.A, model.B, model.C[name][None], model.D[name][None]), bump, time)
        np.testing.assert_allclose(response.outputs[i], y, atol=1e-9 * np.abs(y).max())


@pytest.mark.parametrize(
    ("vehicle", "named"),
    [
        (ss.RigidTyreQuarterCar(), ["bacc", "dtl"]),
        (ss.QuarterCar(ct=100.0), ["dtl"]),
        (ss.FullCar(ct=ss.Corners(fr=0.0, fl=50.0, rr=0.0, rl=0.0)), ["dtl_fl"]),
    ],
)
def test_improper_displacement_forms_are_refused_by_name(vehicle, named):
    with pytest.raises(ValueError, match='input="velocity"') as refusal:
        vehicle.state_space()
    assert str(refusal.value).startswith(", ".join(named) + ": no state space")
    assert vehicle.state_space(input="velocity").ninputs >= 1


@pytest.mark.parametrize("form", ["displacement", "velocity"])
@pytest.mark.parametrize("name", ["quarter", "full, bars"])
def test_actuators_push_wheel_and_body_apart(name, form):
    vehicle = VEHICLES[name]
    system = vehicle.state_space(input=form, actuators=True)
    forces = [label for label in system.input_labels if label.startswith("u")]
    rates = [label for label in system.output_labels if label.startswith("sws_rate")]
    assert len(forces) == len(rates) == len(vehicle.wheels)
    oracle = models.oracle(vehicle)
    w = 2 * np.pi * 3.0
    for wheel, force in zip(oracle.wheels, forces, strict=True):
        # Along each suspension deflection z_u - z_s a force on the body is one of opposite sign.
        along = oracle.outputs[f"sws_{wheel}" if wheel else "sws"].q
        q = np.linalg.solve(oracle.K - w**2 * oracle.M + 1j * w * oracle.C, -along)
        for output in ("sws", "bacc", "dtl"):
            output = f"{output}_{wheel}" if wheel else output
            y = oracle.outputs[output]
            expected = y.q @ q + 1j * w * (y.v @ q) - w**2 * (y.a @ q)
            np.testing.assert_allclose(complex(system[output, force](1j * w)), expected, rtol=1e-9)
        rate = f"sws_rate_{wheel}" if wheel else "sws_rate"
        np.testing.assert_allclose(complex(system[rate, force](1j * w)), 1j * w * (along @ q), rtol=1e-9)


@given(models.vehicles)
@settings(max_examples=30)
def test_modes_solve_the_quadratic_eigenproblem(vehicle):
    model, modes = models.oracle(vehicle), vehicle.modes()
    assert (np.diff(modes["frequency"]) >= -1e-12).all()
    assert (modes["damping_ratio"] > 0).all()
    for frequency, ratio, shape in modes.itertuples(index=False):
        modulus = 2 * np.pi * frequency
        s = modulus * (-ratio + 1j * np.sqrt(max(0.0, 1 - ratio**2)))
        residual = (s**2 * model.M + s * model.C + model.K) @ shape.to_numpy()
        np.testing.assert_allclose(np.abs(residual).max() / np.abs(model.K).max(), 0.0, atol=1e-6)
        np.testing.assert_allclose(np.abs(shape).max(), 1.0)


def test_identical_corners_and_central_mass_make_three_quarter_cars():
    car = ss.FullCar(a=1.2, b=1.2)
    masses = oracles.equivalent_sprung_masses(car.mb, car.iyy, car.ixx, 1.2, car.c)
    quarters = [ss.QuarterCar(ms=ms).natural_frequencies() for ms in masses.values()]
    four = ss.QuarterCar(ms=1e12).natural_frequencies()[1]
    expected = np.sort(np.concatenate([*quarters, [four]]))
    np.testing.assert_allclose(car.natural_frequencies(), expected, rtol=1e-9)


def test_state_space_needs_numbers():
    with pytest.raises(ValueError, match="one number for every parameter"):
        ss.QuarterCar(ks=np.array([1e4, 2e4])).state_space()
    with pytest.raises(ValueError, match="'displacement' or 'velocity', got 'force'"):
        ss.QuarterCar().state_space(input="force")


def test_two_equal_eigenvalues_are_two_modes_however_rounding_splits_them():
    split = np.array([-2.0 + 1e-8j, -2.0 - 1e-8j, -0.5 + 3.0j, -0.5 - 3.0j, -1.0 + 0.0j])
    assert modes_among(split).tolist() == [4, 0, 1, 2]
    apart = np.array([-2.0 + 0.1j, -2.0 - 0.1j, -3.0, -3.0])
    assert modes_among(apart).tolist() == [0, 2, 3]
