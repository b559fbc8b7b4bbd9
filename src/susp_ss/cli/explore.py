"""``susp-ss explore``: the whole engine in a browser, live."""

from pathlib import Path
from typing import Annotated

import typer

from .options import TrustUnits
from .refusals import Refusal, refusals

PORT = 8050


def run(
    vehicle: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE",
            help="TOML file of a vehicle to begin with, as susp-ss metrics --template prints it.",
            show_default=False,
        ),
    ] = None,
    port: Annotated[int, typer.Option(metavar="N", help="Where on this machine; 0 takes one that is free.")] = PORT,
    no_browser: Annotated[bool, typer.Option("--no-browser", help="Serve, and open no browser.")] = False,
    trust_units: TrustUnits = False,
) -> None:
    """Explore vehicle, road and design in a browser, every number live.

    It answers this machine alone (http://127.0.0.1) and ends with Ctrl-C.

    susp-ss explore --vehicle car.toml
    """
    from ..explorer.app import application
    from ..explorer.server import serve
    from ..explorer.state import Given
    from ..vehicles.files import read_vehicle

    with refusals():
        app = application(Given(vehicle=None if vehicle is None else read_vehicle(vehicle, trust_units)))
    try:
        serve(app, port, not no_browser, lambda address: typer.echo(f"{address} (Ctrl-C ends it)"))
    except OSError as error:
        raise Refusal(f"--port {port}: {error.strerror}; pass another, or 0 for one that is free") from error
