"""``susp-ss optimise``: the designs that no other beats, or the best one."""

import json
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from ..quantities import METRICS, Quantity
from .documents import json_number, road_document
from .folder import check_result
from .options import (
    Force,
    Json,
    TrustUnits,
    Weighting,
    bounds,
    built_from,
    measured,
    names,
    number,
    road_from_options,
    vehicle_options,
    weightings,
    whole,
)
from .refusals import Refusal, refusals

if TYPE_CHECKING:
    from ..design import ParetoFront
    from ..roads.road import Road
    from ..vehicles.vehicle import Vehicle


@built_from(vehicle=vehicle_options(), road=road_from_options)
def run(
    vehicle: "Vehicle",
    road: "Road",
    variables: Annotated[
        list[str],
        typer.Option(
            metavar="PARAM=LO:HI,...",
            help="Parameters to choose and their ranges, ks=12e3:25e3 or ks_front=12N/mm:25N/mm; may be repeated.",
        ),
    ],
    minimise: Annotated[
        list[str],
        typer.Option(
            metavar="METRIC@PLACE",
            help="What is to be small: bacc@cg, dtl@fr, pitch_acc; one, or two for the trade-off between them.",
        ),
    ],
    limit: Annotated[
        list[str] | None,
        typer.Option(
            metavar="METRIC@PLACE=VALUE",
            help="What must not be exceeded, sws@fr=20mm; may be repeated.",
            show_default=False,
        ),
    ] = None,
    points: Annotated[str, typer.Option(metavar="N", help="Designs of a trade-off.")] = "20",
    weighting: Weighting = None,
    scenarios: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE",
            help="Table of what the vehicle meets, a row a scenario: columns such as mb, kt, speed, roughness in SI "
            "units, and weight.",
            show_default=False,
        ),
    ] = None,
    statistic: Annotated[
        str, typer.Option(metavar="NAME", help="Over scenarios: mean, worst, or a quantile such as 0.95.")
    ] = "mean",
    bound: Annotated[
        bool, typer.Option("--bound", help="Also compute what any suspension, active ones too, could do.")
    ] = False,
    out: Annotated[
        Path | None,
        typer.Option(
            metavar="FOLDER",
            help="Write front.csv, metrics.nc, front.txt and front.png here; without it nothing is written.",
            show_default=False,
        ),
    ] = None,
    force: Force = False,
    trust_units: TrustUnits = False,
    as_json: Json = False,
) -> None:
    """Springs, dampers and other parameters that no others beat, on a random road.

    With two --minimise the trade-off between them: designs in which neither
    gets better without the other getting worse; with one the best design.

    susp-ss optimise --variables ks=12536:24570,cs=798:2235 --minimise bacc@cg
    --minimise dtl@fr --limit sws@fr=6mm
    """
    from .. import pareto_front, report, save
    from ..design import ParetoFront

    if out is not None:
        check_result(out, ParetoFront, force)
    given: Any = {"scenarios": None if scenarios is None else _scenarios(scenarios)}
    if statistic not in ("mean", "worst"):
        given["statistic"] = number("--statistic", statistic)
    else:
        given["statistic"] = statistic
    box = _ranges(vehicle, variables, trust_units)
    limits = _limits(limit or [], trust_units)
    with refusals():
        front = pareto_front(
            vehicle,
            road,
            box,
            names(minimise),
            limits,
            whole("--points", points, 2),
            weighting=weightings(weighting or []),
            bound=bound,
            **given,
        )
        if out is not None:
            save(front, out, force=force)
    typer.echo(json.dumps(_document(front), indent=2) + "\n" if as_json else report(front), nl=False)


def _parted(option: str, form: str, given: list[str]) -> list[tuple[str, str]]:
    """Names and texts of ``NAME=TEXT``, each name once."""
    parts = [text.partition("=") for text in names(given)]
    for name, equals, text in parts:
        if not equals or not text:
            raise Refusal(f"{option} must be {form}, got {name!r}")
        if [other for other, *_ in parts].count(name) > 1:
            raise Refusal(f"{option} {name} is given twice")
    return [(name, text) for name, _, text in parts]


def _ranges(vehicle: "Vehicle", given: list[str], trust_units: bool) -> dict[str, tuple[float, float]]:
    box = {}
    for name, text in _parted("--variables", "PARAM=LO:HI, such as ks=12e3:25e3", given):
        if name not in vehicle.settings():
            available = ", ".join(vehicle.quantities())
            raise Refusal(f"--variables: {type(vehicle).__name__} has no parameter {name!r}, available: {available}")
        quantity = vehicle.quantities()[vehicle.settings()[name][0]]
        box[name] = bounds(f"--variables {name}", text, quantity, trust_units)
    return box


def _limits(given: list[str], trust_units: bool) -> dict[str, float]:
    limits = {}
    for name, text in _parted("--limit", "METRIC@PLACE=VALUE, such as sws@fr=20mm", given):
        metric = name.partition("@")[0]
        quantity = METRICS.get(metric, Quantity(metric, "", metric))
        limits[name] = measured(f"--limit {name}", text, quantity, trust_units)
    return limits


def _scenarios(path: Path) -> dict[str, list[float]]:
    """Columns of a text table, numbers in SI units under a line of names."""
    from .. import written

    with refusals():
        records, separator, _ = written.text_table(path)
    if len(records) < 2:
        raise Refusal(f"--scenarios {path} needs a line of names, such as speed, and a line of numbers below it")
    (_, header), *rows = records
    for line, row in rows:
        if len(row) != len(header):
            raise Refusal(
                f"--scenarios {path}, line {line}: needs {len(header)} columns as the first line, got {len(row)}"
            )
    with refusals():
        cells = [(f"--scenarios {path}, line {line}", cell) for line, row in rows for cell in row]
        sign = written.decimal_sign(cells, separator)
    columns: dict[str, list[float]] = {name.strip(): [] for name in header}
    for line, row in rows:
        for name, cell in zip(columns, row, strict=True):
            value = written.number(cell, sign)
            if value is None:
                raise Refusal(f"--scenarios {path}, line {line}: {name} needs a number in SI units, got {cell!r}")
            columns[name].append(value)
    return columns


def _document(front: "ParetoFront") -> dict[str, Any]:
    """Everything asked and answered, in SI units."""
    from ..vehicles.files import vehicle_table

    def numbers(row: Any) -> dict[str, Any]:
        return {str(name): json_number(float(value)) for name, value in row.items()}

    table = front.table()
    return {
        "vehicle": vehicle_table(front.vehicle),
        "road": road_document(front.road),
        "variables": {name: list(side) for name, side in front.variables.items()},
        "minimise": list(front.objectives),
        "limits": dict(front.limits),
        "designs": [numbers(row) for _, row in table.iterrows()],
        "own": numbers(front.passive()),
    }
