"""Output feedback that keeps the worst gain least, and the worst gain of any system."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
import scipy.linalg
from numpy.typing import NDArray

from ..quantities import briefly
from .plant import plant
from .result import Feedback

if TYPE_CHECKING:
    import control

Array = NDArray[Any]

# Relative width of the bracket in which levels are bisected, and how far above its lower end a controller is sought
# whose gains have not grown without bound, as they do at the optimum.
WIDTH, ABOVE = 1e-4, (0.0, 1e-3, 1e-2, 0.03, 0.1)

# Relative digits of a norm; an eigenvalue this close to the imaginary axis, relative to its modulus, lies on it.
DIGITS, ON_AXIS = 1e-6, 1e-8

# Rounds of a norm at most: each at least doubles its digits.
ROUNDS = 50

# Levels that are tried at most and at least, relative to the gain without a controller or to one.
MOST, SMALL = 1e8, 1e-9

# A matrix is not negative if no eigenvalue is below this share of the largest.
NEGATIVE = 1e-8


@dataclass(frozen=True, eq=False, repr=False)
class HInfinity:
    """A controller of least worst gain.

    Attributes
    ----------
    controller : control.StateSpace
        From the measured outputs to the controls.
    closed : control.StateSpace
        From the other inputs to the other outputs, with the controller.
    level : float
        The closed loop's norm, as found on the closed loop itself.
    least : float
        No controller comes below this level, by the Riccati equations.
    """

    controller: control.StateSpace
    closed: control.StateSpace
    level: float
    least: float

    def on(self, vehicle: Any, road: Any, weighting: Any = None) -> Feedback:
        """What the controller makes of a vehicle on a road, its closed loop a `LinearVehicle`.

        Parameters
        ----------
        vehicle : Vehicle
            With one number for every parameter. What the controller measures are its outputs (``bacc_cg``, ``sws_fr``),
            free of noise; what it sets are the forces of its actuators (``u_fr``), without a model of these.
        road : Road
        weighting : optional
            As in `ride_metrics`.

        Returns
        -------
        Feedback
            With ``controller`` and ``closed``.

        Raises
        ------
        TypeError, ValueError
            No such vehicle, no such signals, or an unstable loop.

        Examples
        --------
        >>> import control as ct
        >>> import susp_ss as ss
        >>> car, road = ss.QuarterCar(), ss.Road()
        >>> own = car.state_space(input="velocity", actuators=True)
        >>> bacc = own.output_labels.index("bacc")
        >>> C, d = own.C[[bacc, bacc, bacc]] * [[1.0], [0.0], [1.0]], own.D[bacc, 1]
        >>> plant = ct.ss(own.A, own.B[:, [0, 0, 1]] * [0.1, 0.0, 1.0], C, [[0, 0, d], [0, 0, 1e-3], [0, 0.05, d]],
        ...               inputs=["road", "noise", "u"], outputs=["ride", "effort", "bacc"])
        >>> ss.h_infinity(plant, measured=["bacc"], controls=["u"]).on(car, road)
        h_infinity on QuarterCar: bacc ..., sws ..., dtl ... of passive
        """
        known = plant(vehicle, road, None, "h_infinity")
        closed = known.controlled(self.controller)
        return known.result("h_infinity", closed, (vehicle, weighting), controller=self.controller)

    def __repr__(self) -> str:
        return (
            f"H-infinity controller of {self.controller.nstates} states: level {self.level:.4g}, least {self.least:.4g}"
        )


class _Parts(NamedTuple):
    A: Array
    B1: Array
    B2: Array
    C1: Array
    C2: Array
    D11: Array
    D12: Array
    D21: Array


def h_infinity(plant: Any, measured: Sequence[str], controls: Sequence[str]) -> HInfinity:
    """Output-feedback controller that makes the largest gain from disturbances to errors least.

    Bisection over the level with the two Riccati equations of Glover and Doyle (Zhou, Doyle and Glover, Robust and
    Optimal Control (1996), theorem 17.1), and the central controller a little above the least level. What is reported
    is the norm of the closed loop itself, by bisection of its own Hamiltonian matrix: never less than is attained.

    Parameters
    ----------
    plant : control.StateSpace
        In continuous time, weights included, with named signals.
    measured : sequence of str
        Outputs that the controller sees; the others are errors.
    controls : sequence of str
        Inputs that it sets; the others are disturbances.

    Returns
    -------
    HInfinity

    Raises
    ------
    TypeError, ValueError
        No such signals; no direct weight on every control in the errors, or no noise on every measurement; no level
        for which a stabilising controller exists.

    Notes
    -----
    Tests hold the level against the loop's own frequency response, a closed form, and the example "Robust Control of
    Active Suspension" of MathWorks' Robust Control Toolbox: with the parameters and weights of its listing the levels
    are 0.94, 0.67 and 0.89 as it says, to the two digits that it gives.

    Examples
    --------
    >>> import control as ct
    >>> import susp_ss as ss
    >>> plant = ct.ss([[-1.0]], [[1.0, 0.0, 1.0]], [[1.0], [0.0], [1.0]], [[0, 0, 0], [0, 0, 1], [0, 1, 0]],
    ...               inputs=["w", "noise", "u"], outputs=["x", "effort", "m"])
    >>> ss.h_infinity(plant, measured=["m"], controls=["u"])
    H-infinity controller of 1 states: level 0.732..., least 0.732...
    """
    parts, back = _parted(plant, measured, controls)
    scale = worst_gain(parts.A, parts.B1, parts.C1, parts.D11) if _stable(parts.A) else 1.0
    low, high = 0.0, max(scale, SMALL)
    while _central(parts, high) is None:
        low, high = high, 4.0 * high
        if high > MOST * scale:
            raise ValueError("no controller stabilises the plant: its controls or measurements miss an unstable mode")
    while high - low > WIDTH * high and high > SMALL * scale:
        middle = np.sqrt(low * high) if low else 0.25 * high
        low, high = (middle, high) if _central(parts, middle) is None else (low, middle)
    tried = []
    for above in ABOVE:
        law = _central(parts, high * (1.0 + above))
        loop = None if law is None else _closed(parts, law)
        if loop is not None and _stable(loop[0]):
            tried.append((worst_gain(*loop), law, loop))
    if not tried:
        raise ValueError("no controller near the least level keeps its digits; scale the plant's signals")
    level, law, loop = min(tried, key=lambda one: one[0])
    controller, closed = back(law, loop)
    return HInfinity(controller, closed, level, min(low, level))


def worst_gain(A: Array, B: Array, C: Array, D: Array) -> float:
    """H-infinity norm of a stable system, from above: the largest singular value over all frequencies.

    Bruinsma and Steinbuch, Systems and Control Letters 14 (1990): a level that no eigenvalue of the Hamiltonian matrix
    on the imaginary axis reaches is above the norm.

    Examples
    --------
    >>> import numpy as np
    >>> from susp_ss.feedback.h_infinity import worst_gain
    >>> one = np.eye(1)
    >>> round(worst_gain(-one, one, one, 0 * one), 5)
    1.0
    """

    def gain(omega: float) -> float:
        x = np.linalg.solve(1j * omega * np.eye(len(A)) - A, B.astype(complex))
        return float(np.linalg.norm(C @ x + D, 2))

    rates = np.linalg.eigvals(A)
    found = max(float(np.linalg.norm(D, 2)), gain(0.0), *(gain(float(abs(rate))) for rate in rates))
    for _ in range(ROUNDS):
        level = found * (1.0 + 2.0 * DIGITS)
        if not level:
            break
        R = level**2 * np.eye(D.shape[1]) - D.T @ D
        F = A + B @ np.linalg.solve(R, D.T @ C)
        G, H = B @ np.linalg.solve(R, B.T), C.T @ (C + D @ np.linalg.solve(R, D.T @ C))
        crossing = np.linalg.eigvals(np.block([[F, G], [-H, -F.T]]))
        on_axis = np.sort(crossing[np.abs(crossing.real) < ON_AXIS * np.abs(crossing)].imag)
        on_axis = on_axis[on_axis >= 0.0]
        between = 0.5 * (on_axis[1:] + on_axis[:-1]) if len(on_axis) > 1 else on_axis
        higher = max((gain(float(omega)) for omega in between), default=0.0)
        if higher <= level:
            break
        found = higher
    return found * (1.0 + 2.0 * DIGITS)


def _stable(A: Array) -> bool:
    return bool(not len(A) or np.linalg.eigvals(A).real.max() < 0.0)


def _parted(plant: Any, measured: Any, controls: Any) -> tuple[_Parts, Any]:
    """The plant with ``D12 = [0; I]`` and ``D21 = [0, I]``, and what takes a controller and its loop back."""
    import control

    if not isinstance(plant, control.StateSpace) or plant.isdtime(strict=True):
        raise TypeError(f"plant must be a control.StateSpace in continuous time, got {briefly(plant)}")
    inputs = _chosen(controls, plant.input_labels, "controls", "inputs")
    outputs = _chosen(measured, plant.output_labels, "measured", "outputs")
    w, z = (np.setdiff1d(np.arange(n), some) for n, some in ((plant.ninputs, inputs), (plant.noutputs, outputs)))
    if not len(w) or not len(z):
        raise ValueError("plant must have a disturbance beside the controls and an error beside what is measured")
    A, B, C, D = plant.A, plant.B, plant.C, plant.D
    D12, D21, D22 = D[np.ix_(z, inputs)], D[np.ix_(outputs, w)], D[np.ix_(outputs, inputs)]
    U, R = _last(D12, "every control must weigh directly on an error, as an effort does")
    V, S = _last(D21.T, "every measurement must carry noise of its own, as a direct disturbance")
    parts = _Parts(
        A, B[:, w] @ V, B[:, inputs] @ np.linalg.inv(R), U.T @ C[z], np.linalg.solve(S.T, C[outputs]),
        U.T @ D[np.ix_(z, w)] @ V, U.T @ D12 @ np.linalg.inv(R), np.linalg.solve(S.T, D21 @ V),
    )  # fmt: skip

    def back(law: tuple[Array, ...], loop: tuple[Array, ...]) -> tuple[Any, Any]:
        Ak, Bk, Ck, Dk = law
        Bk, Ck, Dk = Bk @ np.linalg.inv(S.T), np.linalg.solve(R, Ck), np.linalg.solve(R, Dk) @ np.linalg.inv(S.T)
        # What passes straight from controls to measurements is taken off these.
        through = np.linalg.inv(np.eye(len(outputs)) + D22 @ Dk)
        own = Ak - Bk @ through @ D22 @ Ck, Bk @ through, Ck - Dk @ through @ D22 @ Ck, Dk @ through
        names = [plant.input_labels[i] for i in inputs], [plant.output_labels[i] for i in outputs]
        Acl, Bcl, Ccl, Dcl = loop
        closed = control.ss(
            Acl, Bcl @ V.T, U @ Ccl, U @ Dcl @ V.T,
            inputs=[plant.input_labels[i] for i in w], outputs=[plant.output_labels[i] for i in z],
        )  # fmt: skip
        return control.ss(*own, inputs=names[1], outputs=names[0], name="h_infinity"), closed

    return parts, back


def _chosen(names: Any, available: Sequence[str], what: str, which: str) -> NDArray[np.int_]:
    if isinstance(names, str) or not isinstance(names, Sequence) or not names:
        raise TypeError(f"{what} must be a sequence of names of {which}, got {briefly(names)}")
    for name in names:
        if name not in available:
            raise ValueError(f"{what}: no {which[:-1]} named {briefly(name)}, available: {', '.join(available)}")
    return np.array([available.index(name) for name in names])


def _last(D: Array, need: str) -> tuple[Array, Array]:
    """Orthogonal U and square R with ``D = U [0; R]``."""
    rows, columns = D.shape
    if rows < columns or np.linalg.svd(D, compute_uv=False)[-1] <= SMALL * max(np.abs(D).max(), SMALL):
        raise ValueError(f"plant: {need}")
    Q, R = np.linalg.qr(D, mode="complete")
    return np.hstack([Q[:, columns:], Q[:, :columns]]), R[:columns]


def _central(parts: _Parts, level: float) -> tuple[Array, Array, Array, Array] | None:
    """The central controller of a level (theorem 17.1 of Zhou, Doyle and Glover); nothing where there is none."""
    A, B1, B2, C1, C2, D11, D12, D21 = parts
    m1, m2, p1, p2 = B1.shape[1], B2.shape[1], len(C1), len(C2)
    a, b = p1 - m2, m1 - p2
    top, left = np.linalg.norm(D11[:a], 2) if a else 0.0, np.linalg.norm(D11[:, :b], 2) if b else 0.0
    if level <= max(top, left) * (1.0 + SMALL):
        return None
    square = level**2
    across, along = np.hstack([D11, D12]), np.vstack([D11, D21])
    R = across.T @ across - scipy.linalg.block_diag(square * np.eye(m1), np.zeros((m2, m2)))
    Rt = along @ along.T - scipy.linalg.block_diag(square * np.eye(p1), np.zeros((p2, p2)))
    B, C = np.hstack([B1, B2]), np.vstack([C1, C2])
    X = _riccati(A, B, C1.T @ C1, R, across.T @ C1)
    Y = _riccati(A.T, C.T, B1 @ B1.T, Rt, along @ B1.T)
    if X is None or Y is None or np.abs(np.linalg.eigvals(X @ Y)).max() >= square:
        return None
    F = -np.linalg.solve(R, across.T @ C1 + B.T @ X)
    L = -np.linalg.solve(Rt, along @ B1.T + C @ Y).T
    F12, F2, L12, L2 = F[b:m1], F[m1:], L[:, a:p1], L[:, p1:]
    D1111, D1112, D1121, D1122 = D11[:a, :b], D11[:a, b:], D11[a:, :b], D11[a:, b:]
    outer, inner = square * np.eye(a) - D1111 @ D1111.T, square * np.eye(b) - D1111.T @ D1111
    D = -D1121 @ D1111.T @ np.linalg.solve(outer, D1112) - D1122
    Dl = np.linalg.cholesky(np.eye(m2) - D1121 @ np.linalg.solve(inner, D1121.T))
    Dr = np.linalg.cholesky(np.eye(p2) - D1112.T @ np.linalg.solve(outer, D1112)).T
    Z = np.linalg.inv(np.eye(len(A)) - Y @ X / square)
    Bk2, Ck2 = Z @ (B2 + L12) @ Dl, -Dr @ (C2 + F12)
    Bk = -Z @ L2 + Bk2 @ np.linalg.solve(Dl, D)
    Ck = F2 + D @ np.linalg.solve(Dr, Ck2)
    return A + B @ F + Bk @ np.linalg.solve(Dr, Ck2), Bk, Ck, D


def _riccati(A: Array, B: Array, Q: Array, R: Array, S: Array) -> Array | None:
    """The stabilising solution of ``A^T X + X A - (X B + S^T) R^-1 (B^T X + S) + Q = 0`` that is not negative."""
    n = len(A)
    F = A - B @ np.linalg.solve(R, S)
    H = np.block([[F, -B @ np.linalg.solve(R, B.T)], [-(Q - S.T @ np.linalg.solve(R, S)), -F.T]])
    rates = np.linalg.eigvals(H)
    if (np.abs(rates.real) < ON_AXIS * np.abs(rates)).any():
        return None
    _, U, stable = scipy.linalg.schur(H, sort="lhp")
    if stable != n or np.linalg.cond(U[:n, :n]) > 1.0 / np.finfo(float).eps:
        return None
    X = np.linalg.solve(U[:n, :n].T, U[n:, :n].T).T
    sizes = np.linalg.eigvalsh(0.5 * (X + X.T))
    return 0.5 * (X + X.T) if sizes[0] >= -NEGATIVE * max(sizes[-1], SMALL) else None


def _closed(parts: _Parts, law: tuple[Array, ...]) -> tuple[Array, Array, Array, Array]:
    A, B1, B2, C1, C2, D11, D12, D21 = parts
    Ak, Bk, Ck, Dk = law
    return (
        np.block([[A + B2 @ Dk @ C2, B2 @ Ck], [Bk @ C2, Ak]]),
        np.vstack([B1 + B2 @ Dk @ D21, Bk @ D21]),
        np.hstack([C1 + D12 @ Dk @ C2, D12 @ Ck]),
        D11 + D12 @ Dk @ D21,
    )
