"""The surrogates are scikit-learn regressors."""

import warnings

import numpy as np
import pandas as pd
import pytest
from sklearn.base import clone
from sklearn.datasets import make_regression
from sklearn.model_selection import cross_val_score
from sklearn.pipeline import make_pipeline
from sklearn.preprocessing import FunctionTransformer
from sklearn.utils import estimator_checks
from sklearn.utils.estimator_checks import parametrize_with_checks

import susp_ss as ss


class Plain:
    """A plain callable whose name holds no address, so that the checks' names repeat."""

    def __call__(self, X, value=1.0):
        return value * np.asarray(X, dtype=float).sum(axis=1)

    def __repr__(self):
        return "Plain()"


class Positive(Plain):
    def __call__(self, X):
        return 1.0 + np.linalg.norm(np.asarray(X, dtype=float), axis=1)

    def __repr__(self):
        return "Positive()"


ESTIMATORS = [
    ss.ResponseBased(low_fidelity=Plain()),
    ss.VariableBased(low_fidelity=Plain()),
    ss.ResponseBased(low_fidelity=Plain(), nonnegative=True),
    ss.VariableBased(low_fidelity=Plain(), nonnegative=True),
    ss.ResponseBased(low_fidelity=Positive(), form="power"),
    ss.ParameterBased(low_fidelity=Plain(), bounds=(0.01, 100.0)),
    ss.Polynomial(degree=1),
    ss.RadialBasis(),
    ss.RadialBasis("gaussian"),
    ss.Kriging(),
    ss.CoKriging(low_fidelity=Plain()),
]


# No check is expected to fail.
@pytest.mark.slow
@pytest.mark.filterwarnings("ignore:the tuned parameter:UserWarning")
@parametrize_with_checks(ESTIMATORS)
def test_scikit_learn_checks(estimator, check, monkeypatch):
    if isinstance(estimator, ss.Kriging | ss.CoKriging | ss.RadialBasis):
        # The checks' own 200 runs in ten variables take minutes.
        monkeypatch.setattr(estimator_checks, "REGRESSION_DATASET", make_regression(30, 3, random_state=0))
    check(estimator)


@pytest.mark.slow
def test_clone_pipeline_and_cross_validation():
    rng = np.random.default_rng(0)
    X = np.column_stack([rng.uniform(12536, 24570, 60), rng.uniform(798, 2235, 60)])
    road = ss.Road()
    y = ss.Response(ss.FullCar(), road, "sws", at="fr")(X)
    for estimator in (
        ss.ResponseBased(ss.Response(ss.QuarterCar(), road, "sws")),
        ss.VariableBased(ss.Response(ss.QuarterCar(), road, "sws")),
        ss.ParameterBased(ss.Response(ss.QuarterCar(), road, "sws", parameter="ms")),
        ss.ResponseBased(ss.Response(ss.QuarterCar(), road, "sws"), form="power"),
        ss.Polynomial(),
        ss.RadialBasis("multiquadric"),
        ss.Kriging(),
        ss.CoKriging(ss.Response(ss.QuarterCar(), road, "sws")),
    ):
        copy = clone(estimator)
        assert copy.get_params().keys() == estimator.get_params().keys()
        pipeline = make_pipeline(FunctionTransformer(), copy).fit(X, y)
        assert pipeline.score(X, y) > 0.5
        assert cross_val_score(estimator, X, y, cv=3).min() > 0.3


@pytest.mark.parametrize("estimator", ESTIMATORS, ids=repr)
def test_extrapolation_is_flagged(estimator):
    runs = pd.DataFrame(np.random.default_rng(1).uniform([1.0, 20.0], [2.0, 40.0], (12, 2)), columns=["ks", "cs"])
    low, high = runs.min(), runs.max()
    fitted = clone(estimator).fit(runs, 3.0 + runs.sum(axis=1))
    inside = pd.concat([runs, low.to_frame().T, high.to_frame().T])
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        fitted.predict(inside)
    assert not fitted.outside(inside).any()
    beyond = pd.DataFrame({"ks": [1.5, 1.5], "cs": [30.0, 1.01 * high.cs]})
    assert fitted.outside(beyond).tolist() == [False, True]
    with pytest.warns(
        ss.ExtrapolationWarning, match=r"^1 of 2 designs .* such as cs = 4\d\.\d+ where the runs go from 2"
    ):
        fitted.predict(beyond)


def test_a_taylor_polynomial_has_no_box():
    tangent = ss.Polynomial.taylor(lambda X: X[:, 0] ** 2, center=[1.0])
    assert not tangent.outside([[100.0]]).any()
