"""PB: the tuned value is the global minimum over its bounds, to nearly all digits, and a bound is said aloud."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import susp_ss as ss

X = np.column_stack([np.linspace(12536, 24570, 40), np.linspace(2235, 798, 40)])


def cheap(X, m):
    """The quarter car's body acceleration in closed form, of order one."""
    return np.sqrt(192e3 * X[:, 1] / m**2 + (m + 45.4) * X[:, 0] ** 2 / (m**2 * X[:, 1])) / 30


@given(st.floats(80.0, 1200.0))
@settings(max_examples=60, deadline=None)
def test_known_parameter_is_recovered(m):
    fitted = ss.ParameterBased(cheap, bounds=(60.0, 1300.0)).fit(X, cheap(X, m))
    np.testing.assert_allclose(fitted.parameter_, m, rtol=1e-9)
    assert fitted.at_bound_ is None
    np.testing.assert_allclose(fitted.predict(X), cheap(X, m), rtol=1e-9)


@given(st.integers(0, 1000))
@settings(max_examples=20, deadline=None)
def test_residual_fit_is_stationary_and_lowest(seed):
    y = cheap(X, 300.0) * (1 + 0.1 * np.random.default_rng(seed).normal(size=len(X)))
    fitted = ss.ParameterBased(cheap, bounds=(60.0, 1300.0)).fit(X, y)
    m, squares = fitted.parameter_, lambda m: np.sum((cheap(X, m) - y) ** 2)
    dense = np.geomspace(60.0, 1300.0, 5001)
    assert squares(m) <= min(squares(value) for value in dense) * (1 + 1e-12)
    h = 1e-4 * m
    gradient = (squares(m + h) - squares(m - h)) / (2 * h)
    curvature = (squares(m + h) - 2 * squares(m) + squares(m - h)) / h**2
    assert abs(gradient / curvature) < 1e-7 * m


def many_valleys(X, a):
    return np.cos(6 * np.log(a)) + 0.3 * np.log(a / 5.0) ** 2 + 0.0 * X[:, 0] + 2.0


def test_global_minimum_among_several():
    target = np.full(len(X), 0.5)
    fitted = ss.ParameterBased(many_valleys, bounds=(0.1, 50.0)).fit(X, target)
    dense = np.geomspace(0.1, 50.0, 200_001)
    values = (np.cos(6 * np.log(dense)) + 0.3 * np.log(dense / 5.0) ** 2 + 2.0 - 0.5) ** 2
    assert np.sum((values[1:-1] < values[:-2]) & (values[1:-1] < values[2:])) >= 4
    np.testing.assert_allclose(fitted.parameter_, dense[np.argmin(values)], rtol=1e-4)


@pytest.mark.parametrize(("bounds", "side"), [((400.0, 900.0), "lower"), ((50.0, 200.0), "upper")])
def test_a_minimum_beyond_the_bounds_is_said(bounds, side):
    with pytest.warns(UserWarning, match=f"sits on its {side} bound"):
        fitted = ss.ParameterBased(cheap, bounds=bounds).fit(X, cheap(X, 300.0))
    assert fitted.at_bound_ == side
    assert fitted.parameter_ == bounds[side == "upper"]


def test_default_bounds_are_the_models_own():
    response = ss.Response(ss.QuarterCar(), ss.Road(), "bacc", parameter="ms")
    fitted = ss.ParameterBased(response).fit(X, response(X, 250.0))
    np.testing.assert_allclose(fitted.parameter_, 250.0, rtol=1e-8)
    with pytest.warns(UserWarning, match=r"\[63.5, 1270\]"):
        ss.ParameterBased(response).fit(X, 0.01 * response(X))


@pytest.mark.parametrize(
    ("bounds", "words"),
    [
        (None, "pass bounds="),
        ((1.0,), "two finite numbers"),
        ((1.0, np.nan), "two finite numbers"),
        (("a", "b"), "two finite numbers"),
        ((2.0, 1.0), "rise from above 0"),
        ((0.0, 1.0), "rise from above 0"),
        ((1.0, 1.0), "rise from above 0"),
    ],
)
def test_bad_bounds(bounds, words):
    with pytest.raises(ValueError, match=words):
        ss.ParameterBased(cheap, bounds=bounds).fit(X, cheap(X, 300.0))


def test_bad_low_fidelity():
    with pytest.raises(TypeError, match="must be a callable"):
        ss.ParameterBased(None, bounds=(1.0, 2.0)).fit(X, X[:, 0])
    with pytest.raises(ValueError, match="finite numbers"):
        ss.ParameterBased(lambda X, m: X[:, 0] * np.inf, bounds=(1.0, 2.0)).fit(X, X[:, 0])
