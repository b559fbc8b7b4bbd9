"""Words, files and pictures of feedback laws, bounds and fronts."""

import pandas as pd
import pytest

import susp_ss as ss

ROAD = ss.Road()
CAR = ss.QuarterCar()


@pytest.fixture(scope="module")
def results():
    limits = {"sws": 0.005, "dtl": 450.0}
    return {
        "law": ss.lqr(CAR, ROAD, {"bacc": 1.0, "sws": 1e4}),
        "bound": ss.active_bound(CAR, ROAD, "bacc", limits),
        "front": ss.active_bound(CAR, ROAD, "bacc", {**limits, "sws": [0.004, 0.005]}),
    }


@pytest.mark.parametrize(
    ("kind", "said"),
    [("law", "Forces in N per state"), ("bound", "No law of any kind comes lower"), ("front", "2 of 2 points")],
)
def test_the_report_says_what_was_reached(results, kind, said):
    assert said in " ".join(ss.report(results[kind]).split())


def test_files_of_a_law_hold_its_numbers(results, tmp_path):
    ss.save(results["law"], tmp_path / "out")
    assert {path.name for path in (tmp_path / "out").iterdir()} == {
        "feedback.csv", "feedback.png", "feedback.txt", "gain.csv",
    }  # fmt: skip
    table = pd.read_csv(tmp_path / "out" / "feedback.csv", index_col="metric")
    assert table.loc["bacc", "lqr"] == pytest.approx(float(results["law"].metrics.bacc))
    with pytest.raises(FileExistsError, match="holds results already"):
        ss.save(results["law"], tmp_path / "out")


def test_files_of_a_front_hold_every_point(results, tmp_path):
    ss.save(results["front"], tmp_path / "out", figures=False)
    table = pd.read_csv(tmp_path / "out" / "feedback.csv")
    assert table.bacc[1] == pytest.approx(results["bound"].bound, rel=1e-6)
    assert set(table) >= {"limit", "bacc", "multiplier_sws", "multiplier_dtl"}


def test_pictures(results):
    bars = ss.plots.feedback(results["bound"]).axes[0]
    assert [patch.get_width() < 0.0 for patch in bars.patches][:1] == [results["bound"].table().ratio.iloc[0] < 1.0]
    line = ss.plots.feedback(results["front"]).axes[0].lines[0]
    assert line.get_xdata().tolist() == pytest.approx([4.0, 5.0])
    with pytest.raises(TypeError, match="result must be a Feedback"):
        ss.plots.feedback(CAR)
