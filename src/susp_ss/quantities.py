"""Every quantity once: its name, unit, meaning and symbol, where it is measured, and how people write all of these.

Vehicles, roads, results, files, options and pictures read what they say of a quantity here. A quantity at a place has
both names, ``sws_fr``. Nothing here needs a library, so that ``--help`` answers at once.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from numbers import Integral, Real
from typing import Any, NamedTuple


class Quantity(NamedTuple):
    """What a name stands for.

    ``unit`` is the SI unit, ``bound`` what its values must be (``"> 0"``, ``">= 0"`` or just finite), ``shown`` the
    unit of pictures where that is another, ``dim`` what its places are, of a result the dim along which they lie,
    ``statistic`` what a ride metric is of the momentary value, and ``known`` the least and the largest value that road
    vehicles and roads have, from karts to trucks; zero is known where the bound admits it.
    """

    name: str
    unit: str
    meaning: str
    symbol: str = ""
    bound: str = ""
    shown: str = ""
    dim: str = ""
    statistic: str = "RMS"
    known: tuple[float, float] = (0.0, math.inf)

    @property
    def zero(self) -> bool:
        """Whether zero is within the bound."""
        return self.bound == ">= 0"


def _table(*quantities: Quantity) -> dict[str, Quantity]:
    return {quantity.name: quantity for quantity in quantities}


PARAMETERS = _table(
    Quantity("ms", "kg", "sprung mass", "M_s", "> 0", known=(20.0, 2e4)),
    Quantity("mb", "kg", "body mass", "M_b", "> 0", known=(40.0, 6e4)),
    Quantity("mu", "kg", "unsprung mass", "M_u", "> 0", dim="corner", known=(2.0, 2e3)),
    Quantity("ixx", "kg m^2", "roll inertia", "I_xx", "> 0", known=(1.0, 1e5)),
    Quantity("iyy", "kg m^2", "pitch inertia", "I_yy", "> 0", known=(1.0, 5e5)),
    Quantity("a", "m", "front axle to centre of gravity", "a", "> 0", known=(0.1, 10.0)),
    Quantity("b", "m", "rear axle to centre of gravity", "b", "> 0", known=(0.1, 10.0)),
    Quantity("middle", "m", "middle axle behind the centre of gravity", known=(0.01, 10.0)),
    Quantity("c", "m", "half track width", "c", "> 0", known=(0.1, 2.0)),
    Quantity("ks", "N/m", "spring stiffness", "K_s", "> 0", "kN/m", dim="corner", known=(1e3, 5e6)),
    Quantity("cs", "N s/m", "damping rate", "C_s", ">= 0", "kN s/m", dim="corner", known=(20.0, 1e6)),
    Quantity("kt", "N/m", "tyre stiffness", "K_t", "> 0", "kN/m", dim="corner", known=(1e4, 1e7)),
    Quantity("ct", "N s/m", "tyre damping", "C_t", ">= 0", dim="corner", known=(1.0, 1e5)),
    Quantity("arb", "N/m", "anti-roll bar of one axle", "", ">= 0", known=(100.0, 1e7)),
    Quantity("arb_front", "N/m", "front anti-roll bar", "", ">= 0", known=(100.0, 1e7)),
    Quantity("arb_middle", "N/m", "middle anti-roll bar", "", ">= 0", known=(100.0, 1e7)),
    Quantity("arb_rear", "N/m", "rear anti-roll bar", "", ">= 0", known=(100.0, 1e7)),
    Quantity("seat_mass", "kg", "mass on the seat", "", "> 0", known=(1.0, 500.0)),
    Quantity("seat_ks", "N/m", "seat stiffness", "", "> 0", "kN/m", known=(500.0, 1e6)),
    Quantity("seat_cs", "N s/m", "seat damping rate", "", ">= 0", "kN s/m", known=(10.0, 1e5)),
)
"""Parameters of vehicles, in the symbols of the study."""

STEERED = _table(
    Quantity("izz", "kg m^2", "yaw inertia of the whole car", "I_zz", "> 0", known=(1.0, 5e5)),
    Quantity("ixz", "kg m^2", "roll-yaw product of inertia of the body", "I_xz", known=(-1e4, 1e4)),
    Quantity("height", "m", "height of the body's centre of gravity", "h_s", ">= 0", known=(0.05, 4.0)),
    Quantity("roll_centre_front", "m", "height of the front roll centre", "h_f", known=(-1.0, 2.0)),
    Quantity("roll_centre_rear", "m", "height of the rear roll centre", "h_r", known=(-1.0, 2.0)),
    Quantity("radius", "m", "wheel radius", "R", "> 0", known=(0.05, 1.5)),
    Quantity("cornering", "N/rad", "cornering stiffness", "C_a", ">= 0", dim="corner", known=(1e3, 1e6)),
    Quantity("relaxation", "m", "relaxation length", "s", ">= 0", dim="corner", known=(0.01, 5.0)),
    Quantity("slip", "N", "longitudinal force per unit of slip", "C_x", "> 0", dim="corner", known=(1e3, 1e6)),
    Quantity("wheel_inertia", "kg m^2", "spin inertia of a wheel", "I_w", "> 0", dim="corner", known=(1e-3, 1e3)),
    Quantity("steering", "N m/rad", "stiffness of the steering, each front wheel", "", "> 0", known=(100.0, 1e7)),
    Quantity(
        "steering_damping", "N m s/rad", "damping of the steering, each front wheel", "", ">= 0", known=(0.1, 1e5)
    ),
    Quantity(
        "steering_inertia", "kg m^2", "inertia of a front wheel about its steering axis", "", "> 0", known=(1e-3, 1e3)
    ),
    Quantity("trail", "m", "trail of the front tyres' lateral force", "", ">= 0", known=(1e-3, 0.5)),
)
"""Parameters of a car that steers."""

ROAD = _table(
    Quantity("roughness", "m^3", "G_d(0.1 cycle/m) of the road", "G_d", "> 0", known=(1e-8, 1.0)),
    Quantity("speed", "m/s", "speed", "V", "> 0", known=(0.1, 70.0)),
    Quantity("cutoff", "cycle/m", "low-wavenumber cut-off of the road", "n_c", ">= 0", known=(1e-5, 2.0)),
)
"""What a design may set of a road."""

METRICS = _table(
    Quantity("bacc", "m/s^2", "body vertical acceleration", "BAcc", ">= 0", dim="point", known=(1e-4, 200.0)),
    Quantity("sws", "m", "suspension deflection", "SWS", ">= 0", "mm", "corner", known=(1e-6, 1.0)),
    Quantity("dtl", "N", "dynamic tyre load", "DTL", ">= 0", "kN", "corner", known=(0.1, 1e6)),
    Quantity("pitch_acc", "rad/s^2", "pitch acceleration", "", ">= 0", known=(1e-5, 500.0)),
    Quantity("roll_acc", "rad/s^2", "roll acceleration", "", ">= 0", known=(1e-5, 500.0)),
    Quantity(
        "damper_power",
        "W",
        "power dissipated by the suspension damper",
        "",
        ">= 0",
        dim="corner",
        statistic="mean",
        known=(1e-4, 1e5),
    ),
    Quantity("tyre_deflection", "m", "tyre deflection", "", ">= 0", "mm", "corner", known=(1e-7, 0.3)),
    Quantity("sws_rate", "m/s", "suspension velocity", "", ">= 0", dim="corner", known=(1e-5, 50.0)),
    Quantity("seat_travel", "m", "seat deflection", "", ">= 0", "mm", "seat", known=(1e-6, 1.0)),
)
"""Variables of `susp_ss.ride_metrics`, in their order."""

ACTUATION = _table(
    Quantity("force", "N", "force of the actuator between wheel and body", "", shown="kN", dim="corner"),
)
"""What feedback adds to them."""

HANDLING = _table(
    Quantity("ay", "m/s^2", "lateral acceleration of the body's centre of gravity", "a_y"),
    Quantity("yaw_rate", "rad/s", "yaw rate", "r"),
    Quantity("sideslip", "rad", "sideslip angle below the centre of gravity", "", shown="deg"),
    Quantity("roll", "rad", "roll angle of the body", "", shown="deg"),
    Quantity(
        "load_transfer", "N", "load that an axle moves from the left wheel to the right", "", shown="kN", dim="axle"
    ),
    Quantity("load_transfer_ratio", "", "share of the car's weight that has moved from the left wheels to the right"),
    Quantity("slip_angle", "rad", "slip angle of the tyre", "", shown="deg", dim="corner"),
)
"""What a car that steers adds to them."""

POSITIONS = _table(
    Quantity("z_s", "m", "height of the body above where it stands on level ground", "z_s", dim="point"),
    Quantity("z_u", "m", "height of the wheel above where it stands on level ground", "z_u", dim="corner"),
    Quantity("z_r", "m", "height of the road under the wheel", "z_r", dim="corner"),
    Quantity("pitch", "rad", "pitch angle of the body, positive nose down", shown="deg"),
    Quantity("roll", "rad", "roll angle of the body, positive left up", shown="deg"),
)
"""Where body, wheels and road are over time."""

EVENTS = _table(
    Quantity("bump_rate", "1/s", "how often a suspension reaches its bump stop", dim="corner"),
    Quantity("rebound_rate", "1/s", "how often a suspension reaches its rebound stop", dim="corner"),
    Quantity("lift_off_rate", "1/s", "how often a wheel leaves the ground", dim="corner"),
    Quantity("bump_probability", "", "probability of reaching the bump stop over the stretch", dim="corner"),
    Quantity("rebound_probability", "", "probability of reaching the rebound stop over the stretch", dim="corner"),
    Quantity("lift_off_probability", "", "probability of a wheel leaving the ground over the stretch", dim="corner"),
    Quantity("static_load", "N", "load of the tyre at rest", dim="corner"),
    Quantity("bacc_highest", "m/s^2", "expected highest body vertical acceleration over the stretch", dim="point"),
    Quantity("sws_highest", "m", "expected highest suspension deflection over the stretch", dim="corner"),
    Quantity("dtl_highest", "N", "expected highest dynamic tyre load over the stretch", dim="corner"),
    Quantity("bacc_crossings", "1/s", "how often body vertical acceleration passes zero upwards", dim="point"),
    Quantity("sws_crossings", "1/s", "how often suspension deflection passes zero upwards", dim="corner"),
    Quantity("dtl_crossings", "1/s", "how often dynamic tyre load passes zero upwards", dim="corner"),
    Quantity("irregularity", "", "zero crossings over peaks of suspension deflection", dim="corner"),
    Quantity("damage", "", "fatigue damage of the suspension spring over the stretch", dim="corner"),
)
"""Variables of `susp_ss.rare_events`, in their order."""

SHIFT = Quantity("ride_height_shift", "m", "deflection of the suspension", shown="mm", dim="corner", statistic="mean")
"""How far curves of springs and dampers move the mean position of a suspension: bump positive, the body sinks."""

KNOWN = PARAMETERS | ROAD | METRICS

# The pound is 0.45359237 kg and the inch 0.0254 m by definition; a pound-force weighs at g = 9.80665 m/s^2.
_LB, _IN, _G = 0.45359237, 0.0254, 9.80665

UNITS: dict[str, dict[str, float]] = {
    "kg": {"kg": 1.0, "t": 1e3, "lb": _LB},
    "kg m^2": {"kg m^2": 1.0, "lb ft^2": _LB * (12.0 * _IN) ** 2},
    "m": {"m": 1.0, "mm": 1e-3, "cm": 1e-2, "in": _IN, "ft": 12.0 * _IN, "km": 1e3},
    "N/m": {"N/m": 1.0, "N/mm": 1e3, "kN/m": 1e3, "lbf/in": _LB * _G / _IN},
    "N s/m": {"N s/m": 1.0, "N s/mm": 1e3, "kN s/m": 1e3, "lbf s/in": _LB * _G / _IN},
    "m/s^2": {"m/s^2": 1.0, "mm/s^2": 1e-3, "g": _G},
    "N": {"N": 1.0, "kN": 1e3, "lbf": _LB * _G, "kgf": _G},
    "N/rad": {"N/rad": 1.0, "N/deg": 180.0 / math.pi, "kN/rad": 1e3},
    "N m/rad": {"N m/rad": 1.0, "kN m/rad": 1e3, "N m/deg": 180.0 / math.pi},
    "N m s/rad": {"N m s/rad": 1.0, "N m s/deg": 180.0 / math.pi},
    "rad": {"rad": 1.0, "deg": math.pi / 180.0},
    "rad/s": {"rad/s": 1.0, "deg/s": math.pi / 180.0},
    "rad/s^2": {"rad/s^2": 1.0, "deg/s^2": math.pi / 180.0},
    "W": {"W": 1.0, "kW": 1e3},
    "m/s": {"m/s": 1.0, "km/h": 1.0 / 3.6, "mph": 0.44704, "mm/s": 1e-3},
    "m^3": {"m^3": 1.0, "cm^3": 1e-6},
    "cycle/m": {"cycle/m": 1.0, "rad/m": 0.5 / math.pi},
    "s": {"s": 1.0, "ms": 1e-3, "min": 60.0, "h": 3600.0},
    "Hz": {"Hz": 1.0, "rad/s": 0.5 / math.pi},
}
"""For each SI unit, the units that people may state in its place, and how much of the SI unit one of them is."""

CORNERS = {"fr": "front right", "fl": "front left", "rr": "rear right", "rl": "rear left"}
"""Corners of a car, in the order of every result."""

MIDDLE = {"mr": "middle right", "ml": "middle left"}
"""Wheels between them, of three axles."""

GROUPS = {
    "front": frozenset({"fr", "fl"}),
    "rear": frozenset({"rr", "rl"}),
    "right": frozenset({"fr", "rr"}),
    "left": frozenset({"fl", "rl"}),
}
"""Corners that a word stands for."""

PLACES = {"cg", *CORNERS, *MIDDLE, "middle", *GROUPS, "f", "r", "l"}
"""What may follow the name of a quantity: wheels, groups of them, ends and sides of half cars, and ``cg``."""

DIMS = (
    *("point", "corner", "axle", "seat", "estimate", "counting", "statistic"),
    *("state", "state_", "output", "input", "frequency", "time"),
)
"""Dims of results."""


def signal(quantity: str, place: str) -> str:
    """Join ``sws`` and ``fr`` to ``sws_fr``; the one place of a quarter car has no name.

    Examples
    --------
    >>> from susp_ss.quantities import signal
    >>> signal("sws", "fr"), signal("sws", "")
    ('sws_fr', 'sws')
    """
    return f"{quantity}_{place}" if place else quantity


def metric_and_place(name: str) -> tuple[str, str | None]:
    """Split ``bacc_fr`` into the metric and its place; a name without a place, or of no metric, has None.

    Examples
    --------
    >>> from susp_ss.quantities import metric_and_place
    >>> metric_and_place("sws_rr"), metric_and_place("pitch_acc")
    (('sws', 'rr'), ('pitch_acc', None))
    """
    found = [metric for metric in METRICS if name.startswith(f"{metric}_")] if name not in METRICS else []
    metric = max(found, key=len, default=name)
    return (metric, name.removeprefix(f"{metric}_")) if found else (name, None)


def unit_of(output: str) -> str:
    """Unit of an output by its name, such as ``sws`` or ``bacc_fr``; nothing if it is not known.

    Examples
    --------
    >>> from susp_ss.quantities import unit_of
    >>> unit_of("bacc_driver"), unit_of("yaw_rate"), unit_of("gap")
    ('m/s^2', 'rad/s', '')
    """
    metric, _ = metric_and_place(output)
    known = quantity_of(metric, METRICS | HANDLING | ACTUATION)
    return known.unit if known else ""


def per_input(name: str) -> str:
    """What a response is per unit of an input of this name: metre of the road's height, or what else drives a vehicle.

    Examples
    --------
    >>> from susp_ss.quantities import per_input
    >>> per_input("z_r_fr"), per_input("delta_f"), per_input("drive_rl")
    ('m', 'rad', 'N m')
    """
    return {"delta": "rad", "drive": "N m"}.get(name.partition("_")[0], "m")


def quantity_of(name: str, known: Mapping[str, Quantity] = KNOWN) -> Quantity | None:
    """What a name stands for, with a place behind it or without; None if it is not known.

    Examples
    --------
    >>> from susp_ss.quantities import quantity_of
    >>> quantity_of("ks_rear").unit, quantity_of("gap")
    ('N/m', None)
    """
    stem, _, place = name.rpartition("_")
    return known.get(name) or (known.get(stem) if place in PLACES else None)


def units_of(unit: str) -> dict[str, float]:
    """The units that people may state in place of an SI unit, itself included, and how much of it each is.

    Examples
    --------
    >>> from susp_ss.quantities import units_of
    >>> units_of("kg"), units_of("N m/kg")
    ({'kg': 1.0, 't': 1000.0, 'lb': 0.45359237}, {'N m/kg': 1.0})
    """
    return UNITS.get(unit, {unit: 1.0})


def typeset(text: str) -> str:
    """Units as people read them, in reports, tables and pictures; what programs read keeps ``m/s^2``.

    Examples
    --------
    >>> from susp_ss.quantities import typeset
    >>> typeset("m/s^2"), typeset("6.4e-05 m^3"), typeset("N s/m")
    ('m/s²', '6.4e-05 m³', 'N s/m')
    """
    return text.replace("^2", "²").replace("^3", "³")


def titled(name: str, unit: str) -> str:
    """A name with its unit, as an axis or a column of a table has it.

    Examples
    --------
    >>> from susp_ss.quantities import titled
    >>> titled("bacc", "m/s^2"), titled("R2", "")
    ('bacc (m/s²)', 'R2')
    """
    return f"{name} ({typeset(unit)})" if unit else name


def briefly(value: Any) -> str:
    """What a message shows of any object: how it is written where that is short, else its kind and size.

    Examples
    --------
    >>> import numpy as np
    >>> from susp_ss.quantities import briefly
    >>> briefly("soft"), briefly([1, 2]), briefly(np.zeros((40, 3))), briefly(object())
    ("'soft'", '[1, 2]', 'an ndarray of shape (40, 3)', 'an object')
    """
    text = repr(value)
    if len(text) <= 100 and "\n" not in text and not text.startswith("<"):
        return text
    kind = type(value).__name__
    article = "an" if kind[:1].lower() in "aeio" or kind.startswith("nd") else "a"
    size = f" of shape {value.shape}" if isinstance(getattr(value, "shape", None), tuple) else ""
    return f"{article} {kind}{size}"


def whole_number(name: str, value: Any, least: int, most: int | None = None, need: str | None = None) -> int:
    """Return a whole number within bounds, or say what is wrong with it.

    Raises
    ------
    ValueError
        It is none, or outside; ``need`` says in words which it may be, in place of ``>= least``.

    Examples
    --------
    >>> from susp_ss.quantities import whole_number
    >>> whole_number("folds", 2.5, 2)
    Traceback (most recent call last):
    ValueError: folds must be a whole number >= 2, got 2.5
    """
    whole = isinstance(value, Integral) and not isinstance(value, bool)
    if not whole or value < least or (most is not None and value > most):
        raise ValueError(f"{name} must be a whole number {need or f'>= {least}'}, got {briefly(value)}")
    return int(value)


def positive(name: str, value: Any, unit: str = "m") -> float:
    """Return a number > 0 as float, or say what is wrong with it.

    Raises
    ------
    TypeError, ValueError
        It is none, not finite or not > 0.

    Examples
    --------
    >>> from susp_ss.quantities import positive
    >>> positive("speed", -1.0, "m/s")
    Traceback (most recent call last):
    ValueError: speed must be > 0 m/s and finite, got -1.0
    """
    need = f"> 0 {unit}".rstrip()
    if isinstance(value, bool) or not isinstance(value, Real):
        raise TypeError(f"{name} must be a number {need}, got {briefly(value)}")
    number = float(value)
    if not (math.isfinite(number) and number > 0.0):
        raise ValueError(f"{name} must be {need} and finite, got {briefly(value)}")
    return number
