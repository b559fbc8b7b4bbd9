"""What a design may set of a vehicle on a road: a field, everywhere or at some wheels (``ks_front``), or the road's."""

from __future__ import annotations

from typing import NamedTuple

from ..quantities import ROAD, Quantity
from ..vehicles.contract import RoadVehicle


class Setting(NamedTuple):
    """What a name sets: a field of the vehicle or the road, at some wheels or (None) at all."""

    field: str
    wheels: tuple[str, ...] | None
    quantity: Quantity

    def at(self, wheel: str | None) -> bool:
        """Whether it sets the field at a wheel."""
        return self.wheels is None or wheel in self.wheels

    def meets(self, other: Setting) -> bool:
        """Whether both set one field at one wheel."""
        if self.field != other.field:
            return False
        return self.wheels is None or any(map(other.at, self.wheels))


def settable(vehicle: RoadVehicle) -> dict[str, Setting]:
    """Every name that sets something of a vehicle and its road."""
    quantities = vehicle.quantities()
    known = {
        name: Setting(field, None if name == field else wheels, quantities[field])
        for name, (field, wheels) in vehicle.settings().items()
    }
    return known | {name: Setting(name, None, quantity) for name, quantity in ROAD.items()}
