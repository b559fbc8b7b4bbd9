"""A model of another program, by its FMU: run over synthesised roads, one process a run, and reduced to metrics.

A run is a design of the model's parameters. All drive over the same heights of the road, so that their metrics differ
by design alone, and whatever fails of one run is said of it while the others go on.
"""

from __future__ import annotations

import difflib
import functools
import hashlib
import json
import os
import warnings
from collections.abc import Mapping, Sequence
from os import PathLike
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from ..extras import needing
from ..fit.histories import over_time
from ..fit.runs import Runs, bounded, check_asked, checked_together
from ..fit.tables import possible_units, quantity
from ..metrics.weightings import filter_of
from ..quantities import briefly, whole_number
from ..responses.excitation import check_kinds
from ..responses.filters import Filter
from ..responses.records import heights_under
from ..roads.road import Road
from ..units import factor_of
from ..vehicles.contract import RoadVehicle
from ..vehicles.quarter import QuarterCar
from ..vehicles.signals import HEIGHT, RATE
from .kept import Design, Kept
from .running import Drive, outcomes

Array = NDArray[np.float64]

REAL = ("Real", "Float64")


class Variable(NamedTuple):
    """A variable of an FMU: its name there, its unit, and how much of the SI unit that is."""

    name: str
    unit: str
    factor: float


class FMU:
    """A model of another program as an FMU: FMI 2 or 3, co-simulation or model exchange.

    Parameters
    ----------
    path : path
    inputs, outputs : mapping of str to str
        For each name in this package's terms (``ks``, ``bacc``, ``sws_rr``), as in `read_runs`, the variable of the
        FMU: a parameter that can be set, and what is measured. Units are those that the FMU states, else SI.
    heights : mapping of str to str, optional
        For each wheel the input that takes the height of the road under it, in m, or its rate, if the name begins with
        ``dz_r``. Without it these are the inputs named ``z_r``, or ``z_r_fr`` and so on.
    units : mapping of str to str, optional
        Unit of a variable, over the one that the FMU states.

    Raises
    ------
    OSError, ModuleNotFoundError
        The file cannot be read; FMPy, the extra ``fmu``, is not installed.
    ValueError
        No FMU of FMI 2 or 3, or none for this system; a variable that it does not have, that cannot be set, is no real
        number, or has a unit of another kind; no input for the road.

    Notes
    -----
    An FMU is a program: run none whose source you do not trust.

    Examples
    --------
    >>> import susp_ss as ss
    >>> model = ss.FMU("model.fmu", {"ks": "front.k"}, {"bacc": "body.a"})  # doctest: +SKIP
    >>> designs = ss.sample({"ks": (15e3, 25e3)}, 12)  # doctest: +SKIP
    >>> runs = model.run(designs, ss.Road.iso8608("B"), kept="runs.json")  # doctest: +SKIP

    An FMU that was exported here has its parameters in its matrices:

    >>> import pathlib, tempfile
    >>> path = ss.export(ss.QuarterCar(), pathlib.Path(tempfile.mkdtemp(), "car.fmu"))
    >>> ss.FMU(path, {"ks": "ks"}, {"bacc": "bacc"})
    Traceback (most recent call last):
    ValueError: ...
    """

    def __init__(
        self,
        path: str | PathLike[str],
        inputs: Mapping[str, str],
        outputs: Mapping[str, str],
        *,
        heights: Mapping[str, str] | None = None,
        units: Mapping[str, str] | None = None,
    ):
        self.path = Path(path)
        given = check_asked(inputs, outputs, units or {})
        self._known = _variables(self.path)
        self.inputs = {name: self._variable(name, own, given, True) for name, own in inputs.items()}
        self.outputs = {name: self._variable(name, own, given, False) for name, own in outputs.items()}
        self.heights = self._heights(heights)
        stems = {own.startswith(RATE) for own in self.heights.values()}
        if len(stems) > 1:
            raise ValueError(f"{self.path}: the road's inputs must be all heights, or all rates (dz_r...)")
        self._by_rate = stems == {True}

    def __repr__(self) -> str:
        return f"FMU of {self.path}: {', '.join(self.outputs)} by {', '.join(self.inputs)}"

    def _variable(self, name: str, own: str, given: Mapping[str, str], is_input: bool) -> Variable:
        found = self._found(own)
        if is_input and not _settable(found):
            what = f"{found.variability or ''} {found.causality or ''}".strip()
            raise ValueError(f"{self.path}: the variable {own!r} cannot be set, it is {what}; inputs are parameters")
        unit = quantity(name).unit
        declared = found.unit or (found.declaredType.unit if found.declaredType is not None else None)
        stated = given.get(name) or declared or unit
        factor = factor_of(stated, quantity(name)) if unit else 1.0
        if factor is None:
            raise ValueError(f"{self.path}: {name} is in {possible_units(name)}, but {own!r} is in {stated!r}")
        return Variable(own, stated, factor)

    def _found(self, own: str) -> Any:
        if own not in self._known:
            close = difflib.get_close_matches(own, self._known, n=3)
            some = ", ".join(map(repr, close or list(self._known)[:10]))
            meant = f"did you mean {some}?" if close else f"it has {some}{' ...' if len(self._known) > 10 else ''}"
            raise ValueError(f"{self.path}: no variable {own!r}; {meant}")
        found = self._known[own]
        if found.type not in REAL or found.dimensions:
            raise ValueError(f"{self.path}: the variable {own!r} is no real number, but {found.type}")
        return found

    def _heights(self, asked: Mapping[str, str] | None) -> dict[str, str]:
        if asked is None:
            driven = [name for name, variable in self._known.items() if variable.causality == "input"]
            asked = {
                name.removeprefix(stem).removeprefix("_"): name
                for name in driven
                for stem in (HEIGHT, RATE)
                if name == stem or name.startswith(f"{stem}_")
            }
            if not asked:
                raise ValueError(
                    f"{self.path}: no input is named z_r or z_r_fr; say in FMU(heights=...) which of its "
                    f"inputs takes the road's height: {', '.join(map(repr, driven)) or 'it has none'}"
                )
        for own in asked.values():
            if self._found(own).causality != "input":
                raise ValueError(f"{self.path}: the road needs an input, but {own!r} is {self._found(own).causality}")
        return dict(asked)

    def run(
        self,
        designs: Any,
        road: Road,
        *,
        like: RoadVehicle | None = None,
        duration: float = 60.0,
        cut: float = 5.0,
        step: float = 1e-3,
        seed: int = 0,
        weighting: Any = None,
        kept: str | PathLike[str] | None = None,
        processes: int | None = None,
        progress: bool = False,
    ) -> Runs:
        """Run the model at designs of its inputs over one synthesised road.

        Parameters
        ----------
        designs : DataFrame, or mapping of str to (n,)
            In SI units, one column an input.
        road : Road
            One number for every parameter. Its heights fade in over the first half of the cut.
        like : vehicle, optional
            Whose wheels, wheelbase and track width the model has; a model on one wheel needs none.
        duration, cut : float
            Length of a run, and how much of its start is left out, in s.
        step : float
            Of samples and of co-simulation, in s.
        seed : int
            Of the road.
        weighting : str or system of python-control, optional
            A filter before accelerations become root mean squares, as in `ride_metrics`.
        kept : path, optional
            Finished runs go into this file (JSON) and are taken from it, so that a second call goes on where the first
            broke off.
        processes : int, optional
            Runs at a time; as many as there are processors by default.
        progress : bool, optional
            Show progress on stderr.

        Returns
        -------
        Runs
            Those that succeeded, for `fit_runs`: root mean squares about the mean after the cut, of ``damper_power``
            the mean.

        Raises
        ------
        OSError
            ``kept`` cannot be written.
        TypeError, ValueError
            Designs without an input or beyond its bound; a road with arrays; wheels that are not those of ``like``;
            times that do not fit together; a weighting that is none; ``kept`` holds other runs; every run failed.

        Warns
        -----
        UserWarning
            A run failed: which, and why. It is tried again when ``kept`` is taken up again.
        """
        X = self._designs(designs)
        like = self._like(like)
        check_kinds(like, road)
        road.single("FMU.run()")
        seed = whole_number("seed", seed, 0)
        processes = whole_number("processes", os.cpu_count() if processes is None else processes, 1)
        _check_times(duration, cut, step)
        behind = None if weighting is None else filter_of(weighting, "weighting")
        asked = self._asked(road, like, behind, duration, cut, step, seed)
        store = Kept(None if kept is None else Path(kept), asked)
        todo = [i for i, design in enumerate(X) if tuple(design.tolist()) not in store.runs]
        todo = [i for i in todo if not any((X[i] == X[j]).all() for j in todo if j < i)]
        failed: dict[int, str] = {}
        if todo:
            drive = self._drive(road, like, duration, cut, step, seed)
            ask = {i: self._parameters(X[i]) for i in todo}
            reduced = functools.partial(self._metrics, cut=cut, behind=behind)
            for i, outcome in outcomes(self.path, drive, ask, reduced, processes, progress):
                if isinstance(outcome, str):
                    failed[i] = outcome
                    warnings.warn(f"{self.path}, run {i + 1} ({self._said(X[i])}) failed: {outcome}", stacklevel=2)
                else:
                    store.add(tuple(X[i].tolist()), outcome)
        return self._runs(X, store.runs, failed, (road, like, duration, cut, step, seed, weighting), behind)

    def _designs(self, designs: Any) -> Array:
        try:
            table = pd.DataFrame(designs)
        except (ValueError, TypeError):
            raise TypeError(f"designs must be a table with a column for each input, got {briefly(designs)}") from None
        missing = [name for name in self.inputs if name not in table]
        if missing or not len(table):
            lacks = f"no column {', '.join(missing)}" if missing else "no row"
            raise ValueError(f"designs must have a column for each of {', '.join(self.inputs)}, and rows; {lacks}")
        if len(table.columns) > len(self.inputs):
            more = ", ".join(str(name) for name in table if name not in self.inputs)
            raise ValueError(f"designs have columns that are no input: {more}")
        try:
            X = table[list(self.inputs)].to_numpy(dtype=float)
        except (ValueError, TypeError):
            raise TypeError("designs must be numbers in SI units") from None
        for j, name in enumerate(self.inputs):
            for i, value in enumerate(X[:, j].tolist()):
                bounded(name, value, f"designs, run {i + 1}", value)
        return X

    def _like(self, like: RoadVehicle | None) -> RoadVehicle:
        if like is None and list(self.heights) == [""]:
            return QuarterCar()
        wheels = ", ".join(map(repr, self.heights))
        if like is None:
            raise ValueError(
                f"{self.path} has inputs for the wheels {wheels}; pass run(like=...), a vehicle with its wheelbase and "
                "track width"
            )
        if isinstance(like, RoadVehicle) and set(like.wheels) != set(self.heights):
            own = ", ".join(map(repr, like.wheels))
            raise ValueError(
                f"run(like=...) must have the wheels of {self.path}, {wheels}, got {type(like).__name__} with {own}"
            )
        return like

    def _asked(self, road: Road, like: RoadVehicle, behind: Filter | None, *times: float) -> dict[str, Any]:
        """Whatever runs hang on but for their designs, as JSON holds it."""
        of = {
            "FMU": hashlib.sha256(self.path.read_bytes()).hexdigest(),
            "inputs": {name: list(variable) for name, variable in self.inputs.items()},
            "outputs": {name: list(variable) for name, variable in self.outputs.items()},
            "heights": self.heights,
            "road": repr(road),
            "wheels": {name: list(wheel) for name, wheel in like.wheels.items()},
            "wheelbase": [float(distance) for distance in like.axles[1:]],
            "track width": float(like.track_width),
        }
        of |= dict(zip(("duration", "cut", "step", "seed"), times, strict=True))
        of["weighting"] = None if behind is None else [behind.numerator.tolist(), behind.denominator.tolist()]
        return json.loads(json.dumps(of))

    def _drive(self, road: Road, like: RoadVehicle, duration: float, cut: float, step: float, seed: int) -> Drive:
        """The road as the model's inputs."""
        z = heights_under(like, road, duration, step, seed)
        t: Array = np.arange(z.shape[1]) * np.float64(step)
        if cut:
            # A model that starts on a flat road must not fall onto this one.
            z = z * (0.5 - 0.5 * np.cos(np.pi * np.minimum(2.0 * t / cut, 1.0)))
        order = [list(like.wheels).index(wheel) for wheel in self.heights]
        u = np.gradient(z[order], step, axis=1) if self._by_rate else z[order]
        return Drive(t, u, tuple(self.heights.values()), tuple(variable.name for variable in self.outputs.values()))

    def _metrics(self, t: Array, y: Array, cut: float, behind: Filter | None) -> dict[str, float]:
        return {
            name: over_time(name, t, variable.factor * values, cut, behind)
            for (name, variable), values in zip(self.outputs.items(), y, strict=True)
        }

    def _parameters(self, design: Array) -> dict[str, float]:
        """What the FMU's own variables are set to."""
        own = zip(self.inputs.values(), design.tolist(), strict=True)
        return {variable.name: value / variable.factor for variable, value in own}

    def _said(self, design: Array) -> str:
        return ", ".join(
            f"{name} = {value:g} {quantity(name).unit}".rstrip()
            for name, value in zip(self.inputs, design.tolist(), strict=True)
        )

    def _runs(
        self,
        X: Array,
        found: Mapping[Design, Mapping[str, float]],
        failed: Mapping[int, str],
        how: Sequence[Any],
        behind: Filter | None,
    ) -> Runs:
        done = [i for i, design in enumerate(X) if tuple(design.tolist()) in found]
        if not done:
            first = min(failed)
            raise ValueError(
                f"{self.path}: every run failed; run {first + 1} ({self._said(X[first])}): {failed[first]}"
            )
        responses = [found[tuple(X[i].tolist())] for i in done]
        names = {name: variable.name for name, variable in (self.inputs | self.outputs).items()}
        units = {name: quantity(name).unit or variable.unit for name, variable in (self.inputs | self.outputs).items()}
        road, like, duration, cut, step, seed, weighting = how
        read = {"designs": dict(zip(self.inputs, X[done].T.tolist(), strict=True)), "road": road, "like": like}
        read |= {"duration": duration, "cut": cut, "step": step, "seed": seed}
        read |= {} if weighting is None else {"weighting": weighting}
        of = {own: {name: one.name for name, one in getattr(self, own).items()} for own in ("inputs", "outputs")}
        stated = {name: variable.unit for name, variable in (self.inputs | self.outputs).items()}
        noted = f"{self.path}: {len(done)} of {len(X)} runs over {duration:g} s, root mean squares about the mean from "
        runs = Runs(
            pd.DataFrame(X[done], columns=list(self.inputs)),
            pd.DataFrame(responses, columns=list(self.outputs), dtype=float),
            np.array(done) + 1,
            self.path,
            units,
            names,
            stated,
            (f"FMU({str(self.path)!r}, **{of!r}, heights={self.heights!r}, units={stated!r}).run", read),
            "run",
            f"{noted}{cut:g} s on" + (f", accelerations through {behind.name}" if behind else ""),
        )
        return checked_together(runs)


def _variables(path: Path) -> dict[str, Any]:
    """Every variable of an FMU by its name, if it can be run here.

    Raises
    ------
    OSError, ModuleNotFoundError, ValueError
        As `FMU`.
    """
    with needing("fmu", f"{path}: an FMU"):
        import fmpy
    with path.open("rb"):
        pass
    try:
        model = fmpy.read_model_description(str(path), validate=False)
        platforms = fmpy.supported_platforms(str(path))
    except Exception as error:  # whatever a damaged file makes the reader raise
        raise ValueError(f"{path}: no FMU: {' '.join(str(error).split())}") from None
    if model.fmiVersion != "2.0" and not model.fmiVersion.startswith("3."):
        raise ValueError(f"{path}: needs FMI 2 or 3, got {model.fmiVersion}")
    if model.coSimulation is None and model.modelExchange is None:
        raise ValueError(f"{path}: is neither for co-simulation nor for model exchange")
    if fmpy.platform not in platforms:
        held = ", ".join(platforms) or "none"
        raise ValueError(f"{path}: has no binary for {fmpy.platform}, only {held}; export it for this system")
    return {variable.name: variable for variable in model.modelVariables}


def _settable(variable: Any) -> bool:
    return variable.causality in ("parameter", "structuralParameter") or (
        variable.variability != "constant"
        and variable.initial in ("exact", "approx")
        and variable.causality != "output"
    )


def _check_times(duration: float, cut: float, step: float) -> None:
    for name, value in (("duration", duration), ("cut", cut), ("step", step)):
        if isinstance(value, bool) or not isinstance(value, (int, float)) or not np.isfinite(value):
            raise TypeError(f"{name} must be a number in s, got {briefly(value)}")
    if not step > 0.0 or not duration >= 100.0 * step:
        raise ValueError(
            f"run(duration=...) must be at least 100 steps, and the step > 0 s, got {duration} s and {step} s"
        )
    if not 0.0 <= cut < duration:
        raise ValueError(f"run(cut=...) must be >= 0 s and less than the duration of {duration:g} s, got {cut}")
