"""What a release says of itself is said in one voice."""

import re
import tomllib
from pathlib import Path

import pytest
import yaml

import susp_ss as ss

ROOT = Path(__file__).parents[1]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]


def test_the_citation_is_that_of_the_package():
    citation = yaml.safe_load((ROOT / "CITATION.cff").read_text(encoding="utf-8"))
    assert citation["cff-version"] == "1.2.0"
    assert citation["version"] == ss.__version__
    assert citation["license"] == PROJECT["license"]
    assert citation["keywords"] == PROJECT["keywords"]
    assert {"message", "title", "authors"} <= citation.keys()


def test_the_changelog_knows_the_version():
    assert f"\n## {ss.__version__}\n" in (ROOT / "CHANGELOG.md").read_text(encoding="utf-8")


def test_every_dependency_has_a_tried_version():
    pinned = (ROOT / "constraints.txt").read_text(encoding="utf-8").splitlines()
    assert all(re.fullmatch(r"[A-Za-z0-9_.-]+==[A-Za-z0-9.]+", line) for line in pinned)
    names = [re.sub(r"[-_.]+", "-", line.partition("==")[0]).lower() for line in pinned]
    assert len(set(names)) == len(names)
    groups = [PROJECT["dependencies"], *PROJECT["optional-dependencies"].values()]
    needed = {re.match(r"[\w.-]+", requirement)[0] for group in groups for requirement in group} - {"susp_ss"}
    assert {re.sub(r"[-_.]+", "-", name).lower() for name in needed} <= set(names)


@pytest.mark.parametrize("path", sorted((ROOT / ".github").rglob("*.yml")), ids=lambda path: path.name)
def test_templates_can_be_read(path):
    form = yaml.safe_load(path.read_text(encoding="utf-8"))
    assert form["blank_issues_enabled"] if path.name == "config.yml" else {"name", "description", "body"} <= form.keys()
