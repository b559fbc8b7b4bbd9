"""One run of an FMU, in a process of its own: a model that crashes takes nothing else with it.

A script that stands alone, so that it starts at once. It reads a job (JSON), and writes the outputs over time
(``.npy``, a row of instants and one for each output) or, in words, why there are none.
"""

import json
import sys
from ctypes import c_double, c_int, c_uint32
from pathlib import Path
from typing import Any

import numpy as np


def simulated(job: dict[str, Any]) -> Any:
    """Run the model over the road that the job says, and return its outputs."""
    from fmpy import read_model_description, simulate_fmu
    from fmpy.simulation import instantiate_fmu

    model = read_model_description(job["folder"], validate=False)
    t, u = np.load(job["time"]), np.load(job["inputs"])
    kind = "CoSimulation" if model.coSimulation is not None else "ModelExchange"
    fmu = instantiate_fmu(job["folder"], model, kind, require_functions=False)
    references = {variable.name: variable.valueReference for variable in model.modelVariables}
    at = [references[name] for name in job["road"]]
    if kind == "CoSimulation":
        _carry_along(fmu, model, at, t, u)
    else:
        _follow(fmu, at, t, u)
    found = simulate_fmu(
        job["folder"],
        model_description=model,
        fmu_instance=fmu,
        start_time=0.0,
        stop_time=float(t[-1]),
        output_interval=job["step"],
        start_values=job["parameters"],
        input=np.array(list(zip(t, *u, strict=True)), dtype=[(name, float) for name in ("time", *job["road"])]),
        output=job["outputs"],
        record_events=False,
    )
    return np.array([found["time"], *(found[name] for name in job["outputs"])], dtype=float)


def _setter(fmu: Any, at: list[int]) -> Any:
    put = getattr(fmu, "setReal", None) or fmu.setFloat64
    return lambda values: put(at, [float(value) for value in values])


def _follow(fmu: Any, at: list[int], t: Any, u: Any) -> None:
    """Model exchange: whenever the solver sets the time, within its steps as well, the road is where it is then."""
    set_time, put = fmu.setTime, _setter(fmu, at)

    def set_time_and_road(time: float) -> None:
        set_time(time)
        put([np.interp(time, t, row) for row in u])

    fmu.setTime = set_time_and_road


def _carry_along(fmu: Any, model: Any, at: list[int], t: Any, u: Any) -> None:
    """Co-simulation: over a step the road is linear where the model can take that, else at its middle; then at its end.

    Held where it is as the step begins, the road would come half a step late.
    """
    do_step, put = fmu.doStep, _setter(fmu, at)
    linear = bool(model.coSimulation.canInterpolateInputs) and hasattr(fmu, "fmi2SetRealInputDerivatives")
    n = len(at)
    references, first = (c_uint32 * n)(*at), (c_int * n)(*[1] * n)

    def step(currentCommunicationPoint: float, communicationStepSize: float, **how: Any) -> Any:
        start, end = (
            np.array([np.interp(currentCommunicationPoint + h, t, row) for row in u])
            for h in (0.0, communicationStepSize)
        )
        put(start if linear else 0.5 * (start + end))
        if linear:
            slopes = (c_double * n)(*(end - start) / communicationStepSize)
            fmu.fmi2SetRealInputDerivatives(fmu.component, references, n, first, slopes)
        done = do_step(currentCommunicationPoint, communicationStepSize, **how)
        put(end)
        return done

    fmu.doStep = step


def main(path: str) -> int:
    """Do the job of a file."""
    job = json.loads(Path(path).read_text(encoding="utf-8"))
    try:
        np.save(job["result"], simulated(job))
    except Exception as error:  # whatever the model or its libraries raise is why there is no run
        Path(job["refusal"]).write_text(f"{type(error).__name__}: {error}", encoding="utf-8")
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1]))
