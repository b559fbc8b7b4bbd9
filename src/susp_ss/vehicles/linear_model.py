"""The model of any state space: what dies out and what integrates, driven by the rate of the road's heights."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields, replace
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from .modes import Modes, modes_among
from .parting import Growing, Parted, parted
from .second_order import CARRIED, Array, Layout, beyond_rounding, real_times

# A state of which no larger share than this is left out with what no output sees has a covariance.
LEFT_OUT = 1e-6


@dataclass(frozen=True)
class LinearLayout(Layout):
    """Names of a system whose states need be no coordinates and their rates."""

    names: tuple[str, ...] = ()

    @property
    def relative_states(self) -> tuple[str, ...]:
        return self.names


@dataclass(frozen=True, eq=False)
class LinearModel:
    """`Model` of any state space, as arrays of shape (N, rows, columns): what dies out and what integrates.

    ``rates`` (N, n) and ``vectors`` (N, n, n) are the eigenvalues and eigenvectors of A.
    """

    layout: LinearLayout
    A: Array
    rates: NDArray
    vectors: NDArray
    B: Array
    C: Array
    integrators: Array
    on_integrators: Array
    on_road_velocity: Array
    states: Array
    damping: Array

    second_order: ClassVar[bool] = False

    def select(self, designs: slice | NDArray[np.int_]) -> LinearModel:
        """Some of the designs."""
        some = {name: x[designs] for name, x in vars(self).items() if name not in ("layout", "damping")}
        return replace(self, **some)

    def velocity_form(self) -> tuple[Array, Array, Array, Array]:
        """A, B, Y and D over x, and what integrates behind it."""
        k = self.integrators.shape[-2]
        if not k:
            return self.A, self.B, self.C, self.on_road_velocity
        A = np.pad(self.A, [(0, 0), (0, k), (0, k)])
        B = np.concatenate([self.B, self.integrators], axis=-2)
        return A, B, np.concatenate([self.C, self.on_integrators], axis=-1), self.on_road_velocity

    def modes(self) -> Modes:
        """Modes of one design, over the system's own states."""
        poles, vectors = self.rates[0], self.vectors[0]
        keep = modes_among(poles)
        shapes = self.states[0][:, : self.A.shape[-1]] @ vectors[:, keep]
        return Modes.of(poles[keep], shapes, self.layout.relative_states)

    def displacement_form(self) -> tuple[Array, Array, Array, Array, Array]:
        """``x' = A x + B z_r``, ``y = Y x + D z_r + D1 z_r'``, x being the own one less ``B z_r``."""
        D = self.C @ self.B + self.on_integrators @ self.integrators
        return self.A, self.A @ self.B, self.C, D, self.on_road_velocity

    def relative_transfer(self, omega: Array) -> NDArray[np.complex128]:
        """``C (j w I - A)^-1 B + D`` at ``omega`` (F,) or (N, F), (N, outputs, inputs, F)."""
        s = 1j * np.asarray(omega, dtype=float)[..., None, None]
        x = np.linalg.solve(s * np.eye(self.A.shape[-1]) - self.A[:, None], self.B[:, None].astype(complex))
        return real_times(self.C, np.moveaxis(x, -3, -1)) + self.on_road_velocity[..., None]

    def in_states(self, X: Array) -> Array:
        """A covariance in the system's own states, as far as they have one."""
        return np.asarray(self.states @ X @ self.states.mT)

    def refusal(self) -> str:
        """Nothing: what does not die out has been refused before there was a model."""
        return ""

    def drifting(self, which: NDArray[np.bool_]) -> str:
        """The outputs that feel what drifts."""
        felt = np.any(self.on_integrators[..., which] != 0.0, axis=(0, 2))
        names = [name for name, feels in zip(self.layout.outputs.names, felt, strict=True) if feels]
        one = len(names) == 1
        return (
            f"{', '.join(names)} {'feels' if one else 'feel'} the height of the road, which has no finite variance, so "
            f"that {'it has' if one else 'they have'} none either"
        )


def driven(A: Array, B: Array, C: Array, D: Array) -> tuple[Parted, Array]:
    """A system driven by the rate of the heights, in parts, and its direct feedthrough."""
    parts = parted(A, B, C)
    # What a closed loop leaves of a zero is no feedthrough: it is small beside what the states pass on at once.
    terms = np.abs(D).max(axis=1, keepdims=True) + np.abs(parts.C) @ np.abs(parts.B) / parts.fastest
    return parts, np.where(beyond_rounding(D, terms), D, 0.0)


def relative(A: Array, B: Array, C: Array, D: Array) -> tuple[Parted, Array]:
    """A system driven by the heights, in the states ``p = x + A^-1 B z_r`` that their rate drives.

    What outputs feel of the heights themselves is ``D - C A^-1 B``: none where everything rides along.
    """
    parts = parted(A, B, C)
    reached = np.abs(parts.rows).max(axis=1, initial=0.0) > 0.0
    if reached.any():
        first = int(np.argmax(reached))
        state, output = (
            int(np.abs(column).argmax()) for column in (parts.basis[:, len(parts.A) + first], parts.seen[:, first])
        )
        raise Growing(0.0, state, output)
    static = np.asarray(np.linalg.solve(parts.A, parts.B), dtype=float)
    # What the solution leaves of a zero would count in full where an output sees nothing else.
    static = np.where(beyond_rounding(static, np.abs(np.linalg.inv(parts.A)) @ np.abs(parts.B)), static, 0.0)
    felt, terms = D - parts.C @ static, np.abs(D) + np.abs(parts.C) @ np.abs(static)
    sizes = terms.max(axis=1, keepdims=True, initial=0.0)
    sizes[sizes == 0.0] = 1.0
    _, shares, directions = np.linalg.svd(felt / sizes, full_matrices=False)
    rows = directions[shares > CARRIED]
    seen = felt @ rows.T
    seen = np.where(np.abs(seen) > CARRIED * sizes, seen, 0.0)
    basis = parts.basis[:, : len(parts.A)]
    basis = np.pad(basis, [(0, 0), (0, len(rows))])
    return parts._replace(B=static, rows=rows, seen=seen, basis=basis), np.zeros_like(D)


def stacked(
    parts: Sequence[tuple[Parted, Array]], layout: Layout, names: tuple[str, ...], damping: Array
) -> LinearModel:
    """The model of all designs: what one has fewer states of gets states that nothing reaches and nothing sees."""
    n, k = max(1, *(len(one.A) for one, _ in parts)), max(len(one.rows) for one, _ in parts)
    kept = ~np.any([np.linalg.norm(one.unseen, axis=1) > LEFT_OUT for one, _ in parts], axis=0)

    def filled(name: str, rows: int, columns: int) -> Array:
        stack = np.zeros((len(parts), rows, columns))
        for i, (one, _) in enumerate(parts):
            x = getattr(one, name)
            stack[i, : x.shape[0], : x.shape[1]] = x
        return stack

    outputs, inputs = len(layout.outputs), len(layout.inputs)
    A, states = filled("A", n, n), np.zeros((len(parts), int(kept.sum()), n + k))
    for i, (one, _) in enumerate(parts):
        own = len(one.A)
        A[i, range(own, n), range(own, n)] = -1.0
        states[i][:, :own], states[i][:, n : n + len(one.rows)] = np.hsplit(one.basis[kept], [own])
    named = tuple(name for name, keep in zip(names, kept, strict=True) if keep)
    rates, vectors = np.linalg.eig(A)
    return LinearModel(
        layout=LinearLayout(**{field.name: getattr(layout, field.name) for field in fields(layout)}, names=named),
        A=A,
        rates=rates,
        vectors=vectors,
        B=filled("B", n, inputs),
        C=filled("C", outputs, n),
        integrators=filled("rows", k, inputs),
        on_integrators=filled("seen", outputs, k),
        on_road_velocity=np.stack([D for _, D in parts]),
        states=states,
        damping=damping,
    )
