"""What ``--json`` prints, where commands share it."""

import dataclasses
import math
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from ..roads.road import Road


def road_document(road: "Road") -> dict[str, Any]:
    """Parameters of a road in SI units, and the line that says them."""
    return {**dataclasses.asdict(road), "description": road.describe()}


def json_number(value: float) -> float | str:
    """Return a number that JSON can hold; it has no infinity."""
    return value if math.isfinite(value) else str(value)
