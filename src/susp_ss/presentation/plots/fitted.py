"""A surrogate over the box of its runs."""

from __future__ import annotations

from typing import Any

import matplotlib as mpl
import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from ...fit.surrogate_file import SuspensionSurrogate
from ...quantities import titled
from .style import COLUMN, STYLE, panels

NODES = 60
"""Of the grid that is predicted, along each input."""


def fitted_map(
    surrogate: SuspensionSurrogate,
    output: str,
    designs: pd.DataFrame | None = None,
    ax: Any = None,
    following: pd.DataFrame | None = None,
) -> Figure:
    """Contours of a surrogate of two inputs over the box of its runs.

    Parameters
    ----------
    surrogate : SuspensionSurrogate
        Of two inputs.
    output : str
        Which of its outputs.
    designs : DataFrame, optional
        The runs, with the inputs as columns, drawn as points.
    ax : Axes, optional
    following : DataFrame, optional
        The runs to make next, as `susp_ss.next_runs` lists them, drawn as squares with their numbers.

    Returns
    -------
    matplotlib.figure.Figure

    Raises
    ------
    ValueError
        The surrogate has not two inputs, or no such output.

    Examples
    --------
    >>> import pandas as pd
    >>> import susp_ss as ss
    >>> from susp_ss.presentation.plots import fitted_map
    >>> from susp_ss.fit.surrogate_file import SuspensionSurrogate
    >>> runs = pd.DataFrame({"ks": [15e3, 15e3, 25e3, 25e3], "cs": [1000.0, 2000.0, 1000.0, 2000.0]})
    >>> models = {"sws": ss.Polynomial(degree=1).fit(runs, [0.010, 0.008, 0.009, 0.007])}
    >>> cheap = ss.LowFidelity(ss.QuarterCar(), ss.Road())
    >>> surrogate = SuspensionSurrogate({"ks": "N/m", "cs": "N s/m"}, {"sws": "m"}, models, cheap)
    >>> fitted_map(surrogate, "sws", runs).axes[0].get_xlabel()
    'ks (N/m)'
    """
    if len(surrogate.inputs) != 2:
        raise ValueError(
            f"a map needs a surrogate of 2 inputs, got {len(surrogate.inputs)}: {', '.join(surrogate.inputs)}"
        )
    if output not in surrogate.outputs:
        raise ValueError(f"no output named {output!r}, available: {', '.join(surrogate.outputs)}")
    (x_name, x), (y_name, y) = ((name, np.linspace(*bounds, NODES)) for name, bounds in surrogate.box.items())
    nodes = np.meshgrid(x, y)
    columns = {name: values.ravel() for name, values in zip(surrogate.inputs, nodes, strict=True)}
    predicted = surrogate.predict(columns)[output].to_numpy().reshape(NODES, NODES)
    with mpl.rc_context(STYLE):
        figure, ((axes,),) = panels(ax, 1, 1, (COLUMN, 2.8))
        image = axes.contourf(x, y, predicted, levels=12, cmap="cividis")
        axes.contour(x, y, predicted, levels=image.levels, colors="white", linewidths=0.3)
        if designs is not None:
            axes.plot(designs[x_name], designs[y_name], "o", color="black", markersize=3.0, mec="white", mew=0.5)
        for i, design in enumerate([] if following is None else following[[x_name, y_name]].to_numpy(), 1):
            axes.plot(*design, "s", color="white", markersize=8.0, mec="black", mew=0.7, clip_on=False, zorder=4)
            axes.annotate(str(i), design, ha="center", va="center_baseline", fontsize=6.0, zorder=5)
        axes.set_xlabel(titled(x_name, surrogate.inputs[x_name]))
        axes.set_ylabel(titled(y_name, surrogate.inputs[y_name]))
        through = surrogate.low_fidelity.through(output)
        shown = f"{output} through {through.name}" if through else output
        figure.colorbar(image, ax=axes).set_label(titled(shown, surrogate.outputs[output]))
    return figure
