"""Pictures over frequency refuse what is no curves in words."""

import pytest

import susp_ss as ss
from susp_ss import plots

S = ss.psd(ss.QuarterCar(), ss.Road.iso8608("C", contact_length=0.1), [1.0, 2.0])

GIVEN = {
    "None": (None, TypeError, "curves must be a mapping of names to DataArrays .*got None"),
    "nothing": ({}, TypeError, "curves must be a mapping"),
    "a list": ({"car": [1.0]}, TypeError, r"got \[1.0\] as 'car'"),
    "a sweep": ({"car": S.expand_dims(cs=[1.0, 2.0])}, ValueError, r"got 'car' on \(cs, output, frequency\)"),
    "one output": ({"car": S.sel(output="sws")}, ValueError, r"got 'car' on \(frequency\)"),
    "others": (
        {"car": S, "x": S.sel(output=["sws"])},
        ValueError,
        "all have the outputs bacc, sws, dtl, got 'x' without",
    ),
}


@pytest.mark.parametrize("draw", [plots.spectra, plots.bode])
@pytest.mark.parametrize("name", GIVEN)
def test_no_curves(name, draw):
    given, error, words = GIVEN[name]
    with pytest.raises(error, match=words):
        draw(given)
