"""Bad parameters: one clear error that names the argument, what it got and what it needs."""

import dataclasses

import numpy as np
import pytest
import xarray as xr

import susp_ss as ss

VEHICLES = [ss.RigidTyreQuarterCar, ss.QuarterCar, ss.PitchHalfCar, ss.RollHalfCar, ss.FullCar]
FIELDS = [(vehicle, name, quantity.zero) for vehicle in VEHICLES for name, quantity in vehicle.quantities().items()]


@pytest.mark.parametrize(("vehicle", "name", "zero"), FIELDS)
def test_every_field_of_every_vehicle_is_checked(vehicle, name, zero):
    where = rf"{vehicle.__name__}\({name}=\.\.\.\) must be "
    for value in (np.nan, np.inf, -np.inf, -1.0, *(() if zero else (0.0,))):
        with pytest.raises(ValueError, match=where):
            vehicle(**{name: value})
    for value in (None, "stiff", True, 1j, {}, object(), np.array(["a"])):
        with pytest.raises(TypeError, match=where):
            vehicle(**{name: value})
    with pytest.raises(ValueError, match=where + r".* got nan at \(design=1\)"):
        vehicle(**{name: np.array([1.0, np.nan])})
    with pytest.raises(ValueError, match=where + ".*got an empty array"):
        vehicle(**{name: np.array([])})
    if zero:
        vehicle(**{name: 0.0})


def test_messages_say_where():
    ks = xr.DataArray([[1e4, 2e4], [-1.0, 2e4]], dims=("ks", "cs"))
    with pytest.raises(ValueError, match=r"FullCar\(ks=\.\.\.\) must be > 0 N/m, got -1.0 at \(ks=1, cs=0\)"):
        ss.FullCar(ks=ks)
    with pytest.raises(ValueError, match=r"at corner rl must be > 0 N/m, got 0.0"):
        ss.FullCar(ks=ss.Corners(fr=1e4, fl=1e4, rr=1e4, rl=0.0))
    with pytest.raises(ValueError, match=r"at end r must be >= 0 N s/m, got -5.0"):
        ss.PitchHalfCar(cs=(1000.0, -5.0))


def test_values_in_the_wrong_form():
    with pytest.raises(TypeError, match=r"FullCar\(mu=...\) got a list of 4, .* Corners\(.*numpy.array\("):
        ss.FullCar(mu=[45.0, 45.0, 40.0, 40.0])
    with pytest.raises(TypeError, match=r"RollHalfCar\(ks=...\) got a list of 2, .* \(first, second\)"):
        ss.RollHalfCar(ks=[1e4, 2e4])
    with pytest.raises(ValueError, match=r"pass one value, or Corners\(fr=, fl=, rr=, rl=\)"):
        ss.FullCar(ks=(1e4, 2e4))
    with pytest.raises(ValueError, match=r"pass one value, or \(first, second\)"):
        ss.RollHalfCar(ks=(1e4, 2e4, 3e4))
    with pytest.raises(TypeError, match="QuarterCar"):
        ss.QuarterCar(ks=ss.Corners(fr=1e4, fl=1e4, rr=1e4, rl=1e4))
    with pytest.raises(TypeError, match="mb"):
        ss.FullCar(mb=ss.Corners(fr=1e3, fl=1e3, rr=1e3, rl=1e3))
    with pytest.raises(TypeError):
        ss.Corners(fr=1.0, fl=1.0, rr=1.0)
    with pytest.raises(TypeError):
        ss.QuarterCar(317.5)
    with pytest.raises(TypeError):
        ss.QuarterCar(k=1e4)


def test_shapes_that_do_not_broadcast():
    with pytest.raises(ValueError, match="do not broadcast"):
        ss.QuarterCar(ks=np.ones(3), cs=np.ones(4))
    with pytest.raises(ValueError, match="do not broadcast"):
        ss.QuarterCar(
            ks=xr.DataArray([1e4, 2e4], dims="x", coords={"x": [0, 1]}),
            cs=xr.DataArray([1e3, 2e3], dims="x", coords={"x": [0, 2]}),
        )


@pytest.mark.parametrize("dim", ["point", "corner", "state", "output", "input", "frequency", "time"])
def test_dims_of_results_are_taken(dim):
    with pytest.raises(ValueError, match=f"a dim named '{dim}', which results use themselves"):
        ss.FullCar(ks=xr.DataArray([1e4, 2e4], dims=dim))


def test_labelled_and_plain_arrays_share_the_design_dim():
    labelled = xr.DataArray([1e3, 2e3], dims="design")
    assert ss.ride_metrics(ss.QuarterCar(ks=np.array([1e4, 2e4]), cs=labelled), ss.Road()).sws.shape == (2,)
    named = xr.DataArray([1e3, 2e3], dims="designer")
    both = ss.ride_metrics(ss.QuarterCar(ks=np.ones((3, 2)) * 1e4, cs=named), ss.Road())
    assert both.sws.sizes == {"designer": 2, "design_0": 3, "design_1": 2}


def test_a_dataarray_of_no_dims_is_a_number():
    assert ss.QuarterCar(ks=xr.DataArray(2e4)).state_space().nstates == 4


def test_stored_arrays_cannot_be_changed_and_the_users_can():
    ks = np.array([1e4, 2e4])
    car, labelled = ss.QuarterCar(ks=ks), ss.QuarterCar(ks=xr.DataArray(ks, dims="x"))
    ks[0] = -1.0
    assert car.ks[0] == float(labelled.ks[0]) == 1e4
    for values in (car.ks, labelled.ks.values):
        with pytest.raises(ValueError, match="read-only"):
            values[0] = -1.0


def test_masked_values_are_refused():
    with pytest.raises(TypeError, match="ks"):
        ss.QuarterCar(ks=np.ma.array([1e4, 2e4], mask=[False, True]))


def test_coordinates_that_are_no_dims_survive():
    ks = xr.DataArray([1e4, 2e4], dims="x", coords={"x": [0, 1], "name": ("x", ["soft", "hard"])})
    assert list(ss.ride_metrics(ss.FullCar(ks=ks), ss.Road()).sws.coords["name"].values) == ["soft", "hard"]


def test_rows_of_different_lengths():
    with pytest.raises(TypeError, match="got rows of different lengths"):
        ss.QuarterCar(ks=[[1e4, 2e4], [1e4]])


def test_vehicles_are_frozen_and_keep_their_defaults():
    car = ss.FullCar()
    with pytest.raises(dataclasses.FrozenInstanceError):
        car.ks = 1.0
    assert (car.mb, car.ixx, car.iyy, car.a, car.b, car.c) == (1270.0, 220.45, 1067.22, 0.961, 1.504, 0.723)
    quarter = ss.QuarterCar()
    assert (quarter.ms, quarter.mu, quarter.kt, quarter.ct) == (317.5, 45.4, 192e3, 0.0)
    # The middle of Table 2.
    assert quarter.ks == (12536 + 24570) / 2
    assert quarter.cs == (798 + 2235) / 2


def test_axles():
    corners = ss.Corners.axles(front=1.0, rear=2.0)
    assert tuple(corners) == (1.0, 1.0, 2.0, 2.0)


def test_whole_numbers_and_replacement():
    car = dataclasses.replace(ss.QuarterCar(ks=18000), cs=np.int64(1500))
    assert isinstance(car.ks, float)
    assert isinstance(car.cs, float)
