"""Kriging: a trend plus a Gaussian process; with the cheap model in its trend, co-Kriging."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from sklearn.utils import gen_batches

from ..quantities import briefly
from .gaussian_process import KERNELS, LEAST_THETA, MOST_NOISE, MOST_THETA, Prediction, Process
from .left_out import left_out
from .low_fidelity import check_callable, evaluated
from .regressor import BATCH, DEPENDENT, Approximation, Array, independent, monomials

TRENDS = {"constant": 0, "linear": 1, "quadratic": 2}
"""Degrees of the trends that are monomials."""

THETAS, NOISES = (0.5 * LEAST_THETA, 2.0 * MOST_THETA), (0.0, 2.0 * MOST_NOISE)
"""Between which a fit's lie, lowest and highest."""

# A fit takes the third power of the runs, some hundred times; beyond this many it takes about this many seconds.
MANY, SECONDS = 500, 3.0


class _GaussianProcess(Approximation):
    """What Kriging and co-Kriging share: all but what the trend is made of.

    A trend is the monomials up to a degree in the scaled columns, and beside them guides: functions of the designs,
    centred and scaled over the runs.
    """

    kernel: str

    def _degrees(self) -> Sequence[int]:
        """Degrees that compete by likelihood; the first must be possible."""
        raise NotImplementedError

    def _guides(self, designs: Array) -> Array:
        """Further columns (n, q) of the trend."""
        raise NotImplementedError

    def _fit(self, X: ArrayLike, y: ArrayLike) -> None:
        designs, responses = self._merged(*self._runs(X, y))
        degrees = self._checked_degrees()
        if len(designs) > MANY:
            _warn_of_time(len(designs))
        Z, guides = self._scale(designs)
        found: list[tuple[int, Prediction]] = []
        for degree in degrees:
            P = _trend(Z, guides, degree)
            if found and not (independent(P) and len(P) > P.shape[1] + self.n_features_in_):
                continue
            self._check_trend(P, degree)
            theta, noise = Process(Z, responses, P, self.kernel).search()
            found.append((degree, Prediction(Z, responses, P, self.kernel, theta, noise)))
        self._take(*min(found, key=lambda one: one[1].deviance_with_trend))

    def predict(self, X: ArrayLike, return_std: bool = False, *, interval: float | None = None) -> Any:
        """Predict the responses at designs.

        Parameters
        ----------
        X : array_like, (n, k), or DataFrame
        return_std : bool
            Also return the standard deviation of a run there.
        interval : float, optional
            Share of new responses that the bounds are to hold, by the jackknife+ as for every surrogate, with errors
            in proportion to the standard deviation.

        Returns
        -------
        ndarray (n,), or ndarray (n,) and ndarray (n,) or (n, 2)
            The mean; with ``return_std`` also standard deviations, with an interval lower and upper bounds.

        Raises
        ------
        ValueError
            Bad designs or interval, both ``return_std`` and an interval, or runs too few for an interval.

        Warns
        -----
        ExtrapolationWarning
            Designs outside the box of the runs, where no interval holds.
        """
        if return_std and interval is not None:
            raise ValueError("predict returns a standard deviation or an interval, got both; pass one of the two")
        designs = self._designs(X)
        if interval is not None:
            return self._with_interval(designs, interval)
        mean = self._at(designs)
        return (mean, self._std(designs)) if return_std else mean

    def _at(self, designs: Array) -> Array:
        (mean,) = self._batched(designs, self._guides(designs), self.process_.mean)
        return mean

    def _std(self, designs: Array) -> Array:
        (std,) = self._batched(designs, self._guides(designs), self.process_.std)
        return self.calibration_ * std

    def covariance(self, X: ArrayLike) -> Array:
        """Return the covariance of the responses at designs that the runs leave, without a run's own noise.

        Parameters
        ----------
        X : array_like, (n, k), or DataFrame

        Returns
        -------
        ndarray, (n, n)
            In the unit of the responses squared, by the likeliest variance: with a run's noise, and times the square
            of ``calibration_``, its diagonal is the square of the standard deviations of `predict`. What a further run
            takes of it stands in ``susp_ss.surrogates.next_designs``.
        """
        designs = self._columns(X)
        return self.process_.covariance(*self._scaled(designs, self._guides(designs)))

    def _common(self, designs: Array) -> tuple[Array, ...]:
        return (self._guides(designs),)

    def _at_with_size(self, designs: Array, *common: Array) -> tuple[Array, Array]:
        # Where a trend meets all runs, next to nothing: errors are then alike.
        (guides,) = common or self._common(designs)
        mean, std = self._batched(designs, guides, self.process_.mean, self.process_.std)
        return mean, np.maximum(self.calibration_ * std, np.finfo(float).tiny)

    def _batched(self, designs: Array, guides: Array, *parts: Callable[[Array, Array], Array]) -> list[Array]:
        Z, P = self._scaled(designs, guides)
        batches = list(gen_batches(len(designs), BATCH))
        return [np.concatenate([part(Z[some], P[some]) for some in batches]) for part in parts]

    def predict_left_out(self, folds: Sequence[NDArray[np.intp]]) -> tuple[Array, Array]:
        """Predict runs by the others alone, in closed form, with thetas, noise, trend and calibration of all.

        Parameters
        ----------
        folds : sequence of ndarray of int
            Rows of the fitted designs, each in one fold; a fold is left out together, equal designs in one.

        Returns
        -------
        ndarray (n,), ndarray (n,)
            Mean and standard deviation, as of a fit to the other runs of a fold with these thetas and calibration.

        Raises
        ------
        ValueError
            A fold without which the trend is not determined, with the number of its runs.
        """
        process = self.process_
        mean, std = process.y.copy(), np.empty(process.n)
        distinct = [np.unique(self._of_run[S]) for S in folds]
        for S, errors, squares in left_out(process.H, process.y, process.P, distinct):
            variance = process.variance_without(S, errors)
            mean[S] -= errors
            std[S] = self.calibration_ * np.sqrt(variance * squares)
        return mean[self._of_run], std[self._of_run]

    def _checked_degrees(self) -> Sequence[int]:
        if self.kernel not in KERNELS:
            raise ValueError(f"kernel must be one of {', '.join(KERNELS)}, got {briefly(self.kernel)}")
        return self._degrees()

    def _check_trend(self, P: Array, degree: int) -> None:
        n, m = P.shape
        if n < m + 1:
            named = next(name for name, known in TRENDS.items() if known == degree)
            raise ValueError(
                f"a {named} trend in {self.n_features_in_} variable(s) needs at least {m + 1} different designs, got "
                f"{n} sample(s)"
            )
        if not independent(P):
            raise ValueError(f"these designs do not tell the {m} columns of the trend apart; vary them otherwise")

    def _scale(self, designs: Array) -> tuple[Array, Array]:
        """The runs on scaled columns (n, k), and their guides (n, q)."""
        self.box_ = self._box(designs)
        guides = self._guides(designs)
        self._centre, self._spread = guides.mean(axis=0), np.ptp(guides, axis=0)
        level = self._spread <= DEPENDENT * np.abs(guides).max(axis=0)
        if level.any():
            raise ValueError(f"the trend has {guides[0, np.argmax(level)]:g} for every run, which leads nowhere")
        return self.box_.transform(designs), (guides - self._centre) / self._spread

    def _scaled(self, designs: Array, guides: Array) -> tuple[Array, Array]:
        """Designs on scaled columns, and the columns of the trend there."""
        Z = self.box_.transform(designs)
        return Z, _trend(Z, (guides - self._centre) / self._spread, self._degree)

    def _take(self, degree: int, process: Prediction, calibration: float | None = None) -> None:
        self._degree, self.process_ = degree, process
        # Not below 1: thetas that have seen a run flatter its error. Nor is what is not known.
        self.calibration_ = max(1.0, process.calibration()) if calibration is None else calibration
        self.theta_ = process.theta * self.box_.scale_**2
        self.noise_ = float(np.sqrt(process.variance * process.noise))

    def _numbers(self) -> dict[str, Any]:
        return {
            "degree": self._degree,
            "scaled_thetas": self.process_.theta,
            "noise": self.process_.noise,
            "calibration": self.calibration_,
            "designs": self.runs_[0],
            "responses": self.runs_[1],
        }

    def _restore(self, found: dict[str, Any]) -> None:
        designs, responses = self._found_runs(found)
        self._checked_degrees()
        degree, thetas, noise = found["degree"], np.asarray(found["scaled_thetas"], dtype=float), float(found["noise"])
        if degree not in TRENDS.values():
            raise ValueError(f"degree must be one of {', '.join(map(str, TRENDS.values()))}, got {briefly(degree)}")
        least, most = THETAS
        if thetas.shape != (self.n_features_in_,) or not ((thetas >= least) & (thetas <= most)).all():
            raise ValueError(f"scaled_thetas must be one for each column, from {least:g} to {most:g}")
        if not NOISES[0] <= noise <= NOISES[1]:
            raise ValueError(f"noise must be from {NOISES[0]:g} to {NOISES[1]:g}, got {noise!r}")
        # Older files have none.
        calibration = found.get("calibration")
        if calibration is not None and not (type(calibration) in (int, float) and 1.0 <= calibration < np.inf):
            raise ValueError(f"calibration must be a number >= 1, got {briefly(calibration)}")
        Z, guides = self._scale(designs)
        P = _trend(Z, guides, degree)
        self._check_trend(P, degree)
        self._take(degree, Prediction(Z, responses, P, self.kernel, thetas, noise), calibration)


def _trend(Z: Array, guides: Array, degree: int) -> Array:
    return np.column_stack([monomials(Z, degree), guides])


def _degree_of(trend: Any) -> int:
    if not isinstance(trend, str) or trend not in TRENDS:
        raise ValueError(f"trend must be one of {', '.join(TRENDS)}, got {briefly(trend)}")
    return TRENDS[trend]


def _warn_of_time(runs: int) -> None:
    warnings.warn(
        f"Kriging of {runs} runs takes some {SECONDS * (runs / MANY) ** 3:.1g} s, for the third power of their number; "
        f"{MANY} are plenty in a few variables",
        UserWarning,
        stacklevel=4,
    )


class Kriging(_GaussianProcess):
    """Universal Kriging: a trend plus a Gaussian process, which interpolates exact runs and smooths noisy ones.

    ``S(x) = sum b_j p_j(x) + Z(x)`` with a correlation of ``t = sum theta_i (x_i - x'_i)^2`` for Z: the Gaussian
    ``exp(-t)`` or Matern's of 5/2, ``(1 + r + r^2/3) exp(-r)`` with ``r = sqrt(5 t)`` (*Feasibility study of surrogate
    model for the application of vehicle suspension system*, 2021, Eqs 22 to 28; its Eq 26 should sum over the design
    variables). Thetas, variance and noise are the likeliest by the restricted likelihood (D. Harville, *Journal of the
    American Statistical Association* 72, 1977), which allows for the trend's coefficients; runs count as exact unless
    noise makes them likelier than chance would.

    Parameters
    ----------
    trend : {"constant", "linear", "quadratic"} or callable
        Monomials, or ``p(X)``, designs (n, k) to columns (n,) or (n, m) that stand beside the constant.
    kernel : {"gaussian", "matern52"}
        The Gaussian for responses that are smooth everywhere, Matern's for those that bend at places.

    Attributes
    ----------
    theta_ : ndarray, (k,)
        In one over each variable's unit squared.
    noise_ : float
        Standard deviation of a run's own noise, in the unit of the responses; next to 0 for exact runs.
    calibration_ : float
        What predicted standard deviations are multiplied by, at least 1.

    Raises
    ------
    TypeError, ValueError
        From `fit`: an unknown trend or kernel, a trend that returns no finite columns or cannot be told apart at these
        designs, a constant column of X, or too few runs for the trend.

    Warns
    -----
    UserWarning
        From `fit`, above 500 runs, with the time that it may take.

    Notes
    -----
    The standard deviation is that of a run, with its own noise and the uncertainty of the trend, but takes thetas and
    noise for known and the correlation for right, and on smooth responses such as RMS values is too small. It is
    therefore multiplied by ``calibration_``, the root mean square of the errors of runs left out over their own
    deviations (F. Bachoc, *Computational Statistics & Data Analysis* 66, 2013), though not by less than 1: thetas that
    have seen a run flatter its error. Of new designs the mean and 1.96 deviations then held, in %, means over Kriging
    and co-Kriging of a linear and a nonlinear car's body acceleration, 24 draws each:

    ====  ============  ==============  ==========  ================  ============  ==============
    runs  exact: plain  not floored     calibrated  2 % noise: plain  not floored   calibrated
    ====  ============  ==============  ==========  ================  ============  ==============
    5     30            26              31          38                36            40
    10    47            47              52          62                60            63
    20    65            76              76          91                91            91
    60    86            90              90          92                92            92
    ====  ============  ==============  ==========  ================  ============  ==============

    With thetas found anew without each run the same factor holds 87 % from 10 and 95 % from 20 exact runs on, at the
    price of as many fits: ``predict(X, interval=0.95)`` pays it, for bounds that hold.

    Examples
    --------
    >>> import numpy as np
    >>> from susp_ss import Kriging
    >>> X = np.linspace(0.0, 6.0, 12)[:, None]
    >>> mean, std = Kriging().fit(X, np.sin(X[:, 0])).predict([[2.5], [9.0]], return_std=True)
    >>> bool(abs(mean[0] - np.sin(2.5)) < 1e-3), bool(std[1] > 10 * std[0])
    (True, True)

    Two runs of one design tell how noisy runs are:

    >>> twice = np.concatenate([X, X])
    >>> y = np.sin(twice[:, 0]) + np.random.default_rng(0).normal(0.0, 0.1, 24)
    >>> bool(0.05 < Kriging().fit(twice, y).noise_ < 0.2)
    True
    """

    def __init__(self, trend: Any = "constant", kernel: str = "gaussian"):
        self.trend = trend
        self.kernel = kernel

    def fit(self, X: ArrayLike, y: ArrayLike) -> Kriging:
        """Fit trend and process to the responses y (n,) at the designs X (n, k), which may repeat."""
        self._fit(X, y)
        return self

    def _degrees(self) -> Sequence[int]:
        return [0 if callable(self.trend) else _degree_of(self.trend)]

    def _guides(self, designs: Array) -> Array:
        if not callable(self.trend):
            return np.empty((len(designs), 0))
        columns = np.asarray(self.trend(designs))
        return np.stack(
            [evaluated(lambda _, column=column: column, designs, name="trend") for column in np.atleast_2d(columns.T)],
            axis=1,
        )


class CoKriging(_GaussianProcess):
    """Co-Kriging: Kriging of a few expensive runs, led by the cheap model.

    ``S(x) = b0 + rho f(x) + Z(x)`` with the cheap model's response f in the trend, to which its monomials of degree one
    are added where that is likelier. As f can be had at every design, this is the autoregressive co-Kriging of M.
    Kennedy and A. O'Hagan (*Biometrika* 87, 2000) without a second process for f. All else is as in `Kriging`.

    Parameters
    ----------
    low_fidelity : callable
        ``f(X)``, designs (n, k) as an array of floats to responses (n,), such as `susp_ss.Response`.
    trend : {"constant", "linear", "quadratic"}, optional
        What stands beside f; by default the likelier of the first two.
    kernel : {"gaussian", "matern52"}

    Attributes
    ----------
    rho_ : float
        What scales the cheap response.
    theta_, noise_, calibration_
        As of `Kriging`.

    Raises
    ------
    TypeError, ValueError
        From `fit`: a low-fidelity model that is not callable, returns no finite (n,) or the same for every run, and as
        `Kriging`.

    Warns
    -----
    UserWarning
        As `Kriging`.

    Examples
    --------
    >>> import numpy as np
    >>> from susp_ss import CoKriging
    >>> X = np.linspace(0.0, 6.0, 5)[:, None]
    >>> surrogate = CoKriging(lambda X: np.sin(2.0 * X[:, 0])).fit(X, 3.0 * np.sin(2.0 * X[:, 0]) + 0.1 * X[:, 0])
    >>> bool(abs(surrogate.predict([[2.5]])[0] - 3.0 * np.sin(5.0) - 0.25) < 0.01)
    True
    """

    def __init__(self, low_fidelity: Callable[[Any], Any], trend: str | None = None, kernel: str = "gaussian"):
        self.low_fidelity = low_fidelity
        self.trend = trend
        self.kernel = kernel

    def fit(self, X: ArrayLike, y: ArrayLike) -> CoKriging:
        """Fit trend and process to the responses y (n,) at the designs X (n, k), which may repeat."""
        check_callable(self.low_fidelity)
        self._fit(X, y)
        return self

    @property
    def rho_(self) -> float:
        """What scales the cheap response."""
        return float(self.process_.coefficients[-1] / self._spread[-1])

    def _degrees(self) -> Sequence[int]:
        return (0, 1) if self.trend is None else [_degree_of(self.trend)]

    def _guides(self, designs: Array) -> Array:
        return evaluated(self.low_fidelity, designs)[:, None]
