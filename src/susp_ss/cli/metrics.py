"""``susp-ss metrics``: the ride of one vehicle on one road."""

import json
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer
from rich.console import Console
from rich.table import Table

from ..quantities import typeset
from .documents import json_number, road_document
from .options import (
    TIME,
    Json,
    Point,
    Weighting,
    body_points,
    built_from,
    counted,
    measured,
    print_table,
    road_from_options,
    vehicle_options,
    weightings,
)
from .refusals import Refusal, refusals

if TYPE_CHECKING:
    import xarray as xr

    from ..roads.road import Road
    from ..vehicles.contract import RoadVehicle
    from ..vehicles.vehicle import Vehicle


@built_from(vehicle=vehicle_options(), road=road_from_options)
def run(
    vehicle: "Vehicle",
    road: "Road",
    method: Annotated[
        str,
        typer.Option(
            metavar="NAME",
            help="covariance: exact; spectral: an integral over frequency; time: a synthesised record, with standard "
            "errors.",
        ),
    ] = "covariance",
    weighting: Weighting = None,
    point: Point = None,
    duration: Annotated[
        str | None,
        typer.Option(metavar="s", help="Length of the record, with --method time.", show_default="600"),
    ] = None,
    seed: Annotated[int | None, counted("Seed of the record, with --method time.", show_default="0")] = None,
    system: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE",
            help="State space in place of the model: JSON with A, B, C, D, inputs (z_r_fr ... in m, or dz_r_fr ... in "
            "m/s) and outputs (bacc_cg, sws_fr, any name), or a .mat of the same. Its wheels are the vehicle's, or its "
            "own (wheels, wheelbase, track_width).",
            show_default=False,
        ),
    ] = None,
    template: Annotated[
        bool, typer.Option("--template", help="Print the vehicle as a file for --vehicle, and compute nothing.")
    ] = False,
    as_json: Json = False,
) -> None:
    """Root mean squares of a vehicle's ride on a random road.

    bacc: body acceleration (m/s^2) at the centre of gravity and each wheel
    sws: suspension deflection (m)
    dtl: dynamic tyre load (N)
    pitch_acc, roll_acc: angular acceleration of the body (rad/s^2)
    damper_power: mean power dissipated in each damper (W)
    tyre_deflection (m), sws_rate: suspension velocity (m/s)
    With --model ride-handling also ay (m/s^2), yaw_rate (rad/s), sideslip, roll and
    slip_angle (rad), load_transfer (N) of each axle and load_transfer_ratio.
    ride_height_shift: mean suspension deflection (m), of a vehicle file with curves of springs or dampers
    seat_travel: deflection of a seat of the vehicle file (m)

    An infinite variance shows as inf, in JSON as the text "inf".
    """
    from .. import ride_metrics
    from ..vehicles.files import vehicle_table, vehicle_text
    from ..vehicles.system_files import read_system

    if template:
        if system:
            raise Refusal("--template prints a model's parameters, which --system has none of")
        typer.echo(vehicle_text(vehicle))
        return
    length = None if duration is None else measured("--duration", duration, TIME, True)
    record = {name: value for name, value in (("duration", length), ("seed", seed)) if value is not None}
    if record and method != "time":
        raise Refusal(f"--{next(iter(record))} belongs to --method time, got --method {method}")
    more: dict[str, Any] = {"weighting": weightings(weighting or []), "points": body_points(point or [])}
    with refusals(), Console(stderr=True).status("computing"):
        asked = read_system(system, vehicle) if system else vehicle
        result = ride_metrics(asked, road, method=method, **more, **record)
    if as_json:
        described = _system_table(asked, system) if system else vehicle_table(vehicle)
        typer.echo(json.dumps(_document(described, road, method, result), indent=2))
    else:
        _print(f"{asked!r} of {system}" if system else type(vehicle).__name__, road, result)


def _system_table(vehicle: "RoadVehicle", file: Path) -> dict[str, Any]:
    """What a system of a file has been taken for."""
    layout = vehicle.layout()
    return {
        "system": str(file),
        "inputs": list(layout.inputs),
        "outputs": list(layout.outputs.names),
        "wheels": {name: wheel._asdict() for name, wheel in vehicle.wheels.items()},
        "wheelbase": {"value": vehicle.wheelbase, "unit": "m"},
        "track_width": {"value": vehicle.track_width, "unit": "m"},
    }


def _document(vehicle: dict[str, Any], road: "Road", method: str, result: "xr.Dataset") -> dict[str, Any]:
    """Everything asked and answered, in SI units."""
    return {
        "vehicle": vehicle,
        "road": road_document(road),
        "method": method,
        "units": {name: data.attrs["units"] for name, data in result.items()},
        "metrics": {
            name: {place: json_number(value) for place, value in by_place(data)}
            if data.dims
            else json_number(data.item())
            for name, data in result.items()
        },
        **({"comment": result.attrs["comment"]} if "comment" in result.attrs else {}),
    }


def _weighted(data: "xr.DataArray") -> str:
    return f"{data.attrs['weighting']}-weighted " if "weighting" in data.attrs else ""


def _comment(data: "xr.DataArray") -> str:
    return f"; {data.attrs['comment']}" if "comment" in data.attrs and float("inf") in data.values else ""


def by_place(data: "xr.DataArray") -> list[tuple[str, float]]:
    (dim,) = data.dims
    return list(zip(data[dim].values.tolist(), data.values.tolist(), strict=True))


def _print(vehicle: str, road: "Road", result: "xr.Dataset") -> None:
    places = [place for dim in ("point", "axle") if dim in result.dims for place in result[dim].values.tolist()]
    table = Table("metric", "unit")
    for place in places or ["value"]:
        table.add_column(place, justify="right")
    for name, data in result.items():
        if data.dims:
            at = dict(by_place(data))
            cells = [f"{at[place]:.4g}" if place in at else "" for place in places]
        else:
            cells = [f"{data.item():.4g}"]
        table.add_row(str(name), typeset(data.attrs["units"]), *cells)
    typer.echo(f"{vehicle}; {typeset(road.describe())}")
    print_table(table)
    for name, data in result.items():
        typer.echo(f"{name}: {_weighted(data)}{data.attrs['long_name']}{_comment(data)}")
    if "comment" in result.attrs:
        typer.echo(result.attrs["comment"])
