"""Formulas as MathML, which browsers show by themselves: no script, no network, and they print."""

import re
from html import unescape
from typing import Any
from xml.etree import ElementTree
from xml.etree.ElementTree import Element

from docutils import nodes
from docutils.utils.math import MathError
from docutils.utils.math.latex2mathml import tex2mathml
from sphinx.util import logging
from sphinx.util.math import get_node_equation_number

logger = logging.getLogger(__name__)

SPACE = "http://www.w3.org/1998/Math/MathML"
ElementTree.register_namespace("", SPACE)

# What docutils does not read as TeX does: a delimiter of stated size on neither side, a fraction of two digits.
READ = ((r"\\([bB]igg?)(?![A-Za-z])", r"\\\1l"), (r"\\frac(\d)(\d)", r"\\frac{\1}{\2}"))


NAMED = r"&(?!amp;|lt;|gt;)\w+;"
"""Characters by names of HTML's, which XML does not know."""


def _tag(name: str) -> str:
    return f"{{{SPACE}}}{name}"


def _accented(parent: Element) -> None:
    """Let the index of an accented letter stand beside it; docutils has it below, as of a limit."""
    for child in parent:
        _accented(child)
        if child.tag == _tag("munderover") and child[2].get("stretchy") == "false":
            letter, index, accent = child
            over = Element(_tag("mover"), accent="true")
            over.extend((letter, accent))
            child[:] = over, index
            child.tag = _tag("msub")
    if parent.tag == _tag("msup") and parent[0].tag == _tag("msub"):
        parent[:] = *parent[0], parent[1]
        parent.tag = _tag("msubsup")


def _mathml(node: nodes.Element, **how: Any) -> str:
    tex = node.astext()
    for pattern, known in READ:
        tex = re.sub(pattern, known, tex)
    try:
        tree = ElementTree.fromstring(re.sub(NAMED, lambda found: unescape(found[0]), tex2mathml(tex, **how)))
    except MathError as error:
        logger.warning("%s: %s", tex, error, location=node)
        return tex
    _accented(tree)
    return ElementTree.tostring(tree, encoding="unicode")


def _inline(writer: Any, node: nodes.math) -> None:
    writer.body.append(_mathml(node))
    raise nodes.SkipNode


def _display(writer: Any, node: nodes.math_block) -> None:
    writer.body.append(writer.starttag(node, "div", CLASS="math"))
    if node["number"]:
        writer.body.append(f'<span class="eqno">({get_node_equation_number(writer, node)})')
        writer.add_permalink_ref(node, "Link to this equation")
        writer.body.append("</span>")
    writer.body.append(_mathml(node, as_block=True) + "</div>\n")
    raise nodes.SkipNode


def setup(app: Any) -> dict[str, bool]:
    """Be the way to show formulas."""
    app.add_html_math_renderer("mathml", (_inline, None), (_display, None))
    app.config.html_math_renderer = "mathml"
    return {"parallel_read_safe": True, "parallel_write_safe": True}
