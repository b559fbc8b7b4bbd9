"""Options of ``susp-ss fit`` for runs of an FMU in place of a table of runs."""

from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, NamedTuple

import typer

from ..quantities import Quantity, quantity_of
from .options import TIME, bounds, counted, measured, names
from .refusals import Refusal

if TYPE_CHECKING:
    from ..fit.runs import Runs
    from ..roads.road import Road

CUT = "5"
"""Start of each run that is left out if nothing is said, s."""


def _fmu(metavar: str, help: str, default: str = "") -> Any:
    return typer.Option(metavar=metavar, help=help, show_default=default or False, rich_help_panel="FMU")


class FmuRuns(NamedTuple):
    """Runs of an FMU as the options ask for them."""

    path: Path
    number: int
    ranges: dict[str, str]
    heights: dict[str, str] | None
    like: Path | None
    duration: float
    kept: Path | None

    def box(self, inputs: dict[str, str], trust_units: bool) -> dict[str, tuple[float, float]]:
        """The ranges in SI units, in the order of the inputs."""
        return box_of("--range", self.ranges, inputs, trust_units)

    def run(
        self,
        inputs: dict[str, str],
        outputs: dict[str, str],
        units: dict[str, str],
        road: "Road",
        cut: float,
        weighting: str | None,
        trust_units: bool,
        seed: int,
    ) -> "Runs":
        """Spread designs over the ranges and run the model at each."""
        from ..exchange import FMU
        from ..surrogates import sample
        from ..vehicles.files import read_vehicle

        for name in inputs:
            if name not in self.ranges:
                raise Refusal(f"--range {name}=LO:HI is missing; each of --inputs needs its range with --fmu")
        box = self.box(inputs, trust_units)
        model = FMU(self.path, inputs, outputs, heights=self.heights, units=units)
        like = None if self.like is None else read_vehicle(self.like, trust_units)
        designs = sample(box, self.number, random_state=seed)
        how: dict[str, Any] = {"duration": self.duration, "cut": cut, "seed": seed, "weighting": weighting}
        return model.run(designs, road, like=like, **how, kept=self.kept, progress=True)


def fmu_from_options(
    fmu: Annotated[
        Path | None,
        _fmu("FILE", "Model of another program, FMI 2 or 3, that is run in place of a table of RUNS; needs --range."),
    ] = None,
    count: Annotated[
        int | None,
        counted(
            "Runs, spread over the ranges by a Latin hypercube.", "--runs", show_default="30", rich_help_panel="FMU"
        ),
    ] = None,
    range: Annotated[
        list[str] | None,
        _fmu("NAME=LO:HI,...", "Range of each of --inputs, such as ks=16N/mm:24N/mm; may be repeated."),
    ] = None,
    heights: Annotated[
        list[str] | None,
        _fmu(
            "WHEEL=VARIABLE,...",
            "Inputs of the FMU that take the road's height (m) under each wheel; of one wheel the variable alone.",
            default="those named z_r, z_r_fr, ...",
        ),
    ] = None,
    like: Annotated[
        Path | None,
        _fmu("FILE", "Vehicle file whose wheelbase and track width the FMU has; not needed for one wheel."),
    ] = None,
    duration: Annotated[str | None, _fmu("s", "Length of a run, of which --cut is left out.", default="60")] = None,
    kept: Annotated[
        Path | None,
        _fmu("FILE", "Finished runs are kept in this file (JSON) and taken from it, so that what broke off goes on."),
    ] = None,
) -> FmuRuns | None:
    """What the options ask to be run; None without ``--fmu``."""
    given = {
        "--runs": count,
        "--range": range,
        "--heights": heights,
        "--like": like,
        "--duration": duration,
        "--kept": kept,
    }
    stray = next((option for option, value in given.items() if value is not None), None)
    if fmu is None:
        if stray:
            raise Refusal(f"{stray} is for --fmu")
        return None
    return FmuRuns(
        fmu,
        30 if count is None else count,
        ranges_of("--range", range or []),
        _wheels(heights),
        like,
        measured("--duration", duration or "60", TIME, True),
        kept,
    )


def box_of(
    option: str, ranges: dict[str, str], inputs: Iterable[str], trust_units: bool
) -> dict[str, tuple[float, float]]:
    """Ranges of inputs, ``LO:HI`` by name, in SI units."""
    for name in ranges:
        if name not in inputs:
            raise Refusal(f"{option} {name}: it is none of --inputs, {', '.join(inputs)}")
    return {
        name: bounds(f"{option} {name}", ranges[name], quantity_of(name) or Quantity(name, "", name), trust_units)
        for name in inputs
        if name in ranges
    }


def ranges_of(option: str, given: list[str]) -> dict[str, str]:
    """``LO:HI`` by name, from options that may be repeated and may each hold several."""
    return _paired(option, "NAME=LO:HI, such as ks=16N/mm:24N/mm", given)


def _wheels(given: list[str] | None) -> dict[str, str] | None:
    if given is None:
        return None
    alone = names(given)
    if len(alone) == 1 and "=" not in alone[0]:
        return {"": alone[0]}
    return _paired("--heights", "WHEEL=VARIABLE, such as fr=Wheel1.z", given)


def _paired(option: str, need: str, given: list[str]) -> dict[str, str]:
    pairs: dict[str, str] = {}
    for text in names(given):
        name, equals, value = (part.strip() for part in text.partition("="))
        if not (name and equals and value):
            raise Refusal(f"{option} must be {need}, got {text!r}")
        if name in pairs:
            raise Refusal(f"{option} names {name} twice")
        pairs[name] = value
    return pairs
