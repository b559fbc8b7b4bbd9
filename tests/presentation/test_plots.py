"""Pictures: something is drawn, in the right place, with units, and nothing is cut off."""

import dataclasses
import io

import numpy as np
import pandas as pd
import pytest
import xarray as xr
from matplotlib.figure import Figure
from matplotlib.image import imread

import susp_ss as ss
from susp_ss import plots
from susp_ss.fit.surrogate_file import SuspensionSurrogate
from susp_ss.study.scan import DEFAULT, FACTORS, Scan

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


def extent(text):
    return text.get_window_extent().padded(-0.5)


@pytest.mark.parametrize("criteria", [["bacc", "dtl", "sws"], ["dtl"]])
def test_surfaces_are_seen_from_one_side_and_labels_keep_apart(criteria):
    figure = plots.response_surfaces(ss.feasibility_study(nodes=(4, 4)), "RB", criteria)
    figure.draw_without_rendering()
    assert len({(axes.elev, axes.azim) for axes in figure.axes}) == 1
    for axes in figure.axes:
        for axis in (axes.xaxis, axes.yaxis, axes.zaxis):
            ticks = [extent(tick.label1) for tick in axis._update_ticks() if tick.label1.get_text()]
            assert ticks
            assert extent(axis.label).count_overlaps(ticks) == 0, (axes.get_title(), axis.axis_name)


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
    for axes, bar, criterion, unit in zip(panels, bars, ["bacc", "dtl", "sws"], [1.0, 1.0, 1e-3], strict=True):
        limit = study.accuracy.loc[(surrogate, criterion), "MAE"] / unit
        np.testing.assert_allclose(bar.get_xlim(), [-limit, limit], rtol=1e-9)
        # A cross where the error is that large.
        (cross,) = (line for line in axes.lines if line.get_marker() == "x")
        (ks,), (cs,) = cross.get_data()
        at = study.responses.sel(criterion=criterion).sel(ks=1e3 * ks, cs=1e3 * cs, method="nearest")
        assert abs(at[surrogate] - at.hf).item() / unit == pytest.approx(limit)


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


ROAD = ss.Road.iso8608("B", speed=20.0, tracks="isotropic")
CARS = {"quarter car": ss.QuarterCar(), "full car": ss.FullCar()}


def own_axes(rows, columns, **how):
    figure = Figure(figsize=(9, 5), layout="constrained")
    return figure, figure.subplots(rows, columns, squeeze=False, **how)


def grid_of_designs(vehicle=ss.QuarterCar, nodes=(5, 9)):
    axes = {"ks": np.linspace(12e3, 25e3, nodes[0]), "cs": np.linspace(800.0, 2200.0, nodes[1])}
    return ss.ride_metrics(vehicle(**{name: xr.DataArray(v, {name: v}, name) for name, v in axes.items()}), ROAD)


def scanned():
    usual = dict(zip(FACTORS, DEFAULT, strict=True)) | {"refused": ""}
    rows = [
        usual | {"speed": speed, "road_class": name, "distance": factor * speed}
        for speed in (10.0, 20.0)
        for name, factor in [("A", 1.0), ("B", 0.1), ("C", 3.0)]
    ]
    return pd.DataFrame([*rows, usual | {"tracks": "independent", "distance": np.nan, "refused": "no variance"}])


def test_bode_draws_magnitude_and_phase():
    curves = plots.study_curves("fl")
    figure = plots.bode(curves)
    assert_whole(figure)
    above, below = figure.axes[:3], figure.axes[3:]
    assert [axes.get_title() for axes in above] == ["BAcc", "DTL", "SWS"]
    assert [axes.get_ylabel() for axes in above] == ["|H| ((m/s²)/m)", "|H| (N/m)", "|H| (m/m)"]
    for i, criterion in enumerate(["bacc", "dtl", "sws"]):
        for j, curve in enumerate(curves.values()):
            magnitude, phase = above[i].lines[j].get_ydata(), below[i].lines[j].get_ydata()
            np.testing.assert_allclose(
                magnitude * np.exp(1j * np.radians(phase)), curve.sel(criterion=criterion), rtol=1e-9
            )
            assert np.abs(np.diff(phase)).max() < 180.0


def test_one_output_of_the_bode_plot_fits_a_column():
    H = ss.frequency_response(ss.FullCar(), np.geomspace(0.1, 20.0, 50)).sel(output=["roll_acc"])
    figure = plots.bode({f"road at {name}": H.sel(input=name) for name in H.input.values})
    assert figure.get_figwidth() == plots.COLUMN
    assert_whole(figure)
    above, below = figure.axes
    assert above.get_ylabel() == "|H| ((rad/s²)/m)"
    # From 0 through -180 degrees and on, without a jump.
    phase = below.lines[0].get_ydata()
    assert phase[0] > -10.0
    assert phase[-1] < -200.0
    assert np.abs(np.diff(phase)).max() < 40.0


def test_spectra_of_any_outputs():
    f, outputs = np.geomspace(0.1, 50.0, 60), ["bacc_cg", "pitch_acc", "sws_fr", "dtl_rl"]
    S = ss.psd(ss.FullCar(), ROAD, f).sel(output=outputs)
    figure = plots.spectra({"full car": S, "twice as rough": 4.0 * S})
    assert_whole(figure)
    labels = ["bacc_cg ((m/s²)²/Hz)", "pitch_acc ((rad/s²)²/Hz)", "sws_fr (mm²/Hz)", "dtl_rl (N²/Hz)"]
    assert [axes.get_ylabel() for axes in figure.axes][:4] == labels
    for axes, output, one in zip(figure.axes, outputs, (1.0, 1.0, 1e-3, 1.0), strict=False):
        np.testing.assert_allclose(axes.lines[1].get_ydata(), 4.0 * S.sel(output=output) / one**2)


def test_axes_say_what_outputs_passed():
    S = ss.psd(ss.QuarterCar(), ROAD, [1.0, 2.0])
    weighted = S.assign_attrs(weighting={"bacc": "Wk"})
    labels = [axes.get_ylabel() for axes in plots.spectra({"a": weighted, "b": 2.0 * weighted}).axes]
    assert labels == ["BAcc through Wk ((m/s²)²/Hz)", "SWS (mm²/Hz)", "DTL (N²/Hz)"]
    assert "Wk" not in plots.spectra({"as it is": S, "through Wk": weighted}).axes[0].get_ylabel()
    runs = pd.DataFrame({"ks": [15e3, 15e3, 25e3, 25e3], "cs": [1000.0, 2000.0, 1000.0, 2000.0]})
    models = {name: ss.Polynomial(degree=1).fit(runs, [1.0, 0.8, 0.9, 0.7]) for name in ("bacc", "sws")}
    cheap = ss.LowFidelity(ss.QuarterCar(), ROAD, weighting="Wk")
    surrogate = SuspensionSurrogate({"ks": "N/m", "cs": "N s/m"}, {"bacc": "m/s^2", "sws": "m"}, models, cheap)
    bars = [plots.fitted_map(surrogate, output).axes[1].get_ylabel() for output in models]
    assert bars == ["bacc through Wk (m/s²)", "sws (m)"]


def test_five_curves_are_refused_not_dropped():
    (name, curve), *_ = plots.study_curves("fr").items()
    with pytest.raises(ValueError, match="at most 4 curves can be told apart, got 5"):
        plots.bode({f"{name} {i}": curve for i in range(5)})


@pytest.mark.parametrize("wrap", [dict, lambda history: {"full": history}, lambda history: [history]])
def test_steering_takes_cars_that_steer_alone(wrap):
    time = np.arange(0.0, 0.1, 0.01)
    with pytest.raises(TypeError, match=r"histories must be a mapping .* of a RideHandlingCar, got"):
        plots.steering(wrap(ss.simulate(ss.FullCar(), 0.0 * time, time)))


def test_area_below_the_spectra_is_the_variance():
    f = np.geomspace(1e-3, 1e3, 4000)
    figure = plots.psd(CARS, ROAD, "rr", f)
    assert_whole(figure)
    assert [axes.get_ylabel() for axes in figure.axes] == ["BAcc ((m/s²)²/Hz)", "DTL (N²/Hz)", "SWS (mm²/Hz)"]
    for j, car in enumerate(CARS.values()):
        ride = ss.ride_metrics(car, ROAD, method="spectral")
        expected = [(ride if j == 0 else ride.sel(point="rr", corner="rr"))[name].item() for name in ("bacc", "sws")]
        for axes, rms in zip([figure.axes[0], figure.axes[2]], [expected[0], 1e3 * expected[1]], strict=True):
            area = np.trapezoid(axes.lines[j].get_ydata(), f)
            np.testing.assert_allclose(np.sqrt(area), rms, rtol=1e-3)
    with pytest.raises(ValueError, match="no corner named 'front'"):
        plots.psd(CARS, ROAD, "front")


@pytest.mark.parametrize(
    "vehicle",
    [ss.FullCar(), ss.PitchHalfCar(), ss.RollHalfCar(arb=9e3), ss.QuarterCar(), ss.RigidTyreQuarterCar()],
    ids=lambda vehicle: type(vehicle).__name__,
)
def test_every_mode_is_a_panel(vehicle):
    figure = plots.mode_shapes(vehicle)
    assert_whole(figure)
    titles = [axes.get_title() for axes in figure.axes if axes.get_title()]
    modes = vehicle.modes()
    assert titles == [
        f"{f:.3g} Hz, ζ = {zeta:.2f}" for f, zeta in zip(modes.frequency, modes.damping_ratio, strict=True)
    ]


def test_symmetric_modes_move_as_their_symmetry_says():
    """With a = b the body modes of a car of equal corners are pure heave, pitch and roll."""
    car = ss.FullCar(a=1.2, b=1.2)
    for mode, what in enumerate(["heave", "pitch", "roll"]):
        axes = plots.mode_shape(car, mode).axes[0]
        outlines = [line.get_xydata()[:4] for line in axes.lines if len(line.get_xydata()) == 5]
        fr, fl, rl, rr = (outlines[1] - outlines[0])[:, 1]
        signs = {"heave": (1, 1, 1), "pitch": (1, -1, -1), "roll": (-1, -1, 1)}[what]
        np.testing.assert_allclose([fl, rl, rr], np.array(signs) * fr, atol=1e-12)
        assert max(map(abs, (fr, fl, rl, rr))) == pytest.approx(0.25)


def test_half_a_cycle_later_a_mode_is_its_mirror():
    def outline(phase):
        lines = plots.mode_shape(ss.FullCar(), 2, phase).axes[0].lines
        rest, moved = (line.get_ydata() for line in lines if len(line.get_ydata()) == 5)
        return moved - rest

    np.testing.assert_allclose(outline(0.4 + np.pi), -outline(0.4), atol=1e-12)
    with pytest.raises(ValueError, match="mode must be 0 to 6 for FullCar, got 7"):
        plots.mode_shape(ss.FullCar(), 7)


@pytest.mark.parametrize("mode", [0, 1])
def test_drawn_displacements_are_those_of_the_mode(mode):
    shape = ss.QuarterCar(cs=2500.0).modes()["shape"][mode]
    axes = plots.mode_shape(ss.QuarterCar(cs=2500.0), mode, 0.7).axes[0]
    bodies = [line.get_ydata()[0] for line in axes.lines if line.get_linewidth() == 3.0]
    wheels = [patch.get_center()[1] for patch in axes.patches]
    expected = 0.25 * (shape[["z_s", "z_u"]] * np.exp(0.7j)).to_numpy().real
    np.testing.assert_allclose(np.diff([bodies, wheels], axis=1)[:, 0], expected, atol=1e-12)


def test_carpet():
    metrics = grid_of_designs()
    figure = plots.carpet(metrics)
    assert_whole(figure)
    axes, bar = figure.axes
    assert (axes.get_xlabel(), axes.get_ylabel(), bar.get_ylabel()) == ("DTL (kN)", "BAcc (m/s²)", "SWS (mm)")
    # Five lines of constant spring over all dampers, six of constant damper over all springs.
    drawn = [line.get_xydata() for line in axes.lines if len(line.get_xydata())]
    assert [len(line) for line in drawn] == [9] * 5 + [5] * 6
    expected = np.column_stack([metrics.dtl.isel(ks=2) / 1e3, metrics.bacc.isel(ks=2)])
    np.testing.assert_allclose(drawn[2], expected)
    np.testing.assert_allclose(drawn[-1][:, 1], metrics.bacc.isel(cs=-1))
    labels = {text.get_text(): text.xy for text in axes.texts}
    assert {"12", "15.2", "25", "0.8", "2.2"} <= set(labels)
    # The springs part where damping is low.
    np.testing.assert_allclose(labels["25"], drawn[4][0])


def test_labels_of_a_folded_carpet_keep_clear_of_its_dots_and_of_each_other():
    ks, cs = (
        xr.DataArray(v, {n: v}, n) for n, v in (("ks", np.linspace(5e3, 4e4, 21)), ("cs", np.geomspace(4e2, 4e3, 21)))
    )
    figure = plots.carpet(ss.ride_metrics(ss.QuarterCar(ks=ks, cs=cs), ROAD))
    figure.draw_without_rendering()
    axes = figure.axes[0]
    (dots,) = axes.collections
    assert len(axes.texts) == 12
    middles = axes.transData.transform(dots.get_offsets())
    for i, text in enumerate(axes.texts):
        box = extent(text)
        assert not any(box.contains(*middle) for middle in middles), text
        assert box.count_overlaps([extent(other) for other in axes.texts[:i]]) == 0, text
        # Beside its end still.
        assert np.hypot(*text.xyann) < 30.0


def test_carpet_of_a_car_needs_one_place():
    metrics = grid_of_designs(ss.FullCar, (3, 3))
    with pytest.raises(ValueError, match="ks and cs alone, got dtl on ks, cs, corner; select one point and one corner"):
        plots.carpet(metrics)
    with pytest.raises(ValueError, match="no metric named 'roll_acc' to draw, available: bacc, dtl, sws"):
        plots.carpet(metrics.sel(point="fr", corner="fr"), x="roll_acc")
    assert_whole(plots.carpet(metrics.sel(point="fr", corner="fr"), x="sws", colour="dtl"))


def test_scenario_scan_puts_what_matters_first():
    figure = plots.scenario_scan(Scan(scanned()))
    assert_whole(figure)
    (axes,) = figure.axes
    rows = [label.get_text() for label in axes.get_yticklabels()]
    assert rows[:7] == ["road class", "B", "A", "C", "speed (m/s)", "10", "20"]
    nearest = {round(line.get_ydata()[0]): line.get_xdata()[0] for line in axes.lines}
    assert [nearest[row] for row in (1, 2, 3, 5, 6)] == [1.0, 10.0, 30.0, 1.0, 2.0]
    assert rows.index("independent") not in nearest
    with pytest.raises(ValueError, match="no scenario of the table has a distance"):
        plots.scenario_scan(Scan(scanned().tail(1)))


def test_road_chart_shows_roads_and_profiles_among_the_classes():
    profile = ss.synthesise(ss.Road.iso8608("B"), 500.0, 0.1)
    figure = plots.road_chart({"measured": profile, "fitted": ss.fit_road(profile), "class D": ss.Road.iso8608("D")})
    assert_whole(figure)
    (axes,) = figure.axes
    assert {text.get_text() for text in axes.texts} == set("ABCDEFGH")
    lines = {line.get_label(): line.get_xydata() for line in axes.lines if not line.get_label().startswith("_")}
    assert set(lines) == {"measured", "fitted", "class D"}
    at = np.interp(np.log(0.1), *np.log(lines["class D"]).T)
    np.testing.assert_allclose(np.exp(at), 1024e-6, rtol=1e-6)
    limits = [line.get_xydata() for line in axes.lines if line.get_color() == "0.6"]
    upper = [np.exp(np.interp(np.log(0.1), *np.log(limit).T)) for limit in limits]
    np.testing.assert_allclose(sorted(upper), 32e-6 * 4.0 ** np.arange(7), rtol=1e-6)
    with pytest.raises(TypeError, match="roads must be Roads or profiles, got 3"):
        plots.road_chart({"one": 3})
    with pytest.raises(ValueError, match=r"road_chart.* needs a road with one"):
        plots.road_chart(ss.Road(roughness=np.array([1e-6, 2e-6])))


def test_pictures_draw_on_given_axes(study):
    curves = plots.study_curves("fr")
    spectra = {"full car": ss.psd(ss.FullCar(), ROAD, [1.0, 10.0]).sel(output=["sws_fr", "bacc_cg"])}
    for draw, shape in [
        (lambda ax: plots.bode(curves, ax), (2, 3)),
        (lambda ax: plots.bode_magnitude(curves, ax), (1, 3)),
        (lambda ax: plots.psd(CARS, ROAD, ax=ax), (1, 3)),
        (lambda ax: plots.spectra(spectra, ax), (1, 2)),
        (lambda ax: plots.mode_shapes(ss.QuarterCar(), ax=ax), (1, 2)),
        (lambda ax: plots.mode_shape(ss.FullCar(), 0, ax=ax), (1, 1)),
        (lambda ax: plots.carpet(grid_of_designs(), ax=ax), (1, 1)),
        (lambda ax: plots.scenario_scan(Scan(scanned()), ax), (1, 1)),
        (lambda ax: plots.error_map(study, "RB", ["dtl"], ax), (1, 1)),
        (lambda ax: plots.road_chart(ROAD, ax), (1, 1)),
    ]:
        figure, axes = own_axes(*shape)
        assert draw(axes) is figure
        assert all(one.has_data() for one in axes.flat)
        with pytest.raises(ValueError, match=f"ax must be one Axes a panel, {shape[0]} x {shape[1]}, got 7"):
            draw(own_axes(1, 7)[1])
    figure, axes = own_axes(1, 2, subplot_kw={"projection": "3d"})
    assert plots.response_surfaces(study, "VB", ["bacc", "sws"], axes) is figure
    with pytest.raises(TypeError, match="ax must be matplotlib Axes, got 3"):
        plots.bode(curves, 3)


def over_a_bump(car, **how):
    return ss.simulate(car, ss.obstacle("bump"), speed=8.0, step=0.004, positions=True, **how)


@pytest.mark.parametrize("car", [ss.QuarterCar(), ss.RigidTyreQuarterCar(), ss.RollHalfCar(), ss.ThreeAxleTruck()])
def test_a_ride_is_drawn_where_everything_is(car):
    history = over_a_bump(car)
    figure = plots.ride(car, history, [1.0, 1.2])
    assert_whole(figure)
    first = next(iter(car.wheels))
    at = history.sel(time=1.2, method="nearest")
    body = at.z_s.sel(point=first) if "point" in at.dims else at.z_s
    hub = at.z_u if "z_u" in at else at.z_r
    hub = hub.sel(corner=first) if "corner" in hub.dims else hub
    large = float(figure.axes[0].get_ylabel().removeprefix("heights × ") if "×" in figure.axes[0].get_ylabel() else 1.0)
    drawn = [line.get_xydata() for line in figure.axes[1].lines]
    # The strut of the first wheel on the right stands from its hub to the body, where the first axle is.
    strut = next(points for points in drawn if len(points) % 3 == 0 and np.isnan(points[2]).all() and len(points) < 30)
    right = [points for points in drawn if len(points) == len(strut) and np.isnan(points[2]).all()][-1]
    np.testing.assert_allclose(right[:2, 0], at.x)
    np.testing.assert_allclose(right[:2, 1], [0.3 + large * hub, 0.95 + large * body])
    felt = figure.axes[-3].lines[0].get_ydata()
    np.testing.assert_allclose(felt, np.atleast_2d(history.bacc)[0])


def test_a_moving_picture_of_a_ride():
    car = ss.FullCar()
    history = over_a_bump(car).isel(time=slice(0, 60))
    animation = plots.ride_animation(car, history, slower=2.0)
    lines = animation._func(30)
    assert len(lines) == 6
    assert lines[0].axes.get_title() == "0.12 s"
    assert lines[0].get_xdata()[0] == pytest.approx(history.x[30])
    animation._draw_was_started = True


@pytest.mark.parametrize(
    ("draw", "error", "words"),
    [
        (lambda car, over: plots.ride(car, over.drop_vars("z_s")), ValueError, "positions=True.* got no z_s"),
        (lambda car, over: plots.ride(car, over.drop_vars("x")), ValueError, "got no x"),
        (lambda car, over: plots.ride(ss.QuarterCar(), over), ValueError, "of this one QuarterCar"),
        (lambda car, over: plots.ride(car, 3), TypeError, "history must be what simulate"),
        (lambda car, over: plots.ride(3, over), TypeError, "vehicle must be one whose body is known"),
        (lambda car, over: plots.ride(car, over.expand_dims("ks")), ValueError, "got dims"),
        (lambda car, over: plots.ride(car, over, [99.0]), ValueError, "instants must be how many, or times from 0 to"),
        (lambda car, over: plots.ride(car, over, 0), ValueError, "instants must be"),
        (lambda car, over: plots.ride_animation(car, over, slower=0.0), ValueError, "slower must be a number > 0"),
    ],
)
def test_rides_that_cannot_be_drawn(draw, error, words):
    car = ss.PitchHalfCar()
    with pytest.raises(error, match=words):
        draw(car, over_a_bump(car))
