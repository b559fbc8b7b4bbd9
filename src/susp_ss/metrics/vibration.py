"""What standards make of a record of acceleration: weighted, its running root mean square, its dose.

Records are arrays with time as their last axis; their samples are taken as joined by straight lines.
"""

from __future__ import annotations

from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..quantities import briefly, positive
from ..responses.filters import Filter
from ..vehicles.parameters import number_array
from .weightings import filter_of

Array = NDArray[np.float64]

# How uneven samples may be for a filter, of a step: what rounded time stamps are.
UNEVEN = 0.01

AVERAGING = ("linear", "exponential")


def weighted(acceleration: ArrayLike, time: ArrayLike, weighting: Any) -> Array:
    """Send records of acceleration through a frequency weighting.

    The filter starts from rest and takes the record as linear between its samples, so that no digital approximation
    of it is made. What a record starts with, such as gravity in an accelerometer's, it answers by a transient of a
    second or two (``Wf``: ten): take the mean off first.

    Parameters
    ----------
    acceleration : array_like, (..., T)
        In m/s^2 or rad/s^2.
    time : array_like, (T,)
        In s, evenly spaced.
    weighting : str, control.TransferFunction or control.StateSpace
        As in `ride_metrics`.

    Returns
    -------
    ndarray, (..., T)

    Raises
    ------
    TypeError, ValueError
        No numbers, not finite, of another length than time, uneven samples, or no weighting.

    Examples
    --------
    Of a sine of 5 Hz, ``Wk`` lets 1.04 through:

    >>> import numpy as np
    >>> from susp_ss import weighted
    >>> time = np.arange(0.0, 10.0, 1e-3)
    >>> felt = weighted(np.sin(2.0 * np.pi * 5.0 * time), time, "Wk")
    >>> print(f"{felt[5000:].max():.2f}")
    1.04
    """
    a, t = checked_record(acceleration, time)
    filtered = filter_of(weighting, "weighting").filtered(a.reshape(-1, a.shape[-1]), even_step(t))
    return filtered.reshape(a.shape)


def running_rms(
    acceleration: ArrayLike,
    time: ArrayLike,
    constant: float = 1.0,
    averaging: Literal["linear", "exponential"] = "linear",
) -> Array:
    """Root mean square of what has just passed, at every instant of records of weighted acceleration.

    ``sqrt(1/T int_(t-T)^t a^2 ds)`` with linear averaging, ``sqrt(1/T int_-inf^t a^2 e^((s-t)/T) ds)`` with exponential
    averaging; before the record there was nothing (ISO 2631-1:1997, 6.3.1, equations 2 and 3). Its greatest value is
    the maximum transient vibration value MTVV.

    Parameters
    ----------
    acceleration : array_like, (..., T)
        Weighted, in m/s^2.
    time : array_like, (T,)
        In s, rising; evenly spaced for exponential averaging.
    constant : float
        T in s; the standard recommends 1 s.
    averaging : {"linear", "exponential"}

    Returns
    -------
    ndarray, (..., T)

    Raises
    ------
    TypeError, ValueError
        As `weighted`; no constant > 0 s, no such averaging.

    Examples
    --------
    A shock of 20 ms in a second:

    >>> import numpy as np
    >>> from susp_ss import running_rms
    >>> time = np.arange(0.0, 3.0, 1e-3)
    >>> shock = np.where((time > 0.5) & (time < 0.52), 5.0, 0.0)
    >>> mtvv = running_rms(shock, time).max()
    >>> print(f"{mtvv:.2f} m/s^2")
    0.69 m/s^2
    """
    a, t = checked_record(acceleration, time)
    constant = positive("constant", constant, "s")
    if averaging not in AVERAGING:
        raise ValueError(f"averaging must be linear or exponential, got {briefly(averaging)}")
    squares = a.reshape(-1, a.shape[-1]) ** 2
    if averaging == "exponential":
        import control

        mean = Filter(control.tf([1.0], [constant, 1.0]), "constant").filtered(squares, even_step(t))
    else:
        from scipy.integrate import cumulative_trapezoid

        until = cumulative_trapezoid(squares, t, axis=-1, initial=0.0)
        before = np.stack([np.interp(t - constant, t, row) for row in until])
        mean = (until - before) / constant
    return np.sqrt(np.maximum(mean, 0.0)).reshape(a.shape)


def vdv(acceleration: ArrayLike, time: ArrayLike) -> Any:
    """Vibration dose value of records of weighted acceleration.

    ``VDV = (int a^4 dt)^(1/4)`` (ISO 2631-1:1997, 6.3.2).

    Parameters
    ----------
    acceleration : array_like, (..., T)
        Weighted, in m/s^2.
    time : array_like, (T,)
        In s, rising.

    Returns
    -------
    float or ndarray, (...)
        In m/s^1.75.

    Raises
    ------
    TypeError, ValueError
        No numbers, not finite, or of another length than time.

    Examples
    --------
    >>> import numpy as np
    >>> from susp_ss import vdv, weighted
    >>> time = np.arange(0.0, 60.0, 1e-3)
    >>> shaken = np.sqrt(2.0) * np.sin(2.0 * np.pi * 5.0 * time)
    >>> round(float(vdv(weighted(shaken, time, "Wk"), time)), 2)
    3.2
    """
    a, t = checked_record(acceleration, time)
    return np.trapezoid(a**4, t, axis=-1) ** 0.25


def rms(acceleration: Array, time: Array) -> Any:
    """Root mean square of records (..., T)."""
    return np.sqrt(np.trapezoid(acceleration**2, time, axis=-1) / (time[-1] - time[0]))


def checked_record(acceleration: ArrayLike, time: ArrayLike) -> tuple[Array, Array]:
    """Return records (..., T) and their instants (T,) as floats, or say what is wrong with them."""
    a, t = number_array(acceleration, "acceleration must be numbers"), number_array(time, "time must be numbers")
    for name, values in (("acceleration", a), ("time", t)):
        if not np.isfinite(values).all():
            raise ValueError(f"{name} must be finite, got NaN or inf")
    if t.ndim != 1 or len(t) < 2 or (np.diff(t) <= 0.0).any():
        raise ValueError(f"time must be one row of two or more rising instants in s, got {briefly(time)}")
    if a.ndim == 0 or a.shape[-1] != len(t):
        raise ValueError(f"acceleration must have a sample for each of {len(t)} instants, got shape {a.shape}")
    return a.astype(float), t.astype(float)


def even_step(time: Array) -> float:
    """The step in s of evenly spaced instants.

    Raises
    ------
    ValueError
        Naming the samples that are uneven, counted from 1.
    """
    steps = np.diff(time)
    step = (time[-1] - time[0]) / len(steps)
    uneven = np.abs(steps - step) > UNEVEN * step
    if uneven.any():
        at = int(np.argmax(uneven))
        raise ValueError(
            f"samples {at + 1} and {at + 2}: a weighting needs even samples, got a step of {steps[at]:.6g} s where the "
            f"mean is {step:.6g} s"
        )
    return float(step)
