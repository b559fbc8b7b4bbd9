"""Python that makes again what the explorer shows."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from ..presentation.reproduction import code
from ..roads.road_fit import unfitted
from ..vehicles.linear import LinearVehicle
from .design import road_of, vehicle_of
from .spectra import FREQUENCIES
from .state import NOTHING, Given, query


def lines(state: Mapping[str, Any], given: Given = NOTHING) -> str:
    """Python that makes a checked state's vehicle and road, and what the page shows of them.

    Raises
    ------
    ValueError
        The vehicle is a state space of a file.

    Examples
    --------
    >>> from susp_ss.explorer.lines import lines
    >>> from susp_ss.explorer.state import from_query
    >>> lines(from_query("model=quarter&ks=20000")[0]).splitlines()[:5]
    ['# susp-ss explore, /?model=quarter&ks=20000', 'import numpy as np', 'import susp_ss as ss', '', ...]
    """
    vehicle, road = vehicle_of(state, given), unfitted(road_of(state, given))
    if isinstance(vehicle, LinearVehicle):
        raise ValueError("the system of a file has no parameters, from which lines could make it again")
    straight = "ss.linearised(vehicle, road)" if vehicle.curved else "vehicle"
    return script(query(state, given), code(vehicle), code(road), straight, **state["bump"])


def script(query: str, vehicle: str, road: str, straight: str, height: float, length: float, speed: float) -> str:
    """The lines, with the code of a vehicle, of a road and of the vehicle without curves, and a bump."""
    low, high, count = FREQUENCIES
    return "\n".join(
        [
            f"# susp-ss explore, /?{query}".removesuffix("?"),
            "import numpy as np",
            "import susp_ss as ss",
            "",
            f"vehicle = {vehicle}",
            f"road = {road}",
            "metrics = ss.ride_metrics(vehicle, road)",
            f"straight = {straight}",
            "comfort = ss.comfort(straight, road)",
            f"frequency = np.geomspace({low!r}, {high!r}, {count!r})",
            "response = ss.frequency_response(straight, frequency)",
            "spectrum = ss.psd(straight, road, frequency)",
            "modes = straight.modes()",
            f"bump = ss.obstacle('bump', height={height!r}, length={length!r})",
            f"ride = ss.simulate(vehicle, bump, speed={speed!r}, positions=True)",
            "print(metrics, comfort, sep='\\n')",
            "",
        ]
    )
