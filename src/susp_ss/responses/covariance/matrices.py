"""The exact covariance of a vehicle on a random road: one Lyapunov equation, with the wheelbase delay in closed form.

Road velocity is white, or white plus first-order colours of either sign: a low-wavenumber cut-off is one (exactly),
the coherence of an isotropic surface a few (a rational fit). Variance is linear in the spectrum, so that each process
and each colour adds its own term to the right-hand side of one equation (`first_order`), which is solved in the
structure of a second-order system (`lyapunov`).
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any, NamedTuple

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from ...roads.colours import colours
from ...roads.road import Road
from ...vehicles.contract import RoadVehicle
from ...vehicles.linear import LinearModel
from ...vehicles.parameters import DesignSpace, SomeDesigns
from ...vehicles.second_order import SecondOrder
from ..excitation import check_kinds, check_stationary, delays, infinite_outputs, integrated, processes, spanned
from .first_order import Correlations, Spectrum
from .lyapunov import Dynamics
from .modal import Modal

Array = NDArray[np.float64]

# Relative error of the largest entries of a matrix, among which smaller ones must keep their digits too, beyond which a
# design is refused.
LOST_MATRIX = 1e-9

# Designs solved together: their 49 x 49 systems then stay near the processor.
BATCH = 256


class Moments(NamedTuple):
    """Matrices of a batch of designs, covariance (N, n + k, n + k) of (p, v) and what integrates, its error (N,).

    ``through`` (N, outputs) is what a road velocity of finite variance adds where it is passed straight on.
    """

    model: Any
    X: Array
    error: Array
    through: Array
    infinite: NDArray[np.bool_]


def covariance(vehicle: RoadVehicle, road: Road) -> xr.DataArray:
    """Stationary covariance of the road-relative states.

    Solves ``A X + X A^T + Q = 0`` exactly, the wheelbase delay included, under the assumption that every eigenvalue
    of A lies in the open left half plane. Every metric is one line on top: ``sqrt(diag(C X C^T))``.

    Parameters
    ----------
    vehicle : Vehicle
        Parameters may be arrays; the designs are solved together.
    road : Road

    Returns
    -------
    xarray.DataArray
        On ``(sweep..., state, state_)``, in the units of the states of ``vehicle.state_space(input="velocity")``:
        positions relative to the road ``p_...`` (m, rad), velocities ``d...`` (m/s, rad/s) and, for the full car,
        ``warp`` (m).

    Raises
    ------
    ValueError
        A design that is not asymptotically stable, or a warp without finite variance.

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
    space, flat, road = spanned(vehicle, road)
    solved = [moments(flat, space, road, chosen, LOST_MATRIX) for chosen in batches(np.arange(space.size), BATCH)]
    states = list(solved[0].model.layout.relative_states)
    X = np.concatenate([batch.model.in_states(batch.X) for batch in solved])
    labels = {"state": states, "state_": states}
    return space.unflatten(X, ("state", "state_"), labels).rename("covariance")


def batches(designs: NDArray[np.int_], size: int) -> Iterator[NDArray[np.int_]]:
    """The designs, at most ``size`` at a time."""
    return (designs[i : i + size] for i in range(0, len(designs), size))


def lost_digits(flat: RoadVehicle, space: DesignSpace | SomeDesigns, design: int) -> ValueError:
    """Say which design cannot be computed to six digits."""
    return ValueError(
        f"{type(flat).__name__}{space.place(design)} is damped so lightly or so heavily, has "
        "masses and stiffnesses so far apart, or is so nearly symmetric, that a variance keeps fewer than six digits; "
        'pass less extreme parameters, or take ride_metrics(..., method="spectral")'
    )


def moments(
    flat: RoadVehicle,
    space: DesignSpace | SomeDesigns,
    road: Road,
    chosen: NDArray[np.int_],
    lost: float,
    seen: Callable[[Any], Any] = lambda model: model,
) -> Moments:
    """Covariance of some designs of a flattened vehicle, each with an error below ``lost``.

    ``seen`` makes of a model one of the same states and other outputs.
    """
    whole, designs, road = road, flat.select(chosen), road.select(chosen)
    model = seen(designs.assemble())
    check_stationary(flat, road, model)
    try:
        with np.errstate(all="ignore"):
            solved = _solved(designs, model, road, len(chosen))
    except np.linalg.LinAlgError:
        # A pivot of exactly zero has lost all digits, like one of rounding: whose it is, halving tells.
        if len(chosen) > 1:
            for half in np.array_split(chosen, 2):
                moments(flat, space, whole, half, lost, seen)
        raise lost_digits(flat, space, int(chosen[0])) from None
    beyond = ~(solved.error < lost)
    if beyond.any():
        raise lost_digits(flat, space, int(chosen[np.argmax(beyond)]))
    return solved


class System(NamedTuple):
    """``x' = A x + inputs w`` in coordinates that a solver likes; ``stretch`` (..., n) takes them back."""

    dynamics: Any
    inputs: Array
    stretch: Array


def _second_order(model: SecondOrder, N: int) -> System:
    n = len(model.layout.coordinates)
    root = np.sqrt(model.m)
    scale = 1.0 / (root[..., :, None] * root[..., None, :])
    dynamics = Dynamics(*(np.broadcast_to(x * scale, (N, n, n)) for x in (model.K, model.C)))
    inputs = np.concatenate([-root[..., None] * model.G, model.C_in / root[..., None]], axis=-2)
    return System(dynamics, inputs, np.concatenate([1.0 / root, 1.0 / root], axis=-1))


def _first_order(model: LinearModel) -> System:
    n = model.A.shape[-1]
    return System(Modal(model.A, model.rates, model.vectors), model.velocity_form()[1][..., :n, :], np.ones(n))


def _solved(vehicle: RoadVehicle, model: Any, road: Road, N: int) -> Moments:
    dynamics, inputs, stretch = _second_order(model, N) if model.second_order else _first_order(model)
    n, k = inputs.shape[-2], model.integrators.shape[-2]
    taus = [np.broadcast_to(tau, (N,)).astype(float) for tau in delays(vehicle, road)]
    width = np.broadcast_to(vehicle.track_width, (N,)).astype(float)

    Y, D = model.velocity_form()[2:]
    on_states, on_integrals = Y[..., :n] * stretch[..., None, :], np.broadcast_to(Y[..., n:], (N, Y.shape[-2], k))
    Q, through = np.zeros((N, n, n)), np.zeros((N, Y.shape[-2]))
    with_drift, of_drift = np.zeros((N, n, k)), np.zeros((N, k, k))
    excited = processes(vehicle, road)
    for process in excited:
        terms, axles = colours(road, process.share, process.sign, width), process.axles
        spectrum = Spectrum(terms.white[:, :, None], terms.alphas, terms.weights)
        entries = [np.broadcast_to(inputs @ process.weights[axle], (N, n))[..., None] for axle in axles]
        met = [taus[axle] for axle in axles]

        def carry(i: int, j: int, entries: Any = entries, met: Any = met, alphas: Any = terms.alphas) -> Any:
            return dynamics.propagate(entries[i][..., 0], met[j] - met[i], alphas)

        stirred = Correlations(dynamics, entries, met, carry, spectrum)
        Q += stirred.right_hand_side()
        each, drift = integrated(model, process)
        rates, bounded = [np.broadcast_to(each[axle], (N, k)) for axle in axles], bool(drift.any())
        if each.any():
            cross, own = stirred.integrated(rates, bounded)
            with_drift += cross
            of_drift += own
        if road.velocity_is_bounded and D.any():
            feeds = [np.broadcast_to(D @ process.weights[axle], through.shape) for axle in axles]
            through += stirred.passed_on(feeds, on_states, on_integrals, rates, bounded)

    X, error = dynamics.lyapunov(Q)
    X = X * (stretch[..., :, None] * stretch[..., None, :])
    if k:
        X = np.pad(X, [(0, 0), (0, k), (0, k)])
        X[:, :n, n:] = stretch[..., None] * with_drift
        X[:, n:, :n] = X[:, :n, n:].mT
        X[:, n:, n:] = of_drift
    return Moments(model, X, error, through, infinite_outputs(model, excited, road))
