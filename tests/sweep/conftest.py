"""Chunks small enough for tests."""

import pytest
from disturbed import AXES, load_once, undisturbed_files

import susp_ss as ss
import susp_ss.sweep.plan


@pytest.fixture(autouse=True, scope="module")
def few_designs():
    with pytest.MonkeyPatch.context() as patch:
        patch.setitem(susp_ss.sweep.plan.MOST_DESIGNS, "covariance", 12)
        yield


@pytest.fixture(autouse=True, scope="session")
def loaded_once():
    with load_once():
        yield


@pytest.fixture
def store(tmp_path):
    return tmp_path / "out.zarr"


@pytest.fixture(scope="module")
def undisturbed(tmp_path_factory):
    """The files of a sweep that nothing disturbs, each swept once."""
    swept = {}

    def of(vehicle=ss.QuarterCar(), axes=AXES, **how):  # noqa: B008
        which = repr((vehicle, axes, how))
        if which not in swept:
            swept[which] = undisturbed_files(tmp_path_factory.mktemp("undisturbed"), vehicle, axes, **how)
        return swept[which]

    return of
