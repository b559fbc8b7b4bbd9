"""Any result as text for the terminal."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from ..design import ParetoFront
from ..feedback import ActiveBound, ActiveFront, Feedback
from ..fit.fitting import Fit
from ..metrics.comfort import Comfort
from ..roads.road_fit import FittedRoad
from ..study.feasibility import Study
from ..study.scan import Scan
from .text.comfort import comfort_text
from .text.design import design_text
from .text.feedback import bound_text, feedback_text, front_text
from .text.fit import fit_text
from .text.road import fitted_road_text
from .text.scan import scan_text
from .text.study import study_text

TEXTS: dict[type, Callable[[Any], str]] = {
    Study: study_text,
    Fit: fit_text,
    Scan: scan_text,
    FittedRoad: fitted_road_text,
    Comfort: comfort_text,
    Feedback: feedback_text,
    ActiveBound: bound_text,
    ActiveFront: front_text,
    ParetoFront: design_text,
}


def report(result: Any) -> str:
    """Say in words and tables what a result is worth.

    Of a `Study`: Tables 3 to 5 with ours beside the published values, what agrees, held-out accuracy, cost, and where
    designs land that are optimised on the surrogates. Of a `Fit`: for each output the ranking, the choice, what the
    cheap model was worth, and the formula. Of a `Scan`: the nearest scenarios, and what each assumption can and cannot
    reach. Of a `FittedRoad`: class, spectrum and tracks, each with its interval. Of a `Comfort`: what is felt and in
    what words, doses, and how long a day they are permitted. Of a `Feedback`, an `ActiveBound` or an `ActiveFront`:
    every metric beside the passive vehicle's, the gain, and what limits cost. Of a `ParetoFront`: its designs, and what
    they gain over the vehicle itself.

    Parameters
    ----------
    result : Study, Fit, Scan, FittedRoad, Comfort, Feedback, ActiveBound, ActiveFront or ParetoFront

    Returns
    -------
    str

    Raises
    ------
    TypeError
        There are no words for such a result.

    Examples
    --------
    >>> import susp_ss as ss
    >>> print(ss.report(ss.comfort(ss.FullCar(), ss.Road())).splitlines()[0])
    Comfort: FullCar on ..., 20 m/s, identical tracks, rear wheels delayed; 8 h of exposure
    """
    if type(result) not in TEXTS:
        available = ", ".join(kind.__name__ for kind in TEXTS)
        raise TypeError(f"result must be one of {available}, got {type(result).__name__}")
    return TEXTS[type(result)](result)
