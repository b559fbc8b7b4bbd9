"""From a template and figures to one HTML file that carries all it needs and may fetch nothing."""

from __future__ import annotations

import base64
import hashlib
import math
from importlib import resources
from pathlib import Path
from typing import Any

import jinja2
from plotly.offline import get_plotlyjs

from ...quantities import typeset


def render(template: str, figures: dict[str, Any], **content: Any) -> str:
    """Fill in a template of this package; text of the content is escaped.

    Parameters
    ----------
    template : str
        Its file name.
    figures : dict
        For each plot of the page, by its id, one figure (``data`` and ``layout`` as plotly has them) a view; the view
        of a plot that has no choice is ``""``.
    **content
        What the template names.

    Returns
    -------
    str
        The page. Its policy lets no script run but the page's own, and nothing be fetched.
    """
    environment = jinja2.Environment(
        loader=jinja2.PackageLoader(__package__),
        autoescape=True,
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.policies["json.dumps_kwargs"] = {"allow_nan": False, "separators": (",", ":")}
    environment.filters |= {"number": number, "typeset": typeset}
    scripts = [get_plotlyjs(), _template("page.js")]
    return environment.get_template(template).render(
        figures=figures,
        scripts=scripts,
        style=_template("page.css"),
        policy="; ".join(
            [
                "default-src 'none'",
                f"script-src {' '.join(map(_hash, scripts))}",
                "style-src 'unsafe-inline'",
                "img-src data: blob:",
                "base-uri 'none'",
                "form-action 'none'",
            ]
        ),
        **content,
    )


def subscripted(symbol: str) -> str:
    """A symbol such as ``K_s`` in HTML."""
    name, _, index = symbol.partition("_")
    return f"{name}<sub>{index}</sub>" if index else name


def picture(path: Path) -> str:
    """A PNG file as an address that holds it."""
    return "data:image/png;base64," + base64.b64encode(path.read_bytes()).decode("ascii")


def number(value: float | None, digits: int = 5) -> str:
    """A number to so many digits; a dash for what is not known."""
    if value is None or math.isnan(value):
        return "–"
    mantissa, _, exponent = f"{value:.{digits}g}".partition("e")
    return (f"{mantissa}e{int(exponent)}" if exponent else mantissa).replace("-", "−")


def _template(name: str) -> str:
    return resources.files(__package__).joinpath("templates", name).read_text(encoding="utf-8")


def _hash(script: str) -> str:
    return f"'sha256-{base64.b64encode(hashlib.sha256(script.encode()).digest()).decode('ascii')}'"
