"""Numbers that write down what is done with them: a vehicle's own arithmetic becomes lines of JavaScript.

A vehicle whose parameters are such numbers assembles its matrices as any other does, in arrays of objects; what each
entry then holds is the name of the line that computes it.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from numbers import Real
from typing import Any

import numpy as np


class Lines:
    """Assignments of JavaScript, one an operation, each operation once."""

    def __init__(self) -> None:
        self.known: dict[str, Symbol] = {}

    def given(self, code: str) -> Symbol:
        """A number that JavaScript already has under this expression."""
        return Symbol(self, code)

    def computed(self, code: str, *of: Any) -> Symbol:
        """A number that this expression makes of others."""
        if code not in self.known:
            self.known[code] = Symbol(self, f"t{len(self.known)}", tuple(x for x in of if isinstance(x, Symbol)))
        return self.known[code]

    def function(self, results: Mapping[str, Any]) -> str:
        """A function of ``p`` that returns an object of results, in the lines that these need.

        Examples
        --------
        >>> from susp_ss.explorer.symbols import Lines
        >>> lines = Lines()
        >>> mass, stiffness = lines.given("p.m"), lines.given("p.k")
        >>> unused = mass + stiffness
        >>> print(lines.function({"square": [0.0, stiffness / mass]}))
        (p) => {
        const t1 = p.k / p.m;
        return { square: [0.0, t1] };
        }
        """
        needed: set[Symbol] = set()
        left: list[Any] = [results]
        while left:
            value = left.pop()
            if isinstance(value, Mapping):
                left.extend(value.values())
            elif isinstance(value, (Sequence, np.ndarray)):
                left.extend(value)
            elif isinstance(value, Symbol) and value not in needed:
                needed.add(value)
                left.extend(value.of)
        lines = [f"const {symbol.code} = {code};" for code, symbol in self.known.items() if symbol in needed]
        return "\n".join(["(p) => {", *lines, f"return {written(results)};", "}"])


class Symbol:
    """A number of which nothing is known but that it is positive, and how it is written in JavaScript."""

    def __init__(self, lines: Lines, code: str, of: tuple[Symbol, ...] = ()):
        self.lines, self.code, self.of = lines, code, of

    def _with(self, operator: str, other: Any, swapped: bool = False) -> Any:
        if not isinstance(other, (Symbol, Real)):
            return NotImplemented
        one, two = (other, self) if swapped else (self, other)
        # What adds nothing and what leaves nothing is not computed.
        if operator in "+-" and isinstance(two, Real) and two == 0:
            return one
        if operator == "+" and isinstance(one, Real) and one == 0:
            return two
        if operator == "*" and isinstance(other, Real) and other in (-1, 0, 1):
            return (0.0, self, -self)[round(float(other))]
        return self.lines.computed(f"{written(one)} {operator} {written(two)}", one, two)

    def __add__(self, other: Any) -> Any:
        return self._with("+", other)

    def __radd__(self, other: Any) -> Any:
        return self._with("+", other, swapped=True)

    def __sub__(self, other: Any) -> Any:
        return self._with("-", other)

    def __rsub__(self, other: Any) -> Any:
        return self._with("-", other, swapped=True)

    def __mul__(self, other: Any) -> Any:
        return self._with("*", other)

    __rmul__ = __mul__

    def __truediv__(self, other: Any) -> Any:
        return self._with("/", other)

    def __rtruediv__(self, other: Any) -> Any:
        return self._with("/", other, swapped=True)

    def __pow__(self, exponent: int) -> Any:
        return self * self if exponent == 2 else NotImplemented

    def __neg__(self) -> Symbol:
        return self.lines.computed(f"-{self.code}", self)

    def __abs__(self) -> Symbol:
        return self

    def __gt__(self, other: Any) -> bool:
        return True

    def __lt__(self, other: Any) -> bool:
        return False


def written(value: Any) -> str:
    """A number, an array or an object of them, as JavaScript reads it, with all its digits.

    Examples
    --------
    >>> from susp_ss.explorer.symbols import written
    >>> written([[0.1, -2]])
    '[[0.1, (-2.0)]]'
    """
    if isinstance(value, Symbol):
        return value.code
    if isinstance(value, Mapping):
        return f"{{ {', '.join(f'{name}: {written(part)}' for name, part in value.items())} }}"
    if isinstance(value, (Sequence, np.ndarray)):
        return f"[{', '.join(written(part) for part in value)}]"
    number = float(value)
    return f"({number!r})" if number < 0.0 else repr(number)
