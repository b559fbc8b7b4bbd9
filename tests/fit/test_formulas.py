"""What a formula says, typed in, is what the surrogate predicts."""

import numpy as np
import pandas as pd
import pytest

import susp_ss as ss
from susp_ss.fit import LowFidelity
from susp_ss.fit.formulas import closed_form, formula

COLUMNS = ("ks_front", "ks_rear", "cs", "ms", "speed")
LOW, HIGH = [15e3, 16e3, 1e3, 250.0, 10.0], [25e3, 26e3, 2e3, 400.0, 30.0]


def runs(n, seed, columns=COLUMNS):
    return pd.DataFrame(np.random.default_rng(seed).uniform(LOW, HIGH, (n, len(LOW))), columns=COLUMNS)[list(columns)]


def typed(text, designs):
    """A spreadsheet's answer: its syntax in Python's."""
    names = {name: designs[name].to_numpy() for name in designs}
    return eval(text.replace("^", "**"), {"SQRT": np.sqrt, "__builtins__": {}}, names) * np.ones(len(designs))


@pytest.mark.parametrize("output", ["bacc", "bacc_cg", "sws_rr", "dtl_fr", "damper_power_fl"])
@pytest.mark.parametrize("columns", [COLUMNS, ("ks_front", "cs"), ("ks_rear", "speed", "ms")], ids=len)
def test_closed_forms_are_the_exact_metrics(output, columns):
    cheap = LowFidelity(ss.QuarterCar(mu=50.0, kt=210e3), ss.Road.iso8608("C", speed=17.0)).response(output, columns)
    T = runs(20, 1, columns)
    np.testing.assert_allclose(typed(closed_form(cheap), T), cheap(T), rtol=1e-10)


@pytest.mark.parametrize(
    "make",
    [
        lambda f, g: ss.ResponseBased(f),
        lambda f, g: ss.ResponseBased(f, form="power"),
        lambda f, g: ss.VariableBased(f),
        lambda f, g: ss.ParameterBased(g),
        lambda f, g: ss.Polynomial(degree=2),
    ],
)
def test_a_typed_formula_predicts(make):
    columns = ("ks_front", "ks_rear", "cs", "speed")
    cheap = LowFidelity(ss.QuarterCar(), ss.Road(), "fr", "ms")
    f, g = cheap.response("sws_fr", columns), cheap.response("bacc_cg", columns, tuned=True)
    output = g if "Parameter" in type(make(f, g)).__name__ else f
    X, T = runs(30, 2, columns), runs(20, 3, columns)
    fitted = make(f, g).fit(X, f(X) ** 1.1 + 1e-6 * X["cs"] if output is f else g(X, 280.0))
    np.testing.assert_allclose(typed(formula(fitted, output), T), fitted.predict(T), rtol=1e-9)


@pytest.mark.parametrize(
    ("vehicle", "road"),
    [
        (ss.QuarterCar(ct=10.0), ss.Road()),
        (ss.QuarterCar(), ss.Road(cutoff=0.01)),
        (ss.PitchHalfCar(), ss.Road()),
    ],
)
def test_no_formula_where_there_is_no_closed_form(vehicle, road):
    cheap = LowFidelity(vehicle, road, "fr").response("sws", ("ks_front", "cs"))
    X = runs(8, 4, ("ks_front", "cs"))
    assert formula(ss.ResponseBased(cheap).fit(X, 2.0 * cheap(X)), cheap) is None
    assert formula(ss.RadialBasis().fit(X, cheap(X))) is None
