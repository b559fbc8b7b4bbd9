"""``susp-ss comfort``: it says what the library says, writes only where it is told, and refuses in one line."""

import json

import pytest

import susp_ss as ss


@pytest.fixture(autouse=True)
def here(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.mark.parametrize("point", ["driver=0.3,0.4", "driver:0.3:0.4"])
def test_it_equals_the_library(run, point):
    asked = f"--road-class C --speed 90km/h --point {point} --duration 4h --weighting bacc=Wb --cs 2000 --json"
    code, out, err = run("comfort", *asked.split())
    assert (code, err) == (0, "")
    said = json.loads(out)
    road = ss.Road.iso8608("C", speed=25.0, tracks="isotropic")
    weighting, points = {"bacc": "Wb"}, {"driver": (0.3, 0.4)}
    ride = ss.comfort(ss.FullCar(cs=2000.0), road, points=points, weighting=weighting, duration=14400.0)
    assert said["weightings"] == {"bacc": "Wb", "roll_acc": "We", "pitch_acc": "We"}
    assert said["points"] == {"driver": {"value": [0.3, 0.4], "unit": "m"}}
    assert said["vehicle"]["parameters"]["cs"] == {"value": 2000.0, "unit": "N s/m"}
    row = said["comfort"][-1]
    assert row["point"] == "driver"
    for name, data in ride.metrics.sel(point="driver").items():
        assert row[name] == (data.item() if name == "reaction" else pytest.approx(data.item())), name


def test_it_prints_the_report_and_writes_where_it_is_told(run, here):
    code, out, err = run("comfort", "--model", "quarter", "--out", "deep/folder")
    assert (code, err) == (0, "")
    assert out == ss.report(ss.comfort(ss.QuarterCar(), ss.DEFAULT_ROAD))
    written = {path.name for path in (here / "deep/folder").iterdir()}
    assert written == {"comfort.csv", "comfort.json", "comfort.png"}
    assert run("comfort", "--model", "quarter", "--out", "deep/folder").code == 2
    assert list(here.iterdir()) == [here / "deep"]


def test_a_profile_is_driven_over(run, here):
    profile = ss.synthesise(ss.Road(tracks="isotropic"), 60.0, 0.1, seed=1)
    profile.to_dataframe().to_csv(here / "road.csv")
    code, out, err = run("comfort", "--profile", "road.csv", "--speed", "36km/h", "--json")
    assert (code, err) == (0, "")
    ride = ss.comfort(ss.FullCar(), ss.read_profile(here / "road.csv"), speed=10.0)
    row = json.loads(out)["comfort"][0]
    for name in ("total", "mtvv", "vdv"):
        assert row[name] == pytest.approx(float(ride.metrics[name].sel(point="cg"))), name
    assert f"{ride.metrics.duration:.3g}" in json.loads(out)["ride"]


@pytest.mark.parametrize(
    ("line", "named"),
    [
        ("--weighting Wk", "--weighting must be OUTPUT=NAME, such as bacc=Wk"),
        ("--weighting bacc=Wx", "no weighting named 'Wx', available: Wk"),
        ("--weighting sws=Wk", "no acceleration named 'sws'"),
        ("--duration 0", "duration must be > 0 s"),
        ("--duration 8days", "no unit 'days' of time, available: s, ms, min, h"),
        ("--point driver", "--point must be NAME=X,Y"),
        ("--point driver:0.3,0.4", "--point must be NAME=X,Y"),
        ("--point driver=a,0.4", "--point: needs a number"),
        ("--profile none.csv", "none.csv: No such file"),
        (
            "--profile none.csv --road-class B",
            "--road-class describes a random road; beside --profile pass --speed alone",
        ),
        ("--profile none.csv --no-delay", "--delay describes a random road"),
        ("--model quarter --point driver=0.3,0.4", "moves as one point"),
    ],
)
def test_refused_in_one_line(run, line, named):
    code, out, err = run("comfort", *line.split())
    assert (code, out) == (2, "")
    assert named in err
    assert err.count("\n") == 1
