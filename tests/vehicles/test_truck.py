"""Three axles: every route, step answers summed without any cross-correlation, reductions to cars, files, refusals."""

import json

import control
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import models
import oracles
import susp_ss as ss
from susp_ss.vehicles.files import read_vehicle, vehicle_text

TRUCKS = {
    "symmetric": ss.ThreeAxleTruck(),
    "bars": ss.ThreeAxleTruck(arb_front=2e5, arb_middle=1e5, arb_rear=3e5, middle=-0.4),
    "unequal": ss.ThreeAxleTruck(
        ks=(2.3e5, 2.6e5, 5e5, 5.6e5, 5.2e5, 6.1e5),
        cs=(9e3, 1.1e4, 1.3e4, 1.6e4, 1.8e4, 1.5e4),
        kt=(0.9e6, 1.0e6, 1.8e6, 1.7e6, 1.9e6, 1.6e6),
        mu=(250.0, 280.0, 500.0, 560.0, 530.0, 600.0),
        arb_rear=2e5,
    ),
}
UNDER = {"right": ("fr", "mr", "rr"), "left": ("fl", "ml", "rl")}

ROADS = {name: models.ROADS[name] for name in models.ROADS if name != "isotropic, slow"} | {
    "waviness": ss.Road(waviness=2.5, tracks="independent"),
    "middle axle, cut-off": ss.Road(wheels=("mr", "ml"), tracks="independent", cutoff=0.02),
    "two axles, identical, cut-off": ss.Road(wheels=("mr", "ml", "rr", "rl"), cutoff=0.02),
}


def written(truck):
    """The truck by the oracle."""
    ahead = (truck.a, -truck.middle, -truck.b)
    each = (truck.at_wheels(name) for name in ("mu", "ks", "cs", "kt", "ct"))
    bars = (truck.arb_front, truck.arb_middle, truck.arb_rear)
    return oracles.truck_matrices(truck.mb, truck.ixx, truck.iyy, ahead, truck.c, truck.wheels, *each, bars)


def flat(metrics):
    return {
        f"{name}_{place}" if place else name: float(data.sel({data.dims[0]: place}) if place else data)
        for name, data in metrics.items()
        for place in (data.coords[data.dims[0]].values if data.dims else [""])
    }


@pytest.mark.parametrize("road", ROADS.values(), ids=ROADS.keys())
@pytest.mark.parametrize("truck", TRUCKS.values(), ids=TRUCKS.keys())
def test_routes_agree(truck, road):
    exact, spectral = ss.ride_metrics(truck, road), ss.ride_metrics(truck, road, method="spectral")
    rtol = 1e-3 if road.tracks == "isotropic" else 1e-5 if road.waviness != 2.0 else 1e-6
    for name, data in exact.items():
        np.testing.assert_allclose(spectral[name], data, rtol=rtol, atol=1e-7, err_msg=name)


@pytest.mark.parametrize("truck", TRUCKS.values(), ids=TRUCKS.keys())
def test_time_route_agrees(truck):
    road = ss.Road(tracks="independent", speed=25.0)
    exact = ss.ride_metrics(truck, road)
    simulated = ss.ride_metrics(truck, road, method="time", duration=100.0, step=0.004, seed=4)
    for name in ("bacc", "sws", "dtl", "pitch_acc", "roll_acc"):
        assert (abs(simulated[name] - exact[name]) <= 5.0 * simulated[f"{name}_stderr"]).all(), name


@pytest.mark.parametrize("speed", [4.0, 20.0])
@pytest.mark.parametrize("tracks", ["identical", "independent"])
@pytest.mark.parametrize("truck", TRUCKS.values(), ids=TRUCKS.keys())
def test_one_step_after_another(truck, tracks, speed):
    road, model = ss.Road(tracks=tracks, speed=speed), written(truck)
    lags = {name: truck.axles[axle] / speed for name, (axle, _) in truck.wheels.items()}
    alone = UNDER.values() if tracks == "independent" else [tuple(truck.wheels)]
    expected = oracles.metrics(model, oracles.variance_impulses(model, lags, alone, road.intensity))
    ours = flat(ss.ride_metrics(truck, road))
    assert ours.keys() == expected.keys()
    for name, value in expected.items():
        np.testing.assert_allclose(ours[name], value, rtol=1e-9, atol=1e-7, err_msg=name)


def test_the_oracle_of_steps_knows_cars():
    """On two axles it is the other oracle, which has cross-correlations."""
    car, road = models.VEHICLES["full, unequal corners"], ss.Road(tracks="independent", speed=13.0)
    model = models.oracle(car)
    lags = {name: car.axles[axle] / road.speed for name, (axle, _) in car.wheels.items()}
    steps = oracles.variance_impulses(model, lags, [("fr", "rr"), ("fl", "rl")], road.intensity)
    expected = oracles.variance_lyapunov_delay(model, models.oracle_road(road))
    for name, value in expected.items():
        np.testing.assert_allclose(steps[name], float(value), rtol=1e-9, err_msg=name)


def test_frequency_response_is_newton_s():
    f, truck = np.geomspace(0.2, 30.0, 20), TRUCKS["unequal"]
    ours, expected = ss.frequency_response(truck, f), oracles.frequency_response(written(truck), f)
    for i, name in enumerate(ours.output.values):
        np.testing.assert_allclose(ours.sel(output=name), expected[name], rtol=1e-8, atol=1e-9 * abs(ours[i]).max())


CAR = ss.FullCar(
    mb=15e3, ixx=18e3, iyy=60e3, a=3.0, b=1.8, c=1.0, mu=400.0, ks=4e5, cs=15e3, kt=1.2e6, arb_rear=1e5
)  # fmt: skip


def truck_like(car, **more):
    """A truck whose first and last axles are a car's."""
    names = ("mb", "ixx", "iyy", "a", "b", "c", "arb_front", "arb_rear")
    return ss.ThreeAxleTruck(**{name: getattr(car, name) for name in names}, middle=0.5, **more)


@pytest.mark.parametrize("road", [ss.Road(), ss.Road(tracks="independent"), ss.Road(cutoff=0.01)])
def test_an_axle_that_carries_nothing_leaves_a_car(road):
    soft = truck_like(CAR, mu=400.0, ks=(4e5, 0.01, 4e5), cs=(15e3, 0.01, 15e3), kt=1.2e6, ct=(0.0, 2e4, 0.0))
    truck, car = ss.ride_metrics(soft, road), ss.ride_metrics(CAR, road)
    for name in ("bacc", "pitch_acc", "roll_acc"):
        data = car[name].sel(point=["cg", "fr", "fl", "rr", "rl"]) if name == "bacc" else car[name]
        own = truck[name].sel(point=data.point) if name == "bacc" else truck[name]
        np.testing.assert_allclose(own, data, rtol=1e-5, atol=1e-9)
    for name in ("sws", "dtl", "damper_power"):
        np.testing.assert_allclose(truck[name].sel(corner=car.corner), car[name], rtol=1e-5)


@pytest.mark.parametrize("tracks", ["identical", "independent"])
@settings(max_examples=8)
@given(share=st.floats(0.2, 0.8), arb=st.floats(0.0, 2e5))
def test_an_axle_in_two_halves_at_one_place_is_one(tracks, share, arb):
    """The rear axle of a car shared between two, all but at its place."""
    road, near = ss.Road(tracks=tracks), CAR.b - 1e-9
    rates = {name: getattr(CAR, name) for name in ("mu", "ks", "cs", "kt")}
    parts = {name: (whole, share * whole, (1 - share) * whole) for name, whole in rates.items()}
    bars = {"arb_front": arb, "arb_middle": share * 1e5, "arb_rear": (1 - share) * 1e5}
    names = ("mb", "ixx", "iyy", "a", "b", "c")
    truck = ss.ThreeAxleTruck(**{name: getattr(CAR, name) for name in names}, middle=near, **parts, **bars)
    one, other = ss.ride_metrics(truck, road), ss.ride_metrics(CAR.replaced(arb_front=arb), road)
    np.testing.assert_allclose(
        one.sws.sel(corner=["fr", "mr", "rr"]), other.sws.sel(corner=["fr", "rr", "rr"]), rtol=1e-5
    )
    for name in ("pitch_acc", "roll_acc"):
        np.testing.assert_allclose(one[name], other[name], rtol=1e-5, atol=1e-9)
    np.testing.assert_allclose(one.dtl.sel(corner="rl"), (1 - share) * other.dtl.sel(corner="rl"), rtol=1e-5)


def test_a_linear_vehicle_takes_the_truck_s_axles():
    truck, road = TRUCKS["unequal"], ss.Road(tracks="isotropic", speed=15.0)
    system = truck.state_space(input="velocity")
    names = [f"fed {name}" for name in system.output_labels]
    free = control.ss(system.A, system.B, system.C, system.D, inputs=system.input_labels, outputs=names)
    expected = ss.ride_metrics(truck, road)
    for vehicle in (
        ss.LinearVehicle(free, like=truck),
        ss.LinearVehicle(free, wheels=truck.wheels, wheelbase=truck.axles[1:], track_width=2.0),
    ):
        found = ss.ride_metrics(vehicle, road)
        np.testing.assert_allclose(found["fed dtl_ml"], expected.dtl.sel(corner="ml"), rtol=1e-8)
        np.testing.assert_allclose(found["fed pitch_acc"], expected.pitch_acc, rtol=1e-8)


@pytest.mark.parametrize("name", ["ks", "ks_mr", "middle", "a", "c", "arb_middle", "speed", "cutoff"])
def test_sensitivity_is_a_difference(name):
    truck, road, h = TRUCKS["bars"], ss.Road(tracks="independent", cutoff=0.01), 1e-3
    slope = ss.sensitivity(truck, road, [name]).squeeze("parameter")
    of_road = name in ("speed", "cutoff")
    at = getattr(road, name) if of_road else truck.at_wheels("ks")[2] if name == "ks_mr" else getattr(truck, name)

    def metrics(step):
        if of_road:
            return ss.ride_metrics(truck, ss.Road(tracks="independent", **({"cutoff": 0.01} | {name: at + step})))
        if name == "ks":
            return ss.ride_metrics(
                truck.replaced(**{f"ks_{w}": k + step for w, k in zip(truck.wheels, at, strict=True)}), road
            )
        return ss.ride_metrics(truck.replaced(**{name: at + step}), road)

    step = h * abs(at[0] if isinstance(at, tuple) else at)
    up, down = metrics(step), metrics(-step)
    for metric in ("bacc", "sws", "dtl", "roll_acc"):
        expected = (up[metric] - down[metric]) / (2 * step)
        np.testing.assert_allclose(
            slope[metric], expected, rtol=1e-4, atol=1e-6 * float(abs(expected).max()), err_msg=metric
        )


def test_sweeps_and_settings():
    ks, middle = np.array([4e5, 6e5]), np.array([0.9, -0.2])
    swept = ss.ride_metrics(ss.ThreeAxleTruck().replaced(ks_middle=ks, middle=middle), ss.Road(tracks="independent"))
    for i in range(2):
        alone = ss.ThreeAxleTruck(ks=(250e3, ks[i], 550e3), middle=middle[i])
        expected = ss.ride_metrics(alone, ss.Road(tracks="independent"))
        for name, data in expected.items():
            np.testing.assert_allclose(swept[name].isel(design=i), data, rtol=1e-9, err_msg=name)
    assert ss.ThreeAxleTruck.settings()["ks_rear"] == ("ks", ("rr", "rl"))


def test_covariance_names_three_warps():
    X = ss.covariance(ss.ThreeAxleTruck(), ss.Road(tracks="independent"))
    assert X.state.values.tolist()[-3:] == ["warp_1", "warp_2", "warp_3"]
    assert (np.linalg.eigvalsh(X.values[-3:, -3:]) > 0.0).all()


def test_four_roads_on_six_wheels_have_no_stationary_warp():
    with pytest.raises(ValueError, match="warp of the road under the wheels has no finite variance"):
        ss.ride_metrics(ss.ThreeAxleTruck(), ss.Road(wheels=("fr", "mr")))


def test_a_seat_on_a_truck():
    truck = ss.ThreeAxleTruck().with_seats({"driver": ss.Seat(x=4.2, y=0.6, mass=70.0, ks=12e3, cs=900.0)})
    road = ss.Road(tracks="independent")
    exact, spectral = ss.ride_metrics(truck, road), ss.ride_metrics(truck, road, method="spectral")
    np.testing.assert_allclose(spectral.bacc, exact.bacc, rtol=1e-6)


def test_files_and_command_line(tmp_path, run):
    path, truck = tmp_path / "truck.toml", TRUCKS["unequal"]
    path.write_text(vehicle_text(truck))
    assert vars(read_vehicle(path)) == vars(truck)
    code, out, err = run("metrics", "--vehicle", str(path), "--tracks", "independent", "--json")
    assert (code, err) == (0, "")
    expected = ss.ride_metrics(truck, ss.Road(tracks="independent"))
    np.testing.assert_allclose(list(json.loads(out)["metrics"]["dtl"].values()), expected.dtl, rtol=1e-9)
    code, out, _ = run("metrics", "--model", "three-axle", "--ks-middle", "500N/mm", "--json")
    assert code == 0
    assert json.loads(out)["vehicle"]["parameters"]["ks"]["ml"] == 5e5


@pytest.mark.parametrize(
    ("values", "error", "said"),
    [
        ({"middle": 2.25}, ValueError, r"middle=...\) must lie between -a and b, got 2.25 m"),
        ({"middle": np.array([0.5, -4.0])}, ValueError, r"got -4 m at \(design=1\)"),
        ({"ks": (1e5, 2e5)}, ValueError, r"pass one value, or \(front, middle, rear\) or \(fr, fl, mr, ml, rr, rl\)"),
        ({"ks": (1e5, 2e5, -3e5)}, ValueError, r"ks=...\) at end rr must be > 0 N/m, got -300000.0"),
        ({"ks": ss.Corners.axles(front=1e5, rear=2e5)}, TypeError, r"takes \(front, middle, rear\)"),
        ({"ks": [1e5, 2e5, 3e5]}, TypeError, "got a list of 3, which may be wheels or designs"),
    ],
)
def test_refused(values, error, said):
    with pytest.raises(error, match=said):
        ss.ThreeAxleTruck(**values)
