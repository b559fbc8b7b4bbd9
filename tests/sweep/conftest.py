"""Chunks small enough for tests."""

import pytest
from disturbed import AXES, undisturbed_files

import susp_ss as ss
import susp_ss.sweep.plan


@pytest.fixture(autouse=True)
def few_designs(monkeypatch):
    monkeypatch.setitem(susp_ss.sweep.plan.MOST_DESIGNS, "covariance", 12)


@pytest.fixture
def store(tmp_path):
    return tmp_path / "out.zarr"


@pytest.fixture
def undisturbed(tmp_path):
    """The files of a sweep that nothing disturbs."""

    def swept(vehicle=ss.QuarterCar(), axes=AXES, **how):  # noqa: B008
        return undisturbed_files(tmp_path, vehicle, axes, **how)

    return swept
