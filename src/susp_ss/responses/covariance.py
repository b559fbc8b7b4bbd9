"""The exact covariance of a vehicle on a random road: one Lyapunov equation, with the wheelbase delay in closed form.

Road velocity is white, or white plus first-order colours of either sign: a low-wavenumber cut-off is one (exactly), the
coherence of an isotropic surface a few (a rational fit). Variance is linear in the spectrum, so that each part adds its
own term to the right-hand side of one equation ``A X + X A^T + Q = 0``. For a process that drives the front by ``B_f``
and, after tau, the rear by ``B_r``, with ``e = e^(A tau) B_f``:

- white of intensity q: ``Q = q (B_f B_f^T + B_r B_r^T + e B_r^T + B_r e^T)``;
- colour of autocorrelation ``s^2 e^(-alpha |t|)``: ``Q = B_f g^T + B_r h^T`` and its transpose, with
  ``g = E[x u(t)]`` and ``h = E[x u(t - tau)]``.

The full car's warp is the integral of a velocity over the delay and joins by its own closed-form moments.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from ..roads import Road
from ..vehicles import Vehicle
from ..vehicles.linkage import SecondOrder
from .excitation import Process, check_kinds, delay, infinite_outputs, processes, refuse_unbounded, refuse_undamped
from .lyapunov import Dynamics
from .spectrum import Spectrum, spectrum

Array = NDArray[np.float64]

# Relative error of the largest entries of a matrix, among which smaller ones must keep their digits too, beyond which a
# design is refused.
LOST_MATRIX = 1e-9

# Designs solved together: their 49 x 49 systems then stay near the processor.
BATCH = 256


class Moments(NamedTuple):
    """Matrices of a batch of designs, covariance (N, 2n [+ 1], 2n [+ 1]) of (p, v [, warp]), its error (N,)."""

    model: SecondOrder
    X: Array
    error: Array
    infinite: NDArray[np.bool_]


def covariance(vehicle: Vehicle, road: Road) -> xr.DataArray:
    """Stationary covariance of the road-relative states.

    Solves ``A X + X A^T + Q = 0`` exactly, the wheelbase delay included, under the assumption that every eigenvalue
    of A lies in the open left half plane. Every metric is one line on top: ``sqrt(diag(C X C^T))``.

    Parameters
    ----------
    vehicle : Vehicle
        Parameters may be arrays; the designs are solved together.
    road : Road
        Waviness 2.

    Returns
    -------
    xarray.DataArray
        On (sweep..., state, state_), in the units of the states of ``vehicle.state_space(input="velocity")``: positions
        relative to the road ``p_...`` (m, rad), velocities ``d...`` (m/s, rad/s) and, for the full car, ``warp`` (m).

    Raises
    ------
    ValueError
        Waviness other than 2, a design that is not asymptotically stable, or a warp without finite variance.

    Examples
    --------
    >>> import numpy as np
    >>> from susp_ss import QuarterCar, Road, covariance
    >>> car, road = QuarterCar(), Road()
    >>> X = covariance(car, road)
    >>> deflection = xr.DataArray([1.0, -1.0, 0.0, 0.0], dims="state", coords={"state": X.state})
    >>> variance = float(deflection.rename(state="state_") @ X @ deflection)
    >>> bool(np.isclose(variance, road.intensity * (car.ms + car.mu) / (2 * car.cs)))
    True
    """
    check_kinds(vehicle, road)
    refuse_waviness(road)
    sweep = vehicle.sweep()
    flat = vehicle.flattened(sweep)
    solved = [moments(vehicle, flat, road, chosen, LOST_MATRIX) for chosen in batches(np.arange(sweep.size), BATCH)]
    states = list(solved[0].model.relative_states)
    X = np.concatenate([batch.X for batch in solved])
    labels = {"state": states, "state_": states}
    return sweep.unflatten(X, ("state", "state_"), labels).rename("covariance")


def refuse_waviness(road: Road) -> None:
    """Say when a road has no finite state-space model."""
    if road.waviness != 2.0:
        raise ValueError(
            f"the covariance route needs waviness 2, got {road.waviness:g}: no finite state-space model of such a "
            'road exists; take ride_metrics(..., method="spectral")'
        )


def batches(designs: NDArray[np.int_], size: int) -> Iterator[NDArray[np.int_]]:
    """The designs, at most ``size`` at a time."""
    return (designs[i : i + size] for i in range(0, len(designs), size))


def lost_digits(vehicle: Vehicle, design: int) -> ValueError:
    """Say which design cannot be computed to six digits."""
    place = dict(zip(vehicle.sweep().dims, np.unravel_index(design, vehicle.sweep().shape), strict=True))
    where = f" at ({', '.join(f'{dim}={i}' for dim, i in place.items())})" if place else ""
    return ValueError(
        f"{type(vehicle).__name__}{where} is damped so lightly or so heavily, has masses and stiffnesses so far apart, "
        "or is so nearly symmetric, that a variance keeps fewer than six digits; pass less extreme parameters, or take "
        'ride_metrics(..., method="spectral")'
    )


def moments(vehicle: Vehicle, flat: Vehicle, road: Road, chosen: NDArray[np.int_], lost: float) -> Moments:
    """Covariance of some designs of a flattened vehicle, each with an error below ``lost``."""
    designs = flat.designs(chosen)
    model = designs.assemble()
    refuse_undamped(vehicle, model)
    refuse_unbounded(vehicle, road, model.warp)
    try:
        with np.errstate(all="ignore"):
            solved = _solved(designs, model, road, len(chosen))
    except np.linalg.LinAlgError:
        raise lost_digits(vehicle, int(chosen[0])) from None
    beyond = ~(solved.error < lost)
    if beyond.any():
        raise lost_digits(vehicle, int(chosen[np.argmax(beyond)]))
    return solved


def _solved(vehicle: Vehicle, model: SecondOrder, road: Road, N: int) -> Moments:
    n = len(model.coordinates)
    root = np.sqrt(model.m)
    scale = 1.0 / (root[..., :, None] * root[..., None, :])
    dynamics = Dynamics(*(np.broadcast_to(x * scale, (N, n, n)) for x in (model.K, model.C)))
    inputs = np.concatenate([-root[..., None] * model.G, model.C_in / root[..., None]], axis=-2)
    tau = np.broadcast_to(delay(vehicle, road), (N,))
    width = np.broadcast_to(vehicle.track_width, (N,)).astype(float)

    Q = np.zeros((N, 2 * n, 2 * n))
    with_warp, warp_variance = np.zeros((N, 2 * n)), np.zeros(N)
    excited = processes(vehicle, road)
    for process in excited:
        parts = spectrum(road, process, width)
        response = _Response(dynamics, inputs, process, parts, tau)
        Q += response.right_hand_side()
        if model.warp is not None:
            cross, own = response.warp(float(model.warp @ process.now), float(model.warp @ process.later))
            with_warp += cross
            warp_variance += own

    X, error = dynamics.lyapunov(Q)
    stretch = np.concatenate([1.0 / root, 1.0 / root], axis=-1)
    X = X * (stretch[..., :, None] * stretch[..., None, :])
    if model.warp is not None:
        X = np.pad(X, [(0, 0), (0, 1), (0, 1)])
        X[:, :-1, -1] = X[:, -1, :-1] = stretch * with_warp
        X[:, -1, -1] = warp_variance
    return Moments(model, X, error, infinite_outputs(model, excited, road))


class _Response:
    """What one process stirs up: correlations of the state x = (p, v) with the process now and a delay ago."""

    def __init__(self, dynamics: Dynamics, inputs: Array, process: Process, parts: Spectrum, tau: Array) -> None:
        N, size = len(tau), inputs.shape[-2]
        self.dynamics, self.parts, self.tau = dynamics, parts, tau
        self.front = np.broadcast_to(inputs @ process.now, (N, size))
        self.rear = np.broadcast_to(inputs @ process.later, (N, size))
        self.delayed = bool(process.later.any())
        if self.delayed:
            self.free, self.forced = dynamics.propagate(self.front, tau, parts.alphas)
        else:
            self.free, self.forced = self.front, np.zeros((N, size, parts.alphas.shape[1]))
        # For a colour u of unit sigma^2: E[x u(t)], and the two halves of E[x u(t - tau)].
        self.decay = np.exp(-parts.alphas * tau[:, None]) if self.delayed else np.ones_like(parts.alphas)
        self.now, self.before = np.empty((2, *self.forced.shape))
        for j, alpha in enumerate(parts.alphas.T):
            sources = np.stack([self.front + self.decay[:, j, None] * self.rear, self.rear + self.free], axis=-1)
            self.now[..., j], self.before[..., j] = np.moveaxis(dynamics.resolvent(alpha, sources), -1, 0)

    def right_hand_side(self) -> Array:
        """The process's share of Q."""
        front, rear, e = self.front, self.rear, self.free
        white = _outer(front, front)
        if self.delayed:
            white = white + _outer(rear, rear) + _outer(e, rear) + _outer(rear, e)
        sigma2 = (0.5 * self.parts.weights * self.parts.alphas)[:, None, :]
        g = (sigma2 * self.now).sum(axis=-1)
        coloured = _outer(front, g) + _outer(g, front)
        if self.delayed:
            h = (sigma2 * (self.before + self.forced)).sum(axis=-1)
            coloured = coloured + _outer(rear, h) + _outer(h, rear)
        return self.parts.white * white + coloured

    def warp(self, now: float, later: float) -> tuple[Array, Array]:
        """``E[x warp]`` and ``E[warp^2]`` of a warp whose rate is ``now * u(t) + later * u(t - tau)``."""
        white, alphas, weights = self.parts
        tau = self.tau[:, None]
        if now + later != 0.0:
            # Bounded by the cut-off alone: the height itself is the sum of colours of variance -weight / (2 alpha).
            height = -0.5 * weights / alphas
            rate = (alphas * height)[:, None, :]
            cross = rate * (now * self.now + later * (self.before - self.forced))
            own = height * (now**2 + later**2 + 2.0 * now * later * self.decay)
            return cross.sum(axis=-1), own.sum(axis=-1)
        if now == 0.0:
            return np.zeros_like(self.front), np.zeros(len(tau))
        # The warp is the process's velocity integrated over the delay.
        sigma2 = 0.5 * weights * alphas
        memory = -np.expm1(-alphas * tau) / alphas
        drift = self.free - self.front
        coloured = (sigma2[:, None, :] * (self.now - self.before - self.forced)).sum(axis=-1)
        coloured += (self.front + self.rear) * (sigma2 * memory).sum(axis=-1, keepdims=True)
        cross = self.dynamics.solve((white * drift - coloured)[..., None])[..., 0]
        own = white * tau[:, 0] + (weights * (tau - memory)).sum(axis=-1)
        return now * cross, now**2 * own


def _outer(x: Array, y: Array) -> Array:
    return x[..., :, None] * y[..., None, :]
