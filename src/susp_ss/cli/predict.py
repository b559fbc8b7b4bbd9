"""``susp-ss predict``: what a fitted surrogate says of designs."""

import json
import warnings
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer
from rich.table import Table

from ..quantities import titled
from .folder import write_together
from .options import Json, names, nodes, number, print_table
from .refusals import Refusal, refusals

if TYPE_CHECKING:
    import pandas as pd

    from ..fit.surrogate_file import SuspensionSurrogate

# Designs that a terminal bears; --out and --json hold all.
PRINTED = 30


def run(
    surrogate: Annotated[Path, typer.Argument(metavar="FILE", help="surrogate.json of susp-ss fit.")],
    at: Annotated[
        list[str] | None,
        typer.Option(
            metavar="NAME=VALUE,...",
            help="One design, a value for every input: ks=18000,cs=1500; may be repeated.",
            show_default=False,
        ),
    ] = None,
    grid: Annotated[
        str | None,
        typer.Option(
            metavar="GRID",
            help="Every combination of N values of each input over the runs, with --grid N, or of those that "
            "--grid ks=12e3:24e3:20,cs=1500 gives.",
            show_default=False,
        ),
    ] = None,
    out: Annotated[
        Path | None,
        typer.Option(metavar="FILE", help="Write all designs to this CSV file.", show_default=False),
    ] = None,
    force: Annotated[bool, typer.Option("--force", help="Replace the file if it exists.")] = False,
    as_json: Json = False,
) -> None:
    """Predict what an expensive model would give, by a surrogate fitted to it.

    Prints every output, with its predictive standard deviation where the
    surrogate has one, in the units of the fit (SI), and says which designs lie
    outside the runs of the fit: of the error there nothing is known. Few smooth
    runs make the standard deviation too small; the fit's report tells how often
    it held.

    susp-ss predict fit/surrogate.json --at ks=18000,cs=1500
    """
    from .. import ExtrapolationWarning, load_surrogate

    if bool(at) == (grid is not None):
        raise Refusal("pass designs by --at NAME=VALUE,... or by --grid, one of the two")
    if out is not None and out.exists() and not force:
        raise Refusal(f"--out {out} exists already; pass --force to replace it")
    with refusals():
        fitted = load_surrogate(surrogate)
    designs = _designs(fitted, at) if at else _grid(fitted, grid or "")
    with refusals(), warnings.catch_warnings():
        # The column outside says it, design by design.
        warnings.simplefilter("ignore", ExtrapolationWarning)
        table = designs.join(fitted.predict(designs, return_std=True)).assign(outside=fitted.outside(designs))
    if out is not None:
        with refusals():
            write_together(out.parent, {out.name: lambda path: table.to_csv(path, index=False)})
    if as_json:
        typer.echo(json.dumps(_document(fitted, table), indent=2))
    else:
        _print(fitted, table)


def _designs(fitted: "SuspensionSurrogate", at: list[str]) -> "pd.DataFrame":
    import pandas as pd

    rows = [{name: number(f"--at {name}", text) for name, text in _settings(fitted, "--at", one).items()} for one in at]
    return pd.DataFrame(rows, columns=list(fitted.inputs))


def _grid(fitted: "SuspensionSurrogate", text: str) -> "pd.DataFrame":
    import pandas as pd

    if "=" in text:
        settings = _settings(fitted, "--grid", text)
    else:
        settings = {name: f"{low!r}:{high!r}:{text}" for name, (low, high) in fitted.box.items()}
    axes = [
        nodes(f"--grid {name}", settings[name]) if ":" in settings[name] else [number(f"--grid {name}", settings[name])]
        for name in fitted.inputs
    ]
    return pd.MultiIndex.from_product(axes, names=list(fitted.inputs)).to_frame(index=False)


def _settings(fitted: "SuspensionSurrogate", option: str, text: str) -> dict[str, str]:
    """The text for each input, all of them and no others."""
    settings = {}
    for setting in names([text]):
        name, equals, value = (part.strip() for part in setting.partition("="))
        if not equals or not value:
            raise Refusal(f"{option} must be NAME=VALUE,..., got {setting!r}")
        if name not in fitted.inputs:
            raise Refusal(f"{option}: no input named {name!r}, available: {', '.join(fitted.inputs)}")
        if name in settings:
            raise Refusal(f"{option} gives {name} twice")
        settings[name] = value
    missing = [name for name in fitted.inputs if name not in settings]
    if missing:
        raise Refusal(f"{option} needs a value for every input, missing: {', '.join(missing)}")
    return settings


def _document(fitted: "SuspensionSurrogate", table: "pd.DataFrame") -> dict[str, Any]:
    return {
        "units": {**fitted.inputs, **fitted.outputs},
        "designs": table.to_dict("records"),
    }


def _print(fitted: "SuspensionSurrogate", table: "pd.DataFrame") -> None:
    units = {**fitted.inputs, **fitted.outputs}
    shown = Table()
    for name in table.drop(columns="outside"):
        unit = units.get(str(name), units.get(str(name).removesuffix("_std"), ""))
        shown.add_column(titled(str(name), unit), justify="right")
    if table.outside.any():
        shown.add_column("")
    for row in table.head(PRINTED).itertuples(index=False):
        *values, outside = row
        shown.add_row(*(f"{value:.5g}" for value in values), *(["outside the runs"] if outside else []))
    print_table(shown)
    if len(table) > PRINTED:
        typer.echo(f"the first {PRINTED} of {len(table)} designs; --out FILE and --json give all")
    if table.outside.any():
        typer.echo(f"{table.outside.sum()} of {len(table)} designs lie outside the runs of the fit: extrapolated")
