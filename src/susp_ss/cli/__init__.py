"""The command line: ``susp-ss study | metrics | comfort | events | bode | psd | road | sweep | fit | ...``.

Bad input ends with exit code 2 and one line on stderr; whatever else goes wrong is a bug and keeps its traceback.
Numerical libraries are imported inside the commands, so that ``--help`` answers at once.
"""

import codecs
import io
import sys
import warnings
from collections.abc import Sequence
from typing import Annotated

import typer

from . import (
    bode,
    bound,
    comfort,
    doctor,
    events,
    explore,
    export,
    fit,
    handling,
    metrics,
    optimise,
    predict,
    psd,
    road,
    study,
    sweep,
)
from .commands import Command, Commands
from .refusals import Refusal

app = typer.Typer(cls=Commands, no_args_is_help=False, pretty_exceptions_enable=False)
for _module in (
    study,
    metrics,
    comfort,
    events,
    bode,
    psd,
    handling,
    sweep,
    fit,
    predict,
    bound,
    optimise,
    explore,
    export,
    doctor,
):
    app.command(_module.__name__.rpartition(".")[2], cls=Command)(_module.run)
app.add_typer(road.app, name="road")


def _print_version(wanted: bool) -> None:
    if wanted:
        from .. import __version__

        typer.echo(f"susp-ss {__version__}")
        raise typer.Exit


@app.callback()
def _options(
    version: Annotated[
        bool, typer.Option("--version", callback=_print_version, is_eager=True, help="Print the version.")
    ] = False,
) -> None:
    """Ride of suspension models on random roads, and surrogates that tune a quarter car to a full car."""


def main(arguments: Sequence[str] | None = None) -> None:
    """Run a command line and exit.

    Parameters
    ----------
    arguments : sequence of str, optional
        What follows ``susp-ss``; the process's own arguments if None. Without any, help is printed.

    Raises
    ------
    SystemExit
        Code 0, or 2 after bad input.

    Examples
    --------
    >>> from susp_ss.cli import main
    >>> main(["--version"])
    Traceback (most recent call last):
    SystemExit: 0
    """
    given = list(sys.argv[1:] if arguments is None else arguments)
    codecs.register_error("spelt out", _spelt_out)
    if isinstance(sys.stdout, io.TextIOWrapper):
        sys.stdout.reconfigure(errors="spelt out")
    try:
        with warnings.catch_warnings():
            warnings.showwarning = _Warner()
            status = app(given or ["--help"], prog_name="susp-ss", standalone_mode=False)
    except typer.TyperException as error:
        _refuse(error.format_message())
    except Refusal as error:
        _refuse(str(error))
    sys.exit(status or 0)


def _spelt_out(error: UnicodeError) -> tuple[str, int]:
    """Units where the terminal's encoding has no superscripts: ``m/s^2``, and a question mark for anything else."""
    assert isinstance(error, UnicodeEncodeError)
    missing = error.object[error.start : error.end]
    return "".join({"²": "^2", "³": "^3"}.get(letter, "?") for letter in missing), error.end


class _Warner:
    """Say each warning once, in one line, without the place in the code that a programmer would want."""

    def __init__(self) -> None:
        self.said: set[str] = set()

    def __call__(self, message: Warning | str, *_: object, **__: object) -> None:
        line = " ".join(str(message).split())
        if line not in self.said:
            self.said.add(line)
            print("susp-ss: warning:", line, file=sys.stderr)


def _refuse(message: str) -> None:
    print("susp-ss: error:", *message.split(), file=sys.stderr)
    sys.exit(2)
