"""Frequency weightings of vibration, as the standards define them, and which output gets which."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from ..quantities import briefly
from ..responses.filters import Filter
from ..vehicles.second_order import Layout, Outputs

if TYPE_CHECKING:
    import control


class _Constants(NamedTuple):
    """Corner frequencies in Hz and resonances of a weighting; None where it has no such part."""

    band: tuple[float, float]
    transition: tuple[float | None, float, float] | None = None  # f3, f4, Q4
    step: tuple[float, float, float, float] | None = None  # f5, Q5, f6, Q6
    gain: float = 1.0


# ISO 2631-1:1997 annex A and ISO 8041-1:2017 table 3, Wm as ISO 2631-2 defines it. BS 6841 states the gain of Wb below
# its step, 0.4, and ISO 2631-4 the one above, 1.024: they are one filter, for (2.5 / 4)^2 = 0.4 / 1.024.
WEIGHTINGS = {
    "Wk": _Constants((0.4, 100.0), (12.5, 12.5, 0.63), (2.37, 0.91, 3.35, 0.91)),
    "Wd": _Constants((0.4, 100.0), (2.0, 2.0, 0.63)),
    "Wf": _Constants((0.08, 0.63), (None, 0.25, 0.86), (0.0625, 0.8, 0.1, 0.8)),
    "Wc": _Constants((0.4, 100.0), (8.0, 8.0, 0.63)),
    "We": _Constants((0.4, 100.0), (1.0, 1.0, 0.63)),
    "Wj": _Constants((0.4, 100.0), None, (3.75, 0.91, 5.32, 0.91)),
    "Wb": _Constants((0.4, 100.0), (16.0, 16.0, 0.55), (2.5, 0.9, 4.0, 0.95), 1.024),
    "Wm": _Constants((10.0**-0.1, 100.0), (0.5 / (0.028 * np.pi), 0.5 / (0.028 * np.pi), 0.5)),
}

# The band limits are Butterworth filters of second order.
BUTTERWORTH = np.sqrt(0.5)

# What a weighting of vibration is for, where one is given for all outputs.
ACCELERATIONS = ("bacc", "pitch_acc", "roll_acc")


def weighting(name: str) -> control.TransferFunction:
    """Return a frequency weighting of vibration as a filter.

    ``W(s) = K W_band(s) W_transition(s) W_step(s)`` with the band limits of second order, the transition from
    acceleration to velocity ``(1 + s/w3) / (1 + s/(Q4 w4) + (s/w4)^2)`` and the upward step
    ``(1 + s/(Q5 w5) + (s/w5)^2) / (1 + s/(Q6 w6) + (s/w6)^2) (w5/w6)^2`` (ISO 2631-1:1997 annex A, ISO 8041-1:2017,
    BS 6841:1987).

    Parameters
    ----------
    name : {"Wk", "Wd", "Wf", "Wc", "We", "Wj", "Wb", "Wm"}
        ``Wk`` vertical and ``Wd`` horizontal vibration of a seat, ``Wf`` motion sickness, ``Wc`` the back rest, ``We``
        rotation, ``Wj`` below the head of a lying person, ``Wb`` vertical vibration by BS 6841 and on railways, ``Wm``
        vibration in buildings.

    Returns
    -------
    control.TransferFunction

    Raises
    ------
    ValueError
        No such weighting.

    Examples
    --------
    >>> from susp_ss import weighting
    >>> print(f"{abs(weighting('Wk')(2j * 3.14159 * 6.3)):.3f}")
    1.054
    """
    import control

    if not isinstance(name, str) or name not in WEIGHTINGS:
        raise ValueError(f"no weighting named {briefly(name)}, available: {', '.join(WEIGHTINGS)}")
    constants = WEIGHTINGS[name]
    lowest, highest = (2.0 * np.pi * f for f in constants.band)
    parts = [
        ([1.0, 0.0, 0.0], [1.0, lowest / BUTTERWORTH, lowest**2]),
        ([highest**2], [1.0, highest / BUTTERWORTH, highest**2]),
        ([constants.gain], [1.0]),
    ]
    if constants.transition:
        f3, f4, Q4 = constants.transition
        zero = [1.0] if f3 is None else [1.0 / (2.0 * np.pi * f3), 1.0]
        parts.append((zero, _resonance(f4, Q4)))
    if constants.step:
        f5, Q5, f6, Q6 = constants.step
        parts.append(([(f5 / f6) ** 2 * c for c in _resonance(f5, Q5)], _resonance(f6, Q6)))
    numerator: Any = 1.0
    denominator: Any = 1.0
    for above, below in parts:
        numerator, denominator = np.polymul(numerator, above), np.polymul(denominator, below)
    return control.tf(numerator, denominator, name=name)


def _resonance(frequency: float, Q: float) -> list[float]:
    """``1 + s/(Q w) + (s/w)^2``, highest power first."""
    w = 2.0 * np.pi * frequency
    return [1.0 / w**2, 1.0 / (Q * w), 1.0]


@cache
def _named(name: str) -> Filter:
    return Filter(weighting(name), f"weighting={name!r}", name)


def filters(given: Any, layout: Layout) -> dict[str, Filter]:
    """Which variable of the results goes through which filter.

    Parameters
    ----------
    given : str, system of python-control, or mapping of either by output
        One for all is for the accelerations; None is no filter.
    layout : Layout
        Of the vehicle.

    Raises
    ------
    TypeError, ValueError
        No filter, or an output that the vehicle does not have.
    """
    if given is None:
        return {}
    available = [name for name in layout.variables if name != "damper_power"]
    if not isinstance(given, Mapping):
        one = filter_of(given, "weighting")
        return {name: one for name in available if name in ACCELERATIONS}
    for name in given:
        if name not in available:
            raise ValueError(f"weighting={{...}}: no output named {briefly(name)}, available: {', '.join(available)}")
    return {name: filter_of(one, f"weighting of {name}") for name, one in given.items() if one is not None}


def filter_of(given: Any, where: str) -> Filter:
    """A filter by its name or as a system.

    Raises
    ------
    TypeError, ValueError
        No such name, or a system that is unstable, improper or none.
    """
    return _named(given) if isinstance(given, str) else Filter(given, where)


def rows_behind(weighted: Mapping[str, Filter], outputs: Outputs) -> dict[Filter, NDArray[np.int_]]:
    """The rows of the output table behind each filter."""
    rows: dict[Filter, list[NDArray[np.int_]]] = {}
    for name, one in weighted.items():
        rows.setdefault(one, []).append(np.arange(len(outputs))[outputs.of(name)])
    return {one: np.concatenate(some) for one, some in rows.items()}


def say_weightings(results: xr.Dataset, weighted: Mapping[str, Filter]) -> None:
    """Name the filter of each variable in its attributes."""
    for name, one in weighted.items():
        results[name].attrs["weighting"] = one.name
