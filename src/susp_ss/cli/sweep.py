"""``susp-ss sweep``: the metrics of a grid of designs, into a store that can be resumed."""

import logging
import os
import time
from typing import TYPE_CHECKING, Annotated, Any

import typer

from .options import built_from, names, road_from_options, vehicle_options
from .refusals import Refusal, refusals

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from ..roads.road import Road
    from ..vehicles.vehicle import Vehicle


@built_from(designs=vehicle_options(ranges=True), road=road_from_options)
def run(
    designs: "tuple[Vehicle, dict[str, NDArray]]",
    road: "Road",
    store: Annotated[
        str, typer.Option(metavar="FOLDER", help="Zarr store to write, or to resume; or a URL, s3://bucket/out.zarr.")
    ],
    method: Annotated[
        str, typer.Option(metavar="NAME", help="covariance: exact; spectral: an integral over frequency.")
    ] = "covariance",
    outputs: Annotated[
        str | None,
        typer.Option(
            metavar="NAME,...",
            help="Metrics to keep, such as bacc@fr,sws: at every place, or at one, as bacc_fr.",
            show_default="all",
        ),
    ] = None,
    dtype: Annotated[str, typer.Option(metavar="NAME", help="Of what is stored: float64 or float32.")] = "float64",
    scheduler: Annotated[
        str | None,
        typer.Option(
            metavar="ADDRESS",
            help="Dask scheduler whose workers compute, and write where they reach the store, such as "
            "tcp://10.0.0.1:8786.",
            show_default="the threads of this machine",
        ),
    ] = None,
) -> None:
    """Root mean squares of the ride of a grid of designs, of any size.

    LO:HI:N are N values from LO to HI, evenly, such as --ks 12e3:24e3:100 or
    --ks-rear 12N/mm:24N/mm:100. The store opens as one labelled dataset,
    xarray.open_zarr("FOLDER"), with the units of susp-ss metrics:
    bacc (m/s^2), sws (m), dtl (N), pitch_acc and roll_acc (rad/s^2),
    damper_power (W), tyre_deflection (m) and sws_rate (m/s), and with
    attributes that say of which vehicle and road;
    what is not finished yet is NaN. The same command again goes on where this
    one stopped.
    """
    vehicle, axes = designs
    if not axes:
        raise Refusal("nothing to sweep; pass --ks, --cs or another parameter with a range LO:HI:N")
    begun = time.perf_counter()
    # What Dask logs of a lost connection, the error says in one line.
    logging.disable(logging.ERROR)
    with refusals():
        from ..sweep import sweep

        kept: Any = {"outputs": None if outputs is None else names([outputs]), "dtype": dtype}
        how: Any = {"method": method, "scheduler": scheduler, "progress": True}
        try:
            done = sweep(vehicle, road, axes, store, **how, **kept)
        except KeyboardInterrupt as stopped:
            typer.echo(f"susp-ss: stopped: {stopped}" if stopped.args else "susp-ss: stopped", err=True)
            # Threads are left in the middle of chunks, which are not marked as finished: nothing waits for them.
            os._exit(130)
    seconds = time.perf_counter() - begun
    line = f"{store}: {done.designs} designs in {done.chunks} chunks, {done.found} of them finished before"
    if done.computed:
        line += f"; {done.computed} designs computed in {seconds:.1f} s, {done.computed / seconds:.0f} a second"
    typer.echo(f"{type(vehicle).__name__} over {', '.join(axes)}; {road.describe()}", err=True)
    typer.echo(line, err=True)
