"""Modes drawn as cars: the body's outline and its wheels, displaced."""

from __future__ import annotations

from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Ellipse, Polygon
from numpy.typing import NDArray

from ...quantities import briefly
from ...vehicles.second_order import coefficients
from ...vehicles.vehicle import Vehicle
from .style import COLUMN, LINES, STYLE, WIDTH, add_legend, panels

# A drawing's proportions in metres: wheels, the body above them, and the largest displacement.
RADIUS = 0.3
BODY_HEIGHT = 0.95
AMPLITUDE = 0.25
# How far the car's left side lies to the right of and above its right side, per metre of its width.
DEPTH = np.array([0.5, 0.55])

# A smaller share of a mode in heights is rounding: wheels that spin, which no drawing shows.
SEEN = 1e-6

AT_REST = "0.75"
BODY, WHEEL = LINES[1][0], LINES[2][0]


def mode_shapes(vehicle: Vehicle, phase: float = 0.0, ax: Any = None) -> Figure:
    """All modes of a vehicle, each drawn as the car at one instant of it.

    The displacements are ``Re(shape e^(j phase))`` of `Vehicle.modes`, so that phases from 0 to 2 pi are the frames of
    a moving picture; damping, which would shrink them, is left out. Each mode's largest displacement is drawn alike.

    Parameters
    ----------
    vehicle : Vehicle
        One number for every parameter.
    phase : float
        Instant within the cycle in rad.
    ax : array_like of Axes, optional
        One a mode.

    Returns
    -------
    matplotlib.figure.Figure
        A panel a mode, slowest first, with its natural frequency and damping ratio; at rest in grey. Full cars and
        pitching cars are seen from their right with the front on the right, rolling cars from behind.

    Examples
    --------
    >>> import susp_ss as ss
    >>> from susp_ss.presentation.plots import mode_shapes
    >>> figure = mode_shapes(ss.QuarterCar())
    >>> [axes.get_title() for axes in figure.axes]
    ['1.18 Hz, ζ = 0.27', '10.7 Hz, ζ = 0.25']
    """
    modes = vehicle.modes()
    columns = min(4, len(modes))
    rows = -(-len(modes) // columns)
    with mpl.rc_context(STYLE):
        if ax is None:
            size = (COLUMN, 1.9) if columns < 3 else (WIDTH, 1.6 * rows + 0.25)
            figure, given = panels(None, rows, columns, size)
        else:
            figure, given = panels(ax, 1, len(modes), (WIDTH, 2.0))
        for axes, (_, mode) in zip(given.flat, modes.iterrows(), strict=False):
            _draw(axes, vehicle, AMPLITUDE * _displacements(vehicle, mode["shape"], phase))
            axes.set_title(_title(mode))
        for axes in given.flat[len(modes) :]:
            axes.set_axis_off()
        add_legend(figure, given.flat[0], inside=ax is not None)
    return figure


def mode_shape(vehicle: Vehicle, mode: int, phase: float = 0.0, ax: Axes | None = None) -> Figure:
    """One mode of a vehicle, drawn as the car at one instant of it: a panel of `mode_shapes`.

    Parameters
    ----------
    vehicle : Vehicle
        One number for every parameter.
    mode : int
        Row of `Vehicle.modes`: 0 is the slowest.
    phase : float
        Instant within the cycle in rad.
    ax : Axes, optional

    Returns
    -------
    matplotlib.figure.Figure

    Raises
    ------
    ValueError
        The vehicle has no such mode.

    Examples
    --------
    >>> import susp_ss as ss
    >>> from susp_ss.presentation.plots import mode_shape
    >>> mode_shape(ss.FullCar(), 2).axes[0].get_title()
    '2.12 Hz, ζ = 0.49'
    """
    modes = vehicle.modes()
    if mode not in modes.index:
        raise ValueError(f"mode must be 0 to {len(modes) - 1} for {type(vehicle).__name__}, got {briefly(mode)}")
    chosen = modes.loc[mode]
    with mpl.rc_context(STYLE):
        figure, given = panels(ax, 1, 1, (COLUMN, 1.8))
        _draw(given[0, 0], vehicle, AMPLITUDE * _displacements(vehicle, chosen["shape"], phase))
        given[0, 0].set_title(_title(chosen))
    return figure


def _title(mode: Any) -> str:
    named = f"{mode['name']}\n" if "name" in mode else ""
    return f"{named}{mode['frequency']:.3g} Hz, ζ = {mode['damping_ratio']:.2f}"


def _displacements(vehicle: Vehicle, shape: Any, phase: float) -> NDArray[np.float64]:
    """Vertical displacement of body points and wheels, (2, corners), the largest of the whole cycle being 1."""
    model = vehicle.linkage().assemble()
    mounts = [corner.mount.terms for corner in vehicle.linkage().corners.values()]
    heights = shape[list(model.layout.coordinates)].to_numpy()
    body = coefficients(mounts, model.layout.coordinates) @ heights
    wheels = body + model.R[model.suspensions] @ heights
    both = np.stack([body, wheels])
    return (both * np.exp(1j * phase)).real / max(np.abs(both).max(), SEEN)


def _draw(axes: Axes, vehicle: Vehicle, moved: NDArray) -> None:
    """The car at rest and with its body and wheels displaced, moved (2, corners) in metres of the drawing."""
    first = getattr(vehicle, "a", 0.0)
    places = np.array(
        [(first - vehicle.axles[axle], 0.5 * side * vehicle.track_width) for axle, side in vehicle.wheels.values()]
    )
    from_behind = not np.ptp(places[:, 0]) and np.ptp(places[:, 1]) > 0.0
    across = np.array([[-1.0, 0.0]]) if from_behind else DEPTH[None]
    ground = np.outer(places[:, 0], [1.0, 0.0]) + places[:, 1:] * across
    up = np.array([0.0, 1.0])
    for displaced, colours, label in (
        (np.zeros_like(moved), (AT_REST, AT_REST), "at rest"),
        (moved, (BODY, WHEEL), None),
    ):
        body = ground + (BODY_HEIGHT + displaced[0])[:, None] * up
        hubs = ground + (RADIUS + displaced[1])[:, None] * up
        for hub, mount in zip(hubs, body, strict=True):
            axes.plot(*np.transpose([hub, mount]), color=colours[0], linewidth=0.8)
            width = RADIUS * (0.7 if from_behind else 2.0)
            axes.add_patch(Ellipse(hub, width, 2.0 * RADIUS, fill=False, edgecolor=colours[1], linewidth=1.2))
        if len(body) > 2:
            outline = body[[0, *range(1, len(body), 2), *range(len(body) - 2, -1, -2)]]
            axes.add_patch(Polygon(outline, facecolor=(*mpl.colors.to_rgb(colours[0]), 0.25), linewidth=0))
            axes.plot(*outline.T, color=colours[0], linewidth=1.5, label=label or "body")
        else:
            line = body if len(body) == 2 else body + np.array([[-0.4, 0.0], [0.4, 0.0]])
            axes.plot(*line.T, color=colours[0], linewidth=3.0, label=label or "body")
    axes.plot([], [], color=WHEEL, linewidth=1.2, label="wheels")
    for name, (x, y) in zip(vehicle.wheels, ground, strict=True):
        axes.text(x, y - AMPLITUDE - 0.1, name, ha="center", va="top", fontsize=7, color="0.35")
    axes.set_aspect("equal")
    axes.set_axis_off()
    low, high = ground.min(axis=0), ground.max(axis=0)
    axes.set_xlim(low[0] - 1.5 * RADIUS, high[0] + 1.5 * RADIUS)
    axes.set_ylim(low[1] - AMPLITUDE - 1.5 * RADIUS, high[1] + BODY_HEIGHT + 1.3 * AMPLITUDE)
