"""``susp-ss road``: profiles synthesised, read, fitted, drawn and rated, and obstacles."""

import io
import json
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer
from rich.table import Table

from ..quantities import Quantity
from .commands import Command, Commands
from .documents import road_document
from .folder import check_result
from .options import Force, Json, bounds, built_from, counted, measured, number, print_table, road_from_options
from .refusals import Refusal, refusals

if TYPE_CHECKING:
    import xarray as xr

    from ..roads.road import Road

app = typer.Typer(cls=Commands, no_args_is_help=True, help="Road profiles: synthesise, read, fit, draw and rate them.")

LENGTH = Quantity("length", "m", "length", bound="> 0")

PICTURES = (".png", ".svg", ".pdf")


def _length(help: str, *flags: str, **shown: Any) -> Any:
    return typer.Option(*flags, metavar="m", help=help, **shown)


ProfileOut = Annotated[
    Path | None,
    typer.Option(
        "--out",
        metavar="FILE",
        help="Write the profile here, as .csv or .nc; without it nothing is written.",
        show_default=False,
    ),
]


def profile_from_options(
    file: Annotated[
        Path,
        typer.Argument(
            metavar="FILE", help="Profile as text (.csv, .txt, .tsv, .dat), NetCDF (.nc) or OpenCRG (.crg)."
        ),
    ],
    x: Annotated[
        str | None, typer.Option(metavar="NAME", help="Column of the distance.", show_default="by its name")
    ] = None,
    left: Annotated[
        str | None, typer.Option(metavar="NAME", help="Column of the left track.", show_default="by its name")
    ] = None,
    right: Annotated[
        str | None, typer.Option(metavar="NAME", help="Column of the right track.", show_default="by its name")
    ] = None,
    unit: Annotated[
        list[str] | None,
        typer.Option(
            metavar="COLUMN=UNIT",
            help="Unit of x, left or right, such as left=mm; may be repeated.",
            show_default="the file's, or m",
        ),
    ] = None,
    decimal: Annotated[
        str | None, typer.Option(metavar=".|,", help="Decimal sign of text.", show_default="as the cells tell")
    ] = None,
    track_width: Annotated[
        str | None, _length("Distance of the tracks taken from an OpenCRG surface.", show_default="1.446")
    ] = None,
) -> "xr.Dataset":
    """Read the profile that the options describe."""
    from ..roads.profile_files import read_profile

    units = {name.strip(): stated.strip() for name, _, stated in (part.partition("=") for part in unit or ())}
    if "" in units.values():
        raise Refusal(f"--unit must be COLUMN=UNIT, such as left=mm, got {' '.join(unit or ())!r}")
    columns = {name: column for name, column in (("x", x), ("left", left), ("right", right)) if column is not None}
    wide = {} if track_width is None else {"track_width": measured("--track-width", track_width, LENGTH)}
    with refusals():
        return read_profile(file, columns=columns or None, units=units or None, decimal=decimal, **wide)


@app.command("synthesise", cls=Command)
@built_from(road=road_from_options)
def synthesise(
    road: "Road",
    length: Annotated[str, _length("Length of the profile.")] = "1000",
    step: Annotated[str, _length("Distance of its points.")] = "0.05",
    track_width: Annotated[str, _length("Distance of the tracks.")] = "1.446",
    seed: Annotated[int, counted("Seed; the same draws the same profile.")] = 0,
    out: ProfileOut = None,
    force: Force = False,
    as_json: Json = False,
) -> None:
    """A random profile of two tracks with the spectrum and the coherence of a road.

    What the road's options say of speed, delay and wheels does not matter.
    """
    from ..roads.profiles import synthesise as synthesised

    _check_out(out, force, (".csv", ".nc"))
    sizes = {"length": length, "step": step, "track_width": track_width}
    given = {name: measured(f"--{name.replace('_', '-')}", text, LENGTH) for name, text in sizes.items()}
    with refusals():
        profile = synthesised(road, seed=seed, **given)
    _write(profile, out)
    _say(profile, as_json, {"road": road_document(road), "seed": seed})


@app.command("read", cls=Command)
@built_from(profile=profile_from_options)
def read(profile: "xr.Dataset", out: ProfileOut = None, force: Force = False, as_json: Json = False) -> None:
    """What a file holds: length, spacing and heights of its profile, in m.

    A gap, a distance that does not rise, or heights that no road has, are refused by their line.
    """
    _check_out(out, force, (".csv", ".nc"))
    _write(profile, out)
    _say(profile, as_json, dict(profile.attrs))


@app.command("fit", cls=Command)
@built_from(profile=profile_from_options)
def fit(
    profile: "xr.Dataset",
    confidence: Annotated[str, typer.Option(metavar="P", help="Confidence of the intervals.")] = "0.95",
    track_width: Annotated[
        str | None, _length("Distance of the tracks.", show_default="the profile's, or 1.446")
    ] = None,
    out: Annotated[
        Path | None,
        typer.Option(
            metavar="FOLDER",
            help="Write fitted_road.csv, fitted_road.json and fitted_road.png here; without it nothing is written.",
            show_default=False,
        ),
    ] = None,
    force: Force = False,
    as_json: Json = False,
) -> None:
    """Roughness, waviness, ISO 8608 class and tracks of a profile, each with its interval.

    One power of the wavenumber, or two with a knee where the profile asks for it.
    """
    from ..presentation.report import report
    from ..roads.road_fit import FittedRoad, fit_road

    if out is not None:
        check_result(out, FittedRoad, force)
    wide = {} if track_width is None else {"track_width": measured("--track-width", track_width, LENGTH)}
    with refusals():
        road = fit_road(profile, confidence=number("--confidence", confidence), **wide)
        text = report(road)
        if out is not None:
            from ..presentation.save import save

            save(road, out, force)
    if not as_json:
        typer.echo(text)
        return
    from ..presentation.documents import fitted_road_document

    typer.echo(json.dumps({**profile.attrs, **fitted_road_document(road)}, indent=2))


@app.command("chart", cls=Command)
@built_from(profile=profile_from_options)
def chart(
    profile: "xr.Dataset",
    out: Annotated[Path, typer.Option("--out", metavar="FILE", help="The picture: .png, .svg or .pdf.")],
    force: Force = False,
) -> None:
    """The spectrum of a profile and the road fitted to it, among the classes of ISO 8608."""
    from ..presentation.plots import road_chart
    from ..roads.road_fit import fit_road

    _check_out(out, force, PICTURES)
    picture = io.BytesIO()
    with refusals():
        road = fit_road(profile)
        figure = road_chart({f"{Path(profile.attrs['file']).name}: class {road.iso_class}": road})
        figure.savefig(picture, format=out.suffix[1:])
    _write_whole(out, picture.getvalue())


@app.command("obstacle", cls=Command)
def obstacle(
    kind: Annotated[
        str,
        typer.Argument(metavar="KIND", help="kerb, ramp, bump, speed-table, pothole, plank or swept-sine."),
    ],
    height: Annotated[str | None, _length("Height, of a pothole its depth.", show_default="the kind's")] = None,
    length: Annotated[str | None, _length("Whole length.", show_default="the kind's")] = None,
    edge: Annotated[str | None, _length("Length of each slope.", show_default="the kind's")] = None,
    wavelengths: Annotated[
        str | None,
        typer.Option(metavar="FROM:TO", help="Wavelengths of a swept sine, in m, falling.", show_default="10:0.5"),
    ] = None,
    track: Annotated[str, typer.Option(metavar="NAME", help="both, left or right.")] = "both",
    before: Annotated[str, _length("Level road before it.")] = "5",
    after: Annotated[str, _length("Level road after it.")] = "30",
    step: Annotated[str, _length("Points are no further apart.")] = "0.01",
    out: ProfileOut = None,
    force: Force = False,
    as_json: Json = False,
) -> None:
    """The profile of a level road with one obstacle."""
    from ..roads.obstacles import obstacle as made

    _check_out(out, force, (".csv", ".nc"))
    texts = {"height": height, "length": length, "edge": edge, "before": before, "after": after, "step": step}
    given: dict[str, Any] = {
        name: measured(f"--{name}", text, LENGTH) for name, text in texts.items() if text is not None
    }
    if wavelengths is not None:
        given["wavelengths"] = bounds("--wavelengths", wavelengths, LENGTH, True)
    with refusals():
        profile = made(kind.replace("-", " "), track=track, **given)
    _write(profile, out)
    _say(profile, as_json, dict(profile.attrs))


@app.command("iri", cls=Command)
@built_from(profile=profile_from_options)
def iri(
    profile: "xr.Dataset",
    segment: Annotated[
        str | None, _length("Length of the segments that get an index each.", show_default="the whole profile")
    ] = None,
    as_json: Json = False,
) -> None:
    """International roughness index of each track of a profile, in m/km."""
    from ..roads.iri import iri as index

    length = None if segment is None else measured("--segment", segment, LENGTH)
    with refusals():
        found = index(profile, segment=length)
    tracks = found.track.values.tolist()
    if as_json:
        document = {
            **profile.attrs,
            "unit": "m/km",
            **{track: found.sel(track=track).values.tolist() for track in tracks},
        }
        document |= (
            {} if length is None else {"from": found.segment.values.tolist(), "length": found.length.values.tolist()}
        )
        typer.echo(json.dumps(document, indent=2))
        return
    table = Table("from (m)", "to (m)", *(f"{track} (m/km)" for track in tracks))
    if length is None:
        x = profile.x.values
        table.add_row(f"{x[0]:g}", f"{x[-1]:g}", *(f"{float(found.sel(track=track)):.3f}" for track in tracks))
    else:
        for start, long, row in zip(
            found.segment.values, found.length.values, found.transpose("segment", ...), strict=True
        ):
            table.add_row(f"{start:g}", f"{start + long:g}", *(f"{value:.3f}" for value in row.values))
    print_table(table)


# What is written and said


def _check_out(out: Path | None, force: bool, suffixes: tuple[str, ...]) -> None:
    """Refuse a file before any work is done."""
    if out is None:
        return
    if out.suffix.lower() not in suffixes:
        raise Refusal(f"--out must end in {' or '.join(suffixes)}, got {out}")
    if out.is_dir():
        raise Refusal(f"--out {out} is a folder")
    if not out.parent.is_dir():
        raise Refusal(f"--out {out}: there is no folder {out.parent}")
    if out.exists() and not force:
        raise Refusal(f"--out {out} exists already; pass --force to replace it")


def _write(profile: "xr.Dataset", out: Path | None) -> None:
    if out is None:
        return
    if out.suffix.lower() == ".nc":
        _write_whole(out, bytes(profile.to_netcdf(engine="scipy")))
        return
    columns = {"x": "x [m]", "left": "left [m]", "right": "right [m]"}
    frame = profile.to_dataframe().reset_index()[list(columns)].rename(columns=columns)
    _write_whole(out, frame.to_csv(index=False, float_format="%.10g"))


def _write_whole(out: Path, content: str | bytes) -> None:
    from ..fit.whole_file import write_whole

    with refusals():
        write_whole(out, content)


def _summary(profile: "xr.Dataset") -> dict[str, float]:
    """What can be told of a profile at a glance, in m."""
    import numpy as np

    x = profile.x.values
    steps = np.diff(x)
    said = {"length": x[-1] - x[0], "points": len(x)}
    said |= {"smallest step": steps.min(), "mean step": steps.mean(), "largest step": steps.max()}
    for side in ("left", "right"):
        z = profile[side].values
        said |= {f"{side}, lowest": z.min(), f"{side}, highest": z.max(), f"{side}, RMS about the mean": z.std()}
    return {name: value.item() if isinstance(value, np.generic) else value for name, value in said.items()}


def _say(profile: "xr.Dataset", as_json: bool, about: dict[str, Any]) -> None:
    summary = _summary(profile)
    if as_json:
        plain = {name.replace(", ", "_").replace(" ", "_"): value for name, value in summary.items()}
        typer.echo(json.dumps({**about, "profile": plain}, indent=2))
        return
    table = Table("profile")
    table.add_column("value", justify="right")
    table.add_column("unit")
    for name, value in summary.items():
        table.add_row(name, f"{value:d}" if name == "points" else f"{value:.5g}", "" if name == "points" else "m")
    print_table(table)
