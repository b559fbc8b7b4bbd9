"""What a design may set of a vehicle on a road: a field, a field at one wheel (``ks_fr``), or one of the road's."""

from __future__ import annotations

from typing import NamedTuple

from ..quantities import ROAD, Quantity, signal
from ..vehicles.vehicle import Vehicle


class Setting(NamedTuple):
    """What a name sets: a field of the vehicle or the road, at one wheel or (None) at all."""

    field: str
    wheel: str | None
    quantity: Quantity


def settable(vehicle: Vehicle) -> dict[str, Setting]:
    """Every name that sets something of a vehicle and its road."""
    known = {}
    for name, quantity in vehicle.quantities().items():
        known[name] = Setting(name, None, quantity)
        if name in vehicle.per_corner:
            known |= {signal(name, wheel): Setting(name, wheel, quantity) for wheel in vehicle.wheels}
    return known | {name: Setting(name, None, quantity) for name, quantity in ROAD.items()}
