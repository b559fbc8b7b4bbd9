"""How every ride metric changes with every parameter, exactly."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from ..quantities import SHIFT, briefly
from ..responses.covariance.implicit import Following, as_settings, curved_rates, followed
from ..responses.covariance.linearisation import linearise
from ..responses.covariance.routes import covariance_variances
from ..responses.covariance.tangents import Tangents, variance_tangents
from ..responses.excitation import check_kinds, spanned
from ..responses.labels import labelled_outputs, shifted
from ..responses.settings import Setting, settable
from ..roads.road import Road
from ..vehicles.vehicle import Vehicle
from .weightings import filters, rows_behind, say_weightings

# Designs differentiated together: few enough to stay near the processor with all their tangents.
BATCH = 64


def sensitivity(
    vehicle: Vehicle,
    road: Road,
    parameters: Sequence[str] = ("ks", "cs"),
    *,
    weighting: Any = None,
    points: Mapping[str, tuple[float, float]] | None = None,
) -> xr.Dataset:
    """Derivatives of the ride metrics with respect to parameters, exact to rounding.

    With ``A X + X A^T + Q = 0`` for the covariance X and ``s = y X y^T`` for a variance,
    ``ds = 2 dy X y^T + y dX y^T`` and ``A dX + dX A^T + (dA X + X dA^T + dQ) = 0``: the equation of X itself with
    another right-hand side, so that one inverse serves all parameters. ``dQ`` includes the derivatives of the
    wheelbase delay's ``e^(A tau)``. (The adjoint equation would need one right-hand side for each output, of
    which a car has 19, in place of one for each parameter.)

    Parameters
    ----------
    vehicle : Vehicle
        Any of the models, or a sweep of one.
    road : Road
    parameters : sequence of str
        Fields of the vehicle; of a field that a corner may have for itself, ``"ks"`` is a common change at all corners,
        ``"ks_front"`` at those of an axle and ``"ks_fr"`` at one; of a curve its rate for small motion, which scales a
        `DamperCurve` and exchanges the main spring of a `SpringCurve`. And ``"speed"``, ``"roughness"`` or (if there is
        one) ``"cutoff"`` of the road.
    weighting, points
        As in `ride_metrics`.

    Returns
    -------
    xarray.Dataset
        The variables of `ride_metrics`, on (sweep..., parameter, point or corner): each in the metric's own unit per
        unit of the parameter, which the coordinate ``unit`` along ``parameter`` tells. NaN where there is no
        derivative: of a metric that is infinite, or becomes so with the parameter (tyre load with tyre damping); and
        of an RMS that is zero by symmetry where the parameter breaks that symmetry, as it grows like ``abs`` there.

    Raises
    ------
    TypeError, ValueError
        Parameters that are no sequence of different, known names; and what `ride_metrics` refuses.

    Notes
    -----
    One parameter costs a little more than one solution of the general covariance equation and each further one about
    a third of that, at any speed: with four parameters 0.35 ms a full car on identical tracks and 0.6 ms on isotropic
    ones. `ride_metrics` itself is called once, by whichever route is its fastest. A cut-off within 1e-6 of one
    of the rates that stand for the coherence of isotropic tracks leaves five digits.

    Examples
    --------
    >>> from susp_ss import QuarterCar, Road, sensitivity
    >>> car = QuarterCar()
    >>> slope = sensitivity(car, Road(), ["cs", "speed"])
    >>> slope.sws.dims, slope.unit.values.tolist()
    (('parameter',), ['N s/m', 'm/s'])

    The deflection goes as ``cs^-1/2`` and as the square root of the speed:

    >>> from susp_ss import ride_metrics
    >>> (slope.sws * [car.cs, 20.0] / ride_metrics(car, Road()).sws).values.round(9).tolist()
    [-0.5, 0.5]
    """
    check_kinds(vehicle, road)
    if not vehicle.quantities() or vehicle.layout().controls:
        raise TypeError(
            f"sensitivity needs a vehicle of springs and dampers alone, such as FullCar(), got {briefly(vehicle)}"
        )
    if points is not None:
        vehicle = vehicle.with_points(points)
    weighted = filters(weighting, vehicle.layout())
    known = settable(vehicle)
    if not np.all(np.asarray(road.cutoff) > 0.0):
        del known["cutoff"]
    settings = _checked(parameters, known)
    space, flat, ground = spanned(vehicle, road)
    for name in ("parameter", "unit"):
        if name in space.coords or name in space.dims:
            raise ValueError(f"{type(vehicle).__name__} has a dim or coordinate named {name!r}, which results use")
    table, rms, power, shifts = vehicle.layout().outputs, [], [], []
    rates, behind = table.of("sws_rate"), rows_behind(weighted, table)
    straight = linearise(flat, space, ground) if flat.curved else None
    car = flat if straight is None else straight.vehicle
    variances = covariance_variances(car, space, ground) if straight is None else straight.variances
    through = {one: covariance_variances(car, space, ground.weighted(one), needed=rows) for one, rows in behind.items()}
    along = [*settings.values(), *(as_settings(flat, curved_rates(flat)) if flat.curved else ())]

    def tangents_of(road: Road, variances: NDArray[np.float64], batch: slice) -> Tangents:
        return variance_tangents(car.select(batch), road.select(batch), along, variances[batch])

    def slopes(tangents: Tangents, variances: NDArray[np.float64]) -> NDArray[np.float64]:
        """Derivatives (P, N, outputs) of the root mean squares of some designs."""
        roots = 2.0 * np.sqrt(variances)
        by_root = np.divide(tangents.variances, roots, out=np.zeros_like(tangents.variances), where=roots > 0.0)
        return np.where(tangents.kinked, np.nan, by_root)

    for start in range(0, space.size, BATCH):
        batch = slice(start, start + BATCH)
        tangents = tangents_of(ground, variances, batch)
        follow = None
        if straight is not None:
            some = flat.select(batch), straight.select(batch)
            follow = Following(*some, list(settings.values()), tangents.variances)
            shifts.append(follow.shift)
            tangents = followed(tangents, follow)
        values = slopes(tangents, variances[batch])
        for one, their_variances in through.items():
            theirs = tangents_of(ground.weighted(one), their_variances, batch)
            theirs = theirs if follow is None else followed(theirs, follow)
            values[..., behind[one]] = slopes(theirs, their_variances[batch])[..., behind[one]]
        rms.append(values)
        with np.errstate(invalid="ignore"):
            change = tangents.damping.tangent * variances[batch, rates]
            power.append(change + tangents.damping.value * tangents.variances[..., rates])
    values, powers = (np.moveaxis(np.concatenate(parts, axis=1), 0, -1) for parts in (rms, power))

    units = [setting.quantity.unit for setting in settings.values()]
    coords = {"parameter": list(settings), "unit": ("parameter", units)}
    long_name = "derivative of {statistic} {meaning} by each parameter"
    slope = labelled_outputs(vehicle.layout(), values, powers, space, ("parameter",), coords, long_name)
    if shifts:
        slope[SHIFT.name] = shifted(vehicle.layout(), space, np.concatenate(shifts), long_name, ("parameter",))
    say_weightings(slope, weighted)
    return slope.transpose(*space.dims, "parameter", ...)


def _checked(parameters: Sequence[str], available: dict[str, Setting]) -> dict[str, Setting]:
    named = isinstance(parameters, Sequence) and not isinstance(parameters, str)
    if not named or not all(isinstance(name, str) for name in parameters):
        raise TypeError(f'parameters must be a sequence of names such as ("ks", "cs"), got {briefly(parameters)}')
    if len(parameters) == 0:
        raise ValueError(f"parameters must hold at least one name, available: {', '.join(available)}")
    for name in parameters:
        if name not in available:
            raise ValueError(f"no parameter named {name!r}, available: {', '.join(available)}")
    if len(set(parameters)) != len(parameters):
        raise ValueError(f"parameters must be different names, got {tuple(parameters)}")
    return {name: available[name] for name in parameters}
