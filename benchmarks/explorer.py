"""From a slider to the picture of the explorer, in a browser, and where that time goes.

The page is served as ``susp-ss explore`` serves it, or lies in a folder as on the site, and is opened in Chromium or
Chrome, 1440 x 900, its cars moving. Each move of a slider is timed from its input event to the frame after the last
drawing, by the browser's clock. The engine's own share is `compute` alone; the page's own is the processor time of the
main thread, on which it draws, until the next move. Writes a table under ``benchmarks/results``.

    python benchmarks/explorer.py [--moves 200]
"""

import argparse
import os
import platform
import shutil
import tempfile
import threading
import time
from importlib.metadata import version
from pathlib import Path

import numpy as np
from playwright.sync_api import sync_playwright
from report import digits, processor, rows
from ride_metrics import RESULTS

from susp_ss.explorer.app import application
from susp_ss.explorer.compute import compute
from susp_ss.explorer.freeze import freeze
from susp_ss.explorer.server import address, listening
from susp_ss.explorer.state import from_query

BROWSERS = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable", "chrome")
SWITCHES = ["--no-sandbox", "--disable-gpu", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"]

# What is shown, and the slider that moves; with pins, a move of the road makes them be computed again as well.
SCENES = {
    "quarter car, springs": ("model=quarter", "ks"),
    "full car, front springs": ("", "ks_front"),
    "full car, a seat, front dampers": ("seat_mass=75", "cs_front"),
    "full car, damper curves, front dampers": ("curve_rebound=1.3", "cs_front"),
    "full car, four pins, front springs": (
        "pin=ks_front%3D15053&pin=ks_front%3D22053&pin=cs_rear%3D2016.5&pin=",
        "ks_front",
    ),
    "full car, four pins, speed": ("pin=ks_front%3D15053&pin=ks_front%3D22053&pin=cs_rear%3D2016.5&pin=", "speed"),
    "three-axle truck, front springs": ("model=three-axle", "ks_front"),
    "ride and handling, front springs": ("model=ride-handling", "ks_front"),
}

# Asserted: the 95th percentile in ms of every scene.
MOST = 100.0

COLUMNS = (
    "the engine alone, ms",
    "median, ms",
    "95 %, ms",
    "the browser's main thread, ms",
    "95 % without a server, ms",
    "its main thread, ms",
)

TIMED = """async ([name, moves]) => {
    const slider = document.querySelector(`input[type=range][name=${name}]`);
    const idle = async () => {
        while (document.querySelector("#panels").ariaBusy !== "false") await new Promise((done) => setTimeout(done, 5));
    };
    const painted = () => new Promise((done) => requestAnimationFrame(() => {
        const after = new MessageChannel();
        after.port1.onmessage = done;
        after.port2.postMessage(null);
    }));
    const took = [];
    for (let i = 0; i < moves; i++) {
        const drawn = new Promise((done) => document.addEventListener("drawn", done, { once: true }));
        const start = performance.now();
        slider.value = 20 + (i % 60);
        slider.dispatchEvent(new Event("input", { bubbles: true }));
        await drawn;
        await painted();
        took.push(performance.now() - start);
        await idle();
    }
    return took;
}"""


def engine(query, repeats=20):
    """Milliseconds that `compute` takes alone, the median."""
    state, errors = from_query(query)
    assert not errors
    took = []
    for _ in range(repeats + 1):
        start = time.perf_counter()
        compute(state)
        took.append(1e3 * (time.perf_counter() - start))
    return float(np.median(took[1:]))


def moves(browser, page, query, name, count):
    """Milliseconds from each move to its picture, and of the main thread a move."""
    context = browser.new_context(viewport={"width": 1440, "height": 900})
    tab = context.new_page()
    tab.set_default_timeout(0)
    meter = context.new_cdp_session(tab)
    meter.send("Performance.setTimeDomain", {"timeDomain": "threadTicks"})
    meter.send("Performance.enable")

    def busy():
        found = {one["name"]: one["value"] for one in meter.send("Performance.getMetrics")["metrics"]}
        return 1e3 * found["TaskDuration"]

    tab.goto(f"{page}?{query}")
    # What takes seconds comes once, before anything is timed.
    tab.wait_for_selector("#panels[aria-busy=false]")
    tab.wait_for_selector("#carpet[aria-busy=false]", state="attached")
    tab.evaluate(TIMED, [name, 10])
    before = busy()
    took = tab.evaluate(TIMED, [name, count])
    main = (busy() - before) / count
    context.close()
    return took, main


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--moves", type=int, default=200)
    count = parser.parse_args().moves
    load, body, broken = os.getloadavg()[0], [], []
    server = listening(application(), 0)
    threading.Thread(target=server.serve_forever, daemon=True).start()
    with sync_playwright() as driver, tempfile.TemporaryDirectory() as folder:
        alone = freeze(Path(folder)).as_uri()
        found = next(filter(None, map(shutil.which, BROWSERS)))
        browser = driver.chromium.launch(executable_path=found, args=SWITCHES)
        named = f"Chromium {browser.version}"
        for scene, (query, name) in SCENES.items():
            took, main = moves(browser, address(server), query, name, count)
            most = np.quantile(took, 0.95)
            cells = [engine(query), np.median(took), most, main]
            took, main = moves(browser, alone, query, name, count)
            cells += [np.quantile(took, 0.95), main]
            most = max(most, cells[4])
            body.append([scene, *map(digits, cells)])
            if most > MOST:
                broken.append(f"{scene}: {most:.0f} ms")
        browser.close()
    server.shutdown()
    text = [
        "# From a slider to the picture",
        "",
        f"{processor()}, {os.cpu_count()} cores, Python {platform.python_version()}, Dash {version('dash')}, {named}, "
        f"without a graphics card; load average at its start {load:.1f} (0 on a quiet machine). Of {count} moves of a "
        "slider, from its input event to the frame after the last drawing, browser and server on one machine; the main "
        "thread's is processor time a move, moving cars included.",
        "",
        *rows(["", *COLUMNS], body),
        "",
    ]
    (RESULTS / "explorer.md").write_text("\n".join(text), encoding="utf-8")
    print("\n".join(text))
    if broken:
        raise SystemExit(f"95 % above {MOST:g} ms: {'; '.join(broken)}")


if __name__ == "__main__":
    main()
