"""Frequency responses and spectra of some outputs, as plain numbers."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..metrics.comfort import AXES
from ..metrics.weightings import filter_of
from ..quantities import metric_and_place, per_input, signal, unit_of
from ..responses.frequency import frequency_response, psd
from ..roads.road import Road
from ..vehicles.contract import RoadVehicle
from .rows import existing, finite

Array = NDArray[np.float64]


FREQUENCIES = (0.1, 50.0, 200)
"""From the slowest ride motion to beyond wheel hop in Hz, and how many, evenly in the logarithm."""


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


def bode(vehicle: RoadVehicle, outputs: Sequence[str], frequency: Array) -> list[dict[str, Any]]:
    """Magnitude and phase (degrees, continuous) of outputs per metre of the road `under` each."""
    response = frequency_response(vehicle, frequency)
    names, inputs = response.output.values.tolist(), response.input.values.tolist()
    curves = []
    for output in outputs:
        name, given = own_name(output, names), under(output, inputs)
        H = response.values[names.index(name), inputs.index(given)]
        curves.append(
            {
                "output": output,
                "unit": response_unit(name, given),
                "input": given,
                "magnitude": finite(np.abs(H)),
                "phase": finite(np.degrees(np.unwrap(np.angle(H)))),
            }
        )
    return curves


def spectra(vehicle: RoadVehicle, road: Road, outputs: Sequence[str], frequency: Array) -> list[dict[str, Any]]:
    """One-sided spectra of outputs on a road, those of accelerations also as people feel them."""
    spectrum = psd(vehicle, road, frequency)
    names = spectrum.output.values.tolist()
    curves = []
    for output in outputs:
        name = own_name(output, names)
        S, axis = spectrum.values[names.index(name)], AXES.get(metric_and_place(name)[0])
        felt = None if axis is None else S * filter_of(axis.weighting, "").power(2.0 * np.pi * frequency)
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
