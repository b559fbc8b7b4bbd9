"""Tuned surrogates of an expensive model in a file of plain numbers, with the cheap model that they evaluate."""

from __future__ import annotations

import dataclasses
import json
import warnings
from collections.abc import Mapping
from dataclasses import dataclass, field
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import ArrayLike, NDArray

from ..metrics.weightings import filter_of
from ..quantities import briefly, quantity_of
from ..roads.road import Road
from ..roads.road_fit import unfitted
from ..surrogates.intervals import NoInterval, NoIntervalWarning
from ..surrogates.kriging import CoKriging, Kriging
from ..surrogates.numbers import from_numbers, to_numbers
from ..surrogates.regressor import ExtrapolationWarning, Surrogate
from ..units import factor_of
from ..vehicles.files import utf8_text, vehicle_of, vehicle_table
from .low_fidelity import LowFidelity
from .whole_file import write_whole

FORMAT = "susp_ss surrogate"

VERSION = 2
"""Of the file's layout; files of a later one are refused."""

NO_JSON = "not a surrogate file, or cut short"
"""What is said of text that is no JSON."""

# Kinds that files of version 1 held with another library's numbers.
FOREIGN = ("Kriging", "CoKriging")


@dataclass(frozen=True, eq=False)
class SuspensionSurrogate:
    """One fitted surrogate for each output of an expensive model, on the same inputs.

    Parameters
    ----------
    inputs, outputs : dict of str to str
        Unit of each, SI where the package knows the name.
    models : dict of str to Surrogate
        For each output, fitted on a DataFrame of the inputs.
    low_fidelity : LowFidelity
        The cheap model behind those that have one.
    accuracy : dict of str to dict, optional
        What is known of each output's error, plain numbers.
    stated : dict of str to str, optional
        Units in which the runs stated inputs and outputs, where these are not SI.

    Examples
    --------
    >>> import pandas as pd
    >>> from susp_ss import LowFidelity, Polynomial, QuarterCar, Road
    >>> from susp_ss.fit.surrogate_file import SuspensionSurrogate
    >>> runs = pd.DataFrame({"ks": [15e3, 20e3, 25e3]})
    >>> models = {"sws": Polynomial(degree=1).fit(runs, [0.010, 0.009, 0.008])}
    >>> surrogate = SuspensionSurrogate({"ks": "N/m"}, {"sws": "m"}, models, LowFidelity(QuarterCar(), Road()))
    >>> surrogate.predict(pd.DataFrame({"ks": [18e3]})).round(9)
          sws
    0  0.0094
    """

    inputs: dict[str, str]
    outputs: dict[str, str]
    models: dict[str, Surrogate]
    low_fidelity: LowFidelity
    accuracy: dict[str, dict[str, Any]] = field(default_factory=dict)
    stated: dict[str, str] = field(default_factory=dict)

    def predict(
        self, designs: pd.DataFrame | Mapping[str, ArrayLike], return_std: bool = False, interval: float | None = None
    ) -> pd.DataFrame:
        """Predict every output at designs.

        Parameters
        ----------
        designs : DataFrame (n, k) or mapping of columns
            The inputs by name, in any order.
        return_std : bool
            Add ``<output>_std`` where the surrogate has a predictive standard deviation.
        interval : float, optional
            Add ``<output>_low`` and ``<output>_high``, between which this share of new responses is to lie, such as
            0.95; of an output without interval they are NaN.

        Returns
        -------
        DataFrame, (n, m)
            With the index of the designs.

        Raises
        ------
        ValueError
            An input is missing or unknown, or not a number.

        Warns
        -----
        ExtrapolationWarning
            Designs outside the box of the runs.
        NoIntervalWarning
            An output has no interval, with the reason: its errors at runs left out are not known, as of files of
            earlier versions, or there are too few runs.
        """
        X = self._designs(designs)
        predicted: dict[str, NDArray[np.float64]] = {}
        for name, model in self.models.items():
            predicted[name] = model.predict(X)
            if return_std and isinstance(model, Kriging | CoKriging):
                predicted[f"{name}_std"] = _quietly(model, X, return_std=True)[1]
            if interval is not None:
                predicted[f"{name}_low"], predicted[f"{name}_high"] = self._bounds(name, X, interval).T
        return pd.DataFrame(predicted, index=X.index)

    def left_out_rmse(self, output: str) -> float | None:
        """RMSE of an output at runs left out of the fit, in its unit; None where it is not known."""
        known = self.accuracy.get(output, {}).get("left_out")
        rmse = known.get("RMSE") if isinstance(known, dict) else None
        return float(rmse) if isinstance(rmse, float | int) and np.isfinite(rmse) else None

    def _bounds(self, name: str, X: pd.DataFrame, interval: float) -> NDArray[np.float64]:
        try:
            return np.asarray(_quietly(self.models[name], X, interval=interval)[1])
        except NoInterval as error:
            warnings.warn(f"{name}: {error}", NoIntervalWarning, stacklevel=3)
            return np.full((len(X), 2), np.nan)

    @property
    def box(self) -> dict[str, tuple[float, float]]:
        """Lowest and highest value of each input in the runs."""
        model = next(iter(self.models.values()))
        return dict(zip(self.inputs, zip(model.lowest_.tolist(), model.highest_.tolist(), strict=True), strict=True))

    def outside(self, designs: pd.DataFrame | Mapping[str, ArrayLike]) -> NDArray[np.bool_]:
        """Which of the designs (n,) lie outside the box of the runs."""
        X = self._designs(designs)
        return np.any([model.outside(X) for model in self.models.values()], axis=0)

    def save(self, path: str | PathLike[str]) -> None:
        """Write a JSON file of plain numbers, for `load_surrogate`; a file of that name is replaced at once.

        Raises
        ------
        OSError
            The file cannot be written; nothing half written is left.
        """
        write_whole(Path(path), json.dumps(self.document(), indent=1, allow_nan=False) + "\n")

    def document(self) -> dict[str, Any]:
        """Everything, as JSON knows it."""
        from .. import __version__

        cheap = self.low_fidelity
        return {
            "format": FORMAT,
            "version": VERSION,
            "susp_ss": __version__,
            "inputs": self.inputs,
            "stated": self.stated,
            "low_fidelity": {
                "vehicle": vehicle_table(cheap.vehicle),
                "road": _road_table(cheap.road),
                "place": cheap.place,
                "parameter": cheap.parameter,
                "weighting": _weighting_table(cheap.weighting),
            },
            "outputs": {
                name: {"unit": unit, "accuracy": self.accuracy.get(name, {}), **to_numbers(self.models[name])}
                for name, unit in self.outputs.items()
            },
        }

    def _designs(self, designs: pd.DataFrame | Mapping[str, ArrayLike]) -> pd.DataFrame:
        table = pd.DataFrame(dict(designs)) if isinstance(designs, Mapping) else designs
        if not isinstance(table, pd.DataFrame):
            raise TypeError(f"designs must be a DataFrame or columns by name, got {briefly(designs)}")
        if set(table.columns) != set(self.inputs):
            raise ValueError(
                f"designs must have the columns {', '.join(self.inputs)}, got {', '.join(map(str, table.columns))}"
            )
        return table[list(self.inputs)]


def _quietly(model: Surrogate, X: pd.DataFrame, **asked: Any) -> Any:
    """A prediction of designs of which `ExtrapolationWarning` has been given."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ExtrapolationWarning)
        return model.predict(X, **asked)


def _road_table(road: Road) -> dict[str, Any]:
    road = unfitted(road)
    if type(road) is not Road:
        raise ValueError(f"a surrogate file holds a Road, got a {type(road).__name__}")
    return dataclasses.asdict(road)


def _weighting_table(weighting: Any) -> str | dict[str, list[float]] | None:
    """A weighting as a file holds it: its name, or the coefficients of a filter, highest power first."""
    if weighting is None or isinstance(weighting, str):
        return weighting
    own = filter_of(weighting, "weighting")
    return {"numerator": own.numerator.tolist(), "denominator": own.denominator.tolist()}


def _weighting(table: Any) -> Any:
    """The weighting that a file holds."""
    if table is None or isinstance(table, str):
        return table
    import control

    return control.tf(table["numerator"], table["denominator"])


def load_surrogate(path: str | PathLike[str]) -> SuspensionSurrogate:
    """Read a surrogate file, as ``susp-ss fit`` or `SuspensionSurrogate.save` wrote it.

    Parameters
    ----------
    path : path

    Returns
    -------
    SuspensionSurrogate
        It predicts to the last digit what the saved one did, on the same libraries.

    Raises
    ------
    OSError
        The file cannot be read.
    ValueError
        The file is truncated or damaged (with line and column), no surrogate's, of a newer version, or of an older one
        with a surrogate that another library trained. The message begins with its name.

    Examples
    --------
    >>> import pathlib, tempfile
    >>> import numpy as np, pandas as pd, susp_ss as ss
    >>> from susp_ss.fit.surrogate_file import SuspensionSurrogate
    >>> cheap = ss.LowFidelity(ss.QuarterCar(), ss.Road())
    >>> runs = pd.DataFrame({"ks": [15e3, 20e3, 25e3], "cs": [1e3, 2e3, 1e3]})
    >>> fitted = ss.ResponseBased(cheap.response("sws", list(runs))).fit(runs, [0.010, 0.007, 0.009])
    >>> path = pathlib.Path(tempfile.mkdtemp(), "surrogate.json")
    >>> units = {"ks": "N/m", "cs": "N s/m"}
    >>> SuspensionSurrogate(units, {"sws": "m"}, {"sws": fitted}, cheap).save(path)
    >>> bool(ss.load_surrogate(path).predict(runs).sws[1] == fitted.predict(runs)[1])
    True
    """
    text = utf8_text(Path(path))
    try:
        return surrogate_of(_document(text))
    except ValueError as error:
        raise ValueError(f"{path}: {error}") from error


def _document(text: str) -> Any:
    try:
        return json.loads(text, parse_constant=_refuse_constant)
    except RecursionError:
        raise ValueError("not a surrogate file: nested too deeply") from None
    except json.JSONDecodeError as error:
        raise ValueError(f"{NO_JSON}: {error.msg} (at line {error.lineno}, column {error.colno})") from None
    except ValueError as error:
        raise ValueError(f"not a surrogate file: {error}") from None


def surrogate_of(document: Any) -> SuspensionSurrogate:
    """Make the surrogate of what `SuspensionSurrogate.document` returned.

    Raises
    ------
    ValueError
        As `load_surrogate`, without a name.

    Examples
    --------
    >>> from susp_ss.fit.surrogate_file import surrogate_of
    >>> surrogate_of({})
    Traceback (most recent call last):
    ValueError: not a surrogate file: it must say "format": "susp_ss surrogate"
    """
    if not isinstance(document, dict) or document.get("format") != FORMAT:
        raise ValueError(f'not a surrogate file: it must say "format": "{FORMAT}"')
    version = document.get("version")
    if not isinstance(version, int) or isinstance(version, bool) or version < 1:
        raise ValueError(f"damaged: version must be a whole number >= 1, got {briefly(version)}")
    if version > VERSION:
        raise ValueError(
            f"written by a newer susp_ss ({document.get('susp_ss')}, file version {version}), this one reads "
            f"up to file version {VERSION}; install that version"
        )
    foreign = _foreign(document) if version < VERSION else None
    if foreign:
        raise ValueError(
            f"holds {foreign} of file version {version}, which another library trained; fit the runs again "
            "with susp-ss fit"
        )
    try:
        return _restored(document)
    except KeyError as error:
        raise ValueError(f"damaged: {error} is missing") from error
    except (ValueError, TypeError, AttributeError, IndexError) as error:
        raise ValueError(f"damaged: {error}") from error


def _foreign(document: dict[str, Any]) -> str | None:
    """The first kind in a file whose numbers only another library reads."""
    outputs = document.get("outputs")
    found = outputs.values() if isinstance(outputs, dict) else ()
    kinds = [output.get("kind") for output in found if isinstance(output, dict)]
    return next((kind for kind in FOREIGN if kind in kinds), None)


def _restored(document: dict[str, Any]) -> SuspensionSurrogate:
    inputs, cheap, outputs = document["inputs"], document["low_fidelity"], document["outputs"]
    low_fidelity = LowFidelity(
        vehicle_of(cheap["vehicle"], trust_units=True),
        Road(**cheap["road"]),
        cheap["place"],
        cheap["parameter"],
        _weighting(cheap.get("weighting")),
    )
    columns = list(inputs)
    if not outputs:
        raise ValueError("it has no outputs")
    models = {}
    for name, output in outputs.items():
        if output["columns"] != columns:
            raise ValueError(f"{name} must have the columns {', '.join(columns)}, got {output['columns']!r}")
        if not isinstance(output["accuracy"], dict):
            raise ValueError(f"accuracy of {name} must be numbers by name, got {briefly(output['accuracy'])}")
        tuned = output["kind"] == "ParameterBased"
        models[name] = from_numbers(output, low_fidelity.response(name, columns, tuned))
        somewhere = np.nan_to_num([models[name].lowest_], posinf=1.0, neginf=1.0)
        if not np.isfinite(models[name].predict(pd.DataFrame(somewhere, columns=columns))).all():
            raise ValueError(f"{name} has no finite value at {dict(zip(columns, *somewhere.tolist(), strict=True))}")
    return SuspensionSurrogate(
        inputs,
        {name: output["unit"] for name, output in outputs.items()},
        models,
        low_fidelity,
        {name: output["accuracy"] for name, output in outputs.items()},
        _stated(document.get("stated", {}), {**inputs, **outputs}),
    )


def _stated(units: Any, known: Mapping[str, Any]) -> dict[str, str]:
    """Units that a file states for inputs and outputs, each one of its quantity's."""
    if not isinstance(units, dict):
        raise ValueError(f"stated must be units by name, got {briefly(units)}")
    for name, unit in units.items():
        quantity = quantity_of(name)
        if name not in known or quantity is None or not isinstance(unit, str) or factor_of(unit, quantity) is None:
            raise ValueError(f"stated: {name!r} is in no unit {unit!r}")
    return units


def _refuse_constant(name: str) -> None:
    raise ValueError(f"it holds {name}, which is no number")
