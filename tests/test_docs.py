"""The documentation: what its pages leave out, and the site that `make docs` built, in a browser.

Examples on the pages, links between them and names in docstrings are checked by the build itself.
"""

import re
from pathlib import Path

import pytest

import susp_ss as ss
from susp_ss.cli import app
from susp_ss.explorer.javascript import MODELS
from susp_ss.explorer.state import NOTHING
from susp_ss.roads.road import DEFAULT_ROAD
from test_layout import ROOMS
from test_layout import ROOT as PACKAGE

DOCS = Path(__file__).parents[1] / "docs"
SITE = DOCS / "_build" / "html"


def text(page):
    return (DOCS / page).read_text(encoding="utf-8")


def test_every_public_name_has_a_page():
    listed = set(re.findall(r"^   ([\w.]+)$", text("api/index.md"), flags=re.MULTILINE))
    assert set(ss.__all__) - {"plots"} - {name.rpartition(".")[2] for name in listed} == set()
    assert {f"plots.{name}" for name in ss.plots.__all__ if callable(getattr(ss.plots, name))} - listed == set()


def test_the_drawing_has_the_rooms_in_their_order():
    rooms = re.findall(r'class="room" x="\d+" y="(-?\d+)">(\w+)<', text("architecture.svg"))
    height = {name: -int(y) for y, name in rooms}
    folders = {path.parent.name for path in PACKAGE.glob("*/__init__.py")}
    assert folders <= set(height) <= set(ROOMS)
    drawn = [room for room in ROOMS if room in height]
    assert [height[room] for room in drawn] == sorted(height.values())


# In a browser


@pytest.fixture(scope="module")
def site():
    if not (SITE / "index.html").exists():
        pytest.skip("the site is not built: make docs does it")
    return SITE


# One of each kind: prose, cells and commands, formulas, a lesson, wide tables, a class, a function, options.
PAGES = (
    "index.html",
    "start.html",
    "how-to/own-car.html",
    "theory/metrics.html",
    "lessons/04_feasibility_study.html",
    "benchmarks.html",
    "api/generated/susp_ss.FullCar.html",
    "api/generated/susp_ss.ride_metrics.html",
    "command-line.html",
    "explorer.html",
    "architecture.html",
)


@pytest.mark.parametrize("page", PAGES)
def test_page_fits_a_telephone_and_paper(opened, site, page):
    tab = opened(site / page, width=360)
    assert tab.evaluate("document.documentElement.scrollWidth") == 360
    assert tab.evaluate("[...document.images].every(image => image.complete && image.naturalWidth > 0)")
    tab.set_viewport_size({"width": 794, "height": 1123})  # A4 at 96 dots an inch
    tab.emulate_media(media="print")
    assert tab.evaluate("document.documentElement.scrollWidth") <= 794
    assert tab.locator("h1").first.is_visible()
    for part in (".bd-header", ".bd-sidebar-primary", ".bd-sidebar-secondary", ".prev-next-area"):
        assert tab.locator(f"{part}:visible").count() == 0, part


def test_formulas_are_drawn_by_the_browser_itself(opened, site):
    tab = opened(site / "theory/metrics.html")
    heights = tab.eval_on_selector_all("div.math math", "all => all.map(one => one.getBoundingClientRect().height)")
    assert min(heights) > 10.0
    assert "\\" not in tab.locator("article").inner_text()


@pytest.mark.parametrize(("term", "found"), [("wheelbase", "theory/roads.html"), ("sensitivity", "sensitivity.html")])
def test_search_finds_a_term_without_a_network(opened, site, term, found):
    tab = opened(site / "search.html")
    tab.goto(f"{(site / 'search.html').as_uri()}?q={term}")
    tab.wait_for_selector("#search-results li a")
    tab.wait_for_function("document.querySelector('#search-results .search-summary')?.innerText.match(/\\d+/)")
    links = tab.eval_on_selector_all("#search-results li a", "all => all.map(one => one.href)")
    assert any(found in link for link in links), links


def test_the_command_line_is_all_there(opened, site):
    tab = opened(site / "command-line.html")
    shown = tab.locator("article").inner_text()
    for command in app.registered_commands:
        assert f"susp-ss {command.name} " in shown
        assert command.callback.__doc__.splitlines()[0] in shown


def test_links_lead_to_other_libraries(opened, site):
    tab = opened(site / "api/generated/susp_ss.ride_metrics.html")
    assert tab.locator("a[href='https://docs.xarray.dev/en/stable/generated/xarray.Dataset.html']").count()


def test_the_explorer_answers_without_a_server(opened, site):
    tab = opened(site / "explorer.html")
    tab.get_by_role("link", name="Open the explorer").click()
    rest = "#panels[aria-busy=false]"
    tab.wait_for_selector(rest)
    for _ in range(5):
        tab.locator("input[type=range][name=ks_front]").press("ArrowRight")
    tab.wait_for_selector(rest)
    (row,) = (row for row in NOTHING.tables["full"] if row.name == "ks_front")
    metrics = ss.ride_metrics(ss.FullCar().replaced(ks_front=row.default + 5 * row.step), DEFAULT_ROAD)
    rows = tab.locator("#metrics tr").filter(has_text="front right").all_inner_texts()
    shown = [float(row.split("\t")[1]) for row in rows[:3]]
    values = [float(metrics.bacc.sel(point="fr")), *(float(metrics[name].sel(corner="fr")) for name in ("sws", "dtl"))]
    assert shown == [float(f"{value * by:.3g}") for value, by in zip(values, (1.0, 1e3, 1e-3), strict=True)]
    tab.goto(f"{tab.url.partition('?')[0]}?ks_front=fast")
    tab.wait_for_selector("#errors:has-text('ks_front must be a number')")


def test_the_explorer_shows_every_model_without_a_server(opened, site):
    tab = opened(site / "explorer/index.html")
    for model in MODELS:
        tab.goto(f"{(site / 'explorer/index.html').as_uri()}?model={model}")
        tab.wait_for_selector("#panels[aria-busy=false]")
        assert tab.locator("#metrics tr").count() > 4
        assert tab.locator("#errors").inner_text() == ""
        assert tab.evaluate("document.documentElement.scrollWidth") <= 1000
