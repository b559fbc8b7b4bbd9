"""Designs that fill a box: Latin hypercube and Sobol."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import pandas as pd
from scipy.stats import qmc

from ..quantities import briefly, whole_number

METHODS = ("latin_hypercube", "sobol")


def sample(
    box: Mapping[str, Sequence[float]], runs: int, method: str = "latin_hypercube", random_state: Any = 0
) -> pd.DataFrame:
    """Spread designs over a box, by `scipy.stats.qmc`.

    A Latin hypercube has one design in each of ``runs`` equal slices of every variable. A scrambled Sobol sequence
    fills the box in all variables together; its first designs are those of every longer one of the same seed. It is
    balanced at powers of two, and of other lengths it is the beginning of the next.

    Parameters
    ----------
    box : mapping of str to (low, high)
        Range of each variable, in its own unit.
    runs : int
    method : {"latin_hypercube", "sobol"}
    random_state : int, sequence of int, numpy.random.Generator or None

    Returns
    -------
    DataFrame, (runs, k)
        A column a variable, in the order of ``box``.

    Raises
    ------
    TypeError, ValueError
        A box that is no mapping to rising pairs of finite numbers, fewer than one run, or an unknown method.

    Examples
    --------
    >>> from susp_ss import sample
    >>> X = sample({"ks": (12e3, 24e3), "cs": (800.0, 2200.0)}, 12)
    >>> X.shape, sorted(((X["ks"] - 12e3) // 1e3).astype(int)) == list(range(12))
    ((12, 2), True)
    """
    lows, highs = sides(box)
    runs = whole_number("runs", runs, 1)
    if method not in METHODS:
        raise ValueError(f"method must be one of {', '.join(METHODS)}, got {briefly(method)}")
    rng = np.random.default_rng(random_state)
    if method == "sobol":
        unit = qmc.Sobol(len(box), rng=rng).random_base2(math.ceil(math.log2(runs)))[:runs]
    else:
        unit = qmc.LatinHypercube(len(box), rng=rng).random(runs)
    return pd.DataFrame(qmc.scale(unit, lows, highs), columns=list(box))


def sides(box: Any) -> tuple[list[float], list[float]]:
    """Lowest and highest value of each variable of a box.

    Raises
    ------
    TypeError, ValueError
        It is no mapping to rising pairs of finite numbers.
    """
    if not isinstance(box, Mapping) or not box:
        raise TypeError(f"box must map the name of each variable to (low, high), got {briefly(box)}")
    lows, highs = [], []
    for name, side in box.items():
        try:
            low, high = map(float, side)
        except (TypeError, ValueError):
            raise ValueError(f"box[{name!r}] must be two numbers (low, high), got {briefly(side)}") from None
        if not -math.inf < low < high < math.inf:
            raise ValueError(f"box[{name!r}] must rise between finite numbers, got {briefly(side)}")
        lows.append(low)
        highs.append(high)
    return lows, highs
