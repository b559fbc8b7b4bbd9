"""The three figures, against their formulas written out."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import susp_ss as ss

responses = st.lists(st.floats(-1e3, 1e3), min_size=4, max_size=4).filter(lambda y: np.ptp(y) > 1e-3)


@given(responses, responses)
def test_formulas(true, predicted):
    F, S = np.array(true), np.array(predicted)
    result = ss.accuracy(true, predicted)
    np.testing.assert_allclose(result.R2, 1 - np.sum((S - F) ** 2) / np.sum((F - F.mean()) ** 2), rtol=1e-9, atol=1e-9)
    np.testing.assert_allclose(result.RMSE, np.sqrt(np.mean((S - F) ** 2)), rtol=1e-12)
    assert np.abs(S - F).max() == result.MAE, "the MAE of the study is the maximum"


@pytest.mark.parametrize(
    ("true", "predicted", "words"),
    [
        ([1.0, 2.0], [1.0], "at least two"),
        ([1.0, 2.0], [1.0, 2.0, 3.0], "one length, got 2 and 3"),
        ([1.0], [1.0], "at least two"),
        ([], [], "at least two"),
        ([1.0, np.nan], [1.0, 2.0], "y_true must be finite"),
        ([1.0, 2.0], [1.0, np.inf], "y_pred must be finite"),
        ([[1.0, 2.0]], [[1.0, 2.0]], "one row"),
        (["a", "b"], [1.0, 2.0], "y_true must be numbers"),
        (None, [1.0, 2.0], "y_true must be numbers"),
    ],
)
def test_bad_responses(true, predicted, words):
    with pytest.raises(ValueError, match=words):
        ss.accuracy(true, predicted)
