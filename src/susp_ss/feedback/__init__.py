"""Feedback laws and bounds: state spaces in, state spaces out."""

from .bound import ActiveBound, ActiveFront, active_bound
from .result import Feedback

__all__ = ["ActiveBound", "ActiveFront", "Feedback", "active_bound"]
