"""Feedback laws, bounds and fronts as text for the terminal."""

from __future__ import annotations

import textwrap
from math import isfinite

import pandas as pd
import xarray as xr

from ...feedback import ActiveBound, ActiveFront, Feedback
from ...quantities import typeset, unit_of

WIDTH = 96

NUMBER = "{:.4g}".format


def feedback_text(law: Feedback) -> str:
    """Every metric passive and under the law, and the gain."""
    blocks = [f"{law!r}; {typeset(law.road.describe())}", _table(law)]
    if law.gain is not None:
        gain = law.gain.to_pandas().T.to_string(float_format="{:.5g}".format)
        blocks.append(f"Forces in N per state:\n{gain}")
    return "\n\n".join(blocks) + "\n"


def bound_text(bound: ActiveBound) -> str:
    """The bound, what its limits cost, and every metric."""
    unit = typeset(bound.metrics[bound.minimise.partition("@")[0]].attrs["units"])
    rank = "No law of any kind comes lower" if bound.preview else "The best gain found on the states alone"
    said = f"{bound!r}. {rank}."
    if bound.unresolved:
        said += (
            f" Forces without end would come closer and closer to a value about {100 * bound.unresolved:.3g} % lower; "
            "limit force to see what actuators of some strength can do."
        )
    if isfinite(bound.least):
        said += f" By a semidefinite programme nothing comes below {bound.least:.4g} {unit}."
    limits = pd.DataFrame(
        {
            "limit": bound.limits,
            "unit": {name: typeset(unit_of(name.replace("@", "_"))) for name in bound.limits},
            f"{bound.minimise} ({unit}) per unit": {name: -price for name, price in bound.multipliers.items()},
        }
    )
    blocks = [textwrap.fill(said, WIDTH), typeset(bound.road.describe())]
    blocks += [limits.to_string(float_format=NUMBER)] if bound.limits else []
    return "\n\n".join([*blocks, _table(bound)]) + "\n"


def front_text(front: ActiveFront) -> str:
    """The bound at every point of the limits."""
    columns = {f"{name} <= ({typeset(limit.attrs['units'])})": limit for name, limit in front.limits.items()}
    unit = typeset(front.bound.attrs["units"])
    columns |= {f"{front.minimise} ({unit})": front.bound}
    if front.least.notnull().any():
        columns |= {f"by a semidefinite programme ({unit})": front.least}
    table = xr.Dataset(columns).to_dataframe()
    return f"{front!r}\n\n{table.to_string(float_format=NUMBER, na_rep='out of reach')}\n"


def _table(law: Feedback) -> str:
    table = law.table().rename(columns={law.kind: "with law"})
    table["unit"] = table["unit"].map(typeset)
    return str(table.to_string(float_format=NUMBER, na_rep=""))
