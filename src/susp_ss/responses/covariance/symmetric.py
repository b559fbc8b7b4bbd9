"""Variances of a left-right symmetric vehicle: one problem a half, on its share of the road, added up."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...quantities import signal
from ...roads import colours as roads
from ...roads.road import Road
from ...vehicles.contract import RoadVehicle
from ...vehicles.decoupled import OnStruts
from ...vehicles.second_order import Outputs
from ..excitation import Process, delays, processes, steep
from . import digits, polynomials
from .polynomials import Array, Body, Colours, Delay, OneStrut, Track, TwoStruts

# A delay is walked in steps in which no root turns by more than this many radians: e^(s h) mod D keeps its digits.
REACH = 16.0

# Damping, as a share of its critical value, from which variances keep ten digits; and how well two systems of units
# must agree for six digits to be sure.
LIGHT, AGREED = 1e-3, 1e-7


class Problem(NamedTuple):
    """One half on its share of the road, as arrays over N designs.

    ``struts`` (struts, 5, N) stand for the corners ``places``; ``accelerations`` of further points by name, per force
    of each strut (struts, N).
    """

    places: tuple[tuple[str, ...], ...]
    struts: Array
    body: Body
    accelerations: dict[str, Array]
    road: Track
    tau: Array
    delayed: bool

    def variances(self, kernels: Any, walk: tuple[int, int]) -> dict[str, Array]:
        """Variance (N,) of every output, by the kernels of `polynomials` or `polynomials_numba`."""
        compliance = self.body.compliance
        if len(self.struts) == 1:
            one = OneStrut._make(kernels.one_strut(self.struts[0], compliance[0, 0], self.road))
            forces, deflections, rates, loads = np.array([[one.force]]), [one.deflection], [one.rate], [one.load]
            tyres = [one.tyre]
        else:
            damped = bool(self.struts[:, 4].any())
            two = TwoStruts._make(kernels.two_struts(self.struts, self.body, self.road, Delay(self.tau, *walk), damped))
            forces = np.array([[two.force_1, two.force_12], [two.force_12, two.force_2]])
            deflections, rates = [two.deflection_1, two.deflection_2], [two.rate_1, two.rate_2]
            loads, tyres = [two.load_1, two.load_2], [two.tyre_1, two.tyre_2]

        # Accelerations per force of each strut: of further points, then of the mounts over the struts.
        shares = np.stack([*self.accelerations.values(), *compliance])
        terms = shares[:, :, None] * shares[:, None] * forces
        accelerations = digits.sum_or_nan(terms.sum(axis=(1, 2)), np.abs(terms).sum(axis=(1, 2)))
        out = dict(zip(self.accelerations, accelerations, strict=False))
        mounts = accelerations[len(out) :]
        for i, corners in enumerate(self.places):
            loads[i][self.struts[i, 4] > 0.0] = np.inf
            values = {"bacc": mounts[i], "sws": deflections[i], "dtl": loads[i], "sws_rate": rates[i]}
            values["tyre_deflection"] = tyres[i]
            out |= {signal(kind, corner): variance for corner in corners for kind, variance in values.items()}
        return out

    def walk(self) -> tuple[int, int]:
        """Steps over every delay, and halvings of each."""
        return digits.walk(float(digits.turns(self.struts, self.body.compliance, self.tau).max()), REACH)

    def in_other_units(self) -> Problem:
        """The same problem with mass and time in other units."""
        return self._replace(
            struts=digits.struts_in_other_units(self.struts),
            body=Body(self.body.compliance / digits.MASS, self.body.rigidity / digits.MASS**2, self.body.rolls),
            accelerations={name: per_force / digits.MASS for name, per_force in self.accelerations.items()},
            road=digits.track_in_other_units(self.road),
            tau=self.tau * digits.TIME,
        )


def problems(halves: Sequence[OnStruts], vehicle: RoadVehicle, road: Road, N: int) -> list[Problem]:
    """The halves of N designs on a road as problems.

    None where a damped tyre passes on a velocity of finite variance, which these polynomials do not hold, or the road
    warps the wheels without bound.
    """
    if road.velocity_is_bounded and any(np.any(strut.ct) for half in halves for strut in half.struts.values()):
        return []
    tau = np.broadcast_to(np.asarray(delays(vehicle, road)[-1], dtype=float), N)
    width = np.broadcast_to(np.asarray(vehicle.track_width, dtype=float), N)
    excited = processes(vehicle, road)
    if any(steep(difference, road) and difference.delayed for difference in excited[1:]):
        return []
    # On identical tracks the half difference of left and right is nothing.
    pairs = zip(halves, excited, strict=False)
    return [_problem(half, road, process, tau, width) for half, process in pairs]


def _problem(half: OnStruts, road: Road, process: Process, tau: Array, width: Array) -> Problem:
    N = len(tau)
    spectrum = roads.colours(road, process.share, process.sign, width)
    count = range(len(half.struts))
    body = half.body.items()
    per_force = {name: [mode.mobility * arm for arm in mode.arms] for name, mode in body}
    return Problem(
        places=tuple(half.struts),
        struts=np.stack([columns(N, strut) for strut in half.struts.values()]),
        body=Body(
            np.stack([columns(N, [half.compliance(i, j) for j in count]) for i in count]),
            columns(N, [half.rigidity()])[0],
            len(body) == 1,
        ),
        accelerations={
            name: columns(N, [sum(share * per_force[mode][i] for mode, share in shares.items()) for i in count])
            for name, shares in half.points.items()
        },
        road=as_track(spectrum),
        tau=tau,
        delayed=process.delayed,
    )


def columns(N: int, rows: Sequence[Any]) -> Array:
    """Numbers, or one a design, as rows (..., N) in memory order."""
    out = np.empty((len(rows), N))
    for row, values in zip(out, rows, strict=True):
        row[:] = values
    return out


def as_track(spectrum: roads.Colours) -> Track:
    """A spectrum with its terms as rows, those of complex rates apart."""
    complex_rates = np.imag(spectrum.alphas).any(axis=0)
    terms = spectrum.alphas, spectrum.low, spectrum.high
    real = (np.ascontiguousarray(term[:, ~complex_rates].real.T) for term in terms)
    swinging = (np.ascontiguousarray(term[:, complex_rates].T, dtype=complex) for term in terms)
    return Track(np.ascontiguousarray(spectrum.level[:, 0]), Colours(*real), Colours(*swinging))


def symmetric_variances(
    halves: Sequence[OnStruts], vehicle: RoadVehicle, road: Road, N: int, kernels: Any = polynomials
) -> tuple[Array, NDArray[np.bool_]]:
    """Variances (outputs, N) of N designs by their halves, and which of them (N,) are left to matrices.

    All are where no damper reaches a wheel, or the delay is very long; and each one is that may keep fewer than six
    digits here.
    """
    parts, outputs = problems(halves, vehicle, road, N), vehicle.layout().outputs
    with np.errstate(all="ignore"):
        walks = [part.walk() if part.delayed else (0, 0) for part in parts]
        stuck = any(digits.undamped(part.struts).any() for part in parts)
        if not parts or stuck or max(walks)[0] > digits.LONGEST_WALK:
            return np.full((len(outputs), N), np.nan), np.ones(N, dtype=bool)
        variances = total(parts, walks, outputs, kernels)
        if not any(digits.extreme(part.struts, part.body.compliance, LIGHT) for part in parts):
            return variances, np.logical_or.reduce(np.isnan(variances))
        other = total([part.in_other_units() for part in parts], walks, outputs, kernels)
    return variances, digits.disagreement(variances, other, outputs, AGREED)


def total(parts: Sequence[Any], walks: Sequence[Any], outputs: Outputs, kernels: Any) -> Array:
    """Variances (outputs, N) of all parts together; what none of them moves has none."""
    found = [part.variances(kernels, walk) for part, walk in zip(parts, walks, strict=True)]
    still = np.zeros_like(next(iter(found[0].values())))
    return np.array([sum((each[name] for each in found if name in each), still) for name in outputs.names])
