"""A folder of results: kept unless its owner says so, and never left half written."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Callable, Iterable
from os import PathLike
from pathlib import Path

from ..quantities import briefly


def write_results(
    folder: str | PathLike[str], write: Callable[[Path], None], names: Iterable[str], force: bool
) -> None:
    """Write the files of a folder together, or none of them.

    Parameters
    ----------
    folder : path
        Made if missing.
    write : callable
        Writes everything into an empty folder, which then takes the place of the results or joins other files.
    names : iterable of str
        Files by which earlier results are known. Those that are not written again go: beside new ones they would
        mislead.
    force : bool
        Replace earlier results.

    Raises
    ------
    TypeError
        ``folder`` is no path.
    FileExistsError
        The folder holds results and ``force`` is False.
    OSError
        The folder cannot be written.

    Examples
    --------
    >>> import pathlib, tempfile
    >>> from susp_ss.presentation.folder import write_results
    >>> folder = pathlib.Path(tempfile.mkdtemp(), "results")
    >>> write_results(folder, lambda empty: (empty / "a.txt").touch(), ("a.txt", "b.txt"), force=False)
    >>> [path.name for path in folder.iterdir()]
    ['a.txt']
    """
    if not isinstance(folder, (str, PathLike)):
        raise TypeError(f"folder must be a path, got {briefly(folder)}")
    target = Path(folder)
    if target.exists() and not target.is_dir():
        raise NotADirectoryError(f"cannot write results to {target}: it is a file, not a folder")
    held = [name for name in names if (target / name).exists()]
    if held and not force:
        raise FileExistsError(f"{target} holds results already, such as {held[0]}; pass force=True to replace them")
    try:
        home = target if target.is_dir() else target.parent
        home.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryDirectory(prefix=".susp_ss-", dir=home) as scratch:
            written = Path(scratch, "results")
            written.mkdir()
            write(written)
            if target.is_dir():
                _replace(written, target, held)
            else:
                written.rename(target)
    except OSError as error:
        raise type(error)(f"cannot write results to {target}: {error.strerror or error}") from error


def _replace(written: Path, target: Path, held: list[str]) -> None:
    new = [path.relative_to(written) for path in sorted(written.rglob("*")) if path.is_file()]
    for name in new:
        (target / name).parent.mkdir(exist_ok=True)
        os.replace(written / name, target / name)
    for name in set(map(Path, held)) - set(new):
        (target / name).unlink()
