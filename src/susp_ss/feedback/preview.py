"""The least weighted sum of variances over all causal laws, and every output's variance under the law that reaches it.

``x' = A x + B u + f`` and ``y = C x + D u + e``, where what the road does, f and e, is known as far ahead as the axles
behind will meet what the first has met. With the stabilising solution P of the Riccati equation for the weights,

    u = -K x - R^-1 (B^T s + D^T W e),    -s' = (A - B K)^T s + P f + (C - D K)^T W e,

with ``R = D^T W D``. A unit of noise that enters at time 0 moves x by a jump at every axle, s by one jump less, each at
its own delay; in between both follow exponentials. So every output's response to it is known in closed form, and its
variance is the integral of the square: no delay line, no Pade, no grid.

In ``x = psi + Z s`` with ``(A - B K) Z + Z (A - B K)^T = B R^-1 B^T`` both parts run by themselves, psi forwards and s
backwards in time (Hac, Vehicle System Dynamics 21 (1992); Tomizuka, J. Dyn. Sys. Meas. Control 98 (1976)).
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
import scipy.linalg
from numpy.typing import NDArray

Array = NDArray[np.float64]

# Steps of Kleinman's iteration at most, and the share of the costs by which the last one may still descend. Far from
# the optimum each step halves what is too much, close to it the digits double.
STEPS, SETTLED = 80, 1e-12


class System(NamedTuple):
    """``x' = A x + B u``, ``y = C x + D u``: states (n), forces (k) and outputs (m)."""

    A: Array
    B: Array
    C: Array
    D: Array


class Noise(NamedTuple):
    """One white noise of unit intensity, met by one axle after the other, and the states ``v' = -rates v`` behind it.

    A unit of noise makes x jump by ``entries`` (J, n), v by ``bank`` (J, r), and what outputs and x' see of a road that
    stands still by ``held`` (J, m) and ``bent`` (J, n), each after its own of the ``delays`` (J,), the first of which
    is 0. Then v drives x by ``pushed`` (n, r), and outputs see it by ``seen`` (m, r).
    """

    delays: Array
    entries: Array
    bank: Array
    held: Array
    bent: Array
    rates: Array
    pushed: Array
    seen: Array


class Law(NamedTuple):
    """``u = -K x`` and what it adds for what is known of the road, which is nothing where ``weights`` is None."""

    K: Array
    P: Any = None
    weights: Any = None
    R: Any = None


def optimal(system: System, weights: Array, start: Array | None = None) -> Law:
    """The law of least ``sum weights y^2`` by Kleinman's iteration (IEEE Trans. Automatic Control 13 (1968)).

    Every step costs the last gain by a Lyapunov equation and descends, whatever the weights are, so that nothing hangs
    on the conditioning of a Hamiltonian matrix. It starts at ``start`` (k, n), or at no force, which must be stable.
    """
    A, B, C, D = system
    R, K = D.T * weights @ D, np.zeros(B.shape[::-1]) if start is None else start
    reached: tuple[float, Array, Array] | None = None
    for _ in range(STEPS):
        Ac, Cc = A - B @ K, C - D @ K
        if np.linalg.eigvals(Ac).real.max() >= 0.0:
            break
        P = scipy.linalg.solve_continuous_lyapunov(Ac.T, -(Cc.T * weights @ Cc))
        size = float(np.trace(P))
        settled = reached is not None and size > reached[0] * (1.0 - SETTLED)
        if reached is None or size < reached[0]:
            reached = size, K, P
        if settled:
            break
        K = np.linalg.solve(R, B.T @ P + D.T * weights @ C)
    if reached is None:
        return optimal(system, weights)
    return Law(reached[1], reached[2], weights, R)


def variances(system: System, noises: list[Noise], law: Law) -> Array:
    """Variances (m,) of all outputs under a law.

    Every eigenvalue of ``A - B K`` lies in the open left half plane.
    """
    return np.asarray(sum(_variances(system, noise, law) for noise in noises))


def bank_gain(system: System, noise: Noise, law: Law) -> tuple[Array, Array]:
    """How v acts on the costate of x, (n, r), and on the forces, ``u = ... - gain v`` (k, r)."""
    if law.weights is None:
        return np.zeros((len(system.A), len(noise.rates))), np.zeros((system.B.shape[1], len(noise.rates)))
    A, B, C, D = system
    Ac, Cc = A - B @ law.K, C - D @ law.K
    right = law.P @ noise.pushed + Cc.T * law.weights @ noise.seen
    N = np.empty_like(right)
    for k, rate in enumerate(noise.rates):
        N[:, k] = np.linalg.solve(rate * np.eye(len(A)) - Ac.T, right[:, k])
    return N, np.linalg.solve(law.R, B.T @ N + D.T * law.weights @ noise.seen)


def _variances(system: System, noise: Noise, law: Law) -> Array:
    n, r = len(system.A), len(noise.rates)
    Ac, Cc = system.A - system.B @ law.K, system.C - system.D @ law.K
    N, gain = bank_gain(system, noise, law)
    # x and v forwards in time, s backwards.
    F = np.block([[Ac, noise.pushed - system.B @ gain], [np.zeros((r, n)), -np.diag(noise.rates)]])
    H = np.hstack([Cc, noise.seen - system.D @ gain])
    Z, L = _backwards(system, law, Ac, Cc)
    jumps, lengths = np.hstack([noise.entries, noise.bank]), np.diff(noise.delays)
    ahead = _ahead(system, noise, law, Ac, Cc, N, lengths)

    total, X = np.zeros(len(Cc)), jumps[0]
    forwards, backwards = np.zeros_like(F), np.zeros_like(Ac)
    for (s, s_end, x_rest, rest), T, jump in zip(ahead, lengths, jumps[1:], strict=True):
        psi = X - np.r_[Z @ s + x_rest, np.zeros(r)]
        gone, crossed = carried(F, psi, s_end, Ac, T)
        forwards += np.outer(psi, psi) - np.outer(gone, gone)
        backwards += np.outer(s_end, s_end) - np.outer(s, s)
        moving = H @ np.linalg.solve(F, gone - psi) + L @ np.linalg.solve(Ac.T, s - s_end)
        total += 2.0 * np.einsum("mi,ij,mj->m", H, crossed, L) + rest * (T * rest + 2.0 * moving)
        X = gone + np.r_[Z @ s_end + x_rest, np.zeros(r)] + jump
    total += _squares(F, forwards + np.outer(X, X), H)
    return total + _squares(Ac.T, backwards, L) if backwards.any() else total


def _squares(A: Array, Q: Array, C: Array) -> Array:
    """Variances of C x where ``A X + X A^T + Q = 0``."""
    return np.einsum("mi,ij,mj->m", C, scipy.linalg.solve_continuous_lyapunov(A, -Q), C)


def _backwards(system: System, law: Law, Ac: Array, Cc: Array) -> tuple[Array, Array]:
    """How s moves x and the outputs."""
    if law.R is None:
        return np.zeros_like(Ac), np.zeros_like(Cc)
    RB = np.linalg.solve(law.R, system.B.T)
    Z = scipy.linalg.solve_continuous_lyapunov(Ac, system.B @ RB)
    return Z, Cc @ Z - system.D @ RB


def _ahead(
    system: System, noise: Noise, law: Law, Ac: Array, Cc: Array, N: Array, lengths: Array
) -> list[tuple[Array, Array, Array, Array]]:
    """For each interval between axles: s at its start and end but for what rests in it, and x and y at rest there."""
    B, D, k = system.B, system.D, system.B.shape[1]
    held, bent = np.cumsum(noise.held, axis=0), np.cumsum(noise.bent, axis=0)
    later, found = np.zeros(len(Ac)), []
    for j in reversed(range(len(lengths))):
        s = s_end = np.zeros(len(Ac))
        u_rest = np.zeros(k)
        if law.weights is not None:
            weighted = law.weights * held[j]
            s_rest = -np.linalg.solve(Ac.T, law.P @ bent[j] + Cc.T @ weighted)
            u_rest = -np.linalg.solve(law.R, B.T @ s_rest + D.T @ weighted)
            s_end = later + law.P @ noise.entries[j + 1] + N @ noise.bank[j + 1] - s_rest
            s = scipy.linalg.expm(Ac.T * lengths[j]) @ s_end
            later = s + s_rest
        x_rest = -np.linalg.solve(Ac, B @ u_rest + bent[j])
        found.append((s, s_end, x_rest, Cc @ x_rest + D @ u_rest + held[j]))
    return found[::-1]


def carried(F: Array, psi: Array, s_end: Array, Ac: Array, T: float) -> tuple[Array, Array]:
    """``e^(F T) psi``, and the integral of ``e^(F t) psi s^T e^(Ac (T - t))`` over the interval (Van Loan 1978)."""
    n, size = len(F), (np.linalg.norm(psi) * np.linalg.norm(s_end)) or 1.0
    grown = scipy.linalg.expm(T * np.block([[F, np.outer(psi, s_end) / size], [np.zeros((len(Ac), n)), Ac]]))
    return grown[:n, :n] @ psi, grown[:n, n:] * size
