"""Any linear vehicle: a python-control system whose inputs are the heights of the road under its wheels, or their rates."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from ..quantities import DIMS, SIGNALS, Quantity, briefly, signal
from .contract import RoadVehicle
from .linkage import Wheel
from .parameters import DesignSpace
from .parting import Growing, Parted, parted
from .second_order import CARRIED, Layout, Outputs, Row, beyond_rounding
from .vehicle import Vehicle

if TYPE_CHECKING:
    import control

Array = NDArray[np.float64]

HEIGHT, RATE = "z_r", "dz_r"

# A state of which no larger share than this is left out with what no output sees has a covariance.
LEFT_OUT = 1e-6

KNOWN_WHEELS = {
    frozenset({""}): {"": Wheel(0, 0)},
    frozenset({"fr", "fl", "rr", "rl"}): {
        "fr": Wheel(0, -1),
        "fl": Wheel(0, 1),
        "rr": Wheel(1, -1),
        "rl": Wheel(1, 1),
    },
    frozenset({"f", "r"}): {"f": Wheel(0, 0), "r": Wheel(1, 0)},
    frozenset({"r", "l"}): {"r": Wheel(0, -1), "l": Wheel(0, 1)},
}
"""Where wheels of these names run, as on the package's own vehicles."""


@dataclass(frozen=True)
class LinearLayout(Layout):
    """Names of a system whose states need be no coordinates and their rates."""

    names: tuple[str, ...] = ()

    @property
    def relative_states(self) -> tuple[str, ...]:
        return self.names


@dataclass(frozen=True, eq=False)
class LinearModel:
    """`Model` of any state space, as arrays of shape (N, rows, columns): what dies out and what integrates."""

    layout: LinearLayout
    A: Array
    B: Array
    C: Array
    integrators: Array
    on_integrators: Array
    on_road_velocity: Array
    states: Array
    damping: Array

    second_order: ClassVar[bool] = False

    def select(self, designs: slice | NDArray[np.int_]) -> LinearModel:
        """Some of the designs."""
        arrays = ("A", "B", "C", "integrators", "on_integrators", "on_road_velocity", "states")
        return replace(self, **{name: getattr(self, name)[designs] for name in arrays})

    @cached_property
    def modes(self) -> tuple[NDArray, NDArray]:
        """Eigenvalues (N, n) and eigenvectors (N, n, n) of what dies out."""
        rates, vectors = np.linalg.eig(self.A)
        return rates, vectors

    def velocity_form(self) -> tuple[Array, Array, Array, Array]:
        """A, B, Y and D over x, and what integrates behind it."""
        k = self.integrators.shape[-2]
        A = np.pad(self.A, [(0, 0), (0, k), (0, k)])
        B = np.concatenate([self.B, self.integrators], axis=-2)
        return A, B, np.concatenate([self.C, self.on_integrators], axis=-1), self.on_road_velocity

    def displacement_form(self) -> tuple[Array, Array, Array, Array, Array]:
        """``x' = A x + B z_r``, ``y = Y x + D z_r + D1 z_r'``, x being the own one less ``B z_r``."""
        D = self.C @ self.B + self.on_integrators @ self.integrators
        return self.A, self.A @ self.B, self.C, D, self.on_road_velocity

    def relative_transfer(self, omega: Array) -> Array:
        """``C (j w I - A)^-1 B + D`` at ``omega`` (F,), (N, F, outputs, inputs)."""
        s = 1j * np.asarray(omega, dtype=float)[:, None, None]
        x = np.linalg.solve(s * np.eye(self.A.shape[-1]) - self.A[:, None], self.B[:, None].astype(complex))
        return np.asarray(self.C[:, None] @ x + self.on_road_velocity[:, None])

    def transfer(self, omega: Array) -> Array:
        """The same with what integrates."""
        s = 1j * np.asarray(omega, dtype=float)[:, None, None]
        return np.asarray(self.relative_transfer(omega) + (self.on_integrators @ self.integrators)[:, None] / s)

    def in_states(self, X: Array) -> Array:
        """A covariance in the system's own states, as far as they have one."""
        return np.asarray(self.states @ X @ self.states.mT)

    def refusal(self) -> str:
        """Nothing: what does not die out has been refused before there was a model."""
        return ""

    def drifting(self, which: NDArray[np.bool_]) -> str:
        """The outputs that feel what drifts."""
        felt = np.any(self.on_integrators[..., which] != 0.0, axis=(0, 2))
        names = [name for name, feels in zip(self.layout.outputs.names, felt, strict=True) if feels]
        one = len(names) == 1
        return (
            f"{', '.join(names)} {'feels' if one else 'feel'} the height of the road, which has no finite variance, so "
            f"that {'it has' if one else 'they have'} none either"
        )


class LinearVehicle(RoadVehicle):
    """A linear vehicle of any making, from its state space: a control system, an identified or a linearised model.

    ``x' = A x + B u``, ``y = C x + D u``, where ``u`` are the heights of the road under the wheels, or their rates, and
    other inputs, which stay zero. The covariance route solves ``A X + X A^T + Q = 0`` with the wheelbase delay in closed
    form. What no output sees (a yaw angle, the integrator of a disturbance) is left out. Driven by heights, it goes by
    ``p = x + A^-1 B z_r``, relative to the road; an output that then still feels the height itself, as position
    feedback may make it do, has a finite variance only where the heights of the wheels do not drift apart.

    Parameters
    ----------
    system : control.StateSpace, or sequence of them
        In continuous time. Inputs ``z_r`` or ``z_r_<wheel>`` (m), or all of them ``dz_r...`` (m/s). Outputs with the
        names of the package's (``bacc_fr``, ``sws_fr``, ``dtl``, ``roll_acc``) are taken for these, with their units
        and dims; others become variables of their own name. Several systems with the same names are the designs
        of a sweep, on dim ``design``.
    wheels : mapping of str to (axle, side), optional
        Axle 0 in front, 1 behind; side -1 right, 1 left, 0 on the centre line. Not needed for the names of the
        package's own vehicles (``fr, fl, rr, rl``; ``f, r``; ``r, l``; a single wheel).
    wheelbase, track_width : float
        In m. 0: both axles meet the road at once; no isotropic tracks.
    like : vehicle, optional
        Whose wheels, wheelbase and track width these are, and whose outputs and dampers, by their names. A system that
        lost all names, as by `control.feedback`, is taken for the inputs and outputs of its ``state_space()``, in their
        order; which of the forms it was is told by the direct feedthrough.

    Raises
    ------
    TypeError, ValueError
        No state space, discrete time, no or unknown wheels, an unstable mode that an output sees.

    Notes
    -----
    ``damper_power`` needs ``like`` and the suspension velocities ``dsws...`` of all corners, and is what the dampers
    of ``like`` dissipate.

    Examples
    --------
    A skyhook of 2 kN s/m on a quarter car, whose damper is halved:

    >>> import control as ct
    >>> import susp_ss as ss
    >>> car = ss.QuarterCar(cs=750.0)
    >>> plant = car.state_space(input="velocity", actuators=True)
    >>> body = ct.tf2ss([-2000.0], [1.0, 0.1], inputs="bacc", outputs="u")
    >>> closed = ct.interconnect([plant, body], inputs="dz_r", outputs=plant.output_labels)
    >>> active = ss.LinearVehicle(closed, like=car)
    >>> bool(ss.ride_metrics(active, ss.Road()).bacc < 0.7 * ss.ride_metrics(ss.QuarterCar(), ss.Road()).bacc)
    True
    """

    def __init__(
        self,
        system: control.StateSpace | Sequence[control.StateSpace],
        wheels: Mapping[str, tuple[int, int]] | None = None,
        wheelbase: float = 0.0,
        track_width: float = 0.0,
        like: RoadVehicle | None = None,
    ):
        import control

        several = isinstance(system, Sequence) and not isinstance(system, control.StateSpace)
        systems = list(system) if several else [system]  # type: ignore[call-overload]
        if not systems:
            raise ValueError("LinearVehicle(system=...) must hold at least one control.StateSpace, got none")
        for one in systems:
            _check_system(one)
        if like is not None:
            if not isinstance(like, RoadVehicle):
                raise TypeError(f"LinearVehicle(like=...) must be a vehicle such as FullCar(), got {briefly(like)}")
            if wheels is not None or wheelbase or track_width:
                raise ValueError(
                    "LinearVehicle(like=...) has wheels, wheelbase and track_width of its own; pass like or these"
                )
            systems = [_named_like(one, like) for one in systems]
            wheels, wheelbase, track_width = like.wheels, like.wheelbase, like.track_width
        names = [(one.input_labels, one.output_labels, one.state_labels) for one in systems]
        if any(one != names[0] for one in names[1:]):
            raise ValueError("LinearVehicle(system=...) must be systems with the same inputs, outputs and states")
        inputs, outputs, states = names[0]
        by_height, heights = _road_inputs(inputs)
        self.wheels = _checked_wheels(wheels, tuple(heights))
        self._wheelbase = _length("wheelbase", wheelbase)
        self._track_width = _length("track_width", track_width)
        self._space = DesignSpace.over([np.zeros(len(systems))] if several else (), type(self).__name__)

        rows, damping = _table(outputs, self.wheels, like)
        order = [outputs.index(row.name) for row in rows]
        taken = [heights[wheel] for wheel in self.wheels]
        road = tuple(signal(HEIGHT, wheel) for wheel in self.wheels)
        known = Layout((), road, tuple(self.wheels), Outputs(rows), False, len(damping) > 0)
        parts = []
        for i, one in enumerate(systems):
            matrices = one.A, one.B[:, taken], one.C[order], one.D[np.ix_(order, taken)]
            try:
                parts.append((_relative if by_height else _driven)(*matrices))
            except Growing as growing:
                raise ValueError(_growing(growing, states, known.outputs.names) + self._space.place(i)) from None
        self._model = _stacked(
            parts, known, tuple(f"p_{name}" for name in states) if by_height else tuple(states), damping
        )

    def __repr__(self) -> str:
        n, outputs = self._model.states.shape[-2], len(self._model.layout.outputs)
        many = f", {self._space.size} designs" if self._space.dims else ""
        return f"LinearVehicle({n} states, {outputs} outputs, wheels {', '.join(self.wheels) or 'one'}{many})"

    @property
    def wheelbase(self) -> float:
        """Distance between the axles in m; 0 for a vehicle with one."""
        return self._wheelbase

    @property
    def track_width(self) -> float:
        """Distance between left and right wheels in m; 0 for a single-track vehicle."""
        return self._track_width

    @property
    def lazy(self) -> bool:
        """No: matrices are in memory."""
        return False

    def design_space(self) -> DesignSpace:
        """One design, or one a system."""
        return self._space

    def flattened(self, space: DesignSpace) -> LinearVehicle:
        """The designs in one row, as they are."""
        return self

    def select(self, designs: slice | NDArray[np.int_]) -> LinearVehicle:
        """Some of the designs."""
        if self._space.size == 1:
            return self
        some = object.__new__(type(self))
        some.__dict__ |= self.__dict__
        some._model = self._model.select(designs)
        return some

    def assemble(self) -> LinearModel:
        """What dies out and what integrates."""
        return self._model

    def single(self, what: str) -> LinearModel:
        """The model of the one design, for a function that takes no more than one."""
        if self._space.dims:
            raise ValueError(f"LinearVehicle: {what} needs one system, got {self._space.size}")
        return self._model

    def halves(self) -> tuple[Any, ...]:
        """None: nothing is known of its sides."""
        return ()

    def damping(self) -> Array:
        """Damping rate at every corner, as far as it is known."""
        return self._model.damping

    def layout(self) -> Layout:
        """The names of inputs, corners, outputs and states."""
        return self._model.layout

    def quantities(self) -> dict[str, Quantity]:
        """It has no parameters."""
        return {}

    def settings(self) -> dict[str, tuple[str, tuple[str, ...]]]:
        """It has no parameters to set."""
        return {}


def _driven(A: Array, B: Array, C: Array, D: Array) -> tuple[Parted, Array]:
    """A system driven by the rate of the heights, in parts, and its direct feedthrough."""
    parts = parted(A, B, C)
    # What a closed loop leaves of a zero is no feedthrough: it is small beside what the states pass on at once.
    terms = np.abs(D).max(axis=1, keepdims=True) + np.abs(parts.C) @ np.abs(parts.B) / parts.fastest
    return parts, np.where(beyond_rounding(D, terms), D, 0.0)


def _relative(A: Array, B: Array, C: Array, D: Array) -> tuple[Parted, Array]:
    """A system driven by the heights, in the states ``p = x + A^-1 B z_r`` that their rate drives.

    What outputs feel of the heights themselves is ``D - C A^-1 B``: none where everything rides along.
    """
    parts = parted(A, B, C)
    reached = np.abs(parts.rows).max(axis=1, initial=0.0) > 0.0
    if reached.any():
        first = int(np.argmax(reached))
        state, output = (
            int(np.abs(column).argmax()) for column in (parts.basis[:, len(parts.A) + first], parts.seen[:, first])
        )
        raise Growing(0.0, state, output)
    static = np.linalg.solve(parts.A, parts.B)
    felt, terms = D - parts.C @ static, np.abs(D) + np.abs(parts.C) @ np.abs(static)
    sizes = terms.max(axis=1, keepdims=True, initial=0.0)
    sizes[sizes == 0.0] = 1.0
    _, shares, directions = np.linalg.svd(felt / sizes, full_matrices=False)
    rows = directions[shares > CARRIED]
    seen = felt @ rows.T
    seen = np.where(np.abs(seen) > CARRIED * sizes, seen, 0.0)
    basis = parts.basis[:, : len(parts.A)]
    basis = np.pad(basis, [(0, 0), (0, len(rows))])
    return parts._replace(B=static, rows=rows, seen=seen, basis=basis), np.zeros_like(D)


def _growing(growing: Growing, states: Sequence[str], outputs: Sequence[str]) -> str:
    return (
        f"LinearVehicle(system=...) has a mode that does not die out (rate {growing.rate:.4g} 1/s, mostly the state "
        f"{states[growing.state]!r}) and that the output {outputs[growing.output]!r} sees; stabilise it, or leave out "
        "the outputs that see it"
    )


def _stacked(
    parts: Sequence[tuple[Parted, Array]], layout: Layout, names: tuple[str, ...], damping: Array
) -> LinearModel:
    """The model of all designs: what one has fewer states of gets states that nothing reaches and nothing sees."""
    n, k = max(1, *(len(one.A) for one, _ in parts)), max(len(one.rows) for one, _ in parts)
    kept = ~np.any([np.linalg.norm(one.unseen, axis=1) > LEFT_OUT for one, _ in parts], axis=0)

    def filled(name: str, rows: int, columns: int) -> Array:
        stack = np.zeros((len(parts), rows, columns))
        for i, (one, _) in enumerate(parts):
            x = getattr(one, name)
            stack[i, : x.shape[0], : x.shape[1]] = x
        return stack

    outputs, inputs = len(layout.outputs), len(layout.inputs)
    A, states = filled("A", n, n), np.zeros((len(parts), int(kept.sum()), n + k))
    for i, (one, _) in enumerate(parts):
        own = len(one.A)
        A[i, range(own, n), range(own, n)] = -1.0
        states[i][:, :own], states[i][:, n : n + len(one.rows)] = np.hsplit(one.basis[kept], [own])
    named = tuple(name for name, keep in zip(names, kept, strict=True) if keep)
    return LinearModel(
        layout=LinearLayout(**{field.name: getattr(layout, field.name) for field in fields(layout)}, names=named),
        A=A,
        B=filled("B", n, inputs),
        C=filled("C", outputs, n),
        integrators=filled("rows", k, inputs),
        on_integrators=filled("seen", outputs, k),
        on_road_velocity=np.stack([D for _, D in parts]),
        states=states,
        damping=damping,
    )


def _check_system(system: Any) -> None:
    import control

    where = "LinearVehicle(system=...)"
    if not isinstance(system, control.StateSpace):
        hint = ""
        if isinstance(system, control.TransferFunction):
            hint = "; pass control.ss(...) of it, with named inputs and outputs"
        elif isinstance(system, control.NonlinearIOSystem):
            hint = "; pass its .linearize(...)"
        raise TypeError(f"{where} must be a control.StateSpace, got {briefly(system)}{hint}")
    if system.isdtime(strict=True):
        raise ValueError(
            f"{where} must be in continuous time, got one of step {system.dt}; pass the system it came from"
        )
    if not system.nstates or not system.noutputs:
        raise ValueError(f"{where} needs states and outputs, got {system.nstates} states and {system.noutputs} outputs")
    for name in "ABCD":
        if not np.isfinite(getattr(system, name)).all():
            raise ValueError(f"{where} must be finite, got NaN or inf in {name}")


def _road_inputs(inputs: Sequence[str]) -> tuple[bool, dict[str, int]]:
    """Whether the road comes as heights, and the number of the input of each wheel."""
    found = {
        stem: {
            name.removeprefix(stem).removeprefix("_"): i
            for i, name in enumerate(inputs)
            if name == stem or name.startswith(f"{stem}_")
        }
        for stem in (HEIGHT, RATE)
    }
    if bool(found[HEIGHT]) == bool(found[RATE]):
        need = "inputs z_r... (m) or dz_r... (m/s)" + (", one of both" if found[HEIGHT] else "")
        raise ValueError(f"LinearVehicle(system=...) needs {need}, got {', '.join(inputs) or 'none'}")
    return bool(found[HEIGHT]), found[HEIGHT] or found[RATE]


def _checked_wheels(wheels: Mapping[str, tuple[int, int]] | None, driven: tuple[str, ...]) -> dict[str, Wheel]:
    """The wheels by name, each with an input of its own."""
    where = "LinearVehicle(wheels=...)"
    if wheels is None:
        if frozenset(driven) not in KNOWN_WHEELS:
            raise ValueError(
                f"{where} must say where the wheels {', '.join(driven)} run, such as wheels="
                f"{{{driven[0]!r}: (0, -1), ...}}: (axle, side), axle 0 in front, side -1 right and 1 left"
            )
        return dict(KNOWN_WHEELS[frozenset(driven)])
    if not isinstance(wheels, Mapping):
        raise TypeError(f'{where} must be a mapping such as {{"fr": (0, -1)}}, got {briefly(wheels)}')
    if set(wheels) != set(driven):
        raise ValueError(
            f"{where} and the inputs of the system must be of the same wheels, got {', '.join(wheels) or 'none'} and inputs "
            f"for {', '.join(driven)}"
        )
    checked = {}
    for name, place in wheels.items():
        if not (isinstance(place, Sequence) and len(place) == 2 and place[0] in (0, 1) and place[1] in (-1, 0, 1)):
            raise ValueError(
                f"{where}: {name!r} must be (axle, side) with axle 0 or 1 and side -1, 0 or 1, got {briefly(place)}"
            )
        checked[name] = Wheel(int(place[0]), int(place[1]))
    return checked


def _length(name: str, value: Any) -> float:
    if isinstance(value, bool) or not isinstance(value, (int, float, np.integer, np.floating)):
        raise TypeError(f"LinearVehicle({name}=...) must be one number >= 0 m, got {briefly(value)}")
    if not (np.isfinite(value) and value >= 0.0):
        raise ValueError(f"LinearVehicle({name}=...) must be finite and >= 0 m, got {briefly(value)}")
    return float(value)


def _table(
    outputs: Sequence[str], wheels: Mapping[str, Wheel], like: RoadVehicle | None
) -> tuple[tuple[Row, ...], Array]:
    """What each output is, what serves the damper powers last; and the damping rates that these are made of."""
    known = {row.name: row for row in like.layout().outputs.rows} if like is not None else {}
    rates = [signal("dsws", wheel) for wheel in wheels]
    damping = np.zeros(0)
    if like is not None and set(rates) <= set(outputs):
        damping = like.damping()
    rows = []
    for name in outputs:
        row = known.get(name) or _row(name)
        if row.quantity.name in DIMS:
            raise ValueError(f"LinearVehicle(system=...) has an output named {name!r}, which results use; rename it")
        rows.append(row._replace(public=name not in rates or not len(damping)))
    variables: dict[str, set[str]] = {}
    for row in rows:
        variables.setdefault(row.quantity.name, set()).add(row.place)
    for name, places in variables.items():
        if "" in places and len(places) > 1:
            other = signal(name, max(places))
            raise ValueError(
                f"LinearVehicle(system=...) has outputs {name!r} and {other!r}; give both a place, or neither"
            )
    return tuple(sorted(rows, key=lambda row: not row.public)), damping


def _row(name: str) -> Row:
    """An output by its name alone: one of the package's at a place, or one of its own."""
    for stem in sorted(SIGNALS, key=len, reverse=True):
        quantity = SIGNALS[stem]
        if quantity.statistic == "RMS" and (name == stem or (quantity.dim and name.startswith(f"{stem}_"))):
            return Row(quantity, name.removeprefix(stem).removeprefix("_"), True)
    return Row(Quantity(name, "", name), "", True)


def _named_like(system: control.StateSpace, like: RoadVehicle) -> control.StateSpace:
    """A system that lost its names, with those of the vehicle whose loop was closed."""
    import control

    generic = [f"u[{i}]" for i in range(system.ninputs)]
    if system.input_labels != generic or not isinstance(like, Vehicle):
        return system
    shape, fitting = (system.noutputs, system.ninputs), []
    for form in ("displacement", "velocity"):
        for actuators in (False, True):
            try:
                own = like.state_space(form, actuators)  # type: ignore[arg-type]
            except ValueError:
                continue
            if (own.noutputs, own.ninputs) == shape:
                fitting.append(own)
    if not fitting:
        raise ValueError(
            f"LinearVehicle(system=...) has no names, and {shape[0]} outputs from {shape[1]} inputs are not those of a "
            f"loop closed around {type(like).__name__}'s state_space(); name them, as control.ss(..., inputs=, outputs=)"
        )
    # Where both forms exist, tyres pass heights straight on to their loads, and rates not at all, whatever actuators do.
    loads = [name.startswith("dtl") for name in fitting[0].output_labels]
    own = min(fitting, key=lambda own: np.abs(system.D - own.D)[loads, : len(like.wheels)].max())
    same = system.nstates == own.nstates
    return control.ss(
        system.A,
        system.B,
        system.C,
        system.D,
        inputs=own.input_labels,
        outputs=own.output_labels,
        states=own.state_labels if same else system.state_labels,
    )
