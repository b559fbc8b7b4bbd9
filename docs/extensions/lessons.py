"""Lessons lie beside the docs, where Jupyter opens them; the site shows them with the run that is committed."""

import shutil
from pathlib import Path
from typing import Any

ROOT = Path(__file__).parents[2]


def _fetch(app: Any, config: Any) -> None:
    for notebook in sorted((ROOT / "notebooks").glob("*.ipynb")):
        copy = Path(app.srcdir, "lessons", notebook.name)
        if not copy.exists() or copy.read_bytes() != notebook.read_bytes():
            shutil.copyfile(notebook, copy)


def setup(app: Any) -> dict[str, bool]:
    """Fetch them before pages are looked for."""
    app.connect("config-inited", _fetch)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
