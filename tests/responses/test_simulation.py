"""Time histories against closed forms, scipy and the frequency response."""

import control as ct
import numpy as np
import pytest
import xarray as xr

import susp_ss as ss
from models import VEHICLES
from susp_ss.responses.first_order_hold import BLOCK, BLOCKS, FirstOrderHold

TIME = np.arange(0.0, 4.0, 0.002)


@pytest.mark.parametrize("name", ["quarter", "pitch half", "roll half", "full, unequal corners"])
def test_simulation_is_python_controls_own(name):
    vehicle = VEHICLES[name]
    system = vehicle.state_space()
    rng = np.random.default_rng(3)
    z = np.cumsum(rng.standard_normal((system.ninputs, len(TIME))), axis=1) * 1e-3
    z -= z[:, :1]
    reference = ct.forced_response(system, TIME, z)
    ours = ss.simulate(vehicle, z, TIME)
    outputs = np.atleast_2d(reference.outputs)
    for i, output in enumerate(system.output_labels):
        kind, _, place = output.partition("_")
        data = ours[output] if output in ours else ours[kind]
        data = data.sel({data.dims[0]: place}) if data.ndim > 1 else data
        np.testing.assert_allclose(data, outputs[i], rtol=0.0, atol=1e-9 * np.abs(outputs[i]).max())


@pytest.mark.parametrize("name", ["rigid tyre", "quarter, tyre damping", "full, unequal corners, bars, tyre damping"])
def test_steady_sine_has_the_amplitude_of_the_frequency_response(name):
    vehicle, f = VEHICLES[name], 2.0
    time = np.arange(0.0, 12.0, 0.0005)
    H = ss.frequency_response(vehicle, [f]).isel(frequency=0)
    z = np.zeros((len(vehicle.wheels), len(time)))
    z[0] = 0.01 * np.sin(2 * np.pi * f * time)
    response = ss.simulate(vehicle, z, time)
    last = time > 10.0
    for output in ("sws", "dtl"):
        data = response[output] if response[output].ndim == 1 else response[output].isel(corner=0)
        label = output if response[output].ndim == 1 else f"{output}_{next(iter(vehicle.wheels))}"
        gain = H.sel(output=label).isel(input=0)
        phasor = 2 * np.mean(data.values[last] * np.exp(-2j * np.pi * f * time[last])) / (0.01 * -1j)
        np.testing.assert_allclose(phasor, complex(gain), rtol=1e-3)


def test_kerb_settles_to_rest_and_starts_in_equilibrium():
    kerb = np.where(TIME < 1.0, 0.3, 0.35)
    response = ss.simulate(ss.QuarterCar(), kerb, TIME)
    np.testing.assert_allclose(response.sws[TIME < 0.9], 0.0, atol=1e-12)
    assert float(np.abs(response.dtl).max()) > 5000.0
    np.testing.assert_allclose(response.sws[-1], 0.0, atol=2e-4)


def test_damper_power_is_force_times_rate():
    z = 0.02 * np.sin(8.0 * TIME)
    car = ss.QuarterCar()
    response = ss.simulate(car, z, TIME)
    rate = np.gradient(response.sws.values, TIME)
    np.testing.assert_allclose(response.damper_power[5:-5], car.cs * rate[5:-5] ** 2, rtol=0.02, atol=0.5)
    assert response.damper_power.attrs["units"] == "W"


def test_profiles_by_name():
    z = 0.01 * np.sin(5.0 * TIME)
    named = ss.simulate(ss.PitchHalfCar(), {"r": 0 * z, "f": z}, TIME)
    listed = ss.simulate(ss.PitchHalfCar(), [z, 0 * z], TIME)
    np.testing.assert_array_equal(named.sws, listed.sws)
    assert named.bacc.dims == ("point", "time")


@pytest.mark.parametrize(
    ("profile", "time", "error", "words"),
    [
        (np.zeros(5), TIME, ValueError, "profile must have shape"),
        (np.zeros((3, len(TIME))), TIME, ValueError, "profile must have shape"),
        (np.full(len(TIME), np.nan), TIME, ValueError, "profile must be finite"),
        ("bumpy", TIME, TypeError, "road heights"),
        (None, TIME, TypeError, "road heights"),
        ({"fr": TIME}, TIME, ValueError, "profile must have the wheels"),
        (np.zeros(3), [0.0, 1.0, 3.0], ValueError, "even steps"),
        (np.zeros(3), [0.0, -1.0, -2.0], ValueError, "even steps"),
        (np.zeros(1), [0.0], ValueError, "at least two"),
        (np.zeros(3), ["a", "b", "c"], TypeError, "numbers in s"),
    ],
)
def test_bad_profiles_and_times(profile, time, error, words):
    with pytest.raises(error, match=words):
        ss.simulate(ss.QuarterCar(), profile, time)


@pytest.mark.parametrize("samples", [2, BLOCK, BLOCK + 1, BLOCK * BLOCKS + 3])
def test_a_hold_is_python_controls_own_with_eigenvalues_that_coincide(samples):
    """Three critically damped modes of one rate and no eigenvectors of their own, from any state."""
    A = np.diag(np.full(4, -3.0)) + np.diag(np.full(3, 7.0), 1)
    rng = np.random.default_rng(1)
    B, C, D = (rng.standard_normal(shape) for shape in ((4, 2), (3, 4), (3, 2)))
    u, x0 = rng.standard_normal((2, samples)), rng.standard_normal(4)
    reference = ct.forced_response(ct.ss(A, B, C, D), 0.01 * np.arange(samples), u, x0).outputs
    ours = np.concatenate(list(FirstOrderHold(A, B, C, D, 0.01).drive(u, x0[:, None])), axis=-1)
    assert ours.shape == (1, 3, samples)
    np.testing.assert_allclose(ours[0], reference, rtol=0.0, atol=1e-12 * np.abs(reference).max())


def same(one, other):
    assert set(one) == set(other)
    for name in one:
        size = float(np.abs(other[name]).max())
        np.testing.assert_allclose(one[name], other[name].transpose(*one[name].dims), rtol=1e-9, atol=1e-10 * size)


@pytest.mark.parametrize(
    "vehicle",
    [
        ss.QuarterCar(ks=np.geomspace(8e3, 30e3, 30), ct=np.linspace(0.0, 90.0, 30)),
        ss.FullCar(b=np.array([1.2, 1.9]), cs=ss.Corners(fr=900.0, fl=np.array([800.0, 2e3]), rr=1500.0, rl=1400.0)),
        ss.RideHandlingCar(izz=np.array([1500.0, 2200.0])),
        ss.QuarterCar(ms=np.array([250.0, 400.0]), cs=ss.DamperCurve.two_slopes(800.0, 2000.0)),
    ],
    ids=["quarter", "full", "moving", "curve"],
)
def test_many_designs_are_each_of_them(vehicle):
    x = np.arange(0.0, 6.0, 0.05)
    bump = xr.DataArray(0.04 * np.exp(-4.0 * (x - 2.0) ** 2), dims="x", coords={"x": x})
    profile = xr.Dataset({"left": bump, "right": 0.5 * bump})
    how = {"speed": 12.0, "step": 0.002, "positions": True}
    every, space = ss.simulate(vehicle, profile, **how), vehicle.design_space()
    for design in (0, space.size - 1):
        one = vehicle.flattened(space).mapped(lambda x, i=design: float(x[i]) if isinstance(x, np.ndarray) else x)
        same(every.isel(design=design), ss.simulate(one, profile, **how))


def test_numbers_in_place_of_histories_are_those_of_the_histories():
    rng = np.random.default_rng(2)
    time = 0.002 * np.arange(BLOCK * BLOCKS + 900)
    z = 1e-3 * np.cumsum(rng.standard_normal((2, len(time))), axis=1)
    cars = ss.PitchHalfCar(cs=xr.DataArray(np.array([900.0, 1800.0]), dims="cs"))
    history = ss.simulate(cars, z, time)
    kept = ss.simulate(cars, z, time, reduce=("rms", "mean", "peak", "max", "min"))
    assert kept.bacc.dims == ("cs", "point", "statistic")
    same(kept.sel(statistic="rms", drop=True), np.sqrt((history**2).mean("time")))
    same(kept.sel(statistic="mean", drop=True), history.mean("time"))
    same(kept.sel(statistic="peak", drop=True), abs(history).max("time"))
    same(kept.sel(statistic="max", drop=True), history.max("time"))
    same(kept.sel(statistic="min", drop=True), history.min("time"))
    assert ss.simulate(cars, z, time, reduce="peak").equals(kept.sel(statistic="peak", drop=True))
    assert kept.sws.attrs["units"] == "m"


def test_a_car_runs_straight_before_it_is_steered():
    car, time = ss.RideHandlingCar(), np.arange(0.0, 1.0, 0.01)
    turn = ss.simulate(car, np.full_like(time, 0.2), time, inputs={"delta_f": np.full_like(time, 0.01)})
    plant = car.state_space()
    u = np.zeros((plant.ninputs, len(time)))
    u[plant.input_labels.index("delta_f")] = 0.01
    expected = ct.forced_response(plant, time, u).outputs[plant.output_labels.index("yaw_rate")]
    np.testing.assert_allclose(turn.yaw_rate, expected, atol=1e-9)
    assert abs(float(turn.yaw_rate[0])) < 1e-12


@pytest.mark.parametrize("reduce", ["root", (), ("rms", "root"), 3, [None]])
def test_unknown_statistics(reduce):
    with pytest.raises(ValueError, match="reduce must be one or several of rms, mean, peak, max, min, got"):
        ss.simulate(ss.QuarterCar(), np.zeros(3), [0.0, 1.0, 2.0], reduce=reduce)


@pytest.mark.parametrize("name", ["rigid tyre", "quarter, tyre damping", "full, unequal corners, bars, tyre damping"])
def test_positions_are_those_whose_differences_are_deflections(name):
    vehicle = VEHICLES[name]
    z = np.outer(np.arange(1.0, len(vehicle.wheels) + 1.0), 0.01 * np.sin(9.0 * TIME) * (1.0 - np.exp(-5.0 * TIME)))
    ride = ss.simulate(vehicle, z, TIME, positions=True)
    road = np.atleast_2d(ride.z_r)
    np.testing.assert_allclose(road, z, atol=1e-15)
    at = {"point": [*vehicle.wheels]} if "point" in ride.dims else {}
    body = np.atleast_2d(ride.z_s.sel(at))
    wheel = np.atleast_2d(ride.z_u) if "z_u" in ride else road
    np.testing.assert_allclose(wheel - body, np.atleast_2d(ride.sws), atol=1e-12)
    if "z_u" in ride:
        np.testing.assert_allclose(road - wheel, np.atleast_2d(ride.tyre_deflection), atol=1e-12)
    if "pitch" in ride:
        front, rear = (ride.z_s.sel(point=[*ends]).mean("point") for ends in (("fr", "fl"), ("rr", "rl")))
        np.testing.assert_allclose((rear - front) / (vehicle.a + vehicle.b), ride.pitch, atol=1e-12)
        left, right = (ride.z_s.sel(point=[*ends]).mean("point") for ends in (("fl", "rl"), ("fr", "rr")))
        np.testing.assert_allclose((left - right) / (2.0 * vehicle.c), ride["roll"], atol=1e-12)
    second = np.diff(np.atleast_2d(ride.z_s), 2) / (TIME[1] - TIME[0]) ** 2
    scale = np.abs(np.atleast_2d(ride.bacc)).max()
    np.testing.assert_allclose(second, np.atleast_2d(ride.bacc)[:, 1:-1], atol=0.02 * scale)


def test_positions_of_seats_of_curves_and_of_what_moves():
    z = np.tile(0.02 * np.sin(8.0 * TIME), (4, 1))
    seated = ss.FullCar().with_seats({"driver": ss.Seat(x=0.3, y=0.4)})
    ride = ss.simulate(seated, z, TIME, positions=True)
    on, floor = (ride.z_s.sel(point=point) for point in ("driver", "driver_floor"))
    np.testing.assert_allclose(on - floor, ride.seat_travel.sel(seat="driver"), atol=1e-12)
    curved = ss.simulate(ss.FullCar(cs=ss.DamperCurve.two_slopes(800.0, 2000.0)), z, TIME, positions=True)
    np.testing.assert_allclose(curved.z_u - curved.z_s.sel(point=curved.corner.values).values, curved.sws, atol=1e-12)
    moving = ss.simulate(ss.RideHandlingCar(), z, TIME, inputs={"delta_f": 0.01 * np.sin(TIME)}, positions=True)
    left, right = moving.z_s.sel(point="fl"), moving.z_s.sel(point="fr")
    np.testing.assert_allclose((left - right) / (2.0 * ss.RideHandlingCar().c), moving["roll"], atol=1e-9)
    plant = ss.LinearVehicle(ss.QuarterCar().state_space(input="velocity"))
    with pytest.raises(TypeError, match="positions need a vehicle whose body is known"):
        ss.simulate(plant, z[0], TIME, positions=True)
