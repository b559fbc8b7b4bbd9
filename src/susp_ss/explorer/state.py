"""What the explorer's page is told: one table for its sliders, its URL, and whoever else computes what it shows.

A state is plain JSON in SI units. What is not in the table of its model (`table`) cannot be set.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any
from urllib.parse import parse_qsl, urlencode

from ..quantities import briefly, signal
from ..roads.road import CLASSES, DEFAULT_ROAD, Road
from ..vehicles.contract import RoadVehicle
from ..vehicles.files import model_named
from .table import DESIGN, Choice, Number, rows

MODELS = ("full", "quarter", "pitch-half", "roll-half", "ride-handling", "three-axle")
"""Models that the page offers beside the one of a file, the first to begin with."""

FILE = "file"
"""The model of a file given at start."""

OPTIONAL = ("curve", "seat")
"""Tables of a state that may be None."""


@dataclass(frozen=True, eq=False)
class Given:
    """What an explorer is started with.

    Parameters
    ----------
    vehicle : Vehicle or LinearVehicle, optional
        Of a file, for the model ``"file"``.
    road : Road, optional
        Where the road begins; a measured one keeps its spectrum.
    surrogates : mapping of str to SuspensionSurrogate
        By the name of their file.
    """

    vehicle: RoadVehicle | None = None
    road: Road = DEFAULT_ROAD
    surrogates: Mapping[str, Any] = dataclasses.field(default_factory=dict)

    @cached_property
    def models(self) -> dict[str, RoadVehicle]:
        """Every model that the page offers, as it is before anything is set; the first to begin with."""
        own = {} if self.vehicle is None else {FILE: self.vehicle}
        return own | {name: model_named(name)() for name in MODELS}

    @cached_property
    def tables(self) -> dict[str, tuple[Number | Choice, ...]]:
        """For each model, what the page may set."""
        return {name: rows(car, self.road) for name, car in self.models.items()}

    def default(self, model: str | None = None) -> dict[str, Any]:
        """The state in which nothing is set."""
        name = next(iter(self.models)) if model is None else model
        state: dict[str, Any] = {"model": name, "vehicle": {}, **dict.fromkeys(OPTIONAL)}
        for row in self.tables[name]:
            if row.table in OPTIONAL:
                continue
            _put(state, row, row.default)
        return state

    def document(self) -> dict[str, Any]:
        """The tables and defaults of all models as plain JSON, for the page's scripts."""
        return {
            "models": {
                name: {"rows": [one._asdict() | {"kind": type(one).__name__.lower()} for one in table]}
                | {"default": self.default(name)}
                for name, table in self.tables.items()
            },
            "optional": list(OPTIONAL),
            "design": list(DESIGN),
            "classes": CLASSES,
        }


NOTHING = Given()


def checked(state: Any, given: Given = NOTHING) -> tuple[dict[str, Any], list[dict[str, str]]]:
    """Whatever is right of a state from outside, the rest as it is by default, and what is wrong with it.

    Returns
    -------
    state : dict
        Complete.
    errors : list of dict
        ``parameter``, the name in the URL, and ``message``, one line.

    Examples
    --------
    >>> from susp_ss.explorer.state import checked
    >>> state, errors = checked({"model": "quarter", "vehicle": {"ks": -3.0}})
    >>> state["vehicle"]["ks"], errors[0]["message"]
    (18553.0, 'ks must be a number from ... to ... N/m, got -3.0')
    """
    if not isinstance(state, Mapping):
        return given.default(), [_error("state", f"state must be a mapping, got {briefly(state)}")]
    errors = []
    model = state.get("model", next(iter(given.models)))
    if not isinstance(model, str) or model not in given.models:
        errors.append(_error("model", f"model must be one of {', '.join(given.models)}, got {briefly(model)}"))
        model = next(iter(given.models))
    right = given.default(model)
    known = {(row.table, row.key): row for row in given.tables[model]}
    for table, key, value in _leaves(state):
        row = known.get((table, key))
        if row is None:
            name = _name(table, key)
            errors.append(_error(name, f"no parameter of {model} named {briefly(name)}"))
            continue
        message = _wrong(row, value)
        if message:
            errors.append(_error(row.name, message))
            continue
        if right.get(row.table, ()) is None:
            right[row.table] = {other.key: other.default for other in known.values() if other.table == row.table}
        _put(right, row, _plain(row, value))
    for row in given.tables[model]:
        message = "" if right["seat"] else _unseated(right, row)
        if message:
            errors.append(_error(row.name, message))
            _put(right, row, row.default)
    return right, errors


def query(state: Mapping[str, Any], given: Given = NOTHING) -> str:
    """What of a state differs from the default, as the query of a URL.

    Examples
    --------
    >>> from susp_ss.explorer.state import NOTHING, query
    >>> state = NOTHING.default("quarter")
    >>> state["vehicle"]["ks"] = 20000.0
    >>> query(state)
    'model=quarter&ks=20000'
    """
    model = state["model"]
    default = given.default(model)
    parts = [] if model == next(iter(given.models)) else [("model", model)]
    for row in given.tables[model]:
        own, usual = _get(state, row), _get(default, row)
        if own is not None and (own != usual or row.table in OPTIONAL):
            parts.append((row.name, ",".join(own) if isinstance(row, Choice) and row.several else _text(own)))
    return urlencode(parts, safe="@,")


def from_query(text: str, given: Given = NOTHING) -> tuple[dict[str, Any], list[dict[str, str]]]:
    """The state of a URL's query, and what is wrong with it, as `checked` returns both.

    Examples
    --------
    >>> from susp_ss.explorer.state import from_query
    >>> state, errors = from_query("model=quarter&ks=20000&cs=fast")
    >>> state["vehicle"]["ks"], [error["parameter"] for error in errors]
    (20000.0, ['cs'])
    """
    said = dict(parse_qsl(text, keep_blank_values=True))
    model = said.pop("model", next(iter(given.models)))
    known = {row.name: row for row in given.tables.get(model, given.tables[next(iter(given.models))])}
    state: dict[str, Any] = {"model": model}
    unknown = [_error(name, f"no parameter of {model} named {briefly(name)}") for name in said if name not in known]
    for name, word in said.items():
        if name in known:
            _put(state, known[name], _read(known[name], word))
    right, errors = checked(state, given)
    return right, [*errors, *unknown]


def _leaves(state: Mapping[str, Any]) -> Iterator[tuple[str, str, Any]]:
    for table, part in state.items():
        if table == "model" or (table in OPTIONAL and part is None):
            continue
        if isinstance(part, Mapping):
            for key, value in part.items():
                yield table, str(key), value
        else:
            yield "", table, part


def _unseated(state: Mapping[str, Any], row: Number | Choice) -> str:
    """What is wrong with an output of a seat that is not there."""
    if not isinstance(row, Choice) or not row.seated:
        return ""
    own = _get(state, row)
    seated = [one for one in (own if row.several else [own]) if one in row.seated]
    return f"{row.name} {seated[0]} needs a seat, got none" if seated else ""


def _wrong(row: Number | Choice, value: Any) -> str:
    """What is wrong with a value, in one line; nothing if it is right."""
    if isinstance(row, Choice):
        some = value if row.several and isinstance(value, (list, tuple)) else [value]
        if all(isinstance(one, str) and one in row.options for one in some):
            return ""
        return (
            f"{row.name} must be {'some' if row.several else 'one'} of {', '.join(row.options)}, got {briefly(value)}"
        )
    if isinstance(value, (int, float)) and not isinstance(value, bool) and row.least <= value <= row.most:
        return ""
    need = f"a number from {row.least:g} to {row.most:g} {row.unit}".rstrip()
    return f"{row.name} must be {need}, got {briefly(value)}"


def _plain(row: Number | Choice, value: Any) -> Any:
    if isinstance(row, Number):
        return row.plain(value)
    return [value] if row.several and isinstance(value, str) else list(dict.fromkeys(value)) if row.several else value


def _read(row: Number | Choice, word: str) -> Any:
    if isinstance(row, Choice):
        return word.split(",") if row.several else word
    try:
        return float(word)
    except ValueError:
        return word


def _text(value: Any) -> str:
    return repr(value).removesuffix(".0") if isinstance(value, float) else value


def _put(state: dict[str, Any], row: Number | Choice, value: Any) -> None:
    if row.table:
        state.setdefault(row.table, {})[row.key] = value
    else:
        state[row.key] = value


def _get(state: Mapping[str, Any], row: Number | Choice) -> Any:
    part = state.get(row.table) if row.table else state
    return None if part is None else part.get(row.key)


def _name(table: str, key: str) -> str:
    return signal(table, key) if table in ("bump", *OPTIONAL, "carpet") else key


def _error(parameter: str, message: str) -> dict[str, str]:
    return {"parameter": parameter, "message": message}
