"""Radial basis functions: scipy's interpolant on scaled columns, and leave-one-out errors as leaving runs out gives."""

import numpy as np
import pandas as pd
import pytest
from scipy.interpolate import RBFInterpolator

import susp_ss as ss
from susp_ss.surrogates.radial_basis import KERNELS, LEAST_DEGREE, SHAPED, leave_one_out


def designs(n, seed):
    rng = np.random.default_rng(seed)
    return np.column_stack([rng.uniform(12536, 24570, n), rng.uniform(798, 2235, n)])


def curved(X):
    return 0.5 + 1e-9 * X[:, 0] ** 1.9 + 0.2 * np.sin(X[:, 1] / 500)


def scaled(X, box):
    low, high = box.min(axis=0), box.max(axis=0)
    return 2 * (X - low) / (high - low) - 1


def settings(kernel):
    return {"kernel": kernel, "shape": 1.5 if kernel in SHAPED else None}


@pytest.mark.parametrize("kernel", KERNELS)
@pytest.mark.parametrize("extra", [0, 1])
def test_interpolant_is_scipys(kernel, extra):
    X, T = designs(25, 1), designs(200, 2)
    degree = LEAST_DEGREE[kernel] + extra
    ours = ss.RadialBasis(**settings(kernel), degree=degree).fit(X, curved(X))
    scipys = RBFInterpolator(scaled(X, X), curved(X), kernel=kernel, epsilon=ours.shape_, degree=degree)
    np.testing.assert_allclose(ours.predict(T), scipys(scaled(T, X)), rtol=1e-9)
    np.testing.assert_allclose(ours.predict(X), curved(X), rtol=1e-9)


@pytest.mark.parametrize("kernel", KERNELS)
def test_default_degree_is_scipys(kernel):
    X, T = designs(25, 3), designs(50, 4)
    ours = ss.RadialBasis(**settings(kernel)).fit(X, curved(X))
    scipys = RBFInterpolator(scaled(X, X), curved(X), kernel=kernel, epsilon=ours.shape_)
    np.testing.assert_allclose(ours.predict(T), scipys(scaled(T, X)), rtol=1e-9)


@pytest.mark.parametrize("kernel", KERNELS)
@pytest.mark.parametrize("extra", [0, 1])
@pytest.mark.parametrize("shape", [0.7, 2.0])
def test_leave_one_out_is_leaving_one_out(kernel, extra, shape):
    X = designs(18, 5)
    Z, y, degree = scaled(X, X), curved(X), LEAST_DEGREE[kernel] + extra
    brute = [
        y[i]
        - RBFInterpolator(np.delete(Z, i, 0), np.delete(y, i), kernel=kernel, epsilon=shape, degree=degree)(Z[[i]])[0]
        for i in range(18)
    ]
    np.testing.assert_allclose(leave_one_out(Z, y, kernel, shape, degree), brute, rtol=1e-5, atol=1e-8)


@pytest.mark.parametrize("kernel", SHAPED)
def test_chosen_shape_has_the_least_leave_one_out_error(kernel):
    X = designs(30, 6)
    Z, y = scaled(X, X), curved(X)
    chosen = ss.RadialBasis(kernel).fit(X, y).shape_
    degree = max(LEAST_DEGREE[kernel], 0)
    errors = {shape: np.linalg.norm(leave_one_out(Z, y, kernel, shape, degree)) for shape in np.geomspace(0.3, 20, 80)}
    # Towards flat bumps the error halves from one shape on the list to the next.
    assert np.linalg.norm(leave_one_out(Z, y, kernel, chosen, degree)) <= 2.0 * min(errors.values())


@pytest.mark.parametrize("kernel", SHAPED)
def test_flat_shapes_do_not_spoil_the_choice(kernel):
    X, T = designs(40, 7), designs(200, 8)
    y = 1e-3 * (1.0 + X[:, 0] / 2e4 - X[:, 1] / 3e3)
    fitted = ss.RadialBasis(kernel).fit(X, y)
    inside = (X.min(axis=0) < T).all(axis=1) & (X.max(axis=0) > T).all(axis=1)
    truth = 1e-3 * (1.0 + T[inside, 0] / 2e4 - T[inside, 1] / 3e3)
    np.testing.assert_allclose(fitted.predict(T[inside]), truth, rtol=1e-2)


def test_a_run_twice_counts_once():
    X = designs(20, 9)
    once = ss.RadialBasis().fit(X, curved(X))
    twice = ss.RadialBasis().fit(np.vstack([X, X[3:7]]), np.append(curved(X), curved(X)[3:7]))
    np.testing.assert_array_equal(once.predict(designs(30, 10)), twice.predict(designs(30, 10)))


def test_one_design_with_two_responses_is_refused():
    X = designs(20, 11)
    X[12] = X[4]
    with pytest.raises(ValueError, match=r"rows 4 and 12 of X are one design with two responses, 4.0 and 12.0"):
        ss.RadialBasis().fit(X, np.arange(20.0))


def test_named_columns_are_checked():
    X = pd.DataFrame(designs(20, 12), columns=["ks", "cs"])
    fitted = ss.RadialBasis().fit(X, curved(X.to_numpy()))
    np.testing.assert_allclose(fitted.predict(X), curved(X.to_numpy()), rtol=1e-9)
    with pytest.raises(ValueError, match="feature names"):
        fitted.predict(X[["cs", "ks"]])
    with pytest.raises(ValueError, match="cs is constant, got 3 in every run"):
        ss.RadialBasis().fit(X.assign(cs=3.0), np.arange(20.0))


@pytest.mark.parametrize(
    ("surrogate", "words"),
    [
        (ss.RadialBasis("quintic"), "kernel must be one of linear, cubic, .*, got 'quintic'"),
        (ss.RadialBasis("linear", shape=1.0), "kernel 'linear' has no shape, got 1.0"),
        (ss.RadialBasis("gaussian", shape=0.0), "shape must be a number > 0, got 0.0"),
        (ss.RadialBasis("gaussian", shape=np.nan), "shape must be a number > 0, got nan"),
        (ss.RadialBasis("gaussian", shape="auto"), "shape must be a number > 0, got 'auto'"),
        (ss.RadialBasis("gaussian", degree=-2), "degree must be a whole number >= -1 for kernel 'gaussian', got -2"),
        (ss.RadialBasis(degree=0), "degree must be a whole number >= 1 for kernel 'thin_plate_spline', got 0"),
        (ss.RadialBasis(degree=1.5), "degree must be a whole number >= 1"),
        (ss.RadialBasis(degree=5), r"degree 5 needs at least 21 different designs, got 20 sample\(s\)"),
        (ss.RadialBasis("gaussian", degree=5), "degree 5 needs at least 22 different designs"),
    ],
)
def test_bad_settings(surrogate, words):
    with pytest.raises(ValueError, match=words):
        surrogate.fit(designs(20, 13), np.arange(20.0))


@pytest.mark.parametrize("kernel", KERNELS)
@pytest.mark.parametrize("step", [1.0, 0.1, 1.0 / 3.0, np.pi])
@pytest.mark.parametrize("slope", [1.0, 0.7, -3.0])
def test_designs_on_a_line_are_refused_by_a_linear_tail(kernel, step, slope):
    x = step * np.arange(8.0)
    X = np.column_stack([x, 2.0 + slope * x])
    with pytest.raises(ValueError, match="these designs do not determine the interpolant"):
        ss.RadialBasis(kernel, degree=1, shape=2.0 if kernel in SHAPED else None).fit(X, np.arange(8.0) ** 2)


def test_designs_on_a_parabola_are_refused_by_a_quadratic_tail():
    x = np.linspace(0.0, 1.0, 12)
    with pytest.raises(ValueError, match="these designs do not determine the interpolant"):
        ss.RadialBasis("cubic", degree=2).fit(np.column_stack([x, 0.3 + x - 2.0 * x**2]), np.sin(x))


@pytest.mark.parametrize("kernel", SHAPED)
def test_bumps_too_flat_for_sixteen_digits_are_refused(kernel):
    X = designs(60, 14)
    assert np.isfinite(ss.RadialBasis(kernel, shape=3.0).fit(X, curved(X)).predict(X)).all()
    with pytest.raises(ValueError, match="take a larger shape"):
        ss.RadialBasis(kernel, shape=1e-4).fit(X, curved(X))


@pytest.mark.parametrize("surrogate", [ss.RadialBasis(), ss.Kriging(), ss.Polynomial(1)])
def test_a_column_that_varies_by_rounding_alone_is_constant(surrogate):
    X = designs(20, 15)
    X[:, 1] = np.where(np.arange(20) % 2, 0.1 + 0.2, 0.3)
    with pytest.raises(ValueError, match=r"column 1 of X is constant, got 0\.3 in every run"):
        ss.RadialBasis().fit(X, np.arange(20.0))
