"""``susp-ss explore``: the whole engine in a browser, live."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from .options import TrustUnits
from .refusals import Refusal, refusals

if TYPE_CHECKING:
    from ..explorer.state import Given
    from ..roads.road import Road

PORT = 8050


def _file(meaning: str) -> Any:
    return typer.Option(metavar="FILE", help=meaning, show_default=False)


def run(
    vehicle: Annotated[
        Path | None, _file("TOML file of a vehicle to begin with, as susp-ss metrics --template prints it.")
    ] = None,
    system: Annotated[
        Path | None,
        _file("State space in place of a vehicle, as susp-ss metrics takes it; its wheels are the vehicle's."),
    ] = None,
    road: Annotated[
        Path | None, _file("Measured profile, as susp-ss road fit takes it: its spectrum is the road to begin with.")
    ] = None,
    surrogate: Annotated[
        list[Path] | None, _file("surrogate.json of susp-ss fit, to predict beside the exact value; may be repeated.")
    ] = None,
    port: Annotated[int, typer.Option(metavar="N", help="Where on this machine; 0 takes one that is free.")] = PORT,
    no_browser: Annotated[bool, typer.Option("--no-browser", help="Serve, and open no browser.")] = False,
    trust_units: TrustUnits = False,
) -> None:
    """Explore vehicle, road and design in a browser: every slider moves every number.

    Ride metrics, comfort, frequency responses, modes, a bump, what springs and
    dampers could do at best. The page's address holds the whole design. The
    server answers this machine alone (http://127.0.0.1) and ends with Ctrl-C.

    susp-ss explore --vehicle car.toml --surrogate fit/surrogate.json
    """
    from ..explorer.app import application
    from ..explorer.beside import Beside
    from ..explorer.server import address, listening, serve

    beside = Beside()
    with refusals():
        app = application(_given(vehicle, system, road, surrogate or [], trust_units), slowly=beside.background)
    try:
        server = listening(app, port)
    except (OSError, OverflowError) as error:
        said = getattr(error, "strerror", None) or str(error)
        raise Refusal(f"--port {port}: {said}; pass another, or 0 for one that is free") from error
    typer.echo(f"{address(server)} (Ctrl-C ends it)")
    with beside:
        serve(server, browser=not no_browser)


def _given(
    vehicle: Path | None, system: Path | None, road: Path | None, surrogates: list[Path], trust_units: bool
) -> "Given":
    from .. import FullCar, load_surrogate
    from ..explorer.state import Given
    from ..vehicles.files import read_vehicle
    from ..vehicles.system_files import read_system

    given: dict[str, Any] = {}
    if vehicle is not None:
        given["vehicle"] = read_vehicle(vehicle, trust_units)
    if system is not None:
        given["vehicle"] = read_system(system, given.get("vehicle", FullCar()))
    if road is not None:
        given |= {"road": _measured(road), "profile": road.name}
    given["surrogates"] = {str(path): load_surrogate(path) for path in surrogates}
    return Given(**given)


def _measured(path: Path) -> "Road":
    from .. import fit_road, read_profile
    from ..roads.road_fit import unfitted

    try:
        with refusals():
            return unfitted(fit_road(read_profile(path)))
    except Refusal as refusal:
        elsewhere = " of susp-ss road read, whose --out is taken here" if "--" in str(refusal) else ""
        raise Refusal(f"{refusal}{elsewhere}") from refusal
