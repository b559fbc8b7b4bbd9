"""Finished runs in a file, so that what broke off goes on where it was."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from ..fit.whole_file import write_whole
from ..quantities import briefly

Design = tuple[float, ...]


class Kept:
    """Finished runs by design, in a file if there is one.

    Parameters
    ----------
    path : Path or None
        JSON, made at the first run; None keeps them in memory alone.
    asked : dict of str to JSON
        Whatever the runs hang on but for their designs.

    Raises
    ------
    OSError
        The file cannot be read.
    ValueError
        It holds no runs, or runs of something else.
    """

    def __init__(self, path: Path | None, asked: dict[str, Any]):
        self.path, self.asked = path, asked
        self.runs: dict[Design, dict[str, float]] = {}
        if path is not None and not path.parent.is_dir():
            raise FileNotFoundError(f"{path}: there is no folder {path.parent}")
        if path is not None and path.exists():
            self.runs = self._read(path)

    def _read(self, path: Path) -> dict[Design, dict[str, float]]:
        try:
            held = json.loads(path.read_text(encoding="utf-8"))
            asked, runs = held["asked"], {tuple(map(float, x)): dict(y) for x, y in held["runs"]}
            outputs = all(set(run) == set(asked["outputs"]) for run in runs.values())
            numbers = all(isinstance(y, float) for run in runs.values() for y in run.values())
            sizes = all(len(x) == len(asked["inputs"]) for x in runs)
        except (ValueError, TypeError, KeyError, AttributeError, RecursionError):
            raise ValueError(f"{path}: holds no runs of an FMU; pass another file for them") from None
        if not (outputs and numbers and sizes):
            raise ValueError(f"{path}: holds no runs of an FMU; pass another file for them")
        for name, value in self.asked.items():
            if asked.get(name) != value:
                raise ValueError(
                    f"{path}: holds runs of another {name}, {briefly(asked.get(name))} in place of {briefly(value)}; "
                    "pass another file, or the same again"
                )
        return runs

    def add(self, design: Design, responses: dict[str, float]) -> None:
        """Keep a run: the file has it whole or not at all."""
        self.runs[design] = responses
        if self.path is not None:
            held = {"asked": self.asked, "runs": [[list(x), y] for x, y in self.runs.items()]}
            write_whole(self.path, json.dumps(held))
