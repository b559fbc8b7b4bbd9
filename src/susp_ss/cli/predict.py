"""``susp-ss predict``: what a fitted surrogate says of designs."""

import json
import warnings
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer
from rich.table import Table

from ..quantities import Quantity, quantity_of, titled
from ..units import factor_of
from .folder import write_together
from .options import measured, names, number, print_table, range_parts, spaced, whole
from .refusals import Refusal, refusals

if TYPE_CHECKING:
    from collections.abc import Sequence

    import pandas as pd

    from ..fit.surrogate_file import SuspensionSurrogate

# Designs that a terminal bears; --out and --json hold all.
PRINTED = 30

# Share of the expensive model's responses that the bounds are to hold.
INTERVAL = 0.95


def run(
    surrogate: Annotated[Path, typer.Argument(metavar="FILE", help="surrogate.json of susp-ss fit.")],
    at: Annotated[
        list[str] | None,
        typer.Option(
            metavar="NAME=VALUE,...",
            help="One design, a value for every input, in the units of the fit or with its own: ks=18N/mm,cs=1500; may "
            "be repeated.",
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
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON, with its units, in place of a table.")] = False,
) -> None:
    """Predict what an expensive model would give, by a surrogate fitted to it.

    Prints every output between the bounds that are to hold 95 % of what the expensive
    model would give, in the units of the runs of the fit, with the error at runs left
    out, and says which designs lie outside the runs of the fit: of the error there
    nothing is known, and no bounds hold.

    susp-ss predict fit/surrogate.json --at ks=18000,cs=1500
    """
    from .. import ExtrapolationWarning, load_surrogate
    from ..surrogates.intervals import NoIntervalWarning

    if bool(at) == (grid is not None):
        raise Refusal("pass designs by --at NAME=VALUE,... or by --grid, one of the two")
    if out is not None and out.exists() and not force:
        raise Refusal(f"--out {out} exists already; pass --force to replace it")
    with refusals():
        fitted = load_surrogate(surrogate)
    designs = _designs(fitted, at) if at else _grid(fitted, grid or "")
    with refusals(), warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always", NoIntervalWarning)
        # The column outside says it, design by design.
        warnings.simplefilter("ignore", ExtrapolationWarning)
        table = designs.join(fitted.predict(designs, interval=INTERVAL).dropna(axis="columns", how="all"))
    lacking = [str(one.message) for one in caught if issubclass(one.category, NoIntervalWarning)]
    for name in table:
        table[name] /= _scale(fitted, _own(str(name)))[1]
    table["outside"] = fitted.outside(designs)
    if out is not None:
        with refusals():
            write_together(out.parent, {out.name: lambda path: table.to_csv(path, index=False)})
    if as_json:
        typer.echo(json.dumps(_document(fitted, table, lacking), indent=2))
    else:
        _print(fitted, table)
        if len(lacking) < len(fitted.outputs):
            typer.echo(f"in brackets: bounds that are to hold {INTERVAL:.0%} of what the expensive model gives")
        through = [f"{output} is weighted, through {name}" for output, name in _weightings(fitted).items()]
        for line in (*through, *_errors(fitted), *lacking):
            typer.echo(line)


def _scale(fitted: "SuspensionSurrogate", name: str) -> tuple[str, float]:
    """The unit in which the runs of the fit stated an input or output, and how much of the SI unit it is."""
    own = {**fitted.inputs, **fitted.outputs}[name]
    quantity, unit = quantity_of(name), fitted.stated.get(name, own)
    return unit, (factor_of(unit, quantity) if quantity else None) or 1.0


def _value(fitted: "SuspensionSurrogate", option: str, name: str, text: str) -> float:
    """A number in SI units; without a unit it is in the fit's."""
    unit, factor = _scale(fitted, name)
    if text.strip()[-1:].isdigit() or text.strip().endswith("."):
        return number(f"{option} {name}", text) * factor
    return measured(f"{option} {name}", text, quantity_of(name) or Quantity(name, unit, name), True)


def _designs(fitted: "SuspensionSurrogate", at: list[str]) -> "pd.DataFrame":
    import pandas as pd

    settings = [_settings(fitted, "--at", one) for one in at]
    rows = [{name: _value(fitted, "--at", name, text) for name, text in design.items()} for design in settings]
    return pd.DataFrame(rows, columns=list(fitted.inputs))


def _grid(fitted: "SuspensionSurrogate", text: str) -> "pd.DataFrame":
    import numpy as np
    import pandas as pd

    if "=" in text:
        settings = _settings(fitted, "--grid", text)
        axes = [_axis(fitted, name, settings[name]) for name in fitted.inputs]
    else:
        count = whole("--grid", text, 1)
        axes = [np.linspace(*fitted.box[name], count).tolist() for name in fitted.inputs]
    return pd.MultiIndex.from_product(axes, names=list(fitted.inputs)).to_frame(index=False)


def _axis(fitted: "SuspensionSurrogate", name: str, text: str) -> "Sequence[float]":
    """Values of an input of a grid, one or a range, in SI units."""
    if ":" not in text:
        return [_value(fitted, "--grid", name, text)]
    low, high, count = range_parts(f"--grid {name}", text)
    ends = (_value(fitted, "--grid", name, low), _value(fitted, "--grid", name, high))
    return list(spaced(f"--grid {name}", text, *ends, count))


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


def _own(column: str) -> str:
    """The input or output that a column is of."""
    return column.removesuffix("_low").removesuffix("_high")


def _rmse(fitted: "SuspensionSurrogate", output: str) -> float | None:
    """The error at runs left out, in the unit of the fit's runs."""
    rmse = fitted.left_out_rmse(output)
    return None if rmse is None else rmse / _scale(fitted, output)[1]


def _weightings(fitted: "SuspensionSurrogate") -> dict[str, str]:
    """What outputs are weighted by, those that are."""
    through = {output: fitted.low_fidelity.through(output) for output in fitted.outputs}
    return {output: one.name for output, one in through.items() if one is not None}


def _errors(fitted: "SuspensionSurrogate") -> list[str]:
    known = {output: _rmse(fitted, output) for output in fitted.outputs}
    return [
        f"{output}: at runs left out of the fit the RMSE is {rmse:.3g} {_scale(fitted, output)[0]}"
        for output, rmse in known.items()
        if rmse is not None
    ]


def _document(fitted: "SuspensionSurrogate", table: "pd.DataFrame", lacking: list[str]) -> dict[str, Any]:
    return {
        "interval": INTERVAL,
        "no_interval": lacking,
        "left_out_rmse": {output: _rmse(fitted, output) for output in fitted.outputs},
        "units": {name: _scale(fitted, name)[0] for name in (*fitted.inputs, *fitted.outputs)},
        "weightings": _weightings(fitted),
        "designs": table.to_dict("records"),
    }


def _print(fitted: "SuspensionSurrogate", table: "pd.DataFrame") -> None:
    shown, lowest = Table(), [f"{output}_low" for output in fitted.outputs if f"{output}_low" in table]
    plain = [*fitted.inputs, *fitted.outputs]
    for name in plain:
        shown.add_column(titled(name, _scale(fitted, name)[0]), justify="right")
    if table.outside.any():
        shown.add_column("")
    for _, row in table.head(PRINTED).iterrows():
        between = {
            low.removesuffix("_low"): f" ({row[low]:.5g} to {row[low.removesuffix('_low') + '_high']:.5g})"
            for low in lowest
        }
        values = [f"{row[name]:.5g}{between.get(name, '')}" for name in plain]
        shown.add_row(*values, *(["outside the runs"] if row.outside else []))
    print_table(shown)
    if len(table) > PRINTED:
        typer.echo(f"the first {PRINTED} of {len(table)} designs; --out FILE and --json give all")
    if table.outside.any():
        typer.echo(f"{table.outside.sum()} of {len(table)} designs lie outside the runs of the fit: extrapolated")
