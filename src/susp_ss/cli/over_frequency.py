"""What commands over frequency share: the grid of frequencies, which rows of a result are wanted, and their table."""

from typing import TYPE_CHECKING, Annotated

import typer

from ..quantities import Quantity
from .options import counted, measured, names
from .refusals import Refusal

if TYPE_CHECKING:
    import xarray as xr
    from numpy.typing import NDArray

FREQUENCY = Quantity("frequency", "Hz", "frequency", bound="> 0")

Output = Annotated[
    list[str] | None,
    typer.Option(
        metavar="NAME,...",
        help="What moves, such as bacc_cg, sws_fr or pitch_acc; may be repeated.",
        show_default="bacc, sws and dtl at the first wheel",
    ),
]


def frequencies(
    *,
    lowest: Annotated[str, typer.Option("--from", metavar="Hz", help="Lowest frequency.")] = "0.1",
    highest: Annotated[str, typer.Option("--to", metavar="Hz", help="Highest frequency.")] = "50",
    points: Annotated[int, counted("Frequencies, evenly on a log scale.")] = 500,
) -> "NDArray":
    """Frequencies in Hz from options."""
    import numpy as np

    low, high = measured("--from", lowest, FREQUENCY, True), measured("--to", highest, FREQUENCY, True)
    if not 0.0 < low < high < float("inf"):
        raise Refusal(f"--from and --to must be 0 < from < to in Hz, got {low:g} and {high:g}")
    if points < 2:
        raise Refusal(f"--points must be >= 2, got {points}")
    return np.geomspace(low, high, points)


def chosen(response: "xr.DataArray", dim: str, given: list[str] | None, otherwise: tuple[str, ...]) -> "xr.DataArray":
    """The rows of a dim that an option of its name wants."""
    wanted, available = names(given) if given else otherwise, response[dim].values.tolist()
    if not wanted:
        raise Refusal(f"--{dim} names none, available: {', '.join(available)}")
    for name in wanted:
        if name not in available:
            raise Refusal(f"--{dim}: no {dim} named {name!r}, available: {', '.join(available)}")
    return response.sel({dim: list(dict.fromkeys(wanted))})


def csv_text(header: list[str], columns: list[list[float]]) -> str:
    """A table of numbers at full length under a header."""
    rows = [header, *([repr(number) for number in row] for row in zip(*columns, strict=True))]
    return "".join(",".join(row) + "\n" for row in rows)
