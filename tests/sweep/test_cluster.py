"""Sweeps past one machine: workers write for themselves, into folders and object stores; what dies loses nothing."""

import importlib.util
import os
import signal
import sys
import warnings

import numpy as np
import pytest
import xarray as xr
import zarr
from distributed import Client, LocalCluster
from disturbed import AXES, CHUNKS, LINE, ROAD, files, process, stopped_by

import susp_ss as ss
import susp_ss.sweep.computing
import susp_ss.sweep.run
from susp_ss.extras import installation
from susp_ss.sweep import Swept, sweep

CAR = ss.FullCar(kt=ss.Corners(fr=18e4, fl=19e4, rr=2e5, rl=21e4))
SPRINGS = {"ks": np.linspace(12e3, 25e3, 600)}
"""Fifty chunks of a car that takes its time."""


@pytest.fixture(scope="module")
def cluster():
    with LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=":0") as running:
        yield running


@pytest.fixture
def at_mark(monkeypatch):
    """Carry something out as the marks are written for the n-th time; what they were then."""

    def arranged(n, action):
        mark, marks = susp_ss.sweep.run.mark, []

        def acting(place, done):
            marks.append(done)
            if len(marks) == n:
                action()
            mark(place, done)

        monkeypatch.setattr(susp_ss.sweep.run, "mark", acting)
        return marks

    return arranged


@pytest.fixture
def written_here(monkeypatch):
    """Regions that this process writes itself."""
    write, regions = susp_ss.sweep.computing.write, []

    def counted(place, region, metrics):
        regions.append(region)
        write(place, region, metrics)

    monkeypatch.setattr(susp_ss.sweep.computing, "write", counted)
    return regions


def test_workers_write_for_themselves(cluster, store, undisturbed, written_here):
    axes = {**AXES, "mu": [40.0, 50.0]}
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert sweep(ss.QuarterCar(), ROAD, axes, store, scheduler=cluster.scheduler_address).computed == 80
    assert written_here == []
    assert files(store) == undisturbed(axes=axes)


def test_relative_path_is_of_this_process(cluster, tmp_path, undisturbed, monkeypatch, written_here):
    monkeypatch.chdir(tmp_path)
    sweep(ss.QuarterCar(), ROAD, AXES, "out.zarr", scheduler=cluster.scheduler_address)
    assert written_here == []
    assert files(tmp_path / "out.zarr") == undisturbed()


def test_what_workers_cannot_write_travels(cluster, store, undisturbed, written_here, monkeypatch):
    """Workers that find another run's name in the store, as in a folder of the same name on another machine."""
    submit = Client.submit

    def elsewhere(self, work, task, place, **how):
        return submit(self, work, task, place._replace(run="another"), **how)

    monkeypatch.setattr(Client, "submit", elsewhere)
    said = r"out.zarr: the worker at tcp://.* cannot write there \(what is reached at .* is another store"
    with pytest.warns(UserWarning, match=said) as warned:
        sweep(ss.QuarterCar(), ROAD, AXES, store, scheduler=cluster.scheduler_address)
    assert len([one for one in warned if "cannot write there" in str(one.message)]) == 1
    assert len(written_here) == CHUNKS
    assert files(store) == undisturbed()


def test_killed_worker(cluster, store, undisturbed, at_mark):
    """A worker dies as the second marks are written, and with it what it was computing or writing."""
    pids = {worker.pid for worker in cluster.workers.values()}
    marks = at_mark(2, lambda: os.kill(min(pids), signal.SIGKILL))
    assert sweep(CAR, ROAD, SPRINGS, store, scheduler=cluster.scheduler_address).computed == 600
    assert marks[-1].sum() == marks[-1].size == 50
    assert files(store) == undisturbed(CAR, SPRINGS)


def test_killed_process_of_a_cluster(cluster, store, undisturbed, run):
    kill = (
        "import susp_ss.sweep.run\n"
        "mark = susp_ss.sweep.run.mark\n"
        "def killing(place, done):\n"
        "    mark(place, done)\n"
        "    if done.sum() >= 2:\n"
        f"        os.kill(os.getpid(), {int(signal.SIGKILL)})\n"
        "susp_ss.sweep.run.mark = killing\n"
    )
    line = [*LINE, store, "--scheduler", cluster.scheduler_address]
    assert process(kill, *line).returncode == -signal.SIGKILL
    found = int(zarr.open_array(store, path="sweep/done", mode="r")[...].sum())
    assert found >= 2
    resumed = run("sweep", *line)
    assert resumed.code == 0
    assert f"40 designs in 4 chunks, {found} of them finished before" in resumed.err
    assert files(store) == undisturbed()


def test_a_store_that_goes_away_for_a_while(cluster, tmp_path, undisturbed, at_mark):
    """A folder that is reached by a link, as by a mount, which is lost at the second marks and comes back."""

    def link(target):
        (tmp_path / "new").symlink_to(target)
        (tmp_path / "new").replace(tmp_path / "share")

    (tmp_path / "disk").mkdir()
    link(tmp_path / "disk")
    store = tmp_path / "share" / "out.zarr"
    at_mark(2, lambda: link(tmp_path / "nowhere"))
    with pytest.raises(OSError, match=r"of 50 chunks are unfinished; run the same sweep again to resume"):
        sweep(CAR, ROAD, SPRINGS, store, scheduler=cluster.scheduler_address)
    assert not (tmp_path / "nowhere").exists()
    link(tmp_path / "disk")
    before = int(zarr.open_array(store, path="sweep/done", mode="r")[...].sum())
    assert 1 <= before < 50
    assert sweep(CAR, ROAD, SPRINGS, store, scheduler=cluster.scheduler_address).found == before
    assert files(store) == undisturbed(CAR, SPRINGS)


def test_a_lost_scheduler(store, undisturbed, at_mark):
    """What was marked before stays, and this machine goes on alone."""
    with LocalCluster(n_workers=1, threads_per_worker=1, dashboard_address=":0") as lost:
        at_mark(2, lost.close)
        with pytest.raises(OSError, match=r"the Dask scheduler at tcp://.* is lost; \d+ of 50 chunks are unfinished"):
            sweep(CAR, ROAD, SPRINGS, store, scheduler=lost.scheduler_address)
    assert 1 <= sweep(CAR, ROAD, SPRINGS, store).found < 50
    assert files(store) == undisturbed(CAR, SPRINGS)


def test_refused_design_on_a_cluster(cluster, store):
    with pytest.raises(ValueError, match=r"cs > 0 at every corner at \(ks=\d+.*, cs=0.0\)"):
        sweep(ss.QuarterCar(), ROAD, {**AXES, "cs": [1e3, 0.0]}, store, scheduler=cluster.scheduler_address)
    assert zarr.open_group(store, path="sweep", mode="r")["done"][...].sum() == 0


def test_unreachable_scheduler(store, run, monkeypatch):
    monkeypatch.setattr(susp_ss.sweep.computing, "ANSWER", 1.0)
    code, _, err = run("sweep", *LINE, store, "--scheduler", "tcp://127.0.0.1:9")
    assert code == 2
    assert err.splitlines()[-1] == (
        "susp-ss: error: no Dask scheduler answers at 'tcp://127.0.0.1:9' within 1 s; start one with: dask scheduler"
    )
    assert not store.exists()


def test_scheduler_without_workers(store, monkeypatch):
    monkeypatch.setattr(susp_ss.sweep.computing, "WORKER", 0.2)
    with (
        LocalCluster(n_workers=0, dashboard_address=":0") as idle,
        pytest.raises(ConnectionError, match="has no worker; start one with: dask worker tcp://"),
    ):
        sweep(ss.QuarterCar(), ROAD, AXES, store, scheduler=idle.scheduler_address)
    assert not store.exists()


# --- Object stores ----------------------------------------------------------------------------------------------------


MISSING = [name for name in ("s3fs", "moto", "flask", "flask_cors") if not importlib.util.find_spec(name)]

needs_s3 = pytest.mark.skipif(bool(MISSING), reason=f"an S3 server on loopback needs {', '.join(MISSING)}")


@pytest.fixture(scope="module")
def bucket():
    """A bucket of an S3 server on loopback, which this process and its children know from the environment."""
    import s3fs
    from moto.server import ThreadedMotoServer

    server = ThreadedMotoServer("127.0.0.1", 0, verbose=False)
    server.start()
    host, port = server.get_host_and_port()
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("AWS_ENDPOINT_URL", f"http://{host}:{port}")
        for name, value in (("ACCESS_KEY_ID", "me"), ("SECRET_ACCESS_KEY", "mine"), ("DEFAULT_REGION", "us-east-1")):
            patch.setenv(f"AWS_{name}", value)
        files = s3fs.S3FileSystem(skip_instance_cache=True, use_listings_cache=False)
        files.mkdir("designs")
        yield files
    server.stop()


@pytest.fixture
def url(bucket, request):
    return f"s3://designs/{request.node.name}.zarr"


@pytest.fixture
def objects(bucket, url):
    """Every object of the store and what it holds."""
    root = url.removeprefix("s3://")
    return lambda: {name.removeprefix(f"{root}/"): bucket.cat_file(name) for name in bucket.find(root)}


@needs_s3
def test_object_store(url, objects, undisturbed):
    assert sweep(ss.QuarterCar(), ROAD, AXES, url).computed == 40
    assert objects() == undisturbed()
    assert sweep(ss.QuarterCar(), ROAD, AXES, url) == Swept(designs=40, chunks=CHUNKS, found=4, computed=0)
    whole = ss.ride_metrics(ss.QuarterCar(ks=AXES["ks"][3], cs=AXES["cs"][2]), ROAD)
    opened = xr.open_zarr(url)
    xr.testing.assert_allclose(opened.isel(ks=3, cs=2, drop=True), whole, rtol=1e-12)
    with pytest.raises(ValueError, match=r"s3://.*zarr is of another sweep: road speed is 20.0 there and 30.0 here"):
        sweep(ss.QuarterCar(), ss.Road(speed=30.0, tracks="isotropic"), AXES, url)


@needs_s3
def test_workers_write_into_an_object_store(bucket, url, objects, undisturbed, written_here):
    """A cluster that is started later knows the server from its environment."""
    with LocalCluster(n_workers=1, threads_per_worker=1, dashboard_address=":0", env=dict(os.environ)) as late:
        assert sweep(ss.QuarterCar(), ROAD, AXES, url, scheduler=late.scheduler_address).computed == 40
    assert written_here == []
    assert objects() == undisturbed()


@needs_s3
def test_workers_that_do_not_reach_an_object_store(bucket, url, objects, undisturbed, written_here):
    """Workers that were started where nobody knew of the server."""
    with pytest.MonkeyPatch.context() as patch:
        for name in ("ENDPOINT_URL", "ACCESS_KEY_ID", "SECRET_ACCESS_KEY", "DEFAULT_REGION"):
            patch.delenv(f"AWS_{name}")
        apart = LocalCluster(n_workers=1, threads_per_worker=1, dashboard_address=":0")
    with apart, pytest.warns(UserWarning, match=r"s3://.*zarr: the worker at tcp://.* cannot write there"):
        sweep(ss.QuarterCar(), ROAD, AXES, url, scheduler=apart.scheduler_address)
    assert len(written_here) == CHUNKS
    assert objects() == undisturbed()


@needs_s3
def test_killed_process_of_an_object_store(url, objects, undisturbed, run):
    assert process(stopped_by(signal.SIGKILL, 3, ("bacc",)), *LINE, url).returncode == -signal.SIGKILL
    assert run("sweep", *LINE, url).code == 0
    assert objects() == undisturbed()


@needs_s3
@pytest.mark.parametrize("written", [1, 10])
def test_killed_while_an_object_store_is_laid_out(written, bucket, url, objects, undisturbed):
    """Laying out is begun again; what somebody else has there is not touched."""
    kill = (
        "import s3fs\n"
        "pipe, names = s3fs.S3FileSystem.pipe_file, []\n"
        "def killing(self, name, *rest, **more):\n"
        f"    if len(names) == {written}:\n"
        f"        os.kill(os.getpid(), {int(signal.SIGKILL)})\n"
        "    names.append(name)\n"
        "    pipe(self, name, *rest, **more)\n"
        "s3fs.S3FileSystem.pipe_file = killing\n"
    )
    assert process(kill, *LINE, url).returncode == -signal.SIGKILL
    assert len(objects()) == written
    sweep(ss.QuarterCar(), ROAD, AXES, url)
    assert objects() == undisturbed()


@needs_s3
def test_somebody_elses_objects(bucket, url, objects):
    bucket.pipe_file(f"{url}/mine.txt", b"mine")
    with pytest.raises(ValueError, match=r"zarr exists and is not a store of a sweep; pass another name"):
        sweep(ss.QuarterCar(), ROAD, AXES, url)
    assert objects() == {"mine.txt": b"mine"}


@needs_s3
def test_unreachable_object_store_is_one_line(bucket, run):
    code, _, err = run("sweep", *LINE, "s3://no-such-bucket/out.zarr")
    assert code == 2
    assert err.splitlines()[-1] == (
        "susp-ss: error: store s3://no-such-bucket/out.zarr: The specified bucket does not exist"
    )


def test_a_missing_library_of_an_object_store_names_the_extra(run, monkeypatch):
    monkeypatch.setitem(sys.modules, "s3fs", None)
    code, _, err = run("sweep", *LINE, "s3://designs/out.zarr")
    assert code == 2
    assert err == (
        f"susp-ss: error: store s3://designs/out.zarr needs s3fs, which is not installed; run {installation('s3')}\n"
    )


def test_unknown_kind_of_store(run):
    code, _, err = run("sweep", *LINE, "nowhere://designs/out.zarr")
    assert code == 2
    assert err.startswith("susp-ss: error: store nowhere://designs/out.zarr: ")
    assert err.count("\n") == 1


def test_a_folder_as_a_url(store, undisturbed):
    sweep(ss.QuarterCar(), ROAD, AXES, f"file://{store}")
    assert files(store) == undisturbed()
