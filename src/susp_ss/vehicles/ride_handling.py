"""Ride and handling in one: the full car, and how it slides, turns, drives and brakes about straight running.

All physics stands in two tables: `linkage`, the full car's links between body, wheels and road, and `velocities`, one
row for everything that has inertia and for everything that a tyre or a shaft acts on. Masses and forces go by the same
rows, so that what a force does to a motion, that motion does to the force's slip.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING, Any, Literal, Self

import numpy as np
from numpy.typing import NDArray

from ..quantities import HANDLING, ROAD, briefly
from .full import FullCar
from .handling_assembly import Velocities, assembled
from .handling_model import CONTROLS, HandlingModel
from .linkage import GRAVITY, Linkage, Output, coordinates
from .parameters import checked
from .seats import Seat
from .second_order import Layout
from .systems import control_system
from .vehicle import Vehicle

if TYPE_CHECKING:
    import control
    import pandas as pd
    import xarray as xr

LACKING = (
    "(izz=...) must exceed {need} kg m^2, what the wheels have about the body's centre of gravity and ixz asks for, "
    "got {izz}"
)


@dataclass(frozen=True, kw_only=True, eq=False)
class RideHandlingCar(FullCar):
    """The full car on tyres that also slide and roll: 14 degrees of freedom, or 16 with compliant steering.

    To the seven of `FullCar` come the body's forward and lateral speed, its yaw rate and the spin of four wheels
    (Shim and Ghike 2007), linear about straight running at a constant speed. A tyre's lateral force is ``C alpha``
    with ``alpha = delta - y_c' / U``, or follows it over the relaxation length: ``(sigma / U) F' + F = C alpha``. An
    axle rolls about its roll centre: over ``phi_u``, the contact of its wheels shifts by ``h_i phi_u`` and their hubs
    by ``(h_i - R) phi_u``; the body rolls about the line through both roll centres. What the tyres do to roll, rolling
    does to the tyres, so that an uneven road moves the car sideways.

    Parameters
    ----------
    izz, ixz : float, array or DataArray
        Yaw inertia of the whole car, > 0, and the body's product of inertia of roll and yaw, in kg m^2.
    height : float, array or DataArray
        Centre of gravity of the body above the ground in m, >= 0.
    roll_centre_front, roll_centre_rear : float, array or DataArray
        Above the ground, in m.
    radius : float, array or DataArray
        Of the wheels in m, > 0; their hubs, and the unsprung masses, are as high.
    cornering : float, array, DataArray or Corners
        Cornering stiffness in N/rad per wheel, >= 0.
    relaxation : float, array, DataArray or Corners
        Relaxation length of the lateral force in m, >= 0.
    slip : float, array, DataArray or Corners
        Longitudinal force in N per unit of slip, > 0.
    wheel_inertia : float, array, DataArray or Corners
        Of a wheel and what spins with it, in kg m^2, > 0.
    steering : float, array or DataArray, optional
        Stiffness in N m/rad, > 0, between the steering wheel and each front wheel, which then turns by itself; without
        it front wheels turn as they are told.
    steering_damping, steering_inertia, trail : float, array or DataArray
        Of a front wheel about its steering axis, in N m s/rad and kg m^2, and how far behind that axis the lateral
        force acts, in m; without ``steering`` of no effect.
    speed : float, array or DataArray
        At which the car moves, in m/s, > 0. On a `Road`, the road's speed takes its place.

    Notes
    -----
    Heave, pitch, hops and their response to a road that is alike on the left and on the right are exactly those of
    `FullCar`: wheels move straight up and down in side view, so that unevenness reaches neither speed nor spin, and a
    drive or brake torque pitches the body as the height of the car's centre of gravity asks. Left out are what grows
    with the square of the motion (jacking), the wheels' gyroscopic moments, the inclination of the roll axis in the
    body's inertia, and camber.

    Examples
    --------
    >>> from susp_ss import Corners, RideHandlingCar
    >>> car = RideHandlingCar(cornering=Corners.axles(front=45e3, rear=60e3))
    >>> turn = car.steady_state(speed=20.0, delta_f=0.02)
    >>> round(float(turn.ay), 2), round(float(turn.dtl_fr), 0)
    (1.84, 490.0)
    """

    izz: Any = 1181.08
    ixz: Any = 0.0
    height: Any = 0.482
    roll_centre_front: Any = 0.10
    roll_centre_rear: Any = 0.10
    radius: Any = 0.31
    cornering: Any = 45e3
    relaxation: Any = 0.0
    slip: Any = 50e3
    wheel_inertia: Any = 1.0
    steering: Any = None
    steering_damping: Any = 50.0
    steering_inertia: Any = 0.8
    trail: Any = 0.03
    speed: Any = dataclasses.field(default=20.0, metadata={"quantity": ROAD["speed"]})

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.curved:
            raise TypeError(
                f"{type(self).__name__} takes numbers for ks and cs, got a curve; pass those that ss.linearised finds "
                "for a FullCar"
            )

    per_corner = (*FullCar.per_corner, "cornering", "relaxation", "slip", "wheel_inertia")

    def linkage(self) -> Linkage:
        own = super().linkage()
        places = {"load_transfer": ("front", "rear"), "slip_angle": tuple(self.wheels)}
        more = [Output(quantity, place) for name, quantity in HANDLING.items() for place in places.get(name, ("",))]
        return dataclasses.replace(own, more=more)

    def with_seats(self, seats: Mapping[str, Seat]) -> Vehicle:
        """Refused: where a rider's mass lies above the roll axis, no `Seat` says.

        Raises
        ------
        TypeError
            Always.
        """
        raise TypeError(f"{type(self).__name__} takes no seats; FullCar does")

    def velocities(self) -> Velocities:
        """One row for everything that has inertia, and for everything that forces act on."""
        *hubs, heave, pitch, roll = coordinates(*(f"z_u_{name}" for name in self.wheels), "z_b", "theta", "phi")
        steer = coordinates("steer_fr", "steer_fl") if self.steering is not None else ()
        lateral, yaw, forward, *spins = coordinates("y", "psi", "x", *(f"spin_{name}" for name in self.wheels))
        R, c, (h_front, h_rear) = self.radius, self.c, self.roll_centres
        rolls = [(0.5 / c) * (hubs[1] - hubs[0]), (0.5 / c) * (hubs[3] - hubs[2])]

        inertias = [(heave, self.mb), (pitch, self.iyy), (roll, self.ixx), (forward, self.mb)]
        body = lateral - self.arm * roll
        inertias += [(body, self.mb), (yaw, self.body_izz)]
        # -ixz phi' r, as a sum of squares.
        inertias += [(roll + yaw, -0.5 * self.ixz), (roll - yaw, 0.5 * self.ixz)]
        contacts, slips = [], []
        places = [(self.a, -c, h_front), (self.a, c, h_front), (-self.b, -c, h_rear), (-self.b, c, h_rear)]
        masses, spinning = self.at_wheels("mu"), self.at_wheels("wheel_inertia")
        for i, (x, y, h) in enumerate(places):
            along, across, axle = forward - y * yaw, lateral + x * yaw, rolls[i // 2]
            inertias += [(hubs[i], masses[i]), (along, masses[i]), (across + (h - R) * axle, masses[i])]
            inertias += [(spins[i], spinning[i])]
            contacts.append(across + h * axle)
            slips.append(along - R * spins[i])
        for i, turn in enumerate(steer):
            inertias.append((yaw + turn, self.steering_inertia))
            contacts[i] = contacts[i] - self.trail * turn
        return Velocities(
            positions=(*hubs, heave, pitch, roll, *steer),
            handling=(lateral, yaw, forward, *spins),
            inertias=inertias,
            contacts=contacts,
            slips=slips,
            shafts=[spin - (self.centre / R) * pitch for spin in spins],
            body=body,
            steer=steer,
        )

    @property
    def roll_centres(self) -> tuple[Any, Any]:
        """Heights of the front and the rear roll centre in m."""
        return self.roll_centre_front, self.roll_centre_rear

    @property
    def arm(self) -> Any:
        """Height of the body's centre of gravity above the roll axis in m."""
        front, rear = self.roll_centres
        return self.height - (self.b * front + self.a * rear) / (self.a + self.b)

    @property
    def mass(self) -> Any:
        """Of the whole car in kg."""
        return self.mb + sum(self.at_wheels("mu"))

    @property
    def weight(self) -> Any:
        """Of the whole car in N."""
        return GRAVITY * self.mass

    @property
    def centre(self) -> Any:
        """Height of the whole car's centre of gravity in m."""
        return (self.mb * self.height + sum(self.at_wheels("mu")) * self.radius) / self.mass

    @property
    def body_izz(self) -> Any:
        """Yaw inertia of the body alone in kg m^2."""
        fr, fl, rr, rl = self.at_wheels("mu")
        wheels = (fr + fl) * (self.a**2 + self.c**2) + (rr + rl) * (self.b**2 + self.c**2)
        return self.izz - wheels - (2.0 * self.steering_inertia if self.steering is not None else 0.0)

    @property
    def least_izz(self) -> Any:
        """What the yaw inertia of the whole car must exceed in kg m^2."""
        return self.izz - self.body_izz + self.ixz**2 / self.ixx

    @property
    def lean(self) -> Any:
        """What gravity adds to roll per mass of the body and angle, ``g h``, in m^2/s^2."""
        return GRAVITY * self.arm

    def moving(self, speed: Any) -> Self:
        """The same car at another speed, in m/s."""
        moved = self.mapped(lambda x: x)
        object.__setattr__(moved, "speed", checked(speed, f"{type(self).__name__}(speed=...)", ROAD["speed"]))
        return moved

    def assemble(self) -> HandlingModel:
        """What all motions of a flattened car do to one another at its speed.

        Raises
        ------
        ValueError
            A yaw inertia that the wheels alone exceed, or a product of inertia that no body has.
        """
        least = self.least_izz
        lacking = np.atleast_1d(self.izz <= least)
        if lacking.any():
            which = np.argmax(lacking)
            izz, need = (f"{np.broadcast_to(x, lacking.shape)[which]:.4g}" for x in (self.izz, least))
            raise ValueError(f"{type(self).__name__}{LACKING.format(need=need, izz=izz)}")
        return assembled(self)

    @classmethod
    @cache
    def layout(cls) -> Layout:
        """The names that all of its kind share."""
        return dataclasses.replace(cls().linkage().layout, controls=CONTROLS)

    def understeer_gradient(self) -> Any:
        """Steering angle that lateral acceleration asks for beyond the wheelbase over the radius, in rad per m/s^2.

        ``delta = L / rho + K a_y`` with ``K = m_f / C_f - m_r / C_r``, the masses that the axles bear and the cornering
        stiffness of both wheels of each; of front wheels that compliant steering lets turn back, ``C / (1 + trail C /
        steering)``. It holds for the car as a whole, with roll and all, as it settles.

        Returns
        -------
        float or DataArray
            Positive where the car understeers, on (sweep...).

        Examples
        --------
        >>> from susp_ss import Corners, RideHandlingCar
        >>> car = RideHandlingCar(cornering=Corners.axles(front=45e3, rear=60e3))
        >>> round(car.understeer_gradient() * 9.81 * 57.3, 2)  # degrees per g
        2.66
        """
        return self._over_designs(lambda car: car.gradient())

    def characteristic_speed(self) -> Any:
        """Speed in m/s at which an understeering car asks for twice the angle: ``sqrt(L / K)``; infinite if K <= 0.

        Examples
        --------
        >>> from susp_ss import Corners, RideHandlingCar
        >>> round(RideHandlingCar(cornering=Corners.axles(front=45e3, rear=60e3)).characteristic_speed(), 1)
        22.8
        """
        return self._over_designs(lambda car: _speed(car.a + car.b, car.gradient()))

    def critical_speed(self) -> Any:
        """Speed in m/s from which on an oversteering car is unstable: ``sqrt(-L / K)``; infinite where K >= 0.

        Examples
        --------
        >>> from susp_ss import Corners, RideHandlingCar
        >>> round(RideHandlingCar(cornering=Corners.axles(front=60e3, rear=35e3)).critical_speed(), 1)
        46.2
        """
        return self._over_designs(lambda car: car.critical())

    def rollover_threshold(self) -> Any:
        """Steady lateral acceleration in m/s^2 at which the wheels inside the turn carry nothing.

        ``m g c = (m H + m_b g h phi_1) a_y``, with ``phi_1`` the roll angle per lateral acceleration and H the height
        of the whole car's centre of gravity: what rigid springs would bear, ``g c / H``, less what the body's lean
        moves its weight outwards. It is linear: tyres slide before that, or an axle lifts a wheel first.

        Examples
        --------
        >>> from susp_ss import RideHandlingCar
        >>> car = RideHandlingCar()
        >>> 0.85 * 9.81 * car.c / car.centre < car.rollover_threshold() < 9.81 * car.c / car.centre
        True
        """
        return self._over_designs(lambda car: 1.0 / car.cornered("load_transfer_ratio"))

    def roll_gradient(self) -> Any:
        """Roll angle per steady lateral acceleration, in rad per m/s^2.

        Examples
        --------
        >>> from susp_ss import RideHandlingCar
        >>> round(RideHandlingCar().roll_gradient() * 9.81 * 57.3, 1)  # degrees per g
        9.2
        """
        return self._over_designs(lambda car: car.cornered("roll"))

    def natural_frequencies(self) -> NDArray[np.float64]:
        """Undamped natural frequencies in Hz, ascending, (n,) or (designs..., n), of the car without tyre forces.

        Roots of ``det(K - (2 pi f)^2 M) = 0`` other than zero; springs, gravity and all masses count.
        """
        space = self.design_space()
        model = self.flattened(space).assemble()
        n = model.stiffness.shape[-1]
        squares = np.sort(np.linalg.eigvals(np.linalg.inv(model.mass)[:, :n, :n] @ model.stiffness).real, axis=-1)
        frequencies = np.sqrt(np.maximum(squares, 0.0)) / (2.0 * np.pi)
        return np.broadcast_to(frequencies, (space.size, n)).reshape(*space.shape, n)

    def critical(self) -> Any:
        """`critical_speed` of a flattened car."""
        return _speed(self.a + self.b, -self.gradient())

    def gradient(self) -> Any:
        """`understeer_gradient` of a flattened car."""
        fr, fl, rr, rl = self.at_wheels("cornering")
        if self.steering is not None:
            fr, fl = (C / (1.0 + self.trail * C / self.steering) for C in (fr, fl))
        mfr, mfl, mrr, mrl = self.at_wheels("mu")
        front, rear = (self.mb * x / (self.a + self.b) for x in (self.b, self.a))
        with np.errstate(divide="ignore", invalid="ignore"):
            return np.divide(front + mfr + mfl, fr + fl) - np.divide(rear + mrr + mrl, rr + rl)

    def cornered(self, output: str) -> Any:
        """An output of a flattened car per lateral acceleration, as it turns steadily: at any speed the same."""
        model = self.moving(np.minimum(self.speed, 0.5 * self.critical())).assemble()
        if not np.all(np.linalg.eigvalsh(model.stiffness)[..., 0] > 0.0):
            raise ValueError(
                f"{type(self).__name__} has springs that do not hold the body up, so that it turns nowhere steadily; "
                "pass stiffer ones (ks, arb_front, arb_rear) or a lower height"
            )
        return model.cornered(output)

    def _over_designs(self, function: Callable[[Self], Any]) -> Any:
        space, flat = self.design_space(), self.flattened(self.design_space())
        fr, fl, rr, rl = flat.at_wheels("cornering")
        if not np.all((np.asarray(fr + fl) > 0.0) & (np.asarray(rr + rl) > 0.0)):
            raise ValueError(
                f"{type(self).__name__}(cornering=...) must be > 0 N/rad at both axles for a car that turns steadily"
            )
        values = np.broadcast_to(function(flat), space.size)
        return space.unflatten(values) if space.dims else float(values[0])

    def state_space(
        self,
        input: Literal["displacement", "velocity"] = "displacement",
        actuators: bool = False,
        speed: float | None = None,
    ) -> control.StateSpace:
        """Return the car at a speed as a python-control system with named signals.

        Parameters
        ----------
        input : {"displacement", "velocity"}
            What the road gives: heights ``z_r_fr ...`` (m), or their rates ``dz_r_fr ...`` (m/s). By rates, positions
            are relative to the road (``p_...``), and two integrators stand behind them: the ``warp`` of the road, and
            the angle ``bank`` to which a road that stands still would bring the body.
        actuators : bool
            As in `FullCar`.
        speed : float, optional
            In m/s; the car's own where it is left out.

        Returns
        -------
        control.StateSpace
            Further inputs ``delta_f``, ``delta_r`` (rad), ``drive_fr ...`` (N m); further outputs ``ay`` (m/s^2),
            ``yaw_rate`` (rad/s), ``sideslip``, ``roll`` (rad), ``load_transfer_front ...`` (N),
            ``load_transfer_ratio`` and ``slip_angle_fr ...`` (rad). States are positions (m, rad), the rates of all
            motions (``dy`` and ``dx`` the lateral and the forward speed, ``dpsi`` the yaw rate) and the slip angles
            that lag behind. The forward speed and the spins together do not die out: a car coasts on.

        Raises
        ------
        ValueError
            A parameter is an array, ``input`` is unknown, or an output needs the derivative of the input.

        Examples
        --------
        >>> from susp_ss import RideHandlingCar
        >>> system = RideHandlingCar().state_space(speed=20.0)
        >>> system.nstates, system.input_labels[4:6]
        (21, ['delta_f', 'delta_r'])
        """
        model = self._at(speed).single("state_space()").whole()
        return control_system(model, type(self).__name__, input, actuators)

    def modes(self, speed: float | None = None) -> pd.DataFrame:
        """Damped modes at a speed, slowest first, by name.

        Parameters
        ----------
        speed : float, optional
            In m/s; the car's own where it is left out.

        Returns
        -------
        pandas.DataFrame
            As `Vehicle.modes` returns it, and ``name``: the motion that holds the most of a mode's energy, heave,
            pitch, roll, front hop, rear hop, spin, sway, yaw (or both, where they swing together), and steer or
            relaxation where there are such.

        Examples
        --------
        >>> from susp_ss import RideHandlingCar
        >>> modes = RideHandlingCar().modes(speed=20.0)
        >>> sorted(set(modes["name"]))
        ['front hop', 'heave', 'pitch', 'rear hop', 'roll', 'spin', 'sway and yaw']
        """
        return self._at(speed).single("modes()").modes().table()

    def steady_state(self, speed: Any = None, delta_f: float = 0.0, delta_r: float = 0.0, **drive: float) -> xr.Dataset:
        """What a car that turns steadily settles at, on a level road.

        Parameters
        ----------
        speed : float, array or DataArray, optional
            In m/s; the car's own where it is left out.
        delta_f, delta_r : float
            Steering angles of the front and the rear wheels in rad, positive to the left.
        **drive : float
            ``drive_fr ...``: torque at a wheel in N m, under which the car gains speed steadily.

        Returns
        -------
        xarray.Dataset
            Every output of `state_space` by its name, on (sweep...).

        Raises
        ------
        ValueError
            The car is unstable at that speed; it says from which speed on.

        Examples
        --------
        >>> from susp_ss import RideHandlingCar
        >>> turn = RideHandlingCar().steady_state(speed=20.0, delta_f=0.01)
        >>> bool(abs(turn.ay - 20.0 * turn.yaw_rate) < 1e-12)
        True
        """
        car = self._at(speed)
        given = {"delta_f": delta_f, "delta_r": delta_r} | drive
        for name, value in given.items():
            if name not in CONTROLS:
                raise ValueError(f"{type(self).__name__} has no input named {name!r}, available: {', '.join(CONTROLS)}")
            if isinstance(value, bool) or not isinstance(value, (int, float, np.number)) or not np.isfinite(value):
                raise TypeError(f"{name} must be a number, got {briefly(value)}")
        space = car.design_space()
        model = car.flattened(space).assemble()
        refusal = model.refusal()
        if refusal:
            raise ValueError(f"{type(self).__name__} {refusal}")
        values = model.settled(given)
        table = model.layout.outputs
        import xarray as xr

        return xr.Dataset({name: space.unflatten(values[:, i]) for i, name in enumerate(table.names[table.public])})

    def _at(self, speed: Any) -> Self:
        return self if speed is None else self.moving(speed)


def _speed(wheelbase: Any, gradient: Any) -> Any:
    """``sqrt(L / K)`` where K is positive."""
    understeers = np.asarray(gradient) > 0.0
    return np.where(understeers, np.sqrt(wheelbase / np.where(understeers, gradient, 1.0)), np.inf)
