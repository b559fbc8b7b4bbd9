"""The explorer's page as a Dash application, which answers this machine alone."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from ..extras import needing
from .compute import compute
from .server import guard
from .state import NOTHING, Given

if TYPE_CHECKING:
    import dash


def application(given: Given = NOTHING) -> dash.Dash:
    """The page: what it holds is `layout`, what it shows is `compute`.

    Its stores are ``state``, which the page's scripts write, and ``results``, which is `compute` of it.

    Parameters
    ----------
    given : Given
        What the explorer was started with.

    Raises
    ------
    ModuleNotFoundError
        Dash is not installed.
    """
    with needing("explorer", "The explorer"):
        import dash

    app = dash.Dash(__package__, title="susp_ss explorer", update_title="", add_log_handler=False, enable_mcp=False)
    guard(app.server)
    app.layout = _layout(given)

    @app.callback(dash.Output("results", "data"), dash.Input("state", "data"))
    def answer(state: Any) -> Any:
        return compute(state, given)

    return app


def _layout(given: Given) -> Any:
    from dash import dcc, html

    return html.Div(
        [
            dcc.Store(id="state", data=given.default()),
            dcc.Store(id="results"),
            dcc.Store(id="table", data=given.document()),
        ]
    )
