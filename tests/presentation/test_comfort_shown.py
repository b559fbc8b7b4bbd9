"""Comfort in words, files and pictures."""

import json

import numpy as np
import pandas as pd
import pytest
import xarray as xr
from test_plots import assert_whole

import susp_ss as ss
from susp_ss import plots

ROAD = ss.Road.iso8608("C", tracks="isotropic")
POINTS = {"driver": (0.3, 0.4)}


def at_speeds(count):
    speed = np.linspace(5.0, 40.0, count)
    return ss.Road.iso8608("C", speed=xr.DataArray(speed, {"speed": speed}, "speed"), tracks="isotropic")


def bump():
    x = np.array([0.0, 5.0, 5.5, 6.0, 30.0])
    z = ("x", np.array([0.0, 0.0, 0.05, 0.0, 0.0]))
    return xr.Dataset({"left": z, "right": z}, {"x": x})


def test_the_report_says_what_was_found():
    ride = ss.comfort(ss.FullCar(), ROAD, points=POINTS)
    driver = ride.metrics.sel(point="driver")
    said = ss.report(ride)
    assert said.startswith("Comfort: FullCar on G_d")
    assert "8 h of exposure" in said
    assert "bacc Wk, k = 1; roll_acc We, k = 0.63; pitch_acc We, k = 0.4" in said
    line = next(line for line in said.splitlines() if line.startswith("driver"))
    assert f"{float(driver.total):.4g}" in line
    assert driver.reaction.item() in line
    assert "Shocks" not in said


def test_the_report_warns_of_shocks():
    shock = ss.comfort(ss.FullCar(), bump(), points=POINTS, speed=10.0)
    assert "Shocks at cg, fr" in ss.report(shock)
    assert "on a profile of 30 m at 10 m/s; 3 s of exposure" in ss.report(shock)
    assert "Shocks: a root" in ss.report(ss.comfort(ss.QuarterCar(), bump(), speed=10.0))


def test_a_long_sweep_is_cut_short():
    said = ss.report(ss.comfort(ss.FullCar(), at_speeds(200)))
    assert len(said.splitlines()) < 250
    assert "..." in said


def test_one_telling_line_and_a_table_in_notebooks():
    ride = ss.comfort(ss.QuarterCar(), ROAD)
    assert repr(ride).count("\n") == 0
    assert ride.metrics.reaction.item() in repr(ride)
    assert "total (m/s²)" in ride._repr_html_()


@pytest.mark.parametrize(
    ("vehicle", "road", "speed", "picture"),
    [
        (ss.FullCar(), ROAD, None, True),
        (ss.QuarterCar(), at_speeds(5), None, True),
        (ss.QuarterCar(ks=xr.DataArray(np.array([2e4, 3e4]), dims="ks")), at_speeds(2), None, False),
        (ss.QuarterCar(), bump(), 10.0, False),
        (ss.LinearVehicle(ss.FullCar().state_space(input="velocity"), like=ss.FullCar()), ROAD, None, True),
    ],
)
def test_files(vehicle, road, speed, picture, tmp_path):
    ride = ss.comfort(vehicle, road, speed=speed)
    ss.save(ride, tmp_path / "out")
    table = pd.read_csv(tmp_path / "out/comfort.csv")
    np.testing.assert_allclose(table.total, ride.metrics.total.values.ravel())
    said = json.loads((tmp_path / "out/comfort.json").read_text())
    assert len(said["comfort"]) == len(table)
    assert said["units"]["vdv"] == "m/s^1.75"
    assert said["duration"] == {"value": ride.duration, "unit": "s"}
    assert (tmp_path / "out/comfort.png").exists() == picture
    ss.save(ride, tmp_path / "out", force=True, figures=False)
    assert not (tmp_path / "out/comfort.png").exists()


def test_json_has_no_infinity(tmp_path):
    level = bump() * 0.0
    ss.save(ss.comfort(ss.QuarterCar(), level.assign_coords(x=bump().x), speed=10.0), tmp_path / "out")
    (row,) = json.loads((tmp_path / "out/comfort.json").read_text())["comfort"]
    assert row["a8_limit_time"] is None
    assert row["total"] == 0.0


def test_pictures_are_whole():
    bands = ss.third_octaves(ss.FullCar(), ROAD, weighting="Wk")
    figure = plots.third_octaves({at: bands.sel(output=f"bacc_{at}") for at in ("cg", "fr")})
    assert_whole(figure)
    assert "ISO 2631-1:1985" in figure.legends[0].get_texts()[-1].get_text()
    total = ss.comfort(ss.FullCar(), at_speeds(4)).metrics.total
    figure = plots.comfort({"front right": total.sel(point="fr"), "centre of gravity": total.sel(point="cg")})
    assert_whole(figure)
    words = [text.get_text() for text in figure.axes[0].texts]
    assert words[0] == "not uncomfortable"
    assert "extremely uncomfortable" in words


@pytest.mark.parametrize(
    ("call", "error", "words"),
    [
        (lambda: plots.comfort(None), TypeError, "curves must be a mapping"),
        (lambda: plots.comfort({"a": 1.0}), TypeError, "got 1.0 as 'a'"),
        (lambda: plots.comfort({"a": xr.DataArray(1.0)}), ValueError, r"'a' on \(\)"),
        (lambda: plots.third_octaves({"a": xr.DataArray([1.0, 2.0], dims="speed")}), ValueError, "on frequency"),
        (lambda: plots.third_octaves({}), TypeError, "curves must be a mapping"),
    ],
)
def test_what_is_no_picture(call, error, words):
    with pytest.raises(error, match=words):
        call()
