"""What the explorer shows of a state while its sliders move: plain numbers in SI units."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from functools import cached_property
from typing import Any, Self

import numpy as np

from ..metrics.comfort import AXES, in_words
from ..metrics.ride import ride_metrics
from ..metrics.weightings import filter_of
from ..responses.covariance import linearised
from ..responses.covariance.routes import covariance_variances
from ..responses.excitation import spanned
from ..roads.road import Road
from .design import road_of, vehicle_of
from .motion import bump, modes
from .rows import Row, at_places, named, number
from .spectra import FREQUENCIES, bode, spectra
from .state import NOTHING, Given, checked
from .surrogates import predictions

SPEEDS = np.linspace(4.0, 60.0, 29)
"""Over which metrics are shown, in m/s."""

Found = dict[str, Any]


class Scene:
    """A state as everything that is shown of it needs it, and what was wrong with it on the way."""

    def __init__(self, state: Any, given: Given):
        self.state, self.errors = checked(state, given)
        self.given = given

    @cached_property
    def vehicle(self) -> Any:
        return vehicle_of(self.state, self.given)

    @cached_property
    def road(self) -> Road:
        return road_of(self.state, self.given)

    @cached_property
    def straight(self) -> Any:
        """The vehicle, with numbers in place of curves."""
        return linearised(self.vehicle, self.road) if self.vehicle.curved else self.vehicle

    def attempt(self, part: Callable[[Self], Any]) -> Any:
        """What a part finds; None where the package refuses, which is noted."""
        try:
            return part(self)
        except (ValueError, TypeError) as error:
            line = {"parameter": "", "message": str(error)}
            if line not in self.errors:
                self.errors.append(line)
            return None


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
            What each surrogate predicts, between its bounds, beside the exact value; or why not, in ``refused``.
        ``errors``
            ``parameter``, its name in the URL or nothing, and ``message``.

    Examples
    --------
    >>> from susp_ss.explorer.compute import compute
    >>> found = compute({"model": "quarter", "vehicle": {"ks": 18e3, "cs": 1500.0}})
    >>> [round(one["value"], 3) for one in found["metrics"] if one["name"] == "bacc"]
    [0.678]
    """
    scene, found = Scene(state, given), Found()
    for part in PARTS:
        found |= scene.attempt(part) or {}
    return found | {"errors": scene.errors}


def over_speed(scene: Scene) -> Found:
    """Metrics at the road's own speed, and over speed where the vehicle can go so fast."""

    def at(speed: Any) -> list[Row]:
        return at_places(ride_metrics(scene.vehicle, dataclasses.replace(scene.road, speed=speed)))

    swept = scene.attempt(lambda scene: at(np.append(scene.road.speed, SPEEDS)))
    rows = swept or at(scene.road.speed)
    found = {"metrics": [row.described() | {"value": number(row.values[0])} for row in rows]}
    if swept is None:
        return found
    over = [row.described() | {"values": list(map(number, row.values[1:]))} for row in rows]
    return found | {"speeds": {"speed": SPEEDS.tolist(), "metrics": over}}


def comfort(scene: Scene) -> Found:
    """Weighted accelerations and total values at all points."""
    space, flat, road = spanned(scene.straight, scene.road)
    layout = flat.layout()
    weighted = {}
    for weighting in dict.fromkeys(axis.weighting for axis in AXES.values()):
        variances = covariance_variances(flat, space, road.weighted(filter_of(weighting, "")), 1)[0]
        for name, axis in AXES.items():
            if axis.weighting == weighting and name in layout.variables:
                weighted[name] = np.sqrt(variances[layout.outputs.of(name)])
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
    asked = scene.state["bode"]
    f = np.geomspace(*FREQUENCIES)
    return {
        "frequency": f.tolist(),
        "bode": bode(scene.straight, asked, f),
        "psd": spectra(scene.straight, scene.road, asked, f),
    }


def surrogates(scene: Scene) -> Found:
    """Predictions of all surrogates, of those that refuse the vehicle why."""
    vehicle, road = scene.vehicle, scene.road
    found: list[Found] = []
    for name, fitted in scene.given.surrogates.items():
        try:
            found += predictions(name, fitted, vehicle, road)
        except ValueError as error:
            found.append({"surrogate": name, "refused": str(error)})
    return {"surrogates": found}


PARTS: tuple[Callable[[Scene], Found], ...] = (
    over_speed,
    comfort,
    over_frequency,
    lambda scene: {"modes": modes(scene.straight)},
    lambda scene: {"bump": bump(scene.vehicle, **scene.state["bump"])},
    surrogates,
)
"""What is shown, each by itself: where one is refused, the others stand."""
