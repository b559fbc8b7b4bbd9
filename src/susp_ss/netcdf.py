"""NetCDF files, classic and 4, as Datasets in memory."""

from __future__ import annotations

import io
from collections.abc import Callable
from pathlib import Path

import xarray as xr

from .extras import needing
from .written import unreadable

# How a NetCDF file begins that is no HDF5 file; scipy reads it.
CLASSIC = (b"CDF\x01", b"CDF\x02")


def read_netcdf(path: Path, wanted: Callable[[str], bool] = lambda name: True) -> tuple[list[str], xr.Dataset]:
    """Names of all variables of a file, and those wanted, loaded.

    Raises
    ------
    OSError
        The file cannot be read.
    ModuleNotFoundError
        It is a NetCDF 4 file, and the extra is not installed.
    ValueError
        It is no NetCDF file.
    """
    # netCDF4 reports a missing file and a broken one alike, and scipy takes bytes.
    raw = path.read_bytes()
    classic = raw.startswith(CLASSIC)
    if not classic:
        with needing("netcdf", f"{path}: a NetCDF 4 file"):
            import netCDF4  # noqa: F401
    source, engine = (io.BytesIO(raw), "scipy") if classic else (path, "netcdf4")
    try:
        with xr.open_dataset(source, engine=engine, decode_times=False) as dataset:
            names = [str(name) for name in dataset.variables]
            return names, dataset[[name for name in names if wanted(name)]].load()
    except (OSError, RuntimeError, ValueError, TypeError, LookupError) as error:
        raise unreadable(path, "NetCDF", error) from error
