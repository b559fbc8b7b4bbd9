"""Names, units and dimensions of the outputs, shared by metrics and time histories."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from ..vehicles import Sweep
from ..vehicles.linkage import SecondOrder, signal

QUANTITIES = {
    "bacc": ("m/s^2", "body vertical acceleration"),
    "sws": ("m", "suspension deflection"),
    "dtl": ("N", "dynamic tyre load"),
    "pitch_acc": ("rad/s^2", "pitch acceleration"),
    "roll_acc": ("rad/s^2", "roll acceleration"),
    "damper_power": ("W", "power dissipated by the suspension damper"),
}


def labelled_outputs(
    model: SecondOrder,
    values: NDArray[np.float64],
    power: NDArray[np.float64],
    sweep: Sweep,
    dims: tuple[str, ...] = (),
    coords: dict[str, Any] | None = None,
    statistic: str = "",
) -> xr.Dataset:
    """Arrange outputs as a Dataset.

    Parameters
    ----------
    model : SecondOrder
        Names the outputs.
    values : ndarray, (designs, outputs, ...)
        In output units, with trailing axes ``dims``.
    power : ndarray, (designs, corners, ...)
        Damper power in W.
    sweep : Sweep
        Labels the designs.
    statistic : str
        Put in front of each long name.
    """

    def variable(name: str, rows: NDArray[np.float64], dim: str, places: tuple[str, ...]) -> xr.DataArray:
        labels = dict(coords or {})
        if places == ("",) or not dim:
            data = sweep.unflatten(rows[:, 0], dims, labels)
        else:
            data = sweep.unflatten(rows, (dim, *dims), {dim: list(places), **labels})
        units, meaning = QUANTITIES[name]
        data.attrs = {"units": units, "long_name": f"{statistic} {meaning}".strip()}
        return data

    def rows(kind: str, places: tuple[str, ...]) -> NDArray[np.float64]:
        return values[:, [model.outputs.index(signal(kind, place)) for place in places]]

    variables = {"bacc": variable("bacc", rows("bacc", model.points), "point", model.points)}
    for kind in ("sws", "dtl"):
        variables[kind] = variable(kind, rows(kind, model.corners), "corner", model.corners)
    for kind in model.rotations:
        variables[kind] = variable(kind, rows(kind, ("",)), "", ())
    variables["damper_power"] = variable("damper_power", power, "corner", model.corners)
    return xr.Dataset(variables)
