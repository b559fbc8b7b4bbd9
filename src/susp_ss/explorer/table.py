"""Rows of the explorer's page: a number or a choice each, with its range, for any vehicle and road."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any, NamedTuple

from ..quantities import ROAD, Quantity, signal
from ..roads.road import CLASSES, TRACKS, Road
from ..vehicles.contract import RoadVehicle
from ..vehicles.curves import rate_of
from ..vehicles.ride_handling import RideHandlingCar
from ..vehicles.seats import Seat
from ..vehicles.vehicle import Vehicle
from .rows import output_names
from .seat import DRIVER, seated, takes_seat

TINY = 1e-6
"""A share of a step: a relaxation length of 1e-20 m is none, and would only spoil digits."""


class Number(NamedTuple):
    """A number that the page may set.

    ``name`` stands in the URL; in a state the number is ``state[table][key]``. ``default`` lies on the grid of
    ``step`` from ``least`` on. ``logarithmic`` is a slider whose steps are ratios.
    """

    name: str
    table: str
    key: str
    group: str
    label: str
    unit: str
    least: float
    most: float
    step: float
    default: float
    logarithmic: bool = False

    def plain(self, value: float) -> float:
        """A value as a float; what is so little beside a step that it can only mean zero is zero."""
        return 0.0 if abs(value) < TINY * self.step else float(value)


class Choice(NamedTuple):
    """A word, or ``several``, that the page may set among ``options``; of these ``seated`` need the driver's seat."""

    name: str
    table: str
    key: str
    group: str
    label: str
    options: tuple[str, ...]
    default: Any
    several: bool = False
    seated: tuple[str, ...] = ()


GROUPS = {
    "springs": ("ks",),
    "dampers": ("cs",),
    "anti-roll bars": ("arb", "arb_front", "arb_middle", "arb_rear"),
    "masses": ("ms", "mb", "mu", "ixx", "iyy", "izz", "ixz"),
    "tyres": ("kt", "ct"),
    "seat": ("seat_mass", "seat_ks", "seat_cs", "seat_x", "seat_y"),
    "geometry": ("a", "b", "c", "middle", "height", "radius", "roll_centre_front", "roll_centre_rear"),
}
"""Parameters of vehicles by what people look for; all others are of the steering and its tyres."""

DESIGN = ("springs", "dampers")
"""Groups that are the design of the carpet and its front; all else is the conditions that it meets."""

# How far a slider goes from the vehicle's own value, as factors of it.
REACH = {"ks": (0.25, 4.0), "cs": (0.1, 5.0), **dict.fromkeys(("a", "b", "c", "radius"), (0.6, 1.6))}
USUAL_REACH = (0.4, 2.5)

# Where the vehicle's own value is zero or its sign is open: to where at least.
SPAN = {
    "ct": (0.0, 500.0),
    **dict.fromkeys(("arb", "arb_front", "arb_middle", "arb_rear"), (0.0, 60e3)),
    "ixz": (-200.0, 200.0),
    "relaxation": (0.0, 1.0),
    **dict.fromkeys(("roll_centre_front", "roll_centre_rear"), (-0.1, 0.4)),
    **dict.fromkeys(("seat_x", "seat_y"), (-2.0, 2.0)),
}

STEPS = 200
"""Of a slider, about."""

# What a compliant steering needs beside its stiffness; without that, these do nothing.
STEERING = ("steering_damping", "steering_inertia", "trail")

BUMP = (
    Number("bump_height", "bump", "height", "bump", "height of the bump", "m", 0.005, 0.2, 0.005, 0.05),
    Number("bump_length", "bump", "length", "bump", "length of the bump", "m", 0.1, 5.0, 0.05, 0.5),
    Number("bump_speed", "bump", "speed", "bump", "speed over the bump", "m/s", 1.0, 30.0, 0.5, 8.0),
)

REBOUND, COMPRESSION = "rebound rate over damping rate", "compression rate over damping rate"

CURVE = (
    Number("curve_rebound", "curve", "rebound", "dampers", REBOUND, "", 0.1, 3.0, 0.05, 1.3),
    Number("curve_compression", "curve", "compression", "dampers", COMPRESSION, "", 0.1, 3.0, 0.05, 0.7),
    Number("curve_knee", "curve", "knee", "dampers", "knee velocity", "m/s", 0.02, 1.0, 0.01, 0.1),
    Number(
        "curve_beyond", "curve", "beyond", "dampers", "rate beyond the knee over that below", "", 0.05, 2.0, 0.05, 0.5
    ),
)


def rows(car: RoadVehicle, road: Road) -> tuple[Number | Choice, ...]:
    """Everything that the page may set of a vehicle on a road, and of what it shows."""
    curve = CURVE if takes_curve(car) else ()
    return (*_vehicle(car), *curve, *_seat(car), *_road(road), *BUMP, *_shown(car))


def _slider(
    name: str, table: str, key: str, group: str, label: str, quantity: Quantity, own: float, car: Any
) -> Number:
    """A slider about a vehicle's own value."""
    least, most = _reach(quantity, own, car)
    step = _round_step((most - least) / STEPS)
    return Number(name, table, key, group, label, quantity.unit, *_grid(least, most, step, own))


def _reach(quantity: Quantity, own: float, car: Any) -> tuple[float, float]:
    """How far a slider goes: over the whole vehicle, where it is a place along that."""
    field = quantity.name
    if field == "middle":
        return -0.9 * car.a, 0.9 * car.b
    if field not in SPAN:
        low, high = REACH.get(field, USUAL_REACH)
        return (low * own, high * own) if own else (0.0, 100.0 * quantity.known[0])
    first, last = SPAN[field]
    if field == "seat_x":
        first, last = min(first, -getattr(car, "b", 0.0)), max(last, getattr(car, "a", 0.0))
    elif field.startswith("arb"):
        last = max(last, *map(rate_of, car.at_wheels("ks")))
    return min(first, 2.0 * own), max(last, 3.0 * own)


def _grid(least: float, most: float, step: float, own: float) -> tuple[float, float, float, float]:
    """Ends of a slider, step and value, the grid of steps going through the value, so that the slider can show it."""
    least = own - step * math.floor((own - least) / step + 1e-9)
    most = own + step * math.ceil((most - own) / step - 1e-9)
    return _shorn(least), _shorn(most), step, own


def _round_step(rough: float) -> float:
    """The least of 1, 2 and 5 times a power of ten that is not below."""
    power = 10.0 ** math.floor(math.log10(rough))
    return _shorn(next(power * digit for digit in (1, 2, 5, 10) if power * digit >= rough * (1.0 - 1e-9)))


def _shorn(value: float) -> float:
    return float(f"{value:.12g}")


def _vehicle(car: RoadVehicle) -> Iterator[Number]:
    """Every number of a vehicle, at each axle, or each wheel where the wheels of an axle differ."""
    if not isinstance(car, Vehicle):
        return
    for name, quantity in car.quantities().items():
        if getattr(car, name) is None or name in ROAD or (name in STEERING and getattr(car, "steering", 0.0) is None):
            continue
        for place, own in _places(car, name):
            group = next((group for group, some in GROUPS.items() if _stem(name) in some), "handling")
            symbol = f" {quantity.symbol}" if quantity.symbol else ""
            label = f"{quantity.meaning}{symbol}" + (f", {place}" if place else "")
            known = quantity._replace(name=_stem(name))
            yield _slider(signal(name, place), "vehicle", signal(name, place), group, label, known, own, car)


def _stem(name: str) -> str:
    """``seat_ks`` of ``seat_ks_driver``."""
    known = (f"seat_{of}" for of in Seat.quantities())
    return max((stem for stem in known if name.startswith(stem)), key=len, default=name)


def _places(car: Vehicle, name: str) -> list[tuple[str, float]]:
    """Where a parameter may be set, and its value there."""
    if name not in car.per_corner:
        return [("", rate_of(getattr(car, name)))]
    own = dict(zip(car.wheels, map(rate_of, car.at_wheels(name)), strict=True))
    axles: dict[int, list[str]] = {}
    for wheel, place in car.wheels.items():
        axles.setdefault(place.axle, []).append(wheel)
    words = {0: "front", max(axles): "rear"}
    if any(len({own[wheel] for wheel in wheels}) > 1 for wheels in axles.values()):
        return list(own.items())
    if len(axles) == 1:
        return [("", own[axles[0][0]])]
    return [(words.get(axle, "middle"), own[wheels[0]]) for axle, wheels in axles.items()]


def takes_curve(car: RoadVehicle) -> bool:
    """Whether the page may give a vehicle's dampers a curve: none has one, and the vehicle takes them."""
    return isinstance(car, Vehicle) and not isinstance(car, RideHandlingCar) and not car.curved


def _seat(car: RoadVehicle) -> Iterator[Number]:
    if not takes_seat(car):
        return
    places = {"x": ("pitch_acc", 0.3), "y": ("roll_acc", 0.4)}
    for key, quantity in Seat.quantities().items():
        rotation, own = places.get(key, ("", getattr(Seat, key)))
        if not rotation or rotation in car.layout().variables:
            named = quantity._replace(name=f"seat_{key}")
            yield _slider(f"seat_{key}", "seat", key, "seat", quantity.meaning, named, own, car)


def _road(road: Road) -> Iterator[Number | Choice]:
    own = {name: float(getattr(road, name)) for name in ROAD}
    rough = min(1e-6, 0.1 * own["roughness"]), max(CLASSES["F"], 10.0 * own["roughness"])
    yield _of_road("roughness", *rough, 1e-7, own["roughness"])._replace(logarithmic=True)
    if road.power_law:
        own["waviness"] = float(road.slopes[0])
        ends = min(1.5, own["waviness"]), max(3.0, own["waviness"])
        yield Number("waviness", "road", "waviness", "road", "waviness w", "", *_grid(*ends, 0.05, own["waviness"]))
    yield _of_road("speed", *_grid(2.0, max(70.0, own["speed"]), 0.5, own["speed"]))
    yield _of_road("cutoff", *_grid(0.0, max(0.1, own["cutoff"]), 0.001, own["cutoff"]))
    yield Choice("tracks", "road", "tracks", "road", "left and right track", TRACKS, road.tracks)


def _of_road(name: str, least: float, most: float, step: float, own: float) -> Number:
    quantity = ROAD[name]
    label = f"{quantity.meaning} {quantity.symbol}" if quantity.symbol not in quantity.meaning else quantity.meaning
    return Number(name, "road", name, "road", label, quantity.unit, least, most, step, own)


def _shown(car: RoadVehicle) -> Iterator[Choice]:
    own, public = output_names(car)
    felt, felt_public = output_names(seated(car, {})) if takes_seat(car) else ((), ())
    more = tuple(name for name in felt if name.endswith(f"@{DRIVER}"))
    first = {name.partition("@")[0]: name for name in reversed(own)}
    x, y = first.get("sws", own[0]), first.get("bacc", own[0])
    yield Choice("carpet_x", "carpet", "x", "carpet", "across the carpet", own + more, x, seated=more)
    yield Choice("carpet_y", "carpet", "y", "carpet", "up the carpet", own + more, y, seated=more)
    more = tuple(name for name in more if name in felt_public)
    some = [name for name in (y, x) if name in public]
    yield Choice("bode", "", "bode", "frequency", "outputs over frequency", public + more, some, True, seated=more)
