"""A model as a python-control system with named signals."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from ..quantities import briefly, signal

if TYPE_CHECKING:
    import control


def control_system(model: Any, name: str, input: str, actuators: bool) -> control.StateSpace:
    """The state space of a model of one design from the road's displacement or velocity, and what else drives it.

    Raises
    ------
    TypeError, ValueError
        Options that are none, or an output that needs the derivative of the input.
    """
    import control

    if not isinstance(actuators, bool | np.bool_):
        raise TypeError(f"actuators must be True or False, got {briefly(actuators)}")
    if input not in ("displacement", "velocity"):
        raise ValueError(f"input must be 'displacement' or 'velocity', got {briefly(input)}")
    layout, table = model.layout, model.layout.outputs
    seen = {"sws_rate"} if actuators else set()
    rows = [i for i, row in enumerate(table.rows) if row.public or row.quantity.name in seen]
    outputs = tuple(table.names[i] for i in rows)
    if input == "velocity":
        A, B, Y, D = map(_one, model.velocity_form())
        states, inputs = layout.relative_states, tuple(f"d{name}" for name in layout.inputs)
    else:
        A, B, Y, D, D1 = map(_one, model.displacement_form())
        improper = [name for name, row in zip(outputs, D1[rows], strict=True) if np.any(row)]
        if improper:
            raise ValueError(
                f"{', '.join(improper)}: no state space from the displacement of the road exists, as its velocity "
                'is passed straight on; pass input="velocity"'
            )
        states, inputs = layout.states, layout.inputs
    driven = [(layout.controls, model.controls)] if layout.controls else []
    driven += [(tuple(signal("u", corner) for corner in layout.corners), model.actuated)] if actuators else []
    for names, forms in driven:
        B_u, D_u = map(_one, forms())
        B, D = np.hstack([B, np.pad(B_u, [(0, len(A) - len(B_u)), (0, 0)])]), np.hstack([D, D_u])
        inputs = inputs + names
    return control.ss(A, B, Y[rows], D[rows], states=states, inputs=inputs, outputs=outputs, name=name)


def _one(x: Any) -> Any:
    return x.reshape(x.shape[-2:])
