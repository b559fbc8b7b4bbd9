"""Many systems of equations at once against LAPACK one by one."""

import numpy as np
import pytest

from susp_ss.vehicles.elimination import TOGETHER, solved


def stacks(n, systems, k=3):
    rng = np.random.default_rng(n)
    return rng.standard_normal((n, n + k, systems)) + 1j * rng.standard_normal((n, n + k, systems))


def by_lapack(equations):
    n, each = len(equations), np.moveaxis(equations, -1, 0)
    return np.moveaxis(np.linalg.solve(each[..., :n], each[..., n:]), 0, -1)


@pytest.mark.parametrize("n", [1, 2, 7])
@pytest.mark.parametrize("systems", [1, TOGETHER + 5])
def test_solutions_are_lapacks(n, systems):
    equations = stacks(n, systems)
    expected = by_lapack(equations)
    size = np.abs(expected).max(axis=(0, 1))
    np.testing.assert_allclose(solved(equations.copy()) / size, expected / size, rtol=0.0, atol=1e-10)


@pytest.mark.parametrize("tiny", [0.0, 1e-14])
def test_a_pivot_of_next_to_nothing_is_swapped_in_the_systems_that_have_it(tiny):
    equations = stacks(4, 60)
    equations[range(4), range(4), ::3] *= tiny
    equations[0, :4, ::2] *= 1e-9
    np.testing.assert_allclose(solved(equations.copy()), by_lapack(equations), rtol=1e-8)


def test_what_is_coupled_through_the_last_alone():
    """Wheels feel one another through the body only: zeros that all systems share, in a matrix not its transpose."""
    equations = stacks(6, 40)
    equations[:4, :4] *= np.eye(4)[..., None]
    expected = by_lapack(equations)
    np.testing.assert_allclose(solved(equations.copy()), expected, rtol=1e-9)
    equations[4:, :3] = 0.0
    np.testing.assert_allclose(solved(equations.copy()), by_lapack(equations), rtol=1e-9)
