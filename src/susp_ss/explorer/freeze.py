"""The explorer as a folder of files, for any web server under any address, or for none.

The page is the one that ``susp-ss explore`` serves, its scripts and components saved as they are; what a server would
answer, the engine in JavaScript does.
"""

from __future__ import annotations

import json
import re
from pathlib import Path
from urllib.parse import urlsplit

from .app import application
from .javascript import engine

ENGINE = "engine.js"

# What Dash asks its server for before it shows a page.
ASKED = ("_dash-layout", "_dash-dependencies")

# Its answer is known; the page may then even be opened from a folder, where a browser reads no other files.
ANSWERED = """(() => {{
const known = {known}, ask = window.fetch, headers = {{ "Content-Type": "application/json" }};
window.fetch = (address, ...more) => {{
  const name = String(address?.url ?? address).split("/").pop();
  return name in known ? Promise.resolve(new Response(known[name], {{ headers }})) : ask(address, ...more);
}};
}})();
"""

# The engine, for the page itself and for what computes beside it.
BESIDE = """(window.explorer ??= {{}}).beside = () => {{
{engine}}};
explorer.beside();
"""


def freeze(folder: Path) -> Path:
    """Write the explorer's page and all that it needs.

    Parameters
    ----------
    folder : Path
        Is made, and may hold an older one.

    Returns
    -------
    Path
        The page, ``index.html``.

    Raises
    ------
    ModuleNotFoundError
        Dash is not installed.
    """
    client = application(served=False).server.test_client()

    def fetched(address: str) -> bytes:
        answer = client.get(address)
        if answer.status_code != 200:
            raise RuntimeError(f"the explorer's page needs {address}, which its server does not have")
        return answer.data

    def saved(found: re.Match[str]) -> str:
        name = urlsplit(found["address"]).path.removeprefix("/")
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(fetched(found["address"]))
        return f'{found["attribute"]}="{name}"'

    folder.mkdir(parents=True, exist_ok=True)
    page = re.sub(r'(?P<attribute>src|href)="(?P<address>/[^"]+)"', saved, fetched("/").decode())
    page = re.sub(r'("requests_pathname_prefix":)"[^"]*"', r'\1"./"', page)
    answers = {name: fetched(f"/{name}").decode() for name in ASKED}
    script = ANSWERED.format(known=json.dumps(answers)) + BESIDE.format(engine=engine())
    (folder / ENGINE).write_text(script, encoding="utf-8")
    first = '<script src="'
    page = page.replace(first, f'{first}{ENGINE}"></script>\n{first}', 1)
    index = folder / "index.html"
    index.write_text(page, encoding="utf-8")
    return index
