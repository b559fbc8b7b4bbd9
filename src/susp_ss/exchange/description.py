"""``modelDescription.xml`` of FMI 2.0: every signal with its unit, and what depends on what."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Iterable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .realised import Realised

ABILITIES = {
    "canGetAndSetFMUstate": "true",
    "canSerializeFMUstate": "true",
    "canNotUseMemoryManagementFunctions": "true",
    "providesDirectionalDerivative": "true",
}
"""Of model exchange and of co-simulation."""

STEPPING = {"canHandleVariableCommunicationStepSize": "true", "canInterpolateInputs": "true"}
"""Of co-simulation."""

EXPERIMENT = {"startTime": "0", "stopTime": "10", "tolerance": "1e-6", "stepSize": "0.001"}

DERIVED = {"N": {"kg": 1, "m": 1, "s": -2}, "W": {"kg": 1, "m": 2, "s": -3}}
"""Units of several base units."""

BASE = ("kg", "m", "s", "rad")


def exponents(unit: str) -> dict[str, int] | None:
    """Exponents of the base units of an SI unit as this package writes it; None where it has others.

    Examples
    --------
    >>> from susp_ss.exchange.description import exponents
    >>> exponents("N s/m"), exponents("m/s^2"), exponents("bar")
    ({'kg': 1, 's': -1}, {'m': 1, 's': -2}, None)
    """
    found: dict[str, int] = {}
    for place, part in enumerate(unit.split("/")):
        for factor in part.split():
            name, _, power = factor.partition("^")
            base = DERIVED.get(name, {name: 1} if name in BASE else None)
            if base is None or not (power or "1").isdecimal():
                return None
            for key, exponent in base.items():
                found[key] = found.get(key, 0) + exponent * int(power or 1) * (-1 if place else 1)
    return {key: exponent for key, exponent in found.items() if exponent}


def nominal(unit: str) -> float:
    """The usual size of a state, by which solvers measure their errors: a centimetre, a tenth of a metre a second."""
    return {"m": 0.01, "rad": 0.01, "m/s": 0.1, "rad/s": 0.1}.get(unit, 1.0)


def description(model: Realised, name: str, identifier: str, guid: str, tool: str) -> str:
    """The file's text.

    Parameters
    ----------
    model : Realised
    name : str
        Of the model, as people read it.
    identifier : str
        Of the model, as C and the binary have it.
    guid : str
        Which sources these are.
    tool : str
        What wrote them.
    """
    root = ET.Element(
        "fmiModelDescription",
        fmiVersion="2.0",
        modelName=name,
        guid=guid,
        description=f"{name}, linear; parameters are in the matrices",
        generationTool=tool,
        variableNamingConvention="flat",
        numberOfEventIndicators="0",
    )
    for kind, more in (("ModelExchange", {}), ("CoSimulation", STEPPING)):
        of_kind = ET.SubElement(root, kind, {"modelIdentifier": identifier, **more, **ABILITIES})
        ET.SubElement(ET.SubElement(of_kind, "SourceFiles"), "File", name="fmi2.c")
    rates = [one.unit and (one.unit + "^2" if one.unit.endswith("/s") else one.unit + "/s") for one in model.states]
    signals = (*model.inputs, *model.states, *model.outputs)
    _units(root, [*(one.unit for one in signals), *rates, *(one.unit for one in model.constants)])
    ET.SubElement(root, "DefaultExperiment", EXPERIMENT)
    _variables(ET.SubElement(root, "ModelVariables"), model, rates)
    _structure(ET.SubElement(root, "ModelStructure"), model)
    ET.indent(root)
    return '<?xml version="1.0" encoding="UTF-8"?>\n' + ET.tostring(root, encoding="unicode") + "\n"


def _units(root: ET.Element, units: Iterable[str]) -> None:
    known = [unit for unit in dict.fromkeys(units) if unit]
    definitions = ET.SubElement(root, "UnitDefinitions") if known else root
    for unit in known:
        definition = ET.SubElement(definitions, "Unit", name=unit)
        base = exponents(unit)
        if base is not None:
            ET.SubElement(definition, "BaseUnit", {key: str(exponent) for key, exponent in base.items()})


def _variables(variables: ET.Element, model: Realised, rates: list[str]) -> None:
    """In the order of their value references, which is that of the C source."""

    def variable(name: str, meaning: str, unit: str, kind: dict[str, str], **real: Any) -> None:
        reference = str(len(variables))
        scalar = ET.SubElement(variables, "ScalarVariable", name=name, valueReference=reference, description=meaning)
        scalar.attrib |= kind
        ET.SubElement(scalar, "Real", ({"unit": unit} if unit else {}) | {key: str(x) for key, x in real.items()})

    local = {"causality": "local", "variability": "continuous", "initial": "calculated"}
    for one in model.inputs:
        variable(one.name, one.meaning, one.unit, {"causality": "input", "variability": "continuous"}, start="0")
    for one in model.states:
        variable(one.name, one.meaning, one.unit, local, nominal=nominal(one.unit))
    first = len(model.inputs) + 1
    for i, (one, unit) in enumerate(zip(model.states, rates, strict=True), start=first):
        variable(f"der({one.name})", f"rate of change of {one.name}", unit, local, derivative=i)
    for one in model.outputs:
        variable(one.name, one.meaning, one.unit, local | {"causality": "output"})
    fixed = {"causality": "local", "variability": "constant", "initial": "exact"}
    for constant in model.constants:
        variable(constant.name, constant.meaning, constant.unit, fixed, start=repr(constant.value))


def _structure(structure: ET.Element, model: Realised) -> None:
    m, n, outputs = len(model.inputs), len(model.states), len(model.outputs)
    states, rates, seen = (list(range(i + 1, i + 1 + k)) for i, k in ((m, n), (m + n, n), (m + 2 * n, outputs)))
    of_outputs, of_rates = np.hstack([model.D, model.C]), np.hstack([model.B, model.A])
    for kind, indices, rows in (("Outputs", seen, of_outputs), ("Derivatives", rates, of_rates)):
        part = ET.SubElement(structure, kind)
        for index, row in zip(indices, rows, strict=True):
            ET.SubElement(part, "Unknown", index=str(index), dependencies=_indices(row))
    initial = ET.SubElement(structure, "InitialUnknowns")
    inputs = " ".join(str(i) for i in range(1, m + 1))
    for index in sorted([*states, *rates, *seen]):
        ET.SubElement(initial, "Unknown", index=str(index), dependencies=inputs)


def _indices(row: NDArray[np.float64]) -> str:
    """Inputs and states that a row of coefficients has: they are the first variables."""
    return " ".join(str(i + 1) for i in np.flatnonzero(row))
