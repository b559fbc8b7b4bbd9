"""Derivatives of variances by a gain and by the weights behind it, against a dense tangent equation and differences."""

import numpy as np
import pytest
import scipy.linalg

import susp_ss as ss
from susp_ss.feedback.plant import plant
from susp_ss.feedback.preview import Law, optimal, variances
from susp_ss.feedback.slopes import by_gain, by_weights

UNEQUAL = ss.FullCar(cs=ss.Corners.axles(front=1300.0, rear=1700.0))
CASES = [
    (ss.QuarterCar(), ss.Road(), None),
    (ss.PitchHalfCar(), ss.Road(), "Wk"),
    (UNEQUAL, ss.Road(tracks="independent"), None),
    (UNEQUAL, ss.Road(tracks="isotropic"), None),
    (ss.PitchHalfCar(), ss.Road(cutoff=0.02, contact_length=0.1), None),
]


def regulated(car, road, weighting=None):
    """A plant, and the optimal law where every output that moves costs in proportion to its passive variance."""
    known = plant(car, road, weighting, "a test")
    passive, costs = known.variances(Law(known.no_force)), np.zeros(len(known.system.C))
    moving = known.rows[(passive[known.rows] > 0.0) & ~known.infinite]
    costs[moving] = 1.0 / passive[moving]
    costs[known.forces] = 1e-6
    return known, optimal(known.system, costs), moving


def test_slopes_by_a_gain_solve_the_tangent_of_the_lyapunov_equation():
    car, road = ss.FullCar(), ss.Road(tracks="independent", delay=False)
    known, law, moving = regulated(car, road)
    A, B, C, D = known.system
    W = np.vstack([noise.entries for noise in known.noises])
    dK = np.random.default_rng(1).normal(size=law.K.shape) * np.abs(law.K)
    Ac, Cc = A - B @ law.K, C - D @ law.K
    X = scipy.linalg.solve_continuous_lyapunov(Ac, -W.T @ W)
    moved = -B @ dK @ X
    dX = scipy.linalg.solve_continuous_lyapunov(Ac, -moved - moved.T)
    expected = np.diagonal(-2.0 * D @ dK @ X @ Cc.T + Cc @ dX @ Cc.T)[moving]
    found = sum(by_gain(known.system, noise, law.K, moving) for noise in known.noises)
    np.testing.assert_allclose((found * dK).sum(axis=(1, 2)), expected, rtol=1e-9, atol=1e-11 * np.abs(expected).max())


@pytest.mark.parametrize(("car", "road", "weighting"), CASES)
def test_slopes_are_the_limits_of_differences(car, road, weighting):
    known, law, moving = regulated(car, road, weighting)
    told = moving[[0, len(moving) // 2, -1]]
    dK = np.random.default_rng(2).normal(size=law.K.shape) * np.abs(law.K)

    def at(K):
        return variances(known.system, known.noises, Law(K))[told]

    step = 1e-5
    found = sum(by_gain(known.system, noise, law.K, told) for noise in known.noises)
    expected = (at(law.K + step * dK) - at(law.K - step * dK)) / (2.0 * step)
    np.testing.assert_allclose((found * dK).sum(axis=(1, 2)), expected, rtol=1e-6)

    row, step = moving[1], 1e-3
    up, down = (law.weights * np.where(np.arange(len(law.weights)) == row, s, 1.0) for s in (1.0 + step, 1.0 - step))
    expected = (at(optimal(known.system, up).K) - at(optimal(known.system, down).K)) / (2.0 * step)
    found = by_weights(known.system, known.noises, law, told)[:, row] * law.weights[row]
    np.testing.assert_allclose(found, expected, rtol=1e-4, atol=1e-4 * np.abs(expected).max())
