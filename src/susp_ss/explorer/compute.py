"""What the explorer shows of a state while its sliders move: plain numbers in SI units."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from typing import Any

import numpy as np

from ..fit.surrogate_file import SuspensionSurrogate
from ..metrics.comfort import AXES, in_words
from ..responses.frequency import densities, on_heights
from .motion import bump, modes
from .rows import at_places, named, number, numbers
from .scene import FELT, SPEEDS, Found, Scene, share
from .spectra import GRID, bode, spectra
from .state import NOTHING, Given
from .surrogates import predictions


def compute(state: Any, given: Given = NOTHING) -> Found:
    """Everything that the page shows at once.

    Parameters
    ----------
    state : dict
        As the page has it; what is wrong in it stays as it is by default, and is said in ``errors``.
    given : Given
        What the explorer was started with.

    Returns
    -------
    dict
        Plain JSON. An infinite value is None. What cannot be computed is left out, and ``errors`` says why.

        ``metrics``, ``comfort``
            Every metric at every place, and ISO 2631's total value wherever there is a vertical acceleration.
        ``frequency``, ``bode``, ``psd``
            Of the outputs that the state names: the response to the height of the road under the output's own wheel,
            under the first wheel where it has none, and the spectrum on the road, as it is and weighted.
        ``modes``, ``bump``
            Natural motions, and a drive over a bump, of body, wheels and seats.
        ``speeds``
            Every metric over speed.
        ``surrogates``
            What each surrogate predicts, between its bounds, beside the exact value.
        ``errors``
            ``parameter``, its name in the URL or nothing, and ``message``.

    Examples
    --------
    >>> from susp_ss.explorer.compute import compute
    >>> found = compute({"model": "quarter", "vehicle": {"ks": 18e3, "cs": 1500.0}})
    >>> [round(one["value"], 3) for one in found["metrics"] if one["name"] == "bacc"]
    [0.678]
    """
    return compute_all([state], given)[0]


def compute_all(states: Sequence[Any], given: Given = NOTHING) -> list[Found]:
    """The same of several states, which share what they can."""
    scenes = [Scene(state, given) for state in states]
    share(scenes)
    return [_shown(scene) for scene in scenes]


def _shown(scene: Scene) -> Found:
    found = Found()
    for part in PARTS:
        found |= scene.attempt(part) or {}
    return found | {"errors": scene.errors}


def over_speed(scene: Scene) -> Found:
    """Metrics at the road's own speed, and over speed where the vehicle can go so fast."""
    rows = at_places(scene.vehicle.layout(), scene.ride.moments)
    found = {"metrics": [row.described() | {"value": number(row.values[0])} for row in rows]}
    if len(scene.ride.moments.variances) == 1:
        return found
    over = [row.described() | {"values": numbers(row.values[1:])} for row in rows]
    return found | {"speeds": {"speed": SPEEDS.tolist(), "metrics": over}}


def comfort(scene: Scene) -> Found:
    """Weighted accelerations and total values at all points."""
    layout, variances = scene.vehicle.layout(), dict(zip(FELT, scene.ride.felt, strict=True))
    weighted = {
        name: np.sqrt(variances[axis.weighting][layout.outputs.of(name)])
        for name, axis in AXES.items()
        if name in layout.variables
    }
    if "bacc" not in weighted:
        return {"comfort": []}
    total = np.sqrt(sum((AXES[name].k * value) ** 2 for name, value in weighted.items()))
    places = layout.outputs.places("bacc")
    words = {"wz": "bacc", "wroll": "roll_acc", "wpitch": "pitch_acc"}
    values = {word: np.broadcast_to(weighted[name], total.shape) for word, name in words.items() if name in weighted}
    return {
        "comfort": [
            {"point": place, "label": named(place)}
            | {word: number(some[i]) for word, some in values.items()}
            | {"total": number(total[i]), "words": in_words(total[i])}
            for i, place in enumerate(places)
        ]
    }


def over_frequency(scene: Scene) -> Found:
    """Frequency responses and spectra of the outputs that the state names."""
    asked, layout, omega = scene.state["bode"], scene.straight.layout(), 2.0 * np.pi * GRID
    relative = scene.model.relative_transfer(omega)
    H = on_heights(scene.model, omega, relative)
    S = densities(scene.straight, scene.model, scene.road, GRID, relative)
    return {
        "frequency": GRID.tolist(),
        "bode": bode(layout, H.reshape(H.shape[-3:]), asked),
        "psd": spectra(layout, S.reshape(S.shape[-2:]), asked),
    }


def over_bump(scene: Scene) -> Found:
    """A drive over the bump, whose speed is its own: a car whose motions depend on that is another there."""
    asked = scene.state["bump"]
    car = scene.vehicle.moving(asked["speed"])
    shared = not scene.vehicle.curved and (car is scene.vehicle or asked["speed"] == scene.road.speed)
    return {"bump": bump(car, scene.model if shared else None, **asked)}


def surrogates(scene: Scene) -> Found:
    """Predictions of all surrogates that the vehicle has one value a input for."""
    found: list[Found] = []
    for name, fitted in scene.given.surrogates.items():
        found += scene.attempt(partial(_of_surrogate, name, fitted)) or []
    return {"surrogates": found}


def _of_surrogate(name: str, fitted: SuspensionSurrogate, scene: Scene) -> list[Found]:
    return predictions(name, fitted, scene.vehicle, scene.road)


PARTS: tuple[Callable[[Scene], Found], ...] = (
    over_speed,
    comfort,
    over_frequency,
    lambda scene: {"modes": modes(scene.straight, scene.model)},
    over_bump,
    surrogates,
)
"""What is shown, each by itself: where one is refused, the others stand."""
