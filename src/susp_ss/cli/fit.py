"""``susp-ss fit``: surrogates of an expensive model, from a table of its runs."""

import json
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
from rich.console import Console

from .fmu import CUT, FmuRuns, box_of, fmu_from_options, ranges_of
from .folder import check_result
from .options import Force, Json, TrustUnits, built_from, counted, names, number, road_from_options, vehicle_options
from .refusals import Refusal, refusals

if TYPE_CHECKING:
    from ..roads.road import Road
    from ..vehicles.vehicle import Vehicle


@built_from(
    vehicle=vehicle_options("low_fidelity", "quarter", "The cheap model"), road=road_from_options, fmu=fmu_from_options
)
def run(
    vehicle: "Vehicle",
    road: "Road",
    fmu: FmuRuns | None,
    inputs: Annotated[
        list[str],
        typer.Option(
            metavar="NAME,...",
            help="What varies: parameters of the cheap model or its road, SI units unless the file or --units states "
            "others; ks_front, cs_rl and the like belong to some corners. Where the column has another name: K_S=ks.",
            show_default=False,
        ),
    ],
    outputs: Annotated[
        list[str],
        typer.Option(
            metavar="NAME,...",
            help="What came out: bacc, sws, dtl, pitch_acc, roll_acc or damper_power, with the place if it matters "
            "(sws_rr, bacc_cg). Where the column has another name: z_acc=bacc.",
            show_default=False,
        ),
    ],
    runs: Annotated[
        list[Path] | None,
        typer.Argument(
            metavar="RUNS...",
            help="Table of expensive runs: .csv, .txt, .tsv, .xlsx, .parquet, .nc or .mat; with --histories one such "
            "file a run; none with --fmu.",
            show_default=False,
        ),
    ] = None,
    units: Annotated[
        list[str] | None,
        typer.Option(
            metavar="NAME=UNIT,...",
            help="Units of columns, over those that the file states: ks=N/mm,dtl=kN.",
            show_default=False,
        ),
    ] = None,
    decimal: Annotated[
        str | None,
        typer.Option(metavar=". or ,", help="Decimal sign of text, where no cell shows it.", show_default=False),
    ] = None,
    sheet: Annotated[
        str | None,
        typer.Option(
            metavar="NAME", help="Sheet of an Excel file, where several have the columns.", show_default=False
        ),
    ] = None,
    histories: Annotated[
        bool,
        typer.Option(
            "--histories",
            help="RUNS are records over time, one file a run, with a column of time; outputs are root mean squares "
            "about the mean, of damper_power the mean.",
        ),
    ] = False,
    cut: Annotated[
        str | None,
        typer.Option(
            metavar="DURATION",
            help="Start of each history or run of an FMU that is left out, s; 0 for none.",
            show_default=f"{CUT} with --fmu",
        ),
    ] = None,
    designs: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE",
            help="Table of the inputs of each history, which its column 'file' names; without it each history holds "
            "them as columns that do not change.",
            show_default=False,
        ),
    ] = None,
    time: Annotated[
        str, typer.Option(metavar="COLUMN", help="Column of time of the histories, s unless the file states ms.")
    ] = "time",
    weighting: Annotated[
        str | None,
        typer.Option(
            metavar="NAME",
            help="Weighting of the accelerations, such as Wk: histories and runs of an FMU pass it, of a table it says "
            "what the accelerations there have passed; the cheap model's pass it, too.",
            show_default=False,
        ),
    ] = None,
    at: Annotated[
        str | None,
        typer.Option(
            metavar="PLACE",
            help="Where outputs without a place were measured: fr, fl, rr, rl or cg.",
            show_default=False,
        ),
    ] = None,
    tune: Annotated[
        str | None,
        typer.Option(
            metavar="PARAM",
            help="Parameter of the cheap model that the surrogate PB tunes.",
            show_default="ms, or mb of a model of more wheels",
        ),
    ] = None,
    surrogate: Annotated[
        str | None,
        typer.Option(
            metavar="NAME", help="Take this surrogate, such as VB.", show_default="the one with the least error"
        ),
    ] = None,
    folds: Annotated[
        int | None,
        counted(
            "Folds of the cross-validation.",
            show_default="leave-one-out up to 30 runs, 10 folds beyond",
        ),
    ] = None,
    held_out: Annotated[int, counted("Runs that neither fits nor choice may see, for a last check.")] = 0,
    learning_curve: Annotated[
        bool, typer.Option("--learning-curve", help="Also fit to fewer runs each, to see how many were needed.")
    ] = False,
    refit: Annotated[
        bool,
        typer.Option(
            "--refit",
            help="Find the thetas of Kriging and the shapes of radial bases anew for every fold; also says the error "
            "without.",
        ),
    ] = False,
    next_runs: Annotated[
        int,
        counted(
            "Also name so many designs to run next, those that would tell most; with --out in next_runs.csv.", "--next"
        ),
    ] = 0,
    next_range: Annotated[
        list[str] | None,
        typer.Option(
            metavar="NAME=LO:HI,...",
            help="Bounds of these designs, such as ks=16N/mm:24N/mm.",
            show_default="where the runs lie; of an FMU --range",
        ),
    ] = None,
    trust_units: TrustUnits = False,
    seed: Annotated[int, counted("Of folds and held-out runs.")] = 0,
    out: Annotated[
        Path | None,
        typer.Option(
            metavar="FOLDER",
            help="Write surrogate.json, report.html, report.md, tables and figures here, with --next next_runs.csv; "
            "without it nothing is written.",
            show_default=False,
        ),
    ] = None,
    force: Force = False,
    as_json: Json = False,
) -> None:
    """Tune a cheap model to runs of an expensive one, or find what does better.

    Reads a table of runs, fits every surrogate, ranks them by cross-validated
    error and prints the best, beside what the same runs give without the
    cheap model. A line of units may follow the header.

    susp-ss fit runs.csv --inputs ks,cs --outputs bacc,sws,dtl --out fit
    susp-ss fit runs.csv --inputs ks,cs --outputs bacc --next 5 --out fit
    susp-ss fit --fmu model.fmu --runs 30 --inputs ks,cs --range ks=16N/mm:24N/mm,cs=1000:2000 --outputs bacc
    """
    if out is not None:
        from ..fit import Fit

        check_result(out, Fit, force)
    columns = _named("--inputs", inputs), _named("--outputs", outputs)
    stated = _pairs("--units", units or [])
    given = {"--designs": designs, "--cut": cut, "--sheet": sheet, "--decimal": decimal}
    _check_source(runs or [], fmu, histories, {option for option, value in given.items() if value is not None})
    if next_range and not next_runs:
        raise Refusal("--next-range is for --next")
    box = box_of("--next-range", ranges_of("--next-range", next_range or []), columns[0], trust_units)
    start = number("--cut", cut or (CUT if fmu else "0"))
    with refusals():
        from ..fit import LowFidelity, fit_runs, read_histories, read_runs

        if fmu:
            table = fmu.run(*columns, stated, road, start, weighting, trust_units, seed)
        elif histories:
            table = read_histories(
                runs or [],
                *columns,
                start,
                designs=designs,
                time=time,
                weighting=weighting,
                units=stated,
                decimal=decimal,
                progress=True,
            )
        else:
            (path,) = runs or []
            table = read_runs(path, *columns, stated, decimal=decimal, sheet=sheet)
        fit = fit_runs(
            table,
            LowFidelity(vehicle, road, at, tune or ("ms" if hasattr(vehicle, "ms") else "mb"), weighting),
            choose=surrogate,
            folds=folds,
            held_out_runs=held_out,
            learning=learning_curve,
            refit=refit,
            next_runs=next_runs,
            next_box=((fmu.box(columns[0], trust_units) if fmu else {}) | box) or None,
            trust_units=trust_units,
            random_state=seed,
            progress=True,
        )
    if table.noted:
        typer.echo(table.noted, err=True)
    if out is not None:
        from ..presentation.save import save

        with refusals(), Console(stderr=True).status(f"writing {out}"):
            save(fit, out, force=force)
    if as_json:
        from ..presentation.documents import fit_document

        typer.echo(json.dumps(fit_document(fit), indent=2))
    else:
        from ..presentation.text.fit import fit_text

        typer.echo(fit_text(fit), nl=False)


def _check_source(runs: list[Path], fmu: FmuRuns | None, histories: bool, given: set[str]) -> None:
    """Refuse what does not say where the runs come from, a table, histories or an FMU, or is for another of these."""
    if fmu and (runs or histories):
        raise Refusal(f"--fmu runs {fmu.path} in place of RUNS; pass one of them")
    if not fmu and not runs:
        raise Refusal("RUNS is missing: a table of expensive runs, histories, or --fmu FILE")
    if "--designs" in given and not histories:
        raise Refusal("--designs is for --histories")
    if "--cut" in given and not (histories or fmu):
        raise Refusal("--cut is for --histories and --fmu")
    if histories and "--cut" not in given:
        raise Refusal("--histories needs --cut, the start of each run that is left out, in s; 0 for none")
    if len(runs) > 1 and not histories:
        raise Refusal(f"RUNS is one table, got {len(runs)} files; pass --histories where each is a run over time")
    if "--sheet" in given and (histories or fmu):
        raise Refusal("--sheet is for one table of runs")
    if "--decimal" in given and fmu:
        raise Refusal("--decimal is for tables of runs")


def _named(option: str, given: list[str]) -> dict[str, str]:
    """Names in the package's terms, and the column of each."""
    columns: dict[str, str] = {}
    for text in names(given):
        column, equals, name = (part.strip() for part in text.partition("="))
        name = name if equals else column
        if not name or not column:
            raise Refusal(f"{option} must be NAME or COLUMN=NAME, such as K_S=ks, got {text!r}")
        if name in columns:
            raise Refusal(f"{option} names {name} twice")
        columns[name] = column
    return columns


def _pairs(option: str, given: list[str]) -> dict[str, str]:
    pairs = {}
    for text in names(given):
        name, equals, value = (part.strip() for part in text.partition("="))
        if not equals or not name or not value:
            raise Refusal(f"{option} must be NAME=UNIT, such as ks=N/mm, got {text!r}")
        pairs[name] = value
    return pairs
