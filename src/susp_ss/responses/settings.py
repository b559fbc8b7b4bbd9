"""What a design may set of a vehicle on a road: a field, a field at one wheel (``ks_fr``), or one of the road's."""

from __future__ import annotations

from typing import NamedTuple

from ..quantities import ROAD, Quantity, signal
from ..vehicles.contract import RoadVehicle


class Setting(NamedTuple):
    """What a name sets: a field of the vehicle or the road, at one wheel or (None) at all."""

    field: str
    wheel: str | None
    quantity: Quantity


def settable(vehicle: RoadVehicle) -> dict[str, Setting]:
    """Every name that sets something of a vehicle and its road."""
    quantities = vehicle.quantities()
    known = {
        name: Setting(field, None if name == field else wheels[0], quantities[field])
        for name, (field, wheels) in vehicle.settings().items()
        if name == field or name == signal(field, wheels[0])
    }
    return known | {name: Setting(name, None, quantity) for name, quantity in ROAD.items()}
