"""A driver on a seat, on any vehicle that has a place for one."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from ..vehicles.contract import RoadVehicle
from ..vehicles.quarter import QuarterCar, QuarterCarWithSeat
from ..vehicles.ride_handling import RideHandlingCar
from ..vehicles.seats import Seat, field_of
from ..vehicles.vehicle import Vehicle

DRIVER = "driver"
"""Name of the seat."""


def takes_seat(car: RoadVehicle) -> bool:
    """Whether a vehicle has a place for a seat, and none on it yet."""
    if not isinstance(car, Vehicle) or isinstance(car, RideHandlingCar):
        return False
    variables = car.layout().variables
    rigid = "" in variables["bacc"][1] and not isinstance(car, QuarterCar)
    return "seat_travel" not in variables and not rigid


def seated(car: Any, seat: Mapping[str, float]) -> Any:
    """The vehicle with a driver on a seat."""
    if isinstance(car, QuarterCar):
        return QuarterCarWithSeat(**vars(car), **{field_of(of, ""): value for of, value in seat.items()})
    return car.with_seats({DRIVER: Seat(**seat)})
