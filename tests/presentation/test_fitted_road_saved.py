"""A fitted road as files."""

import json

import numpy as np
import pandas as pd
import pytest

import susp_ss as ss


@pytest.fixture(scope="module")
def road():
    return ss.fit_road(ss.synthesise(ss.Road(tracks="isotropic"), 500.0, 0.1))


def test_files_hold_the_bands_and_the_fit(road, tmp_path):
    folder = tmp_path / "out"
    ss.save(road, folder)
    assert sorted(path.name for path in folder.iterdir()) == ["fitted_road.csv", "fitted_road.json", "fitted_road.png"]
    bands = pd.read_csv(folder / "fitted_road.csv", index_col="wavenumber")
    for name in road.spectrum:
        np.testing.assert_allclose(bands[name], road.spectrum[name])
    said = json.loads((folder / "fitted_road.json").read_text())
    assert said["fitted"]["waviness"] == [road.waviness, *road.intervals["waviness"]]
    assert ss.Road(roughness=said["road"]["roughness"], tracks=said["road"]["tracks"]).roughness == road.roughness
    with pytest.raises(FileExistsError, match="pass force=True"):
        ss.save(road, folder)
    ss.save(road, folder, force=True, figures=False)
    assert not (folder / "fitted_road.png").exists()


def test_a_road_without_a_profile_has_no_files(tmp_path):
    with pytest.raises(ValueError, match="a fitted road is one of fit_road"):
        ss.save(ss.FittedRoad(), tmp_path / "out")
    assert not (tmp_path / "out").exists()
