"""Frequency responses and spectra of some outputs, as plain numbers."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..metrics.comfort import AXES
from ..metrics.weightings import filter_of
from ..quantities import metric_and_place, per_input, signal, unit_of
from ..vehicles.second_order import Layout
from .rows import existing, finite

Array = NDArray[np.float64]

FREQUENCIES = (0.1, 50.0, 200)
"""From the slowest ride motion to beyond wheel hop in Hz, and how many, evenly in the logarithm."""

GRID = np.geomspace(*FREQUENCIES)
"""These, in Hz."""


def own_name(output: str, names: Sequence[str]) -> str:
    """The name in a table of outputs of one that is asked for, ``sws_fr`` of ``sws@fr``."""
    return existing(output.replace("@", "_"), names, "_")


def under(output: str, inputs: Sequence[str]) -> str:
    """The height of the road under an output's own wheel, or under the first where it is at none."""
    own = signal("z_r", output.partition("@")[2])
    return own if own in inputs else inputs[0]


def response_unit(name: str, given: str) -> str:
    """The unit of an output per that of an input."""
    return f"{unit_of(name) or 1}/{per_input(given)}"


def spectrum_unit(name: str) -> str:
    """The unit of an output's one-sided spectrum."""
    return f"({unit_of(name) or 1})^2/Hz"


def bode(layout: Layout, H: NDArray[np.complex128], outputs: Sequence[str]) -> list[dict[str, Any]]:
    """Magnitude and phase (degrees, continuous) of outputs per metre of the road `under` each.

    ``H`` are all public outputs on all inputs (outputs, inputs, F).
    """
    names = layout.outputs.names[layout.outputs.public]
    curves = []
    for output in outputs:
        name, given = own_name(output, names), under(output, layout.inputs)
        response = H[names.index(name), layout.inputs.index(given)]
        curves.append(
            {
                "output": output,
                "unit": response_unit(name, given),
                "input": given,
                "magnitude": finite(np.abs(response)),
                "phase": finite(np.degrees(np.unwrap(np.angle(response)))),
            }
        )
    return curves


def spectra(layout: Layout, densities: Array, outputs: Sequence[str]) -> list[dict[str, Any]]:
    """One-sided spectra of outputs, those of accelerations also as people feel them.

    ``densities`` are those of all public outputs (outputs, F).
    """
    names = layout.outputs.names[layout.outputs.public]
    curves = []
    for output in outputs:
        name = own_name(output, names)
        S, axis = densities[names.index(name)], AXES.get(metric_and_place(name)[0])
        felt = None if axis is None else S * powers(axis.weighting)
        curves.append(
            {
                "output": output,
                "unit": spectrum_unit(name),
                "psd": finite(S),
                "weighting": None if axis is None else axis.weighting,
                "weighted": None if felt is None else finite(felt),
            }
        )
    return curves


@cache
def powers(weighting: str) -> Array:
    """What a weighting leaves of a spectrum."""
    return filter_of(weighting, "").power(2.0 * np.pi * GRID)
