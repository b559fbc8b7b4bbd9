"""From a table of runs to a surrogate that can be believed, and to its predictions."""

import dataclasses
import json
import re

import numpy as np
import pandas as pd
import pytest
import scipy.stats

import susp_ss as ss
from susp_ss.fit import LowFidelity, fitting
from susp_ss.presentation.documents import fit_document
from susp_ss.presentation.text import fit as text_of_fits
from susp_ss.surrogates.folds import split

ROAD = ss.Road.iso8608("B", speed=20.0, tracks="isotropic")
QUICK = ("RB", "VB", "PB ms", "Polynomial 1", "Polynomial 2", "RBF thin plate")
SCENARIO = ("--tracks", "isotropic", "--at", "fr")


def table(n, seed=0):
    """Exact runs of a full car at its front right corner."""
    runs = ss.sample({"ks": (12536.0, 24570.0), "cs": (798.0, 2235.0)}, n, random_state=seed)
    car = ss.ride_metrics(ss.FullCar(ks=runs.ks.to_numpy(), cs=runs.cs.to_numpy()), ROAD)
    return runs.assign(bacc=car.bacc.sel(point="fr"), sws=car.sws.sel(corner="fr"), dtl=car.dtl.sel(corner="fr"))


@pytest.fixture(scope="module")
def runs_file(tmp_path_factory):
    path = tmp_path_factory.mktemp("runs") / "runs.csv"
    table(14).to_csv(path, index=False)
    return path


@pytest.fixture
def quick(monkeypatch):
    """Without the surrogates that take seconds."""
    every = fitting.candidates
    monkeypatch.setattr(fitting, "candidates", lambda *a: {k: v for k, v in every(*a).items() if k in QUICK})


@pytest.fixture(scope="module")
def fitted(runs_file):
    runs = ss.read_runs(runs_file, {"ks": "ks", "cs": "cs"}, {"bacc": "bacc", "dtl": "dtl"})
    return ss.fit_runs(runs, LowFidelity(ss.QuarterCar(), ROAD, "fr", "ms"), folds=4, learning=True, held_out_runs=2)


def test_each_output_has_every_surrogate_and_the_best_is_taken(fitted):
    for found in fitted.outputs.values():
        ranked = found.comparison.table
        assert {*ranked.index, *found.comparison.refused} == {
            *QUICK,
            "RB power",
            "CoKriging",
            "Polynomial 3",
            "RBF Gaussian",
            "Kriging",
        }
        assert found.chosen == ranked.index[0] == ranked.RMSE.idxmin()
        assert set(found.kept_back) == set(ranked.index)
        assert ranked.low_fidelity.sum() == 5
    assert len(fitted.runs.rows) == 12


def test_the_errors_are_those_of_runs_left_out(fitted):
    X, bacc = fitted.runs.designs, fitted.runs.responses.bacc.to_numpy()
    cheap = ss.Response(ss.QuarterCar(), ROAD, "bacc")
    alone = np.empty_like(bacc)
    for kept, left in split(X, 4, 0):
        alone[left] = ss.VariableBased(cheap).fit(X.iloc[kept], bacc[kept]).predict(X.iloc[left])
    left_out = fitted.outputs["bacc"].comparison.validations["VB"]
    np.testing.assert_allclose(left_out.predicted, alone, rtol=1e-9)
    assert fitted.outputs["bacc"].untuned == ss.accuracy(bacc, cheap(X))


def test_held_out_runs_are_in_no_fit(fitted, runs_file):
    every = pd.read_csv(runs_file)
    kept = every[~every.ks.isin(fitted.runs.designs.ks)]
    assert len(kept) == 2
    for name, seen in fitted.outputs["dtl"].kept_back.items():
        np.testing.assert_array_equal(np.sort(seen.y), np.sort(kept.dtl), err_msg=name)


def test_the_report_says_what_was_found(fitted):
    text = ss.report(fitted)
    bacc = fitted.outputs["bacc"]
    assert text.startswith("12 runs of ")
    assert f"Taken: {bacc.chosen}." in text
    gain = bacc.comparison.gain()
    assert f"runs give {gain.baseline}, with {gain.ratio:.2g} times the RMSE of {gain.tuned}" in " ".join(text.split())
    assert re.search(r"^cheap, untuned +yes", text, re.MULTILINE)
    assert "RMSE (m/s²) after fewer runs" in text
    formulas = [f"{name} = {found.formula[1]}" for name, found in fitted.outputs.items()]
    assert max(len(line) for line in text.splitlines() if line not in formulas) <= 120
    assert set(formulas) <= set(text.splitlines())
    # Units as people read them; in a formula and to programs as programs do.
    assert "^" not in "".join(line for line in text.splitlines() if line not in formulas)
    assert fit_document(fitted)["outputs"]["bacc"]["unit"] == "m/s^2"


@pytest.mark.parametrize("output", ["bacc", "dtl"])
def test_a_formula_stands_beside_its_error_and_that_of_the_surrogate_taken(fitted, output):
    found, unit = fitted.outputs[output], {"bacc": "m/s^2", "dtl": "N"}[output]
    typed = found.formula[0]
    taken = next(name for name in found.models if name != typed)
    rmse = {name: found.comparison.validations[name].accuracy.RMSE for name in (typed, taken)}

    (said,) = text_of_fits.typed(dataclasses.replace(found, chosen=taken), unit)
    shown = unit.replace("^2", "²")
    assert f"{typed}, not the surrogate taken; at runs left out its RMSE is {rmse[typed]:.4g} {shown}" in said
    assert f"by the same folds that of {taken} is {rmse[taken]:.4g}." in said

    (said,) = text_of_fits.typed(dataclasses.replace(found, chosen=typed), unit)
    assert said.endswith(f"{typed}, the surrogate taken; at runs left out its RMSE is {rmse[typed]:.4g} {shown}.")
    (said,) = text_of_fits.typed(dataclasses.replace(found, formula=None), unit)
    assert said == "None of these has a formula to type into a spreadsheet."

    (said,) = text_of_fits.typed(found, unit)
    assert said in " ".join(ss.report(fitted).split())


def test_the_report_says_how_far_a_stated_interval_held(fitted):
    text, told = " ".join(ss.report(fitted).split()), 0
    for found in fitted.outputs.values():
        taken = found.comparison.validations[found.chosen]
        if taken.std is None:
            continue
        within = int(np.sum(np.abs(taken.predicted - taken.y) <= 1.959964 * taken.std))
        # So few that 95 % would give them less than once in forty times.
        small = scipy.stats.binom.cdf(within, taken.y.size, 0.95) < 0.025
        said = f"{within / taken.y.size:.0%} lie within the 95 % interval that {found.chosen} states"
        assert f"{said}{'; its standard deviations are too small.' if small else '.'}" in text
        told += 1
    assert told == text.count("Of the runs left out") >= 1


def test_files(fitted, tmp_path):
    ss.save(fitted, tmp_path / "fit")
    files = {str(path.relative_to(tmp_path / "fit")) for path in (tmp_path / "fit").rglob("*.*")}
    pictures = {
        f"figures/{kind}_{output}.png"
        for kind in ("parity", "residuals", "map", "learning")
        for output in ("bacc", "dtl")
    }
    assert files == {"surrogate.json", "report.md", "report.html", "accuracy.csv", "predictions.csv", *pictures}
    report = (tmp_path / "fit" / "report.md").read_text()
    assert set(re.findall(r"\]\((.*?)\)", report)) == pictures
    ranked = pd.read_csv(tmp_path / "fit" / "accuracy.csv").set_index(["output", "surrogate"])
    np.testing.assert_allclose(ranked.loc["dtl"].RMSE, fitted.outputs["dtl"].comparison.table.RMSE)
    assert ranked.taken.groupby("output").sum().tolist() == [1, 1]
    predicted = pd.read_csv(tmp_path / "fit" / "predictions.csv")
    np.testing.assert_allclose(predicted["bacc: RB"], fitted.outputs["bacc"].comparison.validations["RB"].predicted)
    assert predicted.row.tolist() == fitted.runs.rows.tolist()
    loaded, T = ss.load_surrogate(tmp_path / "fit" / "surrogate.json"), table(5, 9)[["ks", "cs"]]
    pd.testing.assert_frame_equal(loaded.predict(T), fitted.surrogate.predict(T))
    assert loaded.accuracy["bacc"]["left_out"]["RMSE"] == pytest.approx(
        fitted.outputs["bacc"].comparison.table.RMSE.iloc[0]
    )
    with pytest.raises(FileExistsError, match=r"holds results already, such as surrogate\.json"):
        ss.save(fitted, tmp_path / "fit")
    ss.save(fitted, tmp_path / "fit", force=True)
    with pytest.raises(NotADirectoryError):
        ss.save(fitted, tmp_path / "fit" / "report.md")


def test_a_failure_leaves_nothing_half_written(fitted, tmp_path, monkeypatch):
    def full(*arguments):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("susp_ss.presentation.pages.fit.fit_page", full)
    (tmp_path / "held").mkdir()
    (tmp_path / "held" / "surrogate.json").write_text("mine")
    for name in ("new", "held"):
        with pytest.raises(OSError, match=rf"cannot write results to .*{name}: No space left"):
            ss.save(fitted, tmp_path / name, force=True)
    assert [path.name for path in tmp_path.rglob("*")] == ["held", "surrogate.json"]
    assert (tmp_path / "held" / "surrogate.json").read_text() == "mine"


def test_a_perfect_cheap_model_wins_and_is_exact(tmp_path, quick):
    runs = table(10)
    runs["bacc"] = 0.1 + 1.3 * ss.Response(ss.QuarterCar(), ROAD, "bacc")(runs[["ks", "cs"]])
    runs.to_csv(tmp_path / "runs.csv", index=False)
    read = ss.read_runs(tmp_path / "runs.csv", {"ks": "ks", "cs": "cs"}, {"bacc": "bacc"})
    found = ss.fit_runs(read, LowFidelity(ss.QuarterCar(), ROAD)).outputs["bacc"]
    assert found.chosen == "RB"
    assert (found.model.intercept_, found.model.coef_[0]) == (pytest.approx(0.1), pytest.approx(1.3))
    assert found.comparison.gain().ratio > 1e3
    assert found.formula[0] == "RB"


def test_front_rear_and_speed(tmp_path, quick):
    """More inputs than two, in other units and under other names; the quarter car takes those of its corner."""
    box = {"front": (13.0, 24.0), "rear": (15.0, 26.0), "cs": (800.0, 2200.0), "v": (40.0, 110.0)}
    runs = ss.sample(box, 30, random_state=4)
    cheap = ss.Response(ss.QuarterCar(), ROAD, "sws", inputs=("ks", "cs", "speed"))
    runs["travel"] = 1e3 * (0.001 + 1.2 * cheap(np.column_stack([1e3 * runs.rear, runs.cs, runs.v / 3.6])))
    runs.to_parquet(tmp_path / "runs.parquet", index=False)
    read = ss.read_runs(
        tmp_path / "runs.parquet",
        {"ks_front": "front", "ks_rear": "rear", "cs": "cs", "speed": "v"},
        {"sws_rr": "travel"},
        {"ks_front": "N/mm", "ks_rear": "kN/m", "speed": "km/h", "sws_rr": "mm"},
    )
    fit = ss.fit_runs(read, LowFidelity(ss.QuarterCar(), ROAD))
    found = fit.outputs["sws_rr"]
    assert (found.chosen, found.model.intercept_) == ("RB", pytest.approx(0.001))
    assert "For sws_rr, QuarterCar does not feel ks_front." in ss.report(fit)


def test_outputs_that_the_cheap_model_has_not(tmp_path, quick):
    runs = table(12)
    runs["peak"] = 3.0 + 1e-4 * runs.ks - 1e-8 * runs.ks * runs.cs
    runs.to_csv(tmp_path / "runs.csv", index=False)
    read = ss.read_runs(tmp_path / "runs.csv", {"ks": "ks", "cs": "cs"}, {"peak": "peak"})
    fit = ss.fit_runs(read, LowFidelity(ss.QuarterCar(), ROAD, parameter="ms"))
    assert fit.outputs["peak"].untuned is None
    assert fit.outputs["peak"].chosen == "Polynomial 2"
    assert "QuarterCar has no peak" in ss.report(fit)
    assert "There is no cheap model to compare with." in ss.report(fit)


def test_a_tuned_input_is_not_tuned_twice(tmp_path, quick):
    runs = table(12).assign(ms=np.linspace(280.0, 350.0, 12))
    runs.to_csv(tmp_path / "runs.csv", index=False)
    read = ss.read_runs(tmp_path / "runs.csv", {"ks": "ks", "ms": "ms"}, {"sws": "sws"})
    fit = ss.fit_runs(read, LowFidelity(ss.QuarterCar(), ROAD, parameter="ms"))
    assert not any("PB" in name for name in fit.outputs["sws"].comparison.table.index)


GOOD = "ks,cs,bacc\n18e3,1500,1\n20e3,1400,1.1\n22e3,1300,1\n19e3,1250,0.9\n"

BAD = [
    (GOOD.replace("e3", ""), (), "column 'ks': the median of ks, 19.5 N/m is outside the usual range of spring"),
    ("ks,cs,bacc\n18e3,1500,1e3\n20e3,1400,1e3\n22e3,1300,1e3\n19e3,1250,900\n", (), "mean 1000 mm/s^2? State its"),
    (
        "ks,cs,sws\n18e3,1500,.9\n20e3,1400,.8\n22e3,1300,.7\n19e3,1250,.9\n",
        (),
        "line 2, column 'sws': 0.9 m where the cheap model has",
    ),
    ("\n".join(GOOD.splitlines()[:4]), (), "3 different designs to fit are fewer than the 4 that 2 input"),
    (GOOD.replace("1400", "14oo"), (), "line 3, column 'cs'"),
    ("ks,cs,bacc\n18e3,1500,1\n19e3,1500,1.1\n22e3,1500,1\n", (), "column 'cs'"),
    (GOOD.replace("bacc", "acc"), (), "no column 'bacc', did you mean 'acc'"),
    (GOOD, ("--surrogate", "XB"), "no surrogate of bacc named 'XB', available: RB, RB power"),
    (GOOD, ("--at", "roof"), "place must be one of fr, fl, rr, rl, cg, got 'roof'"),
    (GOOD, ("--inputs", "ks,ks"), "--inputs names ks twice"),
    (GOOD, ("--units", "ks"), "--units must be NAME=UNIT, such as ks=N/mm, got 'ks'"),
    (GOOD, ("--low-fidelity", "lorry"), "no model named 'lorry'"),
    (GOOD, ("--tune", "zz"), "QuarterCar has no parameter named 'zz'"),
    (GOOD, ("--folds", "9"), "folds must be a whole number from 2 to the 4 different designs, got 9"),
]


@pytest.mark.parametrize(("content", "options", "said"), BAD, ids=range(len(BAD)))
def test_bad_files_are_one_line_and_write_nothing(run, tmp_path, content, options, said):
    (tmp_path / "runs.csv").write_text(content)
    out = run(
        "fit",
        tmp_path / "runs.csv",
        "--inputs",
        "ks,cs",
        "--outputs",
        "sws" if "sws" in content else "bacc",
        *options,
        "--out",
        tmp_path / "fit",
    )
    assert out.code == 2
    assert out.err.startswith("susp-ss: error: ")
    assert said in out.err
    assert out.err.count("\n") == 1
    assert [path.name for path in tmp_path.iterdir()] == ["runs.csv"]


def test_command_line_from_runs_to_predictions(run, runs_file, tmp_path, quick):
    fit = tmp_path / "fit"
    out = run(
        "fit", runs_file, "--inputs", "ks,cs", "--outputs", "bacc,sws", *SCENARIO, "--out", fit, "--surrogate", "VB"
    )
    assert out.code == 0
    assert "14 runs of" in out.out
    predicted = json.loads(
        run("predict", fit / "surrogate.json", "--at", "ks=18000,cs=1500", "--at", "cs=1500,ks=30e3", "--json").out
    )
    assert [design["outside"] for design in predicted["designs"]] == [False, True]
    assert predicted["units"] == {"ks": "N/m", "cs": "N s/m", "bacc": "m/s^2", "sws": "m"}
    X = pd.read_csv(runs_file)
    again = ss.VariableBased(ss.Response(ss.QuarterCar(), ROAD, "sws")).fit(X[["ks", "cs"]].to_numpy(), X.sws)
    assert predicted["designs"][0]["sws"] == pytest.approx(again.predict([[18e3, 1500.0]])[0], rel=1e-9)
    text = run("predict", fit / "surrogate.json", "--at", "ks=30000,cs=1500").out
    assert "outside the runs" in text
    written = tmp_path / "grid.csv"
    assert run("predict", fit / "surrogate.json", "--grid", "7", "--out", written).code == 0
    grid = pd.read_csv(written)
    assert len(grid) == 49
    assert (grid.ks.min(), grid.ks.max()) == (pytest.approx(X.ks.min()), pytest.approx(X.ks.max()))
    assert not grid.outside.any()
    assert "exists already" in run("predict", fit / "surrogate.json", "--grid", "7", "--out", written).err
    ranking = json.loads(run("fit", runs_file, "--inputs", "ks,cs", "--outputs", "sws", *SCENARIO, "--json").out)
    assert ranking["outputs"]["sws"]["taken"] == ranking["outputs"]["sws"]["ranking"][0]["surrogate"]


def test_the_cheap_model_may_be_a_whole_car(run, runs_file, quick):
    out = run("fit", runs_file, "--inputs", "ks,cs", "--outputs", "bacc", "--at", "fr", "--low-fidelity", "full")
    assert out.code == 0
    assert "Cheap model: FullCar" in out.out


@pytest.mark.parametrize(
    ("options", "said"),
    [
        ((), "pass designs by --at"),
        (("--at", "ks=1,cs=1", "--grid", "3"), "pass designs by --at"),
        (("--at", "ks=18000"), "--at needs a value for every input, missing: cs"),
        (("--at", "ks=18000,kz=3"), "--at: no input named 'kz', available: ks, cs"),
        (("--at", "ks=soft,cs=3"), "--at ks: needs a number"),
        (("--grid", "ks=1:2,cs=3"), "--grid ks must be LO:HI:N"),
        (("--grid", "x"), "--grid must be a whole number >= 1"),
    ],
)
def test_bad_designs(run, fitted, tmp_path, options, said):
    fitted.surrogate.save(tmp_path / "surrogate.json")
    out = run("predict", tmp_path / "surrogate.json", *options)
    assert (out.code, out.err.count("\n")) == (2, 1)
    assert said in out.err


def test_predict_refuses_what_is_no_surrogate(run, runs_file, tmp_path):
    assert "not a surrogate file" in run("predict", runs_file, "--at", "ks=1").err
    assert "No such file" in run("predict", tmp_path / "none.json", "--at", "ks=1").err
