"""Laws of a few gains: dampers to the sky and to the ground, with the lag of their actuators, and their tuning."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..quantities import briefly
from .plant import Plant, plant
from .result import Feedback

Array = NDArray[np.float64]

# By how much, relatively, a tuned law may exceed its limits.
MET = 1e-4

# Least of a number, as a share of its start, and what a law costs that is none, relative to the start.
LEAST, FAR = 1e-3, 1e3


def skyhook(vehicle: Any, road: Any, gain: float, lag: float = 0.0, weighting: Any = None) -> Feedback:
    """Dampers between the body and the sky: ``u = -gain z_s'`` at every corner.

    A `hybrid` without its part to the ground (Karnopp, Crosby and Harwood, J. Eng. for Industry 96 (1974)).

    Parameters
    ----------
    vehicle, road, lag, weighting
        As in `hybrid`.
    gain : float
        In N s/m, >= 0.

    Returns
    -------
    Feedback

    Examples
    --------
    >>> import susp_ss as ss
    >>> law = ss.skyhook(ss.QuarterCar(cs=800.0), ss.Road(), gain=1500.0, lag=0.01)
    >>> bool(law.metrics.bacc < 0.9 * law.passive.bacc)
    True
    """
    return _hooked("skyhook", vehicle, road, {"gain": gain}, lag, weighting)


def groundhook(vehicle: Any, road: Any, gain: float, lag: float = 0.0, weighting: Any = None) -> Feedback:
    """Dampers between the wheels and the ground: ``u = gain z_u'`` pushes a rising wheel down, at every corner.

    Parameters
    ----------
    vehicle, road, lag, weighting
        As in `hybrid`.
    gain : float
        In N s/m, >= 0.

    Returns
    -------
    Feedback

    Examples
    --------
    >>> import susp_ss as ss
    >>> law = ss.groundhook(ss.QuarterCar(cs=800.0), ss.Road(), gain=1000.0)
    >>> bool(law.metrics.dtl < law.passive.dtl)
    True
    """
    return _hooked("groundhook", vehicle, road, {"ground": gain}, lag, weighting)


def hybrid(vehicle: Any, road: Any, sky: float, ground: float, lag: float = 0.0, weighting: Any = None) -> Feedback:
    """Dampers to the sky and to the ground at once: ``u = ground z_u' - sky z_s'`` at every corner.

    With a lag the force follows as ``lag F' + F = u``. Velocities are absolute and known; each force acts on the body
    and back on the wheel.

    Parameters
    ----------
    vehicle : Vehicle
        With one number for every parameter; its own dampers stay.
    road : Road
        On which the metrics are taken.
    sky, ground : float
        In N s/m, >= 0.
    lag : float
        Time constant of the actuators in s, >= 0.
    weighting : optional
        As in `ride_metrics`.

    Returns
    -------
    Feedback
        With ``closed``, and without a lag also ``gain``.

    Raises
    ------
    TypeError, ValueError
        Gains or a lag that are no numbers >= 0, or an unstable loop.

    Examples
    --------
    >>> import susp_ss as ss
    >>> law = ss.hybrid(ss.FullCar(cs=900.0), ss.DEFAULT_ROAD, sky=1500.0, ground=300.0, lag=0.005)
    >>> law.metrics.force.dims
    ('corner',)
    """
    return _hooked("hybrid", vehicle, road, {"sky": sky, "ground": ground}, lag, weighting)


def _hooked(kind: str, vehicle: Any, road: Any, gains: dict[str, Any], lag: Any, weighting: Any) -> Feedback:
    for name, value in {**gains, "lag": lag}.items():
        if isinstance(value, bool) or not isinstance(value, (int, float, np.integer, np.floating)):
            raise TypeError(f"{kind}({name}=...) must be a number >= 0, got {briefly(value)}")
        if not (np.isfinite(value) and value >= 0.0):
            raise ValueError(f"{kind}({name}=...) must be finite and >= 0, got {briefly(value)}")
    known = plant(vehicle, road, None, kind)
    wheels, body = _velocities(known)
    sky, ground = gains.get("sky", gains.get("gain", 0.0)), gains.get("ground", 0.0)
    K = (sky * body - ground * wheels) * known.sizes
    if lag > 0.0:
        return known.result(kind, known.lagging(K, float(lag)), (vehicle, weighting))
    return known.result(kind, known.closed(K), (vehicle, weighting), gain=known.gain(K))


def _velocities(known: Plant) -> tuple[Array, Array]:
    """Absolute velocities of wheels and of the body above them per state, (corners, n) each."""
    model = known.model
    if not model.second_order:
        raise TypeError(f"a skyhook needs a vehicle of masses and links, such as FullCar(), got {known.vehicle!r}")
    links, corners = model.R.reshape(model.R.shape[-2:]), len(known.layout.corners)
    wheels, stretch = -links[model.tyres], links[model.suspensions]
    wheels = np.where((model.tyres == model.suspensions)[:, None], 0.0, wheels)
    at_rest = np.zeros((corners, links.shape[1]))
    return np.hstack([at_rest, wheels]), np.hstack([at_rest, wheels - stretch])


def tuned(
    law: Callable[..., Feedback],
    start: Mapping[str, float],
    minimise: str = "bacc",
    limits: Mapping[str, float] | None = None,
) -> Feedback:
    """Tune the numbers of a law: the least of one metric under limits of others, within the law's structure.

    A local optimum by sequential quadratic programming on exact metrics, from where it starts.

    Parameters
    ----------
    law : callable
        From these numbers, by their names, to a `Feedback`: ``lambda sky, ground: ss.hybrid(car, road, sky, ground)``.
        It may set parameters of the vehicle as well.
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
        No such metric, or limits that the search could not meet.

    Examples
    --------
    The best damper to the sky, with the suspension travel of the passive car:

    >>> import susp_ss as ss
    >>> car, road = ss.QuarterCar(), ss.Road()
    >>> travel = {"sws": float(ss.ride_metrics(car, road).sws)}
    >>> best = ss.tuned(lambda gain: ss.skyhook(ss.QuarterCar(cs=900.0), road, gain), {"gain": 1500.0}, "bacc", travel)
    >>> best
    skyhook, gain 2695 on QuarterCar: bacc 0.80, sws 0.77, dtl 1.00 of passive
    """
    from scipy.optimize import minimize as search

    if not isinstance(start, Mapping) or not start or not all(_positive(value) for value in start.values()):
        raise TypeError(f'start must be a mapping of numbers > 0 such as {{"gain": 1500.0}}, got {briefly(start)}')
    names, scale = list(start), np.array([float(value) for value in start.values()])
    first = law(**start)
    goal = first.values(minimise, "minimise")
    if len(goal) > 1:
        raise ValueError(f"minimise must be a metric at one place, got {minimise!r}; available: {', '.join(goal)}")
    bounds: dict[str, float] = {}
    for name, limit in (limits or {}).items():
        if not _positive(limit):
            raise ValueError(f"limits: {name} must be a number > 0, got {briefly(limit)}")
        bounds |= dict.fromkeys(first.values(name, "limits"), float(limit))
    (target,) = goal
    seen: dict[bytes, Feedback | None] = {}

    def evaluated(x: Array) -> Feedback | None:
        key = x.tobytes()
        if key not in seen:
            try:
                seen[key] = law(**dict(zip(names, (x * scale).tolist(), strict=True)))
            except ValueError:
                # Numbers on the way for which the loop is unstable are as bad as can be.
                seen[key] = None
        return seen[key]

    def cost(x: Array) -> float:
        found = evaluated(x)
        return FAR if found is None else found.value(target) / goal[target]

    def slack(x: Array) -> Array:
        found = evaluated(x)
        return np.array([-FAR if found is None else 1.0 - found.value(name) / bounds[name] for name in bounds])

    best = search(
        cost,
        np.ones(len(names)),
        method="SLSQP",
        bounds=[(LEAST, None)] * len(names),
        constraints={"type": "ineq", "fun": slack} if bounds else (),
        options={"ftol": 1e-10, "maxiter": 50},
    )
    found = evaluated(best.x)
    if found is None or (bounds and slack(best.x).min() < -MET):
        nearest = min(bounds, key=lambda name: bounds[name] / (first if found is None else found).value(name))
        raise ValueError(
            f"limits: no numbers found that keep {nearest} below {bounds[nearest]:.4g}; start elsewhere, or raise it"
        )
    said = ", ".join(f"{name} {value:.4g}" for name, value in zip(names, best.x * scale, strict=True))
    return found.renamed(said)


def _positive(value: Any) -> bool:
    number = isinstance(value, (int, float, np.integer, np.floating)) and not isinstance(value, bool)
    return bool(number and np.isfinite(value) and value > 0.0)
