"""A trend plus a Gaussian process, from one factorisation: restricted likelihood, predictions, runs left out.

Responses are ``y = P b + z`` with P (n, m) a trend's columns, the constant among them, and z of covariance ``s2 C``.
Contrasts ``K' y`` with ``K' P = 0`` know nothing of b, and have the covariance ``s2 W``, ``W = K' C K``. All else is
made of W and of ``H = K W^-1 K'``, which has every prediction, and every one without some of the runs, in it.

As constants drop out of contrasts, the correlation r may stand by its variogram ``1 - r``, whose small values keep the
digits that r loses; both it and the noise are taken relative to the variogram from one corner of the box of the runs
to the opposite one: ``C = noise I - (1 - r(t)) / (1 - r(t_box))``, ``t = sum theta_i (z_i - z'_i)^2``.
"""

from __future__ import annotations

import functools
from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import lapack
from scipy.optimize import OptimizeResult, minimize
from scipy.special import gammainc
from scipy.stats import qmc

from .regressor import DEPENDENT, Array

EPSILON = float(np.finfo(float).eps)

SQRT5 = np.sqrt(5.0)


class Kernel(NamedTuple):
    """A correlation by its variogram ``1 - r(t)``, to all digits however small, and that one's slope."""

    variogram: Callable[[Any], Any]
    slope: Callable[[Any], Any]


def _gaussian(t: Any) -> Any:
    return -np.expm1(-t)


def _gaussian_slope(t: Any) -> Any:
    return np.exp(-t)


def _matern(t: Any) -> Any:
    """``1 - (1 + a + a^2/3) exp(-a)``, where the incomplete gamma function is ``1 - (1 + a + a^2/2) exp(-a)``."""
    a = SQRT5 * np.sqrt(t)
    return gammainc(3.0, a) + a * a / 6.0 * np.exp(-a)


def _matern_slope(t: Any) -> Any:
    a = SQRT5 * np.sqrt(t)
    return 5.0 / 6.0 * (1.0 + a) * np.exp(-a)


# C. Rasmussen and C. Williams, Gaussian Processes for Machine Learning, 2006, Eqs 4.9 and 4.17.
KERNELS = {
    "gaussian": Kernel(_gaussian, _gaussian_slope),
    "matern52": Kernel(_matern, _matern_slope),
}

# Below, the process is a polynomial to most digits; beyond, neighbours tell nothing, and runs are noise alone.
LEAST_THETA, MOST_THETA, MOST_NOISE = 1e-5, 50.0, 100.0

# Noise below this, a hundred-thousandth of the responses' range, is none; above, W keeps half of its digits.
NOTED = 1e-10

# Where the search looks before it descends: thetas alike in all variables, and 2^MORE unlike ones.
ALIKE, MORE, NOISES = (0.003, 0.03, 0.1, 0.3, 1.0, 3.0), 3, (1e-4, 1e-1)

# When it stops, in the likelihood of one run.
ENOUGH, FLAT = 1e-5, 1e-2

# Noise is believed if it makes the runs as much likelier as chance does in one of 100 exact tables: the ratio's 99 %
# point of chi squared with one degree of freedom.
BELIEVED = 6.63

# For each run, in the measure of C: pivots of W stay clear of rounding under any kernel of LAPACK.
LEAST_NOISE = 0.5 * EPSILON


class Process:
    """Responses at scaled designs, as contrasts.

    Parameters
    ----------
    Z : ndarray, (n, k)
        Designs in the box from -1 to 1.
    y : ndarray, (n,)
    P : ndarray, (n, m)
        Columns of the trend, the constant among them, independent of one another.
    kernel : str
        One of `KERNELS`.
    """

    def __init__(self, Z: Array, y: Array, P: Array, kernel: str):
        self.Z, self.y, self.P, self.kernel = Z, y, P, KERNELS[kernel]
        self.n, self.k = Z.shape
        self.free = self.n - P.shape[1]
        self.squares = ((Z[:, None] - Z[None]) ** 2).transpose(2, 0, 1).reshape(self.k, -1)
        self.reflectors = lapack.dgeqrf(P)[:2]
        contrasts = self._contrast(y[:, None])[:, 0]
        size = float(np.linalg.norm(contrasts))
        # What is left of responses that the trend meets is rounding.
        self.size = size if size > DEPENDENT * np.linalg.norm(y) else 0.0
        self.contrasts = contrasts / self.size if self.size else np.zeros(self.free)
        self.least_noise = self.n * LEAST_NOISE

    def search(self) -> tuple[Array, float]:
        """The likeliest thetas (k,) and noise; without noise where that is as likely."""
        if not self.size:
            return np.ones(self.k), self.least_noise
        exact = self._descend([self.least_noise], (self.least_noise, self.least_noise), starts=2)
        noisy = self._descend(NOISES, (NOTED, MOST_NOISE), starts=1)
        at = noisy if self.free * (exact.fun - noisy.fun) > BELIEVED else exact
        return np.exp(at.x[:-1]), float(np.exp(at.x[-1]))

    def _descend(self, noises: Sequence[float], between: tuple[float, float], starts: int) -> OptimizeResult:
        least, most = np.log(LEAST_THETA), np.log(MOST_THETA)
        points = [np.append(theta, np.log(noise)) for theta in _thetas(self.k) for noise in noises]
        order = np.argsort([self.deviance(point) for point in points], kind="stable")
        found = [
            minimize(
                self.deviance_and_slope,
                points[i],
                jac=True,
                method="L-BFGS-B",
                bounds=[(least, most)] * self.k + [tuple(np.log(between))],
                options={"ftol": ENOUGH, "gtol": FLAT},
            )
            for i in order[:starts]
        ]
        return min(found, key=lambda at: at.fun)

    def deviance(self, at: Array) -> float:
        """Minus twice the logarithm of the restricted likelihood, a contrast; at log thetas and log noise (k + 1,).

        The variance is the likeliest: ``log s2 + log|W| / (n - m)``, ``s2 = y' H y / (n - m)``, up to a constant.
        """
        factor = self._factor(self._covariance(np.exp(at[:-1]), np.exp(at[-1])))
        return np.inf if factor is None else self._deviance(factor)[0]

    def deviance_and_slope(self, at: Array) -> tuple[float, Array]:
        """The deviance and its derivative (k + 1,)."""
        theta, noise = np.exp(at[:-1]), np.exp(at[-1])
        t, t_box = theta @ self.squares, 4.0 * theta.sum()
        variogram, slope = self.kernel.variogram(t), self.kernel.slope(t)
        across, slope_across = self.kernel.variogram(t_box), self.kernel.slope(t_box)
        factor = self._factor(self._covariance(theta, noise, variogram))
        if factor is None:
            return np.inf, np.zeros_like(at)
        deviance, weights, spread = self._deviance(factor)
        # d = trace(G dW), and so trace(K G K' dC), with dC = -d(variogram / across) and the noise.
        G = _inverse(factor) / self.free - np.outer(weights, weights) / spread
        M = self._spread(self._spread(G).T).ravel()
        of_t = 4.0 * slope_across / across**2 * (M @ variogram) - self.squares @ (M * slope) / across
        return deviance, np.append(theta * of_t, noise * np.trace(G))

    def _deviance(self, factor: Array) -> tuple[float, Array, float]:
        weights = _solved(factor, self.contrasts)
        spread = float(self.contrasts @ weights)
        return float(np.log(spread / self.free) + 2.0 * np.log(np.diag(factor)).sum() / self.free), weights, spread

    def _covariance(self, theta: Array, noise: float, variogram: Array | None = None) -> Array:
        if variogram is None:
            variogram = self.kernel.variogram(theta @ self.squares)
        C = variogram.reshape(self.n, self.n) / -self.kernel.variogram(4.0 * theta.sum())
        C.flat[:: self.n + 1] += noise
        return C

    def _factor(self, C: Array) -> Array | None:
        """Cholesky's factor of W; None where a pivot is no more than rounding, whether or not LAPACK stops there."""
        W = self._contrast(self._contrast(C).T)
        factor, failed = lapack.dpotrf(W, lower=1)
        if failed or np.diag(factor).min() ** 2 <= EPSILON * np.diag(W).max():
            return None
        return factor

    def _contrast(self, A: Array) -> Array:
        """``K' A``: the last rows of ``Q' A``, where ``P = Q R``."""
        return lapack.dormqr("L", "T", *self.reflectors, A, 64 * A.shape[1])[0][self.n - self.free :]

    def _spread(self, A: Array) -> Array:
        """``K A``."""
        below = np.zeros((self.n, A.shape[1]))
        below[self.n - self.free :] = A
        return lapack.dormqr("L", "N", *self.reflectors, below, 64 * A.shape[1])[0]


@functools.cache
def _thetas(k: int) -> list[Array]:
    """Logarithms of thetas (k,) to look at first."""
    lowest, highest = np.log(ALIKE[0]), np.log(ALIKE[-1])
    unlike = qmc.Sobol(k, scramble=False).random_base2(MORE)
    return [*(np.full(k, np.log(theta)) for theta in ALIKE), *(lowest + unlike * (highest - lowest))]


def _solved(factor: Array, A: Array) -> Array:
    return lapack.dpotrs(factor, A, lower=1)[0]


def _inverse(factor: Array) -> Array:
    lower = lapack.dpotri(factor, lower=1)[0]
    inverse = lower + lower.T
    inverse.flat[:: len(inverse) + 1] *= 0.5
    return inverse


class Prediction(Process):
    """The process with thetas and noise found, ready to predict.

    Parameters
    ----------
    theta : ndarray, (k,)
    noise : float
        In the measure of C.
    """

    def __init__(self, Z: Array, y: Array, P: Array, kernel: str, theta: Array, noise: float):
        super().__init__(Z, y, P, kernel)
        self.theta, self.noise = theta, max(noise, self.least_noise)
        self.across = float(self.kernel.variogram(4.0 * theta.sum()))
        self.C = self._covariance(theta, self.noise)
        factor = self._factor(self.C)
        if factor is None:
            raise ValueError("these runs and thetas leave no digits")
        self.factor = factor
        weights = self.size * _solved(factor, self.contrasts)
        self.variance = self.size * float(self.contrasts @ weights) / self.free
        self.weights = self._spread(weights[:, None])[:, 0]
        self.averages = np.linalg.pinv(P)
        self.coefficients = self.averages @ (y - self.C @ self.weights)

    @property
    def deviance_with_trend(self) -> float:
        """Minus twice the logarithm of the likelihood, in which trends can be compared.

        Each coefficient beyond the constant's may be anything as wide as the responses themselves.
        """
        if not self.size:
            return -np.inf
        width = np.linalg.norm(self.y - self.y.mean())
        likelihood = self.free * (self._deviance(self.factor)[0] + 2.0 * np.log(self.size))
        return likelihood + 2.0 * (self.P.shape[1] - 1) * np.log(width)

    def mean(self, Z: Array, P: Array) -> Array:
        """The mean (N,) at designs (N, k) with the trend's columns (N, m)."""
        return P @ self.coefficients - self._variogram(Z) @ self.weights

    def std(self, Z: Array, P: Array) -> Array:
        """The standard deviation (N,) of a run there, its own noise and the trend's uncertainty included."""
        variogram, a, left, corrected = self._left(Z, P)
        own = self.noise + np.sum(a * (variogram - left), axis=1)
        return np.sqrt(self.variance * np.maximum(own - np.sum(corrected**2, axis=0), 0.0))

    def covariance(self, Z: Array, P: Array) -> Array:
        """The covariance (N, N) of the response itself, without the noise of a run."""
        variogram, a, left, corrected = self._left(Z, P)
        own = a @ variogram.T - left @ a.T - self._between(Z, Z)
        return self.variance * (own - corrected.T @ corrected)

    def _left(self, Z: Array, P: Array) -> tuple[Array, Array, Array, Array]:
        """What is left of the process at designs when averages of the runs are taken off, by these averages.

        Averages a' y are as P b; the process is left, and corrected by its covariance with the contrasts.
        """
        variogram, a = self._variogram(Z), P @ self.averages
        left = -variogram - a @ self.C
        return variogram, a, left, lapack.dtrtrs(self.factor, self._contrast(left.T), lower=1)[0]

    def _variogram(self, Z: Array) -> Array:
        return self._between(Z, self.Z)

    def _between(self, Z: Array, others: Array) -> Array:
        columns = zip(self.theta, Z.T, others.T, strict=True)
        t = sum(theta * np.subtract.outer(at, runs) ** 2 for theta, at, runs in columns)
        return self.kernel.variogram(t) / self.across

    def variance_without(self, left_out: NDArray[np.intp], errors: Array) -> float:
        """The variance of the other runs alone, by the errors of their prediction of those left out."""
        of_all = self.variance * self.free
        # Where the trend meets the others, what is left of the difference is rounding.
        return max(of_all - float(self.weights[left_out] @ errors), 0.0) / (self.free - len(left_out))

    def calibration(self) -> float:
        """Root mean square of the errors of runs left out, each over its own standard deviation, by this variance.

        ``sqrt(mean(e_i^2 / (s2 c_i)))`` with ``e_i = (H y)_i / H_ii`` and ``c_i = 1 / H_ii``. Its square is the
        variance by cross-validation over the likeliest one (F. Bachoc, *Computational Statistics & Data Analysis* 66,
        2013, Eq 7). NaN where no run can be left out, or the trend meets them all.
        """
        h = np.diag(self.H)
        # Without the others the trend is not determined, and there is no error.
        known = h > DEPENDENT * h.max()
        squares = self.weights[known] ** 2 / h[known]
        return float(np.sqrt(np.mean(squares) / self.variance)) if self.size and known.any() else np.nan

    @functools.cached_property
    def H(self) -> Array:
        """``K W^-1 K'`` (n, n)."""
        return self._spread(self._spread(_inverse(self.factor)).T)
