"""``susp-ss comfort``: what a ride is worth to the people in it, by ISO 2631-1 and 2002/44/EC."""

import inspect
import json
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer
from rich.console import Console

from ..quantities import ROAD
from .folder import check_result
from .options import (
    TIME,
    Force,
    Json,
    Point,
    body_points,
    built_from,
    flag,
    measured,
    road_from_options,
    vehicle_options,
    weightings,
)
from .refusals import Refusal, refusals

if TYPE_CHECKING:
    import xarray as xr

    from ..roads.road import Road
    from ..vehicles.vehicle import Vehicle

Profile = Annotated[
    Path | None,
    typer.Option(
        metavar="FILE",
        help="Measured profile to drive over at --speed, in place of a random road: x, left and right in m.",
        show_default=False,
        rich_help_panel="Road",
    ),
]

ALONG = ("speed", "trust_units")
"""Options of a road that a profile knows as well."""


def way_from_options(profile: Path | None = None, **road: Any) -> "tuple[Road | xr.Dataset, float | None]":
    """What is driven over, and how fast where that is a profile."""
    if profile is None:
        return road_from_options(**road), None
    from .. import DEFAULT_ROAD, read_profile

    for name, option in inspect.signature(road_from_options).parameters.items():
        if name not in ALONG and road[name] != option.default:
            raise Refusal(f"{flag(name)} describes a random road; beside --profile pass --speed alone")
    text = road["speed"]
    speed = DEFAULT_ROAD.speed if text is None else measured("--speed", text, ROAD["speed"], road["trust_units"])
    with refusals():
        return read_profile(profile), speed


_PROFILE = inspect.Parameter("profile", inspect.Parameter.KEYWORD_ONLY, default=None, annotation=Profile)
way_from_options.__signature__ = inspect.Signature(  # type: ignore[attr-defined]
    [
        option.replace(kind=inspect.Parameter.KEYWORD_ONLY)
        for option in (_PROFILE, *inspect.signature(road_from_options).parameters.values())
    ]
)


@built_from(vehicle=vehicle_options(), way=way_from_options)
def run(
    vehicle: "Vehicle",
    way: "tuple[Road | xr.Dataset, float | None]",
    weighting: Annotated[
        list[str] | None,
        typer.Option(
            metavar="OUTPUT=NAME",
            help="Another weighting of one output, bacc=Wb; may be repeated.",
            show_default="bacc=Wk,roll_acc=We,pitch_acc=We",
        ),
    ] = None,
    point: Point = None,
    duration: Annotated[
        str | None,
        typer.Option(
            metavar="s", help="Exposure of a day or a ride; also 8h, 30min.", show_default="8h; one run over a profile"
        ),
    ] = None,
    out: Annotated[
        Path | None,
        typer.Option(
            metavar="FOLDER",
            help="Write comfort.csv, comfort.json and, on a random road, comfort.png here; without it nothing is "
            "written.",
            show_default=False,
        ),
    ] = None,
    force: Force = False,
    as_json: Json = False,
) -> None:
    """Comfort of a ride: weighted accelerations, total value in words, doses, permitted exposure.

    bacc (m/s^2), roll_acc, pitch_acc (rad/s^2): weighted root mean squares
    total: vibration total value (m/s^2); reaction: the words of ISO 2631-1 for it
    vdv, evdv: vibration dose value (m/s^1.75) and its estimate
    msdv: motion sickness dose value (m/s^1.5)
    a8: daily exposure (m/s^2), and the exposure in s a day until action and limit values
    (2002/44/EC)
    On a profile also mtvv: greatest running RMS (m/s^2), and crest_factor.
    """
    from .. import comfort
    from ..metrics.comfort import Comfort
    from ..presentation.documents import comfort_document
    from ..presentation.report import report
    from ..presentation.save import save

    if out is not None:
        check_result(out, Comfort, force)
    by_output = weightings(weighting or [])
    if isinstance(by_output, str):
        raise Refusal(f"--weighting must be OUTPUT=NAME, such as bacc={by_output}, got {by_output!r}")
    seconds = None if duration is None else measured("--duration", duration, TIME, True)
    road, speed = way
    with refusals(), Console(stderr=True).status("computing"):
        ride = comfort(
            vehicle, road, points=body_points(point or []), weighting=by_output, duration=seconds, speed=speed
        )
    if out is not None:
        with refusals():
            save(ride, out, force)
    typer.echo(json.dumps(comfort_document(ride), indent=2) if as_json else report(ride), nl=as_json)
