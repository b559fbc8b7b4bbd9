"""A linear system parted into what dies out, what integrates and what no output sees.

Variances need every mode that an output sees to die out, but for integrators whose input the road may bound (the warp
of the ground under four wheels). Systems as people have them hold more: a yaw angle, the integrator of a disturbance.
All decisions are made in balanced coordinates, in which the sizes of states can be compared, by stated tolerances.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import scipy.linalg
from numpy.typing import NDArray

from .second_order import ROUNDING

Array = NDArray[np.float64]

# Modes that decay this slowly, relative to the fastest mode, are looked at one by one: chains of integrators that no
# output sees are that far from zero after rounding.
SLOW = 1e-3

# A rate no larger than this, relative to the fastest mode's, is zero.
STILL = 1e-10

# An output sees a direction if its share of the output's coefficients is more than this.
SEEN = 1e-9

# A chain of integrators couples them by more than this, relative to the fastest mode.
CHAINED = 1e-8


class Parted(NamedTuple):
    """``x' = A x + B u`` dies out, ``h' = rows u`` integrates, ``y = C x + seen h + D u``, of one system.

    ``basis`` (states, x and h) takes both back to the system's own states, ``unseen`` (states, j) spans in balanced
    coordinates what no output sees, and ``fastest`` is the modulus of the fastest mode.
    """

    A: Array
    B: Array
    C: Array
    rows: Array
    seen: Array
    basis: Array
    unseen: Array
    fastest: float


class Growing(Exception):
    """A mode that an output sees and that does not die out: its rate, its state and the output, by their numbers."""

    def __init__(self, rate: complex, state: int, output: int):
        super().__init__(rate, state, output)
        self.rate, self.state, self.output = rate, state, output


class _Block(NamedTuple):
    """Part of a system: ``x' = A x + B u``, ``y = C x``, ``basis`` its directions in the balanced states."""

    A: Array
    B: Array
    C: Array
    basis: Array

    def along(self, right: Array, left: Array) -> _Block:
        """The part along an invariant subspace with the basis ``right``, of which ``left`` takes the coordinates."""
        return _Block(left @ self.A @ right, left @ self.B, self.C @ right, self.basis @ right)

    def beside(self, other: _Block) -> _Block:
        return _Block(
            scipy.linalg.block_diag(self.A, other.A),
            np.vstack([self.B, other.B]),
            np.hstack([self.C, other.C]),
            np.hstack([self.basis, other.basis]),
        )


def parted(A: Array, B: Array, C: Array) -> Parted:
    """Part one system ``x' = A x + B u``, ``y = C x``.

    Raises
    ------
    Growing
        A mode that an output sees neither dies out nor is a simple integrator.
    """
    balanced, (scale, _) = scipy.linalg.matrix_balance(A, permute=False, separate=True)
    sizes = np.linalg.norm(C * scale, axis=1, keepdims=True)
    sizes[sizes == 0.0] = 1.0
    whole = _Block(balanced, B / scale[:, None], C * scale / sizes, np.eye(len(A)))
    columns = np.linalg.norm(whole.B, axis=0)
    rates = np.linalg.eigvals(balanced)
    fastest = float(np.abs(rates).max() or np.linalg.norm(balanced) or 1.0)
    lively, still = _divided(whole, rates, SLOW * fastest)
    unseen = still.basis
    if len(still.A):
        slow, unseen = _without_unseen(still, fastest)
        creeping, still = _divided(slow, np.linalg.eigvals(slow.A), STILL * fastest)
        lively = lively.beside(creeping)
        _refuse_growing(still, fastest)

    # What the splitting leaves of a zero would grow without bound at low frequency.
    left_over = np.maximum(SEEN * np.abs(still.B).max(axis=1, initial=0.0)[:, None], ROUNDING * columns)
    rows = np.where(np.abs(still.B) > left_over, still.B, 0.0)
    basis = scale[:, None] * np.hstack([lively.basis, still.basis])
    return Parted(lively.A, lively.B, sizes * lively.C, rows, sizes * still.C, basis, unseen, fastest)


def _divided(system: _Block, rates: NDArray, bound: float) -> tuple[_Block, _Block]:
    """Split a system with these eigenvalues into what decays faster than ``bound``, and the rest."""
    n = len(system.A)
    # The bound moves into the widest gap near it, where rounding takes no eigenvalue across.
    near = np.clip(np.sort(np.append(-rates.real, [0.0, 100.0 * bound])), 0.1 * bound, 10.0 * bound)
    widest = int(np.argmax(near[1:] / near[:-1]))
    bound = float(np.sqrt(near[widest] * near[widest + 1]))
    fast = int(np.sum(rates.real < -bound))
    if fast in (0, n):
        nothing = system.along(np.zeros((n, 0)), np.zeros((0, n)))
        return (system, nothing) if fast else (nothing, system)
    T, Q, k = scipy.linalg.schur(system.A + bound * np.eye(n), sort="lhp")
    T = T - bound * np.eye(n)
    Y = scipy.linalg.solve_sylvester(T[:k, :k], -T[k:, k:], -T[:k, k:])
    first, second = Q[:, :k], Q[:, k:]
    return (
        system.along(first, first.T - Y @ second.T)._replace(A=T[:k, :k]),
        system.along(first @ Y + second, second.T)._replace(A=T[k:, k:]),
    )


def _without_unseen(system: _Block, fastest: float) -> tuple[_Block, Array]:
    """Leave out the directions that no output sees, at once or later; they are returned."""
    n = len(system.A)
    seen, frontier = np.zeros((n, 0)), system.C.T / max(1.0, float(np.linalg.norm(system.basis, ord=2)))
    while frontier.size and seen.shape[1] < n:
        frontier = frontier - seen @ (seen.T @ frontier)
        U, s, _ = np.linalg.svd(frontier, full_matrices=False)
        # Of a direction little may be left, with few digits; and there are no more directions than states.
        U = U[:, s > SEEN]
        frontier = scipy.linalg.orth(U - seen @ (seen.T @ U))[:, : n - seen.shape[1]]
        seen = np.hstack([seen, frontier])
        frontier = system.A.T @ frontier / fastest
    unseen = scipy.linalg.null_space(seen.T) if seen.shape[1] else np.eye(n)
    return system.along(seen, seen.T), system.basis @ unseen


def _refuse_growing(still: _Block, fastest: float) -> None:
    if not len(still.A):
        return
    rates, vectors = np.linalg.eig(still.A)
    worst = int(np.argmax(np.abs(rates)))
    if np.abs(rates[worst]) <= STILL * fastest and np.abs(still.A).max() <= CHAINED * fastest:
        return
    direction = vectors[:, worst]
    state, output = np.abs(still.basis @ direction).argmax(), np.abs(still.C @ direction).argmax()
    raise Growing(complex(rates[worst]), int(state), int(output))
