"""Comfort by the standards: routes that agree, the standards' arithmetic written out once more, and refusals."""

import dataclasses

import control
import numpy as np
import pytest
import xarray as xr
from hypothesis import given, settings
from hypothesis import strategies as st

import susp_ss as ss
from susp_ss.metrics.comfort import REACTIONS, reaction, spell_time
from susp_ss.responses.records import heights_under

POINTS = {"driver": (0.3, 0.4)}
ROAD = ss.Road.iso8608("C", tracks="isotropic")
CURVED = ss.DamperCurve([-1.0, 0.0, 1.0], [-1200.0, 0.0, 2000.0])


def bump(length=60.0, height=0.05):
    x = np.array([0.0, 5.0, 5.5, 6.0, length])
    z = ("x", np.array([0.0, 0.0, height, 0.0, 0.0]))
    return xr.Dataset({"left": z, "right": z}, {"x": x})


@pytest.mark.parametrize("method", ["covariance", "spectral"])
def test_a_road_by_the_standards_arithmetic(method):
    """ISO 2631-1, 6.5 and 8.2.2.1 for the total value, 6.3.2 for the dose, 9 for sickness; 2002/44/EC, annex B."""
    ride = ss.comfort(ss.FullCar(), ROAD, points=POINTS, duration=7200.0).metrics.sel(point="driver")

    def felt(**weighting):
        found = ss.ride_metrics(ss.FullCar(), ROAD, method=method, weighting=weighting, points=POINTS)
        return [float(found[name].sel(point="driver") if name == "bacc" else found[name]) for name in weighting]

    z, roll, pitch = felt(bacc="Wk", roll_acc="We", pitch_acc="We")
    (sick,) = felt(bacc="Wf")
    expected = {
        "bacc": z,
        "roll_acc": roll,
        "pitch_acc": pitch,
        "total": np.sqrt(z**2 + (0.63 * roll) ** 2 + (0.4 * pitch) ** 2),
        "vdv": (3.0 * z**4 * 7200.0) ** 0.25,
        "evdv": 1.4 * z * 7200.0**0.25,
        "msdv": sick * np.sqrt(7200.0),
        "a8": z / 2.0,
        "a8_action_time": 8.0 * 3600.0 * (0.5 / z) ** 2,
        "a8_limit_time": 8.0 * 3600.0 * (1.15 / z) ** 2,
        "vdv_action_time": (9.1 / z) ** 4 / 3.0,
        "vdv_limit_time": (21.0 / z) ** 4 / 3.0,
    }
    for name, value in expected.items():
        assert float(ride[name]) == pytest.approx(value, rel=1e-3 if method == "spectral" else 1e-12), name
    assert ride.reaction == "uncomfortable"
    assert set(ride) == {*expected, "reaction"}


def test_a_synthesised_profile_comes_to_the_road_s_values():
    """Within the scatter of a record: of the root mean square as `ride_metrics` states it, of the dose about twice."""
    car, road, seconds, step = ss.QuarterCarWithSeat(), ss.Road(), 100.0, 0.005
    z = heights_under(car, road, seconds, step, seed=5)[0]
    x = road.speed * step * np.arange(len(z))
    profile = xr.Dataset({"left": ("x", z), "right": ("x", z)}, {"x": x})
    driven = ss.comfort(car, profile, speed=road.speed, step=step).metrics
    exact = ss.comfort(car, road, duration=float(driven.duration)).metrics
    timed = ss.ride_metrics(car, road, "time", weighting="Wk", duration=seconds, step=step, seed=5)
    scatter = (timed.bacc_stderr / timed.bacc).max().item()
    for name, times in (("bacc", 4.0), ("total", 4.0), ("vdv", 8.0)):
        assert (abs(driven[name] / exact[name] - 1.0) < times * scatter).all(), name
    assert (driven.crest_factor > 3.0).all()
    assert (driven.mtvv > driven.bacc).all()


def test_a_profile_is_its_weighted_records():
    once = ss.comfort(ss.FullCar(), bump(), points=POINTS, speed=10.0).metrics.sel(point="driver")
    history = ss.simulate(ss.FullCar().with_points(POINTS), bump(), speed=10.0)
    t = history.time.values
    z = ss.weighted(history.bacc.sel(point="driver"), t, "Wk")
    pitch = ss.weighted(history.pitch_acc, t, "We")
    sick = ss.weighted(history.bacc.sel(point="driver"), t, "Wf")
    mean = [np.trapezoid(a**2, t) / t[-1] for a in (z, pitch)]
    assert once.duration == pytest.approx(6.0)
    expected = {
        "bacc": np.sqrt(mean[0]),
        "total": np.sqrt(mean[0] + 0.16 * mean[1]),
        "vdv": np.trapezoid(z**4, t) ** 0.25,
        "msdv": np.sqrt(np.trapezoid(sick**2, t)),
        "mtvv": ss.running_rms(z, t).max(),
        "crest_factor": abs(z).max() / np.sqrt(mean[0]),
    }
    for name, value in expected.items():
        assert float(once[name]) == pytest.approx(value, rel=1e-6, abs=1e-12), name
    assert once.bacc.attrs["weighting"] == "Wk"
    assert once.pitch_acc.attrs["weighting"] == "We"


def test_many_designs_over_a_bump():
    cs = xr.DataArray(np.linspace(900.0, 2500.0, 3), dims="cs")
    many = ss.comfort(ss.FullCar(cs=cs), bump(), speed=10.0, step=2e-3).metrics
    one = ss.comfort(ss.FullCar(cs=1700.0), bump(), speed=10.0, step=2e-3).metrics
    for name in ("total", "vdv", "msdv", "mtvv", "crest_factor"):
        np.testing.assert_allclose(many[name].isel(cs=1), one[name], rtol=1e-9, atol=1e-15, err_msg=name)


def test_a_longer_exposure_meets_the_profile_again_and_again():
    once, often = (
        ss.comfort(ss.QuarterCar(), bump(), speed=10.0, duration=seconds).metrics for seconds in (None, 600.0)
    )
    for name, power in (("vdv", 0.25), ("evdv", 0.25), ("msdv", 0.5), ("a8", 0.5), ("bacc", 0.0), ("mtvv", 0.0)):
        assert float(often[name]) == pytest.approx(100.0**power * float(once[name])), name
    for name in ("a8_action_time", "vdv_limit_time"):
        assert float(often[name]) == pytest.approx(float(once[name]))


@given(st.floats(1e-6, 1e-2), st.sampled_from(["a8_action", "a8_limit", "vdv_action", "vdv_limit"]))
@settings(max_examples=12)
def test_permitted_times_reach_their_values(roughness, which):
    dose, _ = which.split("_")
    value = {"a8_action": 0.5, "a8_limit": 1.15, "vdv_action": 9.1, "vdv_limit": 21.0}[which]
    road = ss.Road(roughness=roughness)
    seconds = float(ss.comfort(ss.QuarterCar(), road).metrics[f"{which}_time"])
    assert float(ss.comfort(ss.QuarterCar(), road, duration=seconds).metrics[dose]) == pytest.approx(value)


@given(st.floats(0.0, 10.0))
def test_words_are_all_whose_band_holds_the_value(total):
    words = [word for word, low, high in REACTIONS if low <= total < high]
    assert reaction(xr.DataArray(total)) == " or ".join(words)


@pytest.mark.parametrize(
    ("total", "words"),
    # ISO 2631-1:1997, C.2.3.
    [
        (0.3, "not uncomfortable"),
        (0.4, "a little uncomfortable"),
        (0.55, "a little uncomfortable or fairly uncomfortable"),
        (0.7, "fairly uncomfortable"),
        (1.1, "uncomfortable"),
        (1.4, "uncomfortable or very uncomfortable"),
        (1.8, "very uncomfortable"),
        (9.0, "extremely uncomfortable"),
    ],
)
def test_the_standard_s_words(total, words):
    assert reaction(xr.DataArray(total)) == words


def test_sweeps_in_memory_and_lazily():
    speed = xr.DataArray(np.array([10.0, 20.0, 30.0]), dims="speed", coords={"speed": [10.0, 20.0, 30.0]})
    cs = xr.DataArray(np.linspace(900.0, 2500.0, 4), dims="cs")
    memory = ss.comfort(ss.FullCar(cs=cs), dataclasses.replace(ROAD, speed=speed), points=POINTS)
    assert dict(memory.metrics.total.sizes) == {"cs": 4, "speed": 3, "point": 6}
    one = ss.comfort(ss.FullCar(cs=900.0), dataclasses.replace(ROAD, speed=20.0), points=POINTS).metrics
    there = memory.metrics.isel(cs=0, speed=1)
    for name, data in one.items():
        if name == "reaction":
            assert (there[name] == data).all()
        else:
            np.testing.assert_allclose(there[name], data, rtol=1e-10, err_msg=name)
    lazy = ss.comfort(ss.FullCar(cs=cs.chunk(cs=2)), dataclasses.replace(ROAD, speed=speed), points=POINTS).metrics
    assert lazy.total.chunks is not None
    xr.testing.assert_allclose(lazy.compute().drop_vars("reaction"), memory.metrics.drop_vars("reaction"))
    assert (lazy.reaction == memory.metrics.reaction).all()
    assert len(memory.table) == 4 * 3 * 6


@pytest.mark.parametrize(
    ("car", "axes"),
    [
        (ss.QuarterCar(), {"bacc"}),
        (ss.RigidTyreQuarterCar(), {"bacc"}),
        (ss.PitchHalfCar(), {"bacc", "pitch_acc"}),
        (ss.RollHalfCar(), {"bacc", "roll_acc"}),
        (ss.RideHandlingCar(), {"bacc", "roll_acc", "pitch_acc"}),
        (ss.FullCar().with_seats({"driver": ss.Seat(x=0.3, y=0.4)}), {"bacc", "roll_acc", "pitch_acc"}),
        (ss.ThreeAxleTruck(), {"bacc", "roll_acc", "pitch_acc"}),
        (ss.QuarterCar(cs=CURVED), {"bacc"}),
    ],
    ids=lambda value: type(value).__name__,
)
def test_any_vehicle_on_a_road_and_over_a_bump(car, axes):
    for ride in (ss.comfort(car, ss.Road(tracks="isotropic")), ss.comfort(car, bump(), speed=10.0, step=2e-3)):
        assert axes <= set(ride.metrics)
        assert {"bacc", "roll_acc", "pitch_acc"} & set(ride.metrics) == axes
        assert np.isfinite(ride.metrics.total).all()
        assert (ride.metrics.total > 0.0).all()
        assert all("units" in data.attrs and "long_name" in data.attrs for data in ride.metrics.values())
        assert len(ride.table) == ride.metrics.total.size
        assert "total value" in repr(ride)


def test_a_linearised_ride_says_so():
    assert "statistically linearised" in ss.comfort(ss.QuarterCar(cs=CURVED), ss.Road()).metrics.attrs["comment"]


def test_a_system_s_own_vertical_acceleration():
    car = ss.FullCar()
    system = car.state_space(input="velocity")
    asked = ss.LinearVehicle(system, like=car)
    np.testing.assert_allclose(ss.comfort(asked, ROAD).metrics.total, ss.comfort(car, ROAD).metrics.total, rtol=1e-8)


def test_another_weighting_by_output():
    british = ss.comfort(ss.FullCar(), ROAD, weighting={"bacc": "Wb"}).metrics
    own = ss.comfort(ss.FullCar(), ROAD, weighting={"bacc": ss.weighting("Wb")}).metrics
    assert british.bacc.attrs["weighting"] == "Wb"
    np.testing.assert_allclose(british.total, own.total, rtol=1e-12)
    standard = ss.comfort(ss.FullCar(), ROAD).metrics
    np.testing.assert_allclose(british.roll_acc, standard.roll_acc, rtol=1e-12)
    assert (british.bacc != standard.bacc).all()


def test_a_level_road_is_comfortable_for_ever():
    level = ss.comfort(ss.QuarterCar(), bump(height=0.0), speed=10.0).metrics
    assert level.total == 0.0
    assert level.reaction == "not uncomfortable"
    assert np.isinf(level.a8_action_time)
    assert np.isnan(level.crest_factor)


def test_times_in_words():
    assert [spell_time(seconds) for seconds in (59.0, 60.0, 3600.0, 86400.0, np.inf)] == [
        "59 s",
        "1 min",
        "1 h",
        "24 h",
        "> 24 h",
    ]


NO_BODY = ss.LinearVehicle(control.ss([[-1.0]], [[1.0]], [[1.0]], [[0.0]], inputs=["dz_r"], outputs=["gap"]))


@pytest.mark.parametrize(
    ("call", "error", "words"),
    [
        (lambda: ss.comfort(None, ROAD), TypeError, "vehicle must be one of the package's vehicles"),
        (lambda: ss.comfort(ss.QuarterCar(), None), TypeError, "road must be a Road, or a profile"),
        (lambda: ss.comfort(ss.QuarterCar(), bump().left, speed=9.0), TypeError, "or a profile with left and right"),
        (lambda: ss.comfort(ss.QuarterCar(), ROAD, duration=0.0), ValueError, "duration must be > 0 s"),
        (lambda: ss.comfort(ss.QuarterCar(), ROAD, duration="8 h"), TypeError, "duration must be a number > 0 s"),
        (lambda: ss.comfort(ss.QuarterCar(), ROAD, speed=20.0), ValueError, "speed and step are for a profile"),
        (lambda: ss.comfort(ss.QuarterCar(), bump()), ValueError, "speed must be given on a profile"),
        (lambda: ss.comfort(ss.QuarterCar(), ROAD, weighting="Wk"), TypeError, "weighting must be by output"),
        (lambda: ss.comfort(ss.QuarterCar(), ROAD, weighting={"sws": "Wk"}), ValueError, "no acceleration named 'sws'"),
        (lambda: ss.comfort(ss.QuarterCar(), ROAD, weighting={"bacc": "Wx"}), ValueError, "no weighting named 'Wx'"),
        (lambda: ss.comfort(ss.QuarterCar(), bump(), weighting={"bacc": 1}, speed=9.0), TypeError, "must be a name"),
        (lambda: ss.comfort(ss.QuarterCar(), ROAD, weighting={"bacc": None}), TypeError, "weighting of bacc must be"),
        (lambda: ss.comfort(ss.QuarterCar(), ROAD, points=POINTS), ValueError, "moves as one point"),
        (lambda: ss.comfort(NO_BODY, ROAD), ValueError, "comfort needs a vertical acceleration.*got gap"),
    ],
)
def test_what_has_no_comfort(call, error, words):
    with pytest.raises(error, match=words):
        call()
