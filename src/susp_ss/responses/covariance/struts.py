"""The exact variances of any number of struts on a rigid body from one scalar process: polynomials in ``s``.

Where left and right differ nothing splits, yet the algebra of `polynomials` goes on. With struts i = 1..S, ``kappa``
the S x S matrix of suspension forces (``ks + cs s`` of each, and anti-roll bars between pairs), ``E_i = kt + ct s + mu
s^2``, ``T_i = kt + ct s`` and ``U = sum mobility arm arm^T`` the body's compliance, of rank B, the road's velocities w
deflect the struts by

    [s^2 (E + kappa) + E U kappa] d = s T w.

The determinant of this matrix of polynomials is ``s^(2 (S - B)) D``, and its minors of k > B rows hold ``s^(2 (k -
B))``: exact zeros, which are left out. Every output is then ``[P(s) u(t) + Q(s) u(t - tau)] / (s D)`` for a road whose
wheels see ``now u(t) + later u(t - tau)``. D has degree ``2 (S + B)``: 14 for a full car, 18 for a truck of three
axles.

With ``s D X = u`` every variance is a fixed combination of the derivatives of X's autocorrelation R at 0 and at tau.
X itself drifts; where the wheels' heights together carry the body without warping it, ``P(0) + Q(0) = 0``, and R counts
from R(0) alone.
"""

from __future__ import annotations

from functools import cache
from itertools import combinations
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from . import polynomials
from .polynomials import Array, Track, windows
from .polynomials import start as start

# A sum of numerators no larger than this, relative to its terms, is zero but for rounding.
BALANCED = 1e-9


class Chassis(NamedTuple):
    """Struts on a rigid body, as arrays over N designs.

    ``struts`` (S, 5, N) of ``mu, ks, cs, kt, ct``; ``bars`` (M, N) between ``pairs`` (M, 2) of them; the body's
    coordinates by ``mobility`` (B, N) and ``arms`` (B, S, N).
    """

    struts: Array
    pairs: NDArray[np.int_]
    bars: Array
    mobility: Array
    arms: Array


class Linked(NamedTuple):
    """Monic D (n + 1, N), and `signals` of the road of each strut alone, (S, B + 2 S, n + 1, N)."""

    D: Array
    signals: Array


@cache
def expansions(S: int) -> tuple[NDArray[np.int_], ...]:
    """How minors of k + 1 rows follow from those of k, along their first row: (minors, k + 1, 3) for k = 0..S - 1.

    Each term is a column, the minor that it multiplies, and a sign; minors count the sets of their columns in order.
    """
    tables = []
    for k in range(S):
        below = {columns: i for i, columns in enumerate(combinations(range(S), k))}
        terms = [
            [(column, below[columns[:t] + columns[t + 1 :]], (-1) ** t) for t, column in enumerate(columns)]
            for columns in combinations(range(S), k + 1)
        ]
        tables.append(np.array(terms))
    return tuple(tables)


def expanded(row: Array, minors: Array, table: NDArray[np.int_], zeros: int) -> Array:
    """Minors of one more row (S, 5, N) on top, along it, without their lowest coefficients that are zero."""
    column, below, sign = np.moveaxis(table, -1, 0)
    factors = sign[:, :, None, None] * row[column, ::-1]
    padded = np.zeros((len(minors), minors.shape[1] + 8 - zeros, minors.shape[2]))
    padded[:, 4 - zeros : -4] = minors
    return np.asarray(np.einsum("ctin,ctkin->ckn", factors, windows(padded[below], 5)))


def matrix(chassis: Chassis) -> Array:
    """``s^2 (E + kappa) + E U kappa``, (S, S, 5, N)."""
    mu, tyres, arms = chassis.struts[:, :1], chassis.struts[:, 3:], chassis.arms
    S, N = len(mu), mu.shape[2]
    kappa = np.zeros((S, S, 2, N))
    for i in range(S):
        kappa[i, i] = chassis.struts[i, 1:3]
    for (i, j), bar in zip(chassis.pairs, chassis.bars, strict=True):
        for one, other in ((i, j), (j, i)):
            kappa[one, one, 0] += bar
            kappa[one, other, 0] -= bar
    E = np.concatenate([tyres, mu], axis=1)
    compliance = np.einsum("bin,bjn->ijn", chassis.mobility[:, None] * arms, arms)
    accelerations = np.einsum("imn,mjkn->ijkn", compliance, kappa)
    out = np.zeros((S, S, 5, N))
    out[:, :, 2:4] = kappa
    for k in range(3):
        out[:, :, k : k + 2] += E[:, None, k : k + 1] * accelerations
    for i in range(S):
        out[i, i, 2:] += E[i]
    return out


def linked(chassis: Chassis) -> Linked:
    """The determinant and the adjugate, by minors from the last row up, and what the road of each strut stirs."""
    M, S, B, N = matrix(chassis), len(chassis.struts), len(chassis.mobility), chassis.struts.shape[2]
    tables = expansions(S)

    def with_row(i: int, minors: Array, k: int) -> Array:
        return expanded(M[i], minors, tables[k], 2 if k + 1 > B else 0)

    below = [np.ones((1, 1, N))]
    for k in range(S - 1):
        below.append(with_row(S - 1 - k, below[k], k))
    D = with_row(0, below[S - 1], S - 1)[0]
    monic = 1.0 / D[-1]
    adjugate, shift = np.zeros((S, S, len(D), N)), 2 if S == B else 0
    for i in range(S):
        minors = below[S - 1 - i]
        for k in range(S - 1 - i, S - 1):
            minors = with_row(S - 2 - k, minors, k)
        # Minors that lack the last column come first.
        signed = minors[::-1] * (monic * (-1.0) ** np.arange(i, i + S)[:, None])[:, None]
        adjugate[i, :, shift : shift + minors.shape[1]] = signed
    return Linked(D * monic, stirred(chassis, adjugate))


def stirred(chassis: Chassis, adjugate: Array) -> Array:
    """Numerators over ``s D`` by the road of each strut, (S, B + 2 S, n + 1, N), from each column of the adjugate.

    Accelerations of the body's coordinates, then deflections of the struts and of the tyres. A wheel's equation of
    motion gives its tyre's force; by reciprocity that of one tyre by the road of another has the factors ``T`` of both,
    which are left out.
    """
    S, B = len(chassis.struts), len(chassis.mobility)
    m, k, c, kt, ct = (chassis.struts[:, i, None] for i in range(5))
    out = np.empty((S, B + 2 * S, *adjugate.shape[2:]))
    force = k * adjugate
    force[:, :, 1:] += c * adjugate[:, :, :-1]
    for (one, other), bar in zip(chassis.pairs, chassis.bars, strict=True):
        across = bar * (adjugate[:, one] - adjugate[:, other])
        force[:, one] += across
        force[:, other] -= across
    body, deflections, tyres = out[:, :B], out[:, B : B + S], out[:, B + S :].swapaxes(0, 1)
    np.einsum("bin,jikn->jbkn", chassis.mobility[:, None] * chassis.arms, force, out=body)
    # The wheel accelerates with the body point above it, and along the deflection.
    np.einsum("bin,jbkn->jikn", chassis.arms, body, out=tyres)
    tyres[:, :, 2:] += adjugate[:, :, :-2]
    tyres *= m
    tyres += force
    deflections[:] = adjugate
    rest = out[:, : B + S]
    damped = ct[:, None] * rest[:, :, :-1]
    rest *= kt[:, None]
    rest[:, :, 1:] += damped
    return out


def signals(linked: Linked, weights: Array) -> Array:
    """Those of `stirred` where the road under the struts moves at ``weights`` (sides, S) times u: (sides, ...)."""
    return np.asarray(np.tensordot(weights, linked.signals, axes=1))


def powers(p: Array, D: Array) -> Array:
    """``s^k p mod s^2 D`` for k = 0..n + 1, each from the one before, (n + 2, n + 2, N).

    Higher powers reduced at once would lose digits, for wheels hop almost alike.
    """
    out = np.zeros((len(p), *p.shape))
    out[0] = p
    for k in range(len(p) - 1):
        out[k + 1, 1:] = out[k, :-1]
        out[k + 1, 2:] -= out[k, -1] * D[:-1]
    return out


def squared(p: Array, D: Array, times: int) -> Array:
    """`powers` of p squared so many times."""
    out = powers(p, D)
    for _ in range(times):
        out = powers((out[0][:, None] * out).sum(axis=0), D)
    return out


def moved(D: Array, tau: Array, squarings: int, kernels: Any) -> Array:
    """``s^k e^(s tau) mod s^2 D``: what X and its derivatives will be, from what they are, (n + 2, n + 2, N)."""
    drifting = np.zeros((len(D) + 2, D.shape[1]))
    drifting[2:] = D
    short = polynomials.delay_operator(drifting, tau / 2.0**squarings, 0)
    return np.asarray(kernels.squared(short, D, squarings))


def products(rows: Array, V: Array, B: int, S: int) -> Array:
    """Second moments (B^2 + 3 S, N) of signals (sides, B + 2 S, n + 1, N) with others, summed over the sides.

    V (sides, B + 2 S, n + 2, N) are the others' covariances with X's derivatives. Each of the body's coordinates comes
    with each, then each deflection, tyre and rate with itself.
    """
    n, d = rows.shape[2], slice(B, B + S)
    body = np.einsum("wikn,wjkn->ijn", rows[:, :B], V[:, :B, :n])
    each = np.einsum("wikn,wikn->in", rows[:, B:], V[:, B:, :n])
    rates = -np.einsum("wikn,wikn->in", rows[:, d, :-1], V[:, d, 2:])
    return np.concatenate([body.reshape(B * B, -1), each, rates])


def together(
    linked: Linked,
    weights: Array,
    B: int,
    derivatives: tuple[Array, Array, Array],
    step: Array,
    steps: int,
) -> Array:
    """Second moments (B^2 + 3 S, N) of `signals` of ``weights`` (1 or 2, S), the second of which come a delay later.

    R has the even ones of ``derivatives`` at 0. Over the delay it is a function of the second at 0, carried by so many
    steps, and of the third after it, where there is one.
    """
    even, free, gone = derivatives
    S, n = len(linked.signals), len(linked.D)
    rows = signals(linked, weights)
    # E[X^(i)(t) X^(j)(0)] = (-1)^j R^(i + j)(t): at 0 even derivatives see even ones alone, and odd ones odd ones.
    mirrored, V = rows.copy(), np.empty((*rows.shape[:2], n + 1, rows.shape[3]))
    mirrored[:, :, 1::2] *= -1.0
    for odd in (0, 1):
        by = windows(even[odd:], (n + 1) // 2 - odd)
        np.einsum("wrjn,ijn->wrin", mirrored[:, :, odd::2], by, out=V[:, :, odd::2])
    out = products(rows, V, B, S)
    if len(weights) > 1:
        late = np.einsum("rjn,ijn->rin", mirrored[1], windows(free, n))
        for _ in range(steps):
            late = np.einsum("kin,rin->rkn", step, late)
        if len(gone):
            late += np.einsum("rjn,ijn->rin", mirrored[1], windows(gone, n))
        across = products(rows[:1], late[None], B, S)
        out += across
        out[B * B :] += across[B * B :]
        out[: B * B] += across[: B * B].reshape(B, B, -1).swapaxes(0, 1).reshape(B * B, -1)
    return out


def excited(
    linked: Linked,
    B: int,
    weights: Array,
    steep: bool,
    road: Track,
    tau: Array,
    step: Array,
    steps: int,
    kernels: Any,
) -> Array:
    """Second moments of the body's B accelerations, of deflections, tyres and rates, (B^2 + 3 S, N), on one process.

    Wheels see it by ``weights`` (2, S), at once and after the delay. The moments are nan where their heights warp the
    body without bound: all together or, on a ``steep`` road, those at once.
    """
    D, N = linked.D, linked.D.shape[1]
    n, none = len(D) - 1, np.zeros((0, N))
    real, real_both = polynomials.apart(D, road.real.alphas)
    swinging, swinging_both = polynomials.apart(D, road.swinging.alphas)
    road = Track(road.level, road.real._replace(alphas=real), road.swinging._replace(alphas=swinging))
    even = np.zeros((n + 1, N))
    even[1:] = -kernels.start(D, road)
    derivatives, sides = (even, none, none), weights[:1]
    if weights[1].any():
        # The exponentials that colours leave in R cross the delay by themselves, without value and slope at 0.
        free, gone, count, sides = np.zeros((2 * n + 2, N)), none, 2 * n + 2, weights
        free[::2] = even
        if len(real) or len(swinging):
            g = polynomials.fading(road.real, real_both, True)
            h = polynomials.fading(road.swinging, swinging_both, True)
            free -= polynomials.decaying(g, real, 2, count) + polynomials.decaying(h, swinging, 2, count).real
            gone = polynomials.faded(g, real * tau, real, True, count)
            gone += polynomials.faded(h, swinging * tau, swinging, True, count).real
        free[-1] = -polynomials.applied(D[:-1], free[n + 1 : -1])
        derivatives = even, free, gone
    at_rest = linked.signals[:, B : -len(linked.signals), 0]

    def warped(weights: Array) -> Array:
        return np.abs(np.einsum("jin,j->in", at_rest, weights)).sum(axis=0)

    warp = warped(weights.sum(axis=0)) + steep * warped(weights[0])
    size = np.einsum("jin,j->n", np.abs(at_rest), np.abs(weights).sum(axis=0))
    out = kernels.together(linked, sides, B, derivatives, step, steps)
    return np.where(warp > BALANCED * size, np.nan, out)
