"""People on seats: every route, Newton's equations once more, limits in closed form, files and refusals."""

import json
import pickle

import control
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import models
import oracles
import susp_ss as ss
from susp_ss.vehicles.files import read_vehicle, vehicle_text

SEATS = {"driver": ss.Seat(x=0.3, y=0.4), "child": ss.Seat(x=-0.6, y=-0.35, mass=20.0, ks=12e3, cs=250.0)}
UNEQUAL = models.VEHICLES["full, unequal corners, bars, tyre damping"]

SEATED = {
    "quarter": ss.QuarterCarWithSeat(cs=1300.0, seat_mass=70.0),
    "pitch half": ss.PitchHalfCar(ks=(16e3, 22e3)).with_seats({"driver": ss.Seat(x=0.3)}),
    "roll half": ss.RollHalfCar(arb=15e3).with_seats({"driver": ss.Seat(y=0.4)}),
    "full, one seat": ss.FullCar().with_seats({"driver": SEATS["driver"]}),
    "full, two seats": ss.FullCar(arb_front=20e3).with_seats(SEATS),
    "full, unequal corners, two seats": UNEQUAL.with_seats(SEATS),
}

ROADS = {name: models.ROADS[name] for name in ("identical", "independent", "isotropic", "independent, cut-off")}


def flat(metrics):
    return {
        f"{name}_{place}" if place else name: float(data.sel({data.dims[0]: place}) if place else data)
        for name, data in metrics.items()
        for place in (data.coords[data.dims[0]].values if data.dims else [""])
    }


def seated_oracle(car, plain, seats):
    """The plain car as the oracle writes it, and the seats on it."""
    model = models.oracle(plain)
    for name, seat in seats.items():
        floor = {"z_s": 1.0, "z_b": 1.0, "theta": -seat.x, "phi": seat.y}
        model = oracles.with_seat(model, name, floor, seat.mass, seat.ks, seat.cs)
    return model


@pytest.mark.parametrize("road", ROADS.values(), ids=ROADS.keys())
@pytest.mark.parametrize("vehicle", SEATED.values(), ids=SEATED.keys())
def test_routes_agree(vehicle, road):
    exact, spectral = ss.ride_metrics(vehicle, road), ss.ride_metrics(vehicle, road, method="spectral")
    rtol = 1e-3 if road.tracks == "isotropic" else 1e-6
    for name, data in exact.items():
        np.testing.assert_allclose(spectral[name], data, rtol=rtol, atol=1e-7, err_msg=name)


@pytest.mark.parametrize("vehicle", SEATED.values(), ids=SEATED.keys())
def test_time_route_agrees(vehicle):
    road = ss.Road(tracks="independent", speed=25.0)
    exact = ss.ride_metrics(vehicle, road)
    simulated = ss.ride_metrics(vehicle, road, method="time", duration=100.0, step=0.004, seed=2)
    for name in ("bacc", "seat_travel", "sws"):
        assert (abs(simulated[name] - exact[name]) <= 5.0 * simulated[f"{name}_stderr"]).all(), name


@pytest.mark.parametrize("road", [road for road in ROADS.values() if road.tracks != "isotropic"])
@pytest.mark.parametrize("plain", [ss.FullCar(), UNEQUAL], ids=["symmetric", "unequal"])
def test_newton_s_equations(plain, road):
    oracle = seated_oracle(plain, plain, SEATS)
    expected = oracles.metrics(oracle, oracles.variance_lyapunov_delay(oracle, models.oracle_road(road)))
    ours = flat(ss.ride_metrics(plain.with_seats(SEATS), road))
    assert ours.keys() == expected.keys()
    for name, value in expected.items():
        np.testing.assert_allclose(ours[name], value, rtol=1e-9, atol=1e-8, err_msg=name)


def test_a_light_rider_filters_the_floor():
    """Nothing comes back from a mass of a gram: the seat is a filter on a point of the body."""
    car, road = ss.FullCar(arb_rear=8e3), ss.Road(tracks="independent")
    w, zeta, mass = 2 * np.pi * 4.0, 0.3, 1e-3
    seat = ss.Seat(x=0.3, y=0.4, mass=mass, ks=mass * w**2, cs=2 * zeta * w * mass)
    felt = ss.ride_metrics(car.with_seats({"driver": seat}), road).bacc
    through = control.tf([2 * zeta * w, w**2], [1, 2 * zeta * w, w**2])
    filtered = ss.ride_metrics(car, road, weighting={"bacc": through}, points={"driver": (0.3, 0.4)}).bacc
    np.testing.assert_allclose(felt.sel(point="driver"), filtered.sel(point="driver"), rtol=1e-5)


def test_a_rigid_seat_is_mass_on_the_body():
    road = ss.Road()
    hard = ss.QuarterCarWithSeat(seat_mass=80.0, seat_ks=1e8, seat_cs=1e5)
    metrics, heavy = ss.ride_metrics(hard, road), ss.ride_metrics(ss.QuarterCar(ms=317.5 + 80.0), road)
    for name in ("sws", "dtl"):
        np.testing.assert_allclose(metrics[name], heavy[name], rtol=1e-3)
    np.testing.assert_allclose(metrics.bacc, heavy.bacc.item(), rtol=1e-2)


@given(models.full_cars, st.floats(-1.0, 1.0), st.floats(20.0, 120.0), st.floats(10e3, 60e3), st.floats(200.0, 2e3))
@settings(max_examples=20)
def test_dampers_dissipate_what_the_road_gives(car, y, mass, ks, cs):
    """Each tyre without damping takes in q kt / 2, however many sit inside, as long as no wheel repeats another."""
    car = car.replaced(ct=0.0) if isinstance(car.ct, float) else ss.FullCar()
    road = ss.Road(tracks="independent", delay=False)
    metrics = ss.ride_metrics(car.with_seats({"driver": ss.Seat(x=0.2, y=y, mass=mass, ks=ks, cs=cs)}), road)
    a, d = float(metrics.bacc.sel(point="driver")), float(metrics.seat_travel.sel(seat="driver"))
    # The force on the rider is ks d + cs d', whose parts do not correlate.
    at_seat = ((mass * a) ** 2 - (ks * d) ** 2) / cs
    given = 0.5 * road.intensity * sum(car.at_wheels("kt"))
    np.testing.assert_allclose(float(metrics.damper_power.sum()) + at_seat, given, rtol=1e-7)


def test_transmissibility_is_the_seat_s_own():
    """From the floor to the rider the car plays no part, whichever wheel is excited."""
    f, seat = np.geomspace(0.3, 30.0, 40), SEATS["child"]
    H = ss.frequency_response(UNEQUAL.with_seats(SEATS), f)
    s = 2j * np.pi * f
    expected = (seat.cs * s + seat.ks) / (seat.mass * s**2 + seat.cs * s + seat.ks)
    for wheel in UNEQUAL.wheels:
        over = H.sel(output="bacc_child", input=f"z_r_{wheel}") / H.sel(output="bacc_child_floor", input=f"z_r_{wheel}")
        np.testing.assert_allclose(over, expected, rtol=1e-8)


def test_defaults_are_a_person_on_foam():
    """4 Hz, and about twice the floor's vibration there."""
    seat = ss.Seat()
    w = np.sqrt(seat.ks / seat.mass)
    f = np.geomspace(1.0, 10.0, 2000)
    s = 2j * np.pi * f
    gain = abs((seat.cs * s + seat.ks) / (seat.mass * s**2 + seat.cs * s + seat.ks))
    assert w / (2 * np.pi) == pytest.approx(4.0, abs=0.05)
    assert gain.max() == pytest.approx(2.0, abs=0.1)


def test_seats_are_parameters():
    car, road = ss.FullCar().with_seats(SEATS), ss.Road(tracks="independent")
    ks, x = np.array([20e3, 35e3]), np.array([0.3, -0.5])
    swept = ss.ride_metrics(car.replaced(seat_ks_driver=ks, seat_x_driver=x), road, weighting="Wk")
    for i in range(2):
        seats = SEATS | {"driver": ss.Seat(x=x[i], y=0.4, ks=ks[i])}
        alone = ss.ride_metrics(ss.FullCar().with_seats(seats), road, weighting="Wk")
        for name, data in alone.items():
            np.testing.assert_allclose(swept[name].isel(design=i), data, rtol=1e-9)
    response = ss.Response(car, road, "bacc", at="driver", inputs=("seat_ks_driver", "cs"))
    expected = ss.ride_metrics(car, road).bacc.sel(point="driver")
    np.testing.assert_allclose(response([[35e3, car.cs]]), expected, rtol=1e-9)


@pytest.mark.parametrize("name", ["seat_x_driver", "seat_y_driver", "seat_mass_child", "seat_cs_driver", "ks"])
def test_sensitivity_is_a_difference(name):
    car, road, step = ss.FullCar().with_seats(SEATS), ss.Road(tracks="independent"), 1e-4
    slope = ss.sensitivity(car, road, [name]).squeeze("parameter")
    at = getattr(car, name)
    up, down = (ss.ride_metrics(car.replaced(**{name: at * (1 + h)}), road) for h in (step, -step))
    for metric in ("bacc", "seat_travel", "sws"):
        expected = (up[metric] - down[metric]) / (2 * step * at)
        atol = 1e-6 * float(abs(expected).max())
        np.testing.assert_allclose(slope[metric], expected, rtol=1e-4, atol=atol, err_msg=metric)


def test_points_and_pickles():
    car = ss.FullCar().with_seats({"driver": SEATS["driver"]}).with_seats({"child": SEATS["child"]})
    assert car.seats == ("driver", "child")
    copy = pickle.loads(pickle.dumps(car.with_points({"roof": (0.0, 0.0)})))
    ride = ss.ride_metrics(copy, ss.Road())
    assert ride.bacc.point.values.tolist()[-5:] == ["driver_floor", "child_floor", "roof", "driver", "child"]
    np.testing.assert_allclose(ride.bacc.sel(point="roof"), ride.bacc.sel(point="cg"), rtol=1e-9)


def test_an_undamped_seat_is_damped_by_the_car():
    car = ss.FullCar().with_seats({"driver": ss.Seat(x=0.1, y=0.2, cs=0.0)})
    assert np.isfinite(ss.ride_metrics(car, ss.Road(tracks="independent")).bacc).all()


def test_files_hold_seats(tmp_path):
    path, car = tmp_path / "car.toml", ss.FullCar(mb=1500.0).with_seats(SEATS)
    path.write_text(vehicle_text(car))
    again = read_vehicle(path)
    assert type(again) is type(car)
    assert vars(again) == vars(car)
    assert "[seats.child]" in path.read_text()
    half = ss.PitchHalfCar().with_seats({"driver": ss.Seat(x=0.3)})
    path.write_text(vehicle_text(half))
    assert vars(read_vehicle(path)) == vars(half)


def test_command_line_takes_seats(run, tmp_path):
    path = tmp_path / "car.toml"
    path.write_text(
        'model = "full"\n[seats.driver]\nx = { value = 300, unit = "mm" }\nmass = { value = 60.0, unit = "kg" }\n'
    )
    code, out, err = run("metrics", "--vehicle", str(path), "--weighting", "Wk", "--json")
    assert (code, err) == (0, "")
    car = ss.FullCar().with_seats({"driver": ss.Seat(x=0.3, mass=60.0)})
    metrics, told = ss.ride_metrics(car, ss.DEFAULT_ROAD, weighting="Wk"), json.loads(out)["metrics"]
    np.testing.assert_allclose(told["bacc"]["driver"], metrics.bacc.sel(point="driver"), rtol=1e-12)
    np.testing.assert_allclose(told["seat_travel"]["driver"], metrics.seat_travel.item(), rtol=1e-12)
    code, out, _ = run("metrics", "--model", "full", "--vehicle", str(path))
    assert code == 0
    assert "seat_travel" in out


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("[seats.driver]\nz = 1\n", "no parameter of the seat 'driver' named 'z', available: x, y, mass, ks, cs"),
        ('[seats.fr]\nx = { value = 0.3, unit = "m" }\n', "'fr' is a point of FullCar already"),
        ("seats = 3\n", "seats must be tables"),
        ("[seats]\ndriver = 3\n", "seats.driver must be a table"),
        ('[seats.driver]\nks = { value = 35, unit = "N/m" }\n', "did you mean 35 N/mm"),
    ],
)
def test_files_refuse(text, said, tmp_path):
    path = tmp_path / "car.toml"
    path.write_text(f'model = "full"\n{text}' if "[" in text else f'{text}model = "full"\n')
    with pytest.raises(ValueError, match=str(path)) as refused:
        read_vehicle(path)
    assert said in str(refused.value)


@pytest.mark.parametrize(
    ("car", "seats", "error", "said"),
    [
        (ss.FullCar(), {"driver": 1}, TypeError, "'driver' must be a Seat"),
        (ss.FullCar(), {}, TypeError, "seats must be a mapping such as"),
        (ss.FullCar(), ss.Seat(), TypeError, "seats must be a mapping such as"),
        (ss.FullCar(), {"front seat": ss.Seat()}, TypeError, "seats must have plain names"),
        (ss.FullCar(), {"rl": ss.Seat()}, ValueError, "'rl' is a point of FullCar already"),
        (ss.FullCar(), {"a": ss.Seat(), "a_floor": ss.Seat()}, ValueError, "'a_floor' is a point of FullCar already"),
        (ss.FullCar(), {"a": ss.Seat(ks=-1.0)}, ValueError, r"FullCar\(seat_ks_a=...\) must be > 0 N/m, got -1.0"),
        (ss.FullCar(), {"a": ss.Seat(x=np.inf)}, ValueError, r"FullCar\(seat_x_a=...\) must be finite, in m, got inf"),
        (ss.PitchHalfCar(), {"a": ss.Seat(y=0.4)}, ValueError, "lies 0.4 m to the left, where a PitchHalfCar has no"),
        (ss.RollHalfCar(), {"a": ss.Seat(x=0.4)}, ValueError, "lies 0.4 m ahead, where a RollHalfCar has no body"),
        (ss.QuarterCar(), {"a": ss.Seat()}, ValueError, "take QuarterCarWithSeat"),
    ],
)
def test_refused(car, seats, error, said):
    with pytest.raises(error, match=said):
        car.with_seats(seats)
