"""A vehicle with a force between every wheel and the body, on a road: what laws are designed for."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
import scipy.linalg
import xarray as xr
from numpy.typing import NDArray

from ..metrics.ride import ride_metrics
from ..metrics.weightings import filters, rows_behind, say_weightings
from ..quantities import ACTUATION, briefly, signal
from ..responses.excitation import (
    check_kinds,
    check_stationary,
    delays,
    infinite_outputs,
    integrated,
    processes,
    vanishing_outputs,
)
from ..responses.filters import Filter
from ..responses.labels import labelled_outputs
from ..roads.colours import colours
from ..roads.road import Road
from ..vehicles.contract import RoadVehicle
from ..vehicles.linear import LinearVehicle
from ..vehicles.parameters import DesignSpace
from ..vehicles.second_order import Layout, Outputs, Row
from .preview import Law, Noise, System, variances
from .result import Feedback
from .shaping import shaping

if TYPE_CHECKING:
    import control

Array = NDArray[np.float64]

# Rows that others make up to this share of the largest are sums of them.
RANK = 1e-9

# States that the road moves less than this share of the one it moves most are scaled as if it did.
STILL = 1e-6

# Directions of states with a smaller share of variance than this are taken to have it.
FLAT = 1e-13


@dataclass(frozen=True, eq=False)
class Plant:
    """A vehicle's state space with actuators, its outputs named, and the noises of the road behind it.

    States are road-relative and divided by ``sizes``, their proportions where each wheel of the passive vehicle runs on
    a road of its own; those of the filters of a weighting come behind the vehicle's own. ``rows`` tells where each of
    the layout's outputs is found among those of the system, behind its filter where it has one; the first of these are
    the layout's own without. The road's velocity under each wheel drives states and outputs by ``velocity``, the warps
    that integrate do by ``standing``.
    """

    vehicle: RoadVehicle
    road: Road
    layout: Layout
    system: System
    weighting: dict[str, Filter]
    rows: NDArray[np.int_]
    infinite: NDArray[np.bool_]
    still: NDArray[np.bool_]
    states: tuple[str, ...]
    sizes: Array
    velocity: tuple[Array, Array]
    standing: tuple[Array, Array]
    model: Any

    @property
    def integrators(self) -> Array:
        """Rates of the warps per road velocity."""
        return np.asarray(_one(self.model.integrators))

    @cached_property
    def noises(self) -> list[Noise]:
        """What the road is made of, where it can be."""
        return _noises(self.vehicle, self.road, self.model, self.velocity, self.standing)

    @property
    def forces(self) -> slice | list[int]:
        """The outputs that are the actuators' forces."""
        return self.layout.outputs.of("force")

    @property
    def no_force(self) -> Array:
        """The gain of a passive vehicle."""
        return np.zeros(self.system.B.shape[::-1])

    @property
    def looks_ahead(self) -> bool:
        """Whether something of the road is known beyond the states: what comes to an axle behind, or its colour."""
        return any(len(noise.delays) > 1 or len(noise.rates) for noise in self.noises)

    def variances(self, law: Law) -> Array:
        """Variances of the system's outputs under a law."""
        return variances(self.system, self.noises, law).clip(min=0.0)

    def named(self, name: Any, where: str) -> dict[str, int]:
        """The layout's outputs that ``"sws@fr"``, or ``"sws"`` at every place, stands for.

        Raises
        ------
        TypeError, ValueError
            Nothing stands under that name, or it has no finite variance.
        """
        if not isinstance(name, str):
            raise TypeError(f"{where} must be the name of an output such as 'bacc@cg', got {briefly(name)}")
        stem, at, place = name.partition("@")
        outputs = self.layout.outputs
        if stem not in outputs.quantities:
            raise ValueError(f"{where}: no output named {stem!r}, available: {', '.join(outputs.quantities)}")
        places = outputs.places(stem)
        if at and place not in places:
            available = ", ".join(f"{stem}@{one}" if one else stem for one in places)
            raise ValueError(f"{where}: no {name!r}, available: {available}")
        rows = np.arange(len(outputs))[outputs.of(stem)]
        found = {f"{stem}@{one}" if one else stem: int(row) for one, row in zip(places, rows, strict=True)}
        found = {name: found[name]} if at else found
        for one, row in found.items():
            if self.infinite[row]:
                raise ValueError(
                    f"{where}: {one} has no finite variance, for the road's white velocity is passed straight on to it"
                )
        return found

    def gain(self, K: Array) -> xr.DataArray:
        """``u = gain x`` with its labels, in SI units, for ``u = -K x`` in the scaled states."""
        labels = {"force": [signal("u", corner) for corner in self.layout.corners], "state": list(self.states)}
        return xr.DataArray(-K / self.sizes, labels, ("force", "state"), name="gain")

    def closed(self, K: Array, named: bool = True) -> LinearVehicle:
        """The vehicle under ``u = -K x``, as one that goes wherever a vehicle may.

        Its states have their names; or, where large gains cancel in them, are as large as one another and uncorrelated.
        """
        A, B, C, D = self.system
        own = len(self.layout.outputs)
        A, C, W, bent = A - B @ K, (C - D @ K)[:own], self.velocity[0], self.standing[0]
        if named:
            T, states = np.diag(self.sizes), list(self.states)
        else:
            squares, directions = np.linalg.eigh(scipy.linalg.solve_continuous_lyapunov(A, -W @ W.T))
            T = (directions / np.sqrt(squares.clip(min=FLAT * squares[-1]))).T
            states = [f"x_{i + 1}" for i in range(len(A))]
        return self.vehicle_of(T @ A @ np.linalg.inv(T), T @ W, C @ np.linalg.inv(T), T @ bent, states)

    def estimated(self, K: Array, L: Array, rows: list[int]) -> LinearVehicle:
        """The vehicle under ``u = -K x^`` on an estimate ``x^' = A x^ + B u + L (m - m^)`` from these rows.

        Its states are the vehicle's and the error ``x - x^``, which the forces do not reach.
        """
        A, B, C, D = self.system
        own, (W, F), (bent, held) = len(self.layout.outputs), self.velocity, self.standing
        T = np.diag(np.append(self.sizes, self.sizes))
        whole = np.block([[A - B @ K, B @ K], [np.zeros_like(A), A - L @ C[rows]]])
        return self.vehicle_of(
            T @ whole @ np.linalg.inv(T),
            T @ np.vstack([W, W - L @ F[rows]]),
            np.hstack([C - D @ K, D @ K])[:own] @ np.linalg.inv(T),
            T @ np.vstack([bent, bent - L @ held[rows]]),
            [*self.states, *(f"{name}_error" for name in self.states)],
        )

    def lagging(self, K: Array, lag: float) -> LinearVehicle:
        """The vehicle under forces that follow ``u = -K x`` with a lag, ``lag F' + F = u``."""
        A, B, C, D = self.system
        forces = len(K)
        T = np.diag(np.append(self.sizes, np.ones(forces)))
        whole = np.block([[A, B], [-K / lag, -np.eye(forces) / lag]])
        W, bent = (np.pad(part, [(0, forces), (0, 0)]) for part in (self.velocity[0], self.standing[0]))
        return self.vehicle_of(
            T @ whole @ np.linalg.inv(T),
            T @ W,
            np.hstack([C, D])[: len(self.layout.outputs)] @ np.linalg.inv(T),
            T @ bent,
            [*self.states, *(signal("force", corner) for corner in self.layout.corners)],
        )

    def controlled(self, controller: control.StateSpace) -> LinearVehicle:
        """The vehicle under the forces of a controller on its outputs, both by their names.

        Raises
        ------
        ValueError
            No such output or force.
        """
        import control

        vehicle: Any = self.vehicle
        system, wheels = vehicle.state_space(input="velocity", actuators=True), len(self.layout.inputs)
        forces = system.input_labels[wheels:]
        outputs = [*system.output_labels, *(signal("force", corner) for corner in self.layout.corners)]
        seen = _places(controller.input_labels, outputs, "measures", "outputs")
        pushing = _places(controller.output_labels, forces, "sets", "forces")
        rows, columns = [*range(len(outputs)), *seen], [*range(wheels), *(wheels + force for force in pushing)]
        C = np.pad(system.C, [(0, len(forces)), (0, 0)])
        D = np.vstack([system.D, np.eye(len(forces), system.ninputs, k=wheels)])
        loop = control.ss(system.A, system.B[:, columns], C[rows], D[np.ix_(rows, columns)]).lft(controller)
        states = [*system.state_labels, *(f"controller_{i + 1}" for i in range(controller.nstates))]
        labels = {"inputs": system.input_labels[:wheels], "outputs": outputs, "states": states}
        return LinearVehicle(control.ss(loop.A, loop.B, loop.C, loop.D, **labels), like=self.vehicle)

    def result(self, kind: str, closed: LinearVehicle, given: Any, **more: Any) -> Feedback:
        """What a law on the vehicle as it was given achieves, from its closed loop."""
        vehicle, weighting = given
        return Feedback(
            kind=kind,
            vehicle=vehicle,
            road=self.road,
            metrics=ride_metrics(closed, self.road, weighting=weighting),
            passive=ride_metrics(vehicle, self.road, weighting=weighting),
            closed=closed,
            **more,
        )

    def vehicle_of(self, A: Array, W: Array, C: Array, bent: Array, states: list[str]) -> LinearVehicle:
        """A closed loop over any states, which the road's velocity and its warps drive."""
        import control

        own, k = len(self.layout.outputs), len(self.integrators)
        system = control.ss(
            np.block([[A, bent], [np.zeros((k, len(A) + k))]]),
            np.vstack([W, self.integrators]),
            np.hstack([C, self.standing[1][:own]]),
            self.velocity[1][:own],
            states=[*states, *(f"warp_{i + 1}" for i in range(k))],
            inputs=[f"d{name}" for name in self.layout.inputs],
            outputs=self.layout.outputs.names,
        )
        return LinearVehicle(system, like=self.vehicle)

    def metrics(self, variances: Array) -> xr.Dataset:
        """Root mean squares of the system's outputs as `ride_metrics` labels them."""
        power = self.vehicle.damping() * variances[self.layout.rates]
        roots = np.sqrt(np.where(self.infinite, np.inf, variances[self.rows]))
        space = DesignSpace.over((), "")
        found = labelled_outputs(self.layout, roots[None], power[None], space, long_name="{statistic} {meaning}")
        say_weightings(found, self.weighting)
        return found


def plant(vehicle: Any, road: Any, weighting: Any, what: str) -> Plant:
    """Put together what laws are designed for.

    Raises
    ------
    TypeError, ValueError
        No vehicle with actuators, arrays in it, or a road without a stationary response.
    """
    check_kinds(vehicle, road)
    road.single(what)
    if vehicle.curved:
        raise ValueError(f"{what} needs numbers for ks and cs, got curves; pass linearised(vehicle, road)")
    moved = vehicle.moving(road.speed)
    model = moved.single(what)
    if not hasattr(model, "actuated"):
        raise TypeError(
            f"{what} needs a vehicle between whose wheels and body actuators may push, such as FullCar(), "
            f"got {briefly(vehicle)}"
        )
    check_stationary(moved, road, model)
    A, W, Y, F = map(_one, model.velocity_form())
    B, D = map(_one, model.actuated())
    n, k = len(B), D.shape[1]
    layout = _with_forces(model.layout)
    weighted = filters(weighting, layout)
    bare = System(A[:n, :n], B, np.pad(Y[:, :n], [(0, k), (0, 0)]), np.vstack([D, np.eye(k)]))
    system, through, into, rows, states = _filtered(bare, weighted, layout.outputs)
    F, E = (np.pad(part, [(0, k), (0, 0)]) for part in (F, Y[:, n:]))
    velocity, standing = (np.vstack([W[:n], into @ F]), through @ F), (_below(into @ E, n), through @ E)
    A, B, C, D = system
    sizes = np.sqrt(np.diagonal(scipy.linalg.solve_continuous_lyapunov(A, -velocity[0] @ velocity[0].T)).clip(min=0.0))
    sizes = np.maximum(sizes, STILL * sizes.max())
    met, more = processes(moved, road), np.zeros(k, dtype=bool)
    return Plant(
        vehicle=moved,
        road=road,
        layout=layout,
        system=System(A / sizes[:, None] * sizes, B / sizes[:, None], C * sizes, D),
        weighting=weighted,
        rows=rows,
        infinite=np.append(infinite_outputs(model, met, road).ravel(), more),
        still=np.append(vanishing_outputs(model, met).ravel(), more),
        states=(*layout.relative_states[:n], *states),
        sizes=sizes,
        velocity=(velocity[0] / sizes[:, None], velocity[1]),
        standing=(standing[0] / sizes[:, None], standing[1]),
        model=model,
    )


def _with_forces(layout: Layout) -> Layout:
    """The outputs of a vehicle and the forces of its actuators."""
    forces = tuple(Row(ACTUATION["force"], corner, True) for corner in layout.corners)
    rows = tuple(row._replace(public=True) for row in layout.outputs.rows)
    return replace(layout, outputs=Outputs(rows + forces))


def _places(names: list[str], known: list[str], what: str, which: str) -> list[int]:
    for name in names:
        if name not in known:
            raise ValueError(f"the controller {what} {name!r}, none of the vehicle's {which} {', '.join(known)}")
    return [known.index(name) for name in names]


def _one(x: Any) -> Any:
    return x.reshape(x.shape[-2:])


def _below(x: Array, rows: int) -> Array:
    """The same with so many rows of zeros above."""
    return np.pad(x, [(rows, 0), (0, 0)])


def _filtered(
    system: System, weighted: dict[str, Filter], outputs: Outputs
) -> tuple[System, Array, Array, NDArray[np.int_], list[str]]:
    """Further outputs behind filters, where each output is then found, and the filters' states.

    What adds to the outputs comes through to all of them by a matrix, and into the filters' states by another. Outputs
    that are sums of others share their filters, as the accelerations of a rigid body's points do.
    """
    A, B, C, D = system
    own = len(C)
    through, into, places = np.eye(own), np.zeros((0, own)), np.arange(own)
    states: list[str] = []
    for one, rows in rows_behind(weighted, outputs).items():
        a, b, c, d = _realised(one)
        both = np.hstack([system.C, system.D])[rows]
        both = both / np.abs(both).max(axis=0).clip(min=1e-300)
        chosen = [i for i in range(len(rows)) if _rank(both[: i + 1]) > _rank(both[:i])]
        U = np.linalg.lstsq(both[chosen].T, both.T, rcond=RANK)[0].T
        U[chosen] = np.eye(len(chosen))
        sums = np.eye(own)[rows[chosen]]
        enters = np.kron(sums, b)
        n, size = len(A), len(enters)
        A = np.block([[A, np.zeros((n, size))], [enters @ C[:own], np.kron(np.eye(U.shape[1]), a)]])
        B = np.vstack([B, enters @ D[:own]])
        C = np.block([[C, np.zeros((len(C), size))], [d * C[rows], np.kron(U, c)]])
        D = np.vstack([D, d * D[rows]])
        places[rows] = len(through) + np.arange(len(rows))
        through, into = np.vstack([through, d * np.eye(own)[rows]]), np.vstack([into, enters])
        states += [f"{one.name}_{i + 1}" for i in range(len(states), len(states) + size)]
    return System(A, B, C, D), through, into, places, states


def _rank(rows: Array) -> int:
    return int(np.linalg.matrix_rank(rows, tol=RANK * np.abs(rows).max())) if rows.any() else 0


def _realised(one: Filter) -> tuple[Array, Array, Array, float]:
    """A filter's state space, in states of like size."""
    import scipy.signal

    a, b, c, d = scipy.signal.tf2ss(one.numerator, one.denominator)
    if not len(one.poles):
        return np.zeros((0, 0)), np.zeros((0, 1)), np.zeros((1, 0)), float(one.numerator[0])
    balanced, T = scipy.linalg.matrix_balance(a, permute=False)
    return balanced, np.linalg.solve(T, b), c @ T, float(d[0, 0])


def _noises(
    vehicle: RoadVehicle,
    road: Road,
    model: Any,
    velocity: tuple[Array, Array],
    standing: tuple[Array, Array],
) -> list[Noise]:
    """The noise of each process, given how velocities under wheels and warps that stand move states and outputs."""
    found, taus = [], np.array([float(np.ravel(tau)[0]) for tau in delays(vehicle, road)])
    width = np.reshape(np.asarray(vehicle.track_width, dtype=float), -1)[:1]
    for process in processes(vehicle, road):
        if not process.weights.any():
            continue
        axles = process.axles
        shaped = shaping(colours(road, process.share, process.sign, width))
        wheels, warps = process.weights[axles], integrated(model, process)[0].reshape(len(vehicle.axles), -1)[axles]
        J, gains = len(axles), shaped.gains
        # What integrates holds the integral of a term, -1/rate of it, and of the noise behind it the static gain.
        heights = -gains / shaped.rates
        entering, passing = (wheels @ part.T for part in velocity)
        bent, held = (warps @ part.T for part in standing)
        found.append(
            Noise(
                delays=taus[axles] - taus[axles[0]],
                entries=shaped.direct * entering,
                bank=np.asarray(np.kron(np.eye(J), np.ones(len(gains))), dtype=float),
                held=shaped.static * held,
                bent=shaped.static * bent,
                rates=np.tile(shaped.rates, J),
                pushed=np.kron(entering.T, gains) + np.kron(bent.T, heights),
                seen=np.kron(passing.T, gains) + np.kron(held.T, heights),
            )
        )
    return found
