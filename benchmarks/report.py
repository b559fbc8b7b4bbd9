"""Tables and plot of the benchmark."""

import os
import platform
import tempfile
from importlib.metadata import version
from pathlib import Path

from matplotlib.figure import Figure

from susp_ss.responses.covariance.routes import MANY, PLENTY

LIBRARIES = ("numpy", "scipy", "numba", "control")

# Colours of Okabe and Ito, told apart with any colour vision, and a marker each.
STYLES = (
    ("#000000", "o"),
    ("#E69F00", "s"),
    ("#D55E00", "^"),
    ("#CC79A7", "D"),
    ("#009E73", "v"),
    ("#56B4E9", "P"),
    ("#0072B2", "X"),
)


def processor():
    """Model of the processor as the system names it."""
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    except OSError:
        lines = []
    named = [line.partition(":")[2].strip() for line in lines if line.startswith("model name")]
    return named[0] if named else platform.processor() or platform.machine()


def digits(value, significant=3):
    """A number with so many digits, never in powers of ten."""
    return f"{float(f'{value:.{significant}g}'):,.10g}"


def rows(header, body):
    return ["| " + " | ".join(map(str, row)) + " |" for row in (header, ["---"] * len(header), *body)]


def beside(timing, ours, count):
    """Microseconds a design, and the ratio to ours in brackets; or why there is none."""
    return timing.failed or f"{digits(1e6 * timing.median / count)} ({digits(timing.median / ours, 2)})"


def markdown(cases, names, runs, by_designs, by_outputs, load, took):
    libraries = ", ".join(f"{name} {version(name)}" for name in LIBRARIES)
    ours = next(iter(names))
    text = [
        "# Ride metrics: microseconds a design",
        "",
        f"{processor()}, {os.cpu_count()} cores, Python {platform.python_version()}, {libraries}. "
        f"One run of {took:.0f} s; load average at its start {load:.1f} (0 on a quiet machine; the higher, the "
        "noisier the figures).",
        "",
        "In brackets: times ours for as many designs; below 1, the peer is faster. "
        "Ours starts from parameters and ends with a checked, labelled Dataset of every metric at every point; peers "
        "start from assembled matrices and end with bare arrays. "
        "Each figure is the median of 5 runs after a warm-up, of 3 from 10^6 designs; 10^7 designs are run once. "
        "A dash: not run, since a tenth as many designs took more than 0.2 s a run. "
        "One BLAS thread, and one processor for all but ours in compiled code, which takes every processor: from "
        f"{MANY:,} full cars with unequal corners and from {PLENTY:,} designs of the others; rigid tyres never.",
        "",
    ]
    for case in cases:
        counts = [n for n in runs if n <= case.largest]
        own = {n: by_designs[case.name, ours, n].median for n in counts}
        body = [[f"**{names[ours]}**", *(f"**{digits(1e6 * own[n] / n)}**" for n in counts)]]
        for contender in case.contenders[1:]:
            found = (by_designs.get((case.name, contender, n)) for n in counts)
            cells = (timing and beside(timing, own[n], n) for n, timing in zip(counts, found, strict=True))
            body.append([names[contender], *(cell or "–" for cell in cells)])
        body.append(["designs/s, ours", *(digits(n / own[n], 2) for n in counts)])
        text += [f"## {case.name.capitalize()}", "", *rows(["designs at once", *(f"{n:,}" for n in counts)], body), ""]
    text += degrees_of_freedom(cases, names, by_designs)
    text += outputs(names, by_outputs)
    text += first_calls(cases, ours, by_designs)
    return "\n".join(text)


def degrees_of_freedom(cases, names, by_designs):
    ours, eig, lyapunov, *_ = names
    body = []
    for case in cases:
        if {eig, lyapunov} <= set(case.contenders):
            own = by_designs[case.name, ours, 1000].median
            peers = (beside(by_designs[case.name, peer, 1000], own, 1000) for peer in (eig, lyapunov))
            many = 1e6 * by_designs[case.name, ours, 10**5].median / 10**5
            body.append([case.degrees_of_freedom, case.name, digits(1e3 * own), *peers, digits(many)])
    header = ["degrees of freedom", "", *(names[n] for n in (ours, eig, lyapunov)), "ours, 100,000 designs"]
    return ["## Against degrees of freedom, 1000 designs", "", *rows(header, body), ""]


def outputs(names, by_outputs, count=100):
    every = max(number for _, number in by_outputs)
    ours = next(iter(names))
    own = by_outputs[ours, every].median
    body = [[f"**{names[ours]}**", "all come at once", f"**{digits(1e6 * own / count)}**"]]
    for peer in dict.fromkeys(name for name, _ in by_outputs if name != ours):
        cells = (beside(by_outputs[peer, number], own, count) for number in (1, every))
        body.append([names[peer].partition(",")[0], *cells])
    return [
        f"## Against outputs, {count} full cars",
        "",
        *rows(["", "one output", f"all {every} outputs"], body),
        "",
    ]


def first_calls(cases, ours, by_designs):
    body = []
    for case in cases:
        for count in (n for n in (1, 10**5, PLENTY) if n <= case.largest):
            timing = by_designs[case.name, ours, count]
            body.append([case.name, f"{count:,}", digits(1e3 * timing.first), digits(1e3 * timing.median)])
    return [
        "## First calls of ours",
        "",
        "In the order of the run. The first of all also loads the modules; one that takes a second or more longer than "
        "later ones loads compiled code, or compiles it if no earlier run has.",
        "",
        *rows(["", "designs at once", "first call, ms", "later calls, ms"], body),
        "",
    ]


def plot(cases, names, by_designs):
    """Full cars by all contenders above, all vehicles by ours below, one column wide."""
    figure = Figure(figsize=(3.5, 6.4), layout="constrained")
    above, below = figure.subplots(2, 1, sharex=True, height_ratios=(1.3, 1.0))
    ours = next(iter(names))

    def draw(axes, case, contender, label, style, width):
        timings = {n: t for (c, p, n), t in by_designs.items() if (c, p) == (case, contender) and not t.failed}
        points = [(n, 1e6 * t.median / n) for n, t in timings.items()]
        if not points:
            return None
        color, marker = style
        axes.loglog(*zip(*points, strict=True), color=color, marker=marker, ms=4, lw=width, label=label)
        return (*points[-1], label, color)

    ends = [
        draw(above, "full car", contender, name, style, 2.2 if contender == ours else 1.1)
        for (contender, name), style in zip(names.items(), STYLES, strict=True)
    ]
    height = 0.0
    for n, microseconds, name, color in sorted(filter(None, ends), key=lambda end: end[1]):
        # Beside the end of its line, above the label below it; ours, which falls to its end, has room below.
        height = max(microseconds, 1.9 * height)
        place = {"xytext": (4, -16), "ha": "right"} if name == names[ours] else {"xytext": (6, 0), "ha": "left"}
        above.annotate(name, (n, height), textcoords="offset points", va="center", color=color, fontsize=7.5, **place)
    # Turned so that ours on full cars is black in both.
    for case, style in zip(cases, STYLES[3:] + STYLES[:3], strict=True):
        draw(below, case.name, ours, case.name, style, 1.1)
    entries = below.get_legend_handles_labels()
    figure.legend(*entries, loc="outside lower center", ncols=2, fontsize=7.5, frameon=False, handlelength=1.5)
    # Room for the labels at the ends of lines.
    above.set_xlim(0.5, 4e8)
    above.margins(y=0.1)
    above.set_title("full car, all contenders", fontsize=9)
    below.set_title(f"all vehicles, {names[ours]}", fontsize=9)
    below.set_xlabel("designs at once", fontsize=9)
    for axes in (above, below):
        axes.set_ylabel("time a design (µs)", fontsize=9)
        axes.tick_params(labelsize=8)
        axes.grid(linewidth=0.3)
    return figure


def write(folder, name, text, figure):
    """Replace the results of a name, each as a whole."""
    folder.mkdir(exist_ok=True)
    with tempfile.TemporaryDirectory(prefix=".bench-", dir=folder) as scratch:
        table, image = Path(scratch, f"{name}.md"), Path(scratch, f"{name}.png")
        table.write_text(text, encoding="utf-8")
        figure.savefig(image, dpi=200)
        for new in (table, image):
            new.replace(folder / new.name)
