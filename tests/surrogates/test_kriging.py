"""Kriging and co-Kriging: SMT's models on the same runs, scikit-learn's process with the same thetas, and silence."""

import numpy as np
import pandas as pd
import pytest
from scipy.stats import qmc
from sklearn.gaussian_process import GaussianProcessRegressor
from sklearn.gaussian_process.kernels import RBF, ConstantKernel

import susp_ss as ss
from susp_ss.surrogates import kriging

LOW, HIGH = [12536.0, 798.0], [24570.0, 2235.0]


def designs(n, seed):
    return qmc.scale(qmc.LatinHypercube(2, rng=seed).random(n), LOW, HIGH)


def cheap(X):
    return 0.5 + 1e-9 * X[:, 0] ** 1.9 + 0.2 * np.sin(X[:, 1] / 400)


def expensive(X):
    return 0.1 + 1.3 * cheap(X) + 0.05 * X[:, 0] / 2e4


def scaled(X, box):
    low, high = box.min(axis=0), box.max(axis=0)
    return 2 * (X - low) / (high - low) - 1


@pytest.fixture
def thorough(monkeypatch):
    monkeypatch.setattr(kriging, "STARTS", 10)


@pytest.mark.parametrize("trend", kriging.TRENDS)
def test_kriging_is_smts(trend, thorough):
    from smt.surrogate_models import KRG

    X, T = designs(25, 1), designs(100, 2)
    ours = ss.Kriging(trend).fit(X, cheap(X))
    smts = KRG(poly=trend, print_global=False)
    smts.set_training_values(scaled(X, X), cheap(X))
    smts.train()
    mean, std = ours.predict(T, return_std=True)
    np.testing.assert_allclose(mean, smts.predict_values(scaled(T, X))[:, 0], atol=1e-4)
    np.testing.assert_allclose(std, np.sqrt(smts.predict_variances(scaled(T, X))[:, 0]), rtol=0.1, atol=1e-4)
    np.testing.assert_allclose(ours.predict(X), cheap(X), atol=1e-5)
    assert (ours.predict(X, return_std=True)[1] < 0.1 * std.max()).all()


def test_mean_is_scikit_learns_with_the_same_thetas():
    X, T = designs(25, 3), designs(100, 4)
    ours = ss.Kriging().fit(X, cheap(X))
    mean = cheap(X).mean()
    # The correlation exp(-theta d^2) is a length of 1 / sqrt(2 theta); a wide constant is an unknown mean.
    kernel = ConstantKernel(1e4) + ConstantKernel(1.0) * RBF(1 / np.sqrt(2 * ours.theta_))
    process = GaussianProcessRegressor(kernel, alpha=1e-10, optimizer=None).fit(X, cheap(X) - mean)
    np.testing.assert_allclose(ours.predict(T), mean + process.predict(T), atol=1e-3)


def test_co_kriging_is_smts(thorough):
    from smt.applications import MFK

    X, T = designs(8, 5), designs(100, 6)
    asked = []

    def recorded(X):
        asked.append(X)
        return cheap(X)

    ours = ss.CoKriging(recorded, samples=30, random_state=4).fit(X, expensive(X))
    (runs,) = asked
    np.testing.assert_array_equal(runs[:8], X)
    assert runs.shape == (38, 2)
    assert ((runs >= X.min(axis=0)) & (runs <= X.max(axis=0))).all()
    smts = MFK(poly="constant", print_global=False)
    smts.set_training_values(scaled(runs, X), cheap(runs), name=0)
    smts.set_training_values(scaled(X, X), expensive(X))
    smts.train()
    mean, std = ours.predict(T, return_std=True)
    np.testing.assert_allclose(mean, smts.predict_values(scaled(T, X))[:, 0], atol=1e-3)
    np.testing.assert_allclose(std**2, smts.predict_variances(scaled(T, X))[:, 0], rtol=0.5, atol=1e-5)
    np.testing.assert_allclose(ours.predict(X), expensive(X), atol=1e-4)


def test_few_runs_go_further_with_a_cheap_model():
    X, T = designs(8, 7), designs(200, 8)
    together = ss.accuracy(expensive(T), ss.CoKriging(cheap).fit(X, expensive(X)).predict(T))
    alone = ss.accuracy(expensive(T), ss.Kriging().fit(X, expensive(X)).predict(T))
    assert together.RMSE < 0.2 * alone.RMSE


def test_scaling_of_the_cheap_model_is_found():
    X = designs(10, 9)
    np.testing.assert_allclose(ss.CoKriging(cheap).fit(X, 0.1 + 1.3 * cheap(X)).rho_, 1.3, rtol=1e-3)


@pytest.mark.parametrize("surrogate", [ss.Kriging(random_state=3), ss.CoKriging(cheap, samples=20, random_state=3)])
def test_a_seed_repeats_a_fit(surrogate, capfd):
    X, T = designs(12, 10), designs(20, 11)
    first, second = (surrogate.fit(X, expensive(X)).predict(T) for _ in range(2))
    np.testing.assert_array_equal(first, second)
    assert capfd.readouterr() == ("", "")


@pytest.mark.filterwarnings("error", "ignore:.* outside the box of the runs:UserWarning")
def test_a_constant_response_is_predicted():
    X = designs(10, 12)
    mean, std = ss.Kriging().fit(X, np.full(10, 7.0)).predict(designs(5, 13), return_std=True)
    np.testing.assert_allclose(mean, 7.0)
    np.testing.assert_allclose(std, 0.0, atol=1e-6)


def test_designs_are_predicted_in_batches(monkeypatch):
    X, T = designs(12, 14), designs(25, 15)
    fitted = ss.Kriging().fit(X, cheap(X))
    whole = fitted.predict(T, return_std=True)
    monkeypatch.setattr(kriging, "BATCH", 10)
    np.testing.assert_allclose(fitted.predict(T, return_std=True), whole, rtol=1e-9, atol=1e-9)


def test_many_runs_are_warned_of(monkeypatch):
    monkeypatch.setattr(kriging, "MANY", 15)
    X = designs(16, 16)
    with pytest.warns(UserWarning, match="Kriging of 16 runs takes some 0.6 minutes"):
        ss.Kriging().fit(X, cheap(X))


def test_named_columns_are_checked():
    X = pd.DataFrame(designs(12, 17), columns=["ks", "cs"])
    fitted = ss.Kriging().fit(X, cheap(X.to_numpy()))
    assert fitted.predict(X).shape == (12,)
    with pytest.raises(ValueError, match="feature names"):
        fitted.predict(X[["cs", "ks"]])
    with pytest.raises(ValueError, match="ks is constant"):
        ss.Kriging().fit(X.assign(ks=1.0), np.arange(12.0))


@pytest.mark.parametrize(
    ("surrogate", "error", "words"),
    [
        (ss.Kriging("cubic"), ValueError, "trend must be one of constant, linear, quadratic, got 'cubic'"),
        (ss.Kriging("quadratic"), ValueError, r"quadratic trend .* at least 7 different designs, got 6 sample\(s\)"),
        (ss.CoKriging(cheap, "linear", samples=0), ValueError, "samples must be a whole number >= 1, got 0"),
        (ss.CoKriging(cheap, samples=2.5), ValueError, "samples must be a whole number >= 1, got 2.5"),
        (ss.CoKriging(cheap, "quadratic"), ValueError, "at least 8 different designs"),
        (ss.CoKriging(None), TypeError, "low_fidelity must be a callable"),
        (ss.CoKriging(lambda X: X), ValueError, "low_fidelity must return one number for each design"),
    ],
)
def test_bad_settings(surrogate, error, words):
    with pytest.raises(error, match=words):
        surrogate.fit(designs(6, 18), np.arange(6.0))
