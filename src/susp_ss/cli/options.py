"""Options that several commands share: the vehicle, the road, and where results go."""

import dataclasses
import inspect
import math
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer
from rich.console import Console
from rich.table import Table

from .refusals import Refusal, refusals

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from ..roads import Road
    from ..vehicles import Vehicle


def built_from(**builders: Callable[..., Any]) -> Callable[[Callable[..., None]], Callable[..., None]]:
    """Give a command the options of the functions that build its arguments.

    ``@built_from(road=road_from_options)`` replaces the command's parameter ``road`` on the command line by the
    parameters of ``road_from_options``, and passes what that returns.
    """

    def decorate(command: Callable[..., None]) -> Callable[..., None]:
        options = {name: inspect.signature(builder).parameters for name, builder in builders.items()}
        own = [p for name, p in inspect.signature(command).parameters.items() if name not in builders]
        shared = [p for parameters in options.values() for p in parameters.values()]

        def run(**given: Any) -> None:
            arguments = {name: builders[name](**{key: given.pop(key) for key in options[name]}) for name in builders}
            command(**arguments, **given)

        keyword_only = [p.replace(kind=inspect.Parameter.KEYWORD_ONLY) for p in (*shared, *own)]
        run.__signature__ = inspect.Signature(keyword_only)  # type: ignore[attr-defined]
        run.__doc__ = command.__doc__
        return run

    return decorate


def _parameter(unit: str, meaning: str) -> Any:
    return typer.Option(metavar=unit, help=meaning, rich_help_panel="Vehicle", show_default=False)


def vehicle_from_options(
    model: Annotated[
        str | None,
        typer.Option(
            metavar="NAME",
            help="full, quarter, rigid-tyre, pitch-half or roll-half.",
            show_default="the vehicle file's, or full",
            rich_help_panel="Vehicle",
        ),
    ] = None,
    vehicle: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE",
            help="TOML file of a vehicle, as susp-ss metrics --template prints it. The options below override its "
            "values, or the model's defaults.",
            rich_help_panel="Vehicle",
            show_default=False,
        ),
    ] = None,
    ms: Annotated[float | None, _parameter("kg", "Sprung mass.")] = None,
    mb: Annotated[float | None, _parameter("kg", "Body mass.")] = None,
    mu: Annotated[float | None, _parameter("kg", "Unsprung mass, each wheel.")] = None,
    ixx: Annotated[float | None, _parameter("kg m^2", "Roll inertia.")] = None,
    iyy: Annotated[float | None, _parameter("kg m^2", "Pitch inertia.")] = None,
    a: Annotated[float | None, _parameter("m", "Front axle to centre of gravity.")] = None,
    b: Annotated[float | None, _parameter("m", "Rear axle to centre of gravity.")] = None,
    c: Annotated[float | None, _parameter("m", "Half track width.")] = None,
    ks: Annotated[float | None, _parameter("N/m", "Spring stiffness, each wheel.")] = None,
    cs: Annotated[float | None, _parameter("N s/m", "Damping rate, each wheel.")] = None,
    kt: Annotated[float | None, _parameter("N/m", "Tyre stiffness, each wheel.")] = None,
    ct: Annotated[float | None, _parameter("N s/m", "Tyre damping, each wheel.")] = None,
    arb: Annotated[float | None, _parameter("N/m", "Anti-roll bar of a roll half car.")] = None,
    arb_front: Annotated[float | None, _parameter("N/m", "Front anti-roll bar.")] = None,
    arb_rear: Annotated[float | None, _parameter("N/m", "Rear anti-roll bar.")] = None,
) -> "Vehicle":
    """Make the vehicle that a file and options describe; options override the file."""
    fields = {"ms": ms, "mb": mb, "mu": mu, "ixx": ixx, "iyy": iyy, "a": a, "b": b, "c": c}
    fields |= {"ks": ks, "cs": cs, "kt": kt, "ct": ct, "arb": arb, "arb_front": arb_front, "arb_rear": arb_rear}
    given = {name: value for name, value in fields.items() if value is not None}

    from ..vehicles.files import model_name, model_named, read_vehicle

    with refusals():
        car = model_named("full" if model is None else model)() if vehicle is None else read_vehicle(vehicle)
        if model is not None and type(car) is not model_named(model):
            raise Refusal(f"--model {model}, but {vehicle} holds the model {model_name(car)!r}")
    known = [field.name for field in dataclasses.fields(car)]
    for name in given:
        if name not in known:
            raise Refusal(
                f"{flag(name)}: {type(car).__name__} has no parameter {name!r}, available: {', '.join(known)}"
            )
    with refusals():
        return dataclasses.replace(car, **given)


def road_from_options(
    road_class: Annotated[
        str | None,
        typer.Option(
            metavar="A-H",
            help="ISO 8608 class, by its geometric mean roughness.",
            show_default="B",
            rich_help_panel="Road",
        ),
    ] = None,
    roughness: Annotated[
        float | None,
        typer.Option(
            metavar="m^3",
            help="G_d(0.1 cycle/m), in place of a class.",
            show_default=False,
            rich_help_panel="Road",
        ),
    ] = None,
    speed: Annotated[float, typer.Option(metavar="m/s", help="Speed.", rich_help_panel="Road")] = 20.0,
    waviness: Annotated[
        float, typer.Option(metavar="W", help="Exponent of the spectrum, 1 to 4.", rich_help_panel="Road")
    ] = 2.0,
    cutoff: Annotated[
        float, typer.Option(metavar="cycle/m", help="Low-wavenumber cut-off.", rich_help_panel="Road")
    ] = 0.0,
    tracks: Annotated[
        str,
        typer.Option(
            metavar="NAME",
            help="How left and right relate: identical, independent or isotropic.",
            rich_help_panel="Road",
        ),
    ] = "identical",
    delay: Annotated[
        bool,
        typer.Option(
            "--delay/--no-delay",
            help="The rear wheels meet the road a wheelbase later, or with the front.",
            rich_help_panel="Road",
        ),
    ] = True,
    wheels: Annotated[
        str | None,
        typer.Option(
            metavar="NAME,...",
            help="Only these wheels meet the road, the others a flat one.",
            show_default="all",
            rich_help_panel="Road",
        ),
    ] = None,
) -> "Road":
    """Make the road that the options describe."""
    from ..roads import Road

    if road_class is not None and roughness is not None:
        raise Refusal("--road-class and --roughness are two ways to say one thing; pass one of them")
    only = None if wheels is None else names([wheels])
    with refusals():
        road = Road.iso8608("B" if road_class is None else road_class)
        if roughness is not None:
            road = Road(roughness=roughness)
        rest: Any = {"speed": speed, "waviness": waviness, "cutoff": cutoff, "tracks": tracks, "delay": delay}
        return dataclasses.replace(road, **rest, wheels=only)


Json = Annotated[bool, typer.Option("--json", help="Print JSON, SI units, in place of tables.")]
Force = Annotated[bool, typer.Option("--force", help="Replace the results of an earlier run in the folder.")]


def print_table(table: Table) -> None:
    """Print a table at its full width: a number cut short to fit a terminal would be a wrong number."""
    Console(width=1000).print(table)


def flag(parameter: str) -> str:
    """Name of a parameter's option."""
    return f"--{parameter.replace('_', '-')}"


def names(given: list[str]) -> tuple[str, ...]:
    """Names from options that may be repeated and may each hold several, with commas."""
    return tuple(name.strip() for text in given for name in text.split(",") if name.strip())


def nodes(where: str, text: str) -> "NDArray[np.float64]":
    """Values of ``LO:HI:N``, or a refusal that says where."""
    import numpy as np

    parts = text.split(":")
    if len(parts) != 3 or not parts[2].strip().isdecimal():
        raise Refusal(f"{where} must be LO:HI:N with a whole number N, such as 12e3:25e3:100, got {text!r}")
    low, high, count = number(where, parts[0]), number(where, parts[1]), int(parts[2])
    if count < 1:
        raise Refusal(f"{where}: N must be >= 1, got {text!r}")
    if not low <= high or (low == high and count > 1):
        raise Refusal(f"{where}: LO must be below HI, or equal to it with N = 1, got {text!r}")
    return np.linspace(low, high, count)


def number(where: str, text: str) -> float:
    """A finite number, or a refusal that says where."""
    try:
        number = float(text)
    except ValueError:
        number = math.nan
    if not math.isfinite(number):
        raise Refusal(f"{where} must be a number, or a range LO:HI:N of numbers, got {text!r}")
    return number
