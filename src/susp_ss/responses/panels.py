"""Where an integral over all frequencies needs its nodes: panels that are short beside their distance to a pole.

In log frequency algebraic ends become exponential, and a resonance is a pole as far off the axis as it is damped.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..roads.road import Road
from ..vehicles.contract import Model, RoadVehicle
from .excitation import delays, processes

Array = NDArray[np.float64]

# Ends of the integral in rad/s. Slowly decaying spectra (waviness close to 1 or to 3) need ends this far out; panels
# are long there. From waviness 3 on, the rounding of a response that vanishes with frequency would be raised without
# bound; what comes from below the third end falls at least with the first power of frequency.
LOWEST, HIGHEST, LOWEST_OF_STEEP = 1e-60, 1e60, 1e-11

# How far off the axis every pole counts, so that no panel is shorter than numbers can tell.
CLOSEST = 1e-12

# Where poles are, in rad/s, that a road does not have.
NOWHERE = 1e300

# Half the length of a panel over its distance to a pole, and at most where axles interfere.
NEAR, INTERFERING = 0.5, 0.3

# Interference begins with a phase of 1 rad, and is followed up to so many times the fastest resonance and so many rad.
FOLLOWED, TURNS = 100.0, 500.0

# Where a panel lies: below interference all axles count together, above it each by itself.
BELOW, BETWEEN, ABOVE = range(3)


class Panels(NamedTuple):
    """Ranges of the logarithm of frequency in rad/s, each of one design, (P,)."""

    design: NDArray[np.int_]
    start: Array
    end: Array

    @property
    def centre(self) -> Array:
        return 0.5 * (self.start + self.end)

    @property
    def half(self) -> Array:
        return 0.5 * (self.end - self.start)

    def some(self, which: Any) -> Panels:
        """Some of them."""
        return Panels(*(x[which] for x in self))

    def halved(self) -> Panels:
        """The first halves, then the second."""
        starts, ends = np.append(self.start, self.centre), np.append(self.centre, self.end)
        return Panels(np.append(self.design, self.design), starts, ends)


class Marks(NamedTuple):
    """What panels go by, in log frequency.

    Poles (N, K) and how far they lie off the axis, breaks (N, B), and where axles begin and cease to interfere, (N,).
    """

    poles: Array
    off: Array
    breaks: Array
    low: Array
    high: Array

    def where(self, panels: Panels) -> NDArray[np.int_]:
        """Where panels lie."""
        return (panels.centre > self.low[panels.design]).astype(int) + (panels.centre > self.high[panels.design])

    def panels(self) -> Panels:
        """Panels of all designs between the breaks, one after the other, each as long as it may be.

        From ``start`` on, half a length h is ``NEAR`` times the distance of the centre to a pole that lies ``ahead``
        where ``(1 - NEAR^2) h^2 + 2 NEAR^2 ahead h = NEAR^2 (ahead^2 + off^2)``.
        """
        design = np.repeat(np.arange(len(self.breaks)), self.breaks.shape[1] - 1)
        ranges = Panels(design, self.breaks[:, :-1].ravel(), self.breaks[:, 1:].ravel())
        ranges, found = ranges.some(ranges.end > ranges.start), []
        most = np.where(self.where(ranges) == BETWEEN, 2.0 * INTERFERING, np.inf)
        poles, off = self.poles[ranges.design], np.sqrt(1.0 - NEAR**2) * self.off[ranges.design]
        while len(most):
            ahead = poles - ranges.start[:, None]
            half = (NEAR * np.hypot(ahead, off) - NEAR**2 * ahead).min(axis=1) / (1.0 - NEAR**2)
            end = np.minimum(ranges.start + np.minimum(2.0 * half, most), ranges.end)
            found.append(ranges._replace(end=end))
            left = end < ranges.end
            ranges = ranges._replace(start=end).some(left)
            most, poles, off = most[left], poles[left], off[left]
        return Panels(*map(np.concatenate, zip(*found, strict=True)))


def marks(vehicle: RoadVehicle, model: Model, road: Road, designs: int) -> Marks:
    """Resonances, cut-offs and bends of a flattened vehicle on a road, and where its axles interfere."""

    def each(values: Any) -> Array:
        return np.stack([np.broadcast_to(value, designs) for value in values], axis=1)

    modes = np.linalg.eigvals(model.A)
    modes = np.broadcast_to(modes, (designs, modes.shape[-1]))
    fastest = np.abs(modes).max(axis=1)
    filtered = road.weighting.poles if road.weighting is not None else np.empty(0)
    modes = np.concatenate([modes, np.broadcast_to(filtered, (designs, len(filtered)))], axis=1)
    lengths = road.contact_length, vehicle.track_width if road.tracks == "isotropic" else 0.0
    corners = each(
        [2.0 * np.pi * road.speed * road.cutoff, *(road.speed / np.maximum(x, 1.0 / NOWHERE) for x in lengths)]
    )
    corners[corners == 0.0] = NOWHERE
    poles = np.concatenate([np.abs(modes), corners], axis=1)
    off = [np.maximum(np.arctan2(np.abs(modes.real), np.abs(modes.imag)), CLOSEST), np.full_like(corners, 0.5 * np.pi)]

    taus = np.sort(each(delays(vehicle, road)), axis=1)
    apart = np.diff(taus, axis=1, append=0.0)
    apart = np.where(apart > 0.0, apart, np.inf).min(axis=1)
    interfere = np.isfinite(apart) & any(process.delayed for process in processes(vehicle, road))
    low = np.where(interfere, 1.0 / np.maximum(taus[:, -1], 1.0 / HIGHEST), HIGHEST)
    high = np.where(interfere, np.maximum(FOLLOWED * fastest, TURNS / apart), HIGHEST)
    lowest = LOWEST if road.slopes[0] < 3.0 else LOWEST_OF_STEEP
    bends = [2.0 * np.pi * road.speed * n for n, _ in road.table]
    breaks = np.clip(each([lowest, HIGHEST, low, high, *bends]), lowest, HIGHEST)
    return Marks(
        np.log(np.maximum(poles, lowest)),
        np.concatenate(off, axis=1),
        np.sort(np.log(breaks), axis=1),
        np.log(low),
        np.log(high),
    )
