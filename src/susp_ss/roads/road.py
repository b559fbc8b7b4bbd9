"""A random road: its spectrum, how fast it passes, and what each wheel sees of it."""

from __future__ import annotations

import copy
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any, ClassVar, Literal, Self, get_args

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike, NDArray
from scipy.special import gamma, k0, kv

from ..quantities import ROAD, Quantity, briefly
from ..vehicles.parameters import checked, lazy
from .first_order import Terms, fit
from .golden_car import mean_index

REFERENCE_WAVENUMBER = 0.1
"""``n0`` of ISO 8608, cycle/m."""

# ISO 8608 classes by their GEOMETRIC MEAN roughness G_d(n0) in m^3; a class's upper limit is twice its mean.
CLASSES = {name: 16e-6 * 4.0**i for i, name in enumerate("ABCDEFGH")}

Tracks = Literal["identical", "independent", "isotropic"]
TRACKS: tuple[Tracks, ...] = get_args(Tracks)

IRI = Quantity("iri", "m/km", "international roughness index", bound="> 0")

# In x = 2 pi n B, where the coherence of two tracks falls from one to zero; and how far, as a factor of the wavenumber,
# a bend of a spectrum reaches.
COHERENCE_BEND = (0.1, 10.0**1.5)
BEND = 10.0

# A rate below this share of x leaves it as it is, to 1e-9.
NEAR = 1e-2


@dataclass(frozen=True)
class Road:
    """A homogeneous Gaussian road, driven over at constant speed.

    The one-sided displacement spectrum is ``G_d(n) = G_d(n0) (n/n0)^-w n^2 / (n^2 + n_c^2) / (1 + (2 pi n L)^2)`` over
    the wavenumber n in cycle/m (ISO 8608, ``n0`` = 0.1 cycle/m). With ``w = 2``, no cut-off and a contact at a point,
    the vertical velocity under a wheel is white, of intensity ``q = 2 pi^2 n0^2 G_d(n0) V``. Other spectra are
    `Road.two_slope` and `Road.from_psd`.

    Parameters
    ----------
    roughness : float, array or DataArray
        ``G_d(n0)`` in m^3, > 0; class B's geometric mean is 64e-6.
    speed : float, array or DataArray
        ``V`` in m/s, > 0.
    waviness : float
        ``w``, between 1 and 4 exclusive.
    cutoff : float, array or DataArray
        Low-wavenumber cut-off ``n_c`` in cycle/m, >= 0.
    tracks : {"identical", "independent", "isotropic"}
        How the left and the right wheel's profile relate. An isotropic surface has the coherence of two parallel
        lines on it, the track width apart; single-track vehicles ignore this.
    delay : bool
        Whether the rear wheels see the profile a wheelbase later, or at the same instant as the front.
    wheels : sequence of str, optional
        Only these wheels see the road, the others a flat one; all of them when None.
    contact_length : float
        ``L`` in m, >= 0, over which a tyre levels the road out: a first-order low-pass at ``V / L``.
    table : tuple of (float, float)
        Points of a spectrum with bends, as `Road.two_slope` and `Road.from_psd` make it.

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

    roughness: Any = 64e-6
    speed: Any = 20.0
    waviness: Any = 2.0
    cutoff: Any = 0.0
    tracks: Tracks = "identical"
    delay: bool = True
    wheels: tuple[str, ...] | None = None
    contact_length: float = 0.0
    table: tuple[tuple[float, float], ...] = ()

    weighting: ClassVar[Any] = None

    def __post_init__(self) -> None:
        for name, quantity in ROAD.items():
            value, where = getattr(self, name), f"Road({name}=...)"
            if isinstance(value, str) and value in CLASSES:
                raise TypeError(f"{where} got {value!r}; a class is Road.iso8608({value!r})")
            object.__setattr__(self, name, checked(value, where, quantity))
        # As JSON gives them back, rows are lists.
        object.__setattr__(self, "table", tuple((float(n), float(G)) for n, G in self.table))
        ends = tuple(self.waviness) if isinstance(self.waviness, (tuple, list)) else (self.waviness,)
        ends = tuple(_number("waviness", value, "> 1 and < 4") for value in ends)
        if not all(1.0 < value < 4.0 for value in ends) or len(ends) != (2 if self.table else 1):
            raise ValueError(f"Road(waviness=...) must be > 1 and < 4, got {briefly(self.waviness)}")
        object.__setattr__(self, "waviness", ends if self.table else ends[0])
        contact_length = _number("contact_length", self.contact_length, ">= 0 m")
        if contact_length < 0.0:
            raise ValueError(f"Road(contact_length=...) must be >= 0 m, got {briefly(contact_length)}")
        object.__setattr__(self, "contact_length", contact_length)
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

    @classmethod
    def two_slope(
        cls,
        roughness: Any = 64e-6,
        waviness: tuple[float, float] = (2.0, 1.5),
        knee: float = 0.16,
        **parameters: Any,
    ) -> Road:
        """Return a road whose spectrum falls by one exponent below a wavenumber and by another above it.

        Parameters
        ----------
        roughness : float, array or DataArray
            ``G_d(n0)`` in m^3, > 0, at ``n0`` = 0.1 cycle/m on whichever side of the knee.
        waviness : (float, float)
            Exponents below and above the knee, between 1 and 4 exclusive.
        knee : float
            In cycle/m, > 0.
        **parameters
            Any other parameter of `Road`.

        Notes
        -----
        The covariance route takes first-order terms in place of the spectrum; they round the knee. `Road.fit_error`
        tells by how much at most.

        Examples
        --------
        >>> from susp_ss import Road
        >>> road = Road.two_slope(64e-6, waviness=(3.0, 2.0), knee=0.2)
        >>> (road.psd([0.1, 0.2, 0.4]) / 64e-6).round(6).tolist()
        [1.0, 0.125, 0.03125]
        """
        knee = _number("knee", knee, "> 0 cycle/m")
        if not knee > 0.0:
            raise ValueError(f"Road.two_slope(knee=...) must be > 0 cycle/m, got {briefly(knee)}")
        if not isinstance(waviness, Sequence) or len(waviness) != 2:
            raise ValueError(f"Road.two_slope(waviness=...) must be two exponents, got {briefly(waviness)}")
        exponent = waviness[0] if knee >= REFERENCE_WAVENUMBER else waviness[1]
        table = ((knee, float((knee / REFERENCE_WAVENUMBER) ** -exponent)),)
        return cls(roughness=roughness, waviness=tuple(waviness), table=table, **parameters)

    @classmethod
    def from_psd(
        cls, wavenumber: ArrayLike, psd: ArrayLike, waviness: float | tuple[float, float] = 2.0, **parameters: Any
    ) -> Road:
        """Return the road of a measured spectrum.

        Between its points the spectrum is interpolated in logarithms; beyond them it goes on from the first and the
        last value as a power of the wavenumber. The roughness ``G_d(0.1 cycle/m)`` is read off it.

        Parameters
        ----------
        wavenumber : array_like, (P,)
            In cycle/m, > 0, rising; at least two.
        psd : array_like, (P,)
            One-sided displacement spectrum in m^3, > 0.
        waviness : float or (float, float)
            Exponents below the first and above the last point.
        **parameters
            Any other parameter of `Road`, but the roughness.

        Raises
        ------
        TypeError, ValueError
            No numbers, not two equal rows of them, not positive or not rising.

        Notes
        -----
        The covariance route takes first-order terms in place of the spectrum, by least squares of the relative error:
        they smooth what is narrower than an octave. `Road.fit_error` tells by how much at most.

        Examples
        --------
        >>> import numpy as np
        >>> from susp_ss import Road
        >>> n = np.geomspace(0.011, 2.83, 9)
        >>> road = Road.from_psd(n, 64e-6 * (n / 0.1) ** -2)
        >>> bool(np.isclose(road.roughness, 64e-6)), bool(np.isclose(road.psd(10.0), 64e-10))
        (True, True)
        """
        if "roughness" in parameters:
            raise ValueError("Road.from_psd reads the roughness off the spectrum; scale psd in place of it")
        n, G = (np.asarray(row) for row in (wavenumber, psd))
        for name, row, unit in (("wavenumber", n, "cycle/m"), ("psd", G, "m^3")):
            if row.dtype.kind not in "iuf" or row.ndim != 1:
                raise TypeError(f"Road.from_psd({name}=...) must be one row of numbers in {unit}, got {briefly(row)}")
            if len(row) < 2 or not (np.isfinite(row) & (row > 0.0)).all():
                raise ValueError(
                    f"Road.from_psd({name}=...) must be two or more finite numbers > 0 {unit}, got {briefly(row)}"
                )
        if n.shape != G.shape or not (np.diff(n) > 0.0).all():
            raise ValueError(
                "Road.from_psd needs rising wavenumbers and one value of the spectrum at each, got "
                f"{len(n)} wavenumbers{'' if (np.diff(n) > 0.0).all() else ' that do not rise'} and {len(G)} values"
            )
        ends = tuple(waviness) if isinstance(waviness, Sequence) else (waviness, waviness)
        raw = cls(waviness=ends, table=tuple(zip(n.tolist(), G.tolist(), strict=True)))
        roughness = float(raw.shape(np.array(REFERENCE_WAVENUMBER)))
        table = tuple(zip(n.tolist(), (G / roughness).tolist(), strict=True))
        return cls(roughness=roughness, waviness=ends, table=table, **parameters)

    @classmethod
    def from_iri(cls, iri: Any, waviness: float = 2.0, **parameters: Any) -> Road:
        """Return the road whose mean international roughness index is given.

        The index grows as the square root of the roughness; `susp_ss.mean_iri` is the way back.

        Parameters
        ----------
        iri : float, array or DataArray
            In m/km, > 0.
        waviness : float
            Between 1 and 4 exclusive.
        **parameters
            Any other parameter of `Road`, but the roughness.

        Examples
        --------
        >>> from susp_ss import Road, mean_iri
        >>> road = Road.from_iri(2.5, waviness=2.2, speed=25.0)
        >>> f"{road.roughness:.3g} m^3, {mean_iri(road):.3f} m/km"
        '2.64e-05 m^3, 2.500 m/km'
        """
        if "roughness" in parameters:
            raise ValueError("Road.from_iri finds the roughness; pass Road(roughness=...) instead of an index")
        iri = checked(iri, "Road.from_iri(iri=...)", IRI)
        unit = cls(roughness=1.0, waviness=waviness, **parameters)
        return cls(roughness=(iri / mean_index(unit)) ** 2, waviness=waviness, **parameters)

    @property
    def intensity(self) -> Any:
        """``q`` of the white vertical velocity, ``E[w(t) w(t')] = q delta(t - t')``, in m^2/s (waviness 2).

        Its one-sided density is twice this, ``4 pi^2 n0^2 G_d(n0) V``.
        """
        return 2.0 * np.pi**2 * REFERENCE_WAVENUMBER**2 * self.roughness * self.speed

    @property
    def slopes(self) -> tuple[float, float]:
        """Exponents of the surface's spectrum at its low and high end: ``G_d`` falls as ``n^-w``."""
        return self.waviness if isinstance(self.waviness, tuple) else (self.waviness, self.waviness)

    @property
    def velocity_is_bounded(self) -> bool:
        """Whether the vertical velocity under a wheel has a finite variance: from waviness 3 on, or with a contact."""
        exact = self.standard().exact_terms()
        if (exact is not None and exact[0] == 0.0) or (self.weighting is not None and self.weighting.strictly_proper):
            return True
        return self.slopes[1] > 3.0 or self.contact_length > 0.0

    @property
    def scale_free(self) -> bool:
        """Whether the spectrum is a power of the wavenumber, so that speed only scales it in time."""
        return not np.any(self.cutoff) and self.power_law and not self.contact_length

    @property
    def power_law(self) -> bool:
        """Whether the surface, before cut-off and contact, is a power of the wavenumber."""
        return not self.table and type(self).psd is Road.psd and type(self).shape is Road.shape

    @property
    def bends(self) -> tuple[tuple[float, float], ...]:
        """Ranges of wavenumbers, in cycle/m, in which the surface's spectrum is no power of the wavenumber."""
        return ((self.table[0][0] / BEND, self.table[-1][0] * BEND),) if self.table else ()

    @property
    def fit_error(self) -> float:
        """Largest relative error of the first-order terms that stand for one track's spectrum; 0 where they are it."""
        standard = self.standard()
        return 0.0 if standard.exact_terms() is not None else track_terms(standard).error

    def standard(self) -> Road:
        """The same surface with unit roughness and speed, and nothing between it and a wheel."""
        standard = self.mapped(lambda _: 1.0)
        plain: dict[str, Any] = {"cutoff": 0.0, "contact_length": 0.0, "tracks": "isotropic", "delay": True}
        for name, value in {**plain, "wheels": None, "weighting": None}.items():
            object.__setattr__(standard, name, value)
        return standard

    def leaves(self) -> list[Any]:
        """The parameters that a design may set."""
        return [getattr(self, name) for name in ROAD]

    def mapped(self, function: Callable[[Any], Any]) -> Self:
        """The same road with a function applied to what a design may set, unchecked."""
        mapped = object.__new__(type(self))
        for name, value in vars(self).items():
            object.__setattr__(mapped, name, function(value) if name in ROAD else value)
        return mapped

    def weighted(self, weighting: Any) -> Self:
        """The road as an output sees it through a filter: a filter on the output may as well stand on the road."""
        weighted = copy.copy(self)
        object.__setattr__(weighted, "weighting", weighting)
        return weighted

    def select(self, designs: slice | NDArray[np.int_]) -> Self:
        """The road of some of the designs, of one with numbers or arrays over the designs."""
        some = self.mapped(lambda x: x[designs] if isinstance(x, np.ndarray) else x)
        return some if self.weighting is None else some.weighted(self.weighting.select(designs))

    def one(self, design: int) -> Self:
        """The road of one of the designs, as numbers."""
        return self.mapped(lambda x: float(x[design]) if isinstance(x, np.ndarray) else x)

    @property
    def lazy(self) -> bool:
        """Whether some parameter's values are computed later."""
        return any(map(lazy, self.leaves()))

    def single(self, what: str) -> None:
        """Say when a road has arrays where one number is needed.

        Raises
        ------
        ValueError
            It has.
        """
        if any(isinstance(x, (np.ndarray, xr.DataArray)) for x in self.leaves()):
            raise ValueError(f"{what} needs a road with one speed, roughness and cutoff, got arrays")

    def first_order(self) -> tuple[Any, NDArray[np.float64], NDArray[np.float64]] | None:
        """The velocity of one track as a white part and first-order terms, where it is such: for waviness 2.

        Cut-off and contact are left out.

        Returns
        -------
        white : float
            Two-sided density in m^2/s.
        rates : ndarray, (J,)
            In rad/m, all different.
        weights : ndarray, (J,)
            In m^2/s: ``S(omega) = white + sum weights alpha^2 / (alpha^2 + omega^2)`` with ``alpha = rates V``.

        None for any other spectrum, which is fitted.
        """
        if not self.table and self.waviness == 2.0:
            return self.intensity, np.empty(0), np.empty(0)
        return None

    def exact_terms(self) -> tuple[Any, NDArray[np.float64], NDArray[np.float64]] | None:
        """What `first_order` says, unless it is not that of this kind of road, which has another `psd`."""
        own = type(self).psd is Road.psd and type(self).shape is Road.shape
        return self.first_order() if own or type(self).first_order is not Road.first_order else None

    def shape(self, n: NDArray[np.float64]) -> NDArray[np.float64]:
        """The surface's spectrum over its value at 0.1 cycle/m: powers of n between the points of a table."""
        if not self.table:
            return np.asarray((n / REFERENCE_WAVENUMBER) ** -self.waviness)
        at, values = np.log(self.table).T
        below, above = self.slopes
        u = np.log(n)
        inside = np.interp(u, at, values)
        beyond = -below * np.minimum(u - at[0], 0.0) - above * np.maximum(u - at[-1], 0.0)
        return np.asarray(np.exp(inside + beyond))

    def psd(self, n: ArrayLike) -> Any:
        """One-sided displacement spectrum ``G_d(n)`` in m^3 at wavenumbers ``n`` > 0 (cycle/m)."""
        n = _wavenumbers(n)
        between = 1.0 / (1.0 + (self.cutoff / n) ** 2) / (1.0 + (2.0 * np.pi * n * self.contact_length) ** 2)
        return (self.roughness * self.shape(n) * between)[()]

    def coherence(self, n: ArrayLike, track_width: ArrayLike) -> Any:
        """Ratio ``gamma(n) = G_LR(n) / G_d(n)`` of the cross spectrum of two tracks to the spectrum of one.

        For an isotropic surface ``gamma = 2 / Gamma(w/2) (x/2)^(w/2) K_(w/2)(x)`` with ``x = 2 pi n B``, B the track
        width and K the modified Bessel function; ``x K_1(x)`` for waviness 2. A spectrum with bends is taken apart
        into first-order terms ``1 / (n^2 + a^2)``, whose cross spectrum is ``y K_1(y)`` times themselves with ``y = 2
        pi B sqrt(n^2 + a^2)``. It is 1 for identical tracks and 0 for independent ones.

        Parameters
        ----------
        n : array_like
            Wavenumbers in cycle/m, > 0.
        track_width : array_like
            B in m.
        """
        return (1.0 - self.incoherence(n, track_width))[()]

    def incoherence(self, n: ArrayLike, track_width: ArrayLike) -> Any:
        """``1 - gamma(n)``, which rules how far two tracks part, with all its digits at low wavenumbers too."""
        n, width = np.broadcast_arrays(_wavenumbers(n), np.asarray(track_width, dtype=float))
        if self.tracks != "isotropic":
            return np.full(n.shape, float(self.tracks != "identical"))[()]
        x = 2.0 * np.pi * n * width
        return (_apart_by_terms(track_terms(self.standard()), x, width) if self.table else _apart(x, self.waviness))[()]

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
        below, above = self.slopes
        if not self.table:
            surface = f"waviness {below:g}"
        elif len(self.table) == 1:
            surface = f"waviness {below:g} up to {self.table[0][0]:g} cycle/m and {above:g} beyond"
        else:
            surface = (
                f"measured at {len(self.table)} wavenumbers from {self.table[0][0]:g} to {self.table[-1][0]:g} cycle/m,"
                f" waviness {below:g} below and {above:g} above"
            )
        return ", ".join(
            [
                f"G_d(0.1 cycle/m) = {_span(self.roughness)} m^3",
                surface,
                *([f"cut-off {_span(self.cutoff)} cycle/m"] if np.any(self.cutoff) else []),
                f"{_span(self.speed)} m/s",
                f"{self.tracks} tracks",
                "rear wheels delayed" if self.delay else "no axle delay",
                *([f"contact over {self.contact_length:g} m"] if self.contact_length else []),
                *([f"under {', '.join(self.wheels)} only"] if self.wheels else []),
            ]
        )


@cache
def track_terms(standard: Road) -> Terms:
    """First-order terms of one track's velocity, over ``x = 2 pi n`` in rad/m, of a standard road."""
    return velocity_terms(standard, 0, 1.0)


@cache
def velocity_terms(standard: Road, sign: int, width: float) -> Terms:
    """First-order terms over ``x = 2 pi n width`` of a standard road's two-sided velocity spectrum.

    Of one track (``sign`` 0), of the mean of two tracks a width (m) apart (1), or of their half difference (-1).
    """
    over = 2.0 * np.pi * width

    def density(x: NDArray[np.float64]) -> NDArray[np.float64]:
        n = x / over
        velocity = 2.0 * np.pi**2 * n**2 * standard.psd(n)
        if not sign:
            return np.asarray(velocity)
        apart = standard.incoherence(n, width)
        return np.asarray(velocity * (0.5 * apart if sign < 0 else 1.0 - 0.5 * apart))

    bends = [(over * low, over * high) for low, high in standard.bends]
    return fit(density, [*bends, *([COHERENCE_BEND] if sign else [])])


def _apart(x: NDArray[np.float64], waviness: float) -> NDArray[np.float64]:
    """``1 - gamma`` of an isotropic surface whose spectrum is a power of the wavenumber.

    At low x gamma is 1 to rounding, and the leading terms of its series stand in:
    ``1 - gamma = Gamma(1-v)/Gamma(1+v) (x/2)^(2v) - (x/2)^2 / (1-v)`` with ``v = w/2``.
    """
    v, half = 0.5 * waviness, np.maximum(0.5 * x, np.finfo(float).tiny)
    if abs(v - 1.0) < 1e-6:
        series = half**2 * (1.0 - 2.0 * np.euler_gamma - 2.0 * np.log(half))
    else:
        series = gamma(1.0 - v) / gamma(1.0 + v) * half ** (2.0 * v) - half**2 / (1.0 - v)
    near = half < 1e-4
    far = np.where(near, 1.0, half)
    return np.where(near, series, 1.0 - 2.0 / gamma(v) * far**v * kv(v, 2.0 * far))


def _apart_by_terms(terms: Terms, x: NDArray[np.float64], width: NDArray[np.float64]) -> NDArray[np.float64]:
    """``1 - gamma`` of an isotropic surface whose velocity spectrum is a list of first-order terms over x / width."""
    x, a = x[..., None], terms.rates * width[..., None]
    y = np.sqrt(x**2 + a**2)
    one, other = _apart(x, 2.0), _apart(y, 2.0)
    # Where they are nearly the same, their difference by its derivative, d(z K_1(z)) = -K_0(z) d(z^2) / 2.
    less = np.where(a < NEAR * x, -0.5 * a**2 * k0(np.sqrt(x**2 + 0.5 * a**2)), one - other)
    # Of a low-pass the term at rate zero less that at its own rate, written so that neither swamps the difference.
    low = (a**2 * one + x**2 * less) / y**2
    parted = terms.level * one[..., 0] + (terms.low * low + terms.high * x**2 * other / y**2).sum(axis=-1)
    whole = terms.level + ((terms.low * a**2 + terms.high * x**2) / y**2).sum(axis=-1)
    return np.asarray(parted / whole)


def _span(value: Any) -> str:
    """One number, or the range of several."""
    if lazy(value):
        return f"{value.size} values of"
    values = np.asarray(value)
    return f"{values:g}" if not values.ndim else f"{values.min():g} to {values.max():g}"


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
