"""Runs whose accelerations are weighted are tuned with a cheap model whose accelerations are weighted likewise."""

import dataclasses
import functools
import json
import tempfile
from pathlib import Path

import control
import numpy as np
import pandas as pd
import pytest
import scipy.integrate

import susp_ss as ss
from susp_ss.fit import fitting
from susp_ss.fit.formulas import closed_form
from susp_ss.fit.runs import Runs
from susp_ss.presentation.documents import fit_document
from susp_ss.presentation.reproduction import fit_code

ROAD = ss.Road.iso8608("C", speed=20.0, tracks="isotropic")
DESIGNS = ss.sample({"ks": (13e3, 24e3), "cs": (900.0, 2200.0)}, 6, random_state=1)
QUICK = ("PB ms", "Polynomial 1")
LOW_PASS = control.tf([30.0], [1.0, 30.0])
WEIGHTINGS = pytest.mark.parametrize("weighting", ["Wk", LOW_PASS], ids=["name", "system"])


def ridden(weighting, ms=350.0):
    """The cheap vehicle itself, of another mass, as table of runs."""
    car = ss.QuarterCar(ms=ms, ks=DESIGNS.ks.to_numpy(), cs=DESIGNS.cs.to_numpy())
    metrics = ss.ride_metrics(car, ROAD, weighting=weighting)
    return DESIGNS.assign(bacc=metrics.bacc.values, sws=metrics.sws.values)


@pytest.fixture(scope="module", autouse=True)
def quick():
    """Without the surrogates that take seconds."""
    every = fitting.candidates
    with pytest.MonkeyPatch.context() as patched:
        patched.setattr(fitting, "candidates", lambda *a: {k: v for k, v in every(*a).items() if k in QUICK})
        yield


@functools.cache
def fitted(weighting):
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "runs.csv")
        ridden(weighting).to_csv(path, index=False)
        runs = ss.read_runs(path, {"ks": "ks", "cs": "cs"}, {"bacc": "bacc", "sws": "sws"})
    return ss.fit_runs(runs, ss.LowFidelity(ss.QuarterCar(), ROAD, "fr", "ms", weighting), folds=3)


def test_a_weighted_response_is_the_integral_of_the_weighted_spectrum():
    """Body acceleration of a quarter car from its impedances, by quadrature."""
    ks, cs, (ms, mu, kt) = 18e3, 1500.0, (317.5, 45.4, 192e3)
    W = ss.weighting("Wk")

    def spectrum(f):
        s = 2j * np.pi * f
        strut = ks + cs * s
        body = s**2 * kt * strut / ((ms * s**2 + strut) * (mu * s**2 + strut + kt) - strut**2)
        heights = ROAD.roughness * 0.1**2 * ROAD.speed / f**2
        return abs(body * W(s)) ** 2 * heights

    variance = sum(scipy.integrate.quad(spectrum, *ends, limit=400)[0] for ends in ((1e-6, 1.0), (1.0, 20.0)))
    variance += scipy.integrate.quad(spectrum, 20.0, np.inf, limit=400)[0]
    response = ss.Response(ss.QuarterCar(ms=ms, mu=mu, kt=kt), ROAD, "bacc", weighting="Wk")
    np.testing.assert_allclose(response([[ks, cs]]), np.sqrt(variance), rtol=1e-6)


@WEIGHTINGS
def test_responses_are_the_ride_metrics(weighting):
    X = DESIGNS.to_numpy()
    car = ss.FullCar(ks=X[:, 0], cs=X[:, 1])
    metrics = ss.ride_metrics(car, ROAD, weighting=weighting)
    for criterion, at in (("bacc", "fr"), ("roll_acc", None), ("pitch_acc", None), ("sws", "rl")):
        expected = metrics[criterion] if at is None else metrics[criterion].sel({metrics[criterion].dims[-1]: at})
        got = ss.Response(ss.FullCar(), ROAD, criterion, at, weighting=weighting)(X)
        np.testing.assert_allclose(got, expected, rtol=1e-9)
    by_output = ss.Response(ss.FullCar(), ROAD, "sws", "rl", weighting={"sws": weighting})(X)
    expected = ss.ride_metrics(car, ROAD, weighting={"sws": weighting}).sws.sel(corner="rl")
    np.testing.assert_allclose(by_output, expected, rtol=1e-9)


@WEIGHTINGS
def test_the_cheap_vehicle_itself_is_found(weighting):
    fit = fitted(weighting)
    for found in fit.outputs.values():
        assert found.comparison.table.R2["PB ms"] == pytest.approx(1.0, abs=1e-12)
        assert found.models["PB ms"].parameter_ == pytest.approx(350.0, rel=1e-9)
        assert found.verdict.elsewhere is None
    assert closed_form(fit.low_fidelity.response("bacc", ("ks", "cs"))) is None
    assert closed_form(fit.low_fidelity.response("sws", ("ks", "cs"))) is not None


@WEIGHTINGS
def test_a_surrogate_file_keeps_the_weighting(weighting, tmp_path):
    fit = fitted(weighting)
    fit.surrogate.save(tmp_path / "surrogate.json")
    again = ss.load_surrogate(tmp_path / "surrogate.json")
    at = pd.DataFrame({"ks": [18e3], "cs": [1500.0]})
    pd.testing.assert_frame_equal(again.predict(at), fit.surrogate.predict(at), rtol=1e-12)
    assert again.document() == fit.surrogate.document()
    assert (again.low_fidelity.through("sws"), again.low_fidelity.through("bacc") is None) == (None, False)
    name = "Wk" if weighting == "Wk" else "filter"
    assert f"bacc: body vertical acceleration, through {name}, " in ss.report(fit)
    assert "sws: suspension deflection, 0.0" in ss.report(fit)
    document = fit_document(fit)["outputs"]
    assert (document["bacc"]["weighting"], document["sws"]["weighting"]) == (name, None)


def test_a_file_without_a_weighting_has_none(tmp_path):
    path = tmp_path / "surrogate.json"
    fitted(None).surrogate.save(path)
    document = json.loads(path.read_text())
    assert document["low_fidelity"].pop("weighting") is None
    path.write_text(json.dumps(document))
    assert ss.load_surrogate(path).low_fidelity.weighting is None
    for damaged, said in (("Wx", "no weighting named 'Wx'"), (["Wk"], "damaged"), ({"numerator": [1.0]}, "damaged")):
        document["low_fidelity"]["weighting"] = damaged
        path.write_text(json.dumps(document))
        with pytest.raises(ValueError, match=f"surrogate.json: damaged: .*{said if said != 'damaged' else ''}"):
            ss.load_surrogate(path)


@WEIGHTINGS
def test_the_code_of_a_fit_holds_its_weighting(weighting):
    code = fit_code(fitted(weighting))
    ours = [line for line in code.splitlines() if "import" in line or "weighting" in line]
    made = {}
    exec("\n".join(ours[:-1]), made)
    again = eval(ours[-1].strip().removeprefix("weighting=").removesuffix(","), made)
    own, theirs = (ss.LowFidelity(ss.QuarterCar(), ROAD, weighting=one).through("bacc") for one in (weighting, again))
    assert own.same_as(theirs)


@pytest.mark.parametrize(
    ("wrong", "kind", "said"),
    [
        ("Wx", ValueError, "no weighting named 'Wx', available: Wk"),
        (3.0, TypeError, "weighting must be a name or a system of python-control, got 3.0"),
        (float("nan"), TypeError, "weighting must be a name or a system of python-control, got nan"),
        (control.tf([1.0], [1.0, -1.0]), ValueError, "weighting must be stable, got a pole at 1"),
        (control.tf([1.0, 0.0], [1.0]), ValueError, "weighting must be proper"),
    ],
)
def test_a_wrong_weighting_is_refused(wrong, kind, said):
    for ask in (
        lambda: ss.LowFidelity(ss.QuarterCar(), ROAD, weighting=wrong),
        lambda: ss.Response(ss.QuarterCar(), ROAD, weighting=wrong),
    ):
        with pytest.raises(kind, match=said):
            ask()


def test_weightings_by_output_are_for_responses():
    with pytest.raises(TypeError, match=r"weighting must be a name or a system of python-control, got \{'bacc'"):
        ss.LowFidelity(ss.QuarterCar(), ROAD, weighting={"bacc": "Wk"})
    with pytest.raises(ValueError, match="no output named 'heave', available: bacc"):
        ss.Response(ss.QuarterCar(), ROAD, weighting={"heave": "Wk"})


def histories(weighting) -> Runs:
    """Runs as `read_histories` returns them."""
    table = ridden(weighting)
    made = ("read_histories", {"weighting": weighting})
    names = dict.fromkeys(table, "SI")
    return Runs(
        table[["ks", "cs"]], table[["bacc", "sws"]], np.arange(len(table)), "runs", names, names, {**names}, made
    )


def test_runs_that_passed_another_weighting_are_refused():
    cheap = ss.LowFidelity(ss.QuarterCar(), ROAD, "fr", "ms")
    for own, given in ((None, "none"), ("Wd", "Wd"), (LOW_PASS, "filter")):
        said = f"bacc of the runs passed the weighting Wk, and of the cheap model {given}; pass"
        with pytest.raises(ValueError, match=said):
            ss.fit_runs(histories("Wk"), dataclasses.replace(cheap, weighting=own), trust_units=True)
    same = dataclasses.replace(cheap, weighting=ss.weighting("Wk"))
    fit = ss.fit_runs(histories("Wk"), same, folds=2, trust_units=True)
    assert fit.outputs["bacc"].models["PB ms"].parameter_ == pytest.approx(350.0)
    only_travel = dataclasses.replace(histories("Wk"), responses=ridden(None)[["sws"]])
    assert ss.fit_runs(only_travel, cheap, folds=2, trust_units=True).outputs["sws"].chosen == "PB ms"


def test_the_verdict_tries_other_places_with_the_weighting(tmp_path):
    car = ss.FullCar(ks=DESIGNS.ks.to_numpy(), cs=DESIGNS.cs.to_numpy())
    path = tmp_path / "runs.csv"
    DESIGNS.assign(bacc=ss.ride_metrics(car, ROAD, weighting="Wd").bacc.sel(point="cg")).to_csv(path, index=False)
    runs = ss.read_runs(path, {"ks": "ks", "cs": "cs"}, {"bacc": "bacc"})
    found = ss.fit_runs(runs, ss.LowFidelity(ss.FullCar(), ROAD, "fr", weighting="Wd"), folds=3).outputs["bacc"].verdict
    assert (found.elsewhere.setting, found.elsewhere.value) == ("place", "cg")
    assert found.elsewhere.share < 1e-6


def test_the_command_line(tmp_path, run):
    ridden("Wk").to_csv(tmp_path / "runs.csv", index=False)
    asked = ["fit", tmp_path / "runs.csv", "--inputs", "ks,cs", "--outputs", "bacc", "--weighting", "Wk", "--json"]
    code, out, err = run(*asked, *["--road-class", "C", "--speed", "20", "--tracks", "isotropic", "--folds", "2"])
    assert code == 0, err
    found = json.loads(out)["outputs"]["bacc"]
    assert (found["taken"], found["weighting"], found["formula"]["surrogate"]) == ("PB ms", "Wk", "Polynomial 1")
    surrogate = tmp_path / "surrogate.json"
    fitted("Wk").surrogate.save(surrogate)
    code, out, _ = run("predict", surrogate, "--at", "ks=18000,cs=1500")
    assert (code, "bacc is weighted, through Wk" in out, "sws is weighted" in out) == (0, True, False)
    code, out, _ = run("predict", surrogate, "--at", "ks=18000,cs=1500", "--json")
    exact = ss.Response(ss.QuarterCar(ms=350.0), ROAD, "bacc", weighting="Wk")([[18e3, 1500.0]])
    assert json.loads(out)["designs"][0]["bacc"] == pytest.approx(exact.item(), rel=1e-9)
    assert json.loads(out)["weightings"] == {"bacc": "Wk"}
