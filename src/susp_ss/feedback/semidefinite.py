"""The active bound once more, by another route: one semidefinite programme, where the state is finite.

On white noise that enters all at once, ``x' = A x + B u + W w``, a covariance X and ``Y = K X`` of some law ``u = K x``
are all that the problem asks for, and in these it is convex (Boyd, El Ghaoui, Feron and Balakrishnan, Linear Matrix
Inequalities in System and Control Theory (1994), chapter 7; Scherer, Gahinet and Chilali, IEEE Trans. Automatic Control
42 (1997)):

    minimise S_00   such that   A X + X A^T + B Y + Y^T B^T + W W^T <= 0,
                                [[S, C X + D Y], [(C X + D Y)^T, X]] >= 0,   S_ii <= limit_i^2.

Nothing of it is shared with the dual: no Riccati equation, no weight on forces. Its least is that of forces of any
bandwidth as well, which no law may reach.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable
from typing import Any

import numpy as np
import scipy.linalg
from numpy.typing import NDArray

from ..quantities import briefly
from .dual import Task
from .plant import Plant

Array = NDArray[np.float64]

SOLVERS: dict[str, dict[str, Any]] = {
    "clarabel": {"solver": "CLARABEL"},
    "scs": {"solver": "SCS", "eps": 1e-6, "max_iters": 20_000},
}
"""Those that cvxpy brings for semidefinite programmes: by interior points, and by splitting, which has fewer digits."""

ENDED = ("optimal", "optimal_inaccurate")


def check_solver(name: Any, plant: Plant) -> None:
    """Refuse what is no solver, and a problem that is no semidefinite programme.

    Raises
    ------
    ValueError
        No such solver, or none installed; a road that comes to an axle later or is not white.
    """
    import cvxpy as cp

    if not isinstance(name, str) or name not in SOLVERS:
        raise ValueError(f"certify must be {' or '.join(map(repr, SOLVERS))}, got {briefly(name)}")
    if name.upper() not in cp.installed_solvers():
        raise ValueError(f"certify: {name} is not installed; pip install {name}")
    if plant.looks_ahead:
        raise ValueError(
            "certify: a semidefinite programme needs a road of white velocity that all axles meet at once, for what is "
            f"between them or behind a colour is no state of the vehicle; got {plant.road.describe()}"
        )


def programme(plant: Plant, task: Task, solver: str) -> Callable[[Task], float]:
    """The least variance of the output minimised, as a function of tasks that differ in their limits.

    It is compiled once. NaN where the solver gives no answer, as where no law meets the limits.
    """
    import cvxpy as cp

    A, B, C, D = plant.system
    W = np.vstack([noise.entries for noise in plant.noises])
    # The largest state has variance one, a unit of force moves the body as the road does, every row has length one.
    unit = float(np.diagonal(scipy.linalg.solve_continuous_lyapunov(A, -W.T @ W)).max())
    force = np.sqrt(task.force / unit)
    rows = np.append(task.row, task.rows)
    B, D = force * B, force * D[rows]
    lengths = np.linalg.norm(np.hstack([C[rows], D]), axis=1)
    C, D, squares = C[rows] / lengths[:, None], D / lengths[:, None], unit * lengths**2

    X, S = cp.Variable((len(A), len(A)), symmetric=True), cp.Variable((len(rows), len(rows)), symmetric=True)
    Y, limits = cp.Variable(B.shape[::-1]), cp.Parameter(len(task.rows), nonneg=True)
    flow, seen = A @ X + B @ Y, C @ X + D @ Y
    holds = [flow + flow.T + W.T @ W / unit << 0, cp.bmat([[S, seen], [seen.T, X]]) >> 0]
    if len(task.rows):
        holds.append(cp.diag(S)[1:] <= limits)
    problem = cp.Problem(cp.Minimize(S[0, 0]), holds)

    def least(task: Task) -> float:
        limits.value = task.limits / squares[1:]
        with warnings.catch_warnings():
            warnings.filterwarnings("ignore", "Solution may be inaccurate")
            try:
                problem.solve(**SOLVERS[solver])
            except cp.SolverError:
                return float("nan")
        return float(problem.value * squares[0]) if problem.status in ENDED else float("nan")

    return least
