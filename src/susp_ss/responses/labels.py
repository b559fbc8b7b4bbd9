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


def unit_of(output: str) -> str:
    """Unit of an output by its name, such as ``sws`` or ``bacc_fr``."""
    return next(unit for kind, (unit, _) in QUANTITIES.items() if f"{output}_".startswith(f"{kind}_"))


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

    variables: dict[str, Any] = {}
    labels: dict[str, Any] = {**sweep.coords, **(coords or {})}

    def add(name: str, data: NDArray[np.float64], dim: str, places: tuple[str, ...]) -> None:
        several = bool(dim) and places != ("",)
        if several:
            labels[dim] = list(places)
        units, meaning = QUANTITIES[name]
        shaped = data if several else data[:, 0]
        variables[name] = (
            (*sweep.dims, *((dim,) if several else ()), *dims),
            shaped.reshape((*sweep.shape, *shaped.shape[1:])),
            {"units": units, "long_name": f"{statistic} {meaning}".strip()},
        )

    def columns(kind: str, places: tuple[str, ...]) -> NDArray[np.float64]:
        found = [model.outputs.index(signal(kind, place)) for place in places]
        if found == list(range(found[0], found[-1] + 1)):
            return values[:, found[0] : found[-1] + 1]
        # Taken by rows of the transpose, which keeps one design after another in memory if they are.
        return np.moveaxis(np.moveaxis(values, 1, 0)[found], 0, 1)

    add("bacc", columns("bacc", model.points), "point", model.points)
    for kind in ("sws", "dtl"):
        add(kind, columns(kind, model.corners), "corner", model.corners)
    for kind in model.rotations:
        add(kind, columns(kind, ("",)), "", ())
    add("damper_power", power, "corner", model.corners)
    return xr.Dataset(variables, labels)
