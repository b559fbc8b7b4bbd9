"""Masses joined by spring-damper links: the one assembly behind every vehicle.

A vehicle is data here: inertias on coordinates, and links whose elongation is a linear form in the coordinates
and the road heights. With one row of ``R`` (and ``N``) a link, elongation ``e = R q + N z_r``, the equations of
motion are ``M q'' + C q' + K q = C_in z_r' + K_in z_r`` with ``K = R^T k R``, ``K_in = -R^T k N`` and likewise
for the dampers. `SecondOrder` holds these matrices, for one design or for a whole batch of them, and turns them
into first-order form in either of two states:

- displacement input: ``(q, v)`` with ``v = q' - M^-1 C_in z_r``;
- velocity input: ``(p, v, warp)`` with ``p = q - G z_r``, the motion relative to where the road would carry the
  vehicle statically (``G = K^-1 K_in``). No integrator remains, except the warp of a four-wheeled ground, which
  a rigid body cannot follow.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]


class Motion:
    """A linear form in coordinates and road heights, such as ``z_b - a*theta - z_u``."""

    def __init__(self, terms: Mapping[str, Any]):
        self.terms = dict(terms)

    def __add__(self, other: Motion) -> Motion:
        names = self.terms | other.terms
        return Motion({name: self.terms.get(name, 0.0) + other.terms.get(name, 0.0) for name in names})

    def __sub__(self, other: Motion) -> Motion:
        return self + (-1.0) * other

    def __rmul__(self, factor: ArrayLike) -> Motion:
        return Motion({name: factor * coefficient for name, coefficient in self.terms.items()})

    # An array on the left would otherwise take the product element by element.
    __array_ufunc__ = None


def coordinates(*names: str) -> tuple[Motion, ...]:
    """Name the degrees of freedom of a model."""
    return tuple(Motion({name: 1.0}) for name in names)


def track(*names: str) -> tuple[Motion, ...]:
    """Name the road heights under a model's wheels."""
    return coordinates(*names)


@dataclass(frozen=True, eq=False)
class Link:
    """A spring and a damper in parallel along one elongation."""

    elongation: Motion
    stiffness: Any
    damping: Any = 0.0


@dataclass(frozen=True, eq=False)
class Corner:
    """What carries the body at one wheel: the suspension, and the link whose force the road feels."""

    suspension: Link
    tyre: Link


def signal(kind: str, place: str) -> str:
    """Join ``sws`` and ``fr`` to ``sws_fr``; the one corner of a quarter car has no name."""
    return f"{kind}_{place}" if place else kind


@dataclass(frozen=True, eq=False)
class Linkage:
    """A vehicle as data.

    Parameters
    ----------
    masses : dict
        Inertia (kg or kg m^2) of each coordinate.
    corners : dict
        `Corner` by name.
    points : dict
        Body points (name -> Motion) whose vertical acceleration is an output.
    rotations : dict
        Body rotations (output name -> Motion).
    bars : sequence of Link
        Links beyond the corners: anti-roll bars.
    warp : Motion, optional
        The combination of road heights that a rigid body on its wheels cannot follow.
    """

    masses: Mapping[Motion, Any]
    corners: Mapping[str, Corner]
    points: Mapping[str, Motion]
    rotations: Mapping[str, Motion] = field(default_factory=dict)
    bars: Sequence[Link] = ()
    warp: Motion | None = None

    def assemble(self) -> SecondOrder:
        """Write the links out as matrices; parameters that are arrays give stacks of matrices."""
        suspensions = [corner.suspension for corner in self.corners.values()]
        tyres = [corner.tyre for corner in self.corners.values()]
        links = list(dict.fromkeys([*suspensions, *tyres, *self.bars]))
        states = [name for motion in self.masses for name in motion.terms]
        inputs = [name for tyre in tyres for name in tyre.elongation.terms if name not in states]

        elongations = [link.elongation for link in links]
        R, N = _rows(elongations, states), _rows(elongations, inputs)
        k = _stack([link.stiffness for link in links])
        c = _stack([link.damping for link in links])
        m = _stack(list(self.masses.values()))
        designs = np.broadcast_shapes(R.shape[:-2], k.shape[:-1], c.shape[:-1], m.shape[:-1])
        R, N = (np.broadcast_to(rows, (*designs, *rows.shape[-2:])) for rows in (R, N))
        k, c, m = (np.broadcast_to(values, (*designs, values.shape[-1])) for values in (k, c, m))
        RT = np.swapaxes(R, -1, -2)

        accelerations = {signal("bacc", place): motion for place, motion in self.points.items()}
        body = dict(list(accelerations.items())[:1]) | dict(self.rotations) | accelerations
        T = _rows(list(body.values()), states)
        strut = np.array([links.index(link) for link in suspensions])
        tread = np.array([links.index(link) for link in tyres])
        unit = np.eye(len(links))
        return SecondOrder(
            coordinates=tuple(states),
            inputs=tuple(inputs),
            corners=tuple(self.corners),
            points=tuple(self.points),
            rotations=tuple(self.rotations),
            outputs=(
                *body,
                *(signal("sws", corner) for corner in self.corners),
                *(signal("dtl", corner) for corner in self.corners),
                *(signal("dsws", corner) for corner in self.corners),
            ),
            m=m,
            K=RT @ (k[..., None] * R),
            C=RT @ (c[..., None] * R),
            K_in=-RT @ (k[..., None] * N),
            C_in=-RT @ (c[..., None] * N),
            R=R,
            N=N,
            acceleration=_pad(T, below=3 * len(strut)),
            elongation=_blocks(len(body), unit[strut], k[..., tread, None] * unit[tread], 0.0 * unit[strut]),
            rate=_blocks(len(body), 0.0 * unit[strut], c[..., tread, None] * unit[tread], unit[strut]),
            strut=strut,
            tread=tread,
            damping=c[..., strut],
            undamped=np.any((c[..., strut] == 0.0) & (c[..., tread] == 0.0), axis=-1),
            warp=None if self.warp is None else _rows([self.warp], inputs)[0],
        )


@dataclass(frozen=True, eq=False)
class SecondOrder:
    """``M q'' + C q' + K q = C_in z_r' + K_in z_r`` with outputs, as arrays of shape (designs..., rows, columns).

    The outputs are ``y = elongation (R q + N z_r) + rate (R q' + N z_r') + acceleration q''``.
    """

    coordinates: tuple[str, ...]
    inputs: tuple[str, ...]
    corners: tuple[str, ...]
    points: tuple[str, ...]
    rotations: tuple[str, ...]
    outputs: tuple[str, ...]
    m: Array
    K: Array
    C: Array
    K_in: Array
    C_in: Array
    R: Array
    N: Array
    acceleration: Array
    elongation: Array
    rate: Array
    strut: NDArray[np.int_]
    tread: NDArray[np.int_]
    damping: Array
    undamped: NDArray[np.bool_]
    warp: Array | None

    @cached_property
    def minv(self) -> Array:
        """``M^-1`` as a column, to scale rows."""
        return 1.0 / self.m[..., None]

    @cached_property
    def G(self) -> Array:
        """Static displacement ``K^-1 K_in`` under unit road heights."""
        return np.asarray(np.linalg.solve(self.K, self.K_in), dtype=self.K.dtype)

    @cached_property
    def on_position(self) -> Array:
        return self.elongation @ self.R - self.acceleration @ (self.minv * self.K)

    @cached_property
    def on_velocity(self) -> Array:
        return self.rate @ self.R - self.acceleration @ (self.minv * self.C)

    @cached_property
    def on_road_velocity(self) -> Array:
        """Coefficients of ``z_r'`` that no state carries: what makes an output improper, or white."""
        return self.rate @ self.N + self.acceleration @ (self.minv * self.C_in)

    @cached_property
    def on_warp(self) -> Array:
        """Outputs per metre of static road warp, (designs..., outputs)."""
        if self.warp is None:
            return np.zeros(self.on_position.shape[:-1])
        residual = (self.R @ self.G + self.N) @ (self.warp / (self.warp @ self.warp))
        return (self.elongation @ residual[..., None])[..., 0]

    @cached_property
    def A(self) -> Array:
        """First-order matrix over (position, velocity)."""
        n = len(self.coordinates)
        A = np.zeros((*self.K.shape[:-2], 2 * n, 2 * n), dtype=np.result_type(self.m, self.K, self.C))
        A[..., :n, n:] = np.eye(n)
        A[..., n:, :n] = -self.minv * self.K
        A[..., n:, n:] = -self.minv * self.C
        return A

    def displacement_form(self) -> tuple[Array, Array, Array, Array, Array]:
        """``x' = A x + B z_r``, ``y = Y x + D z_r + D1 z_r'`` over ``x = (q, q' - M^-1 C_in z_r)``."""
        Bz = self.minv * self.C_in
        B = np.concatenate([Bz, self.minv * (self.K_in - self.C @ Bz)], axis=-2)
        Y = np.concatenate([self.on_position, self.on_velocity], axis=-1)
        D = self.elongation @ self.N + self.acceleration @ (self.minv * self.K_in) + self.on_velocity @ Bz
        return self.A, B, Y, D, self.on_road_velocity

    def velocity_form(self) -> tuple[Array, Array, Array, Array]:
        """``x' = A x + B z_r'``, ``y = Y x + D z_r'`` over the road-relative ``x = (p, v)``, then the warp if any."""
        A, B = self.A, np.concatenate([-self.G, self.minv * self.C_in], axis=-2)
        Y = np.concatenate([self.on_position, self.on_velocity], axis=-1)
        if self.warp is not None:
            A = _pad(A, below=1, right=1)
            B = np.concatenate([B, np.broadcast_to(self.warp, (*B.shape[:-2], 1, B.shape[-1]))], axis=-2)
            Y = np.concatenate([Y, self.on_warp[..., None]], axis=-1)
        return A, B, Y, self.on_road_velocity

    @property
    def relative_states(self) -> tuple[str, ...]:
        """Names of the road-relative states (p, v), then the warp if there is one."""
        positions = tuple(f"p_{name}" for name in self.coordinates)
        velocities = tuple(f"d{name}" for name in self.coordinates)
        return positions + velocities + (() if self.warp is None else ("warp",))

    def transfer(self, omega: Array) -> Array:
        """Outputs per road VELOCITY at angular frequencies ``omega`` (F,), as (designs..., F, outputs, inputs).

        With ``D = K + s C + s^2 M`` and ``s = j w``, the road-relative positions solve ``D p = C_in - C G - s M G`` and
        the velocities ``D v = K_in + s C_in``: either right-hand side alone would lose the other's digits at one
        end of the frequency axis. What grows as ``1/s`` is the static warp alone.
        """
        s = 1j * np.asarray(omega, dtype=float)[:, None, None]
        M = self.m[..., None, :, None] * np.eye(len(self.coordinates))
        K, C, G, C_in, K_in = (x[..., None, :, :] for x in (self.K, self.C, self.G, self.C_in, self.K_in))
        right = np.concatenate(np.broadcast_arrays(C_in - C @ G - s * (M @ G), K_in + s * C_in), axis=-1)
        p, v = np.split(np.linalg.solve(K + s * (C + s * M), right), 2, axis=-1)
        H = self.on_position[..., None, :, :] @ p + self.on_velocity[..., None, :, :] @ v
        H = H + self.on_road_velocity[..., None, :, :]
        if self.warp is not None:
            H = H + self.on_warp[..., None, :, None] * self.warp / s
        return H

    def unstable(self) -> NDArray[np.bool_]:
        """Designs with a mode that no damper reaches: not asymptotically stable.

        A damper at every corner reaches every mode, so that eigenvalues are needed only where one is missing.
        """
        unstable = np.array(self.undamped)
        if unstable.any():
            eigenvalues = np.linalg.eigvals(self.A[unstable])
            scale = np.abs(eigenvalues).max(axis=-1)
            unstable[unstable] = eigenvalues.real.max(axis=-1) > -1e-12 * scale
        return unstable


def _rows(motions: Sequence[Motion], names: Sequence[str]) -> Array:
    """Coefficients of each motion on each name, (designs..., motions, names)."""
    coefficients = [np.asarray(x) for motion in motions for x in motion.terms.values()]
    shape = np.broadcast_shapes(*(x.shape for x in coefficients))
    rows = np.zeros((*shape, len(motions), len(names)), dtype=np.result_type(float, *coefficients))
    for i, motion in enumerate(motions):
        for name, coefficient in motion.terms.items():
            if name in names:
                rows[..., i, names.index(name)] = coefficient
    return rows


def _stack(values: Sequence[ArrayLike]) -> Array:
    return np.stack(np.broadcast_arrays(*values), axis=-1)


def _pad(matrix: Array, below: int = 0, right: int = 0) -> Array:
    return np.pad(matrix, [(0, 0)] * (matrix.ndim - 2) + [(0, below), (0, right)])


def _blocks(above: int, *blocks: Array) -> Array:
    """Stack row blocks under ``above`` rows of zeros, broadcasting their leading dimensions."""
    shape = np.broadcast_shapes(*(block.shape for block in blocks))
    zeros = np.zeros((*shape[:-2], above, shape[-1]))
    return np.concatenate([zeros, *(np.broadcast_to(block, shape) for block in blocks)], axis=-2)
