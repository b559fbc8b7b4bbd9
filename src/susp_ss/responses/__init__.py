"""Responses of a vehicle to a road: over frequency, over time, and as exact covariance."""

from .frequency import frequency_response, psd
from .peaks import peaks
from .simulation import simulate

__all__ = ["frequency_response", "peaks", "psd", "simulate"]
