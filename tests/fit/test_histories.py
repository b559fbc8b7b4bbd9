"""Histories become the metrics that they hold: sums of sines have root mean squares in closed form."""

import numpy as np
import pandas as pd
import pytest

import susp_ss as ss

FREQUENCY = 1.5
INPUTS, OUTPUTS = {"ks": "ks"}, {"bacc": "acc", "sws": "travel", "damper_power": "power"}


def history(t, ks, amplitude):
    """Whole periods after a start that is none of the ride."""
    wave = amplitude * np.sin(2.0 * np.pi * FREQUENCY * t)
    started = t >= 2.0
    return pd.DataFrame(
        {
            "time": t,
            "ks": ks,
            "acc": 9.81 + np.where(started, wave, 40.0),
            "travel": np.where(started, -0.03 + 0.01 * wave, 1.0),
            "power": np.where(started, 50.0 + wave, 0.0),
        }
    )


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    t = np.arange(0.0, 12.0 + 1e-3, 2e-3)
    for name, ks, amplitude in (("a.csv", 18e3, 0.9), ("b.csv", 20e3, 1.1)):
        history(t, ks, amplitude).to_csv(name, index=False)
    return tmp_path


def read(**how):
    return ss.read_histories(["a.csv", "b.csv"], INPUTS, OUTPUTS, **{"cut": 2.0, **how})


def test_sines(folder):
    runs = read()
    assert runs.designs.ks.tolist() == [18e3, 20e3]
    np.testing.assert_allclose(runs.responses.bacc, np.array([0.9, 1.1]) / np.sqrt(2.0), rtol=1e-5)
    np.testing.assert_allclose(runs.responses.sws, np.array([0.009, 0.011]) / np.sqrt(2.0), rtol=1e-5)
    np.testing.assert_allclose(runs.responses.damper_power, 50.0, rtol=1e-5)
    assert runs.place(1, "bacc") == f"{folder}, file b.csv, column 'acc'"
    assert runs.noted == "2 histories: root mean squares about the mean, from 2 s on"


def test_uneven_samples_weigh_by_the_time_that_they_stand_for(folder):
    """Ten times as dense in one half, in which the ride is calmer."""
    t = np.concatenate([np.arange(0.0, 7.0, 1e-3), np.arange(7.0, 12.0 + 5e-3, 1e-2)])
    for name, ks in (("a.csv", 18e3), ("b.csv", 20e3)):
        ride = history(t, ks, 0.9)
        ride.loc[t >= 7.0, "travel"] = -0.03 + 0.02 * np.sin(2.0 * np.pi * FREQUENCY * t[t >= 7.0])
        ride.to_csv(name, index=False)
    expected = np.sqrt((5.0 * 0.009**2 + 5.0 * 0.02**2) / 20.0)
    np.testing.assert_allclose(read().responses.sws, expected, rtol=2e-3)
    with pytest.raises(
        ValueError, match=r"a\.csv: samples 1 and 2: a weighting needs even samples, got a step of 0.001"
    ):
        read(weighting="Wk")


def test_a_weighting_is_its_gain_on_a_sine_and_leaves_the_rest(folder):
    t = np.arange(0.0, 40.0, 2e-3)
    for name, ks in (("a.csv", 18e3), ("b.csv", 20e3)):
        wave = 0.9 * np.sin(2.0 * np.pi * FREQUENCY * t)
        pd.DataFrame({"time": t, "ks": ks, "acc": wave, "travel": wave, "power": wave}).to_csv(name, index=False)
    plain, weighted = read(cut=20.0), read(cut=20.0, weighting="Wk")
    gain = abs(ss.weighting("Wk")(2j * np.pi * FREQUENCY))
    np.testing.assert_allclose(weighted.responses.bacc, gain * plain.responses.bacc, rtol=1e-4)
    pd.testing.assert_series_equal(weighted.responses.sws, plain.responses.sws)
    assert weighted.noted.endswith("from 20 s on, accelerations through Wk")


def test_inputs_from_a_table_that_names_the_histories(folder):
    for name in ("a", "b"):
        pd.read_csv(f"{name}.csv").drop(columns="ks").to_csv(f"{name}.csv", index=False)
    (folder / "plan.csv").write_text("file;ks [N/mm];rest\nb.csv;20,5;1\nlost.csv;9;2\nout/a;18,5;3\n")
    runs = read(designs="plan.csv")
    assert runs.designs.ks.tolist() == [18500.0, 20500.0]
    np.testing.assert_allclose(runs.responses.bacc, np.array([0.9, 1.1]) / np.sqrt(2.0), rtol=1e-5)
    (folder / "plan.csv").write_text("file,ks\na,18e3\nc,20e3\n")
    with pytest.raises(ValueError, match=r"plan\.csv, column 'file': b\.csv needs one design, got none"):
        read(designs="plan.csv")
    (folder / "plan.csv").write_text("file,ks\na,18e3\nb,20e3\nb.csv,21e3\n")
    with pytest.raises(ValueError, match=r"plan\.csv, column 'file': b\.csv needs one design, got 2, in line 3, 4"):
        read(designs="plan.csv")


def test_histories_of_matlab_in_milliseconds(folder):
    from scipy.io import savemat

    for name in ("a", "b"):
        table = pd.read_csv(f"{name}.csv")
        savemat(f"{name}.mat", {"T": {c: table[c].to_numpy() for c in table}})
        text = table.assign(time=1e3 * table.time).rename(columns={"time": "Time (ms)"})
        text.to_csv(f"{name}.csv", index=False, sep=";", decimal=",")
    of_matlab = ss.read_histories(["a.mat", "b.mat"], INPUTS, OUTPUTS, 2.0)
    of_text = read(time="Time")
    pd.testing.assert_frame_equal(of_matlab.responses, of_text.responses, rtol=1e-9)


@pytest.mark.parametrize(
    ("change", "how", "said"),
    [
        ({}, {"cut": -1.0}, "cut must be >= 0 s, got -1.0"),
        ({}, {"cut": "2 s"}, "cut must be >= 0 s, got '2 s'"),
        ({}, {"cut": 60.0}, "a.csv: ends at 12 s, before the cut of 60 s"),
        ({}, {"time": "t"}, "a.csv, line 1: no column 't', available: 'time', 'ks', 'acc', 'travel', 'power'"),
        ({}, {"weighting": "Wx"}, "no weighting named 'Wx'"),
        ({(3, "time"): 0.0}, {}, "a.csv, line 5, column 'time': time must rise"),
        ({(7, "ks"): 19e3}, {}, "a.csv, line 9, column 'ks': the input ks must not change within a run, got 19000"),
        ({(7, "acc"): np.nan}, {}, "a.csv, line 9, column 'acc': bacc needs a number, got an empty cell"),
        ({(7, "acc"): np.inf}, {}, "a.csv, line 9, column 'acc': bacc needs a number, got 'inf'"),
        ({"ks": -1.0}, {}, "a.csv, column 'ks': ks must be finite and > 0, got -1"),
        ({"ks": 20e3}, {}, "column 'ks': an input must vary, got ks = 20000.0 N/m in all runs"),
    ],
)
def test_one_line_says_what_is_wrong(folder, change, how, said):
    table = pd.read_csv("a.csv")
    for at, value in change.items():
        if isinstance(at, tuple):
            table.loc[at] = value
        else:
            table[at] = value
    table.to_csv("a.csv", index=False)
    with pytest.raises(ValueError, match=r".") as error:
        read(**how)
    assert said in str(error.value)
    assert "\n" not in str(error.value)


def test_no_history(folder):
    with pytest.raises(ValueError, match=r"files must name at least one history, got none"):
        ss.read_histories([], INPUTS, OUTPUTS, 2.0)
    pd.read_csv("a.csv").head(1).to_csv("a.csv", index=False)
    with pytest.raises(ValueError, match=r"a\.csv: needs two samples or more, got 1"):
        read()
