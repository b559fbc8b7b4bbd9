"""A surrogate file gives back what was saved, or one line that says what is wrong with it."""

import json
import runpy
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

import susp_ss as ss
from susp_ss.fit import LowFidelity
from susp_ss.fit.surrogate_file import SuspensionSurrogate

BENCHMARKS = Path(__file__).parents[2] / "benchmarks"

COLUMNS = ["ks_front", "ks_rear", "cs", "speed"]
CHEAP = LowFidelity(
    ss.QuarterCar(ms=300.0), ss.Road.iso8608("C", speed=25.0, tracks="isotropic"), place="rr", parameter="ms"
)


def runs(n, seed):
    rng = np.random.default_rng(seed)
    return pd.DataFrame(rng.uniform([15e3, 16e3, 1e3, 15.0], [25e3, 26e3, 2e3, 30.0], (n, 4)), columns=COLUMNS)


@pytest.fixture(scope="module")
def fitted():
    X = runs(14, 1)
    models = {}
    for output, make in {
        "bacc": lambda f: ss.VariableBased(f),
        "sws": lambda f: ss.CoKriging(f),
        "dtl_fr": lambda f: ss.ResponseBased(f, form="power"),
        "roll_acc": lambda f: ss.Polynomial(degree=1),
        "peak": lambda f: ss.Kriging(),
    }.items():
        cheap = CHEAP.response(output, COLUMNS)
        y = cheap(X) * 1.1 + 1e-5 * X["cs"] if cheap else X.sum(axis=1)
        models[output] = make(cheap).fit(X, y)
    models["bacc_cg"] = ss.ParameterBased(CHEAP.response("bacc_cg", COLUMNS, tuned=True)).fit(
        X, CHEAP.response("bacc_cg", COLUMNS, tuned=True)(X, 350.0)
    )
    units = dict(zip(COLUMNS, ("N/m", "N/m", "N s/m", "m/s"), strict=True))
    return SuspensionSurrogate(units, dict.fromkeys(models, "SI"), models, CHEAP, {"bacc": {"RMSE": 0.1}})


@pytest.fixture
def path(fitted, tmp_path):
    fitted.save(tmp_path / "surrogate.json")
    return tmp_path / "surrogate.json"


def test_saved_and_loaded_predict_the_same(fitted, path):
    again, T = ss.load_surrogate(path), runs(30, 2)
    pd.testing.assert_frame_equal(again.predict(T, return_std=True), fitted.predict(T, return_std=True), rtol=0, atol=0)
    np.testing.assert_array_equal(again.outside(T), fitted.outside(T))
    assert 0 < again.outside(T).sum() < 30
    assert (again.inputs, again.outputs, again.accuracy["bacc"]) == (fitted.inputs, fitted.outputs, {"RMSE": 0.1})
    assert again.models["bacc_cg"].parameter_ == pytest.approx(350.0)
    assert again.document() == fitted.document()


def test_columns_go_by_name(path):
    again, T = ss.load_surrogate(path), runs(5, 3)
    pd.testing.assert_frame_equal(again.predict(T[COLUMNS[::-1]]), again.predict(T))
    pd.testing.assert_frame_equal(again.predict({name: T[name].to_numpy() for name in COLUMNS}), again.predict(T))
    with pytest.raises(ValueError, match="designs must have the columns ks_front, ks_rear, cs, speed, got cs"):
        again.predict({"cs": [1.0]})
    with pytest.raises(TypeError, match="designs must be a DataFrame"):
        again.predict(T.to_numpy())


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (lambda d: d | {"format": "recipe"}, 'not a surrogate file: it must say "format": "susp_ss surrogate"'),
        (lambda d: [d], "not a surrogate file"),
        (
            lambda d: d | {"version": 3, "susp_ss": "3.1"},
            r"written by a newer susp_ss \(3.1, file version 3\), this one",
        ),
        (lambda d: d | {"version": "1"}, "damaged: version must be a whole number >= 1, got '1'"),
        (lambda d: {k: v for k, v in d.items() if k != "outputs"}, "damaged: 'outputs' is missing"),
        (lambda d: d["outputs"]["bacc"]["found"].pop("coef") and d, "damaged: 'coef' is missing"),
        (lambda d: d["outputs"]["bacc"].update(accuracy=1.0) or d, "damaged: accuracy of bacc must be numbers by name"),
        (lambda d: d["outputs"]["bacc"].update(kind="Oracle") or d, "damaged: no surrogate named 'Oracle'"),
        (lambda d: d["outputs"]["bacc"]["found"].update(coef=[1.0]) or d, "damaged: "),
        (lambda d: d["outputs"]["bacc"]["settings"].update(magic=1) or d, "damaged: .*magic"),
        (lambda d: d["outputs"]["sws"].update(columns=["ks"]) or d, "damaged: sws must have the columns ks_front"),
        (lambda d: d["low_fidelity"]["road"].update(speed=-1.0) or d, r"damaged: Road\(speed=...\) must be > 0"),
        (lambda d: d["low_fidelity"]["vehicle"].update(model="lorry") or d, "damaged: no model named 'lorry'"),
        (lambda d: d["outputs"]["peak"]["found"]["responses"].pop() and d, "damaged: "),
    ],
)
def test_what_is_wrong_with_a_file(path, change, said):
    path.write_text(json.dumps(change(json.loads(path.read_text()))))
    with pytest.raises(ValueError, match=f"surrogate.json: {said}") as refusal:
        ss.load_surrogate(path)
    assert "\n" not in str(refusal.value)


def test_truncated_and_foreign_files(path):
    text = path.read_text()
    path.write_text(text[: len(text) // 2])
    with pytest.raises(
        ValueError, match=r"surrogate.json: not a surrogate file, or cut short: .* \(at line \d+, column \d+\)"
    ):
        ss.load_surrogate(path)
    path.write_bytes(b"{\n\xff\xfe}")
    with pytest.raises(ValueError, match=r"not UTF-8 text \(at line 2, column 1\)"):
        ss.load_surrogate(path)
    path.write_text(text.replace('"RMSE": 0.1', '"RMSE": NaN'))
    with pytest.raises(ValueError, match="it holds NaN, which is no number"):
        ss.load_surrogate(path)
    path.write_text("[" * 100_000)
    with pytest.raises(ValueError, match="not a surrogate file"):
        ss.load_surrogate(path)
    with pytest.raises(FileNotFoundError):
        ss.load_surrogate(path.with_name("none.json"))


def test_any_damage_is_refused_in_one_line_or_predicts():
    """A sample of the ten thousand of the benchmark, of every kind."""
    count = runpy.run_path(str(BENCHMARKS / "damaged_files.py"))["count"]
    for verdicts in count(210, seed=1).values():
        assert verdicts.total() == 30
        assert verdicts["refused"] > 10


@pytest.mark.parametrize("kind", ["Kriging", "CoKriging"])
def test_files_of_another_library_are_refused_in_words(path, kind):
    """Those of version 1; of other kinds, they load."""
    document = json.loads(path.read_text()) | {"version": 1}
    document["outputs"] = {k: v for k, v in document["outputs"].items() if v["kind"] not in ("Kriging", "CoKriging")}
    path.write_text(json.dumps(document))
    assert set(ss.load_surrogate(path).outputs) == set(document["outputs"])
    first = next(iter(document["outputs"]))
    document["outputs"][first] |= {"kind": kind, "settings": {"trend": "constant", "random_state": 0}}
    path.write_text(json.dumps(document))
    with pytest.raises(ValueError, match=f"holds {kind} of file version 1, which another .* again with susp-ss fit$"):
        ss.load_surrogate(path)


@pytest.mark.parametrize(
    ("found", "said"),
    [
        ({"scaled_thetas": [0.1]}, "scaled_thetas must be one for each column, from 5e-06 to 100"),
        ({"scaled_thetas": [0.1, 0.1, 0.1, 1e9]}, "scaled_thetas must be"),
        ({"noise": -1.0}, "noise must be from 0 to 200, got -1.0"),
        ({"degree": 7}, "degree must be one of 0, 1, 2, got 7"),
        ({"designs": [[1.0, 2.0]]}, r"designs and responses must be \(n, 4\) and \(n,\), got \(1, 2\)"),
    ],
)
def test_numbers_of_kriging_are_checked(path, found, said):
    document = json.loads(path.read_text())
    document["outputs"]["peak"]["found"] |= found
    path.write_text(json.dumps(document))
    with pytest.raises(ValueError, match=f"surrogate.json: damaged: {said}"):
        ss.load_surrogate(path)


def test_kriging_is_restored_without_a_search(path, monkeypatch):
    def never(self):
        raise AssertionError("searched")

    monkeypatch.setattr("susp_ss.surrogates.gaussian_process.Process.search", never)
    assert np.isfinite(ss.load_surrogate(path).predict(runs(3, 4), interval=0.95)).all(axis=None)


def test_a_file_that_cannot_be_written_leaves_the_old_one(fitted, path, monkeypatch):
    before = path.read_text()
    monkeypatch.setattr("os.replace", lambda *_: (_ for _ in ()).throw(OSError(28, "No space left on device")))
    with pytest.raises(OSError, match="No space"):
        fitted.save(path)
    assert path.read_text() == before
    assert [file.name for file in path.parent.iterdir()] == ["surrogate.json"]
