"""The engine of the page without a server, written once."""

import pytest

from susp_ss.explorer.javascript import engine


@pytest.fixture(scope="session")
def script():
    return engine(["quarter"])
