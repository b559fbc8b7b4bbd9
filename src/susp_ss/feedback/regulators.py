"""Linear-quadratic laws in the metrics' own units: with every state known, and from sensors with noise."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import scipy.linalg
from numpy.typing import NDArray

from ..quantities import briefly
from .plant import Plant, plant
from .preview import Law, optimal
from .result import Feedback

Array = NDArray[np.float64]

# Directions of the forces that cost less than this share of the dearest cost nothing.
FREE = 1e-12


def lqr(vehicle: Any, road: Any, weights: Mapping[str, float], weighting: Any = None) -> Feedback:
    """Linear-quadratic regulator: the gain on all states of least weighted sum of mean squares.

    ``u = gain x`` minimises ``E[sum weights y^2]`` on white road velocity that comes to every wheel by itself, which is
    what the gain does not depend on: ``A^T P + P A - (P B + S) R^-1 (P B + S)^T + Q = 0``, with ``Q = C^T W C``,
    ``S = C^T W D`` for the force in accelerations, and ``R = D^T W D`` (Anderson and Moore, Optimal Control, 1990).

    Parameters
    ----------
    vehicle : Vehicle
        With one number for every parameter.
    road : Road
        On which the metrics are taken, its delays included; the gain is the same on every road.
    weights : mapping of str to float
        By output, of its square in SI units: ``{"bacc@cg": 1.0, "sws": 1e4, "force": 1e-8}``; a name without a place
        holds at every place. At least as many outputs with a force in them as there are actuators must cost
        something: accelerations, or ``force`` itself.
    weighting : optional
        As in `ride_metrics`: outputs cost behind their filters, whose states the gain then takes as well.

    Returns
    -------
    Feedback
        With ``gain`` and ``closed``.

    Raises
    ------
    TypeError, ValueError
        No such output, a negative weight, or forces that cost nothing.

    Examples
    --------
    >>> import susp_ss as ss
    >>> car, road = ss.QuarterCar(), ss.Road()
    >>> regulator = ss.lqr(car, road, {"bacc": 1.0, "sws": 1e4, "dtl": 1e-6})
    >>> regulator.gain.sel(force="u").round(0).values.tolist()
    [5744.0, -13197.0, -528.0, -2886.0]
    """
    known = plant(vehicle, road, weighting, "lqr")
    law = _regulator(known, weights)
    closed = known.closed(law.K, named=not known.weighting)
    return known.result("lqr", closed, (vehicle, weighting), gain=known.gain(law.K))


def lqg(
    vehicle: Any, road: Any, weights: Mapping[str, float], sensors: Mapping[str, float], weighting: Any = None
) -> Feedback:
    """Linear-quadratic regulator on a Kalman filter's estimate of the states from noisy sensors.

    ``x^' = A x^ + B u + L (m - C_m x^ - D_m u)``, ``u = -K x^`` with `lqr`'s gain and the filter's ``L = (X C_m^T + N)
    V^-1``, whose road is white noise under every wheel by itself, of the road's spectrum at 1 Hz.

    Parameters
    ----------
    vehicle, road, weights, weighting
        As in `lqr`; sensors see outputs before their filters.
    sensors : mapping of str to float
        By output, ``{"bacc@fr": 0.05, "sws": 0.001}``: the root two-sided spectral density of its noise, in its SI unit
        per root Hz, > 0; without a place at every place.

    Returns
    -------
    Feedback
        With ``controller``, from measured outputs to forces, and ``closed``, in which the sensors are free of noise.

    Raises
    ------
    TypeError, ValueError
        As `lqr`; no sensor, or one without noise.

    Examples
    --------
    >>> import susp_ss as ss
    >>> car, road = ss.QuarterCar(), ss.Road()
    >>> weights = {"bacc": 1.0, "sws": 1e4, "dtl": 1e-6}
    >>> seen = ss.lqg(car, road, weights, {"bacc": 0.01, "sws": 1e-4})
    >>> seen.controller.input_labels, seen.controller.output_labels
    (['bacc', 'sws'], ['u'])
    >>> bool(seen.metrics.bacc < seen.passive.bacc)
    True
    """
    import control

    known = plant(vehicle, road, weighting, "lqg")
    law = _regulator(known, weights)
    noise = _positive(known, sensors, "sensors")
    if not noise:
        raise ValueError("sensors must name at least one output, got none")
    rows, V = list(noise), np.diag(np.square([*noise.values()]))
    A, B, C, D = known.system
    W, F = known.velocity[0] * np.sqrt(_density(road)), known.velocity[1][rows] * np.sqrt(_density(road))
    V = V + F @ F.T
    X = scipy.linalg.solve_continuous_are(A.T, C[rows].T, W @ W.T, V, s=W @ F.T)
    L = np.linalg.solve(V, C[rows] @ X + F @ W.T).T
    names = [known.layout.outputs.names[row] for row in rows]
    inner = A - B @ law.K - L @ (C[rows] - D[rows] @ law.K)
    forces = [f"u_{name}" if name else "u" for name in known.layout.corners]
    size = known.sizes
    controller = control.ss(
        inner * size[:, None] / size, L * size[:, None], -law.K / size, np.zeros((len(forces), len(rows))),
        inputs=names, outputs=forces, states=[f"{name}_estimated" for name in known.states], name="lqg",
    )  # fmt: skip
    closed = known.estimated(law.K, L, rows)
    return known.result("lqg", closed, (vehicle, weighting), gain=known.gain(law.K), controller=controller)


def _regulator(known: Plant, weights: Any) -> Law:
    costs = np.zeros(len(known.system.C))
    for row, weight in _positive(known, weights, "weights").items():
        costs[known.rows[row]] = weight
    R = known.system.D.T * costs @ known.system.D
    least, dearest = np.linalg.eigvalsh(R)[[0, -1]]
    if not least > FREE * dearest:
        raise ValueError(
            f"weights must make every one of the {len(R)} forces cost something; weigh force, or more accelerations"
        )
    return optimal(known.system, costs)


def _positive(known: Plant, given: Any, what: str) -> dict[int, float]:
    """Numbers by output as by row of the output table, those of a place before those of all places.

    Raises
    ------
    TypeError, ValueError
        No such output, or no number > 0.
    """
    if not isinstance(given, Mapping):
        raise TypeError(f'{what} must be a mapping such as {{"bacc": 1.0}}, got {briefly(given)}')
    found: dict[int, float] = {}
    for name in sorted(given, key=lambda name: "@" in str(name)):
        value = given[name]
        number = isinstance(value, (int, float, np.integer, np.floating)) and not isinstance(value, bool)
        rows = known.named(name, what).values()
        if not number:
            raise TypeError(f"{what}: {name} must be a number > 0, got {briefly(value)}")
        if not (np.isfinite(value) and value > 0.0):
            raise ValueError(f"{what}: {name} must be finite and > 0, got {briefly(value)}")
        found |= dict.fromkeys(rows, float(value))
    return found


def _density(road: Any) -> float:
    """Two-sided density of the road's velocity under a wheel at 1 Hz, in m^2/s: of a white one, its intensity."""
    n = 1.0 / road.speed
    return float(2.0 * np.pi**2 * n**2 * road.psd(n) * road.speed)
