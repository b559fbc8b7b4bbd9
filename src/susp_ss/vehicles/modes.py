"""The damped modes of a design: how fast each is, how it dies out, what moves in it."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    import pandas as pd

Array = NDArray[np.float64]

# Of its modulus, an imaginary part that rounding gives to two equal real eigenvalues: the root of it.
SPLIT = 1e-6


class Modes(NamedTuple):
    """Modes, slowest first, by their poles (m,) and shapes (names, m) whose largest amplitude is 1.

    ``motions`` name each after what moves most, where a vehicle says so.
    """

    poles: NDArray[np.complex128]
    shapes: NDArray[np.complex128]
    names: tuple[str, ...]
    motions: tuple[str, ...] | None = None

    @classmethod
    def of(
        cls,
        poles: NDArray[np.complex128],
        amplitudes: NDArray[np.complex128],
        names: tuple[str, ...],
        motions: tuple[str, ...] | None = None,
    ) -> Modes:
        """Modes of shapes of any size."""
        largest = amplitudes[np.argmax(np.abs(amplitudes), axis=0), range(len(poles))]
        return cls(poles, amplitudes / largest, names, motions)

    @property
    def frequency(self) -> Array:
        """Moduli of the poles in Hz."""
        return np.asarray(np.abs(self.poles) / (2.0 * np.pi))

    @property
    def damping_ratio(self) -> Array:
        """1 where a mode does not swing."""
        return np.asarray(-self.poles.real / np.abs(self.poles))

    def table(self) -> pd.DataFrame:
        """The same as `Vehicle.modes` returns it."""
        import pandas as pd

        named = {} if self.motions is None else {"name": list(self.motions)}
        shapes = [pd.Series(shape, index=list(self.names)) for shape in self.shapes.T]
        return pd.DataFrame(
            {**named, "frequency": self.frequency, "damping_ratio": self.damping_ratio, "shape": shapes}
        )


def modes_among(eigenvalues: NDArray[np.complex128]) -> NDArray[np.int_]:
    """Which eigenvalues of a real matrix are its modes, slowest first: one of each pair, and all that do not swing."""
    creeping = np.abs(eigenvalues.imag) <= SPLIT * np.abs(eigenvalues)
    modes = np.flatnonzero(creeping | (eigenvalues.imag > 0.0))
    return modes[np.argsort(np.abs(eigenvalues[modes]), kind="stable")]
