"""Parameters in Dask blocks: the same numbers as in memory, computed and checked only when they are asked for."""

import dataclasses
import subprocess
import sys

import dask
import dask.array as da
import numpy as np
import pytest
import xarray as xr
from distributed import Client, LocalCluster

import susp_ss as ss

ROAD = ss.Road.iso8608("B", tracks="isotropic")


def along(dim, *values, labels=True, chunk=2):
    """A lazy row of values, with or without labels."""
    values = np.array(values)
    row = xr.DataArray(da.from_array(values, chunks=chunk), dims=dim)
    return row.assign_coords({dim: (dim, values, {"units": "SI"})}) if labels else row


KS, CS = along("ks", 15e3, 17e3, 19e3, 21e3, 23e3), along("cs", 900.0, 1400.0, 2000.0, labels=False)

VEHICLES = {
    "rigid tyre": ss.RigidTyreQuarterCar(ks=KS, cs=CS),
    "quarter": ss.QuarterCar(ks=KS, cs=CS),
    "quarter, all in one": ss.QuarterCar(ks=KS * CS / 1500.0, ct=50.0),
    "quarter, whole numbers": ss.QuarterCar(ms=along("ms", 200, 300, 400, chunk=3)),
    "pitch half, unequal ends": ss.PitchHalfCar(ks=(KS, 20e3), cs=(1500.0, CS)),
    "roll half": ss.RollHalfCar(ks=KS, arb=along("arb", 0.0, 10e3, chunk=1)),
    "full": ss.FullCar(ks=KS, cs=CS),
    "full, corners": ss.FullCar(
        ks=ss.Corners(fr=KS, fl=KS + 1e3, rr=20e3, rl=KS - 1e3), cs=ss.Corners.axles(front=CS, rear=1500.0)
    ),
    "full, with plain arrays and arrays in memory": ss.FullCar(
        mb=np.array([1100.0, 1300.0]), iyy=KS.compute() / 18.0, ks=KS, cs=CS
    ),
    "full, other coordinates": ss.FullCar(cs=CS.assign_coords(name=("cs", ["soft", "middle", "hard"]), year=2021)),
}


def in_memory(vehicle):
    return dataclasses.replace(vehicle.mapped(lambda leaf: leaf.compute() if isinstance(leaf, xr.DataArray) else leaf))


@pytest.mark.parametrize("vehicle", VEHICLES.values(), ids=VEHICLES.keys())
def test_lazy_equals_memory(vehicle):
    lazy = ss.ride_metrics(vehicle, ROAD)
    assert all(data.chunks is not None for data in lazy.values())
    expected = ss.ride_metrics(in_memory(vehicle), ROAD)
    xr.testing.assert_allclose(lazy, expected, rtol=1e-12, atol=0.0)
    assert lazy.sizes == expected.sizes
    for name, data in expected.items():
        assert lazy[name].dims == data.dims
        assert lazy[name].attrs == data.attrs
    xr.testing.assert_identical(lazy.coords.to_dataset(), expected.coords.to_dataset())


@pytest.mark.parametrize("options", [{"method": "spectral"}, {"method": "time", "duration": 5.0, "seed": 3}])
def test_every_route(options):
    vehicle = ss.QuarterCar(ks=along("ks", 15e3, 17e3, 19e3))
    road = ss.Road(waviness=2.2)
    lazy = ss.ride_metrics(vehicle, road, **options)
    xr.testing.assert_allclose(lazy, ss.ride_metrics(in_memory(vehicle), road, **options), rtol=1e-12, atol=0.0)


def test_blocks_of_one_sweep_on_two_roads_stay_apart():
    vehicle = ss.QuarterCar(ks=KS)
    roads = [ss.Road(speed=10.0), ss.Road(speed=30.0)]
    together = dask.compute(*(ss.ride_metrics(vehicle, road) for road in roads))
    for road, metrics in zip(roads, together, strict=True):
        xr.testing.assert_allclose(metrics, ss.ride_metrics(in_memory(vehicle), road), rtol=1e-12)


def explosive(dim, size):
    """Blocks that must not be computed."""

    def explode(block):
        raise AssertionError("computed")

    blocks = da.ones(size, chunks=size // 10).map_blocks(explode, dtype=float, meta=np.empty(0))
    return xr.DataArray(blocks, dims=dim)


@pytest.mark.parametrize("method", ["covariance", "spectral", "time"])
def test_nothing_is_computed_before_it_is_asked_for(method):
    axle = ss.Corners.axles(front=explosive("ks", 10**6), rear=20e3)
    metrics = ss.ride_metrics(ss.FullCar(ks=axle, cs=explosive("cs", 10**4)), ss.Road(), method)
    assert metrics.bacc.sizes == {"ks": 10**6, "cs": 10**4, "point": 5}
    assert metrics.bacc.chunks[:2] == ((10**5,) * 10, (10**3,) * 10)
    with pytest.raises(AssertionError, match="computed"):
        metrics.sws[0, 0, 0].compute()


WRONG = {
    "label": ({"ks": along("ks", 1e4, 2e4, -1.0)}, r"QuarterCar\(ks=...\) must be > 0 N/m, got -1.0 at \(ks=-1.0\)"),
    "position": ({"mu": along("x", 40.0, 45.0, np.nan, labels=False)}, r"\(mu=...\) .* got nan at \(x=2\)"),
    "grid": (
        {"ks": KS, "cs": along("cs", 1e3, 2e3, -5.0, labels=False)},
        r"\(cs=...\) must be >= 0 N s/m, got -5.0 at \(ks=\d+.0, cs=2\)",
    ),
    "the engine's word": ({"ks": KS, "cs": along("cs", 1e3, 2e3, 0.0)}, r"cs > 0.* at \(ks=\d+.0, cs=0.0\)"),
}


@pytest.mark.parametrize(("parameters", "said"), WRONG.values(), ids=WRONG.keys())
def test_values_are_checked_when_computed(parameters, said):
    metrics = ss.ride_metrics(ss.QuarterCar(**parameters), ss.Road())
    with pytest.raises(ValueError, match=said):
        metrics.load()


def test_other_blocks_are_not_refused():
    metrics = ss.ride_metrics(ss.QuarterCar(ks=along("ks", 1e4, 2e4, -1.0)), ss.Road())
    expected = ss.ride_metrics(ss.QuarterCar(ks=2e4), ss.Road())
    np.testing.assert_allclose(metrics.bacc[1], expected.bacc, rtol=1e-12)


REFUSED = {
    "bare": (da.ones(3), r"\(ks=...\).* must be > 0 N/m, got a bare Dask array; wrap it in an xarray.DataArray"),
    "text": (xr.DataArray(da.from_array(np.array(["a"])), dims="x"), "got a lazy DataArray of <U1"),
    "one number": (xr.DataArray(da.ones(())), "compute"),
    "none": (xr.DataArray(da.ones(0), dims="x"), "got an empty array"),
    "dim of results": (xr.DataArray(da.ones(3), dims="point"), "dim named 'point'"),
}


@pytest.mark.parametrize(("value", "said"), REFUSED.values(), ids=REFUSED.keys())
@pytest.mark.parametrize("wrap", [lambda value: value, lambda value: ss.Corners.axles(front=value, rear=2e4)])
def test_refused_at_once(value, said, wrap):
    with pytest.raises((TypeError, ValueError), match=said):
        ss.FullCar(ks=wrap(value))


VALUES = {
    "natural_frequencies": lambda vehicle: vehicle.natural_frequencies(),
    "covariance": lambda vehicle: ss.covariance(vehicle, ss.Road()),
    "frequency_response": lambda vehicle: ss.frequency_response(vehicle, [1.0, 2.0]),
    "psd": lambda vehicle: ss.psd(vehicle, ss.Road(), [1.0, 2.0]),
    "simulate": lambda vehicle: ss.simulate(vehicle, np.eye(9)[4], 0.1 * np.arange(9)).sws,
}


@pytest.mark.parametrize("function", VALUES.values(), ids=VALUES.keys())
def test_what_needs_values_computes_and_checks_them(function):
    vehicle = ss.QuarterCar(ks=KS, cs=CS)
    np.testing.assert_array_equal(function(vehicle), function(in_memory(vehicle)))
    with pytest.raises(ValueError, match=r"QuarterCar\(ks=...\) must be > 0 N/m, got -1.0"):
        function(ss.QuarterCar(ks=along("ks", 1e4, -1.0)))


def test_what_needs_one_design_refuses():
    vehicle = ss.QuarterCar(ks=explosive("ks", 20))
    for refused in (vehicle.state_space, vehicle.modes):
        with pytest.raises(ValueError, match="needs one number for every parameter, got arrays"):
            refused()


def test_memory_needs_no_dask():
    program = (
        "import sys; sys.modules.update(dict.fromkeys(['dask', 'distributed', 'zarr'])); "
        "import numpy as np, xarray as xr, susp_ss as ss; "
        "print(ss.ride_metrics(ss.QuarterCar(ks=xr.DataArray(np.array([1e4, 2e4]), dims='ks')), ss.Road()).sizes)"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert "'ks': 2" in done.stdout


def test_on_a_worker_process():
    vehicle = VEHICLES["full, corners"]
    with LocalCluster(n_workers=1, threads_per_worker=1, dashboard_address=":0") as cluster, Client(cluster):
        computed = ss.ride_metrics(vehicle, ROAD).compute()
        with pytest.raises(ValueError, match=r"got -1.0 at \(ks=-1.0\)"):
            ss.ride_metrics(ss.QuarterCar(ks=along("ks", 1e4, 2e4, -1.0)), ROAD).compute()
    xr.testing.assert_allclose(computed, ss.ride_metrics(in_memory(vehicle), ROAD), rtol=1e-12)
