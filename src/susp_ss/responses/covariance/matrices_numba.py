"""The matrix route design by design, compiled: the equations of `lyapunov` and `first_order`, for very many designs.

Importing this loads the compiler: a second, and at first use on a machine some ten more to compile.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from .compiler import compiled

jit = compiled(error_model="numpy", fastmath={"reassoc", "contract", "arcp"})

# As in `lyapunov`: Taylor steps of at most this reach, and terms enough for it.
REACH, TERMS = 4.0, 32

# A correction as small as this, relative to the solution, needs no further one.
SOUND = 1e-13


@jit
def factorise(A, rows):
    """LU of A in place with row exchanges, recorded in ``rows``."""
    n = A.shape[0]
    for k in range(n):
        p = k
        for i in range(k + 1, n):
            if abs(A[i, k]) > abs(A[p, k]):
                p = i
        rows[k] = p
        if p != k:
            for j in range(n):
                A[k, j], A[p, j] = A[p, j], A[k, j]
        inverse = 1.0 / A[k, k]
        for i in range(k + 1, n):
            factor = A[i, k] * inverse
            A[i, k] = factor
            if factor != 0.0:
                for j in range(k + 1, n):
                    A[i, j] -= factor * A[k, j]


@jit
def substitute(A, rows, b):
    """``A^-1 b`` in place, from `factorise`."""
    n = A.shape[0]
    for k in range(n):
        p = rows[k]
        if p != k:
            b[k], b[p] = b[p], b[k]
    for i in range(1, n):
        s = b[i]
        for j in range(i):
            s -= A[i, j] * b[j]
        b[i] = s
    for i in range(n - 1, -1, -1):
        s = b[i]
        for j in range(i + 1, n):
            s -= A[i, j] * b[j]
        b[i] = s / A[i, i]


@jit
def apply(K, C, x, out):
    """``A x`` with ``A = [[0, I], [-K, -C]]``."""
    n = K.shape[0]
    for i in range(n):
        s = 0.0
        for j in range(n):
            s += K[i, j] * x[j] + C[i, j] * x[n + j]
        out[i] = x[n + i]
        out[n + i] = -s


@jit
def propagate(K, C, tau, fastest, x):
    """``e^(A tau) x`` in place, by Taylor steps."""
    steps = max(1, int(np.ceil(fastest * tau / REACH)))
    h = tau / steps
    term, following = np.empty_like(x), np.empty_like(x)
    for _ in range(steps):
        term[:] = x
        for k in range(1, TERMS + 1):
            apply(K, C, term, following)
            size, change = 0.0, 0.0
            for i in range(len(x)):
                term[i] = h / k * following[i]
                x[i] += term[i]
                change, size = change + abs(term[i]), size + abs(x[i])
            if change < 1e-18 * size:
                break


@jit
def resolvent(K, C, alpha, a, b):
    """``(alpha I - A)^-1`` of the columns a and b, in place; alpha may be negative."""
    n = K.shape[0]
    shifted, rows = np.empty((n, n)), np.empty(n, np.int64)
    for i in range(n):
        for j in range(n):
            shifted[i, j] = K[i, j] + alpha * C[i, j]
        shifted[i, i] += alpha * alpha
    factorise(shifted, rows)
    p = np.empty(n)
    for x in (a, b):
        for i in range(n):
            s = x[n + i] + alpha * x[i]
            for j in range(n):
                s += C[i, j] * x[j]
            p[i] = s
        substitute(shifted, rows, p)
        for i in range(n):
            x[n + i] = alpha * p[i] - x[i]
            x[i] = p[i]


@jit
def equations(K, C, L):
    """The n^2 equations of `Dynamics.lyapunov`, a column for each unknown: P_ab, and W_ab where a < b.

    In this order the wheels, which touch nothing but the body, are eliminated before what they would fill in.
    """
    n = K.shape[0]
    V, T = np.zeros((n, n)), np.empty((n, n))
    unknown = 0
    for b in range(n):
        for a in range(b + 1):
            for skew in (False, True):
                if skew and a == b:
                    continue
                # V = P K^T + W C^T of a unit unknown has two rows.
                for j in range(n):
                    if skew:
                        V[a, j], V[b, j] = C[j, b], -C[j, a]
                    else:
                        V[b, j], V[a, j] = K[j, a], K[j, b]
                for i in range(n):
                    other = C[i, b] if a != b else 0.0
                    for j in range(n):
                        T[i, j] = C[i, a] * V[a, j] + other * V[b, j]
                if skew:
                    for i in range(n):
                        T[i, b] += K[i, a]
                        T[i, a] -= K[i, b]
                row = 0
                for j in range(n):
                    for i in range(j):
                        L[row, unknown] = T[i, j] + T[j, i]
                        L[row + 1, unknown] = V[i, j] - V[j, i]
                        row += 2
                    L[row, unknown] = 2.0 * T[j, j]
                    row += 1
                V[a, :] = 0.0
                V[b, :] = 0.0
                unknown += 1


@jit
def lyapunov(K, C, Q, X):
    """Solve ``A X + X A^T + Q = 0``, as `Dynamics.lyapunov` does; returns the relative error."""
    n = K.shape[0]
    trace = 0.0
    for i in range(n):
        trace += K[i, i]
    unit = np.sqrt(trace / n)
    K, C = K / unit**2, C / unit
    Qpp, Qpv, Qvv = Q[:n, :n] / unit, Q[:n, n:] / unit**2, Q[n:, n:] / unit**3

    L = np.empty((n * n, n * n))
    equations(K, C, L)
    V0, S0 = np.empty((n, n)), np.empty((n, n))
    for i in range(n):
        for j in range(n):
            s = -Qpv[i, j]
            for k in range(n):
                s -= 0.5 * Qpp[i, k] * C[j, k]
            V0[i, j] = s
    for i in range(n):
        for j in range(n):
            s = 0.0
            for k in range(n):
                s += C[i, k] * V0[k, j] - 0.5 * K[i, k] * Qpp[k, j]
            S0[i, j] = s
    right = np.empty(n * n)
    row = 0
    for j in range(n):
        for i in range(j):
            right[row] = Qvv[i, j] - S0[i, j] - S0[j, i]
            right[row + 1] = V0[j, i] - V0[i, j]
            row += 2
        right[row] = Qvv[j, j] - 2.0 * S0[j, j]
        row += 1

    factors, rows = L.copy(), np.empty(n * n, np.int64)
    factorise(factors, rows)
    y, left = right.copy(), np.empty(n * n)
    substitute(factors, rows, y)
    error = np.inf
    # Refinement; what a step changes tells the digits that are lost before it, and a second step is seldom needed.
    for _ in range(2):
        if error < SOUND:
            break
        for i in range(n * n):
            s = right[i]
            for j in range(n * n):
                s -= L[i, j] * y[j]
            left[i] = s
        substitute(factors, rows, left)
        y += left
        error = np.abs(left).max() / np.abs(y).max()

    P, S = np.empty((n, n)), -0.5 * Qpp
    unknown = 0
    for b in range(n):
        for a in range(b):
            P[a, b] = P[b, a] = y[unknown]
            S[a, b] += y[unknown + 1]
            S[b, a] -= y[unknown + 1]
            unknown += 2
        P[b, b] = y[unknown]
        unknown += 1
    for i in range(n):
        for j in range(n):
            s = -Qpv[i, j] - Qpv[j, i]
            for k in range(n):
                s += P[i, k] * K[j, k] + S[i, k] * C[j, k] + P[j, k] * K[i, k] + S[j, k] * C[i, k]
            X[i, j] = P[i, j]
            X[n + i, n + j] = 0.5 * s * unit**2
            X[i, n + j] = X[n + j, i] = S[i, j] * unit
    return error


@jit
def add_outer(Q, weight, x, y):
    """``Q += weight (x y^T + y x^T)``."""
    for i in range(len(x)):
        for j in range(len(x)):
            Q[i, j] += weight * (x[i] * y[j] + y[i] * x[j])


class System(NamedTuple):
    """Matrices of `SecondOrder` of N designs, and ``Y`` (N, outputs, 2n + 1), which reads them off (p, v, warp)."""

    m: Any
    K: Any
    C: Any
    K_in: Any
    C_in: Any
    Y: Any
    warp: Any


class Excitation(NamedTuple):
    """Processes with weights ``now`` and ``later`` (P, wheels), ``white`` (P, N) and colours (P, N, J); delays (N,)."""

    now: Any
    later: Any
    white: Any
    alphas: Any
    weights: Any
    tau: Any


@jit
def variances(system, excitation):
    """Variances (N, outputs) of N designs, the size of their terms, and the relative error of each solution."""
    m, K, C, K_in, C_in, Y, warp = system
    now, later, white, alphas, weights, tau = excitation
    N, n = m.shape
    wheels, states = K_in.shape[2], 2 * n + 1
    out, terms, errors = np.empty((N, Y.shape[1])), np.empty((N, Y.shape[1])), np.empty(N)
    root, k, c, X = np.empty(n), np.empty((n, n)), np.empty((n, n)), np.empty((2 * n + 1, 2 * n + 1))
    inputs, Q = np.empty((2 * n, wheels)), np.empty((2 * n, 2 * n))
    factors, rows, column = np.empty((n, n)), np.empty(n, np.int64), np.empty(n)
    y = np.empty(2 * n + 1)
    for design in range(N):
        for i in range(n):
            root[i] = np.sqrt(m[design, i])
        stiffness, damping = 0.0, 0.0
        for i in range(n):
            sum_k, sum_c = 0.0, 0.0
            for j in range(n):
                k[i, j] = K[design, i, j] / (root[i] * root[j])
                c[i, j] = C[design, i, j] / (root[i] * root[j])
                sum_k += abs(k[i, j])
                sum_c += abs(c[i, j])
            stiffness, damping = max(stiffness, sum_k), max(damping, 0.5 * sum_c)
        fastest = damping + np.sqrt(damping**2 + stiffness)
        factors[:] = k
        factorise(factors, rows)
        for w in range(wheels):
            for i in range(n):
                column[i] = K_in[design, i, w] / root[i]
                inputs[n + i, w] = C_in[design, i, w] / root[i]
            substitute(factors, rows, column)
            inputs[:n, w] = -column

        Q[:] = 0.0
        X[:] = 0.0
        for process in range(len(white)):
            front, rear = inputs @ now[process], inputs @ later[process]
            delayed = np.any(later[process] != 0.0)
            free = front.copy()
            if delayed:
                propagate(k, c, tau[design], max(fastest, 0.0), free)
            colour_g, colour_h = np.zeros(2 * n), np.zeros(2 * n)
            q = white[process, design]
            drift_now, drift_later = warp @ now[process], warp @ later[process]
            bounded = drift_now + drift_later != 0.0
            cross, own, memory_sum = np.zeros(2 * n), 0.0, 0.0
            difference = np.zeros(2 * n)
            for j in range(alphas.shape[2]):
                alpha, weight = alphas[process, design, j], weights[process, design, j]
                sigma2 = 0.5 * weight * alpha
                decay = np.exp(-alpha * tau[design]) if delayed else 1.0
                # Of a colour u of unit variance: E[x u(t)], and the two halves of E[x u(t - tau)].
                x_now, before = front + decay * rear, rear + free
                resolvent(k, c, alpha, x_now, before)
                forced = np.zeros(2 * n)
                if delayed:
                    forced, spare = decay * front - free, np.zeros(2 * n)
                    resolvent(k, c, -alpha, forced, spare)
                colour_g += sigma2 * x_now
                colour_h += sigma2 * (before + forced)
                if bounded:
                    height = -0.5 * weight / alpha
                    cross += alpha * height * (drift_now * x_now + drift_later * (before - forced))
                    own += height * (drift_now**2 + drift_later**2 + 2.0 * drift_now * drift_later * decay)
                else:
                    memory = -np.expm1(-alpha * tau[design]) / alpha
                    difference += sigma2 * (x_now - before - forced)
                    memory_sum += sigma2 * memory
                    own += weight * (tau[design] - memory)
            add_outer(Q, 0.5 * q, front, front)
            add_outer(Q, 1.0, front, colour_g)
            if delayed:
                add_outer(Q, 0.5 * q, rear, rear)
                add_outer(Q, q, free, rear)
                add_outer(Q, 1.0, rear, colour_h)
            if not bounded:
                own = (own + q * tau[design]) * drift_now**2
                # A^-1 of what is left over the delay.
                source = q * (free - front) - difference - memory_sum * (front + rear)
                for i in range(n):
                    s = source[n + i]
                    for j in range(n):
                        s += c[i, j] * source[j]
                    column[i] = s
                substitute(factors, rows, column)
                cross[:n] = -drift_now * column
                cross[n:] = drift_now * source[:n]
            for i in range(2 * n):
                X[i, 2 * n] += cross[i]
                X[2 * n, i] += cross[i]
            X[2 * n, 2 * n] += own

        errors[design] = lyapunov(k, c, Q, X[: 2 * n, : 2 * n])
        for o in range(Y.shape[1]):
            y[:states] = Y[design, o]
            for i in range(n):
                y[i] /= root[i]
                y[n + i] /= root[i]
            total, size = 0.0, 0.0
            for i in range(states):
                if y[i] != 0.0:
                    s = 0.0
                    for j in range(states):
                        s += X[i, j] * y[j]
                    total += y[i] * s
                    size += abs(y[i]) * np.sqrt(max(X[i, i], 0.0))
            out[design, o], terms[design, o] = total, size**2
    return out, terms, errors
