"""The command line: it says what the library says, writes only where it is told, and refuses in one line."""

import csv
import dataclasses
import inspect
import io
import json
import os
import subprocess
import sys

import numpy as np
import pandas as pd
import pytest

import susp_ss as ss
from susp_ss.cli import main
from susp_ss.cli.options import vehicle_options
from susp_ss.quantities import typeset
from susp_ss.study.scan import scan_scenarios
from susp_ss.vehicles.files import models

pytestmark = pytest.mark.usefixtures("few_runs")

ROAD = ss.DEFAULT_ROAD


@pytest.fixture(autouse=True)
def here(tmp_path, monkeypatch):
    """Run in an empty folder, on a terminal too narrow for the tables: no number may be cut short for it."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", "40")
    return tmp_path


@pytest.fixture
def answer(run):
    """Run a command line that must succeed quietly; return stdout."""

    def ran(*arguments):
        code, out, err = run(*arguments)
        assert (code, err) == (0, "")
        return out

    return ran


def as_json(dataset):
    """Metrics as ``--json`` lays them out."""
    layout = {}
    for name, data in dataset.items():
        numbers = [x if np.isfinite(x) else str(x) for x in np.atleast_1d(data.values).tolist()]
        layout[name] = dict(zip(data[data.dims[0]].values.tolist(), numbers, strict=True)) if data.dims else numbers[0]
    return layout


@pytest.mark.parametrize(("encoding", "unit"), [("utf-8", "m/s²"), ("cp1250", "m/s^2")])
def test_units_are_spelt_out_where_the_terminal_has_no_superscripts(encoding, unit, monkeypatch):
    written = io.BytesIO()
    monkeypatch.setattr(sys, "stdout", io.TextIOWrapper(written, encoding))
    with pytest.raises(SystemExit) as end:
        main(["metrics", "--model", "quarter"])
    sys.stdout.flush()
    assert end.value.code == 0
    assert f" {unit} " in written.getvalue().decode(encoding)


METRICS = {
    "default": ("", ss.FullCar(), ROAD, {}),
    "full": ("--model full --ks 18000 --cs 1500", ss.FullCar(ks=18e3, cs=1500.0), ROAD, {}),
    "bars": ("--arb-front 2e4 --arb-rear 1e4", ss.FullCar(arb_front=2e4, arb_rear=1e4), ROAD, {}),
    "quarter": ("--model quarter --ms 300", ss.QuarterCar(ms=300.0), ROAD, {}),
    "rigid tyre, infinite": ("--model rigid-tyre", ss.RigidTyreQuarterCar(), ROAD, {}),
    "pitch half": ("--model pitch-half --a 1.0", ss.PitchHalfCar(a=1.0), ROAD, {}),
    "roll half": ("--model roll-half --arb 15e3", ss.RollHalfCar(arb=15e3), ROAD, {}),
    "road": (
        "--road-class C --speed 30 --tracks isotropic --no-delay --cutoff 0.01 --wheels fr,fl",
        ss.FullCar(),
        ss.Road.iso8608("C", speed=30.0, tracks="isotropic", delay=False, cutoff=0.01, wheels=("fr", "fl")),
        {},
    ),
    "spectral": (
        "--model quarter --roughness 1e-4 --waviness 2.3 --method spectral",
        ss.QuarterCar(),
        ss.Road(roughness=1e-4, waviness=2.3, tracks="isotropic"),
        {"method": "spectral"},
    ),
    "time": (
        "--model quarter --method time --duration 20 --seed 3",
        ss.QuarterCar(),
        ROAD,
        {"method": "time", "duration": 20.0, "seed": 3},
    ),
}


@pytest.mark.parametrize(("line", "vehicle", "road", "options"), METRICS.values(), ids=METRICS.keys())
def test_metrics_equal_the_library(line, vehicle, road, options, answer):
    document = json.loads(answer("metrics", "--json", *line.split()), parse_constant=pytest.fail)
    expected = ss.ride_metrics(vehicle, road, **options)
    assert document["metrics"] == as_json(expected)
    assert document["units"] == {name: data.attrs["units"] for name, data in expected.items()}
    assert document["method"] == options.get("method", "covariance")
    assert document["road"]["description"] == road.describe()
    own = {name: entry["value"] for name, entry in document["vehicle"]["parameters"].items()}
    assert own == dataclasses.asdict(vehicle)


@pytest.mark.parametrize("model", models())
def test_metrics_table(model, answer):
    table = answer("metrics", "--model", model)
    for name, data in ss.ride_metrics(models()[model](), ROAD).items():
        (row,) = (line for line in table.splitlines() if line.startswith(f"│ {name} "))
        cells = [cell.strip() for cell in row.strip("│").split("│")]
        assert cells[1] == typeset(data.attrs["units"])
        assert [cell for cell in cells[2:] if cell] == [f"{value:.4g}" for value in np.atleast_1d(data.values)]
    assert typeset(ROAD.describe()) in table


def test_every_parameter_has_an_option():
    settings = {name for car in models().values() for name in car.settings()}
    # The speed of a car that moves is the road's.
    others = {"model", "vehicle", "trust_units"}
    assert settings - {"speed"} | others <= set(inspect.signature(vehicle_options()).parameters)


@pytest.mark.parametrize("model", models())
def test_template_round_trips(model, answer, here):
    option = "--cs-front" if model == "three-axle" else "--cs"
    template = answer("metrics", "--model", model, option, "1700", "--template")
    (here / "car.toml").write_text(template)
    assert answer("metrics", "--vehicle", "car.toml", "--template") == template
    assert answer("metrics", "--vehicle", "car.toml") == answer("metrics", "--model", model, option, "1700")


def test_options_override_the_file(answer, here):
    (here / "car.toml").write_text('model = "quarter"\n[parameters]\nks = { value = 20.0, unit = "kN/m" }\n')
    document = json.loads(answer("metrics", "--vehicle", "car.toml", "--cs", "1200", "--json"))
    assert document["metrics"] == as_json(ss.ride_metrics(ss.QuarterCar(ks=20e3, cs=1200.0), ROAD))


CURVES = ["--output", "bacc_cg,sws_rr", "--output", "pitch_acc", "--input", "z_r_fl", "--input", "z_r_rr"]


def test_bode_equals_the_library(answer, here):
    grid = ["--from", "0.2", "--to", "20", "--points", "60"]
    document = json.loads(answer("bode", *CURVES, *grid, "--out", "deep/folder", "--json"))
    f = np.geomspace(0.2, 20.0, 60)
    expected = ss.frequency_response(ss.FullCar(), f)
    with open(here / "deep/folder/bode.csv", newline="", encoding="utf-8") as file:
        header, *rows = csv.reader(file)
    columns = np.array(rows, dtype=float).T
    assert header[:3] == ["frequency (Hz)", "|bacc_cg/z_r_fl| (m/s^2/m)", "phase bacc_cg/z_r_fl (deg)"]
    np.testing.assert_array_equal(columns[0], f)
    assert document["frequency"] == {"unit": "Hz", "values": f.tolist()}
    assert [(curve["output"], curve["input"]) for curve in document["responses"]] == [
        (output, input) for output in ("bacc_cg", "sws_rr", "pitch_acc") for input in ("z_r_fl", "z_r_rr")
    ]
    for curve, magnitude, phase in zip(document["responses"], columns[1::2], columns[2::2], strict=True):
        H = expected.sel(output=curve["output"], input=curve["input"]).values
        np.testing.assert_array_equal(curve["magnitude"]["values"], magnitude)
        np.testing.assert_array_equal(curve["phase"]["values"], phase)
        np.testing.assert_allclose(magnitude * np.exp(1j * np.radians(phase)), H, rtol=1e-12)
        assert np.abs(np.diff(phase)).max() <= 180.0
    assert (here / "deep/folder/bode.png").read_bytes().startswith(b"\x89PNG")
    assert sorted(path.name for path in (here / "deep/folder").iterdir()) == ["bode.csv", "bode.png"]


def test_bode_peaks(answer):
    table = answer("bode", "--model", "quarter", "--points", "4000")
    rows = [[cell.strip() for cell in line.strip("│").split("│")] for line in table.splitlines() if line[0] == "│"]
    hop = [float(row[3]) for row in rows if row[0] == "bacc"]
    H = ss.frequency_response(ss.QuarterCar(), np.geomspace(5.0, 20.0, 20000)).sel(output="bacc", input="z_r")
    assert hop[-1] == pytest.approx(float(H.frequency[int(np.abs(H.values).argmax())]), rel=5e-3)
    assert {row[0]: row[2] for row in rows} == {"bacc": "m/s²/m", "sws": "m/m", "dtl": "N/m"}


def test_psd_equals_the_library(answer, here):
    grid = ["--from", "0.01", "--to", "100", "--points", "900"]
    rows = ["--output", "bacc_driver,roll_acc", "--output", "sws_rr"]
    more = ["--point", "driver=0.3,0.4", "--weighting", "bacc=Wk", "--speed", "15", "--cs", "1800"]
    document = json.loads(answer("psd", *rows, *grid, *more, "--out", "out", "--json"))
    f, road = np.geomspace(0.01, 100.0, 900), ss.Road.iso8608("B", speed=15.0, tracks="isotropic")
    car = ss.FullCar(cs=1800.0).with_points({"driver": (0.3, 0.4)})
    expected = ss.psd(car, road, f)
    with open(here / "out/psd.csv", newline="", encoding="utf-8") as file:
        header, *lines = csv.reader(file)
    columns = np.array(lines, dtype=float).T
    assert header == [
        "frequency (Hz)",
        "bacc_driver ((m/s^2)^2/Hz)",
        "roll_acc ((rad/s^2)^2/Hz)",
        "sws_rr (m^2/Hz)",
    ]
    ride = ss.ride_metrics(car, road, weighting={"bacc": "Wk"})
    rms = [ride.bacc.sel(point="driver"), ride.roll_acc, ride.sws.sel(corner="rr")]
    assert [one.get("weighting") for one in document["spectra"]] == ["Wk", None, None]
    for one, column, metric in zip(document["spectra"], columns[1:], rms, strict=True):
        W = np.abs(ss.weighting("Wk")(2j * np.pi * f)) ** 2 if "weighting" in one else 1.0
        np.testing.assert_array_equal(one["values"], column)
        np.testing.assert_allclose(column, W * expected.sel(output=one["output"]), rtol=1e-10)
        assert one["rms"]["value"] == pytest.approx(metric.item(), rel=2e-3)
    assert (here / "out/psd.png").read_bytes().startswith(b"\x89PNG")


def test_psd_peaks(answer):
    table = answer("psd", "--model", "quarter", "--weighting", "Wk")
    rows = [[cell.strip() for cell in line.strip("│").split("│")] for line in table.splitlines() if line[0] == "│"]
    assert [row[:3] for row in rows if row[0]] == [["bacc", "Wk", "m/s²"], ["sws", "", "m"], ["dtl", "", "N"]]
    hop = ss.psd(ss.QuarterCar(), ROAD, np.geomspace(5.0, 20.0, 4000)).sel(output="dtl").idxmax("frequency").item()
    assert any(float(row[4]) == pytest.approx(hop, rel=0.02) for row in rows)


def test_bode_keeps_results_unless_forced(run, answer, here):
    folder = here / "out"
    answer("bode", "--out", "out")
    (folder / "mine.txt").write_text("keep")
    before = {path.name: path.read_bytes() for path in folder.iterdir()}
    code, out, err = run("bode", "--out", "out", "--ks", "30000")
    assert (code, out) == (2, "")
    assert err == (
        "susp-ss: error: --out out holds results already (bode.csv, bode.png); pass --force to replace them\n"
    )
    assert {path.name: path.read_bytes() for path in folder.iterdir()} == before
    answer("bode", "--out", "out", "--ks", "30000", "--force")
    after = {path.name: path.read_bytes() for path in folder.iterdir()}
    assert after.keys() == before.keys()
    assert [name for name in before if before[name] == after[name]] == ["mine.txt"]


SMALL = ["study", "--nodes", "5", "--corner", "rl", "--nonnegative", "--speed", "15", "--tracks", "identical"]


@pytest.fixture(scope="module")
def small():
    return ss.feasibility_study(
        ss.Road.iso8608("B", speed=15.0), corner="rl", nodes=(5, 5), nonnegative=True
    ).comparison()


def test_study_equals_the_library(answer, small, here):
    document = json.loads(answer(*SMALL, "--json"), parse_constant=pytest.fail)
    for row in small.itertuples():
        entry = document["tables"][row.surrogate][row.criterion][row.quantity]
        assert entry["ours"] == pytest.approx(row.ours, rel=1e-9, nan_ok=True)
        assert entry["unit"] == row.unit
    assert list(here.iterdir()) == []


def test_study_prints_ours_beside_published(answer, small):
    report = answer(*SMALL)
    for table in ("Table 3", "Table 4", "Table 5"):
        assert table in report
    (masses,) = (line.split()[-6:] for line in report.splitlines() if line.startswith("Ms, kg"))
    rows = small[small.quantity == "ms"]
    assert [float(x) for x in masses[::2]] == pytest.approx(rows.ours.tolist(), rel=1e-4)
    assert [float(x) for x in masses[1::2]] == rows.published.tolist()


def test_study_default_road(answer):
    """The study's own scenario, not the default road of the other commands."""
    report = answer("study", "--nodes", "3")
    assert typeset(ss.feasibility_study(nodes=(3, 3)).describe()) in report


def test_study_keeps_results_unless_forced(run, answer, here):
    answer(*SMALL, "--out", "out", "--no-figures")
    files = {"report.html", "responses.nc", "tables.csv", "tables.json"}
    assert {path.name for path in (here / "out").iterdir()} == files
    before = {name: (here / "out" / name).read_bytes() for name in files}
    code, out, err = run("study", "--nodes", "3", "--out", "out", "--no-figures")
    assert (code, out) == (2, "")
    assert err.startswith("susp-ss: error: --out out holds results already")
    assert {name: (here / "out" / name).read_bytes() for name in files} == before
    answer("study", "--nodes", "3", "--out", "out", "--no-figures", "--force")
    assert json.loads((here / "out" / "tables.json").read_text())["scenario"]["nodes"] == [3, 3]


@pytest.fixture
def few_scenarios(monkeypatch):
    """A scan of two roads."""
    for name, value in {"EXCITED": {"all wheels": None}, "TRACKS": ("isotropic",), "SPEEDS": (20.0,)}.items():
        monkeypatch.setattr(f"susp_ss.study.scan.{name}", value)
    monkeypatch.setattr("susp_ss.study.scan.CUTOFFS", (0.0,))
    monkeypatch.setattr("susp_ss.study.scan.OTHERS", ())


def test_scan_equals_the_library(answer, few_scenarios, here):
    scan = scan_scenarios((4, 4))
    expected = scan.scenarios
    printed = json.loads(
        answer("study", "--scan", "--nodes", "4", "--json", "--out", "out"), parse_constant=pytest.fail
    )
    saved = pd.read_csv(here / "out" / "scan.csv", keep_default_na=False)
    assert (here / "out" / "scan.png").read_bytes().startswith(b"\x89PNG")
    for rows in (pd.DataFrame(printed), saved):
        assert len(rows) == len(expected) > 10
        np.testing.assert_allclose(rows["distance"], expected["distance"], rtol=1e-9)
        assert rows["place"].tolist() == expected["place"].tolist()
    assert answer("study", "--scan", "--nodes", "4") == ss.report(scan)


# What is typed, and what the one line must name.
REFUSED = {
    "no such command": ("drive", "drive"),
    "no such option": ("metrics --stiffness 3", "--stiffness"),
    "argument without option": ("metrics car.toml", "car.toml"),
    "option without value": ("metrics --ks", "--ks"),
    "text for a number": ("metrics --ks soft", "--ks"),
    "negative stiffness": ("metrics --ks -1", "--ks must be > 0 N/m, got -1.0"),
    "NaN": ("metrics --kt nan", "--kt"),
    "infinite mass": ("metrics --mb inf", "--mb"),
    "negative damping": ("metrics --cs -5", "--cs"),
    "no damping": ("metrics --cs 0", "cs > 0"),
    "field of another model": ("metrics --model quarter --mb 900", "--mb: QuarterCar", "ms, mu, ks, cs, kt, ct"),
    "bar of another model": ("bode --arb-front 1 --model roll-half", "--arb-front: RollHalfCar"),
    "unknown model": ("metrics --model truck", "'truck'", "full, quarter, quarter-seat, rigid-tyre"),
    "model and file": ("metrics --model full --vehicle quarter.toml", "--model full", "'quarter'"),
    "file missing": ("metrics --vehicle none.toml", "none.toml: No such file"),
    "file is a folder": ("metrics --vehicle .", ".: Is a directory"),
    "file malformed": ("metrics --vehicle bad.toml", "bad.toml: not TOML", "line 1, column 9"),
    "value in file": ("bode --vehicle heavy.toml", "heavy.toml", "ms.unit", "kg, t"),
    "unknown class": ("metrics --road-class Z", "A, B, C, D, E, F, G, H", "'Z'"),
    "class and roughness": ("metrics --road-class B --roughness 1e-5", "--road-class and --roughness"),
    "negative roughness": ("metrics --roughness -1", "--roughness"),
    "speed 0": ("metrics --speed 0", "--speed"),
    "negative cut-off": ("metrics --cutoff -1", "--cutoff"),
    "unknown tracks": ("metrics --tracks parallel", "identical, independent, isotropic"),
    "unknown wheel": ("metrics --wheels rear", "no wheel named 'rear'"),
    "no wheel": ("metrics --wheels ,", "--wheels"),
    "unbounded warp": ("metrics --wheels fr", "warp"),
    "weighting": ("metrics --weighting Wx", "no weighting named 'Wx'", "Wk"),
    "output of a weighting": ("metrics --weighting roll=We", "no output named 'roll'", "roll_acc"),
    "two weightings": ("metrics --weighting Wk,Wd", "is for bacc, pitch_acc and roll_acc", "bacc=Wk"),
    "point": ("metrics --point driver", "--point must be NAME=X,Y", "driver"),
    "knee": ("metrics --knee 0.2", "--knee needs two exponents", "2:1.5"),
    "three exponents": ("metrics --waviness 2:3:2", "one exponent, or two", "2:3:2"),
    "unknown method": ("metrics --method guess", "covariance, spectral, time"),
    "seed without record": ("metrics --seed 1", "--seed", "--method time"),
    "duration without record": ("metrics --duration 9 --method spectral", "--duration", "--method time"),
    "no record": ("metrics --method time --duration 0", "duration"),
    "negative seed": ("metrics --method time --seed -1", "seed"),
    "frequency 0": ("bode --from 0", "--from"),
    "no span": ("bode --from 5 --to 5", "--from and --to"),
    "endless span": ("bode --to inf", "--to"),
    "NaN frequency": ("bode --from nan", "--from"),
    "one point": ("bode --points 1", "--points"),
    "unknown output": ("bode --output bacc", "no output named 'bacc'", "bacc_cg"),
    "no output": ("bode --output ,", "--output names none", "bacc_cg"),
    "no input": ("bode --input ,", "--input names none", "z_r_fr"),
    "empty class": ("metrics --road-class=", "A, B, C, D, E, F, G, H", "''"),
    "unknown input": ("bode --input z_r", "no input named 'z_r'", "z_r_fr"),
    "unknown output of psd": ("psd --output bacc", "no output named 'bacc'", "bacc_cg"),
    "unknown weighting of psd": ("psd --weighting Wx", "no weighting named 'Wx'"),
    "no span of psd": ("psd --from 5 --to 5", "--from and --to"),
    "point of a quarter car": ("psd --model quarter --point driver=0,0", "moves as one point"),
    "folder is a file": ("bode --out bad.toml", "--out bad.toml is a file"),
    "folder in a file": ("bode --out bad.toml/out", "bad.toml"),
    "empty grid": ("study --nodes 1", "nodes"),
    "study at no corner": ("study --corner rear", "no corner named 'rear'"),
    "study on no class": ("study --road-class Z --out out", "A, B, C, D, E, F, G, H"),
    "study on no road": ("study --speed -3", "--speed"),
    "scan on one road": ("study --scan --speed 20", "--speed", "--scan"),
    "scan without delay": ("study --scan --no-delay", "--delay", "--scan"),
    "scan on an empty grid": ("study --scan --nodes 1", "nodes"),
    "scan into a file": ("study --scan --out bad.toml", "--out bad.toml is a file"),
    "study into a file": ("study --nodes 4 --no-figures --out bad.toml", "--out bad.toml is a file"),
}


@pytest.mark.parametrize(("line", "named"), [(row[0], row[1:]) for row in REFUSED.values()], ids=REFUSED.keys())
def test_refused_in_one_line(line, named, run, here):
    (here / "bad.toml").write_text("model = full")
    (here / "quarter.toml").write_text('model = "quarter"')
    (here / "heavy.toml").write_text('model = "quarter"\n[parameters]\nms = { value = 1.0, unit = "stone" }\n')
    before = sorted(here.iterdir())
    code, out, err = run(*line.split())
    assert (code, out) == (2, "")
    assert err.startswith("susp-ss: error: ")
    assert err.count("\n") == 1
    for part in named:
        assert part in err
    assert sorted(here.iterdir()) == before
    assert (here / "bad.toml").read_text() == "model = full"


def test_the_line_is_one_line(run):
    code, _, err = run("metrics", "--vehicle", "two\nlines.toml")
    assert (code, err) == (2, "susp-ss: error: two lines.toml: No such file or directory\n")


def test_warnings_are_said_once_in_one_line(run):
    """With the wheels of the other side alone on the road, the best quarter car is as light as it may be."""
    code, out, err = run("study", "--nodes", "3", "--wheels", "fr,rr", "--corner", "fl")
    lines = err.splitlines()
    assert code == 0
    assert "Table 5" in out
    assert len(lines) == len(set(lines)) > 0
    assert all(line.startswith("susp-ss: warning: the tuned parameter 63.5 sits on its lower bound") for line in lines)


@pytest.mark.parametrize("error", [ValueError, TypeError, KeyError, ZeroDivisionError])
def test_a_bug_keeps_its_traceback(error, monkeypatch, capsys):
    """Only what the package itself refuses becomes a line: not a ValueError out of another library."""

    def broken(*_, **__):
        raise error("deep inside")

    monkeypatch.setattr(ss, "ride_metrics", broken)
    with pytest.raises(error, match="deep inside"):
        main(["metrics"])
    assert capsys.readouterr().err == ""


@pytest.mark.parametrize("command", ["study", "metrics", "bode", "psd"])
def test_help_states_units(command, answer):
    words = answer(command, "--help")
    assert "m/s" in words
    assert "--json" in words


def test_nothing_is_written_unasked(answer, here):
    answer("metrics", "--json")
    answer("bode")
    answer("bode", "--json")
    answer("psd", "--json")
    assert list(here.iterdir()) == []


def process(*arguments, **options):
    command = [sys.executable, "-c", "from susp_ss.cli import main; main()", *arguments]
    environment = {**os.environ, "COLUMNS": "100"}
    return subprocess.run(command, capture_output=True, text=True, env=environment, **options)


def test_process_answers():
    done = process("metrics", "--model", "quarter", "--json")
    assert (done.returncode, done.stderr) == (0, "")
    assert json.loads(done.stdout)["metrics"] == as_json(ss.ride_metrics(ss.QuarterCar(), ROAD))


def test_process_refuses():
    done = process("metrics", "--speed", "0")
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr == "susp-ss: error: --speed must be > 0 m/s, got 0.0\n"


@pytest.mark.parametrize("arguments", [[], ["--help"], ["--version"], ["metrics", "--help"]])
def test_help_loads_no_numerical_library(arguments):
    script = (
        "import sys, atexit; from susp_ss.cli import main; heavy = {'numpy', 'xarray', 'control', 'matplotlib'}; "
        f"atexit.register(lambda: print(sorted(heavy & set(sys.modules)))); main({arguments!r})"
    )
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True)
    assert done.returncode == 0
    assert done.stdout.splitlines()[-1] == "[]"
    assert len(done.stdout.splitlines()) > 1


def test_a_measured_spectrum(run, tmp_path):
    table = "# a survey\nn;G\n\n0,01;6,4e-3\n0,2;1,6e-5\n1;9e-7\n"
    (tmp_path / "road.csv").write_text(table, encoding="utf-8")
    code, out, _ = run("metrics", "--model", "quarter", "--spectrum", tmp_path / "road.csv", "--json")
    road = ss.Road.from_psd([0.01, 0.2, 1.0], [6.4e-3, 1.6e-5, 9e-7], tracks="isotropic")
    assert code == 0
    assert json.loads(out)["metrics"]["bacc"] == float(ss.ride_metrics(ss.QuarterCar(), road).bacc)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("", "road.csv: wavenumber must be two or more finite numbers > 0 cycle/m"),
        ("0.1,0\n1,1e-6\n", "road.csv: psd must be two or more finite numbers > 0 m^3"),
        ("1,1e-6\n0.1,1e-5\n", "road.csv: needs rising wavenumbers"),
        ("0.1,1e-6,3\n", "road.csv, line 1: needs two columns, n (cycle/m) and G_d (m^3), got 3"),
        ("# survey\n\nn;G\n0.1;1e-5\n0,2;1e-5\n", "road.csv, line 5: 0,2 is written with a decimal comma, but"),
        ("1.000;2.100\n2.000;1.200\n", "road.csv, line 1: 1.000 may be 1 or 1000, and no other cell tells"),
        ("n,G\n0.1,x\n", "road.csv, line 2: needs a number"),
    ],
)
def test_what_is_no_spectrum(run, tmp_path, text, said):
    (tmp_path / "road.csv").write_text(text, encoding="utf-8")
    code, out, err = run("metrics", "--spectrum", tmp_path / "road.csv")
    assert (code, out, err.count("\n")) == (2, "", 1)
    assert said in err
