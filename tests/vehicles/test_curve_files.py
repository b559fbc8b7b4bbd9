"""Curves in vehicle files: what is written is what is read, and each wrong one has one clear line."""

import json

import numpy as np
import pytest

import susp_ss as ss
from susp_ss.vehicles.files import read_vehicle, vehicle_text

HEAD = 'model = "full"\n[parameters]\n'
TABLE = """velocity = { value = [-500, 0, 100, 500], unit = "mm/s" },
    force = { value = [-1.2, 0, 0.1, 0.3], unit = "kN" }""".replace("\n", "")
EQUAL = {
    f"cs = {{ {TABLE} }}": ss.DamperCurve([-0.5, 0.0, 0.1, 0.5], [-1200.0, 0.0, 100.0, 300.0]),
    'cs = { csv = "damper.csv" }': ss.DamperCurve([-0.5, 0.0, 0.1, 0.5], [-1200.0, 0.0, 100.0, 300.0]),
    'cs = { bump = 0.8, rebound = 2.4, unit = "kN s/m" }': ss.DamperCurve.two_slopes(800.0, 2400.0),
    'cs = { bump = 800, rebound = 2400, knee = { value = 200, unit = "mm/s" }, final = 0.3, unit = "N s/m" }': (
        ss.DamperCurve.digressive(800.0, 2400.0, 0.2, 0.3)
    ),
    'ks = { value = 18, stop = 150, bump = { value = 5, unit = "cm" }, rebound = { value = 60, unit = "mm" }, '
    'unit = "kN/m" }': ss.SpringCurve.with_stops(18e3, 150e3, 0.05, 0.06),
}


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "damper.csv").write_text("velocity,force\nmm/s,kN\n-500,-1.2\n0,0\n100,0.1\n500,0.3\n")
    return tmp_path


def written(folder, text):
    path = folder / "car.toml"
    path.write_text(text)
    return path


@pytest.mark.parametrize(("entry", "curve"), EQUAL.items())
def test_every_form(entry, curve, folder):
    read = read_vehicle(written(folder, HEAD + entry))
    again = read_vehicle(written(folder, vehicle_text(read)))
    x = np.linspace(-1.0, 1.0, 41)
    for car in (read, again):
        found = getattr(car, curve.field)
        np.testing.assert_allclose(found.force(x), curve.force(x), rtol=1e-9, atol=1e-9 * curve.rate)
    factored = ss.FullCar(**{curve.field: 1.5 * curve})
    np.testing.assert_allclose(
        getattr(read_vehicle(written(folder, vehicle_text(factored))), curve.field).force(x), 1.5 * curve.force(x)
    )


def test_curves_and_numbers_by_corner(folder):
    text = '[parameters.cs]\nfr = { csv = "damper.csv" }\nfl = { csv = "damper.csv" }\nrr = 1500\nrl = 1500\n'
    car = read_vehicle(written(folder, f'model = "full"\n{text}unit = "N s/m"\n'))
    assert isinstance(car.cs.fl, ss.DamperCurve)
    assert car.cs.rl == 1500.0
    half = read_vehicle(
        written(folder, f'model = "pitch-half"\n[parameters]\ncs = {{ f = {{ {TABLE} }}, r = {{ {TABLE} }} }}\n')
    )
    assert [type(x) for x in half.cs] == [ss.DamperCurve] * 2


WRONG = {
    'cs = { bump = 800, unit = "N s/m" }': "cs must have value, or one of these: csv; velocity, force; bump, rebound",
    "cs = { bump = 800, rebound = 2400 }": "cs.unit must be one of N s/m, N s/mm, kN s/m, lbf s/in, got none",
    'cs = { bump = "a", rebound = 2400, unit = "N s/m" }': "cs.bump must be a number, got 'a'",
    f"cs = {{ bump = {10**400}, rebound = 2, unit = 'N s/m' }}": "cs.bump must be a finite number, got one of 401",
    'cs = { bump = -1, rebound = 2400, unit = "N s/m" }': "must be >= 0 N s/m, got -1.0",
    'cs = { csv = "none.csv" }': "none.csv",
    "cs = { csv = 3 }": "cs.csv must be the name of a file, got 3",
    "cs = { velocity = [1, 2], force = [1, 2] }": 'cs.velocity must be { value = ..., unit = "m/s" }, got [1, 2]',
    f"cs = {{ {TABLE.replace('mm/s', 'knots')} }}": "cs.velocity.unit must be one of m/s, km/h, mph, mm/s, got 'knots'",
    f"cs = {{ {TABLE.replace('0.1', '0.4')} }}": "must not fall, got 300 after 400 N at entry 3",
    f"ks = {{ {TABLE} }}": "ks must have value, or one of these: csv; deflection, force; value, stop, bump, rebound",
    'ks = { csv = "damper.csv" }': "line 1 must name the columns deflection, force, got velocity, force",
}


@pytest.mark.parametrize(("entry", "said"), WRONG.items())
def test_each_wrong_one_has_one_line(entry, said, folder, run):
    answer = run("metrics", "--vehicle", written(folder, HEAD + entry))
    assert answer.code == 2
    assert said in answer.err
    assert answer.err.strip().count("\n") == 0
    assert "car.toml" in answer.err or "none.csv" in answer.err


def test_command_lines_of_curved_cars(folder, run):
    path = written(folder, HEAD + 'cs = { csv = "damper.csv" }')
    answer = run("metrics", "--vehicle", path, "--road-class", "C", "--json")
    assert answer.code == 0
    said = json.loads(answer.out)
    assert "ride_height_shift" in json.dumps(said)
    assert "statistically linearised" in json.dumps(said)
    text = run("metrics", "--vehicle", path, "--road-class", "C")
    assert "statistically linearised" in text.out
    refused = run("bode", "--vehicle", path)
    assert refused.code == 2
    assert "ss.linearised" in refused.err
