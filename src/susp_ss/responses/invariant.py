"""Frequencies at which a quarter car's response does not depend on its damper."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..quantities import briefly
from ..vehicles.curves import Curve
from ..vehicles.quarter import QuarterCar, RigidTyreQuarterCar


def invariant_points(vehicle: QuarterCar | RigidTyreQuarterCar) -> dict[str, NDArray[np.float64]]:
    """Frequencies at which the modulus of a quarter car's response to the road is the same for any ``cs``.

    With ``w`` in rad/s and ``M = ms + mu``, and the tyre undamped:

    - ``bacc`` at ``w^2 = kt / mu``, where the body's response does not depend on ``ks`` either, and at both roots of
      ``ms mu w^4 - (ms kt + 2 M ks) w^2 + 2 ks kt = 0``;
    - ``sws`` at ``w^2 = kt / M``, where it does not depend on ``ks`` either;
    - ``dtl`` at both roots of ``2 ms mu M w^4 - (2 M^2 ks + ms (M + mu) kt) w^2 + 2 M ks kt = 0``.

    On a rigid tyre ``bacc`` at ``w^2 = 2 ks / ms`` is what remains. No damper, passive or active between the same two
    masses, changes the first of ``bacc`` and that of ``sws`` (J. K. Hedrick and T. Butsuen, *Proc. Inst. Mech. Eng. D*
    204, 1990).

    Parameters
    ----------
    vehicle : QuarterCar or RigidTyreQuarterCar
        Parameters may be arrays; ``ct`` must be 0.

    Returns
    -------
    dict of str to ndarray, (designs..., n)
        By output, in Hz, ascending.

    Raises
    ------
    TypeError, ValueError
        No quarter car, or one with tyre damping.

    Examples
    --------
    >>> from susp_ss import QuarterCar, invariant_points
    >>> {name: points.round(2).tolist() for name, points in invariant_points(QuarterCar()).items()}
    {'bacc': [1.57, 10.35, 11.33], 'sws': [3.66], 'dtl': [1.51, 8.36]}
    """
    if type(vehicle) not in (QuarterCar, RigidTyreQuarterCar):
        raise TypeError(f"vehicle must be a QuarterCar or a RigidTyreQuarterCar, got {briefly(vehicle)}")
    if isinstance(vehicle.ks, Curve):
        raise TypeError(
            f"{type(vehicle).__name__}(ks=...) must be a number for points that do not depend on cs, got a curve"
        )
    space = vehicle.design_space()
    flat = vehicle.flattened(space)
    ms, ks = np.asarray(flat.ms), np.asarray(flat.ks)

    def found(*squares: Any) -> NDArray[np.float64]:
        points = np.sqrt(np.stack(np.broadcast_arrays(*squares), axis=-1)) / (2.0 * np.pi)
        return np.broadcast_to(np.sort(points, axis=-1), (space.size, len(squares))).reshape(*space.shape, -1)

    if isinstance(flat, RigidTyreQuarterCar):
        return {"bacc": found(2.0 * ks / ms)}
    if np.any(np.asarray(flat.ct) > 0.0):
        raise ValueError("QuarterCar(ct=...) must be 0 N s/m for invariant points, got tyre damping")
    mu, kt = np.asarray(flat.mu), np.asarray(flat.kt)
    M = ms + mu
    return {
        "bacc": found(kt / mu, *_roots(ms * mu, ms * kt + 2.0 * M * ks, 2.0 * ks * kt)),
        "sws": found(kt / M),
        "dtl": found(*_roots(2.0 * ms * mu * M, 2.0 * M**2 * ks + ms * (M + mu) * kt, 2.0 * M * ks * kt)),
    }


def _roots(a: Any, b: Any, c: Any) -> tuple[Any, Any]:
    """Both roots of ``a x^2 - b x + c``, of positive numbers, without loss of digits."""
    q = 0.5 * (b + np.sqrt(b**2 - 4.0 * a * c))
    return c / q, q / a
