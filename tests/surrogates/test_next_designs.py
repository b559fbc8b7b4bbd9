"""Where the next runs tell most: by the dense formulas of Kriging, and by trying every design."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import susp_ss as ss
from susp_ss.surrogates.next_designs import Knowledge, filling, knowledge, most_telling, nearest_square, over


def runs(n=9, noise=0.0, seed=0):
    rng = np.random.default_rng(seed)
    X = rng.uniform([1.0, 10.0], [3.0, 50.0], (n, 2))
    return X, np.sin(2.0 * X[:, 0]) + (X[:, 1] / 30.0) ** 2 + noise * rng.standard_normal(n)


@pytest.mark.parametrize("kernel", ["gaussian", "matern52"])
@pytest.mark.parametrize("trend", ["constant", "linear"])
def test_the_covariance_is_that_of_the_dense_equations(kernel, trend):
    """``c(x, x') - [c; p]' [[C, P], [P', 0]]^-1 [c; p]``, universal Kriging, with noise enough to be solved densely."""
    X, y = runs(14, 0.1)
    model = ss.Kriging(trend, kernel).fit(X, y)
    T = over({"a": (1.0, 3.0), "b": (10.0, 50.0)})[::40]

    def correlation(A, B):
        t = np.sum(model.theta_ * (A[:, None] - B[None]) ** 2, axis=-1)
        r = np.sqrt(5.0 * t)
        return np.exp(-t) if kernel == "gaussian" else (1.0 + r + r**2 / 3.0) * np.exp(-r)

    process = model.process_
    s2 = process.variance / process.across
    noise = model.noise_**2
    P, p = ([np.ones(len(A)), *(A.T if trend == "linear" else [])] for A in (X, T))
    P, p = np.stack(P, axis=1), np.stack(p, axis=1)
    m = P.shape[1]
    system = np.block([[s2 * correlation(X, X) + noise * np.eye(len(X)), P], [P.T, np.zeros((m, m))]])
    both = np.concatenate([s2 * correlation(X, T), p.T])
    expected = s2 * correlation(T, T) - both.T @ np.linalg.solve(system, both)
    np.testing.assert_allclose(model.covariance(T), expected, atol=1e-6 * s2)
    std = model.predict(T, return_std=True)[1] / model.calibration_
    np.testing.assert_allclose(np.diag(model.covariance(T)) + noise, std**2, rtol=1e-6)


def random_knowledge(seed, N=7):
    rng = np.random.default_rng(seed)
    A = rng.standard_normal((N, N))
    return Knowledge(A @ A.T, float(rng.uniform(0.1, 2.0)))


@settings(max_examples=30)
@given(seed=st.integers(0, 10_000))
def test_what_a_run_tells_is_what_conditioning_on_it_takes_away(seed):
    """Bayes' rule for a Gaussian vector, written out once more for each design by itself."""
    known = random_knowledge(seed)
    S, told = known.covariance, known.told()
    for i in range(len(S)):
        left = S - np.outer(S[:, i], S[i]) / (S[i, i] + known.noise)
        assert told[i] == pytest.approx(np.mean(np.diag(S) - np.diag(left)), rel=1e-9)
    several = known.after([2, 5]).covariance
    np.testing.assert_allclose(several, known.after([5]).after([2]).covariance, atol=1e-9 * np.abs(S).max())


@settings(max_examples=15)
@given(seed=st.integers(0, 10_000))
def test_each_design_is_the_best_after_those_before(seed):
    known, allowed = [random_knowledge(seed), random_knowledge(seed + 1)], np.arange(7) != 3
    chosen = []
    for best in most_telling(known, allowed):

        def left(i, chosen=tuple(chosen)):
            return sum(one.after([*chosen, i]).variance for one in known)

        others = [i for i in range(7) if allowed[i] and i not in chosen]
        assert left(best) <= min(map(left, others)) * (1.0 + 1e-9)
        chosen.append(best)
    assert sorted(chosen) == [i for i in range(7) if i != 3]


@settings(max_examples=30)
@given(seed=st.integers(0, 10_000), k=st.integers(1, 4))
def test_filling_keeps_away_from_all_runs(seed, k):
    rng = np.random.default_rng(seed)
    designs, made = rng.random((40, k)), rng.random((3, k))
    for count, farthest in zip(range(6), filling(designs, made), strict=False):
        apart = np.linalg.norm(designs[:, None] - made, axis=-1).min(axis=1)
        assert apart[farthest] == pytest.approx(apart.max()), count
        made = np.concatenate([made, designs[[farthest]]])


def test_no_design_comes_twice():
    designs = np.linspace(0.0, 1.0, 5)[:, None]
    assert sorted(filling(designs, designs[[2]])) == [0, 1, 3, 4]
    np.testing.assert_allclose(nearest_square(designs, designs[[0]]), designs[:, 0] ** 2)


def test_chosen_runs_lower_the_variance_more_than_others():
    X, y = runs(9)
    model = ss.Kriging().fit(X, y)
    designs = over({"a": (1.0, 3.0), "b": (10.0, 50.0)})
    known = knowledge(model, designs, float(y.std()))
    chosen = [one for one, _ in zip(most_telling([known], np.full(len(designs), True)), range(4), strict=False)]
    rng = np.random.default_rng(1)
    by_chance = [known.after(rng.choice(len(designs), 4, replace=False)).variance for _ in range(20)]
    assert known.after(chosen).variance < min(by_chance)


def test_a_box_is_filled_to_its_corners():
    designs = over({"a": (-2.0, 4.0), "b": (10.0, 50.0)})
    assert {(-2.0, 10.0), (-2.0, 50.0), (4.0, 10.0), (4.0, 50.0)} <= set(map(tuple, designs.tolist()))
    assert (designs.min(axis=0) >= [-2.0, 10.0]).all()
    assert (designs.max(axis=0) <= [4.0, 50.0]).all()
    # More corners than anyone would run are left out.
    assert len(over({str(i): (0.0, 1.0) for i in range(10)})) == 512
