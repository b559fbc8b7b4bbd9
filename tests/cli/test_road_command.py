"""``susp-ss road``: profiles made, read, fitted, drawn and rated from the command line."""

import json

import numpy as np
import pytest

import susp_ss as ss


@pytest.fixture(autouse=True)
def here(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", "40")
    return tmp_path


@pytest.fixture
def answer(run):
    def ran(line):
        code, out, err = run("road", *line.split())
        assert (code, err) == (0, "")
        return out

    return ran


def test_a_profile_is_the_library_s_and_fitted_as_there(answer, here):
    for name in ("road.csv", "road.nc"):
        line = f"synthesise --road-class C --length 0.6km --step 10cm --seed 3 --out {name} --json"
        said = json.loads(answer(line))
        assert said["profile"]["points"] == 6000
        assert said["road"]["roughness"] == 256e-6
        expected = ss.synthesise(ss.Road.iso8608("C", tracks="isotropic"), 600.0, 0.1, seed=3)
        read = ss.read_profile(here / name)
        for variable in ("x", "left", "right"):
            np.testing.assert_allclose(read[variable], expected[variable], rtol=1e-9, atol=1e-12)
    fitted, road = json.loads(answer("fit road.nc --json")), ss.fit_road(read)
    assert fitted["iso_class"] == road.iso_class == "C"
    assert fitted["fitted"]["waviness"] == [road.waviness, *road.intervals["waviness"]]
    assert fitted["road"]["tracks"] == "isotropic"
    assert len(fitted["bands"]["psd"]) == len(fitted["bands"]["wavenumber"])
    text = answer("fit road.csv")
    assert text.startswith("ISO 8608 class C, by the geometric mean of G_d(0.1 cycle/m): 0.000256 m^3")
    assert f"{road.waviness:12.4g}" in text
    assert ss.report(road) == answer("fit road.nc --out fitted").rstrip("\n")
    assert json.loads((here / "fitted/fitted_road.json").read_text())["fitted"] == fitted["fitted"]


def test_reading_says_what_was_found(answer, here):
    (here / "road.csv").write_text("Dist;LWP [mm]\n0;1,5\n0,1;2\n0,3;-1\n")
    said = json.loads(answer("read road.csv --json"))
    assert said["read"] == "cells between semicolons"
    assert said["profile"]["largest_step"] == pytest.approx(0.2)
    assert said["profile"]["left_lowest"] == -0.001
    (here / "bare.csv").write_text("a,b\n0,1\n1,2\n")
    said = json.loads(answer("read bare.csv --x a --right b --unit right=mm --json"))
    assert said["profile"]["left_highest"] == 0.002
    assert "points" in answer("read road.csv")


def test_an_obstacle_has_an_index(answer, here):
    answer("obstacle speed-table --height 60mm --track right --out table.nc")
    table = ss.read_profile(here / "table.nc")
    assert float(table.right.max()) == 0.06
    assert not table.left.any()
    index = json.loads(answer("iri table.nc --json"))
    assert index["left"] == 0.0
    assert index["right"] == ss.iri(table).sel(track="right").item()
    parts = json.loads(answer("iri table.nc --segment 10 --json"))
    assert parts["right"] == ss.iri(table, segment=10.0).sel(track="right").values.tolist()
    assert "right (m/km)" in answer("iri table.nc --segment 10")
    assert f"{index['right']:.3f}" in answer("iri table.nc")
    answer("obstacle swept-sine --wavelengths 8:1 --out sine.csv")
    assert ss.read_profile(here / "sine.csv").left.max() == pytest.approx(0.01, rel=1e-3)


def test_the_chart_is_written_where_it_is_told(answer, here):
    answer("synthesise --length 300 --out road.csv")
    for name in ("chart.png", "chart.svg"):
        answer(f"chart road.csv --out {name}")
        assert (here / name).stat().st_size > 5000
    assert b"<svg" in (here / "chart.svg").read_bytes()[:500]


REFUSED = [
    ("synthesise --length 0", "length must be > 0 m"),
    ("synthesise --length 1,5", "write 1.5"),
    ("synthesise --step 5V", "no unit 'V' of length"),
    ("synthesise --out road.xyz", "--out must end in .csv or .nc, got road.xyz"),
    ("synthesise --out held.csv", "--out held.csv exists already; pass --force to replace it"),
    ("synthesise --out no/road.csv --length 1", "--out no/road.csv: there is no folder no"),
    ("synthesise --speed fast", "--speed"),
    ("read missing.csv", "missing.csv: No such file"),
    ("read held.csv --unit left", "--unit must be COLUMN=UNIT, such as left=mm"),
    ("read held.csv --unit left=kg", "left is in one of m, mm"),
    ("read held.csv --x a", "columns must name x and left or right or both"),
    ("read held.csv --unit x=furlong", "got 'furlong'; to say which, --unit x=m"),
    ("read names.csv", "say which by --x, --left and --right"),
    ("fit held.csv --out held.csv", "is a file, not a folder"),
    ("fit held.csv", "profile must be 80 m or longer"),
    ("fit held.csv --confidence 2", "confidence must be > 0 and < 1"),
    ("chart held.csv --out chart.gif", "--out must end in .png or .svg or .pdf"),
    ("obstacle log", "kind must be one of kerb"),
    ("obstacle bump --height=-1", "height must be > 0 m"),
    ("obstacle bump --edge 0.1", "edge is for"),
    ("obstacle swept-sine --wavelengths 8", "--wavelengths must be LO:HI"),
    ("iri held.csv", "iri needs at least 11 m of profile"),
]


@pytest.mark.parametrize(("line", "said"), REFUSED, ids=[line for line, _ in REFUSED])
def test_bad_input_is_one_line(line, said, run, here):
    (here / "held.csv").write_text("x,left\n0,0\n1,0.01\n2,0\n")
    (here / "names.csv").write_text("a,b\n0,0\n1,0\n")
    before = sorted(here.iterdir())
    code, out, err = run("road", *line.split())
    assert (code, out) == (2, "")
    assert err.startswith("susp-ss: error: ")
    assert err.count("\n") == 1
    assert said in err
    assert sorted(here.iterdir()) == before
