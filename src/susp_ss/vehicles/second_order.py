"""Second-order models: matrices, their output table, and first-order forms of both.

``M q'' + C q' + K q = C_in z_r' + K_in z_r``, for one design or for a whole batch of them, turns into first-order form
in either of two states:

- displacement input: ``(q, v)`` with ``v = q' - M^-1 C_in z_r``;
- velocity input: ``(p, v, warps)`` with ``p = q - G z_r``, the motion relative to where the road would carry the
  vehicle statically (``G = K^-1 K_in``). No integrator remains, except the warp of the ground under four wheels, or the
  three warps under six, which a rigid body cannot follow.

What a model is known to be without a look at its numbers, it says itself (`SecondOrder.damped`); a changed copy says
nothing, and what is not said is found out by eigenvalues.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import ClassVar, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..quantities import METRICS, Quantity, signal
from .elimination import solved
from .modes import Modes, modes_among

Array = NDArray[np.float64]

# A sum no larger than this, relative to its terms, is zero but for rounding.
ROUNDING = 1e-12

# A static elongation no larger than this, relative to its terms, is what the solution of K leaves.
CARRIED = 1e-7


class Row(NamedTuple):
    """One row of the output table; what is not public is no output of a plain state space."""

    quantity: Quantity
    place: str
    public: bool

    @property
    def name(self) -> str:
        return signal(self.quantity.name, self.place)


@dataclass(frozen=True)
class Outputs:
    """The output table, found by names: public rows first."""

    rows: tuple[Row, ...]

    @cached_property
    def names(self) -> tuple[str, ...]:
        return tuple(row.name for row in self.rows)

    @cached_property
    def public(self) -> slice:
        return slice(sum(row.public for row in self.rows))

    @cached_property
    def quantities(self) -> dict[str, Quantity]:
        """Quantities by name, in the order of their first rows."""
        return {row.quantity.name: row.quantity for row in self.rows}

    def __len__(self) -> int:
        return len(self.rows)

    @cached_property
    def _found(self) -> dict[str, list[int]]:
        found: dict[str, list[int]] = {}
        for i, row in enumerate(self.rows):
            found.setdefault(row.quantity.name, []).append(i)
        return found

    def places(self, quantity: str) -> tuple[str, ...]:
        """Where a quantity is measured."""
        return tuple(self.rows[i].place for i in self._found[quantity])

    def of(self, quantity: str) -> slice | list[int]:
        """The rows of a quantity, in the order of its places: a slice if they follow one another."""
        found = self._found[quantity]
        first, last = found[0], found[-1]
        return slice(first, last + 1) if last - first + 1 == len(found) else found


@dataclass(frozen=True)
class Layout:
    """Names that all designs of a kind of vehicle share."""

    coordinates: tuple[str, ...]
    inputs: tuple[str, ...]
    corners: tuple[str, ...]
    outputs: Outputs
    warps: int
    dampers: bool = True
    controls: tuple[str, ...] = ()
    """Inputs beyond the road's, such as a steering angle."""

    @cached_property
    def variables(self) -> dict[str, tuple[Quantity, tuple[str, ...]]]:
        """The variables of results: what each is, and where; one place without a name where there is no dim.

        First those of the table of metrics, in its order, then what a vehicle adds.
        """
        outputs = self.outputs
        measured = {name: (quantity, outputs.places(name)) for name, quantity in outputs.quantities.items()}
        if self.dampers:
            measured["damper_power"] = METRICS["damper_power"], self.corners
        return {name: measured[name] for name in dict.fromkeys([*METRICS, *measured]) if name in measured}

    @property
    def rates(self) -> slice | list[int]:
        """The rows of the suspension velocities at every corner that damper powers are made of, if any are."""
        return self.outputs.of("sws_rate") if self.dampers else []

    @property
    def states(self) -> tuple[str, ...]:
        """The states of displacement input (q, v)."""
        return self.coordinates + tuple(f"d{name}" for name in self.coordinates)

    @property
    def relative_states(self) -> tuple[str, ...]:
        """The road-relative states (p, v), then the warps, if there are any."""
        positions = tuple(f"p_{name}" for name in self.coordinates)
        velocities = tuple(f"d{name}" for name in self.coordinates)
        warps = ("warp",) if self.warps == 1 else tuple(f"warp_{i + 1}" for i in range(self.warps))
        return positions + velocities + warps


@dataclass(frozen=True, eq=False)
class SecondOrder:
    """``M q'' + C q' + K q = C_in z_r' + K_in z_r`` with outputs, as arrays of shape (designs..., rows, columns).

    The outputs are ``y = elongation (R q + N z_r) + rate (R q' + N z_r') + acceleration q''``, with one row of R and N
    a link; ``suspensions`` and ``tyres`` are the rows of each corner's. Nothing needs K or C to be symmetric.
    """

    layout: Layout
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
    suspensions: NDArray[np.int_]
    tyres: NDArray[np.int_]
    damping: Array
    integrators: Array
    """Rates of the road's warps per road velocity, (designs..., k, inputs)."""

    second_order: ClassVar[bool] = True
    damped: NDArray[np.bool_] | None = field(default=None, init=False)
    """Designs (designs...,) whose every mode is known to be damped. `dataclasses.replace` does not hand it on."""

    @cached_property
    def symmetric(self) -> bool:
        """Whether K and C of every design equal their transposes, beyond rounding."""
        return all(
            bool(np.all(np.abs(x - np.swapaxes(x, -1, -2)) <= ROUNDING * np.abs(x).max(axis=(-2, -1), keepdims=True)))
            for x in (self.K, self.C)
        )

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
        at_wheels = self.minv * self.C_in
        total = self.rate @ self.N + self.acceleration @ at_wheels
        terms = np.abs(self.rate) @ np.abs(self.N) + np.abs(self.acceleration) @ np.abs(at_wheels)
        return np.where(beyond_rounding(total, terms), total, 0.0)

    @cached_property
    def warped(self) -> Array:
        """Static elongation of every link per metre of each road warp, (designs..., links, k)."""
        warps = self.integrators
        return np.asarray((self.R @ self.G + self.N) @ warps.mT @ np.linalg.inv(warps @ warps.mT))

    @cached_property
    def on_integrators(self) -> Array:
        """Outputs per metre of each static road warp, (designs..., outputs, k)."""
        return np.asarray(self.elongation @ self.warped)

    @cached_property
    def rides_along(self) -> bool:
        """Whether no link is stretched by road heights that stand still, but for their warp.

        So it is where every spring joins what the road carries. A stiffness that was added to a copy keeps this only
        with its share of ``K_in``: ``dK_in = dK G``. Where more warps than are known set wheels apart, this holds for
        none.
        """
        wheels = np.count_nonzero(self.suspensions != self.tyres)
        warps = len(self.layout.corners) + wheels - len(self.layout.coordinates)
        if self.damped is not None and warps <= self.layout.warps:
            return True
        static = self.R @ self.G + self.N
        rest = static - self.warped @ self.integrators
        terms = np.abs(self.R) @ np.abs(self.G) + np.abs(self.N)
        return bool(np.all(np.abs(rest) <= CARRIED * terms))

    @cached_property
    def A(self) -> Array:
        """First-order matrix over (position, velocity)."""
        n = len(self.layout.coordinates)
        A = np.zeros((*self.K.shape[:-2], 2 * n, 2 * n), dtype=np.result_type(self.m, self.K, self.C))
        A[..., :n, n:] = np.eye(n)
        A[..., n:, :n] = -self.minv * self.K
        A[..., n:, n:] = -self.minv * self.C
        return A

    def modes(self) -> Modes:
        """Modes of one design, over its coordinates."""
        poles, vectors = np.linalg.eig(self.A)
        keep, names = modes_among(poles), self.layout.coordinates
        return Modes.of(poles[keep], vectors[: len(names), keep], names)

    def displacement_form(self) -> tuple[Array, Array, Array, Array, Array]:
        """``x' = A x + B z_r``, ``y = Y x + D z_r + D1 z_r'`` over ``x = (q, q' - M^-1 C_in z_r)``."""
        Bz = self.minv * self.C_in
        B = np.concatenate([Bz, self.minv * (self.K_in - self.C @ Bz)], axis=-2)
        Y = np.concatenate([self.on_position, self.on_velocity], axis=-1)
        D = self.elongation @ self.N + self.acceleration @ (self.minv * self.K_in) + self.on_velocity @ Bz
        return self.A, B, Y, D, self.on_road_velocity

    def velocity_form(self) -> tuple[Array, Array, Array, Array]:
        """``x' = A x + B z_r'``, ``y = Y x + D z_r'`` over the road-relative ``x = (p, v)``, then the warps if any."""
        A, B = self.A, np.concatenate([-self.G, self.minv * self.C_in], axis=-2)
        Y = np.concatenate([self.on_position, self.on_velocity], axis=-1)
        k = self.layout.warps
        if k:
            A = np.pad(A, [(0, 0)] * (A.ndim - 2) + [(0, k), (0, k)])
            B = np.concatenate([B, np.broadcast_to(self.integrators, (*B.shape[:-2], k, B.shape[-1]))], axis=-2)
            Y = np.concatenate([Y, self.on_integrators], axis=-1)
        return A, B, Y, self.on_road_velocity

    def actuated(self) -> tuple[Array, Array]:
        """What forces between wheel and body, one a corner, do to the states of either form, and to the outputs."""
        push = -self.minv * self.R[..., self.suspensions, :].mT
        D = self.acceleration @ push
        # On a rigid tyre the road carries what the actuator pushes with.
        D[..., self.layout.outputs.of("dtl"), :] += np.diag(self.suspensions == self.tyres)
        return np.concatenate([np.zeros_like(push), push], axis=-2), D

    def relative_transfer(self, omega: Array) -> NDArray[np.complex128]:
        """Outputs per road VELOCITY at angular frequencies ``omega``, as (designs..., outputs, inputs, F).

        ``omega`` is (F,), or (designs, F).

        The static warp, which grows as ``1/s``, is left out.
        With ``D = K + s C + s^2 M`` and ``s = j w``, the road-relative positions solve ``D p = C_in - C G - s M G`` and
        the velocities ``D v = K_in + s C_in``: either right-hand side alone would lose the other's digits at one
        end of the frequency axis.
        """
        n, C_in, m = self.K.shape[-1], self.C_in, self.m[..., None]
        real = np.concatenate([self.K, C_in - self.C @ self.G, self.K_in], axis=-1)
        imag = np.concatenate([self.C, -m * self.G, C_in], axis=-1)
        w = np.asarray(omega, dtype=float)
        designs = np.broadcast_shapes(real.shape[:-2], w.shape[:-1])
        equations = np.empty((*real.shape[-2:], *designs, w.shape[-1]), dtype=complex)
        real, imag, m = (
            np.moveaxis(np.broadcast_to(x, (*designs, *x.shape[-2:])), (-2, -1), (0, 1))[..., None]
            for x in (real, imag, m)
        )
        equations.real = real
        np.multiply(w, imag, out=equations.imag)
        equations.real[range(n), range(n)] -= w**2 * m[:, 0]
        x = solved(equations.reshape(*real.shape[:2], -1)).reshape(n, 2, -1, *equations.shape[2:])
        x = np.moveaxis(x, (1, 0, 2), (-4, -3, -2)).reshape(*designs, 2 * n, -1, w.shape[-1])
        Y = np.concatenate([self.on_position, self.on_velocity], axis=-1)
        H = real_times(Y, x)
        if self.on_road_velocity.any():
            H += self.on_road_velocity[..., None]
        return H

    def in_states(self, X: Array) -> Array:
        """A covariance in the states that the layout names, which are those of `velocity_form`."""
        return X

    def refusal(self) -> str:
        """Why no road of random height has a stationary response; nothing where it may have."""
        if np.any(self.unstable()):
            return "has a mode that no damper reaches; pass cs > 0 at every corner"
        if not self.rides_along:
            return (
                "has a stiffness that feels the height of the road, which has no finite variance; add its share of "
                "K_in as well, dK_in = dK G"
            )
        return ""

    def drifting(self, which: NDArray[np.bool_]) -> str:
        """What has no finite variance where the warp drifts."""
        return "the warp of the road under the wheels has no finite variance, so that SWS and DTL have none either"

    def unstable(self) -> NDArray[np.bool_]:
        """Designs with a mode that is not damped: not asymptotically stable. Eigenvalues tell where nothing else does.

        A real part of rounding is none.
        """
        unstable = np.array(np.ones(self.K.shape[:-2], dtype=bool) if self.damped is None else ~self.damped)
        if unstable.any():
            eigenvalues = np.linalg.eigvals(self.A[unstable])
            scale = np.abs(eigenvalues).max(axis=-1)
            unstable[unstable] = eigenvalues.real.max(axis=-1) > -ROUNDING * scale
        return unstable


def real_times(A: Array, Z: NDArray) -> NDArray[np.complex128]:
    """Real matrices (..., m, n) times complex arrays (..., n, k, F), whose real and imaginary parts are columns."""
    columns = np.ascontiguousarray(Z).view(float)
    product = A @ columns.reshape(*columns.shape[:-2], -1)
    return product.view(complex).reshape(*product.shape[:-1], *Z.shape[-2:])


def beyond_rounding(total: NDArray, terms: NDArray) -> NDArray[np.bool_]:
    """Which sums are more than the rounding of their terms, whose sizes are added up in ``terms``."""
    return np.abs(total) > ROUNDING * terms


def coefficients(forms: Sequence, names: Sequence) -> NDArray:
    """Coefficients of each linear form (a mapping of names to factors) on each name, (designs..., forms, names)."""
    factors = [x for form in forms for x in form.values()]
    shape = np.broadcast_shapes(*{np.shape(x) for x in factors if not isinstance(x, float)})
    kind = np.result_type(float, *{getattr(x, "dtype", type(x)) for x in factors})
    rows = np.zeros((*shape, len(forms), len(names)), dtype=kind)
    columns = {name: j for j, name in enumerate(names)}
    for i, form in enumerate(forms):
        for name, factor in form.items():
            if name in columns:
                rows[..., i, columns[name]] = factor
    return rows
