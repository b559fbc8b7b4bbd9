"""The primitives of `struts` compiled for very many designs: the same arithmetic in loops over them, run as vectors.

Each is compiled by itself, which takes a fraction of what one function of all would. Importing this loads the compiler:
a second, and at first use on a machine some more.
"""

from __future__ import annotations

import numpy as np

from . import polynomials
from .compiler import compiled
from .polynomials import Colours
from .polynomials_numba import OPTIONS
from .struts import Linked, expansions

# Designs whose polynomials stay in the first caches.
WIDTH = 32


def linked(chassis):
    """`struts.linked`."""
    return Linked(*by_minors(*chassis, expansions(len(chassis.struts))))


@compiled(**OPTIONS)
def by_minors(struts, pairs, bars, mobility, arms, tables):
    """D and the deflections of `linked`, some designs at a time."""
    S, B, designs = len(struts), len(mobility), struts.shape[2]
    degree, shift = 2 * (S + B), 2 if S == B else 0
    D, deflections = np.empty((degree + 1, designs)), np.zeros((S, S, degree, designs))
    for first in range(0, designs, WIDTH):
        here = min(WIDTH, designs - first)
        M = np.zeros((S, S, 5, WIDTH))
        matrix(M, struts, pairs, bars, mobility, arms, first, here)
        below = [np.ones((1, 1, WIDTH))]
        for k in range(S - 1):
            below.append(expanded(M[S - 1 - k], below[k], tables[k], 2 if k + 1 > B else 0))
        determinant = expanded(M[0], below[S - 1], tables[S - 1], 2 if S > B else 0)[0]
        for k in range(degree + 1):
            for N in range(here):
                D[k, first + N] = determinant[k, N] / determinant[degree, N]
        for i in range(S):
            minors = below[S - 1 - i]
            for k in range(S - 1 - i, S - 1):
                minors = expanded(M[S - 2 - k], minors, tables[k], 2 if k + 1 > B else 0)
            for j in range(S):
                sign = 1.0 - 2.0 * ((i + j) % 2)
                for order in range(2):
                    for k in range(minors.shape[1]):
                        for N in range(here):
                            deflections[j, i, shift + order + k, first + N] += (
                                sign * struts[i, 3 + order, first + N] / determinant[degree, N] * minors[S - 1 - j, k, N]
                            )
    return D, deflections


@compiled(**OPTIONS)
def matrix(M, struts, pairs, bars, mobility, arms, first, here):
    """`struts.matrix` of some designs, added to M."""
    S = len(struts)
    kappa, u = np.zeros((S, S, 2, WIDTH)), np.empty(WIDTH)
    for i in range(S):
        for N in range(here):
            kappa[i, i, 0, N], kappa[i, i, 1, N] = struts[i, 1, first + N], struts[i, 2, first + N]
    for m in range(len(pairs)):
        for i in pairs[m]:
            for j in pairs[m]:
                for N in range(here):
                    kappa[i, j, 0, N] += bars[m, first + N] if i == j else -bars[m, first + N]
    for i in range(S):
        for j in range(S):
            for order in range(2):
                for N in range(here):
                    M[i, j, 2 + order, N] += kappa[i, j, order, N]
        for m in range(S):
            u[:] = 0.0
            for b in range(len(mobility)):
                for N in range(here):
                    u[N] += mobility[b, first + N] * arms[b, i, first + N] * arms[b, m, first + N]
            for j in range(S):
                for order in range(2):
                    for N in range(here):
                        force = u[N] * kappa[m, j, order, N]
                        M[i, j, order, N] += struts[i, 3, first + N] * force
                        M[i, j, order + 1, N] += struts[i, 4, first + N] * force
                        M[i, j, order + 2, N] += struts[i, 0, first + N] * force
        for N in range(here):
            M[i, i, 2, N] += struts[i, 3, first + N]
            M[i, i, 3, N] += struts[i, 4, first + N]
            M[i, i, 4, N] += struts[i, 0, first + N]


@compiled(**OPTIONS)
def expanded(row, minors, table, zeros):
    """`struts.expanded`, of as many designs as one block has."""
    length = minors.shape[1]
    out, factor = np.zeros((len(table), length + 4 - zeros, WIDTH)), np.empty(WIDTH)
    for c in range(len(table)):
        for t in range(table.shape[1]):
            column, below, sign = table[c, t]
            for i in range(5):
                for N in range(WIDTH):
                    factor[N] = sign * row[column, i, N]
                for k in range(max(0, zeros - i), length):
                    for N in range(WIDTH):
                        out[c, i + k - zeros, N] += factor[N] * minors[below, k, N]
    return out


@compiled(**OPTIONS)
def signals(struts, pairs, bars, mobility, arms, deflections, weights, first, here, out, force):
    """`struts.signals` of some designs, out of which ``force`` is left over."""
    S, B, length = len(struts), len(mobility), deflections.shape[2]
    out[:], force[:] = 0.0, 0.0
    accelerations, d, loads = out[:B], out[B : B + S], out[B + S :]
    for i in range(S):
        for j in range(S):
            if weights[j] != 0.0:
                for k in range(length):
                    for N in range(here):
                        d[i, k, N] += weights[j] * deflections[i, j, k, first + N]
        for k in range(length):
            for N in range(here):
                force[i, k, N] += struts[i, 1, first + N] * d[i, k, N]
                force[i, k + 1, N] = struts[i, 2, first + N] * d[i, k, N]
    for m in range(len(pairs)):
        i, j = pairs[m]
        for k in range(length):
            for N in range(here):
                across = bars[m, first + N] * (d[i, k, N] - d[j, k, N])
                force[i, k, N] += across
                force[j, k, N] -= across
    for b in range(B):
        for i in range(S):
            for k in range(length + 1):
                for N in range(here):
                    accelerations[b, k, N] += arms[b, i, first + N] * force[i, k, N]
        for k in range(length + 1):
            for N in range(here):
                accelerations[b, k, N] *= mobility[b, first + N]
    for i in range(S):
        loads[i, 2:] = d[i, : length - 1]
        for k in range(length + 1):
            for b in range(B):
                for N in range(here):
                    loads[i, k, N] += arms[b, i, first + N] * accelerations[b, k, N]
            for N in range(here):
                loads[i, k, N] = struts[i, 0, first + N] * loads[i, k, N] + force[i, k, N]


@compiled(**OPTIONS)
def squared(p, D, times):
    """`struts.squared`, some designs at a time."""
    size, designs = p.shape
    out, rows, lead = np.empty((size, size, designs)), np.empty((size, size, WIDTH)), np.zeros((size, WIDTH))
    monic, square = np.zeros((size - 2, WIDTH)), np.empty((size, WIDTH))
    for first in range(0, designs, WIDTH):
        here = min(WIDTH, designs - first)
        square[:, :here], monic[:, :here] = p[:, first : first + here], D[: size - 2, first : first + here]
        for time in range(times + 1):
            rows[0] = square
            for k in range(size - 1):
                rows[k + 1, 0], rows[k + 1, 1] = 0.0, rows[k, 0]
                for j in range(2, size):
                    for N in range(WIDTH):
                        rows[k + 1, j, N] = rows[k, j - 1, N] - rows[k, size - 1, N] * monic[j - 2, N]
            if time < times:
                lead[:], square[:] = rows[0], 0.0
                for k in range(size):
                    for j in range(size):
                        for N in range(WIDTH):
                            square[j, N] += lead[k, N] * rows[k, j, N]
        out[:, :, first : first + here] = rows[:, :, :here]
    return out


def together(chassis, deflections, weights, derivatives, step, steps):
    """`struts.together`."""
    return by_products(*chassis, deflections, weights, *derivatives, step, steps)


@compiled(**OPTIONS)
def by_products(struts, pairs, bars, mobility, arms, deflections, weights, moments, free, gone, step, steps):
    """`struts.together`, a design at a time in products of small matrices."""
    S, B, (length, designs) = len(struts), len(mobility), deflections.shape[2:]
    count, size = B + 2 * S, length + 2
    rows, force = np.empty((count, size - 1, WIDTH)), np.empty((S, size - 1, WIDTH))
    Z, Y = np.empty((WIDTH, count, size - 1)), np.empty((WIDTH, count, size - 1))
    H, move, V, W = np.empty((size - 1, size)), np.empty((size, size)), np.empty((count, size)), np.empty((count, size))
    out = np.zeros((B * B + 3 * S, designs))
    for first in range(0, designs, WIDTH):
        here = min(WIDTH, designs - first)
        signals(struts, pairs, bars, mobility, arms, deflections, weights[0], first, here, rows, force)
        turned(rows, Z)
        if steps > 0:
            signals(struts, pairs, bars, mobility, arms, deflections, weights[1], first, here, rows, force)
            turned(rows, Y)
        for N in range(here):
            sums = out[:, first + N]
            hankel(moments, first + N, H)
            np.dot(Z[N], H, V)
            products(Z[N], V, B, S, 1.0, sums)
            if steps > 0:
                np.dot(Y[N], H, V)
                products(Y[N], V, B, S, 1.0, sums)
                hankel(free, first + N, H)
                np.dot(Y[N], H, V)
                for i in range(size):
                    for j in range(size):
                        move[j, i] = step[i, j, first + N]
                for _ in range(steps):
                    W[:] = V
                    np.dot(W, move, V)
                hankel(gone, first + N, H)
                np.dot(Y[N], H, W)
                V += W
                products(Z[N], V, B, S, 2.0, sums)
            for i in range(B):
                for j in range(i):
                    mean = 0.5 * (sums[i * B + j] + sums[j * B + i])
                    sums[i * B + j] = sums[j * B + i] = mean
    return out


@compiled(**OPTIONS)
def turned(rows, out):
    """The last axis in front."""
    for i in range(rows.shape[0]):
        for j in range(rows.shape[1]):
            for N in range(rows.shape[2]):
                out[N, i, j] = rows[i, j, N]


@compiled(**OPTIONS)
def products(Z, V, B, S, times, out):
    """Add `struts.products` of one design, so many times."""
    length = Z.shape[1]
    for i in range(len(Z)):
        for j in range(B) if i < B else range(i, i + 1):
            total = 0.0
            for k in range(length):
                total += Z[i, k] * V[j, k]
            out[i * B + j if i < B else B * B - B + i] += times * total
    for i in range(B, B + S):
        total = 0.0
        for k in range(length - 1):
            total += Z[i, k] * V[i, k + 2]
        out[B * B - B + 2 * S + i] -= times * total


@compiled(**OPTIONS)
def hankel(derivatives, N, H):
    """The transpose of `struts.hankel` of one design."""
    for i in range(H.shape[0]):
        sign = 1.0 - 2.0 * (i % 2)
        for j in range(H.shape[1]):
            H[i, j] = sign * derivatives[i + j, N]


def start(D, road):
    """`polynomials.start`; complex colours are compiled once some come."""
    out = coloured(D, road.real) + coloured(D, road.swinging).real if len(road.swinging.alphas) else coloured(D, road.real)
    return out + white(D, road.level)


@compiled(**OPTIONS)
def white(D, level):
    """`polynomials.routh`, some designs at a time."""
    out = np.empty((len(D) - 1, D.shape[1]))
    for first in range(0, D.shape[1], WIDTH):
        end = min(first + WIDTH, D.shape[1])
        out[:, first:end] = polynomials.routh(D[:, first:end].copy(), level[first:end].copy())
    return out


@compiled(**OPTIONS)
def coloured(D, colours):
    """`polynomials.coloured`, some designs at a time."""
    out = np.zeros((len(D) - 1, D.shape[1]), colours.alphas.dtype)
    for first in range(0, D.shape[1] if len(colours.alphas) else 0, WIDTH):
        end = min(first + WIDTH, D.shape[1])
        alphas, low, high = (
            colours.alphas[:, first:end].copy(),
            colours.low[:, first:end].copy(),
            colours.high[:, first:end].copy(),
        )
        out[:, first:end] = polynomials.coloured(D[:, first:end].copy(), Colours(alphas, low, high))
    return out
