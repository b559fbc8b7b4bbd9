"""``susp-ss handling``: it says what the library says, writes only where it is told, and refuses in one line."""

import csv
import json

import numpy as np
import pytest

import susp_ss as ss
from susp_ss.vehicles.files import read_vehicle, vehicle_text

CAR = ss.RideHandlingCar(cornering=ss.Corners.axles(front=45e3, rear=55e3), relaxation=0.4, arb_front=1e4)


@pytest.fixture(autouse=True)
def here(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "car.toml").write_text(vehicle_text(CAR))
    return tmp_path


def test_it_equals_the_library(run, here):
    asked = "--vehicle car.toml --speeds 10:30:3 --angle 2deg --speed 90km/h --json"
    code, out, err = run("handling", *asked.split())
    assert (code, err) == (0, "")
    said = json.loads(out)
    assert said["understeer_gradient"] == {"value": CAR.understeer_gradient(), "unit": "rad/(m/s^2)"}
    assert said["characteristic_speed"]["value"] == CAR.characteristic_speed()
    assert said["critical_speed"]["value"] == "inf"
    assert said["rollover_threshold"]["value"] == CAR.rollover_threshold()
    assert said["speed"]["values"] == [10.0, 20.0, 30.0]
    for name, gain in said["gains"].items():
        expected = [float(CAR.steady_state(speed=v, delta_f=1.0)[name]) for v in (10.0, 20.0, 30.0)]
        np.testing.assert_allclose(gain["values"], expected, rtol=1e-12)
    step = said["step"]
    assert (step["speed"]["value"], step["angle"]["value"]) == (25.0, pytest.approx(np.radians(2.0)))
    time = np.arange(0.0, 6.0, 1e-3)
    delta = {"delta_f": np.full_like(time, np.radians(2.0))}
    yaw = ss.simulate(CAR.moving(25.0), 0.0 * time, time, inputs=delta).yaw_rate.values
    assert step["overshoot"]["value"] == pytest.approx(yaw.max() / yaw[-1] - 1.0, rel=0.01)
    assert step["rise"]["value"] == pytest.approx(time[np.argmax(yaw > 0.9 * yaw[-1])], abs=0.004)


def test_it_writes_its_table_and_figure(run, here):
    code, out, err = run("handling", "--vehicle", "car.toml", "--out", "deep/folder")
    assert (code, err) == (0, "")
    assert "understeer gradient: " in out
    assert "deg/g" in out
    with open(here / "deep/folder/handling.csv", newline="", encoding="utf-8") as file:
        header, *rows = csv.reader(file)
    assert header[:3] == ["speed (m/s)", "yaw rate (1/s)", "ay (m/s^2/rad)"]
    assert [float(row[0]) for row in rows] == np.linspace(10.0, 40.0, 7).tolist()
    np.testing.assert_allclose(float(rows[2][1]), CAR.steady_state(speed=20.0, delta_f=1.0).yaw_rate)
    assert (here / "deep/folder/handling.png").read_bytes().startswith(b"\x89PNG")
    assert run("handling", "--vehicle", "car.toml", "--out", "deep/folder").code == 2


def test_a_file_holds_a_car_that_steers(run, here):
    read = read_vehicle(here / "car.toml")
    assert read.cornering.rl == 55e3
    assert read.steering is None
    steered = ss.RideHandlingCar(steering=9e3, roll_centre_rear=-0.02, speed=31.0)
    (here / "steered.toml").write_text(vehicle_text(steered))
    again = read_vehicle(here / "steered.toml")
    assert (again.steering, again.roll_centre_rear, again.speed) == (9e3, -0.02, 31.0)
    said = json.loads(run("metrics", "--vehicle", "car.toml", "--json").out)
    expected = ss.ride_metrics(CAR, ss.DEFAULT_ROAD)
    assert said["metrics"]["ay"] == pytest.approx(float(expected.ay))
    assert said["metrics"]["load_transfer"]["rear"] == pytest.approx(float(expected.load_transfer.sel(axle="rear")))
    text = run("metrics", "--vehicle", "car.toml").out
    assert "load_transfer" in text
    assert "yaw_rate" in text


def test_options_set_what_the_file_does(run):
    options = "--cornering-front 45kN/rad --cornering-rear 55kN/rad --relaxation 40cm --arb-front 1e4"
    by_options = json.loads(run("handling", *options.split(), "--json").out)
    assert by_options["vehicle"] == json.loads(run("handling", "--vehicle", "car.toml", "--json").out)["vehicle"]


def test_responses_to_steering(run):
    asked = "--vehicle car.toml --output yaw_rate --input delta_f --out o --json"
    code, out, err = run("bode", *asked.split())
    assert (code, err) == (0, "")
    (curve,) = json.loads(out)["responses"]
    assert curve["magnitude"]["unit"] == "rad/s/rad"
    f = np.geomspace(0.1, 50.0, 500)
    expected = abs(ss.frequency_response(CAR, f).sel(output="yaw_rate", input="delta_f"))
    np.testing.assert_allclose(curve["magnitude"]["values"], expected, rtol=1e-12)


@pytest.mark.parametrize(
    ("line", "said"),
    [
        ("--model full", "handling needs a car that steers, --model ride-handling, got a FullCar"),
        ("--cornering-rear 22e3 --speed 30", "unstable at 30 m/s, above its critical speed of 25.82 m/s"),
        ("--cornering-rear 22e3 --speeds 10:40:4", "unstable at 30 m/s, above its critical speed of 25.82 m/s"),
        ("--cornering 0", "--cornering must be > 0 N/rad at both axles"),
        ("--speeds 0:10:3", "--speeds must be > 0 m/s, got '0:10:3'"),
        ("--cornering 800", "did you mean 800 N/deg"),
        ("--angle 0", "--angle must be another than zero"),
        ("--angle 5", "did you mean 5 deg"),
        ("--speed 90", "did you mean 90 km/h"),
        ("--height=-0.2", "--height must be >= 0 m, got -0.2"),
        ("--height 600", "did you mean 600 mm"),
        ("--izz 300", "--izz must exceed 384.2 kg m^2"),
    ],
)
def test_wrong_input_is_refused_in_one_line(line, said, run, here):
    code, out, err = run("handling", *line.split())
    assert (code, out, err.count("\n")) == (2, "", 1)
    assert said in err
    assert [path.name for path in here.iterdir()] == ["car.toml"]
