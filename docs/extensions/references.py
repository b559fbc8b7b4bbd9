"""What a name in a docstring or on a page points to, without asking the network for anybody's inventory.

A name of this package may be given by its end, ``ride_metrics`` for ``susp_ss.ride_metrics``, wherever it stands. Each
other library has one form of address for the page of a name; that the name exists is found out by importing it.
"""

import importlib
from functools import cache
from typing import Any

from docutils import nodes
from numpydoc.xref import DEFAULT_LINKS

import susp_ss
from susp_ss.surrogates.regressor import Surrogate
from susp_ss.vehicles.vehicle import Vehicle

PAGES = {
    "abc": "https://docs.python.org/3/library/abc.html#{}",
    "control": "https://python-control.readthedocs.io/en/stable/generated/{}.html",
    "numpy": "https://numpy.org/doc/stable/reference/generated/{}.html",
    "pandas": "https://pandas.pydata.org/docs/reference/api/{}.html",
    "scipy": "https://docs.scipy.org/doc/scipy/reference/generated/{}.html",
    "sklearn": "https://scikit-learn.org/stable/modules/generated/{}.html",
    "xarray": "https://docs.xarray.dev/en/stable/generated/{}.html",
}

TYPES = {
    "DataArray": "xarray.DataArray",
    "DataFrame": "pandas.DataFrame",
    "Dataset": "xarray.Dataset",
    "Vehicle": "susp_ss.vehicles.Vehicle",
    "ndarray": "numpy.ndarray",
    **{name: f"susp_ss.{name}" for name in susp_ss.__all__ if isinstance(getattr(susp_ss, name), type)},
}
"""What docstrings call types, ours and others'."""


@cache
def _exists(name: str) -> bool:
    """Whether a dotted name can be imported, or is found in what can."""
    module, _, last = name.rpartition(".")
    try:
        return hasattr(importlib.import_module(module), last)
    except ModuleNotFoundError:
        return _exists(module) and hasattr(_found(module), last)


def _found(name: str) -> Any:
    module, _, last = name.rpartition(".")
    return getattr(importlib.import_module(module), last)


def _elsewhere(target: str, content: nodes.Element) -> nodes.reference | None:
    name = TYPES.get(target, target)
    page = PAGES.get(name.split(".")[0])
    if page is None or not _exists(name):
        return None
    return nodes.reference("", "", content, internal=False, refuri=page.format(name), reftitle=name)


def _resolve(app: Any, env: Any, node: Any, content: nodes.Element) -> nodes.Element | None:
    if node.get("refdomain") != "py":
        return None
    target, domain = node["reftarget"], env.domains.python_domain
    end = target.rpartition(".")[2] if target.startswith("susp_ss.") else target
    ours = [name for name, found in domain.objects.items() if name.endswith(f".{end}") and not found.aliased]
    if len(ours) == 1:
        return domain.resolve_xref(env, node["refdoc"], app.builder, "obj", ours[0], node, content)
    return _elsewhere(target, content)


def _types(app: Any, config: Any) -> None:
    # Nobody needs a link to `float`.
    DEFAULT_LINKS.clear()
    full = ("control.StateSpace", *TYPES.values())
    config.numpydoc_xref_aliases = TYPES | {name: f":obj:`{name}`" for name in full}


def _kind(app: Any, name: str, which: type, options: Any, bases: list[type]) -> None:
    """In place of the classes that code is shared by, say what kind of thing it is."""
    bases[:] = [kind for kind in (Vehicle, Surrogate) if issubclass(which, kind) and which is not kind] or bases


def setup(app: Any) -> dict[str, bool]:
    """Resolve what is not found by its full name."""
    app.connect("autodoc-process-bases", _kind)
    app.connect("config-inited", _types, priority=400)
    app.connect("missing-reference", _resolve)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
