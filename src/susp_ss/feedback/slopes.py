"""How variances change with the weights for which a gain is optimal, where that gain sees the states alone.

A change dK of the gain is one more force, ``-dK x``. With the costate of one output y under the gain as it is, ``-l' =
F^T l + h^T y``, its variance changes by ``-2 E[(D^T y + B^T l) (dK x)]``: no other output, and no other change, needs
another solution. Between axles x is a rest and a decay, y likewise, and the costate is ``Y psi + mu + q``, what it is
without further axles, what the rest adds, and what the next axle's jump sends back in time, ``-q' = F^T q``.

The gain follows the weights by the Riccati equation: of a weight's share, ``(A - B K)^T dP + dP (A - B K) + c^T c = 0``
and ``R dK = B^T dP + D^T c``, c being the output's row under the gain. Read backwards, one Lyapunov equation an output
serves all weights.
"""

from __future__ import annotations

import numpy as np
import scipy.linalg
from numpy.typing import NDArray

from .preview import Law, Noise, System, carried

Array = NDArray[np.float64]


def by_weights(system: System, noises: list[Noise], law: Law, rows: NDArray[np.int_]) -> Array:
    """Derivatives (rows, m) of the variances of some outputs by the weights of all, under the law's K alone.

    ``law`` is `preview.optimal` for its weights.
    """
    B, D = system.B, system.D
    Ac, Cc = system.A - B @ law.K, system.C - D @ law.K
    slopes = np.sum([by_gain(system, noise, law.K, rows) for noise in noises], axis=0)
    found = []
    for slope in slopes:
        pulled = np.linalg.solve(law.R, slope)
        pushed = B @ pulled
        Z = scipy.linalg.solve_continuous_lyapunov(Ac, -0.5 * (pushed + pushed.T))
        found.append(((Cc @ Z + D @ pulled) * Cc).sum(axis=1))
    return np.array(found)


def by_gain(system: System, noise: Noise, K: Array, rows: NDArray[np.int_]) -> Array:
    """Derivatives (rows, k, n) of what one noise adds to the variances of some outputs under ``u = -K x``."""
    A, B, C, D = system
    n, r = len(A), len(noise.rates)
    Ac, Cc = A - B @ K, C - D @ K
    F = np.block([[Ac, noise.pushed], [np.zeros((r, n)), -np.diag(noise.rates)]])
    H = np.hstack([Cc, noise.seen])
    held, bent, jumps = (
        np.cumsum(noise.held, axis=0),
        np.cumsum(noise.bent, axis=0),
        np.hstack([noise.entries, noise.bank]),
    )

    x, stirred, passed = jumps[0], np.zeros_like(F), []
    for j, T in enumerate(np.diff(noise.delays)):
        rho = np.append(-np.linalg.solve(Ac, bent[j]), np.zeros(r))
        E, psi, rest = scipy.linalg.expm(F * T), x - rho, H @ rho + held[j]
        last = E @ psi
        stirred += np.outer(psi, psi) - np.outer(last, last)
        passed.append((T, E, rho, rest, psi, last, np.linalg.solve(F, last - psi)))
        x = last + rho + jumps[j + 1]
    X = scipy.linalg.solve_continuous_lyapunov(F, -stirred - np.outer(x, x))

    found = []
    for row in rows:
        h = H[row]
        Y = scipy.linalg.solve_continuous_lyapunov(F.T, -np.outer(h, h))
        felt, moved, costate = X @ h, Y @ X, Y @ x
        for T, E, rho, rest, psi, last, total in reversed(passed):
            mu = -np.linalg.solve(F.T, h * rest[row])
            end = costate - Y @ last - mu
            start = E.T @ end
            sent = np.linalg.solve(F.T, start - end)
            felt += rest[row] * (T * rho + total) + rho * (h @ total)
            moved += np.outer(mu, T * rho + total) + np.outer(Y @ total + sent, rho)
            # The road's states drive those of the vehicle, whose costate therefore runs by itself.
            moved[:n] += carried(F, psi, end[:n], Ac, T)[1].T
            costate = Y @ psi + mu + start
        found.append(-2.0 * (np.outer(D[row], felt[:n]) + B.T @ moved[:n, :n]))
    return np.array(found)
