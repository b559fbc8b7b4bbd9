"""The command line from outside: how it is started, completed and explained."""

import os
import re
import subprocess
import sys

import pytest

import susp_ss as ss
from susp_ss.cli import app

COMMANDS = [command.name for command in app.registered_commands]
COMMANDS += [
    f"{group.name} {command.name}".strip()
    for group in app.registered_groups
    for command in group.typer_instance.registered_commands
]


@pytest.fixture
def shell(tmp_path):
    """Run ``python -m susp_ss`` in a home of its own; return stdout."""

    def run(*arguments, **environment):
        home = {"HOME": str(tmp_path), "SHELL": "/bin/bash"}
        done = subprocess.run(
            [sys.executable, "-m", "susp_ss", *arguments],
            env=os.environ | home | environment,
            capture_output=True,
            text=True,
            check=True,
        )
        assert done.stderr == ""
        return done.stdout

    return run


def test_python_starts_it(shell):
    assert shell("--version") == f"susp-ss {ss.__version__}\n"


@pytest.mark.parametrize("command", ["", *COMMANDS])
def test_a_switch_wants_no_value(command, run, monkeypatch):
    monkeypatch.setenv("COLUMNS", "120")
    code, out, err = run(*command.split(), "--help")
    assert (code, err) == (0, "")
    assert "bool" not in out
    assert re.search(r"--help +Show this message", out)


def test_bash_completes_commands_and_options(shell):
    def completed(words, at):
        return shell(COMP_WORDS=words, COMP_CWORD=str(at), _SUSP_SS_COMPLETE="complete_bash").split()

    assert completed("susp-ss me", 1) == ["metrics"]
    assert completed("susp-ss metrics --spee", 2) == ["--speed"]


def test_completion_is_installed_where_help_says(shell, tmp_path):
    assert "--install-completion" in shell("--help")
    # Without a shell to detect, one is named.
    said = shell("--install-completion", "bash", _TYPER_COMPLETE_TEST_DISABLE_SHELL_DETECTION="1")
    assert "bash completion installed" in said
    written = "".join(path.read_text() for path in tmp_path.rglob("*") if path.is_file())
    assert "_SUSP_SS_COMPLETE=complete_bash" in written
    assert "complete -o default -F _susp_ss_completion susp-ss" in written
