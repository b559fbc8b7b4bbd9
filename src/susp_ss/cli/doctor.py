"""``susp-ss doctor``: what is installed, what computes how, and what to do where something lacks."""

import importlib.util
import json
import os
import platform
import shutil
import sys
from pathlib import Path
from typing import Annotated, Any

import typer

from ..extras import EXTRAS, installation

BROWSERS = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable", "chrome", "msedge", "firefox")


def run(as_json: Annotated[bool, typer.Option("--json", help="Print JSON in place of lines.")] = False) -> None:
    """Say what is installed, what computes how, and what to do where something lacks.

    One line each: versions, the processor, its linear algebra and threads, the
    compiled code that is kept, a browser for reports, and the extras.
    """
    found = examination()
    if as_json:
        typer.echo(json.dumps(found, indent=2))
        return
    lines = _lines(found)
    width = max(len(subject) for subject, _ in lines)
    for subject, said in lines:
        typer.echo(f"{subject:{width}}  {said}")


def examination() -> dict[str, Any]:
    """Everything that the command says, as JSON knows it."""
    import numpy as np  # noqa: F401 - its BLAS is to be seen
    import scipy.linalg  # noqa: F401 - and scipy's
    from threadpoolctl import threadpool_info

    from ..presentation.versions import versions
    from ..responses.covariance.compiler import cache_folder

    cache = cache_folder().parent
    return {
        "python": sys.executable,
        "package": str(Path(__file__).parents[1]),
        "versions": versions(),
        "processor": {"name": _processor(), "cores": os.cpu_count()},
        "blas": [
            {"name": blas["internal_api"], "version": blas["version"], "threads": blas["num_threads"]}
            for blas in threadpool_info()
            if blas["user_api"] == "blas"
        ],
        "compiled": {
            "folder": str(cache),
            "bytes": sum(path.stat().st_size for path in cache.rglob("*") if path.is_file()),
        },
        "browser": next((path for path in map(shutil.which, BROWSERS) if path), None),
        "extras": {name: _extra(name) for name in EXTRAS},
    }


def _processor() -> str:
    """Model of the processor as the system names it."""
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    except OSError:
        lines = []
    named = [line.partition(":")[2].strip() for line in lines if line.startswith("model name")]
    return named[0] if named else platform.processor() or platform.machine()


def _extra(name: str) -> dict[str, Any]:
    modules, purpose = EXTRAS[name]
    missing = [module for module in modules if importlib.util.find_spec(module) is None]
    return {"for": purpose, "missing": missing, "install": installation(name) if missing else None}


def _lines(found: dict[str, Any]) -> list[tuple[str, str]]:
    """Subject and what is said of it."""
    others = ", ".join(f"{name} {version}" for name, version in found["versions"].items())
    cores, threads = found["processor"]["cores"], max((blas["threads"] for blas in found["blas"]), default=1)
    libraries = ", ".join(dict.fromkeys(f"{blas['name']} {blas['version']}" for blas in found["blas"])) or "not known"
    fewer = "; many small problems are faster with one: set OPENBLAS_NUM_THREADS=1" if threads > 1 else ""
    size = found["compiled"]["bytes"]
    kept = f"{size / 1e6:.1f} MB, which may be deleted" if size else "nothing yet"
    return [
        ("python", found["python"]),
        ("package", found["package"]),
        ("versions", others),
        ("processor", f"{found['processor']['name']}, {cores} core{'s' if cores != 1 else ''}"),
        ("blas", f"{libraries}, {threads} thread{'s' if threads != 1 else ''}{fewer}"),
        ("compiled", f"{found['compiled']['folder']}: {kept}"),
        ("browser", found["browser"] or f"none of {', '.join(BROWSERS)} found; install one to open report.html"),
        *((f"[{name}]", _said(extra)) for name, extra in found["extras"].items()),
    ]


def _said(extra: dict[str, Any]) -> str:
    if not extra["missing"]:
        return f"installed: {extra['for']}"
    return f"lacks {', '.join(extra['missing'])}, for {extra['for']}; run {extra['install']}"
