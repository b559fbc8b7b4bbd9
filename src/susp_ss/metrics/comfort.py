"""What a ride is worth to the people in it, by ISO 2631-1 and the European directive 2002/44/EC."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
import pandas as pd
import xarray as xr

from ..quantities import METRICS, Quantity, briefly, positive, titled
from ..responses.excitation import check_kinds
from ..responses.simulation import simulate
from ..roads.road import Road
from ..vehicles.contract import RoadVehicle
from .ride import ride_metrics
from .vibration import rms, running_rms, vdv, weighted
from .weightings import filter_of, filters, say_weightings


class Axis(NamedTuple):
    """How a direction counts on a seat: its weighting, and the factor k of its root mean square in the total value."""

    weighting: str
    k: float


AXES = {"bacc": Axis("Wk", 1.0), "roll_acc": Axis("We", 0.63), "pitch_acc": Axis("We", 0.4)}
"""Seated persons, comfort (ISO 2631-1:1997, table 1 and 8.2.2.1); k of rotations in m/rad."""

REACTIONS = (
    ("not uncomfortable", 0.0, 0.315),
    ("a little uncomfortable", 0.315, 0.63),
    ("fairly uncomfortable", 0.5, 1.0),
    ("uncomfortable", 0.8, 1.6),
    ("very uncomfortable", 1.25, 2.5),
    ("extremely uncomfortable", 2.0, np.inf),
)
"""Likely reactions to total values in m/s^2, which overlap (ISO 2631-1:1997, C.2.3)."""

DAY = 8.0 * 3600.0
"""The time in s to which a daily exposure A(8) refers."""

A8 = {"action": 0.5, "limit": 1.15}
VDV = {"action": 9.1, "limit": 21.0}
"""Exposure action and limit values of a day, in m/s^2 and m/s^1.75 (2002/44/EC, article 3)."""

GAUSSIAN, ESTIMATED = 3.0**0.25, 1.4
"""VDV over root mean square and fourth root of time: of a Gaussian ride, and as ISO 2631-1 estimates it."""

CREST, MTVV_RATIO, VDV_RATIO = 9.0, 1.5, 1.75
"""Above these a root mean square underestimates shocks: peak and MTVV over it, VDV over it and fourth root of time."""

TIMES = {
    f"{dose}_{value}_time": Quantity(
        f"{dose}_{value}_time", "s", f"exposure a day that reaches the {value} value of {word}, 2002/44/EC"
    )
    for dose, word in (("a8", "A(8)"), ("vdv", "VDV"))
    for value in ("action", "limit")
}

VALUES = {
    quantity.name: quantity
    for quantity in (
        Quantity("total", "m/s^2", "vibration total value, k-weighted root sum of squares"),
        Quantity("reaction", "", "likely reaction to the total value, ISO 2631-1 C.2.3"),
        Quantity("vdv", "m/s^1.75", "vibration dose value of the exposure, vertical"),
        Quantity("evdv", "m/s^1.75", "estimated vibration dose value, 1.4 a_w T^(1/4), vertical"),
        Quantity("msdv", "m/s^1.5", "motion sickness dose value of the exposure, Wf, vertical"),
        Quantity("a8", "m/s^2", "daily exposure A(8), vertical"),
        *TIMES.values(),
        Quantity("mtvv", "m/s^2", "maximum transient vibration value, 1 s, vertical"),
        Quantity("crest_factor", "", "peak over RMS of the weighted vertical acceleration"),
    )
}
"""Variables of `comfort` beside the weighted accelerations, in their order."""


@dataclass(frozen=True, eq=False)
class Comfort:
    """What `comfort` found.

    Attributes
    ----------
    vehicle : Vehicle
        Whose ride it is.
    road : Road or xarray.Dataset
        What it runs over.
    points : dict
        Points of the body that were asked for.
    speed : float or None
        On a profile, in m/s.
    duration : float
        Of the exposure, in s.
    weighting : dict
        Of each acceleration.
    metrics : xarray.Dataset
        The values, on the dims of a sweep and on point.
    """

    vehicle: RoadVehicle
    road: Road | xr.Dataset
    points: dict[str, tuple[float, float]]
    speed: float | None
    duration: float
    weighting: dict[str, Any]
    metrics: xr.Dataset

    @property
    def table(self) -> pd.DataFrame:
        """One row a design and point."""
        if self.metrics.dims:
            return self.metrics.to_dataframe()
        return pd.DataFrame({name: [data.item()] for name, data in self.metrics.items()})

    def describe(self) -> str:
        """Say in one line what was driven over what, and for how long."""
        kind = type(self.vehicle).__name__
        if isinstance(self.road, Road):
            return f"{kind} on {self.road.describe()}; {spell_time(self.duration)} of exposure"
        x = self.road["x"].values
        return (
            f"{kind} on a profile of {x[-1] - x[0]:g} m at {self.speed:g} m/s; {spell_time(self.duration)} of exposure"
        )

    def __repr__(self) -> str:
        total = self.metrics["total"]
        low, high = float(total.min()), float(total.max())
        span = f"{low:.3g}" if low == high else f"{low:.3g} to {high:.3g}"
        words = f", {self.metrics['reaction'].item()}" if total.size == 1 else ""
        return f"Comfort: {self.describe()}; total value {span} m/s^2{words}"

    def _repr_html_(self) -> str:
        named = {name: titled(str(name), data.attrs["units"]) for name, data in self.metrics.items()}
        return self.table.rename(columns=named).to_html(float_format="{:.4g}".format)


def comfort(
    vehicle: RoadVehicle,
    road: Road | xr.Dataset,
    *,
    points: Mapping[str, tuple[float, float]] | None = None,
    weighting: Mapping[str, Any] | None = None,
    duration: float | None = None,
    speed: float | None = None,
    step: float | None = None,
) -> Comfort:
    """Comfort, dose and permitted exposure of a ride, by ISO 2631-1:1997 and 2002/44/EC.

    On a `Road` all of it is exact: the ride is Gaussian, so that a weighted root mean square ``a_w`` says everything,
    the vibration dose too, ``VDV = (3 T)^(1/4) a_w``. On a profile, measured, synthesised or an obstacle, the vehicle
    is simulated and its records go through the same weightings.

    Parameters
    ----------
    vehicle : Vehicle
        Any of the models, with seats or without. On a `Road`, parameters may be arrays; on a profile, curves are taken
        as they are.
    road : Road or xarray.Dataset
        A random road, whose speed and roughness may be arrays, or a profile, of `read_profile`, `synthesise` or
        `obstacle`: ``left`` and ``right`` (m) on ``x`` (m).
    points : mapping of str to (x, y), optional
        Points of the body, as in `ride_metrics`.
    weighting : mapping of str, optional
        Other weightings than the standard's for a seat, by output: ``{"bacc": "Wb"}`` for BS 6841. Without: ``Wk`` for
        ``bacc``, ``We`` for ``roll_acc`` and ``pitch_acc``.
    duration : float, optional
        Exposure in s, of a day or a ride. Without: 8 h on a `Road`, on a profile what one run over it takes. A profile
        is met again and again in a longer one.
    speed, step : float, optional
        On a profile, as in `simulate`.

    Returns
    -------
    Comfort
        Its ``metrics``, a Dataset on the dims of a sweep and on point:

        ``bacc`` (m/s^2), ``roll_acc`` and ``pitch_acc`` (rad/s^2)
            weighted root mean squares ``a_w``, where the vehicle has them;
        ``total``
            vibration total value ``sqrt(sum k^2 a_w^2)`` in m/s^2 with k = 1, 0.63 and 0.4 m/rad (8.2.2.1), and
            ``reaction``, the standard's words for it (C.2.3), two where they overlap;
        ``vdv`` and ``evdv``
            vibration dose value of the vertical acceleration, and its estimate ``1.4 a_w T^(1/4)``, in m/s^1.75;
        ``msdv``
            motion sickness dose value ``sqrt(int a^2 dt)`` by ``Wf``, in m/s^1.5; a third of it is about the percentage
            of unadapted adults who vomit (annex D);
        ``a8``
            daily exposure ``a_w sqrt(T / 8 h)`` in m/s^2, and ``a8_action_time``, ``a8_limit_time``,
            ``vdv_action_time``, ``vdv_limit_time``: the exposure in s that reaches 0.5 and 1.15 m/s^2, 9.1 and
            21 m/s^1.75. The directive takes the greatest axis, 1.4 times it if horizontal; what these models know of a
            seat is its vertical axis;
        ``mtvv`` (m/s^2), ``crest_factor``
            on a profile: greatest running root mean square over 1 s, and peak over root mean square.

    Raises
    ------
    TypeError, ValueError
        As `ride_metrics` or `simulate`; a vehicle without ``bacc``, a weighting of another output, no duration > 0, a
        speed or step beside a `Road`.

    Examples
    --------
    >>> import susp_ss as ss
    >>> ride = ss.comfort(ss.FullCar(), ss.Road.iso8608("C", tracks="isotropic"), points={"driver": (0.3, 0.4)})
    >>> driver = ride.metrics.sel(point="driver")
    >>> print(f"{float(driver.total):.2f} m/s^2: {driver.reaction.item()}")
    1.19 m/s^2: uncomfortable
    >>> print(f"{float(driver.a8_action_time) / 60.0:.0f} min to the action value")
    88 min to the action value

    A bump of 5 cm, once:

    >>> shock = ss.comfort(ss.QuarterCar(), ss.obstacle("bump", height=0.05), speed=10.0)
    >>> bool(shock.metrics.crest_factor > 3.0)
    True
    """
    check_kinds(vehicle)
    if not isinstance(road, (Road, xr.Dataset)):
        raise TypeError(f"road must be a Road, or a profile with left and right on x, got {briefly(road)}")
    car = vehicle if points is None else vehicle.with_points(points)
    filtering = _filtering(car, weighting)
    seconds = None if duration is None else positive("duration", duration, "s")
    if isinstance(road, xr.Dataset):
        values, seconds = _on_profile(car, road, filtering, seconds, speed, step)
    else:
        if speed is not None or step is not None:
            raise ValueError("speed and step are for a profile, a Dataset with left and right on x; a Road has its own")
        seconds = DAY if seconds is None else seconds
        values = _on_road(car, road, filtering, seconds)
    judged = _judged(values, filtering, seconds)
    return Comfort(vehicle, road, dict(points or {}), speed, seconds, filtering, judged)


def reaction(total: xr.DataArray) -> xr.DataArray:
    """The standard's words for total values in m/s^2, joined by "or" where bands overlap."""
    edges = np.unique([edge for _, *ends in REACTIONS for edge in ends])[1:-1]
    words = np.array([in_words(at) for at in (0.0, *edges)])
    named: xr.DataArray = xr.apply_ufunc(
        lambda values: words[np.digitize(values, edges)], total, dask="parallelized", output_dtypes=[words.dtype]
    )
    return named


def in_words(total: float) -> str:
    """The same of one total value in m/s^2.

    Examples
    --------
    >>> from susp_ss.metrics.comfort import in_words
    >>> in_words(0.4), in_words(0.55)
    ('a little uncomfortable', 'a little uncomfortable or fairly uncomfortable')
    """
    return " or ".join(word for word, low, high in REACTIONS if low <= total < high)


def doubtful(metrics: xr.Dataset) -> xr.DataArray:
    """Where shocks make a weighted root mean square alone too little (ISO 2631-1:1997, 6.2 and 6.3.3).

    Nowhere on a `Road`: there the ratio of the dose is 1.316.
    """
    a_w, seconds = metrics.bacc, metrics.attrs["duration"]
    dosed = metrics["vdv"] > VDV_RATIO * seconds**0.25 * a_w
    if "mtvv" not in metrics:
        return dosed
    return dosed | (metrics.mtvv > MTVV_RATIO * a_w) | (metrics.crest_factor > CREST)


def spell_time(seconds: float) -> str:
    """A time as people say it.

    Examples
    --------
    >>> from susp_ss.metrics.comfort import spell_time
    >>> spell_time(28800.0), spell_time(5400.0), spell_time(3.21), spell_time(1e6)
    ('8 h', '1 h 30 min', '3.21 s', '> 24 h')
    """
    if seconds > 3.0 * DAY:
        return "> 24 h"
    if seconds < 60.0:
        return f"{seconds:.3g} s"
    hours, minutes = divmod(round(seconds / 60.0), 60)
    return " ".join(f"{n} {unit}" for n, unit in ((hours, "h"), (minutes, "min")) if n)


def _filtering(vehicle: RoadVehicle, weighting: Any) -> dict[str, Any]:
    """Weighting of each acceleration that the vehicle has."""
    layout = vehicle.layout()
    available = {name: axis.weighting for name, axis in AXES.items() if name in layout.variables}
    if "bacc" not in available:
        raise ValueError(
            f"comfort needs a vertical acceleration, an output bacc or bacc_..., got {', '.join(layout.variables)}"
        )
    if weighting is None:
        return available
    if not isinstance(weighting, Mapping):
        raise TypeError(f'weighting must be by output, such as {{"bacc": "Wb"}}, got {briefly(weighting)}')
    for name, one in weighting.items():
        if name not in available:
            raise ValueError(f"weighting: no acceleration named {briefly(name)}, available: {', '.join(available)}")
        filter_of(one, f"weighting of {name}")
    return available | dict(weighting)


def _on_road(vehicle: RoadVehicle, road: Road, filtering: Mapping[str, Any], seconds: float) -> xr.Dataset:
    values = ride_metrics(vehicle, road, weighting=filtering)[list(filtering)]
    sick = ride_metrics(vehicle, road, weighting={"bacc": "Wf"}).bacc
    return values.assign(vdv=GAUSSIAN * seconds**0.25 * values.bacc, msdv=np.sqrt(seconds) * sick)


def _on_profile(
    vehicle: RoadVehicle,
    profile: xr.Dataset,
    filtering: Mapping[str, Any],
    seconds: float | None,
    speed: float | None,
    step: float | None,
) -> tuple[xr.Dataset, float]:
    """The values, and the exposure in s, one run if it is not given."""
    history = simulate(vehicle, profile, speed=speed, step=step)
    t = history.time.values
    run = float(t[-1] - t[0])
    seconds = run if seconds is None else seconds

    def reduced(name: str, numbers: Any) -> xr.DataArray:
        long_name = f"RMS {METRICS[name].meaning}"
        return history[name].isel(time=0, drop=True).copy(data=numbers).assign_attrs(long_name=long_name)

    records = {name: weighted(history[name], t, one) for name, one in filtering.items()}
    values = xr.Dataset({name: reduced(name, rms(record, t)) for name, record in records.items()})
    say_weightings(values, filters(filtering, vehicle.layout()))
    up, sick = records["bacc"], weighted(history.bacc, t, "Wf")
    values = values.assign(
        vdv=reduced("bacc", vdv(up, t) * (seconds / run) ** 0.25),
        msdv=reduced("bacc", rms(sick, t) * np.sqrt(seconds)),
        mtvv=reduced("bacc", running_rms(up, t).max(axis=-1)),
        crest_factor=reduced("bacc", np.abs(up).max(axis=-1)) / values.bacc.where(values.bacc > 0.0),
    )
    return values, seconds


def _judged(values: xr.Dataset, filtering: Mapping[str, Any], seconds: float) -> xr.Dataset:
    """With what follows from weighted root mean squares and doses, in order and with units."""
    total = sum((AXES[name].k * values[name]) ** 2 for name in filtering) ** 0.5
    a8 = values.bacc * np.sqrt(seconds / DAY)
    with np.errstate(divide="ignore"):  # On a level road no exposure is too long.
        times = {f"a8_{value}_time": seconds * (A8[value] / a8) ** 2 for value in A8}
        times |= {f"vdv_{value}_time": seconds * (VDV[value] / values["vdv"]) ** 4 for value in VDV}
    evdv = ESTIMATED * seconds**0.25 * values.bacc
    values = values.assign(total=total, reaction=reaction(total), evdv=evdv, a8=a8, **times)
    for name, quantity in VALUES.items():
        if name in values:
            values[name].attrs = {"units": quantity.unit, "long_name": quantity.meaning}
    values.attrs["duration"] = seconds
    return values[[*filtering, *(name for name in VALUES if name in values)]]
