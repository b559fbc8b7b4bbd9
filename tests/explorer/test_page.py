"""The explorer's page in a browser, served as ``susp-ss explore`` serves it."""

import contextlib
import re
import threading
import types
from urllib.parse import parse_qs, urlsplit

import matplotlib.image
import numpy as np
import pytest

import susp_ss as ss
from susp_ss.explorer.app import application
from susp_ss.explorer.compute import compute
from susp_ss.explorer.server import address as where
from susp_ss.explorer.server import left, listening
from susp_ss.explorer.state import NOTHING, Given, from_query

IDLE = "#panels[aria-busy=false]"
ROAD = ss.Road.iso8608("B", speed=20.0, tracks="isotropic")


def carpet(conditions, given):
    """In place of the background, which takes seconds: three designs in a plane, and what bounds them."""
    return {
        "carpet": {"designs": [[[4e-3, 0.6], [5e-3, 0.5]]]},
        "front": {"points": [[4e-3, 0.5], [6e-3, 0.4]], "designs": [{"ks": 12e3, "cs": 2e3}, {"ks": 2e4, "cs": 900.0}]},
        "bound": {"points": [[4e-3, 0.3], [6e-3, 0.2]]},
        "errors": [],
    }


@contextlib.contextmanager
def serving(given=NOTHING, slowly=carpet):
    """The address of an explorer, whose background costs nothing."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("susp_ss.explorer.app.background", slowly)
        server = listening(application(given), 0)
        thread = threading.Thread(target=server.serve_forever)
        thread.start()
        try:
            yield where(server)
        finally:
            server.shutdown()
            thread.join()
            server.server_close()


@pytest.fixture(scope="module")
def address():
    with serving() as found:
        yield found


@contextlib.contextmanager
def visit(browser, address, width=1440, **context):
    """A user of the page, who must meet no error and whose page must ask nobody but its server."""
    wrong, asked = [], []
    user = browser.new_context(viewport={"width": width, "height": 900}, **context)
    user.set_default_timeout(0)
    tab = user.new_page()
    tab.on("console", lambda message: wrong.append(message.text) if message.type == "error" else None)
    tab.on("pageerror", lambda error: wrong.append(str(error)))
    tab.on("request", lambda request: asked.append(request.url))

    def go(query=""):
        tab.goto(address + query)
        tab.wait_for_selector(IDLE)

    tab.go = go
    yield tab
    user.close()
    assert wrong == []
    assert all(url.startswith((address, "data:", "blob:")) for url in asked), asked


@pytest.fixture
def tab(browser, address):
    with visit(browser, address) as opened:
        yield opened


def slider(tab, name):
    return tab.locator(f"input[type=range][name={name}]")


def press(tab, name, key, times=1):
    for _ in range(times):
        slider(tab, name).press(key)
    tab.wait_for_selector(IDLE)


def until(tab, expression):
    """Wait for the page; its policy lets nobody evaluate text within it, as ``wait_for_function`` does."""
    while not tab.evaluate(expression):
        tab.wait_for_timeout(20)


def row(tab, metric, place=""):
    """A metric's cells as numbers: now, change in percent, each pinned design; None where a design has none."""
    cells = tab.evaluate(
        """([metric, place]) => {
            const own = [...document.querySelectorAll("#metrics tr")];
            const at = own.findIndex((row) => row.cells[0].textContent.startsWith(metric));
            const chosen = place ? own.slice(at).find((row) => row.cells[0].textContent === place) : own[at];
            return [...chosen.cells].slice(1).map((cell) => cell.textContent);
        }""",
        [metric, place],
    )
    said = (cell.replace("\u2212", "-").removesuffix("%") for cell in cells)
    return [float(word) if any(map(str.isdigit, word)) else None for word in said]


def query(tab):
    return {name: some[0] for name, some in parse_qs(urlsplit(tab.url).query).items()}


def front(ks):
    return ss.FullCar(ks=ss.Corners.axles(front=ks, rear=18553.0))


def near(shown, value):
    """Whether three digits say the value."""
    return shown == pytest.approx(float(value), rel=5.1e-3)


def test_a_slider_moves_the_numbers(tab):
    tab.go()
    before = ss.ride_metrics(ss.FullCar(), ROAD)
    press(tab, "ks_front", "ArrowRight", times=10)
    after = ss.ride_metrics(front(18553.0 + 10 * 500.0), ROAD)
    for metric, name, place, corner in (
        ("Body vertical", "bacc", "centre of gravity", {"point": "cg"}),
        ("Suspension deflection", "sws", "front left", {"corner": "fl"}),
        ("Dynamic tyre load", "dtl", "rear right", {"corner": "rr"}),
        ("Roll acceleration", "roll_acc", "", {}),
    ):
        unit = {"sws": 1e-3, "dtl": 1e3}.get(name, 1.0)
        now, change, start = row(tab, metric, place)
        assert near(now, after[name].sel(corner) / unit)
        assert near(start, before[name].sel(corner) / unit)
        assert change == pytest.approx(
            100.0 * float(after[name].sel(corner) / before[name].sel(corner) - 1.0), abs=0.06
        )
    assert query(tab) == {"ks_front": "23553"}


def test_curves_seats_and_other_models(tab):
    tab.go("?model=quarter&ks=20053")
    assert near(row(tab, "Dynamic")[0], ss.ride_metrics(ss.QuarterCar(ks=20053.0), ROAD).dtl / 1e3)
    tab.locator("input[name=curve]").check()
    tab.wait_for_selector(IDLE)
    state, errors = from_query(urlsplit(tab.url).query)
    assert errors == []
    assert state["curve"]["rebound"] == 1.3
    tab.get_by_label("Model").select_option("roll-half")
    tab.wait_for_selector(IDLE)
    ride = ss.ride_metrics(ss.RollHalfCar(), ROAD)
    assert near(row(tab, "Suspension deflection", "right")[0], 1e3 * ride.sws.sel(corner="r"))
    tab.locator("summary", has_text="Seat").click()
    tab.locator("input[name=seat]").check()
    tab.wait_for_selector(IDLE)
    assert row(tab, "Body vertical", "driver")[0] > 0.0
    modes = tab.locator("#modes figcaption").all_inner_texts()
    assert all(("%" in mode) != mode.startswith("seat") for mode in modes)  # The design to compare with has none.


def test_a_seat_that_is_taken_away_takes_its_outputs_along(tab):
    asked = {"seat_mass": "75", "carpet_y": "bacc@driver", "bode": "dtl@fr,bacc@driver"}
    tab.go(f"?{'&'.join(map('='.join, asked.items()))}")
    offered = "!document.querySelector('#bode-set input[value=\\'bacc@driver\\']').parentNode.hidden"
    assert tab.evaluate(offered)
    tab.locator("input[name=seat]").evaluate("box => box.click()")
    tab.wait_for_selector(IDLE)
    assert query(tab) == {"bode": "dtl@fr"}
    assert tab.locator("#errors").inner_text() == ""
    assert not tab.evaluate(offered)
    tab.locator("#undo").click()
    until(tab, "location.search.includes('seat_mass')")
    assert asked.items() <= query(tab).items()


def test_quantities_at_several_places_have_one_title_and_the_unit_of_pictures(tab):
    tab.go("?model=ride-handling")
    ride = ss.ride_metrics(ss.RideHandlingCar(), ROAD)
    slip = np.degrees(ride.slip_angle.sel(corner="rr"))
    assert near(row(tab, "Slip angle of the tyre (deg)", "rear right")[0], slip)
    moved = 1e-3 * ride.load_transfer[0]
    assert near(row(tab, "Load that an axle moves from the left wheel to the right (kN)", "front")[0], moved)
    tab.go("?model=quarter&curve_rebound=1.3")
    shift = compute(from_query("model=quarter&curve_rebound=1.3")[0])["metrics"][-1]["value"]
    assert near(row(tab, "Mean deflection of the suspension (mm)")[0], 1e3 * shift)


def test_what_takes_seconds_is_given_up_for_newer_conditions_and_by_pages_that_leave(browser):
    asked, gone = [], []

    def slowly(conditions, given):
        asked.append(conditions["road"]["speed"])
        second = len(asked) == 2
        while not (second or left()):
            threading.Event().wait(0.02)
        gone.append(left())
        return carpet(conditions, given)

    with serving(slowly=slowly) as address:
        with visit(browser, address) as tab:
            tab.go("?model=quarter")
            while not asked:
                tab.wait_for_timeout(20)
            press(tab, "speed", "ArrowRight")
            tab.wait_for_selector("#carpet[aria-busy=false]")
            while len(gone) < 2:
                tab.wait_for_timeout(20)
            assert sorted(gone) == [False, True]
            press(tab, "speed", "ArrowRight")
            until(tab, "document.querySelector('#carpet[aria-busy=true]')")
            while len(asked) < 3:
                tab.wait_for_timeout(20)
        while len(gone) < 3:
            threading.Event().wait(0.02)
    assert gone[2]
    assert len({*asked}) == 3


def test_a_point_of_the_front_is_a_design_to_take(tab):
    """By key and by pointer; who sits on a seat is drawn, and the one point of the car has a name beside it."""
    tab.go("?model=quarter&seat_mass=75")
    tab.wait_for_selector("#carpet[aria-busy=false]")
    first, second = tab.locator(".point.best").all()
    assert first.get_attribute("aria-label") == (
        "Take the design of spring stiffness K_s 12.0 kN/m; damping rate C_s 2.00 kN s/m"
    )
    first.press("Enter")
    tab.wait_for_selector(IDLE)
    own = ss.QuarterCarWithSeat(ks=12e3, cs=2e3, seat_mass=75.0)
    shown, _, start = row(tab, "Body vertical", "body")
    assert near(shown, ss.ride_metrics(own, ROAD).bacc.sel(point="body"))
    assert near(start, ss.ride_metrics(ss.QuarterCar(), ROAD).bacc)
    assert tab.locator("#modes .rider").count() == tab.locator("#modes figure").count()
    second.click()
    until(tab, "location.search.includes('cs=900')")
    assert query(tab).items() >= {"ks": "20000", "cs": "900"}.items()


def test_undo_redo_and_back(tab):
    tab.go("?model=quarter")
    assert tab.locator("#undo").is_disabled()
    press(tab, "ks", "ArrowRight", times=3)
    press(tab, "cs", "ArrowLeft", times=2)
    moved = row(tab, "Body vertical")
    assert query(tab) == {"model": "quarter", "ks": "20053", "cs": "1416.5"}
    slider(tab, "cs").press("Control+z")
    until(tab, "!location.search.includes('cs=')")
    assert query(tab) == {"model": "quarter", "ks": "20053"}  # The moves of one slider are one step.
    tab.go_back()
    until(tab, "!location.search.includes('ks=')")
    assert slider(tab, "ks").get_attribute("aria-valuetext") == "18.55 kN/m"
    tab.locator("#redo").click()
    until(tab, "location.search.includes('ks=')")
    slider(tab, "ks").press("Control+Shift+Z")
    until(tab, "location.search.includes('cs=')")
    tab.wait_for_selector(IDLE)
    assert row(tab, "Body vertical") == moved
    assert tab.locator("#redo").is_disabled()


def test_pins_and_reload(tab):
    tab.go("?model=quarter")
    for _ in range(4):
        press(tab, "ks", "ArrowRight", times=2)
        tab.locator("#pin").click()
        tab.wait_for_selector(IDLE)
    assert tab.locator("#pin").is_disabled()
    press(tab, "speed", "ArrowRight", times=4)
    faster = ss.Road.iso8608("B", speed=22.0, tracks="isotropic")
    pinned = ss.ride_metrics(ss.QuarterCar(ks=18553.0 + 1e3 * np.arange(1, 5)), faster).bacc.values
    now, change, *shown = row(tab, "Body vertical")
    assert all(map(near, shown, pinned))
    assert change == pytest.approx(100.0 * float(pinned[3] / pinned[0] - 1.0), abs=0.06)
    tab.reload()
    tab.wait_for_selector(IDLE)
    assert row(tab, "Body vertical") == [now, change, *shown]
    assert tab.locator("#undo").is_enabled()
    tab.get_by_role("button", name="Compare with D").click()
    tab.get_by_role("button", name="Unpin design B").click()
    tab.wait_for_selector(IDLE)
    assert row(tab, "Body vertical") == [now, 0.0, shown[3], *shown[1:3]]
    tab.get_by_role("button", name="Go on from design B").click()
    tab.wait_for_selector(IDLE)
    assert query(tab)["ks"] == "20553"


def test_the_ends_of_a_slider_in_ratios_are_of_its_range(tab):
    tab.go("?model=quarter")
    rough = next(one for one in NOTHING.tables["quarter"] if one.name == "roughness")
    for key, end in (("End", rough.most), ("Home", rough.least)):
        press(tab, "roughness", key)
        assert float(query(tab)["roughness"]) == end
        tab.reload()
        tab.wait_for_selector(IDLE)
        assert tab.locator("#errors li").count() == 0


def test_bad_urls(tab):
    bad = "model=quarter&ks=soft&cs=-3&speed=900&tracks=parallel&nonsense=1&mu=50.4&kt=&bode=sws,taste"
    tab.go(f"?{bad}")
    told = tab.locator("#errors li").all_inner_texts()
    state, errors = from_query(bad)
    needs = [[line.partition(", got")[0] for line in lines] for lines in (told, [one["message"] for one in errors])]
    assert sorted(needs[0]) == sorted(needs[1])
    assert len(told) == 7
    assert near(row(tab, "Dynamic")[0], ss.ride_metrics(ss.QuarterCar(mu=50.4), ROAD).dtl / 1e3)
    assert state["vehicle"]["mu"] == 50.4
    press(tab, "cs", "ArrowRight")
    assert tab.locator("#errors").inner_text() == ""
    tab.go("?model=tank&pin=model%3Dquarter%26ks%3D1")
    assert "tank" in tab.locator("#errors").inner_text()
    assert "pin" in tab.locator("#errors").inner_text()
    field = tab.get_by_label("Spring stiffness K_s, front in kN/m")
    for text in ("", "abc", "-2", "1e9", "nan"):
        field.fill(text)
        field.press("Enter")
        assert field.get_attribute("aria-invalid") == "true"
        assert "ks_front must be a number from 5.053 to 74.553 kN/m, got" in tab.locator("#errors").inner_text()
    press(tab, "ks_rear", "ArrowRight")  # Whatever moves, what was typed in vain is gone.
    assert tab.locator("#errors").inner_text() == ""
    assert (field.input_value(), field.get_attribute("aria-invalid")) == ("18.55", "false")
    field.fill("20.5")
    field.press("Enter")
    tab.wait_for_selector(IDLE)
    assert "ks_front" not in tab.locator("#errors").inner_text()
    assert query(tab)["ks_front"] == "20500"
    tab.go(f"?{'&'.join(['pin=ks_front%3D20000'] * 5)}")
    assert tab.locator("#errors").inner_text() == "pin must be at most 4 designs, got 5"
    assert tab.locator("#pins li").count() == 4
    tab.go("?pin=model%3Dtank&pin=ks_front%3D20000")
    assert "got 'tank'" in tab.locator("#errors").inner_text()
    assert tab.locator("#pins li").count() == 1  # A design of no model is none.
    assert tab.evaluate(
        "document.querySelector('#metrics').scrollWidth <= document.querySelector('#metrics').clientWidth"
    )


def test_a_system_and_a_measured_road_have_what_there_is_of_them(browser):
    full = types.SimpleNamespace(inputs={"ks_front": "N/m"})
    measured = ss.Road.two_slope(roughness=90e-6, tracks="isotropic")
    car = ss.LinearVehicle(ss.QuarterCar(ks=21e3).state_space())
    system = Given(car, measured, "measured.csv", surrogates={"full.json": full})
    with serving(system) as address, visit(browser, address) as tab:
        tab.go()
        assert "full.json needs ks_front, which LinearVehicle has not" in " ".join(
            tab.locator("#surrogates tbody").inner_text().split()
        )
        assert tab.locator("#errors").inner_text() == ""
        classes = tab.get_by_label("measured.csv")
        for chosen, road in (("C", ss.Road.iso8608("C", tracks="isotropic")), ("measured", measured)):
            classes.select_option(chosen)
            tab.wait_for_selector(IDLE)
            assert classes.input_value() == chosen
            assert near(row(tab, "Body vertical")[0], ss.ride_metrics(ss.QuarterCar(ks=21e3), road).bacc)
        assert query(tab) == {}
        assert not tab.locator("#panel-modes").is_visible()
        tab.get_by_label("Model").select_option("quarter")
        tab.wait_for_selector("#modes figure")
        assert tab.locator("#panel-modes").is_visible()


def test_two_users_at_once(browser, address, tab):
    tab.go()
    with visit(browser, address) as other:
        other.go("?model=quarter")
        for _ in range(5):
            slider(tab, "ks_front").press("ArrowRight")
            slider(other, "ks").press("ArrowLeft")
        for one in (tab, other):
            one.wait_for_selector(IDLE)
        own = ss.ride_metrics(ss.QuarterCar(ks=18553.0 - 5 * 500.0), ROAD).bacc
        assert near(row(other, "Body vertical")[0], own)
    own = ss.ride_metrics(front(18553.0 + 5 * 500.0), ROAD).bacc.sel(point="cg")
    assert near(row(tab, "Body vertical", "centre of gravity")[0], own)


def test_by_keyboard_and_by_ear(tab):
    tab.go("?pin=ks_front%3D20053")
    nameless = tab.evaluate(
        """() => [...document.querySelectorAll("input, select, button, summary, table, svg[role=img]")]
            .filter((one) => !`${one.ariaLabel ?? ""}${one.closest("label")?.textContent ?? one.textContent}`.trim())
            .map((one) => one.outerHTML.slice(0, 99))"""
    )
    assert nameless == []
    seen = {}
    for _ in range(60):
        tab.keyboard.press("Tab")
        name, outline = tab.evaluate(
            "[document.activeElement.name || document.activeElement.id || document.activeElement.textContent, "
            "getComputedStyle(document.activeElement).outlineStyle]"
        )
        seen[name] = outline
        if name == "ks_rear":
            break
    assert {"model", "pin", "ks_front", "ks_rear"} <= set(seen)
    assert set(seen.values()) == {"solid"}
    tab.keyboard.press("PageUp")
    tab.wait_for_selector(IDLE)
    assert query(tab)["ks_rear"] > "18553"
    until(tab, "document.getElementById('said').textContent.includes('%')")
    assert re.match(
        r"body vertical acceleration, centre of gravity [\d.]+ m/s², [+−][\d.]+", tab.locator("#said").inner_text()
    )
    tab.keyboard.press("Control+z")
    until(tab, "!location.search.includes('ks_rear')")


def test_pictures_out_of_view_are_drawn_as_well_once_nothing_moves(tab):
    tab.go()
    for _ in range(2):
        until(tab, "document.querySelector('#speeds .line.now')?.getAttribute('d')")
        assert tab.evaluate("document.querySelector('#speeds').getBoundingClientRect().top > innerHeight")
        before = tab.evaluate("document.querySelector('#speeds .line.now').getAttribute('d')")
        press(tab, "ks_front", "PageUp")
        until(tab, f"document.querySelector('#speeds .line.now').getAttribute('d') !== '{before}'")


@pytest.mark.parametrize("model", ["full", "ride-handling"])
def test_telephone(browser, address, model):
    with visit(browser, address, width=360, has_touch=True) as tab:
        tab.go(f"?model={model}&pin=cs_front%3D2016.5&pin=&pin=&pin=")
        assert tab.evaluate("document.documentElement.scrollWidth") == 360
        for name in ("metrics", "ride", "bode", "carpet"):
            tab.locator(f"#panel-{name}").scroll_into_view_if_needed()
            right = tab.locator(f"#panel-{name}").evaluate("one => one.getBoundingClientRect().right")
            assert right <= 360
        small = tab.evaluate(
            "[...document.querySelectorAll('button, select')].filter(({ offsetHeight: h }) => h && h < 24).length"
        )
        assert small == 0


def test_cars_move_unless_less_motion_is_wanted(browser, address):
    place = "document.querySelector('#modes .wheel').getAttribute('transform')"
    with visit(browser, address, reduced_motion="reduce") as tab:
        tab.go("?model=quarter")
        still = tab.evaluate(place)
        tab.wait_for_timeout(150)
        assert tab.evaluate(place) == still
        tab.locator("#modes-tools .player").click()
        until(tab, f"{place} !== '{still}'")
        assert tab.locator("#ride-tools .player").inner_text() == "Pause"
        tab.locator("#ride-tools .player").click()
        still = tab.evaluate(place)
        tab.wait_for_timeout(150)
        assert tab.evaluate(place) == still


def test_pictures_are_downloaded(tab):
    tab.go("?model=quarter")
    for name in ("bode", "ride"):
        with tab.expect_download() as waiting:
            tab.locator(f"#{name}-tools").get_by_text("PNG").click()
        assert waiting.value.suggested_filename == f"{name}.png"
        height, width, _ = matplotlib.image.imread(waiting.value.path()).shape
        box = tab.locator(f"#panel-{name}").bounding_box()
        assert (width, height) == pytest.approx((2 * box["width"], 2 * box["height"]), abs=1.0)


def test_what_is_not_answered_is_asked_again(browser, address):
    tab = browser.new_page()
    tab.goto(f"{address}?model=quarter")
    tab.wait_for_selector(IDLE)
    tab.route("**/answer", lambda route: route.fulfill(status=500))
    slider(tab, "ks").press("ArrowRight")
    tab.wait_for_selector("#errors:has-text('No answer; asked again.')")
    tab.unroute("**/answer")
    tab.wait_for_selector(IDLE)
    assert tab.locator("#errors").inner_text() == ""
    assert near(row(tab, "Body vertical")[0], ss.ride_metrics(ss.QuarterCar(ks=19053.0), ROAD).bacc)
    tab.close()


MOVES = """async ([count, together]) => {
    const slider = document.querySelector("input[name=ks]");
    for (let i = 0; i < count; i++) {
        slider.value = (7 * i) % 100;
        slider.dispatchEvent(new Event("input", { bubbles: true }));
        if (i % together === 0) await new Promise((done) => setTimeout(done, 4));
    }
    slider.dispatchEvent(new Event("keyup", { bubbles: true })); // Let go, it has its URL.
}"""


def test_a_thousand_moves(tab):
    """One question at a time, the newest last; nothing piles up in the page."""
    tab.go("?model=quarter")
    tab.evaluate(
        """() => {
            Object.assign(window, { flying: 0, most: 0, answers: 0 });
            const fetch = window.fetch;
            window.fetch = async (...asked) => {
                window.most = Math.max(window.most, ++window.flying);
                try { return await fetch(...asked); } finally { window.flying--; window.answers++; }
            };
        }"""
    )
    meter = tab.context.new_cdp_session(tab)
    meter.send("Performance.enable")

    def size():
        tab.wait_for_selector(IDLE)
        meter.send("HeapProfiler.collectGarbage")
        found = {one["name"]: one["value"] for one in meter.send("Performance.getMetrics")["metrics"]}
        return np.array([found["JSHeapUsedSize"], found["Nodes"], found["JSEventListeners"]])

    tab.evaluate(MOVES, [200, 4])
    before = size()
    tab.evaluate(MOVES, [1000, 4])
    heap, nodes, listeners = size() - before
    assert heap < 1e6
    assert nodes < 50
    assert listeners <= 0
    assert tab.evaluate("most") <= 2  # One for what moves, one for the background of the carpet.
    assert tab.evaluate("answers") > 10
    ks = float(query(tab)["ks"])
    assert ks == pytest.approx(5053.0 + 500.0 * (7 * 999 % 100))
    assert near(row(tab, "Body vertical")[0], ss.ride_metrics(ss.QuarterCar(ks=ks), ROAD).bacc)
