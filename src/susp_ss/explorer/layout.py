"""What stands on the explorer's page before its scripts fill it: its tables, buttons and a panel a picture."""

from __future__ import annotations

from typing import Any

from ..quantities import HANDLING, KNOWN, POSITIONS, SHIFT, Quantity, typeset, units_of
from .rows import PLACES, spoken
from .state import Given
from .table import Number

# What people say in another unit than the engine; of all else, what `quantities` shows.
SHOWN = {"roughness": "cm^3", "bump_height": "mm"}

COLUMNS = (
    ("metrics", "comfort", "surrogates", "speeds"),
    ("ride", "modes", "carpet"),
    ("bode", "psd"),
)
"""Panels beside and below one another, where there is room."""

PANELS = {
    "metrics": ("Metrics", "Root mean squares on the road, and damper power, beside the pinned designs."),
    "ride": ("Over the bump", "The car drives over one bump; heights are three times as large, time runs slower."),
    "modes": ("Modes", "Each mode as the car moves in it, all at one pace and size."),
    "comfort": ("Comfort", "Weighted accelerations by ISO 2631-1 and what people say of their sum."),
    "bode": ("Frequency response", "Per metre of the road under the output's own wheel, or else under the first."),
    "psd": ("Spectrum", "Power spectral density on the road; filled, as weighted for comfort."),
    "speeds": ("Over speed", "Metrics at other speeds on the same road."),
    "carpet": (
        "Carpet",
        "Grey: springs by dampers, halved to doubled. Where there are: solid, the Pareto front, points to take; "
        "dotted, the least that any active suspension reaches.",
    ),
    "surrogates": ("Surrogates", "What each predicts of its expensive model, its interval, and what this vehicle has."),
}
"""For each panel its title and what it shows."""

DOWNLOADS = {
    "csv": ("CSV", "CSV file of the metrics"),
    "toml": ("TOML", "TOML file of the vehicle, for --vehicle"),
    "fmu": ("FMU", "functional mock-up unit of the vehicle"),
    "py": ("Python", "lines that make the same again"),
}
"""Kinds of files: word on the button and what it is."""


ELSEWHERE = "FMUs have C source alone here; with a binary, and for cars of your own: susp-ss explore"
"""What a page without a server says beside its downloads."""

OPEN = ("open", "Open file", "Open file: surrogate.json of susp-ss fit, one or several; they stay in this browser")
"""The button that such a page has in the panel of surrogates: its name, text and words."""


def layout(given: Given, served: bool = True) -> Any:
    """The page: the store ``table``, which its scripts begin with, and what they fill.

    Where it is not ``served``, it says what it lacks.
    """
    from dash import dcc, html

    return html.Div(
        [
            dcc.Store(id="table", data=given.document() | {"words": _words(given)}),
            html.Header(_header(served), id="head"),
            html.Ul(id="errors", role="alert"),
            html.Aside([html.Div(id="sliders")], id="controls", **_aria(label="Sliders")),
            html.Main(
                [html.Div([_panel(name, served, *PANELS[name]) for name in column]) for column in COLUMNS],
                id="panels",
                **_aria(busy="true"),
            ),
            html.P(id="said", role="status"),
        ],
        id="page",
    )


def _header(served: bool) -> list[Any]:
    from dash import html

    kinds = [_button(f"download-{kind}", text, f"Download: {words}") for kind, (text, words) in DOWNLOADS.items()]
    downloads = html.Div([html.Span("Download", className="quiet"), *kinds], id="downloads")
    elsewhere = [] if served else [html.Span(ELSEWHERE, className="quiet", id="elsewhere")]
    return [
        html.H1("susp_ss explorer"),
        html.Label(["Model", html.Span(id="models")]),
        html.Div([_button("undo", "Undo", "Undo (Ctrl+Z)"), _button("redo", "Redo", "Redo (Ctrl+Shift+Z)")]),
        html.Div([_button("pin", "Pin design", "Pin this design and compare others with it")]),
        html.Ul(id="pins", **_aria(label="Pinned designs")),
        downloads,
        *elsewhere,
    ]


def _button(name: str, text: str, words: str) -> Any:
    from dash import html

    return html.Button(text, id=name, type="button", title=words, **_aria(label=words))


def _panel(name: str, served: bool, title: str, words: str) -> Any:
    from dash import html

    tools = [_button(*OPEN)] if name == "surrogates" and not served else []
    return html.Section(
        [
            html.H2(title, id=f"{name}-title"),
            html.Div(tools, id=f"{name}-tools", className="tools"),
            html.P(words, className="quiet"),
            html.Div(id=f"{name}-set", className="set"),
            html.Div(id=name, className="body"),
        ],
        id=f"panel-{name}",
        className="panel",
        **_aria(labelledby=f"{name}-title"),
    )


def _aria(**words: str) -> dict[str, Any]:
    """What those who listen are told of an element."""
    return {f"aria-{name}": text for name, text in words.items()}


def _words(given: Given) -> dict[str, Any]:
    """Quantities with their unit on the page and how much of the SI unit one is; units of rows; places."""

    def unit(si: str, shown: str) -> dict[str, Any]:
        return {"unit": typeset(shown), "one": units_of(si)[shown]}

    def of(quantity: Quantity) -> dict[str, Any]:
        return unit(quantity.unit, quantity.shown or quantity.unit) | {"meaning": spoken(quantity)}

    numbers = [row for table in given.tables.values() for row in table if isinstance(row, Number)]
    quantities = POSITIONS | KNOWN | HANDLING | {SHIFT.name: SHIFT}
    units = {row.name: unit(row.unit, SHOWN.get(row.name) or _shown(row.name) or row.unit) for row in numbers}
    return {
        "quantities": {name: of(one) for name, one in quantities.items()},
        "units": units,
        "places": PLACES,
    }


def _shown(row: str) -> str:
    """The unit in which the quantity of a row, perhaps at a place, is shown."""
    stems = [name for name in KNOWN if f"{row}_".startswith(f"{name}_")]
    return KNOWN[max(stems, key=len)].shown if stems else ""
