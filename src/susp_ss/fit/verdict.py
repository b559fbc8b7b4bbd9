"""What to say first of a fit: whether anything predicts at all, and what may be wrong with the runs or the question.

A useless surrogate has a rank like any other. So the one taken is set beside the mean of the runs, runs that the others
contradict are named, and two common slips are tried: responses in another unit, and a cheap model that stands at
another place or on other tracks than the expensive one.
"""

from __future__ import annotations

import warnings
from collections.abc import Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass, replace
from typing import Any, NamedTuple

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from ..quantities import CORNERS, metric_and_place, quantity_of, units_of
from ..roads.road import TRACKS
from ..surrogates import bootstrap
from ..surrogates.low_fidelity import evaluated
from ..surrogates.validation import Comparison, Validation, cross_validate
from ..units import factor_of
from .low_fidelity import LowFidelity, LowFidelityResponse

Array = NDArray[np.float64]

# An error that is so many times what the surrogate errs by at the other runs, once it is fitted to them alone. Of 107
# clean tables of a linear car and 117 of a nonlinear one, of 8 to 60 runs, one had one.
SUSPECT = 10.0

# Of a response, what is no error.
ROUNDING = 1e-9

# Of the runs, how many may be suspects: more are no exceptions.
EXCEPTIONS = 0.1

# A cheap model of the same quantity is nearer than this, whatever its place, unless the unit is another.
NEAR = 3.0

# The error elsewhere that makes one ask, as a share of the error here.
MUCH_BETTER = 0.5


class Suspect(NamedTuple):
    """A run, 0 to n - 1, with what the surrogate predicts from the others, and its error over their usual one."""

    run: int
    predicted: float
    times: float


class OtherUnit(NamedTuple):
    """Responses that are so many times the cheap model's, and the unit that explains it."""

    ratio: float
    unit: str


class Elsewhere(NamedTuple):
    """A setting of the cheap model, ``place`` or ``tracks``, with which its error when tuned falls to a share."""

    setting: str
    value: str
    share: float


@dataclass(frozen=True, eq=False)
class Verdict:
    """What to say first.

    Attributes
    ----------
    gain, low, high : float
        RMSE of the mean of the other runs over that of the surrogate taken, both at runs left out, and 95 % bounds; NaN
        where the bootstrap has none.
    suspects : tuple of Suspect
        Runs that the others contradict.
    unit : OtherUnit or None
    elsewhere : Elsewhere or None
    """

    gain: float
    low: float
    high: float
    suspects: tuple[Suspect, ...]
    unit: OtherUnit | None
    elsewhere: Elsewhere | None

    @property
    def predicts(self) -> bool:
        """Whether the surrogate taken is better than the mean of the runs, as far as these runs can tell."""
        return (self.low if np.isfinite(self.low) else self.gain) > 1.0


def verdict(
    comparison: Comparison,
    chosen: str,
    surrogates: Mapping[str, Any],
    X: pd.DataFrame,
    y: Array,
    own: Array | None,
    low_fidelity: LowFidelity,
    output: str,
    stated: str,
) -> Verdict:
    """Judge the surrogate taken, the runs, and how the cheap model was asked.

    Parameters
    ----------
    comparison : Comparison
    chosen : str
        The surrogate taken.
    surrogates : mapping of str to surrogate
        Those compared, unfitted.
    X : DataFrame, (n, k)
    y : ndarray, (n,)
    own : ndarray, (n,), or None
        What the cheap model has at the designs, if it has the output.
    low_fidelity : LowFidelity
    output : str
    stated : str
        The unit that its numbers were taken to be in.
    """
    errors = of_mean(y), comparison.validations[chosen].residuals
    low, high = map(float, bootstrap.bounds(bootstrap.ratio, *errors, confidence=0.95))
    return Verdict(
        float(bootstrap.ratio(*errors, axis=-1)),
        low,
        high,
        tuple(suspects(comparison, surrogates, X, y)),
        None if own is None else _other_unit(own, y, output, stated),
        None if own is None else _elsewhere(own, X, y, low_fidelity, output),
    )


def of_mean(y: Array) -> Array:
    """What the mean of the others misses each response by: prediction minus response."""
    return (y.mean() - y) * len(y) / (len(y) - 1.0)


def suspects(comparison: Comparison, surrogates: Mapping[str, Any], X: pd.DataFrame, y: Array) -> Iterator[Suspect]:
    """Runs far from what the others predict, the farthest first.

    The judge is the surrogate of least median error, which a few bad runs spoil least. What it misses a run by once it
    is fitted to the others alone is compared with what it misses those by.
    """
    runs = np.arange(len(y))
    judge = min(comparison.validations, key=lambda name: np.median(np.abs(comparison.validations[name].residuals)))
    found = comparison.validations[judge]
    for _ in range(max(1, int(EXCEPTIONS * len(y)))):
        worst = int(np.argmax(_standing_out(found)))
        error, std = found.residuals[worst], 1.0 if found.std is None else found.std[worst]
        rest = np.delete(runs, worst)
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore", UserWarning)
                without = cross_validate(surrogates[judge], X.iloc[rest], y[rest])
        except ValueError:
            return
        usual = np.sqrt(np.mean(_standing_out(without) ** 2))
        times = abs(error) / std / usual if usual > 0.0 else np.inf
        if not times > SUSPECT or abs(error) <= ROUNDING * np.abs(y).max():
            return
        yield Suspect(int(runs[worst]), float(found.predicted[worst]), float(times))
        runs, found = rest, without


def _standing_out(found: Validation) -> Array:
    """Errors, over the surrogate's own deviation where it states one."""
    return np.abs(found.residuals) / (1.0 if found.std is None else np.maximum(found.std, np.finfo(float).tiny))


def _other_unit(own: Array, y: Array, output: str, stated: str) -> OtherUnit | None:
    """The unit in which the runs would be near the cheap model, where they are not."""
    quantity, ratio = quantity_of(output), float(np.median(y / own))
    if quantity is None or 1.0 / NEAR < ratio < NEAR or not ratio > 0.0:
        return None
    taken = factor_of(stated, quantity) or 1.0
    explained = {unit: abs(np.log(ratio * factor / taken)) for unit, factor in units_of(quantity.unit).items()}
    unit = min(explained, key=lambda name: explained[name])
    return OtherUnit(ratio, unit) if explained[unit] < np.log(NEAR) else None


def _elsewhere(own: Array, X: pd.DataFrame, y: Array, low_fidelity: LowFidelity, output: str) -> Elsewhere | None:
    """Another place or other tracks with which the cheap model, scaled and shifted, is much nearer to the runs."""
    here = _line_errors(own, y)
    best = None
    for setting, value, other in _alternatives(low_fidelity, output, X):
        there = _line_errors(evaluated(other, X.to_numpy()), y)
        share = float(bootstrap.ratio(there, here, axis=-1))
        if share < (best.share if best else MUCH_BETTER):
            low, _ = bootstrap.bounds(bootstrap.ratio, here, there, confidence=0.95)
            best = Elsewhere(setting, value, share) if low > 1.0 else best
    return best


def _alternatives(
    low_fidelity: LowFidelity, output: str, X: pd.DataFrame
) -> Iterator[tuple[str, str, LowFidelityResponse]]:
    """The cheap model at every other place and on other tracks."""
    asked: list[tuple[str, str, LowFidelity]] = [
        ("tracks", tracks, replace(low_fidelity, road=replace(low_fidelity.road, tracks=tracks))) for tracks in TRACKS
    ]
    if metric_and_place(output)[1] is None:
        asked += [("place", place, replace(low_fidelity, place=place)) for place in (*CORNERS, "cg")]
    for setting, value, other in asked:
        with suppress(ValueError):  # Not every metric is measured at every place.
            response = other.response(output, list(map(str, X)))
            if response is not None:
                yield setting, value, response


def _line_errors(f: Array, y: Array) -> Array:
    """Errors of a straight line in f at runs left out: those of the fit to all, over one minus their leverage."""
    A = np.stack([np.ones_like(f), (f - f.mean()) / np.maximum(np.abs(f).max(), np.finfo(float).tiny)], axis=1)
    Q = np.linalg.svd(A, full_matrices=False)[0]
    return (Q @ (Q.T @ y) - y) / np.maximum(1.0 - np.sum(Q**2, axis=1), ROUNDING)
