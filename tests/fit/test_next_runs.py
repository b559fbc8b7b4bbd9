"""The next runs of a fit, the file that waits for them, and whether they would help."""

import dataclasses
import warnings

import numpy as np
import pandas as pd
import pytest

import susp_ss as ss
from susp_ss.fit import fitting
from susp_ss.fit.next_runs import outlook, planned, to_fill_in
from susp_ss.presentation.documents import fit_document
from susp_ss.presentation.text.fit import more

ROAD = ss.Road.iso8608("B", speed=20.0, tracks="isotropic")
BOX = {"ks": (12536.0, 24570.0), "cs": (798.0, 2235.0)}
INPUTS, OUTPUTS = {"ks": "K_S [N/mm]", "cs": "C_S"}, {"bacc": "z_acc", "sws": "travel"}
CHEAP = ss.LowFidelity(ss.QuarterCar(), ROAD, "fr", "ms")


@pytest.fixture(scope="module", autouse=True)
def quick():
    """With a few surrogates."""
    every, kept = fitting.candidates, ("RB", "Kriging", "CoKriging")
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(fitting, "candidates", lambda *a: {k: v for k, v in every(*a).items() if k in kept})
        yield


def table(n, noise=0.0, seed=0, text=False):
    """Runs of a full car as a file has them: springs in N/mm, with semicolons and decimal commas if so asked."""
    X = ss.sample(BOX, n, random_state=seed)
    car = ss.ride_metrics(ss.FullCar(ks=X.ks.to_numpy(), cs=X.cs.to_numpy()), ROAD)
    rng = np.random.default_rng(seed)
    columns = {"K_S [N/mm]": X.ks / 1e3, "C_S": X.cs}
    for name, values in (("z_acc", car.bacc.sel(point="fr")), ("travel", car.sws.sel(corner="fr"))):
        columns[name] = values.to_numpy() * (1.0 + noise * rng.standard_normal(n))
    return pd.DataFrame(columns)


def fitted(tmp_path, runs, outputs=None, **asked):
    path = tmp_path / "runs.csv"
    runs.to_csv(path, index=False)
    return ss.fit_runs(ss.read_runs(path, INPUTS, outputs or OUTPUTS), CHEAP, **asked)


@pytest.fixture(scope="module")
def exact(tmp_path_factory):
    """Nine exact runs, and the next three asked for."""
    return fitted(tmp_path_factory.mktemp("runs"), table(9), next_runs=3, next_box=BOX)


def test_they_are_new_within_the_box_and_in_its_steps(exact):
    designs = ss.next_runs(exact, 8)
    assert (list(designs), len(designs)) == (["ks", "cs"], 8)
    for name, (low, high) in exact.surrogate.box.items():
        assert designs[name].between(low, high).all()
    apart = pd.concat([exact.runs.designs, designs]).round(6)
    assert not apart.duplicated().any()
    wider = ss.next_runs(exact, 8, BOX)
    assert exact.surrogate.outside(wider).any()
    assert all(wider[name].between(*ends).all() for name, ends in BOX.items())
    pd.testing.assert_frame_equal(ss.next_runs(exact, 3, BOX), wider.head(3))
    only_springs = ss.next_runs(exact, 8, {"ks": (15e3, 16e3)})
    assert only_springs.ks.between(15e3, 16e3).all()
    assert only_springs.cs.between(*exact.surrogate.box["cs"]).all()


def test_few_runs_are_filled_up_first(tmp_path, exact):
    fit = fitted(tmp_path, table(4), {"bacc": "z_acc"})
    plan = planned(fit, 5)
    assert (plan.filling, planned(exact, 5).filling) == (2, 0)
    box = np.array(list(fit.surrogate.box.values())).T
    made, new = ((X.to_numpy() - box[0]) / (box[1] - box[0]) for X in (fit.runs.designs, plan.designs))
    anywhere = np.random.default_rng(0).random((200, 2))
    gaps = [np.linalg.norm(X[:, None] - made, axis=-1).min(axis=1) for X in (new[:1], anywhere)]
    assert gaps[0].item() > 0.95 * gaps[1].max()


def test_an_output_weighs_the_same_in_any_unit(tmp_path, exact):
    in_mm = table(9).eval("travel = 1e3 * travel").rename(columns={"travel": "travel [mm]"})
    other = fitted(tmp_path, in_mm, {"bacc": "z_acc", "sws": "travel [mm]"})
    pd.testing.assert_frame_equal(ss.next_runs(other, 4), ss.next_runs(exact, 4))


def test_without_a_surrogate_of_a_variance_the_box_is_filled(tmp_path, monkeypatch):
    few = {"RB": ss.ResponseBased(CHEAP.response("bacc", ["ks", "cs"])), "plane": ss.Polynomial(1)}
    monkeypatch.setattr(fitting, "candidates", lambda *cheap: few)
    fit = fitted(tmp_path, table(12), {"bacc": "z_acc"}, next_runs=4)
    plan = planned(fit, 4)
    assert (plan.filling, plan.by, len(plan.designs)) == (4, {}, 4)
    assert outlook(fit, "bacc") is None
    assert more(fit, "bacc") == []
    assert "All fill the box" in ss.report(fit)


def test_another_stands_in_for_a_surrogate_without_a_variance(exact):
    found = dataclasses.replace(exact.outputs["bacc"], chosen="RB")
    plan = planned(dataclasses.replace(exact, outputs={"bacc": found}), 2)
    assert plan.by["bacc"] == next(name for name in found.comparison.table.index if name != "RB")


@pytest.mark.parametrize(("noise", "helps"), [(0.0, True), (0.05, False)])
def test_more_runs_help_where_they_do(tmp_path, noise, helps):
    """Twice the exact runs make the error at others much smaller, twice the noisy ones hardly."""
    T = table(60, noise, seed=9)
    T = T[T["K_S [N/mm]"].between(14.0, 23.0) & T["C_S"].between(950.0, 2100.0)]
    at = np.stack([1e3 * T["K_S [N/mm]"], T["C_S"]], axis=1)
    runs, errors = table(48, noise, seed=3), []
    for n in (24, 48):
        some = runs.head(n)
        model = ss.Kriging().fit(np.stack([1e3 * some["K_S [N/mm]"], some["C_S"]], axis=1), some.z_acc)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", ss.ExtrapolationWarning)
            errors.append(np.sqrt(np.mean((model.predict(at) - T.z_acc) ** 2)))
    fit = fitted(tmp_path, runs.head(24), {"bacc": "z_acc"})
    ahead = outlook(fit, "bacc")
    assert (ahead.helps, bool(errors[1] / errors[0] < 0.8)) == (helps, helps)
    (said,) = more(fit, "bacc")
    assert said.startswith("MORE RUNS WILL HARDLY HELP" if not helps else ("More runs would", "There are runs enough"))
    if not helps:
        assert ahead.noise == pytest.approx(noise * T.z_acc.mean(), rel=0.4)


def test_the_file_to_fill_in_is_read_again(tmp_path, exact):
    ss.save(exact, tmp_path / "fit", figures=False)
    path = tmp_path / "fit" / "next_runs.csv"
    lines = path.read_text().splitlines()
    assert lines[:2] == ["K_S [N/mm],C_S,z_acc,travel", "N/mm,N s/m,m/s^2,m"]
    assert all(line.endswith(",,") for line in lines[2:])
    path.write_text("\n".join([*lines[:2], *(line.replace(",,", f",1.{i},0.01") for i, line in enumerate(lines[2:]))]))
    again = ss.read_runs(path, INPUTS, OUTPUTS)
    np.testing.assert_allclose(again.designs, ss.next_runs(exact, 3, BOX), rtol=1e-9)
    # An earlier fit's file goes when nothing is asked for.
    unasked = dataclasses.replace(exact, asked={**exact.asked, "next_runs": 0})
    ss.save(unasked, tmp_path / "fit", force=True, figures=False)
    assert not path.exists()


def test_the_file_has_the_decimal_sign_of_the_runs(tmp_path, exact):
    path = tmp_path / "runs.csv"
    table(9).to_csv(path, sep=";", decimal=",", index=False)
    fit = dataclasses.replace(exact, runs=ss.read_runs(path, INPUTS, OUTPUTS))
    designs = ss.next_runs(fit, 3)
    (tmp_path / "next.csv").write_text(to_fill_in(fit, designs).replace(";;", ";1,1;0,01"))
    again = ss.read_runs(tmp_path / "next.csv", INPUTS, OUTPUTS)
    np.testing.assert_allclose(again.designs, designs, rtol=1e-9)


def test_the_document_has_them(exact):
    document = fit_document(exact)
    assert document["next_runs"] == ss.next_runs(exact, 3, BOX).to_dict("records")
    assert document["outputs"]["bacc"]["more_runs"] == more(exact, "bacc")


def test_command_line_report_and_page(run, tmp_path):
    table(9).to_csv(tmp_path / "runs.csv", index=False)
    fit = ("fit", tmp_path / "runs.csv", "--inputs", "K_S=ks,C_S=cs", "--outputs", "z_acc=bacc")
    fit = (*fit, "--tracks", "isotropic", "--at", "fr", "--next", "4", "--next-range", "ks=12.5N/mm:24.6N/mm")
    out = run(*fit, "--out", tmp_path / "fit")
    assert out.code == 0
    assert "The next runs, the most telling first." in out.out
    assert "ks (N/mm)" in out.out
    page = (tmp_path / "fit" / "report.html").read_text()
    assert 'id="next"' in page
    assert "next_runs.csv" in page
    assert "next_runs=4, next_box={'ks': (12500.0, 24600.0)}" in page.replace("&#39;", "'")
    assert "The next runs" in (tmp_path / "fit" / "report.md").read_text()


@pytest.mark.parametrize(
    ("asked", "said"),
    [
        ({"runs": 0}, "runs must be a whole number from 1 to 100, got 0"),
        ({"runs": None}, "runs must be a whole number from 1 to 100, got None"),
        ({"box": {"kt": (1.0, 2.0)}}, "box has no input named 'kt', available: ks, cs"),
        ({"box": {"ks": (2e4, 1e4)}}, r"box\['ks'\] must rise between finite numbers"),
        ({"box": {"ks": (-1.0, 2e4)}}, r"box\['ks'\]: ks must be finite and > 0, got -1.0"),
        ({"box": {"ks": (np.nan, 2e4)}}, r"box\['ks'\] must rise between finite numbers"),
        ({"box": [1.0]}, "box must map the name of each variable"),
    ],
)
def test_bad_requests(exact, asked, said):
    with pytest.raises((TypeError, ValueError), match=said):
        ss.next_runs(exact, **asked)


def test_what_is_no_fit_is_refused():
    with pytest.raises(TypeError, match="fit must be a Fit, as fit_runs returns it, got None"):
        ss.next_runs(None)


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (("--next", "many"), "needs a whole number, got 'many'"),
        (("--next", "101"), "next_runs must be a whole number from 0 to 100, got 101"),
        (("--next", "2", "--next-range", "kt=1:2"), "--next-range kt: it is none of --inputs, ks, cs"),
        (("--next", "2", "--next-range", "ks=12"), "--next-range ks must be LO:HI"),
        (("--next", "2", "--next-range", "ks=24e3:12e3"), "must rise between finite numbers"),
        (("--next-range", "ks=12e3:24e3"), "--next-range is for --next"),
    ],
)
def test_bad_options_are_one_line(run, tmp_path, options, said):
    table(5).to_csv(tmp_path / "runs.csv", index=False)
    fit = ("fit", tmp_path / "runs.csv", "--inputs", "K_S=ks,C_S=cs", "--outputs", "z_acc=bacc")
    out = run(*fit, *options, "--out", tmp_path / "fit")
    assert (out.code, out.err.count("\n")) == (2, 1)
    assert said in out.err
    assert not (tmp_path / "fit").exists()
