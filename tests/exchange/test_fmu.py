"""FMUs of others, for which a nonlinear quarter car in C stands, run as scipy and `simulate` say over the same road."""

import json
import re
import shutil
import subprocess
import sys
import zipfile
from pathlib import Path

import control
import fmpy
import numpy as np
import pytest
from scipy.integrate import solve_ivp

import susp_ss as ss
from susp_ss.exchange import running
from susp_ss.exchange.exporting import BINARIES, COMPILERS
from susp_ss.fit.histories import over_time
from susp_ss.responses.simulation import heights_under

SOURCE = Path(__file__).with_name("nonlinear_quarter.c")
ROAD = ss.Road.iso8608("C", speed=20.0)
INPUTS, OUTPUTS = {"ks": "k", "cs": "damper.bump"}, {"bacc": "acc", "sws": "travel", "dtl": "load"}
SHORT = {"duration": 3.0, "cut": 1.0, "step": 2e-3}

PARAMETERS = {"k": "N/mm", "damper.bump": "N.s/m", "damper.rebound": "N.s/m", "gap": "mm", "fault": ""}
STARTS = {"k": 18.553, "damper.bump": 1516.5, "damper.rebound": 1516.5, "gap": 1e3, "fault": 0.0}
MEASURED = {"acc": "m/s2", "travel": "mm", "load": "N"}


def unit(name):
    return f' unit="{name}"' if name else ""


def fmi2(kind):
    of_road = (
        '<ScalarVariable name="z_r" valueReference="0" causality="input"><Real start="0" unit="m"/></ScalarVariable>'
    )
    rows = [of_road]
    for i, (name, own) in enumerate(PARAMETERS.items(), start=1):
        real = f'<Real start="{STARTS[name]}"{unit(own)}/>'
        at = f'name="{name}" valueReference="{i}" causality="parameter" variability="tunable"'
        rows.append(f"<ScalarVariable {at}>{real}</ScalarVariable>")
    for i in range(4):
        rows.append(f'<ScalarVariable name="x{i}" valueReference="{6 + i}"><Real/></ScalarVariable>')
    for i in range(4):
        rows.append(
            f'<ScalarVariable name="dx{i}" valueReference="{10 + i}"><Real derivative="{7 + i}"/></ScalarVariable>'
        )
    for i, (name, own) in enumerate(MEASURED.items(), start=14):
        at = f'name="{name}" valueReference="{i}" causality="output"'
        rows.append(f"<ScalarVariable {at}><Real{unit(own)}/></ScalarVariable>")
    derivatives = "".join(f'<Unknown index="{11 + i}"/>' for i in range(4))
    outputs = "".join(f'<Unknown index="{15 + i}"/>' for i in range(3))
    units = "".join(f'<Unit name="{name}"/>' for name in {"m", *PARAMETERS.values(), *MEASURED.values()} if name)
    return f"""<?xml version="1.0"?>
<fmiModelDescription fmiVersion="2.0" modelName="car" guid="g" numberOfEventIndicators="0">
<{kind} modelIdentifier="car"/><UnitDefinitions>{units}</UnitDefinitions>
<ModelVariables>{"".join(rows)}</ModelVariables>
<ModelStructure><Outputs>{outputs}</Outputs><Derivatives>{derivatives}</Derivatives></ModelStructure>
</fmiModelDescription>"""


def fmi3():
    rows = ['<Float64 name="z_r" valueReference="0" causality="input" start="0"/>']
    for i, (name, own) in enumerate(PARAMETERS.items(), start=1):
        at = f'name="{name}" valueReference="{i}" causality="parameter" variability="tunable" start="{STARTS[name]}"'
        rows.append(f"<Float64 {at}{unit(own)}/>")
    for i, (name, own) in enumerate(MEASURED.items(), start=14):
        rows.append(f'<Float64 name="{name}" valueReference="{i}" causality="output"{unit(own)}/>')
    outputs = "".join(f'<Output valueReference="{14 + i}"/>' for i in range(3))
    return f"""<?xml version="1.0"?>
<fmiModelDescription fmiVersion="3.0" modelName="car" instantiationToken="g">
<CoSimulation modelIdentifier="car"/>
<ModelVariables><Float64 name="time" valueReference="99" causality="independent" variability="continuous"/>
{"".join(rows)}</ModelVariables><ModelStructure>{outputs}</ModelStructure>
</fmiModelDescription>"""


DESCRIPTIONS = {
    "co-simulation 2": fmi2("CoSimulation"),
    "model exchange 2": fmi2("ModelExchange"),
    "co-simulation 3": fmi3(),
}


@pytest.fixture(scope="module")
def library(tmp_path_factory):
    """The C source with functions that do nothing for whatever it leaves out, compiled."""
    compiler = next(filter(None, map(shutil.which, COMPILERS)), None)
    if compiler is None or fmpy.platform not in {folder for folder, _ in BINARIES.values()}:
        pytest.skip("no C compiler for this system to build an FMU with")
    folder = tmp_path_factory.mktemp("library")
    headers = Path(fmpy.__file__).parent / "c-code"
    types = "".join((headers / f"fmi{version}FunctionTypes.h").read_text() for version in (2, 3))
    asked = set(re.findall(r"\b(fmi[23][A-Z]\w+)TYPE\b", types))
    idle = asked - set(re.findall(r"EXPORT\((fmi\w+)\)", SOURCE.read_text()))
    (folder / "idle.c").write_text("\n".join(f"int {name}(void) {{ return 0; }}" for name in sorted(idle)))
    built = ["-O1", "-shared", "-fPIC", "-I", headers, SOURCE, "idle.c", "-o", "car.so", "-lm"]
    subprocess.run([compiler, *built], cwd=folder, check=True)
    return folder / "car.so"


@pytest.fixture
def fmu(library, tmp_path, monkeypatch):
    """Make an FMU of a kind, car.fmu, in the current folder."""
    monkeypatch.chdir(tmp_path)

    def make(kind="co-simulation 2"):
        folder = fmpy.platform_tuple if kind.endswith("3") else fmpy.platform
        with zipfile.ZipFile("car.fmu", "w") as file:
            file.writestr("modelDescription.xml", DESCRIPTIONS[kind])
            file.write(library, f"binaries/{folder}/car{fmpy.sharedLibraryExtension}")
        return Path("car.fmu")

    return make


def road_of(duration, cut, step):
    z = heights_under(ss.QuarterCar(), ROAD, duration, step, 0)[0]
    t = step * np.arange(len(z))
    return t, z * (0.5 - 0.5 * np.cos(np.pi * np.clip(2.0 * t / cut, 0.0, 1.0)))


@pytest.mark.parametrize("kind", DESCRIPTIONS)
def test_a_linear_model_has_the_metrics_of_simulate(kind, fmu):
    """Damper and stops are linear as long as only ``ks`` is set; its unit there is N/mm, of travel mm."""
    model = ss.FMU(fmu(kind), {"ks": "k"}, OUTPUTS, units={"ks": "N/mm", "sws": "mm"})
    runs = model.run({"ks": [16e3, 24e3]}, ROAD, **SHORT)
    t, z = road_of(**SHORT)
    for ks, found in zip(runs.designs.ks, runs.responses.to_dict("records"), strict=True):
        said = ss.simulate(ss.QuarterCar(ks=ks), z, t)
        for name, value in found.items():
            assert value == pytest.approx(over_time(name, t, said[name].values, SHORT["cut"]), rel=2e-3)
    assert (runs.row_word, runs.rows.tolist()) == ("run", [1, 2])
    assert runs.place(1, "ks") == "car.fmu, run 2, column 'k'"


def test_accelerations_pass_a_weighting(fmu):
    model, X = ss.FMU(fmu(), {"ks": "k"}, OUTPUTS), {"ks": [16e3, 24e3]}
    runs = model.run(X, ROAD, **SHORT, weighting="Wk", kept="runs.json")
    t, z = road_of(**SHORT)
    said = ss.simulate(ss.QuarterCar(ks=16e3), z, t)
    _, felt = control.forced_response(ss.weighting("Wk"), t, said.bacc.values)
    for name, values in (("bacc", felt), ("sws", said.sws.values)):
        assert runs.responses[name][0] == pytest.approx(over_time(name, t, values, SHORT["cut"]), rel=2e-3)
    assert runs.noted.endswith("about the mean from 1 s on, accelerations through Wk")
    with pytest.raises(ValueError, match=r"runs\.json: holds runs of another weighting, "):
        model.run(X, ROAD, **SHORT, kept="runs.json")
    with pytest.raises(ValueError, match="no weighting named 'Wx', available: Wk"):
        model.run(X, ROAD, **SHORT, weighting="Wx")


def test_a_nonlinear_model_has_those_of_scipy(fmu):
    """Harsh enough that stops are hit and the wheel lifts."""
    model = ss.FMU(fmu(), {**INPUTS, "gap": "gap"}, OUTPUTS)
    rough, how = ss.Road.iso8608("E", speed=20.0), {"duration": 2.0, "cut": 0.5, "step": 2e-3}
    design = {"ks": 15e3, "cs": 700.0, "gap": 30.0}
    runs = model.run(
        {name: [x] for name, x in design.items()} | {"ks": [15e3, 16e3], "cs": [7e2, 8e2], "gap": [3e1, 4e1]},
        rough,
        **how,
    )
    z = heights_under(ss.QuarterCar(), rough, how["duration"], how["step"], 0)[0]
    t = how["step"] * np.arange(len(z))
    z = z * (0.5 - 0.5 * np.cos(np.pi * np.clip(2.0 * t / how["cut"], 0.0, 1.0)))

    def outputs(time, x):
        travel, rate = x[0] - x[1], x[2] - x[3]
        damping = np.where(rate < 0.0, 700.0, 1516.5)
        stop = 2e5 * np.sign(travel) * np.maximum(np.abs(travel) - 0.03, 0.0)
        force = 15e3 * travel + damping * rate + stop
        load = np.maximum(192e3 * (np.interp(time, t, z) - x[1]), -(317.5 + 45.4) * 9.81)
        return -force / 317.5, travel, load

    def rate(time, x):
        acceleration, _, load = outputs(time, x)
        return [x[2], x[3], acceleration, (load - 317.5 * acceleration) / 45.4]

    x = solve_ivp(rate, (0.0, t[-1]), np.zeros(4), t_eval=t, max_step=1e-3, rtol=1e-6, atol=1e-8).y
    truth = dict(zip(OUTPUTS, outputs(t, x), strict=True))
    assert np.abs(truth["sws"]).max() > 0.03
    assert truth["dtl"].min() == -(317.5 + 45.4) * 9.81
    for name, y in truth.items():
        assert runs.responses[name][0] == pytest.approx(over_time(name, t, y, how["cut"]), rel=5e-3)


def test_failures_are_said_by_design_and_the_others_kept(fmu):
    model = ss.FMU(fmu(), {"ks": "k", "fault": "fault"}, {"bacc": "acc"})
    designs = {"ks": [15e3, 16e3, 17e3, 18e3, 19e3, 20e3], "fault": [0.0, 1.0, 2.0, 3.0, 4.0, 0.5]}
    with pytest.warns(UserWarning, match="failed") as warned:
        runs = model.run(designs, ROAD, kept="runs.json", **SHORT)
    assert (runs.rows.tolist(), runs.designs.ks.tolist()) == ([1, 6], [15e3, 20e3])
    said = "\n".join(sorted(str(one.message) for one in warned))
    assert re.search(r"car\.fmu, run 2 \(ks = 16000 N/m, fault = 1\) failed: FMICallException: .*all licences", said)
    assert "run 3 (ks = 17000 N/m, fault = 2) failed: the model crashed, signal 6" in said
    assert "run 4 (ks = 18000 N/m, fault = 3) failed: 'acc' is not finite from 0.502 s on" in said
    assert "run 5 (ks = 19000 N/m, fault = 4) failed: the model ended its process with code 7" in said
    assert runs.noted.startswith("car.fmu: 2 of 6 runs over 3 s, root mean squares about the mean from 1 s on")


def test_finished_runs_are_taken_up_again(fmu, monkeypatch):
    model = ss.FMU(fmu(), {"ks": "k"}, {"bacc": "acc"})
    first = model.run({"ks": [15e3, 16e3]}, ROAD, kept="runs.json", **SHORT)
    ran = []
    monkeypatch.setattr(running, "_outcome", lambda folder, drive, i, *_: ran.append(i) or {"bacc": 1.0})
    more = model.run({"ks": [16e3, 17e3, 15e3, 17e3]}, ROAD, kept="runs.json", **SHORT)
    assert ran == [1]
    assert more.responses.bacc.tolist() == [first.responses.bacc[1], 1.0, first.responses.bacc[0], 1.0]
    assert len(json.loads(Path("runs.json").read_text())["runs"]) == 3
    with pytest.raises(ValueError, match=r"runs\.json: holds runs of another seed, 0 in place of 1"):
        model.run({"ks": [15e3, 16e3]}, ROAD, kept="runs.json", seed=1, **SHORT)
    for wrong in ("{", "[]", '{"asked": {"inputs": 1}, "runs": [[[1], {}]]}'):
        Path("runs.json").write_text(wrong)
        with pytest.raises(ValueError, match=r"runs\.json: holds no runs of an FMU"):
            model.run({"ks": [15e3, 16e3]}, ROAD, kept="runs.json", **SHORT)


def test_a_vehicle_of_four_wheels_meets_tracks_and_delay(fmu, monkeypatch, tmp_path):
    """Our own export stands in: it has nothing to set, so that its inputs' start values do."""
    monkeypatch.chdir(tmp_path)
    car = ss.FullCar()
    ss.export(car, "full.fmu")
    road = ss.Road.iso8608("C", tracks="isotropic")
    with pytest.raises(ValueError, match="the variable 'ks_fr' cannot be set, it is constant local"):
        ss.FMU("full.fmu", {"ks": "ks_fr"}, {"bacc": "bacc_cg"})
    outputs = {"bacc_cg": "bacc_cg", "sws_rl": "sws_rl", "dtl_fr": "dtl_fr", "roll_acc": "roll_acc"}
    model = ss.FMU("full.fmu", {"gap": "z_r_fr"}, outputs)
    with pytest.raises(ValueError, match=r"inputs for the wheels 'fr', .* pass run"):
        model.run({"gap": [0.0]}, road)
    found = model.run({"gap": [0.0, 1.0]}, road, like=car, **SHORT).responses.iloc[0]
    z = heights_under(car, road, SHORT["duration"], SHORT["step"], 0)
    t = SHORT["step"] * np.arange(z.shape[1])
    said = ss.simulate(car, z * (0.5 - 0.5 * np.cos(np.pi * np.clip(2.0 * t / SHORT["cut"], 0.0, 1.0))), t)
    truth = {
        "bacc_cg": said.bacc.sel(point="cg"),
        "sws_rl": said.sws.sel(corner="rl"),
        "dtl_fr": said.dtl.sel(corner="fr"),
        "roll_acc": said.roll_acc,
    }
    for name, y in truth.items():
        assert found[name] == pytest.approx(over_time(name, t, y.values, SHORT["cut"]), rel=1e-6)


def test_what_an_fmu_does_not_have_is_said(fmu):
    path = fmu()
    for inputs, outputs, how, said in (
        ({"ks": "K"}, OUTPUTS, {}, r"car\.fmu: no variable 'K'; it has 'z_r', 'k', "),
        ({"ks": "damper.bum"}, OUTPUTS, {}, r"no variable 'damper\.bum'; did you mean 'damper\.bump'"),
        ({"ks": "acc"}, {"dtl": "load"}, {}, "the variable 'acc' cannot be set, it is continuous output"),
        ({"ks": "damper.bump"}, OUTPUTS, {}, r"ks is in one of N/m, .*, but 'damper\.bump' is in 'N\.s/m'"),
        ({"ks": "k"}, OUTPUTS, {"units": {"ks": "kg"}}, r"ks is in one of N/m, .*, but 'k' is in 'kg'"),
        ({"ks": "k"}, OUTPUTS, {"heights": {"": "k"}}, "the road needs an input, but 'k' is parameter"),
        ({"ks": "k"}, OUTPUTS, {"heights": {"": "zr"}}, "no variable 'zr'; did you mean 'z_r'"),
        ({"ks": "k"}, {"ks": "acc"}, {}, "ks is asked for as an input and as an output"),
    ):
        with pytest.raises(ValueError, match=said):
            ss.FMU(path, inputs, outputs, **how)


def test_what_cannot_be_run_is_said(fmu):
    model = ss.FMU(fmu(), {"ks": "k"}, OUTPUTS)
    for designs, road, how, said in (
        ({"cs": [1.0]}, ROAD, {}, "designs must have a column for each of ks, and rows; no column ks"),
        ({"ks": []}, ROAD, {}, "and rows; no row"),
        ({"ks": [1.0], "cs": [1.0]}, ROAD, {}, "designs have columns that are no input: cs"),
        ({"ks": [1.0, -1.0]}, ROAD, {}, "designs, run 2: ks must be finite and > 0, got -1.0"),
        ({"ks": ["soft"]}, ROAD, {}, "designs must be numbers in SI units"),
        (3.0, ROAD, {}, "designs must be a table"),
        ({"ks": [2e4]}, 20.0, {}, "road must be a Road"),
        ({"ks": [2e4]}, ss.Road(speed=[10.0, 20.0]), {}, "a road with one speed"),
        ({"ks": [2e4]}, ROAD, {"like": ss.FullCar()}, r"run\(like=\.\.\.\) must have the wheels of car\.fmu, '', got"),
        ({"ks": [2e4]}, ROAD, {"duration": 0.01}, r"run\(duration=\.\.\.\) must be at least 100 steps"),
        ({"ks": [2e4]}, ROAD, {"cut": 60.0}, r"run\(cut=\.\.\.\) must be >= 0 s and less than the duration of 60 s"),
        ({"ks": [2e4]}, ROAD, {"step": "1 ms"}, "step must be a number in s, got '1 ms'"),
        ({"ks": [2e4]}, ROAD, {"kept": "no/runs.json"}, "there is no folder no"),
        ({"ks": [2e4]}, ROAD, {"processes": 0}, "processes must be a whole number >= 1"),
    ):
        with pytest.raises((ValueError, TypeError, OSError), match=said):
            model.run(designs, road, **how)


def test_files_that_are_no_fmu_for_here(fmu, monkeypatch):
    path = fmu()
    with zipfile.ZipFile("other.fmu", "w") as file:
        file.writestr("modelDescription.xml", DESCRIPTIONS["co-simulation 2"])
        file.writestr("binaries/win32/car.dll", b"")
    with zipfile.ZipFile("old.fmu", "w") as file:
        file.writestr("modelDescription.xml", '<fmiModelDescription fmiVersion="1.0"/>')
    Path("text.fmu").write_text("no")
    for name, said in (
        ("other.fmu", "has no binary for .*, only win32; export it for this system"),
        ("text.fmu", r"text\.fmu: no FMU: "),
        ("old.fmu", r"old\.fmu: "),
    ):
        with pytest.raises(ValueError, match=said):
            ss.FMU(name, {"ks": "k"}, OUTPUTS)
    with pytest.raises(FileNotFoundError):
        ss.FMU("none.fmu", {"ks": "k"}, OUTPUTS)
    monkeypatch.setitem(sys.modules, "fmpy", None)
    with pytest.raises(ModuleNotFoundError, match=r"car\.fmu: an FMU needs fmpy, .* run .*\[fmu\]"):
        ss.FMU(path, {"ks": "k"}, OUTPUTS)


def test_fit_of_an_fmu_on_the_command_line(fmu, run, missing):
    fmu()
    missing("smt")  # without Kriging, which takes its time
    line = ["fit", "--fmu", "car.fmu", "--runs", 4, "--inputs", "k=ks", "--outputs", "acc=bacc"]
    line += ["--range", "ks=16N/mm:24N/mm", "--road-class", "C", "--duration", 3, "--cut", 1, "--weighting", "Wk"]
    code, out, err = run(*line, "--kept", "runs.json", "--json")
    assert code == 0, err
    assert (
        "car.fmu: 4 of 4 runs over 3 s, root mean squares about the mean from 1 s on, accelerations through Wk" in err
    )
    document = json.loads(out)
    assert (document["runs"], document["inputs"]) == (4, {"ks": "N/m"})
    assert len(json.loads(Path("runs.json").read_text())["runs"]) == 4
