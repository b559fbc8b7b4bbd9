"""The surrogates are scikit-learn regressors."""

import numpy as np
import pytest
from sklearn.base import clone
from sklearn.model_selection import cross_val_score
from sklearn.pipeline import make_pipeline
from sklearn.preprocessing import FunctionTransformer
from sklearn.utils.estimator_checks import parametrize_with_checks

import susp_ss as ss


class Plain:
    """A plain callable whose name holds no address, so that the checks' names repeat."""

    def __call__(self, X, value=1.0):
        return value * np.asarray(X, dtype=float).sum(axis=1)

    def __repr__(self):
        return "Plain()"


ESTIMATORS = [
    ss.ResponseBased(low_fidelity=Plain()),
    ss.VariableBased(low_fidelity=Plain()),
    ss.ResponseBased(low_fidelity=Plain(), nonnegative=True),
    ss.VariableBased(low_fidelity=Plain(), nonnegative=True),
    ss.ParameterBased(low_fidelity=Plain(), bounds=(0.01, 100.0)),
]


# No check is expected to fail.
@pytest.mark.filterwarnings("ignore:the tuned parameter:UserWarning")
@parametrize_with_checks(ESTIMATORS)
def test_scikit_learn_checks(estimator, check):
    check(estimator)


def test_clone_pipeline_and_cross_validation():
    rng = np.random.default_rng(0)
    X = np.column_stack([rng.uniform(12536, 24570, 60), rng.uniform(798, 2235, 60)])
    road = ss.Road()
    y = ss.Response(ss.FullCar(), road, "sws", at="fr")(X)
    for estimator in (
        ss.ResponseBased(ss.Response(ss.QuarterCar(), road, "sws")),
        ss.VariableBased(ss.Response(ss.QuarterCar(), road, "sws")),
        ss.ParameterBased(ss.Response(ss.QuarterCar(), road, "sws", parameter="ms")),
    ):
        copy = clone(estimator)
        assert copy.get_params().keys() == estimator.get_params().keys()
        pipeline = make_pipeline(FunctionTransformer(), copy).fit(X, y)
        assert pipeline.score(X, y) > 0.5
        assert cross_val_score(estimator, X, y, cv=3).min() > 0.3
