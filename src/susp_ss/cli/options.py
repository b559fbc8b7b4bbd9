"""Options that several commands share: the vehicle, the road, and where results go."""

import dataclasses
import inspect
import math
import re
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer
from rich.console import Console
from rich.table import Table

from ..quantities import CORNERS, GROUPS, MIDDLE, PARAMETERS, ROAD, STEERED, Quantity, signal
from ..units import implausible, in_si, likely, split_unit, stated
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
    parameters of ``road_from_options``, and passes what that returns. What several of them name is one option.
    """

    def decorate(command: Callable[..., None]) -> Callable[..., None]:
        options = {name: inspect.signature(builder).parameters for name, builder in builders.items()}
        own = {name: p for name, p in inspect.signature(command).parameters.items() if name not in builders}
        shared = {name: p for parameters in options.values() for name, p in parameters.items()}

        def run(**given: Any) -> None:
            arguments = {name: builders[name](**{key: given[key] for key in options[name]}) for name in builders}
            command(**arguments, **{name: given[name] for name in own})

        keyword_only = [p.replace(kind=inspect.Parameter.KEYWORD_ONLY) for p in (shared | own).values()]
        run.__signature__ = inspect.Signature(keyword_only)  # type: ignore[attr-defined]
        run.__doc__ = command.__doc__
        return run

    return decorate


TrustUnits = Annotated[
    bool,
    typer.Option(
        "--trust-units", help="Take numbers that no road vehicle or road has, or that are far from the cheap model's."
    ),
]


def vehicle_options(
    option: str = "model",
    default: str = "full",
    meaning: str = "The model",
    without: Sequence[str] = (),
    ranges: bool = False,
    steered: bool = False,
) -> Callable[..., Any]:
    """Return what makes the vehicle that a file and options describe, an option for every parameter there is.

    Parameters
    ----------
    option, default, meaning : str
        Name of the option that chooses the model, what it is without, and its help.
    without : sequence of str
        Parameters that have no option here.
    ranges : bool
        Whether a parameter may be a range ``LO:HI:N``; what is made is then the vehicle and the values by parameter.
    steered : bool
        Whether help shows the options of a car that steers; they are there all the same.
    """

    def build(*, trust_units: bool = False, **given: Any) -> Any:
        car = _vehicle(option, default, given.pop(option), given.pop("vehicle"), trust_units)
        more = [setting.partition("=") for setting in given.pop("more", None) or ()]
        for name, equals, _ in more:
            if not equals:
                raise Refusal(f"--more must be PARAM=LO:HI:N, such as mu=40:50:11, got {name!r}")
            if given.get(name) is not None or [other for other, *_ in more].count(name) > 1:
                raise Refusal(f"--more {name}: {name} is given twice")
        texts = {name: (flag(name), text) for name, text in given.items() if text is not None}
        texts |= {name: (f"--more {name}", text) for name, _, text in more}
        of = {name: ROAD[name] for name, *_ in more if name in ROAD}
        for name, (where, text) in texts.items():
            if name in of and ":" not in text:
                raise Refusal(f"{where} must be LO:HI:N; one value is {flag(name)} {text}")
            if name not in of:
                _refuse_unknown(car, name, where)
                of[name] = car.quantities()[car.settings()[name][0]]
        axes = {
            name: nodes(where, text, of[name], trust_units)
            for name, (where, text) in texts.items()
            if ranges and ":" in text
        }
        fixed = {
            name: measured(where, text, of[name], trust_units)
            for name, (where, text) in texts.items()
            if name not in axes
        }
        with refusals():
            car = car.replaced(**fixed)
        return (car, axes) if ranges else car

    def optional(name: str, kind: Any, **shown: Any) -> inspect.Parameter:
        annotation = Annotated[kind, typer.Option(rich_help_panel="Vehicle", **shown)]
        return inspect.Parameter(name, inspect.Parameter.KEYWORD_ONLY, default=None, annotation=annotation)

    def value(name: str, quantity: Quantity, where: str, hidden: bool = False) -> inspect.Parameter:
        said = f"{quantity.meaning.capitalize()}{where}."
        metavar = f"{quantity.unit} or LO:HI:N" if ranges else quantity.unit
        return optional(name, str | None, metavar=metavar, help=said, show_default=False, hidden=hidden)

    parameters = []
    for name, quantity in (PARAMETERS | STEERED).items():
        if name not in without:
            hidden = name in STEERED and not steered
            parameters.append(value(name, quantity, ", each wheel" if quantity.dim else "", hidden))
            if quantity.dim:
                shown = {place: f" of the {place} wheels" for place in ("front", "rear")}
                others = (
                    place for place in (*CORNERS, *MIDDLE, "f", "r", "l", "middle", *GROUPS) if place not in shown
                )
                parameters += [value(signal(name, place), quantity, where, hidden) for place, where in shown.items()]
                parameters += [value(signal(name, place), quantity, "", hidden=True) for place in others]
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
        "or the model's defaults. Numbers may state their unit, 24N/mm; --ks-rl and the like set one wheel.",
        show_default=False,
    )
    more = inspect.Parameter("more", inspect.Parameter.KEYWORD_ONLY, default=None, annotation=More)
    trust = inspect.Parameter("trust_units", inspect.Parameter.KEYWORD_ONLY, default=False, annotation=TrustUnits)
    build.__signature__ = inspect.Signature(  # type: ignore[attr-defined]
        [model, file, *parameters, *([more] if ranges else []), trust]
    )
    return build


More = Annotated[
    list[str] | None,
    typer.Option(
        metavar="PARAM=LO:HI:N",
        help="Values of a parameter, as its own option takes them, or of the road's speed, roughness or cutoff; may "
        "be repeated.",
        show_default=False,
    ),
]


def _vehicle(option: str, default: str, model: str | None, file: Path | None, trust_units: bool) -> "Vehicle":
    from ..vehicles.files import model_name, model_named, read_vehicle

    with refusals():
        if file is None:
            return model_named(default if model is None else model)()
        car = read_vehicle(file, trust_units)
        if model is not None and model_name(car) != model:
            raise Refusal(f"{flag(option)} {model}, but {file} holds the model {model_name(car)!r}")
        return car


def _refuse_unknown(car: "Vehicle", name: str, where: str) -> None:
    if name not in car.settings():
        raise Refusal(
            f"{where}: {type(car).__name__} has no parameter {name!r}, available: {', '.join(car.quantities())}"
        )


def _road(metavar: str, meaning: str, default: str = "") -> Any:
    return typer.Option(metavar=metavar, help=meaning, show_default=default or False, rich_help_panel="Road")


TIME = Quantity("time", "s", "time", bound="> 0")

CONTACT = Quantity("contact_length", "m", "contact length", bound=">= 0", known=(1e-3, 1.0))


def road_from_options(
    road_class: Annotated[
        str | None, _road("A-H", "ISO 8608 class, by its geometric mean roughness.", default="B")
    ] = None,
    roughness: Annotated[str | None, _road(ROAD["roughness"].unit, "G_d(0.1 cycle/m), in place of a class.")] = None,
    speed: Annotated[str | None, _road(ROAD["speed"].unit, "Speed; also 72km/h.", default="20")] = None,
    waviness: Annotated[
        str | None, _road("W", "Exponent of the spectrum, 1 to 4; W:W below and above a knee.", default="2")
    ] = None,
    knee: Annotated[str | None, _road("cycle/m", "Where the exponent changes.", default="0.16")] = None,
    spectrum: Annotated[
        Path | None,
        _road("FILE", "Measured spectrum, a table of n (cycle/m) and G_d (m^3), in place of class and waviness."),
    ] = None,
    contact_length: Annotated[
        str | None, _road("m", "Length over which a tyre levels the road out.", default="0")
    ] = None,
    cutoff: Annotated[str | None, _road(ROAD["cutoff"].unit, "Low-wavenumber cut-off.", default="0")] = None,
    tracks: Annotated[
        str | None,
        _road("NAME", "How left and right relate: identical, independent or isotropic.", default="isotropic"),
    ] = None,
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
    trust_units: TrustUnits = False,
) -> "Road":
    """Make the road that the options describe; what they leave open is the default road's."""
    from ..roads.road import DEFAULT_ROAD, Road

    if road_class is not None and roughness is not None:
        raise Refusal("--road-class and --roughness are two ways to say one thing; pass one of them")
    texts = {"roughness": roughness, "speed": speed, "cutoff": cutoff}
    given: dict[str, Any] = {
        name: measured(flag(name), text, ROAD[name], trust_units) for name, text in texts.items() if text is not None
    }
    if contact_length is not None:
        given["contact_length"] = measured("--contact-length", contact_length, CONTACT, trust_units)
    if tracks is not None:
        given["tracks"] = tracks
    only = None if wheels is None else names([wheels])
    with refusals():
        if road_class is not None:
            given["roughness"] = Road.iso8608(road_class).roughness
        road = dataclasses.replace(DEFAULT_ROAD, **given, delay=delay, wheels=only)
        return _surface(road, waviness, knee, spectrum, "roughness" in given)


def _surface(road: "Road", waviness: str | None, knee: str | None, spectrum: Path | None, rough: bool) -> "Road":
    """The same road on a surface of one or two exponents, or on a measured one."""
    from ..roads.road import Road

    exponents = [number("--waviness", text) for text in (waviness or "").split(":") if text]
    if len(exponents) > 2:
        raise Refusal(f"--waviness must be one exponent, or two such as 2:1.5, got {waviness!r}")
    if knee is not None and len(exponents) != 2:
        raise Refusal("--knee needs two exponents, such as --waviness 2:1.5")
    surface: dict[str, Any] = {}
    if spectrum is not None:
        if rough or len(exponents) == 2:
            raise Refusal("--spectrum says how rough the road is; pass no class, roughness or knee with it")
        n, G = _spectrum(spectrum)
        try:
            measured_road = Road.from_psd(n, G, exponents[0] if exponents else 2.0)
        except (TypeError, ValueError) as error:
            said = re.sub(r"Road[.]from_psd(?:\((\w+)=[.]{3}\))? ", r"\1 ", str(error)).strip()
            raise Refusal(f"--spectrum {spectrum}: {said}") from error
        surface = {name: getattr(measured_road, name) for name in ("roughness", "waviness", "table")}
    elif len(exponents) == 2:
        at = {} if knee is None else {"knee": number("--knee", knee)}
        bent = Road.two_slope(road.roughness, (exponents[0], exponents[1]), **at)
        surface = {"waviness": bent.waviness, "table": bent.table}
    elif exponents:
        surface = {"waviness": exponents[0]}
    return dataclasses.replace(road, **surface)


def _spectrum(path: Path) -> "tuple[list[float], list[float]]":
    """Wavenumbers and values of a file of two columns, with or without a line of names."""
    from .. import written

    with refusals():
        records, separator, _ = written.text_table(path)
    if records and not any(map(written.like_number, records[0][1])):
        records = records[1:]
    cells = [(f"--spectrum {path}, line {line}", cell) for line, row in records for cell in row]
    for line, row in records:
        if len(row) != 2:
            raise Refusal(
                f"--spectrum {path}, line {line}: needs two columns, n (cycle/m) and G_d (m^3), got {len(row)}"
            )
    with refusals():
        sign = written.decimal_sign(cells, separator)
    values = []
    for where, cell in cells:
        value = written.number(cell, sign)
        if value is None:
            raise Refusal(f"{where}: needs a number, such as 18500 or 18.5e3, got {cell!r}")
        values.append(value)
    return values[::2], values[1::2]


Json = Annotated[bool, typer.Option("--json", help="Print JSON, SI units, in place of tables.")]
Force = Annotated[bool, typer.Option("--force", help="Replace the results of an earlier run in the folder.")]
Weighting = Annotated[
    list[str] | None,
    typer.Option(
        metavar="NAME or OUTPUT=NAME",
        help="Frequency weighting of the accelerations, Wk, Wd, Wb, ..., or of one output, roll_acc=We; may be "
        "repeated.",
        show_default=False,
    ),
]
Point = Annotated[
    list[str] | None,
    typer.Option(
        metavar="NAME=X,Y",
        help="A further point of the body, m ahead and left of the centre of gravity; may be repeated.",
        show_default=False,
    ),
]


def print_table(table: Table) -> None:
    """Print a table at its full width: a number cut short to fit a terminal would be a wrong number."""
    Console(width=1000).print(table)


def _integer(text: str) -> int:
    """Parse a whole number for an option, with what was typed in the refusal."""
    try:
        return int(text)
    except ValueError:
        raise typer.BadParameter(f"needs a whole number, got {text!r}") from None


def counted(help: str, *flags: str, **shown: Any) -> Any:
    """An option whose value is a whole number."""
    return typer.Option(*flags, metavar="N", parser=_integer, help=help, **shown)


def weightings(given: list[str]) -> Any:
    """One name for all, or names by output."""
    named = [text.partition("=") for text in names(given)]
    everywhere = [name for name, equals, _ in named if not equals]
    if not named:
        return None
    if everywhere and len(named) > 1:
        raise Refusal(
            f"--weighting {everywhere[0]} is for bacc, pitch_acc and roll_acc; by output, pass "
            f"bacc={everywhere[0]} and so on"
        )
    return everywhere[0] if everywhere else {output: name for output, _, name in named}


def body_points(given: list[str]) -> dict[str, tuple[float, float]] | None:
    """Points of the body by name, None of them all; ``driver:0.3:0.4`` is read as well."""
    points = {}
    for text in given:
        parts = re.fullmatch(r"([^=:]+)(?:=([^,:]+),([^,:]+)|:([^,:]+):([^,:]+))", text)
        if parts is None:
            raise Refusal(f"--point must be NAME=X,Y such as driver=0.3,0.4 in m, got {text!r}")
        name, *numbers = filter(None, parts.groups())
        points[name] = (number("--point", numbers[0]), number("--point", numbers[1]))
    return points or None


def flag(parameter: str) -> str:
    """Name of a parameter's option."""
    return f"--{parameter.replace('_', '-')}"


def names(given: list[str]) -> tuple[str, ...]:
    """Names from options that may be repeated and may each hold several, with commas."""
    return tuple(name.strip() for text in given for name in text.split(",") if name.strip())


def nodes(where: str, text: str, quantity: Quantity, trust_units: bool = False) -> "NDArray[np.float64]":
    """Values of ``LO:HI:N`` in SI units, or a refusal that says where."""
    low, high, count = range_parts(where, text)
    ends = measured(where, low, quantity, trust_units), measured(where, high, quantity, trust_units)
    return spaced(where, text, *ends, count)


def range_parts(where: str, text: str) -> tuple[str, str, int]:
    """The parts of ``LO:HI:N``, a unit at one end given to both."""
    low, high, count = (part.strip() for part in text.split(":")) if text.count(":") == 2 else ("", "", "")
    if not count.isdecimal():
        raise Refusal(f"{where} must be LO:HI:N with a whole number N, such as 12e3:25e3:100, got {text!r}")
    units = [_split(where, end)[1] for end in (low, high)]
    low, high = (end + ("" if own else other) for end, own, other in zip((low, high), units, units[::-1], strict=True))
    return low, high, int(count)


def bounds(where: str, text: str, quantity: Quantity, trust_units: bool) -> tuple[float, float]:
    """The ends of ``LO:HI`` in SI units, or a refusal that says where."""
    if text.count(":") != 1:
        raise Refusal(f"{where} must be LO:HI, such as 12e3:25e3, got {text!r}")
    low, high, _ = range_parts(where, f"{text}:2")
    return measured(where, low, quantity, trust_units), measured(where, high, quantity, trust_units)


def spaced(where: str, text: str, low: float, high: float, count: int) -> "NDArray[np.float64]":
    """N values from LO to HI, evenly."""
    import numpy as np

    if count < 1:
        raise Refusal(f"{where}: N must be >= 1, got {text!r}")
    if not low <= high or (low == high and count > 1):
        raise Refusal(f"{where}: LO must be below HI, or equal to it with N = 1, got {text!r}")
    return np.linspace(low, high, count)


def measured(where: str, text: str, quantity: Quantity, trust_units: bool = False) -> float:
    """A number with or without a unit in SI units, or a refusal that says where."""
    try:
        value = stated(text, quantity)
    except ValueError as error:
        raise Refusal(f"{where}: {error}") from error
    if not math.isfinite(value.number):
        raise Refusal(f"{where} must be finite, got {text!r}")
    far = "" if trust_units else implausible(value, quantity)
    if far:
        meant = likely(value, quantity)
        stating = f"State the unit, {where} {meant.number:g}{meant.unit}, or pass" if meant else "Pass"
        raise Refusal(f"{where}: {far} {stating} --trust-units to take it as it is")
    return in_si(value, quantity)


def number(where: str, text: str) -> float:
    """A finite number without a unit, or a refusal that says where."""
    value, unit = _split(where, text)
    if unit:
        raise Refusal(f"{where} has no unit, got {text!r}")
    if not math.isfinite(value):
        raise Refusal(f"{where} must be finite, got {text!r}")
    return value


def whole(where: str, text: str, least: int) -> int:
    """A whole number, or a refusal that says where."""
    if not text.strip().isdecimal() or int(text) < least:
        raise Refusal(f"{where} must be a whole number >= {least}, got {text!r}")
    return int(text)


def _split(where: str, text: str) -> tuple[float, str]:
    try:
        return split_unit(text)
    except ValueError as error:
        raise Refusal(f"{where}: {error}") from error
