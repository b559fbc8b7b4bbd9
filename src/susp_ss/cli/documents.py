"""What ``--json`` prints, where commands share it."""

import dataclasses
import math
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from ..roads import Road
    from ..vehicles import Vehicle


def vehicle_document(vehicle: "Vehicle") -> dict[str, Any]:
    """Model and parameters of a vehicle, laid out as in a vehicle file."""
    from ..vehicles.files import entry, model_name

    return {
        "model": model_name(vehicle),
        "parameters": {field.name: entry(vehicle, field) for field in dataclasses.fields(vehicle)},
    }


def road_document(road: "Road") -> dict[str, Any]:
    """Parameters of a road in SI units, and the line that says them."""
    return {**dataclasses.asdict(road), "description": road.describe()}


def json_number(value: float) -> float | str:
    """Return a number that JSON can hold; it has no infinity."""
    return value if math.isfinite(value) else str(value)
