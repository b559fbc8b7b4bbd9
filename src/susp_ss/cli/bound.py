"""``susp-ss bound``: how far any suspension could go, beside the passive vehicle."""

import json
import math
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer
from rich.console import Console

from ..quantities import ACTUATION, METRICS, Quantity
from .documents import json_number, road_document
from .folder import check_result
from .options import (
    Force,
    Json,
    TrustUnits,
    Weighting,
    built_from,
    measured,
    number,
    road_from_options,
    vehicle_options,
    weightings,
)
from .refusals import Refusal, refusals

if TYPE_CHECKING:
    from ..feedback import ActiveBound
    from ..roads.road import Road
    from ..vehicles.vehicle import Vehicle


@built_from(vehicle=vehicle_options(), road=road_from_options)
def run(
    vehicle: "Vehicle",
    road: "Road",
    minimise: Annotated[
        str, typer.Option(metavar="OUTPUT@PLACE", help="What is least: bacc@cg, dtl@fr, or bacc of a quarter car.")
    ] = "bacc@cg",
    limit: Annotated[
        list[str] | None,
        typer.Option(
            metavar="OUTPUT[@PLACE]=VALUE",
            help="A root mean square not to be exceeded: sws@fr=6mm, dtl=430, force=200N; without a place at every "
            "place; may be repeated.",
            show_default=False,
        ),
    ] = None,
    weighting: Weighting = None,
    no_preview: Annotated[
        bool,
        typer.Option("--no-preview", help="The best gain found on the states alone, blind to the road between axles."),
    ] = False,
    certify: Annotated[
        str | None,
        typer.Option(
            metavar="SOLVER",
            help="Solve it as one semidefinite programme as well, by clarabel or scs; without an axle delay.",
            show_default=False,
        ),
    ] = None,
    out: Annotated[
        Path | None,
        typer.Option(
            metavar="FOLDER",
            help="Write table, gain and figure here; without it nothing is written.",
            show_default=False,
        ),
    ] = None,
    force: Force = False,
    as_json: Json = False,
    trust_units: TrustUnits = False,
) -> None:
    """Least root mean square of one output over all feedback laws, under limits of others.

    Forces act between each wheel and the body. Whatever is not limited may grow:
    limit force, pitch_acc and roll_acc as well.
    """
    from .. import active_bound, report, save
    from ..feedback import ActiveBound

    if out:
        check_result(out, ActiveBound, force)
    limits = dict(_limit(text, trust_units) for text in limit or [])
    with refusals(), Console(stderr=True).status("computing"):
        found = active_bound(
            vehicle, road, minimise, limits, weightings(weighting or []), preview=not no_preview, certify=certify
        )
        if out:
            save(found, out, force=force)
    typer.echo(json.dumps(_document(found), indent=2) if as_json else report(found), nl=as_json)


def _limit(text: str, trust_units: bool) -> tuple[str, float]:
    name, equals, value = text.partition("=")
    if not equals:
        raise Refusal(f"--limit must be OUTPUT=VALUE such as sws@fr=6mm, got {text!r}")
    known: dict[str, Quantity] = METRICS | ACTUATION
    quantity = known.get(name.partition("@")[0])
    where = f"--limit {name}"
    return name, number(where, value) if quantity is None else measured(where, value, quantity, trust_units)


def _document(found: "ActiveBound") -> dict[str, Any]:
    """Everything found, in SI units."""
    table = found.table()
    return {
        "minimise": found.minimise,
        "bound": found.bound,
        "unresolved": found.unresolved,
        "least": None if math.isnan(found.least) else found.least,
        "preview": found.preview,
        "limits": dict(found.limits),
        "multipliers": dict(found.multipliers),
        "road": road_document(found.road),
        "units": table["unit"].to_dict(),
        "metrics": {name: json_number(value) for name, value in table[found.kind].items()},
        "passive": {name: json_number(value) for name, value in table["passive"].items()},
    }
