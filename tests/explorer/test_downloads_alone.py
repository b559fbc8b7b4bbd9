"""Files that the page without a server makes, beside those of the server."""

import base64
import csv
import io
import re
import zipfile

import numpy as np
import pytest
from fmpy.validation import validate_fmu
from hypothesis import given, settings

from explored import states
from susp_ss.explorer.downloads import FILES
from susp_ss.explorer.freeze import freeze
from susp_ss.explorer.state import MODELS, NOTHING, from_query, query

TAKE = """async ([kind, state, query]) => {
    const { name, content, message } = dash_clientside.engine.file(kind, state, query);
    if (message) return { message };
    const bytes = new Uint8Array(await content.arrayBuffer());
    return { name, type: content.type, content: btoa(Array.from(bytes, (one) => String.fromCharCode(one)).join("")) };
}"""

DESIGNS = (
    "seat_x=0.2&ks_front=20000&arb_front=3000",
    "ct_front=120&model=full&b=1.6",
    "model=quarter&seat_mass=70&ct=20",
    "model=pitch-half&cs_rear=0",
    "model=roll-half&arb=4000",
    "curve_knee=0.08&cs_front=1300",
    "model=three-axle&ct_middle=20&ks_rear=300000",
)


@pytest.fixture(scope="module")
def take(browser, script):
    """Let the page make a file of a state: its bytes, or why it does not."""
    page = browser.new_page()
    page.add_script_tag(content=script)

    def taken(kind, state):
        found = page.evaluate(TAKE, [kind, state, query(state)])
        if "message" in found:
            return found["message"]
        assert found["name"] == FILES[kind].name
        assert found["type"] == FILES[kind].type
        return base64.b64decode(found["content"])

    yield taken
    page.close()


@given(states(models=MODELS))
@settings(max_examples=60)
def test_texts_are_those_of_the_server(take, state):
    for kind in ("toml", "py"):
        found = take(kind, state)
        if isinstance(found, str):
            with pytest.raises(ValueError, match=re.escape(found)):
                FILES[kind].content(state, NOTHING)
        else:
            assert found.decode() == FILES[kind].content(state, NOTHING).decode()


@pytest.mark.parametrize("text", DESIGNS)
def test_the_table_is_that_of_the_server(take, text):
    state, _ = from_query(text)
    found, expected = (
        list(csv.reader(io.StringIO(content.decode())))
        for content in (take("csv", state), FILES["csv"].content(state, NOTHING))
    )
    assert [row[:3] for row in found] == [row[:3] for row in expected]
    values, truth = (np.array([float(row[3]) for row in rows[1:]]) for rows in (found, expected))
    np.testing.assert_allclose(values, truth, rtol=1e-9, atol=1e-12)


def test_a_table_that_there_is_not_is_refused_in_one_line(take):
    state, _ = from_query("waviness=3&tracks=independent")
    assert "warp" in take("csv", state)


NUMBER = r"-?\d+(\.\d+)?(e[-+]\d+)?"


def matrices(tables):
    """The arrays of an FMU's tables by name, and the C about them."""
    own = re.findall(r"double (\w+)\[[^=]*\] = (\{.*?\});", tables, flags=re.DOTALL)
    found = {name: np.array(eval(text.replace("{", "[").replace("}", "]"))) for name, text in own}
    return found, re.sub(r'"\{.*\}"', "GUID", re.sub(NUMBER, "1", tables))


@pytest.mark.filterwarnings("ignore:.*compiler")
@pytest.mark.parametrize("text", DESIGNS)
def test_an_fmu_is_that_of_the_server_without_its_binary(take, text, tmp_path, monkeypatch):
    monkeypatch.setattr("susp_ss.exchange.exporting.COMPILERS", ())
    state, _ = from_query(text)
    path = tmp_path / "vehicle.fmu"
    path.write_bytes(take("fmu", state))
    assert validate_fmu(str(path)) == []
    with zipfile.ZipFile(path) as one, zipfile.ZipFile(io.BytesIO(FILES["fmu"].content(state, NOTHING))) as other:
        assert one.testzip() is None
        assert sorted(one.namelist()) == sorted(other.namelist())
        found, expected = ({name: file.read(name).decode() for name in file.namelist()} for file in (one, other))
    assert found["sources/fmi2.c"] == expected["sources/fmi2.c"]
    (own, code), (truth, expected_code) = (matrices(texts["sources/tables.h"]) for texts in (found, expected))
    assert code == expected_code
    for name, values in truth.items():
        np.testing.assert_allclose(own[name], values, rtol=1e-9, atol=1e-12 * np.abs(values).max(initial=0.0))
    told, needed = (re.sub('guid="[^"]*"', "", texts["modelDescription.xml"]) for texts in (found, expected))
    # What rounding leaves of a sum that cancels is a dependency as well.
    depends = r'(?<=dependencies=")[^"]*'
    starts = [[float(one) for one in re.findall('(?<=start=")[^"]*', text)] for text in (told, needed)]
    np.testing.assert_allclose(*starts, rtol=1e-9)
    assert re.sub(f'{depends}|(?<=start=")[^"]*', "", told) == re.sub(f'{depends}|(?<=start=")[^"]*', "", needed)
    rows = np.vstack([np.hstack([own["D"], own["C"]]), np.hstack([own["B"], own["A"]])])
    assert re.findall(depends, told)[: len(rows)] == [" ".join(map(str, np.flatnonzero(row) + 1)) for row in rows]
    (guid,) = set(re.findall(r"\{[0-9a-f-]{36}\}", found["modelDescription.xml"] + found["sources/tables.h"]))
    assert guid not in expected["modelDescription.xml"]


def test_the_page_hands_out_every_file(browser, script, tmp_path, monkeypatch):
    monkeypatch.setattr("susp_ss.explorer.freeze.engine", lambda: script)
    tab = browser.new_page()
    tab.set_default_timeout(0)
    tab.goto(freeze(tmp_path).as_uri() + "?model=quarter&ks=20000")
    tab.wait_for_selector("#panels[aria-busy=false]")
    state, _ = from_query("model=quarter&ks=20000")
    for kind, file in FILES.items():
        with tab.expect_download() as waiting:
            tab.locator(f"#download-{kind}").click()
        assert waiting.value.suggested_filename == file.name
        if kind in ("toml", "py"):
            assert waiting.value.path().read_bytes() == file.content(state, NOTHING)
    assert "susp-ss explore" in tab.locator("#elsewhere").inner_text()
    tab.close()
