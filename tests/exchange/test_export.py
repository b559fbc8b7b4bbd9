"""Exported vehicles run in C as `simulate` and python-control say, by both kinds of FMI, in steps of any length."""

import ctypes
import itertools
import shutil
import subprocess
import zipfile

import control as ct
import fmpy
import numpy as np
import pytest
from fmpy.fmi1 import FMICallException
from fmpy.fmi2 import FMU2Model, FMU2Slave
from fmpy.validation import validate_fmu
from scipy.integrate import solve_ivp
from scipy.io import loadmat

import susp_ss as ss
from models import VEHICLES
from susp_ss.exchange import exporting
from susp_ss.quantities import signal
from susp_ss.vehicles.system_files import read_system

PLANT = ss.QuarterCar(cs=750.0).state_space(input="velocity", actuators=True)
LAW = ct.ss([-0.6], [1.0], [-1500.0], [0.0], inputs="bacc", outputs="u")
LOOP = ct.interconnect([PLANT, LAW], inputs="dz_r", outputs=PLANT.output_labels)

BY_HEIGHT = {
    "full": VEHICLES["full, unequal corners"],
    "quarter": ss.QuarterCar(),
    "truck": ss.ThreeAxleTruck(),
    "steered": ss.RideHandlingCar(relaxation=0.3),
    "closed loop": ss.LinearVehicle(LOOP, like=ss.QuarterCar(cs=750.0)),
}
BY_RATE = {"rigid_tyre": ss.RigidTyreQuarterCar(), "pitch": VEHICLES["pitch half, unequal ends"]}
CARS = BY_HEIGHT | BY_RATE

T = np.linspace(0.0, 1.0, 101)


def waves(car):
    """Heights, or rates, that begin neither at zero nor at rest; then steering angles and torques from zero."""
    heights = 0.02 * np.cos(np.outer(np.linspace(3.0, 40.0, len(car.wheels)), T) + 0.3)
    controls = np.outer([0.02 if name.startswith("delta") else 50.0 for name in car.layout().controls], np.sin(4.0 * T))
    return np.vstack([heights, controls])


@pytest.fixture(scope="module")
def fmus(tmp_path_factory):
    if not any(map(shutil.which, exporting.COMPILERS)) or fmpy.platform not in dict(exporting.BINARIES.values()):
        pytest.skip("no C compiler for this system to run an FMU with")
    folder = tmp_path_factory.mktemp("fmus")
    return {name: ss.export(car, folder / f"{name}.fmu") for name, car in CARS.items()}


class Instance:
    """An FMU of one kind, by the names of its variables."""

    def __init__(self, path, kind, folder):
        self.about = fmpy.read_model_description(path)
        self.at = {v.name: v.valueReference for v in self.about.modelVariables}
        self.inputs = [v.name for v in self.about.modelVariables if v.causality == "input"]
        self.outputs = [u.variable.name for u in self.about.outputs]
        self.fmu = kind(
            guid=self.about.guid,
            unzipDirectory=fmpy.extract(path, folder),
            modelIdentifier=self.about.modelExchange.modelIdentifier,
            instanceName="car",
        )
        self.fmu.instantiate()

    def start(self, u):
        self.fmu.setupExperiment()
        self.fmu.enterInitializationMode()
        self.set(u)
        self.fmu.exitInitializationMode()

    def set(self, u):
        self.fmu.setReal([self.at[name] for name in self.inputs], list(u))

    def get(self):
        return np.array(self.fmu.getReal([self.at[name] for name in self.outputs]))

    def slopes(self, u):
        n = len(u)
        references = (ctypes.c_uint32 * n)(*(self.at[name] for name in self.inputs))
        first, values = (ctypes.c_int * n)(*[1] * n), (ctypes.c_double * n)(*u)
        self.fmu.fmi2SetRealInputDerivatives(self.fmu.component, references, n, first, values)


def by_steps(path, u, folder):
    """Co-simulation of inputs that are linear between samples."""
    car = Instance(path, FMU2Slave, folder)
    car.start(u[:, 0])
    found, h = [car.get()], T[1]
    for i, t in enumerate(T[:-1]):
        car.set(u[:, i])
        car.slopes((u[:, i + 1] - u[:, i]) / h)
        car.fmu.doStep(t, h)
        found.append(car.get())
    car.fmu.freeInstance()
    return dict(zip(car.outputs, np.transpose(found), strict=True))


def by_derivatives(path, u, folder):
    """Model exchange of the same inputs, integrated by scipy from sample to sample."""
    car = Instance(path, FMU2Model, folder)
    car.start(u[:, 0])
    car.fmu.enterContinuousTimeMode()
    n = len(car.about.derivatives)
    x, dx = (ctypes.c_double * n)(), (ctypes.c_double * n)()
    car.fmu.getContinuousStates(x, n)

    def rate(t, state):
        x[:] = state
        car.fmu.setTime(t)
        car.fmu.setContinuousStates(x, n)
        car.set([np.interp(t, T, row) for row in u])
        car.fmu.getDerivatives(dx, n)
        return list(dx)

    found = [car.get()]
    for start, end in itertools.pairwise(T):
        after = solve_ivp(rate, (start, end), list(x), method="DOP853", rtol=1e-9, atol=1e-12).y[:, -1]
        rate(end, after)
        found.append(car.get())
    car.fmu.freeInstance()
    return dict(zip(car.outputs, np.transpose(found), strict=True))


def expected(name):
    """What the package or python-control says of the same inputs, by the names of outputs."""
    car = CARS[name]
    u = waves(car)
    if name in BY_RATE:
        system = car.state_space(input="velocity")
        return u, dict(zip(system.output_labels, ct.forced_response(system, T, u, 0.0).outputs, strict=True))
    wheels, controls = len(car.wheels), car.layout().controls
    said = ss.simulate(car, u[:wheels], T, inputs=dict(zip(controls, u[wheels:], strict=True)) if controls else None)
    return u, {
        signal(output, place): said[output].values
        if said[output].ndim == 1
        else said[output].sel({q.dim: place}).values
        for output, (q, places) in car.layout().variables.items()
        if output != "damper_power"
        for place in places
    }


@pytest.mark.parametrize("run", [by_steps, by_derivatives])
@pytest.mark.parametrize("name", CARS)
def test_it_runs_as_said(name, run, fmus, tmp_path):
    u, truth = expected(name)
    found = run(fmus[name], u, tmp_path)
    assert set(truth) <= set(found)
    for output, values in truth.items():
        np.testing.assert_allclose(found[output], values, atol=1e-6 * np.abs(values).max(), err_msg=output)


@pytest.mark.parametrize("name", CARS)
def test_the_description_is_valid_and_says_units_and_parameters(name, fmus):
    assert validate_fmu(str(fmus[name])) == []
    known = {v.name: v for v in fmpy.read_model_description(fmus[name]).modelVariables}
    if name == "full":
        assert (known["z_r_rl"].unit, known["z_r_rl"].causality) == ("m", "input")
        assert known["bacc_cg"].unit == "m/s^2"
        assert (float(known["ks_rl"].start), known["ks_rl"].unit) == (24e3, "N/m")
        assert (known["ks_rl"].variability, known["ks_rl"].description) == ("constant", "spring stiffness, rl")
    if name in BY_RATE:
        assert {v.unit for v in known.values() if v.causality == "input"} == {"m/s"}
    if name == "steered":
        assert (known["delta_f"].unit, known["drive_rl"].unit) == ("rad", "N m")
        assert known["delta_f"].description == "steering angle, f"


def test_steps_of_any_length_and_back_again(fmus, tmp_path):
    car = Instance(fmus["full"], FMU2Slave, tmp_path)
    car.start([0.0, 0.01, 0.0, -0.02])
    car.set([0.03, 0.0, 0.0, 0.01])
    start = car.fmu.getFMUState()
    car.fmu.doStep(0.0, 0.3)
    once = car.get()
    car.fmu.setFMUState(start)
    for i, h in enumerate((0.1, 0.1, 0.07, 0.03)):
        if i == 2:
            kept = car.fmu.serializeFMUState(car.fmu.getFMUState())
            car.fmu.doStep(9.0, 4.0)
            car.fmu.setFMUState(car.fmu.deserializeFMUState(kept))
        car.fmu.doStep(0.0, h)
    np.testing.assert_allclose(car.get(), once, rtol=1e-9, atol=1e-9)
    car.fmu.reset()
    car.start([0.01] * 4)
    np.testing.assert_allclose(car.get(), 0.0, atol=1e-9)


def test_directional_derivatives_are_the_matrices(fmus, tmp_path):
    car, system = Instance(fmus["quarter"], FMU2Slave, tmp_path), CARS["quarter"].state_space()
    rows = [car.at[name] for name in system.output_labels]
    for i, name in enumerate(system.state_labels):
        np.testing.assert_allclose(car.fmu.getDirectionalDerivative(rows, [car.at[name]], [1.0]), system.C[:, i])
    rates = [car.at[f"der({name})"] for name in system.state_labels]
    np.testing.assert_allclose(car.fmu.getDirectionalDerivative(rates, [car.at["z_r"]], [2.0]), 2.0 * system.B[:, 0])


def test_what_it_cannot_do_it_refuses(fmus, tmp_path):
    car = Instance(fmus["quarter"], FMU2Slave, tmp_path)
    car.start([0.0])
    for wrong in (
        lambda: car.fmu.setReal([car.at["ks"]], [2e4]),
        lambda: car.fmu.doStep(0.0, 0.0),
        lambda: (car.set([np.nan]), car.fmu.doStep(0.0, 0.1)),
        lambda: car.fmu.getReal([999]),
        lambda: car.fmu.getInteger([0]),
    ):
        with pytest.raises(FMICallException):
            wrong()


def test_without_a_compiler_it_holds_source_that_any_compiler_takes(monkeypatch, tmp_path):
    compiler = next(filter(None, map(shutil.which, exporting.COMPILERS)), None)
    monkeypatch.setattr(shutil, "which", lambda name: None)
    with pytest.warns(UserWarning, match=r"^my-car\.fmu holds C source only, no binary, as no C compiler"):
        path = ss.export(ss.QuarterCar(), tmp_path / "my-car.fmu")
    zipfile.ZipFile(path).extractall(tmp_path)
    assert sorted(zipfile.ZipFile(path).namelist()) == ["modelDescription.xml", "sources/fmi2.c", "sources/tables.h"]
    if compiler is None:
        pytest.skip("no C compiler here to take it")
    strict = ["-std=c90", "-pedantic", "-Wall", "-Wextra", "-Werror", "-fPIC", "-shared"]
    subprocess.run([compiler, *strict, "fmi2.c", "-o", "car.so"], cwd=tmp_path / "sources", check=True)
    assert ctypes.CDLL(str(tmp_path / "sources" / "car.so")).my_car_fmi2DoStep


def test_a_compiler_that_fails_is_quoted(monkeypatch, tmp_path):
    monkeypatch.setattr(exporting, "COMPILERS", ("false",))
    with pytest.warns(UserWarning, match="false failed"):
        ss.export(ss.QuarterCar(), tmp_path / "car.fmu")


def test_the_same_vehicle_is_the_same_file(fmus, tmp_path):
    names = ("modelDescription.xml", "sources/tables.h")
    again = zipfile.ZipFile(ss.export(ss.QuarterCar(), tmp_path / "quarter.fmu"))
    assert all(again.read(name) == zipfile.ZipFile(fmus["quarter"]).read(name) for name in names)


@pytest.mark.parametrize("name", CARS)
def test_matrices_come_back_as_the_same_vehicle(name, tmp_path):
    car = CARS[name]
    back = ss.ride_metrics(read_system(ss.export(car, tmp_path / "car.mat")), ss.Road())
    truth = ss.ride_metrics(car, ss.Road())
    for output in set(back) & set(truth):  # load transfers at an axle lie on a dim of the car's own
        np.testing.assert_allclose(back[output], truth[output], rtol=1e-7, err_msg=str(output))
    assert loadmat(tmp_path / "car.mat")["outputs"].ravel()[0].item().startswith("bacc")


def test_octave_reads_the_matrices(tmp_path):
    octave = shutil.which("octave-cli") or shutil.which("octave")
    if octave is None:
        pytest.skip("Octave is not installed")
    ss.export(ss.FullCar(), tmp_path / "car.mat")
    asked = "load car.mat; printf('%s %d %.17g', inputs{4}, wheels.rl(2), norm(A))"
    said = subprocess.run([octave, "--eval", asked], cwd=tmp_path, capture_output=True, text=True, check=True).stdout
    assert said == f"z_r_rl 1 {np.linalg.norm(ss.FullCar().state_space().A, 2):.17g}"


@pytest.mark.parametrize(
    ("car", "path", "said"),
    [
        (ss.QuarterCar(), "car.mo", r"car\.mo: a vehicle is exported as \.fmu or \.mat"),
        (ss.QuarterCar(), "no/car.mat", "there is no folder"),
        (ss.QuarterCar(), "there.mat", "exists already; pass force=True to replace it"),
        (ss.QuarterCar(ks=[1e4, 2e4]), "car.mat", r"export\(\) needs one number for every parameter"),
        ("car", "car.mat", "vehicle must be one of the package's vehicles"),
        (
            ss.LinearVehicle(ct.ss(-1.0, 1.0, 1.0, 0.0, inputs="z_r", outputs="z_r", states="x")),
            "car.fmu",
            "outputs: another signal is named 'z_r' as well; rename it",
        ),
        (
            ss.LinearVehicle(ct.ss(-1.0, 1.0, 1.0, 0.0, inputs="z_r_1", outputs="y"), wheels={"1": (0, 0)}),
            "car.mat",
            "wheels: MATLAB needs a letter, then letters, digits and _, got '1'",
        ),
    ],
)
def test_refusals(car, path, said, tmp_path):
    (tmp_path / "there.mat").touch()
    with pytest.raises((ValueError, TypeError, OSError), match=said):
        ss.export(car, tmp_path / path)
    assert [file.name for file in tmp_path.iterdir()] == ["there.mat"]
    assert (tmp_path / "there.mat").stat().st_size == 0


def test_on_the_command_line(run, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert run("export", "--model", "quarter", "--ks", "20N/mm", "--out", "car.mat") == (0, "car.mat: QuarterCar\n", "")
    code, out, err = run("export", "--system", "car.mat", "--out", "car.fmu")
    assert (code, err) == (0, "")
    assert out == "car.fmu: LinearVehicle(4 states, 5 outputs, wheels one) of car.mat\n"
    assert fmpy.read_model_description("car.fmu").modelName == "LinearVehicle"
    assert run("export", "--out", "car.fmu").err.endswith("--out car.fmu exists already; pass --force to replace it\n")
    assert run("export", "--out", "car.mat", "--force").code == 0
