"""``susp-ss bound``: it says what the library says, and refuses in one line."""

import json

import pytest

import susp_ss as ss

QUARTER = ["bound", "--model", "quarter", "--minimise", "bacc", "--limit", "sws=6mm", "--limit", "dtl=0.43kN"]


def test_it_says_what_the_library_says(run, tmp_path):
    code, out, err = run(*QUARTER, "--json", "--out", tmp_path / "out")
    found = json.loads(out)
    expected = ss.active_bound(ss.QuarterCar(), ss.DEFAULT_ROAD, "bacc", {"sws": 0.006, "dtl": 430.0})
    assert (code, err) == (0, "")
    assert found["bound"] == pytest.approx(expected.bound)
    assert found["limits"] == {"sws": 0.006, "dtl": 430.0}
    assert (tmp_path / "out" / "feedback.csv").exists()
    assert run(*QUARTER, "--out", tmp_path / "out").code == 2
    assert "active bound on QuarterCar" in run(*QUARTER).out
    assert found["least"] is None
    assert "By a semidefinite programme nothing comes" in run(*QUARTER, "--certify", "clarabel").out


@pytest.mark.parametrize(
    ("line", "said"),
    [
        (["--limit", "sws"], "--limit must be OUTPUT=VALUE such as sws@fr=6mm, got 'sws'"),
        (["--certify", "mosek"], "certify must be 'clarabel' or 'scs', got 'mosek'"),
        (["--limit", "swx=3"], "limits: no output named 'swx'"),
        (["--limit", "sws=3N"], "--limit sws"),
        (["--limit", "sws=6"], "pass --trust-units"),
        (["--limit", "sws=3mm", "--limit", "dtl=100N"], "no law meets the limits"),
        (["--minimise", "bacc@cg"], "minimise: no 'bacc@cg', available: bacc"),
    ],
)
def test_bad_input_is_refused_in_one_line(run, line, said):
    code, out, err = run(*QUARTER[:5], *line)
    assert (code, out) == (2, "")
    assert said in err
    assert err.count("\n") == 1
