"""``susp-ss export``: a vehicle as a file that other programs run."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
from rich.console import Console

from .options import built_from, vehicle_options
from .refusals import Refusal, refusals

if TYPE_CHECKING:
    from ..vehicles.vehicle import Vehicle


@built_from(vehicle=vehicle_options())
def run(
    vehicle: "Vehicle",
    out: Annotated[
        Path,
        typer.Option(
            metavar="FILE",
            help=".fmu: FMI 2.0, model exchange and co-simulation, with C source; .mat: the matrices for MATLAB.",
            show_default=False,
        ),
    ],
    system: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE",
            help="State space in place of the model, as susp-ss metrics takes it: a closed loop, say.",
            show_default=False,
        ),
    ] = None,
    force: Annotated[bool, typer.Option("--force", help="Replace a file that is there.")] = False,
) -> None:
    """Write a vehicle as an FMU, or its matrices as a MATLAB file.

    Inputs are the heights of the road under the wheels (z_r_fr ..., m), or
    their rates (dz_r_fr ..., m/s) where tyre damping or a rigid tyre passes
    these on. Outputs are those of susp-ss metrics over time.

    susp-ss export --vehicle car.toml --out car.fmu
    """
    from ..exchange import export
    from ..vehicles.system_files import read_system

    if out.exists() and not force:
        raise Refusal(f"--out {out} exists already; pass --force to replace it")
    with refusals(), Console(stderr=True).status(f"writing {out}"):
        exported = read_system(system, vehicle) if system else vehicle
        export(exported, out, force)
    typer.echo(f"{out}: {f'{exported!r} of {system}' if system else type(vehicle).__name__}")
