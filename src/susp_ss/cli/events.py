"""``susp-ss events``: how often one vehicle on one road comes to its limits."""

import json
from typing import TYPE_CHECKING, Annotated, Any

import typer
from rich.console import Console
from rich.table import Table

from ..quantities import Quantity, typeset
from .documents import json_number, road_document
from .metrics import by_place
from .options import (
    TIME,
    Json,
    TrustUnits,
    built_from,
    flag,
    measured,
    number,
    print_table,
    road_from_options,
    vehicle_options,
)
from .refusals import Refusal, refusals

if TYPE_CHECKING:
    import xarray as xr

    from ..roads.road import Road
    from ..vehicles.vehicle import Vehicle

MEASURED = {
    "clearance": Quantity("clearance", "m", "travel to the bump stop", bound="> 0", known=(0.005, 0.5)),
    "rebound": Quantity("rebound", "m", "travel to the rebound stop", bound="> 0", known=(0.005, 0.5)),
    "distance": Quantity("distance", "m", "length of the stretch", bound="> 0"),
    "duration": TIME,
    "sn_range": Quantity("sn_range", "N", "range of the spring force", bound="> 0"),
}


def _option(metavar: str, help: str, default: str = "") -> Any:
    return typer.Option(metavar=metavar, help=help, show_default=default or False)


@built_from(vehicle=vehicle_options(), road=road_from_options)
def run(
    vehicle: "Vehicle",
    road: "Road",
    clearance: Annotated[str | None, _option("m", "Travel of the suspension to its bump stop; also 80mm.")] = None,
    rebound: Annotated[str | None, _option("m", "Travel to the rebound stop.", "the clearance")] = None,
    distance: Annotated[str | None, _option("m", "Length of the stretch.", "1000")] = None,
    duration: Annotated[str | None, _option("s", "Time in place of a distance.")] = None,
    sn_slope: Annotated[str | None, _option("K", "Slope of the spring's S-N curve.", "5")] = None,
    sn_range: Annotated[str | None, _option("N", "Range of the spring force that is endured ...", "1000")] = None,
    sn_cycles: Annotated[str | None, _option("CYCLES", "... so many times.", "1")] = None,
    trust_units: TrustUnits = False,
    as_json: Json = False,
) -> None:
    """How often a vehicle on a random road comes to its limits, and how far it goes.

    bump_rate, rebound_rate: how often a suspension reaches its stop (1/s)
    lift_off_rate: how often a wheel leaves the ground (1/s), with the tyre's static_load (N)
    bump_probability ...: that it happens on the stretch at all
    bacc_highest (m/s^2), sws_highest (m), dtl_highest (N): expected highest value on the stretch
    bacc_crossings ...: how often zero is passed upwards (1/s); irregularity of the deflection
    damage of the suspension's spring on the stretch: cycles of 1 kN, or shares of its life

    Wheels leave the ground infinitely often on a road that a tyre meets at a point: pass --contact-length 0.1.
    """
    from .. import rare_events
    from ..vehicles.files import vehicle_table

    if distance is not None and duration is not None:
        raise Refusal("--distance and --duration are two ways to say one thing; pass one of them")
    lengths = {"clearance": clearance, "rebound": rebound, "distance": distance, "duration": duration}
    numbers = {"sn_slope": sn_slope, "sn_cycles": sn_cycles}
    asked: dict[str, Any] = {
        name: measured(flag(name), text, MEASURED[name], trust_units)
        for name, text in {**lengths, "sn_range": sn_range}.items()
        if text is not None
    }
    asked |= {name: number(flag(name), text) for name, text in numbers.items() if text is not None}
    with refusals(), Console(stderr=True).status("computing"):
        events = rare_events(vehicle, road, **asked)
    if as_json:
        units = {name: data.attrs["units"] for name, data in events.items()}
        document = {"vehicle": vehicle_table(vehicle), "road": road_document(road), "units": units}
        values = {name: _nested(data) for name, data in events.items()}
        typer.echo(json.dumps({**document, **events.attrs, "events": values}, indent=2))
        return
    typer.echo(f"{type(vehicle).__name__}; {typeset(road.describe())}")
    _print(events)


def _nested(data: "xr.DataArray") -> Any:
    """Values by place, and within that by estimate."""
    if not data.dims:
        return json_number(data.item())
    dim = data.dims[0]
    return {place: _nested(data.sel({dim: place})) for place in data[dim].values.tolist()}


def _print(events: "xr.Dataset") -> None:
    places = events["point"].values.tolist() if "point" in events.dims else []
    table = Table("event", "unit")
    for place in places or ["value"]:
        table.add_column(place, justify="right")
    for name, data in events.items():
        for line, one in _lines(str(name), data):
            at = dict(by_place(one)) if one.dims else {"value": one.item()}
            cells = [f"{at[place]:.4g}" if place in at else "" for place in places or ["value"]]
            table.add_row(line, typeset(data.attrs["units"]), *cells)
    print_table(table)
    for name, data in events.items():
        typer.echo(f"{name}: {data.attrs['long_name']}")
    if "comment" in events.attrs:
        typer.echo(events.attrs["comment"])


def _lines(name: str, data: "xr.DataArray") -> "list[tuple[str, xr.DataArray]]":
    """A line a variable, or one for each of its estimates."""
    for dim in ("estimate", "counting"):
        if dim in data.dims:
            return [(f"{name}, {kind}", data.sel({dim: kind}, drop=True)) for kind in data[dim].values.tolist()]
    return [(name, data)]
