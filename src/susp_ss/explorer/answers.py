"""What the page asks while its sliders move: of one design everything, of those to compare it with what is drawn."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from ..quantities import briefly
from .compute import Found, compute_all
from .state import NOTHING, Given

COMPARED = {
    "metrics": ("name", "value"),
    "comfort": ("point", "total"),
    "bode": ("output", "magnitude", "phase"),
    "psd": ("output", "psd"),
    "modes": ("name", "frequency"),
}
"""What is shown of each part of a design to compare with, beside its curves over speed and over the bump."""


def answer(question: Any, given: Given = NOTHING) -> Found:
    """The design that moves, and others under the same conditions.

    Parameters
    ----------
    question : dict
        ``state`` and ``pins``, a list of states, as the page has them.
    given : Given
        What the explorer was started with.

    Returns
    -------
    dict
        ``found``, `compute` of the state, and ``pins``, `compared` of each.

    Raises
    ------
    ValueError
        It is no such question; a state that is wrong is answered in words, as `compute` does.

    Examples
    --------
    >>> from susp_ss.explorer.answers import answer
    >>> found = answer({"state": {"model": "quarter"}, "pins": [{"model": "quarter", "vehicle": {"ks": 30e3}}]})
    >>> found["found"]["metrics"][0]["value"] < found["pins"][0]["metrics"][0]["value"]
    True
    """
    if not isinstance(question, Mapping) or not isinstance(question.get("pins"), list) or "state" not in question:
        raise ValueError(f"question must be a mapping of a state and a list of pins, got {briefly(question)}")
    found, *pins = compute_all([question["state"], *question["pins"]], given)
    return {"found": found, "pins": [compared(pin) for pin in pins]}


def compared(whole: Found) -> Found:
    """What the page shows of a design to compare with: the parts of `compute` that it draws, `COMPARED` of each.

    Examples
    --------
    >>> from susp_ss.explorer.answers import compared
    >>> from susp_ss.explorer.compute import compute
    >>> compared(compute({"model": "quarter"}))["modes"][0].keys()
    dict_keys(['name', 'frequency'])
    """
    found: Found = {
        part: [{key: one[key] for key in keys} for one in whole[part]]
        for part, keys in COMPARED.items()
        if part in whole
    }
    if "speeds" in whole:
        rows = [{key: one[key] for key in ("name", "values")} for one in whole["speeds"]["metrics"]]
        found["speeds"] = {"speed": whole["speeds"]["speed"], "metrics": rows}
    if "bump" in whole:
        found["bump"] = {key: whole["bump"][key] for key in ("t", "acceleration")}
    if "frequency" in whole:
        found["frequency"] = whole["frequency"]
    return found
