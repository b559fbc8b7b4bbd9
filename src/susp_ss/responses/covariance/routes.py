"""The variances of all outputs of all designs, each by the fastest exact way that it admits.

- Designs that fall into halves (left and right alike, struts on a rigid body) go by polynomials (`symmetric`), a block
  of them at a time: a microsecond or two each.
- The rest, and those that would lose digits there, take the Lyapunov equation of their matrices: in batches
  (`matrices`), some hundred microseconds each, or once they are very many design by design in compiled code on every
  processor (`matrices_numba`), some tens of microseconds; without a compiler in batches, too.

What a way needs is stated by the vehicle (`Vehicle.halves`) or by its matrices; what lacks it takes the next. The
choice shows in nothing but time. Against 80-bit arithmetic, over a thousand random full cars each on isotropic tracks,
polynomials err by at most 3e-13 with parameters within a factor 2 of a car's, 2e-10 over two decades of every mass and
stiffness, 2e-8 over three (99 % below 1e-9), and 3e-9 with damping down to a millionth. Designs beyond the bounds of
`symmetric` are computed in two systems of units; those that differ go to matrices, which measure their own error, and
what keeps fewer than six digits there is refused.
"""

from __future__ import annotations

import os
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...roads.colours import colours
from ...roads.road import Road
from ...vehicles.contract import Model, RoadVehicle
from ...vehicles.parameters import DesignSpace
from ..excitation import Process, check_stationary, delay, infinite_outputs, processes, vanishing_outputs
from . import polynomials
from .compiler import compiler_found
from .matrices import BATCH, batches, lost_digits, moments
from .symmetric import symmetric_variances

Array = NDArray[np.float64]

# Relative error of a variance beyond which it is refused, and the error of a sound solution. Of a sound one, a variance
# no larger than its rounding is zero by symmetry; one that near symmetry leaves small keeps the digits of its terms.
LOST, SOUND = 1e-6, 1e-12

# Designs of one block: its polynomials then stay near the processor. Compiled code keeps them there by itself.
BLOCK, LONG_BLOCK = 2048, 8192

# Symmetric designs, and designs by matrices, from which loading the compiler (a second; at first use on a machine ten
# to thirty) is repaid.
PLENTY, MANY = 1_000_000, 50_000

# Designs by matrices that a thread takes at a time.
SHARE = 512


def covariance_variances(flat: RoadVehicle, space: DesignSpace, road: Road, designs: int = 1) -> Array:
    """Variances (designs, outputs) of all outputs of a flattened vehicle's designs; `inf` where white velocity passes.

    These may be part of a sweep of more ``designs``, whose number decides what is worth compiling.
    """
    halves = flat.halves()
    variances = np.empty((len(flat.layout().outputs), space.size))
    left = np.zeros(space.size, dtype=bool)

    def solve(block: slice, kernels: Any = polynomials) -> None:
        some, size = [half.select(block) for half in halves], block.stop - block.start
        here = flat.select(block), road.select(block)
        variances[:, block], left[block] = symmetric_variances(some, *here, size, kernels)

    if max(designs, space.size) < PLENTY or not halves or not compiler_found():
        for block in _blocks(space.size, BLOCK):
            solve(block)
    else:
        from . import polynomials_numba

        first, *others = _blocks(space.size, LONG_BLOCK)
        # What has yet to be compiled is compiled here, where an interrupt reaches it.
        solve(first, polynomials_numba)
        with ThreadPoolExecutor(os.cpu_count()) as pool:
            list(pool.map(lambda block: solve(block, polynomials_numba), others))
    by_matrices = np.flatnonzero(left)
    second_order = flat.select(slice(0, 1)).assemble().second_order
    if len(by_matrices) >= MANY and second_order and not road.velocity_is_bounded and compiler_found():
        by_matrices = _compiled(flat, road, by_matrices, variances)
    for chosen in batches(by_matrices, BATCH):
        model, X, error, through, infinite = moments(flat, space, road, chosen, LOST)
        Y = model.velocity_form()[2]
        variance = through + np.einsum("...oi,...oi->...o", Y @ X, np.broadcast_to(Y, (len(X), *Y.shape[-2:])))
        terms = np.einsum("...oi,...i->...o", np.abs(Y), np.sqrt(np.einsum("...ii->...i", X).clip(min=0.0))) ** 2
        if model.second_order:
            values, lost = _sound(variance, terms, error, infinite)
        else:
            values, lost = _seen(variance, terms, error, infinite, model, processes(flat, road))
        if lost.any():
            raise lost_digits(flat, space, int(chosen[np.argmax(lost)]))
        variances[:, chosen] = values.T
    return variances.T


def _blocks(size: int, length: int) -> list[slice]:
    return [slice(first, min(first + length, size)) for first in range(0, size, length)]


def _sound(variance: Array, terms: Array, error: Array, infinite: NDArray[np.bool_]) -> tuple[Array, NDArray[np.bool_]]:
    """Variances (N, outputs) with zeros and infinities in place, and which designs (N,) lost digits of some."""
    noise, sound = error[:, None] * terms, error < SOUND
    zero = (variance <= 10.0 * np.maximum(noise, np.finfo(float).eps * terms)) & sound[:, None]
    lost = np.any(~infinite & ~(noise <= LOST * variance), axis=-1) & ~sound
    return np.where(infinite, np.inf, np.where(zero, 0.0, variance)), lost


def _seen(
    variance: Array, terms: Array, error: Array, infinite: NDArray[np.bool_], model: Model, excited: list[Process]
) -> tuple[Array, NDArray[np.bool_]]:
    """The same of any linear system, in whose states large variances that no output sees may cancel as by symmetry."""
    noise = np.maximum(error[:, None], np.finfo(float).eps) * terms
    kept = infinite | (noise <= LOST * variance)
    if not kept.all():
        still = vanishing_outputs(model, excited)
        variance, kept = np.where(still, 0.0, variance), kept | still
    return np.where(infinite, np.inf, variance), ~np.all(kept, axis=-1)


def _compiled(flat: RoadVehicle, road: Road, designs: NDArray[np.int_], variances: Array) -> NDArray[np.int_]:
    """Fill in the variances (outputs, N) of some designs on every processor; return those that lost digits."""
    from . import matrices_numba

    excited = processes(flat, road)
    now, later = np.stack([process.now for process in excited]), np.stack([process.later for process in excited])

    def solve(chosen: NDArray[np.int_]) -> NDArray[np.int_]:
        some, here, N = flat.select(chosen), road.select(chosen), len(chosen)

        def each(x: Any, *shape: int) -> Array:
            # A copy in memory order each time: one signature, compiled once.
            return np.array(np.broadcast_to(x, (N, *shape)), dtype=float, order="C")

        model = some.assemble()
        check_stationary(flat, road, model)
        Y = np.concatenate([model.on_position, model.on_velocity, model.on_warp[..., None]], axis=-1)
        matrices = {"K": model.K, "C": model.C, "K_in": model.K_in, "C_in": model.C_in, "Y": Y}
        spectra = [colours(here, process.share, process.sign, each(some.track_width)) for process in excited]
        variance, terms, error = matrices_numba.variances(
            matrices_numba.System(
                m=each(model.m, model.m.shape[-1]),
                warp=np.zeros(now.shape[1]) if model.warp is None else model.warp,
                **{name: each(x, *x.shape[-2:]) for name, x in matrices.items()},
            ),
            matrices_numba.Excitation(
                now,
                later,
                np.array([spectrum.white[:, 0] for spectrum in spectra]),
                np.array([spectrum.alphas for spectrum in spectra]),
                np.array([spectrum.weights for spectrum in spectra]),
                each(delay(some, here)),
            ),
        )
        with np.errstate(all="ignore"):
            values, lost = _sound(variance, terms, error, infinite_outputs(model, excited, road))
        variances[:, chosen] = values.T
        return chosen[lost]

    with ThreadPoolExecutor(os.cpu_count()) as pool:
        return np.concatenate(list(pool.map(solve, batches(designs, SHARE))))
