"""The primitives of `struts` compiled for very many designs: the same arithmetic in loops over them, run as vectors.

Each is compiled by itself, which takes a fraction of what one function of all would. Importing this loads the compiler:
a second, and at first use on a machine some more.
"""

from __future__ import annotations

import numpy as np

from . import polynomials
from .compiler import compiled
from .polynomials_numba import OPTIONS, part_of

# Designs whose polynomials stay in the first caches.
WIDTH = 64

# Designs of the innermost loops of `across`.
FEW = 16


@compiled(**OPTIONS)
def expanded(row, minors, table, zeros):
    """`struts.expanded`."""
    length, designs = minors.shape[1], row.shape[2]
    out = np.zeros((len(table), length + 4 - zeros, designs))
    for first in range(0, designs, WIDTH):
        end = min(first + WIDTH, designs)
        for c in range(len(table)):
            for t in range(table.shape[1]):
                column, below, sign = table[c, t]
                for i in range(5):
                    for k in range(max(0, zeros - i), length):
                        for N in range(first, end):
                            out[c, i + k - zeros, N] += sign * row[column, i, N] * minors[below, k, N]
    return out


@compiled(**OPTIONS)
def signals(struts, pairs, bars, mobility, arms, deflections, weights):
    """`struts.signals`."""
    S, B, (length, designs) = len(struts), len(mobility), deflections.shape[2:]
    out, force = np.zeros((B + 2 * S, length + 1, designs)), np.zeros((S, length + 1, designs))
    accelerations, d, loads = out[:B], out[B : B + S], out[B + S :]
    for first in range(0, designs, WIDTH):
        end = min(first + WIDTH, designs)
        for i in range(S):
            for j in range(S):
                if weights[j] != 0.0:
                    for k in range(length):
                        for N in range(first, end):
                            d[i, k, N] += weights[j] * deflections[i, j, k, N]
            for k in range(length):
                for N in range(first, end):
                    force[i, k, N] += struts[i, 1, N] * d[i, k, N]
                    force[i, k + 1, N] = struts[i, 2, N] * d[i, k, N]
        for m in range(len(pairs)):
            i, j = pairs[m]
            for k in range(length):
                for N in range(first, end):
                    across = bars[m, N] * (d[i, k, N] - d[j, k, N])
                    force[i, k, N] += across
                    force[j, k, N] -= across
        for b in range(B):
            for i in range(S):
                for k in range(length + 1):
                    for N in range(first, end):
                        accelerations[b, k, N] += mobility[b, N] * arms[b, i, N] * force[i, k, N]
        for i in range(S):
            for k in range(length - 1):
                for N in range(first, end):
                    loads[i, k + 2, N] = d[i, k, N]
            for k in range(length + 1):
                for b in range(B):
                    for N in range(first, end):
                        loads[i, k, N] += arms[b, i, N] * accelerations[b, k, N]
                for N in range(first, end):
                    loads[i, k, N] = struts[i, 0, N] * loads[i, k, N] + force[i, k, N]
    return out


@compiled(**OPTIONS)
def powers(p, D):
    """`struts.powers`."""
    size, designs = p.shape
    out = np.zeros((size, size, designs))
    out[0] = p
    for first in range(0, designs, WIDTH):
        end = min(first + WIDTH, designs)
        for k in range(size - 1):
            for N in range(first, end):
                out[k + 1, 1, N] = out[k, 0, N]
            for j in range(2, size):
                for N in range(first, end):
                    out[k + 1, j, N] = out[k, j - 1, N] - out[k, size - 1, N] * D[j - 2, N]
    return out


@compiled(**OPTIONS)
def combined(p, rows):
    """`struts.combined`."""
    size, designs = p.shape
    out = np.zeros((size, designs))
    for first in range(0, designs, WIDTH):
        end = min(first + WIDTH, designs)
        for i in range(size):
            for j in range(size):
                for N in range(first, end):
                    out[j, N] += p[i, N] * rows[i, j, N]
    return out


@compiled(**OPTIONS)
def across(rows, others, derivatives, step, steps, gone, B, S):
    """`struts.across`, a few designs at a time: loops of a length that the compiler knows run twice as fast."""
    length, designs = rows.shape[1:]
    size = length + 1
    out = np.empty((B * B + 3 * S, designs))
    R, left = np.zeros((2 * size + 1, FEW)), np.zeros((2 * size + 1, FEW))
    P, Q, move = np.zeros((B + 2 * S, size, FEW)), np.zeros((size + 1, FEW)), np.zeros((size, size, FEW))
    V, before, sums = np.empty((size, FEW)), np.empty((size, FEW)), np.empty((B * B + 3 * S, FEW))
    for first in range(0, designs, FEW):
        here = min(FEW, designs - first)
        part = slice(first, first + here)
        R[: len(derivatives), :here], left[: len(gone), :here] = derivatives[:, part], gone[:, part]
        P[:, :length, :here] = rows[:, :, part]
        if steps > 0:
            move[:, :, :here] = step[:, :, part]
        sums[:] = 0.0
        for signal in range(B + 2 * S):
            for j in range(length):
                for N in range(here):
                    Q[j, N] = (1.0 - 2.0 * (j % 2)) * others[signal, j, first + N]
            V[:] = 0.0
            if steps == 0:
                # At one instant every second derivative is zero.
                for i in range(size):
                    for j in range(i % 2, size, 2):
                        for N in range(FEW):
                            V[i, N] += R[i + j, N] * Q[j, N]
            else:
                covariances(R, Q, V)
                for _ in range(steps):
                    before[:], V[:] = V, 0.0
                    for i in range(size):
                        for j in range(0, size, 2):
                            for N in range(FEW):
                                V[i, N] += move[i, j, N] * before[j, N] + move[i, j + 1, N] * before[j + 1, N]
                covariances(left, Q, V)
            for row in range(B) if signal < B else range(signal, signal + 1):
                to = row * B + signal if signal < B else B * B - B + signal
                for k in range(size):
                    for N in range(FEW):
                        sums[to, N] += P[row, k, N] * V[k, N]
            if B <= signal < B + S:
                for k in range(size - 2):
                    for N in range(FEW):
                        sums[B * B - B + 2 * S + signal, N] -= P[signal, k, N] * V[k + 2, N]
        out[:, part] = sums[:, :here]
    return out


@compiled(**OPTIONS)
def covariances(R, Q, V):
    """Add covariances of a signal with X's derivatives, whose own are R's."""
    for i in range(len(V)):
        for j in range(0, len(V), 2):
            for N in range(FEW):
                V[i, N] += R[i + j, N] * Q[j, N] + R[i + j + 1, N] * Q[j + 1, N]


@compiled(**OPTIONS)
def start(D, road):
    """`polynomials.start`, some designs at a time."""
    out = np.empty((len(D) - 1, D.shape[1]))
    for first in range(0, D.shape[1], WIDTH):
        end = min(first + WIDTH, D.shape[1])
        out[:, first:end] = polynomials.start(D[:, first:end].copy(), part_of(road, first, end))
    return out
