"""Variances of a left-right symmetric vehicle: one problem a section, on its share of the road, added up."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..roads import Road
from ..vehicles import Vehicle
from ..vehicles.linkage import signal
from ..vehicles.sections import Section
from . import base_process
from .base_process import Array
from .excitation import Process, delay, processes
from .spectrum import spectrum

# A delay is walked in steps in which no root turns by more than this many radians: e^(s h) mod D keeps its digits.
REACH = 16.0

# A delay of more steps than this (a walking pace) is left to matrices, which square their way through it.
LONGEST_WALK = 256

# An acceleration whose variance is at most the first share of its terms is zero by symmetry; up to the second, it may
# have lost digits.
ZERO, CANCELLED = 1e-14, 1e-9

# Ratios of masses, of stiffnesses, and of damping to its critical value, within which variances keep ten digits. Beyond
# them they are computed in two systems of units, which must agree to this for six digits to be sure.
SPREAD, LIGHT, HEAVY = 300.0, 1e-3, 30.0
AGREED = 1e-7
OTHER_MASS, OTHER_TIME = 0.73, 1.37


class Problem(NamedTuple):
    """One section on its share of the road, as arrays over N designs; ``body`` is mobility times arm of each strut."""

    places: tuple[tuple[str, ...], ...]
    struts: Array
    body: dict[str, Array]
    compliance: Array
    rigidity: Array
    delayed: bool
    static: float
    alphas: Array
    weights: Array
    tau: Array

    def variances(self, kernels: Any, steps: int, halvings: int) -> dict[str, Array]:
        """Variance (N,) of every output, by the kernels of `base_process` or `lanes`."""
        road = self.static, self.alphas, self.weights
        if len(self.struts) == 1:
            F, *rest = kernels.one_strut(self.struts[0], self.compliance[0, 0], *road)
            force = [[F]]
        else:
            body = self.compliance, self.rigidity, len(self.body) == 1, bool(self.struts[:, 4].any())
            F1, F2, F12, *rest = kernels.two_struts(self.struts, *body, *road, self.tau, steps, halvings)
            force = [[F1, F12], [F12, F2]]

        def acceleration(weights: Array) -> Array:
            terms = [u * v * force[i][j] for i, u in enumerate(weights) for j, v in enumerate(weights)]
            total, size = sum(terms), sum(map(np.abs, terms))
            return np.where(total > CANCELLED * size, total, np.where(np.abs(total) < ZERO * size, 0.0, np.nan))

        count = len(self.struts)
        out = {name: acceleration(weights) for name, weights in self.body.items()}
        for i, places in enumerate(self.places):
            deflection, rate, load = rest[i::count]
            load[self.struts[i, 4] > 0.0] = np.inf
            values = {"bacc": acceleration(self.compliance[i]), "sws": deflection, "dtl": load, "dsws": rate}
            out |= {signal(kind, place): variance for place in places for kind, variance in values.items()}
        return out

    def steps(self) -> tuple[int, int]:
        """How many steps reach every delay, and how often each halves before no root turns by a radian in it."""
        if not self.delayed:
            return 0, 0
        mu, ks, cs, kt, ct = np.moveaxis(self.struts, 1, 0)

        def bound(spring: Array, tyre: Array, unit: float) -> float:
            """Largest row sum of the springs' matrix over the masses, the body's coordinates in this unit."""
            at_body = np.einsum("ijn,jn->in", np.abs(self.compliance), (1.0 + 1.0 / unit) * spring)
            return max(float(at_body.max()), float((((1.0 + unit) * spring + tyre) / mu).max()))

        def fastest(unit: float) -> float:
            half = 0.5 * bound(cs, ct, unit)
            return half + np.sqrt(half**2 + bound(ks, kt, unit))

        # Any unit bounds the roots; a small one does so tightly where the wheels are faster than the body.
        turns = min(fastest(1.0), fastest(0.25)) * float(self.tau.max())
        steps = int(np.ceil(turns / REACH))
        return steps, max(0, int(np.ceil(np.log2(turns / steps))))

    def undamped(self) -> bool:
        """Whether some wheel has no damper at all."""
        return bool(((self.struts[:, 2] == 0.0) & (self.struts[:, 4] == 0.0)).any())

    def extreme(self) -> bool:
        """Whether some design is so far from any vehicle that its digits have to be counted."""
        mu, ks, cs, kt, ct = np.moveaxis(self.struts, 1, 0)
        masses = np.concatenate([mu, 1.0 / np.einsum("iin->in", self.compliance)])
        stiffnesses = np.concatenate([ks, kt])
        damping = (cs + ct) / np.sqrt((ks + kt) * mu)
        spread = max(float((x.max(axis=0) / x.min(axis=0)).max()) for x in (masses, stiffnesses))
        return not (spread < SPREAD and damping.min() > LIGHT and damping.max() < HEAVY)

    def in_other_units(self) -> Problem:
        """The same problem with mass and time in other units: the same result but for rounding."""
        mass, time = OTHER_MASS, OTHER_TIME
        force = mass / time**2
        return self._replace(
            struts=self.struts * np.array([mass, force, force * time, force, force * time])[:, None],
            body={name: weights / mass for name, weights in self.body.items()},
            compliance=self.compliance / mass,
            rigidity=self.rigidity / mass**2,
            static=self.static / time,
            alphas=self.alphas / time,
            weights=self.weights / time,
            tau=self.tau * time,
        )


def problems(vehicle: Vehicle, road: Road, N: int) -> list[Problem]:
    """Split N designs on a road into problems; none where left and right differ, or no such split exists."""
    if road.wheels is not None and not set(vehicle.wheels) <= set(road.wheels):
        return []
    tau = np.broadcast_to(np.asarray(delay(vehicle, road), dtype=float), N)
    width = np.broadcast_to(np.asarray(vehicle.track_width, dtype=float), N)
    # On identical tracks the half difference of left and right is nothing.
    pairs = zip(vehicle.sections(), processes(vehicle, road), strict=False)
    return [_problem(section, road, process, tau, width) for section, process in pairs]


def _problem(section: Section, road: Road, process: Process, tau: Array, width: Array) -> Problem:
    def stacked(rows: Any) -> Array:
        out = np.empty((len(rows), len(tau)))
        for row, values in zip(out, rows, strict=True):
            row[:] = values
        return out

    parts = spectrum(road, process, width)
    count = range(len(section.struts))
    return Problem(
        places=tuple(section.struts),
        struts=np.stack([stacked(strut) for strut in section.struts.values()]),
        body={name: stacked([mode.mobility * arm for arm in mode.arms]) for name, mode in section.body.items()},
        compliance=np.stack([stacked([section.compliance(i, j) for j in count]) for i in count]),
        rigidity=stacked([section.rigidity()])[0],
        delayed=bool(process.later.any()),
        static=0.0 if road.cutoff else road.intensity * (process.share + 0.5 * process.sign),
        alphas=np.ascontiguousarray(parts.alphas.T),
        weights=np.ascontiguousarray(parts.weights.T),
        tau=tau,
    )


def symmetric_variances(
    vehicle: Vehicle, road: Road, outputs: tuple[str, ...], N: int, kernels: Any = base_process
) -> tuple[Array, NDArray[np.bool_]]:
    """Variances (outputs, N) of N designs, and which of them (N,) are left to matrices.

    All are where left and right differ, a wheel sees no road, no damper reaches a wheel, or the delay is very long; and
    each one is that may keep fewer than six digits here.
    """
    parts = problems(vehicle, road, N)
    with np.errstate(all="ignore"):
        walks = [part.steps() for part in parts]
        if not parts or any(part.undamped() for part in parts) or max(walks)[0] > LONGEST_WALK:
            return np.full((len(outputs), N), np.nan), np.ones(N, dtype=bool)
        variances = _total(parts, walks, outputs, kernels)
        if not any(part.extreme() for part in parts):
            return variances, np.logical_or.reduce(np.isnan(variances))
        other = _total([part.in_other_units() for part in parts], walks, outputs, kernels)
    acceleration, force = OTHER_TIME**-4.0, OTHER_MASS**2 * OTHER_TIME**-4.0
    units = {"sws": 1.0, "dtl": force, "dsws": OTHER_TIME**-2.0}
    other /= np.array([units.get(name.split("_")[0], acceleration) for name in outputs])[:, None]
    apart = (variances != other) & ~(np.abs(variances - other) < AGREED * variances)
    return variances, np.logical_or.reduce(apart)


def _total(parts: list[Problem], walks: list[tuple[int, int]], outputs: tuple[str, ...], kernels: Any) -> Array:
    total = np.zeros((len(outputs), len(parts[0].tau)))
    for part, walk in zip(parts, walks, strict=True):
        for name, variance in part.variances(kernels, *walk).items():
            total[outputs.index(name)] += variance
    return total
