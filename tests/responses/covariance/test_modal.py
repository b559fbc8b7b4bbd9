"""Functions of any stable matrix: by modes and one by one, against scipy's and integrals."""

import numpy as np
import pytest
import scipy.linalg
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import quad_vec

from susp_ss.responses.covariance.modal import Modal

LAGS = -7.0 * np.eye(4) + 7.0 * np.eye(4, k=-1)


def stable(seed, n):
    A = 10.0 * np.random.default_rng(seed).standard_normal((n, n))
    return A - (np.linalg.eigvals(A).real.max() + 2.0) * np.eye(n)


def both(seed):
    """A plain matrix and one whose eigenvectors are all the same."""
    A = np.stack([stable(seed, 4), LAGS])
    return Modal(A, *np.linalg.eig(A))


@given(st.integers(0, 10**6))
@settings(max_examples=25)
def test_lyapunov(seed):
    dynamics, rng = both(seed), np.random.default_rng(seed)
    assert dynamics.parallel[1]
    Q = rng.standard_normal((2, 4, 4))
    Q = Q + Q.mT
    X, error = dynamics.lyapunov(Q)
    for A, q, x, e in zip(dynamics.A, Q, X, error, strict=True):
        np.testing.assert_allclose(
            x, scipy.linalg.solve_continuous_lyapunov(A, -q), rtol=1e-8, atol=1e-10 * np.abs(x).max()
        )
        assert e < 1e-10


@pytest.mark.parametrize("alphas", [np.array([[0.5, 40.0]] * 2), np.array([[3.0 + 4.0j, 20.0 - 9.0j]] * 2)])
def test_resolvents_and_what_a_delay_carries(alphas):
    dynamics, rng = both(3), np.random.default_rng(3)
    b, tau, eye = rng.standard_normal((2, 4)), np.array([0.07, 0.3]), np.eye(4)
    free, forced = dynamics.propagate(b, tau, alphas)
    x = rng.standard_normal((2, 2, 4, 3))
    solved = dynamics.resolvent(alphas[:, :, None, None], x)
    for i, A in enumerate(dynamics.A):
        np.testing.assert_allclose(free[i, :, 0], scipy.linalg.expm(A * tau[i]) @ b[i], rtol=1e-10)
        for j, alpha in enumerate(alphas[i]):
            np.testing.assert_allclose((alpha * eye - A) @ solved[i, j], x[i, j], rtol=1e-9, atol=1e-12)
            expected, _ = quad_vec(
                lambda s, A=A, i=i, alpha=alpha: scipy.linalg.expm(A * (tau[i] - s)) @ b[i] * np.exp(-alpha * s),
                0.0,
                tau[i],
            )
            np.testing.assert_allclose(forced[i, j, :, 0], expected, rtol=1e-8, atol=1e-12)


def test_a_colour_as_fast_as_a_mode_loses_nothing():
    A = np.array([[[-5.0, 0.0], [0.0, -80.0]]])
    dynamics, tau = Modal(A, *np.linalg.eig(A)), np.array([0.4])
    _, forced = dynamics.propagate(np.ones((1, 2)), tau, np.array([[5.0, 80.0, 1e4]]))
    mean = [tau * np.exp(-5.0 * tau), tau * np.exp(-80.0 * tau)]
    np.testing.assert_allclose(forced[0, 0, 0], mean[0], rtol=1e-13)
    np.testing.assert_allclose(forced[0, 1, 1], mean[1], rtol=1e-13)
    np.testing.assert_allclose(forced[0, 2, 0], (np.exp(-5.0 * tau) - np.exp(-1e4 * tau)) / (1e4 - 5.0), rtol=1e-12)


def test_one_matrix_for_many_designs():
    for A in (stable(1, 4)[None], LAGS[None]):
        dynamics, many = Modal(A, *np.linalg.eig(A)), np.repeat(A, 3, axis=0)
        apart, Q = Modal(many, *np.linalg.eig(many)), np.stack([k * np.eye(4) for k in (1.0, 2.0, 3.0)])
        np.testing.assert_allclose(dynamics.lyapunov(Q)[0], apart.lyapunov(Q)[0], rtol=1e-12)
        b, tau, alphas = np.ones((3, 4)), np.array([0.1, 0.2, 0.3]), np.array([[1.0], [2.0], [3.0]])
        for ours, theirs in zip(dynamics.propagate(b, tau, alphas), apart.propagate(b, tau, alphas), strict=True):
            np.testing.assert_allclose(ours, theirs, rtol=1e-12)
