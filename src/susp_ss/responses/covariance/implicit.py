"""How linearised rates follow parameters: the fixed point of `linearisation`, differentiated implicitly.

Rates ``r`` (c and k at every corner with a curve) are functions of variances and means, these of rates and parameters:
``dr = M dr + b dp``. What the variances do with rates is known from `tangents`; the means of a law are one another's
derivatives, along the mean each the next, along a variance half the one after the next.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...vehicles.curves import Curve
from ...vehicles.laws import Means
from ...vehicles.vehicle import Vehicle
from ..settings import Setting
from .dual import Dual
from .linearisation import Linearised
from .tangents import STEP, Tangents, stepped_along

Array = NDArray[np.float64]


class Curved(NamedTuple):
    """A rate in place of a curve: its field, and the wheel by number and name."""

    field: str
    at: int
    wheel: str


def curved_rates(flat: Vehicle) -> list[Curved]:
    """Every rate that stands for a curve."""
    return [
        Curved(field, at, wheel)
        for field in ("cs", "ks")
        for at, (wheel, value) in enumerate(zip(flat.wheels, flat.at_wheels(field), strict=True))
        if isinstance(value, Curve)
    ]


def as_settings(flat: Vehicle, rates: Sequence[Curved]) -> list[Setting]:
    """The same as settings of the linear car."""
    known = flat.quantities()
    return [Setting(rate.field, (rate.wheel,) if flat.per_corner else None, known[rate.field]) for rate in rates]


class Following:
    """How rates and means of N designs follow P settings.

    Parameters
    ----------
    flat : Vehicle
        A flattened vehicle with curves, of these designs.
    straight : Linearised
        What it was linearised to, of these designs.
    settings : sequence of Setting
    tangents : ndarray, (P + R, N, outputs)
        Of the linear car's variances along the settings, then along the R rates.
    """

    def __init__(self, flat: Vehicle, straight: Linearised, settings: Sequence[Setting], tangents: Array):
        self.flat, self.straight, self.settings = flat, straight, settings
        self.rates = curved_rates(flat)
        self.P, self.N = len(settings), tangents.shape[1]
        self.on_curves = np.array(
            [[s.field == r.field and s.at(r.wheel) for r in self.rates] for s in settings], dtype=float
        )
        # Along settings with the rates held, and along rates.
        held, along, table = self.held(tangents), tangents[self.P :], flat.layout().outputs
        (v_p, v_r), (d_p, d_r) = (
            (np.moveaxis(held[..., rows], 0, -1), np.moveaxis(along[..., rows], 0, -1))
            for rows in (table.of("sws_rate"), table.of("sws"))
        )
        self.of_rates, self.shift = self._solved(v_p, v_r, d_p, d_r)

    def held(self, tangents: Array) -> Array:
        """Tangents (P, N, outputs) along the settings where the rates in place of curves stay."""
        return np.asarray(tangents[: self.P] - np.einsum("pr,rn...->pn...", self.on_curves, tangents[self.P :]))

    def total(self, tangents: Array) -> Array:
        """Tangents (P, N, outputs) along the settings, with all that follows."""
        return np.asarray(self.held(tangents) + np.einsum("nrp,rn...->pn...", self.of_rates, tangents[self.P :]))

    def _solved(self, v_p: Array, v_r: Array, d_p: Array, d_r: Array) -> tuple[Array, Array]:
        """Tangents (N, R, P) of the rates and (N, corners, P) of the mean deflections."""
        N, state = self.N, self.straight.state
        damper, spring = _columns(state.damping, N), _columns(state.stiffness, N)
        # By itself a setting scales a damper, and exchanges a spring beside what else the curve has.
        own_c, own_f0, own_k, own_f = (np.zeros((N, len(state.cs), self.P)) for _ in range(4))
        for r, (field, at, _) in enumerate(self.rates):
            along = self.on_curves[:, r]
            if field == "cs" and along.any():
                rate = np.broadcast_to(self.flat.at_wheels("cs")[at].rate, N)[:, None]
                own_c[:, at] += damper.slope[:, at, None] / rate * along
                own_f0[:, at] += damper.force[:, at, None] / rate * along
            elif field == "ks":
                own_k[:, at] += along
                own_f[:, at] += state.mean[:, at, None] * along

        yielding, geometry = self._equilibrium()
        half_v, half_d = 0.5 * damper.curvature[..., None], 0.5 * spring.curvature[..., None]
        m_r = yielding @ (half_v * v_r + half_d * d_r)
        m_p = geometry + yielding @ (half_v * v_p + half_d * d_p + own_f0 + own_f)
        c_r, c_p = 0.5 * damper.third[..., None] * v_r, 0.5 * damper.third[..., None] * v_p + own_c
        k_r = spring.curvature[..., None] * m_r + 0.5 * spring.third[..., None] * d_r
        k_p = spring.curvature[..., None] * m_p + 0.5 * spring.third[..., None] * d_p + own_k
        M = np.stack([(c_r if field == "cs" else k_r)[:, at] for field, at, _ in self.rates], axis=1)
        b = np.stack([(c_p if field == "cs" else k_p)[:, at] for field, at, _ in self.rates], axis=1)
        of_rates = np.linalg.solve(np.eye(len(self.rates)) - M, b)
        return of_rates, m_p + m_r @ of_rates

    def _equilibrium(self) -> tuple[Array, Array]:
        """Mean deflections per force at each corner (N, corners, corners), and along the settings (N, corners, P)."""
        car, state = self.straight.vehicle, self.straight.state
        model, corners = car.assemble(), len(state.cs)
        R = np.broadcast_to(model.R[..., model.suspensions, :], (self.N, corners, model.R.shape[-1]))
        inverse = np.linalg.inv(model.K)
        damper, spring = _columns(state.damping, self.N), _columns(state.stiffness, self.N)
        curved = np.array([isinstance(x, Curve) for x in self.flat.at_wheels("ks")])
        k = np.stack([np.broadcast_to(x, self.N) for x in state.ks], axis=-1)
        force = damper.force + np.where(curved, spring.force - k * state.mean, 0.0)
        q = -inverse @ (R.mT @ force[..., None])
        moved = stepped_along(car, self.settings, {(rate.field, rate.wheel) for rate in self.rates}).assemble()
        dK, dR = (np.imag(x) / STEP for x in (moved.K, moved.R[..., moved.suspensions, :]))
        change = -inverse @ (dK @ q + dR.mT @ force[..., None])
        geometry = np.broadcast_to((R @ change + dR @ q)[..., 0], (self.P, self.N, corners))
        return -R @ inverse @ R.mT, np.moveaxis(geometry, 0, -1)


def followed(tangents: Tangents, follow: Following) -> Tangents:
    """Tangents of the linear car along settings and rates as tangents along the settings, with all that follows."""
    damping = Dual(tangents.damping.value, follow.total(tangents.damping.tangent))
    return Tangents(follow.total(tangents.variances), tangents.kinked[: follow.P], damping)


def _columns(means: Sequence[Means | None], N: int) -> Means:
    """Means (N, corners), zero where there is no curve."""
    every = [one or (0.0,) * 4 for one in means]
    return Means(*(np.stack([np.broadcast_to(part, N) for part in parts], -1) for parts in zip(*every, strict=True)))
