"""The explorer's page as a Dash application, which answers this machine alone."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from ..extras import needing
from .background import background
from .compute import compute
from .downloads import offer
from .server import guard
from .state import NOTHING, Given

if TYPE_CHECKING:
    import dash


def application(given: Given = NOTHING) -> dash.Dash:
    """The page: what it holds is `layout`, what it shows is `compute`.

    Its stores are ``state``, which the page's scripts write, and ``results``, which is `compute` of it; ``conditions``,
    a state that they write where more than springs and dampers moved, and ``background`` of that.

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

    app = dash.Dash(__package__, title="susp_ss explorer", update_title="", add_log_handler=False)
    offer(app.server, given)
    app.layout = _layout(given)

    @app.callback(dash.Output("results", "data"), dash.Input("state", "data"))
    def answer(state: Any) -> Any:
        return compute(state, given)

    @app.callback(dash.Output("background", "data"), dash.Input("conditions", "data"), prevent_initial_call=True)
    def answer_slowly(conditions: Any) -> Any:
        return background(conditions, given)

    guard(app.server, app.csp_hashes())
    return app


def _layout(given: Given) -> Any:
    from dash import dcc, html

    return html.Div(
        [
            dcc.Store(id="state", data=given.default()),
            dcc.Store(id="results"),
            dcc.Store(id="conditions"),
            dcc.Store(id="background"),
            dcc.Store(id="table", data=given.document()),
        ]
    )
