"""What every other room may ask of a vehicle, whatever it is made of.

A vehicle runs on named wheels, spans designs, and assembles to a model of them. Models of masses and links
(`SecondOrder`) and of any state space (`LinearModel`) answer the same questions; what a fast way needs beyond them,
such as K and C, the model states itself.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping
from typing import Any, ClassVar, Protocol, Self

import numpy as np
from numpy.typing import NDArray

from ..quantities import Quantity
from .linkage import Wheel
from .modes import Modes
from .parameters import DesignSpace
from .second_order import Layout

Array = NDArray[np.float64]


class Model(Protocol):
    """A vehicle from road velocity to outputs: ``x' = A x + B w`` dies out, ``h' = integrators w`` does not.

    Arrays have the shape (designs..., rows, columns). Outputs are ``y = Y x + on_integrators h + on_road_velocity w``.
    """

    second_order: ClassVar[bool]
    """Whether it has K and C, whose structure a faster solution of the covariance equation needs."""

    @property
    def layout(self) -> Layout:
        """The names of everything."""
        ...

    @property
    def damping(self) -> Array:
        """Damping rate at every corner, (designs..., corners); (0,) where it is not known."""
        ...

    @property
    def A(self) -> Array:
        """What dies out, its eigenvalues the resonances."""
        ...

    @property
    def integrators(self) -> Array:
        """Rates of what integrates, such as the warp of the road, per road velocity, (designs..., k, inputs)."""
        ...

    @property
    def on_integrators(self) -> Array:
        """Outputs per what integrates, (designs..., outputs, k)."""
        ...

    @property
    def on_road_velocity(self) -> Array:
        """Outputs per road velocity passed straight on, (designs..., outputs, inputs)."""
        ...

    def relative_transfer(self, omega: Array) -> NDArray[np.complex128]:
        """Outputs per road velocity without what integrates, (designs..., outputs, inputs, F), at ``omega``.

        That is (F,), or (designs, F).
        """
        ...

    def modes(self) -> Modes:
        """Modes of one design."""
        ...

    def displacement_form(self) -> tuple[Array, Array, Array, Array, Array]:
        """``x' = A x + B z_r``, ``y = Y x + D z_r + D1 z_r'`` over states that stand for the same outputs."""
        ...

    def velocity_form(self) -> tuple[Array, Array, Array, Array]:
        """A, B, Y and D over x, and what integrates behind it."""
        ...

    def controls(self) -> tuple[Array, Array]:
        """How the further inputs that a layout may name drive the states of `displacement_form`, and the outputs."""
        ...

    def in_states(self, X: Array) -> Array:
        """A covariance (designs..., x and h, x and h) in the states that the layout names."""
        ...

    def refusal(self) -> str:
        """Why no road of random height has a stationary response; nothing where it may have."""
        ...

    def drifting(self, which: NDArray[np.bool_]) -> str:
        """What has no finite variance where these of the integrators (k,) drift."""
        ...


class RoadVehicle(ABC):
    """Anything on wheels that a road excites: one design, or a sweep of them."""

    @property
    @abstractmethod
    def wheels(self) -> Mapping[str, Wheel]:
        """Where each wheel runs, by its name."""

    @property
    @abstractmethod
    def axles(self) -> tuple[Any, ...]:
        """How far each axle is behind the first, in m: 0, then ascending; numbers, or one a design."""

    @property
    def wheelbase(self) -> Any:
        """Distance from the first to the last axle in m; 0 for a vehicle with one."""
        return self.axles[-1]

    @property
    @abstractmethod
    def track_width(self) -> Any:
        """Distance between left and right wheels in m; 0 for a single-track vehicle."""

    @property
    @abstractmethod
    def lazy(self) -> bool:
        """Whether some parameter's values are computed later."""

    def moving(self, speed: Any) -> RoadVehicle:
        """The vehicle on a road that passes at this speed, in m/s: itself, where only the road depends on that."""
        return self

    @property
    def curved(self) -> bool:
        """Whether a curve stands for some spring or damper, so that it is linear on one road at a time only."""
        return False

    @abstractmethod
    def with_points(self, points: Mapping[str, tuple[float, float]]) -> RoadVehicle:
        """The same vehicle, measured at further points of its body."""

    @abstractmethod
    def leaves(self) -> list[Any]:
        """Whatever spans designs: numbers, arrays or DataArrays."""

    @abstractmethod
    def mapped(self, function: Any) -> Self:
        """The same with a function applied to every leaf, unchecked."""

    @abstractmethod
    def checked(self) -> Self:
        """The same, its leaves checked."""

    @abstractmethod
    def design_space(self) -> DesignSpace:
        """The designs that the vehicle spans."""

    @abstractmethod
    def flattened(self, space: DesignSpace) -> Self:
        """The same designs in one row."""

    @abstractmethod
    def select(self, designs: slice | NDArray[np.int_]) -> Self:
        """Some of the designs of a flattened vehicle."""

    @abstractmethod
    def assemble(self) -> Any:
        """The ``Model`` of a flattened vehicle."""

    @abstractmethod
    def single(self, what: str) -> Any:
        """The ``Model`` of the one design, for a function that takes no more than one."""

    @abstractmethod
    def halves(self) -> tuple[Any, ...]:
        """The mean of left and right, and half their difference; none where they do not part."""

    @abstractmethod
    def whole(self) -> Any:
        """All struts on a rigid body; None of what is more, or else."""

    @abstractmethod
    def damping(self) -> Array:
        """Damping rate at every corner of a flattened vehicle, (corners,) or (designs, corners)."""

    def static_loads(self) -> Array | None:
        """What every tyre of a flattened vehicle carries at rest in N, (designs..., corners); None if not known."""
        return None

    @abstractmethod
    def layout(self) -> Layout:
        """The names of coordinates, inputs, corners and outputs."""

    @abstractmethod
    def quantities(self) -> dict[str, Quantity]:
        """What each parameter is."""

    @abstractmethod
    def settings(self) -> dict[str, tuple[str, tuple[str, ...]]]:
        """Field and wheels of every name that sets a parameter."""
