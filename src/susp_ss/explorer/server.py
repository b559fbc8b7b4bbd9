"""The explorer's server: on this machine's own address alone, for pages of its own alone."""

from __future__ import annotations

import logging
import threading
import webbrowser
from typing import Any
from urllib.parse import urlsplit

HOST = "127.0.0.1"

NAMES = {"localhost", "127.0.0.1", "::1"}
"""What a browser may call this machine by; any other name that leads here is somebody else's."""


def guard(server: Any) -> None:
    """Let a Flask application refuse whatever does not come from a page of its own.

    A foreign page could send a browser here under a name of its own (DNS rebinding), which ``Host`` tells, or by a
    request across sites, which ``Origin`` or ``Sec-Fetch-Site`` tell; a link to the page itself may be anywhere.
    """
    from flask import abort, request

    @server.before_request
    def refuse_foreign() -> None:
        if urlsplit(f"//{request.host}").hostname not in NAMES:
            abort(403, f"this explorer answers {HOST} alone, not {request.host}")
        origin, site = request.headers.get("Origin"), request.headers.get("Sec-Fetch-Site", "none")
        linked = request.method == "GET" and request.path == "/"
        foreign = origin is not None and origin != request.host_url.rstrip("/")
        if foreign or (site not in ("same-origin", "none") and not linked):
            abort(403, "this explorer answers pages of its own alone")

    @server.after_request
    def keep_to_itself(response: Any) -> Any:
        response.headers["X-Content-Type-Options"] = "nosniff"
        response.headers["X-Frame-Options"] = "DENY"
        response.headers["Referrer-Policy"] = "no-referrer"
        response.headers["Cross-Origin-Resource-Policy"] = "same-origin"
        return response


def serve(app: Any, port: int, browser: bool, say: Any) -> None:
    """Serve a Dash application until it is interrupted.

    Parameters
    ----------
    app : dash.Dash
        The page.
    port : int
        Where; 0 takes one that is free.
    browser : bool
        Whether to open the page.
    say : callable
        Is told the page's address.

    Raises
    ------
    OSError
        The port is taken.
    """
    from werkzeug.serving import make_server

    logging.getLogger("werkzeug").setLevel(logging.ERROR)
    server = make_server(HOST, port, app.server, threaded=True)
    address = f"http://{HOST}:{server.server_port}/"
    say(address)
    if browser:
        threading.Timer(0.3, webbrowser.open, [address]).start()
    try:
        server.serve_forever()
    except KeyboardInterrupt:
        pass
    finally:
        server.server_close()
