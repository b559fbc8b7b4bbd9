"""The explorer's server: on this machine's own address alone, for pages of its own alone."""

from __future__ import annotations

import logging
import select
import socket
import threading
import webbrowser
from collections.abc import Sequence
from contextlib import suppress
from typing import Any
from urllib.parse import urlsplit

from ..surrogates.folds import one_blas_thread

HOST = "127.0.0.1"

NAMES = {"localhost", "127.0.0.1", "::1"}
"""What a browser may call this machine by; any other name that leads here is somebody else's."""


HEADERS = {
    "X-Content-Type-Options": "nosniff",
    "X-Frame-Options": "DENY",
    "Referrer-Policy": "no-referrer",
    "Cross-Origin-Resource-Policy": "same-origin",
}

POLICY = (
    "default-src 'none'; script-src 'self' {scripts}; style-src 'self' 'unsafe-inline'; img-src 'self' data: blob:; "
    "font-src 'self' data:; connect-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
)


def guard(server: Any, scripts: Sequence[str]) -> None:
    """Let a Flask application refuse whatever does not come from a page of its own.

    A foreign page could send a browser here under a name of its own (DNS rebinding), which ``Host`` tells, or by a
    request across sites, which ``Origin`` or ``Sec-Fetch-Site`` tell; a link to the page itself may be anywhere. The
    page may load nothing from elsewhere and run no script within it but those of the hashes ``scripts``.
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
        if request.path == "/_dash-update-component":  # Dash would take the shape of what is asked there for granted.
            abort(400, "this explorer has no callback of Dash to answer")

    @server.after_request
    def keep_to_itself(response: Any) -> Any:
        response.headers.update(HEADERS)
        response.headers["Content-Security-Policy"] = POLICY.format(scripts=" ".join(scripts))
        return response


def listening(app: Any, port: int) -> Any:
    """A server of a Dash application, listening on this machine alone; port 0 takes one that is free.

    Raises
    ------
    OSError, OverflowError
        The port is taken, or none.
    """
    from werkzeug.serving import WSGIRequestHandler, make_server

    class Handler(WSGIRequestHandler):
        """Keeps a connection open: a slider asks many times a second."""

        protocol_version = "HTTP/1.1"

    logging.getLogger("werkzeug").setLevel(logging.ERROR)
    # Left to itself, werkzeug would print and exit where the port is taken.
    with socket.create_server((HOST, port)) as taken:
        return make_server(HOST, port, app.server, threaded=True, request_handler=Handler, fd=taken.fileno())


def address(server: Any) -> str:
    """Where a browser finds its page."""
    return f"http://{HOST}:{server.port}/"


def left() -> bool:
    """Whether the page that this thread answers waits no more: it has closed its connection."""
    from flask import has_request_context, request

    if not has_request_context() or (line := request.environ.get("werkzeug.socket")) is None:
        return False
    try:
        return bool(select.select([line], [], [], 0.0)[0]) and not line.recv(1, socket.MSG_PEEK)
    except OSError:
        return True


def serve(server: Any, browser: bool) -> None:
    """Answer until interrupted; ``browser`` opens the page."""
    if browser:
        threading.Timer(0.3, webbrowser.open, [address(server)]).start()
    with suppress(KeyboardInterrupt), server, one_blas_thread():
        server.serve_forever()
