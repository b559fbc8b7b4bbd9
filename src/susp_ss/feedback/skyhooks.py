"""Laws of a few gains: dampers to the sky and to the ground, with the lag of their actuators."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..quantities import briefly
from .plant import Plant, plant
from .result import Feedback

Array = NDArray[np.float64]

GAINS = {
    "skyhook": {"gain": "sky"},
    "groundhook": {"gain": "ground"},
    "hybrid": {"sky": "sky", "ground": "ground"},
}
"""What the gains of each law are dampers to."""


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
    return hooked("skyhook", vehicle, road, {"gain": gain, "lag": lag}, weighting)


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
    return hooked("groundhook", vehicle, road, {"gain": gain, "lag": lag}, weighting)


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
    return hooked("hybrid", vehicle, road, {"sky": sky, "ground": ground, "lag": lag}, weighting)


def hooked(kind: str, vehicle: Any, road: Any, numbers: dict[str, Any], weighting: Any) -> Feedback:
    """A law by its kind and numbers.

    Raises
    ------
    TypeError, ValueError
        As `hybrid`.
    """
    for name, value in numbers.items():
        if isinstance(value, bool) or not isinstance(value, (int, float, np.integer, np.floating)):
            raise TypeError(f"{kind}({name}=...) must be a number >= 0, got {briefly(value)}")
        if not (np.isfinite(value) and value >= 0.0):
            raise ValueError(f"{kind}({name}=...) must be finite and >= 0, got {briefly(value)}")
    known, lag = plant(vehicle, road, None, kind), float(numbers["lag"])
    towards = directions(known)
    K = sum((numbers[name] * towards[to] for name, to in GAINS[kind].items()), known.no_force)
    made = {"numbers": {name: float(value) for name, value in numbers.items()}, "weighting": weighting}
    if lag > 0.0:
        return known.result(kind, known.lagging(K, lag), (vehicle, weighting), **made)
    return known.result(kind, known.closed(K), (vehicle, weighting), gain=known.gain(K), **made)


def directions(known: Plant) -> dict[str, Array]:
    """The gains ``u = -K x`` of unit dampers to the sky and to the ground, (corners, n) each."""
    wheels, body = (np.pad(each, [(0, 0), (0, len(known.sizes) - each.shape[1])]) for each in _velocities(known))
    return {"sky": body * known.sizes, "ground": -wheels * known.sizes}


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
