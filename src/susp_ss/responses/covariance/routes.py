"""The variances of all outputs of all designs, each by the fastest exact way that it admits.

- Designs that fall into halves (left and right alike, struts on a rigid body) go by polynomials (`symmetric`), a block
  of them at a time: a microsecond or two each.
- More struts than two on a rigid body go by polynomials of a higher degree (`whole`), a truck's three axles in halves
  as well, four unequal corners or seats as they are: some twenty to forty microseconds a vehicle, half of that once
  they are many enough to be worth compiling.
- The rest, and those that would lose digits there, take the Lyapunov equation of their matrices in batches
  (`matrices`): some hundred microseconds each.

What a way needs is stated by the vehicle (`Vehicle.halves`, `Vehicle.whole`) or by its matrices; what lacks it takes
the next. The choice shows in nothing but time. Against 80-bit arithmetic, over a thousand random full cars each on
isotropic tracks, polynomials err by at most 3e-13 with parameters within a factor 2 of a car's, 2e-10 over two decades
of every mass and stiffness, 2e-8 over three (99 % below 1e-9), and 3e-9 with damping down to a millionth; `whole` errs
by 1e-12 at a car's damping, by 1e-9 at a third of it, where wheels that hop almost alike cost digits; of a truck's
halves it differs from matrices by 1e-13. Designs beyond the bounds of `digits` are computed in two systems of units;
those that differ go to matrices, which measure their own error, and what keeps fewer than six digits there is refused.
"""

from __future__ import annotations

import os
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...roads.road import Road
from ...vehicles.contract import Model, RoadVehicle
from ...vehicles.parameters import DesignSpace, SomeDesigns, blocks
from ..excitation import Process, processes, vanishing_outputs
from . import polynomials, struts
from .compiler import compiler_found
from .matrices import BATCH, batches, lost_digits, moments
from .symmetric import symmetric_variances
from .whole import whole_variances

Array = NDArray[np.float64]

# Relative error of a variance beyond which it is refused, and the error of a sound solution. Of a sound one, a variance
# no larger than its rounding is zero by symmetry; one that near symmetry leaves small keeps the digits of its terms.
LOST, SOUND = 1e-6, 1e-12

# Designs of one block: its polynomials then stay near the processor. Compiled code keeps them there by itself.
BLOCK, LONG_BLOCK = 2048, 8192
STRUTS_BLOCK, LONG_STRUTS_BLOCK = 512, 512

# Numbers that a block works on at most, far below what the C library takes for an array too large to be kept.
KEPT = 4_000_000

# Symmetric designs, and other struts on a body, from which loading the compiler (a second; at first use on a machine
# ten to thirty) is repaid.
PLENTY, MANY = 1_000_000, 50_000

EVERY = slice(None)
"""All outputs."""


def covariance_variances(
    flat: RoadVehicle, space: DesignSpace | SomeDesigns, road: Road, designs: int = 1, needed: Any = EVERY
) -> Array:
    """Variances (designs, outputs) of all outputs of a flattened vehicle's designs; `inf` where white velocity passes.

    These may be part of a sweep of more ``designs``, whose number decides what is worth compiling. Outputs that are not
    ``needed`` may lose digits.
    """
    variances = np.empty((len(flat.layout().outputs), space.size))
    left = _by_polynomials(flat, road, max(designs, space.size), variances)
    for chosen in batches(np.flatnonzero(left), BATCH):
        variances[:, chosen] = by_matrices(flat, space, road, chosen, needed=needed).T
    return variances.T


def by_matrices(
    flat: RoadVehicle,
    space: DesignSpace | SomeDesigns,
    road: Road,
    chosen: NDArray[np.int_],
    seen: Callable[[Any], Any] = lambda model: model,
    needed: Any = EVERY,
) -> Array:
    """Variances (chosen, outputs) by the Lyapunov equation, of the outputs that ``seen`` gives a model."""
    model, X, error, through, infinite = moments(flat, space, road, chosen, LOST, seen)
    Y = model.velocity_form()[2]
    variance = through + np.einsum("...oi,...oi->...o", Y @ X, np.broadcast_to(Y, (len(X), *Y.shape[-2:])))
    terms = np.einsum("...oi,...i->...o", np.abs(Y), np.sqrt(np.einsum("...ii->...i", X).clip(min=0.0))) ** 2
    if model.second_order:
        values, lost = _sound(variance, terms, error, infinite)
    else:
        values, lost = _seen(variance, terms, error, infinite, model, processes(flat, road))
    if lost[:, needed].any():
        raise lost_digits(flat, space, int(chosen[np.argmax(lost[:, needed].any(axis=-1))]))
    return values


def _by_polynomials(flat: RoadVehicle, road: Road, designs: int, variances: Array) -> NDArray[np.bool_]:
    """Fill in the variances (outputs, N) of what goes by polynomials; say which designs (N,) are left to matrices."""
    halves, size = flat.halves() if _on_all_wheels(road, flat) else (), variances.shape[1]
    whole, left = None if halves else flat.whole(), np.ones(size, dtype=bool)
    parts = halves if whole is None else (whole,)
    if not parts:
        return left
    short = bool(halves) and len(halves[0].struts) <= 2
    # What a block frees, the next one needs: the C library keeps it once it has seen so large an array freed. Otherwise
    # it is handed back and zeroed anew page by page, which takes a third of all the time.
    np.empty(KEPT)
    plenty, block, long = (PLENTY, BLOCK, LONG_BLOCK) if short else (MANY, STRUTS_BLOCK, LONG_STRUTS_BLOCK)
    compiled = designs >= plenty and compiler_found()
    kernels: Any = polynomials if short else struts
    if compiled:
        from . import polynomials_numba, struts_numba

        kernels = polynomials_numba if short else struts_numba

    def solve(part: slice) -> None:
        count = part.stop - part.start

        def of(designs: Any) -> Any:
            return designs if count == size else designs.select(part)

        solved = symmetric_variances if short else whole_variances
        variances[:, part], left[part] = solved([*map(of, parts)], of(flat), of(road), count, kernels)

    first, *others = blocks(size, long if compiled else block)
    # What has yet to be compiled is compiled here, where an interrupt reaches it.
    solve(first)
    if compiled:
        with ThreadPoolExecutor(os.cpu_count()) as pool:
            list(pool.map(solve, others))
    else:
        for part in others:
            solve(part)
    return left


def _on_all_wheels(road: Road, vehicle: RoadVehicle) -> bool:
    return road.wheels is None or set(vehicle.wheels) <= set(road.wheels)


def _sound(variance: Array, terms: Array, error: Array, infinite: NDArray[np.bool_]) -> tuple[Array, NDArray[np.bool_]]:
    """Variances (N, outputs) with zeros and infinities in place, and which of them lost digits."""
    noise, sound = error[:, None] * terms, error < SOUND
    zero = (variance <= 10.0 * np.maximum(noise, np.finfo(float).eps * terms)) & sound[:, None]
    lost = ~infinite & ~(noise <= LOST * variance) & ~sound[:, None]
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
    return np.where(infinite, np.inf, variance), ~kept
