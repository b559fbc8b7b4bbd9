"""Time histories against closed forms, scipy and the frequency response."""

import control as ct
import numpy as np
import pytest

import susp_ss as ss
from models import VEHICLES

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
        np.testing.assert_allclose(data, outputs[i], atol=1e-8 * np.abs(outputs[i]).max())


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
    with pytest.raises(ValueError, match="one number for every parameter"):
        ss.simulate(ss.QuarterCar(ks=np.array([1e4])), np.zeros(3), [0.0, 1.0, 2.0])
