"""Surrogates: a cheap model tuned to an expensive one, or its runs approximated. They know only callables of X."""

from .accuracy import Accuracy, accuracy
from .correction import ResponseBased, VariableBased
from .kriging import CoKriging, Kriging
from .learning import learning_curve, learning_curve_of_runs
from .parameter import ParameterBased
from .polynomial import Polynomial
from .radial_basis import RadialBasis
from .regressor import ExtrapolationWarning
from .sampling import sample
from .validation import Comparison, Validation, compare, cross_validate, held_out

__all__ = [
    "Accuracy",
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
]
