"""Linear systems under inputs that are linear between samples, exactly: many designs at once, in blocks of steps.

``x' = A x + B u``, ``y = C x + D u`` goes over a step of h from ``x`` to ``F x + G u_k + H u_k+1``; in the states
``p = x - H u`` that is ``p_k+1 = F p_k + (F H + G) u_k``, the first-order hold of `scipy.signal.cont2discrete` (G. F.
Franklin, J. D. Powell and M. L. Workman, *Digital Control of Dynamic Systems*, 1998, chapter 6). Steps follow one
another only from block to block, by ``F^BLOCK`` and what the inputs of a block have done at its end; within blocks, the
same step of all of them is one product of matrices. No eigenvectors are needed, however close eigenvalues lie.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import expm

Array = NDArray[np.float64]

# Steps of a block, a power of two, and blocks of a stretch.
BLOCK, BLOCKS = 64, 128


def held(A: Array, B: Array, h: float, powers: int = 2) -> list[Array]:
    """``e^(A h)`` of A (..., n, n), and what inputs ``1``, ``t/h``, ... ``(t/h)^(powers-1)`` have done after a step."""
    n, m = B.shape[-2:]
    block = np.zeros((*np.broadcast_shapes(A.shape[:-2], B.shape[:-2]), n + powers * m, n + powers * m))
    block[..., :n, :n], block[..., :n, n : n + m] = h * A, h * B
    for power in range(1, powers):
        end = n + power * m
        block[..., end - m : end, end : end + m] = power * np.eye(m)
    return np.split(expm(block)[..., :n, :], n + m * np.arange(powers), axis=-1)


def joined(parts: Sequence[Array], axis: int) -> Array:
    """Matrices (..., rows, columns) beside (-1) or below (-2) one another, of as many designs as any of them has."""
    designs = np.broadcast_shapes(*(part.shape[:-2] for part in parts))
    return np.concatenate([np.broadcast_to(part, (*designs, *part.shape[-2:])) for part in parts], axis=axis)


class FirstOrderHold:
    """Systems of A (..., n, n), B (..., n, m), C (..., p, n) and D (..., p, m) in steps of ``h`` seconds.

    They are N where there are arrays of them, else one.
    """

    def __init__(self, A: Array, B: Array, C: Array, D: Array, h: float):
        F, hold, self.H = held(A, B, h)
        self.F, self.G = F, F @ self.H + hold - self.H
        self.forward = joined([self.F, self.G], -1)
        self.seen = joined([C, D + C @ self.H], -1)

    @cached_property
    def over_block(self) -> tuple[Array, Array]:
        """``F^BLOCK``, and what the inputs (BLOCK, m) of a block have done at its end."""
        power, at_end = self.F, [self.G]
        for _ in range(BLOCK - 1):
            at_end.append(self.F @ at_end[-1])
        for _ in range(int(np.log2(BLOCK))):
            power = power @ power
        return power, np.concatenate(at_end[::-1], axis=-1)

    def drive(self, u: Array, x: Any = 0.0) -> Iterator[Array]:
        """Outputs (N, p, L) under inputs u, (m, T) or (N, m, T), from states x (..., n, 1): stretch after stretch."""
        p = x - self.H @ u[..., :1]
        designs, (n, m) = np.broadcast_shapes(p.shape[:-2], self.seen.shape[:-2]) or (1,), self.H.shape[-2:]
        forward, seen = (np.broadcast_to(x, (*designs, *x.shape[-2:])) for x in (self.forward, self.seen))
        power, at_end = self.over_block
        for start in range(0, u.shape[-1], BLOCK * BLOCKS):
            part = u[..., start : start + BLOCK * BLOCKS]
            length = part.shape[-1]
            blocks = -(-length // BLOCK)
            part = np.pad(part, [(0, 0)] * (u.ndim - 1) + [(0, blocks * BLOCK - length)])
            part = np.moveaxis(part.reshape(*part.shape[:-1], blocks, BLOCK), -1, -3)
            states = np.empty((*designs, BLOCK, n + m, blocks))
            states[..., n:, :] = part
            done = at_end @ part.reshape(*part.shape[:-3], BLOCK * m, blocks)
            for block in range(blocks):
                states[:, 0, :n, block] = p[..., 0]
                p = power @ p + done[..., block, None]
            for step in range(1, BLOCK):
                np.matmul(forward, states[:, step - 1], out=states[:, step, :n])
            y = np.moveaxis(seen[:, None] @ states, 1, -1)
            yield y.reshape(*y.shape[:2], -1)[..., :length]
