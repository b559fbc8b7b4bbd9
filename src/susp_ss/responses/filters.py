"""A filter on an output, which may as well stand on the road: ``y = W H w = H W w``.

Its square ``|W(j omega)|^2`` is a list of first-order terms, one for each pole, as every factor of the road's spectrum
is: ``c + sum_k r_k / (omega^2 + p_k^2)`` with ``r_k = -2 p_k Res_(p_k) W(s) W(-s)``. Poles that coincide have no such
terms of their own. By Cauchy's formula points on a circle around them do in their place, for what the variance makes of
a term is analytic in its rate.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..quantities import briefly
from ..roads.colours import Colours
from .first_order_hold import FirstOrderHold

# Poles nearer to one another than a share of the way to the imaginary axis are taken together: the first share with
# which the terms are |W|^2 to ENOUGH of its peak, else the best; what is then off by more than LOST is refused.
SHARES, ENOUGH, LOST = (0.03, 0.1, 0.2, 0.01, 0.4, 0.7, 1.0), 1e-11, 1e-7

# Around poles together runs a circle midway, in ratio, between what it holds and what lies outside: the next pole and
# the imaginary axis. The error falls as that ratio's power of the number of points; a smaller circle than LEAST of the
# way would lose digits to the large values on it.
LEAST, POINTS = 0.2, (16, 32, 64, 128)


class Filter:
    """A stable, proper filter with one input and one output.

    Parameters
    ----------
    system : control.TransferFunction or control.StateSpace
        In continuous time.
    where : str
        What the errors call it.
    name : str
        What results call it.

    Raises
    ------
    TypeError, ValueError
        No such system.
    """

    def __init__(self, system: Any, where: str, name: str = "filter"):
        import control

        self.name, self.where = name, where
        if not isinstance(system, (control.TransferFunction, control.StateSpace)):
            raise TypeError(f"{where} must be a name or a system of python-control, got {briefly(system)}")
        if system.ninputs != 1 or system.noutputs != 1:
            raise ValueError(
                f"{where} must have one input and one output, got {system.ninputs} inputs and {system.noutputs} outputs"
            )
        if system.isdtime(strict=True):
            raise ValueError(f"{where} must be in continuous time, got a step of {system.dt} s")
        transfer = control.tf(system)
        numerator, denominator = (np.trim_zeros(np.asarray(p[0][0], float), "f") for p in (transfer.num, transfer.den))
        if len(numerator) > len(denominator):
            raise ValueError(
                f"{where} must be proper, got a numerator of degree {len(numerator) - 1} over {len(denominator) - 1}"
            )
        self.numerator, self.denominator = numerator / denominator[0], denominator / denominator[0]
        self.poles = np.roots(self.denominator)
        if (self.poles.real >= 0.0).any():
            worst = self.poles[np.argmax(self.poles.real)]
            raise ValueError(f"{where} must be stable, got a pole at {worst:.4g} rad/s")
        self.strictly_proper = len(self.numerator) < len(self.denominator)

    def __call__(self, s: Any) -> Any:
        """``W(s)``, in powers of s or of 1/s, whichever is small."""
        s = np.asarray(s, dtype=complex)
        large = np.abs(s) > 1.0
        below, above = np.where(large, 1.0, s), 1.0 / np.where(large, s, 1.0)
        lag = len(self.denominator) - len(self.numerator)
        small = np.polyval(self.numerator, below) / np.polyval(self.denominator, below)
        steep = np.polyval(self.numerator[::-1], above) / np.polyval(self.denominator[::-1], above)
        return np.where(large, above**lag * steep, small)

    def power(self, omega: NDArray[Any]) -> NDArray[Any]:
        """``|W(j omega)|^2``."""
        return np.asarray(np.abs(self(1j * omega)) ** 2)

    def same_as(self, other: Filter) -> bool:
        """Whether another has the same coefficients."""
        return np.array_equal(self.numerator, other.numerator) and np.array_equal(self.denominator, other.denominator)

    def select(self, designs: Any) -> Filter:
        """The same for any designs."""
        return self

    @cached_property
    def colours(self) -> Colours:
        """``|W(j omega)|^2`` as first-order terms, for one design.

        Raises
        ------
        ValueError
            Poles of which no terms keep the digits.
        """
        best, least = self._colours(SHARES[0]), np.inf
        for share in SHARES:
            colours = self._colours(share)
            error = self._error(colours)
            if error < least:
                best, least = colours, error
            if least <= ENOUGH:
                break
        if least > LOST:
            raise ValueError(
                f"{self.where} has poles too close to the imaginary axis and to one another to keep digits"
            )
        return best

    def _colours(self, share: float) -> Colours:
        level = np.array([[0.0 if self.strictly_proper else self.numerator[0] ** 2]])
        terms = [term for cluster in self._clusters(share) for term in self._terms(cluster)]
        alphas, low = np.array(terms, dtype=complex).reshape(-1, 2).T[:, None]
        if not alphas.imag.any():
            alphas, low = alphas.real, low.real
        return Colours(level, alphas, low, np.zeros_like(low))

    def _error(self, colours: Colours) -> float:
        """How far the terms are from ``|W|^2`` at most, over its peak, on frequencies about every pole."""
        if not len(self.poles):
            return 0.0
        sizes = np.abs(self.poles)
        about = np.abs(self.poles.imag[:, None] + np.outer(self.poles.real, np.linspace(-3.0, 3.0, 13))).ravel()
        omega = np.concatenate([about, np.geomspace(0.01 * sizes.min(), 100.0 * sizes.max(), 60)])
        power, squares = self.power(omega), colours.alphas[0] ** 2
        terms = colours.level[0, 0] + ((colours.low[0] * squares)[:, None] / (squares[:, None] + omega**2)).sum(axis=0)
        return float(np.max(np.abs(terms.real - power)) / power.max())

    def _clusters(self, share: float) -> list[NDArray[Any]]:
        """Poles of the upper half plane, those together that lie close."""
        clusters: list[list[complex]] = []
        for pole in sorted(self.poles, key=abs):
            near = [c for c in clusters if any(abs(pole - other) < share * abs(pole.real) for other in c)]
            clusters = [c for c in clusters if c not in near] + [[pole, *(other for c in near for other in c)]]
        found = [np.array(cluster) for cluster in clusters]
        return [cluster for cluster in found if cluster.mean().imag > -1e-12 * abs(cluster.mean())]

    def _terms(self, cluster: NDArray[Any]) -> list[tuple[complex, complex]]:
        """Rates and low-pass weights of the terms of a cluster and of its conjugate."""
        centre = cluster.mean()
        real = abs(centre.imag) <= 1e-12 * abs(centre)
        if len(cluster) == 1:
            slope = np.polyval(np.polyder(self.denominator), centre)
            residue = -2.0 * centre * np.polyval(self.numerator, centre) * self(-centre) / slope
            return [(-centre.real, (residue / centre**2).real)] if real else [(-centre, 2.0 * residue / centre**2)]
        outside = min([-centre.real, *(abs(pole - centre) for pole in self.poles if not np.isin(pole, cluster))])
        inside = np.abs(cluster - centre).max()
        radius = max(np.sqrt(inside * outside), LEAST * outside)
        count = next((n for n in POINTS if (radius / outside) ** n <= ENOUGH), POINTS[-1])
        turns = radius * np.exp(2j * np.pi * (np.arange(count) + 0.5) / count)
        nodes = centre + turns
        weights = turns / count * self(nodes) * self(-nodes) * (-2.0 / nodes)
        # Of a pole and its conjugate, or of points above and below the real axis, the real part counts twice.
        counted = nodes.imag > 0.0 if real else np.ones(count, dtype=bool)
        return list(zip(-nodes[counted], 2.0 * weights[counted], strict=True))

    def filtered(self, y: NDArray[Any], step: float) -> NDArray[Any]:
        """Histories (outputs, T) filtered from rest, each taken as linear between samples."""
        if len(self.denominator) == 1:
            return np.asarray(self.numerator[0] * y)
        from scipy import signal

        A, B, C, D = signal.tf2ss(self.numerator, self.denominator)
        hold = FirstOrderHold(A, B, C, D, step)
        return np.concatenate(list(hold.drive(y[:, None])), axis=-1)[:, 0]


# What lets everything pass.
OPEN = Colours(np.ones((1, 1)), *(np.empty((1, 0)) for _ in range(3)))


class EachDesign:
    """A filter, or None, for each of N designs, which the covariance route then solves side by side.

    Where some let the velocity of the road pass at high frequency, outputs that pass it straight on count as infinite
    in every design.
    """

    def __init__(self, filters: Sequence[Filter | None]):
        self.filters = tuple(filters)
        self.strictly_proper = all(one is not None and one.strictly_proper for one in self.filters)

    def select(self, designs: slice | NDArray[np.int_]) -> EachDesign | None:
        """Those of some of the designs; None where none has any."""
        some = [self.filters[i] for i in np.arange(len(self.filters))[designs]]
        return EachDesign(some) if any(some) else None

    @cached_property
    def colours(self) -> Colours:
        """``|W(j omega)|^2`` of every design as as many first-order terms, some of them zero."""
        different = {one: i for i, one in enumerate(dict.fromkeys(self.filters))}
        which = [different[one] for one in self.filters]
        colours = [OPEN if one is None else one.colours for one in different]
        most = max((one.alphas for one in colours), key=np.size)
        nothing = np.zeros_like(most)

        def filled(name: str, beyond: NDArray[Any]) -> NDArray[Any]:
            rows = [getattr(one, name) for one in colours]
            return np.concatenate([np.concatenate([row, beyond[:, row.shape[1] :]], axis=1) for row in rows])[which]

        level = np.concatenate([one.level for one in colours])[which]
        return Colours(level, filled("alphas", most), filled("low", nothing), filled("high", nothing))
