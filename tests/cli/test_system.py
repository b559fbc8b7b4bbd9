"""``susp-ss metrics --system``: a state space from a file."""

import json

import numpy as np
import pytest
from scipy.io import savemat

import susp_ss as ss

CAR, ROAD = ss.FullCar(), ss.DEFAULT_ROAD


@pytest.fixture(autouse=True)
def here(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return tmp_path


def table(vehicle, form="velocity", **more):
    system = vehicle.state_space(form)
    matrices = {name: getattr(system, name).tolist() for name in "ABCD"}
    return (
        matrices
        | {"inputs": system.input_labels, "outputs": system.output_labels, "states": system.state_labels}
        | more
    )


def written(contents, name="system.json"):
    if name.endswith(".mat"):
        cells = {key: np.array(value, dtype=object) for key, value in contents.items() if key.endswith("puts")}
        savemat(name, {key: value for key, value in contents.items() if key != "states"} | cells)
    else:
        with open(name, "w", encoding="utf-8") as file:
            json.dump(contents, file)
    return name


def metrics(run, *arguments):
    code, out, err = run("metrics", "--json", *arguments)
    assert (code, err) == (0, "")
    return json.loads(out)


PLACES = {
    "wheels": {"fr": [0, -1], "fl": [0, 1], "rr": [1, -1], "rl": [1, 1]},
    "wheelbase": CAR.wheelbase,
    "track_width": CAR.track_width,
}


@pytest.mark.parametrize("form", ["velocity", "displacement"])
@pytest.mark.parametrize("places", [{}, PLACES], ids=["like the model", "of its own"])
@pytest.mark.parametrize("file", ["system.json", "system.mat"])
def test_a_file_of_a_full_car_is_the_full_car(run, file, places, form):
    document = metrics(run, "--system", written(table(CAR, form, **places), file))
    expected = ss.ride_metrics(CAR, ROAD)
    assert document["vehicle"]["system"] == file
    assert document["vehicle"]["wheelbase"] == {"value": CAR.wheelbase, "unit": "m"}
    assert document["vehicle"]["wheels"]["rl"] == {"axle": 1, "side": 1}
    for name, data in expected[["bacc", "sws", "dtl", "pitch_acc", "roll_acc"]].items():
        ours = document["metrics"][name]
        np.testing.assert_allclose(list(ours.values()) if data.dims else ours, data, rtol=1e-10)


@pytest.mark.parametrize("file", ["system.json", "system.mat"])
def test_a_quarter_car_needs_no_places(run, file):
    # One column of B comes out of MATLAB as a row of numbers.
    document = metrics(run, "--system", written(table(ss.QuarterCar()), file))
    np.testing.assert_allclose(document["metrics"]["sws"], ss.ride_metrics(ss.QuarterCar(), ROAD).sws, rtol=1e-10)
    code, out, _ = run("metrics", "--system", file)
    assert code == 0
    assert out.startswith(f"LinearVehicle(4 states, 3 outputs, wheels one) of {file}; ")


def test_a_half_car_by_the_model_that_it_is_like(run):
    car = ss.PitchHalfCar()
    document = metrics(run, "--system", written(table(car)), "--model", "pitch-half")
    np.testing.assert_allclose(list(document["metrics"]["dtl"].values()), ss.ride_metrics(car, ROAD).dtl, rtol=1e-10)


GOOD = table(ss.QuarterCar())
WRONG = {
    "no file": (None, "", "system.json"),
    "not JSON": ("{", "", "not JSON"),
    "no object": ([1, 2], "", "must be an object with A, B, C, inputs and outputs, got [1, 2]"),
    "unknown key": (GOOD | {"E": [[1.0]]}, "", "no key named 'E', available: A, B, C, D, inputs"),
    "missing": ({"A": [[1.0]]}, "", "B is missing"),
    "shape": (GOOD | {"B": [[1.0]]}, "", "B must have shape (4, 1)"),
    "text": (GOOD | {"A": "soft"}, "", "A must"),
    "ragged": (GOOD | {"C": [[1.0], [1.0, 2.0]]}, "", "C must be rows of numbers"),
    "names": (GOOD | {"outputs": [1, 2, 3]}, "", "outputs must be names, got [1, 2, 3]"),
    "states": (GOOD | {"states": ["one"]}, "", "states must be 4 names"),
    "unstable": (GOOD | {"A": (-np.array(GOOD["A"])).tolist()}, "", "has a mode that does not die out"),
    "wheels of another model": (
        table(ss.PitchHalfCar()),
        "",
        "must be of the same wheels, got fr, fl, rr, rl and inputs for f, r",
    ),
    "template": (GOOD, "--template", "--template prints a model's parameters"),
}


@pytest.mark.parametrize(("contents", "options", "said"), WRONG.values(), ids=WRONG.keys())
def test_wrong_files_are_refused_in_one_line(run, here, contents, options, said):
    if contents is not None:
        (here / "system.json").write_text(contents if isinstance(contents, str) else json.dumps(contents))
    code, out, err = run("metrics", "--system", "system.json", *options.split())
    assert (code, out) == (2, "")
    assert said in err
    assert len(err.splitlines()) == 1


def test_what_is_no_matlab_file(run, here):
    (here / "system.mat").write_bytes(b"not from MATLAB")
    code, out, err = run("metrics", "--system", "system.mat")
    assert (code, out, len(err.splitlines())) == (2, "", 1)
    assert "no MATLAB file" in err
