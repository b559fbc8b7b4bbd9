"""``susp-ss doctor``: what there is in one line each, and what to do where something lacks."""

import json
import sys

import pytest

import susp_ss as ss
from susp_ss.cli import doctor
from susp_ss.extras import EXTRAS, installation


@pytest.fixture
def cache(tmp_path, monkeypatch):
    """An empty cache of one's own."""
    monkeypatch.setattr("susp_ss.responses.covariance.compiler.cache_folder", lambda: tmp_path / "cache" / "0a1b")
    return tmp_path / "cache"


def said(run):
    code, out, err = run("doctor")
    assert (code, err) == (0, "")
    lines = dict(line.split(maxsplit=1) for line in out.splitlines())
    assert list(lines) == [
        *("python", "package", "versions", "processor", "blas", "compiled", "browser"),
        *(f"[{extra}]" for extra in EXTRAS),
    ]
    return lines


def test_each_thing_has_its_line(run, cache):
    lines = said(run)
    assert lines["python"] == sys.executable
    assert f"susp_ss {ss.__version__}" in lines["versions"]
    assert "thread" in lines["blas"]
    assert lines["compiled"] == f"{cache}: nothing yet"
    assert all(lines[f"[{extra}]"] == f"installed: {purpose}" for extra, (_, purpose) in EXTRAS.items())


def test_what_lacks_has_its_command(run, cache, missing):
    missing("netCDF4")
    _, purpose = EXTRAS["netcdf"]
    assert said(run)["[netcdf]"] == f"lacks netCDF4, for {purpose}; run {installation('netcdf')}"
    document = json.loads(run("doctor", "--json").out)
    assert document["extras"]["netcdf"] == {"for": purpose, "missing": ["netCDF4"], "install": installation("kriging")}


def test_compiled_code_is_measured(run, cache):
    (cache / "0a1b").mkdir(parents=True)
    (cache / "0a1b" / "kernel.nbc").write_bytes(bytes(2_500_000))
    assert said(run)["compiled"] == f"{cache}: 2.5 MB, which may be deleted"
    assert json.loads(run("doctor", "--json").out)["compiled"] == {"folder": str(cache), "bytes": 2_500_000}


@pytest.mark.parametrize(("threads", "advised"), [(1, False), (8, True)])
def test_threads_that_hinder_are_told(run, cache, threads, advised, monkeypatch):
    monkeypatch.setattr(
        "threadpoolctl.threadpool_info",
        lambda: [{"user_api": "blas", "internal_api": "openblas", "version": "1", "num_threads": threads}],
    )
    assert ("set OPENBLAS_NUM_THREADS=1" in said(run)["blas"]) == advised


def test_no_browser_is_told(run, cache, monkeypatch):
    monkeypatch.setattr(doctor.shutil, "which", lambda name: None)
    assert said(run)["browser"].endswith("install one to open report.html")
