"""Tuned surrogates as formulas that can be typed into a spreadsheet.

The quarter car's metrics have closed forms on a road of waviness 2, so that a tuned quarter car needs no program.
"""

from __future__ import annotations

import math
from typing import TypeGuard

from ..roads.road import REFERENCE_WAVENUMBER
from ..surrogates import ParameterBased, Polynomial, ResponseBased, VariableBased
from ..surrogates.regressor import Surrogate
from ..vehicles.quarter import QuarterCar
from ..vehicles.vehicle import Vehicle
from .low_fidelity import LowFidelityResponse

# Closed forms under white road velocity, without tyre damping; M is ms + mu.
CLOSED_FORMS = {
    "bacc": "SQRT({q}/2*({kt}*{cs}/{ms}^2+{M}*{ks}^2/({ms}^2*{cs})))",
    "sws": "SQRT({q}*{M}/(2*{cs}))",
    "dtl": "SQRT({q}/2*({M}^3*{ks}^2/({ms}^2*{cs})-2*{M}*{mu}*{ks}*{kt}/({ms}*{cs})"
    "+{kt}^2*{mu}/{cs}+{kt}*{M}^2*{cs}/{ms}^2))",
    "damper_power": "{q}*{kt}/2",
}


def formula(surrogate: Surrogate, cheap: LowFidelityResponse | None = None) -> str | None:
    """Write a fitted surrogate as text in the names of its columns, SI units.

    Parameters
    ----------
    surrogate : Surrogate
        Fitted on a DataFrame.
    cheap : LowFidelityResponse, optional
        Its cheap model, if it has one.

    Returns
    -------
    str or None
        In the syntax of spreadsheets, with ``^`` and ``SQRT``. None for a surrogate without a formula of a few terms:
        radial basis functions and Kriging sum over all runs, and not every cheap model has a closed form.

    Examples
    --------
    >>> import pandas as pd
    >>> from susp_ss import Polynomial, RadialBasis
    >>> from susp_ss.fit.formulas import formula
    >>> runs = pd.DataFrame({"ks": [1.0, 2.0, 4.0]})
    >>> text = formula(Polynomial(degree=1).fit(runs, [1.5, 3.5, 7.5]))
    >>> text.count("*ks"), round(eval(text, {"ks": 3.0}), 9)
    (1, 5.5)
    >>> formula(RadialBasis().fit(runs, [1.5, 3.5, 7.5])) is None
    True
    """
    if isinstance(surrogate, Polynomial):
        return surrogate.formula()
    f = None if cheap is None else closed_form(cheap, getattr(surrogate, "parameter_", None))
    if f is None:
        return None
    if isinstance(surrogate, ParameterBased):
        return f
    if isinstance(surrogate, ResponseBased):
        a0, a1 = surrogate.intercept_, float(surrogate.coef_[0])
        return f"{a0!r}*({f})^({a1!r})" if surrogate.form == "power" else f"{a0!r} + {a1!r}*{f}"
    if isinstance(surrogate, VariableBased):
        plane = zip(surrogate.coef_.tolist(), surrogate.feature_names_in_, strict=True)
        return " + ".join([f, repr(surrogate.intercept_), *(f"{a!r}*{name}" for a, name in plane)])
    return None


def closed_form(cheap: LowFidelityResponse, value: float | None = None) -> str | None:
    """Write a quarter car's metric as text in the names of its columns; None without one, as weighted.

    With ``q = 2 pi^2 n0^2 G_d V`` and ``M = ms + mu``, on a road of waviness 2 without cut-off and without tyre
    damping, the variances are ``q/2 (kt cs/ms^2 + M ks^2/(ms^2 cs))`` of bacc, ``q M/(2 cs)`` of sws and
    ``q/2 (M^3 ks^2/(ms^2 cs) - 2 M mu ks kt/(ms cs) + kt^2 mu/cs + kt M^2 cs/ms^2)`` of dtl; the mean damper power is
    ``q kt/2``. (Residues of the transfer functions of Eqs 29 and 30 of *Feasibility study of surrogate model for the
    application of vehicle suspension system*, 2021, squared.)

    Parameters
    ----------
    cheap : LowFidelityResponse
    value : float, optional
        Of its tuned parameter; its own if None.

    Examples
    --------
    >>> from susp_ss import QuarterCar, Road
    >>> from susp_ss.fit.formulas import closed_form
    >>> from susp_ss.fit.low_fidelity import LowFidelityResponse
    >>> closed_form(LowFidelityResponse(QuarterCar(ms=300.0, mu=40.0), Road(), "sws", "fr", ("ks", "cs", "speed")))
    'SQRT((1.263309363339438e-05*speed)*340.0/(2*cs))'
    """
    car, road = cheap.vehicle, cheap.road
    given: dict[str, float | str] = {**cheap.expressions()}
    if cheap.parameter is not None and value is not None:
        given[cheap.parameter] = value
    white = road.waviness == 2.0 and road.scale_free and "cutoff" not in given
    if not _is_quarter_car(car) or car.curved or not white or car.ct or "ct" in given or cheap.response.weighted:
        return None
    own = {**vars(car), "speed": road.speed, "roughness": road.roughness}
    symbols: dict[str, float | str] = own | given
    q = 2.0 * math.pi**2 * REFERENCE_WAVENUMBER**2
    texts = []
    for name in ("roughness", "speed"):
        symbol = symbols[name]
        if isinstance(symbol, float):
            q *= symbol
        else:
            texts.append(symbol)
    symbols["q"] = f"({'*'.join([repr(q), *texts])})" if texts else q
    ms, mu = symbols["ms"], symbols["mu"]
    symbols["M"] = ms + mu if isinstance(ms, float) and isinstance(mu, float) else f"({ms}+{mu})"
    return CLOSED_FORMS[cheap.criterion].format_map(symbols)


def _is_quarter_car(car: Vehicle) -> TypeGuard[QuarterCar]:
    """Whether a car's equations are the quarter car's own: a kind derived from it may add what no closed form has."""
    kind = type(car)
    return kind.linkage is QuarterCar.linkage and kind.assemble is QuarterCar.assemble
