"""The folder of ``--out``: kept unless forced, and never left with half of the results."""

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

from .refusals import Refusal


def check_folder(out: Path, files: Sequence[str], force: bool) -> None:
    """Refuse a folder that is none, or that holds results already, before any work is done.

    Raises
    ------
    Refusal
    """
    if out.exists() and not out.is_dir():
        raise Refusal(f"--out {out} is a file, not a folder")
    held = [name for name in files if (out / name).exists()]
    if held and not force:
        raise Refusal(f"--out {out} holds results already ({', '.join(held)}); pass --force to replace them")


def check_result(out: Path, kind: type, force: bool) -> None:
    """Refuse a folder of ``--out`` for a kind of result, such as `Fit`.

    Raises
    ------
    Refusal
    """
    from ..presentation.save import kind_of

    check_folder(out, kind_of(kind).files, force)


def write_together(out: Path, files: Mapping[str, Callable[[Path], object]]) -> None:
    """Write files of a folder, each by its own function, all or none.

    Raises
    ------
    OSError
        The folder cannot be written.
    """
    from ..presentation.folder import write_results

    def write_all(empty: Path) -> None:
        for name, write in files.items():
            write(empty / name)

    write_results(out, write_all, files, force=True)
