"""What is a linear vehicle, how its signals are named, and what is none."""

import control as ct
import numpy as np
import pytest

import susp_ss as ss
from models import VEHICLES
from susp_ss.vehicles.linkage import Wheel

CAR = ss.FullCar()
PLANT = CAR.state_space("velocity")
LAYOUT = {"wheelbase": 2.5, "track_width": 1.5}


def lag(rate=-3.0, **names):
    return ct.ss([[rate]], [[1.0]], [[1.0]], [[0.0]], **({"inputs": "dz_r", "outputs": "lagged"} | names))


def named(inputs, outputs=("y",), n=2):
    A = -np.diag(np.arange(1.0, n + 1.0))
    return ct.ss(
        A, np.ones((n, len(inputs))), np.ones((len(outputs), n)), 0.0, inputs=list(inputs), outputs=list(outputs)
    )


def changed(system, **matrices):
    parts = {name: getattr(system, name).copy() for name in "ABCD"}
    for name, (at, value) in matrices.items():
        parts[name][at] = value
    return ct.ss(*parts.values(), inputs=system.input_labels, outputs=system.output_labels, states=system.state_labels)


WRONG = {
    "no system": (lambda: ss.LinearVehicle(CAR), TypeError, "must be a control.StateSpace, got a FullCar"),
    "transfer function": (
        lambda: ss.LinearVehicle(ct.tf([1.0], [1.0, 1.0])),
        TypeError,
        r"must be a control.StateSpace, got .*; pass control.ss\(...\) of it, with named inputs and outputs",
    ),
    "nonlinear": (
        lambda: ss.LinearVehicle(ct.nlsys(lambda t, x, u, p: -x, None, states=1, inputs="dz_r")),
        TypeError,
        "pass its .linearize",
    ),
    "none of them": (lambda: ss.LinearVehicle([]), ValueError, "at least one control.StateSpace, got none"),
    "discrete time": (
        lambda: ss.LinearVehicle(ct.c2d(lag(), 0.01)),
        ValueError,
        "must be in continuous time, got one of step 0.01",
    ),
    "no states": (
        lambda: ss.LinearVehicle(ct.ss([], [], [], [[1.0]], inputs="z_r", outputs="y")),
        ValueError,
        "needs states and outputs, got 0 states and 1 outputs",
    ),
    "no road": (
        lambda: ss.LinearVehicle(lag(inputs="force")),
        ValueError,
        r"needs inputs z_r... \(m\) or dz_r... \(m/s\), got force",
    ),
    "heights and rates": (
        lambda: ss.LinearVehicle(named(["z_r_f", "dz_r_r"])),
        ValueError,
        "one of both, got z_r_f, dz_r_r",
    ),
    "unknown wheels": (
        lambda: ss.LinearVehicle(named(["z_r_1", "z_r_2"])),
        ValueError,
        r"must say where the wheels 1, 2 run, such as wheels=\{'1': \(0, -1\), ...\}",
    ),
    "other wheels": (
        lambda: ss.LinearVehicle(named(["z_r_1", "z_r_2"]), wheels={"1": (0, 0), "3": (1, 0)}),
        ValueError,
        "must be of the same wheels, got 1, 3 and inputs for 1, 2",
    ),
    "wheels of another vehicle": (
        lambda: ss.LinearVehicle(PLANT, like=ss.PitchHalfCar()),
        ValueError,
        "must be of the same wheels, got f, r and inputs for fr, fl, rr, rl",
    ),
    "wheels in a list": (lambda: ss.LinearVehicle(PLANT, wheels=["fr"]), TypeError, "must be a mapping such as"),
    "third axle": (
        lambda: ss.LinearVehicle(named(["z_r_1", "z_r_2"]), wheels={"1": (0, 0), "2": (2, 0)}),
        ValueError,
        r"'2' must be \(axle, side\) with axle 0 to 1 and side -1, 0 or 1, got \(2, 0\)",
    ),
    "negative wheelbase": (
        lambda: ss.LinearVehicle(PLANT, wheelbase=-1.0),
        ValueError,
        "wheelbase=...* >= 0 m, got -1.0",
    ),
    "wheelbases": (
        lambda: ss.LinearVehicle(PLANT, wheelbase=np.ones(2)),
        TypeError,
        "wheelbase=...* one number >= 0 m",
    ),
    "like nothing": (lambda: ss.LinearVehicle(PLANT, like="FullCar"), TypeError, "must be a vehicle such as FullCar"),
    "like and wheels": (
        lambda: ss.LinearVehicle(PLANT, like=CAR, wheelbase=2.0),
        ValueError,
        "pass like or these",
    ),
    "unstable": (
        lambda: ss.LinearVehicle(changed(PLANT, A=((12, 5), 900.0))),
        ValueError,
        r"has a mode that does not die out \(rate [\d.+\-j]+ 1/s, mostly the state '\w+'\) and that the output '\w+'",
    ),
    "undamped": (
        lambda: ss.LinearVehicle(ss.QuarterCar(cs=0.0).state_space()),
        ValueError,
        "has a mode that does not die out",
    ),
    "unstable among many": (lambda: ss.LinearVehicle([lag(), lag(2.0)]), ValueError, r"rate 2.* at \(design=1\)"),
    "integrates the height": (
        lambda: ss.LinearVehicle(ct.ss([[0.0]], [[1.0]], [[1.0]], [[0.0]], inputs="z_r", outputs="y", states=["sum"])),
        ValueError,
        "mostly the state 'sum'.* 'y' sees",
    ),
    "chain of integrators": (
        lambda: ss.LinearVehicle(
            ct.ss([[0.0, 1.0], [0.0, 0.0]], [[0.0], [1.0]], [[1.0, 0.0]], [[0.0]], inputs="dz_r", outputs="y")
        ),
        ValueError,
        "has a mode that does not die out",
    ),
    "other names": (
        lambda: ss.LinearVehicle([lag(), lag(outputs="y")]),
        ValueError,
        "the same inputs, outputs and states",
    ),
    "bare and placed": (
        lambda: ss.LinearVehicle(named(["dz_r"], ["bacc", "bacc_driver"])),
        ValueError,
        "has outputs 'bacc' and 'bacc_driver'",
    ),
    "name of a dim": (
        lambda: ss.LinearVehicle(lag(outputs="time")),
        ValueError,
        "an output named 'time', which results use",
    ),
    "NaN": (lambda: ss.LinearVehicle(changed(PLANT, B=((0, 0), np.nan))), ValueError, "got NaN or inf in B"),
    "isotropic tracks of no width": (
        lambda: ss.ride_metrics(ss.LinearVehicle(PLANT, wheelbase=2.5), ss.Road(tracks="isotropic")),
        ValueError,
        "isotropic tracks need the track width",
    ),
    "drift": (
        lambda: ss.ride_metrics(ss.LinearVehicle(PLANT, **LAYOUT), ss.Road(wheels=("fr",))),
        ValueError,
        "sws_fr, sws_fl, sws_rr, sws_rl, dtl_fr, dtl_fl, dtl_rr, dtl_rl feel the height of the road",
    ),
    "points": (
        lambda: ss.ride_metrics(ss.LinearVehicle(PLANT, like=CAR), ss.Road(), points={"driver": (0.3, 0.4)}),
        TypeError,
        "points need a vehicle whose body is known.* named bacc_driver",
    ),
    "sensitivity": (
        lambda: ss.sensitivity(ss.LinearVehicle(PLANT, like=CAR), ss.Road(), ["speed"]),
        TypeError,
        "sensitivity needs a vehicle of springs and dampers",
    ),
}


@pytest.mark.parametrize(("make", "kind", "said"), WRONG.values(), ids=WRONG.keys())
def test_wrong_input_is_refused_in_one_line(make, kind, said):
    with pytest.raises(kind, match=said) as refusal:
        make()
    assert "\n" not in str(refusal.value)


def test_names_of_the_package_land_on_its_dims_others_on_their_own():
    names = ["bacc_cg", "bacc_driver", "sws_fr", "dtl_fr", "roll_acc", "seat_force", "sws_rate_fr"]
    vehicle = ss.LinearVehicle(named([f"dz_r_{wheel}" for wheel in CAR.wheels], names), **LAYOUT)
    metrics = ss.ride_metrics(vehicle, ss.Road())
    assert list(metrics) == ["bacc", "sws", "dtl", "roll_acc", "sws_rate", "seat_force"]
    assert metrics.bacc.point.values.tolist() == ["cg", "driver"]
    assert (metrics.sws.dims, metrics.seat_force.dims) == (("corner",), ())
    assert (metrics.bacc.attrs["units"], metrics.seat_force.attrs["long_name"]) == ("m/s^2", "RMS seat_force")


def test_wheels_by_their_usual_names_and_by_the_vehicle_that_it_is_like():
    for vehicle in VEHICLES.values():
        system = vehicle.state_space("velocity", actuators=True)
        assert ss.LinearVehicle(system).wheels == vehicle.wheels
        linear = ss.LinearVehicle(system, like=vehicle)
        assert (linear.wheels, linear.wheelbase, linear.track_width) == (
            vehicle.wheels,
            vehicle.wheelbase,
            vehicle.track_width,
        )
        assert "damper_power" in linear.layout().variables
        again = ss.LinearVehicle(system, like=linear)
        assert again.layout().variables == linear.layout().variables
    own = ss.LinearVehicle(named(["z_r_1", "z_r_2"]), wheels={"2": (1, 0), "1": (0, 0)}, wheelbase=3.0)
    assert own.wheels == {"2": Wheel(1, 0), "1": Wheel(0, 0)}
    assert own.layout().inputs == ("z_r_2", "z_r_1")
    assert repr(own) == "LinearVehicle(2 states, 1 outputs, wheels 2, 1)"


def test_the_system_is_left_as_it_was():
    system = CAR.state_space("velocity", actuators=True)
    before = [getattr(system, name).copy() for name in "ABCD"]
    vehicle = ss.LinearVehicle(system, like=CAR)
    ss.ride_metrics(vehicle, ss.Road(tracks="isotropic"))
    for name, matrix in zip("ABCD", before, strict=True):
        np.testing.assert_array_equal(getattr(system, name), matrix)


def test_a_washout_slower_than_any_wheel_is_kept():
    # Five decades between the slowest and the fastest mode that an output sees.
    for rate in (1e-1, 1e-3, 1e-5):
        vehicle = ss.LinearVehicle(
            ct.ss(np.diag([-rate, -100.0]), np.ones((2, 1)), np.eye(2), 0.0, inputs="dz_r", outputs=["slow", "fast"])
        )
        metrics, road = ss.ride_metrics(vehicle, ss.Road()), ss.Road()
        np.testing.assert_allclose(metrics.slow, np.sqrt(road.intensity / (2.0 * rate)), rtol=1e-9)
        np.testing.assert_allclose(metrics.fast, np.sqrt(road.intensity / 200.0), rtol=1e-9)


def test_nothing_but_an_integrator():
    height = ss.LinearVehicle(ct.ss([[0.0]], [[1.0]], [[1.0]], [[0.0]], inputs="dz_r", outputs="height"))
    road = ss.Road(cutoff=0.01)
    with pytest.raises(ValueError, match="height feels the height of the road"):
        ss.ride_metrics(height, ss.Road())
    # The first-order road z' = -a z + w has the variance q / (2 a).
    expected = np.sqrt(road.intensity / (2.0 * 2.0 * np.pi * road.cutoff * road.speed))
    for method in ("covariance", "spectral"):
        np.testing.assert_allclose(ss.ride_metrics(height, road, method=method).height, expected, rtol=1e-6)
