"""The nonlinear full car: its linear limit, its equations by hand under another integrator, and its table of runs."""

import importlib.util
import sys
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import susp_ss as ss

SCRIPT = Path(__file__).parents[1] / "examples" / "nonlinear_full_car.py"
SHORT = ("--runs", "3", "--duration", "1")


def _loaded():
    spec = importlib.util.spec_from_file_location(SCRIPT.stem, SCRIPT)
    module = importlib.util.module_from_spec(spec)
    sys.modules[SCRIPT.stem] = module
    spec.loader.exec_module(module)
    return module


example = _loaded()
LINEAR = example.Laws(bump=1.0, rebound=1.0, beyond=1.0, jounce=np.inf, droop=np.inf, gravity=np.inf)
ROUGH = ss.Road.iso8608("D", speed=20.0, tracks="isotropic")


def finer(z, parts):
    """The same heights, linear between samples, with steps that many times shorter."""
    samples = np.arange(z.shape[1])
    return np.array([np.interp(np.arange((len(samples) - 1) * parts + 1) / parts, samples, row) for row in z])


def call(*arguments):
    with pytest.raises(SystemExit) as end:
        example.main(list(map(str, arguments)))
    return end.value.code


# The car


def test_with_linear_laws_it_is_the_linear_car():
    car, z = ss.FullCar(ks=15e3, cs=900.0), example.record(ROUGH, 2.0, seed=3)
    exact = ss.simulate(car, z, example.STEP * np.arange(z.shape[1]))
    history = example.ride(car, z, example.STEP, LINEAR)
    bacc = exact.bacc.sel(point=exact.corner.values).transpose("point", "time")
    for ours, theirs in ((history.bacc, bacc), (history.sws, exact.sws), (history.dtl, exact.dtl)):
        theirs = theirs.transpose(..., "time").values
        np.testing.assert_allclose(ours, theirs, rtol=0.0, atol=1e-9 * np.abs(theirs).max())
    assert not history.on_stop.any()
    assert not history.lifted.any()


def test_with_linear_laws_its_root_mean_squares_are_the_exact_ones_within_their_error(monkeypatch):
    monkeypatch.setattr(example, "Laws", lambda: LINEAR)
    car, duration = ss.FullCar(ks=20e3, cs=1800.0), 40.0
    measured, shares = example.run(car.ks, car.cs, example.record(ROUGH, duration, seed=1))
    exact = ss.ride_metrics(car, ROUGH)
    error = ss.ride_metrics(car, ROUGH, method="time", duration=duration, step=2e-3, seed=2)
    at = {"bacc": {"point": "fr"}, "sws": {"corner": "fr"}, "dtl": {"corner": "fr"}}
    for value, (name, where) in zip(measured, at.items(), strict=True):
        assert abs(value - exact[name].sel(where)) < 3.0 * error[f"{name}_stderr"].sel(where), name
    assert not shares.any()


def by_hand(car, laws, z, step):
    """Newton's second law for body and wheels, heights above the static position, gravity included."""
    x, y = np.array([-car.a, -car.a, car.b, car.b]), np.array([-car.c, car.c, -car.c, car.c])
    axle = np.linalg.solve([[2.0, 2.0], [-2.0 * car.a, 2.0 * car.b]], [car.mb * laws.gravity, 0.0])
    carried = np.repeat(axle, 2)
    time = step * np.arange(z.shape[1])

    def strut(travel, rate):
        slope = laws.rebound * car.cs if rate > 0.0 else laws.bump * car.cs
        damper = slope * min(abs(rate), laws.knee) + slope * laws.beyond * max(abs(rate) - laws.knee, 0.0)
        pressed = max(-travel - laws.jounce, travel - laws.droop, 0.0)
        stop = laws.stop_rate * (pressed + pressed**3 / laws.stop_depth**2)
        return car.ks * travel + np.copysign(damper, rate) + np.copysign(stop, travel)

    def slope(t, state):
        (heave, pitch, roll, *wheel), (d_heave, d_pitch, d_roll, *d_wheel) = np.split(state, 2)
        travel = heave + x * pitch + y * roll - wheel
        rate = d_heave + x * d_pitch + y * d_roll - d_wheel
        lift = carried - np.array(list(map(strut, travel, rate)))
        road = np.array([np.interp(t, time, row) for row in z])
        ground = np.maximum(carried + car.mu * laws.gravity - car.kt * (wheel - road), 0.0)
        body = lift.sum() / car.mb - laws.gravity, x @ lift / car.iyy, y @ lift / car.ixx
        return np.concatenate([state[7:], body, (ground - lift) / car.mu - laws.gravity])

    solved = solve_ivp(slope, time[[0, -1]], np.zeros(14), "RK45", time, rtol=1e-8, atol=1e-10, max_step=step)
    slopes = np.array([slope(t, state) for t, state in zip(time, solved.y.T, strict=True)]).T
    heave, pitch, roll, *wheel = solved.y[:7]
    travel = heave + np.outer(x, pitch) + np.outer(y, roll) - wheel
    bacc = slopes[7] + np.outer(x, slopes[8]) + np.outer(y, slopes[9])
    dtl = np.maximum(car.kt * (z - wheel), -(carried + car.mu * laws.gravity)[:, None])
    return bacc, -travel, dtl


def test_it_obeys_newton_with_stops_and_lift_off_at_work():
    step, laws, car = example.STEP, example.Laws(), ss.FullCar(ks=13e3, cs=900.0)
    z = example.record(ROUGH, 1.0, seed=5)[:, :1200]
    z = (z - z[:, :1]) * np.minimum(np.arange(1200) / 200.0, 1.0)
    truth = by_hand(car, laws, z, step)
    errors = []
    for parts in (1, 2):
        history = example.ride(car, finer(z, parts), step / parts, laws)
        errors.append([np.abs(a[:, ::parts] - b).max() / np.abs(b).max() for a, b in zip(history, truth, strict=False)])
    assert (history.on_stop & (history.sws < 0.0)).any()
    assert (history.on_stop & (history.sws > 0.0)).any()
    assert history.lifted.any()
    assert np.max(errors[0]) < 5e-3
    # Second order: half the step, a quarter of the error.
    assert np.linalg.norm(errors[1]) < 0.35 * np.linalg.norm(errors[0])


def test_half_the_step_changes_no_root_mean_square_by_a_thousandth():
    z = example.record(ss.Road.iso8608("C", speed=20.0, tracks="isotropic"), 5.0, seed=0)
    car, laws = ss.FullCar(ks=12536.0, cs=798.0), example.Laws()
    coarse = example.ride(car, z, example.STEP, laws)
    fine = example.ride(car, finer(z, 2), 0.5 * example.STEP, laws)
    assert coarse.on_stop.any()
    assert coarse.lifted.any()
    for a, b in zip(coarse[:3], fine[:3], strict=True):
        np.testing.assert_allclose(np.sqrt((a**2).mean(axis=1)), np.sqrt((b[:, ::2] ** 2).mean(axis=1)), rtol=1e-3)


# The table


def test_a_table_is_read_as_a_user_would(tmp_path, capsys):
    out = tmp_path / "runs.csv"
    example.main([*SHORT, "--out", str(out)])
    assert "3 runs, 0 of them found" in capsys.readouterr().err
    assert out.read_text().splitlines()[:2] == ["ks,cs,bacc,sws,dtl", "N/m,N s/m,m/s^2,m,N"]
    assert [path.name for path in tmp_path.iterdir()] == ["runs.csv"]
    table = np.loadtxt(out, delimiter=",", skiprows=2)
    z = example.record(ss.Road.iso8608("C", speed=20.0, tracks="isotropic"), 1.0, seed=0)
    for ks, cs, *measured in table:
        assert 12536.0 <= ks <= 24570.0
        assert 798.0 <= cs <= 2235.0
        history = example.ride(ss.FullCar(ks=ks, cs=cs), z, example.STEP, example.Laws())
        expected = [np.sqrt((values[0, -1000:] ** 2).mean()) for values in history[:3]]
        np.testing.assert_allclose(measured, expected, rtol=1e-8)
    third = np.digitize(table[:, :2], [12536.0 + 12034.0 / 3, 12536.0 + 2 * 12034.0 / 3])[:, 0]
    assert sorted(third) == [0, 1, 2]


def test_a_stopped_table_goes_on_to_the_same_file(tmp_path, capsys, monkeypatch):
    whole, stopped = tmp_path / "whole.csv", tmp_path / "stopped.csv"
    partial = tmp_path / "stopped.csv.partial"
    example.main([*SHORT, "--out", str(whole)])
    done = []

    def run(*arguments):
        if done:
            raise KeyboardInterrupt
        done.append(arguments)
        return untouched(*arguments)

    untouched = example.run
    monkeypatch.setattr(example, "run", run)
    assert call(*SHORT, "--out", stopped) == 130
    assert not stopped.exists()
    assert partial.read_text().splitlines()[1:] == whole.read_text().splitlines()[:3]
    monkeypatch.setattr(example, "run", untouched)

    capsys.readouterr()
    assert call(*SHORT, "--seed", "1", "--out", stopped) == 2
    assert capsys.readouterr().err.count("\n") == 1

    with partial.open("a") as file:
        file.write("17000.1,11")  # a line that a power cut left
    example.main([*SHORT, "--out", str(stopped)])
    assert "3 runs, 1 of them found" in capsys.readouterr().err
    assert stopped.read_bytes() == whole.read_bytes()
    assert not partial.exists()


@pytest.mark.parametrize(
    ("arguments", "named"),
    [
        (["--runs", "0"], "--runs: needs a whole number from 1 to 100000, got '0'"),
        (["--runs", "2.5"], "--runs"),
        (["--seed", "-1"], "--seed"),
        (["--duration", "nan"], "--duration: needs a number from 1 to 3600, got 'nan'"),
        (["--speed", "fast"], "--speed"),
        (["--road-class", "AB"], "--road-class"),
        (["--sampling", "grid"], "--sampling"),
        (["--run", "3"], "--run"),
        (["--out", "missing/runs.csv"], "missing/runs.csv"),
        (["--out", "there.csv"], "there.csv exists already"),
    ],
)
def test_wrong_input_gets_one_line(arguments, named, tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("there.csv").write_text("mine")
    assert call("--out", "runs.csv", *arguments) == 2
    said = capsys.readouterr()
    assert said.out == ""
    assert said.err.count("\n") == 1
    assert named in said.err
    assert Path("there.csv").read_text() == "mine"
    assert not Path("runs.csv.partial").exists()
