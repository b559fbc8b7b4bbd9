"""Responses over frequency: transfer functions from the road's height, and spectra of the outputs on a road."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike, NDArray

from ..roads.road import Road
from ..vehicles.contract import Model, RoadVehicle
from ..vehicles.parameters import blocks, number_array
from .excitation import check_kinds, delays, integrated, processes, spanned

# Numbers that are at work at once.
TOGETHER = 1e6


def frequency_response(vehicle: RoadVehicle, frequency: ArrayLike) -> xr.DataArray:
    """Complex response of every output to the height of the road under every wheel.

    ``H(f) = Y (K - w^2 M + j w C)^-1 (K_in + j w C_in) + ...`` with ``w = 2 pi f``, solved relative to the road so that
    small deflections at low frequency keep all their digits. Outputs that have no state-space model from the road's
    height (tyre damping, rigid tyre) are included. A vehicle with further inputs, such as the steering angle of a
    `RideHandlingCar`, answers to these as well.

    Parameters
    ----------
    vehicle : Vehicle
        Parameters may be arrays.
    frequency : array_like, (F,)
        Hz, > 0.

    Returns
    -------
    xarray.DataArray
        On (sweep..., output, input, frequency); outputs and inputs named as in ``vehicle.state_space()``, in output
        unit per metre, or per unit of the further input.

    Raises
    ------
    ValueError
        ``frequency`` is not a finite, positive, non-empty row of numbers, or is exactly that of a mode without damping.

    Examples
    --------
    >>> import numpy as np
    >>> from susp_ss import QuarterCar, frequency_response
    >>> H = frequency_response(QuarterCar(), np.array([0.01, 1.0, 10.0]))
    >>> H.sel(output="sws", input="z_r").dims
    ('frequency',)
    """
    check_kinds(vehicle)
    f = checked_frequency(frequency)
    space, layout = vehicle.design_space(), vehicle.layout()
    flat, omega = vehicle.flattened(space), 2.0 * np.pi * f
    public, inputs = layout.outputs.public, (*layout.inputs, *layout.controls)
    outputs = layout.outputs.names[public]
    H = np.empty((space.size, len(outputs), len(inputs), len(f)), dtype=complex)
    for part in blocks(space.size, int(TOGETHER // (len(layout.outputs) * len(inputs) * len(f)) + 1)):
        model = flat.select(part).assemble()
        H[part, :, : len(layout.inputs)] = on_heights(model, omega, model.relative_transfer(omega))
        if layout.controls:
            H[part, :, len(layout.inputs) :] = np.moveaxis(_controlled(model, omega)[..., public, :], -3, -1)
    labels = {"output": list(outputs), "input": list(inputs), "frequency": f}
    result = space.unflatten(H, ("output", "input", "frequency"), labels).rename("frequency_response")
    result.frequency.attrs["units"] = "Hz"
    return result


def on_heights(model: Model, omega: NDArray, relative: NDArray) -> NDArray[np.complex128]:
    """Public outputs per metre under every wheel at ``omega`` (F,), (designs..., outputs, inputs, F).

    ``relative`` is `Model.relative_transfer` there.
    """
    public = model.layout.outputs.public
    H = 1j * omega * relative[..., public, :, :]
    H += (model.on_integrators @ model.integrators)[..., public, :, None]
    return np.asarray(H)


def _controlled(model: Model, omega: NDArray) -> NDArray:
    """Outputs per further input at ``omega`` (F,), (designs..., F, outputs, controls)."""
    A, _, Y, _, _ = model.displacement_form()
    B, D = model.controls()
    s = 1j * omega[:, None, None]
    x = np.linalg.solve(s * np.eye(A.shape[-1]) - A[..., None, :, :], B[..., None, :, :].astype(complex))
    return np.asarray(Y[..., None, :, :] @ x + D[..., None, :, :])


def psd(vehicle: RoadVehicle, road: Road, frequency: ArrayLike, cross: bool = False) -> xr.DataArray:
    """One-sided spectrum of every output on a random road.

    ``S_y(f) = sum over processes |H(f) sum_j b_j e^(-j w tau_j)|^2 G(f)``, the processes being the mean and the half
    difference of the two tracks, which the axles j meet one after the other.

    Parameters
    ----------
    vehicle : Vehicle
        Parameters may be arrays.
    road : Road
        Any waviness, any tracks.
    frequency : array_like, (F,)
        Hz, > 0.
    cross : bool
        Cross-spectra of any two outputs as well, ``S_yz = E[Y Z*]``: its phase is how far ``output`` is ahead of
        ``output_``, as in ``scipy.signal.csd(output_, output)``.

    Returns
    -------
    xarray.DataArray
        On (sweep..., output, frequency), in output unit squared per Hz; with ``cross`` complex on (sweep..., output,
        ``output_``, frequency), a Hermitian matrix at each frequency.

    Raises
    ------
    ValueError
        ``frequency`` is not a finite, positive, non-empty row of numbers, or a wheel of the road is unknown.

    Examples
    --------
    >>> import numpy as np
    >>> from susp_ss import QuarterCar, Road, psd
    >>> S = psd(QuarterCar(), Road(), np.geomspace(0.1, 30.0, 200))
    >>> peak = S.sel(output="bacc").idxmax("frequency")
    >>> bool(0.5 < peak < 15.0)
    True
    """
    check_kinds(vehicle, road)
    f = checked_frequency(frequency)
    space, flat, road = spanned(vehicle, road)
    table = vehicle.layout().outputs
    outputs = list(table.names[table.public])
    dims = ("output", "output_") if cross else ("output",)
    S = np.empty((space.size, *(len(outputs) for _ in dims), len(f)), dtype=complex if cross else float)
    for part in blocks(space.size, int(TOGETHER // (len(table) * len(outputs) * len(f)) + 1)):
        some = flat.select(part)
        model = some.assemble()
        wholes = _wholes(some, model, road.select(part), f, model.relative_transfer(2.0 * np.pi * f))
        S[part] = sum(map(_outer if cross else squared, wholes))
    result = space.unflatten(S, (*dims, "frequency"), {**dict.fromkeys(dims, outputs), "frequency": f}).rename("psd")
    result.frequency.attrs["units"] = "Hz"
    return result


def densities(vehicle: RoadVehicle, model: Model, road: Road, f: NDArray, relative: NDArray) -> NDArray[np.float64]:
    """One-sided densities per Hz of the public outputs of a flattened vehicle at ``f`` (F,), (designs..., outputs, F).

    ``relative`` is `Model.relative_transfer` there.
    """
    return np.asarray(sum(map(squared, _wholes(vehicle, model, road, f, relative))))


def _wholes(vehicle: RoadVehicle, model: Model, road: Road, f: NDArray, relative: NDArray) -> list[NDArray]:
    """What each process does to the public outputs, (designs..., outputs, F), in roots of their densities per Hz."""
    public = model.layout.outputs.public
    found = effects(vehicle, model, road, f, relative)
    return [(np.sqrt(effect.velocity) * effect.whole)[..., public, :] for effect in found]


def _outer(whole: NDArray) -> NDArray:
    return np.asarray(whole[..., :, None, :] * whole[..., None, :, :].conj())


class Effect(NamedTuple):
    """What one process does to all outputs at frequencies, of arrays (designs..., outputs, F) for each of its axles.

    ``velocity`` (designs..., 1, F) is the one-sided density per Hz of its rate, ``s`` (designs..., 1, F) is ``j w``.
    ``alone`` is what each axle makes of the rate as if it met it at once, ``taus`` by how much later it does. What
    integrates, such as the warp of the road, is in ``warps``, and what is left of it after all axles in ``drift``.
    """

    velocity: NDArray
    s: NDArray
    taus: list[NDArray]
    alone: list[NDArray]
    warps: list[NDArray]
    drift: NDArray | None

    def at(self, which: NDArray[np.int_]) -> Effect:
        """The same of some of the designs, each of which has frequencies of its own."""

        def some(x: NDArray) -> NDArray:
            return x[which] if x.ndim == 3 else x

        taus, alone, warps = ([some(x) for x in parts] for parts in (self.taus, self.alone, self.warps))
        drift = None if self.drift is None else some(self.drift)
        return Effect(some(self.velocity), some(self.s), taus, alone, warps, drift)

    @property
    def whole(self) -> NDArray:
        """What all axles do together."""
        turns = [-self.s * tau for tau in self.taus]
        late: Any = sum(np.exp(turn) * one for turn, one in zip(turns, self.alone, strict=True))
        if self.drift is not None:
            # At low frequency the warp of an axle is large and nearly cancels the others': the sum first.
            late = late + self.drift
            late = sum((np.expm1(turn) * warp for turn, warp in zip(turns, self.warps, strict=True)), late)
        return np.asarray(late)

    @property
    def each(self) -> list[NDArray]:
        """What each axle does, what integrates included."""
        return self.alone if self.drift is None else [a + b for a, b in zip(self.alone, self.warps, strict=True)]


def effects(vehicle: RoadVehicle, model: Model, road: Road, f: NDArray, H: NDArray) -> list[Effect]:
    """What every process does to all outputs of a flattened vehicle at frequencies (F,), or (designs, F).

    ``H`` is `Model.relative_transfer` there.
    """
    omega = 2.0 * np.pi * f
    s = 1j * omega[..., None, :]
    taus = [np.asarray(tau)[..., None, None] for tau in delays(vehicle, road)]
    width = np.asarray(vehicle.track_width)[..., None]
    road = road.mapped(lambda x: np.asarray(x)[..., None])
    velocity = omega**2 * road.psd(f / road.speed) / road.speed
    if road.weighting is not None:
        velocity = velocity * road.weighting.power(omega)

    def warped(rate: NDArray) -> NDArray:
        return np.asarray(model.on_integrators @ rate[..., None] / s)

    found = []
    for process in processes(vehicle, road):
        share: Any = process.share
        if process.sign:
            apart = road.incoherence(f / road.speed, width)
            share = 0.5 * (apart if process.sign < 0 else 2.0 - apart)
        rates, drift = integrated(model, process)
        warps = [warped(rates[axle]) for axle in process.axles] if rates.any() else []
        alone = list(np.moveaxis(process.weights[process.axles] @ H, -2, 0))
        late = [taus[axle] for axle in process.axles]
        found.append(Effect((share * velocity)[..., None, :], s, late, alone, warps, warped(drift) if warps else None))
    return found


def squared(z: NDArray) -> NDArray[np.float64]:
    """``|z|^2``."""
    return np.asarray(z.real**2 + z.imag**2)


def checked_frequency(frequency: ArrayLike) -> NDArray[np.float64]:
    """Return frequencies as one row of floats, or say what is wrong with them."""
    values = number_array(frequency, "frequency must be numbers in Hz")
    if values.ndim != 1 or values.size == 0:
        raise ValueError(f"frequency must be one non-empty row of Hz, got shape {values.shape}")
    if not (np.isfinite(values) & (values > 0.0)).all():
        raise ValueError(f"frequency must be finite and > 0 Hz, got {values[~(np.isfinite(values) & (values > 0))][0]}")
    return values.astype(float)
