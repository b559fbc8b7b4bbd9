"""The best numbers of a law: by exact slopes where these are dampers, else by differences of exact metrics."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..quantities import briefly
from .plant import Plant, plant
from .preview import Law, System, variances
from .result import Feedback
from .skyhooks import GAINS, directions, hooked
from .slopes import by_gain

Array = NDArray[np.float64]

# By how much, relatively, a tuned law may exceed its limits.
MET = 1e-4

# Least of a number, as a share of its start, and what a law costs that is none, relative to the start.
LEAST, FAR = 1e-3, 1e3


def tuned(
    law: Feedback | Callable[..., Feedback],
    start: Mapping[str, float],
    minimise: str = "bacc",
    limits: Mapping[str, float] | None = None,
) -> Feedback:
    """Tune the numbers of a law: the least of one metric under limits of others, within the law's structure.

    A local optimum by sequential quadratic programming on exact metrics, from where it starts. Of a law of dampers, to
    the sky, to the ground and the car's own, the slopes are exact as well (``feedback.slopes``): each is a gain, and so
    is a change of the lag.

    Parameters
    ----------
    law : Feedback or callable
        A `skyhook`, `groundhook` or `hybrid` whose numbers (``gain``, ``sky``, ``ground``, ``lag``) and whose vehicle's
        ``cs`` (``cs_front``, ``cs_rl``) are tuned. Or what makes a `Feedback` of numbers by their names, for parameters
        of any kind: ``lambda ks, sky: ss.skyhook(ss.QuarterCar(ks=ks), road, sky)``; its slopes are differences.
    start : mapping of str to float
        Where to start, each > 0; the numbers stay above a thousandth of that.
    minimise : str
        A metric: ``"bacc@cg"``, or ``"bacc"`` where it has one place.
    limits : mapping of str to float
        Of metrics, not to be exceeded; without a place at every place.

    Returns
    -------
    Feedback
        Of the best numbers found, which its ``kind`` names.

    Raises
    ------
    TypeError, ValueError
        No such metric or number, or limits that the search could not meet.

    Examples
    --------
    The best damper to the sky, with the suspension travel of the passive car:

    >>> import susp_ss as ss
    >>> car, road = ss.QuarterCar(), ss.Road()
    >>> travel = {"sws": float(ss.ride_metrics(car, road).sws)}
    >>> law = ss.skyhook(ss.QuarterCar(cs=900.0), road, gain=1500.0)
    >>> ss.tuned(law, {"gain": 1500.0}, "bacc", travel)
    skyhook, gain 2695 on QuarterCar: bacc 0.80, sws 0.77, dtl 1.00 of passive

    And the car's own damper with it:

    >>> ss.tuned(law, {"gain": 1500.0, "cs": 900.0}, "bacc", travel | {"dtl": 420.0})
    skyhook, gain ..., cs ... on QuarterCar: bacc ..., sws ..., dtl ... of passive
    """
    from scipy.optimize import minimize as search

    if not isinstance(start, Mapping) or not start or not all(_positive(value) for value in start.values()):
        raise TypeError(f'start must be a mapping of numbers > 0 such as {{"gain": 1500.0}}, got {briefly(start)}')
    names, scale = list(start), np.array([float(value) for value in start.values()])
    if not isinstance(law, Feedback) and not callable(law):
        raise TypeError(f"law must be a {', '.join(GAINS)} or make a Feedback of numbers, got {briefly(law)}")
    made = remade(law, names) if isinstance(law, Feedback) else law
    first = made(**start)
    goal = first.values(minimise, "minimise")
    if len(goal) > 1:
        raise ValueError(f"minimise must be a metric at one place, got {minimise!r}; available: {', '.join(goal)}")
    bounds: dict[str, float] = {}
    for name, limit in (limits or {}).items():
        if not _positive(limit):
            raise ValueError(f"limits: {name} must be a number > 0, got {briefly(limit)}")
        bounds |= dict.fromkeys(first.values(name, "limits"), float(limit))
    told, sizes = [*goal, *bounds], np.array([*goal.values(), *bounds.values()])
    exact: Any = Dampers.of(first, names, told) if isinstance(law, Feedback) else None
    seen: dict[bytes, Array] = {}

    def by_metrics(numbers: Mapping[str, float]) -> Array:
        found = made(**numbers)
        return np.array([found.value(name) for name in told])

    values = by_metrics if exact is None else exact.values

    def numbered(x: Array) -> dict[str, float]:
        return dict(zip(names, (x * scale).tolist(), strict=True))

    def relative(x: Array) -> Array:
        """The metric minimised in proportion to its start, and those limited to their limits."""
        key = x.tobytes()
        if key not in seen:
            try:
                seen[key] = values(numbered(x)) / sizes
            except ValueError:
                # Numbers on the way for which the loop is unstable are as bad as can be.
                seen[key] = np.full(len(sizes), FAR)
        return seen[key]

    @lru_cache(maxsize=1)
    def slopes(key: bytes) -> Array:
        x = np.frombuffer(key)
        return np.asarray(exact.slopes(numbered(x), relative(x) * sizes) * scale / sizes[:, None])

    limited: dict[str, Any] = {"type": "ineq", "fun": lambda x: 1.0 - relative(x)[1:]}
    if exact is not None:
        limited["jac"] = lambda x: -slopes(x.tobytes())[1:]
    best = search(
        lambda x: relative(x)[0],
        np.ones(len(names)),
        jac=None if exact is None else lambda x: slopes(x.tobytes())[0],
        method="SLSQP",
        bounds=[(LEAST, None)] * len(names),
        constraints=limited if bounds else (),
        options={"ftol": 1e-10, "maxiter": 50},
    )
    excess = relative(best.x)[1:]
    if excess.max(initial=0.0) > 1.0 + MET:
        name = told[1 + int(np.argmax(excess))]
        raise ValueError(
            f"limits: no numbers found that keep {name} below {bounds[name]:.4g}; start elsewhere, or raise it"
        )
    numbers = numbered(best.x)
    return made(**numbers).renamed(", ".join(f"{name} {value:.4g}" for name, value in numbers.items()))


def remade(law: Feedback, names: Sequence[str]) -> Callable[..., Feedback]:
    """What makes the same law with other numbers, of its own and of its vehicle.

    Raises
    ------
    TypeError, ValueError
        No law of dampers, or other names than its own and those of the vehicle's.
    """
    kind = law.kind.partition(",")[0]
    if kind not in GAINS:
        raise TypeError(f"law must be a {', '.join(GAINS)} or make a Feedback of numbers, got {briefly(law)}")
    vehicle: Any = law.vehicle
    dampers = [name for name, (field, _) in vehicle.settings().items() if field == "cs"]
    for name in names:
        if name not in law.numbers and name not in dampers:
            raise ValueError(
                f"start: a {kind} has no {name!r} to tune, available: {', '.join([*law.numbers, *dampers])}; pass a "
                "function of any numbers that makes a Feedback"
            )

    def made(**numbers: float) -> Feedback:
        own = {name: numbers.get(name, value) for name, value in law.numbers.items()}
        car = {name: value for name, value in numbers.items() if name not in own}
        return hooked(kind, vehicle.replaced(**car) if car else vehicle, law.road, own, law.weighting)

    return made


class Dampers(NamedTuple):
    """A law of dampers on a plant: all its numbers are gains of two sets of forces, those set and those of dampers."""

    known: Plant
    rows: NDArray[np.int_]
    numbers: dict[str, float]
    gains: dict[str, Array]
    dampers: dict[str, Array]

    @classmethod
    def of(cls, law: Feedback, names: Sequence[str], metrics: Sequence[str]) -> Dampers:
        """The law with slopes of some metrics by some of its numbers, about the vehicle that it was made for.

        Raises
        ------
        ValueError
            A metric that is no root mean square of an output, or a road of which no filter is known.
        """
        vehicle: Any = law.vehicle
        known = plant(vehicle, law.road, law.weighting, "tuned")
        rows = [row for name in metrics for row in known.named(name, "tuned").values()]
        towards = directions(known)
        felt = known.layout.outputs.of("sws_rate")
        rates, settings = known.system.C[felt], vehicle.settings()
        if "force" in known.weighting or known.velocity[1][felt].any():
            raise ValueError("tuned: force behind a weighting, or a rigid tyre, needs a function that makes a Feedback")
        dampers, taken = {}, set[str]()
        for name in sorted(
            (name for name in names if name not in law.numbers), key=lambda name: len(settings[name][1])
        ):
            # Where two names set one wheel, the narrower.
            at = np.array([wheel in settings[name][1] and wheel not in taken for wheel in vehicle.wheels])
            dampers[name] = -rates * at[:, None]
            taken |= set(settings[name][1])
        made = {
            name: float(np.ravel(vehicle.at_wheels("cs")[list(vehicle.wheels).index(settings[name][1][0])])[0])
            for name in dampers
        }
        gains = {name: towards[to] for name, to in GAINS[law.kind].items()}
        return cls(known, known.rows[rows], {**law.numbers, **made}, gains, dampers)

    def _loop(self, numbers: Mapping[str, float]) -> tuple[System, list[Any], Array, dict[str, Array]]:
        """System and noises with both sets of forces, their gain, and how that changes with each number."""
        known, (A, B, C, D) = self.known, self.known.system
        now = self.numbers | dict(numbers)
        lag, (n, k) = now["lag"], B.shape
        # What dampers push with is no actuator's force.
        damped = D.copy()
        damped[known.forces] = 0.0
        set_ = sum((now[name] * gain for name, gain in self.gains.items()), known.no_force)
        own = sum(((now[name] - self.numbers[name]) * gain for name, gain in self.dampers.items()), known.no_force)
        nothing, noises = known.no_force, known.noises
        by = {name: np.vstack([gain, nothing]) for name, gain in self.gains.items()}
        by |= {name: np.vstack([nothing, gain]) for name, gain in self.dampers.items()}
        K = np.vstack([set_, own])
        if not lag:
            return System(A, np.hstack([B, B]), C, np.hstack([D, damped])), noises, K, by
        eye, late = np.eye(k), np.zeros((n, k))
        system = System(
            np.block([[A, B], [late.T, -eye / lag]]),
            np.block([[late, B], [eye / lag, 0.0 * eye]]),
            np.hstack([C, D]),
            np.hstack([0.0 * D, damped]),
        )
        noises = [
            noise._replace(
                entries=np.pad(noise.entries, [(0, 0), (0, k)]),
                bent=np.pad(noise.bent, [(0, 0), (0, k)]),
                pushed=np.pad(noise.pushed, [(0, k), (0, 0)]),
            )
            for noise in noises
        ]
        by = {name: np.pad(gain, [(0, 0), (0, k)]) for name, gain in by.items()}
        # A longer lag is as if less of what is still missing were asked for.
        by["lag"] = -np.block([[set_, eye], [nothing, 0.0 * eye]]) / lag
        return system, noises, np.pad(K, [(0, 0), (0, k)]), by

    def values(self, numbers: Mapping[str, float]) -> Array:
        """Root mean squares of the metrics.

        Raises
        ------
        ValueError
            An unstable loop.
        """
        system, noises, K, _ = self._loop(numbers)
        if np.linalg.eigvals(system.A - system.B @ K).real.max() >= 0.0:
            raise ValueError("unstable")
        return np.asarray(np.sqrt(variances(system, noises, Law(K))[self.rows].clip(min=0.0)))

    def slopes(self, numbers: Mapping[str, float], values: Array) -> Array:
        """Derivatives (metrics, numbers) of these values by the numbers, in their order; none of what is at rest."""
        system, noises, K, by = self._loop(numbers)
        slope = np.sum([by_gain(system, noise, K, self.rows) for noise in noises], axis=0)
        along = np.array([[(one * by[name]).sum() for name in numbers] for one in slope])
        return np.divide(along, 2.0 * values[:, None], out=np.zeros_like(along), where=values[:, None] > 0.0)


def _positive(value: Any) -> bool:
    number = isinstance(value, (int, float, np.integer, np.floating)) and not isinstance(value, bool)
    return bool(number and np.isfinite(value) and value > 0.0)
