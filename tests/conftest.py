"""What several tests use."""

from typing import NamedTuple

import hypothesis
import pytest

from susp_ss.cli import main

# Machines differ in speed and are shared: no test fails by the clock.
hypothesis.settings.register_profile(
    "any machine", deadline=None, suppress_health_check=[hypothesis.HealthCheck.too_slow]
)
hypothesis.settings.load_profile("any machine")


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
