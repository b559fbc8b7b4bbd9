"""The exact variances of half a symmetric car from one scalar process: polynomials in ``s``, no matrices.

A half (`susp_ss.vehicles.decoupled`) has one or two struts, each with suspension ``kappa = ks + cs s``, tyre
``T = kt + ct s`` and wheel ``E = T + mu s^2``, joined by the body's compliance ``u_ij`` (acceleration over strut i per
unit force of strut j). With ``Q_i = s^2 (E_i + kappa_i) + u_ii kappa_i E_i`` the road's velocities w deflect them by

    d_1 = s [T_1 Q_2 w_1 - u_12 E_1 kappa_2 T_2 w_2] / D,    D = Q_1 Q_2 - u_12^2 kappa_1 kappa_2 E_1 E_2,

and d_2 likewise; one strut alone by ``d = s T w / Q``. Let ``D xi = w``: every variance is a fixed combination of the
derivatives of xi's autocorrelation r at 0 and, with a wheelbase delay, at tau.

- At 0, ``D(d/dt) r = 0`` and the symmetry of r leave a Hurwitz system, solved by Routh's elimination (`routh`).
- At tau they follow from ``D(d/dt) r = 0`` in between: ``r(t + tau) = [e^(s tau) mod D] r(t)``, the remainder of a
  power series, squared up from a short step (`delay_operator`).
- A first-order colour of the road (its cut-off, the coherence of isotropic tracks) lengthens D by one factor, and
  leaves an exponential that crosses the delay on its own.

A body that only rolls has one mode, which makes ``D = s^2 D~``: a road that differs between front and rear warps it.
Deflections then hold the integral of ``xi = w / D~`` over the delay; minus r integrated twice is its autocorrelation.

Polynomials are arrays of rows, the coefficients of 1, s, s^2, ..., with one column a design. The road's spectrum is a
level and first-order terms, low-passes or high-passes: what cancels at either end never enters. Rates may be complex
(a frequency weighting's): then the real part counts.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

# The short step of a delay has |s h| <= 1, where the series is exact to rounding after 1 / 19!.
SERIES_TERMS = 19

# Columns of all colours that are eliminated together: few enough to stay near the processor.
TOGETHER = 4096

# A colour as close as this to a real pole is moved by as much: what that changes is what rounding would.
COINCIDENT = 1e-8


class Body(NamedTuple):
    """What joins two struts: compliance (2, 2, N), its determinant (N,), and whether it has one mode only: it rolls."""

    compliance: Array
    rigidity: Array
    rolls: bool


class Colours(NamedTuple):
    """Terms ``(low alphas^2 + high omega^2) / (alphas^2 + omega^2)``, (J, N)."""

    alphas: Any
    low: Any
    high: Any


class Track(NamedTuple):
    """A road: the two-sided spectrum of a level (N,) and colours; complex ones count by their real part."""

    level: Array
    real: Colours
    swinging: Colours


class Delay(NamedTuple):
    """How much later the second strut meets the road (N,), in how many steps that is walked, and halvings of each.

    No step when both struts meet the road at once.
    """

    tau: Array
    steps: int
    halvings: int


class OneStrut(NamedTuple):
    """Variances that `one_strut` returns as rows."""

    force: Any
    deflection: Any
    rate: Any
    load: Any
    tyre: Any


class TwoStruts(NamedTuple):
    """Variances that `two_struts` returns as rows; ``force_12`` is the covariance of both forces."""

    force_1: Any
    force_2: Any
    force_12: Any
    deflection_1: Any
    deflection_2: Any
    rate_1: Any
    rate_2: Any
    load_1: Any
    load_2: Any
    tyre_1: Any
    tyre_2: Any


class Wheel(NamedTuple):
    """Mass of a wheel, spring and damper of the suspension on it, and the stiffness of its tyre."""

    m: Any
    k: Any
    c: Any
    kt: Any


class Joint(NamedTuple):
    """The body's compliance between both struts."""

    u11: Any
    u22: Any
    u12: Any


class Even(NamedTuple):
    """Derivatives of order 0, 2 and 4 of a deflection's autocorrelation at 0."""

    value: Any
    bend: Any
    jerk: Any


class Cross(NamedTuple):
    """Derivatives of order 0 to 3 of ``E[d_1(t) d_2(0)]`` at 0."""

    value: Any
    slope: Any
    bend: Any
    third: Any


def windows(p: Array, width: int) -> Array:
    """``p[i + j]`` for every i and for j below the width, of rows (..., length, N): a view (..., i, j, N)."""
    *before, row, column = p.strides
    shape = (*p.shape[:-2], p.shape[-2] - width + 1, width, p.shape[-1])
    return np.lib.stride_tricks.as_strided(p, shape, (*before, row, row, column), writeable=False)


def product(p: Array, q: Array) -> Array:
    """``p(s) q(s)``."""
    out = np.zeros((len(p) + len(q) - 1, p.shape[1]))
    for i in range(len(p)):
        out[i : i + len(q)] += p[i] * q
    return out


def plus(p: Array, q: Array, shift: int = 0) -> Array:
    """``p(s) + s^shift q(s)``; complex if q is."""
    out = np.zeros((max(len(p), len(q) + shift), p.shape[1]), dtype=q.dtype)
    out[: len(p)] = p
    out[shift : shift + len(q)] += q
    return out


def scaled(p: Array, factor: Array) -> Array:
    """``factor p(s)``, a factor each design."""
    return p * factor


def reflected(p: Array) -> Array:
    """``p(-s)``."""
    out = p.copy()
    out[1::2] *= -1.0
    return out


def every_other(p: Array, first: int) -> Array:
    """The even (0) or odd (1) coefficients of p, as a polynomial in s^2."""
    return p[first::2].copy()


def modulus(p: Array) -> Array:
    """``p(s) p(-s)`` as a polynomial in s^2."""
    even, odd = every_other(p, 0), every_other(p, 1)
    return plus(product(even, even), scaled(product(odd, odd), -np.ones(p.shape[1])), 1)


def applied(p: Array, derivatives: Array) -> Array:
    """``p(d/dt)`` of a function whose derivatives are the rows; those beyond the last count as zero."""
    n = min(len(p), len(derivatives))
    return np.asarray(np.add.reduce(p[:n] * derivatives[:n]))


def decaying(g: Array, alphas: Array, first: int, count: int) -> Array:
    """Derivatives of ``sum g e^(-alpha t)`` at 0, of orders first to count - 1; zeros before."""
    out = np.zeros((count, g.shape[1]), dtype=g.dtype)
    if len(g) == 0:
        return out
    rates = -alphas
    term = g * rates**first
    for k in range(first, count):
        term.sum(axis=0, out=out[k])
        term *= rates
    return out


def value(p: Array, s: Array) -> Array:
    """``p(s)`` at s (J, N), J a column of p."""
    if len(s) == 0:
        return s
    out = p[-1] + 0.0 * s
    for i in range(len(p) - 2, -1, -1):
        out = out * s + p[i]
    return out


def routh(D: Array, density: Array) -> Array:
    """Even derivatives ``r(0), r''(0), ..., r^(2n-2)(0)`` of the autocorrelation of ``D xi = w``.

    D of degree n has its roots in the open left half plane, and w the two-sided spectral density given. With
    ``L[p] = p(d/dt) r`` at 0 the system is ``L[s^k D] = 0`` for k < n - 1, of which only even parts count, and a jump
    in the last. Eliminating leading coefficients in turn leaves one new derivative in each row.
    """
    n = len(D) - 1
    table = np.zeros((n + 1, n // 2 + 1, D.shape[1]), dtype=D.dtype)
    right = np.zeros((n + 1, D.shape[1]), dtype=D.dtype)
    for j in range(n + 1):
        table[j % 2, j // 2] = D[n - j]
    right[1] = -((-1.0) ** n) * density / (2.0 * D[n])
    for i in range(1, n):
        factor = table[i - 1, 0] / table[i, 0]
        length = (n - i - 1) // 2 + 1
        table[i + 1, :length] = table[i - 1, 1 : length + 1]
        shared = (n - i) // 2
        table[i + 1, :shared] -= factor * table[i, 1 : shared + 1]
        right[i + 1] = -factor * right[i]
    derivatives = np.zeros((n, D.shape[1]), dtype=D.dtype)
    for e in range(n):
        row, known = table[n - e], e // 2
        rest = (row[1 : known + 1] * derivatives[e - known : e][::-1]).sum(axis=0)
        derivatives[e] = (right[n - e] - rest) / row[0]
    return derivatives


def delay_operator(D: Array, tau: Array, squarings: int) -> Array:
    """``e^(s tau) mod D`` for monic D: the series over ``tau / 2^squarings``, squared up."""
    n = len(D) - 1
    low, h = D[:n], tau / 2.0**squarings
    term, total = np.zeros((n, D.shape[1])), np.zeros((n, D.shape[1]))
    total[0] = 1.0
    for k in range(1, n):
        total[k] = total[k - 1] * (h / k)
    term[n - 1] = total[n - 1]
    for k in range(n, SERIES_TERMS):
        top = term[n - 1] * (h / k)
        term[1:] = term[: n - 1] * (h / k)
        term[0] = 0.0
        term -= top * low
        total += term
    between = np.zeros((3 * n - 2, D.shape[1]))
    for _ in range(squarings):
        between[n - 1 : 2 * n - 1] = total
        square = np.einsum("in,kin->kn", total[::-1], windows(between, n))
        for i in range(2 * n - 2, n - 1, -1):
            square[i - n : i] -= square[i] * low
        total = square[:n]
    return total


def apart(D: Array, alphas: Array) -> tuple[Array, Array]:
    """Rates of colours (J, N), none of which sits on a pole ``-alpha`` of D, and ``D(alpha) D(-alpha)``.

    All coefficients of D are positive, so that ``D(|alpha|)`` is the size of the terms of ``D(-alpha)``.
    """
    signed = value(reflected(D), alphas)
    near = np.abs(signed) < COINCIDENT * value(D, np.abs(alphas))
    if not near.any():
        return alphas, value(D, alphas) * signed
    rates = np.where(near, alphas * (1.0 + COINCIDENT), alphas)
    return rates, value(D, rates) * value(reflected(D), rates)


def start(D: Array, road: Track) -> Array:
    """Even derivatives of r at 0 for monic D, from white noise of the level and from every colour."""
    out = np.zeros((len(D) - 1, D.shape[1]))
    if road.level.any():
        out += routh(D, road.level)
    if len(road.real.alphas) > 0:
        out += coloured(D, road.real)
    if len(road.swinging.alphas) > 0:
        out += coloured(D, road.swinging).real
    return out


def coloured(D: Array, colours: Colours) -> Array:
    """The share of colours in `start`: low-passed white noise; a high-pass is it differentiated twice, over alpha^2."""
    n, N, J = len(D) - 1, D.shape[1], len(colours.alphas)
    out, together = np.zeros((n, N), dtype=colours.alphas.dtype), max(1, TOGETHER // N)
    for first in range(0, J, together):
        last = min(first + together, J)
        longer = np.zeros((n + 2, (last - first) * N), dtype=colours.alphas.dtype)
        for j in range(first, last):
            longer[:, (j - first) * N : (j - first + 1) * N] = plus(D, D / colours.alphas[j], 1)
        each = routh(longer, np.ones(longer.shape[1]))
        for j in range(first, last):
            here = each[:, (j - first) * N : (j - first + 1) * N]
            out += colours.low[j] * here[:n] - colours.high[j] / colours.alphas[j] ** 2 * here[1:]
    return out


def fading(colours: Colours, both: Array, rolls: bool) -> Array:
    """Sizes g (J, N) of the exponentials ``g e^(-alpha t)`` that colours leave in the autocorrelation of `start`.

    Of xi', or of the integral of xi where the body rolls; ``both`` is ``D(alpha) D(-alpha)``.
    """
    gone = 0.5 * (colours.high - colours.low) / both
    return gone / colours.alphas if rolls else gone * colours.alphas**3


def faded(g: Array, past: Array, alphas: Array, rolls: bool, count: int) -> Array:
    """Derivatives of orders below count, at the delay, of ``sum g e^(-alpha t)``.

    Where the body rolls they come without value and slope at 0.
    """
    later = decaying(g * np.exp(-past), alphas, 2 if rolls else 0, count)
    if rolls:
        later[0] += (g * (np.expm1(-past) + past)).sum(axis=0)
        later[1] -= (g * alphas * np.expm1(-past)).sum(axis=0)
    return later


def carried(A: Array, now: Array, exponentials: Array, later_exponentials: Array, delay: Delay) -> Array:
    """Derivatives 0 to 14 at tau of a function with ``A(d/dt)`` zero, apart from exponentials.

    A is monic of degree 8 and ``now`` holds the even derivatives at 0, of order 0 to 12; the odd ones are zero.
    ``exponentials`` are derivatives 0 to 12 of the exponentials at 0, ``later_exponentials`` 0 to 14 at tau.
    """
    n = 8
    free, later = np.zeros((2 * n - 1, A.shape[1])), np.zeros((2 * n - 1, A.shape[1]))
    free[0:13:2] = now
    free[:13] -= exponentials
    for k in range(13, 15):
        free[k] = -applied(A[:n], free[k - n : k])
    operator = delay_operator(A, delay.tau / delay.steps, delay.halvings)
    for _ in range(delay.steps):
        for k in range(n):
            later[k] = applied(operator, free[k : k + n])
        for k in range(n, 15):
            later[k] = -applied(A[:n], later[k - n : k])
        free[:] = later
    return later + later_exponentials


def one_strut(strut: Array, compliance: Array, road: Track) -> Array:
    """Variances (5, N) of `OneStrut`, where one strut alone carries the body.

    Parameters
    ----------
    strut : ndarray, (5, N)
        ``mu, ks, cs, kt, ct``.
    compliance : ndarray, (N,)
    road : Track
    """
    m, k, c = strut[0], strut[1], strut[2]
    kappa, T, E = strut[1:3], strut[3:5], wheel(strut)
    D = plus(scaled(product(kappa, E), compliance), plus(E, kappa), 2)
    monic = 1.0 / D[-1]
    now = -start(scaled(D, monic), road)[1:]
    P = scaled(modulus(T), monic**2)
    d, rate, jerk = applied(P, now), -applied(P, now[1:]), applied(P, now[2:])
    F = k**2 * d + c**2 * rate
    own = 1.0 + m * compliance
    out = np.zeros((5, strut.shape[1]))
    out[0], out[1], out[2] = F, d, rate
    out[3] = own**2 * F - 2.0 * own * m * k * rate + m**2 * jerk
    # The tyre is deflected by (m s w + F) / E, of which the numerator holds E as a factor.
    out[4] = applied(scaled(modulus(plus(scaled(kappa, own), strut[:1], 2)), monic**2), now)
    return out


def two_struts(struts: Array, body: Body, road: Track, delay: Delay, damped: bool) -> Array:
    """Variances (11, N) of `TwoStruts`, where the second strut meets the road a delay after the first.

    Parameters
    ----------
    struts : ndarray, (2, 5, N)
        ``mu, ks, cs, kt, ct`` of each.
    body : Body
    road : Track
    delay : Delay
    damped : bool
        Whether any tyre has damping.
    """
    compliance, rolls, N = body.compliance, body.rolls, struts.shape[2]
    u11, u22, u12 = compliance[0, 0], compliance[1, 1], compliance[0, 1]
    tyre = 5 if damped else 4
    kappa1, T1, E1 = struts[0, 1:3], struts[0, 3:tyre], wheel(struts[0])
    kappa2, T2, E2 = struts[1, 1:3], struts[1, 3:tyre], wheel(struts[1])
    G1, H1, G2, H2 = plus(E1, kappa1), product(kappa1, E1), plus(E2, kappa2), product(kappa2, E2)
    Q1, Q2 = plus(scaled(H1, u11), G1, 2), plus(scaled(H2, u22), G2, 2)

    # D / s^2 but for the rigidity's share, which a rolling body does not have.
    D = plus(scaled(product(H1, G2), u11), scaled(product(H2, G1), u22))
    D = plus(D, product(G1, G2), 2)
    if not rolls:
        D = plus(scaled(product(H1, H2), body.rigidity), D, 2)
    monic = 1.0 / D[-1]
    D = scaled(D, monic)
    real, real_both = apart(D, road.real.alphas)
    swinging, swinging_both = apart(D, road.swinging.alphas)
    real_colours = Colours(real, road.real.low, road.real.high)
    swinging_colours = Colours(swinging, road.swinging.low, road.swinging.high)
    r = start(D, Track(road.level, real_colours, swinging_colours))
    # Deflections are polynomials in xi', or in the integral of xi where the body rolls: of autocorrelation R.
    zero = np.zeros((7, N))
    if rolls:
        zero[1:] -= r
    else:
        zero -= r[1:]

    # Numerators of d_1 and d_2 (a of the strut's own road, b of the other's), over the leading coefficient of D.
    T1, T2, across = scaled(T1, monic), scaled(T2, monic), -u12
    a1, b1 = product(T1, Q2), scaled(product(T2, product(E1, kappa2)), across)
    a2, b2 = product(T2, Q1), scaled(product(T1, product(E2, kappa1)), across)
    own1, own2, cross, later = np.zeros((3, N)), np.zeros((3, N)), np.zeros((4, N)), np.zeros((0, N))
    if delay.steps == 0:
        a1, a2 = plus(a1, b1), plus(a2, b2)
        P1, P2, P12 = modulus(a1), modulus(a2), product(a1, reflected(a2))
    else:
        P1, P2 = plus(modulus(a1), modulus(b1)), plus(modulus(a2), modulus(b2))
        P12 = plus(product(a1, reflected(b2)), product(b1, reflected(a2)))
    for k in range(3):
        own1[k], own2[k] = applied(P1, zero[k:]), applied(P2, zero[k:])
    for k in range(4):
        cross[k] = applied(every_other(P12, k % 2), zero[(k + 1) // 2 :])
    if delay.steps > 0:
        A = plus(np.zeros((1, N)), D, 2) if rolls else D
        g, h = fading(real_colours, real_both, rolls), fading(swinging_colours, swinging_both, rolls)
        first = 2 if rolls else 0
        now = decaying(g, real, first, 13) + decaying(h, swinging, first, 13).real
        then = faded(g, real * delay.tau, real, rolls, 15) + faded(h, swinging * delay.tau, swinging, rolls, 15).real
        later = carried(A, zero, now, then, delay)
        P1, P2 = product(a1, reflected(b1)), product(b2, reflected(a2))
        ahead, behind = product(a1, reflected(a2)), product(reflected(b1), b2)
        for k in range(3):
            own1[k] += 2.0 * applied(P1, later[2 * k :])
            own2[k] += 2.0 * applied(P2, later[2 * k :])
        for k in range(4):
            cross[k] += applied(ahead, later[k:]) + (-1.0) ** k * applied(behind, later[k:])
    out = read_off(struts, compliance, own1, own2, cross)
    if damped:
        # Numerators of (m s w + F) / E, of which E is a factor, by the road at once and by the road later.
        kappas = scaled(product(kappa1, kappa2), across)
        t1 = tyre_numerator(struts[0], Q2, u11, scaled(product(kappas, E2), across), monic)
        t2 = tyre_numerator(struts[1], Q1, u22, scaled(product(kappas, E1), across), monic)
        out[9] = variance(t1, product(kappas, T2), zero, later)
        out[10] = variance(product(kappas, T1), t2, zero, later)
    return out


def variance(now: Array, behind: Array, zero: Array, later: Array) -> Array:
    """Of what ``now`` makes of a road and ``behind`` of the same road a delay ago, or at once where there is none."""
    if len(later) == 0:
        return applied(modulus(plus(now, behind)), zero)
    alone = applied(modulus(now), zero) + applied(modulus(behind), zero)
    return alone + 2.0 * applied(product(now, reflected(behind)), later)


def tyre_numerator(strut: Array, Q: Array, u: Array, coupled: Array, monic: Array) -> Array:
    """``Q (m s^2 + kappa (1 + m u)) - m coupled`` over the leading coefficient of D, Q being the other strut's."""
    mass = strut[:1]
    own = product(Q, plus(scaled(strut[1:3], 1.0 + strut[0] * u), mass, 2))
    return scaled(plus(own, scaled(coupled, -strut[0])), monic)


def read_off(struts: Array, compliance: Array, own1: Array, own2: Array, cross: Array) -> Array:
    """Rows of `two_struts`, for every design at once."""
    one, other = (Wheel(strut[0], strut[1], strut[2], strut[3]) for strut in struts)
    joint = Joint(compliance[0, 0], compliance[1, 1], compliance[0, 1])
    return np.stack(combined(one, other, joint, Even(*own1), Even(*own2), Cross(*cross)))


def combined(one: Wheel, other: Wheel, joint: Joint, d1: Even, d2: Even, cross: Cross) -> TwoStruts:
    """All variances from those of the deflections, element by element, as if no tyre were damped."""
    rate1, rate2 = -d1.bend, -d2.bend
    m1, k1, c1, kt1 = one
    m2, k2, c2, kt2 = other
    F1, F2 = k1 * k1 * d1.value + c1 * c1 * rate1, k2 * k2 * d2.value + c2 * c2 * rate2
    F12 = k1 * k2 * cross.value - c1 * c2 * cross.bend + (c1 * k2 - k1 * c2) * cross.slope
    # Tyre load F + m (u_ii F + u_ij F_j + d''): the wheel accelerates with the body point and along the deflection.
    s1, t1, s2, t2 = 1.0 + m1 * joint.u11, m1 * joint.u12, 1.0 + m2 * joint.u22, m2 * joint.u12
    own1 = s1 * s1 * F1 + t1 * t1 * F2 + m1 * m1 * d1.jerk
    own2 = s2 * s2 * F2 + t2 * t2 * F1 + m2 * m2 * d2.jerk
    bend, third = cross.bend, cross.third
    load1 = own1 + 2.0 * (s1 * t1 * F12 - s1 * m1 * k1 * rate1 + t1 * m1 * (k2 * bend - c2 * third))
    load2 = own2 + 2.0 * (s2 * t2 * F12 - s2 * m2 * k2 * rate2 + t2 * m2 * (k1 * bend + c1 * third))
    tyre1, tyre2 = load1 / kt1**2, load2 / kt2**2
    return TwoStruts(F1, F2, F12, d1.value, d2.value, rate1, rate2, load1, load2, tyre1, tyre2)


def wheel(strut: Array) -> Array:
    """``E = kt + ct s + m s^2``."""
    E = np.zeros((3, strut.shape[1]))
    E[:2], E[2] = strut[3:5], strut[0]
    return E
