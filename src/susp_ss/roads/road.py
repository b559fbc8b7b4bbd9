"""A random road: its spectrum, how fast it passes, and what each wheel sees of it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.special import gamma, kv

from ..quantities import briefly

REFERENCE_WAVENUMBER = 0.1
"""``n0`` of ISO 8608, cycle/m."""

# ISO 8608 classes by their GEOMETRIC MEAN roughness G_d(n0) in m^3; a class's upper limit is twice its mean.
CLASSES = {name: 16e-6 * 4.0**i for i, name in enumerate("ABCDEFGH")}

TRACKS = ("identical", "independent", "isotropic")


@dataclass(frozen=True)
class Road:
    """A homogeneous Gaussian road, driven over at constant speed.

    The one-sided displacement spectrum is ``G_d(n) = G_d(n0) (n/n0)^-w n^2 / (n^2 + n_c^2)`` over the wavenumber n in
    cycle/m (ISO 8608, ``n0`` = 0.1 cycle/m). With ``w = 2`` and no cut-off the vertical velocity under a wheel is
    white, of intensity ``q = 2 pi^2 n0^2 G_d(n0) V``.

    Parameters
    ----------
    roughness : float
        ``G_d(n0)`` in m^3, > 0; class B's geometric mean is 64e-6.
    speed : float
        ``V`` in m/s, > 0.
    waviness : float
        ``w``, between 1 and 4 exclusive. Only ``w = 2`` has a finite state-space model; other values
        need ``method="spectral"`` or ``"time"``.
    cutoff : float
        Low-wavenumber cut-off ``n_c`` in cycle/m, >= 0.
    tracks : {"identical", "independent", "isotropic"}
        How the left and the right wheel's profile relate. An isotropic surface has the coherence of two parallel
        lines on it, the track width apart; single-track vehicles ignore this.
    delay : bool
        Whether the rear wheels see the profile a wheelbase later, or at the same instant as the front.
    wheels : sequence of str, optional
        Only these wheels see the road, the others a flat one; all of them when None.

    Raises
    ------
    TypeError, ValueError
        An argument of the wrong kind or outside its bounds, named.

    Examples
    --------
    >>> from susp_ss import Road
    >>> print(Road.iso8608("C", speed=25.0, tracks="isotropic").describe())
    G_d(0.1 cycle/m) = 0.000256 m^3, waviness 2, 25 m/s, isotropic tracks, rear wheels delayed
    >>> float(Road().psd(0.1))
    6.4e-05
    """

    roughness: float = 64e-6
    speed: float = 20.0
    waviness: float = 2.0
    cutoff: float = 0.0
    tracks: Literal["identical", "independent", "isotropic"] = "identical"
    delay: bool = True
    wheels: tuple[str, ...] | None = None

    def __post_init__(self) -> None:
        for name, unit, low, high in (
            ("roughness", "m^3", 0.0, np.inf),
            ("speed", "m/s", 0.0, np.inf),
            ("waviness", "", 1.0, 4.0),
        ):
            need = f"> {low:g} {unit}".rstrip() + (f" and < {high:g}" if np.isfinite(high) else "")
            value = _number(name, getattr(self, name), need)
            if not low < value < high:
                raise ValueError(f"Road({name}=...) must be {need}, got {briefly(value)}")
            object.__setattr__(self, name, value)
        cutoff = _number("cutoff", self.cutoff, ">= 0 cycle/m")
        if cutoff < 0.0:
            raise ValueError(f"Road(cutoff=...) must be >= 0 cycle/m, got {briefly(cutoff)}")
        object.__setattr__(self, "cutoff", cutoff)
        if not isinstance(self.tracks, str) or self.tracks not in TRACKS:
            raise ValueError(f"Road(tracks=...) must be one of {', '.join(TRACKS)}, got {briefly(self.tracks)}")
        if not isinstance(self.delay, (bool, np.bool_)):
            raise TypeError(f"Road(delay=...) must be True or False, got {briefly(self.delay)}")
        if self.wheels is not None:
            named = isinstance(self.wheels, Sequence) and not isinstance(self.wheels, str)
            if not named or not all(isinstance(name, str) for name in self.wheels):
                raise TypeError(
                    f'Road(wheels=...) must be a sequence of names such as ("fr",), got {briefly(self.wheels)}'
                )
            if len(self.wheels) == 0:
                raise ValueError("Road(wheels=...) must name at least one wheel, got none")
            object.__setattr__(self, "wheels", tuple(self.wheels))

    @classmethod
    def iso8608(cls, road_class: str, **parameters: Any) -> Road:
        """Return the road of an ISO 8608 class, by the class's geometric mean roughness.

        Parameters
        ----------
        road_class : str
            A to H: ``G_d(n0)`` of 16e-6 m^3 times 4 from each class to the next.
        **parameters
            Any other parameter of `Road`.

        Examples
        --------
        >>> from susp_ss import Road
        >>> Road.iso8608("B") == Road(roughness=64e-6)
        True
        """
        if not isinstance(road_class, str) or road_class not in CLASSES:
            raise ValueError(f"road class must be one of {', '.join(CLASSES)}, got {briefly(road_class)}")
        if "roughness" in parameters:
            raise ValueError("Road.iso8608 takes its roughness from the class; pass Road(roughness=...) instead")
        return cls(roughness=CLASSES[road_class], **parameters)

    @property
    def intensity(self) -> float:
        """``q`` of the white vertical velocity, ``E[w(t) w(t')] = q delta(t - t')``, in m^2/s (waviness 2).

        Its one-sided density is twice this, ``4 pi^2 n0^2 G_d(n0) V``.
        """
        return 2.0 * np.pi**2 * REFERENCE_WAVENUMBER**2 * self.roughness * self.speed

    @property
    def scale_free(self) -> bool:
        """Whether the spectrum is a power of the wavenumber, so that speed only scales it in time."""
        return not self.cutoff and type(self).psd is Road.psd

    def first_order(self) -> tuple[float, NDArray[np.float64], NDArray[np.float64]]:
        """The velocity of one track, but for the cut-off, as a white part and first-order terms.

        Returns
        -------
        white : float
            Two-sided density in m^2/s.
        rates : ndarray, (J,)
            In rad/m, all different.
        weights : ndarray, (J,)
            In m^2/s: ``S(omega) = white + sum weights alpha^2 / (alpha^2 + omega^2)`` with ``alpha = rates V``.

        Raises
        ------
        ValueError
            The road has no such spectrum.
        """
        if self.waviness != 2.0:
            raise ValueError(
                f"the covariance route needs waviness 2, got {self.waviness:g}: no finite state-space model of such a "
                'road exists; take ride_metrics(..., method="spectral")'
            )
        return self.intensity, np.empty(0), np.empty(0)

    def psd(self, n: ArrayLike) -> Any:
        """One-sided displacement spectrum ``G_d(n)`` in m^3 at wavenumbers ``n`` > 0 (cycle/m)."""
        n = _wavenumbers(n)
        low_cut = 1.0 / (1.0 + (self.cutoff / n) ** 2)
        return (self.roughness * (n / REFERENCE_WAVENUMBER) ** -self.waviness * low_cut)[()]

    def coherence(self, n: ArrayLike, track_width: ArrayLike) -> Any:
        """Ratio ``gamma(n) = G_LR(n) / G_d(n)`` of the cross spectrum of two tracks to the spectrum of one.

        For an isotropic surface ``gamma = 2 / Gamma(w/2) (x/2)^(w/2) K_(w/2)(x)`` with ``x = 2 pi n B``, B the track
        width and K the modified Bessel function; ``x K_1(x)`` for waviness 2. It is 1 for identical tracks
        and 0 for independent ones.

        Parameters
        ----------
        n : array_like
            Wavenumbers in cycle/m, > 0.
        track_width : array_like
            B in m.
        """
        return (1.0 - self.incoherence(n, track_width))[()]

    def incoherence(self, n: ArrayLike, track_width: ArrayLike) -> Any:
        """``1 - gamma(n)``, which rules how far two tracks part, with all its digits at low wavenumbers too.

        There ``gamma`` is 1 to rounding, and the leading terms of its series stand in:
        ``1 - gamma = Gamma(1-v)/Gamma(1+v) (x/2)^(2v) - (x/2)^2 / (1-v)`` with ``v = w/2``.
        """
        n, width = np.broadcast_arrays(_wavenumbers(n), np.asarray(track_width, dtype=float))
        if self.tracks != "isotropic":
            return np.full(n.shape, float(self.tracks != "identical"))[()]
        v, half = 0.5 * self.waviness, np.maximum(np.pi * n * width, np.finfo(float).tiny)
        if abs(v - 1.0) < 1e-6:
            series = half**2 * (1.0 - 2.0 * np.euler_gamma - 2.0 * np.log(half))
        else:
            series = gamma(1.0 - v) / gamma(1.0 + v) * half ** (2.0 * v) - half**2 / (1.0 - v)
        near = half < 1e-4
        far = np.where(near, 1.0, half)
        return np.where(near, series, 1.0 - 2.0 / gamma(v) * far**v * kv(v, 2.0 * far))[()]

    def cross_psd(self, n: ArrayLike, track_width: ArrayLike = 0.0, distance: ArrayLike = 0.0) -> Any:
        """One-sided cross spectrum in m^3 of two wheels' profiles, complex.

        ``gamma(n) G_d(n) exp(-j 2 pi n L)``: ``track_width`` apart across the road (0: the same track) and the
        second wheel ``distance`` L behind the first.
        """
        n = _wavenumbers(n)
        across = np.where(np.asarray(track_width) == 0.0, 1.0, self.coherence(n, track_width))
        along = np.exp(-2j * np.pi * n * np.asarray(distance)) if self.delay else 1.0
        return (across * self.psd(n) * along)[()]

    def describe(self) -> str:
        """Say everything about the road in one line."""
        return ", ".join(
            [
                f"G_d(0.1 cycle/m) = {self.roughness:g} m^3",
                f"waviness {self.waviness:g}",
                *([f"cut-off {self.cutoff:g} cycle/m"] if self.cutoff else []),
                f"{self.speed:g} m/s",
                f"{self.tracks} tracks",
                "rear wheels delayed" if self.delay else "no axle delay",
                *([f"under {', '.join(self.wheels)} only"] if self.wheels else []),
            ]
        )


def _wavenumbers(n: ArrayLike) -> NDArray[np.float64]:
    values = np.asarray(n)
    if values.dtype.kind not in "iuf":
        raise TypeError(f"n must be wavenumbers in cycle/m, got {briefly(n)}")
    if not (np.isfinite(values) & (values > 0.0)).all():
        raise ValueError(
            f"n must be finite and > 0 cycle/m, got {values[~(np.isfinite(values) & (values > 0.0))].flat[0]}"
        )
    return values.astype(float)


def _number(name: str, value: Any, need: str) -> float:
    if isinstance(value, (bool, np.bool_)) or not isinstance(value, (int, float, np.integer, np.floating)):
        hint = f"; a class is Road.iso8608({value!r})" if isinstance(value, str) and value in CLASSES else ""
        raise TypeError(f"Road({name}=...) must be a number {need}, got {briefly(value)}{hint}")
    if not np.isfinite(value):
        raise ValueError(f"Road({name}=...) must be finite and {need}, got {briefly(value)}")
    return float(value)


DEFAULT_ROAD = Road.iso8608("B", speed=20.0, tracks="isotropic")
"""The road where none is given: class B at 72 km/h on an isotropic surface, the rear axle delayed.

The study states none. On identical tracks a symmetric car would not roll at all, on independent ones it would roll like
on no surface; an isotropic surface has the coherence that its own spectrum implies.
"""
