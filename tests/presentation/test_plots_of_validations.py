"""Pictures of validation: what is drawn is what was found, with units, and nothing is cut off."""

import io

import numpy as np
import pandas as pd
import pytest
from matplotlib.figure import Figure
from matplotlib.image import imread

from susp_ss import plots
from susp_ss.surrogates import Validation


@pytest.fixture(scope="module")
def validations():
    rng = np.random.default_rng(0)
    y = np.linspace(1.0, 2.0, 12)
    return {
        "RB": Validation(y, y + rng.normal(0.0, 0.1, 12), None, None),
        "Kriging": Validation(y, y + rng.normal(0.0, 0.05, 12), np.full(12, 0.05), None),
    }


@pytest.fixture(scope="module")
def table():
    rows = [
        {"surrogate": name, "runs": runs, "repeat": repeat, "RMSE": scale * (1.0 + repeat) / runs}
        for scale, name in enumerate(map("surrogate {}".format, range(9)), 1)
        for runs in (5, 10, 100)
        for repeat in (0, 1, 4)
    ]
    table = pd.DataFrame(rows)
    # A fit that was refused.
    table.loc[(table["surrogate"] == "surrogate 3") & (table["runs"] == 5), "RMSE"] = np.nan
    return table


def assert_whole(figure):
    """Ink, and none of it on the border."""
    buffer = io.BytesIO()
    figure.savefig(buffer, dpi=100)
    buffer.seek(0)
    image = imread(buffer, format="png")[..., :3]
    assert image.std() > 0.05
    border = np.concatenate([image[0], image[-1], image[:, 0], image[:, -1]])
    assert (border > 0.99).all()


def series(axes):
    """Points (n, 2) and ends of bars (n, 2), if any, by legend entry."""
    found = {}
    for points, _, bars in (container.lines for container in axes.containers):
        ends = [np.array([segment[:, 1] for segment in bar.get_segments() if len(segment)]) for bar in bars]
        found[len(found)] = np.column_stack(points.get_data(orig=False)), ends
    return dict(zip((container.get_label() for container in axes.containers), found.values(), strict=True))


def test_parity(validations):
    figure = plots.parity(validations, unit="m/s²")
    assert_whole(figure)
    (axes,) = figure.axes
    assert axes.get_xlabel() == "expensive response (m/s²)"
    assert axes.get_ylabel() == "predicted response (m/s²)"
    assert axes.get_xlim() == axes.get_ylim()
    drawn = series(axes)
    assert list(drawn) == ["RB", "Kriging"]
    for name, one in validations.items():
        np.testing.assert_array_equal(drawn[name][0], np.column_stack([one.y, one.predicted]))
    assert drawn["RB"][1] == []
    # The central interval of 95 % of a normal distribution.
    expected = validations["Kriging"].predicted[:, None] + 0.05 * 1.959964 * np.array([-1.0, 1.0])
    np.testing.assert_allclose(drawn["Kriging"][1][0], expected, rtol=1e-6)


def test_residuals(validations):
    figure = plots.residuals(validations, unit="N")
    assert_whole(figure)
    (axes,) = figure.axes
    assert axes.get_ylabel() == "residual (N)"
    for name, (points, _) in series(axes).items():
        one = validations[name]
        np.testing.assert_allclose(points, np.column_stack([one.y, one.predicted - one.y]), atol=1e-15)


@pytest.mark.parametrize(("draw", "height"), [(plots.parity, "predicted"), (plots.residuals, "residuals")])
def test_other_bars(validations, draw, height):
    bars = {name: one.allowance for name, one in validations.items()}
    drawn = series(draw(validations, margins=bars).axes[0])
    for name, one in validations.items():
        expected = getattr(one, height)[:, None] + bars[name][:, None] * np.array([-1.0, 1.0])
        np.testing.assert_allclose(drawn[name][1][0], expected, rtol=1e-6, atol=1e-12)


@pytest.mark.parametrize("draw", [plots.parity, plots.residuals])
def test_one_validation_needs_no_legend(validations, draw):
    figure = draw(validations["RB"])
    assert_whole(figure)
    assert figure.legends == []
    assert figure.axes[0].get_xlabel() == "expensive response"


def test_learning_curves(table):
    figure = plots.learning_curves(table, unit="m/s²")
    assert_whole(figure)
    (axes,) = figure.axes
    assert (axes.get_xscale(), axes.get_yscale()) == ("log", "log")
    assert axes.get_xlabel() == "expensive runs"
    assert axes.get_ylabel() == "RMSE (m/s²)"
    assert [label.get_text() for label in axes.get_xticklabels()] == ["5", "10", "100"]
    drawn = series(axes)
    assert list(drawn) == [f"surrogate {i}" for i in range(9)]
    (points, (whiskers,)) = drawn["surrogate 1"]
    runs = np.array([5, 10, 100])
    np.testing.assert_allclose(points[:, 0], runs, rtol=0.1)
    # Errors of 2/runs times 1, 2 and 5.
    np.testing.assert_allclose(points[:, 1], 4.0 / runs, rtol=1e-12)
    np.testing.assert_allclose(whiskers, np.outer(2.0 / runs, [1.0, 5.0]), rtol=1e-12)
    assert np.isnan(drawn["surrogate 3"][0][0, 1])


def test_the_foremost_curves_stand_out_from_the_others(table):
    figure = plots.learning_curves(table, "m/s^2", foremost=("surrogate 4", "surrogate 1"))
    assert_whole(figure)
    (axes,) = figure.axes
    assert axes.get_ylabel() == "RMSE (m/s²)"
    assert set(series(axes)) == {"surrogate 4", "surrogate 1"}
    assert [text.get_text() for text in figure.legends[0].get_texts()] == ["the others", "surrogate 4", "surrogate 1"]
    others = [line for line in axes.lines if line.get_marker() == "None"]
    assert len(others) == 7
    assert {line.get_color() for line in others} == {"#a6a6a6"}
    assert max(line.get_zorder() for line in others) < min(
        line.get_zorder() for line in axes.lines if line not in others
    )
    np.testing.assert_allclose(others[0].get_xydata(), [[5, 0.4], [10, 0.2], [100, 0.02]])
    with pytest.raises(ValueError, match="no surrogate named 'RB' in the table, available: surrogate 0, surrogate 1"):
        plots.learning_curves(table, foremost=("RB",))


def test_nine_curves_can_be_told_apart_without_colour(table):
    lines = [container.lines[0] for container in plots.learning_curves(table).axes[0].containers]
    assert len({(line.get_marker(), line.get_linestyle(), line.get_markerfacecolor() == "none") for line in lines}) == 9
    assert len({line.get_color() for line in lines}) == 9


def test_pictures_fit_into_others(validations, table):
    figure = Figure(figsize=(7.1, 2.6), layout="constrained")
    left, middle, right = figure.subplots(1, 3)
    assert plots.parity(validations, ax=left) is figure
    assert plots.residuals(validations, ax=middle) is figure
    assert plots.learning_curves(table, ax=right) is figure
    assert_whole(figure)
    assert [len(axes.containers) for axes in (left, middle, right)] == [2, 2, 9]
    assert left.get_legend() is not None
