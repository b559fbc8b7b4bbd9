"""Seats and who sits on them: one more mass, spring and damper each, anywhere on a vehicle's body."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from typing import Any

from ..quantities import PARAMETERS, Quantity, briefly, signal
from .linkage import Cushion, Linkage, coordinates
from .parameters import parameter
from .points import ALONG, again, as_kind, body_point

# Three quarters of a person of 75 kg rest on the seat, whose resonance with him is at 4 Hz and doubles the vibration
# of the floor there, as on the foam cushions of cars (M. J. Griffin, Handbook of Human Vibration, 1990, chapter 9).
MASS, KS, CS = 56.0, 35e3, 800.0


@dataclass(frozen=True, kw_only=True, eq=False)
class Seat:
    """A seat on a body and who sits on it: a mass on a spring and a damper, one degree of freedom.

    ``mass z'' = ks (z_floor - z) + cs (z_floor' - z')``, with the floor at a point of the body. The defaults are three
    quarters of a person of 75 kg on a cushion of foam: 4 Hz, and twice the vibration of the floor there (M. J.
    Griffin, *Handbook of Human Vibration*, 1990, chapter 9). The mass comes on top of the body's own.

    Parameters
    ----------
    x, y : float, array or DataArray
        Place in m ahead of and to the left of the centre of gravity.
    mass : float, array or DataArray
        What rests on the seat, in kg, > 0.
    ks : float, array or DataArray
        Stiffness of the seat in N/m, > 0.
    cs : float, array or DataArray
        Damping rate of the seat in N s/m, >= 0.

    See Also
    --------
    Vehicle.with_seats : puts seats on a car.

    Examples
    --------
    >>> import susp_ss as ss
    >>> car = ss.FullCar().with_seats({"driver": ss.Seat(x=0.3, y=0.4), "child": ss.Seat(x=-0.6, y=-0.4, mass=20.0)})
    >>> ride = ss.ride_metrics(car, ss.DEFAULT_ROAD, weighting="Wk")
    >>> ride.seat_travel.seat.values.tolist()
    ['driver', 'child']
    """

    x: Any = parameter(0.0, "m", "place of the seat ahead of the centre of gravity", signed=True)
    y: Any = parameter(0.0, "m", "place of the seat to the left of the centre of gravity", signed=True)
    mass: Any = MASS
    ks: Any = KS
    cs: Any = CS

    @classmethod
    @cache
    def quantities(cls) -> dict[str, Quantity]:
        """What each parameter is."""
        known = {field.name: field.metadata.get("quantity") for field in dataclasses.fields(cls)}
        return {name: quantity or PARAMETERS[f"seat_{name}"] for name, quantity in known.items()}


def field_of(parameter: str, name: str) -> str:
    """The field of a vehicle that holds a parameter of the seat of this name: ``seat_ks_driver``."""
    return signal(f"seat_{parameter}", name)


def floor_of(name: str) -> str:
    """The point of the body under the seat of this name."""
    return f"{name}_floor"


def checked_seats(given: Any, kind: str, linkage: Linkage) -> dict[str, Any]:
    """The seats' parameters by the fields that hold them.

    Raises
    ------
    TypeError, ValueError
        No mapping of names to seats, a name that is taken, or a place that the model's body does not have.
    """
    need = '{"driver": Seat(x=0.3, y=0.4)}'
    if not isinstance(given, Mapping) or not given:
        raise TypeError(f"seats must be a mapping such as {need}, got {briefly(given)}")
    if "" in linkage.points:
        raise ValueError(
            f"seats: the body of a {kind} moves as one point; take QuarterCarWithSeat, or a car with pitch"
        )
    fields, taken = {}, {*linkage.points, *linkage.seats}
    for name, seat in given.items():
        if not isinstance(name, str) or not name.isidentifier():
            raise TypeError(f"seats must have plain names such as 'driver', got {briefly(name)}")
        if not isinstance(seat, Seat):
            raise TypeError(f"seats: {name!r} must be a Seat, such as Seat(x=0.3, y=0.4), got {briefly(seat)}")
        for point in (name, floor_of(name)):
            if point in taken:
                raise ValueError(f"seats: {point!r} is a point of {kind} already; pass another name")
            taken.add(point)
        for of in Seat.quantities():
            rotation, word = ALONG.get(of, ("", ""))
            value = getattr(seat, of)
            if not rotation or rotation in linkage.rotations:
                fields[field_of(of, name)] = value
            elif not (isinstance(value, (int, float)) and value == 0):
                raise ValueError(
                    f"seats: {name!r} lies {briefly(value)} m {word}, where a {kind} has no body; pass {of}=0"
                )
    return fields


@cache
def with_seats(kind: Any, names: tuple[str, ...], fields: tuple[str, ...]) -> Any:
    """The same kind of vehicle with seats of these names, whose parameters are further fields of it."""

    def linkage(self: Any) -> Linkage:
        own: Linkage = kind.linkage(self)
        masses, points, seats = dict(own.masses), dict(own.points), dict(own.seats)
        for name in names:
            seat = {of: getattr(self, field_of(of, name), 0.0) for of in Seat.quantities()}
            (rider,) = coordinates(f"z_seat_{name}")
            floor = body_point(own, seat["x"], seat["y"])
            masses[rider], seats[name] = seat["mass"], Cushion(rider, floor, seat["ks"], seat["cs"])
            points[floor_of(name)] = floor
        return dataclasses.replace(own, masses=masses, points=points, seats=seats)

    def reduce(self: Any) -> tuple[Any, ...]:
        return again, (with_seats, as_kind(self, kind), names, fields)

    def declared(name: str, of: str) -> tuple[str, Any, Any]:
        quantity = Seat.quantities()[of]
        metadata = {"quantity": quantity._replace(meaning=f"{quantity.meaning}, {name}")}
        return field_of(of, name), Any, dataclasses.field(default=getattr(Seat, of), metadata=metadata)

    own = [declared(name, of) for name in names for of in Seat.quantities() if field_of(of, name) in fields]
    namespace = {
        "__doc__": kind.__doc__,
        "__module__": kind.__module__,
        "__reduce__": reduce,
        "linkage": linkage,
        "seats": (*kind.seats, *names),
        "plain": getattr(kind, "plain", kind),
    }
    return dataclasses.make_dataclass(
        kind.__name__, own, bases=(kind,), namespace=namespace, frozen=True, kw_only=True, eq=False
    )
