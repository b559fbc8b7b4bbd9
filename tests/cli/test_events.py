"""``susp-ss events`` says what the library says, and refuses in one line."""

import json

import pytest

import susp_ss as ss

ROUGH = ("--road-class", "D", "--contact-length", "0.1")
ROAD = ss.Road.iso8608("D", speed=20.0, tracks="isotropic", contact_length=0.1)


def test_a_table_of_every_wheel(run):
    code, out, err = run("events", *ROUGH, "--clearance", "80mm", "--distance", "2000")
    assert (code, err) == (0, "")
    events = ss.rare_events(ss.FullCar(), ROAD, clearance=0.08, distance=2000.0)
    line = next(line for line in out.splitlines() if "bump_probability" in line)
    assert f"{float(events.bump_probability.sel(corner='rr')):.4g}" in line
    assert "sws_highest, davenport" in out
    assert "bump_rate: how often a suspension reaches its bump stop" in out


def test_json_is_what_the_library_says(run):
    more = ("--rebound", "90mm", "--duration", "60", "--sn-slope", "4", "--sn-range", "2kN", "--sn-cycles", "1e5")
    code, out, err = run("events", "--model", "quarter", *ROUGH, "--clearance", "0.08", *more, "--json")
    assert (code, err) == (0, "")
    told = json.loads(out)
    settings = {"duration": 60.0, "sn_slope": 4.0, "sn_range": 2000.0, "sn_cycles": 1e5}
    assert {name: told[name] for name in settings} == settings
    events = ss.rare_events(ss.QuarterCar(), ROAD, 0.08, 0.09, **settings)
    assert told["events"]["rebound_rate"] == pytest.approx(float(events.rebound_rate))
    assert told["events"]["damage"]["dirlik"] == pytest.approx(float(events.damage.sel(counting="dirlik")))
    assert told["units"]["sws_highest"] == "m"


@pytest.mark.parametrize(
    ("options", "said"),
    [
        ((), "--contact-length must be > 0 m"),
        ((*ROUGH, "--clearance", "80"), "did you mean 80 mm?"),
        ((*ROUGH, "--clearance", "-1"), "--clearance must be > 0 m, got -1"),
        ((*ROUGH, "--rebound", "80mm"), "rebound needs a clearance"),
        ((*ROUGH, "--sn-slope", "steep"), "--sn-slope"),
        ((*ROUGH, "--distance", "2000", "--duration", "60"), "--distance and --duration are two ways"),
        ((*ROUGH, "--ct", "50"), "pass ct=0"),
    ],
)
def test_what_has_no_answer_is_refused(run, options, said):
    code, out, err = run("events", *options)
    assert (code, out) == (2, "")
    assert said in err
    assert err.count("\n") == 1
