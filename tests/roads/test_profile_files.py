"""Profiles from files: what stands there is read as it was meant, and what no road can be is refused by its place."""

import numpy as np
import pytest
import xarray as xr

import susp_ss as ss

X = [0.0, 0.1, 0.25, 0.3]
LEFT = [0.0, 0.0015, -0.002, 0.001]
RIGHT = [0.001, 0.0, -0.001, 0.0005]

WRITTEN = {
    "names": "x,left,right\n" + "".join(f"{x},{l},{r}\n" for x, l, r in zip(X, LEFT, RIGHT, strict=True)),
    "no names": "".join(f"{x}\t{l}\t{r}\n" for x, l, r in zip(X, LEFT, RIGHT, strict=True)),
    "blanks": "# a comment\nstation  z_left  z_right\n"
    + "".join(f"  {x}   {l:.6f} {r}\n" for x, l, r in zip(X, LEFT, RIGHT, strict=True)),
    "decimal commas": "Road 7;;\n\nStation (m);Left wheel path [mm];RWP [mm]\n"
    + "".join(f"{x};{1e3 * l:.3f};{1e3 * r:.3f}\n" for x, l, r in zip(X, LEFT, RIGHT, strict=True)).replace(".", ","),
    "line of units": "RWP,distance,LWP\ncm,mm,m\n"
    + "".join(f"{1e2 * r},{1e3 * x},{l}\n" for x, l, r in zip(X, LEFT, RIGHT, strict=True)),
    "UTF-16": "x,left,right\n" + "".join(f"{x},{l},{r}\n" for x, l, r in zip(X, LEFT, RIGHT, strict=True)),
}


def same(profile):
    np.testing.assert_allclose(profile.x, X, atol=1e-12)
    np.testing.assert_allclose(profile.left, LEFT, atol=1e-12)
    np.testing.assert_allclose(profile.right, RIGHT, atol=1e-12)
    assert {variable.attrs["units"] for variable in profile.variables.values()} == {"m"}


@pytest.mark.parametrize("how", WRITTEN)
def test_text_is_read_as_it_was_meant(how, tmp_path):
    path = tmp_path / "road.txt"
    path.write_text(WRITTEN[how], encoding="utf-16" if how == "UTF-16" else "utf-8")
    same(ss.read_profile(path))


def test_columns_units_and_the_decimal_sign_may_be_told(tmp_path):
    path = tmp_path / "road.csv"
    path.write_text(
        "t;A;B;C\n0;0,000;1,000;0\n1;0,100;0,000;1.5\n2;0,250;-1,000;-2\n3;0,300;0,500;1\n".replace(",", ".")
    )
    how = {"columns": {"x": "A", "left": "C", "right": "B"}, "units": {"left": "mm", "right": "mm"}, "decimal": "."}
    same(ss.read_profile(path, **how))


@pytest.mark.parametrize("heading", ["elevation", "z [m]", "Height"])
def test_one_track_is_both(heading, tmp_path):
    path = tmp_path / "road.csv"
    path.write_text(f"x,{heading}\n" + "".join(f"{x},{l}\n" for x, l in zip(X, LEFT, strict=True)))
    profile = ss.read_profile(path)
    np.testing.assert_array_equal(profile.left, profile.right)
    np.testing.assert_allclose(profile.left, LEFT)


def test_netcdf_gives_back_what_was_synthesised(tmp_path):
    profile = ss.synthesise(ss.Road(tracks="isotropic"), 20.0, 0.1)
    for name, how in (("new.nc", {"engine": "netcdf4"}), ("old.nc", {"engine": "scipy"})):
        profile.to_netcdf(tmp_path / name, **how)
        read = ss.read_profile(tmp_path / name)
        for variable in ("x", "left", "right"):
            np.testing.assert_array_equal(read[variable], profile[variable])


def test_units_of_netcdf_are_its_own(tmp_path):
    dataset = xr.Dataset(
        {"z": ("distance", 1e3 * np.array(LEFT), {"units": "mm"}), "grid": (("distance", "k"), np.zeros((4, 2)))},
        coords={"distance": ("distance", X)},
    )
    dataset.to_netcdf(tmp_path / "road.nc", engine="scipy")
    np.testing.assert_allclose(ss.read_profile(tmp_path / "road.nc").left, LEFT)


CRG = """$CT
three long sections
$ROAD_CRG
REFERENCE_LINE_START_U = 0.0
REFERENCE_LINE_END_U = 1.5
REFERENCE_LINE_INCREMENT = 0.5
LONG_SECTION_V_RIGHT = -1.0
LONG_SECTION_V_LEFT = 1.0
LONG_SECTION_V_INCREMENT = 1.0
$
$KD_DEFINITION
#:LRFI
U:reference line u,m,0.0,0.5
D:long section 1,m
D:long section 2,m
D:long section 3,m
$
$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$
 -0.001000 0.0000000 0.0010000
 0.0020000 0.0000000 -0.004000
 0.0000000 0.0000000 0.0000000
 0.0000000 0.0010000 0.0020000
"""


def test_a_surface_is_read_along_two_tracks(tmp_path):
    # Bilinear between the long sections at v = -1, 0 and 1 m; v is positive to the left.
    pytest.importorskip("pyopencrg", reason="pyopencrg is not installed: pip install '.[roads]'")
    path = tmp_path / "road.crg"
    path.write_text(CRG)
    profile = ss.read_profile(path, track_width=1.0)
    np.testing.assert_allclose(profile.x, [0.0, 0.5, 1.0, 1.5])
    np.testing.assert_allclose(profile.left, [0.0005, -0.002, 0.0, 0.0015], atol=1e-9)
    np.testing.assert_allclose(profile.right, [-0.0005, 0.001, 0.0, 0.0005], atol=1e-9)
    with pytest.raises(
        ValueError, match=r"tracks 3 m apart lie at v = -1.5 and 1.5 m, but the surface reaches from -1"
    ):
        ss.read_profile(path, track_width=3.0)
    path.write_text(CRG[:400])
    with pytest.raises(ValueError, match="not a readable OpenCRG file"):
        ss.read_profile(path)


def test_without_the_extra_one_line_says_how_to_get_it(tmp_path, monkeypatch):
    monkeypatch.setitem(__import__("sys").modules, "pyopencrg", None)
    path = tmp_path / "road.crg"
    path.write_text(CRG)
    with pytest.raises(ModuleNotFoundError, match=r"road.crg: an OpenCRG file needs pyopencrg.*\[roads\]"):
        ss.read_profile(path)


ROUGH = "".join(f"{0.1 * i:.1f},{h}\n" for i, h in enumerate(np.random.default_rng(0).normal(size=200).cumsum()))

REFUSED = {
    "empty": ("", "needs a distance and heights, the file has no text"),
    "no points": ("x,left\n", "needs two points or more, got 0"),
    "one point": ("x,left\n0,1\n", "needs two points or more, got 1"),
    "no distance": ("t,left\n0,1\n1,1\n", "line 1: needs one column of distance, got none; available: 't', 'left'"),
    "no heights": ("x,y\n0,1\n1,1\n", "line 1: needs one column of heights, got none"),
    "two of a kind": ("x,left,lwp\n0,1,2\n", "needs one column of heights, got 2: 'left', 'lwp'"),
    "four columns": ("0,1,2,3\n1,1,2,3\n", "a distance and one or two heights, got 4 columns"),
    "ragged": ("x,left\n0,1\n1\n", "line 3: needs 2 cells as the others have, got 1"),
    "a gap": ("x,left\n0,0.1\n1,\n", "line 3, column 'left': needs a number, got an empty cell"),
    "not a number": ("x,left\n0,0.1\n1,nan\n", "line 3, column 'left': needs a number, got 'nan'"),
    "a word": ("x,left\n0,0.1\n1,high\n", "line 3, column 'left': needs a number, got 'high'"),
    "twice": (
        "x,left\n0,0.1\n0.5,0\n0.5,0.1\n",
        "line 4, column 'x': the distance must rise from point to point, got 0.5 m",
    ),
    "back": ("x,left\n3,0.1\n2,0\n", "line 3, column 'x': the distance must rise from point to point, got 2 m after 3"),
    "a hole": ("x,left\n0,0\n.1,0\n.2,0\n9,.1\n", "line 5, column 'x': a gap of 8.8 m, where points are 0.1 m apart"),
    "unit": ("x,left [kg]\n0,1\n1,2\n", "column 'left .kg.': left is in one of m, mm, cm, in, ft, km, got 'kg'"),
    "unknown unit": (
        "x [furlong],left\n0,1\n1,2\n",
        "column 'x .furlong.': x is in one of m, .* got 'furlong'; .*units=",
    ),
    "millimetres": (f"x,left\n{ROUGH}", r"column 'left': heights in m .*if they are in mm, state it: .*left \[mm\]"),
}


@pytest.mark.parametrize("name", REFUSED)
def test_a_doubtful_file_is_refused_by_its_place(name, tmp_path):
    text, words = REFUSED[name]
    path = tmp_path / "road.csv"
    path.write_text(text)
    with pytest.raises(ValueError, match=f"road.csv.*{words}"):
        ss.read_profile(path)


def test_the_same_in_millimetres_is_a_road(tmp_path):
    path = tmp_path / "road.csv"
    path.write_text(f"x,left [mm]\n{ROUGH}")
    assert ss.read_profile(path).sizes["x"] == 200


def test_a_level_stretch_is_no_gap(tmp_path):
    path = tmp_path / "road.csv"
    path.write_text("x,left\n0,0\n.1,.1\n.2,0\n20,0\n20.1,0.1\n")
    assert float(ss.read_profile(path).x[3]) == 20.0


@pytest.mark.parametrize(
    ("given", "error", "words"),
    [
        ({"path": "road.xyz"}, ValueError, "profiles are read from .csv, .* got .xyz"),
        ({"path": "road"}, ValueError, "got no suffix"),
        ({"columns": {"x": "x", "left": "LWP"}}, ValueError, "needs one column named 'LWP', got none"),
        ({"path": "missing.csv"}, FileNotFoundError, "missing.csv"),
        ({"path": "missing.nc"}, FileNotFoundError, "missing.nc"),
        ({"path": "missing.crg"}, FileNotFoundError, "missing.crg"),
        ({"columns": {"left": "a"}}, ValueError, "columns must name x and left or right or both"),
        ({"columns": {"middle": "a"}}, ValueError, "columns: there is no 'middle', available: x, left, right"),
        ({"columns": "left"}, TypeError, "columns must be a mapping"),
        ({"units": {"left": 3}}, TypeError, "units must be a mapping"),
        ({"decimal": ";"}, ValueError, 'decimal must be "." or ","'),
    ],
)
def test_bad_requests_are_refused(given, error, words, tmp_path):
    (tmp_path / "road.csv").write_text("x,left\n0,0\n1,0\n")
    given = {"path": "road.csv", **given}
    with pytest.raises(error, match=words):
        ss.read_profile(tmp_path / given.pop("path"), **given)


@pytest.mark.parametrize("path", [None, 3, b"road.csv", [], float("nan")])
def test_what_is_no_path_is_refused(path):
    with pytest.raises(TypeError, match="path must be the path of a profile, got"):
        ss.read_profile(path)


def test_units_are_read_as_people_spell_them(tmp_path):
    path = tmp_path / "road.csv"
    path.write_text("distance [feet],left [inches]\n0,0\n1,1\n2,0\n")
    profile = ss.read_profile(path)
    np.testing.assert_allclose(profile.x, [0.0, 0.3048, 0.6096])
    np.testing.assert_allclose(profile.left, [0.0, 0.0254, 0.0])
