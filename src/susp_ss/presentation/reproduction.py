"""What to type to get a result again."""

from __future__ import annotations

import dataclasses
from typing import Any

import numpy as np

from ..fit.fitting import Fit
from ..metrics.weightings import filter_of
from ..roads.road import Road
from ..roads.road_fit import unfitted
from ..study.feasibility import Study


def study_code(study: Study) -> str:
    """Python that runs a study again.

    Examples
    --------
    >>> import susp_ss as ss
    >>> from susp_ss.presentation.reproduction import study_code
    >>> print(study_code(ss.feasibility_study(nodes=(3, 3))))
    import susp_ss as ss
    <BLANKLINE>
    study = ss.feasibility_study(
        road=ss.Road(
            roughness=6.4e-05,
            speed=20.0,
            waviness=2.0,
            tracks='isotropic',
            delay=True,
        ),
        corner='fr',
        nodes=(3, 3),
        nonnegative=False,
    )
    ss.save(study, 'results')
    """
    asked = {"road": study.road, "corner": study.corner, "nodes": study.nodes, "nonnegative": study.nonnegative}
    if not study.as_published:
        ranges = {name: tuple(study.responses[name].values[[0, -1]].tolist()) for name in ("ks", "cs")}
        asked |= {"vehicle": study.vehicle, "low_fidelity": study.low_fidelity, **ranges}
    return "\n".join(
        ["import susp_ss as ss", "", f"study = {_call('feasibility_study', asked)}", "ss.save(study, 'results')"]
    )


def study_command(study: Study) -> str | None:
    r"""The command that runs a study again, if the command line can: it knows square grids, and cars from files.

    Examples
    --------
    >>> import susp_ss as ss
    >>> from susp_ss.presentation.reproduction import study_command
    >>> print(study_command(ss.feasibility_study(nodes=(3, 3))))
    susp-ss study --roughness 6.4e-05 --speed 20.0 \
        --waviness 2.0 --cutoff 0.0 \
        --tracks isotropic --delay \
        --corner fr --nodes 3 --free \
        --out results
    """
    road, (springs, dampers) = unfitted(study.road), study.nodes
    if springs != dampers or not study.as_published or type(road) is not Road or len(road.table) > 1:
        return None
    wheels = "" if road.wheels is None else f" --wheels {','.join(road.wheels)}"
    return " \\\n    ".join(
        [
            f"susp-ss study --roughness {road.roughness!r} --speed {road.speed!r}",
            f"{_surface(road)} --cutoff {road.cutoff!r}",
            f"--tracks {road.tracks} --{'' if road.delay else 'no-'}delay{wheels}",
            f"--corner {study.corner} --nodes {springs} --{'nonnegative' if study.nonnegative else 'free'}",
            "--out results",
        ]
    )


def _surface(road: Road) -> str:
    contact = f" --contact-length {road.contact_length!r}" if road.contact_length else ""
    if not road.table:
        return f"--waviness {road.waviness!r}{contact}"
    below, above = road.slopes
    return f"--waviness {below!r}:{above!r} --knee {road.table[0][0]!r}{contact}"


def fit_code(fit: Fit) -> str:
    """Python that makes a fit again from the same file."""
    made = [f"runs = {_call(*fit.runs.read)}", f"cheap = {_code(fit.low_fidelity)}"]
    own_filter = any("control.tf(" in line for line in made)
    return "\n".join(
        [
            *(["import control"] if own_filter else []),
            "import susp_ss as ss\n",
            *made,
            f"fit = ss.fit_runs(runs, cheap, {', '.join(f'{name}={value!r}' for name, value in fit.asked.items())})",
            "ss.save(fit, 'fit')",
        ]
    )


def _call(name: str, arguments: dict[str, Any]) -> str:
    lines = [f"    {key}={_code(value)},".replace("\n", "\n    ") for key, value in arguments.items()]
    return "\n".join([f"ss.{name}(", *lines, ")"])


def _code(value: Any) -> str:
    if dataclasses.is_dataclass(value):
        fields = {field.name: getattr(value, field.name) for field in dataclasses.fields(value)}
        defaults = {field.name: field.default for field in dataclasses.fields(value)}
        # What is nothing, and is so by default, goes without saying.
        fields = {name: x for name, x in fields.items() if x or defaults[name]}
        return _call(type(value).__name__, fields)
    if hasattr(value, "ninputs"):
        own = filter_of(value, "weighting")
        return f"control.tf({own.numerator.tolist()!r}, {own.denominator.tolist()!r})"
    return repr(value.tolist() if isinstance(value, (np.ndarray, np.generic)) else value)
