"""What the package refuses, as the one line that the user sees."""

import re
import traceback
from collections.abc import Iterator
from contextlib import contextmanager


class Refusal(Exception):
    """Bad input; the message is the whole line."""


@contextmanager
def refusals() -> Iterator[None]:
    """Turn a refusal of the package into `Refusal`.

    An OSError speaks for itself. A ValueError or TypeError is the package's word about its arguments, and a
    ModuleNotFoundError its word about an extra, only where the package raised it; from inside another library it is a
    bug, and passes.
    """
    try:
        yield
    except OSError as error:
        raise Refusal(f"{error.filename}: {error.strerror}" if error.filename else str(error)) from error
    except (ValueError, TypeError, ModuleNotFoundError) as error:
        *_, (frame, _) = traceback.walk_tb(error.__traceback__)
        if frame.f_globals.get("__name__", "").split(".")[0] != "susp_ss":
            raise
        raise Refusal(as_options(str(error))) from error


def as_options(message: str) -> str:
    """What the package says of its arguments, said of options.

    Examples
    --------
    >>> from susp_ss.cli.refusals import as_options
    >>> as_options('Road(speed=...) must be > 0 m/s; take ride_metrics(..., method="spectral")')
    '--speed must be > 0 m/s; take --method spectral'
    >>> as_options('if they are in mm, state it: units={"left": "mm"}')
    'if they are in mm, state it: --unit left=mm'
    """
    said = re.sub(r'\w+\([.]{3}, (\w+)="(\w+)"\)', r"--\1 \2", message)
    said = re.sub(r'units=\{"(\w+)": "(\w+)"\}', r"--unit \1=\2", said)
    said = said.replace('columns={"x": ..., "left": ..., "right": ...}', "--x, --left and --right")
    return re.sub(r"\w+\((\w+)=[.]{3}\)", lambda found: f"--{found[1].replace('_', '-')}", said)
