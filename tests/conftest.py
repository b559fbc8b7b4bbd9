"""What several tests use."""

import contextlib
import functools
import os
import shutil
import sys
from typing import NamedTuple

import hypothesis
import pytest
import typer.main

from susp_ss import progress
from susp_ss.cli import main

# Machines differ in speed and are shared: no test fails by the clock. Where a change is judged, the same examples are
# tried each time; elsewhere, new ones.
hypothesis.settings.register_profile(
    "any machine",
    deadline=None,
    derandomize="CI" in os.environ,
    suppress_health_check=[hypothesis.HealthCheck.too_slow],
)
hypothesis.settings.load_profile("any machine")


BROWSERS = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable", "chrome")
# WebGL without a graphics card, and no traffic of the browser's own.
SWITCHES = [
    "--no-sandbox",
    "--disable-gpu",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--disable-quic",
    "--no-first-run",
]


class Ran(NamedTuple):
    """What a command line came to."""

    code: int
    out: str
    err: str


@pytest.fixture
def run(capsys):
    """Run a command line; return exit code, stdout and stderr."""

    def ran(*arguments):
        with pytest.raises(SystemExit) as end:
            main(list(map(str, arguments)))
        captured = capsys.readouterr()
        return Ran(end.value.code, captured.out, captured.err)

    return ran


@pytest.fixture(autouse=True, scope="session")
def commands_built_once():
    """A process of ours reads one command line, for which all commands are built; that of the tests reads hundreds."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(typer.main, "get_command", functools.cache(typer.main.get_command))
        yield


@pytest.fixture
def missing(monkeypatch):
    """Make a library seem not installed, and forget what has loaded it already."""

    def hide(library, loaded_by=()):
        for name in list(sys.modules):
            if f"{name}.".startswith((f"{library}.", *(f"{module}." for module in loaded_by))):
                # Its package knows it by an attribute as well, which must be the old one again afterwards.
                package, _, own = name.rpartition(".")
                if package in sys.modules:
                    monkeypatch.delattr(sys.modules[package], own, raising=False)
                monkeypatch.delitem(sys.modules, name)
        monkeypatch.setitem(sys.modules, library, None)

    return hide


@pytest.fixture(autouse=True, scope="session")
def no_lines_by_the_clock():
    """Off a terminal, progress is a line every ten seconds; what a test reads must not hang on the machine's speed."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(progress, "EVERY", float("inf"))
        yield


@pytest.fixture(scope="session")
def browser():
    found = next(filter(None, map(shutil.which, BROWSERS)), None)
    if found is None:
        pytest.skip(f"no browser to open the page in: none of {', '.join(BROWSERS)} is installed")
    from playwright.sync_api import sync_playwright

    with sync_playwright() as driver:
        running = driver.chromium.launch(executable_path=found, args=SWITCHES)
        yield running
        running.close()


@contextlib.contextmanager
def pages(browser):
    """Open pages; at the end, nothing must have gone wrong or been asked of the network."""
    wrong, contexts = [], []

    def open_page(path, width=1000, **context):
        contexts.append(browser.new_context(viewport={"width": width, "height": 900}, **context))
        contexts[-1].set_default_timeout(0)
        tab = contexts[-1].new_page()
        tab.on("console", lambda message: wrong.append(message.text) if message.type == "error" else None)
        tab.on("pageerror", lambda error: wrong.append(str(error)))
        tab.on("dialog", lambda dialog: (wrong.append(dialog.message), dialog.dismiss()))
        tab.on("request", lambda request: open_page.asked.append(request.url))
        tab.goto(path.as_uri())
        return tab

    open_page.asked = []
    yield open_page
    assert wrong == []
    assert all(url.startswith(("file:", "data:", "blob:")) for url in open_page.asked), open_page.asked
    for context in contexts:
        context.close()


@pytest.fixture
def opened(browser):
    """Open a page of its own."""
    with pages(browser) as open_page:
        yield open_page


@pytest.fixture(scope="session")
def script():
    """The explorer's engine in JavaScript."""
    from susp_ss.explorer.javascript import engine

    return engine()


@pytest.fixture(scope="session")
def ask(browser, script):
    """Call a function of the explorer's engine for each of some states, in one page."""
    page = browser.new_page()
    wrong = []
    page.on("pageerror", lambda error: wrong.append(str(error)))
    page.add_script_tag(content=script)

    def asked(function, states):
        return page.evaluate(
            "([name, states]) => states.map((one) => dash_clientside.engine[name](one))", [function, states]
        )

    yield asked
    page.close()
    assert wrong == []


@pytest.fixture(scope="module")
def few_runs():
    """Optimise a study on surrogates of five runs alone."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("susp_ss.study.feasibility.RUNS", (5,))
        yield
