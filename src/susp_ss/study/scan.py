"""Which unstated assumptions bring the published tables near: the study's fits over a table of scenarios.

The study states neither road nor speed nor place of measurement. Every scenario here is fitted afresh and compared with
Tables 3 to 5; nothing is tuned to them, and the nearest scenario is not a claim about what its authors ran.
"""

from __future__ import annotations

import dataclasses
import functools
import itertools
import warnings
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import pandas as pd
import xarray as xr
from numpy.typing import ArrayLike, NDArray

from ..metrics.ride import ride_metrics
from ..progress import tracked
from ..roads.road import CLASSES, TRACKS, Road
from ..surrogates import accuracy
from ..vehicles.full import FullCar
from ..vehicles.quarter import QuarterCar
from .feasibility import by_criterion, checked_nodes, designs, grid
from .fits import coefficients_of, fit_criterion
from .published import ACCURACY, COEFFICIENTS, CRITERIA, comparison, published, usable
from .tabulated import Tabulated

Entries = dict[tuple[str, str, str], float]
"""Values of the tables by (surrogate, criterion, quantity)."""

# The scenarios: every combination of these, but for what makes no difference (tracks where one side alone is excited,
# the delay where one axle is). Roughness only scales the responses, so that classes cost nothing.
EXCITED: dict[str, tuple[str, ...] | None] = {
    "all wheels": None,
    "front axle": ("fr", "fl"),
    "right side": ("fr", "rr"),
    "front right": ("fr",),
}
SPEEDS = (10.0, 20.0, 30.0)
CUTOFFS = (0.0, 0.01)
ROAD_CLASSES = ("A", "B", "C", "D")
FITS = {"free": False, "nonnegative": True}
# Point of BAcc, and corner of SWS and DTL.
PLACES = {"fr": ("fr", "fr"), "rr": ("rr", "rr"), "BAcc cg, fr": ("cg", "fr"), "BAcc cg, rr": ("cg", "rr")}

# Waviness other than 2, where all wheels see the road.
OTHERS = ((20.0, 2.5, 0.0),)  # speed, waviness, cut-off

FACTORS = ["excited", "tracks", "delay", "speed", "waviness", "cutoff", "place", "road_class", "fit"]
DEFAULT = ("all wheels", "isotropic", "on", 20.0, 2.0, 0.0, "fr", "B", "free")
DISTANCES = ["distance", "accuracies", "coefficients", "masses"]


@dataclass(frozen=True, eq=False)
class Scan:
    """What `scan_scenarios` found.

    Attributes
    ----------
    scenarios : DataFrame
        One row a scenario, nearest first. What was assumed: ``excited`` wheels, ``tracks``, ``delay`` ("any" where it
        makes no difference), ``speed`` (m/s), ``waviness``, ``cutoff`` (cycle/m), ``place`` of the metrics,
        ``road_class``, and ``fit`` (free or nonnegative). What came out: ``distance``, its parts over ``accuracies``,
        ``coefficients`` of RB and VB, and tuned ``masses``; ``worst``, the entry that differs most, and by how much;
        and ``refused``: why there is no distance. A scenario without finite variance is listed last.
    """

    scenarios: pd.DataFrame

    @property
    def finite(self) -> pd.DataFrame:
        """Scenarios that have a distance."""
        return self.scenarios[self.scenarios["refused"] == ""]

    @property
    def refused(self) -> pd.DataFrame:
        """Scenarios that have none."""
        return self.scenarios[self.scenarios["refused"] != ""]

    def nearest_by_factor(self) -> pd.DataFrame:
        """Smallest distance that each assumption reaches, whatever the others: which can come near and which cannot.

        Returns
        -------
        DataFrame
            Columns factor, level, distance (NaN: refused throughout), scenarios, refused (how many of them).
        """
        rows = [
            (factor, level, group["distance"].min(), len(group), int((group["refused"] != "").sum()))
            for factor in FACTORS
            for level, group in self.scenarios.groupby(factor, sort=False)
        ]
        summary = pd.DataFrame(rows, columns=["factor", "level", "distance", "scenarios", "refused"])
        order = summary["factor"].map(FACTORS.index)
        return summary.assign(order=order).sort_values(["order", "distance"], ignore_index=True).drop(columns="order")

    def rank(self, scenario: Sequence[Any]) -> int | None:
        """Place of a scenario, its factors in the order of `FACTORS`, counted from 1; None if it has no distance."""
        matches = (self.finite[FACTORS] == pd.Series(dict(zip(FACTORS, scenario, strict=True)))).all(axis=1)
        found = np.flatnonzero(matches)
        return int(found[0]) + 1 if len(found) else None

    def __repr__(self) -> str:
        """How many scenarios there are, and how near the nearest comes."""
        return (
            f"Scan of {len(self.scenarios)} scenarios, {len(self.refused)} of them without finite variance; nearest to "
            f"the published tables at {self.finite['distance'].min():.3g}"
        )

    def _repr_html_(self) -> str:
        return self.finite.head(10).to_html()


def scan_scenarios(nodes: tuple[int, int] = (10, 10), progress: bool = False) -> Scan:
    """Fit the study's surrogates in many scenarios and rank these by their distance to the published tables.

    The distance is the root mean square of ``(ours - published) / |published|`` over all printed, usable entries of
    Tables 3 to 5: VB of SWS is left out, and a '-' counts as unknown. Nothing is tuned to the tables.

    Parameters
    ----------
    nodes : (int, int)
        Springs and dampers on the grid of every scenario.
    progress : bool
        Show progress on stderr.

    Returns
    -------
    Scan

    Examples
    --------
    The whole scan takes half a minute. What it varies:

    >>> from susp_ss.study.scan import FACTORS
    >>> ", ".join(FACTORS)
    'excited, tracks, delay, speed, waviness, cutoff, place, road_class, fit'
    """
    X = designs(*grid(*checked_nodes(nodes)))
    cases = list(_roads())
    rows: list[dict[str, Any]] = []
    known = _published_entries()
    quarter_cars: dict[tuple[float, float, float], dict[str, Tabulated]] = {}
    for labels, road in tracked(cases, "scenarios", progress):
        try:
            metrics = ride_metrics(FullCar(ks=X[:, 0], cs=X[:, 1]), road)
        except ValueError as error:
            rows += [labels | scenario | {"refused": str(error)} for scenario in _variants()]
            continue
        key = (road.speed, road.cutoff, road.waviness)
        if key not in quarter_cars:
            quarter_cars[key] = _quarter_car(dataclasses.replace(road, wheels=None), X)
        rows += [labels | row for row in _compared(metrics, quarter_cars[key], X, known)]
    table = pd.DataFrame(rows, columns=[*FACTORS, *DISTANCES, "worst", "refused"])
    # Refused scenarios, without a distance, go last; ties keep the order of the table of scenarios.
    return Scan(table.sort_values("distance", kind="stable", ignore_index=True))


def distance(ours: Entries, known: Entries) -> float:
    """Root mean square of the relative differences over the entries of ``known``."""
    return float(np.sqrt(np.mean([(ours[key] / value - 1.0) ** 2 for key, value in known.items()])))


def _published_entries() -> Entries:
    entries = comparison(published().accuracy, published().coefficients)
    rows = entries[usable(entries)].to_dict("records")
    return {(row["surrogate"], row["criterion"], row["quantity"]): row["published"] for row in rows}


def _roads() -> Iterator[tuple[dict[str, Any], Road]]:
    """Every road of the scan with its labels, at class B."""
    for excited, wheels in EXCITED.items():
        tracks = TRACKS if excited in ("all wheels", "front axle") else TRACKS[:1]
        delays = (True, False) if excited in ("all wheels", "right side") else (True,)
        for track, delay in itertools.product(tracks, delays):
            labels = {
                "excited": excited,
                "tracks": track if len(tracks) > 1 else "any",
                "delay": ("on" if delay else "off") if len(delays) > 1 else "any",
            }
            choices = [(speed, 2.0, cutoff) for speed, cutoff in itertools.product(SPEEDS, CUTOFFS)]
            choices += OTHERS if wheels is None else ()
            for speed, waviness, cutoff in choices:
                road = Road.iso8608(
                    "B", speed=speed, waviness=waviness, cutoff=cutoff, tracks=track, delay=delay, wheels=wheels
                )
                yield labels | {"speed": speed, "waviness": waviness, "cutoff": cutoff}, road


def _variants() -> Iterator[dict[str, Any]]:
    """What varies on one road: the place, the class and the fit."""
    for place, road_class, kind in itertools.product(PLACES, ROAD_CLASSES, FITS):
        yield {"place": place, "road_class": road_class, "fit": kind}


@dataclass(frozen=True)
class _Criterion:
    """One criterion of the quarter car as a response over (X, ms); the criteria share their evaluations."""

    name: str
    evaluate: Callable[[bytes, bytes], xr.DataArray]
    parameter_value: float = QuarterCar().ms

    def __call__(self, X: NDArray, ms: ArrayLike | None = None) -> NDArray[np.float64]:
        masses = np.broadcast_to(self.parameter_value if ms is None else np.asarray(ms, dtype=float), len(X))
        return self.evaluate(X.tobytes(), masses.tobytes()).sel(criterion=self.name).values


def _quarter_car(road: Road, X: NDArray) -> dict[str, Tabulated]:
    @functools.cache
    def evaluate(nodes: bytes, masses: bytes) -> xr.DataArray:
        ks, cs = np.frombuffer(nodes).reshape(-1, 2).T
        car = QuarterCar(ms=np.frombuffer(masses), ks=ks, cs=cs)
        return by_criterion(ride_metrics(car, road))

    return {criterion: Tabulated(_Criterion(criterion, evaluate), X) for criterion in CRITERIA}


def _compared(
    metrics: xr.Dataset, quarter_car: dict[str, Tabulated], X: NDArray, known: Entries
) -> Iterator[dict[str, Any]]:
    """Distances of every variant on one road."""
    at_place: dict[tuple[str, str, str], Entries] = {}
    for (point, corner), (kind, nonnegative) in itertools.product(PLACES.values(), FITS.items()):
        for criterion in CRITERIA:
            at = point if criterion == "bacc" else corner
            if (criterion, at, kind) not in at_place:
                y = metrics[criterion].sel({metrics[criterion].dims[-1]: at}).values
                at_place[criterion, at, kind] = _fitted(criterion, y, quarter_car[criterion], X, nonnegative)
    for variant in _variants():
        point, corner = PLACES[variant["place"]]
        entries = {
            key: value * _scale(key, variant["road_class"])
            for criterion in CRITERIA
            for key, value in at_place[criterion, point if criterion == "bacc" else corner, variant["fit"]].items()
        }
        yield variant | _distances(entries, known) | {"refused": ""}


def _fitted(criterion: str, y: NDArray, f: Tabulated, X: NDArray, nonnegative: bool) -> Entries:
    with warnings.catch_warnings():
        # A mass on its bound is as far from the published one as any other.
        warnings.filterwarnings("ignore", message="the tuned parameter")
        models = fit_criterion(X, y, f, nonnegative)
    entries: Entries = {}
    for surrogate, model in models.items():
        values = [*accuracy(y, model.predict(X)), *coefficients_of(model)]
        for quantity, value in zip(ACCURACY + COEFFICIENTS[surrogate], values, strict=True):
            entries[surrogate, criterion, quantity] = value
    return entries


def _scale(key: tuple[str, str, str], road_class: str) -> float:
    """How an entry grows from class B: with the responses, but for pure numbers and masses."""
    surrogate, _, quantity = key
    fixed = quantity in ("R2", "ms") or (surrogate, quantity) == ("RB", "a1")
    return 1.0 if fixed else float(np.sqrt(CLASSES[road_class] / CLASSES["B"]))


def _distances(ours: Entries, known: Entries) -> dict[str, Any]:
    groups = {
        "distance": known,
        "accuracies": {key: value for key, value in known.items() if key[2] in ACCURACY},
        "coefficients": {key: value for key, value in known.items() if key[2] not in (*ACCURACY, "ms")},
        "masses": {key: value for key, value in known.items() if key[2] == "ms"},
    }
    worst = max(known, key=lambda key: abs(ours[key] / known[key] - 1.0))
    times = ours[worst] / known[worst]
    return {name: distance(ours, group) for name, group in groups.items()} | {
        "worst": f"{' '.join(worst)} x{times:.2g}"
    }
