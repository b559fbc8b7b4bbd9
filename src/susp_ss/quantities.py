"""Every quantity once: its name, unit, meaning and symbol, where it is measured, and how people write all of these.

Vehicles, roads, results, files, options and pictures read what they say of a quantity here. A quantity at a place has
both names, ``sws_fr``. Nothing here needs a library, so that ``--help`` answers at once.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from numbers import Integral
from typing import Any, NamedTuple


class Quantity(NamedTuple):
    """What a name stands for.

    ``unit`` is the SI unit, ``bound`` what its values must be (``"> 0"``, ``">= 0"`` or nothing), ``shown`` the unit of
    pictures where that is another, ``dim`` what its places are, of a result the dim along which they lie, and
    ``statistic`` what a ride metric is of the momentary value.
    """

    name: str
    unit: str
    meaning: str
    symbol: str = ""
    bound: str = ""
    shown: str = ""
    dim: str = ""
    statistic: str = "RMS"

    @property
    def zero(self) -> bool:
        """Whether zero is within the bound."""
        return self.bound == ">= 0"


def _table(*quantities: Quantity) -> dict[str, Quantity]:
    return {quantity.name: quantity for quantity in quantities}


PARAMETERS = _table(
    Quantity("ms", "kg", "sprung mass", "M_s", "> 0"),
    Quantity("mb", "kg", "body mass", "M_b", "> 0"),
    Quantity("mu", "kg", "unsprung mass", "M_u", "> 0", dim="corner"),
    Quantity("ixx", "kg m^2", "roll inertia", "I_xx", "> 0"),
    Quantity("iyy", "kg m^2", "pitch inertia", "I_yy", "> 0"),
    Quantity("a", "m", "front axle to centre of gravity", "a", "> 0"),
    Quantity("b", "m", "rear axle to centre of gravity", "b", "> 0"),
    Quantity("c", "m", "half track width", "c", "> 0"),
    Quantity("ks", "N/m", "spring stiffness", "K_s", "> 0", "kN/m", dim="corner"),
    Quantity("cs", "N s/m", "damping rate", "C_s", ">= 0", "kN s/m", dim="corner"),
    Quantity("kt", "N/m", "tyre stiffness", "K_t", "> 0", "kN/m", dim="corner"),
    Quantity("ct", "N s/m", "tyre damping", "C_t", ">= 0", dim="corner"),
    Quantity("arb", "N/m", "anti-roll bar of one axle", "", ">= 0"),
    Quantity("arb_front", "N/m", "front anti-roll bar", "", ">= 0"),
    Quantity("arb_rear", "N/m", "rear anti-roll bar", "", ">= 0"),
)
"""Parameters of vehicles, in the symbols of the study."""

ROAD = _table(
    Quantity("roughness", "m^3", "G_d(0.1 cycle/m) of the road", "G_d", "> 0"),
    Quantity("speed", "m/s", "speed", "V", "> 0"),
    Quantity("cutoff", "cycle/m", "low-wavenumber cut-off of the road", "n_c", ">= 0"),
)
"""What a design may set of a road."""

METRICS = _table(
    Quantity("bacc", "m/s^2", "body vertical acceleration", "BAcc", ">= 0", dim="point"),
    Quantity("sws", "m", "suspension deflection", "SWS", ">= 0", "mm", "corner"),
    Quantity("dtl", "N", "dynamic tyre load", "DTL", ">= 0", "kN", "corner"),
    Quantity("pitch_acc", "rad/s^2", "pitch acceleration", "", ">= 0"),
    Quantity("roll_acc", "rad/s^2", "roll acceleration", "", ">= 0"),
    Quantity(
        "damper_power", "W", "power dissipated by the suspension damper", "", ">= 0", dim="corner", statistic="mean"
    ),
)
"""Variables of `susp_ss.ride_metrics`, in their order."""

SIGNALS = METRICS | _table(Quantity("dsws", "m/s", "suspension velocity", dim="corner"))
"""Outputs of models, whether a metric is made of each or not."""

KNOWN = PARAMETERS | ROAD | METRICS

UNITS: dict[str, dict[str, float]] = {
    "kg": {"kg": 1.0, "t": 1e3},
    "kg m^2": {"kg m^2": 1.0},
    "m": {"m": 1.0, "mm": 1e-3, "cm": 1e-2},
    "N/m": {"N/m": 1.0, "N/mm": 1e3, "kN/m": 1e3},
    "N s/m": {"N s/m": 1.0, "N s/mm": 1e3, "kN s/m": 1e3},
    "m/s^2": {"m/s^2": 1.0, "mm/s^2": 1e-3, "g": 9.80665},
    "N": {"N": 1.0, "kN": 1e3},
    "rad/s^2": {"rad/s^2": 1.0, "deg/s^2": math.pi / 180.0},
    "W": {"W": 1.0, "kW": 1e3},
    "m/s": {"m/s": 1.0, "km/h": 1.0 / 3.6},
    "m^3": {"m^3": 1.0},
    "cycle/m": {"cycle/m": 1.0},
}
"""For each SI unit, the units that a file may state, and how much of the SI unit one of them is."""

CORNERS = {"fr": "front right", "fl": "front left", "rr": "rear right", "rl": "rear left"}
"""Corners of a car, in the order of every result."""

GROUPS = {
    "front": frozenset({"fr", "fl"}),
    "rear": frozenset({"rr", "rl"}),
    "right": frozenset({"fr", "rr"}),
    "left": frozenset({"fl", "rl"}),
}
"""Corners that a word stands for."""

PLACES = {"cg", *CORNERS, *GROUPS, "f", "r", "l"}
"""What may follow the name of a quantity: corners, groups of them, ends and sides of half cars, and ``cg``."""

DIMS = ("point", "corner", "state", "state_", "output", "input", "frequency", "time")
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
    metric, _, place = name.rpartition("_")
    return (metric, place) if metric in METRICS else (name, None)


def unit_of(output: str) -> str:
    """Unit of an output by its name, such as ``sws`` or ``bacc_fr``; nothing if it is not known.

    Examples
    --------
    >>> from susp_ss.quantities import unit_of
    >>> unit_of("bacc_driver"), unit_of("ay")
    ('m/s^2', '')
    """
    metric, _ = metric_and_place(output)
    return METRICS[metric].unit if metric in METRICS else ""


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
    >>> units_of("kg"), units_of("N m/rad")
    ({'kg': 1.0, 't': 1000.0}, {'N m/rad': 1.0})
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
        raise ValueError(f"{name} must be a whole number {need or f'>= {least}'}, got {value!r}")
    return int(value)
