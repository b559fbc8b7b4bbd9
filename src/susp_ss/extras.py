"""What only some users need is an extra of the package; where one is missed, one line says how to get it."""

from __future__ import annotations

import importlib.metadata
import json
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from urllib.parse import urlsplit
from urllib.request import url2pathname

EXTRAS = {
    "fast": (("numba",), "compiled code where designs are very many"),
    "pages": (("plotly", "jinja2"), "report.html of a study and of a fit"),
    "excel": (("openpyxl",), "runs in Excel files"),
    "explorer": (("dash", "orjson"), "susp-ss explore: the engine live in a browser"),
    "fmu": (("fmpy",), "runs of FMUs"),
    "netcdf": (("netCDF4",), "runs and profiles in NetCDF 4 files"),
    "parquet": (("pyarrow",), "runs in Parquet files"),
    "distributed": (("dask", "distributed", "zarr"), "susp-ss sweep: grids of any size, on any number of machines"),
    "roads": (("pyopencrg",), "road surfaces in OpenCRG files"),
    "s3": (("s3fs",), "sweeps into object stores, s3://bucket/out.zarr"),
}
"""Modules of each extra, and what it is for."""


@contextmanager
def needing(extra: str, who: str) -> Iterator[None]:
    """Import what an extra brings.

    Parameters
    ----------
    extra : str
        Name of the extra.
    who : str
        What needs it, as a sentence begins.

    Raises
    ------
    ModuleNotFoundError
        A module is not installed; the message is one line that says how to install the extra.

    Examples
    --------
    >>> from susp_ss.extras import needing
    >>> with needing("parquet", "A table"):
    ...     import pyarrow_of_another_planet
    Traceback (most recent call last):
    ModuleNotFoundError: A table needs pyarrow_of_another_planet, which is not installed; run ... -m pip install ...
    """
    try:
        yield
    except ModuleNotFoundError as error:
        library = str(error.name).partition(".")[0]
        need = f"{who} needs {library}, which is not installed; run {installation(extra)}"
        raise ModuleNotFoundError(need, name=library) from None


def installation(extra: str) -> str:
    """Return the command that adds an extra to this Python, whether the package came from an index or a checkout.

    Where pip installed the package from a place of its own, it has noted which (PEP 610); no index need know it.

    Examples
    --------
    >>> from susp_ss.extras import installation
    >>> installation("parquet").split()[1:4]
    ['-m', 'pip', 'install']
    """
    python = f'"{sys.executable}"' if " " in sys.executable else sys.executable
    return f"{python} -m pip install {_requirement(extra)}"


def _requirement(extra: str) -> str:
    """What pip is told; in double quotes, which every shell takes."""
    try:
        noted = importlib.metadata.distribution("susp_ss").read_text("direct_url.json")
    except importlib.metadata.PackageNotFoundError:
        noted = None
    origin = json.loads(noted) if noted else {}
    if origin.get("dir_info", {}).get("editable"):
        return f'-e "{url2pathname(urlsplit(origin["url"]).path)}[{extra}]"'
    if "vcs_info" in origin:
        source = origin["vcs_info"]
        return f'"susp_ss[{extra}] @ {source["vcs"]}+{origin["url"]}@{source["commit_id"]}"'
    return f'"susp_ss[{extra}] @ {origin["url"]}"' if origin else f'"susp_ss[{extra}]"'
