"""Kriging: a trend plus a Gaussian process, of one model's runs or of two models' together; by SMT."""

from __future__ import annotations

import warnings
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import ArrayLike
from scipy.stats import qmc
from sklearn.utils import check_random_state, gen_batches

from ..extras import needing
from ..quantities import briefly, whole_number
from .low_fidelity import check_callable, evaluated
from .regressor import Approximation, Array

# Coefficients of a trend in k variables.
TRENDS: dict[str, Callable[[int], int]] = {
    "constant": lambda k: 1,
    "linear": lambda k: 1 + k,
    "quadratic": lambda k: (1 + k) * (2 + k) // 2,
}

CORRELATION = "squar_exp"

# Bounds that no theta of the search, which keeps within 1e-6 and 20, is rounded out of.
ANY = [1e-7, 100.0]

# Of the search for the thetas, whose likelihood has many peaks.
STARTS = 10

# A fit takes the third power of the runs, hundreds of times; beyond this many it takes about this many minutes.
MANY, MINUTES = 500, 0.5

# Designs predicted at once: a prediction holds every distance from every run.
BATCH = 1000


class _GaussianProcess(Approximation):
    """What one model's Kriging and two models' share."""

    trend: str
    random_state: Any

    def predict(self, X: ArrayLike, return_std: bool = False) -> Array | tuple[Array, Array]:
        """Return the mean (n,) at the designs X (n, k), and on demand its standard deviation (n,)."""
        designs = self._designs(X)
        batches = [self.box_.transform(designs[batch]) for batch in gen_batches(len(designs), BATCH)]
        mean = np.concatenate([self.model_.predict_values(Z)[:, 0] for Z in batches])
        if not return_std:
            return mean
        variance = np.concatenate([self.model_.predict_variances(Z)[:, 0] for Z in batches])
        return mean, np.sqrt(np.maximum(variance, 0.0))

    def _krige(self, model: type, *samples: tuple[Array, Array], thetas: Any = None) -> None:
        """SMT's model of the samples on the scaled columns, the cheapest first; its thetas by search if not given."""
        scaled = [(self.box_.transform(designs), responses) for designs, responses in samples]
        if thetas is None:
            for designs, _ in samples:
                _warn_of_time(len(designs))
            search = model(poly=self.trend, corr=CORRELATION, print_global=False, n_start=STARTS, seed=self._seed())
            thetas = _trained(search, scaled).optimal_theta
        # Trained again from the thetas alone, as from a file, where the same numbers then give the same digits.
        self.scaled_thetas_ = np.asarray(thetas, dtype=float)
        given = model(poly=self.trend, corr=CORRELATION, print_global=False, hyper_opt="NoOp", theta_bounds=ANY)
        self.model_ = _trained(given, scaled, self.scaled_thetas_)

    def _seed(self) -> int:
        return int(check_random_state(self.random_state).randint(2**31 - 1))

    def _check_trend(self, runs: int, coefficients: int = 0) -> None:
        if self.trend not in TRENDS:
            raise ValueError(f"trend must be one of {', '.join(TRENDS)}, got {briefly(self.trend)}")
        needed = TRENDS[self.trend](self.n_features_in_) + coefficients + 1
        if runs < needed:
            raise ValueError(
                f"a {self.trend} trend in {self.n_features_in_} variable(s) needs at least {needed} different designs, "
                f"got {runs} sample(s)"
            )


def _trained(process: Any, samples: list[tuple[Array, Array]], thetas: Array | None = None) -> Any:
    """Train SMT's process on samples, from the cheapest to the last, with given thetas if it is not to search."""
    for level, (Z, y) in enumerate(samples):
        process.set_training_values(Z, y, name=level if level < len(samples) - 1 else None)
    if thetas is not None:
        checked = process._check_param

        def given() -> None:
            # The option theta0 takes thetas of each level only where there are as many levels as variables.
            checked()
            process._theta0 = thetas if thetas.ndim == 2 else list(thetas)

        process._check_param = given
    # Responses that the trend meets exactly leave no variance, whose logarithm SMT takes.
    with np.errstate(divide="ignore"):
        process.train()
    if thetas is not None:
        del process._check_param
    return process


def _warn_of_time(runs: int) -> None:
    if runs > MANY:
        warnings.warn(
            f"Kriging of {runs} runs takes some {MINUTES * (runs / MANY) ** 3:.1g} minutes, for the third power of "
            f"their number; {MANY} are plenty in a few variables",
            UserWarning,
            stacklevel=4,
        )


class Kriging(_GaussianProcess):
    """Universal Kriging: a trend plus a Gaussian process that interpolates.

    ``S(x) = sum b_j p_j(x) + Z(x)`` with the correlation ``exp(-sum theta_i (x_i - x'_i)^2)`` of Z, one theta a
    variable by maximum likelihood (*Feasibility study of surrogate model for the application of vehicle suspension
    system*, 2021, Eqs 22 to 28; its Eq 26 should sum over the design variables), by SMT's KRG.

    Parameters
    ----------
    trend : {"constant", "linear", "quadratic"}
    random_state : int, RandomState or None
        Of the likelihood's starts.

    Attributes
    ----------
    theta_ : ndarray, (k,)
        In one over each variable's unit squared.
    model_ : smt.surrogate_models.KRG
        On the columns scaled to [-1, 1].

    Raises
    ------
    ValueError
        From `fit`: an unknown trend, one design with two responses (its rows are named), a constant column, or too few
        runs for the trend.
    ModuleNotFoundError
        From `fit`: SMT is not installed; the message says how to get it.

    Warns
    -----
    UserWarning
        From `fit`, above 500 runs, with the time that it may take.

    Notes
    -----
    The standard deviation takes the thetas for known and the correlation for right. On smooth responses such as RMS
    values it is too small: intervals meant for 95 % of runs left out held 50 to 80 % of them.

    The search for the thetas takes some 0.4 s for 60 runs in two variables, 4 s for 200 and 15 s for 400.

    Examples
    --------
    >>> import numpy as np
    >>> from susp_ss import Kriging
    >>> X = np.linspace(0.0, 6.0, 12)[:, None]
    >>> mean, std = Kriging().fit(X, np.sin(X[:, 0])).predict([[2.5], [9.0]], return_std=True)
    >>> bool(abs(mean[0] - np.sin(2.5)) < 1e-3), bool(std[1] > 10 * std[0])
    (True, True)
    """

    def __init__(self, trend: str = "constant", random_state: Any = 0):
        self.trend = trend
        self.random_state = random_state

    def fit(self, X: ArrayLike, y: ArrayLike) -> Kriging:
        """Fit trend and process to the responses y (n,) at the designs X (n, k)."""
        designs, _ = self._distinct(X, y)
        self._check_trend(len(designs))
        self.box_ = self._box(designs)
        self._process()
        return self

    def _process(self, thetas: Any = None) -> None:
        with needing("kriging", "Kriging"):
            from smt.surrogate_models import KRG

        self._krige(KRG, self.runs_, thetas=thetas)
        self.theta_ = self.scaled_thetas_ * (self.box_.scale_ / self.model_.X_scale) ** 2

    def _numbers(self) -> dict[str, Any]:
        designs, responses = self.runs_
        return {"scaled_thetas": self.scaled_thetas_, "designs": designs, "responses": responses}

    def _restore(self, found: dict[str, Any]) -> None:
        designs, _ = self._found_runs(found)
        self._check_trend(len(designs))
        self._process(found["scaled_thetas"])


class CoKriging(_GaussianProcess):
    """Co-Kriging: Kriging of a few expensive runs, led by many runs of the cheap model.

    ``S(x) = rho f(x) + D(x)`` with f the Kriging of the cheap model's responses and D, a trend plus a Gaussian process,
    that of the expensive model's deviations (M. Kennedy and A. O'Hagan, *Biometrika* 87, 2000; L. Le Gratiet's
    recursive form), by SMT's MFK. The cheap model runs at the designs of the fit and on a Latin hypercube over their
    box.

    Parameters
    ----------
    low_fidelity : callable
        ``f(X)``, designs (n, k) as an array of floats to responses (n,), such as `susp_ss.Response`.
    trend : {"constant", "linear", "quadratic"}
        Of f and of D.
    samples : int
        Runs of the cheap model on the Latin hypercube.
    random_state : int, RandomState or None
        Of the hypercube and of the likelihood's starts.

    Attributes
    ----------
    rho_ : float
        What scales the cheap response.
    cheap_runs_ : (ndarray (n, k), ndarray (n,))
        Runs of the cheap model.
    model_ : smt.applications.MFK
        On the columns scaled to [-1, 1].

    Raises
    ------
    TypeError, ValueError
        From `fit`: a low-fidelity model that is not callable or returns no finite (n,), bad samples, and as `Kriging`.
    ModuleNotFoundError
        As `Kriging`.

    Warns
    -----
    UserWarning
        From `fit`, above 500 runs of either model, with the time that it may take.

    Notes
    -----
    A fit takes about three times as long as that of `Kriging`: 1.5 s for 60 runs.

    Examples
    --------
    >>> import numpy as np
    >>> from susp_ss import CoKriging
    >>> X = np.linspace(0.0, 6.0, 5)[:, None]
    >>> surrogate = CoKriging(lambda X: np.sin(2.0 * X[:, 0]), samples=30)
    >>> surrogate = surrogate.fit(X, 3.0 * np.sin(2.0 * X[:, 0]) + 0.1 * X[:, 0])
    >>> bool(abs(surrogate.predict([[2.5]])[0] - 3.0 * np.sin(5.0) - 0.25) < 0.01)
    True
    """

    cheap_runs_: tuple[Array, Array]

    def __init__(
        self,
        low_fidelity: Callable[[Any], Any],
        trend: str = "constant",
        samples: int = 60,
        random_state: Any = 0,
    ):
        self.low_fidelity = low_fidelity
        self.trend = trend
        self.samples = samples
        self.random_state = random_state

    def fit(self, X: ArrayLike, y: ArrayLike) -> CoKriging:
        """Fit both processes to the responses y (n,) at the designs X (n, k)."""
        designs, _ = self._distinct(X, y)
        check_callable(self.low_fidelity)
        samples = whole_number("samples", self.samples, 1)
        self._check_trend(len(designs), coefficients=1)
        self.box_ = self._box(designs)
        hypercube = qmc.LatinHypercube(self.n_features_in_, rng=self._seed()).random(samples)
        cheap = np.concatenate([designs, self.lowest_ + hypercube * (self.highest_ - self.lowest_)])
        self.cheap_runs_ = cheap, evaluated(self.low_fidelity, cheap)
        self._process()
        return self

    def _process(self, thetas: Any = None) -> None:
        with needing("kriging", "Kriging"):
            from smt.applications import MFK

        self._krige(MFK, self.cheap_runs_, self.runs_, thetas=thetas)
        self.rho_ = float(self.model_.optimal_par[-1]["beta"][0, 0])

    def _numbers(self) -> dict[str, Any]:
        return {
            "scaled_thetas": self.scaled_thetas_,
            "cheap_designs": self.cheap_runs_[0],
            "cheap_responses": self.cheap_runs_[1],
            "designs": self.runs_[0],
            "responses": self.runs_[1],
        }

    def _restore(self, found: dict[str, Any]) -> None:
        self._check_trend(len(self._found_runs(found)[0]), coefficients=1)
        designs, responses = (np.asarray(found[f"cheap_{name}"], dtype=float) for name in ("designs", "responses"))
        self.cheap_runs_ = designs, responses
        self._process(found["scaled_thetas"])
