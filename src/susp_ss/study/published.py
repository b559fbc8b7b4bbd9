"""Tables 3 to 5 of the study, as printed, and how a run of ours compares with them.

The source is *Feasibility study of surrogate model for the application of vehicle suspension system*, 2021. It states
neither the road nor the speed nor the place behind its tables, so that agreement entry by entry is not to be expected.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import pandas as pd

from ..quantities import METRICS, PARAMETERS

CRITERIA = {name: METRICS[name].unit for name in ("bacc", "dtl", "sws")}
"""The study's three criteria, in its order, with their SI units."""

SURROGATES = {"RB": "S = a0 + a1 f", "VB": "S = f + a0 + a1 K_s + a2 C_s", "PB": "S = f(M_s)"}
"""The study's three surrogates, with f the low-fidelity response."""

TABLES = {"RB": "Table 3", "VB": "Table 4", "PB": "Table 5"}
FIGURES = {"RB": "Figure 4", "VB": "Figure 5", "PB": "Figure 6"}
ACCURACY = ("R2", "RMSE", "MAE")
COEFFICIENTS = {"RB": ("a0", "a1"), "VB": ("a0", "a1", "a2"), "PB": ("ms",)}
LABELS = {name: METRICS[name].symbol for name in CRITERIA}

# Table 4's SWS column has a0 = 61.1685 where no deflection comes near: its digits belong elsewhere.
UNUSABLE = ("VB", "sws")

NEAR = 0.25
"""Relative difference up to which a value counts as near the published one."""

_NAN = float("nan")  # A '-' in print: unknown.

# (surrogate, criterion): R2, RMSE, MAE, then the coefficients of the surrogate in the order of COEFFICIENTS. The study
# prints the errors of DTL in kN and its coefficients in N; here all are in N.
_PRINTED = {
    ("RB", "bacc"): (0.9218, 0.0351, 0.0879, _NAN, 1.8149),
    ("RB", "dtl"): (0.9970, 2.2850, 4.1415, 109.4078, 0.7473),
    ("RB", "sws"): (0.9526, 1.7969e-4, 3.4127e-4, 0.0010, 0.9999),
    ("VB", "bacc"): (0.9996, 0.0026, 0.0064, 0.3251, _NAN, 1.4559e-4),
    ("VB", "dtl"): (0.9950, 2.9671, 7.8310, _NAN, 1.8652e-4, 0.0322),
    ("VB", "sws"): (0.9926, 7.1046e-5, 1.5637e-4, 61.1685, 2.7149e-6, 5.0812e-9),
    ("PB", "bacc"): (0.9475, 0.0295, 0.0731, 195.4),
    ("PB", "dtl"): (0.8476, 16.7876, 38.5780, 263.3),
    ("PB", "sws"): (0.8684, 3.0715e-4, 7.5847e-4, 451.6),
}


class Published(NamedTuple):
    """Published accuracies and coefficients, in SI units; NaN where print has a '-' or the model no such term.

    Examples
    --------
    >>> from susp_ss.study.published import published
    >>> published().coefficients.loc[("PB", "bacc"), "ms"].item()
    195.4
    """

    accuracy: pd.DataFrame
    coefficients: pd.DataFrame


def index() -> pd.MultiIndex:
    """Every surrogate by every criterion, in the order of the study."""
    return pd.MultiIndex.from_product([SURROGATES, CRITERIA], names=["surrogate", "criterion"])


def published() -> Published:
    """Return Tables 3 to 5 of the study.

    Returns
    -------
    Published
        ``accuracy`` with columns R2, RMSE, MAE (the maximum absolute error) and ``coefficients`` with columns a0, a1,
        a2, ms; both indexed by (surrogate, criterion).

    Examples
    --------
    >>> from susp_ss.study.published import published
    >>> published().accuracy.loc[("RB", "dtl"), "RMSE"].round(4).item()
    2.285
    """
    accuracy = pd.DataFrame(index=index(), columns=list(ACCURACY), dtype=float)
    coefficients = pd.DataFrame(index=index(), columns=["a0", "a1", "a2", "ms"], dtype=float)
    for key, values in _PRINTED.items():
        accuracy.loc[key] = values[:3]
        coefficients.loc[key, list(COEFFICIENTS[key[0]])] = values[3:]
    return Published(accuracy, coefficients)


def unit(quantity: str, surrogate: str, criterion: str) -> str:
    """SI unit of an entry of the tables."""
    own = CRITERIA[criterion]
    if quantity in ("RMSE", "MAE", "a0"):
        return own
    if quantity == "ms":
        return PARAMETERS["ms"].unit
    if quantity == "R2" or surrogate == "RB":
        return "1"
    return f"{own}/({PARAMETERS['ks' if quantity == 'a1' else 'cs'].unit})"


def comparison(accuracy: pd.DataFrame, coefficients: pd.DataFrame) -> pd.DataFrame:
    """Put a run's tables beside the published ones, one row an entry.

    Parameters
    ----------
    accuracy, coefficients : DataFrame
        As `feasibility_study` gives them.

    Returns
    -------
    DataFrame
        Columns table, surrogate, criterion, quantity, unit, ours, published.
    """
    ours = accuracy.join(coefficients)
    theirs = published().accuracy.join(published().coefficients)
    rows = [
        (TABLES[key[0]], *key, quantity, unit(quantity, *key), ours.at[key, quantity], theirs.at[key, quantity])
        for key in index()
        for quantity in ACCURACY + COEFFICIENTS[key[0]]
    ]
    names = ["table", "surrogate", "criterion", "quantity", "unit", "ours", "published"]
    return pd.DataFrame(rows, columns=names)


def usable(entries: pd.DataFrame) -> pd.Series:
    """Which rows of a `comparison` have a published value that can be compared with."""
    surrogate, criterion = UNUSABLE
    lost = (entries.surrogate == surrogate) & (entries.criterion == criterion)
    return entries.published.notna() & ~lost


def relative_differences(entries: pd.DataFrame) -> pd.Series:
    """``(ours - published) / |published|`` of the usable rows of a `comparison`."""
    known = entries[usable(entries)]
    return (known.ours - known.published) / known.published.abs()


def agreement(entries: pd.DataFrame, surrogate: str) -> str:
    """Say in one line which entries of a surrogate's table come near the published ones, and which do not."""
    table = entries[entries.surrogate == surrogate]
    known = table[usable(table)]
    opposite = known.ours * known.published < 0.0
    near = relative_differences(table).abs() <= NEAR
    ratio, blank = known.ours / known.published, table[table.published.isna()]
    parts = {
        f"within {NEAR:.0%}": _grouped(known[near]),
        "further off, as multiples of print": _grouped(known[~near & ~opposite], " x{:.2g}", ratio),
        "opposite sign": _grouped(known[opposite]),
        "'-' in print, ours": _grouped(blank, " {:.3g}", blank.ours),
    }
    ours, theirs = (_r2_order(table, side) for side in ("ours", "published"))
    parts["R2 order"] = f"{ours}, as published" if ours == theirs else f"{ours}, published {theirs}"
    return "; ".join(f"{label}: {said}" for label, said in parts.items() if said)


def _grouped(rows: pd.DataFrame, remark: str = "", values: pd.Series | None = None) -> str:
    """Rows by quantity, such as ``R2 BAcc DTL, a1 SWS``, each with its value in a remark."""
    groups: dict[str, str] = {}
    remarks = [""] * len(rows) if values is None else values[rows.index].map(remark.format)
    for quantity, criterion, said in zip(rows.quantity, rows.criterion, remarks, strict=True):
        groups[quantity] = f"{groups.get(quantity, quantity)} {LABELS[criterion]}{said}"
    return ", ".join(groups.values())


def _r2_order(table: pd.DataFrame, side: str) -> str:
    r2 = table[table.quantity == "R2"].sort_values(side, ascending=False)
    return " > ".join(r2.criterion.map(LABELS))


def ranking(accuracy: pd.DataFrame) -> dict[str, str]:
    """The surrogates of each criterion, highest R2 first, such as ``{"bacc": "VB > PB > RB"}``."""
    r2 = accuracy["R2"].unstack("criterion")
    return {criterion: " > ".join(r2[criterion].sort_values(ascending=False).index) for criterion in CRITERIA}


def printed_spread() -> pd.DataFrame:
    """Standard deviation of the high-fidelity response over the nodes that each table implies.

    ``RMSE / sqrt(1 - R2)``; the tables must agree with one another, as the high-fidelity response is the same.
    """
    accuracy = published().accuracy
    spread = accuracy["RMSE"] / np.sqrt(1.0 - accuracy["R2"])
    return spread.unstack("criterion")[list(CRITERIA)].loc[list(SURROGATES)]
