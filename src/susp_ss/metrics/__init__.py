"""Ride metrics of vehicles on roads, their derivatives, comfort, and one metric as a function of a table of designs."""

from .comfort import Comfort, comfort
from .rare_events import rare_events
from .response import Response
from .ride import ride_metrics
from .sensitivity import sensitivity
from .third_octaves import third_octaves
from .vibration import running_rms, vdv, weighted
from .weightings import weighting

__all__ = [
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
]
