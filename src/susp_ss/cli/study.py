"""``susp-ss study``: the feasibility study, and the scan over scenarios."""

import json
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer
from rich.console import Console

from ..quantities import PARAMETERS
from .folder import check_result
from .options import (
    Force,
    Json,
    TrustUnits,
    bounds,
    built_from,
    counted,
    flag,
    road_from_options,
    vehicle_options,
)
from .refusals import Refusal, refusals

if TYPE_CHECKING:
    from ..roads.road import Road
    from ..vehicles.vehicle import Vehicle


def _bounds(name: str) -> Any:
    quantity = PARAMETERS[name]
    meaning = (
        f"{quantity.meaning.capitalize()} in {quantity.unit}, lowest and highest; at --corner, where corners differ."
    )
    low, high = {"ks": (12536, 24570), "cs": (798, 2235)}[name]
    return typer.Option(metavar="LO:HI", help=meaning, show_default=f"{low}:{high}")


@built_from(car=vehicle_options(without=("ks", "cs")), road=road_from_options)
def run(
    context: typer.Context,
    car: "Vehicle",
    road: "Road",
    corner: Annotated[
        str, typer.Option(metavar="NAME", help="Where the full car is measured: fr, fl, rr or rl.")
    ] = "fr",
    ks_range: Annotated[str | None, _bounds("ks")] = None,
    cs_range: Annotated[str | None, _bounds("cs")] = None,
    low_fidelity: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE",
            help="TOML file of the cheap car, on one wheel.",
            show_default="the quarter car of --corner",
        ),
    ] = None,
    nodes: Annotated[
        int | None,
        counted("Springs and dampers on the N x N grid.", show_default="20; 10 with --scan"),
    ] = None,
    nonnegative: Annotated[
        bool, typer.Option("--nonnegative/--free", help="Whether coefficients are kept from being negative.")
    ] = False,
    scan: Annotated[
        bool,
        typer.Option(
            "--scan",
            help="Instead, fit in many scenarios and rank these by their distance to the published tables. Varies the "
            "road, the place and the fit itself, so that only --nodes, --out, --force, --no-figures and --json go "
            "with it.",
        ),
    ] = False,
    out: Annotated[
        Path | None,
        typer.Option(
            metavar="FOLDER",
            help="Write tables, responses, figures and report.html here (scan.csv and scan.png with --scan); "
            "without it nothing is written.",
            show_default=False,
        ),
    ] = None,
    force: Force = False,
    trust_units: TrustUnits = False,
    figures: Annotated[bool, typer.Option("--figures/--no-figures", help="Whether FOLDER gets figures.")] = True,
    as_json: Json = False,
) -> None:
    """Tune a quarter car to a full car three ways, beside the published tables.

    Springs from 12536 to 24570 N/m, dampers from 798 to 2235 N s/m; or a car
    of your own, --vehicle car.toml --ks-range 15e3:30e3 --cs-range 1e3:3e3,
    beside which nothing is published. Root mean squares of body acceleration
    (bacc, m/s^2), dynamic tyre load (dtl, N) and suspension working space (sws, m).
    Designs are then optimised on surrogates of 5 to 60 runs, and verified on the full car.
    """
    if scan:
        _refuse_fixed(context)
        _scan(10 if nodes is None else nodes, out, force, figures, as_json)
        return

    from ..presentation.documents import study_document
    from ..presentation.report import report
    from ..study import Study, feasibility_study
    from ..vehicles.files import read_vehicle

    ranges = {
        name: bounds(flag(f"{name}_range"), text, PARAMETERS[name], trust_units)
        for name, text in (("ks", ks_range), ("cs", cs_range))
        if text is not None
    }
    with refusals():
        cheap = None if low_fidelity is None else read_vehicle(low_fidelity, trust_units)
    if out is not None:
        check_result(out, Study, force)
    size = 20 if nodes is None else nodes
    with refusals(), Console(stderr=True).status("fitting the surrogates"):
        study = feasibility_study(road, corner, (size, size), nonnegative, vehicle=car, low_fidelity=cheap, **ranges)
    with refusals(), Console(stderr=True).status("optimising on the surrogates"):
        text = json.dumps(study_document(study), indent=2) + "\n" if as_json else report(study)
    _finish(study, out, force, figures, text)


def _finish(result: Any, out: Path | None, force: bool, figures: bool, text: str) -> None:
    """Write a result where it is asked for, and print its text."""
    from ..presentation.save import save

    if out is not None:
        with refusals(), Console(stderr=True).status(f"writing {out}"):
            save(result, out, force=force, figures=figures)
    typer.echo(text, nl=False)


def _refuse_fixed(context: typer.Context) -> None:
    """Refuse options that fix what the scan varies."""
    for name in context.params:
        source = context.get_parameter_source(name)
        if (
            name not in ("nodes", "scan", "out", "force", "figures", "as_json")
            and source
            and source.name == "COMMANDLINE"
        ):
            raise Refusal(f"{flag(name)} does not go with --scan, which varies it or has no use for it")


def _scan(nodes: int, out: Path | None, force: bool, figures: bool, as_json: bool) -> None:
    from ..presentation.report import report
    from ..study import Scan, scan_scenarios

    if out is not None:
        check_result(out, Scan, force)
    with refusals():
        scan = scan_scenarios((nodes, nodes), progress=True)
    table = scan.scenarios
    text = table.to_json(orient="records", double_precision=15, indent=2) + "\n" if as_json else report(scan)
    _finish(scan, out, force, figures, text)
