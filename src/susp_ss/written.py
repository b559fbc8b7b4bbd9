"""Text and numbers as the programs of several countries write them: encodings, separators, decimal signs.

Nothing is guessed that can be read two ways: ``1.234`` may be one and a quarter or a thousand and more, and which it is
another cell must tell, or the caller.
"""

from __future__ import annotations

import codecs
import csv
import io
import re
from collections.abc import Iterable, Sequence
from decimal import Decimal
from pathlib import Path
from typing import Any, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from .quantities import briefly

Sign = Literal[".", ","]

SEPARATORS = {"\t": "tabs", ";": "semicolons", ",": "commas"}

# Digits in groups of three: by the other sign, an apostrophe, or a space that breaks no line or any.
_GROUPED = r"[1-9][0-9]{{0,2}}(?:(?P<by>[{other}'\u2019\u00a0\u202f\u2009 ])[0-9]{{3}}(?:(?P=by)[0-9]{{3}})*)"
_WRITTEN = r"[+-]?(?:(?:{grouped})(?:{sign}[0-9]*)?|(?:[0-9]+(?:{sign}[0-9]*)?|{sign}[0-9]+)(?:e[+-]?[0-9]+)?)"
WRITTEN = {
    sign: re.compile(_WRITTEN.format(grouped=_GROUPED.format(other=other), sign=re.escape(sign)), re.IGNORECASE)
    for sign, other in ((".", ","), (",", "."))
}
# What a plain decimal number is made of.
PLAIN = frozenset("0123456789.eE+-")
NO_NUMBER = re.compile(r"[+-]?(?:nan|inf|infinity)", re.IGNORECASE)


class Text(NamedTuple):
    """A table of text: lines that hold something, each with its number and cells, and how it was read."""

    records: list[tuple[int, list[str]]]
    separator: str
    encoding: str


def decoded(path: Path) -> tuple[str, str]:
    """The text of a file and its encoding: UTF-8, UTF-16 by its mark or its zeros, else Latin-1 as Windows has it."""
    raw = path.read_bytes()
    for mark, encoding in (
        (codecs.BOM_UTF8, "UTF-8"),
        (codecs.BOM_UTF16_LE, "UTF-16"),
        (codecs.BOM_UTF16_BE, "UTF-16"),
    ):
        if raw.startswith(mark):
            codec = "utf-8-sig" if encoding == "UTF-8" else "utf-16"
            try:
                return raw.decode(codec), encoding
            except UnicodeDecodeError as error:
                raise ValueError(
                    f"{path}: not {encoding} text, as its first bytes say (at byte {error.start})"
                ) from None
    for first, codec in ((1, "utf-16-le"), (0, "utf-16-be")):
        if len(raw) > 1 and len(raw) % 2 == 0 and not any(raw[first:200:2]):
            try:
                return raw.decode(codec), "UTF-16"
            except UnicodeDecodeError:
                break
    for codec, name in (("utf-8", "UTF-8"), ("cp1252", "Latin-1 (Windows-1252)")):
        try:
            return raw.decode(codec), name
        except UnicodeDecodeError:
            continue
    return raw.decode("latin-1"), "Latin-1"


def text_table(path: Path) -> Text:
    """The cells of a text file, by tabs, semicolons or commas: whichever comes first in this list and in the header.

    Blank lines and lines that begin with # are skipped, and so is the line ``sep=;`` by which a spreadsheet tells.

    Raises
    ------
    OSError
        The file cannot be read.
    ValueError
        A quote that does not end, or text behind one; the message names the line.
    """
    text, encoding = decoded(path)
    lines = ["\n" if line.startswith("#") else line for line in io.StringIO(text, newline=None)]
    told = re.fullmatch(r"sep=([\t;,])\s*", lines[0]) if lines else None
    if told:
        lines[0] = "\n"
    header = next((line.strip() for line in lines if line.strip()), "")
    found = next((mark for mark in SEPARATORS if mark in re.sub('"[^"]*"', "", header)), ",")
    separator = told[1] if told else found
    reader = csv.reader(lines, delimiter=separator, skipinitialspace=True, strict=True)
    records, line = [], 1
    try:
        for cells in reader:
            stripped = [cell.strip() for cell in cells]
            if any(stripped):
                records.append((line, stripped))
            # A cell in quotes may hold line breaks; a record's line is its first.
            line = reader.line_num + 1
    except csv.Error as error:
        raise ValueError(f"{path}, line {line}: not a line of cells: {error}") from None
    return Text(records, separator, encoding)


def like_number(text: str) -> bool:
    """Whether a cell is meant as a number, whatever its decimal sign."""
    return bool(readings(text))


def number(text: str, decimal: Sign = ".") -> float | None:
    """The number that a cell holds, digits grouped or not; None if it holds none.

    Examples
    --------
    >>> from susp_ss.written import number
    >>> number("18.553,5", ","), number("18 553.5"), number("1.234"), number("1.234", ",")
    (18553.5, 18553.5, 1.234, 1234.0)
    >>> number("1.23.4") is None
    True
    """
    if NO_NUMBER.fullmatch(text):
        return float(text)
    found = WRITTEN[decimal].fullmatch(text)
    if not found:
        return None
    plain = text.replace(found["by"], "") if found["by"] else text
    return float(plain.replace(decimal, "."))


def cell_number(cell: Any, decimal: Sign) -> float | None:
    """The number of a cell, be it text or not; None if it holds none."""
    if isinstance(cell, str):
        return number(cell, decimal)
    plain = isinstance(cell, (int, float, Decimal)) and not isinstance(cell, bool)
    return float(cell) if plain else None


def numbers(cells: Sequence[Any], sign: Sign) -> NDArray[np.float64]:
    """Cells of a column as numbers, NaN where there is none."""
    # Plain numbers are read all at once, ten times as fast.
    if sign == "." and all(isinstance(cell, str) and cell for cell in cells) and PLAIN.issuperset("".join(cells)):
        try:
            return np.array(cells).astype(float)
        except ValueError:
            pass  # A cell such as 1-2, which the caller names.
    values = (cell_number(cell, sign) for cell in cells)
    return np.array([np.nan if value is None else value for value in values])


def readings(text: str) -> dict[Sign, float]:
    """What a cell says with each decimal sign with which it is a number."""
    signs: tuple[Sign, Sign] = (".", ",")
    read = {sign: number(text, sign) for sign in signs}
    return {sign: value for sign, value in read.items() if value is not None}


def decimal_sign(cells: Iterable[tuple[str, str]], separator: str = "") -> Sign:
    """The decimal sign of cells, each with its place: what all can be read with.

    Between commas as separators a point is a decimal point: programs that write a decimal comma do not separate by it.

    Raises
    ------
    ValueError
        One cell has a decimal point and another a decimal comma, or every cell could have either and would be another
        number; the message names the place.

    Examples
    --------
    >>> from susp_ss.written import decimal_sign
    >>> decimal_sign([("line 2", "1.234"), ("line 3", "0,5")])
    ','
    >>> decimal_sign([("line 2", "1.234"), ("line 3", "18")])
    Traceback (most recent call last):
    ValueError: line 2: 1.234 may be 1.234 or 1234, and no other cell tells; say decimal="." or ","
    """
    certain: dict[Sign, tuple[str, str]] = {}
    unsure: tuple[str, str] | None = None
    for place, text in cells:
        read = readings(text)
        if len(read) == 1:
            certain.setdefault(next(iter(read)), (place, text))
        elif len(set(map(repr, read.values()))) > 1 and unsure is None and not (separator == "," and "," not in text):
            unsure = place, text
    if len(certain) == 2:
        (first, with_point), (second, with_comma) = certain["."], certain[","]
        raise ValueError(
            f"{second}: {with_comma} is written with a decimal comma, but {first} has a decimal point: {with_point}"
        )
    if certain:
        return "," if "," in certain else "."
    if unsure:
        place, text = unsure
        values = " or ".join(f"{value:.15g}" for value in readings(text).values())
        raise ValueError(f'{place}: {text} may be {values}, and no other cell tells; say decimal="." or ","')
    return "."


def checked_sign(decimal: Any) -> Sign | None:
    """Return a decimal sign or None, or refuse what is neither.

    Raises
    ------
    ValueError
        Neither None nor one of the two signs.
    """
    if decimal is None or decimal in (".", ","):
        return decimal
    raise ValueError(f'decimal must be "." or ",", got {briefly(decimal)}')


def unreadable(path: Path, kind: str, error: Exception) -> ValueError:
    """What to say of a file that another library cannot read."""
    return ValueError(f"{path}: not a readable {kind} file: {' '.join(str(error).split()) or type(error).__name__}")
