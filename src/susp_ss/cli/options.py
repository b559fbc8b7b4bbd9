"""Options that several commands share: the vehicle, the road, and where results go."""

import dataclasses
import inspect
import math
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer
from rich.console import Console
from rich.table import Table

from ..quantities import PARAMETERS, ROAD
from ..vehicles import MODELS
from .refusals import Refusal, refusals

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from ..roads.road import Road
    from ..vehicles.vehicle import Vehicle


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


def vehicle_options(
    option: str = "model", default: str = "full", meaning: str = "The model", without: Sequence[str] = ()
) -> Callable[..., "Vehicle"]:
    """Return what makes the vehicle that a file and options describe, an option for every parameter there is.

    Parameters
    ----------
    option, default, meaning : str
        Name of the option that chooses the model, what it is without, and its help.
    without : sequence of str
        Parameters that have no option here.
    """

    def build(**given: Any) -> "Vehicle":
        return _vehicle(option, default, given.pop(option), given.pop("vehicle"), given)

    def optional(name: str, kind: Any, **shown: Any) -> inspect.Parameter:
        annotation = Annotated[kind, typer.Option(rich_help_panel="Vehicle", **shown)]
        return inspect.Parameter(name, inspect.Parameter.KEYWORD_ONLY, default=None, annotation=annotation)

    parameters = [
        optional(
            name,
            float | None,
            metavar=quantity.unit,
            help=f"{quantity.meaning.capitalize()}{', each wheel' if quantity.dim else ''}.",
            show_default=False,
        )
        for name, quantity in PARAMETERS.items()
        if name not in without
    ]
    model = optional(
        option,
        str | None,
        metavar="NAME",
        help=f"{meaning}: {', '.join(MODELS)}.",
        show_default=f"the vehicle file's, or {default}",
    )
    file = optional(
        "vehicle",
        Path | None,
        metavar="FILE",
        help="TOML file of a vehicle, as susp-ss metrics --template prints it. The options below override its values, "
        "or the model's defaults.",
        show_default=False,
    )
    build.__signature__ = inspect.Signature([model, file, *parameters])  # type: ignore[attr-defined]
    return build


def _vehicle(option: str, default: str, model: str | None, file: Path | None, given: dict[str, Any]) -> "Vehicle":
    from ..vehicles.files import model_name, model_named, read_vehicle

    with refusals():
        car = model_named(default if model is None else model)() if file is None else read_vehicle(file)
        if model is not None and type(car) is not model_named(model):
            raise Refusal(f"{flag(option)} {model}, but {file} holds the model {model_name(car)!r}")
    values = {name: value for name, value in given.items() if value is not None}
    for name in values:
        refuse_unknown(car, name, flag(name))
    with refusals():
        return dataclasses.replace(car, **values)


def refuse_unknown(car: "Vehicle", name: str, where: str) -> None:
    """Refuse a parameter that a vehicle does not have.

    Raises
    ------
    Refusal
    """
    known = car.quantities()
    if name not in known:
        raise Refusal(f"{where}: {type(car).__name__} has no parameter {name!r}, available: {', '.join(known)}")


def _road(metavar: str, meaning: str, default: str = "") -> Any:
    return typer.Option(metavar=metavar, help=meaning, show_default=default or False, rich_help_panel="Road")


def road_from_options(
    road_class: Annotated[
        str | None, _road("A-H", "ISO 8608 class, by its geometric mean roughness.", default="B")
    ] = None,
    roughness: Annotated[float | None, _road(ROAD["roughness"].unit, "G_d(0.1 cycle/m), in place of a class.")] = None,
    speed: Annotated[float | None, _road(ROAD["speed"].unit, "Speed.", default="20")] = None,
    waviness: Annotated[float | None, _road("W", "Exponent of the spectrum, 1 to 4.", default="2")] = None,
    cutoff: Annotated[float | None, _road(ROAD["cutoff"].unit, "Low-wavenumber cut-off.", default="0")] = None,
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
        str | None, _road("NAME,...", "Only these wheels meet the road, the others a flat one.", default="all")
    ] = None,
) -> "Road":
    """Make the road that the options describe."""
    from ..roads.road import Road

    if road_class is not None and roughness is not None:
        raise Refusal("--road-class and --roughness are two ways to say one thing; pass one of them")
    only = None if wheels is None else names([wheels])
    numbers = {"speed": speed, "waviness": waviness, "cutoff": cutoff, "roughness": roughness}
    given: Any = {name: value for name, value in numbers.items() if value is not None} | {"tracks": tracks}
    with refusals():
        road = Road.iso8608("B" if road_class is None else road_class)
        return dataclasses.replace(road, **given, delay=delay, wheels=only)


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
