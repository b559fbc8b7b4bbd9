"""The study's pictures: something is drawn, in the right place, with units, and nothing is cut off."""

import dataclasses
import io

import numpy as np
import pytest
from matplotlib.image import imread

import susp_ss as ss
from susp_ss import plots

SURROGATES = ["RB", "VB", "PB"]


@pytest.fixture(scope="module")
def study():
    return ss.feasibility_study(nodes=(6, 5))


def pixels(figure):
    buffer = io.BytesIO()
    figure.savefig(buffer, dpi=100)
    buffer.seek(0)
    return imread(buffer, format="png")[..., :3]


def assert_whole(figure):
    """Ink, and none of it on the border."""
    image = pixels(figure)
    assert image.std() > 0.05
    border = np.concatenate([image[0], image[-1], image[:, 0], image[:, -1]])
    assert (border > 0.99).all()


def share_of(image, colour):
    return np.mean(np.abs(image - np.array(colour)).max(axis=-1) < 0.03)


@pytest.mark.parametrize("surrogate", SURROGATES)
def test_response_surfaces(study, surrogate):
    figure = plots.response_surfaces(study, surrogate)
    assert_whole(figure)
    assert [axes.get_zlabel() for axes in figure.axes] == ["BAcc (m/s²)", "DTL (kN)", "SWS (mm)"]
    assert {(axes.get_xlabel(), axes.get_ylabel()) for axes in figure.axes} == {("$K_s$ (kN/m)", "$C_s$ (kN s/m)")}
    (legend,) = figure.legends
    assert [text.get_text().split()[0] for text in legend.get_texts()] == ["low", "high", "surrogate"]
    # All heights lie inside the axes.
    for axes, criterion in zip(figure.axes, ["bacc", "dtl", "sws"], strict=True):
        heights = study.responses[["lf", "hf", surrogate]].sel(criterion=criterion).to_dataarray()
        unit = {"bacc": 1.0, "dtl": 1e3, "sws": 1e-3}[criterion]
        np.testing.assert_allclose(axes.get_zlim(), [heights.min() / unit, heights.max() / unit], rtol=1e-6)


def test_surfaces_have_the_colours_of_the_study(study):
    image = pixels(plots.response_surfaces(study, "RB", ["bacc"]))
    assert share_of(image, (0.949, 0.827, 0.043)) > 0.01
    assert share_of(image, (0.208, 0.816, 0.878)) > 0.01


def test_the_higher_surface_hides_the_lower(study):
    """Seen from above, the highest of three parallel surfaces covers the others but for a seam at the edge."""
    lowered = study.responses.copy(deep=True)
    for name in ("lf", "RB"):
        lowered[name] = 0.99 * lowered["hf"]
    image = pixels(plots.response_surfaces(_with(study, lowered), "RB", ["dtl"]))
    assert share_of(image, (0.208, 0.816, 0.878)) > 0.1
    assert share_of(image, (0.949, 0.827, 0.043)) < 0.005


def _with(study, responses):
    return dataclasses.replace(study, responses=responses)


@pytest.mark.parametrize("surrogate", SURROGATES)
def test_error_map(study, surrogate):
    figure = plots.error_map(study, surrogate)
    assert_whole(figure)
    panels, bars = figure.axes[:3], figure.axes[3:]
    assert [bar.get_xlabel() for bar in bars] == [
        f"{surrogate} error of BAcc (m/s²)",
        f"{surrogate} error of DTL (N)",
        f"{surrogate} error of SWS (mm)",
    ]
    assert panels[0].get_ylabel() == "$C_s$ (kN s/m)"
    for bar, criterion, unit in zip(bars, ["bacc", "dtl", "sws"], [1.0, 1.0, 1e-3], strict=True):
        limit = study.accuracy.loc[(surrogate, criterion), "MAE"] / unit
        np.testing.assert_allclose(bar.get_xlim(), [-limit, limit], rtol=1e-9)


def test_error_map_is_blue_where_the_surrogate_is_low(study):
    low = study.responses.copy(deep=True)
    low["VB"] = low["hf"] * 0.9
    image = pixels(plots.error_map(_with(study, low), "VB"))
    panel = image[30:120, 60:220]
    assert panel[..., 2].mean() > panel[..., 0].mean() + 0.1


def test_bode_magnitude():
    curves = plots.study_curves("rl")
    figure = plots.bode_magnitude(curves)
    assert_whole(figure)
    assert [axes.get_ylabel() for axes in figure.axes] == [
        "|BAcc / road| ((m/s²)/m)",
        "|DTL / road| (N/m)",
        "|SWS / road| (m/m)",
    ]
    assert {axes.get_xlabel() for axes in figure.axes} == {"frequency (Hz)"}
    labels = [text.get_text() for text in figure.legends[0].get_texts()]
    assert labels == list(curves)
    assert "full car at rl, all wheels in phase" in labels
    # The lines are the gains of the models.
    line = figure.axes[1].lines[0]
    expected = abs(ss.frequency_response(ss.QuarterCar(), line.get_xdata()).sel(output="dtl", input="z_r"))
    np.testing.assert_allclose(line.get_ydata(), expected, rtol=1e-12)
    together = abs(ss.frequency_response(ss.FullCar(), line.get_xdata()).sel(output="sws_rl").sum("input"))
    np.testing.assert_allclose(figure.axes[2].lines[1].get_ydata(), together, rtol=1e-12)


def test_unknown_names_are_refused(study):
    with pytest.raises(ValueError, match="no surrogate named 'XB', available: RB, VB, PB"):
        plots.error_map(study, "XB")
    with pytest.raises(ValueError, match="no criterion named 'roll', available: bacc, dtl, sws"):
        plots.response_surfaces(study, "RB", ["roll"])
