"""What one output is of another on a road, by frequency: transmissibility and coherence."""

from __future__ import annotations

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike

from ..quantities import briefly, unit_of
from ..roads.road import Road
from ..vehicles.contract import RoadVehicle
from .excitation import check_kinds, processes, spanned, vanishing_outputs
from .frequency import checked_frequency, effects, psd

# What a transmissibility is over, besides outputs.
ROAD = "road"


def transmissibility(
    vehicle: RoadVehicle, road: Road, frequency: ArrayLike, output: str, over: str = ROAD
) -> xr.DataArray:
    """How much of one vibration arrives at another place: the body's over the road's, a seat's over its floor's.

    ``T(f) = S_yx / S_xx``, the part of the output y that follows x, from spectra on the road. Of one input it is the
    ratio of both responses, whatever the road; in general its modulus is the root of coherence times ``S_yy / S_xx``.
    Over the road, x is the vertical acceleration under the first axle, the mean of both tracks, so that T is the
    ratio of displacements as well.

    Parameters
    ----------
    vehicle : Vehicle
        Parameters may be arrays.
    road : Road
        How tracks cohere, and by its speed the delay of the axles; its roughness does not matter.
    frequency : array_like, (F,)
        Hz, > 0.
    output : str
        An output of ``vehicle.state_space()``, such as ``"bacc_driver"``; over the road an acceleration.
    over : str
        Another output, or the road.

    Returns
    -------
    xarray.DataArray
        Complex, on (sweep..., frequency), in the output's unit over the other's.

    Raises
    ------
    ValueError
        An unknown output, one over the road that is no acceleration of the body, or one over an output that no wheel
        moves.

    Examples
    --------
    A person on a seat, over the floor below it, is a mass on a spring, whatever the car and the road:

    >>> import numpy as np
    >>> import susp_ss as ss
    >>> car = ss.FullCar().with_seats({"driver": ss.Seat(x=0.3, y=0.4)})
    >>> seat = ss.transmissibility(car, ss.Road(), [4.0], "bacc_driver", over="bacc_driver_floor")
    >>> w = 2.0 * np.pi * 4.0
    >>> alone = (35e3 + 800.0j * w) / (35e3 + 800.0j * w - 56.0 * w**2)
    >>> bool(np.isclose(seat.item(), alone))
    True
    """
    check_kinds(vehicle, road)
    f = checked_frequency(frequency)
    names = vehicle.layout().outputs.names[vehicle.layout().outputs.public]
    for argument, name in (("output", output), ("over", over)):
        if name not in names and not (argument == "over" and name == ROAD):
            available = ", ".join([*names, *([ROAD] if argument == "over" else [])])
            raise ValueError(f"{argument}: no output named {briefly(name)}, available: {available}")
    space, flat, road = spanned(vehicle, road)
    model = flat.assemble()
    found = effects(flat, model, road, f, model.relative_transfer(2.0 * np.pi * f))
    row = model.layout.outputs.names.index(output)
    if over == ROAD:
        if unit_of(output) != "m/s^2":
            raise ValueError(f"output: over the road it must be an acceleration in m/s^2, got {output!r}")
        # The first process is the mean of both tracks.
        T = (found[0].whole / found[0].s)[..., row, :]
    else:
        below = model.layout.outputs.names.index(over)
        if np.any(vanishing_outputs(model, processes(flat, road))[..., below]):
            raise ValueError(f"over: no wheel moves {over!r} on such a road ({road.describe()})")
        both, alone = (
            sum(
                effect.velocity[..., 0, :] * effect.whole[..., one, :] * effect.whole[..., below, :].conj()
                for effect in found
            )
            for one in (row, below)
        )
        T = both / alone
    result = space.unflatten(np.broadcast_to(T, (space.size, len(f))), ("frequency",), {"frequency": f})
    result.frequency.attrs["units"] = "Hz"
    return result.rename("transmissibility")


def coherence(vehicle: RoadVehicle, road: Road, frequency: ArrayLike) -> xr.DataArray:
    """How much of any output follows any other on a road, at each frequency.

    ``gamma^2 = |S_yz|^2 / (S_y S_z)`` of `psd` with ``cross=True``: 1 where one process moves both, as on identical
    tracks, 0 where they have nothing in common, as heave and roll of a symmetric car have.

    Parameters
    ----------
    vehicle : Vehicle
        Parameters may be arrays.
    road : Road
        Any waviness, any tracks.
    frequency : array_like, (F,)
        Hz, > 0.

    Returns
    -------
    xarray.DataArray
        On (sweep..., output, ``output_``, frequency), between 0 and 1; NaN where no wheel moves an output.

    Examples
    --------
    >>> import susp_ss as ss
    >>> gamma = ss.coherence(ss.RollHalfCar(), ss.DEFAULT_ROAD, [0.5, 20.0])
    >>> gamma.sel(output="sws_r", output_="sws_l").round(2).values.tolist()
    [0.99, 0.0]
    """
    S = psd(vehicle, road, frequency, cross=True)
    space, flat, road = spanned(vehicle, road)
    still = vanishing_outputs(flat.assemble(), processes(flat, road))[..., vehicle.layout().outputs.public]
    still = np.broadcast_to(still, (space.size, S.sizes["output"])).reshape(*space.shape, -1)
    own = np.moveaxis(np.diagonal(S.values.real, axis1=-3, axis2=-2), -1, -2)
    own = np.where(still[..., None], np.nan, own)
    gamma = np.abs(S.values) ** 2 / (own[..., :, None, :] * own[..., None, :, :])
    return S.copy(data=gamma).rename("coherence")
