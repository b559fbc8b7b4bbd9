"""What every vehicle can do: check its parameters, assemble, and become a python-control system."""

from __future__ import annotations

import copy
import dataclasses
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING, Any, ClassVar, Literal, Self

import numpy as np
from numpy.typing import NDArray

from ..quantities import PARAMETERS, STEERED, Quantity, signal
from .contract import RoadVehicle
from .curves import Curve, check_place, rated
from .decoupled import OnStruts, halves, whole
from .linkage import Linkage, Wheel
from .parameters import Corners, DesignSpace, checked, computed, lazy
from .points import as_kind, checked_points, with_points
from .seats import Seat, checked_seats, with_seats
from .second_order import Layout
from .systems import control_system

if TYPE_CHECKING:
    import control
    import pandas as pd


@dataclass(frozen=True, kw_only=True, eq=False)
class Vehicle(RoadVehicle):
    """A linear vehicle on its wheels: frozen parameters, each a number, an array or a DataArray.

    A kind of vehicle states its parameters as fields, its ``wheels``, the fields that each corner may have for itself,
    and its `linkage`; everything else follows from these.
    """

    wheels: ClassVar[dict[str, Wheel]]
    per_corner: ClassVar[tuple[str, ...]] = ()
    seats: ClassVar[tuple[str, ...]] = ()

    def linkage(self) -> Linkage:
        """Masses, corners and links: the vehicle's physics as data."""
        raise NotImplementedError

    def __post_init__(self) -> None:
        for name, quantity in self.quantities().items():
            object.__setattr__(self, name, self._checked(name, quantity))
        self.design_space()

    @classmethod
    @cache
    def quantities(cls) -> dict[str, Quantity]:
        """What each parameter is: as its field says, or as the table of quantities knows its name."""
        known = {}
        for field in dataclasses.fields(cls):
            quantity = field.metadata.get("quantity", (PARAMETERS | STEERED).get(field.name))
            if quantity is None:
                raise TypeError(
                    f"{cls.__name__}.{field.name} is no known quantity; say what it is: "
                    f"{field.name}: Any = parameter(default, unit, meaning)"
                )
            known[field.name] = quantity._replace(name=field.name)
        return known

    @classmethod
    @cache
    def settings(cls) -> dict[str, tuple[str, tuple[str, ...]]]:
        """Field and wheels of every name that sets a parameter: ``ks`` everywhere, ``ks_front`` or ``ks_rl`` there."""
        places: dict[str, tuple[str, ...]] = {name: (name,) for name in cls.wheels if name}
        last = max(wheel.axle for wheel in cls.wheels.values())
        for place, part, value in (
            ("front", "axle", 0),
            *([("middle", "axle", 1)] if last == 2 else []),
            ("rear", "axle", last),
            ("right", "side", -1),
            ("left", "side", 1),
        ):
            places[place] = tuple(name for name, wheel in cls.wheels.items() if getattr(wheel, part) == value)
        known = {}
        for field in cls.quantities():
            known[field] = field, tuple(cls.wheels)
            if field in cls.per_corner:
                some = {place: at for place, at in places.items() if 0 < len(at) < len(cls.wheels)}
                known |= {signal(field, place): (field, at) for place, at in some.items()}
        return known

    def replaced(self, **values: Any) -> Self:
        """The same vehicle with other values by the names of `settings`; where two names set one wheel, the narrower.

        A number for a curve is its rate for small motion.

        Raises
        ------
        ValueError
            No such name, or one value for wheels that differ.

        Examples
        --------
        >>> from susp_ss import Corners, FullCar
        >>> list(FullCar(ks=Corners.axles(front=18e3, rear=21e3)).replaced(ks_rear=22e3).ks)
        [18000.0, 18000.0, 22000.0, 22000.0]
        """
        known, at_wheels = self.settings(), dict[str, dict[str, Any]]()
        for name in values:
            if name not in known:
                raise ValueError(f"{type(self).__name__} has no parameter {name!r}, available: {', '.join(known)}")
        for name in sorted(values, key=lambda name: -len(known[name][1])):
            field, wheels = known[name]
            own = dict(zip(self.wheels, self.at_wheels(field), strict=True))
            self._refuse_to_flatten(name, {wheel: own[wheel] for wheel in wheels})
            there = {wheel: rated(own[wheel], values[name]) for wheel in wheels}
            at_wheels.setdefault(field, own).update(there)
        named = [known[name][0] for name in values]
        everywhere = {
            name: rated(self.at_wheels(name)[0], value) for name, value in values.items() if named.count(name) == 1
        }
        return dataclasses.replace(self, **{field: joined(at) for field, at in at_wheels.items()} | everywhere)

    def _refuse_to_flatten(self, name: str, own: dict[str, Any]) -> None:
        first, *others = own.values()
        if all(_equal(other, first) for other in others):
            return
        field, _ = self.settings()[name]
        values = dict(zip(self.wheels, self.at_wheels(field), strict=True))
        narrower = [
            one
            for one, (of, at) in sorted(self.settings().items(), key=lambda item: -len(item[1][1]))
            if of == field and len(at) < len(own) and all(_equal(values[at[0]], values[w]) for w in at)
        ]
        said = ", ".join(f"{wheel} {value:g}" for wheel, value in own.items() if isinstance(value, float))
        raise ValueError(
            f"{name} would give {', '.join(own)} one value where {type(self).__name__} has several ({said} "
            f"{self.quantities()[field].unit}); set {', '.join(narrower)}"
        )

    def _checked(self, name: str, quantity: Quantity) -> Any:
        value = getattr(self, name)
        where = f"{type(self).__name__}({name}=...)"
        if value is None and getattr(type(self), name) is None:
            return None
        if isinstance(value, list) and name in self.per_corner:
            raise TypeError(
                f"{where} got a list of {len(value)}, which may be wheels or designs; pass {self._each()} for the "
                "wheels, or numpy.array([...]) for designs"
            )
        if isinstance(value, Corners) and name in self.per_corner and len(self.wheels) == 4:
            parts = zip(Corners.__dataclass_fields__, value, strict=True)
            return Corners(**{corner: _passed(part, f"{where} at corner {corner}", quantity) for corner, part in parts})
        if isinstance(value, tuple) and name in self.per_corner:
            if len(value) == len(self.axles) > 2:
                value = tuple(value[wheel.axle] for wheel in self.wheels.values())
            if len(self.wheels) == 4 or len(value) != len(self.wheels):
                raise ValueError(f"{where} got the tuple {value!r}; pass one value, or {self._each()}")
            ends = zip(self.wheels, value, strict=True)
            return tuple(_passed(part, f"{where} at end {end}", quantity) for end, part in ends)
        if isinstance(value, Corners):
            takes = self._each() if name in self.per_corner else "one value"
            raise TypeError(f"{where} takes {takes}, got Corners")
        return _passed(value, where, quantity)

    def _each(self) -> str:
        """How a parameter is given for each wheel."""
        if len(self.wheels) == 4:
            return "Corners(fr=, fl=, rr=, rl=)"
        return "(first, second)" if len(self.wheels) == 2 else f"(front, middle, rear) or ({', '.join(self.wheels)})"

    def values(self) -> list[Any]:
        """Every parameter value, those of the corners one by one."""
        values = [getattr(self, field.name) for field in dataclasses.fields(self)]
        parts = [part for x in values for part in (x if isinstance(x, (Corners, tuple)) else (x,))]
        return [part for part in parts if part is not None]

    def leaves(self) -> list[Any]:
        """Whatever spans designs: every parameter value, and what curves are made of."""
        return [leaf for x in self.values() for leaf in (x.leaves() if isinstance(x, Curve) else (x,))]

    @property
    def curved(self) -> bool:
        """Whether a curve stands for some spring or damper."""
        return any(isinstance(x, Curve) for x in self.values())

    def straightened(self, numbers: Mapping[str, Sequence[Any]]) -> Self:
        """The same vehicle with numbers at each wheel for fields that have curves, unchecked."""
        straight = copy.copy(self)
        for name, at in numbers.items():
            alike = all(number is at[0] for number in at)
            object.__setattr__(straight, name, at[0] if alike else joined(dict(zip(self.wheels, at, strict=True))))
        return straight

    def middling(self) -> Self:
        """The same with the rates that curves come to on a passable road, one number for curves that are alike."""
        return self.straightened(self._rates(lambda curve: curve.means(curve.middling).slope))

    def steepest(self) -> Self:
        """The same with the largest rates of curves."""
        return self.straightened(self._rates(lambda curve: curve.steepest))

    def _rates(self, rate: Callable[[Curve], Any]) -> dict[str, list[Any]]:
        known: list[tuple[Curve, Any]] = []

        def number(value: Any) -> Any:
            if not isinstance(value, Curve):
                return value
            found = next((number for curve, number in known if curve.alike(value)), None)
            if found is None:
                found = rate(value)
                known.append((value, found))
            return found

        fields = [name for name in ("ks", "cs") if any(isinstance(x, Curve) for x in self.at_wheels(name))]
        return {name: [number(value) for value in self.at_wheels(name)] for name in fields}

    def at_wheels(self, name: str) -> tuple[Any, ...]:
        """A parameter's value at each wheel, in the order of ``wheels``."""
        value = getattr(self, name)
        return tuple(value) if isinstance(value, (Corners, tuple)) else (value,) * len(self.wheels)

    @property
    def axles(self) -> tuple[Any, ...]:
        """How far each axle is behind the first, in m: ``a + b`` where there are two."""
        own: Any = self
        return (0.0, own.a + own.b) if hasattr(own, "a") else (0.0,)

    @property
    def track_width(self) -> Any:
        """Distance between left and right wheels in m, ``2 c``; 0 for a single-track vehicle."""
        return 2.0 * getattr(self, "c", 0.0)

    def design_space(self) -> DesignSpace:
        """The designs that this vehicle's parameters span."""
        return DesignSpace.over(self.leaves(), type(self).__name__)

    @property
    def lazy(self) -> bool:
        """Whether some parameter's values are computed later."""
        return any(map(lazy, self.leaves()))

    def flattened(self, space: DesignSpace) -> Self:
        """The same designs in one row: every parameter a number, or an array over the designs; lazy ones computed."""
        known = dataclasses.replace(self.mapped(computed)) if self.lazy else self
        return known.mapped(space.flat)

    def select(self, designs: slice | NDArray[np.int_]) -> Self:
        """Some of the designs of a flattened vehicle."""
        return self.mapped(lambda x: x[designs] if isinstance(x, np.ndarray) else x)

    def mapped(self, function: Any) -> Self:
        """The same vehicle with a function applied to every parameter value, or a curve's, unchecked."""

        def each(value: Any) -> Any:
            return value.mapped(function) if isinstance(value, Curve) else function(value)

        values: dict[str, Any] = {}
        for field in dataclasses.fields(self):
            value = getattr(self, field.name)
            if isinstance(value, Corners):
                values[field.name] = Corners(**{k: each(getattr(value, k)) for k in Corners.__dataclass_fields__})
            elif isinstance(value, tuple):
                values[field.name] = tuple(each(part) for part in value)
            else:
                values[field.name] = None if value is None else each(value)
        mapped = object.__new__(type(self))
        for name, value in values.items():
            object.__setattr__(mapped, name, value)
        return mapped

    def checked(self) -> Self:
        """The same vehicle, its parameters checked."""
        return dataclasses.replace(self)

    def with_points(self, points: Mapping[str, tuple[float, float]]) -> Vehicle:
        """The same vehicle, measured at further points of its body.

        Parameters
        ----------
        points : mapping of str to (x, y)
            In m ahead of and to the left of the centre of gravity.

        Raises
        ------
        TypeError, ValueError
            No such mapping, a name that is taken, or a place that the model's body does not have.

        Examples
        --------
        >>> from susp_ss import FullCar
        >>> FullCar().with_points({"driver": (0.3, 0.4)}).layout().outputs.places("bacc")
        ('cg', 'fr', 'fl', 'rr', 'rl', 'driver')
        """
        own: Any = type(self)
        vehicle: Vehicle = as_kind(self, with_points(own, checked_points(points, own.__name__, self.linkage())))
        return vehicle

    def with_seats(self, seats: Mapping[str, Seat]) -> Vehicle:
        """The same vehicle with people on seats: one more mass, spring and damper each, coupled to the body.

        The fields ``seat_x``, ``seat_y``, ``seat_mass``, ``seat_ks`` and ``seat_cs``, with the name of the seat behind
        them (``seat_ks_driver``), are parameters of the vehicle like any other: sweeps, sensitivities and
        `replaced` know them. ``bacc`` is measured on the seat, at the point of its name, and on the floor below it
        (``driver_floor``), ``seat_travel`` on dim "seat".

        Parameters
        ----------
        seats : mapping of str to Seat

        Raises
        ------
        TypeError, ValueError
            No such mapping, a name that is taken, or a place that the model's body does not have.

        Examples
        --------
        >>> from susp_ss import FullCar, Road, Seat, sensitivity
        >>> car = FullCar().with_seats({"driver": Seat(x=0.3, y=0.4, ks=30e3)})
        >>> car.seat_ks_driver
        30000.0
        >>> sensitivity(car, Road(), ["seat_ks_driver"], weighting="Wk").bacc.sel(point="driver").item() > 0.0
        True
        """
        own: Any = type(self)
        fields = checked_seats(seats, own.__name__, self.linkage())
        vehicle: Vehicle = with_seats(own, tuple(seats), tuple(fields))(**vars(self), **fields)
        return vehicle

    def assemble(self) -> Any:
        """The model, stacked over the designs of a flattened vehicle: second-order matrices of its linkage."""
        return self._linear().assemble()

    def _linear(self) -> Linkage:
        """The linkage where numbers are needed, or say that there are curves."""
        curves = dict.fromkeys(x.field for x in self.values() if isinstance(x, Curve))
        if curves:
            raise ValueError(
                f"{type(self).__name__} has a curve for {', '.join(curves)} where a number is needed; pass "
                "ss.linearised(vehicle, road), the linear vehicle that comes closest to it on a road"
            )
        return self.linkage()

    def damping(self) -> NDArray[np.float64]:
        """Damping rate at every corner of a flattened vehicle, (corners,) or (designs, corners)."""
        return np.stack(np.broadcast_arrays(*(corner.cs for corner in self._linear().corners.values()))).T

    def static_loads(self) -> NDArray[np.float64]:
        """What every tyre of a flattened vehicle carries at rest in N, (corners,) or (designs, corners)."""
        return self._linear().static_loads()

    def halves(self) -> tuple[OnStruts, ...]:
        """The mean of left and right, and half their difference, of a flattened vehicle.

        There are none where the sides differ, and none of a kind of vehicle that has matrices of its own: its linkage
        does not answer for them.
        """
        return halves(self._linear(), self.wheels) if type(self).assemble is Vehicle.assemble else ()

    def whole(self) -> OnStruts | None:
        """All struts on the rigid body of a flattened vehicle; None of one that is more, or has matrices of its own."""
        return whole(self._linear()) if type(self).assemble is Vehicle.assemble else None

    @classmethod
    @cache
    def layout(cls) -> Layout:
        """The names that all of its kind share: coordinates, inputs, corners and outputs."""
        return cls().linkage().layout

    def single(self, what: str) -> Any:
        """The model of the one design, for a method that takes no more than one."""
        if any(not isinstance(leaf, float) for leaf in self.leaves()):
            raise ValueError(f"{type(self).__name__}.{what} needs one number for every parameter, got arrays")
        return self.assemble()

    def state_space(
        self, input: Literal["displacement", "velocity"] = "displacement", actuators: bool = False
    ) -> control.StateSpace:
        """Return the vehicle as a python-control system with named signals.

        Parameters
        ----------
        input : {"displacement", "velocity"}
            What the road gives: heights ``z_r...`` (m), with states ``(q, q')``; or their rates ``dz_r...`` (m/s),
            with states ``p = q - G z_r`` relative to the road (names ``p_...``), velocities, and for the full
            car the ``warp`` of the road, the one direction in which a rigid body cannot follow it. The warp is an
            integrator that no actuator reaches: leave it out (it is the last state) for H2 norms and LQR.
        actuators : bool
            Add force inputs ``u...`` (N) between wheel and body, positive pushing the body up, and the suspension
            velocities ``sws_rate...`` (m/s) as outputs.

        Returns
        -------
        control.StateSpace
            Outputs ``bacc...`` (m/s^2), ``pitch_acc``, ``roll_acc`` (rad/s^2), ``sws...`` (m), ``dtl...`` (N).

        Raises
        ------
        ValueError
            A parameter is an array, ``input`` is unknown, or an output needs the derivative of the input.

        Examples
        --------
        >>> import control as ct
        >>> from susp_ss import QuarterCar
        >>> system = QuarterCar().state_space()
        >>> system.nstates, system.input_labels, system.output_labels
        (4, ['z_r'], ['bacc', 'sws', 'dtl'])
        >>> bool(abs(ct.dcgain(system["sws", "z_r"])) < 1e-12)
        True
        """
        return control_system(self.single("state_space()"), type(self).__name__, input, actuators)

    def natural_frequencies(self) -> NDArray[np.float64]:
        """Undamped natural frequencies in Hz, ascending, (n,) or (designs..., n).

        Roots of ``det(K - (2 pi f)^2 M) = 0``.

        Examples
        --------
        >>> from susp_ss import QuarterCar
        >>> QuarterCar().natural_frequencies().round(2)
        array([ 1.16, 10.84])
        """
        space = self.design_space()
        model = self.flattened(space).assemble()
        root = np.sqrt(model.m)
        normalised = model.K / (root[..., :, None] * root[..., None, :])
        eigenvalues = np.linalg.eigvalsh(normalised) if model.symmetric else _ascending(normalised)
        frequencies = np.sqrt(np.maximum(eigenvalues, 0.0)) / (2.0 * np.pi)
        return np.broadcast_to(frequencies, (space.size, root.shape[-1])).reshape(*space.shape, -1)

    def modes(self) -> pd.DataFrame:
        """Damped modes, slowest first.

        Returns
        -------
        pandas.DataFrame
            ``frequency`` (Hz, modulus of the eigenvalue over 2 pi), ``damping_ratio``, and ``shape``: a pandas
            Series of complex amplitudes by coordinate, the largest scaled to 1. An overdamped mode splits into
            two rows of damping ratio 1.

        Examples
        --------
        >>> from susp_ss import FullCar
        >>> modes = FullCar().modes()
        >>> modes["frequency"].round(2).tolist()
        [1.12, 1.69, 2.12, 10.29, 10.5, 10.69, 10.84]
        >>> modes["shape"][0].abs().idxmax()
        'z_b'
        """
        table: pd.DataFrame = self.single("modes()").modes().table()
        return table


def _passed(value: Any, where: str, quantity: Quantity) -> Any:
    """A checked number, array, DataArray or curve."""
    return check_place(value, where, quantity.name) if isinstance(value, Curve) else checked(value, where, quantity)


def _equal(one: Any, other: Any) -> bool:
    return one.alike(other) if isinstance(one, Curve) else one is other or np.array_equal(one, other)


def joined(at_wheels: dict[str, Any]) -> Any:
    """A value for each wheel as a field holds them."""
    if len(at_wheels) == 1:
        return next(iter(at_wheels.values()))
    return Corners(**at_wheels) if len(at_wheels) == 4 else tuple(at_wheels.values())


def _ascending(matrices: NDArray) -> NDArray[np.float64]:
    """Real parts of the eigenvalues of matrices that need not be symmetric, ascending."""
    return np.sort(np.linalg.eigvals(matrices).real, axis=-1)
