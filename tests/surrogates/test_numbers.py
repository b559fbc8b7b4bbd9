"""A surrogate that went through text predicts the same, to the last digit."""

import json

import numpy as np
import pandas as pd
import pytest
from sklearn.base import clone

import susp_ss as ss
from susp_ss.surrogates.numbers import KINDS, from_numbers, to_numbers


def cheap(X, value=1.0):
    X = np.asarray(X, dtype=float)
    return 1.0 + value * np.sin(X[:, 0]) + X[:, 1] ** 2


FITTED = [
    ss.ResponseBased(cheap, nonnegative=True),
    ss.ResponseBased(cheap, form="power"),
    ss.VariableBased(cheap, terms=(True, False, True)),
    ss.ParameterBased(cheap, bounds=(0.1, 3.0)),
    ss.Polynomial(degree=3),
    ss.RadialBasis(),
    ss.RadialBasis("gaussian", degree=1),
    ss.Kriging("linear"),
    ss.CoKriging(cheap),
]


@pytest.mark.parametrize("surrogate", FITTED, ids=lambda s: type(s).__name__)
@pytest.mark.parametrize("named", [False, True])
def test_through_text_and_back(surrogate, named):
    rng = np.random.default_rng(5)
    X, T = rng.uniform([0.3, 10.0], [3.0, 11.0], (25, 2)), rng.uniform([0.3, 10.0], [3.0, 11.0], (40, 2))
    if named:
        X, T = pd.DataFrame(X, columns=["ks", "cs"]), pd.DataFrame(T, columns=["ks", "cs"])
    fitted = clone(surrogate).fit(X, 10.0 + cheap(X, 0.7) ** 1.01)
    text = json.dumps(to_numbers(fitted), allow_nan=False)
    again = from_numbers(json.loads(text), cheap)
    if not named:
        bounds = (model.predict(T, interval=0.95)[1] for model in (again, fitted))
        np.testing.assert_array_equal(*bounds)
    np.testing.assert_array_equal(again.predict(T), fitted.predict(T))
    np.testing.assert_array_equal(again.outside(T), fitted.outside(T))
    if hasattr(fitted, "theta_") or hasattr(fitted, "rho_"):
        np.testing.assert_array_equal(again.predict(T, return_std=True)[1], fitted.predict(T, return_std=True)[1])
    for name in ("intercept_", "coef_", "parameter_", "terms_", "theta_", "rho_", "shape_"):
        if hasattr(fitted, name):
            np.testing.assert_array_equal(getattr(again, name), getattr(fitted, name))
    if named:
        with pytest.raises(ValueError, match="feature names"):
            again.predict(T[["cs", "ks"]])


@pytest.mark.parametrize("k", [1, 2, 3, 4])
@pytest.mark.parametrize("surrogate", [ss.Kriging(), ss.CoKriging(lambda X: np.sin(X.sum(axis=1)))], ids=["one", "two"])
def test_thetas_of_any_number_of_variables(surrogate, k):
    X = np.random.default_rng(k).uniform(size=(12, k)) * np.arange(1.0, k + 1)
    y = np.sin(X.sum(axis=1)) + X[:, 0] ** 2
    fitted = clone(surrogate).fit(X, y)
    assert fitted.theta_.shape == (k,)
    again = from_numbers(json.loads(json.dumps(to_numbers(fitted))), surrogate.get_params().get("low_fidelity"))
    np.testing.assert_array_equal(again.predict(X + 0.01), fitted.predict(X + 0.01))


def test_old_numbers_have_no_interval():
    X = np.arange(6.0)[:, None]
    numbers = to_numbers(ss.Polynomial(degree=1).fit(X, X[:, 0] ** 2))
    del numbers["left_out"]
    with pytest.raises(ValueError, match="Polynomial has no interval: its errors at runs left out are not known; fit"):
        from_numbers(numbers).predict(X, interval=0.9)


def test_old_numbers_of_kriging_are_calibrated_anew():
    X = np.random.default_rng(2).uniform(size=(15, 2))
    fitted = ss.Kriging().fit(X, np.sin(9.0 * X[:, 0]) + X[:, 1] ** 3)
    numbers = to_numbers(fitted)
    assert numbers["found"]["calibration"] == fitted.calibration_
    del numbers["found"]["calibration"]
    again = from_numbers(numbers)
    assert again.calibration_ == pytest.approx(fitted.calibration_, rel=1e-9)
    np.testing.assert_array_equal(again.predict(X), fitted.predict(X))


@pytest.mark.parametrize("value", [0.5, np.nan, np.inf, "wide", True, [1.0]])
def test_damaged_calibrations_are_refused(value):
    numbers = to_numbers(ss.Kriging().fit([[0.0], [1.0], [2.0]], [1.0, 2.0, 4.0]))
    numbers["found"]["calibration"] = value
    with pytest.raises(ValueError, match="calibration must be a number >= 1, got"):
        from_numbers(numbers)


@pytest.mark.parametrize(
    ("part", "value"),
    [("errors", [1.0, np.nan]), ("errors", []), ("folds", [0, 7]), ("folds", [0.5, 1.0]), ("fits", [[1.0]])],
)
def test_damaged_errors_are_refused(part, value):
    numbers = to_numbers(ss.Polynomial(degree=1).fit([[0.0], [1.0], [2.0]], [1.0, 2.0, 4.0]))
    numbers["left_out"] = {"errors": [1.0, 2.0], "folds": [0, 1], "fits": [[1.0, 2.0], [2.0, 3.0]]} | {part: value}
    with pytest.raises(ValueError, match="left_out must"):
        from_numbers(numbers)


@pytest.mark.parametrize(
    "change",
    [{"folds": [0, 1]}, {"folds": [0, 0, 0]}, {"folds": [0, 1, 3]}, {"fits": []}, {"fits": [{}, {}, {}]}, {"fits": 3}],
)
def test_damaged_fits_without_a_run_are_refused(change):
    numbers = to_numbers(ss.RadialBasis("linear").fit([[0.0], [1.0], [2.0]], [1.0, 2.0, 4.0]))
    numbers["left_out"] |= change
    with pytest.raises((ValueError, KeyError, TypeError)):
        from_numbers(numbers)


def test_of_many_runs_fits_without_some_are_made_when_asked_for(monkeypatch):
    X = np.random.default_rng(0).uniform(size=(12, 2))
    fitted = ss.Kriging().fit(X, np.sin(9.0 * X[:, 0]) + X[:, 1] ** 3)
    monkeypatch.setattr("susp_ss.surrogates.regressor.KEPT", 11)
    numbers = to_numbers(fitted)
    assert numbers["left_out"] is None
    bounds = (model.predict(X, interval=0.9)[1] for model in (from_numbers(numbers), fitted))
    np.testing.assert_array_equal(*bounds)


def test_every_kind_is_tested():
    assert {type(surrogate) for surrogate in FITTED} == set(KINDS.values())


def test_taylor_has_no_box_in_text_either():
    tangent = ss.Polynomial.taylor(lambda X: X[:, 0] ** 2, [3.0], degree=2)
    again = from_numbers(json.loads(json.dumps(to_numbers(tangent), allow_nan=False)))
    assert again.coef_.tolist() == tangent.coef_.tolist()
    assert not again.outside([[1e6]]).any()


def test_what_is_not_plain_is_refused():
    X = np.arange(6.0)[:, None]
    with pytest.raises(TypeError, match="trend must be a plain value"):
        to_numbers(ss.Kriging(lambda X: np.sin(X[:, 0])).fit(X, X[:, 0] ** 2))
    with pytest.raises(ValueError, match="no surrogate named 'Oracle', available: ResponseBased"):
        from_numbers({"kind": "Oracle"})
