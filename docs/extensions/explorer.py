"""The explorer without a server lies beside the pages, in ``explorer/``."""

from pathlib import Path
from typing import Any

from susp_ss.explorer.freeze import freeze


def _freeze(app: Any, exception: Exception | None) -> None:
    if exception is None and app.builder.name == "html":
        freeze(Path(app.outdir, "explorer"))


def setup(app: Any) -> dict[str, bool]:
    """Write it once the pages are there."""
    app.connect("build-finished", _freeze)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
