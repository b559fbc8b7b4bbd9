"""The engine in JavaScript, written once, and in one page of a browser."""

import pytest

from susp_ss.explorer.javascript import engine


@pytest.fixture(scope="session")
def script():
    return engine()


@pytest.fixture(scope="package")
def ask(browser, script):
    """Call a function of the engine for each of some states."""
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
