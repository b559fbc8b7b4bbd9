"""Validation against closed forms of leave-one-out, known distributions, and data whose best surrogate is known."""

import warnings

import numpy as np
import pandas as pd
import pytest
from scipy import stats
from sklearn.base import BaseEstimator, RegressorMixin
from sklearn.linear_model import BayesianRidge
from sklearn.model_selection import cross_val_predict
from sklearn.neighbors import KNeighborsRegressor
from sklearn.pipeline import make_pipeline
from sklearn.preprocessing import PolynomialFeatures, StandardScaler

import susp_ss as ss
from susp_ss.surrogates import Validation, bootstrap
from susp_ss.surrogates.by_coefficients import without_rows
from susp_ss.surrogates.folds import split, unfitted, uses_low_fidelity
from susp_ss.surrogates.radial_basis import leave_one_out


def cheap(X):
    return np.sin(3.0 * X[:, 0]) + X[:, 1] ** 2


class Stated(RegressorMixin, BaseEstimator):
    """Predicts zero and states a standard deviation."""

    def __init__(self, std=1.0):
        self.std = std

    def fit(self, X, y):
        self.fitted_ = True
        return self

    def predict(self, X, return_std=False):
        zero = np.zeros(len(X))
        return (zero, zero + self.std) if return_std else zero


def plan(n, k=2, seed=0):
    return np.random.default_rng(seed).uniform(-1.0, 1.0, (n, k))


def hat_errors(columns, y):
    """Leave-one-out errors of a least-squares fit, ``e_i / (1 - h_ii)``, as prediction minus response."""
    H = columns @ np.linalg.pinv(columns)
    return (H @ y - y) / (1.0 - np.diag(H))


def from_errors(errors, y, confidence=0.95):
    return Validation(y, y + errors, None, None, confidence)


def test_leave_one_out_of_a_polynomial_is_that_of_the_hat_matrix():
    X = plan(14)
    y = np.exp(X[:, 0]) * X[:, 1]
    expected = hat_errors(PolynomialFeatures(2).fit_transform(X), y)
    np.testing.assert_allclose(ss.cross_validate(ss.Polynomial(2), X, y).residuals, expected, rtol=1e-8, atol=1e-12)


def test_leave_one_out_of_a_radial_basis_is_that_of_one_inverse():
    """The corners come in pairs on every side, so that the box is the same without any one of them."""
    X = np.concatenate([[[-1, -1], [-1, 1], [1, -1], [1, 1]], 0.9 * plan(9)])
    y = cheap(X)
    found = ss.cross_validate(ss.RadialBasis("gaussian", shape=1.3), X, y)
    np.testing.assert_allclose(found.residuals, -leave_one_out(X, y, "gaussian", 1.3, 0), rtol=1e-6, atol=1e-9)
    assert not found.outside.any()


def test_response_based_on_the_full_car_is_that_of_the_hat_matrix():
    road = ss.Road.iso8608("B", speed=20.0, tracks="isotropic")
    quarter, full = ss.Response(ss.QuarterCar(), road), ss.Response(ss.FullCar(), road, at="fr")
    X = ss.sample({"ks": (12536.0, 24570.0), "cs": (798.0, 2235.0)}, 15)
    f, F = quarter(X), full(X)
    found = ss.compare({"RB": ss.ResponseBased(quarter), "plane": ss.Polynomial(1)}, X, F)
    expected = hat_errors(np.column_stack([np.ones_like(f), f]), F)
    np.testing.assert_allclose(found.validations["RB"].residuals, expected, rtol=1e-6, atol=1e-9)
    rmse = {"RB": expected, "plane": hat_errors(np.column_stack([np.ones_like(f), X]), F)}
    rmse = {name: np.sqrt(np.mean(errors**2)) for name, errors in rmse.items()}
    assert found.best == min(rmse, key=rmse.get)
    assert found.gain().ratio == pytest.approx(rmse["plane"] / rmse["RB"], rel=1e-6)


def test_accuracy_is_that_of_the_predictions():
    X, y = plan(12), cheap(plan(12))
    found = ss.cross_validate(ss.Polynomial(1), X, y)
    assert found.accuracy == ss.accuracy(y, found.predicted)
    np.testing.assert_allclose(found.predicted - found.residuals, y, atol=1e-15)
    assert found.std is found.coverage is found.coverage_interval is found.margin is None


@pytest.mark.parametrize("folds", [2, 7, 40])
def test_every_run_is_predicted_once_without_itself(folds):
    X = plan(40)
    left_out = []
    for fitted, predicted in split(X, folds, 3):
        assert sorted([*fitted, *predicted]) == list(range(40))
        left_out += list(predicted)
    assert sorted(left_out) == list(range(40))
    # A neighbour that knew the run would return its response.
    assert (ss.cross_validate(KNeighborsRegressor(1), X, X[:, 0], folds, random_state=3).residuals != 0.0).all()


def test_number_of_folds():
    assert [len(split(plan(n), None, 0)) for n in (2, 30, 31, 200)] == [2, 30, 10, 10]
    sizes = [len(predicted) for _, predicted in split(plan(33), None, 0)]
    assert set(sizes) == {3, 4}


@pytest.mark.parametrize(
    "surrogate",
    [
        ss.ResponseBased(cheap),
        ss.ResponseBased(cheap, terms=(False, True)),
        ss.ResponseBased(lambda X: 3.0 + cheap(X), form="power"),
        ss.VariableBased(cheap),
        ss.VariableBased(cheap, nonnegative=True),
        ss.ParameterBased(lambda X, a: cheap(X) + np.sin(a * X[:, 0]), bounds=(0.1, 3.0)),
        ss.Polynomial(3),
    ],
)
def test_folds_are_predicted_as_by_fits_without_them(surrogate):
    X = plan(24)
    y = 4.0 + cheap(X) + 0.1 * np.exp(X[:, 0])
    expected = cross_val_predict(surrogate, X, y, cv=split(X, 5, 0))
    np.testing.assert_allclose(ss.cross_validate(surrogate, X, y, folds=5).predicted, expected, rtol=1e-8)


def test_a_design_far_from_all_others_leaves_no_closed_form_without_it():
    x = np.append(np.linspace(-1.0, 1.0, 9), 1e5)
    columns, y = np.column_stack([np.ones(10), x / 1e5]), np.append(np.exp(x[:9]), 7.0)
    assert without_rows(columns, y, np.linalg.lstsq(columns, y)[0], [np.array([9])]) is None
    expected = np.polynomial.Polynomial.fit(x[:9], y[:9], 1)(1e5)
    assert ss.cross_validate(ss.Polynomial(1), x[:, None], y).predicted[9] == pytest.approx(expected, rel=1e-8)


def test_folds_are_those_of_the_seed():
    X, y = plan(40), cheap(plan(40))
    one, same, other = (ss.cross_validate(ss.Polynomial(2), X, y, random_state=seed).predicted for seed in (1, 1, 2))
    np.testing.assert_array_equal(one, same)
    assert (one != other).any()


@pytest.mark.parametrize("folds", [None, 5])
def test_equal_designs_are_left_out_together(folds):
    once = plan(12)
    twice, y = np.concatenate([once, once]), np.tile(once[:, 0], 2)
    found = ss.cross_validate(KNeighborsRegressor(1), twice, y, folds)
    assert (found.residuals != 0.0).all()
    if folds is None:
        alone = ss.cross_validate(KNeighborsRegressor(1), once, once[:, 0])
        np.testing.assert_array_equal(found.predicted, np.tile(alone.predicted, 2))


def test_tables_keep_their_names():
    X = pd.DataFrame(plan(9), columns=["ks", "cs"], index=range(100, 109))
    y = pd.Series(cheap(X.to_numpy()), index=X.index)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        named = ss.cross_validate(ss.Polynomial(1), X, y)
    np.testing.assert_array_equal(named.predicted, ss.cross_validate(ss.Polynomial(1), X.to_numpy(), y).predicted)


def test_runs_outside_the_box_of_the_others_are_counted_not_warned_of():
    X = np.linspace(0.0, 1.0, 7)[:, None]
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        found = ss.cross_validate(ss.Polynomial(1), X, X[:, 0] ** 2)
        beyond = ss.held_out(ss.Polynomial(1).fit(X, X[:, 0]), [[0.5], [2.0]], [0.5, 2.0])
    assert found.outside.tolist() == [True, *[False] * 5, True]
    assert beyond.outside.tolist() == [False, True]
    assert ss.cross_validate(KNeighborsRegressor(1), X, X[:, 0]).outside is None


def test_the_low_fidelity_model_is_shared_and_the_settings_are_kept():
    model = ss.VariableBased(cheap, nonnegative=True, terms=[True, False, True])
    copy = unfitted(model)
    assert copy is not model
    assert copy.low_fidelity is cheap
    assert copy.get_params() == model.get_params()
    assert not hasattr(unfitted(ss.ResponseBased(cheap).fit(plan(5), cheap(plan(5)))), "coef_")

    class Costly:
        def __call__(self, X):
            return cheap(X)

        def __deepcopy__(self, memo):
            raise AssertionError("copied")

    ss.cross_validate(ss.ResponseBased(Costly()), plan(5), cheap(plan(5)))


def test_a_pipeline_may_use_a_low_fidelity_model():
    assert uses_low_fidelity(make_pipeline(StandardScaler(), ss.ResponseBased(cheap)))
    assert not uses_low_fidelity(make_pipeline(StandardScaler(), ss.Kriging()))


@pytest.mark.parametrize(("std", "share"), [(1.5, 0.95), (0.75, 2 * stats.norm.cdf(1.959964 / 2) - 1)])
def test_coverage_of_known_errors(std, share):
    """Responses of standard deviation 1.5 about the prediction; stating half of it covers 67 %."""
    y = np.random.default_rng(5).normal(0.0, 1.5, 600)
    X = np.arange(600.0)[:, None]
    found = ss.held_out(Stated(std).fit(X, y), X, y)
    hits = round(found.coverage * 600)
    assert stats.binomtest(hits, 600, share).pvalue > 0.01
    assert stats.binomtest(hits, 600, 1.0 - share).pvalue < 1e-9
    low, high = found.coverage_interval
    assert low < share < high
    # Clopper and Pearson by the quantiles of the beta distribution.
    expected = stats.beta.ppf(0.025, hits, 601 - hits), stats.beta.ppf(0.975, hits + 1, 600 - hits)
    assert (low, high) == pytest.approx(expected, rel=1e-9)


def test_cross_validation_takes_a_standard_deviation_of_any_regressor():
    X = plan(25)
    y = X @ [1.0, -2.0] + np.random.default_rng(1).normal(0.0, 0.1, 25)
    found = ss.cross_validate(BayesianRidge(), X, y, confidence=0.9)
    assert found.margin == pytest.approx(1.6448536 * found.std, rel=1e-6)
    assert stats.binomtest(round(found.coverage * 25), 25, 0.9).pvalue > 0.01


def test_kriging_states_its_standard_deviation_where_it_predicts():
    X = plan(12, 1)
    y = np.sin(3.0 * X[:, 0])
    found = ss.cross_validate(ss.Kriging(), X, y, folds=3, refit=True)
    fitted, left_out = split(X, 3, 0)[0]
    mean, std = ss.Kriging().fit(X[fitted], y[fitted]).predict(X[left_out], return_std=True)
    np.testing.assert_allclose(found.predicted[left_out], mean, rtol=1e-12)
    np.testing.assert_allclose(found.std[left_out], std, rtol=1e-12)


@pytest.mark.parametrize("surrogate", [ss.Kriging(), ss.CoKriging(cheap), ss.RadialBasis("gaussian")])
def test_what_a_choice_in_every_fold_costs_is_told(surrogate):
    X = plan(16, 2)
    y = cheap(X) ** 2
    at_once, anew = (ss.cross_validate(surrogate, X, y, folds=4, refit=refit) for refit in (False, True))
    assert at_once.fixed is None
    np.testing.assert_array_equal(anew.fixed, at_once.predicted)
    np.testing.assert_array_equal(anew.outside, at_once.outside)
    table = ss.compare({"one": surrogate, "plane": ss.Polynomial(1)}, X, y, folds=4, refit=True).table
    assert table.RMSE_fixed["one"] == at_once.accuracy.RMSE != table.RMSE["one"]
    assert np.isnan(table.RMSE_fixed["plane"])


def test_intervals_hold_the_truth_about_as_often_as_they_say(monkeypatch):
    """Errors of RMSE 1 and responses of variance 4 about them, so that R2 is 3/4."""
    monkeypatch.setattr(bootstrap, "RESAMPLES", 499)
    rng = np.random.default_rng(0)
    held = np.zeros(2)
    for _ in range(200):
        low, high = from_errors(rng.normal(size=40), rng.normal(0.0, 2.0, 40), confidence=0.9).interval
        held += [low.RMSE < 1.0 < high.RMSE, low.R2 < 0.75 < high.R2]
    # Two standard deviations of 200 draws are 4 %; the bootstrap of 40 runs is itself some 2 % short.
    assert (held / 200 > 0.83).all()
    assert (held / 200 < 0.96).all()


def test_a_maximum_has_no_interval_nor_have_errors_all_alike():
    low, high = from_errors(np.random.default_rng(0).normal(size=20), np.arange(20.0)).interval
    assert np.isnan([low.MAE, high.MAE]).all()
    low, high = from_errors(np.full(20, 0.5), np.arange(20.0)).interval
    assert np.isnan([low.RMSE, high.RMSE]).all()


@pytest.fixture(scope="module")
def comparison():
    """F = 2 f + noise of 0.05: RB is as good as the noise, and nothing else comes near."""
    X = plan(60, seed=2)
    F = 2.0 * cheap(X) + np.random.default_rng(3).normal(0.0, 0.05, 60)
    surrogates = {
        "plane": ss.Polynomial(1),
        "wild": ss.Polynomial(15),
        "quadratic": ss.Polynomial(2),
        "RB": ss.ResponseBased(cheap),
        "RB again": ss.ResponseBased(cheap),
        "VB": ss.VariableBased(cheap),
    }
    return ss.compare(surrogates, X, F)


def test_the_best_is_the_one_that_made_the_data(comparison):
    table = comparison.table
    # Rounding decides between the two.
    assert comparison.best in {"RB", "RB again"}
    assert comparison.baseline == "quadratic"
    assert set(comparison.tied) == {"RB", "RB again"}
    assert table["RMSE"].is_monotonic_increasing
    assert table.loc["RB", "RMSE_low"] < 0.05 < table.loc["RB", "RMSE_high"]
    assert table["low_fidelity"].to_dict() == {
        "RB": True,
        "RB again": True,
        "VB": True,
        "quadratic": False,
        "plane": False,
    }
    assert table["coverage"].isna().all()
    assert (table["outside"] == comparison.validations["RB"].outside.sum()).all()
    assert (table["seconds"] > 0.0).all()


def test_the_gain_is_the_ratio_of_errors(comparison):
    gain = comparison.gain()
    assert (gain.tuned, gain.baseline) == (comparison.best, "quadratic")
    rmse = comparison.table["RMSE"]
    assert gain.ratio == pytest.approx(rmse["quadratic"] / rmse["RB"], rel=1e-12)
    assert 1.0 < gain.low < gain.ratio < gain.high


def test_what_cannot_be_fitted_is_listed(comparison):
    assert list(comparison.refused) == ["wild"]
    assert comparison.refused["wild"].startswith("fold 1 of 10, fitted to 54 of 60 runs: degree 15 in 2 variable(s)")
    assert "wild" not in comparison.table.index


def test_a_worse_surrogate_is_told_from_the_best_and_a_chance_is_not():
    X, rng = plan(200, 1), np.random.default_rng(4)
    y = rng.normal(size=200)

    class Constant(Stated):
        def predict(self, X):
            return np.full(len(X), self.std)

    found = ss.compare({"zero": Constant(0.0), "close": Constant(0.02), "far": Constant(1.0)}, X, y)
    assert set(found.tied) == {"zero", "close"}
    exact = ss.compare({"exact": Constant(0.0), "worse by the same": Constant(1.0)}, X, np.tile([1e-9, -1e-9], 100))
    assert exact.tied == ("exact",)


def test_a_baseline_joins_where_there_is_none():
    X = plan(12, 1)
    found = ss.compare({"RB": ss.ResponseBased(lambda X: np.exp(X[:, 0]))}, X, 1.0 + np.exp(X[:, 0]), folds=4)
    assert set(found.table.index) == {"RB", "Polynomial (baseline)", "RadialBasis (baseline)", "Kriging (baseline)"}
    assert found.best == "RB"
    assert found.baseline == found.table.index[1]
    assert 0.0 <= found.table.loc["Kriging (baseline)", "coverage"] <= 1.0


def test_no_gain_without_both():
    X = plan(8)
    with pytest.raises(ValueError, match="a gain needs a fitted surrogate with a low-fidelity model, got none"):
        ss.compare({"plane": ss.Polynomial(1)}, X, cheap(X)).gain()
    both = {"plane": ss.Polynomial(9), "RB": ss.ResponseBased(cheap)}
    with pytest.raises(ValueError, match=r"without its low-fidelity model, got none; plane: fold 1 of 8"):
        ss.compare(both, X, cheap(X)).gain()


@pytest.mark.parametrize("progress", [True, False])
def test_progress_goes_to_stderr(capsys, monkeypatch, progress):
    monkeypatch.setenv("FORCE_COLOR", "1")
    ss.compare({"plane": ss.Polynomial(1)}, plan(6), cheap(plan(6)), progress=progress)
    out, err = capsys.readouterr()
    assert out == ""
    assert ("comparing" in err) is progress


@pytest.mark.parametrize(
    ("change", "error", "match"),
    [
        ({"folds": 1}, ValueError, "folds must be a whole number from 2 to the 8 different designs, got 1"),
        ({"folds": 9}, ValueError, "from 2 to the 8 different designs, got 9"),
        ({"folds": True}, ValueError, "folds must be a whole number"),
        ({"confidence": 1.0}, ValueError, "confidence must be a number between 0 and 1, got 1.0"),
        ({"y": np.ones(7)}, ValueError, "inconsistent numbers of samples"),
        ({"y": np.full(8, np.nan)}, ValueError, "NaN"),
        ({"surrogates": [ss.Kriging()]}, TypeError, "surrogates must map names to regressors"),
        ({"surrogates": {}}, TypeError, "surrogates must map names to regressors"),
        ({"surrogates": {"high": ss.Polynomial(9)}}, ValueError, "no surrogate can be fitted: high: fold 1 of 8"),
        ({"surrogates": {"RB": ss.ResponseBased(3)}}, TypeError, "low_fidelity must be a callable"),
    ],
)
def test_bad_arguments(change, error, match):
    good = {"surrogates": {"plane": ss.Polynomial(1)}, "X": plan(8), "y": cheap(plan(8))}
    with pytest.raises(error, match=match):
        ss.compare(**(good | change))


def test_a_refusal_states_the_size_of_the_fold():
    with pytest.raises(ValueError, match=r"fold 1 of 6, fitted to 5 of 6 runs: degree 2 in 2 variable"):
        ss.cross_validate(ss.Polynomial(2), plan(6), cheap(plan(6)))


@pytest.mark.parametrize("n", [6, 19, 21, 60])
@pytest.mark.parametrize("stated", [False, True])
def test_an_allowance_is_what_the_other_runs_say(n, stated):
    rng = np.random.default_rng(n)
    y, std = rng.normal(size=n), rng.uniform(0.5, 2.0, n) if stated else None
    one = Validation(y, y + rng.normal(size=n) * (1.0 if std is None else std), std, None)
    size = np.ones(n) if std is None else std
    for i in range(n):
        others = np.sort(np.delete(abs(one.residuals) / size, i))
        if n >= 20:
            # At least 95 % of n, the run itself among them.
            expected = others[np.ceil(0.95 * n).astype(int) - 1]
        else:
            expected = stats.t(n - 1).ppf(0.975) * np.sqrt(np.mean(others**2))
        assert one.allowance[i] == pytest.approx(size[i] * expected)


def test_an_allowance_holds_independent_errors():
    held = []
    for seed in range(200):
        y = np.random.default_rng(seed).normal(size=40)
        one = Validation(y, np.zeros(40), None, None)
        held.append(np.mean(abs(one.residuals) <= one.allowance))
    assert np.mean(held) == pytest.approx(0.95, abs=0.01)
