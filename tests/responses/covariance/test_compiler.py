"""The compiler is not needed, and what it compiled is kept in the user's cache, nowhere else."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import susp_ss as ss
from susp_ss.responses.covariance import compiler, routes

PROGRAM = """
import sys
import numba, numpy as np
before = numba.config.CACHE_DIR
from susp_ss.responses.covariance import compiler, struts_numba
out = np.empty((3, 4, 2))
struts_numba.weighted(np.ones((2, 3, 4, 5)), np.array([1.0, 2.0]), 1, 2, out)
assert (out == 3.0).all() and numba.config.CACHE_DIR == before
sys.path.insert(0, sys.argv[1])
import own
assert own.twice(2) == 4
print(compiler.cache_folder())
"""


@pytest.fixture
def kept(tmp_path):
    """Compile a kernel of ours and one of the user's own; return where ours goes, and every file of compiled code."""
    own = tmp_path / "own.py"
    own.write_text("import numba\n@numba.njit(cache=True)\ndef twice(x):\n    return 2 * x\n")
    package = Path(ss.__file__).parent

    def run(**environment):
        before = set(package.rglob("*.nb?"))
        clean = {name: text for name, text in os.environ.items() if name != "NUMBA_CACHE_DIR"}
        program = [sys.executable, "-c", PROGRAM, str(tmp_path)]
        home = {"HOME": str(tmp_path), "XDG_CACHE_HOME": str(tmp_path / "cache")}
        said = subprocess.run(program, env=clean | home | environment, capture_output=True, text=True, check=True)
        assert set(package.rglob("*.nb?")) == before
        return Path(said.stdout.strip()), {path.relative_to(tmp_path) for path in tmp_path.rglob("*.nbi")}

    return run


def test_compiled_code_goes_to_the_user_s_cache(kept, tmp_path):
    folder, files = kept()
    assert folder.is_relative_to(tmp_path)
    ours = {path for path in files if (tmp_path / path).is_relative_to(folder)}
    assert {path.name.partition("-")[0] for path in ours} == {"struts_numba.weighted"}
    assert {path.parent.name for path in files - ours} == {"__pycache__"}


def test_numba_s_own_setting_is_followed(kept, tmp_path):
    folder, files = kept(NUMBA_CACHE_DIR=str(tmp_path / "theirs"))
    assert folder.parent == tmp_path / "theirs" / "susp_ss"
    assert len(files) == 2
    assert {path.parts[0] for path in files} == {"theirs"}


def test_where_no_cache_can_be_written_code_is_compiled_all_the_same(kept, tmp_path):
    (tmp_path / "cache").write_text("no folder")
    _, files = kept()
    assert {path.name.partition("-")[0] for path in files} == {"own.twice"}


def test_other_sources_have_another_folder(tmp_path, monkeypatch):
    for path in Path(compiler.__file__).parent.glob("*.py"):
        shutil.copy(path, tmp_path)
    here = compiler.cache_folder()
    monkeypatch.setattr(compiler, "__file__", str(tmp_path / "compiler.py"))
    compiler._sources.cache_clear()
    assert compiler.cache_folder() == here
    with (tmp_path / "polynomials.py").open("a") as file:
        file.write("# changed\n")
    compiler._sources.cache_clear()
    changed = compiler.cache_folder()
    compiler._sources.cache_clear()
    assert changed != here
    assert changed.parent == here.parent


@pytest.mark.parametrize("vehicle", [ss.FullCar(), ss.FullCar(ks=ss.Corners(fr=16e3, fl=18e3, rr=21e3, rl=24e3))])
def test_without_numba_the_plain_kernels_answer(vehicle, missing, monkeypatch):
    expected = ss.ride_metrics(vehicle, ss.Road())
    monkeypatch.setattr(routes, "PLENTY", 1)
    monkeypatch.setattr(routes, "MANY", 1)
    missing("numba", loaded_by=[f"{routes.__package__}.{name}_numba" for name in ("polynomials", "struts")])
    with pytest.warns(UserWarning, match=r"a few times as long without numba; run .*\[fast\]") as warned:
        found = ss.ride_metrics(vehicle, ss.Road())
    assert len(warned) == 1
    for name, data in expected.items():
        np.testing.assert_array_equal(found[name], data)
