"""The explorer's page as a Dash application, which answers this machine alone."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from ..extras import needing
from .background import background
from .compute import compute
from .downloads import offer
from .layout import layout
from .server import guard
from .state import NOTHING, Given

if TYPE_CHECKING:
    import dash

# A wheel on its spring, in the page itself: browsers ask for a file again whenever the address changes.
ICON = (
    "<link rel='icon' href=\"data:image/svg+xml,<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 16 16' fill='none'"
    " stroke='%230072b2' stroke-width='1.6'><circle cx='8' cy='11.5' r='3.6'/><path d='M2 1h12M8 1l3 1.6-6 2 6 2L8 8'/>"
    '</svg>">'
)


def application(
    given: Given = NOTHING, served: bool = True, slowly: Callable[[Any, Given], Any] | None = None
) -> dash.Dash:
    """The page: what it holds is `layout`, what it shows is `compute`.

    Its stores are ``state``, which the page's scripts write, and ``results``, which is `compute` of it; ``conditions``,
    a state that they write where more than springs and dampers moved, and ``background`` of that.

    Parameters
    ----------
    given : Given
        What the explorer was started with.
    served : bool
        Whether a server answers; without one, the functions of `javascript.engine` do.
    slowly : callable, optional
        Stands for `background`, such as that of `Beside`.

    Raises
    ------
    ModuleNotFoundError
        Dash is not installed.
    """
    with needing("explorer", "The explorer"):
        import dash

    app = dash.Dash(__package__, title="susp_ss explorer", update_title="", add_log_handler=False)
    app.index_string = app.index_string.replace("{%favicon%}", ICON)
    app.layout = layout(given, served)

    def script(function: str, store: str) -> None:
        app.clientside_callback(dash.ClientsideFunction("explorer", function), dash.Input(store, "data"))

    script("start", "table")
    script("answered", "results")
    script("answeredSlowly", "background")
    if not served:
        for function, store, question in (("compute", "results", "state"), ("background", "background", "conditions")):
            stores = dash.Output(store, "data"), dash.Input(question, "data")
            app.clientside_callback(dash.ClientsideFunction("engine", function), *stores, prevent_initial_call=True)
        return app

    offer(app.server, given)

    @app.callback(dash.Output("results", "data"), dash.Input("state", "data"), prevent_initial_call=True)
    def answer(state: Any) -> Any:
        return compute(state, given)

    @app.callback(dash.Output("background", "data"), dash.Input("conditions", "data"), prevent_initial_call=True)
    def answer_slowly(conditions: Any) -> Any:
        return (slowly or background)(conditions, given)

    guard(app.server, app.csp_hashes())
    return app
