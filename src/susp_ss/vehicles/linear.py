"""Any linear vehicle: a python-control system whose inputs are the heights of the road under its wheels or their rates.

Names are read in `signals`, matrices parted in `parting` and made a model in `linear_model`.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from ..quantities import Quantity, briefly, signal
from .contract import RoadVehicle
from .linear_model import LinearModel, driven, relative, stacked
from .linkage import Wheel
from .parameters import DesignSpace, computed
from .parting import Growing
from .second_order import Array, Layout, Outputs
from .signals import HEIGHT, check_system, checked_wheels, distances, length, named_like, output_table, road_inputs

if TYPE_CHECKING:
    import control
    import pandas as pd


class LinearVehicle(RoadVehicle):
    """A linear vehicle of any making, from its state space: a control system, an identified or a linearised model.

    ``x' = A x + B u``, ``y = C x + D u``, where ``u`` are the heights of the road under the wheels, or their rates, and
    other inputs, which stay zero. The covariance route solves ``A X + X A^T + Q = 0`` with the wheelbase delay in
    closed form. What no output sees (a yaw angle, the integrator of a disturbance) is left out. Driven by heights, it
    goes by ``p = x + A^-1 B z_r``, relative to the road; an output that then still feels the height itself, as position
    feedback may make it do, has a finite variance only where the heights that it feels do not drift apart.

    Parameters
    ----------
    system : control.StateSpace, or sequence of them
        In continuous time. Inputs ``z_r`` or ``z_r_<wheel>`` (m), or all of them ``dz_r...`` (m/s). Outputs with the
        names of the package's (``bacc_fr``, ``sws_fr``, ``dtl``, ``roll_acc``) are taken for these, with their units
        and dims; others become variables of their own name. Several systems with the same names are the designs
        of a sweep, on dim ``design``.
    wheels : mapping of str to (axle, side), optional
        Axle 0 in front, 1 behind and so on; side -1 right, 1 left, 0 on the centre line. Not needed for the names of
        the package's own vehicles (``fr, fl, rr, rl``; ``f, r``; ``r, l``; a single wheel).
    wheelbase : float, or sequence of float
        From the first axle to the other, or to each of the others, in m. 0: both axles meet the road at once.
    track_width : float
        In m. 0: no isotropic tracks.
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
    ``damper_power`` needs ``like`` and the suspension velocities ``sws_rate...`` of all corners, and is what the
    dampers of ``like`` dissipate.

    Examples
    --------
    A skyhook of 1.5 kN s/m on a quarter car with a softer damper, from an accelerometer on the body:

    >>> import control as ct
    >>> import susp_ss as ss
    >>> car = ss.QuarterCar(cs=750.0)
    >>> plant = car.state_space(input="velocity", actuators=True)
    >>> law = ct.ss([-0.6], [1.0], [-1500.0], [0.0], inputs="bacc", outputs="u")
    >>> closed = ct.interconnect([plant, law], inputs="dz_r", outputs=plant.output_labels)
    >>> active = ss.LinearVehicle(closed, like=car)
    >>> bool(ss.ride_metrics(active, ss.Road()).bacc < 0.75 * ss.ride_metrics(ss.QuarterCar(), ss.Road()).bacc)
    True
    """

    def __init__(
        self,
        system: control.StateSpace | Sequence[control.StateSpace],
        wheels: Mapping[str, tuple[int, int]] | None = None,
        wheelbase: float | Sequence[float] = 0.0,
        track_width: float = 0.0,
        like: RoadVehicle | None = None,
    ):
        import control

        several = isinstance(system, Sequence) and not isinstance(system, control.StateSpace)
        systems: list[Any] = list(system) if several else [system]
        if not systems:
            raise ValueError("LinearVehicle(system=...) must hold at least one control.StateSpace, got none")
        for one in systems:
            check_system(one)
        if like is not None:
            if not isinstance(like, RoadVehicle):
                raise TypeError(f"LinearVehicle(like=...) must be a vehicle such as FullCar(), got {briefly(like)}")
            if wheels is not None or wheelbase or track_width:
                raise ValueError(
                    "LinearVehicle(like=...) has wheels, wheelbase and track_width of its own; pass like or these"
                )
            systems = [named_like(one, like) for one in systems]
            wheels, wheelbase, track_width = like.wheels, like.axles[1:], like.track_width
        names = [(one.input_labels, one.output_labels, one.state_labels) for one in systems]
        if any(one != names[0] for one in names[1:]):
            raise ValueError("LinearVehicle(system=...) must be systems with the same inputs, outputs and states")
        inputs, outputs, states = names[0]
        by_height, heights = road_inputs(inputs)
        self._axles = distances(wheelbase)
        self._wheels = checked_wheels(wheels, tuple(heights), len(self._axles))
        self._track_width = length("track_width", track_width)
        self._which: Any = xr.DataArray(np.arange(len(systems), dtype=float), dims="design") if several else None

        rows, damping = output_table(outputs, self.wheels, like)
        taken = [heights[wheel] for wheel in self.wheels]
        road = tuple(signal(HEIGHT, wheel) for wheel in self.wheels)
        known = Layout((), road, tuple(self.wheels), Outputs(rows), 0, len(damping) > 0)
        parts = []
        for i, one in enumerate(systems):
            matrices = one.A, one.B[:, taken], one.C, one.D[:, taken]
            try:
                parts.append((relative if by_height else driven)(*matrices))
            except Growing as growing:
                raise ValueError(
                    _growing(growing, states, known.outputs.names) + (f" at (design={i})" if several else "")
                ) from None
        self._model = stacked(
            parts, known, tuple(f"p_{name}" for name in states) if by_height else tuple(states), damping
        )

    def __repr__(self) -> str:
        n, outputs = self._model.states.shape[-2], len(self._model.layout.outputs)
        many = f", {len(self._which)} designs" if self._which is not None else ""
        return f"LinearVehicle({n} states, {outputs} outputs, wheels {', '.join(self.wheels) or 'one'}{many})"

    @property
    def wheels(self) -> dict[str, Wheel]:
        """Where each wheel runs, by its name."""
        return self._wheels

    @property
    def axles(self) -> tuple[Any, ...]:
        """How far each axle is behind the first, in m."""
        return self._axles

    @property
    def track_width(self) -> float:
        """Distance between left and right wheels in m; 0 for a single-track vehicle."""
        return self._track_width

    @property
    def lazy(self) -> bool:
        """No: matrices are in memory."""
        return False

    def with_points(self, points: Mapping[str, tuple[float, float]]) -> LinearVehicle:
        """Refused: where its body is, only its outputs know."""
        raise TypeError(
            f"points need a vehicle whose body is known, such as FullCar(), got {self!r}; give the system an output "
            "there, named bacc_driver"
        )

    def leaves(self) -> list[Any]:
        """The numbers of the systems, where there are several."""
        return [] if self._which is None else [self._which]

    def mapped(self, function: Any) -> LinearVehicle:
        """The same with a function applied to the numbers of the systems."""
        return self if self._which is None else self._with(_which=function(self._which))

    def checked(self) -> LinearVehicle:
        """The same: its systems have been checked."""
        return self

    def design_space(self) -> DesignSpace:
        """One design, or one a system."""
        return DesignSpace.over(self.leaves(), type(self).__name__)

    def flattened(self, space: DesignSpace) -> LinearVehicle:
        """The same designs in one row; the one system stands for all of them."""
        return self if self._which is None else self.select(np.asarray(space.flat(computed(self._which)), dtype=int))

    def select(self, designs: slice | NDArray[np.int_]) -> LinearVehicle:
        """Some of the designs of a flattened vehicle."""
        if self._which is None:
            return self
        return self._with(_which=np.asarray(self._which)[designs], _model=self._model.select(designs))

    def _with(self, **parts: Any) -> LinearVehicle:
        other = object.__new__(type(self))
        other.__dict__ |= self.__dict__ | parts
        return other

    def assemble(self) -> LinearModel:
        """What dies out and what integrates."""
        return self._model

    def single(self, what: str) -> LinearModel:
        """The model of the one design, for a function that takes no more than one."""
        if self._which is not None:
            raise ValueError(f"LinearVehicle: {what} needs one system, got {len(self._which)}")
        return self._model

    def modes(self) -> pd.DataFrame:
        """Damped modes of what dies out, slowest first, as `Vehicle.modes` returns them.

        Each ``shape`` is over the system's states, in their own units.

        Examples
        --------
        >>> import susp_ss as ss
        >>> law = ss.skyhook(ss.QuarterCar(), ss.Road(), gain=1500.0)
        >>> law.closed.modes()["damping_ratio"].round(2).tolist()
        [0.58, 0.26]
        """
        return self.single("modes()").modes().table()

    def halves(self) -> tuple[Any, ...]:
        """None: nothing is known of its sides."""
        return ()

    def whole(self) -> None:
        """None: nothing is known of its struts."""

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


def _growing(growing: Growing, states: Sequence[str], outputs: Sequence[str]) -> str:
    return (
        f"LinearVehicle(system=...) has a mode that does not die out (rate {growing.rate:.4g} 1/s, mostly the state "
        f"{states[growing.state]!r}) and that the output {outputs[growing.output]!r} sees; stabilise it, or leave out "
        "the outputs that see it"
    )
