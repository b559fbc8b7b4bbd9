"""Plans that fill a box, and errors against the number of runs where these are known."""

import warnings

import numpy as np
import pandas as pd
import pytest
from sklearn.base import BaseEstimator, RegressorMixin

import susp_ss as ss
from susp_ss.surrogates import learning

BOX = {"a": (-1.0, 1.0), "b": (10.0, 30.0)}


def cheap(X):
    return np.sin(3.0 * X[:, 0]) + (X[:, 1] / 20.0) ** 2


def expensive(X):
    return 1.0 + 2.0 * cheap(X)


class Witness(RegressorMixin, BaseEstimator):
    """Notes what it was fitted to and asked for."""

    def __init__(self, notes=None):
        self.notes = notes

    def get_params(self, deep=True):
        return {}

    def fit(self, X, y):
        Witness.notes.append([np.asarray(X), None])
        return self

    def predict(self, X):
        Witness.notes[-1][1] = np.asarray(X)
        return np.zeros(len(X))


@pytest.fixture
def notes():
    Witness.notes = []
    return Witness.notes


def without_time(table):
    return table.drop(columns="seconds")


@pytest.mark.parametrize("runs", [1, 7, 32])
def test_a_latin_hypercube_has_one_design_in_every_slice(runs):
    X = ss.sample(BOX, runs, random_state=4)
    assert list(X) == ["a", "b"]
    for name, (low, high) in BOX.items():
        slices = np.floor((X[name] - low) / (high - low) * runs).astype(int)
        assert sorted(slices) == list(range(runs))


def test_a_sobol_sequence_grows_by_its_beginning():
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        few, many = ss.sample(BOX, 13, "sobol"), ss.sample(BOX, 64, "sobol")
    np.testing.assert_array_equal(few, many[:13])
    # Balanced: every cell of an 8 x 8 grid holds one design of 64.
    low, high = np.array(list(BOX.values())).T
    cells = np.floor((many.to_numpy() - low) / (high - low) * 8).astype(int)
    assert len(np.unique(cells, axis=0)) == 64


@pytest.mark.parametrize("method", ["latin_hypercube", "sobol"])
def test_designs_are_those_of_the_seed(method):
    one, same, other = (ss.sample(BOX, 9, method, random_state=seed) for seed in (1, 1, 2))
    pd.testing.assert_frame_equal(one, same)
    assert (one != other).to_numpy().all()


@pytest.mark.parametrize(
    ("arguments", "error", "match"),
    [
        (([(0, 1)], 5), TypeError, "box must map the name of each variable"),
        (({}, 5), TypeError, "box must map"),
        (({"ks": (1.0,)}, 5), ValueError, r"box\['ks'\] must be two numbers \(low, high\), got \(1.0,\)"),
        (({"ks": (2.0, 1.0)}, 5), ValueError, r"box\['ks'\] must rise between finite numbers"),
        (({"ks": (0.0, np.inf)}, 5), ValueError, "must rise between finite numbers"),
        ((BOX, 0), ValueError, "runs must be a whole number >= 1, got 0"),
        ((BOX, 5, "halton"), ValueError, "method must be one of latin_hypercube, sobol, got 'halton'"),
    ],
)
def test_bad_samples(arguments, error, match):
    with pytest.raises(error, match=match):
        ss.sample(*arguments)


@pytest.mark.parametrize("sampling", ["latin_hypercube", "sobol"])
def test_a_scaled_model_is_found_from_any_number_of_runs(sampling):
    table = ss.learning_curve({"RB": ss.ResponseBased(cheap)}, expensive, BOX, (3, 5, 20), sampling, repeats=2, test=64)
    assert table["runs"].tolist() == [3, 3, 5, 5, 20, 20]
    assert table["repeat"].tolist() == [0, 1] * 3
    assert (table["RMSE"] < 1e-9).all()
    assert (table["R2"] > 1.0 - 1e-12).all()
    assert table["refused"].isna().all()


def test_kriging_learns_and_is_not_tried_beyond_its_limit():
    surrogates = {"Kriging": ss.Kriging(), "plane": ss.Polynomial(1)}
    table = ss.learning_curve(surrogates, expensive, BOX, (6, 12, 24), repeats=2, test=64, limits={"Kriging": 23})
    kriging, plane = (table[table["surrogate"] == name].groupby("runs")["RMSE"] for name in surrogates)
    assert kriging.median()[12] < 0.5 * kriging.median()[6]
    capped = table[(table["surrogate"] == "Kriging") & (table["runs"] == 24)]
    assert capped["refused"].tolist() == ["not tried above 23 runs"] * 2
    assert capped[["R2", "RMSE", "MAE", "seconds"]].isna().all(axis=None)
    assert plane.count().tolist() == [2, 2, 2]


def test_kriging_has_a_limit_by_default(notes, monkeypatch):
    monkeypatch.setattr("susp_ss.surrogates.learning.MANY", 100)
    surrogates = {"one": ss.Kriging(), "two": ss.CoKriging(cheap), "free": Witness()}
    table = ss.learning_curve(surrogates, expensive, BOX, (101,), repeats=1, test=4)
    assert table["refused"].isna().tolist() == [False, False, True]
    assert learning._most(surrogates, {}) == {}


def test_a_refused_fit_is_listed():
    table = ss.learning_curve({"quadratic": ss.Polynomial(2)}, expensive, BOX, (5, 6), repeats=1, test=8)
    assert table["RMSE"].isna().tolist() == [True, False]
    assert table["refused"][0].startswith("degree 2 in 2 variable(s) has 6 coefficients")


def test_tables_are_those_of_the_seed():
    def table(seed):
        return without_time(ss.learning_curve({"plane": ss.Polynomial(1)}, expensive, BOX, (8,), random_state=seed))

    pd.testing.assert_frame_equal(table(1), table(1))
    assert (table(1)["RMSE"] != table(2)["RMSE"]).all()
    assert table(1)["RMSE"].nunique() == 5


def test_all_are_tested_at_the_same_designs_that_none_was_fitted_to(notes):
    ss.learning_curve({"one": Witness(), "two": Witness()}, expensive, BOX, (4, 16), repeats=2, test=50)
    tests = [test for _, test in notes]
    assert len(tests) == 8
    for fitted, test in notes:
        np.testing.assert_array_equal(test, tests[0])
        assert len(np.unique(np.concatenate([fitted, test]), axis=0)) == len(fitted) + 50
    np.testing.assert_array_equal(notes[0][0], notes[1][0])


def test_the_error_is_that_at_the_test_designs(notes):
    table = ss.learning_curve({"zero": Witness()}, expensive, BOX, (4,), repeats=1, test=32)
    F = expensive(notes[0][1])
    assert table["RMSE"][0] == pytest.approx(np.sqrt(np.mean(F**2)), rel=1e-12)
    assert table["MAE"][0] == pytest.approx(np.abs(F).max(), rel=1e-12)


def test_runs_at_hand_are_tested_where_they_were_not_fitted(notes):
    X = ss.sample(BOX, 20)
    X = pd.concat([X, X[:5]], ignore_index=True)
    table = ss.learning_curve_of_runs({"zero": Witness()}, X, expensive(X.to_numpy()), (4, 12), repeats=3)
    assert table["runs"].tolist() == [4] * 3 + [12] * 3
    for fitted, test in notes:
        assert not {*map(tuple, fitted)} & {*map(tuple, test)}
        assert {*map(tuple, fitted)} | {*map(tuple, test)} == {*map(tuple, X.to_numpy())}
    # Within a repeat the larger draw holds the smaller.
    np.testing.assert_array_equal(notes[3][0][:4], notes[0][0])


@pytest.mark.parametrize("times", [(3,) * 7, (8, 1, 1, 1, 1), (1, 2, 3, 4, 5)])
def test_repeated_runs_leave_designs_to_test_at(notes, times):
    X = np.repeat(ss.sample(BOX, len(times)).to_numpy(), times, axis=0)
    learning_curve = ss.learning_curve_of_runs({"zero": Witness()}, X, expensive(X), repeats=4)
    assert learning_curve["refused"].isna().all()
    for fitted, test in notes:
        assert len(test) >= 2
        assert not {*map(tuple, fitted)} & {*map(tuple, test)}


def test_runs_at_hand_with_a_known_truth():
    X = ss.sample(BOX, 30).to_numpy()
    surrogates = {"RB": ss.ResponseBased(cheap), "plane": ss.Polynomial(1)}
    tables = [ss.learning_curve_of_runs(surrogates, X, expensive(X), repeats=2) for _ in range(2)]
    pd.testing.assert_frame_equal(*map(without_time, tables))
    errors = tables[0].pivot_table("RMSE", "runs", "surrogate")
    assert errors.index.tolist() == [5, 10, 20, 24]
    assert (errors["RB"] < 1e-9).all()
    assert (errors["plane"] > 0.1).all()


def test_a_quarter_car_tuned_to_a_full_car():
    """A plane has less to carry beside the quarter car than alone; a cubic needs ten runs, and then outdoes both."""
    road = ss.Road.iso8608("B", speed=20.0, tracks="isotropic")
    quarter, full = ss.Response(ss.QuarterCar(), road), ss.Response(ss.FullCar(), road, at="fr")
    box = {"ks": (12536.0, 24570.0), "cs": (798.0, 2235.0)}
    surrogates = {"VB": ss.VariableBased(quarter), "plane": ss.Polynomial(1), "cubic": ss.Polynomial(3)}
    table = ss.learning_curve(surrogates, full, box, (5, 40), repeats=3, test=64)
    error = table.pivot_table("RMSE", "runs", "surrogate", aggfunc="median")
    assert error.loc[40, "cubic"] < error.loc[40, "VB"] < error.loc[40, "plane"]
    assert (error.loc[5, ["VB", "plane"]] > error.loc[40, ["VB", "plane"]]).all()
    assert np.isnan(error.loc[5, "cubic"])
    with pytest.raises(ValueError, match=r"box must have the inputs of expensive in their order, ks, cs, got \['cs', "):
        ss.learning_curve(surrogates, full, {"cs": box["cs"], "ks": box["ks"]})


@pytest.mark.parametrize(
    ("change", "error", "match"),
    [
        ({"surrogates": {}}, TypeError, "surrogates must map names"),
        ({"expensive": 3}, TypeError, "expensive must be a callable"),
        ({"expensive": lambda X: X}, ValueError, "expensive must return one number for each design"),
        ({"budgets": (5, 0)}, ValueError, "budgets must be a whole number >= 1, got 0"),
        ({"repeats": 0}, ValueError, "repeats must be a whole number >= 1, got 0"),
        ({"test": 1}, ValueError, "test must be a whole number >= 2, got 1"),
        ({"random_state": -1}, ValueError, "random_state must be a whole number >= 0, got -1"),
        ({"limits": {"spline": 5}}, ValueError, "limits has no surrogate named 'spline', available: plane"),
        ({"sampling": "grid"}, ValueError, "method must be one of"),
    ],
)
def test_bad_arguments(change, error, match):
    good = {"surrogates": {"plane": ss.Polynomial(1)}, "expensive": expensive, "box": BOX, "budgets": (5,)}
    with pytest.raises(error, match=match):
        ss.learning_curve(**(good | change))


def test_runs_at_hand_must_leave_some_to_test_at():
    X = ss.sample(BOX, 8).to_numpy()
    for budget in (7, 8, 9):
        with pytest.raises(ValueError, match=f"budgets must leave two or more of the 8 runs to test at, got {budget}"):
            ss.learning_curve_of_runs({"plane": ss.Polynomial(1)}, X, X[:, 0], (budget,))
    for n, most in ((4, 2), (5, 3), (8, 6)):
        table = ss.learning_curve_of_runs({"plane": ss.Polynomial(1)}, X[:n], X[:n, 0], repeats=1)
        assert table["runs"].max() == most
