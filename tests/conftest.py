"""What several tests use."""

import sys
from typing import NamedTuple

import hypothesis
import pytest

from susp_ss.cli import main
from susp_ss.surrogates import kriging

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


@pytest.fixture
def missing(monkeypatch):
    """Make a library seem not installed, and forget what has loaded it already."""

    def hide(library, loaded_by=()):
        for name in list(sys.modules):
            if f"{name}.".startswith((f"{library}.", *(f"{module}." for module in loaded_by))):
                monkeypatch.delitem(sys.modules, name)
        monkeypatch.setitem(sys.modules, library, None)

    return hide


@pytest.fixture(autouse=True, scope="session")
def few_starts():
    """Search likelihoods from two starts in place of ten; what tests the search itself asks for ten."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(kriging, "STARTS", 2)
        yield
