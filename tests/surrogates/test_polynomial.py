"""Polynomials: least squares on raw monomials, formulas that survive the trip to a spreadsheet, and exact tangents."""

import math

import numpy as np
import pandas as pd
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import susp_ss as ss


def designs(n, seed):
    rng = np.random.default_rng(seed)
    return np.column_stack([rng.uniform(12536, 24570, n), rng.uniform(798, 2235, n)])


def curved(X):
    return 0.5 + 1e-9 * X[:, 0] ** 1.9 + 0.2 * np.sqrt(X[:, 1] / 1500)


def monomials(X, degree):
    """Columns ks^i cs^j, i + j <= degree, in the order of the terms."""
    powers = [(total - j, j) for total in range(degree + 1) for j in range(total + 1)]
    return np.column_stack([X[:, 0] ** i * X[:, 1] ** j for i, j in powers])


@given(st.integers(0, 10_000), st.integers(1, 4))
@settings(max_examples=25)
def test_fit_is_least_squares_on_raw_monomials(seed, degree):
    X = designs(40, seed)
    y = curved(X) + 0.01 * np.random.default_rng(seed).normal(size=40)
    fitted = ss.Polynomial(degree).fit(X, y)
    # In kN/m and kN s/m the raw monomials are mild enough for numpy.
    size = monomials(np.array([[1e4, 1e3]]), degree)[0]
    expected = np.linalg.lstsq(monomials(X / [1e4, 1e3], degree), y)[0] / size
    ours = np.array([fitted.intercept_, *fitted.coef_])
    np.testing.assert_allclose(ours * size, expected * size, rtol=1e-6, atol=1e-7 * np.abs(expected * size).max())
    np.testing.assert_allclose(fitted.predict(X), monomials(X, degree) @ expected, rtol=1e-8)


@pytest.mark.parametrize("degree", [1, 2, 3, 4])
def test_formula_evaluates_to_the_prediction(degree):
    X = pd.DataFrame(designs(60, 1), columns=["ks", "cs"])
    fitted = ss.Polynomial(degree).fit(X, curved(X.to_numpy()))
    typed = eval(fitted.formula().replace("^", "**"), {"ks": X["ks"].to_numpy(), "cs": X["cs"].to_numpy()})
    np.testing.assert_allclose(typed, fitted.predict(X), rtol=1e-12)
    assert len(fitted.terms_) == len(fitted.coef_) == math.comb(degree + 2, 2) - 1


def test_terms_are_named_by_the_columns():
    X = pd.DataFrame(designs(20, 2), columns=["ks", "cs"])
    assert ss.Polynomial(2).fit(X, np.arange(20.0)).terms_ == ["ks", "cs", "ks^2", "ks*cs", "cs^2"]
    assert ss.Polynomial(1).fit(X.to_numpy(), np.arange(20.0)).terms_ == ["x0", "x1"]


@pytest.mark.parametrize("variables", [1, 2, 3])
@pytest.mark.parametrize("degree", [1, 2])
def test_taylor_of_a_quadratic_is_the_quadratic(variables, degree):
    rng = np.random.default_rng(variables)
    c, H, g = rng.normal(size=variables) + 3.0, rng.normal(size=(variables, variables)), rng.normal(size=variables)

    def quadratic(X):
        return 0.7 + (X - c) @ g + (degree - 1) * np.einsum("ni,ij,nj->n", X - c, H, X - c)

    X = rng.normal(size=(20, variables)) + 3.0
    taylor = ss.Polynomial.taylor(quadratic, c, degree, step=np.full(variables, 0.1))
    np.testing.assert_allclose(taylor.predict(X), quadratic(X), rtol=1e-10, atol=1e-10)


def test_taylor_has_the_derivatives_of_its_response():
    center = np.array([18553.0, 1516.5])
    response = ss.Response(ss.QuarterCar(), ss.Road(), "bacc")
    taylor = ss.Polynomial.taylor(response, center)
    np.testing.assert_allclose(taylor.predict(center[None]), response(center[None]), rtol=1e-14)
    # The quarter car's closed form, in complex steps: q (kt cs / ms^2 + (ms + mu) ks^2 / (ms^2 cs)), up to a constant.
    scale = response(center[None])[0] / np.sqrt(bacc_squared(*center))
    for i, h in enumerate(1e-20j * np.eye(2)):
        slope = scale * np.sqrt(bacc_squared(*(center + h))).imag / 1e-20
        e = np.eye(2)[i]
        ours = (taylor.predict([center + e]) - taylor.predict([center - e]))[0] / 2
        np.testing.assert_allclose(ours, slope, rtol=1e-5)
    # Its error is of third order: eight times less at half the distance.
    away = np.array([1500.0, 150.0])
    far, near = (np.abs(taylor.predict([center + d]) - response([center + d])) for d in (away, away / 2))
    np.testing.assert_allclose(far / near, 8.0, rtol=0.2)


def bacc_squared(ks, cs, ms=317.5, mu=45.4, kt=192e3):
    return kt * cs / ms**2 + (ms + mu) * ks**2 / (ms**2 * cs)


def test_taylor_takes_the_columns_of_its_center():
    center = pd.DataFrame({"ks": [18e3], "cs": [1500.0]})
    taylor = ss.Polynomial.taylor(curved, center)
    assert list(taylor.feature_names_in_) == ["ks", "cs"]
    np.testing.assert_allclose(taylor.predict(center), curved(center.to_numpy()), rtol=1e-14)
    with pytest.raises(ValueError, match="feature names"):
        taylor.predict(center[["cs", "ks"]])


@pytest.mark.parametrize(
    ("arguments", "error", "words"),
    [
        ({"degree": 3}, ValueError, "degree of a Taylor polynomial must be 1 or 2, got 3"),
        ({"degree": True}, ValueError, "must be 1 or 2, got True"),
        ({"step": [1.0]}, ValueError, r"step must be 2 number\(s\) > 0"),
        ({"step": [1.0, -1.0]}, ValueError, r"> 0, one a variable, got \[1.0, -1.0\]"),
        ({"center": [0.0, 1.0]}, ValueError, r"step must be 2 number\(s\) > 0"),
        ({"center": [[1.0, 2.0], [3.0, 4.0]]}, ValueError, "center must be one design, got 2"),
        ({"center": [np.nan, 2.0]}, ValueError, "NaN"),
        ({"response": None}, TypeError, "response must be a callable"),
        ({"response": lambda X: X}, ValueError, "response must return one number for each design"),
    ],
)
def test_bad_taylor(arguments, error, words):
    with pytest.raises(error, match=words):
        ss.Polynomial.taylor(**{"response": curved, "center": [18e3, 1500.0]} | arguments)


@pytest.mark.parametrize("degree", [0, -1, 1.5, True, "two", None])
def test_bad_degree(degree):
    with pytest.raises(ValueError, match="degree must be a whole number >= 1, got"):
        ss.Polynomial(degree).fit(designs(20, 3), np.arange(20.0))


def test_bad_designs():
    X = designs(20, 4)
    with pytest.raises(ValueError, match=r"has 6 coefficients and needs at least 6 runs, got 5 sample\(s\)"):
        ss.Polynomial(2).fit(X[:5], np.arange(5.0))
    levels = np.column_stack([X[:, 0], np.where(X[:, 1] > 1500, 1.0, 2.0)])
    with pytest.raises(ValueError, match="determine 5 only; vary every column over at least 3 levels"):
        ss.Polynomial(2).fit(levels, np.arange(20.0))
    named = pd.DataFrame(np.column_stack([X[:, 0], np.full(20, 1500.0)]), columns=["ks", "cs"])
    with pytest.raises(ValueError, match="cs is constant, got 1500 in every run"):
        ss.Polynomial(1).fit(named, np.arange(20.0))
    with pytest.raises(ValueError, match="NaN"):
        ss.Polynomial(1).fit(X, np.full(20, np.nan))
    with pytest.raises(ValueError, match="3 features"):
        ss.Polynomial(1).fit(X, np.arange(20.0)).predict(np.ones((4, 3)))
