"""What several tests use."""

import pytest

from susp_ss.cli import main


@pytest.fixture
def run(capsys):
    """Run a command line; return exit code, stdout and stderr."""

    def ran(*arguments):
        with pytest.raises(SystemExit) as end:
            main(list(map(str, arguments)))
        captured = capsys.readouterr()
        return end.value.code, captured.out, captured.err

    return ran
