"""Intervals of predictions: by their definition, and by how many new responses they hold."""

import numpy as np
import pytest
from scipy import stats
from sklearn.base import clone

import susp_ss as ss
from susp_ss.surrogates.intervals import jackknife_plus

ROAD = ss.Road.iso8608("B", speed=20.0, tracks="isotropic")
BOX = {"ks": (13e3, 24e3), "cs": (900.0, 2200.0)}


def cheap(parameter=None):
    return ss.Response(ss.QuarterCar(), ROAD, "bacc", parameter=parameter)


KINDS = {
    "RB": ss.ResponseBased(cheap()),
    "RB power": ss.ResponseBased(cheap(), form="power"),
    "VB": ss.VariableBased(cheap()),
    "PB": ss.ParameterBased(cheap("ms")),
    "Polynomial": ss.Polynomial(2),
    "thin plate": ss.RadialBasis(),
    "Gaussian": ss.RadialBasis("gaussian"),
    "Kriging": ss.Kriging(),
    "CoKriging": ss.CoKriging(cheap()),
}


def runs(n, seed):
    X = ss.sample(BOX, n, random_state=seed).to_numpy()
    return X, ss.Response(ss.FullCar(), ROAD, "bacc", at="fr")(X)


@pytest.mark.parametrize("name", KINDS)
def test_bounds_are_those_of_fits_without_each_run(name):
    (X, y), (T, _), n, level = runs(11, 0), runs(30, 1), 11, 0.8
    surrogate = KINDS[name]
    by_others, misses = np.empty((30, n)), np.empty((30, n))
    for i in range(n):
        others = np.arange(n) != i
        alone = clone(surrogate) if "low_fidelity" not in surrogate.get_params() else surrogate
        alone.fit(X[others], y[others])
        by_others[:, i], misses[:, i] = alone.predict(T), abs(y[i] - alone.predict(X[[i]]))
        if hasattr(alone, "theta_"):
            misses[:, i] *= alone.predict(T, return_std=True)[1] / alone.predict(X[[i]], return_std=True)[1]
    predicted, bounds = surrogate.fit(X, y).predict(T, interval=level)
    # Ranks floor(0.2 * 12) = 2 and ceil(0.8 * 12) = 10 of 11.
    low = np.minimum(np.sort(by_others - misses, axis=1)[:, 1], predicted)
    high = np.maximum(np.sort(by_others + misses, axis=1)[:, 9], predicted)
    np.testing.assert_array_equal(predicted, surrogate.predict(T))
    np.testing.assert_allclose(bounds, np.column_stack([low, high]), rtol=1e-6)


def test_the_cheap_model_is_asked_once_for_all_fits_without_a_run():
    """Where a slider moves, an interval must not cost a cheap run for every expensive one."""
    asked = []

    def counted(X):
        asked.append(len(X))
        return cheap()(X)

    (X, y), (T, _) = runs(11, 0), runs(4, 1)
    fitted = ss.CoKriging(counted).fit(X, y)
    first = fitted.predict(T, interval=0.8)
    asked.clear()
    np.testing.assert_array_equal(fitted.predict(T, interval=0.8)[1], first[1])
    assert sum(asked) <= 2 * len(T)


@pytest.mark.parametrize("name", ["RB", "VB", "Polynomial", "thin plate", "CoKriging"])
def test_they_hold_new_responses(name):
    (T, F), held = runs(200, 100), []
    for seed in range(2):
        _, bounds = KINDS[name].fit(*runs(20, seed)).predict(T, interval=0.95)
        held.append(np.mean((bounds[:, 0] <= F) & (bounds[:, 1] >= F)))
    assert 0.85 < np.mean(held) <= 1.0


def test_few_runs_are_taken_for_normal():
    rng = np.random.default_rng(0)
    predicted, by_others, misses = rng.normal(size=3), rng.normal(size=(3, 5)), np.abs(rng.normal(size=5))
    bounds = [
        [abs(other - at) + miss for other, miss in zip(row, misses, strict=True)]
        for row, at in zip(by_others, predicted, strict=True)
    ]
    margin = stats.t(5).ppf(0.975) * np.linalg.norm(bounds, axis=1) / np.sqrt(5.0)
    expected = np.column_stack([predicted - margin, predicted + margin])
    np.testing.assert_allclose(jackknife_plus(predicted, by_others, misses, 0.95), expected)


def test_independent_errors_are_held_as_often_as_said():
    rng = np.random.default_rng(1)
    for n in (6, 19, 40):
        missed, new = np.abs(rng.standard_normal((4000, n))), np.abs(rng.standard_normal(4000))
        bounds = jackknife_plus(np.zeros(4000), np.zeros((4000, n)), missed, 0.95)
        assert np.mean(new <= bounds[:, 1]) == pytest.approx(
            np.ceil(0.95 * (n + 1)) / (n + 1) if n > 18 else 0.95, abs=0.02
        )


def test_more_runs_than_thirty_are_left_out_in_tens():
    X, y = runs(40, 2)
    fits = ss.Polynomial(2).fit(X, y)
    errors, folds, coefficients = fits.left_out()
    assert (len(errors), len(coefficients), np.bincount(folds).tolist()) == (40, 10, [4] * 10)


@pytest.mark.parametrize("level", [0.0, 1.0, True, "95"])
def test_a_share_is_asked_for(level):
    with pytest.raises(ValueError, match="interval must be a number between 0 and 1, got"):
        ss.Polynomial(1).fit([[0.0], [1.0], [2.0]], [1.0, 2.0, 4.0]).predict([[0.5]], interval=level)


def test_too_few_runs_have_none():
    line = ss.Polynomial(1).fit([[0.0], [1.0]], [1.0, 2.0])
    with pytest.raises(ValueError, match=r"Polynomial has no interval: fold 1 of 2, fitted to 1 of 2 runs: degree 1"):
        line.predict([[0.5]], interval=0.95)
    with pytest.raises(ValueError, match="a standard deviation or an interval, got both"):
        ss.Kriging().fit([[0.0], [1.0], [2.0]], [1.0, 2.0, 4.0]).predict([[0.5]], return_std=True, interval=0.9)
