"""Surrogates: a cheap model tuned to an expensive one, or its runs approximated. They know only callables of X."""

from .accuracy import Accuracy, accuracy
from .correction import ResponseBased, VariableBased
from .kriging import CoKriging, Kriging
from .parameter import ParameterBased
from .polynomial import Polynomial
from .radial_basis import RadialBasis
from .regressor import ExtrapolationWarning

__all__ = [
    "Accuracy",
    "CoKriging",
    "ExtrapolationWarning",
    "Kriging",
    "ParameterBased",
    "Polynomial",
    "RadialBasis",
    "ResponseBased",
    "VariableBased",
    "accuracy",
]
