"""Comfort of a ride as text for the terminal."""

from __future__ import annotations

import textwrap

import pandas as pd

from ...metrics.comfort import AXES, TIMES, Comfort, doubtful, spell_time
from ...quantities import titled

ROWS = 60
"""Of a sweep, so many are printed, from its beginning and its end."""

NOTHING = 1e-12
"""What rounding leaves of a rotation that a road does not excite, in SI units."""


def comfort_text(comfort: Comfort) -> str:
    """Weighted root mean squares with the total value in words, doses, and how long a day they are permitted."""
    metrics, table = comfort.metrics, comfort.table
    felt = [name for name in AXES if name in metrics]
    named = {str(name): titled(str(name), data.attrs["units"]) for name, data in metrics.items()}
    doses = [name for name in ("vdv", "evdv", "msdv", "a8", "mtvv", "crest_factor") if name in metrics]
    counted = "; ".join(f"{name} {metrics[name].attrs['weighting']}, k = {AXES[name].k:g}" for name in felt)
    times = table[list(TIMES)].map(spell_time)
    return "\n".join(
        [
            f"Comfort: {comfort.describe()}\n",
            f"Weighted root mean squares and total value (ISO 2631-1: {counted})",
            _printed(table[[*felt, "total", "reaction"]].rename(columns=named)),
            "\nDoses of the exposure and peaks, vertical",
            _printed(table[doses].rename(columns=named)),
            "\nExposure a day that reaches the action and limit values (2002/44/EC)",
            _printed(times.rename(columns=lambda name: name.removesuffix("_time").replace("_", " "))),
            *_doubts(comfort),
            "",
        ]
    )


def _printed(table: pd.DataFrame) -> str:
    return table.to_string(index=len(table) > 1, max_rows=ROWS, float_format=_number)


def _number(value: float) -> str:
    return f"{value:.4g}" if abs(value) > NOTHING else "0"


def _doubts(comfort: Comfort) -> list[str]:
    """Where a root mean square alone says too little of shocks."""
    where = doubtful(comfort.metrics)
    if not where.any():
        return []
    at = f" at {', '.join(where.point.values[where.values].tolist())}" if where.dims == ("point",) else ""
    said = (
        f"Shocks{at}: a root mean square alone says too little of them (crest factor above 9, MTVV above 1.5 a_w, or "
        "VDV above 1.75 a_w T^(1/4); ISO 2631-1, 6.2 and 6.3.3). Report MTVV or VDV beside it."
    )
    return ["", textwrap.fill(said, 110)]
