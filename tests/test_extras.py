"""Extras: the ones that are declared, each missed in one line that is right wherever the package came from."""

import importlib.metadata
import json
import shlex
import sys
import tomllib
from pathlib import Path

import pytest

from susp_ss.extras import EXTRAS, installation, needing
from susp_ss.presentation.versions import versions

ROOT = Path(__file__).parents[1]


@pytest.fixture
def noted(monkeypatch):
    """Let pip have noted where the package came from."""

    def note(origin):
        class Distribution:
            def read_text(self, name):
                return json.dumps(origin) if origin and name == "direct_url.json" else None

        monkeypatch.setattr(importlib.metadata, "distribution", lambda name: Distribution())

    return note


CAME_FROM = {
    "an index": (None, ["susp_ss[netcdf]"]),
    "a checkout": (
        {"url": "file:///home/me/my%20cars", "dir_info": {"editable": True}},
        ["-e", "/home/me/my cars[netcdf]"],
    ),
    "a folder": ({"url": "file:///home/me/cars", "dir_info": {}}, ["susp_ss[netcdf] @ file:///home/me/cars"]),
    "a wheel": ({"url": "file:///tmp/s.whl", "archive_info": {}}, ["susp_ss[netcdf] @ file:///tmp/s.whl"]),
    "git": (
        {"url": "https://example.org/s.git", "vcs_info": {"vcs": "git", "commit_id": "0a1b"}},
        ["susp_ss[netcdf] @ git+https://example.org/s.git@0a1b"],
    ),
}


@pytest.mark.parametrize(("origin", "told"), CAME_FROM.values(), ids=CAME_FROM)
def test_the_command_is_right_wherever_the_package_came_from(origin, told, noted):
    noted(origin)
    assert shlex.split(installation("netcdf")) == [sys.executable, "-m", "pip", "install", *told]


def test_a_package_that_is_not_installed_is_asked_for_by_name(monkeypatch):
    def unknown(name):
        raise importlib.metadata.PackageNotFoundError(name)

    monkeypatch.setattr(importlib.metadata, "distribution", unknown)
    assert installation("fast").endswith('"susp_ss[fast]"')


def test_extras_are_those_of_the_project():
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    declared = project["optional-dependencies"]
    assert declared["all"] == [f"susp_ss[{','.join(EXTRAS)}]"]
    assert "susp_ss[all]" in declared["test"]
    for extra, (modules, _) in EXTRAS.items():
        text = " ".join(declared[extra]).lower()
        for module in modules:
            assert module.lower() in text
            assert module.lower() not in " ".join(project["dependencies"]).lower()


def test_what_is_missed_is_named():
    said = r"^A sweep needs no_such_library, .* run .*\[distributed\]"
    with pytest.raises(ModuleNotFoundError, match=said) as error, needing("distributed", "A sweep"):
        import no_such_library  # noqa: F401
    assert error.value.name == "no_such_library"


def test_versions_leave_out_what_is_not_installed(monkeypatch):
    known = importlib.metadata.version

    def version(name):
        if name == "plotly":
            raise importlib.metadata.PackageNotFoundError(name)
        return known(name)

    monkeypatch.setattr(importlib.metadata, "version", version)
    assert "plotly" not in versions()
    assert "numpy" in versions()
