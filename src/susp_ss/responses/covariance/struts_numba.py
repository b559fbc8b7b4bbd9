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

# Designs at a time: as few as make loops over them run as vectors, so that their polynomials stay in the caches.
WIDTH = 64


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
def by_products(signals, weights, B, even, free, gone, step, steps):
    """`struts.together`, some designs at a time."""
    S, count, n, designs = signals.shape
    rows, R = np.empty((2, count, n, WIDTH)), np.ones((2 * n, WIDTH))
    V, W, move = np.empty((count, n + 1, WIDTH)), np.empty((count, n + 1, WIDTH)), np.ones((n + 1, n + 1, WIDTH))
    own, across = np.empty((B * B + 3 * S, WIDTH)), np.empty((B * B + 3 * S, WIDTH))
    out = np.empty((B * B + 3 * S, designs))
    for first in range(0, designs, WIDTH):
        here = min(WIDTH, designs - first)
        part = slice(first, first + here)
        own[:], R[:n, :here] = 0.0, even[:, part]
        for side in range(len(weights)):
            weighted(signals, weights[side], first, here, rows[side])
            at_once(rows[side], R, V)
            products(rows[side], V, B, S, own)
        if len(weights) > 1:
            V[:], across[:] = 0.0, 0.0
            R[:, :here], move[:, :, :here] = free[:, part], step[:, :, part]
            later(rows[1], R, V)
            for _ in range(steps):
                W[:] = V
                carried(move, W, V)
            if len(gone) > 0:
                R[:, :here] = gone[:, part]
                later(rows[1], R, V)
            products(rows[0], V, B, S, across)
            for i in range(len(own)):
                turned = i if i >= B * B else i % B * B + i // B
                for N in range(WIDTH):
                    own[i, N] += across[i, N] + across[turned, N]
        out[:, part] = own[:, :here]
    return out


@compiled(**OPTIONS)
def weighted(signals, weights, first, here, out):
    """`struts.signals` of one block of designs."""
    out[:] = 0.0
    for j in range(len(weights)):
        if weights[j] != 0.0:
            for row in range(signals.shape[1]):
                for k in range(signals.shape[2]):
                    for N in range(here):
                        out[row, k, N] += weights[j] * signals[j, row, k, first + N]


@compiled(**OPTIONS)
def at_once(rows, even, V):
    """Covariances of signals with X's derivatives, from the even derivatives of R at 0."""
    n = rows.shape[1]
    V[:] = 0.0
    for r in range(len(rows)):
        for i in range(0, n + 1, 2):
            for j in range(0, n, 2):
                for N in range(WIDTH):
                    V[r, i, N] += rows[r, j, N] * even[(i + j) // 2, N]
        for i in range(1, n + 1, 2):
            for j in range(1, n, 2):
                for N in range(WIDTH):
                    V[r, i, N] -= rows[r, j, N] * even[(i + j) // 2, N]


@compiled(**OPTIONS)
def later(rows, derivatives, V):
    """Add covariances of signals with X's derivatives at another time, from the derivatives of R."""
    n = rows.shape[1]
    for r in range(len(rows)):
        for i in range(n + 1):
            for j in range(0, n, 2):
                for N in range(WIDTH):
                    V[r, i, N] += rows[r, j, N] * derivatives[i + j, N]
            for j in range(1, n, 2):
                for N in range(WIDTH):
                    V[r, i, N] -= rows[r, j, N] * derivatives[i + j, N]


@compiled(**OPTIONS)
def carried(move, before, V):
    """Covariances of signals with X's derivatives a step later."""
    V[:] = 0.0
    for r in range(len(V)):
        for k in range(len(move)):
            for i in range(len(move)):
                for N in range(WIDTH):
                    V[r, k, N] += move[k, i, N] * before[r, i, N]


@compiled(**OPTIONS)
def products(rows, V, B, S, out):
    """Add `struts.products` of one block of designs on one side."""
    n, deflections, rates = rows.shape[1], B * B - B, B * B - B + 2 * S
    for i in range(B):
        for j in range(B):
            for k in range(n):
                for N in range(WIDTH):
                    out[i * B + j, N] += rows[i, k, N] * V[j, k, N]
    for i in range(B, B + 2 * S):
        for k in range(n):
            for N in range(WIDTH):
                out[deflections + i, N] += rows[i, k, N] * V[i, k, N]
    for i in range(B, B + S):
        for k in range(n - 1):
            for N in range(WIDTH):
                out[rates + i, N] -= rows[i, k, N] * V[i, k + 2, N]


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
