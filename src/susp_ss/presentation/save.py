"""Any result as files in a folder: kept unless forced, and never half written."""

from __future__ import annotations

import json
import re
import warnings
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager
from os import PathLike
from pathlib import Path
from typing import Any, NamedTuple

import pandas as pd
from matplotlib.figure import Figure

from ..design import ParetoFront
from ..extras import needing
from ..feedback import ActiveBound, ActiveFront, Feedback
from ..fit.fitting import Fit
from ..fit.next_runs import asked_for, to_fill_in
from ..metrics.comfort import Comfort
from ..metrics.third_octaves import third_octaves
from ..quantities import signal
from ..responses.covariance import linearised
from ..roads.road import Road
from ..roads.road_fit import FittedRoad
from ..study.feasibility import Study
from ..study.published import FIGURES, SURROGATES
from ..study.scan import Scan
from . import plots
from .documents import comfort_document, fitted_road_document, study_document
from .folder import write_results
from .text.design import design_text
from .text.feedback import bound_text, feedback_text, front_text
from .text.fit import fit_text
from .text.road import fitted_spectrum

PAGE = "report.html"

TABLES = "tables.csv", "tables.json", "responses.nc"

STILLS = {
    **{
        f"surfaces_{name}": f"figures/{FIGURES[name].lower().replace(' ', '_')}_{name}_surfaces.png"
        for name in SURROGATES
    },
    **{f"errors_{name}": f"figures/error_map_{name}.png" for name in SURROGATES},
    "bode_magnitude": "figures/bode_magnitude.png",
}
"""Pictures of a study."""

SURROGATE, REPORT = "surrogate.json", "report.md"
ACCURACY, PREDICTIONS, NEXT = "accuracy.csv", "predictions.csv", "next_runs.csv"

PICTURES = {
    "parity": "predicted against expensive, runs left out",
    "residuals": "errors, runs left out",
    "map": "the surrogate taken, over the box of the runs",
    "learning": "error against number of runs",
}
"""What each picture of an output of a fit shows."""

SCAN, SCAN_PICTURE = "scan.csv", "scan.png"

FITTED_ROAD = "fitted_road.csv", "fitted_road.json", "fitted_road.png"

COMFORT = "comfort.csv", "comfort.json", "comfort.png"
LAW, GAIN, LAW_TEXT, LAW_PICTURE = "feedback.csv", "gain.csv", "feedback.txt", "feedback.png"

FRONT, FRONT_METRICS, FRONT_TEXT, FRONT_PICTURE = "front.csv", "metrics.nc", "front.txt", "front.png"


def save(result: Any, folder: str | PathLike[str], force: bool = False, figures: bool = True) -> None:
    """Write a result into a folder.

    A `Study` becomes ``tables.csv`` (one row an entry: ours, published, unit), ``tables.json`` (the same with scenario,
    held-out accuracy, cost, designs and versions), ``responses.nc``, ``figures/`` and ``report.html``. A `Fit` becomes
    ``surrogate.json``, ``accuracy.csv``, ``predictions.csv``, ``figures/``, ``report.md`` and ``report.html``, and if
    it was asked for next runs ``next_runs.csv``, a table whose outputs wait to be filled in. A `Scan` becomes
    ``scan.csv`` and ``scan.png``. A `FittedRoad` becomes ``fitted_road.csv`` (the bands of its profile),
    ``fitted_road.json`` (the fit with its intervals) and ``fitted_road.png``, the chart of ISO 8608. A `Comfort`
    becomes ``comfort.csv``, ``comfort.json`` and, of one design on a `Road` or of a sweep along one dim,
    ``comfort.png``. A `Feedback`, an `ActiveBound` or an `ActiveFront` becomes ``feedback.csv`` (every metric beside
    the passive vehicle's, or the front), ``gain.csv`` where there is one gain, ``feedback.txt`` and ``feedback.png``. A
    `ParetoFront` becomes ``front.csv`` (a row a design), ``metrics.nc``, ``front.txt`` and ``front.png``. A page is one
    file that opens in a browser without a network; it needs the extra ``pages``.

    Parameters
    ----------
    result : Study, Fit, Scan, FittedRoad, Comfort, Feedback, ActiveBound, ActiveFront or ParetoFront
    folder : path
        Made if missing.
    force : bool
        Replace the results of an earlier run; other files in the folder are never touched.
    figures : bool
        Whether to draw the figures.

    Raises
    ------
    TypeError
        There are no files for such a result.
    FileExistsError
        The folder holds results and ``force`` is False.
    OSError
        The folder cannot be written. Whatever the error, nothing half written is left.

    Warns
    -----
    UserWarning
        The page is left out, for its extra is not installed.

    Examples
    --------
    >>> import pathlib, tempfile
    >>> import susp_ss as ss
    >>> folder = pathlib.Path(tempfile.mkdtemp(), "results")
    >>> ss.save(ss.comfort(ss.FullCar(), ss.Road()), folder, figures=False)
    >>> sorted(path.name for path in folder.iterdir())
    ['comfort.csv', 'comfort.json']
    """
    kind = kind_of(type(result))
    write_results(folder, lambda empty: kind.write(result, empty, figures), kind.files, force)


class Kind(NamedTuple):
    """Files by which a result's folder is known, beside others that it may hold, and what writes them."""

    files: tuple[str, ...]
    write: Callable[[Any, Path, bool], None]


def kind_of(result: type) -> Kind:
    """Files and writer of a kind of result.

    Raises
    ------
    TypeError
        There are none.
    """
    if result not in KINDS:
        available = ", ".join(kind.__name__ for kind in KINDS)
        raise TypeError(f"result must be one of {available}, got {result.__name__}")
    return KINDS[result]


@contextmanager
def _unless_missed(page: str) -> Iterator[None]:
    """Leave a page out, and say so, where what it takes is not installed."""
    try:
        with needing("pages", page):
            yield
    except ModuleNotFoundError as error:
        warnings.warn(f"{error} (the other files are written)", stacklevel=2)


# A study


def _write_study(study: Study, folder: Path, figures: bool) -> None:
    document = study_document(study)
    study.comparison().to_csv(folder / "tables.csv", index=False)
    (folder / "tables.json").write_text(json.dumps(document, indent=2, allow_nan=False) + "\n", encoding="utf-8")
    study.responses.to_netcdf(folder / "responses.nc", engine="scipy")
    stills = _draw_study(study, folder) if figures else {}
    with _unless_missed(PAGE):
        from .pages.study import study_page

        (folder / PAGE).write_text(study_page(study, document, stills), encoding="utf-8")


def _draw_study(study: Study, folder: Path) -> dict[str, Path]:
    """Save the figures; return where each is."""
    (folder / "figures").mkdir()
    for name, figure in zip(STILLS.values(), _study_figures(study), strict=True):
        figure.savefig(folder / name, dpi=plots.DPI)
    return {name: folder / file for name, file in STILLS.items()}


def _study_figures(study: Study) -> Iterator[Figure]:
    """In the order of STILLS."""
    for draw in (plots.response_surfaces, plots.error_map):
        for surrogate in SURROGATES:
            yield draw(study, surrogate)
    cars = (linearised(car, study.road) for car in (study.vehicle, study.low_fidelity))
    yield plots.bode_magnitude(plots.study_curves(study.corner, *cars))


# A fit


def _write_fit(fit: Fit, folder: Path, figures: bool) -> None:
    fit.surrogate.save(folder / SURROGATE)
    accuracy_table(fit).to_csv(folder / ACCURACY, index=False)
    predictions(fit).to_csv(folder / PREDICTIONS, index=False)
    if (plan := asked_for(fit)) is not None:
        (folder / NEXT).write_text(to_fill_in(fit, plan.designs), encoding="utf-8")
    drawn = _draw_fit(fit, folder) if figures else {}
    maps = {output: folder / file for (kind, output), file in drawn.items() if kind == "map"}
    with _unless_missed(PAGE):
        from .pages.fit import fit_page

        (folder / PAGE).write_text(fit_page(fit, maps), encoding="utf-8")
    (folder / REPORT).write_text(_markdown(fit, drawn), encoding="utf-8")


def _draw_fit(fit: Fit, folder: Path) -> dict[tuple[str, str], str]:
    """Save the figures; return the file of each kind and output."""
    (folder / "figures").mkdir()
    names, drawn = _file_names(fit.outputs), {}
    for kind, output, figure in _fit_figures(fit):
        drawn[kind, output] = f"figures/{kind}_{names[output]}.png"
        figure.savefig(folder / drawn[kind, output])
    return drawn


def accuracy_table(fit: Fit) -> pd.DataFrame:
    """Every surrogate of every output, one row each: its accuracy at runs left out."""
    tables = []
    for name, found in fit.outputs.items():
        table = found.comparison.table.reset_index()
        table.insert(0, "output", name)
        table.insert(1, "unit", fit.runs.units[name])
        table.insert(3, "taken", table.surrogate == found.chosen)
        tables.append(table)
    return pd.concat(tables, ignore_index=True)


def predictions(fit: Fit) -> pd.DataFrame:
    """The runs, where they stand in their file, and what each surrogate predicted for them when they were left out."""
    table = pd.concat([fit.runs.designs, fit.runs.responses], axis=1).reset_index(drop=True)
    table.insert(0, "row", fit.runs.rows)
    left_out = {
        f"{output}: {name}": validation.predicted
        for output, found in fit.outputs.items()
        for name, validation in found.comparison.validations.items()
    }
    return table.assign(**left_out)


def _fit_figures(fit: Fit) -> Iterator[tuple[str, str, Figure]]:
    """Kind, output and figure; of the surrogates those that are foremost."""
    surrogate, plan = fit.surrogate, asked_for(fit)
    for output, found in fit.outputs.items():
        unit = fit.runs.units[output]
        shown = {name: found.comparison.validations[name] for name in found.foremost}
        bars = {name: one.allowance for name, one in shown.items()}
        yield "parity", output, plots.parity(shown, unit, margins=bars)
        yield "residuals", output, plots.residuals(shown, unit, margins=bars)
        if len(surrogate.inputs) == 2:
            yield "map", output, plots.fitted_map(surrogate, output, fit.runs.designs, following=plan and plan.designs)
        if found.learning is not None:
            yield "learning", output, plots.learning_curves(found.learning, unit, found.foremost)


def _file_names(outputs: Iterable[str]) -> dict[str, str]:
    """Outputs may have any name; what each is called in a file name."""
    names: dict[str, str] = {}
    for output in outputs:
        name = re.sub(r"[^A-Za-z0-9_.-]", "_", output)
        names[output] = f"{name}_{len(names)}" if name in names.values() else name
    return names


def _markdown(fit: Fit, pictures: Mapping[tuple[str, str], str]) -> str:
    lines = [f"# Surrogates of {fit.runs.path.name}", "", "```text", fit_text(fit) + "```", ""]
    for (kind, output), file in pictures.items():
        title = f"{output}: {PICTURES[kind]}"
        lines.append(f"## {title}\n\n![{title}]({file})\n")
    return "\n".join(lines)


# A scan


def _write_scan(scan: Scan, folder: Path, figures: bool) -> None:
    scan.scenarios.to_csv(folder / SCAN, index=False)
    if figures:
        plots.scenario_scan(scan).savefig(folder / SCAN_PICTURE)


# A fitted road


def _write_fitted_road(road: FittedRoad, folder: Path, figures: bool) -> None:
    table, document, picture = (folder / name for name in FITTED_ROAD)
    fitted_spectrum(road).to_dataframe().to_csv(table)
    document.write_text(json.dumps(fitted_road_document(road), indent=2, allow_nan=False) + "\n", encoding="utf-8")
    if figures:
        plots.road_chart({f"fitted: class {road.iso_class}": road}).savefig(picture)


# Comfort


def _write_comfort(comfort: Comfort, folder: Path, figures: bool) -> None:
    table, document, picture = (folder / name for name in COMFORT)
    comfort.table.to_csv(table, index=bool(comfort.metrics.dims))
    document.write_text(json.dumps(comfort_document(comfort), indent=2, allow_nan=False) + "\n", encoding="utf-8")
    figure = _comfort_figure(comfort) if figures else None
    if figure is not None:
        figure.savefig(picture)


def _comfort_figure(comfort: Comfort) -> Figure | None:
    """Total values along the one dim of a sweep; of one design on a `Road`, its last place in one-third octaves."""
    total = comfort.metrics["total"]
    places = total.point.values.tolist() if "point" in total.dims else [""]
    swept = [dim for dim in total.dims if dim != "point"]
    if len(swept) == 1:
        shown = {place or "body": total.sel(point=place) if place else total for place in places[-len(plots.LINES) :]}
        return plots.comfort(shown)
    if swept or not isinstance(comfort.road, Road):
        return None
    output, weighting = signal("bacc", places[-1]), comfort.metrics["bacc"].attrs["weighting"]
    named = {"not weighted": None, f"through {weighting}": comfort.weighting}
    ride = comfort.vehicle, comfort.road
    bands = {name: third_octaves(*ride, weighting=one, points=comfort.points or None) for name, one in named.items()}
    return plots.third_octaves({f"{output}, {name}": curve.sel(output=output) for name, curve in bands.items()})


# Feedback


def _write_law(law: Feedback, folder: Path, figures: bool) -> None:
    law.table().to_csv(folder / LAW, index_label="metric")
    if law.gain is not None:
        law.gain.to_pandas().to_csv(folder / GAIN)
    words = bound_text(law) if isinstance(law, ActiveBound) else feedback_text(law)
    (folder / LAW_TEXT).write_text(words, encoding="utf-8")
    if figures:
        plots.feedback(law).savefig(folder / LAW_PICTURE)


def _write_front(front: ActiveFront, folder: Path, figures: bool) -> None:
    table = front.bound.to_dataframe(name=front.minimise)
    table.join(front.multipliers.to_dataframe().add_prefix("multiplier_")).to_csv(folder / LAW)
    (folder / LAW_TEXT).write_text(front_text(front), encoding="utf-8")
    if figures and front.bound.ndim == 1:
        plots.feedback(front).savefig(folder / LAW_PICTURE)


# Designs


def _write_designs(front: ParetoFront, folder: Path, figures: bool) -> None:
    front.table().to_csv(folder / FRONT, index_label="design")
    front.metrics.to_netcdf(folder / FRONT_METRICS, engine="scipy")
    (folder / FRONT_TEXT).write_text(design_text(front), encoding="utf-8")
    if figures and len(front.designs) > 1:
        plots.pareto(front).savefig(folder / FRONT_PICTURE)


KINDS: dict[type, Kind] = {
    Study: Kind((*TABLES, PAGE, *STILLS.values()), _write_study),
    Fit: Kind((SURROGATE, REPORT, PAGE, ACCURACY, PREDICTIONS, NEXT), _write_fit),
    Scan: Kind((SCAN, SCAN_PICTURE), _write_scan),
    FittedRoad: Kind(FITTED_ROAD, _write_fitted_road),
    Comfort: Kind(COMFORT, _write_comfort),
    Feedback: Kind((LAW, GAIN, LAW_TEXT, LAW_PICTURE), _write_law),
    ActiveBound: Kind((LAW, GAIN, LAW_TEXT, LAW_PICTURE), _write_law),
    ActiveFront: Kind((LAW, LAW_TEXT, LAW_PICTURE), _write_front),
    ParetoFront: Kind((FRONT, FRONT_METRICS, FRONT_TEXT, FRONT_PICTURE), _write_designs),
}
