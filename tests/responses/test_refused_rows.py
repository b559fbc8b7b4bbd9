"""What is no row of numbers is refused in the package's own words, wherever rows are taken."""

import numpy as np
import pytest

import susp_ss as ss

ROAD = ss.Road.iso8608("C", contact_length=0.1)
LEVEL = ss.obstacle("bump", step=1.0)
TIME = np.arange(5) * 0.1

TAKEN = {
    "frequency": lambda row: ss.psd(ss.QuarterCar(), ROAD, row),
    "time": lambda row: ss.simulate(ss.QuarterCar(), TIME, row),
    "speeds": lambda row: ss.peaks(ss.QuarterCar(), LEVEL, row),
    "acceleration": lambda row: ss.vdv(row, TIME),
    "elevation": lambda row: ss.iri(TIME, row),
    "delta_f": lambda row: ss.simulate(ss.RideHandlingCar(), np.zeros(5), TIME, inputs={"delta_f": row}),
}


@pytest.mark.parametrize(
    "row", [None, "a", [[1.0], [1.0, 2.0]], LEVEL, 1j], ids=["None", "text", "ragged", "profile", "1j"]
)
@pytest.mark.parametrize("name", TAKEN)
def test_no_numbers(name, row):
    with pytest.raises(TypeError, match=rf"{name}.* must be .*numbers.*, got"):
        TAKEN[name](row)


def test_no_further_inputs_are_none():
    alone = ss.simulate(ss.QuarterCar(), np.ones(5), TIME)
    assert ss.simulate(ss.QuarterCar(), np.ones(5), TIME, inputs={}).equals(alone)
