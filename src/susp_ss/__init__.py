"""Suspension models as linear state-space systems, their exact ride metrics on random roads, and surrogates.

The flow is ``vehicles`` and ``roads`` -> ``responses`` -> ``metrics`` -> ``surrogates`` -> ``study``, ``fit`` and
``sweep`` -> ``presentation``. A vehicle is a frozen dataclass of parameters; a sweep of designs is the same dataclass
with arrays in it.

Examples
--------
>>> import susp_ss as ss
>>> car = ss.QuarterCar(ks=18e3, cs=1500.0)
>>> metrics = ss.ride_metrics(car, ss.Road.iso8608("B", speed=20.0))
>>> round(float(metrics.bacc), 3)
0.678
"""

import lazy_loader

from .vehicles import CLASSES

__version__ = "0.1.0"

__getattr__, __dir__, __all__ = lazy_loader.attach(
    __name__,
    submod_attrs={f"vehicles.{module}": classes for module, classes in CLASSES.items()}
    | {
        "vehicles.curves": ["DamperCurve", "SpringCurve"],
        "vehicles.linear": ["LinearVehicle"],
        "vehicles.parameters": ["Corners"],
        "vehicles.seats": ["Seat"],
        "roads": [
            "DEFAULT_ROAD",
            "FittedRoad",
            "Road",
            "fit_road",
            "iri",
            "mean_iri",
            "obstacle",
            "read_profile",
            "synthesise",
        ],
        "responses": [
            "coherence",
            "frequency_response",
            "invariant_points",
            "peaks",
            "psd",
            "simulate",
            "transmissibility",
        ],
        "responses.covariance": ["covariance", "linearised"],
        "metrics": [
            "Comfort",
            "Response",
            "comfort",
            "rare_events",
            "ride_metrics",
            "running_rms",
            "sensitivity",
            "third_octaves",
            "vdv",
            "weighted",
            "weighting",
        ],
        "surrogates": [
            "CoKriging",
            "Comparison",
            "ExtrapolationWarning",
            "Kriging",
            "ParameterBased",
            "Polynomial",
            "RadialBasis",
            "ResponseBased",
            "Validation",
            "VariableBased",
            "accuracy",
            "compare",
            "cross_validate",
            "held_out",
            "learning_curve",
            "learning_curve_of_runs",
            "sample",
        ],
        "design": ["ParetoFront", "pareto_front"],
        "feedback": [
            "ActiveBound",
            "ActiveFront",
            "Feedback",
            "HInfinity",
            "active_bound",
            "groundhook",
            "h_infinity",
            "hybrid",
            "lqg",
            "lqr",
            "skyhook",
            "tuned",
        ],
        "study": ["Scan", "Study", "feasibility_study", "scan_scenarios"],
        "exchange": ["FMU", "export"],
        "fit": ["Fit", "LowFidelity", "fit_runs", "load_surrogate", "next_runs", "read_histories", "read_runs"],
        "presentation": ["plots"],
        "presentation.report": ["report"],
        "presentation.save": ["save"],
    },
)
