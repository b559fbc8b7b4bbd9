"""Where a vehicle's body, wheels and road are: further rows of the output table, ready to animate."""

from __future__ import annotations

import dataclasses
from functools import cache

import numpy as np
from numpy.typing import NDArray

from ..quantities import POSITIONS
from ..vehicles.contract import Model, RoadVehicle
from ..vehicles.linkage import Motion
from ..vehicles.second_order import Layout, Outputs, Row, coefficients
from ..vehicles.vehicle import Vehicle
from .first_order_hold import joined

Array = NDArray[np.float64]


def with_positions(layout: Layout, vehicle: RoadVehicle) -> Layout:
    """The layout with a row for the height of every point of the body, wheel and road, and the angles of the body."""
    return _positioned(layout, type(_known(vehicle)))


@cache
def _positioned(layout: Layout, kind: type[Vehicle]) -> Layout:
    rows = tuple(row for row, _ in _motions(kind()))
    return dataclasses.replace(layout, outputs=Outputs((*layout.outputs.rows, *rows)))


def form_with_positions(model: Model, vehicle: RoadVehicle) -> tuple[Array, Array, Array, Array, Array]:
    """`Model.displacement_form` of a flattened vehicle with these rows."""
    A, B, Y, D, D1 = model.displacement_form()
    terms = [motion.terms for _, motion in _motions(_known(vehicle))]
    of_states, of_heights = (coefficients(terms, names) for names in (model.layout.states, model.layout.inputs))
    return A, B, joined([Y, of_states], -2), joined([D, of_heights], -2), joined([D1, np.zeros_like(of_heights)], -2)


def _known(vehicle: RoadVehicle) -> Vehicle:
    if not isinstance(vehicle, Vehicle):
        raise TypeError(f"positions need a vehicle whose body is known, such as FullCar(), got {vehicle!r}")
    return vehicle


def _motions(vehicle: Vehicle) -> list[tuple[Row, Motion]]:
    linkage, known = vehicle.linkage(), vehicle.layout().outputs.names
    found = [
        *(("z_s", name, motion) for name, motion in linkage.points.items()),
        *(("z_s", name, seat.rider) for name, seat in linkage.seats.items()),
        *((name.removesuffix("_acc"), "", motion) for name, motion in linkage.rotations.items()),
        *(("z_u", name, corner.wheel) for name, corner in linkage.corners.items() if corner.wheel is not None),
        *(("z_r", name, corner.road) for name, corner in linkage.corners.items()),
    ]
    rows = [(Row(POSITIONS[name], place, False), motion) for name, place, motion in found]
    return [(row, motion) for row, motion in rows if row.name not in known]
