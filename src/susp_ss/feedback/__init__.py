"""Feedback laws and bounds: state spaces in, state spaces out."""

from .bound import ActiveBound, ActiveFront, active_bound
from .h_infinity import HInfinity, h_infinity
from .regulators import lqg, lqr
from .result import Feedback
from .skyhooks import groundhook, hybrid, skyhook
from .tuning import tuned

__all__ = [
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
]
