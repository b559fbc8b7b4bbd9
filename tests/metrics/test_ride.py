"""The labelled results, sweeps, and the bridge to surrogates."""

import numpy as np
import pytest
import xarray as xr

import susp_ss as ss
from models import UNEQUAL, VEHICLES

ROAD = ss.Road(tracks="isotropic")
SHAPES = {
    "rigid tyre": ((), (), set()),
    "quarter": ((), (), set()),
    "pitch half": (("cg", "f", "r"), ("f", "r"), {"pitch_acc"}),
    "roll half": (("cg", "r", "l"), ("r", "l"), {"roll_acc"}),
    "full": (("cg", "fr", "fl", "rr", "rl"), ("fr", "fl", "rr", "rl"), {"pitch_acc", "roll_acc"}),
}


@pytest.mark.parametrize("method", ["covariance", "spectral", "time"])
@pytest.mark.parametrize("name", SHAPES)
def test_layout(name, method):
    points, corners, rotations = SHAPES[name]
    metrics = ss.ride_metrics(VEHICLES[name], ROAD, method=method, duration=5.0)
    rigid = isinstance(VEHICLES[name], ss.RigidTyreQuarterCar)
    expected = (
        {"bacc", "sws", "dtl", "damper_power", "sws_rate"} | rotations | (set() if rigid else {"tyre_deflection"})
    )
    assert set(metrics) == expected | ({f"{name}_stderr" for name in expected} if method == "time" else set())
    assert metrics.bacc.dims == (("point",) if points else ())
    assert metrics.sws.dims == metrics.dtl.dims == metrics.damper_power.dims == (("corner",) if corners else ())
    if points:
        assert tuple(metrics.point.values) == points
        assert tuple(metrics.corner.values) == corners
    units = {
        "bacc": "m/s^2",
        "sws": "m",
        "dtl": "N",
        "damper_power": "W",
        "tyre_deflection": "m",
        "sws_rate": "m/s",
        "pitch_acc": "rad/s^2",
        "roll_acc": "rad/s^2",
    }
    for variable in expected:
        assert metrics[variable].attrs["units"] == units[variable]
        assert metrics[variable].attrs["long_name"]


def test_labelled_sweep():
    ks = xr.DataArray([15e3, 20e3, 25e3], dims="ks", coords={"ks": [15e3, 20e3, 25e3]})
    cs = xr.DataArray([1000.0, 2000.0], dims="cs", coords={"cs": [1000.0, 2000.0]})
    metrics = ss.ride_metrics(ss.FullCar(ks=ks, cs=cs), ROAD)
    assert metrics.bacc.dims == ("ks", "cs", "point")
    assert metrics.roll_acc.dims == ("ks", "cs")
    one = ss.ride_metrics(ss.FullCar(ks=20e3, cs=2000.0), ROAD)
    for name in one:
        np.testing.assert_allclose(metrics[name].sel(ks=20e3, cs=2000.0), one[name], rtol=1e-10)


@pytest.mark.parametrize(
    "changes",
    [
        {"cs": np.array([1000.0, 2000.0])},
        {"ks": ss.Corners(fr=np.array([15e3, 20e3]), fl=18e3, rr=np.array([22e3, 21e3]), rl=20e3)},
        {"a": np.array([0.9, 1.1]), "arb_rear": np.array([0.0, 1e4])},
        {"mb": np.array([1000.0, 1500.0]), "ct": np.array([0.0, 100.0])},
        {"cs": ss.Corners.axles(front=np.array([0.0, 1500.0]), rear=1500.0)},
    ],
)
def test_every_design_of_a_sweep_is_the_single_car(changes):
    def pick(value, i):
        if isinstance(value, ss.Corners):
            return ss.Corners(**{name: pick(getattr(value, name), i) for name in ("fr", "fl", "rr", "rl")})
        return float(value[i]) if isinstance(value, np.ndarray) else value

    metrics = ss.ride_metrics(ss.FullCar(**changes), ROAD)
    for i in range(2):
        one = ss.ride_metrics(ss.FullCar(**{name: pick(value, i) for name, value in changes.items()}), ROAD)
        for name in one:
            np.testing.assert_allclose(metrics[name][i], one[name], rtol=1e-9, atol=1e-9)


def test_plain_arrays_broadcast_as_numpy_does():
    car = ss.QuarterCar(ks=np.array([[15e3], [20e3]]), cs=np.array([1000.0, 1500.0, 2000.0]))
    metrics = ss.ride_metrics(car, ROAD)
    assert metrics.sws.dims == ("design_0", "design_1")
    assert metrics.sws.shape == (2, 3)
    np.testing.assert_allclose(metrics.sws[1, 2], ss.ride_metrics(ss.QuarterCar(ks=20e3, cs=2000.0), ROAD).sws)


def test_inputs_are_untouched():
    ks = np.array([15e3, 20e3])
    before = ks.copy()
    ss.ride_metrics(ss.FullCar(ks=ks), ROAD)
    np.testing.assert_array_equal(ks, before)


@pytest.mark.parametrize(
    ("criterion", "at"), [("dtl", "rr"), ("bacc", "cg"), ("damper_power", "fl"), ("roll_acc", None)]
)
def test_response_is_the_metric(criterion, at):
    X = np.array([[15e3, 1200.0], [20e3, 1500.0]])
    response = ss.Response(ss.FullCar(), ROAD, criterion, at=at)
    metric = ss.ride_metrics(ss.FullCar(ks=X[:, 0], cs=X[:, 1]), ROAD)[criterion]
    np.testing.assert_array_equal(response(X), metric.sel({metric.dims[-1]: at}) if at else metric)


def test_response_with_parameter():
    X = np.array([[15e3, 1200.0], [20e3, 1500.0]])
    response = ss.Response(ss.QuarterCar(), ROAD, "bacc", parameter="ms")
    assert response.parameter_value == 317.5
    np.testing.assert_array_equal(response(X), response(X, 317.5))
    np.testing.assert_array_equal(
        response(X, 200.0), ss.ride_metrics(ss.QuarterCar(ks=X[:, 0], cs=X[:, 1], ms=200.0), ROAD).bacc
    )


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ({"criterion": "comfort"}, "no criterion named 'comfort', available: bacc"),
        ({"criterion": "sws"}, "no corner named None, available: fr, fl, rr, rl"),
        ({"criterion": "sws", "at": "rear"}, "no corner named 'rear', available: fr, fl, rr, rl"),
        ({"criterion": "bacc", "at": "x"}, "no point named 'x', available: cg, fr"),
        ({"criterion": "pitch_acc", "at": "fr"}, "one place only"),
        ({"at": "fr", "inputs": ("k",)}, "no parameter named 'k', available: mb"),
        ({"at": "fr", "inputs": ()}, "different fields"),
        ({"at": "fr", "inputs": ("ks", "ks")}, "different fields"),
        ({"at": "fr", "parameter": "ks"}, "different fields"),
    ],
)
def test_bad_responses(arguments, words):
    with pytest.raises(ValueError, match=words):
        ss.Response(ss.FullCar(), ROAD, **arguments)


def test_response_honours_column_names():
    import pandas as pd

    response = ss.Response(ss.QuarterCar(), ROAD, "dtl")
    X = pd.DataFrame({"cs": [1200.0, 1500.0], "ks": [15e3, 20e3]})
    np.testing.assert_array_equal(response(X), response(X[["ks", "cs"]].to_numpy()))
    with pytest.raises(ValueError, match="X must have the columns ks, cs, got a, b"):
        response(X.set_axis(["a", "b"], axis=1))


def test_bad_response_calls():
    tuned = ss.Response(ss.QuarterCar(), ROAD, parameter="ms")
    with pytest.raises(ValueError, match="one number or one a design"):
        tuned([[18e3, 1500.0]], [300.0, 310.0])
    for arguments in ({"criterion": ["bacc"]}, {"inputs": None}):
        with pytest.raises(TypeError, match=r"criterion must be|sequence of field names"):
            ss.Response(ss.QuarterCar(), ROAD, **arguments)
    response = ss.Response(ss.QuarterCar(), ROAD)
    with pytest.raises(ValueError, match="columns ks, cs"):
        response([[1.0, 2.0, 3.0]])
    with pytest.raises(ValueError, match="names no parameter"):
        response([[18e3, 1500.0]], 300.0)
    with pytest.raises(ValueError, match="must be > 0 N/m"):
        response([[-1.0, 1500.0]])
    with pytest.raises(TypeError, match="X must be numbers"):
        response([["soft", "light"]])
    with pytest.raises(TypeError, match="sequence of field names"):
        ss.Response(ss.QuarterCar(), ROAD, inputs="ks")
    with pytest.raises(ValueError, match="one number for every parameter"):
        ss.Response(ss.QuarterCar(ks=np.array([1e4, 2e4])), ROAD)
    with pytest.raises(TypeError, match="vehicle must be"):
        ss.Response("car", ROAD)


def test_bad_metric_calls():
    with pytest.raises(TypeError, match="vehicle must be one of"):
        ss.ride_metrics(None, ROAD)
    with pytest.raises(TypeError, match="road must be a Road"):
        ss.ride_metrics(ss.QuarterCar(), "B")
    with pytest.raises(ValueError, match="covariance, spectral, time, got 'montecarlo'"):
        ss.ride_metrics(ss.QuarterCar(), ROAD, method="montecarlo")
    for function in (ss.covariance, ss.psd):
        with pytest.raises(TypeError, match="vehicle must be one of"):
            function(None, ROAD, *([[1.0]] if function is ss.psd else []))
        with pytest.raises(TypeError, match="road must be a Road"):
            function(ss.QuarterCar(), None, *([[1.0]] if function is ss.psd else []))
    with pytest.raises(TypeError, match="vehicle must be one of"):
        ss.frequency_response(3, [1.0])
    with pytest.raises(TypeError, match="vehicle must be one of"):
        ss.simulate(3, [0.0], [1.0])


def test_full_car_with_unequal_corners_differs_at_every_corner():
    metrics = ss.ride_metrics(ss.FullCar(**UNEQUAL), ROAD)
    assert len(set(np.round(metrics.sws.values, 9))) == 4


def test_a_result_changed_by_its_owner_changes_no_other():
    car, road = ss.FullCar(), ss.Road()
    changed = ss.ride_metrics(car, road)
    expected = changed.copy(deep=True)
    changed.bacc.attrs["units"], changed.attrs["said"], changed.corner.attrs["said"] = "g", "mine", "mine"
    changed["sws"][:] = 0.0
    changed.coords["point"] = [str(i) for i in range(5)]
    xr.testing.assert_identical(ss.ride_metrics(car, road), expected)
