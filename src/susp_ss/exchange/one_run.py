"""One run of an FMU, in a process of its own: a model that crashes takes nothing else with it.

A script that stands alone, so that it starts at once. It reads a job (JSON), and writes the outputs over time
(``.npy``, a row of instants and one for each output) or, in words, why there are none.
"""

import json
import sys
from ctypes import c_double, c_int, c_uint32
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np


def simulated(job: dict[str, Any]) -> Any:
    """Run the model over the road that the job says, and return its outputs."""
    from fmpy import read_model_description, simulate_fmu
    from fmpy.simulation import instantiate_fmu

    model = read_model_description(job["folder"], validate=False)
    kind = "CoSimulation" if model.coSimulation is not None else "ModelExchange"
    fmu = instantiate_fmu(job["folder"], model, kind, require_functions=False)
    references = {variable.name: variable.valueReference for variable in model.modelVariables}
    road = Road(fmu, [references[name] for name in job["road"]], np.load(job["inputs"]).T, job["step"])
    road.start()
    if kind == "ModelExchange":
        road.follow()
    else:
        road.carry_along(bool(model.coSimulation.canInterpolateInputs) and model.fmiVersion == "2.0")
    found = simulate_fmu(
        job["folder"],
        model_description=model,
        fmu_instance=fmu,
        start_time=0.0,
        stop_time=job["step"] * (len(road.u) - 1),
        output_interval=job["step"],
        start_values=job["parameters"],
        output=job["outputs"],
        record_events=False,
    )
    return np.array([found["time"], *(found[name] for name in job["outputs"])], dtype=float)


class Road:
    """The road as inputs ``u`` (T, k) of a model, linear between samples, set whenever the model is asked for more.

    Inputs by FMPy itself are held where they are as a step begins, half a step late, and within the steps of a solver.
    """

    def __init__(self, fmu: Any, at: list[int], u: Any, step: float):
        self.fmu, self.at, self.u, self.step = fmu, at, u, step
        self.put = partial(getattr(fmu, "setReal", None) or fmu.setFloat64, at)

    def __call__(self, time: float) -> Any:
        i = min(max(int(time / self.step), 0), len(self.u) - 2)
        share = min(time / self.step - i, 1.0)
        return self.u[i] + share * (self.u[i + 1] - self.u[i])

    def start(self) -> None:
        """The model starts on the first of it."""
        started = self.fmu.exitInitializationMode

        def on_road() -> Any:
            self.put(self(0.0).tolist())
            return started()

        self.fmu.exitInitializationMode = on_road

    def follow(self) -> None:
        """Model exchange: it is where it is whenever the solver sets the time, within its steps as well."""
        set_time = self.fmu.setTime

        def set_time_and_road(time: float) -> None:
            set_time(time)
            self.put(self(time).tolist())

        self.fmu.setTime = set_time_and_road

    def carry_along(self, linear: bool) -> None:
        """Co-simulation: linear over a step where the model can take that, else at its middle; then at its end."""
        do_step, n = self.fmu.doStep, len(self.at)
        references, first = (c_uint32 * n)(*self.at), (c_int * n)(*[1] * n)

        def step(currentCommunicationPoint: float, communicationStepSize: float, **how: Any) -> Any:
            start, end = self(currentCommunicationPoint), self(currentCommunicationPoint + communicationStepSize)
            self.put((start if linear else 0.5 * (start + end)).tolist())
            if linear:
                slopes = (c_double * n)(*((end - start) / communicationStepSize).tolist())
                self.fmu.fmi2SetRealInputDerivatives(self.fmu.component, references, n, first, slopes)
            done = do_step(currentCommunicationPoint, communicationStepSize, **how)
            self.put(end.tolist())
            return done

        self.fmu.doStep = step


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
