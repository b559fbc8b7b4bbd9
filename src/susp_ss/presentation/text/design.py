"""Designs that were searched as text for the terminal."""

from __future__ import annotations

import textwrap

import pandas as pd

from ...design import ParetoFront
from ...metrics.outputs import output
from ...quantities import titled, typeset

WIDTH = 96

NUMBER = "{:.4g}".format


def design_text(front: ParetoFront) -> str:
    """The designs beside the vehicle itself, and what the best of either objective gains."""
    blocks = [textwrap.fill(line, WIDTH) for line in (_asked(front), typeset(front.road.describe()))]
    table = pd.concat([front.table(), front.passive().to_frame("own").T])
    table.columns = pd.Index([titled(name, _unit(front, name)) for name in table.columns])
    blocks.append(table.to_string(float_format=NUMBER, na_rep=""))
    return "\n\n".join([*blocks, textwrap.fill(_gain(front), WIDTH)]) + "\n"


def _unit(front: ParetoFront, name: str) -> str:
    if name in front.variables:
        return front.vehicle.quantities()[front.vehicle.settings()[name][0]].unit
    return str(output(front.metrics, front.objectives[0] if name == "bound" else name).attrs["units"])


def _asked(front: ParetoFront) -> str:
    ranges = ", ".join(
        f"{name} {low:.5g} to {high:.5g} {typeset(_unit(front, name))}".rstrip()
        for name, (low, high) in front.variables.items()
    )
    limits = "".join(f", {name} <= {x:.4g} {typeset(_unit(front, name))}" for name, x in front.limits.items())
    over = front.scenarios
    said = "" if over is None else f", {over.said} over {len(over)} scenarios of {', '.join(over.settings)}"
    which = f"{len(front.designs)} designs that no other beats" if len(front.objectives) > 1 else "The best design"
    return f"{which} in {' and '.join(front.objectives)}{limits}{said}: {type(front.vehicle).__name__}, {ranges}"


def _gain(front: ParetoFront) -> str:
    """What the ends of the front are worth beside the vehicle itself."""
    table, own = front.table(), front.passive()
    said = []
    for name in front.objectives:
        change = table[name].min() / own[name] - 1.0
        said.append(f"{name} comes {100 * abs(change):.1f} % {'below' if change < 0 else 'above'} the vehicle's own")
    both = (table[list(front.objectives)] <= own[list(front.objectives)]).all(axis=1).sum()
    if len(front.objectives) > 1:
        said.append(f"{both} of the designs are better than it in both")
    if front.bound is not None:
        share = table[front.objectives[0]] / front.bound
        said.append(
            f"with any suspension {front.objectives[0]} could be {share.min():.2f} to {share.max():.2f} times lower, "
            "no deflection or tyre load at any corner being larger (bound)"
        )
    return "At best " + "; ".join(said) + "."
