"""A vehicle that runs over a profile: at several instants beside what it feels, and as a moving picture."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import matplotlib as mpl
import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from ...quantities import briefly
from ...vehicles.vehicle import Vehicle
from .modes import AMPLITUDE, BODY, BODY_HEIGHT, RADIUS, WHEEL
from .style import COLUMN, STYLE, WIDTH, add_grid, new_figure, panels, shown, styled

if TYPE_CHECKING:
    from matplotlib.animation import FuncAnimation

Array = NDArray[np.float64]

NEEDED = ("z_s", "z_r", "sws", "dtl", "bacc")
FELT = ("bacc", "sws", "dtl")

# Half the length of a body that stands on one axle, and what is seen before and behind a car, in m.
SHORT, AROUND = 0.4, 1.2

# Of the largest acceleration, what counts as felt.
FEELS = 0.1

# Frames a second of a moving picture.
FRAMES = 25

ROAD, LEFT_SIDE = "0.3", 0.45


def ride(vehicle: Vehicle, history: xr.Dataset, instants: int | Sequence[float] = 4, ax: Any = None) -> Figure:
    """A ride over a profile: the vehicle at several instants, and what it feels over time.

    Parameters
    ----------
    vehicle : Vehicle
        One number for every parameter.
    history : xarray.Dataset
        What ``simulate(vehicle, profile, speed=..., positions=True)`` returns of it.
    instants : int or sequence of float
        How many, evenly while the body feels anything, or at which times in s.
    ax : sequence of Axes, optional
        One an instant, and three more.

    Returns
    -------
    matplotlib.figure.Figure
        Above the vehicle from its right, its left side paler, with heights drawn larger where that is said. Below body
        acceleration at the first point and, of the wheels on the right, suspension deflection and tyre load; dotted
        lines are the instants.

    Raises
    ------
    TypeError, ValueError
        Another history, or an instant outside it.

    Examples
    --------
    >>> import susp_ss as ss
    >>> from susp_ss import plots
    >>> car = ss.FullCar()
    >>> over = ss.simulate(car, ss.obstacle("speed table"), speed=8.0, positions=True)
    >>> [axes.get_ylabel() for axes in plots.ride(car, over).axes[-3:]]
    ['BAcc (m/s²)', 'SWS (mm)', 'DTL (kN)']
    """
    check_history(vehicle, history)
    at, large = _instants(history, instants), _magnified(history)
    with mpl.rc_context(STYLE):
        if ax is None:
            figure = new_figure(WIDTH, 5.0, layout="constrained")
            grid = figure.add_gridspec(4, len(at))
            seen = [figure.add_subplot(grid[0, i]) for i in range(len(at))]
            felt = [figure.add_subplot(grid[1 + i, :]) for i in range(len(FELT))]
        else:
            figure, given = panels(ax, 1, len(at) + len(FELT), (WIDTH, 2.0))
            seen, felt = given[0, : len(at)], given[0, len(at) :]
        for here, k in zip(seen, at.tolist(), strict=True):
            _add_road(here, vehicle, history, large)
            _add_car(here, vehicle, history, k, large)
            _follow(here, vehicle, history, k)
            here.set_title(f"{history.time.values[k]:.2f} s")
        seen[0].set_ylabel(f"heights × {large:g}" if large > 1.0 else "to scale")
        for here, name in zip(felt, FELT, strict=True):
            symbol = shown(name)
            for values, style in styled(_felt(vehicle, history[name])):
                here.plot(history.time, values / symbol.one, **style)
            for k in at.tolist():
                here.axvline(history.time.values[k], color="0.6", linewidth=0.8, linestyle=":")
            here.set(ylabel=symbol.label, xlim=(history.time[0], history.time[-1]))
            here.legend(frameon=False, loc="upper right", ncols=3, handlelength=2.5)
            add_grid(here)
        felt[-1].set_xlabel("time (s)")
    return figure


def ride_animation(vehicle: Vehicle, history: xr.Dataset, slower: float = 1.0) -> FuncAnimation:
    """The same ride as a moving picture.

    Parameters
    ----------
    vehicle, history
        As for `ride`.
    slower : float
        How many times slower than the ride itself, > 0.

    Returns
    -------
    matplotlib.animation.FuncAnimation
        ``animation.to_jshtml()`` shows it in a notebook, ``animation.save("ride.gif")`` keeps it.

    Examples
    --------
    >>> import susp_ss as ss
    >>> from susp_ss import plots
    >>> car = ss.QuarterCar()
    >>> over = ss.simulate(car, ss.obstacle("bump"), speed=5.0, positions=True)
    >>> html = plots.ride_animation(car, over.isel(time=slice(600, 700))).to_jshtml()
    """
    from matplotlib.animation import FuncAnimation

    check_history(vehicle, history)
    if isinstance(slower, bool) or not isinstance(slower, (int, float)) or not 0.0 < slower < np.inf:
        raise ValueError(f"slower must be a number > 0, got {briefly(slower)}")
    time, large = history.time.values, _magnified(history)
    frames = np.searchsorted(time, np.arange(time[0], time[-1], 1.0 / (FRAMES * slower)))
    with mpl.rc_context(STYLE):
        figure = new_figure(COLUMN, 0.42 * COLUMN)
        axes = figure.add_axes((0.01, 0.01, 0.98, 0.86))
        _add_road(axes, vehicle, history, large)
        lines = _add_car(axes, vehicle, history, 0, large)

    def move(k: int) -> list[Any]:
        for line, (x, y) in zip(lines, _parts(vehicle, history, k, large), strict=True):
            line.set_data(x, y)
        _follow(axes, vehicle, history, k)
        axes.set_title(f"{time[k]:.2f} s", fontsize=8)
        return lines

    return FuncAnimation(figure, move, frames=frames.tolist(), interval=1000.0 / FRAMES)


def check_history(vehicle: Any, history: Any) -> None:
    """Say when a history is none of one vehicle with positions on a profile.

    Raises
    ------
    TypeError, ValueError
    """
    if not isinstance(vehicle, Vehicle):
        raise TypeError(f"vehicle must be one whose body is known, such as FullCar(), got {briefly(vehicle)}")
    need = "history must be what simulate(vehicle, profile, speed=..., positions=True) returns"
    if not isinstance(history, xr.Dataset):
        raise TypeError(f"{need}, got {briefly(history)}")
    missing = [name for name in (*NEEDED, "x", "time") if name not in history.variables]
    if missing:
        raise ValueError(f"{need}, got no {', '.join(missing)}")
    corners = list(vehicle.wheels)
    others = set(history.dims) - {"time", "point", "corner", "seat", "axle"}
    if others or (history.corner.values.tolist() if "corner" in history.dims else [""]) != corners:
        raise ValueError(f"{need} of this one {type(vehicle).__name__}, got dims {', '.join(map(str, history.dims))}")


def _instants(history: xr.Dataset, instants: Any) -> NDArray[np.int_]:
    """Which samples are drawn."""
    time = history.time.values
    if isinstance(instants, int) and not isinstance(instants, bool) and instants > 0:
        felt = np.abs(np.atleast_2d(history.bacc)).max(axis=0)
        first, last = np.flatnonzero(felt >= FEELS * felt.max())[[0, -1]]
        return np.linspace(first, last, instants).astype(int)
    at = np.asarray(instants)
    if at.dtype.kind not in "if" or at.ndim != 1 or not at.size or not ((at >= time[0]) & (at <= time[-1])).all():
        span = f"times from {time[0]:g} to {time[-1]:g} s"
        raise ValueError(f"instants must be how many, or {span}, got {briefly(instants)}")
    return np.searchsorted(time, at)


def _magnified(history: xr.Dataset) -> float:
    """How many times heights are drawn larger than they are: a whole number."""
    highest = max(float(np.ptp(history[name].values)) for name in ("z_s", "z_r"))
    return float(max(1, round(AMPLITUDE / highest))) if highest > 0.0 else 1.0


def _sides(vehicle: Vehicle) -> list[tuple[float, list[int]]]:
    """Opacity and wheels, front to rear, of each side, the nearer last."""
    sides = [wheel.side for wheel in vehicle.wheels.values()]
    found = [[i for i, side in enumerate(sides) if side == one] for one in (1, 0, -1)]
    return [(LEFT_SIDE if one and one[0] and sides[one[0]] == 1 else 1.0, one) for one in found if one]


def _height(history: xr.Dataset, name: str, wheel: str, k: Any) -> Any:
    """A height at a wheel, or over it."""
    data = history[name].isel(time=k)
    dim = next((dim for dim in ("corner", "point") if dim in data.dims), None)
    return (data.sel({dim: wheel}) if dim else data).values


def _parts(vehicle: Vehicle, history: xr.Dataset, k: int, large: float) -> list[tuple[Array, Array]]:
    """Points of body, struts and wheels of each side, those of several lines parted by NaN."""
    names, wheels = list(vehicle.wheels), list(vehicle.wheels.values())
    turn = np.linspace(0.0, 2.0 * np.pi, 33)
    parts = []
    for _, side in _sides(vehicle):
        at = np.array([float(history.x[k]) - vehicle.axles[wheels[i].axle] for i in side])
        over = [name if "point" in history.dims and name in history.point.values else "cg" for name in names]
        body = BODY_HEIGHT + large * np.array([_height(history, "z_s", over[i], k) for i in side])
        hub = "z_u" if "z_u" in history else "z_r"
        hubs = RADIUS + large * np.array([_height(history, hub, names[i], k) for i in side])
        if len(side) > 1:
            parts.append((at, body))
        else:
            parts.append((at + np.array([-SHORT, SHORT]), np.repeat(body, 2)))
        apart = np.full(len(side), np.nan)
        parts.append((np.stack([at, at, apart], axis=1).ravel(), np.stack([hubs, body, apart], axis=1).ravel()))
        rims = (
            at[:, None] + RADIUS * np.append(np.cos(turn), np.nan),
            hubs[:, None] + RADIUS * np.append(np.sin(turn), 0),
        )
        parts.append((rims[0].ravel(), rims[1].ravel()))
    return parts


def _add_car(axes: Axes, vehicle: Vehicle, history: xr.Dataset, k: int, large: float) -> list[Any]:
    """The vehicle at one instant; its lines."""
    looks = (BODY, 2.5), ("0.5", 0.8), (WHEEL, 1.2)
    parts, lines = iter(_parts(vehicle, history, k, large)), []
    for opacity, _ in _sides(vehicle):
        for (colour, width), (x, y) in zip(looks, parts, strict=False):
            lines += axes.plot(x, y, alpha=opacity, color=colour, linewidth=width, solid_capstyle="round")
    return lines


def _add_road(axes: Axes, vehicle: Vehicle, history: xr.Dataset, large: float) -> None:
    """The tracks that the first axle meets, level before the first point."""
    for opacity, side in _sides(vehicle):
        first = list(vehicle.wheels)[side[0]]
        heights = large * _height(history, "z_r", first, slice(None))
        x = np.append(history.x.values[0] - vehicle.wheelbase - 2.0 * AROUND, history.x.values)
        axes.plot(x, np.append(heights[0], heights), color=ROAD, linewidth=1.0, alpha=opacity)


def _follow(axes: Axes, vehicle: Vehicle, history: xr.Dataset, k: int) -> None:
    """Show what is around the vehicle at one instant."""
    x = float(history.x[k])
    ground = float(np.mean(history.z_r.isel(time=k))) * _magnified(history)
    axes.set_xlim(x - vehicle.wheelbase - AROUND, x + AROUND)
    axes.set_ylim(ground - 1.5 * AMPLITUDE, ground + BODY_HEIGHT + 2.0 * AMPLITUDE)
    axes.set(xticks=[], yticks=[], aspect="equal")


def _felt(vehicle: Vehicle, data: xr.DataArray) -> dict[str, Array]:
    """Histories by the legend: at the first point, and at the wheels on the right or on the only track."""
    if "point" in data.dims:
        return {str(data.point.values[0]): data.isel(point=0).values}
    if "corner" not in data.dims:
        return {type(vehicle).__name__: data.values}
    right = [name for name, wheel in vehicle.wheels.items() if wheel.side <= 0]
    return {name: data.sel(corner=name).values for name in right}
