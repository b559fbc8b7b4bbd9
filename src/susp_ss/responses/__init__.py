"""Responses of a vehicle to a road: over frequency, over time, and as exact covariance."""

from .frequency import frequency_response, psd
from .simulation import simulate

__all__ = ["frequency_response", "psd", "simulate"]
