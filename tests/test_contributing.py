"""CONTRIBUTING's recipes, carried out as written, in modules outside the package."""

import importlib.util
import re
import sys
from pathlib import Path

import control
import numpy as np
import pytest
import scipy.linalg

import susp_ss as ss
from susp_ss.fit.formulas import closed_form
from susp_ss.fit.low_fidelity import LowFidelityResponse

TEXT = (Path(__file__).parents[1] / "CONTRIBUTING.md").read_text(encoding="utf-8")
RECIPES = dict(re.findall(r"```python\n# (\w+)\.py\n(.*?)```", TEXT, flags=re.DOTALL))


@pytest.fixture(scope="module")
def recipe(tmp_path_factory):
    """Return the module that a recipe makes."""
    folder, made = tmp_path_factory.mktemp("recipes"), {}

    def of(name):
        if name not in made:
            path = folder / f"{name}.py"
            path.write_text(RECIPES[name], encoding="utf-8")
            spec = importlib.util.spec_from_file_location(name, path)
            made[name] = sys.modules[name] = importlib.util.module_from_spec(spec)
            spec.loader.exec_module(made[name])
        return made[name]

    yield of
    for name in made:
        del sys.modules[name]


def agree(vehicle, road, rtol=1e-6):
    """The three routes to every metric of a vehicle."""
    exact = ss.ride_metrics(vehicle, road)
    spectral = ss.ride_metrics(vehicle, road, method="spectral")
    simulated = ss.ride_metrics(vehicle, road, method="time", duration=200.0, seed=3)
    for name, data in exact.items():
        np.testing.assert_allclose(spectral[name], data, rtol=rtol, atol=1e-12, err_msg=name)
        assert (abs(simulated[name] - data) <= 5.0 * simulated[f"{name}_stderr"] + 1e-12).all(), name
    return exact


def test_there_is_a_recipe_for_each():
    assert list(RECIPES) == ["seated", "wheel_acceleration", "undulating"]


# A vehicle


def test_a_new_vehicle_has_every_route(recipe):
    car = recipe("seated").SeatedQuarterCar(cs=1300.0)
    metrics = agree(car, ss.Road.iso8608("C", speed=15.0))
    assert metrics.bacc.point.values.tolist() == ["body", "driver"]
    assert metrics.sws.dims == ()
    assert len(car.natural_frequencies()) == 4


def test_a_new_vehicle_obeys_its_equations(recipe):
    """Newton's second law of four masses, one on the other, written out in the road's frame."""
    car, road = recipe("seated").SeatedQuarterCar(md=80.0, kd=25e3), ss.Road()
    M = np.diag([car.mu, car.ms, car.mf, car.md])

    def chain(below, *rates):
        matrix = np.diag([below + rates[0], rates[0] + rates[1], rates[1] + rates[2], rates[2]])
        return matrix - np.diag(rates, 1) - np.diag(rates, -1)

    K, C = chain(car.kt, car.ks, car.kf, car.kd), chain(0.0, car.cs, car.cf, car.cd)
    on_K, on_C = (np.linalg.solve(M, matrix) for matrix in (K, C))
    A = np.block([[np.zeros((4, 4)), np.eye(4)], [-on_K, -on_C]])
    B = np.r_[-np.ones(4), np.zeros(4)]
    X = scipy.linalg.solve_continuous_lyapunov(A, -road.intensity * np.outer(B, B))
    metrics, driver = ss.ride_metrics(car, road), np.r_[-on_K[3], -on_C[3]]
    np.testing.assert_allclose(float(metrics.bacc.sel(point="driver")) ** 2, driver @ X @ driver, rtol=1e-9)
    np.testing.assert_allclose(float(metrics.dtl) ** 2, car.kt**2 * X[0, 0], rtol=1e-9)


def test_a_new_vehicle_goes_wherever_a_vehicle_goes(recipe):
    car, road = recipe("seated").SeatedQuarterCar(), ss.Road()
    cars = type(car)(kd=np.array([20e3, 35e3, 50e3]), cs=np.array([1e3, 1516.5, 2e3]))
    swept = ss.ride_metrics(cars, road)
    np.testing.assert_allclose(swept.bacc.isel(design=1), ss.ride_metrics(car, road).bacc, rtol=1e-12)
    step = 1e-4
    ends = [ss.ride_metrics(type(car)(kd=car.kd * (1 + h)), road).bacc for h in (-step, step)]
    slope = ss.sensitivity(car, road, ["kd"]).bacc.squeeze("parameter")
    np.testing.assert_allclose(slope, (ends[1] - ends[0]) / (2 * step * car.kd), rtol=1e-6)
    response = ss.Response(car, road, "bacc", at="driver", inputs=("kd", "cs"))
    np.testing.assert_allclose(response([[car.kd, car.cs]]), ss.ride_metrics(car, road).bacc.sel(point="driver"))
    system = car.state_space(input="velocity")
    norm = control.norm(system["bacc_driver", "dz_r"], 2)
    np.testing.assert_allclose(norm * np.sqrt(road.intensity), float(response([[car.kd, car.cs]])[0]), rtol=1e-6)
    assert len(ss.plots.mode_shapes(car).axes) == 4
    heavy = type(car)(md=1e6).natural_frequencies()
    assert heavy[0] < 0.1
    with pytest.raises(ValueError, match=r"SeatedQuarterCar\(kd=...\) must be > 0 N/m, got -1.0"):
        type(car)(kd=-1.0)
    with pytest.raises(ValueError, match=r"a file holds one of full, quarter, .*, got a SeatedQuarterCar"):
        ss.vehicles.files.vehicle_text(car)


def test_an_undamped_seat_is_told_by_its_eigenvalues(recipe):
    car = recipe("seated").SeatedQuarterCar
    assert np.isfinite(ss.ride_metrics(car(cd=0.0), ss.Road()).bacc).all()
    with pytest.raises(ValueError, match="no damper reaches"):
        ss.ride_metrics(car(cs=0.0, cf=0.0, cd=0.0), ss.Road())


def test_a_quarter_car_with_a_seat_has_no_quarter_car_s_closed_form(recipe):
    seated = recipe("seated").SeatedQuarterCar

    class Derived(ss.QuarterCar):
        """A quarter car by name, with a seat."""

        def linkage(self):
            return seated(ms=self.ms, mu=self.mu, ks=self.ks, cs=self.cs, kt=self.kt).linkage()

    columns = ("ks", "cs")
    assert closed_form(LowFidelityResponse(ss.QuarterCar(), ss.Road(), "sws", None, columns)) is not None
    assert closed_form(LowFidelityResponse(Derived(), ss.Road(), "sws", None, columns)) is None
    assert Derived().halves() == ()
    np.testing.assert_allclose(
        ss.ride_metrics(Derived(), ss.Road()).sws, ss.ride_metrics(seated(), ss.Road()).sws, rtol=1e-12
    )


# A metric


@pytest.mark.parametrize("road", [ss.Road(), ss.Road(tracks="isotropic", speed=30.0)], ids=["identical", "isotropic"])
def test_a_new_metric_has_every_route(recipe, road):
    car = recipe("wheel_acceleration").FullCar(arb_front=10e3)
    metrics = agree(car, road, rtol=1e-6 if road.tracks == "identical" else 1e-3)
    assert list(metrics)[-1] == "wheel_acc"
    assert metrics.wheel_acc.dims == ("corner",)
    assert metrics.wheel_acc.attrs == {"units": "m/s^2", "long_name": "RMS wheel vertical acceleration"}
    plain = ss.ride_metrics(ss.FullCar(arb_front=10e3), road)
    for name, data in plain.items():
        np.testing.assert_allclose(metrics[name], data, rtol=1e-9)


def test_a_new_metric_is_newton_s(recipe):
    """The wheel's acceleration is what the tyre gives less what the suspension takes."""
    car = recipe("wheel_acceleration").FullCar()
    time = np.arange(0.0, 2.0, 0.002)
    history = ss.simulate(car, 0.03 * np.sin(12.0 * time) * (time > 0.1), time)
    suspension = car.ks * history.sws + car.cs * history.sws.differentiate("time")
    expected = (history.dtl - suspension) / car.mu
    np.testing.assert_allclose(history.wheel_acc[:, 80:-5], expected[:, 80:-5], atol=0.02 * float(expected.max()))


# A road


@pytest.mark.parametrize("tracks", ["identical", "independent", "isotropic"])
@pytest.mark.parametrize("cutoff", [0.0, 0.01])
def test_a_new_road_has_every_route(recipe, tracks, cutoff):
    road = recipe("undulating").UndulatingRoad(tracks=tracks, cutoff=cutoff)
    agree(ss.FullCar(arb_rear=5e3), road, rtol=1e-3 if tracks == "isotropic" else 1e-6)


def test_a_new_road_without_more_is_the_road(recipe):
    plain = recipe("undulating").UndulatingRoad(more=0.0, tracks="isotropic")
    metrics, expected = (ss.ride_metrics(ss.FullCar(), road) for road in (plain, ss.Road(tracks="isotropic")))
    for name, data in expected.items():
        np.testing.assert_allclose(metrics[name], data, rtol=1e-12)


def test_a_new_road_is_no_power_law_for_anyone(recipe):
    """Neither the shortcut over speeds nor the spreadsheet's formula takes it for one."""
    road = recipe("undulating").UndulatingRoad()
    response = ss.Response(ss.QuarterCar(), road, "bacc", inputs=("ks", "speed"))
    for speed in (10.0, 35.0):
        alone = recipe("undulating").UndulatingRoad(speed=speed)
        np.testing.assert_allclose(response([[2e4, speed]]), ss.ride_metrics(ss.QuarterCar(ks=2e4), alone).bacc)
    assert closed_form(LowFidelityResponse(ss.QuarterCar(), road, "bacc", None, ("ks", "cs"))) is None
    slope = ss.sensitivity(ss.FullCar(), road, ["speed"]).bacc.squeeze("parameter")
    fast, slow = (
        ss.ride_metrics(ss.FullCar(), recipe("undulating").UndulatingRoad(speed=speed)).bacc for speed in (20.01, 19.99)
    )
    np.testing.assert_allclose(slope, (fast - slow) / 0.02, rtol=1e-5)


def test_a_road_that_is_white_nowhere_has_a_velocity_of_finite_variance(recipe):
    class Smooth(recipe("undulating").UndulatingRoad):
        def psd(self, n):
            return super().psd(n) - ss.Road.psd(self, n)

        def first_order(self):
            _, rates, weights = super().first_order()
            return 0.0, rates, weights

    agree(ss.FullCar(ct=200.0), Smooth(cutoff=0.002))
