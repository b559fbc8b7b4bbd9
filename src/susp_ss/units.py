"""Numbers as people write them: with a unit, by the habits of several countries, and whether they can be meant.

The unit of a number is the mistake that nothing else finds: a spring of 24 N/m has a ride as good as any other. What a
number may be, `quantities` knows; here it is read, and what is far from every road vehicle is refused with the unit
that was likely meant.
"""

from __future__ import annotations

import math
import re
from typing import NamedTuple

from .quantities import UNITS, Quantity, units_of

NUMBER = re.compile(r"[+-]?(?:(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:e[+-]?[0-9]+)?|nan|inf|infinity)", re.IGNORECASE)
DECIMAL_COMMA = re.compile(r"[+-]?[0-9]*,[0-9]+(?:e[+-]?[0-9]+)?", re.IGNORECASE)

ALIASES = {"kph": "km/h", "kmh": "km/h", "lb/in": "lbf/in", "lbs/in": "lbf/in", "lbs": "lb", "lbs/in.": "lbf/in"} | {
    **dict.fromkeys(("metre", "metres", "meter", "meters"), "m"),
    **dict.fromkeys(("inch", "inches"), "in"),
    **dict.fromkeys(("foot", "feet"), "ft"),
}
"""What people also call a unit, in plain spelling."""


class Stated(NamedTuple):
    """A number with the unit that it was stated in; without one it is in SI units."""

    number: float
    unit: str

    def __str__(self) -> str:
        return f"{self.number:g} {self.unit}".rstrip()


def plain_unit(unit: str) -> str:
    """A unit without what people write differently: N.s/m, N*s/m, Ns/m and N s/m; m/s² and m/s2; N/(m/s); [mm].

    Examples
    --------
    >>> from susp_ss.units import plain_unit
    >>> plain_unit("[m/s²]"), plain_unit("N*s/m"), plain_unit("N/(m/s)")
    ('m/s2', 'Ns/m', 'Ns/m')
    """
    text = re.sub(r"^\[(.*)\]$|^\((.*)\)$", r"\1\2", unit.strip())
    text = text.replace("²", "2").replace("³", "3").replace("^", "")
    text = re.sub(r"\s*/\s*", "/", text)
    text = re.sub(r"/\((\w+)/(\w+)\)$", r"\2/\1", text)
    text = re.sub(r"(?<=\w)[\s.*·⋅-]+(?=[^\W\d])", "", text)
    return plain_unit(ALIASES[text]) if text in ALIASES else text


SPELT = {plain_unit(unit) for units in UNITS.values() for unit in units}
"""Every unit that is known, in plain spelling."""


def split_heading(heading: str) -> tuple[str, str]:
    """A column's name and the unit in brackets behind it, if that is a unit.

    Examples
    --------
    >>> from susp_ss.units import split_heading
    >>> split_heading("Ks (N/mm)"), split_heading("travel [rear]")
    (('Ks', 'N/mm'), ('travel [rear]', ''))
    """
    found = re.fullmatch(r"(.*\S)\s*(?:\[(.+)\]|\((.+)\))", heading)
    unit = (found[2] or found[3]) if found else ""
    return (found[1], unit) if found and plain_unit(unit) in SPELT else (heading, "")


def factor_of(unit: str, quantity: Quantity) -> float | None:
    """How much of its quantity's SI unit a stated unit is; None if it is none of them.

    Examples
    --------
    >>> from susp_ss.quantities import PARAMETERS
    >>> from susp_ss.units import factor_of
    >>> factor_of("N/mm", PARAMETERS["ks"]), factor_of("kg", PARAMETERS["ks"])
    (1000.0, None)
    """
    known = {plain_unit(name): factor for name, factor in units_of(quantity.unit).items()}
    spelt = plain_unit(unit)
    alike = [factor for name, factor in known.items() if name.casefold() == spelt.casefold()]
    return known.get(spelt, alike[0] if alike else None)


def stated(text: str, quantity: Quantity) -> Stated:
    """Read a number with or without a unit.

    Raises
    ------
    ValueError
        No number, a decimal comma, or a unit that the quantity does not come in.

    Examples
    --------
    >>> from susp_ss.quantities import PARAMETERS, ROAD
    >>> from susp_ss.units import stated
    >>> stated("24N/mm", PARAMETERS["ks"]), stated("20", ROAD["speed"])
    (Stated(number=24.0, unit='N/mm'), Stated(number=20.0, unit='m/s'))
    >>> stated("1,18 t", PARAMETERS["mb"])
    Traceback (most recent call last):
    ValueError: 1,18 is written with a decimal comma; write 1.18
    """
    number, unit = split_unit(text)
    if not unit:
        return Stated(number, quantity.unit)
    if factor_of(unit, quantity) is None:
        units = ", ".join(units_of(quantity.unit)) if quantity.unit else "none"
        raise ValueError(f"no unit {unit!r} of {quantity.meaning}, available: {units}")
    return Stated(number, unit)


def split_unit(text: str) -> tuple[float, str]:
    """Split ``24N/mm`` into the number and its unit, which may be nothing.

    Raises
    ------
    ValueError
        It does not begin with a number, or that has a decimal comma or groups of digits.

    Examples
    --------
    >>> from susp_ss.units import split_unit
    >>> split_unit("72 km/h")
    (72.0, 'km/h')
    """
    text = text.strip()
    comma = re.match(rf"({DECIMAL_COMMA.pattern})(?![0-9.,])", text, re.IGNORECASE)
    if comma:
        written = comma.group(1)
        raise ValueError(f"{written} is written with a decimal comma; write {written.replace(',', '.')}")
    found = NUMBER.match(text)
    unit = text[found.end() :].strip() if found else ""
    if found is None or re.match(r"[0-9.,'_:+-]", unit):
        raise ValueError(f"needs a number, such as 18500 or 18.5e3, got {text!r}")
    return float(found.group()), unit


def in_si(value: Stated, quantity: Quantity) -> float:
    """The number in the quantity's SI unit."""
    factor = factor_of(value.unit, quantity)
    assert factor is not None
    return value.number * factor


def implausible(value: Stated, quantity: Quantity) -> str:
    """Say that a number is far from every road vehicle's, and what may have been meant; nothing where it is not.

    What no vehicle can have at all, a negative mass or no number, is left to the vehicle to refuse.

    Examples
    --------
    >>> from susp_ss.quantities import PARAMETERS, ROAD
    >>> from susp_ss.units import Stated, implausible
    >>> implausible(Stated(24.0, "N/m"), PARAMETERS["ks"])
    '24 N/m is outside the usual range of spring stiffness, 1000 to 5e+06 N/m; did you mean 24 N/mm?'
    >>> implausible(Stated(24.0, "N/mm"), PARAMETERS["ks"])
    ''
    """
    si, (least, most) = in_si(value, quantity), quantity.known
    if not si > 0.0 or math.isinf(si) or least <= si <= most:
        return ""
    said = f"{value} is outside the usual range of {quantity.meaning}, {least:g} to {most:g} {quantity.unit}"
    meant = likely(value, quantity)
    return f"{said}; did you mean {meant}?" if meant else f"{said}."


def likely(value: Stated, quantity: Quantity) -> Stated | None:
    """The number in the first unit that makes it one of a road vehicle's, if there is any."""
    least, most = quantity.known
    meant = (Stated(value.number, unit) for unit in units_of(quantity.unit))
    return next((one for one in meant if least <= in_si(one, quantity) <= most), None)
