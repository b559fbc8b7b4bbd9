"""Surrogates: a cheap model's response, tuned to an expensive model's. They know no vehicle, only callables of X."""

from .accuracy import Accuracy, accuracy
from .correction import ResponseBased, VariableBased
from .parameter import ParameterBased

__all__ = ["Accuracy", "ParameterBased", "ResponseBased", "VariableBased", "accuracy"]
