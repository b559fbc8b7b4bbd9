"""The explorer's page as a Dash application, which answers this machine alone."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from ..extras import needing
from .answers import answer
from .background import background
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
    """The page: what it holds is `layout`, what its scripts ask for is `answer` and `background`.

    They ask past Dash, whose components would compare and copy all that is drawn at each move of a slider.

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

    start = dash.ClientsideFunction("explorer", "start")
    app.clientside_callback(start, dash.Input("table", "data"))
    if not served:
        return app

    offer(app.server, given)
    reply(app.server, "answer", lambda question: answer(question, given))
    reply(app.server, "background", lambda conditions: (slowly or background)(conditions, given))
    guard(app.server, app.csp_hashes())
    return app


def reply(server: Any, name: str, found: Callable[[Any], Any]) -> None:
    """Let a Flask application answer what is posted to ``/name``: JSON by JSON, a ValueError in one line."""
    with needing("explorer", "The explorer"):
        import orjson
    from flask import request

    @server.post(f"/{name}", endpoint=name)
    def replied() -> Any:
        try:
            text = orjson.dumps(found(request.get_json()), option=orjson.OPT_SERIALIZE_NUMPY)
        except ValueError as error:
            return str(error), 400, {"Content-Type": "text/plain"}
        return text, {"Content-Type": "application/json"}
