"""Masses joined by spring-damper links: the one assembly behind every vehicle.

A vehicle is data here: inertias on coordinates, and links whose elongation is a linear form in the coordinates
and the road heights. With one row of ``R`` (and ``N``) a link, elongation ``e = R q + N z_r``, the equations of
motion are ``M q'' + C q' + K q = C_in z_r' + K_in z_r`` with ``K = R^T k R``, ``K_in = -R^T k N`` and likewise
for the dampers: `SecondOrder` holds these matrices.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from ..quantities import METRICS, Quantity
from .second_order import Array, Layout, Outputs, Row, SecondOrder, coefficients

GRAVITY = 9.81
"""m/s^2."""


class Motion:
    """A linear form in coordinates and road heights, such as ``z_b - a*theta - z_u``."""

    def __init__(self, terms: Mapping[str, Any]):
        self.terms = dict(terms)

    def __add__(self, other: Motion) -> Motion:
        terms = dict(self.terms)
        for name, coefficient in other.terms.items():
            terms[name] = terms[name] + coefficient if name in terms else coefficient
        return Motion(terms)

    def __sub__(self, other: Motion) -> Motion:
        terms = dict(self.terms)
        for name, coefficient in other.terms.items():
            terms[name] = terms[name] - coefficient if name in terms else -coefficient
        return Motion(terms)

    def __rmul__(self, factor: ArrayLike) -> Motion:
        return Motion({name: factor * coefficient for name, coefficient in self.terms.items()})

    # An array on the left would otherwise take the product element by element.
    __array_ufunc__ = None


def coordinates(*names: str) -> tuple[Motion, ...]:
    """Name the degrees of freedom of a model."""
    return tuple(Motion({name: 1.0}) for name in names)


def track(*names: str) -> tuple[Motion, ...]:
    """Name the road heights under a model's wheels."""
    return coordinates(*names)


class Wheel(NamedTuple):
    """Where a wheel runs: ``axle`` 0 in front, 1 behind and so on; ``side`` -1 right, 1 left, 0 on the centre line."""

    axle: int
    side: int


@dataclass(frozen=True, eq=False)
class Link:
    """A spring and a damper in parallel along one elongation."""

    elongation: Motion
    stiffness: Any
    damping: Any = 0.0


@dataclass(frozen=True, eq=False)
class Corner:
    """A wheel on its tyre, and the suspension on it that carries the body at a point, the mount.

    Without a wheel the tyre is rigid: the road feels the suspension's own force.
    """

    road: Motion
    wheel: Motion | None
    mount: Motion
    ks: Any
    cs: Any
    kt: Any = 0.0
    ct: Any = 0.0

    @cached_property
    def suspension(self) -> Link:
        return Link((self.wheel or self.road) - self.mount, self.ks, self.cs)

    @cached_property
    def tyre(self) -> Link:
        return self.suspension if self.wheel is None else Link(self.road - self.wheel, self.kt, self.ct)


@dataclass(frozen=True, eq=False)
class Cushion:
    """Spring and damper of a seat, which carry a rider on the floor: on the body, at a point of it."""

    rider: Motion
    floor: Motion
    ks: Any
    cs: Any

    @cached_property
    def link(self) -> Link:
        return Link(self.rider - self.floor, self.ks, self.cs)


@dataclass(frozen=True, eq=False)
class Output:
    """One row of the output table: ``acceleration q'' + sum elongation e + sum rate e'``, links by their factors."""

    quantity: Quantity
    place: str = ""
    acceleration: Motion = field(default_factory=lambda: Motion({}))
    elongation: Mapping[Link, Any] = field(default_factory=dict)
    rate: Mapping[Link, Any] = field(default_factory=dict)
    public: bool = True


@dataclass(frozen=True, eq=False)
class Linkage:
    """A vehicle as data.

    Parameters
    ----------
    masses : dict
        Inertia (kg or kg m^2) of each coordinate.
    corners : dict
        `Corner` by name.
    points : dict
        Points of the body (name -> Motion) whose vertical acceleration is an output.
    rotations : dict
        Body rotations (name of their acceleration -> Motion).
    bars : dict
        Anti-roll bars: stiffness along the difference of the suspension deflections of two corners (pair of names).
    seats : dict
        `Cushion` by the name of the seat, at which the rider's acceleration is an output.
    links : sequence of Link
        Beyond corners, bars and seats.
    warps : sequence of Motion
        The combinations of road heights that a rigid body on its wheels cannot follow.
    more : sequence of Output
        Rows of the output table beyond those of every vehicle.
    """

    masses: Mapping[Motion, Any]
    corners: Mapping[str, Corner]
    points: Mapping[str, Motion]
    rotations: Mapping[str, Motion] = field(default_factory=dict)
    bars: Mapping[tuple[str, ...], Any] = field(default_factory=dict)
    seats: Mapping[str, Cushion] = field(default_factory=dict)
    links: Sequence[Link] = ()
    warps: Sequence[Motion] = ()
    more: Sequence[Output] = ()

    @cached_property
    def outputs(self) -> list[Output]:
        """The output table: what every vehicle has, and more."""
        bacc, sws, dtl, rate = (METRICS[name] for name in ("bacc", "sws", "dtl", "sws_rate"))
        first, *others = (Output(bacc, place, acceleration=motion) for place, motion in self.points.items())
        rotations = (Output(METRICS[name], acceleration=motion) for name, motion in self.rotations.items())
        corners = self.corners.items()
        return [
            first,
            *rotations,
            *others,
            *(Output(bacc, name, acceleration=seat.rider) for name, seat in self.seats.items()),
            *(Output(sws, name, elongation={corner.suspension: 1.0}) for name, corner in corners),
            *(Output(dtl, name, elongation=_stiff(corner.tyre), rate=_damped(corner.tyre)) for name, corner in corners),
            *(Output(METRICS["seat_travel"], name, elongation={seat.link: 1.0}) for name, seat in self.seats.items()),
            *self.more,
            *(Output(rate, name, rate={corner.suspension: 1.0}, public=False) for name, corner in corners),
            *(
                Output(METRICS["tyre_deflection"], name, elongation={corner.tyre: 1.0}, public=False)
                for name, corner in corners
                if corner.wheel is not None
            ),
        ]

    @cached_property
    def layout(self) -> Layout:
        """The names of everything."""
        states = [name for motion in self.masses for name in motion.terms]
        heights = (name for corner in self.corners.values() for name in corner.road.terms)
        rows = tuple(Row(output.quantity, output.place, output.public) for output in self.outputs)
        return Layout(tuple(states), tuple(heights), tuple(self.corners), Outputs(rows), len(self.warps))

    def assemble(self) -> SecondOrder:
        """Write the links out as matrices; parameters that are arrays give stacks of matrices."""
        layout, outputs = self.layout, self.outputs
        suspensions = [corner.suspension for corner in self.corners.values()]
        tyres = [corner.tyre for corner in self.corners.values()]
        bars = [
            Link(self.corners[one].suspension.elongation - self.corners[other].suspension.elongation, stiffness)
            for (one, other), stiffness in self.bars.items()
        ]
        cushions = [seat.link for seat in self.seats.values()]
        links = list(dict.fromkeys([*suspensions, *tyres, *bars, *cushions, *self.links]))

        elongations = [link.elongation.terms for link in links]
        R, N = coefficients(elongations, layout.coordinates), coefficients(elongations, layout.inputs)
        k, c = _stack([link.stiffness for link in links]), _stack([link.damping for link in links])
        m = _stack(list(self.masses.values()))
        designs = np.broadcast_shapes(R.shape[:-2], k.shape[:-1], c.shape[:-1], m.shape[:-1])
        R, N = (np.broadcast_to(rows, (*designs, *rows.shape[-2:])) for rows in (R, N))
        k, c, m = (np.broadcast_to(values, (*designs, values.shape[-1])) for values in (k, c, m))
        RT = np.swapaxes(R, -1, -2)
        of_suspension, of_tyre = (np.array([links.index(link) for link in some]) for some in (suspensions, tyres))
        model = SecondOrder(
            layout=layout,
            m=m,
            K=RT @ (k[..., None] * R),
            C=RT @ (c[..., None] * R),
            K_in=-RT @ (k[..., None] * N),
            C_in=-RT @ (c[..., None] * N),
            R=R,
            N=N,
            acceleration=coefficients([output.acceleration.terms for output in outputs], layout.coordinates),
            elongation=coefficients([output.elongation for output in outputs], links),
            rate=coefficients([output.rate for output in outputs], links),
            suspensions=of_suspension,
            tyres=of_tyre,
            damping=c[..., of_suspension],
            integrators=coefficients([warp.terms for warp in self.warps], layout.inputs),
        )
        # Energy only leaves: where each corner and each seat has a damper, no mode of wheels, a rigid body and riders
        # can go on for ever.
        at_corners = np.all((c.real[..., of_suspension] > 0.0) | (c.real[..., of_tyre] > 0.0), axis=-1)
        at_seats = np.all(c.real[..., [links.index(link) for link in cushions]] > 0.0, axis=-1)
        object.__setattr__(model, "damped", at_corners & at_seats & (not self.links))
        return model

    def static_loads(self) -> Array:
        """What every tyre carries at rest in N, (designs..., corners), on springs that bear no load without weights.

        Two axles share the weights as the lever says. What more wheels than that carry, their springs decide.
        """
        model = self.assemble()
        turning = {name for motion in self.rotations.values() for name in motion.terms}
        falling = np.array([name not in turning for name in model.layout.coordinates])
        rest = np.linalg.solve(model.K, -GRAVITY * (model.m * falling)[..., None])
        stretched = (model.R[..., model.tyres, :] @ rest)[..., 0]
        return np.asarray(stretched * _stack([corner.tyre.stiffness for corner in self.corners.values()]))


def _stiff(link: Link) -> dict[Link, Any]:
    return {link: link.stiffness}


def _damped(link: Link) -> dict[Link, Any]:
    return {link: link.damping}


def _stack(values: Sequence[ArrayLike]) -> Array:
    return np.stack(np.broadcast_arrays(*values), axis=-1)
