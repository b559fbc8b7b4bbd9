"""The polynomials compiled for very many designs: their primitives in loops over the designs, which run as vectors.

`polynomials` is compiled as it stands; only the primitives that the time goes into are written out here, each the same
arithmetic as the one it replaces. Importing this loads the compiler: a second, and at first use on a machine some more.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numba.extending import overload, register_jitable

from . import polynomials
from .compiler import compiled
from .polynomials import Body, Colours, Cross, Delay, Even, Joint, Track, Wheel

# Designs whose polynomials stay in the first caches.
WIDTH = 256

OPTIONS: dict[str, Any] = {"error_model": "numpy", "fastmath": {"contract"}}


@overload(polynomials.product, jit_options=OPTIONS)
def _product(p, q):
    def product(p, q):
        out = np.zeros((len(p) + len(q) - 1, p.shape[1]))
        for i in range(len(p)):
            for j in range(len(q)):
                for N in range(p.shape[1]):
                    out[i + j, N] += p[i, N] * q[j, N]
        return out

    return product


@overload(polynomials.plus, jit_options=OPTIONS)
def _plus(p, q, shift=0):
    def plus(p, q, shift=0):
        out = np.zeros((max(len(p), len(q) + shift), p.shape[1]), q.dtype)
        for i in range(len(p)):
            for N in range(p.shape[1]):
                out[i, N] = p[i, N]
        for i in range(len(q)):
            for N in range(p.shape[1]):
                out[i + shift, N] += q[i, N]
        return out

    return plus


@overload(polynomials.scaled, jit_options=OPTIONS)
def _scaled(p, factor):
    def scaled(p, factor):
        out = np.empty(p.shape)
        for i in range(len(p)):
            for N in range(p.shape[1]):
                out[i, N] = p[i, N] * factor[N]
        return out

    return scaled


@overload(polynomials.reflected, jit_options=OPTIONS)
def _reflected(p):
    def reflected(p):
        out = np.empty(p.shape)
        for i in range(len(p)):
            sign = 1.0 - 2.0 * (i % 2)
            for N in range(p.shape[1]):
                out[i, N] = sign * p[i, N]
        return out

    return reflected


@overload(polynomials.every_other, jit_options=OPTIONS)
def _every_other(p, first):
    def every_other(p, first):
        out = np.empty(((len(p) - first + 1) // 2, p.shape[1]))
        for i in range(len(out)):
            for N in range(p.shape[1]):
                out[i, N] = p[first + 2 * i, N]
        return out

    return every_other


@overload(polynomials.applied, jit_options=OPTIONS)
def _applied(p, derivatives):
    def applied(p, derivatives):
        out = np.zeros(p.shape[1])
        for i in range(min(len(p), len(derivatives))):
            for N in range(p.shape[1]):
                out[N] += p[i, N] * derivatives[i, N]
        return out

    return applied


@overload(polynomials.decaying, jit_options=OPTIONS)
def _decaying(g, alphas, first, count):
    def decaying(g, alphas, first, count):
        out = np.zeros((count, g.shape[1]), g.dtype)
        for j in range(len(g)):
            for N in range(g.shape[1]):
                term = g[j, N] * (1.0 if first == 0 else alphas[j, N] ** 2)
                for k in range(first, count):
                    out[k, N] += term
                    term *= -alphas[j, N]
        return out

    return decaying


@overload(polynomials.value, jit_options=OPTIONS)
def _value(p, s):
    def value(p, s):
        out = np.empty(s.shape, s.dtype)
        for j in range(len(s)):
            for N in range(s.shape[1]):
                out[j, N] = p[-1, N]
            for i in range(len(p) - 2, -1, -1):
                for N in range(s.shape[1]):
                    out[j, N] = out[j, N] * s[j, N] + p[i, N]
        return out

    return value


@overload(polynomials.routh, jit_options=OPTIONS)
def _routh(D, density):
    def routh(D, density):
        n, designs = len(D) - 1, D.shape[1]
        table, right = np.empty((n + 1, n // 2 + 1, designs), D.dtype), np.empty((n + 1, designs), D.dtype)
        derivatives, factor = np.empty((n, designs), D.dtype), np.empty(designs, D.dtype)
        sign = 2.0 * (n % 2) - 1.0
        for N in range(designs):
            right[1, N] = sign * density[N] / (2.0 * D[n, N])
        for j in range(n + 1):
            for N in range(designs):
                table[j % 2, j // 2, N] = D[n - j, N]
        for i in range(1, n):
            for N in range(designs):
                factor[N] = table[i - 1, 0, N] / table[i, 0, N]
                right[i + 1, N] = -factor[N] * right[i, N]
            shared = (n - i) // 2
            for j in range((n - i - 1) // 2 + 1):
                for N in range(designs):
                    table[i + 1, j, N] = table[i - 1, j + 1, N]
                if j < shared:
                    for N in range(designs):
                        table[i + 1, j, N] -= factor[N] * table[i, j + 1, N]
        for e in range(n):
            for N in range(designs):
                derivatives[e, N] = right[n - e, N]
            for j in range(1, e // 2 + 1):
                for N in range(designs):
                    derivatives[e, N] -= table[n - e, j, N] * derivatives[e - j, N]
            for N in range(designs):
                derivatives[e, N] /= table[n - e, 0, N]
        return derivatives

    return routh


@overload(polynomials.delay_operator, jit_options=OPTIONS)
def _delay_operator(D, tau, squarings):
    terms = polynomials.SERIES_TERMS

    def delay_operator(D, tau, squarings):
        n, designs = len(D) - 1, D.shape[1]
        total, term, square = np.zeros((n, designs)), np.zeros((n, designs)), np.empty((2 * n - 1, designs))
        h, top = tau / 2.0**squarings, np.empty(designs)
        for N in range(designs):
            total[0, N] = 1.0
        for k in range(1, n):
            for N in range(designs):
                total[k, N] = total[k - 1, N] * (h[N] / k)
        term[n - 1] = total[n - 1]
        for k in range(n, terms):
            for N in range(designs):
                top[N] = term[n - 1, N] * (h[N] / k)
            for j in range(n - 1, 0, -1):
                for N in range(designs):
                    term[j, N] = term[j - 1, N] * (h[N] / k) - top[N] * D[j, N]
                    total[j, N] += term[j, N]
            for N in range(designs):
                term[0, N] = -top[N] * D[0, N]
                total[0, N] += term[0, N]
        for _ in range(squarings):
            square[:] = 0.0
            for i in range(n):
                for N in range(designs):
                    square[2 * i, N] += total[i, N] * total[i, N]
                for j in range(i + 1, n):
                    for N in range(designs):
                        square[i + j, N] += 2.0 * total[i, N] * total[j, N]
            for i in range(2 * n - 2, n - 1, -1):
                for j in range(n):
                    for N in range(designs):
                        square[i - n + j, N] -= square[i, N] * D[j, N]
            total[:] = square[:n]
        return total

    return delay_operator


@overload(polynomials.read_off, jit_options=OPTIONS)
def _read_off(struts, compliance, own1, own2, cross):
    combined = register_jitable(**OPTIONS)(polynomials.combined)

    def read_off(struts, compliance, own1, own2, cross):
        out = np.empty((11, own1.shape[1]))
        for N in range(own1.shape[1]):
            rows = combined(
                Wheel(struts[0, 0, N], struts[0, 1, N], struts[0, 2, N], struts[0, 3, N]),
                Wheel(struts[1, 0, N], struts[1, 1, N], struts[1, 2, N], struts[1, 3, N]),
                Joint(compliance[0, 0, N], compliance[1, 1, N], compliance[0, 1, N]),
                Even(own1[0, N], own1[1, N], own1[2, N]),
                Even(own2[0, N], own2[1, N], own2[2, N]),
                Cross(cross[0, N], cross[1, N], cross[2, N], cross[3, N]),
            )
            for i in range(11):
                out[i, N] = rows[i]
        return out

    return read_off


for function in (
    polynomials.modulus,
    polynomials.apart,
    polynomials.start,
    polynomials.coloured,
    polynomials.fading,
    polynomials.faded,
    polynomials.carried,
    polynomials.wheel,
    polynomials.tyre_numerator,
    polynomials.variance,
    polynomials.one_strut,
    polynomials.two_struts,
):
    register_jitable(**OPTIONS)(function)


@register_jitable(**OPTIONS)
def part_of(road, N, end):
    """A road of some of the designs."""
    real, swinging = road.real, road.swinging
    return Track(
        road.level[N:end].copy(),
        Colours(real.alphas[:, N:end].copy(), real.low[:, N:end].copy(), real.high[:, N:end].copy()),
        Colours(swinging.alphas[:, N:end].copy(), swinging.low[:, N:end].copy(), swinging.high[:, N:end].copy()),
    )


@compiled(**OPTIONS)
def one_strut(strut, compliance, road):
    """`polynomials.one_strut`, some designs at a time."""
    designs = strut.shape[1]
    out = np.empty((5, designs))
    for N in range(0, designs, WIDTH):
        end = min(N + WIDTH, designs)
        here = part_of(road, N, end)
        out[:, N:end] = polynomials.one_strut(strut[:, N:end].copy(), compliance[N:end].copy(), here)
    return out


@compiled(**OPTIONS)
def two_struts(struts, body, road, delay, damped):
    """`polynomials.two_struts`, some designs at a time."""
    designs = struts.shape[2]
    out = np.empty((11, designs))
    for N in range(0, designs, WIDTH):
        end = min(N + WIDTH, designs)
        joined = Body(body.compliance[:, :, N:end].copy(), body.rigidity[N:end].copy(), body.rolls)
        here = part_of(road, N, end)
        later = Delay(delay.tau[N:end].copy(), delay.steps, delay.halvings)
        out[:, N:end] = polynomials.two_struts(struts[:, :, N:end].copy(), joined, here, later, damped)
    return out
