"""The nonlinear turning car: the linear car is its limit for small angles, on a rough road too."""

import dataclasses
import importlib.util
import sys
from pathlib import Path

import numpy as np
import pytest

import susp_ss as ss

SCRIPT = Path(__file__).parents[1] / "examples" / "nonlinear_turning_car.py"


def _loaded():
    spec = importlib.util.spec_from_file_location(SCRIPT.stem, SCRIPT)
    module = importlib.util.module_from_spec(spec)
    sys.modules[SCRIPT.stem] = module
    spec.loader.exec_module(module)
    return module


example = _loaded()
UNEQUAL = ss.RideHandlingCar(
    mu=ss.Corners(fr=41.0, fl=44.0, rr=47.0, rl=52.0),
    cornering=ss.Corners(fr=40e3, fl=43e3, rr=52e3, rl=49e3),
    slip=ss.Corners(fr=40e3, fl=43e3, rr=52e3, rl=49e3),
    ixz=30.0,
    roll_centre_rear=0.2,
    arb_front=8e3,
    speed=24.0,
)


@pytest.mark.parametrize("tyre", [example.Tyre(), example.Tyre(0.9)], ids=["linear tyres", "saturating tyres"])
def test_the_linear_car_is_its_limit_for_small_angles_on_a_rough_road(tyre):
    step = 2e-3
    time = np.arange(0.0, 0.6, step)
    small = np.array([1e-4, 2e-4])
    ramp = np.clip(time / 0.1, 0.0, 1.0)
    delta = small[:, None] * ramp
    bumps = np.random.default_rng(3).normal(size=(4, len(time))).cumsum(axis=1) * 1e-6
    z = bumps - bumps[:, :1]
    true = example.TurningCar(UNEQUAL, tyre).drive(delta, z, step)
    ours = example.linear(UNEQUAL, delta, z, time)
    for name in example.OUTPUTS:
        largest = np.abs(true[name]).max(axis=1)
        error = np.abs(ours[name] - true[name]).max(axis=1) / largest
        assert (error < 5e-5).all(), name


def conserved(car, state):
    """Energy, and momentum in axes that turn with the car."""
    x, y = np.array([car.a, car.a, -car.b, -car.b]), car.c * np.array([-1.0, 1.0, -1.0, 1.0])
    swing = np.repeat([car.roll_centre_front, car.roll_centre_rear], 2) - car.radius
    (hubs, body), w = (state[:4], state[4:7]), state[7:]
    (d_hubs, (d_heave, d_pitch, d_roll), v, r, u), spins = (w[:4], w[4:7], *w[7:10]), w[10:]
    lean, d_lean = (np.repeat([rate[1] - rate[0], rate[3] - rate[2]], 2) / (2 * car.c) for rate in (hubs, d_hubs))
    aside, d_aside = -car.arm * np.sin(body[2]), -car.arm * np.cos(body[2]) * d_roll
    places = [(0.0, aside, d_aside, car.mb)]
    places += [(x[i], y[i] + swing[i] * lean[i], swing[i] * d_lean[i], car.at_wheels("mu")[i]) for i in range(4)]
    motions = [(m, u - r * py, v + d + r * px) for px, py, d, m in places]
    kinetic = sum(m * (vx**2 + vy**2) for m, vx, vy in motions) + car.mb * d_heave**2
    kinetic += car.ixx * d_roll**2 + car.iyy * d_pitch**2 + car.body_izz * r**2 - 2 * car.ixz * d_roll * r
    kinetic += np.sum(car.at_wheels("mu") * d_hubs**2) + np.sum(car.at_wheels("wheel_inertia") * spins**2)
    travel = hubs - (body[0] - x * body[1] + y * body[2])
    springs = np.sum(car.at_wheels("ks") * travel**2) + np.sum(car.at_wheels("kt") * hubs**2)
    springs += car.arb_front * (travel[0] - travel[1]) ** 2
    energy = 0.5 * (kinetic + springs) + car.mb * 9.81 * car.arm * np.cos(body[2])
    push = np.array([(m * vx, m * vy) for m, vx, vy in motions]).sum(axis=0)
    return energy, push


def test_without_friction_and_dampers_nothing_is_lost():
    """Of large motions: energy, and the size of the momentum, are what they were."""
    car = dataclasses.replace(UNEQUAL, cs=0.0, cornering=0.0, slip=1e-12)
    model, step, z, straight = example.TurningCar(car, example.Tyre()), 1e-3, np.zeros(4), np.zeros(1)
    state = model.at_speed(1)
    state[:7, 0] = [0.004, -0.006, 0.002, 0.005, 0.03, 0.02, 0.2]
    state[7:17, 0] += [0.1, -0.2, 0.1, 0.2, 0.3, 0.2, 1.0, 4.0, 1.2, 0.0]
    before = conserved(car, state[:, 0])
    for _ in range(400):
        stages = []
        for share in (0.0, 0.5, 0.5, 1.0):
            at = state + share * step * stages[-1] if stages else state
            stages.append(model.slope(at, straight, z)[0])
        weights = (1 / 6, 1 / 3, 1 / 3, 1 / 6)
        state = state + step * sum(w * s for w, s in zip(weights, stages, strict=True))
    after = conserved(car, state[:, 0])
    assert after[0] == pytest.approx(before[0], rel=1e-9)
    assert np.hypot(*after[1]) == pytest.approx(np.hypot(*before[1]), rel=1e-9)


@pytest.fixture
def short(monkeypatch):
    monkeypatch.setattr(example, "STEP", 4e-3)
    monkeypatch.setattr(example, "END", 0.8)


def test_errors_grow_with_the_square_of_the_angle(short):
    angles = np.radians([0.5, 1.0])
    _, errors = example.turns(UNEQUAL, example.Tyre(0.9), angles)
    for name in ("ay", "yaw_rate", "roll"):
        assert errors[name][1] / errors[name][0] == pytest.approx(4.0, rel=0.25), name


def test_what_it_says(capsys, monkeypatch, short):
    monkeypatch.setattr(example.turns, "__defaults__", (np.radians([1.0, 3.0]),))
    example.main(["--speed", "20"])
    said = capsys.readouterr().out
    assert "linear tyres: largest error" in said
    assert "friction 0.9: largest error" in said
    assert said.count("ay, yaw rate and roll hold to 2% up to ") == 2


def test_bounds_are_found_between_turns():
    ay, error = np.array([1.0, 2.0, 4.0]), np.array([0.01, 0.03, 0.05])
    assert example.holds_to(ay, error, 0.02) == pytest.approx(1.5)
    assert example.holds_to(ay, error, 0.1) == 4.0
    assert example.holds_to(ay, error, 0.001) == 0.0


@pytest.mark.parametrize(
    ("arguments", "named"),
    [
        (["--speed", "fast"], "--speed: needs a number from 5 to 60, got 'fast'"),
        (["--friction", "0"], "--friction"),
        (["--angle", "3"], "--angle"),
    ],
)
def test_wrong_input_gets_one_line(arguments, named, capsys):
    with pytest.raises(SystemExit) as end:
        example.main(arguments)
    said = capsys.readouterr()
    assert (end.value.code, said.out, said.err.count("\n")) == (2, "", 1)
    assert named in said.err


def test_what_the_car_is_without_is_refused():
    with pytest.raises(ValueError, match="neither compliant steering nor relaxation"):
        example.TurningCar(ss.RideHandlingCar(relaxation=0.3), example.Tyre())
