"""Kriging and co-Kriging: textbook formulas written out, SMT's models with the same thetas, explicit refits."""

import numpy as np
import pandas as pd
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.distance import cdist
from scipy.stats import qmc
from sklearn.gaussian_process.kernels import RBF, Matern

import susp_ss as ss
from susp_ss.surrogates import kriging
from susp_ss.surrogates.folds import split
from susp_ss.surrogates.gaussian_process import KERNELS, Prediction, Process

LOW, HIGH = [12536.0, 798.0], [24570.0, 2235.0]


def designs(n, seed):
    return qmc.scale(qmc.LatinHypercube(2, rng=seed).random(n), LOW, HIGH)


def cheap(X):
    return 0.5 + 1e-9 * X[:, 0] ** 1.9 + 0.2 * np.sin(X[:, 1] / 400)


def expensive(X):
    return 0.1 + 1.3 * cheap(X) + 0.05 * X[:, 0] / 2e4


def noisy(X, seed=0, std=0.01):
    return expensive(X) + np.random.default_rng(seed).normal(0.0, std, len(X))


def scaled(X, box):
    low, high = box.min(axis=0), box.max(axis=0)
    return 2 * (X - low) / (high - low) - 1


def correlation(kernel, theta):
    """scikit-learn's, whose length is what stands below a distance."""
    return RBF(1 / np.sqrt(2 * theta)) if kernel == "gaussian" else Matern(1 / np.sqrt(theta), nu=2.5)


def textbook(Z, y, P, R, noise, r, p):
    """Universal Kriging by generalised least squares: mean, variance, restricted deviance with the likeliest s2.

    (D. Harville, *JASA* 72, 1977, Eqs 3.2 to 4.1; N. Cressie, *Statistics for Spatial Data*, 1993, Eqs 3.4.29-31.)
    """
    n, m = P.shape
    C = R + noise * np.eye(n)
    A = P.T @ np.linalg.solve(C, P)
    b = np.linalg.solve(A, P.T @ np.linalg.solve(C, y))
    e = y - P @ b
    s2 = e @ np.linalg.solve(C, e) / (n - m)
    u = p - r @ np.linalg.solve(C, P)
    mean = p @ b + r @ np.linalg.solve(C, e)
    variance = s2 * (
        1.0 + noise - np.sum(r * np.linalg.solve(C, r.T).T, axis=1) + np.sum(u * np.linalg.solve(A, u.T).T, axis=1)
    )
    logarithms = [np.linalg.slogdet(M)[1] for M in (C, A, P.T @ P)]
    return mean, variance, np.log(s2) + (logarithms[0] + logarithms[1] - logarithms[2]) / (n - m)


@pytest.mark.parametrize("kernel", KERNELS)
@given(
    st.integers(8, 30),
    st.integers(1, 4),
    st.booleans(),
    st.floats(0.2, 3.0),
    st.sampled_from([1e-4, 1e-2, 1.0]),
    st.integers(0, 2**20),
)
def test_predictions_and_likelihood_are_the_textbooks(kernel, n, k, linear, theta, noise, seed):
    rng = np.random.default_rng(seed)
    Z, T, y = rng.uniform(-1, 1, (n, k)), rng.uniform(-1, 1, (5, k)), rng.normal(size=n)
    thetas = theta * rng.uniform(0.5, 2.0, k)
    P, p = (np.column_stack([np.ones(len(X)), X][: 1 + linear]) for X in (Z, T))
    of = correlation(kernel, thetas)
    across = 1.0 - of([[0.0] * k], [[2.0] * k])[0, 0]
    mean, variance, deviance = textbook(Z, y, P, of(Z), noise * across, of(T, Z), p)
    found = Prediction(Z, y, P, kernel, thetas, noise)
    np.testing.assert_allclose(found.mean(T, p), mean, rtol=1e-7, atol=1e-7)
    np.testing.assert_allclose(found.std(T, p) ** 2, variance, rtol=1e-6, atol=1e-8)
    own = Process(Z, y, P, kernel)
    assert own.deviance(np.log([*thetas, noise])) + 2.0 * np.log(own.size) == pytest.approx(
        deviance, rel=1e-7, abs=1e-7
    )


@pytest.mark.parametrize("kernel", KERNELS)
@given(st.integers(5, 25), st.integers(1, 5), st.floats(1e-3, 5.0), st.floats(1e-5, 1.0), st.integers(0, 2**20))
def test_slope_of_the_likelihood_is_that_of_its_differences(kernel, n, k, theta, noise, seed):
    rng = np.random.default_rng(seed)
    Z = rng.uniform(-1, 1, (n, k))
    process = Process(Z, np.exp(Z.sum(axis=1)), np.ones((n, 1)), kernel)
    at = np.log([*theta * rng.uniform(0.3, 3.0, k), noise])
    deviance, slope = process.deviance_and_slope(at)
    step = 1e-4 * np.eye(k + 1)
    differences = [(process.deviance(at + h) - process.deviance(at - h)) / 2e-4 for h in step]
    assert deviance == pytest.approx(process.deviance(at), rel=1e-9, abs=1e-9)
    np.testing.assert_allclose(slope, differences, rtol=1e-4, atol=1e-5)


def test_it_is_smts_with_the_same_thetas():
    from smt.surrogate_models import KRG

    X, T = designs(15, 1), designs(50, 2)
    Z = scaled(X, X)
    smts = KRG(
        poly="constant", print_global=False, hyper_opt="NoOp", theta0=[0.4, 0.7], nugget=1e-10, theta_bounds=[0.1, 1]
    )
    smts.set_training_values(Z, cheap(X))
    smts.train()
    theta = smts.optimal_theta / smts.X_scale**2
    across = 1.0 - np.exp(-4.0 * theta.sum())
    ours = Prediction(Z, cheap(X), np.ones((15, 1)), "gaussian", theta, 1e-10 / across)
    at, one = scaled(T, X), np.ones((50, 1))
    np.testing.assert_allclose(ours.mean(at, one), smts.predict_values(at)[:, 0], rtol=1e-7)
    # SMT divides by the runs, we by what the trend leaves of them.
    np.testing.assert_allclose(
        ours.std(at, one) ** 2 * 14 / 15, smts.predict_variances(at)[:, 0], rtol=1e-3, atol=1e-12
    )


def test_it_errs_no_more_than_smt():
    """Whose co-Kriging sees forty runs of the cheap model."""
    from smt.applications import MFK
    from smt.surrogate_models import KRG

    road = ss.Road.iso8608("B", speed=20.0, tracks="isotropic")
    X, T = designs(20, 5), designs(200, 6)
    Z, at = scaled(X, X), scaled(T, X)
    f, F = ss.Response(ss.QuarterCar(), road), ss.Response(ss.FullCar(), road, at="fr")
    for ours, kind in ((ss.Kriging(), KRG), (ss.CoKriging(f), MFK)):
        smts = kind(print_global=False, n_start=2)
        if kind is MFK:
            many = np.concatenate([X, designs(20, 7)])
            smts.set_training_values(scaled(many, X), f(many), name=0)
        smts.set_training_values(Z, F(X))
        smts.train()
        error = ss.accuracy(F(T), ours.fit(X, F(X)).predict(T)).RMSE
        assert error < 2.0 * ss.accuracy(F(T), smts.predict_values(at)[:, 0]).RMSE


SURROGATES = {
    "constant": ss.Kriging(),
    "quadratic": ss.Kriging("quadratic"),
    "Matern": ss.Kriging("linear", kernel="matern52"),
    "callable": ss.Kriging(lambda X: np.column_stack([np.log(X[:, 0]), 1.0 / X[:, 1]])),
    "co-Kriging": ss.CoKriging(cheap),
}


@pytest.mark.parametrize("surrogate", SURROGATES.values(), ids=SURROGATES)
@pytest.mark.parametrize("folds", [None, 4])
@pytest.mark.parametrize("response", [expensive, noisy])
def test_left_out_in_closed_form_is_left_out_and_fitted(surrogate, folds, response):
    """Repeated designs among the noisy ones; thetas and noise as of the fit to all."""
    X = designs(18, 8) if response is expensive else np.concatenate([designs(18, 8), designs(18, 8)[:3]])
    y = response(X)
    mean, std = surrogate.fit(X, y).predict_left_out([S for _, S in split(X, folds, 0)])
    process, beside = surrogate.process_, max(1e-9, 1e-3 * surrogate.noise_)
    for fitted, S in split(X, folds, 0):
        Z, P = process.Z, process.P
        again = Prediction(Z[fitted], y[fitted], P[fitted], surrogate.kernel, process.theta, process.noise)
        np.testing.assert_allclose(mean[S], again.mean(Z[S], P[S]), rtol=1e-5, atol=beside)
        stated = surrogate.calibration_ * again.std(Z[S], P[S])
        np.testing.assert_allclose(std[S], stated, rtol=1e-2, atol=beside)


@pytest.mark.parametrize("surrogate", SURROGATES.values(), ids=SURROGATES)
@pytest.mark.parametrize("response", [lambda X: expensive(X) + 0.02 * np.cos(X[:, 0] / 2e3), noisy])
def test_deviations_are_as_large_as_the_errors_of_runs_left_out(surrogate, response):
    X = designs(14, 8)
    y = response(X)
    process = surrogate.fit(X, y).process_
    Z, P, each = process.Z, process.P, []
    for i in range(len(X)):
        rest = np.arange(len(X)) != i
        others = Prediction(Z[rest], y[rest], P[rest], surrogate.kernel, process.theta, process.noise)
        # Its own variance is that of the others alone.
        std = others.std(Z[[i]], P[[i]])[0] * np.sqrt(process.variance / others.variance)
        each.append((y[i] - others.mean(Z[[i]], P[[i]])[0]) / std)
    found = np.sqrt(np.mean(np.square(each)))
    assert process.calibration() == pytest.approx(found, rel=1e-2)
    assert surrogate.calibration_ == max(1.0, process.calibration())
    np.testing.assert_array_equal(
        surrogate.predict(X[:3], return_std=True)[1], surrogate.calibration_ * process.std(Z[:3], P[:3])
    )


def test_what_no_run_tells_is_not_calibrated():
    """A run without which no trend is left has no error; nor has a response that the trend meets."""
    X = np.column_stack([[0.0, 0.0, 0.0, 0.0, 0.0, 1.0], np.arange(6.0) ** 2])
    assert np.isfinite(ss.Kriging("linear").fit(X, np.arange(6.0) ** 3).process_.calibration())
    assert ss.Kriging("linear").fit(designs(8, 1), designs(8, 1) @ [1e-4, 1e-3]).calibration_ == 1.0


def test_a_fold_that_the_trend_needs_is_refused():
    X = np.column_stack([[0.0, 0.0, 0.0, 0.0, 0.0, 1.0], np.arange(6.0) ** 2])
    fitted = ss.Kriging("linear").fit(X, np.arange(6.0) ** 3)
    with pytest.raises(ValueError, match=r"fold 6 of 6, fitted to 5 of 6 runs: these do not determine the 3 columns"):
        fitted.predict_left_out(np.arange(6)[:, None])


@pytest.mark.parametrize("kernel", KERNELS)
def test_exact_runs_are_interpolated(kernel):
    X = designs(25, 1)
    fitted = ss.Kriging(kernel=kernel).fit(X, expensive(X))
    np.testing.assert_allclose(fitted.predict(X), expensive(X), atol=1e-5)
    mean, std = fitted.predict(designs(100, 2), return_std=True)
    np.testing.assert_allclose(mean, expensive(designs(100, 2)), atol=1e-2)
    assert fitted.noise_ < 1e-4
    assert fitted.predict(X, return_std=True)[1].max() < 0.3 * std.max()


@pytest.mark.parametrize("surrogate", [ss.Kriging(), ss.Kriging(kernel="matern52"), ss.CoKriging(cheap)])
def test_noise_is_found_and_smoothed(surrogate):
    X, T = designs(60, 3), designs(200, 4)
    fitted = surrogate.fit(X, noisy(X))
    mean, std = fitted.predict(T, return_std=True)
    assert 0.006 < fitted.noise_ < 0.014
    assert np.sqrt(np.mean((mean - expensive(T)) ** 2)) < 0.006
    # A run's deviation holds its noise.
    assert (std > fitted.noise_).all()
    assert np.mean(np.abs(mean - noisy(T, 1)) < 1.96 * std) == pytest.approx(0.95, abs=0.06)


def test_repeated_runs_tell_their_noise():
    X = np.repeat(designs(12, 3), 4, axis=0)
    y = noisy(X, std=0.02)
    within = np.sqrt(y.reshape(12, 4).var(axis=1, ddof=1).mean())
    assert ss.Kriging().fit(X, y).noise_ == pytest.approx(within, rel=0.3)


def test_few_runs_go_further_with_a_cheap_model():
    X, T = designs(8, 7), designs(200, 8)
    together = ss.accuracy(expensive(T), ss.CoKriging(cheap).fit(X, expensive(X)).predict(T))
    alone = ss.accuracy(expensive(T), ss.Kriging().fit(X, expensive(X)).predict(T))
    assert together.RMSE < 0.2 * alone.RMSE


def test_scaling_of_the_cheap_model_is_found():
    X = designs(10, 9)
    np.testing.assert_allclose(ss.CoKriging(cheap).fit(X, 0.1 + 1.3 * cheap(X)).rho_, 1.3, rtol=1e-6)


def test_a_plane_beside_the_cheap_model_is_taken_where_it_is_likelier():
    X, T = designs(12, 9), designs(50, 10)
    tilted = ss.CoKriging(cheap).fit(X, expensive(X))
    np.testing.assert_allclose(tilted.predict(T), expensive(T), rtol=1e-9)
    bent = ss.CoKriging(cheap).fit(X, 1.3 * cheap(X) + 1e-3 * np.sin(X[:, 0] / 2e3))
    alone = ss.CoKriging(cheap, trend="constant").fit(X, 1.3 * cheap(X) + 1e-3 * np.sin(X[:, 0] / 2e3))
    np.testing.assert_array_equal(bent.predict(T), alone.predict(T))


def test_co_kriging_is_kriging_with_the_cheap_model_for_its_trend():
    X, T = designs(15, 11), designs(20, 12)
    y = np.exp(cheap(X))
    one, other = (s.fit(X, y).predict(T) for s in (ss.CoKriging(cheap, "constant"), ss.Kriging(cheap)))
    np.testing.assert_array_equal(one, other)


@pytest.mark.filterwarnings("error", "ignore:.* outside the box of the runs:UserWarning")
def test_a_response_that_the_trend_meets_is_predicted():
    X, T = designs(10, 12), designs(5, 13)
    mean, std = ss.Kriging().fit(X, np.full(10, 7.0)).predict(T, return_std=True)
    np.testing.assert_allclose(mean, 7.0)
    np.testing.assert_allclose(std, 0.0, atol=1e-9)
    fitted = ss.Kriging("linear").fit(X, X @ [1.0, -2.0])
    np.testing.assert_allclose(fitted.predict(T), T @ [1.0, -2.0], rtol=1e-12)
    np.testing.assert_allclose(fitted.predict_left_out(np.arange(10)[:, None])[0], X @ [1.0, -2.0], rtol=1e-9)


@pytest.mark.parametrize(("n", "k"), [(40, 1), (150, 1), (60, 6)])
def test_no_pivot_is_lost_where_the_responses_are_smooth(n, k, monkeypatch):
    rng, lost, factor = np.random.default_rng(0), [], Process._factor

    def watched(self, C):
        found = factor(self, C)
        lost.append(found is None)
        return found

    monkeypatch.setattr(Process, "_factor", watched)
    X, T = rng.uniform(-1, 1, (n, k)), rng.uniform(-0.9, 0.9, (50, k))
    fitted = ss.Kriging().fit(X, np.exp(X.sum(axis=1) / k))
    assert not any(lost)
    np.testing.assert_allclose(fitted.predict(T), np.exp(T.sum(axis=1) / k), atol=1e-6 if k == 1 else 1e-2)


def test_a_far_run_is_as_uncertain_as_without_runs():
    """Far from all runs the mean is the trend, and the deviation the process's and the coefficients'."""
    X = np.linspace(0.0, 1.0, 20)[:, None]
    fitted = ss.Kriging().fit(X, np.sin(20.0 * X[:, 0]) + np.random.default_rng(0).normal(0.0, 0.1, 20))
    mean, std = fitted.predict([[50.0], [90.0]], return_std=True)
    assert mean[0] == pytest.approx(mean[1], rel=1e-9)
    process = fitted.process_
    R = np.exp(-process.theta * cdist(process.Z, process.Z) ** 2) + process.noise * process.across * np.eye(20)
    of_mean = 1.0 / np.linalg.inv(R).sum()
    s2 = process.variance / process.across
    stated = fitted.calibration_ * np.sqrt(s2 * (1.0 + of_mean) + fitted.noise_**2)
    assert std[0] == pytest.approx(stated, rel=1e-6)


@pytest.mark.parametrize("surrogate", [ss.Kriging(), ss.CoKriging(cheap)])
def test_a_fit_repeats(surrogate, capfd):
    X, T = designs(12, 10), designs(20, 11)
    first, second = (surrogate.fit(X, expensive(X)).predict(T) for _ in range(2))
    np.testing.assert_array_equal(first, second)
    assert capfd.readouterr() == ("", "")


def test_designs_are_predicted_in_batches(monkeypatch):
    X, T = designs(12, 14), designs(25, 15)
    fitted = ss.Kriging().fit(X, cheap(X))
    whole = fitted.predict(T, return_std=True)
    monkeypatch.setattr(kriging, "BATCH", 10)
    np.testing.assert_allclose(fitted.predict(T, return_std=True), whole, rtol=1e-9, atol=1e-9)


def test_many_runs_are_warned_of(monkeypatch):
    monkeypatch.setattr(kriging, "MANY", 15)
    X = designs(16, 16)
    with pytest.warns(UserWarning, match="Kriging of 16 runs takes some 4 s"):
        ss.Kriging().fit(X, cheap(X))
    monkeypatch.setattr("susp_ss.surrogates.regressor.MOST_RUNS", 15)
    with pytest.raises(ValueError, match="Kriging takes at most 15 runs, got 16"):
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
        (
            ss.Kriging("cubic"),
            ValueError,
            "trend must be one of constant, linear, quadratic, got 'cubic'",
        ),
        (ss.Kriging(["linear"]), ValueError, "trend must be one of constant, linear, quadratic"),
        (ss.Kriging(kernel="cubic"), ValueError, "kernel must be one of gaussian, matern52, got 'cubic'"),
        (ss.Kriging("quadratic"), ValueError, r"quadratic trend .* at least 7 different designs, got 6 sample\(s\)"),
        (ss.Kriging(lambda X: X[:3]), ValueError, "trend must return"),
        (ss.Kriging(lambda X: np.full(len(X), np.nan)), ValueError, "trend must return finite numbers"),
        (ss.Kriging(lambda X: np.ones(len(X))), ValueError, "trend has 1 for every run, which leads nowhere"),
        (ss.Kriging(lambda X: np.column_stack([X, X])), ValueError, "do not tell the 5 columns of the trend apart"),
        (ss.CoKriging(cheap, "quadratic"), ValueError, "at least 8 different designs"),
        (ss.CoKriging(cheap, "cubic"), ValueError, "trend must be one of constant, linear, quadratic"),
        (ss.CoKriging(None), TypeError, "low_fidelity must be a callable"),
        (ss.CoKriging(lambda X: X), ValueError, "low_fidelity must return one number for each design"),
        (ss.CoKriging(lambda X: np.full(len(X), 2.5)), ValueError, "has 2.5 for every run, which leads nowhere"),
    ],
)
def test_bad_settings(surrogate, error, words):
    with pytest.raises(error, match=words):
        surrogate.fit(designs(6, 18), np.arange(6.0))
