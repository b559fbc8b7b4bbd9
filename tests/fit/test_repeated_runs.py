"""A rig that scatters: designs that stand in the table several times, with different results."""

import json

import numpy as np
import pandas as pd
import pytest

import susp_ss as ss
from susp_ss.fit import fitting

INPUTS, OUTPUTS = {"ks": "ks", "cs": "cs"}, {"bacc": "bacc"}
NOISE = 0.01


@pytest.fixture(scope="module")
def table():
    """Seven designs of a quarter car, three runs each, with one per cent of noise."""
    X = pd.concat([ss.sample({"ks": (13e3, 24e3), "cs": (900.0, 2200.0)}, 7, random_state=1)] * 3, ignore_index=True)
    exact = ss.Response(ss.QuarterCar(), ss.Road.iso8608("C", speed=20.0), "bacc")(X)
    return X.assign(bacc=1.2 * exact * (1.0 + NOISE * np.random.default_rng(0).standard_normal(len(X))))


@pytest.fixture
def path(table, tmp_path):
    table.to_csv(tmp_path / "runs.csv", index=False)
    return tmp_path / "runs.csv"


def test_all_runs_are_read_and_the_note_says_which_scatter(table, path):
    runs = ss.read_runs(path, INPUTS, OUTPUTS)
    pd.testing.assert_frame_equal(runs.designs.join(runs.responses), table)
    assert runs.noted == (
        f"{path}: different results of one design, in lines 2, 9, 16, as of 6 more designs, are taken for scatter"
    )


def test_the_same_result_again_is_no_scatter(table, path):
    pd.concat([table[:7], table[:7]]).to_csv(path, index=False)
    assert ss.read_runs(path, INPUTS, OUTPUTS).noted == ""
    changed = pd.concat([table[:7], table[:1].assign(bacc=9.0)])
    changed.rename(columns={"ks": "ks [N/m]"}).to_csv(path, index=False)
    said = f"{path}: ks in N/m; different results of one design, in lines 2, 9, are taken for scatter"
    assert ss.read_runs(path, INPUTS, OUTPUTS).noted == said


def test_the_command_line_to_the_end(path, tmp_path, run, monkeypatch):
    every, few = fitting.candidates, ("RB", "Polynomial 1", "RBF thin plate", "Kriging")
    monkeypatch.setattr(fitting, "candidates", lambda *a: {k: v for k, v in every(*a).items() if k in few})
    asked = ["fit", path, "--inputs", "ks,cs", "--outputs", "bacc", "--road-class", "C", "--speed", "20"]
    code, out, err = run(*asked, "--learning-curve", "--next", "2", "--held-out", "1", "--json")
    assert code == 0, err
    assert "in lines 2, 9, 16, as of 6 more designs, are taken for scatter" in err
    found = json.loads(out)["outputs"]["bacc"]
    assert {row["surrogate"] for row in found["ranking"]} == {*few} - {"RBF thin plate"}
    assert list(found["not_fitted"]) == ["RBF thin plate"]
    assert "are one design with two responses" in found["not_fitted"]["RBF thin plate"]
    assert found["predicts"]
    assert found["taken"] == "RB"
    code, _, err = run(*asked, "--surrogate", "RBF thin plate")
    assert (code, "RBF thin plate cannot be fitted to bacc: rows 0 and 7 of X are one design" in err) == (2, True)


def test_a_surrogate_of_repeated_runs_is_saved_and_loaded(table, path, tmp_path, monkeypatch):
    monkeypatch.setattr(fitting, "candidates", lambda *a: {"Kriging": ss.Kriging(), "plane": ss.Polynomial(1)})
    runs = ss.read_runs(path, INPUTS, OUTPUTS)
    cheap = ss.LowFidelity(ss.QuarterCar(), ss.Road.iso8608("C", speed=20.0), "fr")
    fit = ss.fit_runs(runs, cheap, choose="Kriging", folds=7)
    # Kriging smooths: its prediction is nearer to the mean of a design's runs than these are to one another.
    means = table.groupby(["ks", "cs"], sort=False).bacc.agg(["mean", "std"])
    at = means.index.to_frame(index=False)
    predicted = fit.surrogate.predict(at).bacc.to_numpy()
    assert (np.abs(predicted - means["mean"]) < 2.0 * means["std"].max()).all()
    fit.surrogate.save(tmp_path / "surrogate.json")
    again = ss.load_surrogate(tmp_path / "surrogate.json").predict(at, interval=0.9)
    pd.testing.assert_frame_equal(again, fit.surrogate.predict(at, interval=0.9), rtol=1e-12)
