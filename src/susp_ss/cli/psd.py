"""``susp-ss psd``: spectra of a vehicle's outputs on a random road, as figure and table."""

import json
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer
from rich.table import Table

from ..quantities import metric_and_place, signal, typeset, unit_of
from .documents import road_document
from .folder import check_folder, write_together
from .options import (
    Force,
    Json,
    Point,
    Weighting,
    body_points,
    built_from,
    print_table,
    road_from_options,
    vehicle_options,
    weightings,
)
from .over_frequency import Output, chosen, csv_text, frequencies
from .refusals import refusals

if TYPE_CHECKING:
    import xarray as xr
    from numpy.typing import NDArray

    from ..roads.road import Road
    from ..vehicles.contract import RoadVehicle
    from ..vehicles.vehicle import Vehicle

TABLE, FIGURE = "psd.csv", "psd.png"

# Highest peaks of a spectrum that the table shows.
PEAKS = 3


@built_from(vehicle=vehicle_options(), road=road_from_options, frequency=frequencies)
def run(
    vehicle: "Vehicle",
    road: "Road",
    frequency: "NDArray",
    output: Output = None,
    weighting: Weighting = None,
    point: Point = None,
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
    """One-sided spectra of a vehicle's ride on a random road.

    In squared units per Hz: bacc (m/s^2), sws (m), dtl (N), pitch_acc and
    roll_acc (rad/s^2). The table has their highest peaks, and the root mean square of
    what lies between --from and --to.
    """
    from .. import psd

    if out is not None:
        check_folder(out, (TABLE, FIGURE), force)
    asked: Any = vehicle
    with refusals():
        points = body_points(point or [])
        asked = vehicle.with_points(points) if points else vehicle
        spectra = _weighted(psd(asked, road, frequency), asked, weightings(weighting or []))
    first = next(iter(vehicle.wheels))
    spectra = chosen(spectra, "output", output, tuple(signal(kind, first) for kind in ("bacc", "sws", "dtl")))
    if out is not None:
        with refusals():
            header = ["frequency (Hz)", *(f"{name} ({_unit(name)})" for name in spectra.output.values.tolist())]
            table = csv_text(header, [spectra.frequency.values.tolist(), *spectra.values.tolist()])
            figure = _figure(vehicle, spectra)
            write_together(out, {TABLE: lambda path: path.write_text(table), FIGURE: figure.savefig})
    if as_json:
        typer.echo(json.dumps(_document(vehicle, road, spectra)))
    else:
        _print(vehicle, road, spectra)


def _weighted(spectra: "xr.DataArray", vehicle: "RoadVehicle", given: Any) -> "xr.DataArray":
    """Spectra through the weightings of their outputs, which attributes name."""
    import numpy as np

    from ..metrics.weightings import filters

    weighted, omega = filters(given, vehicle.layout()), 2.0 * np.pi * spectra.frequency.values
    by_output = {}
    for name in spectra.output.values.tolist():
        metric, _ = metric_and_place(name)
        if metric in weighted:
            spectra.loc[{"output": name}] *= weighted[metric].power(omega)
            by_output[name] = weighted[metric].name
    return spectra.assign_attrs(weighting=by_output)


def _unit(output: str) -> str:
    unit = unit_of(output)
    return f"({unit})^2/Hz" if "/" in unit else f"{unit}^2/Hz" if unit else "1/Hz"


def _document(vehicle: "Vehicle", road: "Road", spectra: "xr.DataArray") -> dict[str, Any]:
    from ..vehicles.files import vehicle_table

    weighting = spectra.attrs["weighting"]
    return {
        "vehicle": vehicle_table(vehicle),
        "road": road_document(road),
        "frequency": {"unit": "Hz", "values": spectra.frequency.values.tolist()},
        "spectra": [
            {
                "output": name,
                **({"weighting": weighting[name]} if name in weighting else {}),
                "unit": _unit(name),
                "values": spectra.sel(output=name).values.tolist(),
                "rms": {"unit": unit_of(name), "value": _rms(spectra.sel(output=name))},
            }
            for name in spectra.output.values.tolist()
        ],
    }


def _rms(spectrum: "xr.DataArray") -> float:
    """Root mean square of what lies on the grid, whose integral over log frequency is smooth."""
    import numpy as np

    f = spectrum.frequency.values
    return float(np.sqrt(np.trapezoid(spectrum.values * f, np.log(f))))


def _print(vehicle: "Vehicle", road: "Road", spectra: "xr.DataArray") -> None:
    from scipy.signal import find_peaks

    frequency = spectra.frequency.values
    span = f"{frequency[0]:g} to {frequency[-1]:g} Hz"
    table = Table("output", "weighting", "unit")
    for name in ("RMS", "peak (Hz)", "density there"):
        table.add_column(name, justify="right")
    for name in spectra.output.values.tolist():
        values = spectra.sel(output=name).values
        peaks = sorted(find_peaks(values)[0], key=lambda at: -values[at])[:PEAKS]
        cells = [(f"{frequency[at]:.3g}", f"{values[at]:.4g}") for at in peaks] or [("none", "")]
        weighting, unit = spectra.attrs["weighting"].get(name, ""), typeset(unit_of(name))
        table.add_row(name, weighting, unit, f"{_rms(spectra.sel(output=name)):.4g}", *cells[0])
        for more in cells[1:]:
            table.add_row("", "", "", "", *more)
    typer.echo(f"{type(vehicle).__name__}; {typeset(road.describe())}; spectra from {span}")
    print_table(table)


def _figure(vehicle: "Vehicle", spectra: "xr.DataArray") -> Any:
    from ..presentation.plots import spectra as drawn

    return drawn({type(vehicle).__name__: spectra})
