"""``susp-ss bode``: frequency responses of a vehicle to the road's height, as figure and table."""

import json
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer
from rich.table import Table

from ..quantities import per_input, signal, typeset
from .folder import check_folder, write_together
from .options import Force, Json, built_from, print_table, vehicle_options
from .over_frequency import Output, chosen, csv_text, frequencies
from .refusals import refusals

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure
    from numpy.typing import NDArray

    from ..vehicles.vehicle import Vehicle

TABLE, FIGURE = "bode.csv", "bode.png"


@built_from(vehicle=vehicle_options(), frequency=frequencies)
def run(
    vehicle: "Vehicle",
    frequency: "NDArray",
    output: Output = None,
    input: Annotated[
        list[str] | None,
        typer.Option(
            metavar="NAME,...",
            help="Height of the road under which wheel, such as z_r_fr, or delta_f of a car that steers; may be "
            "repeated.",
            show_default="the first wheel",
        ),
    ] = None,
    out: Annotated[
        Path | None,
        typer.Option(
            metavar="FOLDER",
            help=f"Write {TABLE} and {FIGURE} here; without it nothing is written.",
            show_default=False,
        ),
    ] = None,
    force: Force = False,
    as_json: Json = False,
) -> None:
    """Magnitude and phase of a vehicle's responses to the height of the road under a wheel.

    Per metre of road height: bacc (m/s^2), sws (m), dtl (N), pitch_acc and
    roll_acc (rad/s^2). Phase in degrees, continuous over frequency.
    With --model ride-handling also per rad of a steering angle (--input delta_f).
    """
    from .. import frequency_response

    if out is not None:
        check_folder(out, (TABLE, FIGURE), force)
    with refusals():
        response = frequency_response(vehicle, frequency)
    first = next(iter(vehicle.wheels))
    response = chosen(response, "output", output, tuple(signal(kind, first) for kind in ("bacc", "sws", "dtl")))
    response = chosen(response, "input", input, (signal("z_r", first),))
    if out is not None:
        with refusals():
            table, figure = _csv(response), _figure(vehicle, response)
            write_together(out, {TABLE: lambda path: path.write_text(table), FIGURE: figure.savefig})
    if as_json:
        typer.echo(json.dumps(_document(vehicle, response)))
    else:
        _print(vehicle, response)


def _curves(response: "xr.DataArray") -> list[tuple[str, str, str, "NDArray", "NDArray"]]:
    """Output, input, unit, magnitude and phase in degrees of each curve."""
    import numpy as np

    from ..quantities import unit_of

    curves = []
    for output in response.output.values.tolist():
        for input in response.input.values.tolist():
            H = response.sel(output=output, input=input).values
            unit = f"{unit_of(output) or 1}/{per_input(input)}"
            curves.append((output, input, unit, np.abs(H), np.degrees(np.unwrap(np.angle(H)))))
    return curves


def _csv(response: "xr.DataArray") -> str:
    header, columns = ["frequency (Hz)"], [response.frequency.values.tolist()]
    for output, input, unit, magnitude, phase in _curves(response):
        header += [f"|{output}/{input}| ({unit})", f"phase {output}/{input} (deg)"]
        columns += [magnitude.tolist(), phase.tolist()]
    return csv_text(header, columns)


def _document(vehicle: "Vehicle", response: "xr.DataArray") -> dict[str, Any]:
    from ..vehicles.files import vehicle_table

    return {
        "vehicle": vehicle_table(vehicle),
        "frequency": {"unit": "Hz", "values": response.frequency.values.tolist()},
        "responses": [
            {
                "output": output,
                "input": input,
                "magnitude": {"unit": unit, "values": magnitude.tolist()},
                "phase": {"unit": "deg", "values": phase.tolist()},
            }
            for output, input, unit, magnitude, phase in _curves(response)
        ],
    }


def _print(vehicle: "Vehicle", response: "xr.DataArray") -> None:
    from scipy.signal import find_peaks

    frequency = response.frequency.values
    span = f"{frequency[0]:g} to {frequency[-1]:g} Hz"
    table = Table("output", "input", "unit")
    table.add_column("frequency (Hz)", justify="right")
    table.add_column("magnitude", justify="right")
    for output, input, unit, magnitude, _ in _curves(response):
        peaks = find_peaks(magnitude)[0]
        for peak in peaks:
            table.add_row(output, input, typeset(unit), f"{frequency[peak]:.3g}", f"{magnitude[peak]:.4g}")
        if not len(peaks):
            table.add_row(output, input, typeset(unit), "none", "")
    typer.echo(f"{type(vehicle).__name__}: peaks of the response to {_driven(response)}, {span}")
    print_table(table)


def _driven(response: "xr.DataArray") -> str:
    others = [name for name in response.input.values.tolist() if per_input(name) != "m"]
    return ", ".join(others) or "road height"


def _figure(vehicle: "Vehicle", response: "xr.DataArray") -> "Figure":
    from ..presentation.plots import bode

    inputs = response.input.values.tolist()
    curves = {f"road at {name}" if per_input(name) == "m" else name: response.sel(input=name) for name in inputs}
    figure = bode(curves, per="/".join(dict.fromkeys(map(per_input, inputs))))
    figure.suptitle(f"{type(vehicle).__name__}: response to {_driven(response)}", fontsize="medium")
    return figure
