"""Variances by integrating spectra: any waviness and any coherence, one design at a time."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import cubature

from ..roads.road import Road
from ..vehicles.parameters import DesignSpace
from ..vehicles.vehicle import Vehicle
from .excitation import check_stationary, infinite_outputs, processes
from .frequency import output_density

# The integral runs over log frequency, where algebraic ends become exponential. Slowly decaying spectra (waviness close
# to 1 or to 3) need ends this far out; the integrand costs nothing there.
LOWEST, HIGHEST = 1e-60, 1e60

# From waviness 3 on, the rounding of a response that vanishes with frequency would be raised without bound; what comes
# from below this, in Hz, falls at least with the first power of it.
LOWEST_OF_STEEP = 1e-12

# Front and rear wheels interfere ever faster as frequency rises, and less and less. Well above every resonance, and
# many turns of their phase up, the interference fades out smoothly over a decade, within the tolerance below.
ABOVE, TURNS, FADE = 10.0, 50.0, 10.0

# Relative to each variance, but no finer than to what the wheels would give alone, where their effects cancel.
RELATIVE, CANCELLED = 1e-7, 1e-12


def spectral_variances(flat: Vehicle, space: DesignSpace, road: Road) -> NDArray[np.float64]:
    """Integrate ``S_y(f) df`` over all frequencies: variances (designs, outputs) of all outputs of all designs.

    Adaptive Gauss-Kronrod cubature in log frequency with breaks at the resonances. An output that passes the road's
    velocity straight on has no finite variance unless the waviness exceeds 3.
    """
    return np.stack([_variances(flat.select(slice(i, i + 1)), road.one(i)) for i in range(space.size)])


def _variances(vehicle: Vehicle, road: Road) -> NDArray[np.float64]:
    model = vehicle.assemble()
    check_stationary(vehicle, road, model)
    infinite = infinite_outputs(model, processes(vehicle, road), road).reshape(-1)
    span = np.geomspace(1e-3, 1e3, 1000)
    density = np.sum(np.abs(model.transfer(2.0 * np.pi * span)) ** 2, axis=-1) * road.intensity
    scale = np.trapezoid(density, span, axis=-2).reshape(-1)

    resonances = np.abs(np.linalg.eigvals(model.A)) / (2.0 * np.pi)
    turn = road.speed / (2.0 * np.pi * float(np.max(vehicle.wheelbase))) if np.any(vehicle.wheelbase) else 0.0
    fading = max(ABOVE * resonances.max(), TURNS * turn)

    def integrand(u: NDArray) -> NDArray:
        f = np.exp(u[:, 0])
        fade = np.clip(np.log(f / fading) / np.log(FADE), 0.0, 1.0)
        density = output_density(vehicle, model, road, f, np.cos(0.5 * np.pi * fade) ** 2).reshape(len(f), -1)
        return np.where(infinite, 0.0, density) * f[:, None] / scale

    lowest, highest = np.log(LOWEST if road.slopes[0] < 3.0 else LOWEST_OF_STEEP), np.log(HIGHEST)
    result = cubature(
        integrand,
        [lowest],
        [highest],
        rule="gk21",
        rtol=RELATIVE,
        atol=CANCELLED,
        max_subdivisions=20000,
        points=[np.array([u]) for u in np.unique(np.log(resonances).round(6))],
    )
    if result.status != "converged" and np.any(result.error > 1e-6 * np.abs(result.estimate) + CANCELLED):
        raise ValueError(f"{type(vehicle).__name__}: the integral over the spectrum did not converge to 1e-6")
    return np.where(infinite, np.inf, scale * result.estimate)
