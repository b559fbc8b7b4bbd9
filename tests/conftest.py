"""What several tests use."""

from typing import NamedTuple

import pytest

from susp_ss.cli import main


class Ran(NamedTuple):
    """What a command line came to."""

    code: int
    out: str
    err: str


@pytest.fixture
def run(capsys):
    """Run a command line; return exit code, stdout and stderr."""

    def ran(*arguments):
        with pytest.raises(SystemExit) as end:
            main(list(map(str, arguments)))
        captured = capsys.readouterr()
        return Ran(end.value.code, captured.out, captured.err)

    return ran
