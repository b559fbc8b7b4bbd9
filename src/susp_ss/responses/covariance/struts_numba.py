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
    """D and the signals of `linked`, some designs at a time."""
    S, B, designs = len(struts), len(mobility), struts.shape[2]
    degree, shift = 2 * (S + B), 2 if S == B else 0
    D, signals = np.empty((degree + 1, designs)), np.empty((S, B + 2 * S, degree + 1, designs))
    adjugate, rows = np.zeros((S, S, degree + 1, WIDTH)), np.empty((S, B + 2 * S, degree + 1, WIDTH))
    M, force = np.empty((S, S, 5, WIDTH)), np.empty((S, degree + 1, WIDTH))
    at_struts, at_bars = np.ones((S, 5, WIDTH)), np.ones((len(bars), WIDTH))
    mobilities, at_arms = np.ones((B, WIDTH)), np.ones((B, S, WIDTH))
    for first in range(0, designs, WIDTH):
        # Loops of a length that the compiler knows run twice as fast: what is over at the end counts for nothing.
        here = min(WIDTH, designs - first)
        part = slice(first, first + here)
        at_struts[:, :, :here], at_bars[:, :here] = struts[:, :, part], bars[:, part]
        mobilities[:, :here], at_arms[:, :, :here] = mobility[:, part], arms[:, :, part]
        M[:] = 0.0
        matrix(M, at_struts, pairs, at_bars, mobilities, at_arms)
        below = [np.ones((1, 1, WIDTH))]
        for k in range(S - 1):
            below.append(expanded(M[S - 1 - k], below[k], tables[k], 2 if k + 1 > B else 0))
        determinant = expanded(M[0], below[S - 1], tables[S - 1], 2 if S > B else 0)[0]
        monic = 1.0 / determinant[degree]
        D[:, part] = (determinant * monic)[:, :here]
        for i in range(S):
            minors = below[S - 1 - i]
            for k in range(S - 1 - i, S - 1):
                minors = expanded(M[S - 2 - k], minors, tables[k], 2 if k + 1 > B else 0)
            for j in range(S):
                sign = 1.0 - 2.0 * ((i + j) % 2)
                for k in range(minors.shape[1]):
                    for N in range(WIDTH):
                        adjugate[i, j, shift + k, N] = sign * monic[N] * minors[S - 1 - j, k, N]
        stir(at_struts, pairs, at_bars, mobilities, at_arms, adjugate, force, rows)
        signals[:, :, :, part] = rows[:, :, :, :here]
    return D, signals


@compiled(**OPTIONS)
def stir(struts, pairs, bars, mobility, arms, adjugate, force, out):
    """`struts.stirred` of one block of designs."""
    S, B, length = len(struts), len(mobility), adjugate.shape[2]
    out[:] = 0.0
    for column in range(S):
        d = adjugate[column]
        for i in range(S):
            for k in range(length):
                for N in range(WIDTH):
                    force[i, k, N] = struts[i, 1, N] * d[i, k, N]
            for k in range(1, length):
                for N in range(WIDTH):
                    force[i, k, N] += struts[i, 2, N] * d[i, k - 1, N]
        for m in range(len(pairs)):
            i, j = pairs[m]
            for k in range(length):
                for N in range(WIDTH):
                    across = bars[m, N] * (d[i, k, N] - d[j, k, N])
                    force[i, k, N] += across
                    force[j, k, N] -= across
        for b in range(B):
            for i in range(S):
                for k in range(length):
                    for N in range(WIDTH):
                        out[column, b, k, N] += arms[b, i, N] * force[i, k, N]
            for k in range(length):
                for N in range(WIDTH):
                    out[column, b, k, N] *= mobility[b, N]
        for i in range(S):
            tyre = out[i, B + S + column]
            tyre[2:] = d[i, : length - 2]
            for k in range(length):
                for b in range(B):
                    for N in range(WIDTH):
                        tyre[k, N] += arms[b, i, N] * out[column, b, k, N]
                for N in range(WIDTH):
                    tyre[k, N] = struts[i, 0, N] * tyre[k, N] + force[i, k, N]
        out[column, B : B + S] = d
        for row in range(B + S):
            for k in range(length - 1, -1, -1):
                for N in range(WIDTH):
                    out[column, row, k, N] *= struts[column, 3, N]
                if k > 0:
                    for N in range(WIDTH):
                        out[column, row, k, N] += struts[column, 4, N] * out[column, row, k - 1, N]


@compiled(**OPTIONS)
def matrix(M, struts, pairs, bars, mobility, arms):
    """`struts.matrix` of one block of designs, added to M."""
    S = len(struts)
    kappa, u = np.zeros((S, S, 2, WIDTH)), np.empty(WIDTH)
    for i in range(S):
        for N in range(WIDTH):
            kappa[i, i, 0, N], kappa[i, i, 1, N] = struts[i, 1, N], struts[i, 2, N]
    for m in range(len(pairs)):
        for i in pairs[m]:
            for j in pairs[m]:
                for N in range(WIDTH):
                    kappa[i, j, 0, N] += bars[m, N] if i == j else -bars[m, N]
    for i in range(S):
        for j in range(S):
            for order in range(2):
                for N in range(WIDTH):
                    M[i, j, 2 + order, N] += kappa[i, j, order, N]
        for m in range(S):
            u[:] = 0.0
            for b in range(len(mobility)):
                for N in range(WIDTH):
                    u[N] += mobility[b, N] * arms[b, i, N] * arms[b, m, N]
            for j in range(S):
                for order in range(2):
                    for N in range(WIDTH):
                        force = u[N] * kappa[m, j, order, N]
                        M[i, j, order, N] += struts[i, 3, N] * force
                        M[i, j, order + 1, N] += struts[i, 4, N] * force
                        M[i, j, order + 2, N] += struts[i, 0, N] * force
        for N in range(WIDTH):
            M[i, i, 2, N] += struts[i, 3, N]
            M[i, i, 3, N] += struts[i, 4, N]
            M[i, i, 4, N] += struts[i, 0, N]


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


def together(linked, weights, B, derivatives, step, steps):
    """`struts.together`."""
    return by_products(linked.signals, weights, B, *derivatives, step, steps)


@compiled(**OPTIONS)
def by_products(signals, weights, B, moments, free, gone, step, steps):
    """`struts.together`, a design at a time in products of small matrices."""
    S, count, length, designs = signals.shape
    size = length + 1
    Z, Y = np.empty((WIDTH, count, length)), np.empty((WIDTH, count, length))
    H, move, V, W = np.empty((length, size)), np.empty((size, size)), np.empty((count, size)), np.empty((count, size))
    out = np.zeros((B * B + 3 * S, designs))
    for first in range(0, designs, WIDTH):
        here = min(WIDTH, designs - first)
        weighted(signals, weights[0], first, here, Z)
        if steps > 0:
            weighted(signals, weights[1], first, here, Y)
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
def weighted(signals, weights, first, here, out):
    """`struts.signals`, the designs in front."""
    out[:] = 0.0
    for j in range(len(weights)):
        if weights[j] != 0.0:
            for row in range(signals.shape[1]):
                for k in range(signals.shape[2]):
                    for N in range(here):
                        out[N, row, k] += weights[j] * signals[j, row, k, first + N]


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
    out = (
        coloured(D, road.real) + coloured(D, road.swinging).real
        if len(road.swinging.alphas)
        else coloured(D, road.real)
    )
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
