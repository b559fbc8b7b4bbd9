"""Moments of the spectra of outputs, ``m_k = int |omega|^k S d omega``: what rates and extremes are made of.

Even ones are variances of the outputs and of their derivatives, rows ``Y``, ``Y A`` and ``Y A A`` of the same states.
The first is one, too: ``|omega| = (2/pi) int_0^inf omega^2 / (alpha^2 + omega^2) d alpha`` is a sum of first-order
terms, and such terms may as well stand on the road. By the trapezoidal rule over ``ln alpha`` they are ``|omega|`` to
1e-10; what they lack at either end has a closed form.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...roads.colours import Colours
from ...roads.road import Road
from ...vehicles.contract import Model, RoadVehicle
from ...vehicles.parameters import DesignSpace
from ...vehicles.second_order import CARRIED
from .routes import by_matrices

Array = NDArray[np.float64]

# Step of ln alpha, with an error of exp(-pi^2 / STEP), and how far beyond the modes alpha goes.
STEP, BEYOND = 0.4, 1e4


class SpectralMoments(NamedTuple):
    """Of outputs, (designs, rows) each: infinite where it has no finite value, NaN where that is not known."""

    m0: Array
    m1: Array
    m2: Array
    m4: Array


def spectral_moments(
    flat: RoadVehicle, space: DesignSpace, road: Road, rows: NDArray[np.int_], chosen: NDArray[np.int_]
) -> SpectralMoments:
    """Moments of some rows of the output table, of some designs of a flattened vehicle."""

    def seen(model: Model) -> Any:
        return Differentiated(model, rows)

    here, model = road.select(chosen), flat.select(chosen).assemble()
    m0, m2, m4 = np.split(by_matrices(flat, space, road, chosen, seen), 3, axis=1)
    improper = Differentiated(model, rows).improper
    # A rate of the road's velocity has no finite variance, but under a contact from waviness 3 on.
    unknown = np.nan if road.contact_length and road.slopes[1] > 3.0 else np.inf
    m2, m4 = np.where(improper[0], unknown, m2), np.where(improper[1], unknown, m4)

    rates = np.abs(np.linalg.eigvals(model.A))
    levelled = np.max(here.speed) / road.contact_length if road.contact_length else 0.0
    magnitude = Magnitude(rates.min() / BEYOND, max(rates.max(), levelled) * BEYOND)
    m1 = by_matrices(flat, space, road.weighted(magnitude), chosen, lambda model: Differentiated(model, rows, 0))
    m1 = np.where(np.isfinite(m2), m1 + magnitude.rest * np.where(np.isfinite(m2), m2, 0.0), m2)
    return SpectralMoments(m0, m1, m2, m4)


class Magnitude:
    """``|omega|`` as what a weighting does to a spectrum, for frequencies well between two rates in rad/s."""

    strictly_proper = False

    def __init__(self, lowest: float, highest: float):
        alphas = np.exp(np.arange(np.log(lowest), np.log(highest), STEP))[None]
        weights, beyond = 2.0 / np.pi * STEP * alphas, 2.0 / np.pi * STEP / np.expm1(STEP)
        level = np.array([[beyond * alphas[0, 0]]])
        self.colours = Colours(level, alphas, np.zeros_like(alphas), weights)
        self.rest = beyond / alphas[0, -1]
        """Times ``omega^2``, what it lacks at high frequency."""

    def select(self, designs: object) -> Magnitude:
        """The same for any designs."""
        return self


class Differentiated:
    """A `Model` of which some outputs and their derivatives in time, up to an order, are seen."""

    def __init__(self, model: Model, rows: NDArray[np.int_], order: int = 2):
        self._model, self._rows, self._order = model, rows, order
        A, B, Y, D = model.velocity_form()
        Y, D = Y[..., rows, :], D[..., rows, :]
        seen, passed = [Y], [D]
        for _ in range(order):
            # What a row passes on of the velocity itself; that of the row before, differentiated, is `improper`.
            now, terms = Y @ B, np.abs(Y) @ np.abs(B)
            Y = Y @ A
            seen.append(Y)
            passed.append(np.where(np.abs(now) > CARRIED * terms, now, 0.0))
        self.improper = np.logical_or.accumulate([np.any(D != 0.0, axis=-1) for D in passed[:-1]])
        self._form = A, B, np.concatenate(np.broadcast_arrays(*seen), axis=-2), np.concatenate(passed, axis=-2)

    def __getattr__(self, name: str) -> Any:
        return getattr(self._model, name)

    def velocity_form(self) -> tuple[Array, Array, Array, Array]:
        """A, B, Y and D over x, and what integrates behind it."""
        return self._form

    @property
    def on_road_velocity(self) -> Array:
        """Outputs per road velocity passed straight on, (designs..., outputs, inputs)."""
        return self._form[3]

    @property
    def on_integrators(self) -> Array:
        """Outputs per what integrates, (designs..., outputs, k)."""
        return self._form[2][..., self._model.A.shape[-1] :]

    def relative_transfer(self, omega: Array) -> NDArray[np.complex128]:
        """Of every output what it was made of: derivatives vanish where that does."""
        H = self._model.relative_transfer(omega)[..., self._rows, :, :]
        return np.concatenate([H] * (self._order + 1), axis=-3)
