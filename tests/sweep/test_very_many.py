"""The example of reductions: what it finds block by block is what all designs in memory give."""

import importlib.util
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import susp_ss as ss

SCRIPT = Path(__file__).parents[2] / "examples" / "very_many.py"


@pytest.fixture(scope="module")
def example():
    spec = importlib.util.spec_from_file_location(SCRIPT.stem, SCRIPT)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def beaten(points):
    """Whether another point is at least as good in both coordinates and better in one, pair by pair."""
    no_worse = (points[:, None, :] <= points[:, :, None]).all(axis=0)
    better = (points[:, None, :] < points[:, :, None]).any(axis=0)
    return (no_worse & better).any(axis=1)


@given(st.lists(st.tuples(st.integers(0, 6), st.integers(0, 6)), min_size=1, max_size=40))
def test_front(example, pairs):
    points = np.array(pairs, dtype=float).T
    kept = example.front(points)
    assert set(map(tuple, kept.T)) == set(map(tuple, points[:, ~beaten(points)].T))
    assert len(set(map(tuple, kept.T))) == kept.shape[1]


def test_blocks_find_what_memory_finds(example, monkeypatch):
    monkeypatch.setattr(example, "BLOCK", 100)
    car = example.grid((20, 15, 3))
    found = example.reduced(car, ss.Road())
    loaded = {name: getattr(car, name).compute() for name in example.RANGES}
    assert car.ks.data.npartitions > 1
    whole = ss.ride_metrics(ss.QuarterCar(**loaded), ss.Road())
    assert found.softest == pytest.approx(float(whole.bacc.min()), rel=1e-12)
    width = example.MOST_TRAVEL / example.BINS
    assert float(whole.sws.max()) < example.MOST_TRAVEL
    steps = np.quantile(whole.sws, example.QUANTILES, method="inverted_cdf")
    np.testing.assert_allclose(found.quantiles, steps, atol=2.0 * width)
    points = np.stack([whole.bacc.values.ravel(), whole.sws.values.ravel()])
    np.testing.assert_allclose(found.front, example.front(points), rtol=1e-12)
    assert not beaten(found.front).any()


def test_runs_as_a_command(example, capsys):
    example.main(["--nodes", "10", "10", "2"])
    assert capsys.readouterr().out.startswith("200 quarter cars: softest 0.")
