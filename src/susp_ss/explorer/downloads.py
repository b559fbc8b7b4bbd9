"""Files of a state: its metrics, its vehicle for ``--vehicle`` and for other programs, Python that makes it again."""

from __future__ import annotations

import csv
import io
import tempfile
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, NamedTuple

from ..exchange import export
from ..vehicles.files import in_file, vehicle_text
from ..vehicles.vehicle import Vehicle
from .compute import compute
from .design import vehicle_of
from .lines import lines
from .scene import Scene
from .state import NOTHING, Given, from_query


class File(NamedTuple):
    """A file to take away: its name, its type, and what makes its content of a checked state."""

    name: str
    type: str
    content: Callable[[Mapping[str, Any], Given], bytes]


def _table(state: Mapping[str, Any], given: Given) -> bytes:
    found = compute(state, given)
    if "metrics" not in found:
        raise ValueError(found["errors"][-1]["message"])
    text = io.StringIO()
    rows = csv.writer(text, lineterminator="\n")
    rows.writerow(["name", "label", "unit", "value"])
    for row in found["metrics"]:
        rows.writerow([row["name"], row["label"], row["unit"], "inf" if row["value"] is None else repr(row["value"])])
    for row in found["comfort"]:
        rows.writerow([f"total@{row['point']}", f"vibration total value, {row['label']}", "m/s^2", repr(row["total"])])
    return text.getvalue().encode()


def _vehicle(state: Mapping[str, Any], given: Given) -> bytes:
    vehicle = vehicle_of(state, given)
    if not isinstance(vehicle, Vehicle) or not in_file(vehicle):
        raise ValueError("the system of a file has no parameters for a vehicle file")
    return f"{vehicle_text(vehicle)}\n".encode()


def _fmu(state: Mapping[str, Any], given: Given) -> bytes:
    straight = Scene(state, given).straight
    with tempfile.TemporaryDirectory() as folder:
        return export(straight, Path(folder, FILES["fmu"].name)).read_bytes()


FILES = {
    "csv": File("metrics.csv", "text/csv; charset=utf-8", _table),
    "toml": File("vehicle.toml", "application/toml", _vehicle),
    "fmu": File("vehicle.fmu", "application/zip", _fmu),
    "py": File("explored.py", "text/x-python; charset=utf-8", lambda state, given: lines(state, given).encode()),
}
"""What there is at ``/download/<kind>?<query of the state>``; an FMU has what stands for curves on the road."""


def offer(server: Any, given: Given = NOTHING) -> None:
    """Let a Flask application hand out the files of the state in a URL's query."""
    from flask import Response, request

    @server.get("/download/<kind>")
    def download(kind: str) -> Any:
        if kind not in FILES:
            return Response(f"no file of kind {kind}, available: {', '.join(FILES)}", 404, mimetype="text/plain")
        state, errors = from_query(request.query_string.decode("latin-1"), given)
        file = FILES[kind]
        try:
            if errors:
                raise ValueError("; ".join(error["message"] for error in errors))
            content = file.content(state, given)
        except (ValueError, TypeError) as error:
            return Response(str(error), 400, mimetype="text/plain")
        named = {"Content-Disposition": f'attachment; filename="{file.name}"'}
        return Response(content, headers=named, content_type=file.type)
