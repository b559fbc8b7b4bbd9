"""``susp-ss handling``: how a car turns, as table by speed and as figure of a step of its steering angle."""

import json
import math
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer
from rich.table import Table

from ..quantities import ROAD, Quantity, typeset
from .documents import json_number
from .folder import check_folder, write_together
from .options import Force, Json, TrustUnits, built_from, measured, nodes, print_table, vehicle_options
from .refusals import Refusal, refusals

if TYPE_CHECKING:
    import xarray as xr

    from ..vehicles.ride_handling import RideHandlingCar

TABLE, FIGURE = "handling.csv", "handling.png"

ANGLE = Quantity("angle", "rad", "steering angle", known=(1e-4, 1.0))
BEGIN, END, STEP = 0.5, 4.0, 2e-3
"""When the step is, when the history ends, and its step, in s."""

GAINS = {
    "yaw_rate": ("yaw rate", "1/s"),
    "ay": ("ay", "m/s^2/rad"),
    "sideslip": ("sideslip", "rad/rad"),
    "roll": ("roll", "rad/rad"),
    "load_transfer_ratio": ("load transfer ratio", "1/rad"),
}
"""What a car settles at per angle of its front wheels."""

RESPONSE = {
    "rise": ("rise of the yaw rate", "s"),
    "overshoot": ("overshoot of the yaw rate", ""),
}
"""What the step shows: the time to 90 % of the steady value, and how far beyond that it goes, as a share of it."""


@built_from(vehicle=vehicle_options(default="ride-handling", steered=True))
def run(
    vehicle: "RideHandlingCar",
    speed: Annotated[
        str | None,
        typer.Option(metavar="m/s", help="Speed of the step; also 72km/h.", show_default="the vehicle's own, 20"),
    ] = None,
    speeds: Annotated[
        str | None,
        typer.Option(
            metavar="LO:HI:N",
            help="Speeds of the table, in m/s; also 20km/h:140km/h:7.",
            show_default="10:40:7, up to the critical speed",
        ),
    ] = None,
    angle: Annotated[
        str, typer.Option(metavar="rad", help="Angle to which the front wheels are turned at once; also 1deg.")
    ] = "1deg",
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
    trust_units: TrustUnits = False,
) -> None:
    """How a car turns: gains by speed, understeer, critical speed, rollover, and a step of its steering angle.

    Of the linear car on a level road. Gains are per angle of the front wheels,
    not of the steering wheel.
    """
    if not vehicle.layout().controls:
        raise Refusal(f"handling needs a car that steers, --model ride-handling, got a {type(vehicle).__name__}")
    if out is not None:
        check_folder(out, (TABLE, FIGURE), force)
    own = vehicle.speed if speed is None else measured("--speed", speed, ROAD["speed"], trust_units)
    turned = measured("--angle", angle, ANGLE, trust_units)
    if not turned:
        raise Refusal(f"--angle must be another than zero, got {angle!r}")
    with refusals():
        whole = _whole(vehicle)
        by_speed = _by_speed(vehicle, speeds, trust_units)
        history = _step(vehicle.moving(own), turned)
    if out is not None:
        with refusals():
            table, figure = _csv(by_speed), _figure(history, own, turned)
            write_together(out, {TABLE: lambda path: path.write_text(table), FIGURE: figure.savefig})
    seen = _seen(history)
    if as_json:
        typer.echo(json.dumps(_document(vehicle, whole, by_speed, own, turned, seen), indent=2))
    else:
        _print(vehicle, whole, by_speed, own, turned, seen)


def _whole(car: "RideHandlingCar") -> dict[str, tuple[float, str]]:
    """What holds at any speed, each with its unit."""
    return {
        "understeer gradient": (car.understeer_gradient(), "rad/(m/s^2)"),
        "characteristic speed": (car.characteristic_speed(), "m/s"),
        "critical speed": (car.critical_speed(), "m/s"),
        "rollover threshold": (car.rollover_threshold(), "m/s^2"),
        "roll gradient": (car.roll_gradient(), "rad/(m/s^2)"),
    }


def _by_speed(car: "RideHandlingCar", speeds: str | None, trust_units: bool) -> "xr.Dataset":
    """Gains on speed."""
    import numpy as np
    import xarray as xr

    critical = car.critical_speed()
    if speeds is None:
        values = np.linspace(10.0, min(40.0, 0.95 * critical), 7) if critical > 11.0 else np.array([0.9 * critical])
    else:
        values = nodes("--speeds", speeds, ROAD["speed"], trust_units)
        if not min(values) > 0.0:
            raise Refusal(f"--speeds must be > 0 m/s, got {speeds!r}")
    axis = xr.DataArray(values, {"speed": values}, "speed")
    return car.steady_state(speed=axis, delta_f=1.0)[list(GAINS)]


def _step(car: "RideHandlingCar", angle: float) -> "xr.Dataset":
    import numpy as np

    from .. import simulate

    car.steady_state()
    time = np.arange(0.0, END, STEP)
    return simulate(car, 0.0 * time, time, inputs={"delta_f": np.where(time >= BEGIN, angle, 0.0)})


def _seen(history: "xr.Dataset") -> dict[str, float]:
    """`RESPONSE` of a history."""
    yaw = history.yaw_rate.values / history.yaw_rate.values[-1]
    first = history.time.values[int((yaw >= 0.9).argmax())]
    return {"rise": float(first) - BEGIN, "overshoot": max(float(yaw.max()) - 1.0, 0.0)}


def _csv(by_speed: "xr.Dataset") -> str:
    header = ["speed (m/s)", *(f"{word} ({unit})" for word, unit in GAINS.values())]
    columns = [by_speed.speed.values.tolist(), *(by_speed[name].values.tolist() for name in GAINS)]
    rows = [header, *([repr(number) for number in row] for row in zip(*columns, strict=True))]
    return "".join(",".join(row) + "\n" for row in rows)


def _document(
    car: "RideHandlingCar",
    whole: dict[str, tuple[float, str]],
    by_speed: "xr.Dataset",
    speed: float,
    angle: float,
    seen: dict[str, float],
) -> dict[str, Any]:
    from ..vehicles.files import vehicle_table

    return {
        "vehicle": vehicle_table(car),
        **{
            name.replace(" ", "_"): {"value": json_number(value), "unit": unit} for name, (value, unit) in whole.items()
        },
        "speed": {"values": by_speed.speed.values.tolist(), "unit": "m/s"},
        "gains": {name: {"values": by_speed[name].values.tolist(), "unit": unit} for name, (_, unit) in GAINS.items()},
        "step": {
            "speed": {"value": speed, "unit": "m/s"},
            "angle": {"value": angle, "unit": "rad"},
            **{name: {"value": seen[name], "unit": unit} for name, (_, unit) in RESPONSE.items()},
        },
    }


def _print(
    car: "RideHandlingCar",
    whole: dict[str, tuple[float, str]],
    by_speed: "xr.Dataset",
    speed: float,
    angle: float,
    seen: dict[str, float],
) -> None:
    table = Table()
    # Two lines a heading, so that the table fits a page.
    for heading, unit in (("speed", "m/s"), ("", "km/h"), *GAINS.values()):
        table.add_column(f"{heading}\n({typeset(unit)})", justify="right")
    for i, at in enumerate(by_speed.speed.values):
        table.add_row(f"{at:.4g}", f"{3.6 * at:.4g}", *(f"{float(by_speed[name][i]):.4g}" for name in GAINS))
    typer.echo(f"{type(car).__name__}: steady turns, per angle of the front wheels")
    print_table(table)
    for name, (value, unit) in whole.items():
        per_g = f", {math.degrees(value) * 9.81:.3g} deg/g" if unit.startswith("rad") else ""
        in_g = f", {value / 9.81:.3g} g" if unit == "m/s^2" else ""
        typer.echo(f"{name}: {value:.4g} {unit}{per_g}{in_g}" if math.isfinite(value) else f"{name}: none")
    typer.echo(
        f"step to {math.degrees(angle):.3g} deg at {speed:.4g} m/s: yaw rate at 90 % after {seen['rise']:.3g} s, "
        f"{seen['overshoot']:.1%} beyond its steady value"
    )


def _figure(history: "xr.Dataset", speed: float, angle: float) -> Any:
    from ..presentation.plots import steering

    figure = steering({f"{math.degrees(angle):.3g} deg at {speed:.4g} m/s": history})
    figure.suptitle("A step of the steering angle", fontsize="medium")
    return figure
