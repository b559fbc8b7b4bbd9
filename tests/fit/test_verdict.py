"""What is said first of a fit: useless surrogates, suspect runs, forgotten inputs, other units, other places."""

import dataclasses
import warnings

import numpy as np
import pytest

import susp_ss as ss
from susp_ss.fit.verdict import of_mean, suspects, verdict
from susp_ss.presentation.text.fit import judged

ROAD = ss.Road.iso8608("C", speed=20.0, tracks="isotropic")
INPUTS = ["ks", "cs"]


def car_runs(n=16, seed=0, speed=20.0):
    designs = ss.sample({"ks": (15e3, 24e3), "cs": (900.0, 2200.0)}, n, random_state=seed)
    car = ss.FullCar(ks=designs.ks.to_numpy(), cs=designs.cs.to_numpy())
    return designs, ss.ride_metrics(car, dataclasses.replace(ROAD, speed=speed))


def few(f):
    """Surrogates that are quickly fitted."""
    return {"RB": ss.ResponseBased(f), "VB": ss.VariableBased(f), "plane": ss.Polynomial(1), "RBF": ss.RadialBasis()}


def judge(X, y, low_fidelity=None, output="bacc", stated="m/s^2"):
    low_fidelity = low_fidelity or ss.LowFidelity(ss.QuarterCar(), ROAD, "fr")
    f = low_fidelity.response(output, INPUTS)
    surrogates = few(f)
    comparison = ss.compare(surrogates, X, y)
    return verdict(comparison, comparison.best, surrogates, X, y, f(X), low_fidelity, output, stated)


def test_of_mean_is_the_mean_fitted_anew_without_each_run():
    y = np.random.default_rng(0).normal(size=7)
    expected = [np.delete(y, i).mean() - y[i] for i in range(7)]
    np.testing.assert_allclose(of_mean(y), expected, rtol=1e-12)


def test_clean_runs_raise_no_doubt():
    X, metrics = car_runs()
    found = judge(X, metrics.bacc.sel(point="fr").to_numpy())
    assert found.predicts
    assert found.low > 20.0
    assert (found.suspects, found.unit, found.elsewhere) == ((), None, None)


def test_noise_is_not_predicted():
    X, _ = car_runs(16)
    assert not any(judge(X, 2.0 + np.random.default_rng(seed).normal(0.0, 0.3, 16)).predicts for seed in range(3))


@pytest.mark.parametrize("factor", [10.0, 0.1, 1.7])
@pytest.mark.parametrize("run", [0, 7, 15])
def test_one_wrong_cell_is_named(factor, run):
    X, metrics = car_runs()
    y = metrics.bacc.sel(point="fr").to_numpy().copy()
    true = y[run]
    y[run] *= factor
    found = judge(X, y)
    assert [suspect.run for suspect in found.suspects] == [run]
    assert found.suspects[0].times > 10.0
    assert abs(found.suspects[0].predicted - true) < abs(y[run] - true)


def test_two_wrong_cells_of_many_are_named():
    X, metrics = car_runs(30)
    y = metrics.bacc.sel(point="fr").to_numpy().copy()
    y[[3, 21]] *= (4.0, 0.2)
    surrogates = few(ss.LowFidelity(ss.QuarterCar(), ROAD, "fr").response("bacc", INPUTS))
    found = list(suspects(ss.compare(surrogates, X, y), surrogates, X, y))
    assert {suspect.run for suspect in found} == {3, 21}


@pytest.mark.parametrize(
    ("output", "stated", "unit", "in_si"),
    [("bacc", "m/s^2", "g", 9.80665), ("dtl", "N", "kgf", 9.80665), ("dtl", "N", "lbf", 4.4482216)],
)
def test_another_unit_is_named(output, stated, unit, in_si):
    X, metrics = car_runs()
    response = metrics[output].sel({metrics[output].dims[-1]: "fr"}).to_numpy()
    found = judge(X, response / in_si, output=output, stated=stated)
    # A pound-force is half a kilogram-force: which of both, nobody can tell.
    assert found.unit.unit in {unit, *(("kgf",) if unit == "lbf" else ())}
    assert judge(X, response, output=output, stated=stated).unit is None


def test_other_tracks_and_another_place_are_found():
    X, metrics = car_runs()
    y = metrics.bacc.sel(point="cg").to_numpy()
    at_corner = judge(X, y, ss.LowFidelity(ss.FullCar(), ROAD, "fr"))
    assert (at_corner.elsewhere.setting, at_corner.elsewhere.value) == ("place", "cg")
    assert at_corner.elsewhere.share < 1e-6
    identical = dataclasses.replace(ROAD, tracks="identical")
    other_tracks = judge(X, y, ss.LowFidelity(ss.FullCar(), identical, "cg"))
    assert (other_tracks.elsewhere.setting, other_tracks.elsewhere.value) == ("tracks", "isotropic")
    assert judge(X, y, ss.LowFidelity(ss.FullCar(), ROAD, "cg")).elsewhere is None


@pytest.fixture(scope="module")
def useless(tmp_path_factory):
    """Runs at many speeds, of which the speed was forgotten; and one cell wrong in another column."""
    speed = np.random.default_rng(1).uniform(8.0, 35.0, 14)
    X, metrics = car_runs(14, speed=speed)
    bacc = metrics.bacc.sel(point="fr").to_numpy().copy()
    sws = car_runs(14)[1].sws.sel(corner="fr").to_numpy().copy()
    sws[4] *= 10.0
    path = tmp_path_factory.mktemp("runs") / "runs.csv"
    X.assign(bacc=bacc, sws=sws, v=speed).to_csv(path, index=False)
    runs = ss.read_runs(path, {"ks": "ks", "cs": "cs"}, {"bacc": "bacc", "sws": "sws"})
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UserWarning)
        return ss.fit_runs(runs, ss.LowFidelity(ss.QuarterCar(), ROAD, "fr"))


def test_the_report_the_document_and_the_file_say_it_first(useless, tmp_path):
    text = ss.report(useless)
    bacc, sws = (judged(useless, output) for output in ("bacc", "sws"))
    assert bacc[0].startswith("NOTHING HERE PREDICTS bacc: the best is ")
    assert "of the columns that were not asked for (v)?" in bacc[1]
    assert any(line.startswith(f"Check {useless.runs.path}, line 6, column 'sws': ") for line in sws)
    assert text.index("NOTHING HERE PREDICTS bacc") < text.index("max error")
    assert useless.surrogate.accuracy["bacc"]["predicts"] is False
    from susp_ss.presentation.documents import fit_document

    document = fit_document(useless)
    assert document["outputs"]["bacc"]["predicts"] is False
    assert document["outputs"]["bacc"]["verdict"] == bacc


def test_nothing_is_wrong_without_a_cheap_model():
    X, metrics = car_runs()
    y = metrics.roll_acc.to_numpy()
    surrogates = {"plane": ss.Polynomial(1), "RBF": ss.RadialBasis()}
    comparison = ss.compare(surrogates, X, y)
    cheap = ss.LowFidelity(ss.QuarterCar(), ROAD, "fr")
    found = verdict(comparison, comparison.best, surrogates, X, y, None, cheap, "roll_acc", "rad/s^2")
    assert (found.predicts, found.unit, found.elsewhere) == (True, None, None)
