"""State spaces from files: matrices and names of signals, as JSON or as MATLAB writes them.

A file holds ``A``, ``B``, ``C``, ``inputs`` and ``outputs``; ``D`` where it is not zero, ``states`` where they have
names.
Where the wheels run is told by ``wheels``, ``wheelbase`` and ``track_width``, or by a vehicle that it is like::

    {"A": [[-2.0]], "B": [[1.0]], "C": [[1.0]], "inputs": ["dz_r"], "outputs": ["bacc"]}
"""

from __future__ import annotations

import json
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np

from ..quantities import briefly
from .contract import RoadVehicle
from .files import utf8_text
from .linear import LinearVehicle

MATRICES, NAMES, PLACES = ("A", "B", "C", "D"), ("inputs", "outputs", "states"), ("wheels", "wheelbase", "track_width")


def read_system(path: str | PathLike[str], like: RoadVehicle | None = None) -> LinearVehicle:
    """Read a state space as a linear vehicle.

    Parameters
    ----------
    path : path
        ``.mat`` of MATLAB 5 to 7 (not 7.3), with matrices, cell arrays of names, and a struct of ``wheels``; else JSON.
    like : vehicle, optional
        Whose wheels these are, where the file says nothing of wheels, wheelbase and track width; a system of a single
        wheel needs none.

    Returns
    -------
    LinearVehicle

    Raises
    ------
    OSError
        The file cannot be read.
    ValueError
        The file is of another kind, a key is unknown or missing, shapes do not fit, or the system is refused. Every
        message begins with the file's name.

    Examples
    --------
    >>> import pathlib, tempfile
    >>> from susp_ss.vehicles.system_files import read_system
    >>> path = pathlib.Path(tempfile.mkdtemp(), "lag.json")
    >>> _ = path.write_text('{"A": [[-2.0]], "B": [[1.0]], "C": [[1.0]], "inputs": ["dz_r"], "outputs": ["bacc"]}')
    >>> read_system(path)
    LinearVehicle(1 states, 1 outputs, wheels one)
    """
    path = Path(path)
    table = matlab_variables(path) if path.suffix.lower() == ".mat" else _json(path)
    try:
        return _vehicle(table, like)
    except (ValueError, TypeError) as error:
        raise ValueError(f"{path}: {error}") from error


def _vehicle(table: dict[str, Any], like: RoadVehicle | None) -> LinearVehicle:
    import control

    known = (*MATRICES, *NAMES, *PLACES)
    for key in table:
        if key not in known:
            raise ValueError(f"no key named {key!r}, available: {', '.join(known)}")
    for key in ("A", "B", "C", "inputs", "outputs"):
        if key not in table:
            raise ValueError(f"{key} is missing; a system has A, B, C, inputs and outputs")
    inputs, outputs = _names("inputs", table["inputs"]), _names("outputs", table["outputs"])
    n = int(np.sqrt(np.size(table["A"])))
    sizes = {"A": (n, n), "B": (n, len(inputs)), "C": (len(outputs), n), "D": (len(outputs), len(inputs))}
    matrices = {name: _matrix(name, table.get(name, np.zeros(shape)), shape) for name, shape in sizes.items()}
    states = _names("states", table["states"]) if "states" in table else [f"x[{i}]" for i in range(n)]
    if len(states) != n:
        raise ValueError(f"states must be {n} names, as A has {n} rows, got {len(states)}")
    system = control.ss(*matrices.values(), inputs=inputs, outputs=outputs, states=states)
    own = {name: table[name] for name in PLACES if name in table}
    if isinstance(own.get("wheelbase"), np.ndarray):
        own["wheelbase"] = own["wheelbase"].tolist()
    if "wheels" in own and isinstance(own["wheels"], dict):
        own["wheels"] = {name: tuple(np.ravel(place).tolist()) for name, place in own["wheels"].items()}
    alone = sum(name.startswith(("z_r", "dz_r")) for name in inputs) == 1 and len(getattr(like, "wheels", ())) > 1
    return LinearVehicle(system, **own) if own or alone else LinearVehicle(system, like=like)


def _names(key: str, value: Any) -> list[str]:
    names = [value] if isinstance(value, str) else list(np.ravel(value)) if isinstance(value, list | np.ndarray) else []
    if not names or not all(isinstance(name, str) for name in names):
        raise ValueError(f"{key} must be names, got {briefly(value)}")
    return [str(name) for name in names]


def _matrix(key: str, value: Any, shape: tuple[int, int]) -> np.ndarray:
    try:
        matrix = np.asarray(value, dtype=float)
    except (ValueError, TypeError):
        raise ValueError(f"{key} must be rows of numbers, got {briefly(value)}") from None
    # A matrix of one row or column may come as a row of numbers.
    if matrix.shape != shape and not (matrix.ndim < 2 and matrix.size == shape[0] * shape[1] and 1 in shape):
        raise ValueError(
            f"{key} must have shape {shape} (by the size of A and the names of inputs and outputs), got {matrix.shape}"
        )
    return matrix.reshape(shape)


def _json(path: Path) -> dict[str, Any]:
    text = utf8_text(path)
    try:
        table = json.loads(text)
    except (ValueError, RecursionError) as error:
        raise ValueError(f"{path}: not JSON: {error}") from None
    if not isinstance(table, dict):
        raise ValueError(f"{path}: must be an object with A, B, C, inputs and outputs, got {briefly(table)}")
    return table


def matlab_variables(path: Path) -> dict[str, Any]:
    """The variables of a MATLAB file: numbers and arrays, structs as dictionaries.

    Raises
    ------
    OSError
        The file cannot be read.
    ValueError
        It is none of MATLAB 5 to 7.
    """
    from scipy.io import loadmat

    try:
        table = loadmat(path, simplify_cells=True)
    except NotImplementedError:
        raise ValueError(f"{path}: MATLAB 7.3 holds HDF5; save it with the option -v7") from None
    except OSError:
        raise
    except Exception as error:  # whatever a damaged file makes the reader raise
        raise ValueError(f"{path}: no MATLAB file: {error}") from None
    return {name: value for name, value in table.items() if not name.startswith("__")}
