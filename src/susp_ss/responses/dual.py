"""Dual numbers over stacks of matrices: a value, and its derivative along each of P parameters, carried together.

Formulas written for `Dual` read like the algebra of the values alone; the product rule is stated once, here. Values
are (N, ...), tangents (P, N, ...), and a plain array is a constant.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[Any]


@dataclass(frozen=True, eq=False)
class Dual:
    """``value + sum_p tangent[p] dp``, with the operators of an array."""

    value: Array
    tangent: Array

    # An array on the left would otherwise take the operation element by element.
    __array_ufunc__ = None

    def __add__(self, other: Dual | Array | float) -> Dual:
        if isinstance(other, Dual):
            return Dual(self.value + other.value, self.tangent + other.tangent)
        value = self.value + other
        return Dual(value, np.broadcast_to(self.tangent, (len(self.tangent), *value.shape)))

    def __mul__(self, other: Dual | Array | float) -> Dual:
        if isinstance(other, Dual):
            return Dual(self.value * other.value, self.tangent * other.value + self.value * other.tangent)
        return Dual(self.value * other, self.tangent * other)

    def __truediv__(self, other: Dual | Array | float) -> Dual:
        if isinstance(other, Dual):
            ratio = self.value / other.value
            return Dual(ratio, (self.tangent - ratio * other.tangent) / other.value)
        return Dual(self.value / other, self.tangent / other)

    def __matmul__(self, other: Dual | Array) -> Dual:
        if isinstance(other, Dual):
            return Dual(self.value @ other.value, self.tangent @ other.value + self.value @ other.tangent)
        return Dual(self.value @ other, self.tangent @ other)

    def __neg__(self) -> Dual:
        return Dual(-self.value, -self.tangent)

    def __sub__(self, other: Dual | Array | float) -> Dual:
        return self + (-other)

    __radd__ = __add__
    __rmul__ = __mul__

    def __getitem__(self, index: Any) -> Dual:
        """Index the axes of the value, of which the first counts designs."""
        return Dual(self.value[index], self.tangent[(slice(None), *(index if isinstance(index, tuple) else (index,)))])

    @property
    def T(self) -> Dual:
        """The last two axes swapped."""
        return Dual(np.swapaxes(self.value, -1, -2), np.swapaxes(self.tangent, -1, -2))

    def sum(self, axis: int) -> Dual:
        """The sum over a (negative) axis."""
        return Dual(self.value.sum(axis=axis), self.tangent.sum(axis=axis))


def solve(matrix: Dual, right: Dual) -> Dual:
    """``matrix^-1 right``, of one inverse for all parameters."""
    inverse = np.linalg.inv(matrix.value)
    x = inverse @ right.value
    return Dual(x, inverse @ (right.tangent - matrix.tangent @ x))


def exp(x: Dual) -> Dual:
    """``e^x``, element by element."""
    value = np.exp(x.value)
    return Dual(value, value * x.tangent)


def expm1(x: Dual) -> Dual:
    """``e^x - 1``, element by element."""
    value = np.expm1(x.value)
    return Dual(value, (value + 1.0) * x.tangent)


def concatenate(parts: Sequence[Dual], axis: int) -> Dual:
    """Parts joined along a (negative) axis."""
    return Dual(
        np.concatenate([part.value for part in parts], axis=axis),
        np.concatenate([part.tangent for part in parts], axis=axis),
    )
