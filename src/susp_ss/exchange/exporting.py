"""A vehicle as a file that other programs run: an FMU with its C source, or the matrices for MATLAB."""

from __future__ import annotations

import hashlib
import platform
import re
import shutil
import subprocess
import tempfile
import uuid
import warnings
import zipfile
from importlib.resources import files
from io import BytesIO
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..fit.whole_file import write_whole
from ..vehicles.contract import RoadVehicle
from .description import description, nominal
from .realised import Realised, realised

KINDS = (".fmu", ".mat")

COMPILERS = ("cc", "gcc", "clang")

BINARIES = {
    ("Linux", "x86_64"): ("linux64", ".so"),
    ("Darwin", "x86_64"): ("darwin64", ".dylib"),
    ("Darwin", "arm64"): ("darwin64", ".dylib"),
    ("Windows", "AMD64"): ("win64", ".dll"),
}
"""Folder and suffix of a binary, by system and machine; FMI 2.0 names no others of 64 bits."""


def export(vehicle: RoadVehicle, path: str | PathLike[str], force: bool = False) -> Path:
    """Write a vehicle as an FMU, or its matrices as a MATLAB file.

    ``x' = A x + B u``, ``y = C x + D u``, with all outputs of the vehicle under their names, in SI units. The inputs
    ``u`` are the heights of the road under the wheels, ``z_r...`` in m; of a vehicle that passes the road's velocity
    straight on to an output (``ct > 0``, a rigid tyre), the rates of the heights, ``dz_r...`` in m/s. It starts at rest
    on the first heights. A `RideHandlingCar` moves at its own speed, and is steered and driven by further inputs.

    Parameters
    ----------
    vehicle : Vehicle or LinearVehicle
        One number for every parameter.
    path : path
        By its suffix:

        - ``.fmu``: FMI 2.0 for model exchange and co-simulation, self-contained: C source, and a binary for this
          system where a C compiler (cc, gcc or clang) is found. A step of co-simulation is exact, whatever its length,
          for inputs that are linear over it, as the master's input derivatives say, or held. Parameters are constants
          of the FMU: they are in its matrices.
        - ``.mat``: MATLAB 5 with A, B, C, D, names of signals and where the wheels run, for ``ss(A, B, C, D)``
          and for ``susp-ss metrics --system``.
    force : bool, optional
        Replace a file that is there.

    Returns
    -------
    Path
        Of the file.

    Raises
    ------
    OSError
        The file exists, or cannot be written.
    TypeError, ValueError
        No vehicle, several designs, another suffix, or signals whose names the format cannot hold.

    Warns
    -----
    UserWarning
        No compiler is found, or it fails: the FMU then holds source only.

    Examples
    --------
    >>> import pathlib, tempfile
    >>> import susp_ss as ss
    >>> folder = pathlib.Path(tempfile.mkdtemp())
    >>> ss.export(ss.QuarterCar(ks=20e3), folder / "car.mat").name
    'car.mat'
    """
    target = Path(path)
    suffix = target.suffix.lower()
    if suffix not in KINDS:
        raise ValueError(f"{target}: a vehicle is exported as {' or '.join(KINDS)}")
    if not target.parent.is_dir():
        raise FileNotFoundError(f"{target}: there is no folder {target.parent}")
    if target.exists() and not force:
        raise FileExistsError(f"{target} exists already; pass force=True to replace it")
    model = realised(vehicle)
    content = _fmu(model, type(vehicle).__name__, target) if suffix == ".fmu" else _matlab(model, vehicle)
    write_whole(target, content)
    return target


# FMU


def _fmu(model: Realised, name: str, target: Path) -> bytes:
    identifier = re.sub(r"\W", "_", target.stem, flags=re.ASCII)
    identifier = identifier if not identifier[:1].isdigit() else f"_{identifier}"
    # The same vehicle under the same name is the same FMU.
    unnamed = "".join(texts(model, name, identifier, "").values())
    guid = f"{{{uuid.UUID(hashlib.sha256(unnamed.encode()).hexdigest()[:32])}}}"
    contents: dict[str, str | bytes] = dict(texts(model, name, identifier, guid))
    contents |= _compiled(contents, identifier, target)
    archive = BytesIO()
    with zipfile.ZipFile(archive, "w", zipfile.ZIP_DEFLATED) as file:
        for path, content in contents.items():
            file.writestr(zipfile.ZipInfo(path), content, zipfile.ZIP_DEFLATED)
    return archive.getvalue()


def texts(model: Realised, name: str, identifier: str, guid: str) -> dict[str, str]:
    """What an FMU holds but its binary, by its places: the `description`, which says what is given, and the source."""
    from .. import __version__

    return {
        "modelDescription.xml": description(model, name, identifier, guid, f"susp_ss {__version__}"),
        "sources/fmi2.c": files(__package__).joinpath("fmi2.c").read_text(encoding="utf-8"),
        "sources/tables.h": _tables(model, identifier, guid),
    }


def _tables(model: Realised, identifier: str, guid: str) -> str:
    """The system as C."""
    sizes = {
        "STATES": len(model.states),
        "INPUTS": len(model.inputs),
        "OUTPUTS": len(model.outputs),
        "CONSTANTS": len(model.constants),
    }
    matrices = {
        "A[STATES][STATES]": model.A,
        "B[STATES][INPUTS]": model.B,
        "C[OUTPUTS][STATES]": model.C,
        "D[OUTPUTS][INPUTS]": model.D,
        "REST[STATES][INPUTS]": model.rest,
        "NOMINAL[STATES]": np.array([nominal(one.unit) for one in model.states]),
        # C knows no array of none.
        "PARAMETER[CONSTANTS + 1]": np.array([*(one.value for one in model.constants), 0.0]),
    }
    lines = [
        *(
            f"/* {kind}: {', '.join(one.name for one in signals)} */"
            for kind, signals in (("u", model.inputs), ("x", model.states), ("y", model.outputs))
        ),
        f"#define MODEL_IDENTIFIER {identifier}",
        f'#define GUID "{guid}"',
        f"enum {{ {', '.join(f'{name} = {size}' for name, size in sizes.items())} }};",
        *(f"static const double {name} = {_initialiser(matrix)};" for name, matrix in matrices.items()),
    ]
    return "\n".join(lines) + "\n"


def _initialiser(matrix: NDArray[np.float64]) -> str:
    if matrix.ndim == 2:
        return "{\n" + ",\n".join(f"    {_initialiser(row)}" for row in matrix) + "\n}"
    return "{" + ", ".join(repr(x) for x in matrix.tolist()) + "}"


def _compiled(contents: dict[str, Any], identifier: str, target: Path) -> dict[str, bytes]:
    """The binary for this system by its place in the FMU; nothing, and why, where there is none."""
    place = BINARIES.get((platform.system(), platform.machine()))
    compiler = next(filter(None, map(shutil.which, COMPILERS)), None)
    lacking = ""
    if place is None:
        lacking = f"FMI 2.0 has no binaries for {platform.system()} on {platform.machine()}"
    elif compiler is None:
        lacking = f"no C compiler ({', '.join(COMPILERS)}) is found"
    else:
        folder, suffix = place
        with tempfile.TemporaryDirectory() as work:
            for name in ("fmi2.c", "tables.h"):
                Path(work, name).write_text(contents[f"sources/{name}"], encoding="utf-8")
            library = Path(work, identifier + suffix)
            options = ["-O2", "-shared", "-fPIC", "-DFMI2_OVERRIDE_FUNCTION_PREFIX", "fmi2.c", "-o", library.name]
            done = subprocess.run([compiler, *options], cwd=work, capture_output=True, text=True, check=False)
            if done.returncode == 0:
                return {f"binaries/{folder}/{library.name}": library.read_bytes()}
        lacking = f"{compiler} failed: {' '.join(done.stderr.split())[:200]}"
    warnings.warn(f"{target.name} holds C source only, no binary, as {lacking}; see sources/fmi2.c", stacklevel=4)
    return {}


# MATLAB


def _matlab(model: Realised, vehicle: RoadVehicle) -> bytes:
    from scipy.io import savemat

    table: dict[str, Any] = {name: getattr(model, name) for name in "ABCD"}
    for kind in ("inputs", "outputs", "states"):
        table[kind] = np.array([one.name for one in getattr(model, kind)], dtype=object)
    # A vehicle of one wheel has no name for it, and needs none.
    if "" not in vehicle.wheels:
        for wheel in vehicle.wheels:
            if not re.fullmatch("[A-Za-z][A-Za-z0-9_]*", wheel):
                raise ValueError(f"wheels: MATLAB needs a letter, then letters, digits and _, got {wheel!r}")
        table["wheels"] = {name: np.array(place, dtype=float) for name, place in vehicle.wheels.items()}
    behind = [float(distance) for distance in vehicle.axles[1:]]
    table |= {"wheelbase": np.array(behind) if behind else 0.0, "track_width": float(vehicle.track_width)}
    content = BytesIO()
    savemat(content, table, long_field_names=True)
    return content.getvalue()
