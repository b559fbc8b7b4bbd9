"""Very many small complex systems of equations at once: Gauss's elimination along an axis of them.

Libraries solve a stack of matrices one by one, and small matrices cost them more in calls than in arithmetic. Here a
row of numbers, one a system, stands where a matrix has one number.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .parameters import blocks

# A pivot no smaller than this, relative to the largest of its column, stays: rows are swapped in few systems, or none,
# and errors grow at most ten times as much a step as with the largest (I. S. Duff, A. M. Erisman and J. K. Reid,
# *Direct Methods for Sparse Matrices*, 2017, section 5.2).
LARGE_ENOUGH = 0.1


# Systems at work at once: few enough to stay near the processor, enough for calls to cost little.
TOGETHER = 1000


def solved(equations: NDArray[np.complex128]) -> NDArray[np.complex128]:
    """Solutions (n, k, S) of S systems of n equations, (n, n + k, S): matrices, then k right-hand sides.

    Overwrites them.
    """
    n = len(equations)
    for part in blocks(equations.shape[-1], TOGETHER):
        some = equations[..., part]
        for i in range(n):
            first = i + _pivoted(some, i)
            row = some[i, i + 1 :]
            row *= 1.0 / some[i, i]
            some[first:, i + 1 :] -= some[first:, i, None] * row
        x = some[:, n:]
        for i in range(n - 1, 0, -1):
            if some[:i, i].any():
                x[:i] -= some[:i, i, None] * x[i]
    return equations[:, n:]


def _pivoted(equations: NDArray[np.complex128], i: int) -> int:
    """Bring the largest of what is left of column ``i`` up where the pivot is small; from which row on it is felt."""
    column = equations[i:, i]
    sizes = np.abs(column.real) + np.abs(column.imag)
    most = sizes.max(axis=0)
    small = np.flatnonzero(sizes[0] < LARGE_ENOUGH * most)
    if len(small):
        largest = i + sizes[:, small].argmax(axis=0)
        upper, lower = equations[i, :, small], equations[largest, :, small]
        equations[i, :, small], equations[largest, :, small] = lower, upper
        return 1
    below = np.flatnonzero(sizes[1:].any(axis=1))
    return 1 + int(below[0]) if len(below) else len(sizes)
