"""Suspension models as linear state-space systems, their exact ride metrics on random roads, and surrogates.

The flow is ``vehicles`` and ``roads`` -> ``responses`` -> ``metrics`` -> ``surrogates`` -> ``study``. A vehicle
is a frozen dataclass of parameters; a sweep of designs is the same dataclass with arrays in it.

Examples
--------
>>> import susp_ss as ss
>>> car = ss.QuarterCar(ks=18e3, cs=1500.0)
>>> metrics = ss.ride_metrics(car, ss.Road.iso8608("B", speed=20.0))
>>> round(float(metrics.bacc), 3)
0.678
"""

import lazy_loader

__version__ = "0.1.0"

__getattr__, __dir__, __all__ = lazy_loader.attach(
    __name__,
    submod_attrs={
        "vehicles": [
            "Corners",
            "FullCar",
            "PitchHalfCar",
            "QuarterCar",
            "RigidTyreQuarterCar",
            "RollHalfCar",
        ],
        "roads": ["Road"],
        "responses": ["covariance", "frequency_response", "psd", "simulate"],
        "bridge": ["Response"],
        "metrics": ["ride_metrics"],
        "sensitivities": ["sensitivity"],
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
        "matched": ["LowFidelity"],
        "runs": ["read_runs"],
        "surrogate_file": ["load_surrogate"],
        "fitting": ["fit_runs"],
        "study": ["Study", "feasibility_study"],
    },
)
