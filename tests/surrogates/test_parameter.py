"""PB: the tuned value is the global minimum over its bounds, to nearly all digits, and a bound is said aloud."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import brentq

import susp_ss as ss
from susp_ss.surrogates import parameter

X = np.column_stack([np.linspace(12536, 24570, 40), np.linspace(2235, 798, 40)])


def cheap(X, m):
    """The quarter car's body acceleration in closed form, of order one."""
    return np.sqrt(192e3 * X[:, 1] / m**2 + (m + 45.4) * X[:, 0] ** 2 / (m**2 * X[:, 1])) / 30


@given(st.floats(80.0, 1200.0))
@settings(max_examples=60)
def test_known_parameter_is_recovered(m):
    fitted = ss.ParameterBased(cheap, bounds=(60.0, 1300.0)).fit(X, cheap(X, m))
    np.testing.assert_allclose(fitted.parameter_, m, rtol=1e-9)
    assert fitted.at_bound_ is None
    np.testing.assert_allclose(fitted.predict(X), cheap(X, m), rtol=1e-9)


@given(st.integers(0, 1000))
@settings(max_examples=20)
def test_residual_fit_is_stationary_and_lowest(seed):
    y = cheap(X, 300.0) * (1 + 0.1 * np.random.default_rng(seed).normal(size=len(X)))
    fitted = ss.ParameterBased(cheap, bounds=(60.0, 1300.0)).fit(X, y)
    m = fitted.parameter_

    def squares(m):
        return np.sum((cheap(X, m) - y) ** 2)

    def gradient(m):
        """By the complex step, which is exact to rounding."""
        return cheap(X, m + 1e-30j).imag @ (cheap(X, m) - y) / 1e-30

    dense = np.geomspace(60.0, 1300.0, 5001)
    assert squares(m) <= min(squares(value) for value in dense) * (1 + 1e-12)
    np.testing.assert_allclose(m, brentq(gradient, 0.99 * m, 1.01 * m, xtol=1e-12, rtol=1e-14), rtol=1e-11)


def test_a_fit_costs_about_a_hundred_evaluations():
    values = []

    def counted(X, m):
        values.append(m)
        return cheap(X, m)

    ss.ParameterBased(counted, bounds=(60.0, 1300.0)).fit(X, cheap(X, 300.0) + 0.1 * np.sin(X[:, 0]))
    assert len(values) <= 100
    assert all(isinstance(m, float) and 60.0 <= m <= 1300.0 for m in values)


def many_valleys(X, a):
    return np.cos(6 * np.log(a)) + 0.3 * np.log(a / 5.0) ** 2 + 0.0 * X[:, 0] + 2.0


def test_global_minimum_among_several():
    target = np.full(len(X), 0.5)
    fitted = ss.ParameterBased(many_valleys, bounds=(0.1, 50.0)).fit(X, target)
    dense = np.geomspace(0.1, 50.0, 200_001)
    values = (np.cos(6 * np.log(dense)) + 0.3 * np.log(dense / 5.0) ** 2 + 2.0 - 0.5) ** 2
    assert np.sum((values[1:-1] < values[:-2]) & (values[1:-1] < values[2:])) >= 4
    np.testing.assert_allclose(fitted.parameter_, dense[np.argmin(values)], rtol=1e-4)


@given(st.floats(1.0, 29.0), st.integers(0, 1000))
@settings(max_examples=40)
def test_global_minimum_of_a_tuned_frequency(frequency, seed):
    """Waves out of tune have a dozen valleys, the narrowest three of the 65 steps wide."""
    time = np.linspace(0.0, 4.0, 200)
    wave = ss.ParameterBased(lambda X, a: np.sin(a * X[:, 0]), bounds=(0.0, 30.0))
    y = np.sin(frequency * time) + 0.3 * np.random.default_rng(seed).normal(size=200)
    tuned = wave.fit(time[:, None], y).parameter_
    dense = np.linspace(0.0, 30.0, 30_001)
    squares = np.sum((np.sin(np.outer(dense, time)) - y) ** 2, axis=1)
    assert np.sum((np.sin(tuned * time) - y) ** 2) <= squares.min()
    assert abs(tuned - dense[np.argmin(squares)]) <= 1e-3


@pytest.mark.parametrize("bounds", [(0.0, 1e-9), (6.9e-10, 7.1e-10), (6.999999e-10, 7.000002e-10)])
def test_small_and_narrow_ranges(bounds):
    fitted = ss.ParameterBased(lambda X, a: np.sqrt(1 + 1e9 * a * X[:, 1]), bounds=bounds)
    np.testing.assert_allclose(fitted.fit(X, np.sqrt(1 + 0.7 * X[:, 1])).parameter_, 7e-10, rtol=1e-9)
    assert fitted.at_bound_ is None


@pytest.mark.parametrize(("bounds", "value"), [((-5.0, 5.0), -2.0), ((0.0, 5.0), 3.0), ((-7, -1), -4.0)])
def test_bounds_need_not_be_positive(bounds, value):
    fitted = ss.ParameterBased(lambda X, a: np.sin(a * X[:, 1] / 2235), bounds=bounds).fit(
        X, np.sin(value * X[:, 1] / 2235)
    )
    np.testing.assert_allclose(fitted.parameter_, value, rtol=1e-9)


def test_a_minimum_beside_a_bound_is_not_on_it():
    fitted = ss.ParameterBased(cheap, bounds=(300.0, 900.0)).fit(X, cheap(X, 300.0 * (1 + 1e-6)))
    assert fitted.at_bound_ is None
    np.testing.assert_allclose(fitted.parameter_, 300.0 * (1 + 1e-6), rtol=1e-9)


@pytest.mark.parametrize(("bounds", "side"), [((400.0, 900.0), "lower"), ((50.0, 200.0), "upper")])
def test_a_minimum_beyond_the_bounds_is_said(bounds, side):
    with pytest.warns(UserWarning, match=f"sits on its {side} bound"):
        fitted = ss.ParameterBased(cheap, bounds=bounds).fit(X, cheap(X, 300.0))
    assert fitted.at_bound_ == side
    assert fitted.parameter_ == bounds[side == "upper"]


def test_default_bounds_are_the_models_own():
    response = ss.Response(ss.QuarterCar(), ss.Road(), "bacc", parameter="ms")
    fitted = ss.ParameterBased(response).fit(X, response(X, 250.0))
    np.testing.assert_allclose(fitted.parameter_, 250.0, rtol=1e-9)
    with pytest.warns(UserWarning, match=r"\[63.5, 1270\]"):
        ss.ParameterBased(response).fit(X, 0.01 * response(X))


@pytest.mark.parametrize(
    ("parameter", "value", "criterion"),
    [("kt", 150e3, "bacc"), ("kt", 150e3, "dtl"), ("mu", 60.0, "bacc"), ("mu", 60.0, "dtl")],
)
def test_any_parameter_of_the_model_can_be_tuned(parameter, value, criterion):
    response = ss.Response(ss.QuarterCar(), ss.Road(), criterion, parameter=parameter)
    fitted = ss.ParameterBased(response).fit(X, response(X, value))
    np.testing.assert_allclose(fitted.parameter_, value, rtol=1e-9)


@pytest.mark.parametrize(
    ("bounds", "words"),
    [
        (None, "pass bounds="),
        ((1.0,), "two finite numbers"),
        ((1.0, np.nan), "two finite numbers"),
        (("a", "b"), "two finite numbers"),
        (((1.0, 2.0), 3.0), "two finite numbers"),
        (5.0, "two finite numbers"),
        ((False, True), "two finite numbers"),
        ((2.0, 1.0), "rise from low to high"),
        ((1.0, 1.0), "rise from low to high"),
    ],
)
def test_bad_bounds(bounds, words):
    with pytest.raises(ValueError, match=words):
        ss.ParameterBased(cheap, bounds=bounds).fit(X, cheap(X, 300.0))


@pytest.mark.parametrize("own", [-1.0, 0.0, np.nan, "heavy"])
def test_default_bounds_need_a_positive_value(own):
    class Named:
        parameter_value = own

        def __call__(self, X, m):
            return cheap(X, m)

    with pytest.raises(ValueError, match=r"parameter_value is not a number > 0, got .*pass bounds="):
        ss.ParameterBased(Named()).fit(X, cheap(X, 300.0))


def test_bad_low_fidelity():
    for bounds in ((1.0, 2.0), None):
        with pytest.raises(TypeError, match="low_fidelity must be a callable"):
            ss.ParameterBased(None, bounds=bounds).fit(X, X[:, 0])
    with pytest.raises(ValueError, match="must depend on its second argument"):
        ss.ParameterBased(lambda X, m: X[:, 0], bounds=(1.0, 2.0)).fit(X, X[:, 1])
    with pytest.raises(ValueError, match=r"got \(\) at the parameter's value 1"):
        ss.ParameterBased(lambda X, m: m, bounds=(1.0, 2.0)).fit(X, X[:, 0])
    with pytest.raises(ValueError, match="finite numbers"):
        ss.ParameterBased(lambda X, m: X[:, 0] * np.inf, bounds=(1.0, 2.0)).fit(X, X[:, 0])


def test_a_parameter_that_acts_by_rounding_alone_is_refused():
    # The quarter car's working space is the square root of q M / 2 c, whatever the tyre.
    response = ss.Response(ss.QuarterCar(), ss.Road(), "sws", parameter="kt")
    with pytest.raises(ValueError, match="must depend on its second argument"):
        ss.ParameterBased(response).fit(X, 1.1 * response(X))


def test_a_model_of_values_per_design_is_tuned_alike(monkeypatch):
    asked = []

    class Whole:
        value_per_design = True

        def __call__(self, X, value):
            asked.append(np.size(value))
            return np.sin(value * X[:, 0])

    X = np.linspace(0.1, 2.0, 15)[:, None]
    y = np.sin(1.3 * X[:, 0]) + 0.05 * X[:, 0]
    one = ss.ParameterBased(lambda X, a: np.sin(a * X[:, 0]), bounds=(0.1, 3.0)).fit(X, y)
    monkeypatch.setattr(parameter, "TOGETHER", 100)
    many = ss.ParameterBased(Whole(), bounds=(0.1, 3.0)).fit(X, y)
    assert max(asked) == 90
    assert len(asked) <= 20
    assert many.parameter_ == pytest.approx(one.parameter_, rel=1e-9)
