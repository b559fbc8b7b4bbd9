"""Ride metrics of vehicles on roads, their derivatives, and one metric as a function of a table of designs."""

from .rare_events import rare_events
from .response import Response
from .ride import ride_metrics
from .sensitivity import sensitivity
from .weightings import weighting

__all__ = ["Response", "rare_events", "ride_metrics", "sensitivity", "weighting"]
