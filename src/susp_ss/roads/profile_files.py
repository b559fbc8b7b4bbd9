"""Measured profiles from files: text as programs write it, NetCDF, and surfaces in OpenCRG.

Whatever makes a profile doubtful is refused by its place: a gap, a distance that does not rise, heights of no road.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from os import PathLike
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from ..extras import needing
from ..netcdf import read_netcdf
from ..quantities import Quantity, briefly, positive, units_of
from ..units import SPELT, factor_of, plain_unit, split_heading
from ..written import SEPARATORS, Sign, checked_sign, decimal_sign, like_number, numbers, text_table, unreadable
from .profiles import SIDES, TRACK_WIDTH, profile_of
from .road import CLASSES, REFERENCE_WAVENUMBER

Array = NDArray[np.float64]

LENGTH = Quantity("x", "m", "length")

WORDS = {
    "left": {"left", "l", "lwp", "lelev"},
    "right": {"right", "r", "rwp", "relev"},
    "x": {"x", "distance", "dist", "station", "chainage", "position"},
    "track": {"z", "elevation", "height", "profile", "track"},
}
"""What a column is, by a word of its heading; the first that fits."""

# Lines of titles that may stand above a header.
TITLES = 20

# Cells of a column in which its decimal sign must show.
SHOWN = 200

# A stretch between two points is a gap from so many times the usual on, and from so many metres on, unless it is level.
GAP, LEAST_GAP = 20.0, 1.0

# Increments of height are taken over this distance, in m, to judge how rough a road they would make; a road may be so
# many times rougher than the geometric mean of the roughest class.
INCREMENT, ROUGHEST = 0.5, 4.0 * CLASSES["H"]


class Columns(NamedTuple):
    """Columns of a file in m by what they are: their headings, values, and the number of each row."""

    word: str
    rows: Sequence[int]
    headings: dict[str, str]
    values: dict[str, Array]
    noted: tuple[str, ...] = ()

    def place(self, name: str, at: Any) -> str:
        """Where a value stands in the file."""
        return f"{self.word} {self.rows[int(at)]}, column {self.headings[name]!r}"


def read_profile(
    path: str | PathLike[str],
    *,
    columns: Mapping[str, str] | None = None,
    units: Mapping[str, str] | None = None,
    decimal: str | None = None,
    track_width: float = TRACK_WIDTH,
) -> xr.Dataset:
    """Read a measured road profile.

    Parameters
    ----------
    path : path
        Text (``.csv``, ``.txt``, ``.tsv``, ``.dat``), NetCDF (``.nc``) or OpenCRG (``.crg``, extra ``roads``). In text
        and NetCDF the columns are told by their names: ``x``, ``distance``, ``station`` or ``chainage``; whatever has
        the word ``left`` or ``right``; ``elevation``, ``height`` or ``z`` of one track, which both sides get. Columns
        of numbers without names are the distance and one or two tracks, left and right. A unit may follow the name,
        ``left [mm]``, or stand in the line below.
    columns : mapping of str to str, optional
        Names in the file of ``x``, ``left`` and ``right``, of which one may be missing.
    units : mapping of str to str, optional
        Units of ``x``, ``left`` and ``right``, in place of the file's; without any they are in m.
    decimal : {".", ","}, optional
        The decimal sign of text, where no cell tells.
    track_width : float
        Distance in m of the two tracks that are taken from an OpenCRG surface, beside the middle of its reference line.

    Returns
    -------
    xarray.Dataset
        ``left`` and ``right`` in m on ``x`` in m, rising, as unevenly spaced as in the file.

    Raises
    ------
    OSError
        The file cannot be read.
    TypeError
        ``path`` is no path, ``columns`` or ``units`` no mapping of text.
    ModuleNotFoundError
        An extra is missing; the message says how to install it.
    ValueError
        Another kind of file, columns that cannot be told, no numbers, a missing height, a distance that does not rise,
        a gap, fewer than two points, or heights that make the road rougher by far than any is, as those in mm do that
        are taken for m. The message names the file and the line.

    Examples
    --------
    >>> import pathlib, tempfile
    >>> import susp_ss as ss
    >>> path = pathlib.Path(tempfile.mkdtemp(), "road.csv")
    >>> path.write_text("Station [m];Left [mm];Right [mm]\\n0,00;1,5;-0,2\\n0,25;2,0;0,1\\n0,40;1,0;0,3\\n")
    73
    >>> profile = ss.read_profile(path)
    >>> profile.x.values.tolist(), profile.left.values.round(6).tolist()
    ([0.0, 0.25, 0.4], [0.0015, 0.002, 0.001])
    """
    if not isinstance(path, (str, PathLike)):
        raise TypeError(f"path must be the path of a profile, got {briefly(path)}")
    file, sign = Path(path), checked_sign(decimal)
    reader = READERS.get(file.suffix.lower())
    if reader is None:
        raise ValueError(f"{file}: profiles are read from {', '.join(READERS)} files, got {file.suffix or 'no suffix'}")
    asked, stated = _names("columns", columns), _names("units", units)
    if asked and ("x" not in asked or len(asked) == 1):
        raise ValueError(f"columns must name x and left or right or both, got {', '.join(asked)}")
    if reader is _read_crg:
        found = _read_crg(file, positive("track_width", track_width, "m"))
    else:
        found = reader(file, asked, stated, sign)
    check(file, found)
    left, right = (found.values[name if name in found.values else other] for name, other in (SIDES, SIDES[::-1]))
    made: dict[str, Any] = {"file": str(file)} | ({"read": ", ".join(found.noted)} if found.noted else {})
    made |= {"track_width": track_width} if reader is _read_crg else {}
    return profile_of(found.values["x"], left, right, made)


def check(path: Path, found: Columns) -> None:
    """Refuse what is no profile of a road, by its place.

    Raises
    ------
    ValueError
        See `read_profile`.
    """
    for name, column in found.values.items():
        missing = ~np.isfinite(column)
        if missing.any():
            at = int(np.argmax(missing))
            raise ValueError(f"{path}, {found.place(name, at)}: needs a number, got {column[at]:g}")
    x, heights = found.values["x"], [column for name, column in found.values.items() if name != "x"]
    if len(x) < 2:
        raise ValueError(f"{path}: needs two points or more, got {len(x)}")
    steps = np.diff(x)
    if (steps <= 0.0).any():
        at = int(np.argmax(steps <= 0.0)) + 1
        got = f"{x[at]:g} m twice" if x[at] == x[at - 1] else f"{x[at]:g} m after {x[at - 1]:g} m"
        raise ValueError(f"{path}, {found.place('x', at)}: the distance must rise from point to point, got {got}")
    usual = float(np.median(steps))
    uneven = np.any([np.diff(z) != 0.0 for z in heights], axis=0)
    gap = (steps > max(GAP * usual, LEAST_GAP)) & uneven
    if gap.any():
        at = int(np.argmax(gap)) + 1
        raise ValueError(
            f"{path}, {found.place('x', at)}: a gap of {steps[at - 1]:g} m, where points are {usual:g} m apart; "
            "cut the file there"
        )
    for name in found.values.keys() - {"x"}:
        rough = roughness(x, found.values[name])
        if rough > ROUGHEST:
            raise ValueError(
                f"{path}, column {found.headings[name]!r}: heights in m that make G_d(0.1 cycle/m) about {rough:.2g} "
                f"m^3, where the roughest class, H, has {CLASSES['H']:.2g}; if they are in mm, state it: the heading "
                f'{name} [mm], or units={{"{name}": "mm"}}'
            )


def roughness(x: Array, heights: Array) -> float:
    """About ``G_d(n0)`` in m^3, by the mean square of increments: ``2 pi^2 n0^2 G_d dx`` at waviness 2."""
    level = heights - np.polynomial.Polynomial.fit(x, heights, 1)(x)
    step = max(INCREMENT, float(np.median(np.diff(x))))
    at = np.linspace(x[0], x[-1], max(2, int((x[-1] - x[0]) / step)))
    increments = np.diff(np.interp(at, x, level))
    return float(np.mean(increments**2) / (at[1] - at[0]) / (2.0 * np.pi**2 * REFERENCE_WAVENUMBER**2))


def _names(argument: str, given: Any) -> dict[str, str]:
    if given is None:
        return {}
    if not isinstance(given, Mapping) or not all(isinstance(value, str) for value in given.values()):
        such = '{"x": "Station", "left": "LWP"}' if argument == "columns" else '{"left": "mm"}'
        raise TypeError(f"{argument} must be a mapping such as {such}, got {briefly(given)}")
    for name in given:
        if name not in ("x", "left", "right"):
            raise ValueError(f"{argument}: there is no {briefly(name)}, available: x, left, right")
    return dict(given)


# Columns by their headings


def _told(where: str, headings: Sequence[str], asked: Mapping[str, str]) -> dict[str, int]:
    """Position of x, left and right among headings; of one track as left."""
    bare = [split_heading(heading)[0] for heading in headings]
    if asked:
        at = {name: [i for i, one in enumerate(headings) if column in (one, bare[i])] for name, column in asked.items()}
    else:
        words = [set(re.split(r"[^a-z0-9]+", heading.casefold())) for heading in bare]
        kinds = [next((kind for kind, of in WORDS.items() if of & word), "") for word in words]
        at = {kind: [i for i, own in enumerate(kinds) if own == kind] for kind in WORDS}
        sides = [side for side in ("left", "right") if at[side]]
        at = {"x": at["x"], **({side: at[side] for side in sides} if sides else {"left": at["track"]})}
    available = ", ".join(map(repr, headings)) or "none"
    for name, positions in at.items():
        if len(positions) != 1:
            meant = f"named {asked[name]!r}" if asked else "of distance" if name == "x" else "of heights"
            got = "none" if not positions else f"{len(positions)}: {', '.join(repr(headings[i]) for i in positions)}"
            hint = "" if asked else '; say which by columns={"x": ..., "left": ..., "right": ...}'
            raise ValueError(f"{where}: needs one column {meant}, got {got}; available: {available}{hint}")
    return {name: positions[0] for name, positions in at.items()}


def _bracketed(heading: str) -> str:
    """What stands in brackets behind a heading, which is a unit unless another is stated."""
    found = re.search(r"[\[(]([^\])]+)[\])]\s*$", heading)
    return found[1] if found else ""


def _factor(where: str, name: str, unit: str) -> float:
    factor = factor_of(unit, LENGTH)
    if factor is None:
        raise ValueError(
            f"{where}: {name} is in one of {', '.join(units_of(LENGTH.unit))}, got {unit!r}; to say which, "
            f'units={{"{name}": "m"}}'
        )
    return factor


# Readers


def _read_text(path: Path, asked: Mapping[str, str], stated: Mapping[str, str], decimal: Sign | None) -> Columns:
    records, separator, encoding = text_table(path)
    noted = [] if encoding == "UTF-8" else [f"read as {encoding}"]
    if records and all(len(cells) == 1 for _, cells in records):
        records, separator = [(line, cells[0].split()) for line, cells in records], " "
    noted += [] if separator == "," else [f"cells between {SEPARATORS.get(separator, 'blanks')}"]
    if not records:
        raise ValueError(f"{path}: needs a distance and heights, the file has no text")
    above, headings, at = _header(path, records, asked)
    below = records[above:]
    units = {name: split_heading(headings[i])[1] if headings else "" for name, i in at.items()}
    if headings and below and all(plain_unit(cell) in SPELT for cell in below[0][1] if cell):
        line, cells = below.pop(0)
        units |= {name: cells[i] for name, i in at.items() if i < len(cells) and cells[i]}
    units |= {name: unit for name, unit in stated.items() if name in at}
    width = len(headings) or len(records[above][1])
    for line, cells in below:
        if len(cells) != width:
            raise ValueError(f"{path}, line {line}: needs {width} cells as the others have, got {len(cells)}")
    rows = [line for line, _ in below]
    named = {name: headings[i] if headings else f"{i + 1}" for name, i in at.items()}
    columns = {name: [cells[i] for _, cells in below] for name, i in at.items()}
    places = (
        (f"{path}, line {line}, column {named[name]!r}", cell)
        for name, texts in columns.items()
        for line, cell in zip(rows[:SHOWN], texts, strict=False)
    )
    sign = decimal or decimal_sign(places, separator)
    found = Columns("line", rows, named, {}, tuple(noted))
    for name, cells in columns.items():
        unit = units[name] or _bracketed(named[name]) or LENGTH.unit
        factor = _factor(f"{path}, column {named[name]!r}", name, unit)
        found.values[name] = factor * numbers(cells, sign)
        missing = np.flatnonzero(~np.isfinite(found.values[name]))
        if missing.size:
            got = repr(cells[missing[0]]) if cells[missing[0]] else "an empty cell"
            raise ValueError(f"{path}, {found.place(name, missing[0])}: needs a number, got {got}")
    return found


def _header(
    path: Path, records: Sequence[tuple[int, Sequence[str]]], asked: Mapping[str, str]
) -> tuple[int, Sequence[str], dict[str, int]]:
    """How many records stand above the first point, the headings among them, and the positions of x, left and right."""
    for above, (line, cells) in enumerate(records[:TITLES]):
        if all(map(like_number, cells)):
            named = next((record for record in records[:above] if len(record[1]) == len(cells)), None)
            if named:
                _told(f"{path}, line {named[0]}", named[1], asked)
            if asked or len(cells) not in (2, 3):
                raise ValueError(
                    f"{path}, line {line}: without names above, numbers are a distance and one or two heights, got "
                    f"{len(cells)} columns"
                )
            return above, [], dict(zip(("x", "left", "right"), range(len(cells)), strict=False))
        try:
            return above + 1, cells, _told(f"{path}, line {line}", cells, asked)
        except ValueError:
            continue
    line, cells = records[0]
    return 1, cells, _told(f"{path}, line {line}", cells, asked)


def _read_netcdf(path: Path, asked: Mapping[str, str], stated: Mapping[str, str], _: Sign | None) -> Columns:
    dataset = read_netcdf(path)[1]
    names = [str(name) for name, variable in dataset.variables.items() if variable.ndim == 1]
    at = _told(str(path), names, asked)
    headings = {name: names[i] for name, i in at.items()}
    arrays = {name: dataset[heading] for name, heading in headings.items()}
    values = {}
    for name, array in arrays.items():
        where = f"{path}, column {headings[name]!r}"
        if array.dims != arrays["x"].dims or array.dtype.kind not in "iuf":
            raise ValueError(f"{where}: needs numbers along {headings['x']!r}, got {array.dtype} on {array.dims}")
        unit = stated.get(name) or split_heading(headings[name])[1] or str(array.attrs.get("units", "")) or LENGTH.unit
        values[name] = _factor(where, name, unit) * array.values.astype(float)
    return Columns("row", range(1, len(values["x"]) + 1), headings, values)


def _read_crg(path: Path, track_width: float) -> Columns:
    with path.open("rb"):
        pass
    with needing("roads", f"{path}: an OpenCRG file"):
        import pyopencrg
    try:
        surface = pyopencrg.read(path, apply_mods=True)
    except Exception as error:  # whatever a damaged file makes the reader raise
        raise unreadable(path, "OpenCRG", error) from error
    half = 0.5 * track_width
    if surface.nv > 1 and not surface.v_min <= -half <= half <= surface.v_max:
        raise ValueError(
            f"{path}: tracks {track_width:g} m apart lie at v = -{half:g} and {half:g} m, but the surface reaches from "
            f"{surface.v_min:g} to {surface.v_max:g} m; pass another track_width"
        )
    u = np.asarray(surface.u, dtype=float)
    values = {"x": u, **{name: surface.uv_to_z(u, side) for name, side in (("left", half), ("right", -half))}}
    headings = {"x": "u", "left": f"v = {half:g}", "right": f"v = -{half:g}"}
    return Columns("row", range(1, len(u) + 1), headings, values, (f"tracks {track_width:g} m apart",))


READERS: dict[str, Callable[..., Columns]] = {
    **dict.fromkeys((".csv", ".txt", ".tsv", ".dat"), _read_text),
    ".nc": _read_netcdf,
    ".crg": _read_crg,
}
