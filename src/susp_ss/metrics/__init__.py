"""Ride metrics of vehicles on roads, their derivatives, and one metric as a function of a table of designs."""

from .response import Response
from .ride import ride_metrics
from .sensitivity import sensitivity
from .weightings import weighting

__all__ = ["Response", "ride_metrics", "sensitivity", "weighting"]
