"""The dual of the active bound: multipliers of limits, for which the best law is known, and what it then makes of them.

The variances that laws can reach form a convex set once any law may be mixed with another by a coin, and quadratic
costs make coins needless: the problem equals its dual. For multipliers of the limits the best law is that of `optimal`,
known in closed form with all that an axle behind knows ahead; its variances less the limits are the slope of the dual.
"""

from __future__ import annotations

from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from .plant import Plant
from .preview import Law, optimal
from .slopes import by_weights

Array = NDArray[np.float64]

# A little weight on the forces keeps the law finite: shares of the variance of a force that moves the body as much as
# the road does. It is lowered until that no longer changes the bound, by this share of the passive value.
LIGHT = (1e-3, 1e-4, 1e-5, 1e-6)
RESOLVED = 1e-5

# Where no weight on forces would be best, the bound falls as the fourth root of it at the slowest: this much from one
# weight to the next, as a share of what is still to come.
SLOWEST = 10.0**0.25 - 1.0

# Multipliers, relative to the passive variance over that of the limit: at the start, and at most.
START, MOST = 0.1, 1e5

# The dual bends about as the inverse of a multiplier, of one below this as of this. Where the search is stuck, what it
# has learnt of the curvature is forgotten, so often at most.
AWAKE, LIFTS = 1e-3, 5

# Least weight of an output, relative to its passive variance, among which the best gain without preview is sought.
FLOOR = 1e-5

# By how much, relatively, a variance may exceed its limit.
MET = 1e-4


class Task(NamedTuple):
    """Outputs of a plant's system: the one minimised and those limited, with limits and the force's size squared."""

    row: int
    size: float
    rows: NDArray[np.int_]
    limits: Array
    force: float
    names: tuple[str, ...]

    def weights(self, outputs: int, forces: Any, multipliers: Array, light: float) -> Array:
        """What the variance of each output costs."""
        weights = np.zeros(outputs)
        weights[forces] = light / self.force
        weights[self.row] += 1.0 / self.size
        np.add.at(weights, self.rows, multipliers / self.limits)
        return weights


class Solution(NamedTuple):
    """A law with the variances of all outputs; for these multipliers and weight on forces it costs least."""

    law: Law
    variances: Array
    multipliers: Array
    light: float

    def excess(self, task: Task) -> Array:
        """By how much each limit is exceeded, relative to it."""
        return self.variances[task.rows] / task.limits - 1.0


def solve(plant: Plant, task: Task, light: float, start: Solution | None = None) -> Solution:
    """Maximise the dual, which is concave, over the multipliers, none of which is negative.

    Their logarithms would hide a limit whose multiplier has become small. Limits that nothing can meet leave an excess.
    """
    from scipy.optimize import minimize

    first = np.full(len(task.rows), START) if start is None else start.multipliers
    last = plant.no_force if start is None else start.law.K

    def at(multipliers: Array) -> Solution:
        nonlocal last
        law = optimal(plant.system, task.weights(len(plant.system.C), plant.forces, multipliers, light), last)
        last = law.K
        return Solution(law, plant.variances(law), multipliers, light)

    def dual(shares: Array, units: Array) -> tuple[float, Array]:
        found = at(units * shares)
        cost = found.law.weights @ found.variances
        return found.multipliers.sum() - cost, -units * found.excess(task)

    if not len(first):
        return at(first)
    for _ in range(LIFTS):
        units = np.sqrt(first.clip(AWAKE))
        best = minimize(
            dual,
            first / units,
            (units,),
            jac=True,
            method="L-BFGS-B",
            bounds=[(0.0, MOST / unit) for unit in units],
            options={"ftol": 1e-15, "gtol": 1e-8},
        )
        found = at(units * best.x)
        if found.excess(task).max() <= MET:
            break
        first = found.multipliers
    # From a start far away it may be led astray.
    return found if start is None or found.excess(task).max() <= MET else solve(plant, task, light)


def best_gain(plant: Plant, task: Task, start: Solution) -> Law | None:
    """The best gain on the states alone, among those that are optimal for some weights of outputs and forces.

    The problem is not convex where the same road comes twice: this descends from the weights of the solution with
    preview. None where it finds no gain that meets the limits.
    """
    from scipy.optimize import minimize

    sizes = plant.variances(Law(plant.no_force))[plant.rows]
    sizes[plant.forces] = task.force
    free = (sizes > 0.0) & ~plant.infinite
    rows, sizes = plant.rows[free], sizes[free]
    costs = task.weights(len(plant.system.C), plant.forces, start.multipliers, LIGHT[-1])
    told, units = np.append(task.row, task.rows), np.append(task.size, task.limits)
    last, seen = start.law, dict[bytes, tuple[Law, Array]]()

    def reached(logarithms: Array) -> Array:
        """The variance minimised, and those limited, in their units."""
        nonlocal last
        key = logarithms.tobytes()
        if key not in seen:
            weights = np.zeros(len(costs))
            weights[rows] = np.exp(logarithms) / sizes
            last = optimal(plant.system, weights, last.K)
            seen[key] = last, plant.variances(Law(last.K))[told] / units
        return seen[key][1]

    @lru_cache(maxsize=1)
    def slopes(key: bytes) -> Array:
        law = seen[key][0]
        by_weight = by_weights(plant.system, plant.noises, law, told)
        return by_weight[:, rows] * law.weights[rows] / units[:, None]

    def slope(logarithms: Array) -> Array:
        reached(logarithms)
        return slopes(logarithms.tobytes())

    minimize(
        lambda x: 0.5 * np.log(reached(x)[0]),
        np.log((costs[rows] * sizes).clip(min=FLOOR)),
        jac=lambda x: 0.5 * slope(x)[0] / reached(x)[0],
        method="SLSQP",
        bounds=[(np.log(FLOOR), -np.log(FLOOR))] * len(rows),
        constraints={"type": "ineq", "fun": lambda x: 1.0 - reached(x)[1:], "jac": lambda x: -slope(x)[1:]},
        options={"maxiter": 100},
    )
    met = [(values[0], law) for law, values in seen.values() if values[1:].max(initial=0.0) <= 1.0 + MET]
    return Law(min(met, key=lambda one: one[0])[1].K) if met else None
