"""``susp-ss sweep``: the metrics of a grid of designs, into a store that can be resumed."""

import dataclasses
import logging
import time
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer
from rich.console import Console

from ..quantities import PARAMETERS
from .options import built_from, flag, nodes, number, refuse_unknown, road_from_options, vehicle_options
from .refusals import Refusal, refusals

if TYPE_CHECKING:
    from ..roads.road import Road
    from ..vehicles.vehicle import Vehicle

SWEPT = ("ks", "cs")
"""Parameters whose own option takes a range."""


def _range(name: str) -> Any:
    quantity = PARAMETERS[name]
    meaning = f"{quantity.meaning.capitalize()} in {quantity.unit}, each wheel; or one."
    return typer.Option(metavar="LO:HI:N", help=meaning, show_default=False)


@built_from(vehicle=vehicle_options(without=SWEPT), road=road_from_options)
def run(
    vehicle: "Vehicle",
    road: "Road",
    store: Annotated[Path, typer.Option(metavar="FOLDER", help="Zarr store to write, or to resume.")],
    ks: Annotated[str | None, _range("ks")] = None,
    cs: Annotated[str | None, _range("cs")] = None,
    more: Annotated[
        list[str] | None,
        typer.Option(
            metavar="PARAM=LO:HI:N",
            help="Values of any other parameter, in its SI unit; may be repeated.",
            show_default=False,
        ),
    ] = None,
    method: Annotated[
        str, typer.Option(metavar="NAME", help="covariance: exact, for waviness 2; spectral: any waviness.")
    ] = "covariance",
    scheduler: Annotated[
        str | None,
        typer.Option(
            metavar="ADDRESS",
            help="Dask scheduler whose workers compute, such as tcp://10.0.0.1:8786.",
            show_default="the threads of this machine",
        ),
    ] = None,
) -> None:
    """Root mean squares of the ride of a grid of designs, of any size.

    LO:HI:N are N values from LO to HI, evenly. The store opens as one labelled
    dataset, xarray.open_zarr("FOLDER"), with the units of susp-ss metrics:
    bacc (m/s^2), sws (m), dtl (N), pitch_acc and roll_acc (rad/s^2),
    damper_power (W); what is not finished yet is NaN. The same command again
    goes on where this one stopped.
    """
    given = _given({"ks": ks, "cs": cs}, more or [])
    for name, (where, _) in given.items():
        refuse_unknown(vehicle, name, where)
    axes = {name: nodes(where, text) for name, (where, text) in given.items() if ":" in text}
    fixed = {name: number(where, text) for name, (where, text) in given.items() if name not in axes}
    if not axes:
        raise Refusal("nothing to sweep; pass --ks, --cs or --more with a range LO:HI:N")
    begun = time.perf_counter()
    # What Dask logs of a lost connection, the error says in one line.
    logging.disable(logging.ERROR)
    with refusals():
        from ..sweep import sweep

        how: Any = {"method": method, "scheduler": scheduler, "progress": Console(stderr=True).is_terminal}
        try:
            done = sweep(dataclasses.replace(vehicle, **fixed), road, axes, store, **how)
        except KeyboardInterrupt as stopped:
            typer.echo(f"susp-ss: stopped: {stopped}" if stopped.args else "susp-ss: stopped", err=True)
            raise typer.Exit(130) from None
    seconds = time.perf_counter() - begun
    line = f"{store}: {done.designs} designs in {done.chunks} chunks, {done.found} of them finished before"
    if done.computed:
        line += f"; {done.computed} designs computed in {seconds:.1f} s, {done.computed / seconds:.0f} a second"
    typer.echo(line, err=True)


def _given(own: dict[str, str | None], more: list[str]) -> dict[str, tuple[str, str]]:
    """Option and text of each parameter."""
    given = {name: (flag(name), text) for name, text in own.items() if text is not None}
    for setting in more:
        name, equals, text = setting.partition("=")
        if not equals:
            raise Refusal(f"--more must be PARAM=LO:HI:N, such as mu=40:50:11, got {setting!r}")
        if name in given:
            raise Refusal(f"--more {name}: {name} is given twice")
        given[name] = (f"--more {name}", text)
    return given
