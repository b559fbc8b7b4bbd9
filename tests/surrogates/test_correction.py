"""RB and VB: known coefficients are recovered, and the fits are the normal equations' and scipy's nnls."""

import mpmath
import numpy as np
import pandas as pd
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from scipy.optimize import minimize_scalar, nnls

import susp_ss as ss

# Typical sizes of BAcc, SWS and DTL, which with K_s span seven orders of magnitude.
SIZES = {"bacc": 1.0, "sws": 5e-3, "dtl": 500.0}


def designs(n, seed):
    rng = np.random.default_rng(seed)
    return np.column_stack([rng.uniform(12536, 24570, n), rng.uniform(798, 2235, n)])


def curved(X):
    """A smooth cheap response of order one."""
    return 0.5 + 1e-9 * X[:, 0] ** 1.9 + 0.2 * np.sqrt(X[:, 1] / 1500)


def exact(columns, target):
    """The normal equations in 60 digits."""
    with mpmath.workdps(60):
        A, y = mpmath.matrix(columns.tolist()), mpmath.matrix(target.tolist())
        return np.array([float(a) for a in mpmath.lu_solve(A.T * A, A.T * y)])


@pytest.mark.parametrize("size", SIZES.values(), ids=SIZES.keys())
def test_known_coefficients_are_recovered(size):
    X = designs(400, 1)
    low = lambda X: size * curved(X)  # noqa: E731
    rb = ss.ResponseBased(low).fit(X, 0.3 * size + 1.7 * low(X))
    np.testing.assert_allclose([rb.intercept_, *rb.coef_], [0.3 * size, 1.7], rtol=1e-9)
    vb = ss.VariableBased(low).fit(X, low(X) + size * (0.2 + 3e-6 * X[:, 0] - 4e-5 * X[:, 1]))
    np.testing.assert_allclose([vb.intercept_, *vb.coef_], size * np.array([0.2, 3e-6, -4e-5]), rtol=1e-9)
    np.testing.assert_allclose(vb.predict(X), low(X) + size * (0.2 + 3e-6 * X[:, 0] - 4e-5 * X[:, 1]), rtol=1e-12)


@given(st.integers(0, 10_000), st.sampled_from(list(SIZES.values())), st.integers(6, 60))
@settings(max_examples=25)
def test_free_fits_are_the_normal_equations(seed, size, n):
    X, rng = designs(n, seed), np.random.default_rng(seed + 1)
    low = lambda X: size * curved(X)  # noqa: E731
    y = size * (rng.normal() + rng.normal() * curved(X) + rng.normal() * X[:, 0] / 2e4 + 0.05 * rng.normal(size=n))
    ones = np.ones(n)
    rb = ss.ResponseBased(low).fit(X, y)
    np.testing.assert_allclose([rb.intercept_, *rb.coef_], exact(np.column_stack([ones, low(X)]), y), rtol=1e-8)
    vb = ss.VariableBased(low).fit(X, y)
    np.testing.assert_allclose([vb.intercept_, *vb.coef_], exact(np.column_stack([ones, X]), y - low(X)), rtol=1e-8)


@given(st.integers(0, 10_000), st.sampled_from(list(SIZES.values())), st.integers(6, 60))
@example(716, 1.0, 6)  # Stalls the solver short of its sharpest tolerance.
@settings(max_examples=40)
def test_nonnegative_fits_are_scipys_nnls(seed, size, n):
    X, rng = designs(n, seed), np.random.default_rng(seed + 1)
    low = lambda X: size * curved(X)  # noqa: E731
    y = low(X) + size * (
        rng.normal() + rng.normal() * X[:, 0] / 2e4 + rng.normal() * X[:, 1] / 2e3 + 0.05 * rng.normal(size=n)
    )
    for surrogate, columns, target in (
        (ss.ResponseBased(low, nonnegative=True), np.column_stack([np.ones(n), low(X)]), y),
        (ss.VariableBased(low, nonnegative=True), np.column_stack([np.ones(n), X]), y - low(X)),
    ):
        scale = np.linalg.norm(columns, axis=0)
        expected = nnls(columns / scale, target)[0]
        fitted = surrogate.fit(X, y)
        ours = np.array([fitted.intercept_, *fitted.coef_]) * scale
        assert ((ours == 0.0) == (expected == 0.0)).all()
        np.testing.assert_allclose(ours, expected, rtol=1e-8)


@given(st.integers(0, 10_000))
@settings(max_examples=40)
def test_nonnegative_fits_near_a_corner(seed):
    """Coefficients and multipliers of every size down to 1e-12: an interior point alone blurs them."""
    rng = np.random.default_rng(seed)
    X = designs(30, seed)
    columns = np.column_stack([np.ones(30), X])
    scale = np.linalg.norm(columns, axis=0)
    unit = columns / scale
    sizes, positive = 10.0 ** rng.uniform(-12, 0, 3), rng.random(3) < 0.5
    residual = rng.normal(size=30)
    residual -= unit @ np.linalg.lstsq(unit, residual)[0]
    # The optimality conditions: unit a + w, where the gradient unit' w is minus the multipliers.
    w = -unit @ np.linalg.solve(unit.T @ unit, np.where(positive, 0.0, sizes))
    target = unit @ np.where(positive, sizes, 0.0) + w + 1e-3 * residual
    fitted = ss.VariableBased(curved, nonnegative=True).fit(X, curved(X) + target)
    ours = np.array([fitted.intercept_, *fitted.coef_]) * scale
    assert (ours >= 0.0).all()
    expected = nnls(unit, (curved(X) + target) - curved(X))[0]
    np.testing.assert_allclose(ours, expected, rtol=0, atol=1e-8 * np.linalg.norm(target))


def test_nonnegative_fit_of_many_scenes_never_stops_short():
    for seed in range(150):
        X, rng = designs(25, seed), np.random.default_rng(seed)
        y = curved(X) - rng.uniform(0, 1) + 10.0 ** rng.uniform(-6, 0) * rng.normal(size=25)
        fitted = ss.VariableBased(curved, nonnegative=True).fit(X, y)
        assert min(fitted.intercept_, *fitted.coef_) >= 0.0


@pytest.mark.parametrize(
    "terms", [(True, False, False), (False, True, True), (True, False, True), (False, False, True)]
)
def test_masked_terms_are_zero_and_the_rest_is_optimal(terms):
    X = designs(50, 3)
    y = curved(X) + 0.3 - 1e-5 * X[:, 0] + 2e-4 * X[:, 1] + 0.01 * np.sin(X[:, 0])
    fitted = ss.VariableBased(curved, terms=terms).fit(X, y)
    ours = np.array([fitted.intercept_, *fitted.coef_])
    keep = np.array(terms)
    assert (ours[~keep] == 0.0).all()
    columns = np.column_stack([np.ones(50), X])[:, keep]
    np.testing.assert_allclose(ours[keep], exact(columns, y - curved(X)), rtol=1e-8)


def test_nonnegative_fit_at_its_corner_is_zero():
    X = designs(50, 4)
    fitted = ss.VariableBased(curved, nonnegative=True).fit(X, curved(X) - 1.0)
    assert [fitted.intercept_, *fitted.coef_] == [0.0, 0.0, 0.0]


def test_named_columns_are_checked():
    X = pd.DataFrame(designs(20, 5), columns=["ks", "cs"])
    fitted = ss.VariableBased(lambda X: curved(np.asarray(X))).fit(X, np.arange(20.0))
    assert list(fitted.feature_names_in_) == ["ks", "cs"]
    with pytest.raises(ValueError, match="feature names"):
        fitted.predict(X[["cs", "ks"]])


def constant(X):
    return np.ones(len(X))


@pytest.mark.parametrize(
    ("surrogate", "error", "words"),
    [
        (ss.ResponseBased(None), TypeError, "low_fidelity must be a callable"),
        (ss.ResponseBased(constant), ValueError, "the low-fidelity response is constant"),
        (ss.ResponseBased(lambda X: X), ValueError, r"shape \(20,\), got \(20, 2\)"),
        (ss.ResponseBased(lambda X: X[:, 0] * np.nan), ValueError, "finite numbers, got nan"),
        (ss.ResponseBased(curved, terms=(True,)), ValueError, "terms must be 2 of True or False"),
        (ss.ResponseBased(curved, terms=(False, False)), ValueError, "at least one True"),
        (ss.VariableBased(curved, terms=(1, 1, 1)), ValueError, "terms must be 3 of True or False"),
        (ss.VariableBased(curved, terms=((True, False), True)), ValueError, "terms must be 3 of True or False"),
        (ss.VariableBased(curved, nonnegative="no"), ValueError, "nonnegative must be True or False, got 'no'"),
        (ss.ResponseBased(lambda X: 1j * X[:, 0]), ValueError, "real numbers, got complex128"),
        (ss.ResponseBased(lambda X: ["a"] * len(X)), ValueError, "real numbers, got <U1"),
        (ss.ResponseBased(lambda X: None), ValueError, r"shape \(20,\), got \(\)"),
    ],
)
def test_bad_settings(surrogate, error, words):
    with pytest.raises(error, match=words):
        surrogate.fit(designs(20, 6), np.arange(20.0))


def test_bad_designs():
    X = designs(20, 7)
    stuck = np.column_stack([X[:, 0], np.full(20, 1500.0)])
    with pytest.raises(ValueError, match="column 1 of X is constant or depends on the others"):
        ss.VariableBased(curved).fit(stuck, np.arange(20.0))
    named = pd.DataFrame(stuck, columns=["ks", "cs"])
    with pytest.raises(ValueError, match="cs is constant"):
        ss.VariableBased(curved).fit(named, np.arange(20.0))
    with pytest.raises(ValueError, match="3 coefficients need at least 3 designs"):
        ss.VariableBased(curved).fit(X[:2], [1.0, 2.0])
    with pytest.raises(ValueError, match="NaN"):
        ss.VariableBased(curved).fit(X, np.full(20, np.nan))


@pytest.mark.parametrize("size", SIZES.values(), ids=SIZES.keys())
@pytest.mark.parametrize("exponent", [0.6, 1.0, 2.5, -1.0])
def test_known_power_law_is_recovered(size, exponent):
    X = designs(40, 9)
    power = ss.ResponseBased(lambda X: size * curved(X), form="power").fit(X, 3.0 * curved(X) ** exponent)
    np.testing.assert_allclose([power.intercept_, *power.coef_], [3.0 / size**exponent, exponent], rtol=1e-9)
    np.testing.assert_allclose(power.predict(X), 3.0 * curved(X) ** exponent, rtol=1e-12)


@given(st.integers(0, 10_000))
@settings(max_examples=25)
def test_power_law_is_least_squares_in_the_response(seed):
    X, rng = designs(30, seed), np.random.default_rng(seed)
    f, y = curved(X), 2.0 * curved(X) ** 1.4 * np.exp(0.1 * rng.normal(size=30))
    power = ss.ResponseBased(curved, form="power").fit(X, y)

    def squares(a1):
        """The least sum of squares with the exponent a1, for which a0 is linear."""
        column = f**a1
        return np.sum((column @ y / (column @ column) * column - y) ** 2)

    least = minimize_scalar(squares, bounds=(-5.0, 8.0), method="bounded", options={"xatol": 1e-10})
    np.testing.assert_allclose(power.coef_[0], least.x, rtol=1e-5)
    assert np.sum((power.predict(X) - y) ** 2) <= least.fun * (1 + 1e-12)


@pytest.mark.parametrize(
    ("settings", "y", "words"),
    [
        ({"low_fidelity": lambda X: curved(X) - 5.0}, 1.0, "the low-fidelity response must be positive"),
        ({"low_fidelity": constant}, 1.0, "the low-fidelity response is constant"),
        ({}, -1.0, "y must be positive for form='power', got -20"),
        ({"nonnegative": True}, 1.0, "form='power' takes neither nonnegative nor terms, got True and None"),
        ({"terms": (True, True)}, 1.0, "takes neither nonnegative nor terms"),
        ({"form": "cubic"}, 1.0, "form must be 'linear' or 'power', got 'cubic'"),
    ],
)
def test_bad_power_laws(settings, y, words):
    with pytest.raises(ValueError, match=words):
        ss.ResponseBased(**{"low_fidelity": curved, "form": "power"} | settings).fit(
            designs(20, 10), y * np.arange(1.0, 21.0)
        )


def test_a_failed_solve_is_an_error(monkeypatch):
    import cvxpy

    monkeypatch.setattr(cvxpy.Problem, "status", property(lambda self: cvxpy.OPTIMAL_INACCURATE))
    for nonnegative in (False, True):
        with pytest.raises(RuntimeError, match="optimal_inaccurate"):
            ss.ResponseBased(curved, nonnegative=nonnegative).fit(designs(20, 8), np.arange(20.0))

    def breaks(self, **settings):
        raise cvxpy.SolverError("Solver 'CLARABEL' failed")

    monkeypatch.setattr(cvxpy.Problem, "solve", breaks)
    with pytest.raises(RuntimeError, match="was not solved: Solver 'CLARABEL' failed"):
        ss.ResponseBased(curved).fit(designs(20, 8), np.arange(20.0))
