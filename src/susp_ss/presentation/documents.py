"""Results as JSON knows them: dictionaries of plain values, in which NaN becomes null."""

from __future__ import annotations

from dataclasses import asdict
from typing import Any

import numpy as np
import pandas as pd

from ..fit.fitting import Fit
from ..fit.next_runs import asked_for
from ..metrics.comfort import AXES, Comfort
from ..roads.road_fit import FittedRoad, unfitted
from ..study.feasibility import Study
from ..study.optima import Optima
from ..study.published import CRITERIA, SURROGATES
from ..vehicles.files import in_file, vehicle_table
from .text.fit import judged, more
from .text.road import fitted_spectrum, fitted_values
from .versions import versions

TITLE = "Feasibility study of surrogate model for the application of vehicle suspension system, 2021"


def study_document(study: Study) -> dict[str, Any]:
    """Everything of a study but the responses."""
    tables: dict[str, Any] = {surrogate: {criterion: {} for criterion in CRITERIA} for surrogate in SURROGATES}
    for row in study.comparison().to_dict("records"):
        entry = {"unit": row["unit"], "ours": _json(row["ours"]), "published": _json(row["published"])}
        tables[row["surrogate"]][row["criterion"]][row["quantity"]] = entry
    return {
        "study": TITLE,
        "scenario": {
            "vehicle": _vehicle(study.vehicle),
            "low_fidelity": _vehicle(study.low_fidelity),
            "as_published": study.as_published,
            "road": study.road.describe(),
            "corner": study.corner,
            "nodes": list(study.nodes),
            "ks": study.responses.ks.values[[0, -1]].tolist(),
            "cs": study.responses.cs.values[[0, -1]].tolist(),
            "nonnegative": study.nonnegative,
            "statistic": "root mean square",
        },
        "note": "The published study states no scenario; this one is a choice, and nothing is tuned to its tables.",
        "tables": tables,
        "held_out": _nested(study.held_out),
        "cost": _nested(study.cost),
        "optima": _optima(study.optima),
        "seconds": study.seconds,
        "versions": versions(),
    }


def _vehicle(vehicle: Any) -> dict[str, Any] | str:
    """A vehicle as a file holds it; by its name, one of a kind that no file holds, or of a sweep."""
    one = in_file(vehicle) and not vehicle.design_space().dims
    return vehicle_table(vehicle) if one else type(vehicle).__name__


def _nested(frame: pd.DataFrame) -> dict[str, Any]:
    """A frame by (surrogate, criterion) as dictionaries in dictionaries."""
    nested: dict[str, Any] = {surrogate: {} for surrogate in SURROGATES}
    for key, row in zip(frame.index, frame.to_dict("records"), strict=True):
        nested[key[0]][key[1]] = {str(name): _json(value) for name, value in row.items()}
    return nested


def _optima(optima: Optima) -> dict[str, Any]:
    """The optimum, and each surrogate's design by the number of its runs; SI units."""
    landed: dict[str, Any] = {}
    for (surrogate, runs), row in zip(optima.landed.index, optima.landed.to_dict("records"), strict=True):
        landed.setdefault(surrogate, {})[str(runs)] = row
    best = optima.best.to_dict()
    return {"limits": optima.limits, "best": best, "middle": {"beyond": optima.middle}, "landed": landed}


def _json(value: float) -> float | None:
    return float(value) if np.isfinite(value) else None


def fit_document(fit: Fit) -> dict[str, Any]:
    """The ranking, the choice and the formula of each output of a fit."""
    outputs = {}
    for output, found in fit.outputs.items():
        through = fit.low_fidelity.through(output)
        ranking = found.comparison.table.reset_index().astype(object)
        outputs[output] = {
            "unit": fit.runs.units[output],
            "weighting": None if through is None else through.name,
            "taken": found.chosen,
            "predicts": found.verdict.predicts,
            "verdict": judged(fit, output),
            "more_runs": more(fit, output),
            "tied": list(found.comparison.tied),
            "baseline": found.comparison.baseline,
            "ranking": ranking.where(ranking.notna(), None).to_dict("records"),
            "untuned": None if found.untuned is None else found.untuned._asdict(),
            "held_out": {name: kept.accuracy._asdict() for name, kept in found.kept_back.items()},
            "not_fitted": found.comparison.refused,
            "formula": None if found.formula is None else dict(zip(("surrogate", "text"), found.formula, strict=True)),
        }
    document = {"runs": len(fit.runs.rows), "inputs": fit.surrogate.inputs, "outputs": outputs}
    plan = asked_for(fit)
    return document if plan is None else document | {"next_runs": plan.designs.to_dict("records")}


def comfort_document(comfort: Comfort) -> dict[str, Any]:
    """Everything asked and found of a ride, one row a design and point."""
    metrics = comfort.metrics
    table = comfort.table.reset_index() if metrics.dims else comfort.table
    return {
        "vehicle": _vehicle(comfort.vehicle),
        "ride": comfort.describe(),
        "points": {name: {"value": list(place), "unit": "m"} for name, place in comfort.points.items()},
        "duration": {"value": comfort.duration, "unit": "s"},
        "weightings": {name: metrics[name].attrs["weighting"] for name in AXES if name in metrics},
        "k": {name: axis.k for name, axis in AXES.items() if name in metrics},
        "units": {str(name): data.attrs["units"] for name, data in metrics.items()},
        "comfort": [{str(name): _plain(value) for name, value in row.items()} for row in table.to_dict("records")],
    }


def fitted_road_document(road: FittedRoad) -> dict[str, Any]:
    """A road, and what its profile says of it: each value with the ends of its interval, and the bands."""
    bands = fitted_spectrum(road)
    return {
        "road": {**asdict(unfitted(road)), "description": road.describe()},
        "iso_class": road.iso_class,
        "class_by": "geometric mean",
        "fitted": {name: [value, *road.intervals[name]] for name, value in fitted_values(road).items()},
        "confidence": road.confidence,
        "scatter": road.scatter,
        "bands": {str(name): bands[name].values.tolist() for name in bands.variables},
    }


def _plain(value: Any) -> Any:
    return _json(value) if isinstance(value, float) else value
