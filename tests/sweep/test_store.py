"""Sweeps into a store: whatever dies on the way, the finished store is the one of an undisturbed run, byte for byte."""

import dataclasses
import json
import os
import signal
import sys

import numpy as np
import pytest
import xarray as xr
import zarr
from disturbed import AXES, CHUNKS, LINE, ROAD, files, process, raising, stopped_by, stopping

import susp_ss as ss
import susp_ss.progress
import susp_ss.sweep.plan
import susp_ss.sweep.store
from susp_ss.extras import installation
from susp_ss.sweep import Swept, sweep
from susp_ss.vehicles.files import models


def expected(vehicle, axes, **options):
    """The metrics in memory, all at once, on dims in the order of the axes."""
    quantities = vehicle.quantities()
    labelled = {}
    for name, values in axes.items():
        attrs = {"units": quantities[name].unit, "long_name": quantities[name].meaning}
        labelled[name] = xr.DataArray(values, {name: (name, values, attrs)})
    return ss.ride_metrics(dataclasses.replace(vehicle, **labelled), ROAD, **options).transpose(*axes, ...)


def same(opened, wanted):
    xr.testing.assert_allclose(opened, wanted, rtol=1e-12, atol=0.0)
    assert set(opened.variables) == set(wanted.variables)
    for name, data in wanted.variables.items():
        assert (opened[name].dims, opened[name].attrs) == (data.dims, data.attrs)
        assert name in ("point", "corner", "axle", "seat") or opened[name].dtype == np.float64


# One stiffness for all wheels would flatten a truck.
@pytest.mark.parametrize("model", [name for name in models() if name != "three-axle"])
def test_store_opens_as_the_metrics(model, store):
    swept = sweep(models()[model](), ROAD, AXES, store)
    assert swept == Swept(designs=40, chunks=CHUNKS, found=0, computed=40)
    same(xr.open_zarr(store), expected(models()[model](), AXES))
    assert zarr.open_group(store, mode="r").metadata.zarr_format == 3
    assert sorted(path.name for path in store.parent.iterdir()) == ["out.zarr"]


def test_axes_in_any_number_and_order(store):
    car = ss.FullCar(cs=ss.Corners.axles(front=1400.0, rear=1700.0), kt=ss.Corners.axles(front=18e4, rear=2e5))
    axes = {"ks": [15e3, 18e3, 21e3], "arb_rear": [0.0], "mb": [1200.0, 1100.0, 1300.0, 1400.0, 1250.0]}
    assert sweep(car, ROAD, axes, store).chunks == 2
    opened = xr.open_zarr(store)
    same(opened, expected(car, {name: np.array(values) for name, values in axes.items()}))
    assert opened.sws.dims == ("ks", "arb_rear", "mb", "corner")
    assert opened.mb.attrs["units"] == "kg"


def test_another_method(store):
    axes = {"cs": np.array([1000.0, 2000.0])}
    sweep(ss.QuarterCar(), ROAD, axes, store, "spectral")
    same(xr.open_zarr(store), expected(ss.QuarterCar(), axes, method="spectral"))


def test_outputs_and_dtype(run, store, tmp_path):
    line = ["--model", "full", *LINE[2:], store, "--outputs", "bacc@cg,sws, dtl@rl", "--dtype", "float32"]
    assert run("sweep", *line)[0] == 0
    opened, every = xr.open_zarr(store), expected(ss.FullCar(), AXES)
    wanted = {"bacc_cg": every.bacc.sel(point="cg"), "sws": every.sws, "dtl_rl": every.dtl.sel(corner="rl")}
    assert set(opened.data_vars) == set(wanted)
    for name, data in wanted.items():
        assert opened[name].dtype == np.float32
        assert opened[name].attrs["units"] == data.attrs["units"]
        np.testing.assert_array_equal(opened[name], data.astype(np.float32))
    assert opened.dtl_rl.attrs["long_name"] == f"{every.dtl.attrs['long_name']} at rl"
    assert set(opened.coords) == {"ks", "cs", "corner"}


def test_a_store_says_what_it_holds(store):
    sweep(ss.FullCar(mb=1300.0), ROAD, AXES, store, outputs=["sws"])
    attrs = xr.open_zarr(store).attrs
    assert attrs["susp_ss"] == ss.__version__
    assert (attrs["model"], attrs["parameter mb"]) == ("full", "value 1300.0, unit kg")
    assert (attrs["road speed"], attrs["road tracks"]) == ("20.0", "isotropic")
    assert (attrs["method"], attrs["outputs"], attrs["dtype"]) == ("covariance", "sws", "float64")
    assert attrs["axes"] == "ks, cs"
    assert zarr.open_array(store, path="sweep/done", mode="r")[...].all()


def test_a_chunk_of_designs_is_a_file_and_a_place_can_be_read_alone(store):
    sweep(ss.FullCar(), ROAD, AXES, store)
    sws = zarr.open_array(store, path="sws", mode="r")
    assert (sws.chunks, sws.shards) == ((2, 5, 1), (2, 5, 4))
    assert sum(path.is_file() for path in (store / "sws" / "c").rglob("*")) == CHUNKS
    assert sum(path.is_file() for path in (store / "sweep" / "done" / "c").rglob("*")) == 1


@pytest.mark.parametrize(
    ("sizes", "most", "chunk"),
    [
        ({"ks": 1000, "cs": 1000}, 131072, {"ks": 125, "cs": 1000}),
        ({"ks": 10, "cs": 10}, 131072, {"ks": 10, "cs": 10}),
        ({"ks": 3, "mu": 7, "cs": 10**6}, 131072, {"ks": 1, "mu": 1, "cs": 125000}),
        ({"ks": 9, "mu": 5, "cs": 4}, 8, {"ks": 1, "mu": 2, "cs": 4}),
    ],
)
def test_chunks_are_even(sizes, most, chunk):
    assert susp_ss.sweep.plan.chunks(sizes, most) == chunk


def test_regions_cover_every_design_once():
    sizes, chunk = {"ks": 7, "mu": 5, "cs": 4}, {"ks": 2, "mu": 3, "cs": 4}
    times = xr.DataArray(np.zeros(tuple(sizes.values())), dims=tuple(sizes))
    for region in susp_ss.sweep.plan.regions(sizes, chunk).values():
        times[region] += 1.0
    assert (times == 1.0).all()


# --- What dies on the way ---------------------------------------------------------------------------------------------


class Stop(Exception):
    pass


PARTS = {"before it": (), "in its midst": ("bacc", "sws"), "before its mark": ("bacc", "sws", "dtl", "damper_power")}


@pytest.mark.parametrize("after", PARTS.values(), ids=PARTS.keys())
def test_only_unfinished_chunks_are_computed_again(after, store, undisturbed, monkeypatch):
    with monkeypatch.context() as patch:
        stopping(patch, raising(Stop()), 3, after)
        with pytest.raises(Stop):
            sweep(ss.QuarterCar(), ROAD, AXES, store)
    assert zarr.open_group(store, path="sweep", mode="r")["done"][...].sum() == 2
    metrics, sizes = susp_ss.sweep.plan.block_metrics, []

    def counted(block, *rest):
        sizes.append(block.sizes["ks"] * block.sizes["cs"])
        return metrics(block, *rest)

    with monkeypatch.context() as patch:
        patch.setattr(susp_ss.sweep.plan, "block_metrics", counted)
        assert sweep(ss.QuarterCar(), ROAD, AXES, store) == Swept(designs=40, chunks=CHUNKS, found=2, computed=20)
        assert sizes == [10, 10]
        assert sweep(ss.QuarterCar(), ROAD, AXES, store) == Swept(designs=40, chunks=CHUNKS, found=4, computed=0)
        assert sizes == [10, 10]
    assert files(store) == undisturbed()


@pytest.mark.parametrize("after", list(PARTS.values())[1:], ids=list(PARTS)[1:])
def test_killed_process(after, store, undisturbed, run):
    assert process(stopped_by(signal.SIGKILL, 3, after), *LINE, store).returncode == -signal.SIGKILL
    assert zarr.open_group(store, path="sweep", mode="r")["done"][...].sum() <= 3
    resumed = run("sweep", *LINE, store)
    assert resumed.code == 0
    assert "40 designs in 4 chunks" in resumed.err
    assert files(store) == undisturbed()


def test_killed_while_the_store_is_laid_out(store, undisturbed, run):
    program = "import zarr\nzarr.consolidate_metadata = lambda path: os.kill(os.getpid(), signal.SIGKILL)\n"
    assert process(program, *LINE, store).returncode == -signal.SIGKILL
    assert not store.exists()
    assert run("sweep", *LINE, store).code == 0
    assert files(store) == undisturbed()


def test_interrupted(store, undisturbed, run):
    stopped = process(stopped_by(signal.SIGINT, 2), *LINE, store)
    assert stopped.returncode == 130
    (line,) = stopped.stderr.splitlines()
    assert line.startswith(f"susp-ss: stopped: store {store}: ")
    assert "of 4 chunks are unfinished; run the same sweep again to resume" in line
    assert run("sweep", *LINE, store).code == 0
    assert files(store) == undisturbed()


def test_a_disk_that_takes_no_more(store, undisturbed, run):
    """Files of at most 60 bytes, once the store is laid out: no chunk fits in."""
    limit = (
        "import susp_ss.sweep.run\n"
        "lay_out = susp_ss.sweep.run.lay_out\n"
        "def limited(*arguments):\n"
        "    lay_out(*arguments)\n"
        "    resource.setrlimit(resource.RLIMIT_FSIZE, (60, 60))\n"
        "susp_ss.sweep.run.lay_out = limited\n"
    )
    full = process(limit, *LINE, store)
    assert full.returncode == 2
    assert full.stderr == (
        f"susp-ss: error: store {store}: File too large; 4 of 4 chunks are unfinished; run the same sweep again to "
        "resume\n"
    )
    assert run("sweep", *LINE, store).code == 0
    assert files(store) == undisturbed()


@pytest.mark.parametrize("n", [1, 2, 4])
def test_a_disk_that_fills_up(n, store, undisturbed, monkeypatch):
    with monkeypatch.context() as patch:
        stopping(patch, raising(OSError(28, "No space left on device")), n, ["bacc"])
        said = f"out.zarr: No space left on device; {CHUNKS + 1 - n} of {CHUNKS} chunks are unfinished; .* to resume"
        with pytest.raises(OSError, match=said):
            sweep(ss.QuarterCar(), ROAD, AXES, store)
    sweep(ss.QuarterCar(), ROAD, AXES, store)
    assert files(store) == undisturbed()


@pytest.mark.skipif(os.geteuid() == 0, reason="root may write anywhere")
def test_a_folder_that_may_not_be_written(tmp_path):
    tmp_path.chmod(0o500)
    with pytest.raises(PermissionError):
        sweep(ss.QuarterCar(), ROAD, AXES, tmp_path / "out.zarr")


# --- What is refused --------------------------------------------------------------------------------------------------


OTHERS = {
    "model": ((ss.RigidTyreQuarterCar(), ROAD, AXES, {}), "model is quarter there and rigid-tyre here"),
    "parameter": ((ss.QuarterCar(mu=50.0), ROAD, AXES, {}), "parameter mu is .*45.4.* there and .*50.0.* here"),
    "road": ((ss.QuarterCar(), ss.Road(speed=30.0), AXES, {}), "road speed is 20.0 there and 30.0 here"),
    "wheels": ((ss.QuarterCar(), ss.Road(delay=False), AXES, {}), "road delay is True there and False here"),
    "nodes": (
        (ss.QuarterCar(), ROAD, {**AXES, "cs": [1e3, 2e3]}, {}),
        "axis cs is 5 nodes from 800.0 to 2200.0 .* there and 2 nodes from 1000.0 to 2000.0",
    ),
    "a node": ((ss.QuarterCar(), ROAD, {**AXES, "cs": AXES["cs"] ** 1.0 + [0, 1, 0, 0, 0]}, {}), "axis cs is 5 nodes"),
    "order": ((ss.QuarterCar(), ROAD, dict(reversed(AXES.items())), {}), "axes is ks, cs there and cs, ks here"),
    "method": ((ss.QuarterCar(), ROAD, AXES, {"method": "spectral"}), "method is covariance there and spectral here"),
    "outputs": (
        (ss.QuarterCar(), ROAD, AXES, {"outputs": ["sws"]}),
        "outputs is bacc, sws, dtl, damper_power, tyre_deflection, sws_rate there and sws here",
    ),
    "dtype": (
        (ss.QuarterCar(), ROAD, AXES, {"dtype": "float32"}),
        "dtype is float64 there and float32 here",
    ),
}


@pytest.mark.parametrize(("other", "said"), OTHERS.values(), ids=OTHERS.keys())
def test_a_store_of_another_sweep(other, said, store):
    car, road, axes, how = other
    sweep(ss.QuarterCar(), ROAD, AXES, store)
    before = files(store)
    with pytest.raises(ValueError, match=f"out.zarr is of another sweep: .*{said}"):
        sweep(car, road, axes, store, **how)
    assert files(store) == before


def test_a_store_of_another_version(store, monkeypatch):
    sweep(ss.QuarterCar(), ROAD, AXES, store)
    with monkeypatch.context() as patch:
        patch.setattr(susp_ss.sweep.plan, "__version__", "9.0")
        with pytest.raises(ValueError, match=r"susp_ss is 0.1.0 there and 9.0 here"):
            sweep(ss.QuarterCar(), ROAD, AXES, store)
    path = store / "sweep" / "zarr.json"
    held = json.loads(path.read_text())
    held["attributes"] |= {"store version": 3, "susp_ss": "9.0"}
    path.write_text(json.dumps(held))
    with pytest.raises(ValueError, match=r"has version 3, and this susp_ss .* reads version 2; use the susp_ss 9.0"):
        sweep(ss.QuarterCar(), ROAD, AXES, store)


def test_what_is_no_store(tmp_path):
    (tmp_path / "file").write_text("mine")
    (tmp_path / "folder").mkdir()
    (tmp_path / "folder" / "file").write_text("mine")
    xr.Dataset({"mine": ("x", [1.0])}).to_zarr(tmp_path / "other.zarr", zarr_format=3, consolidated=False)
    before = files(tmp_path)
    for name in ("file", "folder", "other.zarr"):
        with pytest.raises(ValueError, match=f"{name} exists and is not a store of a sweep; pass another name"):
            sweep(ss.QuarterCar(), ROAD, AXES, tmp_path / name)
    assert files(tmp_path) == before


WRONG = {
    "no axes": ((ss.QuarterCar(), ROAD, {}), "axes must name at least one parameter, available: ms, mu, ks"),
    "unknown axis": ((ss.QuarterCar(), ROAD, {"arb": [1.0]}), "no parameter named 'arb', available: ms, mu, ks"),
    "a grid": ((ss.QuarterCar(), ROAD, {"ks": np.ones((2, 2))}), r"axes\['ks'\] must be a row of different numbers"),
    "text": ((ss.QuarterCar(), ROAD, {"ks": ["a"]}), r"axes\['ks'\] must be a row"),
    "twice the same": ((ss.QuarterCar(), ROAD, {"ks": [1e4, 1e4]}), r"axes\['ks'\] must be a row of different"),
    "empty": ((ss.QuarterCar(), ROAD, {"ks": []}), "got an empty array"),
    "negative": ((ss.QuarterCar(), ROAD, {"ks": [1e4, -1.0]}), r"QuarterCar\(ks=...\) must be > 0 N/m, got -1.0"),
    "array": ((ss.QuarterCar(mu=np.array([4.0, 5.0])), ROAD, AXES), r"QuarterCar\(mu=...\) .* a number, or an axis"),
    "speeds": ((ss.QuarterCar(), ss.Road(speed=np.array([1.0, 2.0])), AXES), "one speed, roughness and cutoff"),
    "method": ((ss.QuarterCar(), ROAD, AXES, "time"), "method of a sweep must be one of covariance, spectral"),
    "no vehicle": (("full", ROAD, AXES), "vehicle must be"),
}


KEPT = {
    "unknown": ({"outputs": ["bacc", "jerk"]}, "outputs: no metric named 'jerk', available: bacc, sws, dtl"),
    "no place": ({"outputs": ["sws@front"]}, "outputs: sws has no corner named 'front', available: fr, fl, rr, rl"),
    "one place": ({"outputs": ["pitch_acc@cg"]}, "outputs: pitch_acc has one place only, .*; pass pitch_acc"),
    "twice": ({"outputs": ["sws", "sws"]}, "outputs must be different names, got sws, sws"),
    "text": ({"outputs": "sws"}, r'outputs must be names such as \("bacc@fr", "sws"\)'),
    "nothing": ({"outputs": []}, "outputs must be names such as"),
    "dtype": ({"dtype": "float16"}, "dtype of a sweep must be one of float64, float32, got 'float16'"),
}


@pytest.mark.parametrize(("how", "said"), KEPT.values(), ids=KEPT.keys())
def test_what_to_keep_is_refused_before_anything_is_written(how, said, store):
    with pytest.raises(ValueError, match=said):
        sweep(ss.FullCar(), ROAD, AXES, store, **how)
    assert list(store.parent.iterdir()) == []


@pytest.mark.parametrize(("arguments", "said"), WRONG.values(), ids=WRONG.keys())
def test_refused_before_anything_is_written(arguments, said, store):
    car, road, axes, *method = arguments
    with pytest.raises((TypeError, ValueError), match=said):
        sweep(car, road, axes, store, *method)
    assert list(store.parent.iterdir()) == []


def test_refused_design(store):
    """The other designs of its chunk are not marked; those of other chunks may be."""
    axes = {"ks": AXES["ks"], "cs": [1e3, 2e3, 3e3, 4e3, 0.0]}
    with pytest.raises(ValueError, match=r"cs > 0 at every corner at \(ks=\d+.*, cs=0.0\)"):
        sweep(ss.QuarterCar(), ROAD, axes, store)
    assert zarr.open_group(store, path="sweep", mode="r")["done"][...].sum() == 0


def test_a_sweep_over_speeds_is_each_of_its_roads(store):
    speeds = np.array([5.0, 20.0, 35.0])
    sweep(ss.FullCar(), ss.Road(tracks="isotropic"), {"ks": np.array([15e3, 20e3]), "speed": speeds}, store)
    with xr.open_zarr(store) as found:
        assert found.speed.attrs["units"] == "m/s"
        for i, speed in enumerate(speeds):
            alone = ss.ride_metrics(ss.FullCar(ks=20e3), ss.Road(speed=speed, tracks="isotropic"))
            for name, data in alone.items():
                np.testing.assert_allclose(found[name].isel(ks=1, speed=i), data, rtol=1e-12, err_msg=name)


# --- The command line -------------------------------------------------------------------------------------------------


def test_command_equals_the_library(run, store, undisturbed):
    code, out, err = run("sweep", *LINE, store)
    assert (code, out) == (0, "")
    assert "40 designs in 4 chunks, 0 of them finished before; 40 designs computed" in err
    assert files(store) == undisturbed()
    code, out, err = run("sweep", *LINE, store)
    scenario = f"QuarterCar over ks, cs; {ROAD.describe()}"
    assert (code, err) == (0, f"{scenario}\n{store}: 40 designs in 4 chunks, 4 of them finished before\n")


def test_axes_of_some_wheels_keep_the_others(tmp_path):
    car = ss.FullCar(ks=ss.Corners.axles(front=18e3, rear=21e3))
    sweep(car, ROAD, {"ks_rear": [20e3, 22e3], "cs_fl": [1e3, 2e3]}, tmp_path / "out.zarr")
    cs = ss.Corners(fr=1516.5, fl=2e3, rr=1516.5, rl=1516.5)
    one = ss.ride_metrics(dataclasses.replace(car, ks=ss.Corners.axles(front=18e3, rear=22e3), cs=cs), ROAD)
    swept = xr.open_zarr(tmp_path / "out.zarr").sel(ks_rear=22e3, cs_fl=2e3, drop=True)
    xr.testing.assert_allclose(swept, one, rtol=1e-12)
    with pytest.raises(ValueError, match=r"ks would give fr, fl, rr, rl one value .* set ks_front, ks_rear, ks_fr"):
        sweep(car, ROAD, {"ks": [20e3, 22e3]}, tmp_path / "flat.zarr")
    with pytest.raises(ValueError, match="axes ks_rear and ks_left both set ks at rl"):
        sweep(ss.FullCar(), ROAD, {"ks_rear": [2e4, 3e4], "ks_left": [2e4, 3e4]}, tmp_path / "two.zarr")


def test_command_with_files_and_more(run, tmp_path):
    (tmp_path / "car.toml").write_text('model = "full"\n[parameters]\nmb = { value = 1.2, unit = "t" }\n')
    car = [
        "--vehicle",
        tmp_path / "car.toml",
        "--ks",
        "2e4",
        "--mu",
        "50",
        "--tracks",
        "isotropic",
        "--road-class",
        "C",
    ]
    more = ["--more", "arb_front=0:1e4:2", "--more", "a=1:1:1"]
    code, _, _ = run("sweep", *car, "--cs", "900:1500:3", *more, "--store", tmp_path / "out.zarr")
    assert code == 0
    opened = xr.open_zarr(tmp_path / "out.zarr")
    assert opened.bacc.dims == ("cs", "arb_front", "a", "point")
    one = ss.FullCar(mb=1200.0, ks=2e4, mu=50.0, cs=1200.0, arb_front=1e4, a=1.0)
    metrics = ss.ride_metrics(one, ss.Road.iso8608("C", tracks="isotropic"))
    xr.testing.assert_allclose(opened.sel(cs=1200.0, arb_front=1e4, a=1.0, drop=True), metrics, rtol=1e-12)


REFUSED = {
    "no range": ("--ks 2e4", "nothing to sweep", "LO:HI:N"),
    "nothing": ("", "nothing to sweep"),
    "two parts": ("--ks 1:2", "--ks must be LO:HI:N", "'1:2'"),
    "text": ("--ks a:b:3", "--ks: needs a number", "'a'"),
    "text for a number": ("--ks soft", "--ks: needs a number", "'soft'"),
    "half a node": ("--ks 1:2:2.5", "--ks must be LO:HI:N with a whole number N"),
    "no node": ("--ks 1e4:2e4:0", "--ks: N must be >= 1"),
    "downwards": ("--cs 2000:1000:5", "--cs: LO must be below HI"),
    "one value twice": ("--cs 2000:2000:5", "--cs: LO must be below HI"),
    "endless": ("--cs 2000:inf:5", "--cs must be finite", "'inf'"),
    "unknown": ("--more kx=1:2:3", "--more kx: FullCar has no parameter 'kx', available: mb, ixx"),
    "of another model": ("--model quarter --more mb=1:2:3", "QuarterCar has no parameter 'mb', available: ms, mu"),
    "no equals": ("--more mb", "--more must be PARAM=LO:HI:N", "'mb'"),
    "twice": ("--ks 1e4:2e4:3 --more ks=1e4:2e4:3", "--more ks: ks is given twice"),
    "negative": ("--ks=-1e4:2e4:3", "--ks must be > 0 N/m, got -10000.0"),
    "a file": ("--ks 1e4:2e4:3 --store bad", "bad exists and is not a store of a sweep"),
    "in a file": ("--ks 1e4:2e4:3 --store bad/out", "bad"),
    "unknown method": ("--ks 1e4:2e4:3 --method time", "covariance, spectral"),
}


@pytest.mark.parametrize(("line", "named"), [(row[0], row[1:]) for row in REFUSED.values()], ids=REFUSED.keys())
def test_refused_in_one_line(line, named, run, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "bad").write_text("mine")
    code, out, err = run("sweep", *([] if "--store" in line else ["--store", "out.zarr"]), *line.split())
    assert (code, out) == (2, "")
    assert err.startswith("susp-ss: error: ")
    assert err.count("\n") == 1
    for part in named:
        assert part in err
    assert [path.name for path in tmp_path.iterdir()] == ["bad"]


@pytest.mark.parametrize("library", ["dask.array", "zarr", "distributed"])
def test_a_missing_library_names_the_extra(library, run, store, monkeypatch):
    monkeypatch.setitem(sys.modules, library, None)
    code, _, err = run("sweep", *LINE, store, "--scheduler", "tcp://127.0.0.1:9")
    assert code == 2
    assert err == (
        f"susp-ss: error: a sweep needs {library.partition('.')[0]}, which is not installed; "
        f"run {installation('distributed')}\n"
    )


def test_progress_is_shown_on_stderr(store, capsys, monkeypatch):
    monkeypatch.setattr(susp_ss.progress, "EVERY", 0.0)
    sweep(ss.QuarterCar(), ROAD, AXES, store, progress=True)
    captured = capsys.readouterr()
    assert captured.out == ""
    assert captured.err.splitlines() == [f"sweeping: {done} of 4" for done in (1, 2, 3, 4)]
