"""A scan of scenarios as text for the terminal."""

from __future__ import annotations

import textwrap

from ...study.scan import DEFAULT, DISTANCES, FACTORS, Scan

NEAREST = 10
"""Scenarios that are printed."""


def scan_text(scan: Scan) -> str:
    """The nearest scenarios, and what each assumption can and cannot reach."""
    finite, refused, summary = scan.finite, scan.refused, scan.nearest_by_factor()
    spread = summary.groupby("factor", sort=False)["distance"].agg(lambda d: d.max() - d.min())
    said = [
        f"{len(scan.scenarios)} scenarios, {len(refused)} of them without finite variance. Distance: root mean square "
        "of the relative differences over all printed, usable entries of Tables 3 to 5; accuracies, coefficients of RB "
        "and VB, and masses are its parts. A coefficient that a nonnegative fit holds at 0 counts as 1. Nothing is "
        "tuned to the tables, and the nearest scenario is not a claim about the published run.",
        f"The choice of {spread.idxmax()} matters most (its levels reach {spread.max():.2g} apart), that of "
        f"{spread.idxmin()} least ({spread.min():.2g}).",
        f"No scenario comes nearer than {finite['distance'].min():.3g}; its entry furthest off, as a multiple of "
        f"print, is {finite['worst'].iloc[0]}. {_default_rank(scan)}",
    ]
    intro, most, nearest = (textwrap.fill(sentence, 110) for sentence in said)
    number = "{:.3g}".format
    tables = [
        finite.head(NEAREST)[[*FACTORS, *DISTANCES, "worst"]].to_string(index=False, float_format=number),
        "Nearest distance that each assumption reaches, the others free:\n"
        + summary.to_string(index=False, float_format=number, na_rep="-"),
    ]
    if len(refused):
        combinations = refused[["excited", "tracks", "delay", "cutoff"]].drop_duplicates()
        tables.append("Without finite variance, as the road warps the car without bound:\n")
        tables[-1] += combinations.to_string(index=False)
    return "\n\n".join([intro, *tables, most, nearest]) + "\n"


def _default_rank(scan: Scan) -> str:
    rank = scan.rank(DEFAULT)
    if rank is None:
        return ""
    at = scan.finite["distance"].iloc[rank - 1]
    return f"The default scenario of feasibility_study is number {rank}, at {at:.3g}."
