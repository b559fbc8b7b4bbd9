"""The pages of a study and of a fit, as text and in a browser."""

import functools
import html.parser
import io
import json
import re
import shlex

import matplotlib.image
import numpy as np
import pandas as pd
import plotly.graph_objects
import pytest
import xarray as xr

import susp_ss as ss
from conftest import pages
from susp_ss.fit import fitting
from susp_ss.presentation.pages.figures import plain
from susp_ss.presentation.pages.page import number
from susp_ss.presentation.save import STILLS
from susp_ss.presentation.text.fit import typed
from susp_ss.presentation.text.study import landings

pytestmark = pytest.mark.usefixtures("few_runs")

# What a column may be called, and what it must not do.
HOSTILE_INPUT, HOSTILE_OUTPUT = 'gap <b onclick="x">', '<script>alert("%{x}")</script>/&amp;'

ROAD = ss.Road.iso8608("B", speed=20.0, tracks="isotropic")


@pytest.fixture(scope="module")
def study():
    return ss.feasibility_study(nodes=(5, 4))


@pytest.fixture(scope="module")
def studied(study, tmp_path_factory):
    folder = tmp_path_factory.mktemp("study")
    ss.save(study, folder, force=True)
    return folder


def runs(n):
    """Exact runs of a full car at its front right corner, and an output of no known name."""
    designs = ss.sample({"ks": (12536.0, 24570.0), "cs": (798.0, 2235.0)}, n, random_state=3)
    car = ss.ride_metrics(ss.FullCar(ks=designs.ks.to_numpy(), cs=designs.cs.to_numpy()), ROAD)
    return designs.assign(bacc=car.bacc.sel(point="fr"), peak=2.0 + 1e-4 * designs.ks - 1e-9 * designs.ks * designs.cs)


def fitted(folder, table, inputs, outputs):
    """A fit without the surrogates that take seconds, but for one that states intervals."""
    table.to_csv(folder / "runs.csv", index=False)
    read = ss.read_runs(folder / "runs.csv", inputs, outputs)
    quick = ("RB", "VB", "PB ms", "Polynomial 1", "Polynomial 2", "Kriging")
    every = fitting.candidates
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(fitting, "candidates", lambda *a: {k: v for k, v in every(*a).items() if k in quick})
        return ss.fit_runs(read, ss.LowFidelity(ss.QuarterCar(), ROAD, "fr", "ms"), learning=True)


@pytest.fixture(scope="module")
def fit(tmp_path_factory):
    names = {"bacc": "bacc", HOSTILE_OUTPUT: "peak"}
    return fitted(tmp_path_factory.mktemp("runs"), runs(13), {"ks": "ks", "cs": "cs"}, names)


@pytest.fixture(scope="module")
def fit_folder(fit, tmp_path_factory):
    folder = tmp_path_factory.mktemp("fit")
    ss.save(fit, folder, force=True)
    return folder


@pytest.fixture(scope="module")
def hostile(tmp_path_factory):
    """A fit of one input, whose name is no parameter's."""
    folder = tmp_path_factory.mktemp("hostile")
    table = pd.DataFrame({HOSTILE_INPUT: np.linspace(1.0, 2.0, 9), "peak": np.linspace(1.0, 2.0, 9) ** 3})
    table["ks"] = 18e3 + 10.0 * np.arange(9)
    found = fitted(folder, table, {HOSTILE_INPUT: HOSTILE_INPUT}, {HOSTILE_OUTPUT: "peak"})
    ss.save(found, folder / "fit")
    return folder / "fit"


# As text


class Parts(html.parser.HTMLParser):
    """Addresses that a page names, and its scripts."""

    def __init__(self, text):
        super().__init__()
        self.addresses, self.ids, self.pictures, self.inside, self.blocks = [], [], [], None, {}
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        found = dict(attributes)
        self.addresses += [found[name] for name in ("src", "href", "action", "data") if name in found]
        self.ids += [found["id"]] if "id" in found else []
        self.pictures += [found] if tag == "img" else []
        self.inside = found.get("id") if tag in ("script", "code") else self.inside

    def handle_endtag(self, tag):
        self.inside = None if tag in ("script", "code") else self.inside

    def handle_data(self, text):
        if self.inside:
            self.blocks[self.inside] = self.blocks.get(self.inside, "") + text


@pytest.fixture(params=["study", "fit"])
def page(request):
    return request.getfixturevalue({"study": "studied", "fit": "fit_folder"}[request.param]) / "report.html"


def test_a_page_is_one_file(page):
    parts = Parts(page.read_text(encoding="utf-8"))
    assert {address.partition(":")[0] for address in parts.addresses if not address.startswith("#")} <= {"data"}
    assert {address[1:] for address in parts.addresses if address.startswith("#")} <= set(parts.ids)
    assert len(set(parts.ids)) == len(parts.ids)
    assert all(picture["alt"] for picture in parts.pictures)


def test_figures_are_plotly_s(page):
    figures = json.loads(Parts(page.read_text(encoding="utf-8")).blocks["figures"])
    for views in figures.values():
        for figure in views.values():
            plotly.graph_objects.Figure(figure)


def test_pages_are_deterministic(study, studied, tmp_path):
    ss.save(study, tmp_path)
    assert (tmp_path / "report.html").read_bytes() == (studied / "report.html").read_bytes()


def test_a_study_shows_where_designs_land(study, studied):
    text = (studied / "report.html").read_text(encoding="utf-8")
    section = text[text.index('<h2 id="optima">') :]
    for surrogate, row in landings(study.optima).items():
        cells = "".join(f"<td>{cell.replace('-', '−')}</td>" for cell in row.values())
        assert f'<tr><th scope="row">{surrogate}</th>\n{cells}' in section


@pytest.mark.filterwarnings("ignore:the tuned parameter")
def test_the_study_s_code_and_command_run_it_again(study, studied, run, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    blocks = Parts((studied / "report.html").read_text(encoding="utf-8")).blocks
    assert "command" not in blocks
    names = {}
    exec(blocks["code"].removesuffix("ss.save(study, 'results')"), names)
    pd.testing.assert_frame_equal(names["study"].comparison(), study.comparison())

    road = ss.Road.iso8608("D", speed=27.5, tracks="identical", delay=False, cutoff=0.01, wheels=("fr", "fl"))
    square = ss.feasibility_study(road, corner="rl", nodes=(3, 3), nonnegative=True)
    ss.save(square, "square", figures=False)
    command = Parts((tmp_path / "square" / "report.html").read_text(encoding="utf-8")).blocks["command"]
    code, out, err = run(*shlex.split(command.replace("\\\n", ""))[1:], "--json", "--no-figures")
    assert code == 0, err
    saved = json.loads((tmp_path / "square" / "tables.json").read_text())
    assert json.loads(out)["tables"] == saved["tables"]
    assert json.loads(out)["scenario"] == saved["scenario"]


def test_the_fit_s_code_makes_it_again(fit, fit_folder):
    code = Parts((fit_folder / "report.html").read_text(encoding="utf-8")).blocks["code"]
    given, called = {}, {}
    exec(re.sub(r"\nfit = .*", "", code.removesuffix("\nss.save(fit, 'fit')")), given)
    pd.testing.assert_frame_equal(given["runs"].designs, fit.runs.designs)
    pd.testing.assert_frame_equal(given["runs"].responses, fit.runs.responses)
    cheap = given["cheap"]
    assert (vars(cheap.vehicle), cheap.road) == (vars(fit.low_fidelity.vehicle), fit.low_fidelity.road)
    assert (cheap.place, cheap.parameter) == (fit.low_fidelity.place, fit.low_fidelity.parameter)
    call = re.search(r"\nfit = ss\.fit_runs\(runs, cheap, (.*)\)", code)[1]
    exec(f"called.update({call})", {"called": called})
    assert called == fit.asked == fit.asked | {"learning": True, "choose": None}


def test_without_figures_numbers_are_printed(study, tmp_path):
    ss.save(study, tmp_path, figures=False)
    text = (tmp_path / "report.html").read_text(encoding="utf-8")
    assert text.count("data-print>") == 3
    assert not Parts(text).pictures


def test_files_of_any_output(fit, fit_folder):
    drawn = {path.name for path in (fit_folder / "figures").iterdir()}
    plain_name = "_script_alert____x_____script___amp_"
    assert drawn == {
        f"{kind}_{name}.png" for kind in ("parity", "residuals", "map", "learning") for name in ("bacc", plain_name)
    }


@pytest.mark.parametrize(
    ("value", "shown"),
    [(None, "–"), (float("nan"), "–"), (-0.00012345678, "−0.00012346"), (3.0081e-5, "3.0081e−5"), (1e20, "1e20")],
)
def test_numbers(value, shown):
    assert number(value) == shown


# In a browser


def is_one_file(asked):
    # Chromium reports the pictures that a page carries as requests, too.
    return all(re.match(r"file:///.*/report\.html$|data:|blob:", url) for url in asked)


@pytest.fixture
def opened(opened):
    """Open a page, which must be one file."""
    yield opened
    assert is_one_file(opened.asked), opened.asked


@pytest.fixture(scope="module")
def kept(browser):
    """Pages that stay open, for drawing one takes seconds."""
    with pages(browser) as open_page:
        yield functools.cache(open_page)
        assert is_one_file(open_page.asked), open_page.asked


@pytest.fixture
def seen(kept):
    """See a page as it has been left, on the screen."""

    def look(path):
        tab = kept(path)
        tab.emulate_media(media="screen")
        return tab

    return look


def pixels(tab, selector):
    """What a browser shows of an element (height, width, 3), 0 to 1."""
    return matplotlib.image.imread(io.BytesIO(tab.locator(selector).screenshot()))[..., :3]


def drawn(tab, selector):
    """The same, once two frames in a row are alike."""
    before, now = None, pixels(tab, selector)
    while before is None or not np.array_equal(before, now):
        tab.wait_for_timeout(300)
        before, now = now, pixels(tab, selector)
    return now


def yellow(image):
    """Number of pixels in the quarter car's yellow, lit from any side."""
    red, green, blue = np.moveaxis(image, -1, 0)
    return int(((blue < 0.25 * red) & (green > 0.6 * red) & (red > 0.4)).sum())


def test_surfaces_are_drawn_and_can_be_toggled(opened, studied):
    tab = opened(studied / "report.html")
    tab.wait_for_selector("#surfaces canvas")
    shown = drawn(tab, "#surfaces")
    assert yellow(shown) > 1000
    tab.get_by_label("quarter car", exact=True).uncheck()
    assert yellow(drawn(tab, "#surfaces")) == 0
    tab.get_by_label("quarter car", exact=True).check()
    assert yellow(drawn(tab, "#surfaces")) == pytest.approx(yellow(shown), rel=0.02)


def test_surfaces_hold_the_responses(seen, studied):
    with xr.open_dataset(studied / "responses.nc") as stored:
        responses = stored.load()
    tab = seen(studied / "report.html")
    for label, criterion, one in (("DTL", "dtl", 1e3), ("SWS", "sws", 1e-3), ("BAcc", "bacc", 1.0)):
        tab.get_by_label(label, exact=True).check()
        tab.wait_for_function(
            f"document.getElementById('surfaces').layout.scene.zaxis.title.text.startsWith('{label}')"
        )
        traces = tab.evaluate("document.getElementById('surfaces').data.map(t => [t.name, t.x, t.y, t.z])")
        names = {"full car": "hf", "quarter car": "lf"}
        for name, ks, cs, heights in traces:
            here = responses[names.get(name, name)].sel(criterion=criterion).transpose("cs", "ks")
            np.testing.assert_allclose(np.array(heights) * one, here, rtol=1e-14)
            np.testing.assert_allclose(np.array(ks) * 1e3, here.ks, rtol=1e-14)
            np.testing.assert_allclose(np.array(cs) * 1e3, here.cs, rtol=1e-14)
        for surrogate in ("RB", "VB", "PB"):
            error = tab.evaluate(f"document.getElementById('errors-{surrogate}').data[0].z")
            scale = one if criterion != "dtl" else 1.0
            expected = (responses[surrogate] - responses.hf).sel(criterion=criterion).transpose("cs", "ks")
            np.testing.assert_allclose(np.array(error) * scale, expected, atol=1e-9 * float(abs(responses.hf).max()))
        visible = tab.locator("[data-view]:visible").evaluate_all("all => all.map(one => one.dataset.view)")
        assert visible == [criterion] * 2


def test_tables_are_those_of_the_file(seen, studied):
    tables = json.loads((studied / "tables.json").read_text())["tables"]
    tab = seen(studied / "report.html")
    cells = tab.locator("table[data-surrogate] tbody tr").evaluate_all(
        """rows => rows.map(row => [row.closest("table").dataset.surrogate, row.closest("table").dataset.criterion,
        row.dataset.quantity, ...[...row.querySelectorAll("td")].map(cell => cell.textContent)])"""
    )
    assert len(cells) == sum(len(entries) for by_criterion in tables.values() for entries in by_criterion.values())
    for surrogate, criterion, quantity, ours, theirs, ratio in cells:
        entry = tables[surrogate][criterion][quantity]
        for text, value in ((ours, entry["ours"]), (theirs, entry["published"])):
            if value is None:
                assert text == "–"
            else:
                assert float(text.replace("−", "-")) == pytest.approx(value, rel=1e-4)
        if ratio != "–":
            expected = entry["ours"] / entry["published"]
            assert float(ratio.replace("−", "-")) == pytest.approx(expected, rel=1e-2)


def test_small_screens_do_not_scroll_sideways(opened, page):
    tab = opened(page, width=360)
    tab.wait_for_selector(".plot canvas")
    assert tab.evaluate("document.documentElement.scrollWidth") == 360


def test_wide_tables_show_that_they_scroll(opened, fit_folder):
    tab = opened(fit_folder / "report.html", width=360)
    table = tab.locator(".scroll").first
    hidden = table.evaluate("box => box.scrollWidth - box.clientWidth")
    assert hidden > 20

    def shadows():
        """How much darker the outer pixels are than the page, left and right."""
        image = matplotlib.image.imread(io.BytesIO(table.screenshot()))[..., :3]
        return [1.0 - np.median(image[:, column]) for column in (1, -2)]

    assert [dark > 0.1 for dark in shadows()] == [False, True]
    table.evaluate("box => box.scrollLeft = 1e4")
    assert [dark > 0.1 for dark in shadows()] == [True, False]
    tab.set_viewport_size({"width": 1000, "height": 900})
    assert [dark > 0.1 for dark in shadows()] == [False, False]


def test_the_toolbar_stands_over_nothing(opened, studied):
    touched = opened(studied / "report.html", width=390, has_touch=True, is_mobile=True)
    touched.wait_for_selector("#errors-PB .contourlayer path")
    touched.locator("#errors-RB").tap()
    assert touched.locator(".modebar-btn:visible").count() == 0

    tab = opened(studied / "report.html")
    tab.wait_for_selector("#errors-PB .contourlayer path")
    tab.locator("#errors-RB").hover()
    tools, title = (tab.locator(f"#errors-RB {part}") for part in (".modebar", ".gtitle"))
    tab.wait_for_function("getComputedStyle(document.querySelector('#errors-RB .modebar')).opacity > 0.5")
    boxes = [part.bounding_box() for part in (title, tools)]
    assert boxes[0]["x"] + boxes[0]["width"] < boxes[1]["x"]
    tab.emulate_media(media="print")
    assert tab.locator(".modebar-btn:visible").count() == 0


LIVE = {"studied": ("chosen above", "Turn with the mouse"), "fit_folder": ("Point at a run",)}


@pytest.mark.parametrize("folder", LIVE)
def test_paper_has_its_own_words(opened, seen, request, folder):
    tab = seen(request.getfixturevalue(folder) / "report.html")
    tab.wait_for_selector(".plot canvas")
    assert all(words in tab.locator("main").inner_text() for words in LIVE[folder])
    still = opened(request.getfixturevalue(folder) / "report.html", java_script_enabled=False)
    tab.emulate_media(media="print")
    for page in (tab, still):
        text = page.locator("main").inner_text()
        assert not any(words in text for words in LIVE[folder])
        assert {"studied": "white surrogate", "fit_folder": "predictions.csv"}[folder] in text


def test_paper_says_which_colour_is_which(seen, fit, fit_folder):
    tab = seen(fit_folder / "report.html")
    tab.wait_for_selector("#learning-0 .point")
    tab.emulate_media(media="print")
    for kind, more in (("parity", []), ("learning", ["the others"])):
        key = tab.locator(f"figure:has(#{kind}-0) label:visible").all_inner_texts()
        assert sorted(key) == sorted([*fit.outputs["bacc"].foremost, *more])


def test_learning_curves_of_the_foremost_are_coloured(seen, fit, fit_folder):
    tab = seen(fit_folder / "report.html")
    tab.wait_for_selector("#learning-0 .point")
    traces = tab.evaluate("document.getElementById('learning-0').data")
    found = fit.outputs["bacc"]
    assert {trace["name"] for trace in traces} == {*found.foremost, "the others"}
    grey = [trace for trace in traces if trace["name"] == "the others"]
    assert len(grey) == len(found.comparison.table) - len(found.foremost)
    assert {trace["line"]["color"] for trace in grey} == {"#a6a6a6"}
    hidden = [name for name in found.comparison.table.index if name not in found.foremost]
    assert [trace["hovertemplate"].split(",")[0] for trace in grey] == hidden
    assert traces[: len(grey)] == grey
    tab.locator("figure:has(#learning-0)").get_by_label("the others").uncheck()
    visible = tab.evaluate("document.getElementById('learning-0').data.map(t => [t.name, t.visible])")
    assert all(shown == (name != "the others") for name, shown in visible)
    tab.locator("figure:has(#learning-0)").get_by_label("the others").check()


def test_the_page_tells_the_error_of_its_formula(fit, fit_folder, seen):
    text = " ".join(seen(fit_folder / "report.html").locator("main").inner_text().split())
    for output, found in fit.outputs.items():
        (said,) = typed(found, fit.runs.units[output])
        assert said in text
    assert fit.outputs["bacc"].formula[0] != fit.outputs["bacc"].chosen


def test_units_are_those_that_people_read(seen, page):
    text = seen(page).locator("body").inner_text()
    for code in seen(page).locator("pre").all_inner_texts():  # Code keeps what programs read.
        assert code in text
        text = text.replace(code, "")
    assert "m/s²" in text
    assert not re.search(r"m/s\^2|m\^3", text)


@pytest.mark.parametrize("folder", ["studied", "fit_folder"])
def test_surfaces_of_all_responses_are_seen_from_one_side(request, folder):
    blocks = Parts((request.getfixturevalue(folder) / "report.html").read_text(encoding="utf-8")).blocks
    plots = json.loads(blocks["figures"])
    views = [view for name, plot in plots.items() if name.startswith("surface") for view in plot.values()]
    assert len(views) == {"studied": 3, "fit_folder": 2}[folder]
    eyes = [view["layout"]["scene"]["camera"]["eye"] for view in views]
    assert all(eye == eyes[0] for eye in eyes)
    # Where a surface falls towards the eye, it shows its upper side.
    for view, eye in zip(views, eyes, strict=True):
        surface = np.array(view["data"][0]["z"])
        over_x, over_y = (np.diff(surface.mean(axis=axis)[[0, -1]]).item() for axis in (0, 1))
        rise = (over_x * eye["x"] + over_y * eye["y"]) / np.hypot(eye["x"], eye["y"])
        assert rise < 0.5 * np.ptp(surface)


def test_print(seen, page):
    tab = seen(page)
    tab.wait_for_selector(".plot canvas")
    tab.emulate_media(media="print")
    # A browser prints surfaces blank; pictures take their place.
    assert tab.locator(".plot.space:visible").count() == 0
    assert tab.locator("img.still:visible").count() == tab.locator("img.still").count() > 0
    assert tab.locator("input:visible").count() == 0
    assert tab.pdf(format="A4").startswith(b"%PDF")


def test_without_scripts(opened, page):
    tab = opened(page, java_script_enabled=False)
    assert tab.locator(".plot:visible, input:visible").count() == 0
    assert tab.locator("img.still:visible").count() == tab.locator("img.still").count() > 0


def test_keyboard(seen, studied):
    tab = seen(studied / "report.html")
    tab.wait_for_selector("#surfaces canvas")
    tab.get_by_label("RB", exact=True).focus()
    before = tab.evaluate("document.getElementById('surfaces').data.map(t => t.visible)")
    tab.keyboard.press("Space")
    after = tab.evaluate("document.getElementById('surfaces').data.map(t => t.visible)")
    assert [a != b for a, b in zip(before, after, strict=True)] == [False, False, True, False, False]


def test_points_of_a_fit_say_where_they_stand(seen, fit, fit_folder):
    tab = seen(fit_folder / "report.html")
    tab.wait_for_selector("#parity-0 .point")
    kriging = tab.evaluate("document.getElementById('parity-0').data.find(t => t.name === 'VB')")
    validation = fit.outputs["bacc"].comparison.validations["VB"]
    np.testing.assert_allclose(kriging["y"], validation.predicted)
    assert [text.split("<br>")[0] for text in kriging["text"]] == [f"line {row}" for row in fit.runs.rows]
    tab.locator("input[value=error]").first.check()
    tab.wait_for_function("document.getElementById('parity-0').layout.yaxis.title.text.startsWith('error')")
    errors = tab.evaluate("document.getElementById('parity-0').data.find(t => t.name === 'VB').y")
    np.testing.assert_allclose(errors, validation.residuals)
    tab.locator("#parity-0 .trace .point").first.hover(force=True)
    tab.wait_for_selector("#parity-0 .hoverlayer .hovertext")
    assert re.search(r"line \d+", tab.locator("#parity-0 .hoverlayer").text_content())


def test_the_surface_of_a_fit(seen, fit, fit_folder):
    tab = seen(fit_folder / "report.html")
    tab.wait_for_selector("#surface-0 canvas")
    taken, cheap, points = tab.evaluate("document.getElementById('surface-0').data")
    assert (cheap["name"], points["z"]) == ("cheap model, untuned", fit.runs.responses.bacc.tolist())
    designs = np.stack([axis.ravel() for axis in np.meshgrid(taken["x"], taken["y"])], axis=-1)
    predicted = fit.surrogate.predict({"ks": designs[:, 0], "cs": designs[:, 1]}).bacc
    np.testing.assert_allclose(np.ravel(taken["z"]), predicted)
    np.testing.assert_allclose(np.ravel(cheap["z"]), ss.Response(ss.QuarterCar(), ROAD, "bacc")(designs))
    assert yellow(drawn(tab, "#surface-0")) > 1000


def test_names_are_shown_as_they_are(seen, hostile):
    tab = seen(hostile / "report.html")
    tab.wait_for_selector("#curve-0 .point")
    assert HOSTILE_OUTPUT in tab.locator("h2").first.text_content()
    titles = tab.locator("#curve-0 .infolayer text").all_text_contents()
    assert titles[-2:] == [HOSTILE_INPUT, HOSTILE_OUTPUT]
    assert tab.locator("main b, main script").count() == 0


@pytest.mark.parametrize(("folder", "plots"), [("fit_folder", 6), ("hostile", 3)])
def test_switches_have_the_colours_of_what_they_switch(seen, request, folder, plots):
    tab = seen(request.getfixturevalue(folder) / "report.html")
    tab.wait_for_selector("#learning-0 .point")
    swatches = tab.locator("input[type=checkbox]").evaluate_all(
        """all => all.map(input => [input.dataset.plots, input.value, input.checked,
        input.parentElement.querySelector(".swatch").getAttribute("style")])"""
    )
    assert len({plot for plot, *_ in swatches}) == plots
    for plot, name, checked, swatch in swatches:
        traces = tab.evaluate("plot => document.getElementById(plot).data", plot)
        switched = [trace for trace in traces if trace["name"] == name]
        assert len(switched) == 1 or name == "the others"
        for trace in switched:
            surface = trace["type"] == "surface"
            colour = trace["colorscale"][0][1] if surface else trace.get("marker", trace.get("line"))["color"]
            assert (trace["visible"], f"color: {colour}") == (checked, swatch)


def test_plain_text():
    assert plain("a<b> %{x} & m/s^2") == "a&lt;b&gt; %&#123;x} &amp; m/s²"


def test_figures_are_all_in_the_page(studied):
    pictures = Parts((studied / "report.html").read_text(encoding="utf-8")).pictures
    assert len(pictures) == len(STILLS)
