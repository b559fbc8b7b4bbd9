"""Dual numbers over stacks of matrices: a value, and its derivative along each of P parameters, carried together.

Formulas for arrays take `Dual` as well, operators, ufuncs and the functions below alike; the product rule is stated
once, here. Values are (N, ...), tangents (P, N, ...), and a plain array is a constant.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
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

    def __array_ufunc__(self, ufunc: Any, method: str, *inputs: Any, **options: Any) -> Any:
        if method != "__call__" or options or ufunc not in UFUNCS:
            return NotImplemented
        return UFUNCS[ufunc](*inputs)

    def __array_function__(self, function: Any, types: Any, arguments: Any, options: Any) -> Any:
        return FUNCTIONS[function](*arguments, **options) if function in FUNCTIONS else NotImplemented

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

    def __pow__(self, exponent: float) -> Dual:
        return Dual(self.value**exponent, exponent * self.value ** (exponent - 1.0) * self.tangent)

    def __matmul__(self, other: Dual | Array) -> Dual:
        if isinstance(other, Dual):
            return Dual(self.value @ other.value, self.tangent @ other.value + self.value @ other.tangent)
        return Dual(self.value @ other, self.tangent @ other)

    def __neg__(self) -> Dual:
        return Dual(-self.value, -self.tangent)

    def __sub__(self, other: Dual | Array | float) -> Dual:
        return self + (-other)

    def __rsub__(self, other: Array | float) -> Dual:
        return -self + other

    __radd__ = __add__
    __rmul__ = __mul__

    def __getitem__(self, index: Any) -> Dual:
        """Index the axes of the value, of which the first counts designs."""
        return Dual(self.value[index], self.tangent[(slice(None), *(index if isinstance(index, tuple) else (index,)))])

    @property
    def shape(self) -> tuple[int, ...]:
        return self.value.shape

    @property
    def mT(self) -> Dual:
        """The last two axes swapped."""
        return Dual(np.swapaxes(self.value, -1, -2), np.swapaxes(self.tangent, -1, -2))

    def sum(self, axis: int) -> Dual:
        """The sum over a (negative) axis."""
        return Dual(self.value.sum(axis=axis), self.tangent.sum(axis=axis))


def _solve(matrix: Dual, right: Dual) -> Dual:
    """``matrix^-1 right``, of one inverse for all parameters."""
    inverse = np.linalg.inv(matrix.value)
    x = inverse @ right.value
    return Dual(x, inverse @ (right.tangent - matrix.tangent @ x))


def _divided(x: Any, y: Any) -> Dual:
    one = x if isinstance(x, Dual) else Dual(np.broadcast_to(x, y.value.shape), 0.0 * y.tangent)
    return one / y


def _exp(x: Dual) -> Dual:
    value = np.exp(x.value)
    return Dual(value, value * x.tangent)


def _expm1(x: Dual) -> Dual:
    value = np.expm1(x.value)
    return Dual(value, (value + 1.0) * x.tangent)


def _concatenate(parts: Sequence[Dual | Array], axis: int) -> Dual:
    """Parts joined along a (negative) axis, constants among them."""
    along = next(len(part.tangent) for part in parts if isinstance(part, Dual))
    every = [part if isinstance(part, Dual) else Dual(part, np.zeros((along, *part.shape))) for part in parts]
    return Dual(*(np.concatenate(x, axis=axis) for x in ([p.value for p in every], [p.tangent for p in every])))


# An array on the left of an operator asks numpy first.
UFUNCS: dict[Any, Callable[..., Dual]] = {
    np.exp: _exp,
    np.expm1: _expm1,
    np.add: lambda x, y: y + x,
    np.multiply: lambda x, y: y * x,
    np.subtract: lambda x, y: -y + x,
    np.true_divide: _divided,
    np.conjugate: lambda x: Dual(np.conj(x.value), np.conj(x.tangent)),
}

FUNCTIONS: dict[Any, Callable[..., Dual]] = {
    np.concatenate: _concatenate,
    np.linalg.solve: _solve,
    np.real: lambda x: Dual(np.real(x.value), np.real(x.tangent)),
}
